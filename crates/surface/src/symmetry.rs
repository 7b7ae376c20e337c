//! Rotations that leave a solid thing as it is.
//!
//! They are found by trying: turns about the axes of inertia, about the normals of faces and through corners, by the angles that a solid may
//! have; a turn counts where the surface comes to lie on itself. What they generate together is a group.

use std::f64::consts::TAU;

use arabesque_core::{Budget, Matrix, Result, TriangleMesh, Vector};

use crate::mesh::MeshIndex;

/// A turn may move the surface off itself by this share of half of the smallest side.
const TOLERANCE: f64 = 0.14;
/// Places of the surface that are tried.
const PLACES: usize = 40;
/// Axes along normals, and along corners, at most.
const AXES: usize = 13;
/// Faces that are told apart, and corners that are looked at.
const FACES: usize = 200;
const CORNERS: usize = 400;
/// Axes whose directions are nearer than this, as a sine, are one.
const SAME: f64 = 0.15;
/// Orders of turns.
const ORDERS: [u32; 5] = [2, 3, 4, 5, 6];
/// Angles, in turns, about an axis that leave only round things as they are.
const ODD: [f64; 4] = [0.0893, 0.1571, 0.2897, 0.4231];
/// Most rotations of a group: those of an icosahedron.
const MOST: usize = 60;
/// Work of a place that is tried.
const LOOK: u64 = 2500;

/// The rotations about its centre that leave a solid as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetry {
    /// Those that are finitely many, the identity first; up to turns about the axis where there is one.
    pub rotations: Vec<Matrix<3>>,
    /// An axis about which any turn does.
    pub axis: Option<Vector<3>>,
    /// Whether any rotation does.
    pub is_round: bool,
}

impl Default for Symmetry {
    fn default() -> Self {
        Self { rotations: vec![Matrix::identity()], axis: None, is_round: false }
    }
}

/// A solid that is turned to see whether it stays as it is.
struct Trial<'a> {
    index: &'a MeshIndex,
    centre: Vector<3>,
    places: Vec<Vector<3>>,
    least: f64,
    budget: &'a Budget,
}

impl Trial<'_> {
    fn stays(&self, turn: &Matrix<3>) -> Result<bool> {
        for p in &self.places {
            self.budget.spend(LOOK)?;
            if self.index.closest_within(self.centre + turn.apply(*p - self.centre), self.least).is_none() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether any turn about an axis does.
    fn is_round_about(&self, axis: Vector<3>) -> Result<bool> {
        for share in ODD {
            if !self.stays(&turned(axis, share * TAU))? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Symmetry {
    /// Tries the rotations of a mesh about `centre`, with `places` all over its surface.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub fn of(
        mesh: &TriangleMesh,
        index: &MeshIndex,
        (centre, places): (Vector<3>, &[Vector<3>]),
        budget: &Budget,
    ) -> Result<Self> {
        let size = index.bounds().size();
        let smallest = size.0.into_iter().fold(f64::INFINITY, f64::min);
        let places: Vec<_> = places.iter().copied().step_by(places.len().div_ceil(PLACES).max(1)).collect();
        let trial = Trial { index, centre, places, least: 0.5 * TOLERANCE * smallest, budget };
        if trial.least <= 0.0 || trial.places.len() < 4 {
            return Ok(Self::default());
        }
        let axes = axes(mesh, &trial);
        let mut round = Vec::new();
        for axis in &axes {
            if trial.is_round_about(*axis)? {
                round.push(*axis);
            }
        }
        if round.iter().any(|a| a.cross(round[0]).norm() > SAME) {
            return Ok(Self { is_round: true, ..Self::default() });
        }
        let axis = round.first().copied();
        let mut found = vec![Matrix::identity()];
        for other in axes.iter().filter(|a| axis.is_none_or(|axis| a.cross(axis).norm() > SAME)) {
            // Beside an axis of any turn there is nothing but half turns across it.
            for order in ORDERS.into_iter().take(if axis.is_some() { 1 } else { ORDERS.len() }) {
                let turn = turned(*other, TAU / f64::from(order));
                if !known(&found, &turn) && trial.stays(&turn)? {
                    found.push(turn);
                    if axis.is_some() {
                        return Ok(Self { rotations: found, axis, is_round: false });
                    }
                }
            }
        }
        Ok(Self { rotations: closed(found), axis, is_round: false })
    }

    /// What has to be done first, about the centre, for `rotation` to come as near to `reference` as it can while the thing lies the same.
    pub fn nearest(&self, rotation: &Matrix<3>, reference: &Matrix<3>) -> Matrix<3> {
        // All that is left to do.
        let whole = rotation.transpose().compose(reference);
        if self.is_round {
            return whole;
        }
        let best = |turn: &Matrix<3>| {
            let Some(axis) = self.axis else { return *turn };
            let rest = turn.transpose().compose(&whole);
            turn.compose(&about(axis, &rest))
        };
        let likeness = |turn: &Matrix<3>| -> f64 {
            (0..3).flat_map(|r| (0..3).map(move |c| (r, c))).map(|(r, c)| turn.0[r][c] * whole.0[r][c]).sum()
        };
        let all = self.rotations.iter().map(best).map(|turn| (likeness(&turn), turn));
        let first = all.fold(None, |found: Option<(f64, Matrix<3>)>, next| match found {
            Some(known) if known.0 >= next.0 - 1e-9 => Some(known),
            _ => Some(next),
        });
        first.map_or_else(Matrix::identity, |(_, turn)| turn)
    }
}

/// Directions about which the solid may be symmetric: normals of its largest faces, of its corners, and its axes of inertia.
fn axes(mesh: &TriangleMesh, trial: &Trial<'_>) -> Vec<Vector<3>> {
    let mut found: Vec<Vector<3>> = Vec::new();
    let add = |found: &mut Vec<Vector<3>>, way: Vector<3>, most: usize| {
        if let Some(way) = way.unit_if_longer(1e-12)
            && found.len() < most
            && found.iter().all(|known| known.cross(way).norm() > SAME)
        {
            found.push(way);
        }
    };
    let mut faces: Vec<Vector<3>> = Vec::new();
    for t in 0..mesh.triangles.len() {
        let normal = mesh.double_area(t);
        // Parts of one face count together.
        match faces.iter().position(|sum| sum.unit_or_zero().dot(normal.unit_or_zero()) > 0.999) {
            Some(known) => faces[known] += normal,
            None if faces.len() < FACES => faces.push(normal),
            None => {}
        }
    }
    faces.sort_by(|a, b| b.norm2().total_cmp(&a.norm2()));
    faces.iter().for_each(|normal| add(&mut found, *normal, AXES));
    inertia(mesh, trial.centre).into_iter().for_each(|axis| add(&mut found, axis, AXES + 3));
    let mut corners: Vec<Vector<3>> = mesh.positions.iter().map(|p| *p - trial.centre).collect();
    corners.sort_by(|a, b| b.norm2().total_cmp(&a.norm2()));
    let most = found.len() + AXES;
    corners.iter().take(CORNERS).for_each(|p| add(&mut found, *p, most));
    found
}

/// Axes of inertia of a surface, longest first, by turning two of them at a time.
fn inertia(mesh: &TriangleMesh, centre: Vector<3>) -> [Vector<3>; 3] {
    let mut m = Matrix::<3>::zero();
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t).map(|p| p - centre);
        let sum = corners[0] + corners[1] + corners[2];
        let area = mesh.double_area(t).norm();
        for (r, row) in m.0.iter_mut().enumerate() {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry += area * (corners.iter().map(|v| v[r] * v[c]).sum::<f64>() + sum[r] * sum[c]);
            }
        }
    }
    let mut vectors = Matrix::<3>::identity();
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.0[p][q];
            if off.abs() <= f64::MIN_POSITIVE {
                continue;
            }
            let angle = 0.5 * (2.0 * off).atan2(m.0[p][p] - m.0[q][q]);
            let (sin, cos) = angle.sin_cos();
            let mut turn = Matrix::identity();
            (turn.0[p][p], turn.0[p][q], turn.0[q][p], turn.0[q][q]) = (cos, -sin, sin, cos);
            m = turn.transpose().compose(&m).compose(&turn);
            vectors = vectors.compose(&turn);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| m.0[*b][*b].total_cmp(&m.0[*a][*a]));
    order.map(|k| Vector(std::array::from_fn(|r| vectors.0[r][k])))
}

/// The rotation about an axis of length 1.
fn turned(axis: Vector<3>, angle: f64) -> Matrix<3> {
    let (sin, cos) = angle.sin_cos();
    let column = |c: usize| {
        let mut v = Vector::ZERO;
        v[c] = 1.0;
        v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
    };
    let columns = [column(0), column(1), column(2)];
    Matrix(std::array::from_fn(|r| columns.map(|c| c[r])))
}

/// The part of a rotation that turns about an axis of length 1.
fn about(axis: Vector<3>, rotation: &Matrix<3>) -> Matrix<3> {
    let m = &rotation.0;
    let trace = m[0][0] + m[1][1] + m[2][2];
    let along = axis.dot(rotation.apply(axis));
    let odd = Vector([m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]]).dot(axis);
    // The angle by which turning about the axis leaves the least to do.
    turned(axis, odd.atan2(trace - along))
}

fn known(found: &[Matrix<3>], turn: &Matrix<3>) -> bool {
    let is_near = |other: &Matrix<3>| {
        let off: f64 =
            (0..3).flat_map(|r| (0..3).map(move |c| (r, c))).map(|(r, c)| (other.0[r][c] - turn.0[r][c]).powi(2)).sum();
        off < 0.02
    };
    found.iter().any(is_near)
}

/// All rotations that some of them make together; those alone where that would not end.
fn closed(generators: Vec<Matrix<3>>) -> Vec<Matrix<3>> {
    let mut group = generators.clone();
    let mut next = 0;
    while next < group.len() {
        for generator in &generators {
            let product = group[next].compose(generator).nearest_rotation();
            if !known(&group, &product) {
                if group.len() == MOST {
                    return vec![Matrix::identity()];
                }
                group.push(product);
            }
        }
        next += 1;
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spread::scatter;

    fn found(mesh: &TriangleMesh) -> Symmetry {
        let budget = Budget::default();
        let index = MeshIndex::new(mesh, "t", &budget).unwrap();
        let places: Vec<_> =
            scatter(&index, (index.area() / 60.0).sqrt(), 0, &budget).unwrap().iter().map(|c| c.point).collect();
        Symmetry::of(mesh, &index, (index.bounds().centre(), &places), &budget).unwrap()
    }

    fn block(sides: [f64; 3]) -> TriangleMesh {
        let corner = |k: u32| Vector(std::array::from_fn(|axis| if k >> axis & 1 == 1 { sides[axis] } else { 0.0 }));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        TriangleMesh { positions: (0..8).map(corner).collect(), triangles, ..TriangleMesh::default() }
    }

    /// A solid of revolution about x.
    fn turned_on_a_lathe(profile: &[(f64, f64)], sides: u32) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        for (x, r) in profile {
            mesh.positions.extend((0..sides).map(|k| {
                let (sin, cos) = (f64::from(k) / f64::from(sides) * TAU).sin_cos();
                Vector([*x, r * cos, r * sin])
            }));
        }
        for ring in 0..profile.len() as u32 - 1 {
            for k in 0..sides {
                let (a, b) = (ring * sides + k, ring * sides + (k + 1) % sides);
                mesh.triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
            }
        }
        let last = (profile.len() as u32 - 1) * sides;
        for k in 1..sides - 1 {
            mesh.triangles.extend([[0, k + 1, k], [last, last + k, last + k + 1]]);
        }
        mesh
    }

    #[test]
    fn a_brick_has_4_a_square_one_8_and_a_die_24() {
        for (sides, count) in [([4.0, 2.0, 1.0], 4), ([3.0, 1.0, 1.0], 8), ([2.0, 2.0, 2.0], 24)] {
            let symmetry = found(&block(sides));
            assert_eq!((symmetry.rotations.len(), symmetry.axis, symmetry.is_round), (count, None, false), "{sides:?}");
        }
    }

    #[test]
    fn a_rod_turns_about_its_axis_and_end_over_end_and_a_cone_does_not() {
        let rod = found(&turned_on_a_lathe(&[(-2.0, 0.4), (0.0, 0.4), (2.0, 0.4)], 16));
        assert!(rod.axis.unwrap()[0].abs() > 0.999 && rod.rotations.len() == 2, "{rod:?}");
        let cone = found(&turned_on_a_lathe(&[(-2.0, 0.6), (0.0, 0.35), (2.0, 0.1)], 16));
        assert!(cone.axis.unwrap()[0].abs() > 0.999 && cone.rotations.len() == 1, "{cone:?}");
    }

    #[test]
    fn a_ball_turns_any_way_and_an_odd_block_none() {
        let profile: Vec<_> =
            (0..=12).map(|k| (f64::from(k) / 12.0 * TAU / 2.0).sin_cos()).map(|(s, c)| (-c, s.max(0.02))).collect();
        assert!(found(&turned_on_a_lathe(&profile, 20)).is_round);
        let mut odd = block([4.0, 2.0, 1.0]);
        odd.positions[7] += Vector([1.5, 0.7, 0.5]);
        odd.positions[1] += Vector([0.8, 0.0, -0.6]);
        assert_eq!(found(&odd), Symmetry::default());
    }

    #[test]
    fn the_nearest_of_equivalent_rotations_is_found() {
        let reference = turned(Vector([0.0, 0.0, 1.0]), 0.3);
        let die = found(&block([2.0; 3]));
        let lying = reference
            .compose(&turned(Vector([1.0, 0.0, 0.0]), TAU / 4.0))
            .compose(&turned(Vector([0.0, 1.0, 0.0]), TAU / 2.0));
        let same = lying.compose(&die.nearest(&lying, &reference));
        assert!(known(&[reference], &same), "{same:?}");
        let rod = found(&turned_on_a_lathe(&[(-2.0, 0.4), (0.0, 0.4), (2.0, 0.4)], 16));
        let rolled = reference
            .compose(&turned(Vector([1.0, 0.0, 0.0]), 1.234))
            .compose(&turned(Vector([0.0, 1.0, 0.0]), TAU / 2.0));
        let same = rolled.compose(&rod.nearest(&rolled, &reference));
        assert!(known(&[reference], &same), "{same:?}");
    }
}
