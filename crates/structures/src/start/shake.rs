//! Shaking: a little noise on all places, so that patches are not the exemplar to the point.

use arabesque_core::{Stage, Stream, Vector};

use crate::{exemplar::bodies::LOOSE, output::state::Output};

const PLACES: Stage = Stage::new(45);

/// Moves each point of no rigid element by up to `length` in each coordinate.
pub(crate) fn shake<const D: usize>(output: &mut Output<D>, length: f64, seed: u64) {
    for i in output.kept..output.places.len() {
        if output.body_of[i] == LOOSE {
            let mut stream = Stream::new(seed, PLACES, i as u64);
            output.places[i] += Vector(std::array::from_fn(|_| stream.range(-length, length)));
        }
    }
}
