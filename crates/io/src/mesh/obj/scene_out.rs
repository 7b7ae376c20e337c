//! OBJ: scenes out, every element written anew, since the format has no copies.

use std::fmt::Write;

use arabesque_core::{Budget, Decimals, Result, Vector, Warning};

use super::mtl::{materials_text, word};
use crate::{
    mesh::scene::{Scene, SceneMesh, SceneNode},
    table::records,
};

/// Comment that files of scenes start with.
pub const SCENE_TITLE: &str = "# elements";
/// Work and bytes of one vertex or triangle.
const PER_LINE: u64 = 900;
const LINE_BYTES: usize = 100;

/// A scene as text.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjScene {
    /// The OBJ file.
    pub obj: String,
    /// The file of materials that it names, where it names one.
    pub mtl: Option<String>,
    /// What it does not hold.
    pub warnings: Vec<Warning>,
}

/// Writes a scene with an `o` for each element, called after its class and its number. With `mtl`, the name of a file beside it,
/// triangles have materials (`usemtl`), which that file holds; without, colours stand behind the places of vertices.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] for more triangles in all places than [`arabesque_core::Limits::nodes`] or when the work or the
/// memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to stop.
pub fn write_scene(scene: &Scene, mtl: Option<&str>, recipe: Option<&str>, budget: &Budget) -> Result<ObjScene> {
    let budget = budget.stage("writing OBJ");
    let nodes = || scene.nodes.iter().filter_map(|n| Some((n, scene.meshes.get(n.mesh)?)));
    let size = |m: &SceneMesh| m.mesh.triangles.len() + 3 * m.mesh.positions.len();
    let lines = nodes().fold(0_usize, |sum, (_, m)| sum.saturating_add(size(m)));
    budget.within("lines of all elements", lines, ("nodes", budget.limits().nodes.saturating_mul(4)))?;
    let _held = budget.hold("the text of the elements", lines.saturating_mul(LINE_BYTES))?;
    let materials = &scene.looks.materials;
    let names: Vec<String> = materials.iter().enumerate().map(|(k, m)| format!("{}_{k}", word(&m.name))).collect();
    let mtl = mtl.filter(|_| !materials.is_empty());
    let most = nodes().flat_map(|(n, _)| n.transform.translation.0).fold(1e-9_f64, |most, c| most.max(c.abs()));
    let place = Decimals::for_extent(most).plus(1);
    let mut writer =
        Writer { out: format!("{SCENE_TITLE}\n"), place, next: [1; 3], names: &names, has_mtl: mtl.is_some() };
    if let Some(mtl) = mtl {
        writer.out += &format!("mtllib {}\n", mtl.replace(['\n', '\r'], " "));
    }
    let classes = scene.classes();
    let mut counts = vec![0_usize; classes.names.len()];
    for (number, node) in scene.nodes.iter().enumerate() {
        let Some(mesh) = scene.meshes.get(node.mesh) else { continue };
        budget.spend(PER_LINE.saturating_mul(size(mesh) as u64))?;
        let class = classes.of_node[number];
        counts[class] += 1;
        let _ = writeln!(writer.out, "o {}.{:03}", word(&classes.names[class]), counts[class]);
        writer.element(node, mesh);
    }
    let mut warnings = Vec::new();
    let textured = materials.iter().filter(|m| !m.used_textures().is_empty()).count();
    if textured > 0 {
        let message = format!("an OBJ file holds no pictures: those of {textured} materials are left out");
        warnings.push(Warning::new(message, "write glb to keep them"));
    }
    if !scene.points.is_empty() {
        let message = format!("{} points beside the elements are left out", scene.points.len());
        warnings.push(Warning::new(message, "write glb to keep them"));
    }
    writer.out += &recipe.map(records::recipe_comments).unwrap_or_default();
    let mtl = mtl.map(|_| materials_text(names.iter().map(String::as_str).zip(materials)));
    Ok(ObjScene { obj: writer.out, mtl, warnings })
}

struct Writer<'a> {
    out: String,
    place: Decimals,
    /// Numbers of the next vertex, texture vertex and normal.
    next: [usize; 3],
    names: &'a [String],
    has_mtl: bool,
}

impl Writer<'_> {
    fn element(&mut self, node: &SceneNode, shape: &SceneMesh) {
        let mesh = &shape.mesh;
        let share = Decimals::for_extent(1.0);
        for (v, p) in mesh.positions.iter().enumerate() {
            let text = node.transform.apply(*p).0.map(|c| self.place.format(c)).join(" ");
            let colour = mesh.colours.as_ref().filter(|_| !self.has_mtl).map(|list| list[v].map(|c| share.format(c)));
            let _ = match colour {
                Some(colour) => writeln!(self.out, "v {text} {}", colour.join(" ")),
                None => writeln!(self.out, "v {text}"),
            };
        }
        for normal in mesh.normals.iter().flatten() {
            let turned: Vector<3> = node.transform.rotation.apply(*normal);
            let _ = writeln!(self.out, "vn {}", turned.0.map(|c| share.format(c)).join(" "));
        }
        let uv: Vec<[f32; 2]> = shape.primitives.iter().flat_map(|p| p.attributes.uv[0].iter().copied()).collect();
        let has_uv = uv.len() == mesh.positions.len();
        if has_uv {
            for [u, v] in &uv {
                let v = 1.0 - f64::from(*v);
                let _ = writeln!(self.out, "vt {} {}", share.format(f64::from(*u)), share.format(v));
            }
        }
        let [first, first_uv, first_normal] = self.next;
        let has_normals = mesh.normals.is_some();
        let corner = |v: u32| {
            let v = v as usize;
            match (has_uv, has_normals) {
                (true, true) => format!("{}/{}/{}", first + v, first_uv + v, first_normal + v),
                (true, false) => format!("{}/{}", first + v, first_uv + v),
                (false, true) => format!("{}//{}", first + v, first_normal + v),
                (false, false) => (first + v).to_string(),
            }
        };
        let mut runs = shape.primitives.iter().filter(|p| !p.triangles.is_empty()).peekable();
        for (k, triangle) in mesh.triangles.iter().enumerate() {
            if let Some(run) = runs.next_if(|run| run.triangles.start <= k)
                && let Some(name) = run.material.and_then(|m| self.names.get(m)).filter(|_| self.has_mtl)
            {
                let _ = writeln!(self.out, "usemtl {name}");
            }
            let _ = writeln!(self.out, "f {}", triangle.map(corner).join(" "));
        }
        let count = mesh.positions.len();
        self.next[0] += count;
        self.next[1] += if has_uv { count } else { 0 };
        self.next[2] += if has_normals { count } else { 0 };
    }
}
