//! Questions about places near a mesh.

use arabesque_core::{Bounds, Budget, Error, Held, Limits, Result, TriangleMesh, Vector, rounded};
use rayon::prelude::*;

use super::{
    topology::{NONE, Topology},
    triangle,
};
use crate::{dipoles::Dipoles, tree::Tree};

/// Work units of a node or triangle that a query looks at.
const LOOK: u64 = 12;
/// Nodes and triangles that a single question may look at for what its loop pays; more are counted by themselves. Many long thin
/// triangles around one corner have boxes that all overlap.
const ORDINARY: u64 = 256;
/// Triangles around one corner from which these are told to be what makes questions dear.
const CROWD: usize = 200;
/// Cells along a side of the box around a mesh, in whose middles it is asked how dear questions are.
const CELLS: usize = 4;
/// Questions that tell how dear they are.
const ASKED: usize = 64;

/// The point of a mesh that is nearest to some place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Where it is.
    pub point: Vector<3>,
    /// The triangle it lies on, as the mesh numbers them.
    pub triangle: usize,
    /// Weights of the triangle's corners, each at least 0 and 1 together.
    pub barycentric: [f64; 3],
    /// How far it is.
    pub distance: f64,
    /// The normal there, of length 1 and outwards: from corner to corner as smooth as the mesh.
    pub normal: Vector<3>,
}

/// A mesh prepared for questions: which of its points is nearest, how far that is, and whether a place is inside. Answers depend on the mesh
/// and the place alone, whatever thread asks. Single questions that look at far more of the mesh than is usual are counted on the budget
/// that the index was made with.
#[derive(Debug)]
pub struct MeshIndex {
    pub(crate) topology: Topology,
    /// Normals at the vertices of the topology, weighted by the angles of the triangles around them.
    pub(crate) normals: Vec<Vector<3>>,
    tree: Tree,
    dipoles: Dipoles,
    bounds: Bounds<3>,
    name: String,
    budget: Budget,
    _held: Held,
}

impl MeshIndex {
    /// Prepares a mesh; `name` is what errors call it.
    ///
    /// # Errors
    /// [`Error::Input`] when it has no triangles, refers to vertices that are not there, or has coordinates that are no numbers;
    /// [`Error::Limit`] when it is over the limits of `nodes`, `coordinate` or `memory`.
    pub fn new(mesh: &TriangleMesh, name: &str, budget: &Budget) -> Result<Self> {
        let budget = &budget.stage("preparing a mesh");
        check(mesh, name, budget)?;
        let held = budget.hold(name, mesh.triangles.len() * 260 + mesh.positions.len() * 80)?;
        let topology = Topology::new(mesh, budget)?;
        budget.spend(mesh.triangles.len() as u64 * 200)?;
        let boxes: Vec<_> =
            (0..topology.triangles.len() as u32).into_par_iter().map(|t| Bounds::around(topology.corners(t))).collect();
        let tree = Tree::new(&boxes, budget)?;
        let middle = |t| triangle::at(&topology.corners(t), [1.0 / 3.0; 3]);
        let dipoles = Dipoles::new(&tree, |t| (middle(t), topology.double_area(t) * 0.5));
        let normals = vertex_normals(&topology.points, &topology.triangles);
        let (bounds, name, budget) = (tree.nodes[0].bounds, name.to_owned(), budget.clone());
        Ok(Self { bounds, topology, normals, tree, dipoles, name, budget, _held: held })
    }

    /// The smallest box around the triangles.
    pub fn bounds(&self) -> Bounds<3> {
        self.bounds
    }

    /// What errors call it.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.topology.triangles.len()
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [Vector<3>; 3] {
        self.topology.corners(triangle as u32)
    }

    /// Area of all triangles together.
    pub fn area(&self) -> f64 {
        (0..self.triangles() as u32).map(|t| self.topology.double_area(t).norm() * 0.5).sum()
    }

    /// Normals at the vertices, as the mesh numbers them: of length 1 and outwards, zero where no triangle says. Vertices at one place have one normal.
    pub fn vertex_normals(&self) -> Vec<Vector<3>> {
        self.topology.welded.iter().map(|&v| self.normals[v as usize]).collect()
    }

    /// The nearest point of the mesh.
    pub fn closest(&self, p: Vector<3>) -> Closest {
        let (found, looked) = self.nearest(p);
        self.owe(looked);
        // There is a nearest triangle, unless `p` is no place; then any will do.
        self.on_triangle(found.map_or(0, |(t, _)| t), p)
    }

    /// The nearest point of the mesh, if it is no farther than `reach`: faster than [`MeshIndex::closest`] where most places are farther.
    pub fn closest_within(&self, p: Vector<3>, reach: f64) -> Option<Closest> {
        let (found, looked) = self.tree.nearest(p, reach * reach, |t| Some(self.distance2(t, p)));
        self.owe(looked);
        found.map(|(t, _)| self.on_triangle(t, p))
    }

    /// The point of one triangle that is nearest to `p`.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn closest_on(&self, triangle: usize, p: Vector<3>) -> Closest {
        self.on_triangle(triangle as u32, p)
    }

    /// Where the weights of a triangle's corners lead, as [`Closest`] to itself.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn at(&self, triangle: usize, barycentric: [f64; 3]) -> Closest {
        let corners = self.topology.corners(triangle as u32);
        let (point, normal) = (triangle::at(&corners, barycentric), self.normal(triangle as u32, barycentric));
        Closest { point, triangle, barycentric, distance: 0.0, normal }
    }

    /// Distance to the mesh: positive inside, negative outside. What is inside of a mesh with small holes, or of one turned inside
    /// out, is told by [`MeshIndex::winding`]; of an open sheet it is nothing: see [`MeshIndex::height`].
    pub fn signed_distance(&self, p: Vector<3>) -> f64 {
        let distance = self.closest(p).distance;
        if self.is_inside(p) { distance } else { -distance }
    }

    /// Whether `p` is inside: more than half of the directions from it lead out through the surface. Parts inside of other parts that are
    /// turned the other way are cavities.
    pub fn is_inside(&self, p: Vector<3>) -> bool {
        self.bounds.contains(p) && self.winding(p).abs() > 0.5
    }

    /// How often the surface winds around `p`: 1 inside of a closed surface, 0 outside, -1 inside of one that is turned inside out. To
    /// about 0.03; nearer to the surface it is exact.
    pub fn winding(&self, p: Vector<3>) -> f64 {
        let (winding, looked) = self.winding_counted(p);
        self.owe(looked);
        winding
    }

    /// Work units that a question such as [`MeshIndex::closest`] takes beyond what is usual, on average over the mesh: 0 for nearly all
    /// meshes. For estimates.
    pub fn dearness(&self) -> f64 {
        let step = self.triangles().div_ceil(ASKED);
        let asked = (0..self.triangles()).step_by(step);
        let count = asked.len() as f64;
        let beyond = |t| self.nearest(self.at(t, [1.0 / 3.0; 3]).point).1.saturating_sub(ORDINARY);
        asked.map(beyond).sum::<u64>() as f64 * LOOK as f64 / count
    }

    /// Distance to the mesh on the side that `closest`, the nearest point to `p`, faces: positive above the surface, along its normals, and negative below. For open sheets.
    /// The side is told by the normals of triangle, edge or vertex, weighted by angles [Baerentzen 2005].
    pub fn height(&self, closest: &Closest, p: Vector<3>) -> f64 {
        let above = (p - closest.point).dot(self.pseudonormal(closest)) >= 0.0;
        if above { closest.distance } else { -closest.distance }
    }

    /// [`MeshIndex::closest`] for many places, in parallel.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn closest_all(&self, points: &[Vector<3>], budget: &Budget) -> Result<Vec<Closest>> {
        self.all(points, budget, |p| {
            let (found, looked) = self.nearest(p);
            (self.on_triangle(found.map_or(0, |(t, _)| t), p), looked)
        })
    }

    /// [`MeshIndex::signed_distance`] for many places, in parallel.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn signed_distances(&self, points: &[Vector<3>], budget: &Budget) -> Result<Vec<f64>> {
        self.all(points, budget, |p| {
            let (found, looked) = self.nearest(p);
            let distance = found.map_or(f64::INFINITY, |(_, d2)| d2.sqrt());
            let (winding, more) = if self.bounds.contains(p) { self.winding_counted(p) } else { (0.0, 0) };
            (if winding.abs() > 0.5 { distance } else { -distance }, looked + more)
        })
    }

    /// [`MeshIndex::is_inside`] for many places, in parallel.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn inside_all(&self, points: &[Vector<3>], budget: &Budget) -> Result<Vec<bool>> {
        self.all(points, budget, |p| {
            let (winding, looked) = if self.bounds.contains(p) { self.winding_counted(p) } else { (0.0, 1) };
            (winding.abs() > 0.5, looked)
        })
    }

    /// The numbers of triangles whose boxes may meet `bounds`, until `visit` answers false; and what was looked at.
    pub(crate) fn meeting(&self, bounds: &Bounds<3>, visit: impl FnMut(u32) -> bool) -> u64 {
        self.tree.meeting(bounds, visit)
    }

    fn all<T: Send>(
        &self,
        points: &[Vector<3>],
        budget: &Budget,
        ask: impl Fn(Vector<3>) -> (T, u64) + Sync,
    ) -> Result<Vec<T>> {
        self.foresee(points, budget, |p| ask(p).1)?;
        let chunks: Result<Vec<Vec<T>>> = points
            .par_chunks(256)
            .map(|chunk| {
                let mut meter = budget.meter();
                let one = |&p: &Vector<3>| {
                    let (answer, looked) = ask(p);
                    meter.spend(looked * LOOK).map(|()| answer)
                };
                chunk.iter().map(one).collect()
            })
            .collect();
        let chunks = chunks?;
        budget.spend(0)?;
        Ok(chunks.into_iter().flatten().collect())
    }

    /// Refuses so many questions where a few of them tell that all would be over the limit of work: for those who are going to ask them
    /// later, after other work.
    ///
    /// # Errors
    /// [`Error::Limit`] when they would be; as [`Budget::spend`].
    pub fn expect(&self, questions: f64, budget: &Budget) -> Result<()> {
        let size = self.bounds.size();
        // The middles of a few cells all over the box.
        let middle = |k: usize, axis: usize| ((k / CELLS.pow(axis as u32) % CELLS) as f64 + 0.5) / CELLS as f64;
        let place = |k: usize| self.bounds.min + Vector(std::array::from_fn(|axis| size[axis] * middle(k, axis)));
        let looked: u64 = (0..CELLS.pow(3)).map(|k| self.nearest(place(k)).1).sum();
        budget.spend(looked * LOOK)?;
        self.refuse_many(questions * (looked * LOOK) as f64 / CELLS.pow(3) as f64 / 1e6, budget)
    }

    /// Refuses questions that would take so many million units of work, where that is over the limit.
    fn refuse_many(&self, expected: f64, budget: &Budget) -> Result<()> {
        let allowed = (budget.allowed() / 1_000_000) as usize;
        if expected <= allowed as f64 {
            return Ok(());
        }
        let (count, corner) = self.crowded();
        let place = shown(corner);
        let (why, advice) = match count {
            CROWD.. => (
                format!(": {count} triangles meet in the corner at {place}, which makes them dear"),
                "make long thin triangles fewer or shorter (Blender: Remesh, or Decimate)",
            ),
            _ => (String::new(), "make it smaller"),
        };
        let raising = Limits::raising("work", expected);
        Err(Error::Limit {
            what: format!("{}: questions to its triangles, in million units of work{why}", self.name),
            found: rounded(expected.ceil()),
            limit: allowed.to_string(),
            advice: format!("{advice}{raising}"),
        })
    }

    /// The vertex with most triangles around it: how many there are, and where it is.
    fn crowded(&self) -> (usize, Vector<3>) {
        let mut counts = vec![0_usize; self.topology.points.len()];
        self.topology.triangles.iter().flatten().for_each(|&v| counts[v as usize] += 1);
        let most = (0..counts.len()).fold(0, |best, v| if counts[v] > counts[best] { v } else { best });
        (counts[most], self.topology.points[most])
    }

    /// Refuses so many questions where a few of them tell that all would be over the limit of work.
    fn foresee(&self, points: &[Vector<3>], budget: &Budget, looks: impl Fn(Vector<3>) -> u64) -> Result<()> {
        let asked = points.iter().step_by(points.len().div_ceil(ASKED).max(1));
        let share = points.len() as f64 / asked.len().max(1) as f64;
        if share < ASKED as f64 {
            return Ok(());
        }
        let looked: u64 = asked.map(|&p| looks(p)).sum();
        budget.spend(looked * LOOK)?;
        let expected = looked as f64 * share * LOOK as f64 / 1e6;
        self.refuse_many(expected, budget)
    }

    /// The nearest triangle with its squared distance, and what was looked at.
    fn nearest(&self, p: Vector<3>) -> (Option<(u32, f64)>, u64) {
        self.tree.nearest(p, f64::INFINITY, |t| Some(self.distance2(t, p)))
    }

    /// Counts what a single question looked at beyond what its loop pays for.
    fn owe(&self, looked: u64) {
        if looked > ORDINARY {
            self.budget.owe((looked - ORDINARY) * LOOK);
        }
    }

    fn winding_counted(&self, p: Vector<3>) -> (f64, u64) {
        self.dipoles.winding(&self.tree, p, |t| triangle::solid_angle(&self.topology.corners(t), p))
    }

    fn distance2(&self, t: u32, p: Vector<3>) -> f64 {
        let corners = self.topology.corners(t);
        (triangle::at(&corners, triangle::nearest(&corners, p)) - p).norm2()
    }

    fn on_triangle(&self, t: u32, p: Vector<3>) -> Closest {
        let corners = self.topology.corners(t);
        let barycentric = triangle::nearest(&corners, p);
        let point = triangle::at(&corners, barycentric);
        let (distance, normal) = ((point - p).norm(), self.normal(t, barycentric));
        Closest { point, triangle: t as usize, barycentric, distance, normal }
    }

    /// The smooth normal.
    fn normal(&self, t: u32, weights: [f64; 3]) -> Vector<3> {
        let at = |k: usize| self.normals[self.topology.triangles[t as usize][k] as usize] * weights[k];
        let sum = at(0) + at(1) + at(2);
        sum.unit_if_longer(1e-6).unwrap_or_else(|| self.topology.double_area(t).unit_or_zero())
    }

    /// The normal of the triangle, edge or vertex that the point lies on.
    fn pseudonormal(&self, closest: &Closest) -> Vector<3> {
        let t = closest.triangle as u32;
        let own = self.topology.double_area(t).unit_or_zero();
        let off = closest.barycentric.map(|w| w <= 1e-12);
        match off.iter().filter(|&&is_off| is_off).count() {
            0 => own,
            1 => {
                // The edge opposite to corner k is the next one.
                let k = (off.iter().position(|&is_off| is_off).unwrap_or(0) + 1) % 3;
                match self.topology.across[closest.triangle][k] {
                    NONE => own,
                    other => own + self.topology.double_area(other).unit_or_zero(),
                }
            }
            _ => {
                let k = off.iter().position(|&is_off| !is_off).unwrap_or(0);
                self.normals[self.topology.triangles[closest.triangle][k] as usize]
            }
        }
    }
}

/// Refuses what is no mesh, or too much of one.
pub(crate) fn check(mesh: &TriangleMesh, name: &str, budget: &Budget) -> Result<()> {
    mesh.check(name)?;
    let limits = *budget.limits();
    budget.within(&format!("{name}: triangles"), mesh.triangles.len(), ("nodes", limits.nodes))?;
    budget.within(&format!("{name}: vertices"), mesh.positions.len(), ("nodes", limits.nodes))?;
    if mesh.triangles.is_empty() {
        return Err(Error::input(
            name,
            "a mesh without triangles, expected a surface",
            "export the surface itself, not its points or edges alone",
        ));
    }
    let far = |p: &Vector<3>| !p.0.iter().all(|c| c.abs() <= limits.coordinate);
    match mesh.positions.iter().position(far) {
        None => Ok(()),
        Some(v) => Err(Error::input(
            name,
            format!(
                "vertex {} is at {}, expected coordinates from -{l} to {l}",
                v + 1,
                shown(mesh.positions[v]),
                l = limits.coordinate
            ),
            format!("move the mesh to the origin{}", raising(&mesh.positions[v])),
        )),
    }
}

/// The end of advice about a place too far away.
pub(crate) fn raising(p: &Vector<3>) -> String {
    Limits::raising("coordinate", p.0.iter().fold(0.0, |most: f64, c| most.max(c.abs())))
}

/// A place as errors show it.
pub(crate) fn shown(p: Vector<3>) -> String {
    let [x, y, z] = p.0.map(|c| format!("{}", (c * 1e4).round() / 1e4));
    format!("({x}, {y}, {z})")
}

/// Normals at the vertices: those of the triangles around, weighted by their angles there.
pub(super) fn vertex_normals(points: &[Vector<3>], triangles: &[[u32; 3]]) -> Vec<Vector<3>> {
    let mut sums = vec![Vector::ZERO; points.len()];
    for corners in triangles {
        let places = corners.map(|v| points[v as usize]);
        let [a, b, c] = places;
        let normal = (b - a).cross(c - a).unit_or_zero();
        for (k, &v) in corners.iter().enumerate() {
            sums[v as usize] += normal * triangle::angle(&places, k);
        }
    }
    sums.into_iter().map(Vector::unit_or_zero).collect()
}
