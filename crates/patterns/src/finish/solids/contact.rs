//! Where two elements meet, and how deep they may.

use arabesque_core::{Bounds, Budget, Domain, Exemplar, GridIndex, Result, Similarity, Solid, Vector};

use crate::exemplar::library::Library;

/// Work for each place of a surface that is looked up, and for one that is passed by.
const LOOK: u64 = 12;
const PASSED: u64 = 2;
/// Work for two bodies of which the boxes say that they are apart.
const APART: u64 = 200;
/// Overlaps of the exemplar that a pair may have: this share of those that touch are no deeper.
const QUANTILE: f64 = 0.75;
/// Overlaps below this share of the inner radius are none.
const TOUCH: f64 = 0.02;

/// A solid in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<'a, const D: usize> {
    pub(super) solid: &'a Solid<D>,
    /// From the coordinates of the solid to those of the output.
    pub(super) pose: Similarity<D>,
    pub(super) centre: Vector<D>,
    pub(super) radius: f64,
}

/// The deepest place of two solids in one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact<const D: usize> {
    pub(super) depth: f64,
    /// Where it is.
    pub(super) at: Vector<D>,
    /// Which way the first one has to go, of length 1.
    pub(super) way: Vector<D>,
}

/// What is known of two bodies beside one another since they were last compared.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pair<const D: usize> {
    /// They lie no deeper in one another than they may until both together have gone so far since the beginning.
    Apart(f64),
    /// The first one lies too deep in the second, by so much.
    Over(Contact<D>, f64),
}

/// How two bodies lie to one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting<const D: usize> {
    /// Their overlap, if they do.
    pub(super) contact: Option<Contact<D>>,
    /// How far they are apart at least, 0 where they overlap.
    pub(super) gap: f64,
    /// What it cost to find out.
    pub(super) cost: u64,
}

impl<const D: usize> Meeting<D> {
    fn apart(gap: f64) -> Self {
        Self { contact: None, gap: gap.max(0.0), cost: APART }
    }
}

impl<'a, const D: usize> Body<'a, D> {
    pub(super) fn new(solid: &'a Solid<D>, pose: Similarity<D>) -> Self {
        Self { solid, pose, centre: pose.apply(solid.centre), radius: solid.radius() * pose.scale }
    }

    /// How deep a place lies in it.
    pub(super) fn depth(&self, p: Vector<D>) -> f64 {
        self.solid.depth(self.pose.inverse().apply(p)) * self.pose.scale
    }

    /// The place of its surface that is nearest to `p`, with the distance.
    pub(super) fn nearest(&self, p: Vector<D>) -> (f64, Vector<D>) {
        let own = self.pose.inverse().apply(p);
        let far = |q: &Vector<D>| (*q - own).norm2();
        let nearest = self.solid.points.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)));
        let at = nearest.map_or(self.centre, |q| self.pose.apply(q));
        ((at - p).norm(), at)
    }

    /// A distance that `p` is away from it at least, 0 within the box around it.
    pub(super) fn beyond_box(&self, p: Vector<D>) -> f64 {
        let own = self.pose.inverse().apply(p);
        (self.solid.bounds.clamp(own) - own).norm() * self.pose.scale
    }

    /// How far from its surface depths are known all around, in its own coordinates.
    fn known(&self) -> f64 {
        let (grid, own) = (&self.solid.distance.bounds, &self.solid.bounds);
        let (low, high) = (own.min - grid.min, grid.max - own.max);
        low.0.into_iter().chain(high.0).fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// A box in the coordinates of this one around the box of `other`, which `both` and `moved` bring there.
    fn around(other: &Self, both: &Similarity<D>, moved: Vector<D>) -> Bounds<D> {
        let its = &other.solid.bounds;
        let (centre, half) = (both.apply(its.centre()) + moved, its.size() * (0.5 * both.scale));
        let mut reach = Vector::ZERO;
        for k in 0..D {
            reach[k] = (0..D).map(|l| both.rotation.0[k][l].abs() * half[l]).sum();
        }
        Bounds { min: centre - reach, max: centre + reach }
    }

    /// The deepest place of the surface of `other` in this one, with the way out of it; else how far the surface is away at least, as far
    /// as `known`, and how many places were looked up. `own_box` is that of this one in the coordinates of the other.
    fn deepest(
        &self,
        other: &Self,
        shift: Vector<D>,
        (own_box, known): (&Bounds<D>, f64),
    ) -> (Option<Contact<D>>, f64, u64) {
        let to_own = self.pose.inverse();
        let both = to_own.after(&other.pose);
        let moved = to_own.rotation.apply(shift) * to_own.scale;
        let mut best: Option<(f64, Vector<D>)> = None;
        let (mut highest, mut looked) = (-known, 0);
        // Most of a surface is far from a body beside it.
        let near = own_box.grown(known / other.pose.scale.max(f64::MIN_POSITIVE));
        for &point in other.solid.points.iter().filter(|point| near.contains(**point)) {
            looked += 1;
            let own = both.apply(point) + moved;
            let depth = self.solid.depth(own) * self.pose.scale;
            highest = highest.max(depth);
            if depth > 0.0 && best.is_none_or(|(most, _)| depth > most) {
                best = Some((depth, own));
            }
        }
        // What lies at one place hardly shows in surfaces: the ball in the middle of the other one has to come out as well.
        let middle = to_own.apply(other.centre + shift);
        let depth = self.solid.depth(middle) * self.pose.scale;
        highest = highest.max(depth);
        if depth > 0.0 {
            let whole = depth + other.solid.inradius() * other.pose.scale;
            if best.is_none_or(|(most, _)| whole > most) {
                best = Some((whole, middle));
            }
        }
        let Some((depth, own)) = best else { return (None, (-highest).max(0.0), looked) };
        let mut way = self.pose.rotation.apply(self.solid.outwards(own));
        if way == Vector::ZERO {
            // In the very middle any way leads out.
            way[0] = 1.0;
        }
        (Some(Contact { depth, at: self.pose.apply(own), way }), 0.0, looked)
    }
}

/// How two bodies overlap, and what it cost to find out; `offset` is the way between their centres, around the back on a torus.
pub(super) fn contact<const D: usize>(
    a: &Body<'_, D>,
    b: &Body<'_, D>,
    offset: Vector<D>,
) -> (Option<Contact<D>>, u64) {
    let found = meeting(a, b, offset);
    (found.contact, found.cost)
}

/// How two bodies lie to one another; `offset` is the way between their centres, around the back on a torus.
pub(super) fn meeting<const D: usize>(a: &Body<'_, D>, b: &Body<'_, D>, offset: Vector<D>) -> Meeting<D> {
    let between = offset.norm() - (a.radius + b.radius);
    if between >= 0.0 {
        return Meeting::apart(between);
    }
    let shift = a.centre + offset - b.centre;
    let (to_a, to_b) = (a.pose.inverse(), b.pose.inverse());
    let (of_b_in_a, of_a_in_b) = (to_a.after(&b.pose), to_b.after(&a.pose));
    let shifted = |to: &Similarity<D>, by: Vector<D>| to.rotation.apply(by) * to.scale;
    // Long bodies side by side lie beside one another's boxes mostly.
    let b_in_a = Body::around(b, &of_b_in_a, shifted(&to_a, shift));
    let a_in_b = Body::around(a, &of_a_in_b, shifted(&to_b, -shift));
    let aside = beside(&b_in_a, &a.solid.bounds) * a.pose.scale;
    let aside = aside.max(beside(&a_in_b, &b.solid.bounds) * b.pose.scale);
    if aside > 0.0 {
        return Meeting::apart(aside);
    }
    let known = (a.known() * a.pose.scale).min(b.known() * b.pose.scale);
    let (of_b, gap, looked) = a.deepest(b, shift, (&a_in_b, known));
    let (of_a, other_gap, also) = b.deepest(a, -shift, (&b_in_a, known));
    let of_b = of_b.map(|c| Contact { way: -c.way, ..c });
    let of_a = of_a.map(|c| Contact { at: c.at + shift, ..c });
    let contact = match (of_a, of_b) {
        (Some(x), Some(y)) => Some(if x.depth >= y.depth { x } else { y }),
        (one, other) => one.or(other),
    };
    let all = (a.solid.points.len() + b.solid.points.len()) as u64;
    let gap = if contact.is_some() { 0.0 } else { gap.min(other_gap) };
    Meeting { contact, gap, cost: APART + PASSED * all + LOOK * (looked + also) }
}

/// How far two boxes are apart along the axis along which they are most; negative where they overlap.
fn beside<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> f64 {
    (0..D).map(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k])).fold(f64::NEG_INFINITY, f64::max)
}

/// How deep elements of two classes may lie in one another.
#[derive(Debug)]
pub(super) struct Allowed {
    classes: usize,
    depth: Vec<f64>,
}

impl Allowed {
    /// What the exemplar shows.
    pub(super) fn measure<const D: usize>(
        exemplar: &Exemplar<D>,
        library: &Library<D>,
        budget: &Budget,
    ) -> Result<Self> {
        let classes = library.classes();
        let bodies: Vec<_> =
            exemplar.elements.iter().zip(&exemplar.solids).map(|(e, s)| Body::new(s, e.pose)).collect();
        let centres: Vec<_> = bodies.iter().map(|b| b.centre).collect();
        let widest = bodies.iter().map(|b| b.radius).fold(0.0, f64::max);
        let index = GridIndex::new(&centres, widest.max(1e-9), &Domain::Box(exemplar.window));
        let mut found = vec![Vec::new(); classes * classes];
        let mut meter = budget.meter();
        for (i, a) in bodies.iter().enumerate() {
            let mut near = Vec::new();
            index.within(a.centre, a.radius + widest, |j, offset| near.push((j, offset)));
            for (j, offset) in near.into_iter().filter(|(j, _)| *j > i) {
                let (found_here, cost) = contact(a, &bodies[j], offset);
                meter.spend(cost)?;
                if let Some(contact) = found_here {
                    let (a, b) = (library.class[i as u32] as usize, library.class[j as u32] as usize);
                    found[a.min(b) * classes + a.max(b)].push(contact.depth);
                }
            }
        }
        let inner: Vec<f64> = (0..classes as u32)
            .map(|c| library.members(c).iter().map(|&e| inner(exemplar, e)).fold(f64::INFINITY, f64::min))
            .collect();
        let mut depth = vec![0.0; classes * classes];
        for a in 0..classes {
            for b in a..classes {
                let list = &mut found[a * classes + b];
                list.sort_by(f64::total_cmp);
                let shown = list.get((QUANTILE * list.len() as f64) as usize).copied().unwrap_or(0.0);
                let least = TOUCH * inner[a].min(inner[b]);
                depth[a * classes + b] = shown.max(least);
                depth[b * classes + a] = shown.max(least);
            }
        }
        Ok(Self { classes, depth })
    }

    /// For elements of these classes.
    pub(super) fn of(&self, a: u32, b: u32) -> f64 {
        self.depth[a as usize * self.classes + b as usize]
    }
}

fn inner<const D: usize>(exemplar: &Exemplar<D>, element: u32) -> f64 {
    let e = element as usize;
    exemplar.solids[e].inradius() * exemplar.elements[e].pose.scale
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Grid, Matrix, Stage, Stream};

    use super::*;

    const HALF: [f64; 3] = [0.8, 0.3, 0.2];

    /// A box whose distances are known all around it.
    fn block() -> Solid<3> {
        let half = Vector(HALF);
        let bounds = Bounds::new(-half, half);
        let around = bounds.grown(0.3);
        let mut distance = Grid { bounds: around, nodes: [45, 25, 21], values: vec![0.0; 45 * 25 * 21] };
        let depth = |p: Vector<3>| {
            let off: Vector<3> = Vector(std::array::from_fn(|k| p[k].abs() - HALF[k]));
            let outside = off.map(|v| v.max(0.0)).norm();
            -outside - off[0].max(off[1]).max(off[2]).min(0.0)
        };
        distance.values = (0..distance.values.len()).map(|n| depth(distance.node(n))).collect();
        let sides = |n: usize| {
            let cell = [n % 9, n / 9 % 5, n / 45];
            Vector(std::array::from_fn(|k| HALF[k] * (cell[k] as f64 / [4.0, 2.0, 1.0][k] - 1.0)))
        };
        Solid::new(distance, bounds, (0..135).map(sides).collect(), Vector::ZERO)
    }

    fn turned(stream: &mut Stream) -> Matrix<3> {
        let mut m = Matrix::<3>::identity();
        m.0.iter_mut().flatten().for_each(|v| *v += stream.range(-2.0, 2.0));
        m.nearest_rotation()
    }

    #[test]
    fn what_is_apart_does_not_touch_until_it_has_gone_as_far() {
        let solid = block();
        let mut stream = Stream::new(11, Stage::TEST, 0);
        let (mut apart, mut known) = (0, 0);
        for _ in 0..400 {
            let place = Vector(std::array::from_fn(|_| stream.range(-1.2, 1.2)));
            let pose = Similarity::about(Vector::ZERO, place, turned(&mut stream), 1.0);
            let (a, b) = (Body::new(&solid, Similarity::identity()), Body::new(&solid, pose));
            let found = meeting(&a, &b, b.centre - a.centre);
            if found.contact.is_some() {
                assert_eq!(found.gap, 0.0);
                continue;
            }
            apart += 1;
            known += usize::from(found.gap > 0.05);
            // Straight on towards the other one, which is the worst that it can do.
            let step = (a.centre - b.centre).unit_or_zero() * (0.99 * found.gap);
            let nearer = Body::new(&solid, Similarity::shift(step).after(&pose));
            let then = meeting(&a, &nearer, nearer.centre - a.centre);
            assert!(then.contact.is_none_or(|c| c.depth < 0.03), "{found:?} {then:?}");
        }
        assert!(apart > 100 && known * 2 > apart, "{apart} {known}");
    }

    #[test]
    fn overlaps_look_the_same_from_both_sides() {
        let solid = block();
        let a = Body::new(&solid, Similarity::identity());
        let b = Body::new(&solid, Similarity::shift(Vector([0.1, 0.55, 0.05])));
        let (one, other) = (meeting(&a, &b, b.centre - a.centre), meeting(&b, &a, a.centre - b.centre));
        let (Some(one), Some(other)) = (one.contact, other.contact) else { panic!("they overlap") };
        assert!((one.depth - 0.05).abs() < 0.02 && (one.depth - other.depth).abs() < 1e-9, "{one:?} {other:?}");
        assert!((one.way + other.way).norm() < 0.05 && one.way[1] < -0.9, "{one:?} {other:?}");
    }
}
