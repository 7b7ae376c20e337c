//! The similarity error of one level, for an output and the matches of its sites.
//!
//! `T = sum_ij a_i.a_j h(x_i - x_j) (P_i + P_j) / 2 - 2 sum_i a_i.F(x_i) + sum_k w_k B(m_k)`
//!
//! with `h(r) = exp(-|r|^2 / (2 sigma^2))`. `P` says how much of all windows lies on a point, `F` is what the matches want there, `B`
//! the exemplar with itself. It is the sum over all sites of the error of [Roveri 2015 eq. 6], each divided by the known share of its
//! window, but for one thing: a pair counts as far as its points lie in the windows, and not its middle.

use std::sync::{Arc, Mutex, PoisonError};

use arabesque_core::{Budget, Domain, Result, Vector};
use rayon::prelude::*;

use super::{
    back::Back,
    exp::exp,
    kernel::Kernel,
    links::{Lists, Reach, SiteIndex, neighbours, windows},
};
use crate::{
    each::each,
    exemplar::{
        channels::{LANES, Weights, inner},
        field::Field,
        known::Known,
        pattern::Pattern,
    },
    output::state::Output,
    territory::site::Site,
};

/// Work for each pair of points of an energy.
const PAIR: u64 = 15;

/// The tables of one size of the window.
#[derive(Debug)]
pub(crate) struct Tables<const D: usize> {
    pub(crate) kernel: Kernel<D>,
    pub(crate) field: Arc<Field<D>>,
    pub(crate) known: Known<D>,
    pub(crate) back: Back<D>,
    pub(crate) reach: Reach<D>,
}

impl<const D: usize> Tables<D> {
    /// The tables for `kernel`, with the field of those that have the same width.
    pub(crate) fn new(pattern: &Pattern<D>, kernel: Kernel<D>, fields: &Fields<D>, budget: &Budget) -> Result<Self> {
        let field = fields.of(pattern, &kernel, budget)?;
        let known = Known::new(&pattern.bounds, pattern.base, &kernel);
        let back = Back::new(pattern, &kernel, &known, budget)?;
        let reach = Reach::new(&kernel, pattern.base, pattern.thickness);
        Ok(Self { kernel, field, known, back, reach })
    }
}

/// Fields of an exemplar by the width of their Gaussians, made when they are first asked for.
#[derive(Debug, Default)]
pub(crate) struct Fields<const D: usize>(Mutex<Vec<(f64, Arc<Field<D>>)>>);

impl<const D: usize> Fields<D> {
    /// The field for `kernel`.
    pub(crate) fn of(&self, pattern: &Pattern<D>, kernel: &Kernel<D>, budget: &Budget) -> Result<Arc<Field<D>>> {
        let mut made = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, field)) = made.iter().find(|f| f.0 == kernel.sigma) {
            return Ok(Arc::clone(field));
        }
        let places = &pattern.points.positions;
        let field = Arc::new(Field::new(places, &pattern.weights, pattern.channels.blocks(), kernel, budget)?);
        made.push((kernel.sigma, Arc::clone(&field)));
        Ok(field)
    }
}

/// One level of the multi-scale optimisation over its sites.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a, const D: usize> {
    pub(crate) pattern: &'a Pattern<D>,
    pub(crate) tables: &'a Tables<D>,
    pub(crate) sites: &'a [Site<D>],
    /// How many of the first sites may get another match.
    pub(crate) open: usize,
    pub(crate) index: &'a SiteIndex<D>,
    pub(crate) domain: &'a Domain<D>,
    /// Shifts that lay the exemplar well upon itself.
    pub(crate) shifts: &'a [Vector<D>],
    /// How many points a window has in the mean over the exemplar, each as far as it is in it.
    pub(crate) usual: f64,
}

/// Where each site looks in the exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Match<const D: usize> {
    /// The matching point.
    pub(crate) m: Vector<D>,
    /// The error density there, divided by the known share.
    pub(crate) error: f64,
}

/// Who is near whom, for the places that the points had when it was made; fixed during a step, so that energies can be compared.
pub(crate) struct Near {
    /// For each point the sites with it in their window.
    pub(crate) windows: Lists,
    /// For each point the other points that make a pair with it.
    pub(crate) pairs: Lists,
    /// `a_i.a_j` of all pairs in their order; nothing where there are rigid elements, whose directions turn with them.
    alike: Vec<f32>,
}

impl Near {
    /// `a_i.a_j` for pair `k` of all, which is one of point `i`.
    #[inline]
    pub(crate) fn alike<const D: usize>(&self, output: &Output<D>, i: usize, k: usize) -> f64 {
        match self.alike.get(k) {
            Some(alike) => f64::from(*alike),
            None => f64::from(inner(&output.weights[i], &output.weights[self.pairs.items()[k] as usize])),
        }
    }
}

/// What acts on one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<const D: usize> {
    /// `P`.
    pub(crate) cover: f64,
    pub(crate) cover_slope: Vector<D>,
    /// `a.F`.
    pub(crate) wanted: f64,
    pub(crate) wanted_slope: Vector<D>,
    /// Mean scale of the pattern.
    pub(crate) scale: f64,
}

impl<const D: usize> Level<'_, D> {
    /// Lists for the output as it is.
    pub(crate) fn near(&self, output: &Output<D>, budget: &Budget) -> Result<Near> {
        let scale = self.sites.iter().map(|s| s.scale).fold(0.0, f64::max);
        let pairs = neighbours(&output.places, self.tables.kernel.pairs() * scale, self.domain, budget)?;
        let windows = windows(&output.places, self.sites, self.index, &self.tables.reach, budget)?;
        let alike = |i: usize| {
            let own = &output.weights[i];
            pairs.of(i).iter().map(|&j| inner(own, &output.weights[j as usize])).collect::<Vec<f32>>()
        };
        let alike = if output.bodies.is_empty() {
            (0..output.places.len()).into_par_iter().with_min_len(256).flat_map_iter(alike).collect()
        } else {
            Vec::new()
        };
        Ok(Near { windows, pairs, alike })
    }

    /// Weight of site `q` with its match: its share of the base over the known share of its window.
    #[inline]
    pub(crate) fn factor(&self, q: usize, m: &Vector<D>) -> f64 {
        self.sites[q].weight / self.tables.known.share(&m.0).max(0.05)
    }

    /// What acts on a point with weights at `x`, from the sites of `windows`.
    pub(crate) fn pull(&self, x: Vector<D>, weights: &Weights, windows: &[u32], matches: &Matches<D>) -> Pull<D> {
        let kernel = &self.tables.kernel;
        let mut pull =
            Pull { cover: 0.0, cover_slope: Vector::ZERO, wanted: 0.0, wanted_slope: Vector::ZERO, scale: 0.0 };
        for &q in windows {
            let (q, site) = (q as usize, &self.sites[q as usize]);
            let u = site.seen(self.domain.offset(site.place, x));
            let m = matches.places[q];
            let seen: [f32; D] = std::array::from_fn(|k| (m[k] + u[k]) as f32);
            let known = f64::from(self.tables.known.at(&seen));
            if known <= 0.0 {
                continue;
            }
            let weight = matches.factors[q] * known * kernel.weight(&u);
            let turned = self.pattern.channels.turned_back(weights, &site.rotation);
            let (value, slope) = self.tables.field.project_slope(&seen, &turned);
            let (value, per, fall) = (f64::from(value), 1.0 / site.scale, kernel.fall(&u));
            pull.cover += weight;
            pull.scale += weight * site.scale;
            pull.wanted += weight * value;
            let wanted = Vector(std::array::from_fn(|k| weight * per * (f64::from(slope[k]) + fall[k] * value)));
            let cover = Vector(std::array::from_fn(|k| weight * per * fall[k]));
            pull.wanted_slope += site.rotation.apply(wanted);
            pull.cover_slope += site.rotation.apply(cover);
        }
        pull.scale = if pull.cover > 0.0 { pull.scale / pull.cover } else { 1.0 };
        pull
    }

    /// What the matches want at `x`: the field itself.
    pub(crate) fn wanted(&self, x: Vector<D>, windows: &[u32], matches: &Matches<D>) -> (Weights, f64) {
        let kernel = &self.tables.kernel;
        let mut sum = [0.0_f32; LANES];
        let mut cover = 0.0;
        for &q in windows {
            let (q, site) = (q as usize, &self.sites[q as usize]);
            let u = site.seen(self.domain.offset(site.place, x));
            let m = matches.places[q];
            let seen: [f32; D] = std::array::from_fn(|k| (m[k] + u[k]) as f32);
            let known = f64::from(self.tables.known.at(&seen));
            if known <= 0.0 {
                continue;
            }
            let weight = matches.factors[q] * known * kernel.weight(&u);
            cover += weight;
            let value = self.pattern.channels.turned(&self.tables.field.value(&seen), &site.rotation);
            for (s, v) in sum.iter_mut().zip(value) {
                *s += weight as f32 * v;
            }
        }
        (sum, cover)
    }

    /// All pulls on the points of an output, in their order.
    pub(crate) fn pulls(
        &self,
        output: &Output<D>,
        near: &Near,
        matches: &Matches<D>,
        budget: &Budget,
    ) -> Result<Vec<Pull<D>>> {
        let cost = |i: usize| near.windows.of(i).len() as u64 * 60;
        each(output.places.len(), budget, cost, |i| {
            self.pull(output.places[i], &output.weights[i], near.windows.of(i), matches)
        })
    }

    /// `sum_j a_i.a_j h(x_i - x_j) (P_i + P_j)` over all points `j` with higher numbers, and half of that for `i` itself.
    fn crowd(&self, output: &Output<D>, near: &Near, pulls: &[Pull<D>], i: usize) -> f64 {
        let (x, a, here) = (output.places[i], &output.weights[i], &pulls[i]);
        let mut sum = f64::from(inner(a, a)) * here.cover;
        for k in near.pairs.span(i) {
            let j = near.pairs.items()[k] as usize;
            if j > i {
                let r2 = self.domain.offset(x, output.places[j]).norm2();
                let h = self.pair(r2, here.scale, pulls[j].scale);
                sum += near.alike(output, i, k) * h * (here.cover + pulls[j].cover);
            }
        }
        sum
    }

    /// `h` between points where the pattern has these scales.
    #[inline]
    pub(crate) fn pair(&self, r2: f64, scale: f64, other: f64) -> f64 {
        let sigma = self.tables.kernel.sigma * 0.5 * (scale + other);
        f64::from(exp((-0.5 * r2 / (sigma * sigma)) as f32))
    }

    /// `T` from the pulls on all points.
    pub(crate) fn energy(
        &self,
        output: &Output<D>,
        near: &Near,
        pulls: &[Pull<D>],
        matches: &Matches<D>,
        budget: &Budget,
    ) -> Result<f64> {
        let cost = |i: usize| near.pairs.of(i).len() as u64 * PAIR;
        let of_points =
            each(output.places.len(), budget, cost, |i| self.crowd(output, near, pulls, i) - 2.0 * pulls[i].wanted)?;
        Ok(of_points.iter().sum::<f64>() + matches.back)
    }
}

/// The matches of all sites, with what depends on them alone.
#[derive(Clone, Debug, Default)]
pub(crate) struct Matches<const D: usize> {
    /// Where each site looks in the exemplar.
    pub(crate) places: Vec<Vector<D>>,
    /// Weights of the sites with these matches.
    pub(crate) factors: Vec<f64>,
    /// Sum of the exemplar with itself.
    pub(crate) back: f64,
}

impl<const D: usize> Matches<D> {
    /// The matches at these places.
    pub(crate) fn new(level: &Level<'_, D>, places: Vec<Vector<D>>) -> Self {
        let factors: Vec<f64> = places.iter().enumerate().map(|(q, m)| level.factor(q, m)).collect();
        let back = places.iter().zip(&factors).map(|(m, f)| f * level.tables.back.at(&m.0).0).sum();
        Self { places, factors, back }
    }
}
