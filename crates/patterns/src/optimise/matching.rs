//! How alike two neighbourhoods are, and which samples correspond [Tu 2020 §4.2].
//!
//! The neighbourhood of an output sample is laid over the one of an exemplar sample, centres together, in the local
//! frame. Pairs cost their squared distance in place and attributes. Robust matching assigns at the least total cost
//! and lets a sample stay alone at the squared outlier distance; beyond the paper, exemplar samples inside the radius
//! that find no partner cost the same, so that holes count as much as surplus elements. Hard matching pairs nearest
//! first and charges nothing for what is missing [Ma 2011 §3.2].

use arabesque_core::{Meter, Numbered, Result, Vector};

use crate::{
    exemplar::{
        differences::Differing,
        graph::net::Star,
        level::{Level, Near},
        library::Library,
    },
    optimise::assignment::Assignment,
    params::Matching,
};

/// Cost of a sample that hard matching leaves without a partner, in squared outlier distances.
const LEFT_OVER: f32 = 4.0;

/// Nanoseconds for a row, and for a pair that is priced.
const PRICE: (u64, u64) = (8, 4);

/// A neighbour of an output sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<const D: usize> {
    /// The neighbour.
    pub(crate) sample: u32,
    /// Its key.
    pub(crate) key: u32,
    /// Exemplar element that is drawn there now.
    pub(crate) source: u32,
    /// From the centre, in exemplar directions and units.
    pub(crate) offset: Vector<D>,
    /// Weight by distance.
    pub(crate) weight: f32,
    /// Whether it may not be an outlier: samples of frozen elements. Those of frozen strokes lie where the pen put
    /// them, and their neighbours along the stroke serve as well.
    pub(crate) frozen: bool,
}

/// The neighbourhood of one output sample.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surroundings<const D: usize> {
    /// The centre.
    pub(crate) sample: u32,
    /// Exemplar element that is drawn at the centre now.
    pub(crate) source: u32,
    /// The neighbours.
    pub(crate) rows: Vec<Row<D>>,
}

/// Partners under one exemplar sample.
#[derive(Clone, Debug, Default)]
pub(crate) struct Correspondence {
    /// (row, exemplar sample), by row.
    pub(crate) pairs: Vec<(u32, u32)>,
    /// Exemplar samples within the radius that have no partner.
    pub(crate) missing: Vec<u32>,
}

/// What is charged besides the pairs, relative to the cost of a surplus sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prices {
    /// An exemplar sample inside the radius without a partner.
    pub(crate) missing: f32,
    /// An exemplar sample inside the radius that would come to lie outside the domain [Ma 2011 §5, eq. 6].
    pub(crate) outside: f32,
}

/// Compares neighbourhoods; keeps its buffers between calls.
pub(crate) struct Matcher<'a, const D: usize> {
    level: &'a Level<D>,
    library: &'a Library<D>,
    /// Edges of the samples that neighbourhoods consist of, in exemplar directions and units; of those of elements none are asked for.
    stars: &'a Numbered<Star<D>>,
    matching: Matching,
    prices: Prices,
    assignment: Assignment,
    used: Numbered<bool>,
    /// The partners that were kept, by row.
    kept: Vec<Option<u32>>,
}

impl<'a, const D: usize> Matcher<'a, D> {
    /// `stars`: the edges of the samples whose neighbourhoods are compared, by the numbers that their rows have.
    pub(crate) fn new(
        level: &'a Level<D>,
        library: &'a Library<D>,
        stars: &'a Numbered<Star<D>>,
        matching: Matching,
        prices: Prices,
    ) -> Self {
        let (assignment, used, kept) = Default::default();
        Self { level, library, stars, matching, prices, assignment, used, kept }
    }

    /// Cost of laying the neighbourhood of exemplar sample `i` under `around`, or infinity once it is sure to exceed
    /// `limit`. `wanted(p)` tells whether something that lies at offset `p` could be in the output at all.
    pub(crate) fn cost(
        &mut self,
        around: &Surroundings<D>,
        i: u32,
        limit: f32,
        wanted: &dyn Fn(Vector<D>) -> bool,
        meter: &mut Meter<'_>,
    ) -> Result<f32> {
        let centre = Difference::new(self, around.source, around.sample).of(self.level, i);
        let pairs = match self.matching {
            Matching::Robust => self.robust(around, i, limit - centre, meter)?,
            Matching::Hard => self.hard(around, i, limit - centre, meter)?,
        };
        let cost = centre + pairs;
        if cost > limit {
            return Ok(cost);
        }
        meter.spend(PRICE.1 * self.level.neighbours(i).len() as u64)?;
        Ok(cost + self.missing_cost(i, wanted) + self.outside_cost(i, wanted))
    }

    fn robust(&mut self, around: &Surroundings<D>, i: u32, limit: f32, meter: &mut Meter<'_>) -> Result<f32> {
        let level = self.level;
        let near = level.neighbours(i);
        let origin = level.position[i];
        self.assignment.begin(near.len());
        for row in &around.rows {
            let outlier2 = level.outlier2[row.key];
            // Nobody knows what lies beyond the frame of the exemplar: half the price.
            let seen = self.library.view.contains(origin + row.offset);
            let alone = if seen { outlier2 } else { 0.5 * outlier2 };
            self.assignment.begin_row(if row.frozen { 4.0 * row.weight * alone } else { row.weight * alone });
            let offset = row.offset.0.map(|v| v as f32);
            // A frozen element may find its partner anywhere.
            let most = if row.frozen { f32::INFINITY } else { outlier2 };
            let difference = Difference::new(self, row.source, row.sample);
            let assignment = &mut self.assignment;
            let looked = level.near_offset(i, row.key, offset, most, |column, d2| {
                let d2 = d2 + difference.near_one(level, &near[column]);
                assignment.pair(column as u32, row.weight * d2);
            });
            meter.spend(PRICE.0 + PRICE.1 * difference.price() * looked as u64)?;
            if self.assignment.end_row() > limit {
                return Ok(f32::INFINITY);
            }
        }
        self.assignment.settle(meter)
    }

    fn hard(&mut self, around: &Surroundings<D>, i: u32, limit: f32, meter: &mut Meter<'_>) -> Result<f32> {
        let level = self.level;
        let near = level.neighbours(i);
        self.assignment.begin(near.len());
        let mut bound = 0.0;
        for row in &around.rows {
            // Only a neighbourhood that is too small leaves a row over; charge it so that such a sample is a last
            // resort.
            let mut least = LEFT_OVER * level.outlier2[row.key];
            let offset = row.offset.0.map(|v| v as f32);
            self.assignment.begin_row(f32::INFINITY);
            let columns = level.neighbours_of_key(i, row.key);
            let difference = Difference::new(self, row.source, row.sample);
            meter.spend(PRICE.0 + PRICE.1 * difference.price() * columns.len() as u64)?;
            for column in columns {
                let other = &near[column];
                let d2: f32 = (0..D).map(|k| (offset[k] - other.offset[k]) * (offset[k] - other.offset[k])).sum();
                let d2 = d2 + difference.near_one(level, other);
                self.assignment.pair(column as u32, d2);
                least = least.min(d2);
            }
            self.assignment.end_row();
            bound += least;
            if bound > limit {
                return Ok(f32::INFINITY);
            }
        }
        let total = self.assignment.settle_greedily(meter)?;
        let alone = around.rows.iter().zip(self.assignment.column_of()).filter(|(_, column)| column.is_none());
        Ok(total + alone.map(|(row, _)| LEFT_OVER * level.outlier2[row.key]).sum::<f32>())
    }

    fn missing_cost(&mut self, i: u32, wanted: &dyn Fn(Vector<D>) -> bool) -> f32 {
        if self.prices.missing == 0.0 || self.matching == Matching::Hard {
            return 0.0;
        }
        let near = self.level.neighbours(i);
        self.mark_used(near.len());
        let absent = near.iter().zip(&self.used).filter(|(other, used)| other.weight > 0.0 && !**used);
        let sum: f32 = absent
            .filter(|(other, _)| wanted(Vector(other.offset.map(f64::from))))
            .map(|(other, _)| other.weight * self.level.outlier2[self.level.key[other.sample]])
            .sum();
        self.prices.missing * sum
    }

    fn outside_cost(&self, i: u32, wanted: &dyn Fn(Vector<D>) -> bool) -> f32 {
        if self.prices.outside == 0.0 {
            return 0.0;
        }
        let near = self.level.neighbours(i).iter().filter(|other| other.weight > 0.0);
        let outside = near.filter(|other| !wanted(Vector(other.offset.map(f64::from))));
        let price = |other: &Near<D>| other.weight * self.level.outlier2[self.level.key[other.sample]];
        self.prices.outside * outside.map(price).sum::<f32>()
    }

    fn mark_used(&mut self, columns: usize) {
        self.used.refill(false, columns);
        for column in self.assignment.column_of().flatten() {
            self.used[column] = true;
        }
    }

    /// Keeps the partners that [`Matcher::cost`] has just found, until it keeps others.
    pub(crate) fn keep(&mut self) {
        self.kept.clear();
        self.kept.extend(self.assignment.column_of());
    }

    /// The partners that were kept, which are those under exemplar sample `i`.
    pub(crate) fn correspondence(&mut self, i: u32, wanted: &dyn Fn(Vector<D>) -> bool) -> Correspondence {
        let near = self.level.neighbours(i);
        let columns = (0..).zip(&self.kept);
        let pairs = columns.filter_map(|(row, column)| Some((row, near[(*column)? as usize].sample))).collect();
        self.used.refill(false, near.len());
        for &column in self.kept.iter().flatten() {
            self.used[column] = true;
        }
        let absent = near.iter().zip(&self.used).filter(|(other, used)| other.weight > 0.0 && !**used);
        let missing = absent
            .filter(|(other, _)| wanted(Vector(other.offset.map(f64::from))))
            .map(|(other, _)| other.sample)
            .collect();
        Correspondence { pairs, missing }
    }
}

/// One sample, ready to be compared with those of the exemplar in everything but place: the edges of a curve sample
/// [Tu 2020 eq. 5], the outline and colour of an element.
#[derive(Clone, Copy)]
enum Difference<'a, const D: usize> {
    Edges(&'a Star<D>, f32),
    Attributes(Differing<'a>),
}

impl<'a, const D: usize> Difference<'a, D> {
    #[inline]
    fn new(matcher: &Matcher<'a, D>, source: u32, sample: u32) -> Self {
        let level = matcher.level;
        if source >= level.base {
            return Self::Edges(&matcher.stars[sample], level.single2);
        }
        Self::Attributes(matcher.library.differences.from(source))
    }

    /// Work to compare it with another one, relative to the work for a line that goes on.
    fn price(&self) -> u64 {
        match self {
            Self::Edges(star, _) => star.price(),
            Self::Attributes(_) => 1,
        }
    }

    /// Difference from a neighbour of a sample of the exemplar, one of the same key.
    #[inline]
    fn near_one(&self, level: &Level<D>, near: &Near<D>) -> f32 {
        match self {
            Self::Edges(star, single2) => star.distance2(&level.stars[near.sample], *single2),
            Self::Attributes(differing) => differing.at(near.column, || level.element[near.sample]),
        }
    }

    /// Difference from sample `i` of the exemplar, one of the same key.
    #[inline]
    fn of(&self, level: &Level<D>, i: u32) -> f32 {
        match self {
            Self::Edges(star, single2) => star.distance2(&level.stars[i], *single2),
            Self::Attributes(differing) => differing.of(level.element[i]),
        }
    }
}
