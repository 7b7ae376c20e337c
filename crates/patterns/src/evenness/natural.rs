//! What the exemplar shows of empty space: how far from ink its places are, and how near elements of two kinds come.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Domain, Exemplar, GridIndex, Matrix, Numbered, Result, Vector};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::{
        ink::{Inks, Pose},
        strokes::Strokes,
    },
    exemplar::library::Library,
};

/// Places in a mean spacing at which distances are measured, and most places in all.
const PLACES: (f64, usize) = (6.0, 1 << 18);

/// Share of places that are nearer to ink than what is tolerated of the output: natural, but no more of it than there is.
const TOLERATED: f64 = 0.993;

/// Distances are measured up to so many mean spacings.
const FARTHEST: f64 = 1.5;

/// Places nearer to the frame than a mean spacing, or this share of its side, are not measured.
const MARGIN: f64 = 0.15;

/// Share of the gaps between elements of two kinds that are narrower than what counts as the narrowest.
const NARROWEST: f64 = 0.01;

/// The same for kinds of which too few pairs are seen beside each other to tell.
const COMMON: f64 = 0.03;

/// Up to so many kinds there is an entry for every two of them.
const TABLE: usize = 128;

/// Directions that are told apart in the plane.
const SECTORS: usize = 8;

/// Share of the gaps in all directions that are narrower than what counts as the narrowest in one that is hardly seen.
const ANYWHERE: f64 = 0.1;

/// So many pairs tell how near two kinds come; and so few at least what they do not do.
const MANY: usize = 8;
const HANDFUL: usize = 4;

/// Kinds of which more than this share touches strokes are joined to them, such as leaves to their twigs; and how near that is, in mean
/// spacings.
const JOINED: f64 = 0.1;
const TOUCHING: f64 = 0.02;

/// Elements belong to others that stand as far from them as usual, up to this share of it, and this much nearer than the next; this share
/// of a kind does.
const BOUND: (f64, f64, f64) = (0.2, 1.5, 0.9);

/// Nanoseconds for a distance that is looked up, and for a pair of elements.
const PRICE: (u64, u64) = (10, 1500);

/// What is natural, in exemplar units.
#[derive(Clone, Debug)]
pub(crate) struct Natural {
    /// Distance from ink that most places keep below.
    pub(crate) tolerated: f64,
    /// Narrowest gap between elements of two kinds, by direction.
    narrowest: Vec<f32>,
    /// Number of kinds; 0 where there are too many for a table.
    kinds: usize,
    /// The same for kinds that are never seen beside each other.
    otherwise: f64,
    /// Largest of these gaps.
    pub(crate) widest: f64,
    /// How near elements of each kind come to strokes; `None` for those that are joined to them, or bound to other elements.
    clear: Numbered<Option<f64>>,
    /// Largest of these.
    pub(crate) clearest: f64,
}

impl Natural {
    /// Measures an exemplar with `strokes`. `None` where too little is seen of it.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new<const D: usize>(
        exemplar: &Exemplar<D>,
        library: &Library<D>,
        inks: &Inks<D>,
        strokes: Strokes<D>,
        budget: &Budget,
    ) -> Result<Option<Self>>
    where
        Vector<D>: Dimension<D>,
    {
        let shown = Shown::new(exemplar, library, inks, strokes);
        let mut distances = shown.distances(budget)?;
        if distances.len() < 16 {
            return Ok(None);
        }
        distances.sort_by(f64::total_cmp);
        let quantile = |q: f64| distances[((distances.len() - 1) as f64 * q) as usize];
        let tolerated = quantile(TOLERATED);
        let gaps = shown.gaps(budget)?;
        let mut all: Vec<f64> = gaps.iter().map(|seen| seen.gap).collect();
        all.sort_by(f64::total_cmp);
        // Where no two elements are seen beside each other, none are to be.
        let otherwise = low(&all, COMMON).unwrap_or(tolerated).min(tolerated);
        let kinds = if library.classes() <= TABLE { library.classes() } else { 0 };
        let narrowest = narrowest(&gaps, kinds, otherwise, tolerated);
        let widest = narrowest.iter().map(|&gap| f64::from(gap)).fold(otherwise, f64::max);
        let mut clear = shown.clear(tolerated);
        for (clear, is_bound) in clear.iter_mut().zip(shown.bound(budget)?) {
            *clear = clear.filter(|_| !is_bound);
        }
        let clearest = clear.iter().flatten().fold(0.0, |most: f64, gap| most.max(*gap));
        Ok(Some(Self { tolerated, narrowest, kinds, otherwise, widest, clear, clearest }))
    }

    /// How near elements of a kind come to strokes; `None` for those that stay as they are: joined to strokes, or bound to other elements.
    pub(crate) fn clear(&self, kind: u32) -> Option<f64> {
        self.clear[kind]
    }

    /// Narrowest gap between elements of two kinds, the second at `offset` from the first in exemplar directions.
    #[inline]
    pub(crate) fn gap<const D: usize>(&self, a: u32, b: u32, offset: Vector<D>) -> f64 {
        let place = (a as usize * self.kinds + b as usize) * SECTORS + sector(offset);
        self.narrowest.get(place).map_or(self.otherwise, |&gap| f64::from(gap))
    }
}

/// Two elements that stand beside each other.
struct Seen<const D: usize> {
    kinds: [u32; 2],
    /// From the first to the second.
    offset: Vector<D>,
    gap: f64,
}

/// The direction of an offset, as one of [`SECTORS`]; in space there is but one.
#[inline]
fn sector<const D: usize>(offset: Vector<D>) -> usize {
    if D != 2 {
        return 0;
    }
    // Eight sectors by signs and by which coordinate is larger, in the order in which they follow each other around.
    let (x, y) = (offset.0[0], offset.0[1]);
    match (x >= 0.0, y >= 0.0, x.abs() >= y.abs()) {
        (true, true, true) => 0,
        (true, true, false) => 1,
        (false, true, false) => 2,
        (false, true, true) => 3,
        (false, false, true) => 4,
        (false, false, false) => 5,
        (true, false, false) => 6,
        (true, false, true) => 7,
    }
}

/// The value below which a share of some lies, ascending.
fn low(sorted: &[f64], share: f64) -> Option<f64> {
    sorted.get((sorted.len() as f64 * share) as usize).copied()
}

/// For every two kinds and every sector, the narrowest gap.
///
/// Long elements that touch with their tips lie farther apart side by side. So gaps are told apart by direction; where too few
/// are seen in one and in those beside it, those in all directions tell, and of these not the narrowest.
fn narrowest<const D: usize>(gaps: &[Seen<D>], kinds: usize, otherwise: f64, most: f64) -> Vec<f32> {
    let mut table = vec![otherwise as f32; kinds * kinds * SECTORS];
    let mut seen = BTreeMap::<[u32; 2], Vec<(usize, f64)>>::new();
    for Seen { kinds: [a, b], offset, gap } in gaps.iter().filter(|_| kinds > 0) {
        seen.entry([*a, *b]).or_default().push((sector(*offset), *gap));
        seen.entry([*b, *a]).or_default().push((sector(-*offset), *gap));
    }
    for ([a, b], mut pairs) in seen {
        pairs.sort_by(|x, y| x.1.total_cmp(&y.1));
        let all: Vec<f64> = pairs.iter().map(|pair| pair.1).collect();
        for s in 0..SECTORS {
            let is_beside =
                |other: usize| matches!((other + SECTORS - s) % SECTORS, 0 | 1) || (s + SECTORS - other) % SECTORS == 1;
            let beside: Vec<f64> = pairs.iter().filter(|pair| D != 2 || is_beside(pair.0)).map(|pair| pair.1).collect();
            let gap = if beside.len() >= MANY {
                low(&beside, NARROWEST)
            } else if all.len() >= 2 * MANY {
                low(&all, ANYWHERE)
            } else {
                // The least of a handful says enough; one or two may be far apart by chance.
                low(&all, 0.0).map(|least| if all.len() >= HANDFUL { least } else { least.min(otherwise) })
            };
            let place = (a as usize * kinds + b as usize) * SECTORS + s;
            table[place] = gap.unwrap_or(otherwise).min(most) as f32;
        }
    }
    table
}

/// The exemplar as it is seen.
struct Shown<'a, const D: usize> {
    library: &'a Library<D>,
    inks: &'a Inks<D>,
    poses: Vec<Pose<D>>,
    index: GridIndex<D>,
    largest: f64,
    strokes: Strokes<D>,
}

impl<'a, const D: usize> Shown<'a, D> {
    fn new(exemplar: &Exemplar<D>, library: &'a Library<D>, inks: &'a Inks<D>, strokes: Strokes<D>) -> Self {
        let pose =
            |e: usize| Pose { source: e as u32, centre: library.centre[e], rotation: Matrix::identity(), scale: 1.0 };
        let poses: Vec<_> = (0..inks.len()).map(pose).collect();
        let centres: Vec<_> = poses.iter().map(|p| p.centre).collect();
        let largest = poses.iter().map(|p| inks.radius(p)).fold(0.0, f64::max).min(library.reach.max(library.spacing));
        let index = GridIndex::new(&centres, library.spacing, &Domain::Box(exemplar.window));
        Self { library, inks, poses, index, largest, strokes }
    }

    /// How far places inside the frame are from ink.
    fn distances(&self, budget: &Budget) -> Result<Vec<f64>> {
        let (window, size) = (self.library.view.window, self.library.view.window.size());
        let mut step = self.library.spacing / PLACES.0;
        let counts = |step: f64| -> [usize; D] { std::array::from_fn(|k| (size[k] / step).ceil().max(1.0) as usize) };
        while counts(step).iter().fold(1, |n: usize, c| n.saturating_mul(*c)) > PLACES.1 {
            step *= 1.2;
        }
        let counts = counts(step);
        let farthest = FARTHEST * self.library.spacing;
        // Beyond the frame nothing is known: what is near it may be near ink outside.
        let margin = self.library.spacing.min(MARGIN * self.library.view.side());
        let places: Vec<_> = (0..counts.iter().product()).map(|c| window.cell_centre(c, &counts)).collect();
        let distance = |&p: &Vector<D>| {
            if self.library.view.signed_distance(p) < margin {
                return Ok(None);
            }
            let mut nearest = farthest;
            let reach = nearest + self.largest;
            let looked = self.index.within(p, reach, |e, offset| {
                if offset.norm() - self.inks.radius(&self.poses[e]) < nearest {
                    nearest = nearest.min(self.inks.distance(&self.poses[e], -offset));
                }
            });
            self.strokes.near(p, nearest.max(0.0), |offset, radius| nearest = nearest.min(offset.norm() - radius));
            budget.spend(PRICE.0 * (4 + looked))?;
            Ok(Some(nearest.max(0.0)))
        };
        let found: Vec<Option<f64>> = places.par_iter().map(distance).collect::<Result<_>>()?;
        Ok(found.into_iter().flatten().collect())
    }

    /// For each kind, how near its elements come to strokes; no farther than what is tolerated.
    fn clear(&self, tolerated: f64) -> Numbered<Option<f64>> {
        let mut gaps = Numbered::filled(Vec::new(), self.library.classes());
        for pose in self.poses.iter().filter(|pose| self.library.view.contains(pose.centre)) {
            gaps[self.library.class[pose.source]].push(self.strokes.gap(self.inks, pose, tolerated));
        }
        let clear = |mut gaps: Vec<f64>| {
            gaps.sort_by(f64::total_cmp);
            let is_joined = low(&gaps, JOINED).is_some_and(|gap| gap <= TOUCHING * self.library.spacing);
            (!is_joined).then(|| low(&gaps, NARROWEST).unwrap_or(0.0))
        };
        gaps.into_iter().map(clear).collect()
    }

    /// Whether elements of each kind stand at a distance of their own from one of some kind, farther from the next one.
    fn bound(&self, budget: &Budget) -> Result<Vec<bool>> {
        let kinds = self.library.classes();
        let mut bound = vec![false; kinds];
        let reach = 2.0 * self.spacing();
        // For each two kinds, how far elements of the first are from the nearest of the second and the next, and from the frame.
        let mut seen = BTreeMap::<[u32; 2], Vec<[f64; 3]>>::new();
        for a in &self.poses {
            let depth = self.library.view.signed_distance(a.centre);
            let mut nearest = BTreeMap::<u32, [f64; 2]>::new();
            let looked = self.index.within(a.centre, reach, |e, offset| {
                let b = &self.poses[e];
                if b.source != a.source {
                    let entry = nearest.entry(self.library.class[b.source]).or_insert([reach; 2]);
                    let distance = offset.norm();
                    if distance < entry[0] {
                        *entry = [distance, entry[0]];
                    } else {
                        entry[1] = entry[1].min(distance);
                    }
                }
            });
            budget.spend(PRICE.0 * (4 + looked))?;
            for (kind, [first, second]) in nearest {
                seen.entry([self.library.class[a.source], kind]).or_default().push([first, second, depth]);
            }
        }
        for ([a, b], mut found) in seen {
            found.sort_by(|x, y| x[0].total_cmp(&y[0]));
            let Some(&[median, ..]) = found.get(found.len() / 2) else { continue };
            found.retain(|[_, _, depth]| *depth > median);
            let room = BOUND.0 * median + TOUCHING * self.spacing();
            let is_bound =
                |[first, second, _]: &&[f64; 3]| (first - median).abs() <= room && *second >= BOUND.1 * first;
            let count = found.iter().filter(is_bound).count();
            if found.len() >= MANY && count as f64 >= BOUND.2 * found.len() as f64 {
                bound[a as usize] = true;
                bound[b as usize] = true;
            }
        }
        Ok(bound)
    }

    /// Mean spacing of the elements, whatever strokes there are.
    fn spacing(&self) -> f64 {
        let view = &self.library.view;
        let shown = self.poses.iter().filter(|pose| view.contains(pose.centre)).count();
        self.library.spacing.max((view.measure() / shown.max(1) as f64).powf(1.0 / D as f64))
    }

    /// Gaps between neighbouring elements.
    fn gaps(&self, budget: &Budget) -> Result<Vec<Seen<D>>> {
        let enough = self.spacing();
        let of = |a: &Pose<D>| {
            let mut found = Vec::new();
            let radius = self.inks.radius(a);
            self.index.within(a.centre, radius + self.largest + enough, |e, offset| {
                let b = &self.poses[e];
                if b.source > a.source {
                    let gap = self.inks.gap(a, b, offset, enough);
                    if gap <= enough {
                        let kinds = [a, b].map(|pose| self.library.class[pose.source]);
                        found.push(Seen { kinds, offset, gap });
                    }
                }
            });
            budget.spend(PRICE.1 * (1 + found.len() as u64))?;
            Ok(found)
        };
        let found: Vec<Vec<_>> = self.poses.par_iter().map(of).collect::<Result<_>>()?;
        Ok(found.into_iter().flatten().collect())
    }
}
