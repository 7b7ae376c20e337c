//! Friezes of all seven groups: named, and continued along themselves.

use arabesque_core::{Bounds, Budget, Domain, Request, Vector};
use arabesque_patterns::repeat::{Extent, Symmetry, symmetry};

use crate::{
    drawing::{Motif, Pattern, Piece, xy},
    measure::{TOLERANCE, assert_same, centres, expected, hausdorff, page, prepared, run},
};

/// A flag with its pole at the origin.
const FLAG: [[f64; 2]; 5] = [[0.0, 0.0], [0.06, 0.0], [0.06, 0.2], [0.2, 0.25], [0.0, 0.32]];

/// Signs of x and y, and a shift along the frieze, of each copy of the motif in a period of 1.
fn copies(name: &str) -> &'static [[f64; 3]] {
    match name {
        "p1" => &[[1.0, 1.0, 0.0]],
        "p11g" => &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.5]],
        "p1m1" => &[[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        "p2" => &[[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        "p2mg" => &[[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.5], [1.0, -1.0, 0.5]],
        "p11m" => &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]],
        _ => &[[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0]],
    }
}

const NAMES: [&str; 7] = ["p1", "p11g", "p1m1", "p2", "p2mg", "p11m", "p2mm"];

/// A frieze between y = -0.5 and 0.5. The second vector is far away: there is one row.
fn frieze(name: &str, stroke: bool) -> Pattern {
    let ring = |[x, y, shift]: [f64; 3]| -> Vec<Vector<2>> {
        FLAG.iter().map(|p| xy(x * (p[0] + 0.09) + shift, y * (p[1] + 0.07))).collect()
    };
    let vectors = [xy(1.0, 0.0), xy(0.0, 100.0)];
    let rings = copies(name).iter().map(|c| ring(*c));
    if stroke {
        Pattern::of_pieces(vectors, rings.map(|points| Piece { points, style: 0 }).collect())
    } else {
        Pattern::of_motifs(vectors, rings.map(|ring| Motif { ring, class: 0 }).collect())
    }
}

fn check(name: &str, stroke: bool, scale: f64, periods: f64) {
    let pattern = frieze(name, stroke).scaled(scale);
    // Somewhat off the middle: nothing says where the axis is.
    let window = Bounds::new(xy(-0.37, -0.52) * scale, xy(periods - 0.37, 0.48) * scale);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, name);
    let repeat = prepared.repeat().unwrap();
    assert_eq!(repeat.extent, Extent::Frieze, "{name}");
    let step = repeat.step(&window).unwrap();
    assert!((step - xy(scale, 0.0)).norm() < 1e-3 * scale, "{name}: {step:?}");
    let found = symmetry(&exemplar, repeat, &Budget::default()).unwrap();
    assert!(matches!(found, Symmetry::Frieze(_)) && found.name() == name, "{name}: taken for {found}");
    let page = page(11.3 * scale, scale);
    let by = page.min - window.min;
    for seed in 0..2 {
        let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
        if stroke {
            let off = hausdorff(&pattern, &exemplar, &outcome, by, &page);
            assert!(off <= TOLERANCE * scale, "{name}: strokes {:.4} of a period off", off / scale);
        } else {
            let wanted = expected(&pattern, by, &page);
            let found = centres(&exemplar, &outcome);
            assert_same(&found, &wanted, 0.3 * TOLERANCE * scale, |p| page.contains(p), name);
        }
    }
}

#[test]
fn friezes_of_elements() {
    for (k, name) in NAMES.into_iter().enumerate() {
        check(name, false, [10.0, 500.0, 0.5][k % 3], [3.6, 4.3, 2.7][k % 3]);
    }
}

#[test]
fn friezes_of_strokes() {
    for (k, name) in NAMES.into_iter().enumerate() {
        check(name, true, [0.5, 40.0, 500.0][k % 3], [4.2, 2.7, 3.6][k % 3]);
    }
}
