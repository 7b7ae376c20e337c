//! Files that hold scenes of meshes.

use arabesque_core::{Budget, Error, Result};
use arabesque_io::{
    file::{Beside, Folder, NothingBeside, decode_text},
    geometry::{Kind, kind_of},
    mesh::{
        gltf::{Scene, read_scene_beside},
        obj,
    },
};

use crate::{recipe::Input, resources::Files};

/// Whether a file may hold a scene of meshes: a GLB or glTF file, or an OBJ file with faces.
pub(crate) fn may_be_scene(name: &str, bytes: &[u8]) -> bool {
    match kind_of(name, bytes) {
        Some(Kind::Glb) => true,
        Some(Kind::Obj) => has_faces(bytes),
        _ => false,
    }
}

/// Whether a line of an OBJ file is a face.
fn has_faces(bytes: &[u8]) -> bool {
    bytes.split(|b| *b == b'\n').any(|line| matches!(line.trim_ascii_start(), [b'f', b' ' | b'\t', ..]))
}

/// The scene of a file; files that it names are looked for beside it.
///
/// # Errors
/// [`Error::Input`] for a file of another kind and for one that cannot be read.
pub(crate) fn scene_of(input: &Input, bytes: &[u8], files: &Files) -> Result<Scene> {
    let beside = files.path_of(input).map(|path| Folder::of(&path));
    let beside: &dyn Beside = beside.as_ref().map_or(&NothingBeside, |folder| folder);
    read(input.name(), bytes, beside, files.budget())
}

fn read(name: &str, bytes: &[u8], beside: &dyn Beside, budget: &Budget) -> Result<Scene> {
    match kind_of(name, bytes) {
        Some(Kind::Glb) => read_scene_beside(name, bytes, beside, budget),
        Some(Kind::Obj) => obj::read_scene(name, &decode_text(name, bytes, budget)?, beside, budget),
        _ => Err(Error::input(name, "no scene of meshes", "give a GLB, glTF or OBJ file")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_obj_file_is_a_scene_when_it_has_faces() {
        assert!(may_be_scene("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\n"));
        assert!(!may_be_scene("a.obj", b"v 0 0 0\nv 1 0 0\nl 1 2\n"));
        assert!(!may_be_scene("a.csv", b"x,y,z\n0,0,0\n"));
    }
}
