//! Every parameter of a struct by its name.

use super::spec::{Kind, ParamSpec};
use crate::{
    error::{Error, Result},
    suggest::did_you_mean,
};

/// A parameter of the struct `P`: what is known of it, and how it is set and read back.
#[derive(Clone, Debug)]
pub struct Param<P> {
    /// What is known of it.
    pub spec: ParamSpec,
    /// Takes the value from a text, if the text stands for one.
    pub set: fn(&mut P, &str, &Kind) -> Option<()>,
    /// The value as text.
    pub get: fn(&P) -> String,
}

/// The parameters of the struct `P`, in the order of its fields.
#[derive(Clone, Debug)]
pub struct Registry<P>(Vec<Param<P>>);

impl<P: Default> Registry<P> {
    /// A registry of `params`, whose defaults are those of `P`.
    pub fn new(params: impl IntoIterator<Item = Param<P>>) -> Self {
        let defaults = P::default();
        let with_default = |mut param: Param<P>| {
            param.spec.default = (param.get)(&defaults);
            param
        };
        Self(params.into_iter().map(with_default).collect())
    }

    /// What is known of every parameter.
    pub fn specs(&self) -> Vec<ParamSpec> {
        self.0.iter().map(|param| param.spec.clone()).collect()
    }

    /// Sets the parameter `name` of `params`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name, with the nearest known one, or for a value that is not allowed.
    pub fn set(&self, params: &mut P, name: &str, value: &str) -> Result<()> {
        let Some(param) = self.0.iter().find(|param| param.spec.name == name) else {
            return Err(unknown("set", name, self.0.iter().map(|param| param.spec.name)));
        };
        let text = value.trim();
        (param.set)(params, text, &param.spec.kind).ok_or_else(|| {
            let hint = did_you_mean(text, param.spec.kind.names().iter().copied());
            Error::parameter(name, value, param.spec.expected() + &hint)
        })
    }

    /// Name and value of every parameter, such that [`Registry::set`] with them gives the same parameters again.
    pub fn values(&self, params: &P) -> Vec<(&'static str, String)> {
        self.0.iter().map(|param| (param.spec.name, (param.get)(params))).collect()
    }

    /// Checks that every parameter has an allowed value.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first one that has not.
    pub fn check(&self, params: &P) -> Result<()> {
        let mut copy = P::default();
        self.values(params).iter().try_for_each(|(name, value)| self.set(&mut copy, name, value))
    }
}

/// The error for a name that is not among the `known` ones, with the nearest of them.
pub(crate) fn unknown<'a>(option: &str, value: &str, known: impl Iterator<Item = &'a str> + Clone) -> Error {
    let names: Vec<&str> = known.clone().collect();
    Error::parameter(option, value, format!("one of {}{}", names.join(", "), did_you_mean(value, known)))
}

impl super::spec::Preset {
    /// The error for a preset whose name is not among those of `known`.
    pub fn unknown(name: &str, known: &[Self]) -> Error {
        unknown("preset", name, known.iter().map(|preset| preset.name))
    }
}
