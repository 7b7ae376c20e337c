//! Attribute values that several writers need: matrices and outlines.

use std::fmt::Write as _;

use arabesque_core::{Bounds, Decimals, Outline, Placement, Vector};

/// The transform of a placement, as an attribute value.
pub(crate) fn matrix(placement: &Placement<2>, shift: Vector<2>, d: Decimals) -> String {
    let t = &placement.transform;
    let (r, s) = (t.rotation.0, t.scale);
    let at = t.translation + shift;
    let (e, f) = (d.format(at[0]), d.format(at[1]));
    let linear = [r[0][0], r[1][0], r[0][1], r[1][1]].map(|v| d.plus(3).format(v * s));
    if linear == ["1", "0", "0", "1"] {
        return format!("translate({e} {f})");
    }
    format!("matrix({} {e} {f})", linear.join(" "))
}

/// The outline of a box.
pub(crate) fn rectangle(b: &Bounds<2>) -> Outline<2> {
    let (a, c) = (b.min, b.max);
    Outline { rings: vec![vec![a, Vector::xy(c[0], a[1]), c, Vector::xy(a[0], c[1])]] }
}

/// Path data of an outline.
pub(crate) fn outline_data(outline: &Outline<2>, d: Decimals) -> String {
    let mut data = String::new();
    for ring in &outline.rings {
        for (k, p) in ring.iter().enumerate() {
            let _ = write!(data, "{}{} {}", if k == 0 { "M" } else { "L" }, d.format(p[0]), d.format(p[1]));
        }
        data.push('Z');
    }
    data
}
