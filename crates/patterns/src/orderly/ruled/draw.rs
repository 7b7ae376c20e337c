//! Steps joined to lines.

use arabesque_core::{Budget, Drawn, Path, Result, Vector, straight};

use crate::{
    orderly::ruled::{
        net::Net,
        star::{WAYS, beside, opposite},
    },
    repeat::lattice::Node,
};

/// Work for each node.
const WORK: u64 = 100;

/// The lines of a net: straight on through nodes where they can, around corners where nothing else is there.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn lines(net: &Net<'_>, budget: &Budget) -> Result<Vec<Drawn<2>>> {
    let next: Vec<[Option<u8>; 8]> = (0..net.nodes.len()).map(|k| pairs(net, k)).collect();
    let mut is_drawn = vec![[false; 8]; net.nodes.len()];
    let mut made = Vec::new();
    // Lines with ends first: what is left closes.
    for needs_end in [true, false] {
        for k in 0..net.nodes.len() {
            budget.spend(WORK)?;
            for way in 0..8 {
                let curve = net.stars[k].steps[way].unwrap_or(0);
                let far = beside(net.nodes[k], way);
                let start = match (needs_end, net.number(far)) {
                    (true, None) => (far, opposite(way)),
                    (true, Some(_)) if next[k][way].is_some() => continue,
                    _ => (net.nodes[k], way),
                };
                if curve > 0 && !is_drawn[k][way] {
                    made.push(line(net, &next, (start, curve), &mut is_drawn));
                }
            }
        }
    }
    Ok(made)
}

/// For each step at a node the one with which its line goes on.
fn pairs(net: &Net<'_>, k: usize) -> [Option<u8>; 8] {
    let style = |way: usize| {
        let curve = net.stars[k].steps[way].unwrap_or(0);
        if curve == 0 { 0 } else { net.sheet.styles[curve as usize - 1] }
    };
    let mut next = [None; 8];
    for way in 0..4 {
        if style(way) > 0 && style(way) == style(way + 4) {
            (next[way], next[way + 4]) = (Some(way as u8 + 4), Some(way as u8));
        }
    }
    let left: Vec<usize> = (0..8).filter(|&way| style(way) > 0 && next[way].is_none()).collect();
    if let [a, b] = left[..]
        && style(a) == style(b)
    {
        (next[a], next[b]) = (Some(b as u8), Some(a as u8));
    }
    next
}

/// The line that begins with a step, at a node that may lie beyond the net, and is drawn as a curve.
fn line(
    net: &Net<'_>,
    next: &[[Option<u8>; 8]],
    (first, curve): ((Node, usize), u32),
    is_drawn: &mut [[bool; 8]],
) -> Drawn<2> {
    let (mut node, mut way) = first;
    let mut path = vec![node];
    let mut closed = false;
    loop {
        if let Some(k) = net.number(node) {
            is_drawn[k][way] = true;
        }
        if let [.., a, b] = path[..]
            && [b[0] - a[0], b[1] - a[1]].map(i64::signum) == WAYS[way]
        {
            path.pop();
        }
        node = beside(node, way);
        path.push(node);
        let Some(there) = net.number(node) else { break };
        is_drawn[there][opposite(way)] = true;
        let Some(on) = next[there][opposite(way)] else { break };
        way = on as usize;
        if is_drawn[there][way] {
            closed = (node, way) == first;
            break;
        }
    }
    let places: Vec<Vector<2>> = path.iter().map(|&n| net.grid.place(net.sheet.origin, n)).collect();
    let cubics = places.windows(2).map(|pair| straight(pair[0], pair[1])).collect();
    Drawn { path: Path { cubics, closed }, source: curve as usize - 1, scale: net.grid.scale(), frozen: None }
}
