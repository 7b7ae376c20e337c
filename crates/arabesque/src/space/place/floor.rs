//! A level floor.

use arabesque_core::{Ground, Vector};

/// A floor at this height along an axis.
#[derive(Debug)]
pub(super) struct Floor {
    pub(super) axis: usize,
    pub(super) height: f64,
}

impl Ground<3> for Floor {
    fn height(&self, p: Vector<3>) -> f64 {
        p[self.axis] - self.height
    }

    fn at_height(&self, p: Vector<3>, height: f64) -> Vector<3> {
        Vector(std::array::from_fn(|k| if k == self.axis { self.height + height } else { p[k] }))
    }
}
