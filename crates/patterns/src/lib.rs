//! Sample-graph synthesis.

mod params;

pub use params::{Deform, Existence, Initialisation, Matching, OptionInfo, Params, Search};

use arabesque_core::{
    Exemplar, Matrix, Observer, Outcome, Placement, Request, Result, Similarity, Stage, StopReason, Stream, Vector,
};

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Exemplar<D>,
}

impl<const D: usize> Prepared<D> {
    /// Analyses the exemplar.
    ///
    /// # Errors
    /// When a parameter is out of range or contradicts the exemplar.
    pub fn new(exemplar: &Exemplar<D>, _params: &Params) -> Result<Self> {
        Ok(Self { exemplar: exemplar.clone() })
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// When nothing can be placed under the constraints, or a limit is reached.
    pub fn run(&self, request: &Request<D>, _observer: &mut dyn Observer<D>) -> Result<Outcome<D>> {
        let mut random = Stream::new(request.seed, Stage::Initialise, 0);
        let bounds = request.domain.bounds();
        let n = (request.domain.measure() / self.exemplar.spacing().powi(D as i32)) as usize;
        let placements = (0..n)
            .map(|_| {
                let source = random.below(self.exemplar.elements.len());
                let p = Vector(std::array::from_fn(|k| random.range(bounds.min[k], bounds.max[k])));
                Placement {
                    source,
                    transform: Similarity::about(self.exemplar.elements[source].centre, p, Matrix::identity(), 1.0),
                    control: Vec::new(),
                    frozen: None,
                }
            })
            .collect();
        Ok(Outcome { placements, energy: Vec::new(), warnings: Vec::new(), stopped: StopReason::Finished })
    }
}
