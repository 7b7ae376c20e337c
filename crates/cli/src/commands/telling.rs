//! What commands have in common that tell of files and may draw: options, orders, and how a picture is written.

use std::process::ExitCode;

use arabesque::{ExemplarTile, Method, Reading, Resources, Stopper, io::file};
use clap::Args;

use super::fill::choice;
use crate::{
    failure::Failure,
    guard::WriteOptions,
    limits::LimitOptions,
    process::sentinel::{self, Orders},
    produce::TalkOptions,
    say::{self, Level},
    summary,
};

/// What an exemplar is taken for.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ReadingOptions {
    /// What the exemplar is made of
    #[arg(long, value_name = "METHOD", default_value = Method::default().name(), value_parser = choice::<Method>())]
    method: Method,
    /// The exemplar is one period of the pattern: what an edge of it cuts goes on at the opposite edge
    #[arg(long, value_name = "WHETHER", num_args = 0..=1, require_equals = true, default_missing_value = "yes",
        default_value = ExemplarTile::default().name(), value_parser = choice::<ExemplarTile>())]
    exemplar_tile: ExemplarTile,
}

impl ReadingOptions {
    pub(crate) fn reading(self) -> Reading {
        Reading { method: self.method, exemplar_tile: self.exemplar_tile, ..Reading::default() }
    }
}

/// How much may be used up, what may be written over, and how much is said.
#[derive(Args, Debug)]
pub(crate) struct TellOptions {
    #[command(flatten)]
    pub(crate) write: WriteOptions,
    #[command(flatten)]
    limit: LimitOptions,
    #[command(flatten)]
    pub(crate) talk: TalkOptions,
}

impl TellOptions {
    /// What the command came to; a failure is told to machines too, where they asked.
    pub(crate) fn end(&self, result: Result<ExitCode, Failure>) -> Result<ExitCode, Failure> {
        if let Err(failure) = &result
            && self.talk.json
        {
            summary::print_failure(failure);
        }
        result
    }

    /// What there is to read from, `piped` when a picture goes to standard output; from here on the program can be stopped.
    pub(crate) fn resources(&self, piped: bool) -> Result<Resources, Failure> {
        let (limits, stopper) = (self.limit.limits()?, Stopper::default());
        let orders =
            Orders { time_limit: None, limits, json: self.talk.json, piped, quiet: self.talk.level() == Level::Quiet };
        sentinel::watch(orders, stopper.clone())?;
        Ok(Resources { limits, stopper, ..Resources::default() })
    }

    /// Writes a picture.
    pub(crate) fn put(&self, target: file::Target, picture: &[u8]) -> Result<(), Failure> {
        let copy = target.write(picture).map_err(Failure::writing)?;
        if let Some(copy) = copy.filter(|_| self.talk.level() > Level::Quiet) {
            say::note(&format!("what was there before is kept as {}", copy.display()));
        }
        Ok(())
    }
}
