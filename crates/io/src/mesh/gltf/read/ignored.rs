//! What a glTF file holds beyond meshes, points and how they look: told in one warning.

use arabesque_core::Warning;

use super::document::Document;

/// Modes of lines in the format.
const LINES: std::ops::RangeInclusive<u32> = 1..=3;

/// One warning that counts what is left out, and one about other scenes.
pub(super) fn warnings(name: &str, document: &Document) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let primitives = || document.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let counts = [
        (document.nodes.iter().filter(|n| n.camera.is_some()).count(), "camera", "cameras"),
        (document.nodes.iter().filter(|n| n.extensions.light.is_some()).count(), "light", "lights"),
        (document.animations.len(), "animation", "animations"),
        (document.nodes.iter().filter(|n| n.skin.is_some()).count(), "skin", "skins"),
        (primitives().map(|p| p.targets.len()).sum(), "morph target", "morph targets"),
        (
            primitives().filter(|p| p.mode.is_some_and(|mode| LINES.contains(&mode))).count(),
            "primitive of lines",
            "primitives of lines",
        ),
    ];
    let found: Vec<String> = counts
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
        .collect();
    if !found.is_empty() {
        let message = format!("{name}: left out: {}; meshes are read as they rest", found.join(", "));
        warnings.push(Warning::new(message, "apply skins and morph targets before saving, if they matter"));
    }
    if document.scenes.len() > 1 {
        let shown = document.scene.unwrap_or(0);
        let called = document.scenes.get(shown).and_then(|s| s.name.as_deref()).map(crate::text::short::short);
        let called = called.map_or_else(|| format!("number {shown}"), |called| format!("\"{called}\""));
        let message = format!("{name}: {} scenes, of which {called} is read", document.scenes.len());
        warnings.push(Warning::new(message, "save the scene that is meant alone"));
    }
    warnings
}
