//! Scenes as exemplars: what each node of a GLB file shows is a rigid element, which points stand for while the engine works.
//!
//! A mesh that several nodes show gets its points once, so that all of its elements are congruent; the points lie on it about as far apart
//! as those beside the meshes.

use arabesque_core::{Error, PointSet, Result, Vector, Warning};
use arabesque_io::{
    geometry::{Cloud, Kind, kind_of},
    mesh::{
        gltf::{Scene, SceneMesh, SceneNode, read_scene},
        scene::Looks,
    },
};
use arabesque_structures::spacing;
use arabesque_surface::{MeshIndex, scatter};

use crate::{resources::Files, solid::read::cloud};

/// Fewest points and nodes together.
const FEWEST: usize = 10;
/// How many points stand for a mesh, but for rounding: where there are no points beside it, at least and at most.
const SAMPLES: [f64; 3] = [24.0, 8.0, 160.0];
/// Points are scattered so that so many are in a square of their spacing.
const PACKED: f64 = 0.7;
/// Colour of what has none among coloured things.
const WHITE: [f64; 3] = [1.0; 3];

/// The meshes that rigid elements stand for; element `n` is what node `n` shows.
#[derive(Debug, Default)]
pub(crate) struct Shapes {
    pub(super) meshes: Vec<SceneMesh>,
    pub(super) nodes: Vec<SceneNode>,
    /// What the meshes are made of.
    pub(super) looks: Looks,
}

/// The points of an exemplar, the meshes that some of them stand for, and what is to be told.
pub(super) fn exemplar(name: &str, bytes: &[u8], files: &Files) -> Result<(Cloud, Shapes, Vec<Warning>)> {
    if kind_of(name, bytes) != Some(Kind::Glb) {
        let (points, warnings) = cloud(name, bytes, files)?;
        return Ok((points, Shapes::default(), warnings));
    }
    let mut scene = read_scene(name, bytes, files.budget())?;
    let mut warnings = std::mem::take(&mut scene.warnings);
    if scene.zero_normals > 0 {
        scene.points.normals = None;
        let message = format!("{name}: {} normals have no length: none of them is used", scene.zero_normals);
        warnings.push(Warning::new(message, "write the points again with all their normals, or without"));
    }
    // Every element is one rigid thing here, whatever it is put together from.
    scene.meshes.iter_mut().for_each(|mesh| mesh.parts.clear());
    let Scene { points, meshes, nodes, looks, .. } = scene;
    if nodes.is_empty() {
        return Ok((Cloud::Space(points), Shapes::default(), warnings));
    }
    let found = points.len() + nodes.len();
    if found < FEWEST {
        let problem = format!("{} points and {} meshes in their places", points.len(), nodes.len());
        let advice =
            format!("give at least {FEWEST} together, so that something can repeat: every node is one rigid element");
        return Err(Error::input(name, problem, advice));
    }
    let shapes = Shapes { meshes, nodes, looks };
    let samples = shapes.samples(name, &points, files)?;
    Ok((Cloud::Space(shapes.with(points, &samples)), shapes, warnings))
}

/// The points that stand for a mesh, in its own coordinates.
struct Samples {
    places: Vec<Vector<3>>,
    normals: Vec<Vector<3>>,
    colours: Vec<[f64; 3]>,
}

impl Shapes {
    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Points on each mesh.
    fn samples(&self, name: &str, points: &PointSet<3>, files: &Files) -> Result<Vec<Samples>> {
        let budget = files.budget();
        let beside = if points.len() < FEWEST { None } else { spacing(&points.positions) };
        let one = |(number, shape): (usize, &SceneMesh)| {
            let called = format!("{name}: mesh {number} {}", shape.name);
            let index = MeshIndex::new(&shape.mesh, called.trim_end(), budget)?;
            let area = index.area();
            if !(area > 0.0 && area.is_finite()) {
                return Err(Error::input(called.trim_end(), "a mesh without area", "leave it out"));
            }
            let scale = self.nodes.iter().find(|n| n.mesh == number).map_or(1.0, |n| n.transform.scale);
            let [usual, least, most] = SAMPLES;
            let wanted = beside.map_or(usual, |s| area * scale * scale / (PACKED * s * s)).clamp(least, most);
            let found = scatter(&index, (area * PACKED / wanted).sqrt(), 0, budget)?;
            let colour = |c: &arabesque_surface::Closest| {
                let Some(colours) = &shape.mesh.colours else { return WHITE };
                let corners = shape.mesh.triangles[c.triangle].map(|v| colours[v as usize]);
                std::array::from_fn(|k| (0..3).map(|n| corners[n][k] * c.barycentric[n]).sum::<f64>().clamp(0.0, 1.0))
            };
            Ok(Samples {
                places: found.iter().map(|c| c.point).collect(),
                normals: found.iter().map(|c| c.normal).collect(),
                colours: found.iter().map(colour).collect(),
            })
        };
        self.meshes.iter().enumerate().map(one).collect()
    }

    /// The points beside the meshes, and for each node those that stand for it. Normals and colours are there where the points beside have
    /// them, or where nothing is beside.
    fn with(&self, points: PointSet<3>, samples: &[Samples]) -> PointSet<3> {
        let loose = points.len();
        let alone = loose == 0;
        let mut all = points;
        let coloured = self.meshes.iter().any(|m| m.mesh.colours.is_some());
        all.normals = all.normals.or(alone.then(Vec::new));
        all.colours = all.colours.or((alone && coloured).then(Vec::new));
        let count = self.nodes.len() as i32;
        // Elements among the points come after the nodes.
        let others = |e: i32| if e < 0 { e } else { e.saturating_add(count) };
        let own = all.elements.take().map(|list| list.into_iter().map(others).collect());
        let mut elements: Vec<i32> = own.unwrap_or_else(|| vec![PointSet::<3>::CONTINUOUS; loose]);
        let mut next = all.groups.iter().flatten().copied().max().unwrap_or(0);
        let usual = all.radii.as_ref().map(|radii| radii.iter().sum::<f64>() / radii.len().max(1) as f64);
        for (number, node) in self.nodes.iter().enumerate() {
            let Samples { places, normals, colours } = &samples[node.mesh];
            let count = places.len();
            all.positions.extend(places.iter().map(|&p| node.transform.apply(p)));
            elements.extend(std::iter::repeat_n(number as i32, count));
            next = next.saturating_add(1);
            if let Some(list) = &mut all.normals {
                list.extend(normals.iter().map(|&n| node.transform.rotation.apply(n).unit_or_zero()));
            }
            if let Some(list) = &mut all.colours {
                list.extend_from_slice(colours);
            }
            if let (Some(list), Some(usual)) = (&mut all.radii, usual) {
                list.extend(std::iter::repeat_n(usual, count));
            }
            if let Some(list) = &mut all.groups {
                list.extend(std::iter::repeat_n(next, count));
            }
        }
        all.elements = Some(elements);
        all
    }
}
