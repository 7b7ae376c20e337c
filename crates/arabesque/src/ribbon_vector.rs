//! Ribbons of drawings: the areas of the exemplar cut by pieces, bent, and joined again.

use arabesque_core::{FillRule, Outline, Path, Ring, Vector};
use arabesque_io::{
    number::Decimals,
    path_data::path_data,
    svg::{Area, simplified},
};
use arabesque_ribbons::{Piece, Ribbon};

/// How far the cut areas reach over the edges of their pieces, in exemplar pixels, so that what goes on is joined.
const REACH: f64 = 0.3;
/// Sides of cut areas are bent in steps of this length, in exemplar pixels.
const BEND: f64 = 2.0;
/// How far a written border may lie from the true one, in exemplar pixels.
const DEVIATION: f64 = 0.05;

/// An exemplar's areas, in pixels of its picture.
pub(crate) struct Drawing {
    pub(crate) areas: Vec<Area>,
}

/// The markup of a ribbon: one path for each area of each exemplar that shows, in the order of the drawings.
pub(crate) fn markup(ribbon: &Ribbon<2>, drawings: &[Drawing], decimals: Decimals) -> String {
    let mut out = String::new();
    for (source, drawing) in drawings.iter().enumerate() {
        let pieces: Vec<&Piece<2>> = ribbon.pieces.iter().filter(|p| p.patch.source == source).collect();
        let Some(scale) = pieces.first().map(|p| p.scale()) else { continue };
        for area in &drawing.areas {
            let rings: Vec<Ring<2>> = pieces.iter().flat_map(|piece| shown(piece, &area.outline)).collect();
            let joined = Outline::union(&rings, FillRule::NonZero);
            let data: String = joined
                .rings
                .iter()
                .map(|ring| path_data(&simplified(&closed(ring), DEVIATION * scale), decimals))
                .collect();
            if data.is_empty() {
                continue;
            }
            let opacity =
                if area.opacity < 1.0 { format!(" fill-opacity=\"{:.4}\"", area.opacity) } else { String::new() };
            out += &format!("      <path fill=\"{}\"{opacity} fill-rule=\"evenodd\" d=\"{data}\"/>\n", area.colour);
        }
    }
    out
}

/// What a piece shows of an area, on the canvas.
fn shown(piece: &Piece<2>, area: &Outline<2>) -> Vec<Ring<2>> {
    let window = window(piece);
    if !window.bounds().intersects(&area.bounds()) {
        return Vec::new();
    }
    let cut = area.intersection(&window);
    cut.rings.iter().map(|ring| placed(piece, ring)).filter(|ring| ring.len() > 2).collect()
}

/// The part of the exemplar that a piece shows, and a little more on both sides.
fn window(piece: &Piece<2>) -> Outline<2> {
    let [tl, tr, br, bl] = piece.patch.texture;
    // What is bent may come from above or below the corners of the right edge.
    let most = piece.shift.iter().fold(0.0_f64, |most, s| most.max(f64::from(s.abs())));
    let spread = (br - tr) * ((most + REACH) / (br - tr).norm().max(1e-9));
    let side = Vector::xy(REACH, 0.0);
    let ring = vec![tl - side, tr + side - spread, br + side + spread, bl - side];
    Outline::union(&[ring], FillRule::NonZero)
}

/// A ring of the exemplar where the piece shows it.
fn placed(piece: &Piece<2>, ring: &[Vector<2>]) -> Ring<2> {
    let at = |p: Vector<2>| piece.to_canvas(if piece.shift.is_empty() { p } else { piece.unbent(p) });
    let step = if piece.shift.is_empty() { f64::INFINITY } else { BEND };
    let next = ring.iter().cycle().skip(1);
    ring.iter()
        .zip(next)
        .flat_map(|(a, b)| {
            let parts = ((*b - *a).norm() / step).ceil().max(1.0);
            (0..parts as usize).map(move |k| *a + (*b - *a) * (k as f64 / parts))
        })
        .map(at)
        .collect()
}

fn closed(ring: &[Vector<2>]) -> Path<2> {
    let points: Vec<_> = ring.iter().chain(ring.first()).copied().collect();
    Path { closed: true, ..Path::polyline(&points) }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Patch;

    use super::*;

    fn strip() -> Ribbon<2> {
        let piece = |k: f64| {
            let texture =
                [(0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0)].map(|(x, y)| Vector::xy(x + k * 10.0, y));
            Piece { patch: Patch { source: 0, corners: texture.map(|p| p * 2.0), texture }, shift: Vec::new() }
        };
        Ribbon { pieces: (0..3).map(|k| piece(f64::from(k))).collect(), closed: false, cost: 0.0 }
    }

    fn area(colour: &str, [x, y, w, h]: [f64; 4]) -> Area {
        let ring = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| Vector::xy(x, y)).to_vec();
        Area { outline: Outline { rings: vec![ring] }, colour: colour.into(), opacity: 1.0 }
    }

    #[test]
    fn what_pieces_cut_is_joined_and_the_order_stays() {
        let drawing =
            Drawing { areas: vec![area("#0000ff", [0.0, 8.0, 30.0, 4.0]), area("red", [12.0, 9.0, 2.0, 2.0])] };
        let text = markup(&strip(), &[drawing], Decimals::for_extent(100.0));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        // One bar with few nodes, not three.
        assert_eq!(lines[0].matches(['M', 'm']).count(), 1, "{text}");
        assert!(lines[0].contains("#0000ff") && lines[1].contains("red"));
        assert!(lines[0].len() < 140, "{text}");
    }

    #[test]
    fn bent_pieces_bend_their_areas() {
        let mut ribbon = strip();
        ribbon.pieces.truncate(1);
        ribbon.pieces[0].shift = vec![2.0; 20];
        let rings = shown(&ribbon.pieces[0], &area("red", [0.0, 9.0, 10.0, 1.0]).outline);
        let at = |x: f64| rings[0].iter().filter(|p| (p[0] - x).abs() < 1.0).map(|p| p[1]).fold(f64::MAX, f64::min);
        // What lies two pixels further down comes up.
        assert!((at(20.0) - 14.0).abs() < 0.3 && (at(0.0) - 18.0).abs() < 0.3, "{rings:?}");
    }
}
