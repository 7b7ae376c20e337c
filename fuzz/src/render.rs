//! Draws points and meshes made of bytes, from any side.
#![no_main]

use arabesque_core::{Budget, PointSet, TriangleMesh, Vector};
use arabesque_fuzz::limits;
use arabesque_io::render::{Background, Extent, Item, Look, View, draw};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let [angle, size, flags, rest @ ..] = data else { return };
    let view = View { azimuth: f64::from(*angle) * 3.0, elevation: f64::from(*size) * 0.7 - 90.0 };
    let mut words = rest.chunks_exact(4).map(|w| f32::from_le_bytes([w[0], w[1], w[2], w[3]]));
    let mut number = || words.next().map(f64::from).filter(|v| v.abs() <= 1e9);
    let mut positions = Vec::new();
    while let (Some(x), Some(y), Some(z)) = (number(), number(), number()) {
        positions.push(Vector([x, y, z]));
    }
    let count = positions.len();
    let corner = |k: usize| (k * 7 + usize::from(*flags)) % count;
    let triangles = (0..count).map(|k| [k, corner(k), corner(k + 1)].map(|v| v as u32)).collect();
    let mut points = PointSet::at(positions.clone());
    points.radii = (flags & 1 > 0).then(|| positions.iter().map(|p| p[0].abs() + 1e-3).collect());
    points.normals = (flags & 2 > 0).then(|| positions.iter().map(|p| p.unit_or_zero()).collect());
    points.elements = (flags & 4 > 0).then(|| (0..count as i32).collect());
    let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
    let background = if flags & 8 > 0 { Background::Transparent } else { Background::White };
    let side = usize::from(*size) / 4 + 1;
    let look = Look { view: Some(view), extent: Extent::Longer(side), background };
    let items = [Item::Points(&points), Item::Mesh(&mesh)];
    let items = match flags >> 6 {
        0 => &items[..1],
        1 => &items[1..],
        _ => &items[..],
    };
    if let Ok(image) = draw(items, &look, &Budget::new(limits())) {
        assert_eq!((image.pixels.len(), image.width.max(image.height)), (image.width * image.height, side));
    }
});
