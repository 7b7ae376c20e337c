//! Faces of any number of corners as triangles: convex ones as fans, others by cutting ears.
//!
//! The corners of a face need not lie in one plane: what counts is how they look along the normal of the face, which is the sum of
//! the areas that its edges sweep (Newell's rule). A face that crosses itself has no ear at some point; what is left of it becomes a
//! fan, and that is told.

use arabesque_core::{Budget, Error, MeshPart, Result, Vector, Warning};

/// Work of one corner, and of one look at whether a corner lies in an ear.
const PER_CORNER: u64 = 60;
const PER_LOOK: u64 = 4;

/// Faces as they are read, each with the number of its line or its own.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    corners: Vec<u32>,
    /// Number that messages call the face by, and where its corners end.
    faces: Vec<(usize, usize)>,
    /// Name, and the first face.
    parts: Vec<(String, usize)>,
}

/// Triangles of faces.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) parts: Vec<MeshPart>,
    pub(crate) warnings: Vec<Warning>,
}

impl Polygons {
    /// Number of faces so far.
    pub(crate) fn len(&self) -> usize {
        self.faces.len()
    }

    /// Number of corners of all faces so far.
    pub(crate) fn corners(&self) -> usize {
        self.corners.len()
    }

    /// Adds a face.
    pub(crate) fn push(&mut self, number: usize, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.faces.push((number, self.corners.len()));
    }

    /// The faces from here on belong to a part.
    pub(crate) fn begin_part(&mut self, name: &str) {
        if self.parts.last().is_some_and(|(_, first)| *first == self.faces.len()) {
            self.parts.pop();
        }
        if self.parts.last().is_none_or(|(last, _)| last != name) {
            self.parts.push((name.to_owned(), self.faces.len()));
        }
    }

    /// The triangles. `noun` is what the numbers of faces count: faces or lines of the file `name`.
    ///
    /// # Errors
    /// [`Error::Input`] for a corner that is none of the `positions`; those of the budget.
    pub(crate) fn triangles(
        self,
        (name, noun): (&str, &str),
        positions: &[Vector<3>],
        budget: &Budget,
    ) -> Result<Triangles> {
        let most = self.corners.len().saturating_sub(2 * self.faces.len());
        let _held = budget.hold("triangles of the mesh", most.saturating_mul(12))?;
        let mut cutter = Cutter { positions, budget, triangles: Vec::new(), without_area: 0, crossing: Vec::new() };
        let mut starts = Vec::with_capacity(self.faces.len());
        let mut from = 0;
        for (number, end) in &self.faces {
            let corners = &self.corners[from..*end];
            from = *end;
            starts.push(cutter.triangles.len());
            if let Some(wrong) = corners.iter().find(|c| **c as usize >= positions.len()) {
                let problem =
                    format!("vertex {wrong} where the vertices 0 to {} are", positions.len().saturating_sub(1));
                let advice = "correct the number of the vertex, or write the mesh again from where it came from";
                return Err(Error::input(format!("{name}: {noun} {number}"), problem, advice));
            }
            cutter.face(*number, corners)?;
        }
        let total = cutter.triangles.len();
        let start = |face: usize| starts.get(face).copied().unwrap_or(total);
        let ends = self.parts.iter().skip(1).map(|(_, first)| start(*first)).chain([total]);
        let parts = self.parts.iter().zip(ends).map(|((name, first), end)| {
            let triangles = start(*first)..end;
            MeshPart { name: name.clone(), triangles }
        });
        let parts = parts.filter(|part| !part.triangles.is_empty()).collect();
        let warnings = cutter.warnings(name, noun);
        Ok(Triangles { triangles: cutter.triangles, parts, warnings })
    }
}

/// Cuts faces into triangles.
struct Cutter<'a> {
    positions: &'a [Vector<3>],
    budget: &'a Budget,
    triangles: Vec<[u32; 3]>,
    /// Faces of fewer than three different corners.
    without_area: usize,
    /// Numbers of faces that cross themselves.
    crossing: Vec<usize>,
}

impl Cutter<'_> {
    fn face(&mut self, number: usize, corners: &[u32]) -> Result<()> {
        self.budget.spend(PER_CORNER * corners.len() as u64)?;
        let mut ring = corners.to_vec();
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        match ring[..] {
            [a, b, c] if a != b && b != c && c != a => self.triangles.push([a, b, c]),
            [_, _, _, _, ..] => self.polygon(number, &ring)?,
            _ => self.without_area += 1,
        }
        Ok(())
    }

    fn polygon(&mut self, number: usize, ring: &[u32]) -> Result<()> {
        let flat = self.flat(ring);
        if is_convex(&flat) {
            self.fan(ring);
            return Ok(());
        }
        let mut left: Vec<usize> = (0..ring.len()).collect();
        let mut at = 0;
        let mut refused = 0;
        while left.len() > 3 {
            let n = left.len();
            let [a, b, c] = [at + n - 1, at, at + 1].map(|k| left[k % n]);
            self.budget.spend(PER_LOOK * n as u64)?;
            if is_ear(&flat, &left, [a, b, c]) {
                self.push([a, b, c].map(|k| ring[k]));
                left.remove(at);
                refused = 0;
                // Going on behind the next corner keeps the triangles from all meeting in one.
                at = (at + 1) % (n - 1);
            } else {
                refused += 1;
                at = (at + 1) % n;
            }
            if refused > left.len() {
                self.crossing.push(number);
                break;
            }
        }
        let rest: Vec<u32> = left.iter().map(|&k| ring[k]).collect();
        self.fan(&rest);
        Ok(())
    }

    fn fan(&mut self, ring: &[u32]) {
        ring[1..].windows(2).for_each(|pair| self.push([ring[0], pair[0], pair[1]]));
    }

    fn push(&mut self, [a, b, c]: [u32; 3]) {
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
        }
    }

    /// The corners as they look along the normal of the face: counter-clockwise.
    fn flat(&self, ring: &[u32]) -> Vec<Vector<2>> {
        let corner = |k: usize| self.positions[ring[k % ring.len()] as usize];
        let first = corner(0);
        let sweep = |sum, k| sum + (corner(k) - first).cross(corner(k + 1) - first);
        let normal = (0..ring.len()).fold(Vector::ZERO, sweep);
        let axis = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).unwrap_or(2);
        let [mut u, mut v] = [(axis + 1) % 3, (axis + 2) % 3];
        if normal[axis] < 0.0 {
            std::mem::swap(&mut u, &mut v);
        }
        (0..ring.len()).map(|k| corner(k) - first).map(|p| Vector::xy(p[u], p[v])).collect()
    }

    fn warnings(&self, name: &str, noun: &str) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.without_area > 0 {
            let message =
                format!("{name}: {} faces of fewer than three different vertices are left out", self.without_area);
            warnings.push(Warning::new(message, "remove them"));
        }
        if let Some(first) = self.crossing.first() {
            let count = self.crossing.len();
            let message = format!("{name}: {count} faces cross themselves, the first at {noun} {first}");
            warnings.push(Warning::new(message, "cut them into triangles where the mesh comes from"));
        }
        warnings
    }
}

/// Twice the area of a triangle: positive when it runs counter-clockwise.
fn turn(a: Vector<2>, b: Vector<2>, c: Vector<2>) -> f64 {
    (b - a).cross(c - a)
}

/// Whether every corner turns left, and the ring goes around once.
fn is_convex(flat: &[Vector<2>]) -> bool {
    let n = flat.len();
    let left = (0..n).all(|k| turn(flat[k], flat[(k + 1) % n], flat[(k + 2) % n]) > 0.0);
    let around: f64 =
        (0..n).map(|k| (flat[(k + 1) % n] - flat[k]).angle_to(flat[(k + 2) % n] - flat[(k + 1) % n])).sum();
    left && around < 3.0 * std::f64::consts::PI
}

/// Whether the triangle of three corners that follow one another turns left and holds none of the others.
fn is_ear(flat: &[Vector<2>], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [p, q, r] = [a, b, c].map(|k| flat[k]);
    if turn(p, q, r) <= 0.0 {
        return false;
    }
    let inside = |v: Vector<2>| {
        v != p && v != q && v != r && turn(p, q, v) >= 0.0 && turn(q, r, v) >= 0.0 && turn(r, p, v) >= 0.0
    };
    !left.iter().any(|&k| inside(flat[k]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(points: &[[f64; 3]], faces: &[&[u32]]) -> Result<Triangles> {
        let positions: Vec<_> = points.iter().copied().map(Vector).collect();
        let mut polygons = Polygons::default();
        for (k, face) in faces.iter().enumerate() {
            polygons.push(k + 1, face.iter().copied());
        }
        polygons.triangles(("a.ply", "face"), &positions, &Budget::default())
    }

    fn area(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
        let corner = |k: u32| Vector(points[k as usize]);
        triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a))[2] / 2.0).sum()
    }

    const ARROW: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [4.0, 2.0, 0.0], [0.0, 4.0, 0.0], [1.0, 2.0, 0.0]];

    #[test]
    fn convex_faces_are_fans() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(cut(&square, &[&[0, 1, 2, 3]]).unwrap().triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_face_with_a_notch_is_cut_inside() {
        for first in 0..4 {
            let ring: Vec<u32> = (0..4).map(|k| (k + first) % 4).collect();
            let cut = cut(&ARROW, &[&ring]).unwrap();
            assert_eq!(cut.triangles.len(), 2);
            let areas: Vec<f64> = cut.triangles.iter().map(|t| area(&ARROW, &[*t])).collect();
            assert!(areas.iter().all(|a| *a > 0.0) && cut.warnings.is_empty(), "{areas:?}");
        }
    }

    #[test]
    fn a_face_that_crosses_itself_is_told() {
        let bow =
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], [4.0, 3.1, 0.0], [2.0, 5.0, 0.0], [1.0, -2.0, 0.0]];
        let cut = cut(&bow, &[&[0, 1, 2, 3, 4, 5]]).unwrap();
        assert_eq!(cut.triangles.len(), 4);
        assert!(
            cut.warnings[0].message.contains("1 faces cross themselves, the first at face 1"),
            "{:?}",
            cut.warnings
        );
    }

    #[test]
    fn faces_without_area_are_left_out_and_wrong_corners_named() {
        let cut_ = cut(&ARROW, &[&[0, 1], &[1, 1, 2], &[0, 1, 2], &[0, 1, 0], &[]]).unwrap();
        assert_eq!(cut_.triangles, [[0, 1, 2]]);
        assert!(cut_.warnings[0].message.contains("4 faces of fewer than three"), "{:?}", cut_.warnings);
        let message = cut(&ARROW, &[&[0, 1, 2], &[0, 1, 4]]).unwrap_err().to_string();
        assert!(message.contains("a.ply: face 2: vertex 4 where the vertices 0 to 3 are"), "{message}");
    }

    #[test]
    fn parts_are_runs_of_triangles() {
        let positions: Vec<_> = ARROW.iter().copied().map(Vector).collect();
        let mut polygons = Polygons::default();
        polygons.begin_part("empty");
        polygons.begin_part("lid");
        polygons.push(1, [0, 1, 2, 3]);
        polygons.begin_part("lid");
        polygons.push(2, [0, 1, 2]);
        polygons.begin_part("rim");
        polygons.push(3, [1, 2, 3]);
        polygons.begin_part("nothing");
        let cut = polygons.triangles(("a", "line"), &positions, &Budget::default()).unwrap();
        let runs: Vec<_> = cut.parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(runs, [("lid", 0..3), ("rim", 3..4)]);
    }

    proptest! {
        #[test]
        fn stars_are_covered_once(radii in prop::collection::vec(0.2..1.0_f64, 4..20), tilt in -1.0..1.0_f64) {
            let n = radii.len();
            let corner = |k: usize| {
                let angle = std::f64::consts::TAU * k as f64 / n as f64;
                let [x, y] = [radii[k] * angle.cos(), radii[k] * angle.sin()];
                [x, y, tilt * x]
            };
            let points: Vec<_> = (0..n).map(corner).collect();
            let ring: Vec<u32> = (0..n as u32).collect();
            let cut = cut(&points, &[&ring]).unwrap();
            let expected: f64 = (0..n).map(|k| {
                let [a, b] = [points[k], points[(k + 1) % n]];
                (a[0] * b[1] - a[1] * b[0]) / 2.0
            }).sum();
            prop_assert_eq!(cut.triangles.len(), n - 2);
            prop_assert!((area(&points, &cut.triangles) - expected).abs() < 1e-9);
            prop_assert!(cut.triangles.iter().all(|t| area(&points, &[*t]) >= 0.0));
        }
    }
}
