//! Ribbons as files.

use arabesque_core::{Bounds, Error, Image, Result, Vector};
use arabesque_io::{
    gltf::{self, Part},
    number::Decimals,
    obj_strip, png, ribbon_json,
    strip::Strip,
    svg::{Cell, Embedded, Look, Page, RibbonSheet, write_ribbons},
};
use arabesque_ribbons::{Exemplar, Piece, Ribbon};

use crate::{
    Encoded, Format, OutputOptions,
    input::encode,
    ribbon::{Laid, RibbonArtwork, Track},
    ribbon_cells::{Rung, rungs},
    ribbon_vector::{Drawing, markup},
};

/// A cell of four corners is shown as one when its fourth corner is no farther off than this, in exemplar pixels.
const FLAT: f64 = 0.4;
/// How far around a cell ink counts, in exemplar pixels.
const MARGIN: f64 = 2.0;
/// A cell is shown with its own map when that stretches no more than this many times as much as the rigid one.
const STRETCH: f64 = 3.0;
/// Pixels a metre of an embedded picture: 96 an inch.
const PER_METRE: f64 = 96.0 / 0.0254;

impl RibbonArtwork<'_> {
    /// The file in the format that `output` asks for; PNG where it does not say, GLB for curves in space.
    ///
    /// # Errors
    /// [`Error::Limit`] for a canvas with too many pixels, [`Error::Unsupported`] for a format that cannot hold the ribbon.
    pub fn encode(&self, output: &OutputOptions) -> Result<Encoded> {
        let format = output.format.unwrap_or_else(|| self.prepared.recipe.usual_format());
        let recipe = self.recipe(&OutputOptions { format: Some(format), ..output.clone() })?;
        let carried = (!output.bare).then_some(recipe.as_str());
        let bytes = match (format, &self.laid, &self.prepared.track) {
            (Format::Toml, ..) => recipe.into_bytes(),
            (Format::Json, ..) => self.json(carried)?.into_bytes(),
            (Format::Obj, ..) => {
                obj_strip::write_strips(&self.parts(Pictures::Left)?, self.extent(), carried).into_bytes()
            }
            (Format::Glb, ..) => gltf::write_glb(&self.parts(Pictures::Held)?, carried)?,
            (Format::Png, Laid::Plane(ribbons), Track::Plane { request, page }) => {
                self.picture((ribbons, request.avoid.as_ref()), page, output, carried)?
            }
            (Format::Svg, Laid::Plane(ribbons), Track::Plane { page, .. }) => {
                self.svg(ribbons, page, carried)?.into_bytes()
            }
            _ => {
                let space = matches!(self.laid, Laid::Space(_));
                let (kind, advice) =
                    if space { ("in space ", "json, obj or glb") } else { ("", "png, svg, json, obj or glb") };
                let what = format!("a ribbon {kind}as {}", format.name());
                return Err(Error::Unsupported { what, advice: format!("write {advice}") });
            }
        };
        Ok(Encoded { bytes, warnings: Vec::new() })
    }

    fn exemplars(&self) -> &[Exemplar] {
        self.prepared.engine.exemplars()
    }

    /// What each curve is called.
    fn names(&self) -> Vec<&str> {
        match &self.prepared.track {
            Track::Plane { request, .. } => request.curves.iter().map(|(name, _)| name.as_str()).collect(),
            Track::Space { request } => request.curves.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    /// Largest side of what is shown.
    fn extent(&self) -> f64 {
        let sides = match (&self.laid, &self.prepared.track) {
            (_, Track::Plane { page, .. }) => page.view.size().0.to_vec(),
            (Laid::Space(ribbons), _) => {
                let corners = ribbons.iter().flat_map(|r| &r.pieces).flat_map(|p| p.patch.corners);
                Bounds::around(corners).size().0.to_vec()
            }
            (Laid::Plane(_), Track::Space { .. }) => Vec::new(),
        };
        sides.into_iter().fold(0.0, f64::max)
    }

    fn json(&self, recipe: Option<&str>) -> Result<String> {
        match &self.laid {
            Laid::Plane(ribbons) => self.json_of(ribbons, recipe),
            Laid::Space(ribbons) => self.json_of(ribbons, recipe),
        }
    }

    fn json_of<const D: usize>(&self, ribbons: &[Ribbon<D>], recipe: Option<&str>) -> Result<String> {
        let lines = ribbons.iter().zip(self.names()).map(|(ribbon, name)| ribbon_json::Line {
            name,
            closed: ribbon.closed,
            cost: ribbon.cost,
            pieces: ribbon.pieces.iter().map(|p| (p.patch, p.shift.as_slice())).collect(),
        });
        let sizes = self.exemplars().iter().map(|e| [e.image.width, e.image.height]);
        ribbon_json::write_ribbons(&ribbon_json::Document {
            exemplars: self.prepared.sources.iter().map(|s| s.name.as_str()).zip(sizes).collect(),
            ribbons: lines.collect(),
            page: match &self.prepared.track {
                Track::Plane { page, .. } => Some([page.view.min.0, page.view.size().0]),
                Track::Space { .. } => None,
            },
            extent: self.extent(),
            warnings: &self.warnings,
            recipe,
        })
    }

    /// A textured strip for each exemplar.
    fn parts(&self, pictures: Pictures) -> Result<Vec<Part>> {
        let mut parts = Vec::new();
        for (exemplar, source) in self.exemplars().iter().zip(&self.prepared.sources) {
            let picture = match pictures {
                Pictures::Held => png::write_image(&exemplar.image, PER_METRE, None)?,
                Pictures::Left => Vec::new(),
            };
            parts.push(Part { name: source.name.clone(), picture, strip: Strip::default() });
        }
        match &self.laid {
            // A drawing has its y axis downwards, a mesh upwards.
            Laid::Plane(ribbons) => self.strips(ribbons, |p| [p[0], -p[1], 0.0], &mut parts),
            Laid::Space(ribbons) => self.strips(ribbons, |p| p.0, &mut parts),
        }
        Ok(parts)
    }

    fn strips<const D: usize>(&self, ribbons: &[Ribbon<D>], at: fn(Vector<D>) -> [f64; 3], parts: &mut [Part]) {
        for piece in ribbons.iter().flat_map(|r| &r.pieces) {
            let source = piece.patch.source;
            let (Some(exemplar), Some(part)) = (self.exemplars().get(source), parts.get_mut(source)) else { continue };
            let (width, height) = (exemplar.image.width as f64, exemplar.image.height as f64);
            let corner = |rung: &Rung<D>, k: usize| {
                (at(rung.ends[k]), [rung.texture[k][0] / width, rung.texture[k][1] / height])
            };
            for pair in rungs(piece, height).windows(2) {
                let [upper, lower] = [&pair[0], &pair[1]].map(|rung| [corner(rung, 0), corner(rung, 1)]);
                part.strip.push(upper, lower);
            }
        }
    }

    /// The exemplars as areas, where they are drawings.
    pub(crate) fn drawings(&self) -> Option<Vec<Drawing>> {
        self.prepared.sources.iter().map(|s| Some(Drawing { areas: s.areas.clone()? })).collect()
    }

    pub(crate) fn svg(&self, ribbons: &[Ribbon<2>], page: &Page, recipe: Option<&str>) -> Result<String> {
        let size = page.view.size();
        let decimals = Decimals::for_extent(size[0].max(size[1]));
        let drawings = self.drawings();
        let mut pictures = Vec::new();
        if drawings.is_none() {
            for exemplar in self.exemplars() {
                let data = encode(&png::write_image(&exemplar.image, PER_METRE, None)?);
                pictures.push(Embedded { size: [exemplar.image.width, exemplar.image.height], data });
            }
        }
        let look = |ribbon: &Ribbon<2>| match &drawings {
            Some(drawings) => Look::Markup(markup(ribbon, drawings, decimals)),
            None => Look::Cells(ribbon.pieces.iter().flat_map(|piece| self.cells(piece)).collect()),
        };
        let looks: Vec<_> = ribbons.iter().zip(self.names()).map(|(r, name)| (name.to_owned(), look(r))).collect();
        Ok(write_ribbons(&RibbonSheet { page: *page, pictures: &pictures, ribbons: &looks, recipe }))
    }

    /// The cells of a piece in which there is anything to see.
    fn cells(&self, piece: &Piece<2>) -> Vec<Cell> {
        let Some(exemplar) = self.exemplars().get(piece.patch.source) else { return Vec::new() };
        let (image, rigid) = (&exemplar.image, rigid(piece));
        rungs(piece, image.height as f64)
            .windows(2)
            .filter(|pair| has_ink(image, pair.iter().flat_map(|rung| rung.texture)))
            .flat_map(|pair| cells(piece.patch.source, &rigid, &pair[0], &pair[1]))
            .collect()
    }
}

/// Whether anything can be seen in the box around `corners`, and a little beyond.
fn has_ink(image: &Image, corners: impl IntoIterator<Item = Vector<2>>) -> bool {
    let bounds = Bounds::around(corners).grown(MARGIN);
    let range = |k: usize, n: usize| {
        let clamp = |v: f64| v.clamp(0.0, n as f64) as usize;
        clamp(bounds.min[k].floor())..clamp(bounds.max[k].ceil())
    };
    let columns = range(0, image.width);
    range(1, image.height).any(|y| columns.clone().any(|x| image.pixel(x, y)[3] > 0))
}

/// Whether a mesh holds its pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pictures {
    Held,
    Left,
}

/// What lies between two lines across a piece: one cell where that is flat enough, else two triangles. `rigid` is the map of the piece
/// as if it were not bent.
fn cells(source: usize, rigid: &[f64; 6], upper: &Rung<2>, lower: &Rung<2>) -> Vec<Cell> {
    let [a, b] = [0, 1].map(|k| (upper.texture[k], upper.ends[k]));
    let [d, c] = [0, 1].map(|k| (lower.texture[k], lower.ends[k]));
    let cell = |corners: &[(Vector<2>, Vector<2>)], matrix: [f64; 6]| Cell {
        source,
        ring: corners.iter().map(|corner| corner.1).collect(),
        matrix,
    };
    if let Some(matrix) = affine([a, c, d]).filter(|m| is_even(m, rigid))
        && (apply(&matrix, b.0) - b.1).norm() <= FLAT * size(rigid)
    {
        return vec![cell(&[a, b, c, d], matrix)];
    }
    let map = |corners| affine(corners).filter(|m| is_even(m, rigid)).unwrap_or_else(|| moved(rigid, corners));
    [[a, b, c], [a, c, d]].into_iter().map(|corners| cell(&corners, map(corners))).collect()
}

/// User units a pixel of the picture.
fn size(matrix: &[f64; 6]) -> f64 {
    (matrix[0] * matrix[3] - matrix[1] * matrix[2]).abs().sqrt()
}

/// Whether a map stretches not much more than the rigid one: a row that is pulled over many shows nothing but itself.
fn is_even(matrix: &[f64; 6], rigid: &[f64; 6]) -> bool {
    let most = STRETCH * size(rigid);
    let turned = matrix[0] * matrix[3] - matrix[1] * matrix[2];
    turned > 0.0 && matrix[0].hypot(matrix[1]) <= most && matrix[2].hypot(matrix[3]) <= most
}

/// The rigid map moved such that the middle of three corners is shown where it belongs.
fn moved(rigid: &[f64; 6], corners: [(Vector<2>, Vector<2>); 3]) -> [f64; 6] {
    let middle = |k: fn(&(Vector<2>, Vector<2>)) -> Vector<2>| {
        corners.iter().fold(Vector::ZERO, |sum, corner| sum + k(corner)) * (1.0 / 3.0)
    };
    let off = middle(|c| c.1) - apply(rigid, middle(|c| c.0));
    let [a, b, c, d, e, f] = *rigid;
    [a, b, c, d, e + off[0], f + off[1]]
}

/// The map of a piece as if it were not bent.
fn rigid(piece: &Piece<2>) -> [f64; 6] {
    let [x, y, o] = [Vector::xy(1.0, 0.0), Vector::xy(0.0, 1.0), Vector::ZERO].map(|q| piece.to_canvas(q));
    let (x, y) = (x - o, y - o);
    [x[0], x[1], y[0], y[1], o[0], o[1]]
}

/// The affine map that takes three points of the picture to three of the canvas, as SVG's `matrix()` has it.
fn affine([p, q, r]: [(Vector<2>, Vector<2>); 3]) -> Option<[f64; 6]> {
    let (u, v) = (q.0 - p.0, r.0 - p.0);
    let (s, t) = (q.1 - p.1, r.1 - p.1);
    let area = u.cross(v);
    if area.abs() < 1e-6 {
        return None;
    }
    let column = |along: [f64; 2]| (s * along[0] + t * along[1]) * (1.0 / area);
    let (x, y) = (column([v[1], -u[1]]), column([-v[0], u[0]]));
    let shift = p.1 - x * p.0[0] - y * p.0[1];
    Some([x[0], x[1], y[0], y[1], shift[0], shift[1]])
}

fn apply([a, b, c, d, e, f]: &[f64; 6], p: Vector<2>) -> Vector<2> {
    Vector::xy(a * p[0] + c * p[1] + e, b * p[0] + d * p[1] + f)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_make_a_map() {
        let to = |p: Vector<2>| Vector::xy(3.0 + 2.0 * p[0] - p[1], 5.0 + p[0] + 4.0 * p[1]);
        let points = [(1.0, 1.0), (7.0, 2.0), (3.0, 9.0)].map(|(x, y)| Vector::xy(x, y));
        let matrix = affine(points.map(|p| (p, to(p)))).unwrap();
        let q = Vector::xy(-4.0, 11.0);
        assert!((apply(&matrix, q) - to(q)).norm() < 1e-9);
        assert!(affine([points[0], points[0], points[1]].map(|p| (p, p))).is_none());
    }

    #[test]
    fn what_is_empty_is_left_out() {
        let mut image = Image::transparent(20, 20);
        let corners = [(3.0, 3.0), (8.0, 6.0)].map(|(x, y)| Vector::xy(x, y));
        image.pixels[15 * 20 + 15] = [1, 2, 3, 4];
        assert!(!has_ink(&image, corners));
        image.pixels[5 * 20 + 5] = [1, 2, 3, 4];
        assert!(has_ink(&image, corners));
    }

    #[test]
    fn bent_cells_are_two_triangles_and_flat_ones_one() {
        let v = |x: f64, y: f64| Vector::xy(x, y);
        let rung = |y: f64, shift: f64| Rung { ends: [v(0.0, y), v(9.0, y)], texture: [v(0.0, y), v(9.0, y + shift)] };
        let still = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        assert_eq!(cells(0, &still, &rung(0.0, 1.0), &rung(4.0, 1.0)).len(), 1);
        assert_eq!(cells(0, &still, &rung(0.0, 0.0), &rung(4.0, 1.0)).len(), 2);
        // Four rows that all show one: nothing is stretched without end.
        for cell in cells(0, &still, &rung(0.0, 4.0), &rung(4.0, 0.0)) {
            assert!(cell.matrix[2].hypot(cell.matrix[3]) <= STRETCH, "{cell:?}");
        }
    }
}
