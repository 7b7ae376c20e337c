//! `arabesque completions`: completion scripts.

use std::{io::Write, process::ExitCode};

use clap::Args;
use clap_complete::Shell;

use crate::{failure::Failure, process::standard};

/// Write the completion script of a shell
#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub(crate) fn execute(self, mut program: clap::Command) -> Result<ExitCode, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "arabesque", &mut script);
        standard::output()?.write_all(&script)?;
        Ok(ExitCode::SUCCESS)
    }
}
