//! What a recipe's files are read from, and within which limits.
//!
//! A path means a file beside the recipe, then one in the working folder. Where a recipe has a fingerprint of a file, one that was
//! moved or renamed is found by that.

mod files;
mod search;

pub(crate) use files::Files;

use std::{collections::BTreeMap, path::PathBuf, sync::Arc};

use arabesque_core::{Budget, Error, Limits, Result, Stopper};

use crate::{
    recipe::Input,
    resources::search::{Found, Search},
};

/// Where the files of a recipe come from. Default: the working folder, [`Limits::default`], and nothing in memory.
#[derive(Clone, Debug, Default)]
pub struct Resources {
    /// Folder beside which relative paths are looked for first.
    pub base: Option<PathBuf>,
    /// Limits for everything that is read and made.
    pub limits: Limits,
    /// Asks whatever is prepared, run or encoded with these resources to stop.
    pub stopper: Stopper,
    /// Files that are already in memory, by the path that the recipe has for them; they are not looked for on disk.
    pub inputs: BTreeMap<String, Arc<[u8]>>,
}

impl Resources {
    /// Files beside `base`.
    pub fn beside(base: impl Into<PathBuf>) -> Self {
        Self { base: Some(base.into()), ..Self::default() }
    }

    /// The same with a file in memory.
    #[must_use]
    pub fn with_input(mut self, path: impl Into<String>, bytes: impl Into<Arc<[u8]>>) -> Self {
        self.inputs.insert(path.into(), bytes.into());
        self
    }

    /// The content of an input: what the recipe itself holds, else what is in memory, else the file. That is looked for beside
    /// [`Resources::base`], then in the working folder; where the recipe has a fingerprint of it, also under other names there.
    ///
    /// # Errors
    /// As [`file::read_bytes`](arabesque_io::file::read_bytes); [`Error::Input`] when the content is not the one that the fingerprint was taken of, or no file has it.
    pub fn read(&self, input: &Input) -> Result<Arc<[u8]>> {
        let bytes = match (input.held()?, self.inputs.get(&input.path)) {
            (Some(held), _) => held.into(),
            (None, Some(bytes)) => Arc::clone(bytes),
            (None, None) => return self.find(input)?.content(input, &self.budget()),
        };
        input.check(&bytes)?;
        Ok(bytes)
    }

    /// [`Resources::read`], with the role of the input in what it says of failures: `--domain`, `recipe`.
    ///
    /// # Errors
    /// As [`Resources::read`].
    pub fn read_as(&self, role: &str, input: &Input) -> Result<Arc<[u8]>> {
        self.read(input).map_err(|error| in_role(role, error))
    }

    /// The file that [`Resources::read_as`] reads; of an input whose content the recipe holds, the file that it comes from, as far as it
    /// is still there under its name; `None` for what is in memory alone. `-` is standard input.
    ///
    /// # Errors
    /// [`Error::Input`] with the role when there is no such file.
    pub fn file_of(&self, role: &str, input: &Input) -> Result<Option<PathBuf>> {
        if self.inputs.contains_key(&input.path) {
            return Ok(None);
        }
        if input.content.is_some() {
            return Ok(self.search(input).named());
        }
        self.find(input).map(|found| Some(found.path)).map_err(|error| in_role(role, error))
    }

    fn search<'a>(&'a self, input: &'a Input) -> Search<'a> {
        Search { base: self.base.as_deref(), input }
    }

    fn find(&self, input: &Input) -> Result<Found> {
        self.search(input).find(&self.budget())
    }

    /// A fresh account within the limits, which the stopper ends.
    pub fn budget(&self) -> Budget {
        Budget::with_stopper(self.limits, self.stopper.clone())
    }
}

/// The same error, which says of which input.
fn in_role(role: &str, error: Error) -> Error {
    let named = |place: String| format!("{role} {place}");
    match error {
        Error::Input { place, problem, advice } => Error::Input { place: named(place), problem, advice },
        Error::Io { path, source } => Error::Io { path: named(path), source },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recipe_comes_before_memory_and_memory_before_the_disk() {
        let resources = Resources::default().with_input("a.svg", &b"memory"[..]);
        assert_eq!(&*resources.read(&Input::file("a.svg")).unwrap(), b"memory");
        assert_eq!(&*resources.read(&Input::file("a.svg").embedding(b"recipe")).unwrap(), b"recipe");
        assert!(resources.read(&Input::file("no such file.svg")).is_err());
    }

    #[test]
    fn limits_reach_what_is_read() {
        let limits = Limits { file_bytes: 10, ..Limits::default() };
        let resources = Resources { limits, ..Resources::beside(env!("CARGO_MANIFEST_DIR")) };
        let error = resources.read(&Input::file("Cargo.toml")).unwrap_err().to_string();
        assert!(error.contains("limit of 10"), "{error}");
    }
}
