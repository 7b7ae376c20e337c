//! The rings on which strokes end or turn: the border of the domain, moved inside.

use arabesque_core::{Budget, Drawn, Measured, Outline, Path, Region, Result, Shape, Vector, segment};

use crate::curves::border::fit::fit;

/// Radius of turns, in sampling distances.
const TURN: f64 = 0.5;

/// Radius of turns, at least, in stroke widths.
const MIN_TURN: f64 = 1.0;

/// Fitted lines keep to the ring within this share of the stroke width.
const TOLERANCE: f64 = 0.1;

/// Lines are fitted to points of the ring this share of the radius of turns apart.
const STEP: f64 = 0.25;

/// Most points on a side of a ring.
const MAX_STEPS: f64 = 10_000.0;

/// A place on a ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) ring: usize,
    pub(crate) arc: f64,
}

/// A stroke cut at the rings.
#[derive(Clone, Debug)]
pub(crate) struct ClippedStroke {
    pub(crate) drawn: Drawn<2>,
    pub(crate) measured: Measured<2>,
    /// Where its start and its end reach a ring.
    pub(crate) reaches: [Option<Place>; 2],
    pub(crate) style: usize,
    /// Whether the exemplar's stroke is closed.
    pub(crate) is_closed: bool,
}

/// The border moved inside, in rings.
#[derive(Clone, Debug)]
pub(crate) struct OffsetRings {
    shape: Shape,
    pub(crate) all: Vec<Measured<2>>,
    /// Radius of turns.
    pub(crate) radius: f64,
    /// How far fitted lines may lie off the rings.
    pub(crate) tolerance: f64,
}

impl OffsetRings {
    /// The rings for strokes of the given width in an outline, or `None` where there is no room for them.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(outline: &Outline<2>, width: f64, unit: f64, budget: &Budget) -> Result<Option<Self>> {
        let radius = (TURN * unit).max(MIN_TURN * width);
        let tolerance = (TOLERANCE * width).max(1e-3 * unit);
        // A little more than half the width, so that fitted lines stay inside as well.
        let margin = 0.5 * width + tolerance;
        let rounded = outline.try_grown(-margin - radius, budget)?.try_grown(radius, budget)?;
        let Some(shape) = Shape::try_from_outline(rounded, budget)? else { return Ok(None) };
        let all = shape.outline().rings.iter().map(|ring| {
            let around: Vec<_> = ring.iter().chain(ring.first()).copied().collect();
            Measured::new(Path { closed: true, ..Path::polyline(&around) }, tolerance)
        });
        Ok(Some(Self { all: all.collect(), shape, radius, tolerance }))
    }

    /// Number of points of all rings.
    pub(crate) fn corners(&self) -> usize {
        self.all.iter().map(|ring| ring.points().len()).sum()
    }

    /// How far inside the rings a place lies; negative outside.
    pub(crate) fn depth(&self, p: Vector<2>) -> f64 {
        self.shape.signed_distance(p)
    }

    /// Takes an end of a path on to a ring that is no farther than `near`, and says where it arrives.
    pub(crate) fn take_on(&self, path: &mut Path<2>, end: usize, near: f64) -> Option<Place> {
        let tip = if end == 0 { path.start() } else { path.end() }?;
        if self.depth(tip).abs() > near {
            return None;
        }
        let place = self.nearest(tip)?;
        let there = self.all[place.ring].point(place.arc);
        match (end, path.cubics.first_mut()) {
            (0, Some(first)) => (first[0], first[1]) = (there, first[1] + there - tip),
            _ => {
                if let Some(last) = path.cubics.last_mut() {
                    (last[3], last[2]) = (there, last[2] + there - tip);
                }
            }
        }
        Some(place)
    }

    fn nearest(&self, p: Vector<2>) -> Option<Place> {
        let mut best: Option<(f64, Place)> = None;
        for (ring, measured) in self.all.iter().enumerate() {
            for (k, w) in measured.points().windows(2).enumerate() {
                let edge = (w[0], w[1]);
                let gap = segment::distance(edge, p);
                if best.is_none_or(|(least, _)| gap < least) {
                    best = Some((
                        gap,
                        Place {
                            ring,
                            arc: measured.arc_of(k) + segment::nearest_share(edge, p) * (w[1] - w[0]).norm(),
                        },
                    ));
                }
            }
        }
        best.map(|b| b.1)
    }

    /// The path along a ring from one arc length to another beyond it.
    pub(crate) fn run(&self, ring: usize, from: f64, to: f64) -> Vec<[Vector<2>; 4]> {
        let measured = &self.all[ring];
        let part = measured.part(from, to);
        let mut points: Vec<_> = part.start().into_iter().collect();
        for c in &part.cubics {
            // Long straight sides next to short edges around a corner would take their bend over.
            let count = ((c[3] - c[0]).norm() / (STEP * self.radius)).ceil().clamp(1.0, MAX_STEPS);
            points.extend((1..=count as usize).map(|k| c[0] + (c[3] - c[0]) * (k as f64 / count)));
        }
        fit(&points, [self.way(ring, from), self.way(ring, to)], 0.5 * self.tolerance)
    }

    /// Direction of a ring at an arc length.
    pub(crate) fn way(&self, ring: usize, arc: f64) -> Vector<2> {
        let measured = &self.all[ring];
        let step = (2.0 * self.tolerance).min(0.1 * measured.length());
        let at = |arc: f64| measured.point(arc.rem_euclid(measured.length()));
        (at(arc + step) - at(arc - step)).unit_or_zero()
    }
}
