//! `arabesque man`: manual pages.

use std::{io::Write, process::ExitCode};

use clap::Args;

use crate::{failure::Failure, process::standard};

/// Write the manual page
#[derive(Args, Debug)]
pub(crate) struct Man {
    /// The page of this subcommand instead of the whole program
    subcommand: Option<String>,
}

impl Man {
    pub(crate) fn execute(self, mut program: clap::Command) -> Result<ExitCode, Failure> {
        program.build();
        let command = match &self.subcommand {
            None => program,
            Some(name) => named(&program, name)?,
        };
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page)?;
        standard::output()?.write_all(&page)?;
        Ok(ExitCode::SUCCESS)
    }
}

fn named(command: &clap::Command, name: &str) -> Result<clap::Command, Failure> {
    let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    command.find_subcommand(name).cloned().ok_or_else(|| {
        let hint =
            arabesque::nearest(name, known.iter().copied()).map(|n| format!("; did you mean {n}?")).unwrap_or_default();
        Failure::usage(format!("no subcommand {name} (there are {}){hint}", known.join(", ")))
    })
}
