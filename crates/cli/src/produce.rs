//! From a recipe to files: what `fill` and `run` have in common.

use std::{collections::BTreeMap, path::Path, process::ExitCode, time::Duration};

use arabesque::{
    Encoded, EnergyPoint, Format, Outcome, OutputOptions, Prepared, Recipe, RibbonArtwork, RibbonPrepared,
    SpacePrepared, StopReason, Warning, in_pool, io::file,
};
use clap::Args;

use crate::{
    control::{self, Deadline, is_interrupted},
    duration,
    failure::{Failure, INTERRUPTED},
    progress::Watch,
    say::{self, Level},
    summary::{self, Message, Output, Ribbons, Summary},
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
    /// Stop each run after this time and write the best so far: seconds, or 1m30s
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) time_limit: Option<Duration>,
    /// File format, where the extension of OUT does not say: svg, png, json, csv, obj, glb or toml (the recipe alone)
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<Format>,
    /// Leave the recipe out of the result, which then cannot be repeated by `arabesque run`
    #[arg(long)]
    pub(crate) no_recipe: bool,
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
}

/// Runs `recipe`, whose files lie beside `base`, and writes the result to `path`.
pub(crate) fn produce(
    mut recipe: Recipe,
    base: Option<&Path>,
    path: &str,
    options: &RunOptions,
) -> Result<ExitCode, Failure> {
    let result = check(&mut recipe, path, options).and_then(|plans| {
        control::listen();
        in_pool(options.threads, || make_all(&recipe, base, plans, options))?
    });
    match &result {
        Err(failure) if options.talk.json && path != file::STANDARD => summary::print_failure(failure),
        _ => {}
    }
    result
}

/// Settles the format and makes sure that every file can be written, before any work is done.
fn check(recipe: &mut Recipe, path: &str, options: &RunOptions) -> Result<Vec<Plan>, Failure> {
    let standard = path == file::STANDARD;
    if standard && options.talk.json {
        return Err(Failure::usage("--json and -o - both write to standard output; give a file for one of them"));
    }
    if standard && options.variations.is_some() {
        return Err(Failure::usage("--variations writes several files; give -o a name"));
    }
    let by_name = if standard || options.format.is_some() { None } else { Format::of_path(path)? };
    let format = options.format.or(by_name).or(recipe.output.format).unwrap_or_else(|| recipe.usual_format());
    recipe.output.format = Some(format);
    recipe.output.bare |= options.no_recipe;
    let numbered = |n: u64| match options.variations {
        Some(_) => variation(path, n),
        None => path.to_owned(),
    };
    let count = u64::from(options.variations.unwrap_or(1));
    (0..count)
        .map(|k| {
            let path = numbered(k + 1);
            let target = file::Target::new(&path).map_err(Failure::writing)?;
            let seed = recipe.seed.checked_add(k).ok_or_else(|| Failure::usage("the seed is too large"))?;
            Ok(Plan { path, seed, target })
        })
        .collect()
}

/// `out.svg` as `out-3.svg`.
fn variation(path: &str, number: u64) -> String {
    let path = Path::new(path);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = match path.extension() {
        Some(extension) => format!("{stem}-{number}.{}", extension.to_string_lossy()),
        None => format!("{stem}-{number}"),
    };
    path.with_file_name(name).to_string_lossy().into_owned()
}

fn make_all(recipe: &Recipe, base: Option<&Path>, plans: Vec<Plan>, options: &RunOptions) -> Result<ExitCode, Failure> {
    let level = options.talk.level();
    let ready = Ready::new(recipe, base)?;
    if level == Level::Verbose {
        say::note(&ready.exemplar());
    }
    let mut outputs = Vec::new();
    for plan in &plans {
        outputs.push(make(&ready, plan, &recipe.output, (level, options.time_limit))?);
        if is_interrupted() {
            break;
        }
    }
    if options.talk.json {
        summary::print(&Summary { version: env!("CARGO_PKG_VERSION"), outputs })?;
    }
    Ok(if is_interrupted() { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

/// A prepared run, in the plane, in space, or along curves.
enum Ready {
    Plane(Box<Prepared>),
    Space(Box<SpacePrepared>),
    Ribbon(Box<RibbonPrepared>),
}

impl Ready {
    fn new(recipe: &Recipe, base: Option<&Path>) -> Result<Self, Failure> {
        Ok(if recipe.is_ribbon() {
            Self::Ribbon(Box::new(recipe.prepare_ribbon(base)?))
        } else if recipe.is_space() {
            Self::Space(Box::new(recipe.prepare_space(base)?))
        } else {
            Self::Plane(Box::new(recipe.prepare(base)?))
        })
    }

    /// What was understood of the exemplar, in words.
    fn exemplar(&self) -> String {
        let ((elements, classes), (curves, styles)) = match self {
            Self::Plane(p) => (p.exemplar_size(), p.exemplar_curves()),
            Self::Space(p) => (p.exemplar_size(), p.exemplar_curves()),
            Self::Ribbon(p) => {
                let sizes: Vec<_> = p.exemplar_sizes().iter().map(|(w, h)| format!("{w} x {h} pixels")).collect();
                return format!("exemplar: {}, along {}", sizes.join(", then "), many(p.curves(), "curve"));
            }
        };
        let of_curves = if curves > 0 { format!(", {curves} curves in {styles} styles") } else { String::new() };
        format!("exemplar: {elements} elements in {classes} classes{of_curves}")
    }

    fn run(&self, seed: u64, output: &OutputOptions, watch: &mut Watch) -> Result<Ran, arabesque::Error> {
        match self {
            Self::Plane(prepared) => {
                let artwork = prepared.run(seed, watch)?;
                watch.finish();
                Ok(Ran::new(&artwork.outcome, artwork.classes(), artwork.styles(), artwork.encode(output)?))
            }
            Self::Space(prepared) => {
                let artwork = prepared.run(seed, watch)?;
                watch.finish();
                Ok(Ran::new(&artwork.outcome, artwork.classes(), artwork.styles(), artwork.encode(output)?))
            }
            Self::Ribbon(prepared) => {
                let artwork = prepared.run(seed, watch)?;
                watch.finish();
                Ok(Ran::ribbon(&artwork, artwork.encode(output)?))
            }
        }
    }
}

/// A finished run and its file.
struct Ran {
    bytes: Vec<u8>,
    elements: usize,
    classes: BTreeMap<String, usize>,
    curves: usize,
    styles: BTreeMap<String, usize>,
    /// Ribbons, their pieces and their cost.
    ribbons: Option<Ribbons>,
    energy: Vec<EnergyPoint>,
    stopped: StopReason,
    warnings: Vec<Warning>,
}

impl Ran {
    fn new<'a, const D: usize>(
        outcome: &Outcome<D>,
        classes: impl Iterator<Item = &'a str>,
        styles: impl Iterator<Item = &'a str>,
        encoded: Encoded,
    ) -> Self {
        Self {
            bytes: encoded.bytes,
            elements: outcome.placements.len(),
            classes: counts(classes),
            curves: outcome.curves.len(),
            styles: counts(styles),
            ribbons: None,
            energy: outcome.energy.clone(),
            stopped: outcome.stopped,
            warnings: outcome.warnings.iter().cloned().chain(encoded.warnings).collect(),
        }
    }

    fn ribbon(artwork: &RibbonArtwork<'_>, encoded: Encoded) -> Self {
        Self {
            bytes: encoded.bytes,
            elements: 0,
            classes: BTreeMap::new(),
            curves: 0,
            styles: BTreeMap::new(),
            ribbons: Some(Ribbons { ribbons: artwork.ribbons(), pieces: artwork.pieces(), cost: artwork.cost() }),
            energy: Vec::new(),
            stopped: artwork.stopped,
            warnings: artwork.warnings.iter().cloned().chain(encoded.warnings).collect(),
        }
    }
}

fn counts<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name.to_owned()).or_insert(0) += 1;
    }
    counts
}

fn make(
    ready: &Ready,
    plan: &Plan,
    output: &OutputOptions,
    (level, time_limit): (Level, Option<Duration>),
) -> Result<Output, Failure> {
    let mut watch = Watch::new(level, Deadline::after(time_limit));
    let ran = ready.run(plan.seed, output, &mut watch);
    watch.finish();
    let interrupted = |failure: Failure| if is_interrupted() { failure.with_code(INTERRUPTED) } else { failure };
    let ran = ran.map_err(|e| interrupted(e.into()))?;
    plan.target.write(&ran.bytes).map_err(Failure::writing)?;
    let (energy, warnings) = (ran.energy.clone(), ran.warnings.clone());
    let made = describe(ran, plan, output, watch.elapsed());
    tell(&made, &energy, &warnings, level);
    Ok(made)
}

fn describe(ran: Ran, plan: &Plan, output: &OutputOptions, elapsed: Duration) -> Output {
    Output {
        path: plan.path.clone(),
        format: output.format.unwrap_or(Format::Svg).name(),
        seed: plan.seed,
        elements: ran.elements,
        classes: ran.classes,
        curves: ran.curves,
        styles: ran.styles,
        ribbons: ran.ribbons,
        energy: ran.energy.last().map(|e| e.energy),
        stopped: match ran.stopped {
            StopReason::Finished => "finished",
            StopReason::Stopped if is_interrupted() => "interrupted",
            StopReason::Stopped => "time limit",
        },
        seconds: elapsed.as_secs_f64(),
        warnings: ran.warnings.iter().map(Message::from).collect(),
    }
}

fn tell(made: &Output, energy: &[EnergyPoint], warnings: &[Warning], level: Level) {
    if level == Level::Quiet {
        return;
    }
    if level == Level::Verbose {
        for e in energy {
            let (l, i) = (e.level + 1, e.iteration);
            say::note(&format!("level {l}, iteration {i}: energy {:.5}, {} elements", e.energy, e.elements));
        }
    }
    warnings.iter().for_each(say::warning);
    let stopped =
        if made.stopped == "finished" { String::new() } else { format!(", stopped early ({})", made.stopped) };
    let name = if made.path == file::STANDARD { "standard output" } else { &made.path };
    say::note(&format!("{name}: {} in {:.2} s{stopped}", counted(made), made.seconds));
}

/// What was made, in words.
fn counted(made: &Output) -> String {
    if let Some(r) = &made.ribbons {
        return format!("{} in {}", many(r.pieces, "piece"), many(r.ribbons, "ribbon"));
    }
    match (made.curves, made.elements) {
        (0, n) => format!("{n} elements"),
        (n, 0) => many(n, "curve"),
        (c, e) => format!("{} and {}", many(c, "curve"), many(e, "element")),
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
