//! Pieces of SVG text: names, outlines, matrices.

use std::fmt::Write as _;

use arabesque_core::{Bounds, Outline, Placement, Vector};

use crate::{svg::drawing::Unit, text::number::Decimals};

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

/// The unit as SVG writes it.
pub(crate) fn unit_name(unit: Unit) -> &'static str {
    match unit {
        Unit::Px => "",
        Unit::Mm => "mm",
        Unit::Cm => "cm",
        Unit::In => "in",
        Unit::Pt => "pt",
        Unit::Pc => "pc",
        Unit::Q => "Q",
    }
}

/// Text as an attribute value.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => {
                let _ = write!(out, "&#{};", u32::from(c));
            }
            c if c < ' ' || c == '\u{FFFE}' || c == '\u{FFFF}' => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}
