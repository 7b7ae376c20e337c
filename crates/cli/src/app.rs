//! The command line as a whole.

use std::{ffi::OsString, process::ExitCode};

use clap::{CommandFactory, Parser, Subcommand};

use crate::{
    commands::{completions, edit, fill, inspect, man, measure, relief, ribbon, run, surface},
    failure::Failure,
};

/// From one small example of a repeating pattern, make as much of it as you want, in any shape.
#[derive(Debug, Parser)]
#[command(name = "arabesque", version, propagate_version = true, arg_required_else_help = true)]
#[command(
    after_help = "Exit codes: 0 done; 1 failure; 2 usage; 3 bad input; 4 no valid result under the given constraints; \
                        130, 143, 129 stopped by Ctrl-C, SIGTERM, SIGHUP (the best so far is written, where there is one)."
)]
pub(crate) struct App {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Fill a page, a shape or a seamless tile with the pattern of an exemplar
    Fill(Box<fill::Fill>),
    /// Lay the pattern of a picture along curves without bending it
    Ribbon(Box<ribbon::Ribbon>),
    /// Continue a relief: more of a scanned or modelled patch of surface detail
    Relief(Box<relief::Relief>),
    /// Make the surface of points
    Surface(Box<surface::Surface>),
    /// Say what was understood of an exemplar
    Inspect(inspect::Inspect),
    /// Say how good results are beside their exemplar: holes, clumps, overlaps, broken elements, copies
    Measure(measure::Measure),
    /// Change elements of a result, and all elements in places like theirs
    Edit(Box<edit::Edit>),
    /// Repeat a run from a recipe, or from any result that carries one
    Run(run::Run),
    /// Write the completion script of a shell
    Completions(completions::Completions),
    /// Write the manual page
    Man(man::Man),
}

impl App {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        match self.command {
            Command::Fill(c) => c.execute(),
            Command::Ribbon(c) => c.execute(),
            Command::Relief(c) => c.execute(),
            Command::Surface(c) => c.execute(),
            Command::Inspect(c) => c.execute(),
            Command::Measure(c) => c.execute(),
            Command::Edit(c) => c.execute(),
            Command::Run(c) => c.execute(),
            Command::Completions(c) => c.execute(Self::command()),
            Command::Man(c) => c.execute(Self::command()),
        }
    }
}

/// Whether a summary for machines is wanted on standard output, where no result goes.
pub(crate) fn asks_for_json(arguments: impl IntoIterator<Item = OsString>) -> bool {
    let arguments: Vec<OsString> = arguments.into_iter().take_while(|a| a != "--").collect();
    let is_piped = arguments.windows(2).any(|pair| (pair[0] == "-o" || pair[0] == "--output") && pair[1] == "-");
    arguments.iter().any(|a| a == "--json") && !is_piped && !arguments.iter().any(|a| a == "-o-" || a == "--output=-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_is_wanted_where_standard_output_is_free() {
        let asks = |text: &str| asks_for_json(text.split(' ').map(OsString::from));
        assert!(asks("arabesque fill a.svg --json -o b.svg"));
        assert!(!asks("arabesque fill a.svg --json -o -") && !asks("arabesque fill a.svg --json --output=-"));
        assert!(!asks("arabesque fill a.svg -o b.svg") && !asks("arabesque fill -- --json"));
    }

    #[test]
    fn the_command_line_is_consistent() {
        App::command().debug_assert();
    }
}
