//! `--limit`: what is read and made may be larger than usual.

use arabesque::{Error, Limits, core::options::help_list};
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
        let named = |error, name: &str| match error {
            // The registry speaks of --set where it does not know the name.
            Error::Parameter { name: known, value, expected } if known == "set" => {
                Error::Parameter { name: "limit".into(), value, expected }
            }
            Error::Parameter { value, expected, .. } => {
                Error::Parameter { name: format!("limit {name}"), value, expected }
            }
            other => other,
        };
        let set = |(name, value): &(String, String)| limits.set(name, value).map_err(|error| named(error, name));
        self.limit.iter().try_for_each(set)?;
        Ok(limits)
    }
}
