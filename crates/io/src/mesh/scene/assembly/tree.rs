//! The tree of a file: which nodes hang below which.

use std::ops::Range;

use arabesque_core::{Bounds, Similarity, Vector};

use crate::mesh::scene::{classes::stem, model::Scene};

/// A node of a file, with whatever hangs below it.
#[derive(Clone, Debug)]
pub(in crate::mesh) struct Branch {
    /// What the file calls it.
    pub(in crate::mesh) name: String,
    /// The branch that it hangs below; what hangs below something comes after it.
    pub(in crate::mesh) above: Option<usize>,
    /// From its coordinates to those of the scene, where that is a similarity.
    pub(in crate::mesh) place: Option<Similarity<3>>,
    /// What the file says of it as an element: class, number and source.
    pub(in crate::mesh) class: Option<String>,
    pub(in crate::mesh) id: Option<u64>,
    pub(in crate::mesh) source: Option<u64>,
    /// Whether the file says that it is one element.
    pub(in crate::mesh) is_element: bool,
}

/// The branches of a file, each before those below it, and the branch that each node of the scene is.
#[derive(Clone, Debug, Default)]
pub(in crate::mesh) struct Tree {
    pub(in crate::mesh) branches: Vec<Branch>,
    pub(in crate::mesh) of_node: Vec<usize>,
}

/// What may be an element of several meshes: a branch of two and more nodes, the highest of those that hold the same.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) branch: usize,
    /// The candidate that it is a part of.
    pub(super) above: Option<usize>,
    /// Its nodes in the scene.
    pub(super) nodes: Range<usize>,
    /// What hangs directly below it, as runs of nodes.
    pub(super) units: Vec<Range<usize>>,
    /// Its meshes, in ascending order.
    pub(super) meshes: Vec<usize>,
    /// The stems of the names of itself and of its nodes, those of the nodes in ascending order.
    pub(super) names: (String, Vec<String>),
}

/// The nodes of the scene below every branch, itself included.
fn runs(tree: &Tree) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = vec![0..0; tree.branches.len()];
    for (node, &branch) in tree.of_node.iter().enumerate() {
        let run = &mut runs[branch];
        *run = if run.start == run.end { node..node + 1 } else { run.start..node + 1 };
    }
    for branch in (0..runs.len()).rev() {
        let (own, above) = (runs[branch].clone(), tree.branches[branch].above);
        if let Some(above) = above.filter(|_| !own.is_empty()) {
            let run = &mut runs[above];
            *run = if run.start == run.end { own } else { run.start.min(own.start)..run.end.max(own.end) };
        }
    }
    runs
}

/// Everything that may be an element of several meshes, in the order of the file. More than `most` nodes are none.
pub(super) fn candidates(scene: &Scene, tree: &Tree, most: usize) -> Vec<Candidate> {
    let runs = runs(tree);
    let mut number: Vec<Option<usize>> = vec![None; runs.len()];
    let mut found: Vec<Candidate> = Vec::new();
    for (branch, known) in tree.branches.iter().enumerate() {
        // What is below a candidate that holds the same is the same; larger ones hold smaller ones.
        let above = known.above.and_then(|above| number[above]);
        number[branch] = above;
        let nodes = runs[branch].clone();
        let is_same = known.above.is_some_and(|above| runs[above] == nodes);
        if !(2..=most).contains(&nodes.len()) || is_same && above.is_some() {
            continue;
        }
        let mut meshes: Vec<usize> = scene.nodes[nodes.clone()].iter().map(|node| node.mesh).collect();
        meshes.sort_unstable();
        let mut names: Vec<String> = scene.nodes[nodes.clone()].iter().map(|n| stem(&n.name).to_owned()).collect();
        names.sort_unstable();
        let names = (stem(&known.name).to_owned(), names);
        number[branch] = Some(found.len());
        found.push(Candidate { branch, above, nodes, units: Vec::new(), meshes, names });
    }
    for (branch, known) in tree.branches.iter().enumerate() {
        let Some(above) = known.above.filter(|above| !runs[branch].is_empty() && runs[*above] != runs[branch]) else {
            continue;
        };
        if let Some(at) = number[above].filter(|at| found[*at].nodes == runs[above]) {
            found[at].units.push(runs[branch].clone());
        }
    }
    for candidate in &mut found {
        // What is shown before the first of them is the branch itself.
        let next = candidate.units.first().map_or(candidate.nodes.end, |unit| unit.start);
        if next > candidate.nodes.start {
            candidate.units.insert(0, candidate.nodes.start..next);
        }
    }
    found
}

/// The box around every node of a scene.
pub(super) fn boxes(scene: &Scene) -> Vec<Bounds<3>> {
    let of_mesh: Vec<Bounds<3>> = scene.meshes.iter().map(|mesh| mesh.mesh.bounds()).collect();
    let of_node = scene.nodes.iter().map(|node| {
        let own = of_mesh[node.mesh];
        let corner = |k: u8| Vector([0, 1, 2].map(|a| if k >> a & 1 == 1 { own.max[a] } else { own.min[a] }));
        Bounds::around((0..8).map(|k| node.transform.apply(corner(k))))
    });
    of_node.collect()
}
