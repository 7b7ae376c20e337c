//! Stacks on a floor, and shelves: elements of which one lies on another, apart from all others. Each is placed as one thing, so that what
//! lies on something in the exemplar lies on it in the result, exactly as there.
//!
//! A stack begins with what stands on the floor, or with what is held by something that the exemplar does not show, as boards on a wall are:
//! elements that lie on nothing and carry others.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, DisjointSets, Element, Placement, Result, Similarity, Solid, Vector};
use arabesque_io::mesh::{
    gltf::{Scene, SceneNode},
    scene::Classes,
};
use arabesque_surface::MeshIndex;

use super::scene::Bodies;

/// Work of a point that is looked at, in a grid and on a mesh, and of a pair of elements.
const PER_POINT: u64 = 60;
const PER_CLOSEST: u64 = 1500;
const PER_PAIR: u64 = 40;
/// What is nearer than this share of the thinner of two touches.
const TOUCH: f64 = 0.06;
/// What is nearer to the floor than this share of its own height stands on it.
const STANDS: f64 = 0.1;
/// One thing lies on another where the surface between them is no steeper than this, as the height of its normal.
const LEVEL: f64 = 0.5;
/// Grids of distances do not show what is thinner than so many of their steps.
const SHOWN: f64 = 1.5;
/// Of the elements of a class that hang in the air this share has to lie on nothing, and this one to carry something, for all to be held.
const HANGS: f64 = 0.9;
const CARRIES: f64 = 0.5;
/// Fewest groups, and fewest of them that are stacks.
const GROUPS: usize = 3;
const STACKS: usize = 2;
/// The largest share of all elements, and of the floor that they lie on, that one stack may be.
const MEMBERS: f64 = 0.5;
const AREA: f64 = 0.34;

/// A scene whose stacks are one element each, and the scene as it was.
#[derive(Clone, Debug)]
pub(super) struct Stacks {
    pub(super) single: Arc<Bodies>,
    groups: Vec<Group>,
}

/// The elements of the scene as it was that one element is.
#[derive(Clone, Debug)]
struct Group {
    members: Vec<usize>,
    /// What all others lie on.
    root: usize,
    /// Whether that is held by what is not shown.
    is_held: bool,
}

impl Stacks {
    /// Placements of single elements.
    pub(super) fn taken_apart(&self, placements: &[Placement<3>]) -> Vec<Placement<3>> {
        let own = |p: &Placement<3>| {
            let single = |&source: &usize| Placement { source, control: Vec::new(), ..p.clone() };
            self.groups.get(p.source).into_iter().flat_map(|group| &group.members).map(single).collect::<Vec<_>>()
        };
        placements.iter().flat_map(own).collect()
    }

    /// How many of them are made of several elements, and of how many.
    pub(super) fn count(&self) -> (usize, usize) {
        let several = self.groups.iter().map(|group| group.members.len()).filter(|members| *members > 1);
        several.fold((0, 0), |(stacks, elements), members| (stacks + 1, elements + members))
    }

    /// Whether a stack is held where it is, and does not fall.
    pub(super) fn is_held(&self, source: usize) -> bool {
        self.groups.get(source).is_some_and(|group| group.is_held)
    }
}

/// The scene with a node for each stack, where all that does not stand on the floor lies on something in a stack that is apart from others,
/// and there are several.
///
/// # Errors
/// As [`Bodies::of`].
pub(super) fn stacked(name: &str, single: Bodies, budget: &Budget) -> Result<(Bodies, Option<Stacks>)> {
    let budget = budget.stage("looking for stacks");
    let Some(groups) = groups(&single, &budget)? else { return Ok((single, None)) };
    let members: Vec<_> = groups.iter().map(|group| group.members.clone()).collect();
    let scene = together(&single.scene, &members);
    let mut whole = Bodies::of(name, scene, single.exemplar.up, &budget)?;
    // A stack is where what carries it is, whatever lies on that.
    let exemplar = Arc::make_mut(&mut whole.exemplar);
    for (element, group) in exemplar.elements.iter_mut().zip(&groups) {
        element.centre = single.exemplar.elements[group.root].centre;
    }
    Ok((whole, Some(Stacks { single: Arc::new(single), groups })))
}

/// A scene with a node for each group of nodes.
fn together(scene: &Scene, groups: &[Vec<usize>]) -> Scene {
    let Classes { names, of_node } = scene.classes();
    let mut meshes = scene.meshes.clone();
    let mut nodes = Vec::with_capacity(groups.len());
    for group in groups {
        let mut classes: Vec<&str> = group.iter().map(|&n| names[of_node[n]].as_str()).collect();
        classes.sort_unstable();
        classes.dedup();
        let class = classes.join("+");
        if let [one] = group[..] {
            nodes.push(SceneNode { class: Some(class), ..scene.nodes[one].clone() });
            continue;
        }
        let frame = Similarity::shift(scene.nodes[group[0]].transform.translation);
        let back = frame.inverse();
        let part =
            |&n: &usize| SceneNode { transform: back.after(&scene.nodes[n].transform), ..scene.nodes[n].clone() };
        let mut mesh = scene.put_together(&class, group.iter().map(part).collect());
        mesh.parts.clear();
        meshes.push(mesh);
        nodes.push(SceneNode { class: Some(class.clone()), ..SceneNode::new(class, meshes.len() - 1, frame) });
    }
    let mut used = vec![None; meshes.len()];
    nodes.iter().for_each(|node| used[node.mesh] = Some(0));
    used.iter_mut().flatten().enumerate().for_each(|(n, number)| *number = n);
    nodes.iter_mut().for_each(|node| node.mesh = used[node.mesh].unwrap_or(0));
    let meshes = meshes.into_iter().zip(&used).filter(|(_, n)| n.is_some()).map(|(mut mesh, _)| {
        // The parts of what is one thing anyhow are not needed here.
        mesh.parts.clear();
        mesh
    });
    Scene { meshes: meshes.collect(), nodes, ..scene.clone() }
}

/// An element, as far as stacks go.
struct Thing<'a> {
    points: Vec<Vector<3>>,
    around: Bounds<3>,
    thinnest: f64,
    element: &'a Element<3>,
    stands: bool,
    /// Whether something is below it, or it lies on something.
    carries: bool,
    lies: bool,
    /// Whether it hangs in the air as others of its class do that carry something.
    is_held: bool,
}

impl Thing<'_> {
    /// Whether a stack may begin with it.
    fn is_root(&self) -> bool {
        self.stands || self.is_held
    }
}

/// The elements of every stack, those alone included; `None` where they are no stacks.
fn groups(single: &Bodies, budget: &Budget) -> Result<Option<Vec<Group>>> {
    let exemplar = &*single.exemplar;
    let up = exemplar.up;
    let count = exemplar.elements.len();
    if count <= GROUPS || exemplar.solids.len() != count || !exemplar.softs.is_empty() {
        return Ok(None);
    }
    let mut things: Vec<Thing<'_>> = exemplar.elements.iter().map(|element| thing(element, up)).collect();
    let floor = things.iter().map(|t| t.around.min[up]).fold(f64::INFINITY, f64::min);
    for thing in &mut things {
        thing.stands = thing.around.min[up] - floor <= STANDS * thing.around.size()[up];
    }
    if things.iter().all(|thing| thing.stands) {
        return Ok(None);
    }
    let meets = Touching { single, things: &things, fine: fine(single, budget)? }.all(budget)?;
    for meet in meets.iter().filter(|meet| meet.is_level) {
        (things[meet.upper].lies, things[meet.lower].carries) = (true, true);
    }
    hold(&mut things);
    let has_shelves = things.iter().any(|thing| thing.is_held);
    let mut sets = DisjointSets::new(count);
    for meet in &meets {
        let [a, b] = [meet.upper, meet.lower].map(|k| &things[k]);
        // What stands side by side on shelves lies on them, and not on one another.
        let is_beside = has_shelves && !meet.is_level && [a, b].iter().all(|thing| thing.is_root() || thing.lies);
        if !(is_beside || a.is_root() && b.is_root()) {
            sets.join(meet.upper, meet.lower);
        }
    }
    let whole = around(&things, &(0..count).collect::<Vec<_>>(), up);
    let is_small = |group: &Vec<usize>| {
        group.len() == 1 || group.len() as f64 <= MEMBERS * count as f64 && around(&things, group, up) <= AREA * whole
    };
    let sets = sets.groups();
    let stacks = sets.iter().filter(|group| group.len() > 1).count();
    if sets.len() < GROUPS || stacks < STACKS || !sets.iter().all(is_small) {
        return Ok(None);
    }
    let group = |members: Vec<usize>| {
        let wide = |k: &usize| around(&things, &[*k], up);
        let roots = members.iter().copied().filter(|&k| things[k].is_root());
        let root = roots.max_by(|a, b| wide(a).total_cmp(&wide(b)).then(b.cmp(a)))?;
        let is_held = !members.iter().any(|&k| things[k].stands);
        Some(Group { members, root, is_held })
    };
    Ok(sets.into_iter().map(group).collect())
}

/// The area of the box around some of them, seen from above.
fn around(things: &[Thing<'_>], group: &[usize], up: usize) -> f64 {
    let all = group.iter().fold(Bounds::EMPTY, |all: Bounds<3>, &k| all.union(&things[k].around)).size();
    (0..3).filter(|axis| *axis != up).map(|axis| all[axis]).product::<f64>()
}

/// Finds out what is held by what the exemplar does not show: elements of classes that lie on nothing where they are off the floor, and
/// carry something mostly.
fn hold(things: &mut [Thing<'_>]) {
    let mut of_class: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
    for thing in things.iter().filter(|thing| !thing.stands) {
        let [all, hanging, carrying] = of_class.entry(thing.element.class).or_default();
        *all += 1.0;
        if !thing.lies {
            *hanging += 1.0;
            *carrying += f64::from(u8::from(thing.carries));
        }
    }
    for thing in things.iter_mut().filter(|thing| !thing.stands && !thing.lies) {
        let [all, hanging, carrying] = of_class[&thing.element.class];
        thing.is_held = hanging >= HANGS * all && carrying >= CARRIES * hanging;
    }
}

fn thing(element: &Element<3>, up: usize) -> Thing<'_> {
    let points: Vec<_> = element.outline.points().collect();
    let around = Bounds::around(points.iter().copied());
    let size = around.size();
    let thinnest = size.0.into_iter().fold(f64::INFINITY, f64::min).max(0.1 * size[up]);
    Thing { points, around, thinnest, element, stands: false, carries: false, lies: false, is_held: false }
}

/// Two elements that touch: the lower one, if one lies on the other.
struct Meet {
    upper: usize,
    lower: usize,
    is_level: bool,
}

/// The meshes of which a grid of distances does not show enough.
fn fine(single: &Bodies, budget: &Budget) -> Result<BTreeMap<usize, MeshIndex>> {
    let mut fine = BTreeMap::new();
    for (node, solid) in single.scene.nodes.iter().zip(&single.exemplar.solids) {
        if is_thin(solid) && !fine.contains_key(&node.mesh) {
            let shape = &single.scene.meshes[node.mesh];
            fine.insert(node.mesh, MeshIndex::new(&shape.mesh, &shape.name, budget)?);
        }
    }
    Ok(fine)
}

fn is_thin(solid: &Solid<3>) -> bool {
    let (grid, size) = (&solid.distance, solid.distance.bounds.size());
    let step = (0..3).map(|k| size[k] / (grid.nodes[k].max(2) - 1) as f64).fold(0.0, f64::max);
    solid.inradius() < SHOWN * step
}

/// Looks for elements that touch.
struct Touching<'a> {
    single: &'a Bodies,
    things: &'a [Thing<'a>],
    fine: BTreeMap<usize, MeshIndex>,
}

impl Touching<'_> {
    /// All pairs of elements that touch.
    fn all(&self, budget: &Budget) -> Result<Vec<Meet>> {
        let (things, up) = (self.things, self.single.exemplar.up);
        let axis = if up == 0 { 1 } else { 0 };
        let mut order: Vec<usize> = (0..things.len()).collect();
        order.sort_by(|&a, &b| things[a].around.min[axis].total_cmp(&things[b].around.min[axis]));
        let mut found = Vec::new();
        for (at, &a) in order.iter().enumerate() {
            let reach = TOUCH * things[a].thinnest;
            for &b in &order[at + 1..] {
                budget.spend(PER_PAIR)?;
                if things[b].around.min[axis] > things[a].around.max[axis] + reach {
                    break;
                }
                let near = reach.min(TOUCH * things[b].thinnest);
                if !things[a].around.grown(near).intersects(&things[b].around) {
                    continue;
                }
                // How level the surface of each is where the other one touches it, seen from below.
                let [on_a, on_b] = [self.reached((a, b), near, budget)?, self.reached((b, a), near, budget)?];
                if on_a.is_none() && on_b.is_none() {
                    continue;
                }
                let most = |one: Option<[f64; 2]>, k: usize| one.map_or(0.0, |levels| levels[k]);
                let (b_lies, a_lies) = (most(on_a, 1).max(-most(on_b, 0)), most(on_b, 1).max(-most(on_a, 0)));
                let (upper, lower) = if a_lies >= b_lies { (a, b) } else { (b, a) };
                // What stands as low lies on nothing there: along edges that coincide, distances do not say which way they lead.
                let low = |k: usize| things[k].around.min[up];
                let lower_size = things[a].around.size()[up].min(things[b].around.size()[up]);
                let is_above = low(upper) - low(lower) > TOUCH * lower_size;
                found.push(Meet { upper, lower, is_level: is_above && a_lies.max(b_lies) > LEVEL });
            }
        }
        Ok(found)
    }

    /// How far down and up the surface of an element looks where points of another one are in it, or nearer than `near`; nothing where none are.
    fn reached(&self, (element, other): (usize, usize), near: f64, budget: &Budget) -> Result<Option<[f64; 2]>> {
        let exemplar = &self.single.exemplar;
        let (pose, solid) = (&exemplar.elements[element].pose, &exemplar.solids[element]);
        let (back, other) = (pose.inverse(), &self.things[other]);
        let mesh = self.fine.get(&self.single.scene.nodes[element].mesh);
        budget.spend(if mesh.is_some() { PER_CLOSEST } else { PER_POINT } * other.points.len() as u64)?;
        let mut levels: Option<[f64; 2]> = None;
        let reach = near / pose.scale.max(f64::MIN_POSITIVE);
        let box_around = solid.bounds.grown(reach);
        let points = other.points.iter().copied().chain([other.element.centre]);
        for own in points.map(|p| back.apply(p)).filter(|own| box_around.contains(*own)) {
            let way = match mesh {
                None => (solid.depth(own) >= -reach).then(|| solid.outwards(own)),
                Some(mesh) => {
                    let closest = mesh.closest(own);
                    let [a, b, c] = mesh.corners(closest.triangle);
                    let is_near = closest.distance <= reach || mesh.is_inside(own);
                    is_near.then(|| (b - a).cross(c - a).unit_or_zero())
                }
            };
            if let Some(way) = way {
                let level = pose.rotation.apply(way)[exemplar.up];
                let [low, high] = levels.get_or_insert([0.0; 2]);
                (*low, *high) = (low.min(level), high.max(level));
            }
        }
        Ok(levels)
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::TriangleMesh;
    use arabesque_io::mesh::gltf::SceneMesh;

    use super::*;
    use crate::recipe::Deform;

    /// A box around the origin.
    fn cuboid(size: [f64; 3]) -> TriangleMesh {
        let corner = |k: usize| Vector(std::array::from_fn(|a| if k >> a & 1 == 1 { 0.5 } else { -0.5 } * size[a]));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        TriangleMesh {
            positions: (0..8).map(corner).collect(),
            triangles: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            ..TriangleMesh::default()
        }
    }

    /// Crates at these places, y up.
    fn crates(places: &[[f64; 3]]) -> Bodies {
        let node =
            |(k, at): (usize, &[f64; 3])| SceneNode::new(format!("crate.{k}"), 0, Similarity::shift(Vector(*at)));
        let scene = Scene {
            meshes: vec![SceneMesh::new("crate", cuboid([1.0; 3]))],
            nodes: places.iter().enumerate().map(node).collect(),
            ..Scene::default()
        };
        Bodies::read("t", scene, (1, &Deform::default(), None), &Budget::default()).unwrap().0
    }

    #[test]
    fn stacks_apart_are_one_element_each_and_come_apart_again() {
        let places =
            [[0.0, 0.5, 0.0], [0.1, 1.52, 0.0], [3.0, 0.5, 1.0], [6.0, 0.5, 0.0], [6.0, 1.5, 0.1], [9.0, 0.5, 2.0]];
        let (whole, stacks) = stacked("t", crates(&places), &Budget::default()).unwrap();
        let stacks = stacks.unwrap();
        assert_eq!((whole.exemplar.elements.len(), stacks.count()), (4, (2, 4)));
        let placement = |source| Placement {
            source,
            transform: Similarity::shift(Vector([5.0, 0.0, 0.0])),
            control: Vec::new(),
            frozen: None,
        };
        let apart = stacks.taken_apart(&[placement(0), placement(1)]);
        assert_eq!(apart.iter().map(|p| p.source).collect::<Vec<_>>(), [0, 1, 2]);
        let upper = stacks.single.placed(&apart, None).nodes[1].transform.translation;
        assert!((upper - Vector([5.1, 1.52, 0.0])).norm() < 1e-9);
    }

    /// Boards on a wall, at three heights, with crates on them; each board is one long mesh.
    fn shelves() -> Bodies {
        let at = |k: usize, x: f64, y: f64| SceneNode::new(format!("n.{k}"), k, Similarity::shift(Vector([x, y, 0.0])));
        let mut nodes = Vec::new();
        for (x, y) in (0..9).map(|k| (4.1 * f64::from(k % 3), 2.0 * f64::from(k / 3))) {
            nodes.push(SceneNode { class: Some("board".into()), ..at(0, x, y) });
            // Those on boards side by side touch.
            for off in [-1.55, 1.55] {
                nodes.push(SceneNode { class: Some("crate".into()), ..at(1, x + off, y + 0.65) });
            }
        }
        let meshes = vec![SceneMesh::new("board", cuboid([4.0, 0.3, 1.0])), SceneMesh::new("crate", cuboid([1.0; 3]))];
        let scene = Scene { meshes, nodes, ..Scene::default() };
        Bodies::read("t", scene, (1, &Deform::default(), None), &Budget::default()).unwrap().0
    }

    #[test]
    fn boards_that_hang_are_held_with_all_that_lies_on_them() {
        let (whole, stacks) = stacked("t", shelves(), &Budget::default()).unwrap();
        let stacks = stacks.unwrap();
        assert_eq!((whole.exemplar.elements.len(), stacks.count()), (9, (9, 27)));
        assert_eq!((0..9).filter(|k| stacks.is_held(*k)).count(), 6, "those on the floor stand there");
        for (element, k) in whole.exemplar.elements.iter().zip(0..9) {
            let board = Vector([4.1 * f64::from(k % 3), 2.0 * f64::from(k / 3), 0.0]);
            assert!((element.centre - board).norm() < 1e-9, "{:?}", element.centre);
        }
    }

    #[test]
    fn heaps_rows_and_what_floats_are_no_stacks() {
        // One heap, a row on the floor, and something that lies on nothing.
        let heap: Vec<_> = (0..12).map(|k| [f64::from(k % 4), 0.5 + f64::from(k / 4), 0.0]).collect();
        let row: Vec<_> = (0..8).map(|k| [1.01 * f64::from(k), 0.5, 0.0]).collect();
        let floats =
            [[0.0, 0.5, 0.0], [0.0, 1.5, 0.0], [3.0, 0.5, 0.0], [3.0, 1.5, 0.0], [6.0, 0.5, 0.0], [9.0, 3.0, 0.0]];
        for places in [&heap[..], &row[..], &floats[..]] {
            assert!(stacked("t", crates(places), &Budget::default()).unwrap().1.is_none());
        }
    }
}
