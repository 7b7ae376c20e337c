//! `arabesque run`: a run again, from its recipe or from its result.

use std::{io::IsTerminal, path::Path, process::ExitCode};

use arabesque::{Input, Resources, io::file, recipe_in};
use clap::Args;

use crate::{
    failure::Failure,
    produce::{RunOptions, produce},
};

/// Repeat a run from a recipe, or from any result that carries one
#[derive(Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Run {
    /// A recipe (TOML), or a result (SVG, PNG, JSON, CSV or OBJ); - is standard input
    file: String,
    /// Where to write [default: where the recipe says, else standard output]
    #[arg(short, long, value_name = "OUT")]
    output: Option<String>,
    /// Use another seed than the recipe
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    #[command(flatten)]
    run: RunOptions,
}

impl Run {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let input = Input::file(&self.file);
        let bytes = Resources::default().read(&input)?;
        let mut recipe = recipe_in(input.name(), &bytes)?;
        if let Some(seed) = self.seed {
            recipe.seed = seed;
        }
        let path = match self.output.or_else(|| recipe.output.path.clone()) {
            Some(path) => path,
            None if std::io::stdout().is_terminal() => {
                return Err(Failure::usage(
                    "the recipe does not say where to write; give -o OUT, or -o - for the terminal",
                ));
            }
            None => file::STANDARD.to_owned(),
        };
        produce(recipe, Path::new(&self.file).parent(), &path, &self.run)
    }
}
