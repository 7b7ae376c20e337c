//! Stacks on a floor: elements of which one lies on another, apart from all others. Each is placed as one thing, so that what lies on
//! something in the exemplar lies on it in the result, exactly as there.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, DisjointSets, Element, Exemplar, Placement, Result, Similarity, Vector};
use arabesque_io::mesh::{
    gltf::{Scene, SceneNode},
    scene::Classes,
};

use super::scene::Bodies;

/// Work of a point that is looked at, and of a pair of elements.
const PER_POINT: u64 = 60;
const PER_PAIR: u64 = 40;
/// What is nearer than this share of the thinner of two touches.
const TOUCH: f64 = 0.06;
/// What is nearer to the floor than this share of its own height stands on it.
const STANDS: f64 = 0.1;
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
    /// The elements of the scene as it was that each element is.
    members: Vec<Vec<usize>>,
}

impl Stacks {
    /// Placements of single elements.
    pub(super) fn taken_apart(&self, placements: &[Placement<3>]) -> Vec<Placement<3>> {
        let own = |p: &Placement<3>| {
            let single = |&source: &usize| Placement { source, control: Vec::new(), ..p.clone() };
            self.members.get(p.source).into_iter().flatten().map(single).collect::<Vec<_>>()
        };
        placements.iter().flat_map(own).collect()
    }

    /// How many of them are made of several elements, and of how many.
    pub(super) fn count(&self) -> (usize, usize) {
        let several = self.members.iter().filter(|members| members.len() > 1);
        several.fold((0, 0), |(stacks, elements), members| (stacks + 1, elements + members.len()))
    }
}

/// The scene with a node for each stack, where all that does not stand on the floor lies on something in a stack that is apart from others,
/// and there are several.
///
/// # Errors
/// As [`Bodies::of`].
pub(super) fn stacked(name: &str, single: Bodies, budget: &Budget) -> Result<(Bodies, Option<Stacks>)> {
    let budget = budget.stage("looking for stacks");
    let Some(members) = members(&single.exemplar, &budget)? else { return Ok((single, None)) };
    let scene = together(&single.scene, &members);
    let whole = Bodies::of(name, scene, single.exemplar.up, &budget)?;
    Ok((whole, Some(Stacks { single: Arc::new(single), members })))
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
}

/// The elements of every stack, those alone included; `None` where they are no stacks.
fn members(exemplar: &Exemplar<3>, budget: &Budget) -> Result<Option<Vec<Vec<usize>>>> {
    let up = exemplar.up;
    let count = exemplar.elements.len();
    if count <= GROUPS || exemplar.solids.len() != count || !exemplar.softs.is_empty() {
        return Ok(None);
    }
    let thing = |element| thing(element, up);
    let mut things: Vec<Thing<'_>> = exemplar.elements.iter().map(thing).collect();
    let floor = things.iter().map(|t| t.around.min[up]).fold(f64::INFINITY, f64::min);
    for thing in &mut things {
        thing.stands = thing.around.min[up] - floor <= STANDS * thing.around.size()[up];
    }
    if things.iter().all(|thing| thing.stands) {
        return Ok(None);
    }
    let mut sets = DisjointSets::new(count);
    for (a, b) in touching(exemplar, &things, budget)? {
        if !(things[a].stands && things[b].stands) {
            sets.join(a, b);
        }
    }
    let groups = sets.groups();
    let has_floor = |group: &Vec<usize>| group.iter().any(|&k| things[k].stands);
    let around = |group: &mut dyn Iterator<Item = usize>| {
        let all = group.fold(Bounds::EMPTY, |all: Bounds<3>, k| all.union(&things[k].around)).size();
        (0..3).filter(|axis| *axis != up).map(|axis| all[axis]).product::<f64>()
    };
    let floor_area = around(&mut (0..count));
    let is_small = |group: &Vec<usize>| {
        group.len() == 1
            || group.len() as f64 <= MEMBERS * count as f64 && around(&mut group.iter().copied()) <= AREA * floor_area
    };
    let stacks = groups.iter().filter(|group| group.len() > 1).count();
    let are_stacks =
        groups.len() >= GROUPS && stacks >= STACKS && groups.iter().all(|group| has_floor(group) && is_small(group));
    Ok(are_stacks.then_some(groups))
}

fn thing(element: &Element<3>, up: usize) -> Thing<'_> {
    let points: Vec<_> = element.outline.points().collect();
    let around = Bounds::around(points.iter().copied());
    let size = around.size();
    let thinnest = size.0.into_iter().fold(f64::INFINITY, f64::min).max(0.1 * size[up]);
    Thing { points, around, thinnest, element, stands: false }
}

/// All pairs of elements that touch.
fn touching(exemplar: &Exemplar<3>, things: &[Thing<'_>], budget: &Budget) -> Result<Vec<(usize, usize)>> {
    let axis = if exemplar.up == 0 { 1 } else { 0 };
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
            budget.spend(PER_POINT * (things[a].points.len() + things[b].points.len()) as u64)?;
            if reaches(exemplar, (a, &things[b]), near) || reaches(exemplar, (b, &things[a]), near) {
                found.push((a, b));
            }
        }
    }
    Ok(found)
}

/// Whether a point of a thing is in an element, or nearer than `near`.
fn reaches(exemplar: &Exemplar<3>, (element, other): (usize, &Thing<'_>), near: f64) -> bool {
    let (pose, solid) = (&exemplar.elements[element].pose, &exemplar.solids[element]);
    let back = pose.inverse();
    let centre = other.element.centre;
    let points = other.points.iter().copied().chain([centre]);
    points.map(|p| solid.depth(back.apply(p)) * pose.scale).any(|depth| depth >= -near)
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
