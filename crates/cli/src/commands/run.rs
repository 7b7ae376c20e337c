//! `arabesque run`: a run again, from its recipe or from its result.

use std::{io::IsTerminal, process::ExitCode};

use arabesque::{Carrier, Input, Recipe, Resources, carried_recipe, io::file};
use clap::Args;

use crate::{
    failure::Failure,
    guard::RecipeFile,
    produce::{RunOptions, produce},
    summary,
};

/// Repeat a run from a recipe, or from any result that carries one
#[derive(Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Run {
    /// A recipe (TOML), or a result (SVG, PNG, JSON, CSV, OBJ or GLB); - is standard input
    file: String,
    /// Where to write [default: where a recipe (TOML) says, in its own folder; else standard output]
    #[arg(short, long, value_name = "OUT")]
    output: Option<String>,
    /// Use another seed than the recipe
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// Leave out the edits of the result
    #[arg(long)]
    no_edits: bool,
    /// Let a recipe write where it says outside its own folder
    #[arg(long)]
    allow_path: bool,
    #[command(flatten)]
    run: RunOptions,
}

impl Run {
    pub(crate) fn execute(self) -> Result<ExitCode, Failure> {
        let json = self.run.talk.json;
        let (recipe, path) = self.recipe().inspect_err(|failure| {
            if json {
                summary::print_failure(failure);
            }
        })?;
        produce(recipe, Some(RecipeFile(&self.file)), &path, &self.run)
    }

    /// The recipe, and where its result goes.
    fn recipe(&self) -> Result<(Recipe, String), Failure> {
        let resources = Resources { limits: self.run.limit.limits()?, ..Resources::default() };
        let input = Input::file(&self.file);
        let bytes = resources.read_as("recipe", &input)?;
        let (mut recipe, carrier) = carried_recipe(input.name(), &bytes)?;
        if let Some(seed) = self.seed {
            recipe.seed = seed;
        }
        if self.no_edits {
            recipe.edits.clear();
        }
        let from = RecipeFile(&self.file);
        // A result came from somebody else, perhaps; where it goes is for whoever runs it to say.
        let own = recipe.output.path.take().filter(|_| carrier == Carrier::Recipe);
        let path = match (&self.output, own) {
            (Some(path), _) => path.clone(),
            (None, Some(path)) => from.output(&path, self.allow_path)?,
            (None, None) if std::io::stdout().is_terminal() => {
                let who = if carrier == Carrier::Recipe { "the recipe does" } else { "results do" };
                return Err(Failure::usage(format!(
                    "{who} not say where to write; give -o OUT, or -o - for the terminal"
                )));
            }
            (None, None) => file::STANDARD.to_owned(),
        };
        Ok((recipe, path))
    }
}
