//! Which points lie in the windows of which sites, and which points are near each other.

use arabesque_core::{Budget, Domain, GridIndex, Result, Vector};
use rayon::prelude::*;

use super::kernel::Kernel;
use crate::territory::site::Site;

/// Lists of numbers, one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// The lists as they are.
    pub(crate) fn new(lists: &[Vec<u32>]) -> Self {
        let mut starts = Vec::with_capacity(lists.len() + 1);
        let mut items = Vec::with_capacity(lists.iter().map(Vec::len).sum());
        starts.push(0);
        for list in lists {
            items.extend_from_slice(list);
            starts.push(items.len() as u32);
        }
        Self { starts, items }
    }

    /// List `n`.
    #[inline]
    pub(crate) fn of(&self, n: usize) -> &[u32] {
        &self.items[self.starts[n] as usize..self.starts[n + 1] as usize]
    }

    /// Where list `n` is among the items of all lists.
    #[inline]
    pub(crate) fn span(&self, n: usize) -> std::ops::Range<usize> {
        self.starts[n] as usize..self.starts[n + 1] as usize
    }

    /// Items of all lists.
    #[inline]
    pub(crate) fn items(&self) -> &[u32] {
        &self.items
    }

    /// Number of items in all lists.
    pub(crate) fn total(&self) -> usize {
        self.items.len()
    }

    /// For each of `count` items the lists that it is in.
    pub(crate) fn turned_round(&self, count: usize) -> Self {
        let mut starts = vec![0_u32; count + 1];
        self.items.iter().for_each(|&i| starts[i as usize + 1] += 1);
        (0..count).for_each(|i| starts[i + 1] += starts[i]);
        let mut next = starts.clone();
        let mut items = vec![0; self.items.len()];
        for n in 0..self.starts.len() - 1 {
            for &i in self.of(n) {
                items[next[i as usize] as usize] = n as u32;
                next[i as usize] += 1;
            }
        }
        Self { starts, items }
    }
}

/// Sites by place, for points that look for the windows they are in.
#[derive(Clone, Debug)]
pub(crate) struct SiteIndex<const D: usize> {
    index: GridIndex<D>,
    largest: f64,
}

impl<const D: usize> SiteIndex<D> {
    /// Of these sites.
    pub(crate) fn new(sites: &[Site<D>], step: f64, domain: &Domain<D>) -> Self {
        let places: Vec<_> = sites.iter().map(|s| s.place).collect();
        let largest = sites.iter().map(|s| s.scale).fold(0.0, f64::max);
        Self { index: GridIndex::new(&places, 2.0 * step * largest, domain), largest }
    }

    /// Calls `visit` with each site that has `p` in its window, and `p` as the exemplar sees it from there.
    pub(crate) fn windows(
        &self,
        sites: &[Site<D>],
        p: Vector<D>,
        reach: &Reach<D>,
        mut visit: impl FnMut(usize, [f64; D]),
    ) -> u64 {
        let radius = reach.radius() * self.largest;
        self.index.within(p, radius, |q, offset| {
            let u = sites[q].seen(-offset);
            if reach.holds(&u) {
                visit(q, u);
            }
        })
    }

    /// Calls `visit` with each site within `radius` of `p` and the offset to it.
    pub(crate) fn around(&self, p: Vector<D>, radius: f64, visit: impl FnMut(usize, Vector<D>)) -> u64 {
        self.index.within(p, radius, visit)
    }

    /// The site nearest to `p`, no farther than `radius`.
    pub(crate) fn nearest(&self, p: Vector<D>, radius: f64) -> Option<usize> {
        self.index.nearest(p, radius, None).map(|found| found.0)
    }
}

/// How far a window reaches along and across the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<const D: usize> {
    along: f64,
    across: f64,
    base: [bool; D],
}

impl<const D: usize> Reach<D> {
    /// For windows of `kernel` on a structure of this thickness.
    pub(crate) fn new(kernel: &Kernel<D>, base: [bool; D], thickness: f64) -> Self {
        let across = if base.iter().all(|b| *b) { 0.0 } else { 1.3 * thickness + 2.0 * kernel.sigma };
        Self { along: kernel.reach(), across, base }
    }

    /// Radius of a ball around all of it.
    pub(crate) fn radius(&self) -> f64 {
        (self.along * self.along + self.across * self.across).sqrt()
    }

    /// Whether it holds what is at `u` from its middle.
    pub(crate) fn holds(&self, u: &[f64; D]) -> bool {
        let (mut along, mut across) = (0.0, 0.0);
        for k in 0..D {
            *(if self.base[k] { &mut along } else { &mut across }) += u[k] * u[k];
        }
        along <= self.along * self.along && across <= self.across * self.across
    }
}

/// For each point the sites that have it in their window.
pub(crate) fn windows<const D: usize>(
    places: &[Vector<D>],
    sites: &[Site<D>],
    index: &SiteIndex<D>,
    reach: &Reach<D>,
    budget: &Budget,
) -> Result<Lists> {
    let lists: Result<Vec<Vec<u32>>> = places
        .par_iter()
        .with_min_len(256)
        .map(|&p| {
            let mut list = Vec::new();
            let looked = index.windows(sites, p, reach, |q, _| list.push(q as u32));
            budget.spend(20 + 12 * looked)?;
            Ok(list)
        })
        .collect();
    Ok(Lists::new(&lists?))
}

/// For each point the others within `radius`.
pub(crate) fn neighbours<const D: usize>(
    places: &[Vector<D>],
    radius: f64,
    domain: &Domain<D>,
    budget: &Budget,
) -> Result<Lists> {
    let index = GridIndex::new(places, radius, domain);
    let lists: Result<Vec<Vec<u32>>> = places
        .par_iter()
        .enumerate()
        .with_min_len(256)
        .map(|(i, &p)| {
            let mut list = Vec::new();
            let looked = index.within(p, radius, |j, _| {
                if j != i {
                    list.push(j as u32);
                }
            });
            budget.spend(20 + 6 * looked)?;
            Ok(list)
        })
        .collect();
    Ok(Lists::new(&lists?))
}
