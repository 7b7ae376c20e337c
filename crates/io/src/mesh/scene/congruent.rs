//! Meshes of one shape as one mesh: the same triangles in the same order, and vertices that a similarity takes to one another.
//!
//! Copies that a program made of one thing keep the order of their triangles, also when they are joined into one mesh or written as
//! text. Whether two meshes are such copies is asked of a few numbers first that turning, moving and scaling leave alone, then of every
//! vertex.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Matrix, Result, Similarity, Vector};

use super::{
    look::{Looks, Primitive},
    model::SceneMesh,
};

/// Work of one vertex, and of one mesh that is compared.
const PER_VERTEX: u64 = 80;
const PER_LOOK: u64 = 3000;
/// How far a vertex may be off, relative to the size of the mesh: files of text have few digits.
const NEARLY: f64 = 2e-4;
/// Steps of the number that meshes are found by.
const STEP: f64 = 2e-3;

/// Meshes as they come, those of one shape once.
pub(super) struct Sharing<'a> {
    looks: &'a Looks,
    budget: &'a Budget,
    meshes: Vec<Known>,
    /// Numbers of the ways in which triangles are joined.
    kinds: BTreeMap<Vec<[u32; 3]>, usize>,
    /// Meshes by their kind and a number of their shape.
    by_shape: BTreeMap<(usize, i64), Vec<usize>>,
}

struct Known {
    mesh: SceneMesh,
    shape: Shape,
}

/// What turning, moving and scaling leave alone, and the size.
#[derive(Clone, Copy)]
struct Shape {
    size: f64,
    kurtosis: f64,
    path: f64,
}

/// What a mesh is a copy of: `place` takes the coordinates of that mesh to its own.
pub(super) struct Found {
    pub(super) mesh: usize,
    pub(super) kind: usize,
    pub(super) place: Similarity<3>,
}

impl<'a> Sharing<'a> {
    pub(super) fn new(looks: &'a Looks, budget: &'a Budget) -> Self {
        Self { looks, budget, meshes: Vec::new(), kinds: BTreeMap::new(), by_shape: BTreeMap::new() }
    }

    /// How many ways of joining triangles there are.
    pub(super) fn kinds(&self) -> usize {
        self.kinds.len()
    }

    /// The meshes, each once.
    pub(super) fn meshes(self) -> Vec<SceneMesh> {
        self.meshes.into_iter().map(|known| known.mesh).collect()
    }

    /// Adds a mesh whose vertices are in the order of their first use.
    ///
    /// # Errors
    /// Those of the budget.
    pub(super) fn add(&mut self, mesh: SceneMesh) -> Result<Found> {
        self.budget.spend(PER_VERTEX.saturating_mul((mesh.mesh.positions.len() + mesh.mesh.triangles.len()) as u64))?;
        let next = self.kinds.len();
        let kind = match self.kinds.get(&mesh.mesh.triangles) {
            Some(kind) => *kind,
            None => *self.kinds.entry(mesh.mesh.triangles.clone()).or_insert(next),
        };
        let shape = Shape::of(&mesh.mesh.positions);
        let step = (shape.kurtosis / STEP).round() as i64;
        for step in [step, step.saturating_sub(1), step.saturating_add(1)] {
            for &number in self.by_shape.get(&(kind, step)).into_iter().flatten() {
                self.budget.spend(PER_LOOK / 100)?;
                let known = &self.meshes[number];
                if !known.shape.is_near(&shape) || !self.look_alike(&known.mesh, &mesh) {
                    continue;
                }
                self.budget.spend(PER_LOOK + PER_VERTEX * mesh.mesh.positions.len() as u64)?;
                if let Some(place) = fitted(known, &mesh.mesh.positions, shape.size) {
                    return Ok(Found { mesh: number, kind, place });
                }
            }
        }
        self.by_shape.entry((kind, step)).or_default().push(self.meshes.len());
        self.meshes.push(Known { mesh, shape });
        Ok(Found { mesh: self.meshes.len() - 1, kind, place: Similarity::identity() })
    }

    /// Whether two meshes of one kind have the same materials and colours; texture coordinates count where there is a texture.
    fn look_alike(&self, a: &SceneMesh, b: &SceneMesh) -> bool {
        let textured = |p: &Primitive| {
            let material = p.material.and_then(|m| self.looks.materials.get(m));
            material.is_some_and(|m| !m.used_textures().is_empty())
        };
        let alike = |p: &Primitive, q: &Primitive| {
            let (a, b) = (&p.attributes, &q.attributes);
            p.material == q.material
                && p.triangles == q.triangles
                && a.colours == b.colours
                && (!textured(p) || a.uv == b.uv)
        };
        a.mesh.colours == b.mesh.colours
            && a.primitives.len() == b.primitives.len()
            && a.primitives.iter().zip(&b.primitives).all(|(p, q)| alike(p, q))
    }
}

impl Shape {
    fn of(positions: &[Vector<3>]) -> Self {
        let count = positions.len().max(1) as f64;
        let middle = positions.iter().fold(Vector::ZERO, |sum, &p| sum + p) * (1.0 / count);
        let squares = || positions.iter().map(|p| (*p - middle).norm2());
        let second = squares().sum::<f64>() / count;
        let size = second.sqrt().max(f64::MIN_POSITIVE);
        let fourth = squares().map(|s| (s / size / size).powi(2)).sum::<f64>() / count;
        let path = positions.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>() / size / count;
        Self { size, kurtosis: fourth, path }
    }

    fn is_near(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= STEP * (1.0 + a.abs());
        near(self.kurtosis, other.kurtosis) && near(self.path, other.path)
    }
}

/// What takes a known mesh to places in the same order, if something does.
fn fitted(known: &Known, places: &[Vector<3>], size: f64) -> Option<Similarity<3>> {
    let own = &known.mesh.mesh.positions;
    let scale = size / known.shape.size;
    let place = Similarity::fit(own, places, scale, Matrix::identity());
    let near = |(p, q): (&Vector<3>, &Vector<3>)| (place.apply(*p) - *q).norm() <= NEARLY * size;
    (scale.is_finite() && own.len() == places.len() && own.iter().zip(places).all(near)).then_some(place)
}
