//! `--limit`: what is read and made may be larger than usual.

use arabesque::{Limits, core::options::help_list};
use clap::Args;

use crate::{failure::Failure, pair::pair};

/// How much a command may use up.
#[derive(Args, Debug)]
pub(crate) struct LimitOptions {
    /// Set one limit by its name (listed under --help); may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, long_help = help())]
    limit: Vec<(String, String)>,
}

fn help() -> String {
    let list = help_list(&Limits::specs());
    format!("Set one limit by its name; may be given several times. Reaching one is an error that names it.\n{list}")
}

impl LimitOptions {
    /// The usual limits with those that were set.
    pub(crate) fn limits(&self) -> Result<Limits, Failure> {
        let mut limits = Limits::default();
        self.limit.iter().try_for_each(|(name, value)| limits.set(name, value))?;
        Ok(limits)
    }
}
