//! The files of one prepared recipe.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

use arabesque_core::{Budget, Result};
use arabesque_io::file;

use crate::{
    recipe::{Input, Recipe},
    resources::Resources,
};

/// What is being done where nothing says more.
const READING: &str = "reading and preparing";

/// The files of one prepared recipe. They are read for each request, so that a change is seen; standard input, which can be read once
/// only, is kept.
#[derive(Clone, Debug)]
pub(crate) struct Files {
    resources: Resources,
    read: Arc<Mutex<BTreeMap<String, Arc<[u8]>>>>,
    /// What the recipe wants each file for, by its path.
    roles: Arc<BTreeMap<String, &'static str>>,
    budget: Budget,
}

impl Files {
    pub(crate) fn new(resources: Resources, recipe: &Recipe) -> Self {
        let roles = recipe.inputs().into_iter().rev().map(|(role, input)| (input.path.clone(), role)).collect();
        Self { budget: resources.budget().stage(READING), resources, read: Arc::default(), roles: Arc::new(roles) }
    }

    /// The same files, with a fresh account for another run.
    pub(crate) fn again(&self) -> Self {
        Self { budget: self.resources.budget().stage(READING), ..self.clone() }
    }

    /// What reading, analysing and running may use up.
    pub(crate) fn budget(&self) -> &Budget {
        &self.budget
    }

    /// The content of an input.
    ///
    /// What the caller opened, such as standard input, is read once.
    pub(crate) fn read(&self, input: &Input) -> Result<Arc<[u8]>> {
        if input.content.is_some() || !file::is_stream(&input.path) {
            return self.read_anew(input);
        }
        let known = self.read.lock().unwrap_or_else(PoisonError::into_inner).get(&input.path).cloned();
        if let Some(bytes) = known {
            input.check(&bytes)?;
            return Ok(bytes);
        }
        let bytes = self.read_anew(input)?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(input.path.clone(), Arc::clone(&bytes));
        Ok(bytes)
    }

    fn read_anew(&self, input: &Input) -> Result<Arc<[u8]>> {
        match self.roles.get(&input.path) {
            Some(role) => self.resources.read_as(role, input),
            None => self.resources.read(input),
        }
    }

    /// Where an input lies on disk, if it does.
    pub(crate) fn path_of(&self, input: &Input) -> Option<PathBuf> {
        self.resources.file_of("", input).ok().flatten().filter(|_| !file::is_stream(&input.path))
    }

    /// The content of an input, as text.
    pub(crate) fn text(&self, input: &Input) -> Result<String> {
        file::decode_text(input.name(), &self.read(input)?, &self.budget)
    }

    /// Reads an input, and makes it what a recipe carries.
    pub(crate) fn embed(&self, input: &mut Input) -> Result<Arc<[u8]>> {
        let bytes = self.read(input)?;
        *input = input.embedding(&bytes);
        Ok(bytes)
    }
}
