//! Where two elements meet, and how deep they may.

use arabesque_core::{Bounds, Budget, Domain, Exemplar, GridIndex, Result, Similarity, Solid, Vector};

use crate::exemplar::library::Library;

/// Work for each place of a surface that is looked up.
const LOOK: u64 = 10;
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<const D: usize> {
    pub(super) depth: f64,
    /// Where it is.
    pub(super) at: Vector<D>,
    /// Which way the first one has to go, of length 1.
    pub(super) way: Vector<D>,
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

    /// The deepest place of the surface of `other` in this one, with the way out of it; `own_box` is that of this one in the coordinates
    /// of the other.
    fn deepest(&self, other: &Self, shift: Vector<D>, own_box: &Bounds<D>) -> Option<Contact<D>> {
        let to_own = self.pose.inverse();
        let both = to_own.after(&other.pose);
        let moved = to_own.rotation.apply(shift) * to_own.scale;
        let mut best: Option<(f64, Vector<D>)> = None;
        // Most of a surface is far from a body beside it.
        for &point in other.solid.points.iter().filter(|point| own_box.contains(**point)) {
            let own = both.apply(point) + moved;
            let depth = self.solid.depth(own) * self.pose.scale;
            if depth > 0.0 && best.is_none_or(|(most, _)| depth > most) {
                best = Some((depth, own));
            }
        }
        // What lies at one place hardly shows in surfaces: the ball in the middle of the other one has to come out as well.
        let middle = to_own.apply(other.centre + shift);
        let depth = self.solid.depth(middle) * self.pose.scale;
        if depth > 0.0 {
            let whole = depth + other.solid.inradius() * other.pose.scale;
            if best.is_none_or(|(most, _)| whole > most) {
                best = Some((whole, middle));
            }
        }
        let (depth, own) = best?;
        let mut way = self.pose.rotation.apply(self.solid.outwards(own));
        if way == Vector::ZERO {
            // In the very middle any way leads out.
            way[0] = 1.0;
        }
        Some(Contact { depth, at: self.pose.apply(own), way })
    }
}

/// How two bodies overlap, and what it cost to find out; `offset` is the way between their centres, around the back on a torus.
pub(super) fn contact<const D: usize>(
    a: &Body<'_, D>,
    b: &Body<'_, D>,
    offset: Vector<D>,
) -> (Option<Contact<D>>, u64) {
    if offset.norm() >= a.radius + b.radius {
        return (None, APART);
    }
    let shift = a.centre + offset - b.centre;
    let (to_a, to_b) = (a.pose.inverse(), b.pose.inverse());
    let (of_b_in_a, of_a_in_b) = (to_a.after(&b.pose), to_b.after(&a.pose));
    let shifted = |to: &Similarity<D>, by: Vector<D>| to.rotation.apply(by) * to.scale;
    // Long bodies side by side lie beside one another's boxes mostly.
    let b_in_a = Body::around(b, &of_b_in_a, shifted(&to_a, shift));
    let a_in_b = Body::around(a, &of_a_in_b, shifted(&to_b, -shift));
    if !b_in_a.intersects(&a.solid.bounds) || !a_in_b.intersects(&b.solid.bounds) {
        return (None, APART);
    }
    let of_b = a.deepest(b, shift, &a_in_b).map(|c| Contact { way: -c.way, ..c });
    let back = -shift;
    let of_a = b.deepest(a, back, &b_in_a).map(|c| Contact { at: c.at + shift, ..c });
    let deepest = match (of_a, of_b) {
        (Some(x), Some(y)) => Some(if x.depth >= y.depth { x } else { y }),
        (one, other) => one.or(other),
    };
    (deepest, LOOK * (a.solid.points.len() + b.solid.points.len()) as u64)
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
