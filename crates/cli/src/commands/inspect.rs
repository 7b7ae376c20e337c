//! `arabesque inspect`: what was understood of an exemplar.

use std::{io::Write, process::ExitCode};

use arabesque::{
    ExemplarTile, Format, Input, Limits, Method, Reading, Report, Resources, Stopper, core::rounded, inspect, io::file,
};
use clap::Args;

use super::fill::choice;
use crate::{
    failure::Failure,
    guard::{Guard, WriteOptions},
    limits::LimitOptions,
    process::{
        sentinel::{self, Orders, Phase},
        standard,
    },
    produce::TalkOptions,
    say::{self, Level},
    summary,
};

/// Say what was understood of an exemplar
#[derive(Args, Debug)]
pub(crate) struct Inspect {
    /// An SVG drawing, points as CSV, or curves in space as OBJ; - is standard input
    file: String,
    /// Draw it as well, SVG or PNG: outlines in the colours of their classes, curves in those of their styles, the frame, a cell of the repeat
    #[arg(short, long, value_name = "PICTURE")]
    output: Option<String>,
    /// What the exemplar is made of
    #[arg(long, value_name = "METHOD", default_value = Method::default().name(), value_parser = choice::<Method>())]
    method: Method,
    /// It is one period of the pattern: what an edge of it cuts goes on at the opposite edge
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "yes",
        default_value = ExemplarTile::default().name(), value_parser = choice::<ExemplarTile>())]
    exemplar_tile: ExemplarTile,
    #[command(flatten)]
    write: WriteOptions,
    #[command(flatten)]
    limit: LimitOptions,
    #[command(flatten)]
    talk: TalkOptions,
}

impl Inspect {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let result = self.inspect();
        if let Err(failure) = &result
            && self.talk.json
        {
            summary::print_failure(failure);
        }
        result
    }

    fn orders(&self, limits: Limits) -> Orders {
        Orders {
            time_limit: None,
            limits,
            json: self.talk.json,
            piped: self.output.as_deref().is_some_and(file::is_standard_output),
            quiet: self.talk.level() == Level::Quiet,
        }
    }

    fn inspect(&self) -> Result<ExitCode, Failure> {
        let (limits, stopper) = (self.limit.limits()?, Stopper::default());
        let guard = Guard::new(self.write).with_input("exemplar", &self.file);
        let target = self.output.as_deref().map(|path| target(path, &guard)).transpose()?;
        sentinel::watch(self.orders(limits), stopper.clone())?;
        let resources = Resources { limits, stopper, ..Resources::default() };
        let reading = Reading { method: self.method, exemplar_tile: self.exemplar_tile, ..Reading::default() };
        let report = inspect(&Input::file(&self.file), reading, &resources)?;
        if let Some((target, format)) = target {
            let picture = report.picture(format, &resources.budget())?;
            sentinel::enter(Phase::Writing);
            let copy = target.write(&picture).map_err(Failure::writing)?;
            if let Some(copy) = copy.filter(|_| self.talk.level() > Level::Quiet) {
                say::note(&format!("what was there before is kept as {}", copy.display()));
            }
        }
        if self.talk.json {
            summary::print(&report)?;
        } else if !self.output.as_deref().is_some_and(file::is_standard_output) {
            print(&report)?;
        }
        if self.talk.level() > Level::Quiet {
            report.warnings.iter().for_each(|w| say::note(&format!("warning: {}; {}", w.message, w.advice)));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn target(path: &str, guard: &Guard) -> Result<(file::Target, Format), Failure> {
    let format = match Format::of_path(path)? {
        None | Some(Format::Svg) => Format::Svg,
        Some(Format::Png) => Format::Png,
        Some(_) => return Err(Failure::usage(format!("{path}: a picture is written as .svg or .png"))),
    };
    Ok((guard.target(path)?, format))
}

fn print(report: &Report) -> Result<(), Failure> {
    let mut out = standard::output()?;
    let join = |v: &[f64]| {
        v.iter()
            .map(|x| format!("{x:.6}").trim_end_matches('0').trim_end_matches('.').to_owned())
            .collect::<Vec<_>>()
            .join(" x ")
    };
    let unit = report
        .unit
        .zip(report.unit_per_user)
        .map_or_else(String::new, |(unit, n)| format!(" (1 unit = {} {unit})", rounded(n)));
    writeln!(out, "{}: {}", report.file, report.kind)?;
    writeln!(out, "  frame: {}{unit}", join(&report.frame_size))?;
    if report.elements > 0 || report.curves + report.areas == 0 {
        writeln!(out, "  elements: {}, of these {} cut at the frame", report.elements, report.cut_at_frame)?;
    }
    if report.curves > 0 {
        let junctions = report.junctions.map(|n| format!(", {n} junctions")).unwrap_or_default();
        writeln!(out, "  curves: {}{junctions}", report.curves)?;
    }
    if report.areas > 0 {
        writeln!(out, "  areas: {}", report.areas)?;
    }
    if report.elements + report.curves > 0 {
        // Areas have no distances of their own, and no neighbourhoods.
        let (spacing, radius) = (rounded(report.spacing), rounded(report.suggested_radius));
        writeln!(out, "  spacing: {spacing}; suggested radius: {radius}")?;
    }
    if let Some(repeat) = &report.repeat {
        for line in repeat.lines() {
            writeln!(out, "  {line}")?;
        }
    }
    if !report.layers.is_empty() {
        writeln!(out, "  a whole job, with the layers {}", report.layers.join(", "))?;
    }
    for class in &report.classes {
        let diameter =
            if class.diameter > 0.0 { format!(", diameter {}", rounded(class.diameter)) } else { String::new() };
        let s = if class.elements == 1 { "" } else { "s" };
        writeln!(out, "  {}: {} element{s}{diameter}", called("class", &class.name), class.elements)?;
    }
    for style in &report.styles {
        writeln!(
            out,
            "  {}: {} curve{} ({} closed), {} end{} inside the frame, length {}, width {}",
            called("style", &style.name),
            style.curves,
            if style.curves == 1 { "" } else { "s" },
            style.closed,
            style.ends,
            if style.ends == 1 { "" } else { "s" },
            rounded(style.length),
            rounded(style.width)
        )?;
    }
    for known in &report.understood {
        writeln!(out, "  {known}")?;
    }
    out.flush()?;
    Ok(())
}

/// A name with the word for what it names, which nameless ones have already.
fn called(word: &str, name: &str) -> String {
    if name.starts_with(word) { name.to_owned() } else { format!("{word} {name}") }
}
