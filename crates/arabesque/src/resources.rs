//! What a recipe's files are read from, and within which limits.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use arabesque_core::{Budget, Limits, Result, Stopper};
use arabesque_io::file;

use crate::recipe::Input;

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

    /// The content of an input: what the recipe itself holds, else what is in memory, else the file.
    ///
    /// # Errors
    /// As [`file::read_bytes`]; [`arabesque_core::Error::Input`] when the content is not the one that the fingerprint was taken of.
    pub fn read(&self, input: &Input) -> Result<Arc<[u8]>> {
        let bytes = match (input.held()?, self.inputs.get(&input.path)) {
            (Some(held), _) => held.into(),
            (None, Some(bytes)) => Arc::clone(bytes),
            (None, None) => file::read_bytes(&self.resolved(&input.path), &self.budget())?.into(),
        };
        input.check(&bytes)?;
        Ok(bytes)
    }

    /// A fresh account within the limits, which the stopper ends.
    pub fn budget(&self) -> Budget {
        Budget::with_stopper(self.limits, self.stopper.clone())
    }

    fn resolved(&self, path: &str) -> String {
        let beside = self.base.as_deref().filter(|_| path != file::STANDARD).map(|base: &Path| base.join(path));
        beside.filter(|p| p.exists()).map_or_else(|| path.to_owned(), |p| p.to_string_lossy().into_owned())
    }
}

/// The files of one prepared recipe. They are read for each request, so that a change is seen; standard input, which can be read once
/// only, is kept.
#[derive(Clone, Debug)]
pub(crate) struct Files {
    resources: Resources,
    read: Arc<Mutex<BTreeMap<String, Arc<[u8]>>>>,
    budget: Budget,
}

impl Files {
    pub(crate) fn new(resources: Resources) -> Self {
        Self { budget: resources.budget(), resources, read: Arc::default() }
    }

    /// The same files, with a fresh account for another run.
    pub(crate) fn again(&self) -> Self {
        Self { budget: self.resources.budget(), ..self.clone() }
    }

    /// What reading, analysing and running may use up.
    pub(crate) fn budget(&self) -> &Budget {
        &self.budget
    }

    /// The content of an input.
    pub(crate) fn read(&self, input: &Input) -> Result<Arc<[u8]>> {
        if input.content.is_some() || input.path != file::STANDARD {
            return self.resources.read(input);
        }
        let known = self.read.lock().unwrap_or_else(PoisonError::into_inner).get(&input.path).cloned();
        if let Some(bytes) = known {
            input.check(&bytes)?;
            return Ok(bytes);
        }
        let bytes = self.resources.read(input)?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(input.path.clone(), Arc::clone(&bytes));
        Ok(bytes)
    }

    /// The content of an input, as text.
    pub(crate) fn text(&self, input: &Input) -> Result<String> {
        file::decode_text(input.name(), &self.read(input)?)
    }

    /// Reads an input, and makes it what a recipe carries.
    pub(crate) fn embed(&self, input: &mut Input) -> Result<Arc<[u8]>> {
        let bytes = self.read(input)?;
        *input = input.embedding(&bytes);
        Ok(bytes)
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
