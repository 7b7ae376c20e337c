//! Whether triangles make a manifold.

use std::collections::BTreeMap;

/// Every edge has at most two triangles, which run through it in opposite directions, and the triangles around a vertex make one fan.
pub(crate) fn assert_manifold(triangles: &[[u32; 3]], vertices: usize) -> usize {
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    let mut around: Vec<Vec<(u32, u32)>> = vec![Vec::new(); vertices];
    for t in triangles {
        for k in 0..3 {
            let [a, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            assert!(a != b);
            *edges.entry((a, b)).or_default() += 1;
            around[a as usize].push((b, c));
        }
    }
    assert!(edges.values().all(|&n| n == 1), "an edge is run through twice in one direction");
    for (v, wings) in around.iter().enumerate() {
        // From the wing that no other one leads to, or any, on as long as wings follow.
        let follows = |b: u32| wings.iter().find(|w| w.0 == b);
        let start = wings.iter().find(|w| !wings.iter().any(|o| o.1 == w.0)).or(wings.first());
        let (mut count, mut at) = (0, start);
        while let Some(wing) = at {
            count += 1;
            at = follows(wing.1).filter(|w| Some(*w) != start);
            assert!(count <= wings.len());
        }
        assert_eq!(count, wings.len(), "vertex {v} has several fans");
        assert!(count > 0, "vertex {v} has no triangle");
    }
    edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).count()
}

/// The same, without open edges.
pub(crate) fn assert_closed(triangles: &[[u32; 3]], vertices: usize) {
    assert_eq!(assert_manifold(triangles, vertices), 0, "open edges");
}
