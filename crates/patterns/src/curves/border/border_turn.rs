//! Strokes that turn at the border.
//!
//! All strokes are cut where their ink would touch the border: along rings half a stroke width inside, their corners
//! rounded. Where strokes of the exemplar branch or cross, each ring becomes a stroke of its own on which the others
//! end. Elsewhere neighbours along the ring become one stroke, see [`super::join`]. A drawing of the exemplar's kind
//! then has no end that it would not have by itself, and can be cut out or stitched along its border.

use arabesque_core::{Budget, Drawn, Measured, Outline, Path, Result, Vector, spans_inside};

use crate::{
    curves::border::{
        join::join,
        rings::{ClippedStroke, OffsetRings, Place},
    },
    dimension::Dimension,
    exemplar::graph::net::Net,
    output::state::State,
};

/// Exemplars of which more than this share of the samples are junctions or crossings are nets.
const MEETINGS: f64 = 0.03;

/// Strokes are left out that stay within so many widths of the ring.
const ALONG: f64 = 1.0;

/// Strokes that end within so many widths of the ring are taken on to it.
const NEAR: f64 = 1.0;

/// Nanoseconds for a place of a stroke that is looked at, and for a corner of a ring that is compared with an end.
const PRICE: (u64, u64) = (150, 5);

/// What the strokes of a pattern do at the border.
#[derive(Clone, Debug)]
pub(crate) struct BorderTurn {
    budget: Budget,
    /// What can be filled.
    outline: Outline<2>,
    curves: Vec<Thickness>,
    /// Distance of samples.
    unit: f64,
    ending: Ending,
}

/// What is asked of an exemplar curve here.
#[derive(Clone, Copy, Debug)]
struct Thickness {
    width: f64,
    style: usize,
    is_closed: bool,
}

/// How strokes end at the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// On a stroke along the border.
    BorderStroke,
    /// They turn into their neighbours.
    IntoNeighbour,
}

impl BorderTurn {
    /// For a state whose strokes turn at the border, if there is one.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn of<const D: usize>(state: &State<'_, D>, net: &Net<D>) -> Result<Option<Self>>
    where
        Vector<D>: Dimension<D>,
    {
        if state.extent.rule() != arabesque_core::Border::Turn {
            return Ok(None);
        }
        let budget = state.budget.stage("turning strokes at the border");
        let Some(last) = net.skeleton.lines.iter().map(|l| l.curve).max() else { return Ok(None) };
        let Some(outline) = state.extent.outline(&budget)? else { return Ok(None) };
        let thickness = |c: u32| {
            let (style, is_closed) = state.extent.style(c as usize);
            Thickness { width: state.width(c), style, is_closed }
        };
        let meetings = (0..net.nodes.len() as u32).filter(|&n| net.degree(n) > 2).count();
        let is_net = meetings as f64 > MEETINGS * net.nodes.len() as f64;
        Ok(Some(Self {
            budget,
            outline,
            curves: (0..=last).map(thickness).collect(),
            unit: net.spacing * state.extent.smallest_spacing_scale,
            ending: if is_net { Ending::BorderStroke } else { Ending::IntoNeighbour },
        }))
    }

    /// For strokes of width 1; whether each curve is closed.
    #[cfg(test)]
    pub(crate) fn test(outline: Outline<2>, closed: &[bool], ending: Ending) -> Self {
        let curves = closed.iter().enumerate().map(|(style, &is_closed)| Thickness { width: 1.0, style, is_closed });
        Self { budget: Budget::default(), outline, curves: curves.collect(), unit: 5.0, ending }
    }

    /// Strokes cut and joined at the border.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn finish<const D: usize>(&self, strokes: Vec<Drawn<D>>) -> Result<Vec<Drawn<D>>>
    where
        Vector<D>: Dimension<D>,
    {
        Vector::map_plane_strokes(strokes, |strokes| self.turned(strokes))
    }

    fn width(&self, drawn: &Drawn<2>) -> f64 {
        self.curves.get(drawn.source).map_or(0.0, |c| c.width) * drawn.scale
    }

    fn turned(&self, strokes: Vec<Drawn<2>>) -> Result<Vec<Drawn<2>>> {
        let widest = strokes.iter().map(|d| self.width(d)).fold(0.0, f64::max);
        self.budget.check()?;
        let Some(rings) = OffsetRings::new(&self.outline, widest, self.unit, &self.budget)? else {
            return Ok(Vec::new());
        };
        let corners = rings.corners() as u64;
        let mut meter = self.budget.meter();
        let mut clipped: Vec<ClippedStroke> = Vec::new();
        for drawn in &strokes {
            let parts = self.clip(drawn, &rings);
            let looks = parts.iter().map(|p| p.measured.length() / (0.05 * self.unit)).sum::<f64>();
            meter.spend(PRICE.0 * (20 + looks as u64) + 2 * PRICE.1 * corners * (1 + parts.len() as u64))?;
            clipped.extend(parts);
        }
        match self.ending {
            Ending::BorderStroke => with_rings(clipped, &rings, &self.budget),
            Ending::IntoNeighbour => join(clipped, &rings, &self.budget),
        }
    }

    /// What is left of a stroke inside the rings.
    fn clip(&self, drawn: &Drawn<2>, rings: &OffsetRings) -> Vec<ClippedStroke> {
        let width = self.width(drawn);
        let measured = Measured::new(drawn.path.clone(), 0.02 * self.unit);
        let spans = spans_inside(&measured, 0.1 * self.unit, &|p| rings.depth(p) >= 0.0);
        let is_whole = measured.is_closed() && matches!(spans.as_slice(), [(a, b)] if b - a >= measured.length());
        let parts =
            spans.into_iter().map(|(a, b)| if is_whole { measured.path().clone() } else { measured.part(a, b) });
        parts.filter_map(|path| self.clip_part(Drawn { path, ..drawn.clone() }, width, rings)).collect()
    }

    fn clip_part(&self, mut drawn: Drawn<2>, width: f64, rings: &OffsetRings) -> Option<ClippedStroke> {
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
        Some(ClippedStroke { drawn, measured, reaches, style, is_closed })
    }
}

/// The strokes as they are, and a closed one along each ring that they reach, in the style of most that do.
fn with_rings(clipped: Vec<ClippedStroke>, rings: &OffsetRings, budget: &Budget) -> Result<Vec<Drawn<2>>> {
    let mut meter = budget.meter();
    let mut along_rings: Vec<Drawn<2>> = Vec::new();
    for (number, ring) in rings.all.iter().enumerate() {
        let is_here = |p: &Option<Place>| p.is_some_and(|p| p.ring == number);
        let ends = |t: &ClippedStroke| t.reaches.iter().filter(|p| is_here(p)).count();
        let total = |style: usize| clipped.iter().filter(|t| t.style == style).map(&ends).sum::<usize>();
        let reaching = clipped.iter().filter(|t| ends(t) > 0);
        let count = reaching.clone().count();
        meter.spend(PRICE.1 * clipped.len() as u64 * (1 + count as u64))?;
        let Some(model) = reaching.max_by_key(|t| (total(t.style), std::cmp::Reverse(t.style))) else { continue };
        let mut path = Path { cubics: rings.run(number, 0.0, ring.length()), closed: true };
        if let Some(&[first, ..]) = path.cubics.first()
            && let Some(last) = path.cubics.last_mut()
        {
            last[3] = first;
        }
        along_rings.push(Drawn { path, ..model.drawn.clone() });
    }
    Ok(clipped.into_iter().map(|t| t.drawn).chain(along_rings).collect())
}
