//! `arabesque inspect`: what was understood of an exemplar.

use std::{io::Write, process::ExitCode};

use arabesque::{Format, Input, Report, core::rounded, inspect, io::file};
use clap::Args;

use super::telling::{ReadingOptions, TellOptions};
use crate::{
    failure::Failure,
    guard::Guard,
    process::{
        sentinel::{self, Phase},
        standard,
    },
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
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    tell: TellOptions,
}

impl Inspect {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        self.tell.end(self.inspect())
    }

    fn inspect(&self) -> Result<ExitCode, Failure> {
        let piped = self.output.as_deref().is_some_and(file::is_standard_output);
        let guard = Guard::new(self.tell.write).with_input("exemplar", &self.file);
        let target = self.output.as_deref().map(|path| target(path, &guard)).transpose()?;
        let resources = self.tell.resources(piped)?;
        let report = inspect(&Input::file(&self.file), self.reading.reading(), &resources)?;
        if let Some((target, format)) = target {
            let picture = report.picture(format, &resources.budget())?;
            sentinel::enter(Phase::Writing);
            self.tell.put(target, &picture)?;
        }
        if self.tell.talk.json {
            summary::print_with_memory(&report)?;
        } else if !piped {
            print(&report)?;
        }
        if self.tell.talk.level() > Level::Quiet {
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
    for told in &report.told {
        writeln!(out, "  {told}")?;
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
