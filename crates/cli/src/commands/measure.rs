//! `arabesque measure`: how good results are beside their exemplar.

use std::{io::Write, process::ExitCode};

use arabesque::{Format, Input, MeasureOptions, Measurements, in_pool, io::file, measure};
use clap::Args;

use super::telling::{ReadingOptions, TellOptions};
use crate::{
    failure::Failure,
    guard::Guard,
    process::{
        sentinel::{self, Phase},
        standard,
    },
    produce::variation,
    say::Level,
    summary,
};

/// Say how good results are beside their exemplar
///
/// Every figure is told beside that of the exemplar and the range that is natural, as parts of the exemplar differ: good is within it,
/// watch within twice of it, bad beyond. A result may be anybody's; one of arabesque says by its recipe which shape it fills, and whether
/// the pattern was turned or scaled.
#[derive(Args, Debug)]
pub(crate) struct Measure {
    /// The exemplar: an SVG drawing, points as CSV, or curves in space as OBJ; - is standard input
    exemplar: String,
    /// Results of it, of the same kind
    #[arg(required = true, value_name = "RESULT")]
    results: Vec<String>,
    /// Draw the result in pale with the worst places marked and numbered, SVG; of several results OUT gets -1, -2, ... before its extension
    #[arg(short, long, value_name = "OUT.svg")]
    output: Option<String>,
    /// The shape that the results fill, where it is not the page: FILE.svg or FILE.svg#id
    #[arg(long, value_name = "SHAPE.svg[#ID]")]
    domain: Option<String>,
    /// Leave directions out, because the pattern was turned on purpose
    #[arg(long)]
    any_direction: bool,
    /// Leave sizes out, because the pattern was scaled on purpose
    #[arg(long)]
    any_size: bool,
    #[command(flatten)]
    reading: ReadingOptions,
    /// Number of threads; the report does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    #[command(flatten)]
    tell: TellOptions,
}

impl Measure {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        self.tell.end(self.measure())
    }

    fn is_piped(&self) -> bool {
        self.output.as_deref().is_some_and(file::is_standard_output)
    }

    /// Where pictures go, one for each result.
    fn targets(&self) -> Result<Vec<file::Target>, Failure> {
        let Some(path) = &self.output else { return Ok(Vec::new()) };
        if self.is_piped() && self.tell.talk.json {
            return Err(Failure::usage("--json and -o - both write to standard output; give a file for one of them"));
        }
        if self.is_piped() && self.results.len() > 1 {
            return Err(Failure::usage("-o - takes the picture of one result; give -o a name"));
        }
        if !matches!(Format::of_path(path)?, None | Some(Format::Svg)) {
            return Err(Failure::usage(format!("{path}: the picture of a report is written as .svg")));
        }
        let read = self.results.iter().map(|path| ("result", path.as_str()));
        let shape = self.domain.as_deref().map(Input::shape);
        let all = std::iter::once(("exemplar", self.exemplar.as_str())).chain(read);
        let guard = all.fold(Guard::new(self.tell.write), |guard, (role, path)| guard.with_input(role, path));
        let guard = shape.iter().fold(guard, |guard, shape| guard.with_input("--domain", &shape.path));
        let paths: Vec<String> = match self.results.len() {
            1 => vec![path.clone()],
            count => (1..=count as u64).map(|n| variation(path, n)).collect(),
        };
        guard.targets(&paths)
    }

    fn measure(&self) -> Result<ExitCode, Failure> {
        let streams = self.results.iter().chain([&self.exemplar]).filter(|path| file::is_standard_input(path)).count();
        if streams > 1 {
            return Err(Failure::usage("standard input can be read once; give files for the others"));
        }
        let targets = self.targets()?;
        let resources = self.tell.resources(self.is_piped())?;
        let options = MeasureOptions {
            reading: self.reading.reading(),
            domain: self.domain.as_deref().map(Input::shape),
            any_direction: self.any_direction,
            any_size: self.any_size,
        };
        let results: Vec<Input> = self.results.iter().map(Input::file).collect();
        let told = in_pool(self.threads, || measure(&Input::file(&self.exemplar), &results, &options, &resources))??;
        let pictures: Vec<Vec<u8>> =
            told.reports.iter().take(targets.len()).map(|report| report.picture()).collect::<Result<_, _>>()?;
        sentinel::enter(Phase::Writing);
        for (target, picture) in targets.into_iter().zip(pictures) {
            self.tell.put(target, &picture)?;
        }
        if self.tell.talk.json {
            summary::print_with_memory(&told)?;
        } else if !self.is_piped() {
            print(&told, self.tell.talk.level() == Level::Verbose)?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn print(told: &Measurements, with_all: bool) -> Result<(), Failure> {
    let mut out = standard::output()?;
    for line in told.reports.iter().flat_map(|report| report.lines(with_all)) {
        writeln!(out, "{line}")?;
    }
    out.flush()?;
    Ok(())
}
