//! Scenes of meshes as exemplars: each node is an element, nodes of one name are a class.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use arabesque_core::{
    Bounds, Budget, Build, Class, Element, Error, Exemplar, Grid, Outline, Placement, Result, Role, Similarity, Soft,
    Solid, TriangleMesh, Vector, Warning, point_lattice, suggest::did_you_mean,
};
use arabesque_io::mesh::{
    gltf::{Scene, SceneMesh, SceneNode},
    scene::Classes,
};
use arabesque_surface::{MeshIndex, Symmetry, scatter};

use super::bending::{Bending, bending};
use crate::recipe::{Constraint, Deform};

/// Points that are scattered over a mesh, and corners that are added to them, at most.
const SCATTERED: f64 = 40.0;
const CORNERS: usize = 24;
/// Cells of the grid of distances across the thinnest and along the longest side of a mesh, cells around it, and how much thinner than
/// long a mesh may be to the grid.
const ACROSS: f64 = 8.0;
const ALONG: f64 = 64.0;
const MARGIN: f64 = 3.0;
const THINNEST: f64 = 12.0;
/// Cells of that grid across the walls of what is hollow.
const WALL: f64 = 2.0;
/// What is nearer to the floor than this share of its size stands on it.
const NEAR: f64 = 0.12;
/// What is over the floor by more than this share of its own height does not stand on it.
const OVER: f64 = 0.9;
/// A frame that is thinner than its elements by this factor is flat.
const FLAT: f64 = 0.2;
/// A frame is made wider by no more than this factor.
const WIDEST: f64 = 1.6;
/// Of more meshes than this nobody looks for symmetries.
const MANY: usize = 64;
/// Shares of all samples along each axis between which the middle of a heap is.
const CORE: (f64, f64) = (0.3, 0.7);
/// Vertices are the same where they differ by no more than files round, relative to their mesh.
const ROUNDED: f64 = 1e-6;
/// Points are scattered so that so many are in a square of their spacing.
const PACKED: f64 = 0.7;

/// A scene as an exemplar: element `n` is what node `n` shows.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    pub(crate) scene: Arc<Scene>,
    pub(crate) exemplar: Arc<Exemplar<3>>,
    /// Height of the floor, where there is one.
    pub(crate) floor: Option<f64>,
    /// What bends, in words; empty where nothing does.
    pub(crate) told: String,
}

/// What a mesh is to the engine, in its own coordinates.
struct Body {
    /// Centre of its volume.
    centre: Vector<3>,
    /// Points all over it.
    points: Vec<Vector<3>>,
    /// Mean colour.
    colour: [f64; 3],
    solid: Arc<Solid<3>>,
    /// The rotations that leave it as it is.
    symmetry: Symmetry,
}

impl Bodies {
    /// Takes a scene for an exemplar; `up` is the axis that is up.
    ///
    /// # Errors
    /// [`Error::Input`] for a scene without meshes and for a mesh without area.
    pub(crate) fn read(
        name: &str,
        mut scene: Scene,
        (up, deform, samples): (usize, &Deform, Option<usize>),
        budget: &Budget,
    ) -> Result<(Self, Vec<Warning>)> {
        let mut warnings = std::mem::take(&mut scene.warnings);
        if scene.nodes.is_empty() {
            let advice = "give a scene of meshes, or use --method structures for points";
            return Err(Error::input(name, "no mesh in its scene", advice));
        }
        if !scene.points.is_empty() {
            let message = format!("{name}: {} points beside the meshes are left out", scene.points.len());
            warnings.push(Warning::new(message, "use --method structures, which continues both"));
            scene.points = arabesque_core::PointSet::default();
        }
        // The parts of what is one element stay together.
        let is_whole = scene.nodes.len() == 1 && scene.meshes[scene.nodes[0].mesh].parts.is_empty();
        if is_whole && scene.components(budget)? > 1 {
            let frame = scene.frame;
            scene = scene.split_components(budget)?;
            scene.frame = frame;
            warnings.append(&mut scene.warnings);
        }
        budget.within("elements of the exemplar", scene.nodes.len(), ("elements", budget.limits().elements))?;
        let scene = shared(scene, budget)?;
        let found = scene.classes();
        if let Some(bending) = bending((name, &scene), &found, (deform, samples), budget)? {
            return Ok((Self::bent((name, up), scene, found, bending)?, warnings));
        }
        Ok((Self::of(name, scene, up, budget)?, warnings))
    }

    /// Takes a scene of which nothing bends for an exemplar.
    ///
    /// # Errors
    /// [`Error::Input`] for a mesh without area.
    pub(crate) fn of(name: &str, scene: Scene, up: usize, budget: &Budget) -> Result<Self> {
        let found = scene.classes();
        let bodies = bodies(name, &scene, budget)?;
        let classes = found.names.into_iter().map(|name| Class { name }).collect();
        let mut elements = Vec::with_capacity(scene.nodes.len());
        let (mut first, mut seen) = (BTreeMap::new(), Vec::with_capacity(scene.nodes.len()));
        for (node, class) in scene.nodes.iter().zip(found.of_node) {
            budget.spend(1000)?;
            let body = &bodies[&node.mesh];
            let usual = *first.entry((class, node.mesh)).or_insert(node.transform.rotation);
            // Of the rotations that are the same to look at, the one that is most like that of the first: none is as good as another.
            let turn = body.symmetry.nearest(&node.transform.rotation, &usual);
            let turn = Similarity::about(body.centre, body.centre, turn, 1.0);
            seen.push(node.transform.after(&turn));
            elements.push(Element {
                class,
                centre: node.transform.apply(body.centre),
                pose: node.transform,
                outline: Outline { rings: vec![body.points.iter().map(|p| node.transform.apply(*p)).collect()] },
                colour: body.colour,
                lean: [Vector::ZERO; 3],
                role: Role::Source,
            });
        }
        let mut exemplar = framed(name, elements, classes, scene.frame)?;
        (exemplar.up, exemplar.seen) = (up, seen);
        exemplar.solids = scene.nodes.iter().map(|node| Arc::clone(&bodies[&node.mesh].solid)).collect();
        let several = scene.nodes.iter().filter(|node| !scene.meshes[node.mesh].parts.is_empty()).count();
        let told = match several {
            0 => String::new(),
            1 => "1 element of several meshes".into(),
            n => format!("{n} elements of several meshes"),
        };
        let (scene, exemplar) = (Arc::new(scene), Arc::new(exemplar));
        Ok(Self { scene, exemplar, floor: None, told })
    }

    /// A scene of which something bends.
    fn bent((name, up): (&str, usize), mut scene: Scene, found: Classes, bending: Bending) -> Result<Self> {
        scene.deformable = found
            .names
            .iter()
            .zip(&bending.builds)
            .filter(|(_, b)| **b != Build::Rigid)
            .map(|(n, _)| n.clone())
            .collect();
        let classes: Vec<Class> = found.names.into_iter().map(|name| Class { name }).collect();
        let nodes = scene.nodes.iter().zip(&found.of_node).zip(&bending.softs);
        let elements = nodes.map(|((node, class), soft)| Element {
            class: *class,
            centre: soft.middle(&soft.samples),
            pose: node.transform,
            outline: Outline { rings: vec![soft.samples.clone()] },
            colour: colour(&scene.meshes[node.mesh].mesh),
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        });
        let frame = scene.frame.unwrap_or_else(|| occupied(&bending.softs));
        let mut exemplar = Exemplar::new(name, elements.collect(), classes, frame)?;
        (exemplar.softs, exemplar.up) = (bending.softs, up);
        Ok(Self { scene: Arc::new(scene), exemplar: Arc::new(exemplar), floor: None, told: bending.told })
    }

    /// The same with a floor at its lowest place: what stands on it is a class of its own. Of classes with a rule that
    /// decides; of others what stands on it does where `others` is true.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a rule for a class that is not there.
    pub(crate) fn on_floor(&self, others: bool, rules: &BTreeMap<String, Constraint>) -> Result<Self> {
        let mut exemplar = (*self.exemplar).clone();
        let up = exemplar.up;
        let names: Vec<_> = exemplar.classes.iter().map(|class| class.name.as_str()).collect();
        if let Some(unknown) = rules.keys().find(|name| !names.contains(&name.as_str())) {
            let hint = did_you_mean(unknown, names.iter().copied());
            return Err(Error::parameter(
                "constrain",
                unknown,
                format!("a class of the exemplar: {}{hint}", list(&names)),
            ));
        }
        let bound: Vec<bool> =
            names.iter().map(|name| rules.get(*name).map_or(others, |rule| *rule == Constraint::Floor)).collect();
        let lowest = |e: &Element<3>| e.outline.points().map(|p| p[up]).fold(f64::INFINITY, f64::min);
        let floor = exemplar.elements.iter().map(lowest).fold(f64::INFINITY, f64::min);
        if let Some(floor) = lowest_soft(&exemplar) {
            return Ok(Self { floor: Some(floor), ..self.clone() });
        }
        let mut number_of = BTreeMap::new();
        let (mut heights, mut classes) = (Vec::new(), exemplar.classes.clone());
        for element in &mut exemplar.elements {
            let high = element.outline.points().map(|p| p[up]).fold(f64::NEG_INFINITY, f64::max) - lowest(element);
            // A coin on another does not lie on the floor.
            let near = (2.0 * NEAR * element.outline.radius(element.centre)).min(OVER * high);
            let stands = bound[element.class] && lowest(element) - floor <= near;
            heights.push(stands.then_some(element.centre[up] - floor));
            if stands {
                let old = element.class;
                element.class = *number_of.entry(old).or_insert_with(|| {
                    classes.push(classes[old].clone());
                    classes.len() - 1
                });
            }
        }
        (exemplar.heights, exemplar.classes) = (heights, classes);
        Ok(Self { exemplar: Arc::new(exemplar), floor: Some(floor), ..self.clone() })
    }

    /// The elements of another scene, each as a copy of one with the same mesh.
    ///
    /// # Errors
    /// [`Error::Input`] for a mesh that the exemplar does not have.
    pub(crate) fn kept(&self, name: &str, kept: &Scene, budget: &Budget) -> Result<Vec<Placement<3>>> {
        // The first node of every mesh that is more than a part.
        let mut shown = BTreeMap::new();
        self.scene.nodes.iter().enumerate().for_each(|(n, node)| {
            shown.entry(node.mesh).or_insert(n);
        });
        let source_of = |mesh: &SceneMesh| {
            let size = mesh.mesh.bounds().size().norm();
            let near = |(p, q): (&Vector<3>, &Vector<3>)| (*p - *q).norm() <= ROUNDED * size;
            let is_same = |own: &SceneMesh| {
                let (own, mesh) = (&own.mesh, &mesh.mesh);
                own.triangles == mesh.triangles
                    && own.positions.len() == mesh.positions.len()
                    && own.positions.iter().zip(&mesh.positions).all(near)
            };
            shown.iter().find(|(own, _)| is_same(&self.scene.meshes[**own])).map(|(_, node)| *node)
        };
        let mut sources = Vec::with_capacity(kept.meshes.len());
        for mesh in &kept.meshes {
            budget.spend((self.scene.meshes.len() * mesh.mesh.positions.len().max(1)) as u64)?;
            sources.push(source_of(mesh));
        }
        let placement = |node: &SceneNode| {
            let Some(source) = sources[node.mesh] else {
                let problem =
                    format!("the mesh {} of a kept element is none of the exemplar", kept.meshes[node.mesh].name);
                return Err(Error::input(name, problem, "keep elements of a result of this exemplar"));
            };
            let transform = node.transform.after(&self.scene.nodes[source].transform.inverse());
            Ok(Placement { source, transform, control: Vec::new(), frozen: None })
        };
        kept.nodes.iter().map(placement).collect()
    }

    /// The scene of these elements in other places.
    pub(crate) fn placed(&self, placements: &[Placement<3>], frame: Option<Bounds<3>>) -> Scene {
        let node = |placement: &Placement<3>| {
            let source = &self.scene.nodes[placement.source];
            let name = self.exemplar.classes[self.exemplar.elements[placement.source].class].name.clone();
            SceneNode {
                name,
                mesh: source.mesh,
                transform: placement.transform.after(&source.transform),
                source: Some(placement.source as u64),
                ..source.clone()
            }
        };
        Scene { nodes: placements.iter().map(node).collect(), frame, ..(*self.scene).clone() }
    }
}

/// A scene with one mesh for those of a class that are copies of one another, as they are in files that hold every element in its place.
fn shared(scene: Scene, budget: &Budget) -> Result<Scene> {
    let classes = scene.classes();
    let mut mesh_of = BTreeMap::new();
    let pairs = scene.nodes.iter().zip(classes.of_node);
    let are_many =
        pairs.fold(false, |any, (node, class)| *mesh_of.entry(class).or_insert(node.mesh) != node.mesh || any);
    if !are_many {
        return Ok(scene);
    }
    let fewer = scene.clone().share_shapes(budget)?;
    Ok(if fewer.meshes.len() < scene.meshes.len() { fewer } else { scene })
}

/// Lowest place of elements that bend.
fn lowest_soft(exemplar: &Exemplar<3>) -> Option<f64> {
    let samples = exemplar.softs.iter().flat_map(|s| s.samples.iter().zip(&s.radii));
    samples.map(|(p, r)| p[exemplar.up] - r).min_by(f64::total_cmp)
}

/// A box of which a heap of elements that bend shows everything, where nobody tells: they are longer than it is wide, so that its density
/// is told by how much of them is in the middle of it, not by their number and where they have their own middle.
fn occupied(softs: &[Arc<Soft<3>>]) -> Bounds<3> {
    let middles = Bounds::around(softs.iter().map(|s| s.middle(&s.samples)));
    let mut core = middles;
    for axis in 0..3 {
        let mut all: Vec<f64> = softs.iter().flat_map(|s| s.samples.iter().map(|p| p[axis])).collect();
        all.sort_by(f64::total_cmp);
        let at = |share: f64| all.get((share * all.len() as f64) as usize).copied().unwrap_or(0.0);
        (core.min[axis], core.max[axis]) = (at(CORE.0), at(CORE.1));
    }
    let inside = softs
        .iter()
        .map(|s| s.samples.iter().filter(|p| core.contains(**p)).count() as f64 / s.samples.len().max(1) as f64);
    let density = inside.sum::<f64>() / core.measure().max(f64::MIN_POSITIVE);
    let wanted = softs.len() as f64 / density.max(f64::MIN_POSITIVE);
    let thickest = softs.iter().flat_map(|s| s.radii.iter().copied()).fold(0.0, f64::max);
    let least = middles.grown(thickest);
    let factor = (wanted / least.measure().max(f64::MIN_POSITIVE)).cbrt().clamp(0.5, 2.0);
    let more = least.size() * (0.5 * (factor - 1.0));
    Bounds::new(least.min - more, least.max + more)
}

/// The exemplar in its frame, if the file has one. A lattice that fits its frame tightly shows more elements than there are elsewhere, so that
/// the frame must be as much wider.
fn framed(name: &str, elements: Vec<Element<3>>, classes: Vec<Class>, frame: Option<Bounds<3>>) -> Result<Exemplar<3>> {
    let Some(frame) = frame else { return Ok(thickened(Exemplar::unframed(name, elements, classes)?)) };
    let flat = |e: Exemplar<3>| Ok(thickened(e));
    let centres: Vec<_> = elements.iter().map(|e| e.centre).collect();
    let tight = Exemplar::new(name, elements, classes, frame)?;
    let Some(cell) = point_lattice(&centres).and_then(|lattice| lattice.cell) else { return flat(tight) };
    let factor = cell * centres.len() as f64 / frame.measure();
    if !(1.0..=WIDEST).contains(&factor) {
        return flat(tight);
    }
    let grow = frame.size() * (0.5 * (factor.cbrt() - 1.0));
    let window = Bounds::new(frame.min - grow, frame.max + grow);
    Ok(Exemplar { window, ..tight })
}

/// The exemplar in a frame at least as thick as its elements: the centres of tiles on a floor all lie at one height, which is no reason for
/// nothing to have room there.
fn thickened(mut exemplar: Exemplar<3>) -> Exemplar<3> {
    for axis in 0..3 {
        let mut sizes: Vec<f64> = exemplar
            .elements
            .iter()
            .map(|e| {
                let along = e.outline.points().map(|p| p[axis]);
                let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
                high - low
            })
            .collect();
        sizes.sort_by(f64::total_cmp);
        let usual = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        let (low, high) = (exemplar.window.min[axis], exemplar.window.max[axis]);
        if high - low < FLAT * usual {
            let middle = 0.5 * (low + high);
            (exemplar.window.min[axis], exemplar.window.max[axis]) = (middle - 0.5 * usual, middle + 0.5 * usual);
        }
    }
    exemplar
}

/// What every mesh is that some node shows, by its number.
fn bodies(name: &str, scene: &Scene, budget: &Budget) -> Result<BTreeMap<usize, Body>> {
    let shown: BTreeSet<usize> = scene.nodes.iter().map(|node| node.mesh).collect();
    let is_many = shown.len() > MANY;
    let one = |number: usize| {
        let shape = &scene.meshes[number];
        let called = format!("{name}: mesh {number} {}", shape.name);
        let index = MeshIndex::new(&shape.mesh, called.trim_end(), budget)?;
        let area = index.area();
        if !(area > 0.0 && area.is_finite()) {
            return Err(Error::input(called.trim_end(), "a mesh without area", "leave it out"));
        }
        let found = scatter(&index, (area * PACKED / SCATTERED).sqrt(), 0, budget)?;
        let mut points: Vec<_> = found.iter().map(|c| c.point).collect();
        points.extend(corners(&shape.mesh));
        let centre = centre(&shape.mesh, &points);
        let solid = Arc::new(solid((&index, thickness(&shape.mesh, area)), &points, centre, budget)?);
        let symmetry =
            if is_many { Symmetry::default() } else { Symmetry::of(&shape.mesh, &index, (centre, &points), budget)? };
        Ok((number, Body { centre, points, colour: colour(&shape.mesh), solid, symmetry }))
    };
    shown.into_iter().map(one).collect()
}

/// The volume of a mesh, whose walls are about so thick: its distances on a grid around it.
fn solid(
    (index, thickness): (&MeshIndex, f64),
    points: &[Vector<3>],
    centre: Vector<3>,
    budget: &Budget,
) -> Result<Solid<3>> {
    let size = index.bounds().size();
    let longest = size.0.into_iter().fold(0.0, f64::max);
    let thinnest = size.0.into_iter().fold(f64::INFINITY, f64::min).max(longest / THINNEST);
    let step = (thinnest / ACROSS).min(thickness / WALL).max(longest / ALONG);
    let bounds = index.bounds().grown(MARGIN * step);
    let nodes = bounds.size().0.map(|side| (side / step).ceil() as usize + 1);
    let mut grid = Grid { bounds, nodes, values: vec![0.0; nodes.iter().product()] };
    let places: Vec<_> = (0..grid.values.len()).map(|n| grid.node(n)).collect();
    grid.values = index.signed_distances(&places, budget)?;
    Ok(Solid::new(grid, index.bounds(), points.to_vec(), centre))
}

/// How thick the walls of a mesh of this area are in the mean: what is hollow is thin. Without end where it encloses nothing.
fn thickness(mesh: &TriangleMesh, area: f64) -> f64 {
    let middle = mesh.bounds().centre();
    let of_triangle = |t| {
        let [a, b, c] = mesh.corners(t).map(|p| p - middle);
        a.dot(b.cross(c)) / 6.0
    };
    let volume = (0..mesh.triangles.len()).map(of_triangle).sum::<f64>().abs();
    if volume > 1e-6 * area.powf(1.5) { 2.0 * volume / area } else { f64::INFINITY }
}

/// Corners far from one another, those that stick out first.
fn corners(mesh: &TriangleMesh) -> Vec<Vector<3>> {
    let middle = mesh.bounds().centre();
    let mut room: Vec<f64> = mesh.positions.iter().map(|p| (*p - middle).norm2()).collect();
    let mut chosen: Vec<Vector<3>> = Vec::new();
    while chosen.len() < CORNERS.min(mesh.positions.len()) {
        let Some((next, most)) = room.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break };
        if *most <= 0.0 {
            break;
        }
        let p = mesh.positions[next];
        chosen.push(p);
        let is_first = chosen.len() == 1;
        for (room, q) in room.iter_mut().zip(&mesh.positions) {
            let far = (*q - p).norm2();
            *room = if is_first { far } else { room.min(far) };
        }
    }
    chosen
}

/// Centre of the volume; of the points where a mesh encloses nothing.
fn centre(mesh: &TriangleMesh, points: &[Vector<3>]) -> Vector<3> {
    let middle = mesh.bounds().centre();
    let mut sum = (Vector::ZERO, 0.0, 0.0);
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(|p| p - middle);
        let volume = a.dot(b.cross(c));
        sum = (sum.0 + (a + b + c) * (0.25 * volume), sum.1 + volume, sum.2 + volume.abs());
    }
    let (moment, volume, total) = sum;
    let size = mesh.bounds().size().norm();
    if volume.abs() > 1e-9 * size.powi(3) && volume.abs() > 0.2 * total {
        return middle + moment * (1.0 / volume);
    }
    points.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / points.len().max(1) as f64)
}

fn colour(mesh: &TriangleMesh) -> [f64; 3] {
    match mesh.colours.as_deref() {
        None | Some([]) => [1.0; 3],
        Some(list) => {
            std::array::from_fn(|k| (list.iter().map(|c| c[k]).sum::<f64>() / list.len() as f64).clamp(0.0, 1.0))
        }
    }
}

/// The first names of a list.
fn list(names: &[&str]) -> String {
    const SHOWN: usize = 8;
    let more = if names.len() > SHOWN { ", ..." } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
}
