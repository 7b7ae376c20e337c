//! Which elements of a scene bend, and the samples that stand for them.
//!
//! Programs write what bends as meshes that are all different. They are one thing bent if each has a centre line, of about one thickness,
//! or if their triangles are joined in the same way and edges differ far less than places do. Anything else is the same thing in
//! several shapes, and rigid.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Budget, Build, Error, Matrix, Result, Similarity, Soft, Vector};
use arabesque_io::mesh::scene::{Classes, Scene, SceneMesh};
use arabesque_surface::{MeshIndex, Tube, balls};

use crate::recipe::Deform;

/// From so many times longer than thick on a thing bends by itself, and one that was asked to bend does so along its line.
const SLENDER: (f64, f64) = (6.0, 3.0);
/// Strands of one kind are as thick as their median within this factor, and this share of them leaves the straight way by so many radii.
const ALIKE: f64 = 1.3;
const BENT: f64 = 1.0;
const OFTEN: f64 = 0.25;
/// Bags of one kind: places differ by this share of their size at least, and by so many times more than edges do.
const PLACES: f64 = 0.04;
const FAITHFUL: f64 = 1.35;
/// Samples of a strand are so many radii apart; fewest and most of them.
const APART: f64 = 2.2;
const STRAND: (usize, usize) = (6, 96);
/// Samples of a bag, and of what does not bend beside what does.
const BAG: usize = 26;
const RIGID: usize = 12;
/// Work of a vertex that is compared.
const VERTEX: u64 = 60;

/// What bends in a scene.
#[derive(Debug)]
pub(super) struct Bending {
    /// How the elements of each class hold together.
    pub(super) builds: Vec<Build>,
    /// The samples of each node.
    pub(super) softs: Vec<Arc<Soft<3>>>,
    /// What was found, in words.
    pub(super) told: String,
}

/// The meshes of a class.
struct Members {
    meshes: Vec<usize>,
    tubes: Vec<Option<Tube>>,
}

/// What bends in a scene; `None` where nothing does. `samples` is how many samples an element is to have, where somebody said so.
///
/// # Errors
/// [`Error::Parameter`] for a class that is not there; those of the budget.
pub(super) fn bending(
    (name, scene): (&str, &Scene),
    classes: &Classes,
    (deform, samples): (&Deform, Option<usize>),
    budget: &Budget,
) -> Result<Option<Bending>> {
    if let Deform::Classes(names) = deform
        && let Some(unknown) = names.iter().find(|name| !classes.names.contains(name))
    {
        let expected = format!("auto, all, off, or classes of {name}: {}", classes.names.join(", "));
        return Err(Error::parameter("deform", unknown, expected));
    }
    if *deform == Deform::Off || samples == Some(1) {
        return Ok(None);
    }
    let budget = &budget.stage("looking for what bends");
    let (mut builds, mut all, mut told) = (Vec::new(), Vec::new(), Vec::new());
    for (number, class) in classes.names.iter().enumerate() {
        let mut meshes: Vec<usize> = Vec::new();
        let own = scene.nodes.iter().zip(&classes.of_node).filter(|(_, c)| **c == number);
        own.for_each(|(node, _)| meshes.push(node.mesh));
        meshes.sort_unstable();
        meshes.dedup();
        let asked = match deform {
            Deform::All => true,
            Deform::Classes(names) => names.contains(class),
            Deform::Auto | Deform::Off => scene.deformable.contains(class),
        };
        // What is put together from parts is as stiff as these, though they may be in other places in each.
        let is_whole = meshes.iter().all(|&mesh| scene.meshes[mesh].parts.is_empty());
        let may = asked || (*deform == Deform::Auto && meshes.len() > 1 && is_whole);
        let members = Members::new(scene, meshes, may, budget)?;
        let build = if may { members.build(scene, asked, budget)? } else { Build::Rigid };
        told.extend(members.told(class, build));
        builds.push(build);
        all.push(members);
    }
    if builds.iter().all(|build| *build == Build::Rigid) {
        return Ok(None);
    }
    let softs = softs((name, scene), classes, (&builds, &all), samples, budget)?;
    Ok(Some(Bending { builds, softs, told: told.join("; ") }))
}

impl Members {
    fn new(scene: &Scene, meshes: Vec<usize>, may_bend: bool, budget: &Budget) -> Result<Self> {
        let tube = |&mesh: &usize| if may_bend { Tube::of(&scene.meshes[mesh].mesh, budget) } else { Ok(None) };
        let tubes = meshes.iter().map(tube).collect::<Result<_>>()?;
        Ok(Self { meshes, tubes })
    }

    /// How they hold together; `asked` where they are to bend in any case.
    fn build(&self, scene: &Scene, asked: bool, budget: &Budget) -> Result<Build> {
        let lines: Vec<&Tube> = self.tubes.iter().flatten().collect();
        let are_lines = !lines.is_empty() && lines.len() == self.tubes.len();
        let thinnest = lines.iter().map(|t| t.slenderness()).fold(f64::INFINITY, f64::min);
        if asked {
            return Ok(if are_lines && thinnest >= SLENDER.1 { Build::Strand } else { Build::Bag });
        }
        let thickness = median(lines.iter().map(|t| t.radius));
        let are_alike = lines.iter().all(|t| t.radius < ALIKE * thickness && t.radius > thickness / ALIKE);
        let bent = lines.iter().filter(|t| t.sag() >= BENT).count();
        let is_bent = bent as f64 >= OFTEN * lines.len() as f64;
        if are_lines && thinnest >= SLENDER.0 && are_alike && is_bent {
            return Ok(Build::Strand);
        }
        let meshes: Vec<&SceneMesh> = self.meshes.iter().map(|m| &scene.meshes[*m]).collect();
        Ok(if are_one_thing_bent(&meshes, budget)? { Build::Bag } else { Build::Rigid })
    }

    fn told(&self, class: &str, build: Build) -> Option<String> {
        match build {
            Build::Rigid => None,
            Build::Bag => Some(format!("{class} bends")),
            Build::Strand => {
                let length = median(self.tubes.iter().flatten().map(Tube::length));
                Some(format!("{class} bends along its line of {length:.4}"))
            }
        }
    }
}

/// Whether meshes are one thing in several shapes between which it can be bent.
fn are_one_thing_bent(meshes: &[&SceneMesh], budget: &Budget) -> Result<bool> {
    let [first, others @ ..] = meshes else { return Ok(false) };
    let own = &first.mesh;
    let (mut all_moved, mut all_stretched) = (0.0, 0.0);
    for other in others {
        let places = &other.mesh.positions;
        if other.mesh.triangles != own.triangles || places.len() != own.positions.len() {
            return Ok(false);
        }
        budget.spend(VERTEX * places.len() as u64)?;
        let edges = |list: &[Vector<3>]| -> Vec<f64> {
            let of = |t: &[u32; 3]| {
                let t = t.map(|v| list[v as usize]);
                [(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()]
            };
            own.triangles.iter().flat_map(of).collect()
        };
        let (a, b) = (edges(&own.positions), edges(places));
        let (sum, other_sum): (f64, f64) = (a.iter().sum(), b.iter().sum());
        let scale = other_sum / sum.max(f64::MIN_POSITIVE);
        let squares: f64 = a.iter().zip(&b).map(|(a, b)| (b - scale * a).powi(2)).sum();
        all_stretched += squares / b.iter().map(|b| b * b).sum::<f64>().max(f64::MIN_POSITIVE);
        let fit = Similarity::fit(&own.positions, places, scale, Matrix::identity());
        let middle = places.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / places.len().max(1) as f64);
        let off: f64 = own.positions.iter().zip(places).map(|(p, q)| (fit.apply(*p) - *q).norm2()).sum();
        let size: f64 = places.iter().map(|q| (*q - middle).norm2()).sum();
        all_moved += off / size.max(f64::MIN_POSITIVE);
    }
    // In the mean over all of them: two may happen to be bent alike.
    let mean = |sum: f64| (sum / others.len().max(1) as f64).sqrt();
    let (moved, stretched) = (mean(all_moved), mean(all_stretched));
    Ok(moved >= PLACES && moved >= FAITHFUL * stretched)
}

/// The samples of every node.
fn softs(
    (name, scene): (&str, &Scene),
    classes: &Classes,
    (builds, members): (&[Build], &[Members]),
    samples: Option<usize>,
    budget: &Budget,
) -> Result<Vec<Arc<Soft<3>>>> {
    let mut of_mesh: BTreeMap<(usize, usize), (Vec<Vector<3>>, Vec<f64>)> = BTreeMap::new();
    for (class, (build, members)) in builds.iter().zip(members).enumerate() {
        let wanted = median(members.tubes.iter().flatten().map(|t| t.length() / (APART * t.radius)));
        let count = samples.unwrap_or((wanted.round() as usize + 1).clamp(STRAND.0, STRAND.1)).max(2);
        for (mesh, tube) in members.meshes.iter().zip(&members.tubes) {
            let found = match (build, tube) {
                (Build::Strand, Some(tube)) => (tube.samples(count), vec![tube.radius; count]),
                _ => {
                    let called = format!("{name}: mesh {mesh} {}", scene.meshes[*mesh].name);
                    let index = MeshIndex::new(&scene.meshes[*mesh].mesh, called.trim_end(), budget)?;
                    let most = if *build == Build::Rigid { RIGID } else { samples.unwrap_or(BAG) };
                    balls(&index, most, budget)?.into_iter().unzip()
                }
            };
            of_mesh.insert((class, *mesh), found);
        }
    }
    let one = |(node, class): (&arabesque_io::mesh::gltf::SceneNode, &usize)| {
        let (places, radii) = of_mesh.get(&(*class, node.mesh))?;
        Some(Arc::new(Soft {
            build: builds[*class],
            samples: places.iter().map(|p| node.transform.apply(*p)).collect(),
            radii: radii.iter().map(|r| r * node.transform.scale).collect(),
        }))
    };
    Ok(scene.nodes.iter().zip(&classes.of_node).filter_map(one).collect())
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}
