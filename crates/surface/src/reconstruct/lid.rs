//! Closed surfaces stay closed when a mesh trims them: the cut gets a lid along that mesh.
//!
//! What is inside of the surface and of the mesh is where the larger of two functions is negative: that of the surface, and the distance
//! to the mesh. Near the mesh the larger one takes the place of the first, and the surface is marched again; away from it all stays as it
//! was. The rim of the lid is as sharp as a cell.

use arabesque_core::{Bounds, Budget, Result, TriangleMesh, Vector};

use crate::{
    implicit::{BLOCK, Blocks, Field, Node, SIDE},
    isosurface::Patch,
    mesh::MeshIndex,
};

/// What is told of nodes that are farther inside or outside than anything known, in cells.
const FAR: f32 = 4.0;
/// Up to this value, in cells, the function of the surface is trusted as it is.
const SURE: f32 = 1.75;
/// Cells around a block that count as near to the mesh.
const AROUND: f64 = 2.0;

/// Whether each edge has a triangle on both of its sides.
pub(super) fn is_closed(patch: &Patch) -> bool {
    let mut sides: Vec<(u32, u32)> = patch
        .triangles
        .iter()
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    sides.sort_unstable();
    !sides.is_empty() && sides.chunk_by(|a, b| a == b).all(|along| along.len() % 2 == 0)
}

/// The field of what is inside of `trim` too; `surface` is the closed surface of `field`. `None` where the mesh does not come near.
pub(super) fn trimmed(field: &Field, surface: &Patch, trim: &MeshIndex, budget: &Budget) -> Result<Option<Field>> {
    let mesh = TriangleMesh {
        positions: surface.vertices.iter().map(|v| v.at).collect(),
        triangles: surface.triangles.clone(),
        ..TriangleMesh::default()
    };
    let index = MeshIndex::new(&mesh, "the surface", budget)?;
    let near = near(&field.blocks, &index, trim, budget)?;
    if near.is_empty() {
        return Ok(None);
    }
    let is_near = |place: &[u64; 3]| near.binary_search(place).is_ok();
    let half = 0.5 * SIDE as f64 * field.blocks.cell;
    let far: Vec<[u64; 3]> = (0..field.blocks.len()).map(|b| field.blocks.place(b)).filter(|p| !is_near(p)).collect();
    let middles: Vec<_> = far.iter().map(|p| field.blocks.corner_at(*p) + Vector::splat(half)).collect();
    let stays = trim.inside_all(&middles, budget)?;
    let places = far.iter().zip(stays).filter(|(_, stays)| *stays).map(|(p, _)| *p).chain(near.iter().copied());
    let blocks = field.blocks.of_places(places.collect(), budget)?;
    let evaluate = |blocks: &Blocks, block: usize, nodes: &mut [Node], colours: &mut [[f32; 3]]| {
        let place = blocks.place(block);
        if let Some(own) = field.blocks.at(place) {
            nodes.copy_from_slice(&field.nodes[own * BLOCK..(own + 1) * BLOCK]);
            if !colours.is_empty() {
                colours.copy_from_slice(&field.colours[own * BLOCK..(own + 1) * BLOCK]);
            }
        }
        if !is_near(&place) {
            return Ok(());
        }
        budget.spend(BLOCK as u64 * 500)?;
        for (n, node) in nodes.iter_mut().enumerate() {
            let step = Vector([n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)].map(|c| c as f64));
            let at = blocks.corner(block) + step * blocks.cell;
            if node.value.is_nan() || node.value.abs() > SURE {
                let is_inside = index.is_inside(at);
                if node.value.is_nan() || (node.value < 0.0) != is_inside {
                    node.value = if is_inside { -FAR } else { FAR };
                }
                if let Some(colour) = colours.get_mut(n).filter(|c| **c == [0.0; 3]) {
                    let corner = mesh.triangles[index.closest(at).triangle][0];
                    *colour = surface.vertices[corner as usize].colour;
                }
            }
            cut_off(node, at, trim, blocks.cell);
        }
        Ok(())
    };
    Field::new(blocks, field.elsewhere, !field.colours.is_empty(), budget, evaluate).map(Some)
}

/// Takes the distance to the mesh where that is larger than the value of a node.
fn cut_off(node: &mut Node, at: Vector<3>, trim: &MeshIndex, cell: f64) {
    let closest = trim.closest(at);
    let is_inside = trim.is_inside(at);
    let distance = (closest.distance / cell) as f32;
    let value = if is_inside { -distance } else { distance };
    if value > node.value {
        let towards = if is_inside { closest.point - at } else { at - closest.point };
        let outwards = towards.unit_if_longer(1e-6 * cell).unwrap_or(closest.normal);
        *node = Node { value, gradient: outwards.0.map(|c| c as f32), beyond: 0.0 };
    }
}

/// Places of the blocks near both the mesh and what the surface encloses, in rising order.
fn near(blocks: &Blocks, surface: &MeshIndex, trim: &MeshIndex, budget: &Budget) -> Result<Vec<[u64; 3]>> {
    let side = SIDE as f64 * blocks.cell;
    let bounds = surface.bounds().grown(AROUND * blocks.cell);
    let count = bounds.max - blocks.origin;
    let most = count.0.iter().map(|c| (c / side).max(0.0).ceil() as u64 + 1).max().unwrap_or(1);
    let mut open = vec![([0_u64; 3], most.next_power_of_two())];
    let mut found = Vec::new();
    while let Some((place, size)) = open.pop() {
        budget.spend(5_000)?;
        let low = blocks.corner_at(place);
        let cube = Bounds::new(low, low + Vector::splat(side * size as f64));
        let reach = 0.5 * cube.size().norm() + AROUND * blocks.cell;
        let middle = cube.centre();
        if trim.closest_within(middle, reach).is_none()
            || surface.closest_within(middle, reach).is_none() && !surface.is_inside(middle)
        {
            continue;
        }
        if size == 1 {
            found.push(place);
            budget.within(
                "blocks of cells along the mesh that trims",
                found.len(),
                ("nodes", budget.limits().nodes),
            )?;
            continue;
        }
        let half = size / 2;
        open.extend((0..8_u64).map(|k| (std::array::from_fn(|axis| place[axis] + (k >> axis & 1) * half), half)));
    }
    found.sort_unstable();
    Ok(found)
}
