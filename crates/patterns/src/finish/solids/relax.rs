//! Taking solids apart, each moved and turned as little as possible.

use arabesque_core::{Border, Budget, Domain, Matrix, Result, Similarity, Vector};
use rayon::prelude::*;

use super::{contact::Contact, things::Things};

/// Overlaps beyond what is allowed by less than this share of the spacing are left.
const ENOUGH: f64 = 0.008;
/// Bodies are pushed so far inside of a border, in spacings, that what is left undone does not reach over it.
const MARGIN: f64 = 0.012;
/// A body that moves by less than this share of the spacing is at rest.
const STILL: f64 = 0.001;
/// Share of a correction that is made in a step.
const RATE: f64 = 0.9;
/// How far a body may go from where it was, in spacings.
const FAR: f64 = 0.6;
/// Work for a place of a surface; for one whose distance from the border is asked, read off a grid, or worked out where it is less than
/// this share of the domain's longest side.
const PER_PLACE: u64 = 10;
const WITHIN: u64 = 60;
const AT_RIM: u64 = 1500;
const RIM: f64 = 0.025;
/// A box thicker than this many radii of the widest body has an inside.
const THICK: f64 = 4.0;
/// Radius of gyration relative to the radius.
const GYRATION: f64 = 0.5;

/// How a body moves in a step: the sum of what its contacts want, and how many they are.
#[derive(Clone, Copy)]
pub(super) struct Push<const D: usize> {
    shift: Vector<D>,
    turn: [f64; 3],
    count: f64,
}

impl<const D: usize> Push<D> {
    /// Nothing is wanted.
    pub(super) fn none() -> Self {
        Self { shift: Vector::ZERO, turn: [0.0; 3], count: 0.0 }
    }
}

/// What the border and the ground want of a body.
struct Held<const D: usize> {
    contacts: [Option<Contact<D>>; 2],
    /// How far it may go before it can reach the border, where that is known.
    inside: Option<f64>,
    cost: u64,
}

impl<const D: usize> Held<D> {
    /// Nothing.
    fn free() -> Self {
        Self { contacts: [None; 2], inside: None, cost: 10 }
    }
}

impl<const D: usize> Things<'_, D> {
    /// Moves and turns bodies until none lies too deep in another, or for so many steps.
    pub(super) fn relax(&mut self, steps: usize, budget: &Budget) -> Result<()> {
        let spacing = self.library.spacing * self.extent.smallest_spacing_scale;
        let starts: Vec<_> = self.bodies.iter().map(|b| b.centre).collect();
        for _ in 0..steps {
            budget.check()?;
            let index = self.index();
            let (is_awake, cost) = self.look(&index);
            budget.spend(cost)?;
            let found: Vec<_> = (0..self.bodies.len())
                .into_par_iter()
                .map(|i| if is_awake[i] && self.placements[i].frozen.is_none() { self.held(i) } else { Held::free() })
                .collect();
            budget.spend(found.iter().map(|held| held.cost).sum())?;
            let mut pushes = vec![Push::none(); self.bodies.len()];
            let mut worst = 0.0_f64;
            for overlap in self.overlaps() {
                let i = overlap.body;
                if is_awake[i] && self.placements[i].frozen.is_none() {
                    worst = worst.max(overlap.over);
                    self.add(&mut pushes[i], i, &overlap.contact, overlap.amount);
                }
            }
            for (i, held) in found.into_iter().enumerate() {
                self.inside[i] = held.inside.map_or(self.inside[i], |more| self.gone[i] + more);
                for contact in held.contacts.into_iter().flatten() {
                    worst = worst.max(contact.depth);
                    self.add(&mut pushes[i], i, &contact, contact.depth);
                }
            }
            for (i, push) in pushes.iter().enumerate() {
                self.moved[i] = self.apply(i, push, starts[i], FAR * spacing) > STILL * spacing;
            }
            if worst < ENOUGH * spacing {
                break;
            }
        }
        Ok(())
    }

    /// What the border and the ground want of a body.
    fn held(&self, i: usize) -> Held<D> {
        let (at_border, inside, looked) = if self.gone[i] < self.inside[i] { (None, None, 0) } else { self.beyond(i) };
        let (below, also) = self.below(i);
        Held { contacts: [at_border, below], inside, cost: 100 + looked + also }
    }

    /// The place of a body that lies deepest in the ground, where it does not stand on it.
    pub(super) fn below(&self, i: usize) -> (Option<Contact<D>>, u64) {
        let body = &self.bodies[i];
        let Some(ground) = self.extent.lies_over(self.placements[i].source as u32) else { return (None, 0) };
        if ground.height(body.centre) >= body.radius {
            return (None, 50);
        }
        let mut worst = (0.0, body.centre);
        for point in &body.solid.points {
            let p = body.pose.apply(*point);
            let height = ground.height(p);
            if height < worst.0 {
                worst = (height, p);
            }
        }
        let (height, at) = worst;
        let way = (ground.at_height(at, 1.0) - ground.at_height(at, 0.0)).unit_or_zero();
        let cost = 50 * body.solid.points.len() as u64;
        ((height < 0.0).then_some(Contact { depth: -height, at, way }), cost)
    }

    /// The place of a body that lies farthest outside, where the border keeps it inside; else how far it may go before one can; and the cost.
    fn beyond(&self, i: usize) -> (Option<Contact<D>>, Option<f64>, u64) {
        let (body, request) = (&self.bodies[i], self.extent.request());
        let domain = &request.domain;
        let depth = domain.signed_distance(body.centre);
        let inside = matches!(request.border, Border::Inside | Border::Turn);
        let margin = MARGIN * self.library.spacing;
        let room = depth - if inside { body.radius + margin } else { 0.0 };
        if room >= 0.0 {
            return (None, Some(room), 2000);
        }
        let back = |p: Vector<D>, depth: f64| {
            let way = domain.nearest_inside(p) - p;
            (way.norm() > 0.0).then(|| Contact { depth: -depth, at: p, way: way.unit_or_zero() })
        };
        if !inside {
            return (back(body.centre, depth), None, 4000);
        }
        let (mut worst, mut cost) = ((f64::INFINITY, body.centre), 4000);
        let rim = domain.bounds().size().0.into_iter().fold(0.0, f64::max) * RIM;
        for point in &body.solid.points {
            let p = body.pose.apply(*point);
            cost += PER_PLACE;
            // Distances differ by no more than places do.
            let least = depth - (p - body.centre).norm() - margin;
            if least > 0.0 {
                worst = if least < worst.0 { (least, p) } else { worst };
                continue;
            }
            let out = domain.signed_distance(p) - margin;
            cost += if out.abs() < rim { AT_RIM } else { WITHIN };
            if out < worst.0 {
                worst = (out, p);
            }
        }
        if worst.0 < 0.0 { (back(worst.1, worst.0), None, cost) } else { (None, Some(worst.0), cost) }
    }

    /// Adds what a contact wants: a shift and a turn that take it apart by `amount`.
    pub(super) fn add(&self, push: &mut Push<D>, i: usize, found: &Contact<D>, amount: f64) {
        let body = &self.bodies[i];
        let arm = found.at - body.centre;
        let gyration2 = (GYRATION * body.radius).powi(2).max(1e-18);
        let source = self.placements[i].source;
        let stands = self.exemplar.heights.get(source).is_some_and(Option::is_some);
        let lever = if stands || self.library.upright[source as u32] { [0.0; 3] } else { cross(arm, found.way) };
        let turned: f64 = lever.iter().map(|v| v * v).sum::<f64>() / gyration2;
        let strength = amount / (1.0 + turned);
        push.shift += found.way * strength;
        for (sum, v) in push.turn.iter_mut().zip(lever) {
            *sum += v * strength / gyration2;
        }
        push.count += 1.0;
    }

    /// Moves a body; how far its places went at most.
    pub(super) fn apply(&mut self, i: usize, push: &Push<D>, start: Vector<D>, far: f64) -> f64 {
        if push.count <= 0.0 {
            return 0.0;
        }
        let weight = RATE / push.count.sqrt();
        let domain = &self.extent.request().domain;
        let body = self.bodies[i];
        let mut to = body.centre + push.shift * weight;
        let gone = domain.offset(start, to);
        if gone.norm() > far {
            to = start + gone * (far / gone.norm());
        }
        let source = self.placements[i].source as u32;
        let to = self.extent.grounded(source, self.confined(to, (start, body.radius)));
        let rotation = rotation::<D>(push.turn.map(|v| v * weight));
        let step = Similarity::about(body.centre, domain.wrap(to), rotation, 1.0);
        let placement = &mut self.placements[i];
        placement.transform = step.after(&placement.transform);
        let (source, transform) = (placement.source, placement.transform);
        self.bodies[i] = self.body(source, &transform);
        let turned = push.turn.iter().map(|v| v * v).sum::<f64>().sqrt() * weight;
        let went = domain.offset(body.centre, self.bodies[i].centre).norm() + turned * body.radius;
        self.gone[i] += went;
        went
    }
}

impl<const D: usize> Things<'_, D> {
    /// What lies at a side of a box over which it may reach, with nothing beyond to hold it, goes no farther out than from where it started:
    /// otherwise the inside would give way to the outside and grow sparse.
    fn confined(&self, mut to: Vector<D>, (start, radius): (Vector<D>, f64)) -> Vector<D> {
        let request = self.extent.request();
        let (Border::Cross, Domain::Box(bounds)) = (request.border, &request.domain) else { return to };
        let size = bounds.size();
        for k in (0..D).filter(|k| size[*k] > THICK * self.widest) {
            let low = bounds.min[k] + (start[k] - bounds.min[k]).clamp(0.0, radius);
            let high = bounds.max[k] - (bounds.max[k] - start[k]).clamp(0.0, radius);
            to[k] = to[k].clamp(low.min(high), high.max(low));
        }
        to
    }
}

/// The turning of a push along `b` at `a`: about three axes in space, about one in the plane.
fn cross<const D: usize>(a: Vector<D>, b: Vector<D>) -> [f64; 3] {
    let at = |v: &Vector<D>, k: usize| if k < D { v[k] } else { 0.0 };
    let part = |k: usize, l: usize| at(&a, k) * at(&b, l) - at(&a, l) * at(&b, k);
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// The rotation about a vector by its length in radians, at most a quarter of a radian.
fn rotation<const D: usize>(turn: [f64; 3]) -> Matrix<D> {
    let angle = turn.iter().map(|v| v * v).sum::<f64>().sqrt();
    if angle <= 1e-12 {
        return Matrix::identity();
    }
    let axis = turn.map(|v| v / angle);
    let (sin, cos) = angle.min(0.25).sin_cos();
    let entry = |r: usize, c: usize| {
        let skew = match (r, c) {
            (0, 1) => -axis[2],
            (1, 0) => axis[2],
            (0, 2) => axis[1],
            (2, 0) => -axis[1],
            (1, 2) => -axis[0],
            (2, 1) => axis[0],
            _ => 0.0,
        };
        let same = if r == c { cos } else { 0.0 };
        same + sin * skew + (1.0 - cos) * axis[r] * axis[c]
    };
    Matrix(std::array::from_fn(|r| std::array::from_fn(|c| entry(r, c))))
}
