//! In place of physics where the library was built without it: a clear answer.

use std::sync::Arc;

use arabesque_core::{Between, Budget, Error, Outcome, Request as EngineRequest, Result};

use crate::{
    artwork::PhysicsSummary,
    method::RunContext,
    recipe::Space,
    space::{scene::Bodies, stacks::Stacks},
};

/// There is none.
#[derive(Debug)]
pub(super) enum Physical {}

impl Physical {
    /// Refuses physics.
    pub(super) fn new(
        job: &mut Space,
        _: (Option<&Bodies>, Option<&Stacks>),
        _: &EngineRequest<3>,
        _: &mut RunContext<'_>,
    ) -> Result<Option<Arc<Self>>> {
        match job.asked_physics()? {
            None => Ok(None),
            Some(_) => Err(Error::Unsupported {
                what: "physics in this build".into(),
                advice: "leave it out, or build arabesque with its feature physics".into(),
            }),
        }
    }

    pub(super) fn between(self: &Arc<Self>) -> Option<Arc<dyn Between<3>>> {
        match **self {}
    }

    pub(super) fn settle(&self, _: &mut Outcome<3>, _: &Budget) -> Result<PhysicsSummary> {
        match *self {}
    }
}
