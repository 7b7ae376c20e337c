//! The program `arabesque`: one file a subcommand, everything else in the library.

mod app;
mod commands;
mod control;
mod duration;
mod failure;
mod produce;
mod progress;
mod say;
mod summary;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let app = app::App::parse();
    match app.execute() {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}
