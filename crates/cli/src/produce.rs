//! From a recipe to files: what `fill` and `run` have in common.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::Duration,
};

use arabesque::{
    Artwork, Companion, Encoded, EnergyPoint, Error, Format, Input, Job, OutputOptions, Prepared, Recipe, Resources,
    StopReason, Stopper, Summary, Warning, in_pool, io::file,
};
use clap::Args;

use crate::{
    drawing, duration,
    failure::Failure,
    guard::{Guard, RecipeFile, WriteOptions},
    limits::LimitOptions,
    process::{
        memory,
        sentinel::{self, Orders, Phase},
        standard,
    },
    progress::Watch,
    say::{self, Level},
    summary::{self, Output, Outputs},
};

/// Options of everything that runs.
#[derive(Args, Debug)]
pub(crate) struct RunOptions {
    /// Number of threads; the result does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<usize>,
    /// Make N results with the seeds SEED, SEED+1, ...; OUT gets -1, -2, ... before its extension
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) variations: Option<u32>,
    /// Stop this long after the start of the command and write the best so far: seconds, or 1m30s
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) time_limit: Option<Duration>,
    /// File format, where the extension of OUT does not say: svg, png, json, csv, obj, glb, gltf, ply, usda or toml (the recipe alone)
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<Format>,
    /// Leave the recipe out of the result, which then cannot be repeated by `arabesque run`
    #[arg(long)]
    pub(crate) no_recipe: bool,
    #[command(flatten)]
    pub(crate) write: WriteOptions,
    #[command(flatten)]
    pub(crate) limit: LimitOptions,
    #[command(flatten)]
    pub(crate) talk: TalkOptions,
}

/// How much is said, and to whom.
#[derive(Args, Debug)]
pub(crate) struct TalkOptions {
    /// Write a machine-readable summary to standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say what was understood and how the run went
    #[arg(short, long, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
}

impl TalkOptions {
    pub(crate) fn level(&self) -> Level {
        match (self.quiet, self.verbose) {
            (true, _) => Level::Quiet,
            (false, 1..) => Level::Verbose,
            (false, 0) => Level::Normal,
        }
    }
}

/// One file to be made.
struct Plan {
    path: String,
    seed: u64,
    target: file::Target,
    /// Where its companion lies, if it may have one.
    beside: Option<file::Target>,
}

impl Plan {
    /// Writes a result and its companion: the latter once the former is on the disk under a name for the time being, so that there are both
    /// or none.
    fn write(&self, bytes: &[u8], companion: Option<&Companion>) -> arabesque::Result<Option<PathBuf>> {
        let (Some(target), Some(companion)) = (&self.beside, companion) else { return self.target.write(bytes) };
        self.target.write_watched(bytes, &mut |step| match step {
            file::Step::Kept => target.write(&companion.bytes).map(|_| ()).map_err(std::io::Error::other),
            _ => Ok(()),
        })
    }
}

/// The ending of files of materials.
const MATERIALS: &str = "mtl";

/// Runs `recipe`, whose files lie beside the file that it was read from, and writes the result to `path`.
pub(crate) fn produce(
    mut recipe: Recipe,
    from: Option<RecipeFile<'_>>,
    path: &str,
    options: &RunOptions,
) -> Result<ExitCode, Failure> {
    let path = if file::is_standard_output(path) { file::STANDARD } else { path };
    let base = from.as_ref().map(RecipeFile::folder);
    let result = check(&mut recipe, from, path, options).and_then(|plans| {
        let resources = resources(base, path, options)?;
        in_pool(options.threads, || make_all(&recipe, &resources, plans, options))?
    });
    match &result {
        Err(failure) if options.talk.json && path != file::STANDARD => summary::print_failure(failure),
        _ => {}
    }
    result
}

/// Where files are and how much may be used up; from here on the program can be stopped.
fn resources(base: Option<&Path>, path: &str, options: &RunOptions) -> Result<Resources, Failure> {
    let (limits, stopper) = (options.limit.limits()?, Stopper::default());
    let orders = Orders {
        time_limit: options.time_limit,
        limits,
        json: options.talk.json,
        piped: path == file::STANDARD,
        quiet: options.talk.level() == Level::Quiet,
    };
    sentinel::watch(orders, stopper.clone())?;
    Ok(Resources { base: base.map(Path::to_path_buf), limits, stopper, ..Resources::default() })
}

/// Settles the format and makes sure that every file can be written, before any work is done.
fn check(
    recipe: &mut Recipe,
    from: Option<RecipeFile<'_>>,
    path: &str,
    options: &RunOptions,
) -> Result<Vec<Plan>, Failure> {
    let piped = path == file::STANDARD;
    if recipe.inputs().iter().filter(|(_, input)| is_read_from_standard(input)).count() > 1 {
        return Err(Failure::usage("standard input can be read once; give files for the others"));
    }
    if piped && options.talk.json {
        return Err(Failure::usage("--json and -o - both write to standard output; give a file for one of them"));
    }
    if piped && options.variations.is_some() {
        return Err(Failure::usage("--variations writes several files; give -o a name"));
    }
    if piped || options.talk.json {
        standard::check().map_err(Failure::standard)?;
    }
    let by_name = if piped || options.format.is_some() { None } else { Format::of_path(path)? };
    let format = options.format.or(by_name).or(recipe.output.format).unwrap_or_else(|| recipe.usual_format());
    recipe.check_format(format)?;
    recipe.output.format = Some(format);
    recipe.output.bare |= options.no_recipe;
    let seeds: Vec<u64> = (0..u64::from(options.variations.unwrap_or(1)))
        .map(|k| recipe.seed.checked_add(k).ok_or_else(|| Failure::usage("the seed is too large")))
        .collect::<Result<_, _>>()?;
    let paths: Vec<String> = match options.variations {
        // An empty name is told as such.
        Some(count) if !path.is_empty() => (1..=u64::from(count)).map(|n| variation(path, n)).collect(),
        _ => vec![path.to_owned()],
    };
    let guard = guard(recipe, from, options.write);
    // Scenes as OBJ have their materials in a file beside it.
    let is_named = Format::of_path(path).ok().flatten() == Some(Format::Obj);
    let has_materials = format == Format::Obj && is_named && matches!(recipe.job, Job::Space(_));
    let beside = if has_materials { guard.companions(&paths, MATERIALS)? } else { Vec::new() };
    let mut beside = beside.into_iter();
    let targets = guard.targets(&paths)?;
    let plans = paths.into_iter().zip(seeds).zip(targets);
    Ok(plans.map(|((path, seed), target)| Plan { path, seed, target, beside: beside.next() }).collect())
}

fn is_read_from_standard(input: &Input) -> bool {
    input.content.is_none() && file::is_standard_input(&input.path)
}

/// What must not be written over.
fn guard(recipe: &Recipe, from: Option<RecipeFile<'_>>, options: WriteOptions) -> Guard {
    let resources = from.map_or_else(Resources::default, |from| Resources::beside(from.folder()));
    let guard = Guard::new(options).with_inputs(recipe, &resources);
    from.into_iter().fold(guard, |guard, from| guard.with_input("recipe", from.0))
}

/// `out.svg` as `out-3.svg`.
pub(crate) fn variation(path: &str, number: u64) -> String {
    let path = Path::new(path);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = match path.extension() {
        Some(extension) => format!("{stem}-{number}.{}", extension.to_string_lossy()),
        None => format!("{stem}-{number}"),
    };
    path.with_file_name(name).to_string_lossy().into_owned()
}

fn make_all(
    recipe: &Recipe,
    resources: &Resources,
    plans: Vec<Plan>,
    options: &RunOptions,
) -> Result<ExitCode, Failure> {
    let level = options.talk.level();
    let prepared = recipe.prepare(resources)?;
    if level == Level::Verbose {
        say::note(&prepared.understood());
    }
    let run = Run { prepared: &prepared, output: &recipe.output, threads: options.threads, level };
    let mut outputs = Vec::new();
    for plan in &plans {
        match run.make(plan) {
            // What is finished is told; of the last one there was nothing yet.
            Err(failure) if sentinel::is_over() && !outputs.is_empty() => {
                say::note(&format!("{}: {}", plan.path, failure.message()));
            }
            made => outputs.push(made?),
        }
        if sentinel::is_over() {
            break;
        }
    }
    if options.talk.json {
        summary::print(&Outputs { version: env!("CARGO_PKG_VERSION"), outputs })?;
    }
    Ok(sentinel::signal().map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// What all files of a command have in common.
struct Run<'a> {
    prepared: &'a Prepared,
    output: &'a OutputOptions,
    threads: Option<usize>,
    level: Level,
}

impl Run<'_> {
    /// Makes one file and writes it.
    fn make(&self, plan: &Plan) -> Result<Output, Failure> {
        sentinel::enter(Phase::Reading);
        let mut watch = Watch::new(self.level);
        let ran = self.run(plan, &mut watch);
        watch.finish();
        let (artwork, Encoded { bytes, mut warnings, companion }) = ran.map_err(stopped)?;
        sentinel::enter(Phase::Writing);
        let copy = plan.write(&bytes, companion.as_ref()).map_err(Failure::writing)?;
        sentinel::written();
        if artwork.stopped() == StopReason::Stopped && sentinel::signal().is_none() {
            let message = "the time was up before the pattern was finished: this is the best so far";
            warnings.push(Warning::new(message, "give it more time, or less to make"));
        }
        let made = self.describe(&artwork, plan, warnings, watch.elapsed());
        tell(&made, artwork.energy(), self.level);
        if let Some(copy) = copy.filter(|_| self.level > Level::Quiet) {
            say::note(&format!("{}: what was there before is kept as {}", plan.path, copy.display()));
        }
        Ok(made)
    }

    /// An artwork, and its file with what the user should know of both.
    fn run(&self, plan: &Plan, watch: &mut Watch) -> arabesque::Result<(Artwork, Encoded)> {
        let artwork = self.prepared.run(&self.prepared.request().with_seed(plan.seed), watch)?;
        let has_draft = artwork.has_draft(self.output);
        sentinel::enter(if has_draft { Phase::Drawing } else { Phase::Encoding });
        watch.finish();
        let path = Some(plan.path.clone()).filter(|_| plan.beside.is_some());
        let output = OutputOptions { path, ..self.output.clone() };
        let drawn = if has_draft { drawing::unless_asked(&artwork, &output, self.threads) } else { None };
        let encode = if has_draft && sentinel::signal().is_some() { Artwork::encode_draft } else { Artwork::encode };
        let mut encoded = match drawn.unwrap_or_else(|| encode(&artwork, &output)) {
            // Somebody asked to stop just when this was begun: it is wanted all the same. What was heard once is not heard again.
            Err(Error::Stopped { .. }) => encode(&artwork, &output)?,
            // What was made is not lost because its picture is too much work.
            Err(limit @ Error::Limit { .. }) if has_draft => artwork.encode_draft(&output).map_err(|_| limit)?,
            encoded => encoded?,
        };
        encoded.warnings.splice(0..0, artwork.warnings().iter().cloned());
        Ok((artwork, encoded))
    }

    fn describe(&self, artwork: &Artwork, plan: &Plan, warnings: Vec<Warning>, elapsed: Duration) -> Output {
        Output {
            path: plan.path.clone(),
            format: self.output.format.unwrap_or(Format::Svg).name(),
            seed: plan.seed,
            made: artwork.summary(),
            stopped: match artwork.stopped() {
                StopReason::Finished => "finished",
                StopReason::Limit => "limit",
                StopReason::Stopped if sentinel::signal().is_some() => "interrupted",
                StopReason::Stopped => "time limit",
            },
            seconds: elapsed.as_secs_f64(),
            work: artwork.work() / 1_000_000,
            memory: memory::peak(),
            warnings,
        }
    }
}

/// A failure, which a signal explains better.
fn stopped(error: Error) -> Failure {
    let late = sentinel::is_late() && matches!(error, Error::Stopped { .. });
    let failure = Failure::from(error);
    match sentinel::signal() {
        Some(code) => failure.with_code(code),
        None if late => failure.because("the time was up before there was anything to write; give it more time"),
        None => failure,
    }
}

fn tell(made: &Output, energy: &[EnergyPoint], level: Level) {
    if level == Level::Quiet {
        return;
    }
    if level == Level::Verbose {
        for e in energy {
            let (l, i) = (e.level + 1, e.iteration);
            say::note(&format!("level {l}, iteration {i}: energy {:.5}, {} elements", e.energy, e.elements));
        }
    }
    made.warnings.iter().for_each(say::warning);
    let stopped =
        if made.stopped == "finished" { String::new() } else { format!(", stopped early ({})", made.stopped) };
    let name = if made.path == file::STANDARD { "standard output" } else { &made.path };
    say::note(&format!("{name}: {} in {:.2} s{stopped}", counted(&made.made), made.seconds));
}

/// What was made, in words.
fn counted(made: &Summary) -> String {
    if let Some(r) = &made.ribbons {
        return format!("{} in {}", many(r.pieces, "piece"), many(r.ribbons, "ribbon"));
    }
    let kinds = [
        (made.points, "point"),
        (made.triangles, "triangle"),
        (made.areas, "area"),
        (made.curves, "curve"),
        (made.elements, "element"),
    ];
    let said: Vec<String> = kinds.iter().filter(|(n, _)| *n > 0).map(|&(n, what)| many(n, what)).collect();
    match said.as_slice() {
        [] => many(0, "element"),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn many(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variations_are_numbered_before_the_extension() {
        assert_eq!(variation("a/out.svg", 2), "a/out-2.svg");
        assert_eq!(variation("out", 10), "out-10");
    }
}
