//! What `extras` say that arabesque understands: they may hold anything, so that whatever is otherwise is passed over.

use arabesque_core::{Bounds, Vector};
use serde_json::{Value, value::RawValue};

use crate::mesh::scene::{Scene, SceneNode};

/// Bytes of text that are looked at: more of them are something else than what is looked for.
const LONGEST: usize = 1 << 16;

/// A text of JSON as a value, where it is not too long.
pub(super) fn value_of(raw: &RawValue) -> Option<Value> {
    if raw.get().len() > LONGEST { None } else { serde_json::from_str(raw.get()).ok() }
}

/// What a scene says of itself: `box` as two corners, and `deformable` as names of classes.
pub(super) fn to_scene(raw: Option<&RawValue>, most: f64, scene: &mut Scene) {
    let Some(value) = raw.and_then(value_of) else { return };
    let corner = |k: usize| {
        let list = value.get("box")?.get(k)?.as_array().filter(|list| list.len() == 3)?;
        let fits = |v: &Value| v.as_f64().filter(|v| v.abs() <= most);
        Some(Vector([fits(&list[0])?, fits(&list[1])?, fits(&list[2])?]))
    };
    let corners = corner(0).zip(corner(1)).filter(|(a, b)| (0..3).all(|k| a[k] < b[k]));
    scene.frame = corners.map(|(min, max)| Bounds::new(min, max));
    let names = value.get("deformable").and_then(Value::as_array).into_iter().flatten();
    scene.deformable = names.filter_map(|name| name.as_str().map(str::to_owned)).collect();
}

/// Adds what a node says of itself: `class`, `id` and `source`. Gives whether it says that all below it is one element (`element`).
pub(super) fn to_node(raw: Option<&RawValue>, node: &mut SceneNode) -> bool {
    let Some(value) = raw.and_then(value_of) else { return false };
    node.class = value.get("class").and_then(Value::as_str).filter(|c| !c.trim().is_empty()).map(str::to_owned);
    let number = |key: &str| value.get(key).and_then(Value::as_u64);
    (node.id, node.source) = (number("id"), number("source"));
    value.get("element").and_then(Value::as_bool).unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(text: &str) -> Box<RawValue> {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn what_is_understood_is_taken_and_the_rest_passed_over() {
        let of_scene = |text: &str| {
            let mut scene = Scene::default();
            to_scene(Some(&raw(text)), 1e9, &mut scene);
            scene
        };
        let scene = of_scene(r#"{"box": [[0, 0, 0], [1, 2.5, 3]], "deformable": ["bag", 7], "x": []}"#);
        assert_eq!(scene.frame, Some(Bounds::new(Vector::ZERO, Vector([1.0, 2.5, 3.0]))));
        assert_eq!(scene.deformable, ["bag"]);
        for text in [
            "7",
            "[1]",
            r#"{"box": [[1, 0, 0], [0, 1, 1]]}"#,
            r#"{"box": [[0, 0], [1, 1]]}"#,
            r#"{"box": [[0, 0, 0], [1, 1, 1e10]]}"#,
        ] {
            assert_eq!(of_scene(text), Scene::default(), "{text}");
        }
        let mut node = SceneNode::default();
        to_node(Some(&raw(r#"{"class": "plum", "id": 7, "source": -1}"#)), &mut node);
        assert_eq!((node.class.as_deref(), node.id, node.source), (Some("plum"), Some(7), None));
        to_node(Some(&raw(&format!("{{\"class\": \"{}\"}}", "x".repeat(LONGEST)))), &mut node);
        assert_eq!(node.class.as_deref(), Some("plum"));
    }
}
