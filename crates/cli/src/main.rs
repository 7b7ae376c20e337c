//! The program `arabesque`: one file a subcommand, everything else in the library.

mod app;
mod commands;
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

use std::process::ExitCode;

use clap::Parser;

#[global_allocator]
static ALLOCATOR: process::memory::Counting = process::memory::Counting;

fn main() -> ExitCode {
    process::sentinel::began();
    let app = app::App::parse();
    match app.execute() {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}
