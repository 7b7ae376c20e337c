//! `arabesque edit`: elements of a result changed, and all that are in places like theirs.

use std::{io::Write, process::ExitCode, time::Instant};

use arabesque::{
    Change, Edit as Edits, EditSession, Format, Input, Insertion, PlacedItem, Proposal, core::rounded, io::file,
};
use clap::Args;
use serde::Serialize;

use super::telling::TellOptions;
use crate::{
    failure::Failure,
    guard::Guard,
    pair::pair,
    process::{
        sentinel::{self, Phase},
        standard,
    },
    say::{self, Level},
    summary,
};

/// Neighbourhoods no more unlike than this are similar, in mean spacings.
const SIMILAR: &str = "0.15";

/// Change elements of a result, and all elements in places like theirs
#[derive(Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Edit {
    /// A result of arabesque with elements: SVG, JSON, CSV, GLB or glTF; - is standard input
    result: String,
    /// Where to write, in the format of the result; an SVG result also as PNG
    #[arg(short, long, value_name = "OUT")]
    output: Option<String>,
    /// List the elements with their numbers, classes and places
    #[arg(long)]
    list: bool,
    /// Tell what would change, and write the result with that marked (SVG and PNG), where -o says to
    #[arg(long)]
    preview: bool,
    #[command(flatten, next_help_heading = "Which elements")]
    which: Which,
    #[command(flatten, next_help_heading = "What changes")]
    what: What,
    #[command(flatten)]
    tell: TellOptions,
}

/// Which elements are changed.
#[derive(Args, Debug)]
struct Which {
    /// Number of an element, as --list and the ids of an SVG result have it: 17 or arabesque-17; may be given several times
    #[arg(long, value_name = "ID")]
    item: Vec<String>,
    /// The element whose centre is nearest to this place; may be given several times
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = place)]
    at: Vec<Place>,
    /// Change all elements whose neighbourhood is no more unlike than this, in mean spacings, each in its own frame
    #[arg(long, value_name = "THRESHOLD", num_args = 0..=1, require_equals = true, default_missing_value = SIMILAR)]
    propagate: Option<f64>,
    /// With --propagate: radius of the neighbourhoods, in mean spacings [default: between the second and the third ring of neighbours]
    #[arg(long, value_name = "R", requires = "propagate")]
    radius: Option<f64>,
    /// With --propagate: elements of all classes may be alike, so that only places count
    #[arg(long, requires = "propagate")]
    any_class: bool,
}

/// What changes about them.
#[derive(Args, Debug)]
struct What {
    /// Move them, in the units of the page
    #[arg(long = "move", value_name = "DX,DY[,DZ]", allow_hyphen_values = true, value_parser = place)]
    shift: Option<Place>,
    /// Turn them about their centres, clockwise on the page
    #[arg(long, value_name = "DEGREES")]
    turn: Option<f64>,
    /// With --turn in space: about this axis [default: 0,1,0, which is up]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = place, requires = "turn")]
    axis: Option<Place>,
    /// Scale them about their centres
    #[arg(long, value_name = "FACTOR")]
    scale: Option<f64>,
    /// Make them elements of another class: copies of the nearest one of it
    #[arg(long, value_name = "CLASS")]
    class: Option<String>,
    /// Paint them: fill=#c0392b, stroke=none, stroke-width=2, opacity=0.5, fill-opacity=.., stroke-opacity=..; may be given several times
    #[arg(long, value_name = "PROPERTY=VALUE", value_parser = pair)]
    set: Vec<(String, String)>,
    /// Delete them
    #[arg(long, conflicts_with_all = ["shift", "turn", "scale", "class", "set", "insert"])]
    delete: bool,
    /// Insert an element, a copy of the nearest one of its class; may be given several times
    #[arg(long, value_name = "CLASS@X,Y[,Z]", value_parser = insertion, conflicts_with_all = ["shift", "turn", "scale", "class", "set"])]
    insert: Vec<Insertion>,
}

/// Coordinates that were given in one word.
#[derive(Clone, Debug)]
struct Place(Vec<f64>);

fn place(text: &str) -> Result<Place, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse::<f64>()).collect();
    match numbers {
        Ok(list) if (2..=3).contains(&list.len()) && list.iter().all(|v| v.is_finite()) => Ok(Place(list)),
        _ => Err("expected two or three numbers with commas between them, such as 3,-1.5".into()),
    }
}

fn insertion(text: &str) -> Result<Insertion, String> {
    let (class, at) = text.rsplit_once('@').ok_or("expected a class and a place, such as leaf@12,30")?;
    Ok(Insertion { class: class.to_owned(), at: place(at)?.0 })
}

/// What is told to machines.
#[derive(Serialize)]
struct Told<'a> {
    version: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<&'a str>,
    format: &'static str,
    /// Elements that there are.
    elements: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    items: Option<&'a [PlacedItem]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    changed: Option<&'a [Change]>,
    seconds: f64,
    /// Millions of units of work.
    work: u64,
}

impl Edit {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        self.tell.end(self.edit())
    }

    fn edit(&self) -> Result<ExitCode, Failure> {
        let start = Instant::now();
        let piped = self.output.as_deref().is_some_and(file::is_standard_output);
        if piped && self.tell.talk.json {
            return Err(Failure::usage("--json and -o - both write to standard output; give a file for one of them"));
        }
        if self.output.is_none() && !self.list && !self.preview {
            return Err(Failure::usage(
                "nothing says where to write; give -o OUT, or --preview to be told what would change",
            ));
        }
        let guard = Guard::new(self.tell.write).with_input("result", &self.result);
        let target = self.output.as_deref().map(|path| guard.target(path)).transpose()?;
        let format = self.output.as_deref().filter(|_| !piped).map(Format::of_path).transpose()?.flatten();
        let resources = self.tell.resources(piped)?;
        let input = Input::file(&self.result);
        let bytes = resources.read_as("result", &input)?;
        let mut session = EditSession::open(input.name(), bytes.to_vec(), &resources)?;
        if self.list {
            return self.listed(&session, start);
        }
        let proposal = session.propose(&self.edits(&session)?)?;
        let written = match (&target, self.preview) {
            (None, _) => None,
            (Some(_), true) => Some(session.preview(&proposal, format)?),
            (Some(_), false) => {
                session.apply(&proposal)?;
                Some(session.encode(format)?)
            }
        };
        if let Some((target, bytes)) = target.zip(written) {
            sentinel::enter(Phase::Writing);
            self.tell.put(target, &bytes)?;
        }
        self.told(&session, &proposal, start, piped)?;
        Ok(ExitCode::SUCCESS)
    }

    /// The edit that the options ask for.
    fn edits(&self, session: &EditSession) -> Result<Edits, Failure> {
        let mut items = Vec::new();
        for text in &self.which.item {
            let number = text.parse().ok().or_else(|| number_in(text));
            items.push(number.ok_or_else(|| {
                Failure::usage(format!("--item {text}: expected the number of an element, such as 17 or arabesque-17"))
            })?);
        }
        let anchors = self.which.at.iter().map(|place| ("--at", &place.0));
        let is_free = self.which.propagate.is_some() && items.is_empty() && self.which.at.is_empty();
        let inserted = self.what.insert.iter().filter(|_| is_free).map(|insertion| ("--insert", &insertion.at));
        for (option, at) in anchors.chain(inserted) {
            items.push(session.nearest(at).ok_or_else(|| {
                Failure::usage(format!(
                    "{option}: {} numbers, where the result has {} dimensions",
                    at.len(),
                    session.dimension()
                ))
            })?);
        }
        let set = self.what.set.iter().map(|(property, value)| (property.trim().to_owned(), value.trim().to_owned()));
        Ok(Edits {
            shift: self.what.shift.as_ref().map(|place| place.0.clone()).unwrap_or_default(),
            turn: self.what.turn,
            axis: self.what.axis.as_ref().map(axis).transpose()?,
            scale: self.what.scale,
            class: self.what.class.clone(),
            set: set.collect(),
            delete: self.what.delete,
            insert: self.what.insert.clone(),
            propagate: self.which.propagate,
            radius: self.which.radius,
            any_class: self.which.any_class,
            ..Edits::of_items(items)
        })
    }

    /// Tells the elements.
    fn listed(&self, session: &EditSession, start: Instant) -> Result<ExitCode, Failure> {
        let items = session.items();
        if self.tell.talk.json {
            let told = Told { items: Some(&items), ..self.head(session, start) };
            summary::print_with_memory(&told)?;
            return Ok(ExitCode::SUCCESS);
        }
        let mut out = standard::output()?;
        writeln!(out, "{}: {} elements", self.result, items.len())?;
        for item in &items {
            let angle = item.angle.filter(|a| a.abs() > 1e-6).map(|a| format!(", turned {}", rounded(a)));
            let scale = Some(item.scale).filter(|s| (s - 1.0).abs() > 1e-6).map(|s| format!(", scale {}", rounded(s)));
            let more = angle.into_iter().chain(scale).chain(item.kept.then(|| ", kept".to_owned())).collect::<String>();
            writeln!(out, "  {}: {} at {}{more}", item.id, item.class, coordinates(&item.centre))?;
        }
        out.flush()?;
        Ok(ExitCode::SUCCESS)
    }

    /// Tells what changed, or would change.
    fn told(&self, session: &EditSession, proposal: &Proposal, start: Instant, piped: bool) -> Result<(), Failure> {
        let level = self.tell.talk.level();
        if self.tell.talk.json {
            let told = Told { changed: Some(&proposal.changed), ..self.head(session, start) };
            return summary::print_with_memory(&told);
        }
        if self.preview && !piped && level > Level::Quiet {
            let mut out = standard::output()?;
            for change in &proposal.changed {
                writeln!(out, "  {}", line(change))?;
            }
            out.flush()?;
        }
        if level > Level::Quiet {
            let (count, all) = (proposal.changed.len(), session.items().len());
            let verb = match (self.preview, count) {
                (true, _) => "would be",
                (false, 1) => "was",
                (false, _) => "were",
            };
            let did = if self.what.delete {
                "deleted"
            } else if self.what.insert.is_empty() {
                "changed"
            } else {
                "inserted"
            };
            let s = if count == 1 { "" } else { "s" };
            let path = self.output.as_deref().filter(|_| !piped).unwrap_or(&self.result);
            say::note(&format!("{path}: {count} element{s} {verb} {did}; there are {all}"));
        }
        Ok(())
    }

    fn head(&self, session: &EditSession, start: Instant) -> Told<'_> {
        Told {
            version: env!("CARGO_PKG_VERSION"),
            path: self.output.as_deref(),
            format: session.format().name(),
            elements: session.items().len(),
            items: None,
            changed: None,
            seconds: start.elapsed().as_secs_f64(),
            work: session.work(),
        }
    }
}

/// The number of an element in its id: 17 in arabesque-17 and in arabesque2-17-1.
fn number_in(id: &str) -> Option<usize> {
    let (prefix, rest) = id.split_once('-')?;
    let is_ours = prefix.trim_end_matches(|c: char| c.is_ascii_digit()) == "arabesque";
    rest.split('-').next().filter(|_| is_ours)?.parse().ok()
}

fn axis(place: &Place) -> Result<[f64; 3], Failure> {
    place.0.clone().try_into().map_err(|_| Failure::usage("--axis: expected three numbers, such as 0,1,0"))
}

/// A change, in words.
fn line(change: &Change) -> String {
    let Change { id, class, from, to, distance, .. } = change;
    let unlike = if *distance > 0.0 { format!(", unlike by {}", rounded(*distance)) } else { String::new() };
    match (from, to) {
        (Some(from), Some(to)) if from == to => format!("{id}: {class} at {}{unlike}", coordinates(from)),
        (Some(from), Some(to)) => format!("{id}: {class} from {} to {}{unlike}", coordinates(from), coordinates(to)),
        (Some(from), None) => format!("{id}: {class} at {} goes{unlike}", coordinates(from)),
        (None, to) => format!("{id}: {class} comes at {}{unlike}", coordinates(to.as_deref().unwrap_or_default())),
    }
}

fn coordinates(place: &[f64]) -> String {
    place.iter().map(|v| rounded(*v)).collect::<Vec<_>>().join(", ")
}
