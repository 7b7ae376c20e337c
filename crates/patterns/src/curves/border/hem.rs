//! Strokes that turn at the border.
//!
//! All strokes are cut where their ink would touch the border: along the rings of the hem, polygons half a stroke width inside, their corners
//! rounded. Where strokes of the exemplar branch or cross, each ring becomes a stroke of its own on which the others end. Elsewhere
//! neighbours along the ring become one stroke, see [`super::turn`].

use std::any::Any;

use arabesque_core::{Drawn, Measured, Outline, Path, Region, Shape, Vector};

use crate::{
    curves::border::{
        fit::{fit, unit},
        trim::inside,
        turn::join,
    },
    exemplar::graph::net::Net,
    output::state::State,
};

/// Radius of turns, in sampling distances.
const TURN: f64 = 0.5;

/// Radius of turns, at least, in stroke widths.
const LEAST_TURN: f64 = 1.0;

/// Exemplars of which more than this share of the samples are junctions or crossings are nets.
const MEETINGS: f64 = 0.03;

/// Strokes are left out that stay within so many widths of the ring.
const ALONG: f64 = 1.0;

/// Strokes that end within so many widths of the ring are taken on to it.
const NEAR: f64 = 1.0;

/// Fitted lines keep to the ring within this share of the stroke width.
const TOLERANCE: f64 = 0.1;

/// Lines are fitted to points of the ring this share of the radius of turns apart.
const STEP: f64 = 0.25;

/// Most points on a side of a ring.
const MOST_STEPS: f64 = 10_000.0;

/// What the strokes of a pattern do at the border.
#[derive(Clone, Debug)]
pub(crate) struct Hem {
    /// What can be filled.
    outline: Outline<2>,
    curves: Vec<Thickness>,
    /// Distance of samples.
    unit: f64,
    end: End,
}

/// What the hem asks of an exemplar curve.
#[derive(Clone, Copy, Debug)]
struct Thickness {
    width: f64,
    style: usize,
    is_closed: bool,
}

/// How strokes end at the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// On a stroke along the border.
    OnRing,
    /// They turn into their neighbours.
    AsNeighbour,
}

/// A stroke cut at the hem.
#[derive(Clone, Debug)]
pub(crate) struct Thread {
    pub(crate) drawn: Drawn<2>,
    pub(crate) measured: Measured<2>,
    /// Where its start and its end reach a ring.
    pub(crate) reaches: [Option<Place>; 2],
    pub(crate) style: usize,
    /// Whether the exemplar's stroke is closed.
    pub(crate) is_closed: bool,
}

/// A place on a ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) ring: usize,
    pub(crate) arc: f64,
}

/// The rings of a hem.
#[derive(Clone, Debug)]
pub(crate) struct Rings {
    shape: Shape,
    pub(crate) all: Vec<Measured<2>>,
    /// Radius of turns.
    pub(crate) radius: f64,
    /// How far fitted lines may lie off the rings.
    pub(crate) tolerance: f64,
}

impl Hem {
    /// The hem of a state, if its strokes turn at the border and there is one.
    pub(crate) fn of<const D: usize>(state: &State<'_, D>, net: &Net<D>) -> Option<Self> {
        if state.extent.rule() != arabesque_core::Border::Turn {
            return None;
        }
        let last = net.skeleton.lines.iter().map(|l| l.curve).max()?;
        let thickness = |c: u32| {
            let (style, is_closed) = state.extent.style(c as usize);
            Thickness { width: state.width(c), style, is_closed }
        };
        let meetings = (0..net.nodes.len() as u32).filter(|&n| net.degree(n) > 2).count();
        let is_net = meetings as f64 > MEETINGS * net.nodes.len() as f64;
        Some(Self {
            outline: state.extent.outline()?,
            curves: (0..=last).map(thickness).collect(),
            unit: net.spacing * state.extent.smallest_spacing_scale,
            end: if is_net { End::OnRing } else { End::AsNeighbour },
        })
    }

    /// A hem for strokes of width 1; whether each curve is closed.
    #[cfg(test)]
    pub(crate) fn test(outline: Outline<2>, closed: &[bool], end: End) -> Self {
        let curves = closed.iter().enumerate().map(|(style, &is_closed)| Thickness { width: 1.0, style, is_closed });
        Self { outline, curves: curves.collect(), unit: 5.0, end }
    }

    /// Strokes cut and joined at the border.
    pub(crate) fn finish<const D: usize>(&self, mut strokes: Vec<Drawn<D>>) -> Vec<Drawn<D>> {
        // There is a hem in the plane alone.
        if let Some(plane) = (&mut strokes as &mut dyn Any).downcast_mut::<Vec<Drawn<2>>>() {
            *plane = self.hemmed(std::mem::take(plane));
        }
        strokes
    }

    fn width(&self, drawn: &Drawn<2>) -> f64 {
        self.curves.get(drawn.source).map_or(0.0, |c| c.width) * drawn.scale
    }

    fn hemmed(&self, strokes: Vec<Drawn<2>>) -> Vec<Drawn<2>> {
        let widest = strokes.iter().map(|d| self.width(d)).fold(0.0, f64::max);
        let Some(rings) = Rings::new(&self.outline, widest, self.unit) else { return Vec::new() };
        let threads: Vec<Thread> = strokes.iter().flat_map(|d| self.threads(d, &rings)).collect();
        match self.end {
            End::OnRing => with_rings(threads, &rings),
            End::AsNeighbour => join(threads, &rings),
        }
    }

    /// What is left of a stroke inside the hem.
    fn threads(&self, drawn: &Drawn<2>, rings: &Rings) -> Vec<Thread> {
        let width = self.width(drawn);
        let measured = Measured::new(drawn.path.clone(), 0.02 * self.unit);
        let spans = inside(&measured, 0.1 * self.unit, &|p| rings.depth(p) >= 0.0);
        let is_whole = measured.is_closed() && matches!(spans.as_slice(), [(a, b)] if b - a >= measured.length());
        let parts =
            spans.into_iter().map(|(a, b)| if is_whole { measured.path().clone() } else { measured.part(a, b) });
        parts.filter_map(|path| self.thread(Drawn { path, ..drawn.clone() }, width, rings)).collect()
    }

    fn thread(&self, mut drawn: Drawn<2>, width: f64, rings: &Rings) -> Option<Thread> {
        let measured = Measured::new(drawn.path.clone(), 0.02 * self.unit);
        let looks = (measured.length() / (0.1 * self.unit)).ceil().clamp(1.0, 1e4) as usize;
        let depth = |k: usize| rings.depth(measured.point(measured.length() * k as f64 / looks as f64));
        let is_scrap = (0..=looks).all(|k| depth(k) <= ALONG * width);
        if drawn.path.is_empty() || is_scrap {
            return None;
        }
        let mut reaches = [None; 2];
        if !drawn.path.closed {
            for (end, reach) in reaches.iter_mut().enumerate() {
                *reach = rings.take_on(&mut drawn.path, end, NEAR * width);
            }
        }
        let Thickness { style, is_closed, .. } = *self.curves.get(drawn.source)?;
        let measured = Measured::new(drawn.path.clone(), 0.02 * self.unit);
        Some(Thread { drawn, measured, reaches, style, is_closed })
    }
}

impl Rings {
    /// The rings for strokes of the given width in an outline, or `None` where there is no room for them.
    pub(crate) fn new(outline: &Outline<2>, width: f64, unit: f64) -> Option<Self> {
        let radius = (TURN * unit).max(LEAST_TURN * width);
        let tolerance = (TOLERANCE * width).max(1e-3 * unit);
        // A little more than half the width, so that fitted lines stay inside as well.
        let margin = 0.5 * width + tolerance;
        let shape = Shape::from_outline(outline.grown(-margin - radius).grown(radius))?;
        let all = shape.outline().rings.iter().map(|ring| {
            let around: Vec<_> = ring.iter().chain(ring.first()).copied().collect();
            Measured::new(Path { closed: true, ..Path::polyline(&around) }, tolerance)
        });
        Some(Self { all: all.collect(), shape, radius, tolerance })
    }

    /// How far inside the rings a place lies; negative outside.
    fn depth(&self, p: Vector<2>) -> f64 {
        self.shape.signed_distance(p)
    }

    /// Takes an end of a path on to a ring that is no farther than `near`, and says where it arrives.
    fn take_on(&self, path: &mut Path<2>, end: usize, near: f64) -> Option<Place> {
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
                let along = w[1] - w[0];
                let t = ((p - w[0]).dot(along) / along.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let gap = (w[0] + along * t - p).norm();
                if best.is_none_or(|(least, _)| gap < least) {
                    best = Some((gap, Place { ring, arc: measured.arc_of(k) + t * along.norm() }));
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
            let count = ((c[3] - c[0]).norm() / (STEP * self.radius)).ceil().clamp(1.0, MOST_STEPS);
            points.extend((1..=count as usize).map(|k| c[0] + (c[3] - c[0]) * (k as f64 / count)));
        }
        fit(&points, [self.way(ring, from), self.way(ring, to)], 0.5 * self.tolerance)
    }

    /// Direction of a ring at an arc length.
    pub(crate) fn way(&self, ring: usize, arc: f64) -> Vector<2> {
        let measured = &self.all[ring];
        let step = (2.0 * self.tolerance).min(0.1 * measured.length());
        let at = |arc: f64| measured.point(arc.rem_euclid(measured.length()));
        unit(at(arc + step) - at(arc - step))
    }
}

/// The strokes as they are, and a closed one along each ring that they reach, in the style of most that do.
fn with_rings(threads: Vec<Thread>, rings: &Rings) -> Vec<Drawn<2>> {
    let mut hems: Vec<Drawn<2>> = Vec::new();
    for (number, ring) in rings.all.iter().enumerate() {
        let is_here = |p: &Option<Place>| p.is_some_and(|p| p.ring == number);
        let ends = |t: &Thread| t.reaches.iter().filter(|p| is_here(p)).count();
        let total = |style: usize| threads.iter().filter(|t| t.style == style).map(&ends).sum::<usize>();
        let reaching = threads.iter().filter(|t| ends(t) > 0);
        let Some(model) = reaching.max_by_key(|t| (total(t.style), std::cmp::Reverse(t.style))) else { continue };
        let mut path = Path { cubics: rings.run(number, 0.0, ring.length()), closed: true };
        if let Some(&[first, ..]) = path.cubics.first()
            && let Some(last) = path.cubics.last_mut()
        {
            last[3] = first;
        }
        hems.push(Drawn { path, ..model.drawn.clone() });
    }
    threads.into_iter().map(|t| t.drawn).chain(hems).collect()
}
