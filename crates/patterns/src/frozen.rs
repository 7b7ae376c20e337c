//! What the user drew, as the engine sees it.

use std::sync::Arc;

use arabesque_core::{Bounds, Matrix, Measured, Numbered, Path, Request, Result, Vector};

use crate::{
    exemplar::{
        graph::{line::Line, net::Net, skeleton::Skeleton},
        level_exemplar::LevelExemplar,
        library::Library,
    },
    output::draft::{Draft, Frozen, Item, Items},
};
/// A frozen stroke that ends this near to the border of the domain goes on inside, as a share of the side of the
/// exemplar.
const NEAR_BORDER: f64 = 2e-3;

/// Frozen elements and samples of frozen strokes.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn draft<const D: usize>(request: &Request<D>, sampled: &LevelExemplar<D>) -> Result<Draft<D>> {
    let mut draft = Draft { items: elements(request, &sampled.library), links: Vec::new() };
    if let Some(net) = &sampled.level.net {
        strokes(request, sampled, net, &mut draft)?;
    }
    Ok(draft)
}

fn elements<const D: usize>(request: &Request<D>, library: &Library<D>) -> Items<D> {
    let one = |(n, placement): (usize, &arabesque_core::Placement<D>)| {
        let source = placement.source as u32;
        let position = placement.transform.apply(library.centre[placement.source]);
        let frame = request.fields.frame(position);
        let turn = frame.rotation.transpose().compose(&placement.transform.rotation);
        (Item { source, position, frozen: Some(Frozen::Element(n as u32)) }, turn)
    };
    request.frozen.iter().enumerate().map(one).collect()
}

/// Samples the frozen strokes near the domain as densely as the exemplar.
fn strokes<const D: usize>(
    request: &Request<D>,
    sampled: &LevelExemplar<D>,
    net: &Net<D>,
    draft: &mut Draft<D>,
) -> Result<()> {
    if request.frozen_curves.is_empty() {
        return Ok(());
    }
    let budget = request.budget.stage("sampling what is kept");
    let mut meter = budget.meter();
    let scale = request.fields.frame(request.domain.bounds().centre()).spacing_scale;
    let side = sampled.library.view.side();
    let ends = request.frozen_curves.iter().flat_map(|drawn| drawn.path.cubics.iter().flat_map(|c| [c[0], c[3]]));
    let frame = Bounds::around(ends);
    let lines = request.frozen_curves.iter().enumerate().map(|(n, drawn)| {
        let curve = &sampled.exemplar.curves[drawn.source];
        let mut line = line(n as u32, drawn.path.clone(), curve.width * drawn.scale, 5e-4 * side);
        let near = line.width.max(NEAR_BORDER * side);
        // At the border of the domain, and at the frame of what was drawn, strokes are cut off rather than ended.
        let on_border =
            |p: Vector<D>| request.domain.signed_distance(p).abs() <= near || frame.signed_distance(p).abs() <= near;
        line.is_cut = [drawn.path.start(), drawn.path.end()].map(|p| p.is_some_and(on_border));
        line
    });
    let skeleton = Arc::new(Skeleton::of_lines(lines.collect(), side, &budget)?);
    let drawn = Net::new(&skeleton, net.spacing * scale, &budget)?;
    // Farther out nothing sees them.
    let reach = 2.0 * sampled.level.radius * scale;
    let mut item_of = Numbered::filled(None, drawn.nodes.len());
    for (n, node) in (0..).zip(&drawn.nodes) {
        if request.domain.signed_distance(node.position) < -reach {
            continue;
        }
        let ways = drawn.directions(n);
        let style = request.frozen_curves[node.curve as usize].source;
        meter.spend(80 * net.nodes.len() as u64)?;
        let source = alike(sampled, net, &ways, sampled.exemplar.curves[style].style);
        item_of[n] = Some(draft.items.len() as u32);
        let item = Item { source: sampled.level.base + source, position: node.position, frozen: Some(Frozen::Stroke) };
        draft.items.push((item, Matrix::identity()));
    }
    for (n, node) in (0..).zip(&drawn.nodes) {
        for arm in node.arms.iter().filter(|arm| arm.to > n) {
            if let (Some(a), Some(b)) = (item_of[n], item_of[arm.to]) {
                draft.links.push((a, b));
            }
        }
    }
    Ok(())
}

fn line<const D: usize>(number: u32, path: Path<D>, width: f64, tolerance: f64) -> Line<D> {
    Line { measured: Measured::new(path, tolerance), curve: number, width, is_cut: [false; 2], stops: Vec::new() }
}

/// The node of the exemplar whose strokes leave it most alike; one of the same style where there is any.
fn alike<const D: usize>(sampled: &LevelExemplar<D>, net: &Net<D>, ways: &[Vector<D>], style: usize) -> u32 {
    let misfit = |n: u32| -> f64 {
        let node = &net.nodes[n];
        let own = net.directions(n);
        let nearest = |w: &Vector<D>| own.iter().map(|t| 1.0 - t.dot(*w)).fold(2.0, f64::min);
        let other = if sampled.exemplar.curves[node.curve as usize].style == style { 0.0 } else { 100.0 };
        ways.iter().map(nearest).sum::<f64>() + 0.3 * (own.len() as f64 - ways.len() as f64).abs() + other
    };
    let nodes = 0..net.nodes.len() as u32;
    nodes.map(|n| (misfit(n), n)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map_or(0, |b| b.1)
}
