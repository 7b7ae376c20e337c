//! Rigid elements of the exemplar.

use std::collections::BTreeMap;

use arabesque_core::{GridIndex, PointSet, Vector};

/// A rigid element: its points and their middle.
#[derive(Clone, Debug)]
pub(crate) struct Body<const D: usize> {
    /// Its number in the exemplar.
    pub(crate) number: i32,
    /// Its points.
    pub(crate) members: Vec<usize>,
    /// The mean of their places.
    pub(crate) centre: Vector<D>,
}

/// Share of the elements of the exemplar that come nearer to another one than an element in a gap may.
const CLOSE: f64 = 0.1;
/// Share of the least clear space between elements of the exemplar that is kept between those of the output.
const KEPT: f64 = 0.85;
/// The same for those that are there already: what is nearer cuts into each other.
const CUTTING: f64 = 0.7;
/// The same for those of mixtures, which make way for each other.
const CROWDED: f64 = 0.35;
/// No element needs more of it than this to look apart, in spacings.
const APART: f64 = 0.5;

/// How near elements come to one another: for each of them, the distance from its points to those of the nearest other one, the smallest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gaps {
    sorted: Vec<f64>,
    /// Whether elements stand on something continuous, which says where they are and how many.
    mixed: bool,
}

impl Gaps {
    /// Of these elements, whose points lie `spacing` apart.
    pub(crate) fn new<const D: usize>(
        (positions, index): (&[Vector<D>], &GridIndex<D>),
        (bodies, body_of): (&[Body<D>], &[u32]),
        spacing: f64,
        size: f64,
    ) -> Self {
        if bodies.len() < 2 {
            return Self::default();
        }
        let nearest = |b: usize| {
            let mut best = size;
            for &i in &bodies[b].members {
                let mut radius = (2.0 * spacing).min(best);
                let mut found = f64::INFINITY;
                while found > radius && radius < best {
                    index.within(positions[i], radius, |j, r| {
                        if body_of[j] != LOOSE && body_of[j] as usize != b {
                            found = found.min(r.norm());
                        }
                    });
                    radius *= 2.0;
                }
                best = best.min(found);
            }
            best
        };
        let mut gaps: Vec<f64> = (0..bodies.len()).map(nearest).collect();
        gaps.sort_by(f64::total_cmp);
        Self { sorted: gaps, mixed: body_of.contains(&LOOSE) }
    }

    /// How near an element that is put in a gap may come to others: only a few of the exemplar come nearer. `None` for fewer than two elements.
    pub(crate) fn usual(&self) -> Option<f64> {
        self.sorted.get((CLOSE * self.sorted.len() as f64) as usize).copied()
    }

    /// How near an element may come to others: about as near as any in the exemplar, of which the fewer there are the less they tell.
    pub(crate) fn least(&self, spacing: f64) -> f64 {
        let kept = if self.mixed { CUTTING } else { KEPT };
        (kept * self.shortest()).max((APART * spacing).min(self.usual().unwrap_or(f64::INFINITY)))
    }

    /// The same for what is laid out at first.
    pub(crate) fn laid(&self, spacing: f64) -> f64 {
        if self.mixed { self.cutting() } else { self.least(spacing) }
    }

    /// Elements that are nearer than this cut into each other.
    pub(crate) fn cutting(&self) -> f64 {
        self.shortest() * if self.mixed { CROWDED } else { CUTTING }
    }

    /// Whether elements stand on something continuous.
    pub(crate) fn is_mixed(&self) -> bool {
        self.mixed
    }

    /// How far elements of mixtures are to stay from each other.
    pub(crate) fn clear(&self) -> Option<f64> {
        self.mixed.then(|| KEPT * self.shortest())
    }

    fn shortest(&self) -> f64 {
        let n = self.sorted.len() as f64;
        self.sorted.first().map_or(0.0, |gap| gap * n / (n + 1.0))
    }
}

/// No rigid element.
pub(crate) const LOOSE: u32 = u32::MAX;

/// The rigid elements by rising number, and for each point the index of its own, or [`LOOSE`].
pub(crate) fn bodies<const D: usize>(points: &PointSet<D>) -> (Vec<Body<D>>, Vec<u32>) {
    let mut of = vec![LOOSE; points.len()];
    let Some(elements) = &points.elements else { return (Vec::new(), of) };
    let mut members: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
    for (i, &number) in elements.iter().enumerate().filter(|(_, n)| **n >= 0) {
        members.entry(number).or_default().push(i);
    }
    let mut bodies = Vec::with_capacity(members.len());
    for (number, members) in members {
        members.iter().for_each(|&i| of[i] = bodies.len() as u32);
        let sum = members.iter().fold(Vector::ZERO, |sum, &i| sum + points.positions[i]);
        let centre = sum * (1.0 / members.len() as f64);
        bodies.push(Body { number, members, centre });
    }
    (bodies, of)
}
