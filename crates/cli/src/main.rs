//! The program `arabesque`: one file a subcommand, everything else in the library.

mod app;
mod commands;
mod duration;
mod failure;
mod guard;
mod limits;
mod memory;
mod pair;
mod produce;
mod progress;
mod say;
mod sentinel;
mod signals;
mod standard;
mod summary;

use std::process::ExitCode;

use clap::Parser;

#[global_allocator]
static ALLOCATOR: memory::Counting = memory::Counting;

fn main() -> ExitCode {
    sentinel::began();
    let app = app::App::parse();
    match app.execute() {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}
