use arabesque_core::{Budget, Error, Limits, PointSet, Vector};
use proptest::prelude::*;

use super::{Encoding, PlyFile, read_ply, recipe_of, write_ply};
use crate::geometry::{Cloud, Geometry};

fn read(bytes: impl AsRef<[u8]>) -> arabesque_core::Result<Geometry> {
    read_ply("a.ply", bytes.as_ref(), &Budget::default())
}

fn space(geometry: &Geometry) -> &PointSet<3> {
    match &geometry.points {
        Cloud::Space(points) => points,
        Cloud::Plane(_) => panic!("there is a z"),
    }
}

fn messages(geometry: &Geometry) -> Vec<&str> {
    geometry.warnings.iter().map(|w| w.message.as_str()).collect()
}

const EVERYTHING: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty float y\nproperty short \
     z\nproperty float normal_x\nproperty float normal_y\nproperty float normal_z\nproperty uchar red\nproperty uchar \
     green\nproperty uchar blue\nproperty uchar alpha\nproperty float radius\nproperty int group\nproperty int \
     element\nend_header\n0.5 1 -2 0 0 1 255 0 51 255 0.25 3 -1\n1 2 3 1 0 0 0 0 0 0 0.5 4 0\n";

#[test]
fn every_attribute_is_read_and_what_says_nothing_is_told() {
    let geometry = read(EVERYTHING).unwrap();
    let points = space(&geometry);
    assert_eq!(points.positions, [Vector([0.5, 1.0, -2.0]), Vector([1.0, 2.0, 3.0])]);
    assert_eq!(points.normals.as_deref(), Some(&[Vector([0.0, 0.0, 1.0]), Vector([1.0, 0.0, 0.0])][..]));
    assert_eq!(points.colours.as_deref(), Some(&[[1.0, 0.0, 0.2], [0.0; 3]][..]));
    assert_eq!(points.radii.as_deref(), Some(&[0.25, 0.5][..]));
    assert_eq!((points.groups.as_deref(), points.elements.as_deref()), (Some(&[3, 4][..]), Some(&[-1, 0][..])));
    assert_eq!(messages(&geometry), ["a.ply: passed over: alpha"]);
}

#[test]
fn line_ends_of_every_system_and_points_of_the_plane_are_read() {
    for end in ["\n", "\r\n", "\r"] {
        let text =
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nend_header\n1 2\n\n3 4";
        let geometry = read(text.replace('\n', end)).unwrap();
        assert!(matches!(&geometry.points, Cloud::Plane(p) if p.positions[1] == Vector::xy(3.0, 4.0)));
    }
}

/// A big-endian file of one triangle: a list before the coordinates, an element between, and floats of eight bytes.
fn big_endian() -> Vec<u8> {
    let header = "ply\r\nformat binary_big_endian 1.0\r\nelement face 1\r\nproperty uchar flags\r\nproperty list ushort \
         uint vertex_index\r\nelement other 2\r\nproperty list int64 short numbers\r\nelement vertex 3\r\nproperty \
         list uchar double odd\r\nproperty double x\r\nproperty float y\r\nproperty short z\r\nend_header\r\n";
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend([7, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 0]);
    bytes.extend([0, 0, 0, 0, 0, 0, 0, 1, 9, 9]);
    bytes.extend([0; 8]);
    for k in 0..3_u8 {
        bytes.push(1);
        bytes.extend(9.0_f64.to_be_bytes());
        bytes.extend(f64::from(k).to_be_bytes());
        bytes.extend(f32::from(k * k).to_be_bytes());
        bytes.extend([0, k]);
    }
    bytes
}

#[test]
fn lists_and_other_elements_are_passed_over_in_binary() {
    let geometry = read(big_endian()).unwrap();
    assert_eq!(space(&geometry).positions[2], Vector([2.0, 4.0, 2.0]));
    assert_eq!(geometry.triangles, [[2, 1, 0]]);
    assert_eq!(messages(&geometry), ["a.ply: passed over: flags of face, element other, odd"]);
}

#[test]
fn whatever_is_missing_at_the_end_is_noticed() {
    let whole = big_endian();
    for end in 0..whole.len() {
        assert!(matches!(read(&whole[..end]), Err(Error::Input { .. })), "cut at {end}");
    }
    let more = read([&whole[..], b"xyz"].concat()).unwrap();
    assert!(messages(&more).contains(&"a.ply: 3 bytes behind the last element are passed over"));
}

fn with(header: &str, data: &str) -> String {
    format!("ply\nformat ascii 1.0\n{header}\nend_header\n{data}")
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z";

#[test]
fn bad_files_say_where_and_what() {
    let vertices = |count: &str, data: &str| with(&format!("element vertex {count}\n{XYZ}"), data);
    let faces = |list: &str, data: &str| {
        let header = format!("element vertex 3\n{XYZ}\nelement face 1\nproperty list {list} vertex_indices");
        with(&header, &format!("0 0 0\n1 0 0\n0 1 0\n{data}"))
    };
    for (text, expected) in [
        (vertices("0", ""), "no vertex; the elements are: vertex"),
        (with("element face 0\nproperty float x", ""), "no vertex; the elements are: face"),
        (vertices("3", "0 0 0\n0 0 1\n"), "3 rows of element vertex where there is room for 2 at most"),
        (vertices("99999999999999", "0 0 0\n"), "where there is room for 1 at most"),
        (vertices("2", "0 0 0\n1111 1\n"), "line 9: the line ends before z"),
        (vertices("2", "0 0 0\n1 1 1 1\n"), "line 9: more values than element vertex has"),
        (vertices("2", "0.00000 0.00000 0.00000"), "vertex 1, counted from 0: the file ends before x"),
        (vertices("1", "0 1,5 0\n"), "line 8: y is \"1,5\" where a number of type float was expected"),
        (vertices("1", "0 nan 0\n"), "line 8, property y: NaN where a coordinate between"),
        (vertices("1", "0 -inf 0\n"), "property y: -inf where"),
        (vertices("1", "0 1e10 0\n"), "property y: 10000000000 where"),
        (with("element vertex 1\nproperty float x", "1"), "no property y among x"),
        (
            with(&format!("element vertex 1\n{XYZ}\nproperty float radius"), "1 1 1 0"),
            "property radius: 0 where a radius",
        ),
        (with(&format!("element vertex 1\n{XYZ}\nproperty float group"), "1 1 1 0.5"), "property group: 0.5 where"),
        (with(&format!("element vertex 1\n{XYZ}\nproperty float nx"), "1 1 1 nan"), "property nx: NaN where"),
        (with(&format!("element vertex 1\n{XYZ}\nproperty int red"), "1 1 1 -4"), "property red: -4 where"),
        (faces("char int", "-1 0 1 2\n"), "line 13: a list vertex_indices of length -1"),
        (faces("int int", "1000000000 0 1 2\n"), "a list vertex_indices of length 1000000000 in a line"),
        (faces("int int", "4 0 1 2\n"), "the line ends before vertex_indices"),
        (faces("int int", "3 0 1 -2\n"), "line 13: vertex -2 where 0, 1, ... was expected"),
        (faces("int int", "3 0 1 3\n"), "face 0: vertex 3 where the vertices 0 to 2 are"),
        (faces("int float", "3 0 1 2\n"), "element face without a list of whole numbers"),
    ] {
        let message = read(&text).unwrap_err().to_string();
        assert!(message.contains(expected) && message.len() < 300, "{text:?}: {message}");
    }
}

#[test]
fn lengths_of_lists_are_checked_before_anything_is_made() {
    let header = format!("ply\nformat binary_little_endian 1.0\nelement vertex 3\n{XYZ}\nelement face 1\n");
    for (list, length) in
        [("int", &(-1_i32).to_le_bytes()), ("uint", &u32::MAX.to_le_bytes()), ("int", &4_i32.to_le_bytes())]
    {
        let mut bytes = format!("{header}property list {list} int vertex_indices\nend_header\n").into_bytes();
        bytes.extend([0; 36]);
        bytes.extend(length);
        bytes.extend([0; 12]);
        let message = read(&bytes).unwrap_err().to_string();
        assert!(message.contains("face 0, counted from 0: a list vertex_indices of length"), "{message}");
    }
}

#[test]
fn polygons_and_strips_become_triangles() {
    let square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let header = format!("element vertex 4\n{XYZ}\nelement face 2\nproperty list uchar int vertex_indices");
    let geometry = read(with(&header, &format!("{square}4 0 1 2 3\n2 0 1\n"))).unwrap();
    assert_eq!(geometry.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(messages(&geometry)[0].contains("1 faces of fewer than three"));
    let mesh = geometry.into_mesh("a.ply").unwrap();
    assert!(mesh.check("a.ply").is_ok() && mesh.double_area(0)[2] > 0.0);
    let header = format!("element vertex 4\n{XYZ}\nelement tristrips 1\nproperty list int int vertex_indices");
    let geometry = read(with(&header, &format!("{square}8 0 1 3 2 -1 1 2 3\n"))).unwrap();
    assert_eq!(geometry.triangles, [[0, 1, 3], [3, 1, 2], [1, 2, 3]]);
}

#[test]
fn limits_hold() {
    let text = with(&format!("element vertex 3\n{XYZ}"), "0 0 0\n1 1 1\n2 2 2\n");
    for limits in [
        Limits { nodes: 2, ..Limits::default() },
        Limits { memory: 20, ..Limits::default() },
        Limits { work: 0, ..Limits::default() },
    ] {
        let budget = Budget::new(limits);
        assert!(matches!(read_ply("a", text.as_bytes(), &budget), Err(Error::Limit { .. })), "{limits:?}");
    }
    let budget = Budget::new(Limits { memory: 20, ..Limits::default() });
    let points = PointSet::at(vec![Vector([0.0; 3]); 3]);
    assert!(matches!(write_ply(&PlyFile::of_points(&points), &budget), Err(Error::Limit { .. })));
}

/// Points of eighths and bytes, which come back as they are.
fn points() -> impl Strategy<Value = PointSet<3>> {
    let float = || (-8000..8000_i32).prop_map(|v| f64::from(v) / 8.0);
    let position = [float(), float(), float()].prop_map(Vector);
    let colour = prop::array::uniform3(any::<u8>()).prop_map(|c| c.map(|v| f64::from(v) / 255.0));
    let point =
        (position, 0..3_usize, colour, (1..99_i32).prop_map(|v| f64::from(v) / 8.0), any::<i32>(), any::<i32>());
    (prop::collection::vec(point, 1..20), any::<[bool; 6]>()).prop_map(|(list, has)| {
        let normal = |k: usize| Vector(std::array::from_fn(|axis| f64::from(u8::from(axis == k))));
        PointSet {
            positions: list.iter().map(|p| p.0).collect(),
            normals: has[0].then(|| list.iter().map(|p| normal(p.1)).collect()),
            colours: has[1].then(|| list.iter().map(|p| p.2).collect()),
            radii: has[2].then(|| list.iter().map(|p| p.3).collect()),
            groups: has[3].then(|| list.iter().map(|p| p.4).collect()),
            elements: has[4].then(|| list.iter().map(|p| p.5).collect()),
            classes: has[5].then(|| list.iter().map(|p| p.5 / 2).collect()),
        }
    })
}

proptest! {
    #[test]
    fn what_is_written_is_read_again(points in points(), text: bool, faces in 0..4_u32) {
        let count = points.len() as u32;
        let triangles: Vec<_> = (0..faces).filter(|_| count > 2).map(|k| [k, k + 1, k + 2].map(|v| v % count)).collect();
        let encoding = if text { Encoding::Text } else { Encoding::Binary };
        let file = PlyFile::of_points(&points).encoded(encoding).with_recipe(Some("seed = 1\n"));
        let bytes = write_ply(&file.with_triangles(&triangles), &Budget::default()).unwrap();
        prop_assert_eq!(recipe_of(&bytes), Some("seed = 1\n".to_owned()));
        let back = read(&bytes).unwrap();
        prop_assert_eq!(space(&back), &points);
        prop_assert_eq!(back.triangles, triangles);
        prop_assert!(back.warnings.is_empty());
    }
}
