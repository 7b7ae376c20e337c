//! The program `arabesque`: one file a subcommand, everything else in the library.

mod app;
mod commands;
mod drawing;
mod duration;
mod failure;
mod guard;
mod limits;
mod pair;
mod process;
mod produce;
mod progress;
mod say;
mod summary;

use std::{io::Write, process::ExitCode};

use clap::{Parser, error::ErrorKind};

use failure::{Failure, USAGE};

#[global_allocator]
static ALLOCATOR: process::memory::Counting = process::memory::Counting;

fn main() -> ExitCode {
    process::sentinel::began();
    let wanted = app::asks_for_json(std::env::args_os());
    let app = match app::App::try_parse() {
        Ok(app) => app,
        Err(error) => return refuse(&error, wanted),
    };
    match app.execute() {
        Ok(code) => code,
        Err(failure) => {
            if wanted && !summary::is_told() {
                summary::print_failure(&failure);
            }
            failure.report()
        }
    }
}

/// Ends the program with help, or with what is wrong in the options: for a machine too, where it asked for that.
fn refuse(error: &clap::Error, wanted: bool) -> ExitCode {
    let is_help = matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    );
    if wanted && !is_help {
        let text = error.to_string();
        let message = text.lines().take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        summary::print_failure(&Failure::with(USAGE, message.trim_start_matches("error: ")));
    }
    match error.print().and_then(|()| std::io::stdout().flush()) {
        Ok(()) => ExitCode::from(if error.use_stderr() { USAGE } else { 0 }),
        Err(error) => Failure::from(error).report(),
    }
}
