//! Triangles split where they have to be small.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Result, Vector};

/// Times that edges are halved at most: more would be finer than numbers are.
const HALVINGS: usize = 40;
/// Work units of an edge that is looked at.
const EDGE: u64 = 400;

/// Points and triangles.
pub(super) struct Triangles {
    pub(super) points: Vec<Vector<3>>,
    pub(super) corners: Vec<[u32; 3]>,
}

impl Triangles {
    /// Halves edges for which `is_long` holds, and the triangles beside them, until there are none. Triangles stay together: both sides of an edge
    /// see it halved.
    ///
    /// # Errors
    /// Over the limits of `nodes` or `work`, and when somebody asks to stop.
    pub(super) fn refine(&mut self, budget: &Budget, is_long: impl Fn(Vector<3>, Vector<3>) -> bool) -> Result<()> {
        for _ in 0..HALVINGS {
            let halves = self.halve(budget, &is_long)?;
            if halves.is_empty() {
                break;
            }
            budget.within("triangles beside sharp edges", self.corners.len(), ("nodes", budget.limits().nodes))?;
            let old = std::mem::take(&mut self.corners);
            self.corners.reserve(2 * old.len());
            for corners in old {
                self.split(corners, &halves);
            }
        }
        Ok(())
    }

    /// The middle of every edge that is too long, by its ends.
    fn halve(
        &mut self,
        budget: &Budget,
        is_long: &impl Fn(Vector<3>, Vector<3>) -> bool,
    ) -> Result<BTreeMap<(u32, u32), u32>> {
        let mut halves = BTreeMap::new();
        let mut meter = budget.meter();
        for corners in &self.corners {
            for (a, b) in edges(corners) {
                meter.spend(EDGE)?;
                let (from, to) = (self.points[a as usize], self.points[b as usize]);
                if a != b && !halves.contains_key(&(a, b)) && is_long(from, to) {
                    halves.insert((a, b), self.points.len() as u32);
                    self.points.push((from + to) * 0.5);
                }
            }
        }
        Ok(halves)
    }

    /// Puts a triangle back, split at those of its edges that are halved.
    fn split(&mut self, corners: [u32; 3], halves: &BTreeMap<(u32, u32), u32>) {
        let middles = edges(&corners).map(|edge| halves.get(&edge).copied());
        let turned = |k: usize| [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
        match middles {
            [None, None, None] => self.corners.push(corners),
            [Some(ab), Some(bc), Some(ca)] => {
                let [a, b, c] = corners;
                self.corners.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            _ if middles.iter().flatten().count() == 1 => {
                let k = middles.iter().position(Option::is_some).unwrap_or(0);
                let ([a, b, c], half) = (turned(k), middles[k].unwrap_or(corners[k]));
                self.corners.extend([[a, half, c], [half, b, c]]);
            }
            _ => {
                // From the corner between the two halved edges on.
                let whole = middles.iter().position(Option::is_none).unwrap_or(0);
                let [a, b, c] = turned((whole + 2) % 3);
                let of = |x: u32, y: u32| halves.get(&(x.min(y), x.max(y))).copied().unwrap_or(x);
                let (ab, ca) = (of(a, b), of(c, a));
                self.corners.push([a, ab, ca]);
                let far = |x: u32, y: u32| (self.points[x as usize] - self.points[y as usize]).norm2();
                let two = if far(ab, c) <= far(b, ca) { [[ab, b, c], [ab, c, ca]] } else { [[ab, b, ca], [b, c, ca]] };
                self.corners.extend(two);
            }
        }
    }
}

/// The edges of a triangle from corner `k` to the next, the smaller number first.
fn edges(&[a, b, c]: &[u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)].map(|(x, y)| (x.min(y), x.max(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_long_edge_is_left_and_the_area_stays() {
        let at = |x: f64, y: f64| Vector([x, y, 0.0]);
        let points = vec![at(0.0, 0.0), at(3.0, 0.0), at(3.0, 2.0), at(0.0, 2.0)];
        let mut mesh = Triangles { points, corners: vec![[0, 1, 2], [0, 2, 3]] };
        let is_long = |a: Vector<3>, b: Vector<3>| (a - b).norm() > 0.2 + 0.2 * (a + b)[0];
        mesh.refine(&Budget::default(), is_long).unwrap();
        let mut sides = BTreeMap::<(u32, u32), usize>::new();
        let mut area = 0.0;
        for t in &mesh.corners {
            let [a, b, c] = t.map(|v| mesh.points[v as usize]);
            let part = 0.5 * (b - a).cross(c - a)[2];
            assert!(part > 0.0, "{t:?} is turned or flat");
            area += part;
            for (x, y) in edges(t) {
                assert!(!is_long(mesh.points[x as usize], mesh.points[y as usize]));
                *sides.entry((x, y)).or_default() += 1;
            }
        }
        assert!((area - 6.0).abs() < 1e-9 && mesh.corners.len() > 40, "{area}");
        // Where only one triangle is beside an edge, it lies on the border.
        let on_border = |v: u32| {
            let p = mesh.points[v as usize];
            p[0] == 0.0 || p[0] == 3.0 || p[1] == 0.0 || p[1] == 2.0
        };
        assert!(sides.iter().all(|((a, b), n)| *n == 2 || *n == 1 && on_border(*a) && on_border(*b)));
    }
}
