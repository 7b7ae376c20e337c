//! The tree of nodes of a glTF file: which mesh stands where.

use arabesque_core::{Error, Matrix, Result, Similarity, Vector};

use super::{accessor::Binary, document::NodeRecord, extras::to_node};
use crate::mesh::scene::{Branch, SceneNode, matrix_of};

/// Work of one node or instance.
const PER_NODE: u64 = 500;
/// How far a transform may be from a similarity to count as one, relative to its scale.
const NEARLY: f64 = 1e-5;
/// Volume that is left of a cube, relative to the cube of the longest side, below which a transform is flat.
const FLAT: f64 = 1e-9;

/// `p -> linear * p + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine {
    pub(super) linear: Matrix<3>,
    pub(super) shift: Vector<3>,
}

impl Affine {
    pub(super) fn identity() -> Self {
        Self { linear: Matrix::identity(), shift: Vector::ZERO }
    }

    pub(super) fn apply(&self, p: Vector<3>) -> Vector<3> {
        self.linear.apply(p) + self.shift
    }

    /// `self` after `first`.
    fn after(&self, first: &Self) -> Self {
        Self { linear: self.linear.compose(&first.linear), shift: self.apply(first.shift) }
    }

    /// From its parts, as the format has them: the rotation is a quaternion x, y, z, w.
    fn of_parts(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> Self {
        let rows = matrix_of(rotation).0;
        let linear = Matrix(rows.map(|row| std::array::from_fn(|c| row[c] * scale[c])));
        Self { linear, shift: Vector(translation) }
    }

    fn of_node(node: &NodeRecord) -> Self {
        if let Some(m) = node.matrix {
            let linear = Matrix(std::array::from_fn(|r| std::array::from_fn(|c| m[4 * c + r])));
            return Self { linear, shift: Vector([m[12], m[13], m[14]]) };
        }
        Self::of_parts(
            node.translation.unwrap_or([0.0; 3]),
            node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            node.scale.unwrap_or([1.0; 3]),
        )
    }

    fn is_finite(&self) -> bool {
        self.shift.is_finite() && self.linear.0.iter().flatten().all(|v| v.is_finite())
    }

    /// Product of the factors by which volumes grow; negative when it turns things inside out.
    pub(super) fn determinant(&self) -> f64 {
        let [a, b, c] = self.linear.0.map(Vector);
        a.cross(b).dot(c)
    }

    /// Whether it leaves nothing of a volume, but for rounding.
    pub(super) fn is_flat(&self) -> bool {
        let longest = self.linear.0.iter().map(|row| Vector(*row).norm()).fold(0.0, f64::max);
        let share = self.determinant().abs() / longest.powi(3);
        // No number where there is nothing at all, or too little for the cube.
        !(share > FLAT && share.is_finite())
    }

    /// As a similarity after a stretch that leaves volumes as large as they are and may mirror; `None` for the stretch where there is
    /// none. Transforms of one stretch turned differently have the same one.
    pub(super) fn parted(&self) -> (Similarity<3>, Option<Matrix<3>>) {
        let determinant = self.determinant();
        let scale = determinant.abs().cbrt();
        let scaled = Matrix(self.linear.0.map(|row| row.map(|v| v / scale)));
        // Of what turns things inside out, the x axis is turned first, so that a rotation remains.
        let mirror = if determinant < 0.0 { -1.0 } else { 1.0 };
        let proper = Matrix(scaled.0.map(|[x, y, z]| [mirror * x, y, z]));
        let rotation = proper.nearest_rotation();
        let stretch = rotation.transpose().compose(&scaled);
        let off = |r: usize, c: usize| (stretch.0[r][c] - f64::from(u8::from(r == c))).abs();
        let similar = (0..9).all(|k| off(k / 3, k % 3) < NEARLY);
        (Similarity { rotation, scale, translation: self.shift }, (!similar).then_some(stretch))
    }
}

/// A mesh in its place.
#[derive(Debug)]
pub(super) struct Placed<'a> {
    pub(super) name: &'a str,
    /// Number of the node in the file.
    pub(super) node: usize,
    pub(super) mesh: usize,
    pub(super) place: Affine,
    /// Number of the branch that the node is.
    pub(super) branch: usize,
}

/// All places of meshes in the scene that the file shows first, in the order of the tree, and its branches.
///
/// # Errors
/// [`Error::Input`] for nodes that do not exist, that hang below themselves or below two others, and for transforms that are no finite
/// numbers; [`Error::Limit`] for trees that are too deep, and for too many instances.
pub(super) fn placed<'a>(binary: &Binary<'a>) -> Result<(Vec<Placed<'a>>, Vec<Branch>)> {
    let document = binary.document;
    let roots = match document.scenes.get(document.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.clone(),
        None => roots(&document.nodes),
    };
    let (found, branches) = (Vec::new(), Vec::new());
    let mut walk = Walk { binary, seen: vec![false; document.nodes.len()], found, branches };
    let root = (Affine::identity(), None, 1);
    let mut open: Vec<(usize, Above)> = roots.iter().rev().map(|&n| (n, root)).collect();
    while let Some((number, above)) = open.pop() {
        let here = walk.visit(number, &above)?;
        let below = (here, Some(walk.branches.len() - 1), above.2 + 1);
        open.extend(document.nodes[number].children.iter().rev().map(|&child| (child, below)));
    }
    Ok((walk.found, walk.branches))
}

/// The nodes that are below no other.
fn roots(nodes: &[NodeRecord]) -> Vec<usize> {
    let mut below = vec![false; nodes.len()];
    for &child in nodes.iter().flat_map(|node| &node.children) {
        if let Some(below) = below.get_mut(child) {
            *below = true;
        }
    }
    (0..nodes.len()).filter(|&n| !below[n]).collect()
}

/// What a node hangs below: a place, the number of a branch, and how deep that is.
type Above = (Affine, Option<usize>, usize);

struct Walk<'a, 'b> {
    binary: &'b Binary<'a>,
    seen: Vec<bool>,
    found: Vec<Placed<'a>>,
    branches: Vec<Branch>,
}

impl<'a> Walk<'a, '_> {
    fn fail<T>(&self, number: usize, problem: String) -> Result<T> {
        let place = format!("{}: node {number}", self.binary.name);
        Err(Error::input(place, problem, "write the file again; it is damaged"))
    }

    /// Takes down the mesh of a node, and gives its transform to the scene.
    fn visit(&mut self, number: usize, &(above, branch, depth): &Above) -> Result<Affine> {
        let budget = self.binary.budget;
        budget.spend(PER_NODE)?;
        budget.within(&format!("{}: depth of nodes", self.binary.name), depth, ("depth", budget.limits().depth))?;
        let Some(node) = self.binary.document.nodes.get(number) else {
            return self.fail(number, format!("it does not exist; there are {}", self.seen.len()));
        };
        if std::mem::replace(&mut self.seen[number], true) {
            return self.fail(number, "it hangs below two nodes, or below itself".into());
        }
        let here = above.after(&Affine::of_node(node));
        if !here.is_finite() {
            return self.fail(number, "its transform is not finite".into());
        }
        self.branches.push(self.branch(node, branch, &here));
        let Some(mesh) = node.mesh else { return Ok(here) };
        let Some(record) = self.binary.document.meshes.get(mesh) else {
            return self.fail(number, format!("its mesh {mesh} does not exist"));
        };
        let name = node.name.as_deref().or(record.name.as_deref()).unwrap_or_default();
        let places = match &node.extensions.instancing {
            None => vec![Affine::identity()],
            Some(instancing) => self.instances(number, &instancing.attributes)?,
        };
        for place in places {
            budget.spend(PER_NODE)?;
            let branch = self.branches.len() - 1;
            self.found.push(Placed { name, node: number, mesh, place: here.after(&place), branch });
        }
        let what = format!("{}: meshes in their places", self.binary.name);
        budget.within(&what, self.found.len(), ("nodes", budget.limits().nodes))?;
        Ok(here)
    }

    fn branch(&self, node: &NodeRecord, above: Option<usize>, here: &Affine) -> Branch {
        let mut said = SceneNode::default();
        let is_element = to_node(node.extras.as_deref(), &mut said);
        let name = node.name.clone().unwrap_or_default();
        let (place, stretch) = if here.is_flat() { (Similarity::identity(), None) } else { here.parted() };
        let place = (!here.is_flat() && stretch.is_none()).then_some(place);
        let SceneNode { class, id, source, .. } = said;
        Branch { name, above, place, class, id, source, is_element }
    }

    /// The places of a mesh that `EXT_mesh_gpu_instancing` lists.
    fn instances(&self, number: usize, attributes: &std::collections::BTreeMap<String, usize>) -> Result<Vec<Affine>> {
        let read = |name: &str, width: usize| -> Result<Option<Vec<f64>>> {
            attributes.get(name).map(|&accessor| self.binary.numbers(accessor, width)).transpose()
        };
        let (translations, rotations, scales) = (read("TRANSLATION", 3)?, read("ROTATION", 4)?, read("SCALE", 3)?);
        let counts = [(&translations, 3), (&rotations, 4), (&scales, 3)];
        let counts: Vec<usize> = counts.iter().filter_map(|(v, width)| Some(v.as_ref()?.len() / width)).collect();
        let Some(&count) = counts.first().filter(|first| counts.iter().all(|n| n == *first)) else {
            return self.fail(number, "its instances have no places, or different numbers of them".into());
        };
        fn item<const N: usize>(list: &Option<Vec<f64>>, k: usize, otherwise: [f64; N]) -> [f64; N] {
            list.as_ref().map_or(otherwise, |list| std::array::from_fn(|c| list[N * k + c]))
        }
        let place = |k: usize| {
            let [translation, scale] = [item(&translations, k, [0.0; 3]), item(&scales, k, [1.0; 3])];
            Affine::of_parts(translation, item(&rotations, k, [0.0, 0.0, 0.0, 1.0]), scale)
        };
        let places: Vec<Affine> = (0..count).map(place).collect();
        if places.iter().all(Affine::is_finite) {
            return Ok(places);
        }
        self.fail(number, "the place of an instance is not finite".into())
    }
}
