//! What a command must not write over: its inputs, and files that arabesque did not make.

use std::path::{Component, Path, PathBuf};

use arabesque::{
    Budget, Input, Recipe, Resources,
    io::file::{self, Identity, Target},
    is_result,
};
use clap::Args;

use crate::{failure::Failure, process::standard};

/// Options of everything that writes a file.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct WriteOptions {
    /// Replace OUT also where it is no result of arabesque, or is one of the inputs, of which a copy is kept as NAME.orig
    #[arg(long)]
    pub(crate) force: bool,
}

/// The files that a command reads.
#[derive(Debug, Default)]
pub(crate) struct Guard {
    inputs: Vec<(String, Identity)>,
    /// An input that is not there.
    missing: Option<arabesque::Error>,
    force: bool,
}

impl Guard {
    pub(crate) fn new(options: WriteOptions) -> Self {
        Self { inputs: Vec::new(), missing: None, force: options.force }
    }

    /// Adds a file, by what it is read for.
    pub(crate) fn with_input(mut self, role: &str, path: &str) -> Self {
        let name = if file::is_standard_input(path) { "standard input" } else { path };
        self.inputs.extend(Identity::of_input(path).map(|identity| (format!("{role} {name}"), identity)));
        self
    }

    /// Adds every file that a recipe reads, or was written from. One that is not there is told once the outputs are known to be in
    /// order; of the exemplar the run itself says it, after what is wrong with the parameters.
    pub(crate) fn with_inputs(mut self, recipe: &Recipe, resources: &Resources) -> Self {
        for (k, (role, input)) in recipe.inputs().into_iter().enumerate() {
            match resources.file_of(role, input) {
                Ok(Some(path)) => self = self.with_input(role, &path.to_string_lossy()),
                Err(error) if k > 0 && self.missing.is_none() => self.missing = Some(error),
                Ok(None) | Err(_) => {}
            }
        }
        self
    }

    /// Makes sure that a file can be written at each of `paths`, and that nothing is lost by it.
    pub(crate) fn targets(self, paths: &[String]) -> Result<Vec<Target>, Failure> {
        let targets = Target::all(paths).map_err(Failure::writing)?;
        let pairs = paths.iter().zip(targets);
        let checked = pairs.map(|(path, target)| self.check(path, target)).collect::<Result<_, _>>()?;
        self.missing.map_or(Ok(checked), |error| Err(error.into()))
    }

    /// The same for one file.
    pub(crate) fn target(&self, path: &str) -> Result<Target, Failure> {
        if file::is_standard_output(path) {
            standard::check().map_err(Failure::standard)?;
        }
        self.check(path, Target::new(path).map_err(Failure::writing)?)
    }

    /// The same for the files beside those at `paths` that are called like them but for their ending.
    pub(crate) fn companions(&self, paths: &[String], ending: &str) -> Result<Vec<Target>, Failure> {
        let beside = |path: &String| Path::new(path).with_extension(ending).to_string_lossy().into_owned();
        let paths: Vec<String> = paths.iter().map(beside).collect();
        let targets = Target::all(&paths).map_err(Failure::writing)?;
        paths.iter().zip(targets).map(|(path, target)| self.check(path, target)).collect()
    }

    fn check(&self, path: &str, target: Target) -> Result<Target, Failure> {
        let written = Identity::of_output(path);
        let input = self.inputs.iter().find(|(_, identity)| written.as_ref() == Some(identity));
        match (input, target.existing()) {
            (Some(_), Some(_)) if self.force => Ok(target.keeping_copy()),
            (Some((input, _)), existing) => {
                let advice = match existing {
                    Some(_) => "name another file, or give --force, which keeps a copy of it as NAME.orig",
                    None => "name another file",
                };
                Err(refusal(path, &format!("it is an input as well ({input}); {advice}")))
            }
            (None, Some(existing)) if !self.force && !may_replace(existing) => Err(refusal(
                path,
                "there is a file already, and nothing in it says that arabesque made it; name another file, or give --force to replace it",
            )),
            (None, _) => Ok(target),
        }
    }
}

fn refusal(path: &str, problem: &str) -> Failure {
    let path = if path == file::STANDARD { "standard output" } else { path };
    Failure::refused(format!("cannot write the result: {path}: {problem}"))
}

/// Whether the file is a result of ours, as far as can be read.
fn may_replace(path: &Path) -> bool {
    file::read_bytes(&path.to_string_lossy(), &Budget::default()).is_ok_and(|bytes| is_result(&bytes))
}

/// The recipe that a command starts from, and where it lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecipeFile<'a>(pub(crate) &'a str);

impl RecipeFile<'_> {
    /// The folder beside which its files are looked for; that of standard input is the working folder.
    pub(crate) fn folder(&self) -> &Path {
        let path = Path::new(self.0);
        if file::is_stream(self.0) { Path::new("") } else { path.parent().unwrap_or(Path::new("")) }
    }

    /// The place that the recipe itself names for its output: in its own folder, or anywhere with `--allow-path`.
    pub(crate) fn output(&self, path: &str, allow_path: bool) -> Result<String, Failure> {
        if file::is_standard_output(path) {
            return Ok(file::STANDARD.to_owned());
        }
        let place = self.folder().join(path);
        if !path.is_empty() && !allow_path && !is_within(self.folder(), Path::new(path)) {
            return Err(Failure::usage(format!(
                "{}: the recipe asks to write to {path}, which is not in its own folder; give -o OUT, or --allow-path to let it",
                Input::file(self.0).name()
            )));
        }
        Ok(if path.is_empty() { String::new() } else { place.to_string_lossy().into_owned() })
    }
}

/// Whether `path` leads to a place in `folder`, through links as well.
fn is_within(folder: &Path, path: &Path) -> bool {
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return false;
    }
    let real = |path: PathBuf| {
        let path = if path.as_os_str().is_empty() { PathBuf::from(".") } else { path };
        path.canonicalize().ok()
    };
    let Some(home) = real(folder.to_owned()) else { return false };
    let place = folder.join(path);
    // What is not there yet lies where its folder is; without that, there is nothing to write to.
    let parent = real(place.parent().unwrap_or(Path::new("")).to_owned());
    let lies_within = |real: Option<PathBuf>| real.is_none_or(|real| real.starts_with(&home));
    lies_within(parent) && lies_within(real(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recipes_stay_in_their_folder() {
        let folder = tempfile::tempdir().unwrap();
        let home = folder.path().join("home");
        std::fs::create_dir_all(home.join("sub")).unwrap();
        let within = |path: &str| is_within(&home, Path::new(path));
        assert!(["a.svg", "./a.svg", "sub/a.svg", "new/a.svg", "..a.svg"].into_iter().all(within));
        assert!(!["../a.svg", "sub/../a.svg", "sub/../../a.svg", "/a.svg", ".."].into_iter().any(within));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("..", home.join("up")).unwrap();
            std::fs::write(folder.path().join("outside.svg"), "").unwrap();
            std::os::unix::fs::symlink("../outside.svg", home.join("link.svg")).unwrap();
            std::os::unix::fs::symlink("sub/inside.svg", home.join("inner.svg")).unwrap();
            assert!(!within("up/a.svg") && !within("link.svg") && within("inner.svg"));
        }
    }
}
