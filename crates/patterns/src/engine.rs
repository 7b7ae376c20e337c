//! An exemplar, prepared for any number of runs.

use std::sync::Arc;

use arabesque_core::{
    Error, Exemplar, Limits, Measured, Observer, Outcome, Request, Result, Role, StopReason, Warning,
};

use crate::{
    clearance::{self, ExemplarClearance},
    curves::Skeleton,
    extent::Extent,
    finish,
    params::Params,
    run::{Run, Stand},
    search,
    setting::{Setting, settings, shortest},
    targets::class_targets,
};

/// Curves with more [`search::strangeness`] than this have nothing to repeat.
const STRANGE: f64 = 0.7;

/// With more samples than this, curves that never repeat are taken for a random pattern.
const FEW_NODES: usize = 100;

/// Fewest elements in the window of an exemplar from which a distribution can be learnt without a warning.
const FEW: usize = 12;

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Exemplar<D>,
    clearance: Option<ExemplarClearance>,
    pub(crate) settings: Vec<Setting<D>>,
    pub(crate) params: Params,
    /// See [`search::strangeness`]; `None` without curves.
    strangeness: Option<f64>,
}

/// Mean distance between strokes: area over length, in space the root of volume over length.
fn mean_gap<const D: usize>(exemplar: &Exemplar<D>) -> f64 {
    let tolerance = 1e-3 * shortest(exemplar.window.size());
    let length: f64 = exemplar.curves.iter().map(|c| Measured::new(c.path.clone(), tolerance).length()).sum();
    (exemplar.window.measure() / length.max(f64::MIN_POSITIVE)).powf(1.0 / (D as f64 - 1.0))
}

impl<const D: usize> Prepared<D> {
    /// Analyses the exemplar.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a parameter is out of range or the radius larger than the exemplar; [`Error::Input`] when the exemplar
    /// shows no curve and fewer than two elements that may be copied, for then nothing tells how far apart they belong, or when its
    /// curves lie outside its frame.
    pub fn new(exemplar: &Exemplar<D>, params: &Params) -> Result<Self> {
        params.check()?;
        if exemplar.curves.is_empty() && exemplar.elements.iter().filter(|e| e.role == Role::Source).count() < 2 {
            let problem = "one element only, expected at least two";
            let advice = "repeat the element a few times in the exemplar, so that it shows distances and directions";
            return Err(Error::input("exemplar", problem, advice));
        }
        let side = shortest(exemplar.window.size());
        if let Some(radius) = params.radius.filter(|r| *r > side) {
            return Err(Error::parameter(
                "radius",
                radius,
                format!("at most {side}, the shorter side of the exemplar"),
            ));
        }
        let skeleton =
            (!exemplar.curves.is_empty()).then(|| Arc::new(Skeleton::new(&exemplar.curves, &exemplar.window)));
        if skeleton.as_ref().is_some_and(|s| s.lines.is_empty()) && exemplar.elements.is_empty() {
            let problem = "every curve lies outside the frame or has no length";
            return Err(Error::input("exemplar", problem, "draw the curves inside the frame of the page"));
        }
        let skeleton = skeleton.filter(|s| !s.lines.is_empty());
        let settings = settings(exemplar, skeleton.as_ref(), params);
        let coarsest = settings.first().filter(|_| skeleton.is_some());
        Ok(Self {
            exemplar: exemplar.clone(),
            clearance: clearance::measure(exemplar),
            strangeness: coarsest.and_then(|s| search::strangeness(&s.level, &s.library, params.matching)),
            settings,
            params: params.clone(),
        })
    }

    /// Neighbourhood radius of each level, coarsest first, in the exemplar's units.
    pub fn radii(&self) -> Vec<f64> {
        self.settings.iter().map(|s| s.level.radius).collect()
    }

    /// Number of samples of each exemplar element at the finest level.
    pub fn samples_per_element(&self) -> Vec<usize> {
        let parts = |s: &Setting<D>| s.level.parts[..s.level.base as usize].iter().map(Vec::len).collect();
        self.settings.last().map_or_else(Vec::new, parts)
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a frozen element with an unknown source; [`Error::Limit`] when the output would be too large;
    /// [`Error::NoResult`] when nothing fits into the domain.
    pub fn run(&self, request: &Request<D>, observer: &mut dyn Observer<D>) -> Result<Outcome<D>> {
        let (levels, mut warnings) = self.usable_levels(request);
        let iterations = if levels.is_empty() { 0 } else { self.params.iterations };
        // Where no neighbourhood fits, the first layout is all there can be.
        let levels = if levels.is_empty() { vec![self.settings.len() - 1] } else { levels };
        // Levels without curves share one exemplar; what it means for the request is then worked out once.
        let used = if self.has_curves() { &levels[..] } else { &levels[..1] };
        let extents: Vec<_> = used
            .iter()
            .map(|&k| {
                Extent::new(
                    request,
                    &self.settings[k].exemplar,
                    &self.settings[k].library.radius,
                    self.settings[k].level.base,
                )
            })
            .collect();
        let targets: Vec<_> = used
            .iter()
            .zip(&extents)
            .map(|(&k, extent)| class_targets(&self.settings[k].library, request, extent, self.settings[k].level.base))
            .collect();
        self.check_request(request, targets.iter().map(|t| t.iter().sum()).fold(0.0, f64::max))?;
        let stand = |(n, &k): (usize, &usize)| {
            let shared = n.min(used.len() - 1);
            Stand { setting: &self.settings[k], extent: &extents[shared], targets: &targets[shared] }
        };
        let stands: Vec<_> = levels.iter().enumerate().map(stand).collect();
        let run = Run { prepared: self, request, stands, iterations };
        let mut trace = Vec::new();
        let (mut found, flow) = run.synthesise(&mut trace, observer);
        let last = &extents[extents.len() - 1];
        warnings.extend(finish::mend(&mut found.placements, self.clearance.as_ref(), (request, last), &self.params));
        if found.placements.is_empty() && found.curves.is_empty() {
            return Err(Error::no_result(
                "no element fits into the domain",
                "make the domain larger, lower the scale, or allow elements to cross its border",
            ));
        }
        let stopped = if flow.is_break() { StopReason::Observer } else { StopReason::Finished };
        Ok(Outcome { placements: found.placements, curves: found.curves, energy: trace, warnings, stopped })
    }

    /// What may be wrong with an exemplar of curves.
    fn doubts(&self) -> Vec<Warning> {
        let mut doubts = Vec::new();
        let Some(setting) = self.settings.first().filter(|_| self.has_curves()) else { return doubts };
        let side = shortest(self.exemplar.window.size());
        if setting.level.radius >= 0.5 * side {
            doubts.push(Warning::new(
                format!("the exemplar is hardly larger than one neighbourhood: {side:.4} across, and it takes {:.4} to see one", 2.0 * setting.level.radius),
                "show more of the pattern, or set a smaller radius or spacing",
            ));
        }
        // A large irregular net has nothing alike either, but enough of it to be one of a kind.
        let nodes = setting.level.net.as_ref().map_or(0, |net| net.nodes.len());
        if nodes < FEW_NODES && self.strangeness.is_none_or(|s| s > STRANGE) {
            doubts.push(Warning::new(
                "no part of the exemplar's curves looks like another: there is nothing to repeat",
                "draw the pattern several times over, so that the exemplar shows how it goes on",
            ));
        }
        let widest = self.exemplar.curves.iter().map(|c| c.width).fold(0.0, f64::max);
        let gap = mean_gap(&self.exemplar);
        if widest > gap {
            doubts.push(Warning::new(
                format!("strokes are wider ({widest:.4}) than the mean distance between them ({gap:.4}): they run into one another"),
                "use thinner strokes; lines closer than their width are taken to touch",
            ));
        }
        doubts
    }

    fn has_curves(&self) -> bool {
        self.settings.iter().any(|s| s.level.net.is_some())
    }

    fn check_request(&self, request: &Request<D>, expected: f64) -> Result<()> {
        let limit = Limits::default().output_elements;
        if expected.is_nan() || expected > limit as f64 {
            return Err(Error::Limit {
                what: "elements of the result".into(),
                found: format!("about {expected:.0}"),
                limit: limit.to_string(),
                advice: "fill a smaller domain, or raise the scale".into(),
            });
        }
        let known = self.exemplar.elements.len();
        match request.frozen.iter().find(|p| p.source >= known) {
            Some(p) => {
                Err(Error::parameter("frozen source", p.source, format!("below {known}, the number of elements")))
            }
            None => Ok(()),
        }
    }

    /// Levels whose neighbourhoods fit into the domain, and what to say about the rest.
    fn usable_levels(&self, request: &Request<D>) -> (Vec<usize>, Vec<Warning>) {
        let mut warnings = Vec::new();
        let inside = self.exemplar.elements.iter().filter(|e| self.exemplar.window.contains(e.centre)).count();
        if inside < FEW && !self.has_curves() {
            warnings.push(Warning::new(
                format!("the exemplar shows only {inside} elements"),
                format!("draw {FEW} or more, so that the output need not repeat the few arrangements there are"),
            ));
        }
        warnings.extend(self.doubts());
        let room = request
            .domain
            .period()
            .map_or(f64::INFINITY, |p| 0.5 * shortest(p) / Extent::<D>::largest_spacing_scale(request));
        let levels = self.settings.len();
        let fits: Vec<_> = (0..levels).filter(|&l| self.settings[l].level.radius <= room).collect();
        if fits.len() < levels {
            warnings.push(Warning::new(
                format!("the tile is too small for {} of {levels} levels", levels - fits.len()),
                "make the tile larger, or set a smaller radius",
            ));
        }
        (fits, warnings)
    }
}
