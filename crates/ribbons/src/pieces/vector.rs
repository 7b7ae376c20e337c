//! Ribbons of drawings: the areas of the exemplar cut by pieces, bent, and joined again.

use arabesque_core::{Bounds, Budget, FillRule, Outline, Result, Ring, Vector};

use crate::pieces::piece::{Piece, Ribbon};

/// How far the cut areas reach over the edges of their pieces, in exemplar pixels, so that what goes on is joined.
const REACH: f64 = 0.3;
/// Sides of cut areas are bent in steps of this length, in exemplar pixels.
const BEND: f64 = 2.0;
/// How far a written border may lie from the true one, in exemplar pixels.
const DEVIATION: f64 = 0.05;

/// Work of comparing the boxes of a piece and of an area, of one corner of an area that is cut, and of one that is joined.
const BOXES: u64 = 10;
const CUT: u64 = 400;
const JOINED: u64 = 600;
/// Bytes of one corner on its way.
const CORNER: usize = 64;

/// What a ribbon shows of one area of an exemplar that is a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownArea {
    /// Which exemplar.
    pub source: usize,
    /// Which of its areas.
    pub area: usize,
    /// Where it is seen, in user units.
    pub outline: Outline<2>,
    /// How far a written border may lie from this one, in user units.
    pub tolerance: f64,
}

/// What a ribbon shows of the areas of each exemplar, in the order of `drawings`: outlines in exemplar pixels, the lowest first. Areas
/// that are not seen are left out.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn shown_areas(ribbon: &Ribbon<2>, drawings: &[Vec<&Outline<2>>], budget: &Budget) -> Result<Vec<ShownArea>> {
    let mut all = Vec::new();
    for (source, areas) in drawings.iter().enumerate() {
        let pieces: Vec<&Piece<2>> = ribbon.pieces.iter().filter(|p| p.patch.source == source).collect();
        let Some(scale) = pieces.first().map(|p| p.scale()) else { continue };
        let windows: Vec<(Outline<2>, Bounds<2>)> =
            pieces.iter().map(|piece| window(piece)).map(|window| (window.clone(), window.bounds())).collect();
        for (area, &outline) in areas.iter().enumerate() {
            let (bounds, corners) = (outline.bounds(), outline.points().count());
            let (mut rings, mut count, mut held) = (Vec::new(), 0, Vec::new());
            for (piece, (window, around)) in pieces.iter().zip(&windows) {
                budget.spend(BOXES)?;
                if around.intersects(&bounds) {
                    budget.spend(CUT * corners as u64)?;
                    let shown = shown(piece, outline, window);
                    let more = shown.iter().map(Vec::len).sum::<usize>();
                    held.push(budget.hold("areas of the drawing, cut by pieces", more * CORNER)?);
                    count += more;
                    rings.extend(shown);
                }
            }
            budget.spend(JOINED * count as u64)?;
            let outline = Outline::union(&rings, FillRule::NonZero);
            if !outline.rings.is_empty() {
                all.push(ShownArea { source, area, outline, tolerance: DEVIATION * scale });
            }
        }
    }
    Ok(all)
}

/// What a piece shows of an area through its window, on the canvas.
fn shown(piece: &Piece<2>, area: &Outline<2>, window: &Outline<2>) -> Vec<Ring<2>> {
    let cut = area.intersection(window);
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

    fn area([x, y, w, h]: [f64; 4]) -> Outline<2> {
        let ring = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| Vector::xy(x, y)).to_vec();
        Outline { rings: vec![ring] }
    }

    #[test]
    fn what_pieces_cut_is_joined_and_the_order_stays() {
        let areas = [area([0.0, 8.0, 30.0, 4.0]), area([40.0, 0.0, 2.0, 2.0]), area([12.0, 9.0, 2.0, 2.0])];
        let shown = shown_areas(&strip(), &[areas.iter().collect()], &Budget::default()).unwrap();
        assert_eq!(shown.iter().map(|s| s.area).collect::<Vec<_>>(), [0, 2]);
        // One bar, not three.
        assert_eq!(shown[0].outline.rings.len(), 1);
        let size = shown[0].outline.bounds().size();
        assert!((size - Vector::xy(60.0, 8.0)).norm() < 0.1, "{size:?}");
        assert!((shown[0].tolerance - 2.0 * DEVIATION).abs() < 1e-12);
    }

    #[test]
    fn bent_pieces_bend_their_areas() {
        let mut ribbon = strip();
        ribbon.pieces.truncate(1);
        ribbon.pieces[0].shift = vec![2.0; 20];
        let rings = shown(&ribbon.pieces[0], &area([0.0, 9.0, 10.0, 1.0]), &window(&ribbon.pieces[0]));
        let at = |x: f64| rings[0].iter().filter(|p| (p[0] - x).abs() < 1.0).map(|p| p[1]).fold(f64::MAX, f64::min);
        // What lies two pixels further down comes up.
        assert!((at(20.0) - 14.0).abs() < 0.3 && (at(0.0) - 18.0).abs() < 0.3, "{rings:?}");
    }
}
