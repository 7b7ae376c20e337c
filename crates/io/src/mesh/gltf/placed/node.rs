//! A node of a scene as text, moved.

use std::ops::Range;

use arabesque_core::{Bounds, Matrix, Similarity, Vector};
use serde::Deserialize;
use serde_json::{Value, value::RawValue};

use crate::{
    mesh::scene::{matrix_of, quaternion},
    placed::{
        digits::json_digits,
        layout::{Item, Replaced},
    },
};

/// A node, in its parts.
#[derive(Clone, Debug)]
pub(super) struct NodeText {
    pub(super) range: Range<usize>,
    name: Option<String>,
    /// The mesh that it shows; none where it has nodes below it.
    pub(super) mesh: Option<usize>,
    /// Numbers of the nodes below it.
    pub(super) children: Vec<usize>,
    rotation: Option<([f64; 4], String)>,
    scale: Option<String>,
    extras: Option<String>,
    /// How far the mesh reaches.
    reach: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NodeIn<'a> {
    #[serde(borrow, default)]
    name: Option<&'a RawValue>,
    #[serde(default)]
    pub(super) mesh: Option<usize>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    #[serde(default)]
    translation: Option<[f64; 3]>,
    #[serde(borrow, default)]
    rotation: Option<&'a RawValue>,
    #[serde(borrow, default)]
    scale: Option<&'a RawValue>,
    #[serde(borrow, default)]
    extras: Option<&'a RawValue>,
}

impl NodeText {
    pub(super) fn new(range: Range<usize>, node: &NodeIn<'_>, bounds: Option<Bounds<3>>) -> Option<Self> {
        let own = |raw: Option<&RawValue>| raw.map(|raw| raw.get().to_owned());
        let rotation = match node.rotation {
            None => None,
            Some(raw) => Some((serde_json::from_str::<[f64; 4]>(raw.get()).ok()?, raw.get().to_owned())),
        };
        let reach = bounds.map_or(0.0, |b| b.size().0.into_iter().fold(0.0, f64::max));
        let (name, scale, extras) = (own(node.name), own(node.scale), own(node.extras));
        let (mesh, children) = (node.mesh, node.children.clone());
        Some(Self { range, name, mesh, children, rotation, scale, extras, reach })
    }

    /// The node moved from its place, showing a mesh or with an empty list of nodes below it.
    pub(super) fn moved(&self, item: &Item<3>, replaced: &Replaced<3>, mesh: Option<usize>) -> String {
        let motion = &replaced.motion;
        let after = motion.after(&item.place);
        let extent = after.translation.0.iter().fold(self.reach * after.scale, |most, c| most.max(c.abs()));
        let mut parts = Vec::new();
        parts.extend(self.name.iter().map(|name| format!("\"name\":{name}")));
        parts.push(mesh.map_or_else(|| format!("{CHILDREN}]"), |mesh| format!("{MESH}{mesh}")));
        let translation = after.translation.0.map(|v| json_digits(v, extent));
        if translation.iter().any(|v| v != "0.0") {
            parts.push(format!("\"translation\":[{}]", translation.join(",")));
        }
        let own = self.rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |(q, _)| *q);
        let rotation = match &self.rotation {
            Some((_, text)) if motion.rotation == Matrix::identity() => text.clone(),
            _ => format!("[{}]", product(quaternion(&motion.rotation), own).map(|v| json_digits(v, 1.0)).join(",")),
        };
        if rotation != "[0.0,0.0,0.0,1.0]" {
            parts.push(format!("\"rotation\":{rotation}"));
        }
        let scale = match &self.scale {
            Some(text) if (motion.scale - 1.0).abs() < f64::EPSILON => text.clone(),
            _ => {
                let scale = json_digits(after.scale, after.scale);
                format!("[{scale},{scale},{scale}]")
            }
        };
        if scale != "[1.0,1.0,1.0]" {
            parts.push(format!("\"scale\":{scale}"));
        }
        parts.extend(self.extras.iter().map(|extras| format!("\"extras\":{extras}")));
        format!("{{{}}}", parts.join(","))
    }
}

/// How the lists of what is below a node, and the numbers of meshes, begin.
const CHILDREN: &str = "\"children\":[";
const MESH: &str = "\"mesh\":";

/// The text of a node, as arabesque writes it, with the nodes of these numbers below it.
pub(super) fn with_children(text: &str, children: Range<usize>) -> Option<String> {
    let (before, after) = text.split_once(CHILDREN)?;
    let (_, after) = after.split_once(']')?;
    let list: Vec<String> = children.map(|n| n.to_string()).collect();
    Some(format!("{before}{CHILDREN}{}]{after}", list.join(",")))
}

/// The text of a node, as arabesque writes it, with another mesh.
pub(super) fn with_mesh(text: &str, mesh: usize) -> Option<String> {
    let (before, after) = text.split_once(MESH)?;
    Some(format!("{before}{MESH}{mesh}{}", after.trim_start_matches(|c: char| c.is_ascii_digit())))
}

/// Where a node stands: `None` where that is not finite, or stretches.
pub(super) fn place(node: &NodeIn<'_>, text: &NodeText, most: f64) -> Option<Similarity<3>> {
    let scale = match &text.scale {
        None => 1.0,
        Some(text) => {
            let [x, y, z]: [f64; 3] = serde_json::from_str(text).ok()?;
            let is_even = (x - y).abs().max((x - z).abs()) <= 1e-6 * x.abs();
            Some(x).filter(|x| is_even && *x > 0.0 && *x <= most)?
        }
    };
    let translation = Vector(node.translation.unwrap_or([0.0; 3]));
    let rotation = text.rotation.as_ref().map_or_else(Matrix::identity, |(q, _)| matrix_of(*q));
    translation.0.iter().all(|v| v.abs() <= most).then_some(Similarity { rotation, scale, translation })
}

/// The rotation of `b` and then that of `a`, of the length of `b`; w is not negative.
fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let ([x, y, z, w], [p, q, r, s]) = (a, b);
    let product = [
        w * p + x * s + y * r - z * q,
        w * q - x * r + y * s + z * p,
        w * r + x * q - y * p + z * s,
        w * s - x * p - y * q - z * r,
    ];
    let largest = product.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0);
    let is_flipped = if product[3].abs() < 1e-12 { largest < 0.0 } else { product[3] < 0.0 };
    if is_flipped { product.map(|v| -v) } else { product }
}

/// The element that a node is, and its class.
pub(super) fn item(text: &NodeText, place: Similarity<3>, bounds: Bounds<3>) -> (Item<3>, String) {
    let extras: Value = text.extras.as_deref().and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    let named = extras["class"].as_str().map(str::to_owned);
    let name = || text.name.as_deref().and_then(|name| serde_json::from_str(name).ok());
    let class = named.or_else(name).unwrap_or_default();
    let source = extras["source"].as_u64().and_then(|n| usize::try_from(n).ok());
    let centre = place.apply(bounds.centre());
    let reach = 0.5 * bounds.size().norm() * place.scale;
    (Item { id: 0, class: 0, source, place, centre, reach, kept: false }, class)
}
