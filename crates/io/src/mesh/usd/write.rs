//! Scenes as USD text: prototypes, their materials, and one instancer.

use std::fmt::Write;

use arabesque_core::{Budget, Decimals, Error, Result, Vector, Warning};

use super::names::{Names, quoted};
use crate::{
    mesh::scene::{Convention, Material, Scene, SceneMesh, Up, quaternion},
    table::records,
};

/// Work and bytes of one vertex or triangle, and of one place.
const PER_ROW: u64 = 900;
const ROW_BYTES: usize = 90;
const PLACE_BYTES: usize = 120;

/// Writes a scene whose coordinates are of the given convention, which the file says. Gives the text, and what it does not hold.
///
/// # Errors
/// [`Error::Input`] for nodes whose mesh does not exist; [`Error::Limit`] when the work or the memory is used up, [`Error::Stopped`]
/// when somebody asked to stop.
pub fn write_usda(
    scene: &Scene,
    convention: &Convention,
    recipe: Option<&str>,
    budget: &Budget,
) -> Result<(String, Vec<Warning>)> {
    let budget = budget.stage("writing USD");
    let rows: usize = scene.meshes.iter().map(|m| m.mesh.positions.len() + 2 * m.mesh.triangles.len()).sum::<usize>();
    let rows = rows + scene.points.len();
    let bytes = rows.saturating_mul(ROW_BYTES).saturating_add(scene.nodes.len().saturating_mul(PLACE_BYTES));
    let _held = budget.hold("the text of the scene", bytes)?;
    budget.spend(PER_ROW.saturating_mul((rows + scene.nodes.len()) as u64))?;
    let mut writer = Writer { out: String::new(), materials: Vec::new(), prototypes: Vec::new(), scene };
    let up = if convention.up == Up::Y { "Y" } else { "Z" };
    writer.out = format!(
        "#usda 1.0\n(\n    defaultPrim = \"Scene\"\n    metersPerUnit = {}\n    upAxis = \"{up}\"\n)\n\ndef Xform \"Scene\"\n{{\n",
        convention.metres_per_unit
    );
    writer.materials();
    let mut number_of = vec![None; scene.meshes.len()];
    for node in &scene.nodes {
        let Some(number) = number_of.get_mut(node.mesh) else {
            let problem = format!("mesh {} where there are {}", node.mesh, scene.meshes.len());
            return Err(Error::input(format!("node {} of the scene", node.name), problem, "remove the node"));
        };
        if number.is_none() && !scene.meshes[node.mesh].mesh.triangles.is_empty() {
            *number = Some(writer.prototypes.len());
            writer.prototypes.push(node.mesh);
        }
    }
    if !writer.prototypes.is_empty() {
        writer.instancer(&number_of);
    }
    writer.points();
    writer.out += "}\n";
    let mut text = writer.out;
    text += &recipe.map(records::recipe_comments).unwrap_or_default();
    let textured = scene.looks.materials.iter().filter(|m| !m.used_textures().is_empty()).count();
    let mut warnings = Vec::new();
    if textured > 0 {
        let message = format!("a USD text holds no pictures: those of {textured} materials are left out");
        warnings.push(Warning::new(message, "write glb to keep them"));
    }
    Ok((text, warnings))
}

struct Writer<'a> {
    out: String,
    /// Identifiers of the materials of the scene.
    materials: Vec<String>,
    /// Numbers of the meshes that stand somewhere.
    prototypes: Vec<usize>,
    scene: &'a Scene,
}

/// Numbers in brackets, separated by commas.
fn list<T>(items: impl IntoIterator<Item = T>, text: impl Fn(T) -> String) -> String {
    let items: Vec<String> = items.into_iter().map(text).collect();
    format!("[{}]", items.join(", "))
}

fn vector(v: [f64; 3], decimals: Decimals) -> String {
    let [x, y, z] = v.map(|c| decimals.format(c));
    format!("({x}, {y}, {z})")
}

fn decimals_of(points: impl Iterator<Item = Vector<3>>) -> Decimals {
    let most = points.flat_map(|p| p.0).fold(0.0_f64, |most, c| most.max(c.abs()));
    Decimals::for_extent(most).plus(1)
}

impl Writer<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        // Writing to a text does not fail.
        let _ = writeln!(self.out, "{:1$}{text}", "", 4 * depth);
    }

    fn materials(&mut self) {
        let scene = self.scene;
        if scene.looks.materials.is_empty() {
            return;
        }
        self.line(1, "def Scope \"Materials\"");
        self.line(1, "{");
        let mut names = Names::default();
        for material in &scene.looks.materials {
            let name = names.unique(&material.name, "material");
            self.material(&name, material);
            self.materials.push(name);
        }
        self.line(1, "}");
    }

    fn material(&mut self, name: &str, material: &Material) {
        let share = Decimals::for_extent(1.0);
        let [r, g, b, alpha] = material.base_colour;
        self.line(2, &format!("def Material \"{name}\""));
        self.line(2, "{");
        let surface = format!("token outputs:surface.connect = </Scene/Materials/{name}/Surface.outputs:surface>");
        self.line(3, &surface);
        self.line(3, "def Shader \"Surface\"");
        self.line(3, "{");
        self.line(4, "uniform token info:id = \"UsdPreviewSurface\"");
        self.line(4, &format!("color3f inputs:diffuseColor = {}", vector([r, g, b], share)));
        self.line(4, &format!("color3f inputs:emissiveColor = {}", vector(material.emissive, share)));
        for (input, value) in [("metallic", material.metallic), ("roughness", material.roughness), ("opacity", alpha)] {
            self.line(4, &format!("float inputs:{input} = {}", share.format(value)));
        }
        self.line(4, "token outputs:surface");
        self.line(3, "}");
        self.line(2, "}");
    }

    fn instancer(&mut self, number_of: &[Option<usize>]) {
        let scene = self.scene;
        let nodes = || scene.nodes.iter().filter_map(|n| Some((n, number_of[n.mesh]?)));
        let place = decimals_of(nodes().map(|(n, _)| n.transform.translation));
        let share = Decimals::for_extent(1.0);
        let half = |node: &crate::mesh::scene::SceneNode| {
            let [x, y, z, w] = quaternion(&node.transform.rotation).map(|v| share.format(v));
            format!("({w}, {x}, {y}, {z})")
        };
        self.line(1, "def PointInstancer \"Elements\"");
        self.line(1, "{");
        let positions = list(nodes(), |(n, _)| vector(n.transform.translation.0, place));
        self.line(2, &format!("point3f[] positions = {positions}"));
        self.line(2, &format!("quath[] orientations = {}", list(nodes(), |(n, _)| half(n))));
        let scales = list(nodes(), |(n, _)| {
            let scale = n.transform.scale;
            vector([scale; 3], Decimals::for_extent(scale))
        });
        self.line(2, &format!("float3[] scales = {scales}"));
        self.line(2, &format!("int[] protoIndices = {}", list(nodes(), |(_, number)| number.to_string())));
        let mut names = Names::default();
        let prototypes: Vec<(String, usize)> =
            self.prototypes.iter().map(|&number| (names.unique(&scene.meshes[number].name, "mesh"), number)).collect();
        let paths = list(&prototypes, |(name, _)| format!("</Scene/Elements/Prototypes/{name}>"));
        self.line(2, &format!("rel prototypes = {paths}"));
        self.line(2, "def Scope \"Prototypes\"");
        self.line(2, "{");
        for (name, number) in prototypes {
            self.mesh(&name, &scene.meshes[number]);
        }
        self.line(2, "}");
        self.line(1, "}");
    }

    fn mesh(&mut self, name: &str, shape: &SceneMesh) {
        let mesh = &shape.mesh;
        let place = decimals_of(mesh.positions.iter().copied());
        let share = Decimals::for_extent(1.0);
        let bound: Vec<_> =
            shape.primitives.iter().filter(|p| p.material.is_some_and(|m| m < self.materials.len())).collect();
        let schemas = if bound.is_empty() { "" } else { "    prepend apiSchemas = [\"MaterialBindingAPI\"]" };
        self.line(3, &format!("def Mesh \"{name}\" ("));
        self.line(3, &format!("    displayName = {}", quoted(&shape.name)));
        if !schemas.is_empty() {
            self.line(3, schemas);
        }
        self.line(3, ")");
        self.line(3, "{");
        self.line(4, "uniform token subdivisionScheme = \"none\"");
        self.line(4, &format!("int[] faceVertexCounts = {}", list(&mesh.triangles, |_| "3".into())));
        self.line(4, &format!("int[] faceVertexIndices = {}", list(mesh.triangles.iter().flatten(), u32::to_string)));
        self.line(4, &format!("point3f[] points = {}", list(&mesh.positions, |p| vector(p.0, place))));
        let bounds = mesh.bounds();
        self.line(4, &format!("float3[] extent = {}", list([bounds.min, bounds.max], |p| vector(p.0, place))));
        if let Some(normals) = &mesh.normals {
            let normals = list(normals, |n| vector(n.0, share));
            self.line(4, &format!("normal3f[] normals = {normals} (interpolation = \"vertex\")"));
        }
        if let Some(colours) = &mesh.colours {
            let light = list(colours, |c| vector(c.map(crate::mesh::colour::linear), share));
            self.line(4, &format!("color3f[] primvars:displayColor = {light} (interpolation = \"vertex\")"));
        }
        let uv: Vec<[f32; 2]> = shape.primitives.iter().flat_map(|p| p.attributes.uv[0].iter().copied()).collect();
        if uv.len() == mesh.positions.len() {
            // Up is the other way there.
            let uv =
                list(&uv, |[u, v]| format!("({}, {})", share.format(f64::from(*u)), share.format(1.0 - f64::from(*v))));
            self.line(4, &format!("texCoord2f[] primvars:st = {uv} (interpolation = \"vertex\")"));
        }
        self.bindings(shape);
        self.line(3, "}");
    }

    /// The materials of a mesh: one for all of it, or one for each run of triangles.
    fn bindings(&mut self, shape: &SceneMesh) {
        let path = |this: &Self, material: Option<usize>| {
            let name = this.materials.get(material?)?;
            Some(format!("rel material:binding = </Scene/Materials/{name}>"))
        };
        if let [only] = &shape.primitives[..] {
            if let Some(binding) = path(self, only.material) {
                self.line(4, &binding);
            }
            return;
        }
        if !shape.primitives.is_empty() {
            self.line(4, "uniform token subsetFamily:materialBind:familyType = \"nonOverlapping\"");
        }
        for (k, primitive) in shape.primitives.iter().enumerate() {
            let Some(binding) = path(self, primitive.material) else { continue };
            self.line(4, &format!("def GeomSubset \"subset_{k}\" (prepend apiSchemas = [\"MaterialBindingAPI\"])"));
            self.line(4, "{");
            self.line(5, "uniform token elementType = \"face\"");
            self.line(5, "uniform token familyName = \"materialBind\"");
            self.line(5, &format!("int[] indices = {}", list(primitive.triangles.clone(), |n| n.to_string())));
            self.line(5, &binding);
            self.line(4, "}");
        }
    }

    fn points(&mut self) {
        let points = &self.scene.points;
        if points.is_empty() {
            return;
        }
        let place = decimals_of(points.positions.iter().copied());
        let share = Decimals::for_extent(1.0);
        self.line(1, "def Points \"Points\"");
        self.line(1, "{");
        self.line(2, &format!("point3f[] points = {}", list(&points.positions, |p| vector(p.0, place))));
        if let Some(radii) = &points.radii {
            let widths = list(radii, |r| Decimals::for_extent(2.0 * r).format(2.0 * r));
            self.line(2, &format!("float[] widths = {widths}"));
        }
        if let Some(colours) = &points.colours {
            let light = list(colours, |c| vector(c.map(crate::mesh::colour::linear), share));
            self.line(2, &format!("color3f[] primvars:displayColor = {light} (interpolation = \"vertex\")"));
        }
        self.line(1, "}");
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Matrix, Similarity, TriangleMesh};

    use super::*;
    use crate::mesh::scene::{Looks, Primitive, SceneNode};

    #[test]
    fn elements_are_one_instancer_of_their_prototypes() {
        let mesh = TriangleMesh {
            positions: vec![Vector([0.0; 3]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 0.5, 0.0])],
            triangles: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        let primitive = Primitive { triangles: 0..1, vertices: 0..3, material: Some(0), ..Primitive::default() };
        let shape = SceneMesh { primitives: vec![primitive], ..SceneMesh::new("plum \"x\"", mesh) };
        let turned = Similarity {
            rotation: Matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            scale: 2.0,
            translation: Vector([1.5, 0.0, -3.0]),
        };
        let scene = Scene {
            meshes: vec![SceneMesh::default(), shape],
            nodes: vec![SceneNode::new("a", 1, Similarity::identity()), SceneNode::new("b", 1, turned)],
            looks: Looks {
                materials: vec![Material { name: "skin 1".into(), ..Material::default() }],
                ..Looks::default()
            },
            ..Scene::default()
        };
        let convention = Convention { up: Up::Z, metres_per_unit: 0.01 };
        let (text, warnings) = write_usda(&scene, &convention, Some("seed = 1\n"), &Budget::default()).unwrap();
        assert!(warnings.is_empty());
        for line in [
            "#usda 1.0\n",
            "metersPerUnit = 0.01\n    upAxis = \"Z\"",
            "point3f[] positions = [(0, 0, 0), (1.5, 0, -3)]",
            "quath[] orientations = [(1, 0, 0, 0), (0.707107, 0, 0, 0.707107)]",
            "float3[] scales = [(1, 1, 1), (2, 2, 2)]",
            "int[] protoIndices = [0, 0]",
            "rel prototypes = [</Scene/Elements/Prototypes/plum__x_>]",
            "displayName = \"plum \\\"x\\\"\"",
            "int[] faceVertexIndices = [0, 1, 2]",
            "rel material:binding = </Scene/Materials/skin_1>",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
        assert_eq!(records::recipe_of(&text).as_deref(), Some("seed = 1\n"));
    }
}
