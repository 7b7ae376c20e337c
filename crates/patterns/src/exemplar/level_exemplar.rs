//! What one level works with: the exemplar as it is sampled there, and its neighbourhoods.

use std::sync::Arc;

use arabesque_core::{Budget, Exemplar, Result, Vector, parallel_line_spacing};

use crate::{
    exemplar::{
        graph::{pseudo::PseudoElements, skeleton::Skeleton},
        level::{Ball, Level},
        library::Library,
        samples::ElementSamples,
    },
    params::{Matching, Params, Switch},
};

/// Sampling distance of the finest level relative to the mean distance of neighbouring strokes (area over length).
const STROKE_GAP: f64 = 1.0;

/// It is no smaller than this share of the shorter side of the window, and no larger than that.
const STEP_RANGE: (f64, f64) = (1.0 / 50.0, 1.0 / 16.0);

/// Mean numbers of samples in a neighbourhood of curves at the coarsest and the finest level [Tu 2020 §C].
const NEIGHBOURS: (f64, f64) = (30.0, 20.0);

/// The exemplar at one level.
#[derive(Clone, Debug)]
pub(crate) struct LevelExemplar<const D: usize> {
    /// Elements and, as pseudo elements, curve samples.
    pub(crate) exemplar: Arc<Exemplar<D>>,
    pub(crate) library: Arc<Library<D>>,
    pub(crate) level: Level<D>,
}

/// The settings of all levels, coarsest first.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn level_exemplars<const D: usize>(
    exemplar: &Arc<Exemplar<D>>,
    skeleton: Option<&Arc<Skeleton<D>>>,
    params: &Params,
    budget: &Budget,
) -> Result<Vec<LevelExemplar<D>>> {
    let samples = ElementSamples::new(exemplar, params.samples, budget)?;
    let Some(skeleton) = skeleton else {
        let library = Arc::new(Library::new(exemplar, None, budget)?);
        let sampled = |number| {
            let counts = (params.coarse_neighbours, params.fine_neighbours);
            let ball = ball(&library, params, number, counts, budget)?;
            let level = Level::new(&library, &samples, detail(params, number), ball, budget)?;
            Ok(LevelExemplar { exemplar: Arc::clone(exemplar), library: library.clone(), level })
        };
        return (0..params.levels).map(sampled).collect();
    };
    let step = finest_spacing(exemplar, skeleton, params);
    let mut made: Vec<(f64, PseudoElements<D>, Arc<Exemplar<D>>, Arc<Library<D>>)> = Vec::new();
    let mut sampled = |number| {
        let spacing = step * params.coarsening.powf(1.0 - detail(params, number));
        // Levels with the same sampling distance share everything but the radius.
        if made.last().is_none_or(|m| m.0 != spacing) {
            let pseudo = PseudoElements::new(exemplar, skeleton, spacing, budget)?;
            let library = Arc::new(Library::new(&pseudo.exemplar, Some((exemplar.classes.len(), spacing)), budget)?);
            made.push((spacing, pseudo.clone(), Arc::new(pseudo.exemplar), library));
        }
        let (_, pseudo, shared, library) = &made[made.len() - 1];
        let samples = samples.with_points(shared.elements.len() - pseudo.base);
        let ball = ball(library, params, number, NEIGHBOURS, budget)?;
        let level = Level::new(library, &samples, detail(params, number), ball, budget)?;
        let level = level.with_net(Arc::clone(&pseudo.net), pseudo.base as u32, params.edges == Switch::On);
        Ok(LevelExemplar { exemplar: Arc::clone(shared), library: Arc::clone(library), level })
    };
    (0..params.levels).map(&mut sampled).collect()
}

/// 0 at the coarsest level, 1 at the finest.
fn detail(params: &Params, number: usize) -> f64 {
    if params.levels == 1 { 1.0 } else { number as f64 / (params.levels - 1) as f64 }
}

/// Radius of the neighbourhoods, and by how much those of the exemplar are larger.
fn ball<const D: usize>(
    library: &Library<D>,
    params: &Params,
    number: usize,
    counts: (f64, f64),
    budget: &Budget,
) -> Result<Ball> {
    let count = counts.0 * (counts.1 / counts.0).powf(detail(params, number));
    let radius = match params.radius {
        Some(radius) => radius,
        None => library.crowded_radius(count, budget)?.min(library.view.side()),
    };
    let slack = match params.matching {
        // Where junctions lie closer than samples, the slack would take in many times the neighbourhood.
        Matching::Robust => library.outlier.iter().copied().fold(0.0, f64::max).min(radius),
        Matching::Hard => radius,
    };
    Ok(Ball { radius, slack })
}

/// Sampling distance of the finest level where none is given: about that of neighbouring strokes, so that
/// neighbourhoods are as dense along as across.
fn finest_spacing<const D: usize>(exemplar: &Exemplar<D>, skeleton: &Skeleton<D>, params: &Params) -> f64 {
    let side = exemplar.view().side();
    let gap = parallel_line_spacing::<D>(exemplar.view().measure(), length(skeleton));
    params.spacing.unwrap_or((STROKE_GAP * gap).clamp(STEP_RANGE.0 * side, STEP_RANGE.1 * side))
}

fn length<const D: usize>(skeleton: &Skeleton<D>) -> f64 {
    skeleton.lines.iter().map(|l| l.measured.length()).sum()
}

/// About how many samples the curves get at the finest level.
pub(crate) fn expected_nodes<const D: usize>(exemplar: &Exemplar<D>, skeleton: &Skeleton<D>, params: &Params) -> f64 {
    length(skeleton) / finest_spacing(exemplar, skeleton, params) + skeleton.knots.len() as f64
}

/// The shortest side of a box of this size.
pub(crate) fn shortest<const D: usize>(v: Vector<D>) -> f64 {
    v.0.into_iter().fold(f64::INFINITY, f64::min)
}
