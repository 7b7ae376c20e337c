//! Dividing the page into charts, and laying them so that the lattice goes on from one to the next.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, Result, Vector};

use crate::{
    regular::bend::{
        chart::Chart,
        raster::{Raster, Wanted},
    },
    repeat::lattice::Lattice,
};

/// The lattice is stretched, or turned away from what is wanted, by no more than this.
const STRETCH: f64 = 0.25;

/// Growth over a chart, as a logarithm, that takes so much stretching.
const GROWTH: f64 = 0.42;

/// Charts whose growth differs by more than this many times that are not one.
const HOPELESS: f64 = 2.6;

/// Most charts.
const MOST: usize = 200;

/// A chart of fewer cells of the lattice than this is as it is.
const FEWEST: f64 = 3.0;

/// Share of the page on which the fields may be followed less closely.
const LOST: f64 = 0.15;

/// Lattices that meet within this share of the shorter vector do not break.
const BREAK: f64 = 0.06;

/// Work for each cell that is sorted.
const SORT: u64 = 60;

/// What is bent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bent<'a> {
    pub(crate) raster: &'a Raster,
    pub(crate) wanted: &'a Wanted,
    pub(crate) lattice: &'a Lattice,
    /// The direction in which stripes repeat, which do not change along the other.
    pub(crate) across: Option<Vector<2>>,
}

/// The charts of a page.
#[derive(Clone, Debug)]
pub(crate) struct Charts {
    pub(crate) all: Vec<Chart>,
    /// Largest stretch, as far as the fields are followed.
    pub(crate) stretch: f64,
    /// Borders between charts along which the lattice breaks.
    pub(crate) breaks: usize,
}

impl Bent<'_> {
    /// Charts for some cells of the raster; `None` where the fields cannot be followed.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn charts(&self, cells: Vec<usize>, budget: &Budget) -> Result<Option<Charts>> {
        let count = cells.len();
        let (mut all, mut stretch, mut lost) = (Vec::new(), 0.0_f64, 0_usize);
        let mut open = self.pieces(cells, budget)?;
        while let Some(piece) = open.pop() {
            let chart = Chart::new(self.raster, self.wanted, piece, budget)?;
            let off: Vec<f64> = chart.cells.iter().map(|&c| chart.stretch(self.wanted, c, self.across)).collect();
            let worst = off.iter().copied().fold(0.0, f64::max);
            if worst > STRETCH && self.size(&chart.cells) > FEWEST {
                open.extend(self.divided(&chart.cells, budget)?);
            } else {
                lost += off.iter().filter(|off| **off > STRETCH).count();
                stretch = off.iter().copied().filter(|off| *off <= STRETCH).fold(stretch, f64::max);
                all.push(chart);
            }
            if all.len() + open.len() > MOST {
                return Ok(None);
            }
        }
        if all.is_empty() || lost as f64 > LOST * count as f64 {
            return Ok(None);
        }
        self.unite(&mut all, &mut stretch, budget)?;
        all.sort_by_key(|chart| (std::cmp::Reverse(chart.cells.len()), chart.cells.first().copied()));
        let breaks = self.align(&mut all, budget)?;
        Ok(Some(Charts { all, stretch, breaks }))
    }

    /// Makes one chart of two neighbours where that stays within bounds.
    fn unite(&self, charts: &mut Vec<Chart>, stretch: &mut f64, budget: &Budget) -> Result<()> {
        let mut refused: BTreeSet<(usize, usize)> = BTreeSet::new();
        for _ in 0..MOST {
            let shared = shared(charts, budget)?;
            let by_length = |((a, b), nodes): (&(usize, usize), &Vec<usize>)| (nodes.len(), *a, *b);
            // Charts are known by their first cells, which no other has.
            let key = |a: usize, b: usize| (charts[a].cells[0], charts[b].cells[0]);
            let mut pairs: Vec<_> = shared.iter().map(by_length).filter(|(n, ..)| *n > 1).collect();
            pairs.sort_by_key(|(n, a, b)| (std::cmp::Reverse(*n), *a, *b));
            let mut united = None;
            for (_, a, b) in pairs {
                if !refused.insert(key(a, b)) {
                    continue;
                }
                let mut cells: Vec<usize> = charts[a].cells.iter().chain(&charts[b].cells).copied().collect();
                cells.sort_unstable();
                let (low, high) = self.range(&cells);
                if self.across.is_none() && high - low > HOPELESS * GROWTH {
                    continue;
                }
                let chart = Chart::new(self.raster, self.wanted, cells, budget)?;
                let off = chart.cells.iter().map(|&c| chart.stretch(self.wanted, c, self.across)).fold(0.0, f64::max);
                if off <= STRETCH {
                    *stretch = stretch.max(off);
                    united = Some((a, b, chart));
                    break;
                }
            }
            let Some((a, b, chart)) = united else { break };
            let (low, high) = (a.min(b), a.max(b));
            // A chart that has grown is another.
            let (p, q) = (charts[low].cells[0], charts[high].cells[0]);
            refused.retain(|(x, y)| ![*x, *y].contains(&p) && ![*x, *y].contains(&q));
            charts.remove(high);
            charts[low] = chart;
        }
        Ok(())
    }

    /// How many cells of the lattice lie in some of the raster.
    fn size(&self, cells: &[usize]) -> f64 {
        let area: f64 = cells.iter().map(|&c| self.wanted.growth[c].powi(-2)).sum();
        area * self.raster.step.powi(2) / self.lattice.cell()
    }

    /// Cells in two parts or more, each in one piece: by growth where that differs too much, else across their length.
    fn divided(&self, cells: &[usize], budget: &Budget) -> Result<Vec<Vec<usize>>> {
        let (low, high) = self.range(cells);
        // Not many at once: what growth differs by in one direction is stretched less than along all of a circle.
        let bands = if high - low > 3.0 * GROWTH { 2.0 } else { ((high - low) / GROWTH).ceil() };
        let part: Box<dyn Fn(usize) -> usize> = if self.across.is_none() && bands > 1.0 && bands.is_finite() {
            Box::new(move |c| (((self.wanted.misfit[c] - low) / (high - low) * bands) as usize).min(bands as usize - 1))
        } else {
            let (mean, axis) = self.length(cells);
            let along = move |c: usize| (self.raster.centre(c) - mean).dot(axis);
            Box::new(move |c| usize::from(along(c) > 0.0))
        };
        let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &cell in cells {
            parts.entry(part(cell)).or_default().push(cell);
        }
        if parts.len() < 2 {
            // Cells in one place: each half of the list.
            let half = cells.len() / 2;
            parts = BTreeMap::from([(0, cells[..half].to_vec()), (1, cells[half..].to_vec())]);
        }
        let mut pieces = Vec::new();
        for part in parts.into_values() {
            pieces.extend(self.pieces(part, budget)?);
        }
        Ok(pieces)
    }

    /// Least and most growth that some cells would have to have.
    fn range(&self, cells: &[usize]) -> (f64, f64) {
        let misfit = cells.iter().map(|c| self.wanted.misfit[*c]);
        misfit.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    }

    /// The middle of some cells, and the direction in which they reach farthest.
    fn length(&self, cells: &[usize]) -> (Vector<2>, Vector<2>) {
        let count = cells.len().max(1) as f64;
        let mean = cells.iter().fold(Vector::ZERO, |sum, &c| sum + self.raster.centre(c)) * (1.0 / count);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for &cell in cells {
            let v = self.raster.centre(cell) - mean;
            (xx, xy, yy) = (xx + v[0] * v[0], xy + v[0] * v[1], yy + v[1] * v[1]);
        }
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        (mean, Vector::xy(angle.cos(), angle.sin()))
    }

    /// The connected pieces of some cells, each in rising order.
    fn pieces(&self, cells: Vec<usize>, budget: &Budget) -> Result<Vec<Vec<usize>>> {
        budget.spend(SORT * cells.len() as u64)?;
        let mut left: BTreeSet<usize> = cells.into_iter().collect();
        let mut pieces = Vec::new();
        while let Some(first) = left.pop_first() {
            let (mut piece, mut seen) = (vec![first], 0);
            while seen < piece.len() {
                let cell = piece[seen];
                seen += 1;
                piece.extend((0..4).filter_map(|way| self.raster.beside(cell, way)).filter(|next| left.remove(next)));
            }
            piece.sort_unstable();
            pieces.push(piece);
        }
        Ok(pieces)
    }

    /// Moves charts, one after the other, to where their lattice meets that of their neighbours best. Returns along how
    /// many borders it breaks.
    fn align(&self, charts: &mut [Chart], budget: &Budget) -> Result<usize> {
        let shared = shared(charts, budget)?;
        let mut is_laid = vec![false; charts.len()];
        is_laid[0] = true;
        for _ in 1..charts.len() {
            // The one that borders most on what is laid already.
            let mut borders: BTreeMap<usize, usize> = BTreeMap::new();
            for (&(a, b), nodes) in shared.iter().filter(|((a, b), _)| is_laid[*a] != is_laid[*b]) {
                *borders.entry(if is_laid[a] { b } else { a }).or_default() += nodes.len();
            }
            let next = borders.iter().max_by_key(|(k, count)| (**count, std::cmp::Reverse(**k))).map(|(k, _)| *k);
            let Some(next) = next.or_else(|| is_laid.iter().position(|laid| !laid)) else { break };
            let of_next = shared.iter().filter(|((a, b), _)| *a == next || *b == next);
            let mut offsets = Vec::new();
            for (&(a, b), nodes) in of_next {
                let other = if a == next { b } else { a };
                if is_laid[other] {
                    offsets
                        .extend(nodes.iter().filter_map(|&n| Some(charts[other].image(n)? - charts[next].image(n)?)));
                }
            }
            charts[next].move_by(self.common(&offsets));
            is_laid[next] = true;
        }
        let breaks = shared.iter().filter(|((a, b), nodes)| self.breaks(&charts[*a], &charts[*b], nodes));
        Ok(breaks.count())
    }

    /// The vector from which others differ by about whole steps of the lattice: the mean of their shares of a step, on a circle.
    fn common(&self, offsets: &[Vector<2>]) -> Vector<2> {
        let turn = std::f64::consts::TAU;
        let mut sums = [(0.0_f64, 0.0_f64); 2];
        for offset in offsets {
            let shares = self.lattice.coordinates(*offset);
            for (k, sum) in sums.iter_mut().enumerate() {
                let (sin, cos) = (turn * shares[k]).sin_cos();
                *sum = (sum.0 + sin, sum.1 + cos);
            }
        }
        self.lattice.vector(Vector(sums.map(|(sin, cos)| sin.atan2(cos) / turn)))
    }

    fn breaks(&self, a: &Chart, b: &Chart, nodes: &[usize]) -> bool {
        let offsets = nodes.iter().filter_map(|&n| Some(a.image(n)? - b.image(n)?));
        let rest = |v: Vector<2>| {
            let rest = self.lattice.nearest(v).1;
            self.across.map_or(rest.norm(), |n| rest.dot(n).abs())
        };
        let off: Vec<f64> = offsets.map(rest).collect();
        nodes.len() > 1 && off.iter().sum::<f64>() > BREAK * self.lattice.shorter() * off.len() as f64
    }
}

/// The nodes that charts have in common, for each pair of them that has some.
fn shared(charts: &[Chart], budget: &Budget) -> Result<BTreeMap<(usize, usize), Vec<usize>>> {
    let mut of_node: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, chart) in charts.iter().enumerate() {
        budget.spend(SORT * chart.nodes().len() as u64)?;
        chart.nodes().iter().for_each(|&node| of_node.entry(node).or_default().push(k));
    }
    let mut shared: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (node, of) in &of_node {
        for (i, &a) in of.iter().enumerate() {
            of[i + 1..].iter().for_each(|&b| shared.entry((a, b)).or_default().push(*node));
        }
    }
    Ok(shared)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Bounds, Fields, Grid, Matrix, OrientationField};

    use super::*;

    /// Charts for a pattern on a square lattice that is turned by `angle` at each place.
    fn charts(angle: impl Fn(Vector<2>) -> f64) -> Option<Charts> {
        let bounds = Bounds::new(Vector::ZERO, Vector::xy(200.0, 150.0));
        let mut field = Grid { bounds, nodes: [101, 76], values: vec![Matrix::identity(); 101 * 76] };
        for k in 0..field.values.len() {
            field.values[k] = Matrix::rotation(angle(field.node(k)));
        }
        let fields = Fields { orientation: Some(OrientationField::Grid(field)), ..Fields::default() };
        let raster = Raster::over(&bounds, 10.0);
        let wanted = Wanted::new(&raster, &fields, &Budget::default()).unwrap();
        let lattice = Lattice::new(Vector::xy(10.0, 0.0), Vector::xy(0.0, 10.0)).unwrap();
        let bent = Bent { raster: &raster, wanted: &wanted, lattice: &lattice, across: None };
        bent.charts((0..raster.count()).collect(), &Budget::default()).unwrap()
    }

    #[test]
    fn a_gentle_turn_takes_one_chart_and_goes_back_where_it_came_from() {
        let found = charts(|p| 0.15 * (p[0] / 60.0).sin()).unwrap();
        assert!(found.all.len() == 1 && found.breaks == 0 && found.stretch < 0.25, "{}", found.stretch);
        let chart = &found.all[0];
        for &node in chart.nodes().iter().step_by(37) {
            let image = chart.image(node).unwrap();
            let there = chart.find(image).or_else(|| chart.find_near(image)).unwrap();
            assert!((chart.raster_node(node) - there.at).norm() < 1e-6);
        }
    }

    #[test]
    fn rings_around_a_place_break_the_lattice_along_a_few_lines() {
        let hub = Vector::xy(100.0, -60.0);
        let ring = move |p: Vector<2>| (p - hub)[0].atan2(-(p - hub)[1]);
        let found = charts(ring).unwrap();
        assert!((2..=12).contains(&found.all.len()), "{} charts", found.all.len());
        assert!(found.stretch <= STRETCH);
    }
}
