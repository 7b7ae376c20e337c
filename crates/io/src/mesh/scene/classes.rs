//! Which elements are of one kind, by their names.

use std::collections::BTreeMap;

use super::model::Scene;

/// The classes of the nodes of a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Classes {
    /// Their names, in the order in which the nodes show them first.
    pub names: Vec<String>,
    /// Index into `names`, for each node.
    pub of_node: Vec<usize>,
}

impl Scene {
    /// The class of every node: what the file says it is ([`super::SceneNode::class`]); else the [`stem`] of its name; else that of
    /// the name of its mesh; else `mesh-` and the number of the mesh.
    pub fn classes(&self) -> Classes {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let mut classes = Classes::default();
        for node in &self.nodes {
            let mesh = self.meshes.get(node.mesh).map(|m| m.name.as_str()).unwrap_or_default();
            let said = node.class.as_deref().map(str::trim);
            let candidates = [said.unwrap_or_default(), stem(&node.name), stem(mesh)];
            let name = candidates.into_iter().find(|name| !name.is_empty());
            let name = name.map_or_else(|| format!("mesh-{}", node.mesh), str::to_owned);
            let number = *numbers.entry(name).or_insert_with_key(|name| {
                classes.names.push(name.clone());
                classes.names.len() - 1
            });
            classes.of_node.push(number);
        }
        classes
    }
}

/// A name without the number at its end, by which programs tell copies apart: `plum.001`, `plum_12`, `plum 3`, `plum-007` and `plum12`
/// are all `plum`. Upper and lower case stay as they are, and a name of digits alone is itself.
pub fn stem(name: &str) -> &str {
    let name = name.trim();
    let bare = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let bare = if bare.len() < name.len() { bare.trim_end_matches(['.', '_', '-', ' ']) } else { bare };
    if bare.is_empty() { name } else { bare }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Similarity, TriangleMesh};

    use super::*;
    use crate::mesh::scene::{SceneMesh, SceneNode};

    #[test]
    fn numbers_at_the_end_do_not_count() {
        for name in ["plum", "plum.001", "plum_12", "plum 3", "plum-007", "plum7", " plum . 12 ", "plum__3"] {
            assert_eq!(stem(name), "plum", "{name}");
        }
        for (name, expected) in [("7", "7"), ("12.5", "12"), ("a1b", "a1b"), ("", ""), ("Plum.1", "Plum"), ("x_", "x_")]
        {
            assert_eq!(stem(name), expected, "{name}");
        }
    }

    #[test]
    fn what_the_file_says_comes_before_names_and_nodes_before_meshes() {
        let node = |name: &str, mesh| SceneNode::new(name, mesh, Similarity::identity());
        let scene = Scene {
            meshes: ["bean", "bean.001", "", "7"].map(|n| SceneMesh::new(n, TriangleMesh::default())).to_vec(),
            nodes: vec![
                node("", 0),
                node("", 1),
                node("plum.1", 0),
                SceneNode { class: Some("bean".into()), ..node("plum.2", 2) },
                node("", 2),
                node("", 3),
            ],
            ..Scene::default()
        };
        let classes = scene.classes();
        assert_eq!(classes.names, ["bean", "plum", "mesh-2", "7"]);
        assert_eq!(classes.of_node, [0, 0, 1, 0, 2, 3]);
    }
}
