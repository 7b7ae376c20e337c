//! How a structure is turned and scaled over its place, and what of the place stays free.
//!
//! Pictures lie over flat places: pages, tiles and shapes of the plane, and sheets in space, which they cover seen from above. As in
//! drawings, the first row of a picture is where y is smallest.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Budget, Domain, Error, Fields, Grid, Matrix, OrientationField, Result, Rotations, ScalarField, Vector,
};
use arabesque_io::{
    file,
    raster::{mask::MaskRaster, png},
    svg,
};
use arabesque_structures::{Site, SitePlan, Territory};

use crate::{
    method::RunContext,
    plane::{constant_factor, factor_field, options, orientation_field},
    recipe::{FieldSource, Input, Structures},
};

/// Values of black and white in a picture of scale.
const SCALE_RANGE: [f64; 2] = [0.5, 2.0];
/// Cells of a mask along the longer side.
const CELLS: f64 = 768.0;

/// The turn that is the same everywhere, in degrees; a picture is told to be none for what `place` says.
pub(super) fn degrees(job: &Structures, place: &str) -> Result<f64> {
    match &job.orient {
        None => Ok(0.0),
        Some(FieldSource::Constant(v)) if v.is_finite() => Ok(*v),
        Some(FieldSource::Constant(v)) => Err(Error::parameter("orient", v, "degrees")),
        Some(FieldSource::File(_)) => Err(not_flat("orient", place)),
    }
}

/// The factor that is the same everywhere.
pub(super) fn factor<const D: usize>(job: &Structures, place: &str) -> Result<ScalarField<D>> {
    match &job.scale {
        Some(FieldSource::File(_)) => Err(not_flat("scale", place)),
        scale => constant_factor("scale", scale.as_ref()),
    }
}

fn not_flat(name: &str, place: &str) -> Error {
    let advice = "give a number; pictures lie over --size, --tile and --domain";
    Error::Unsupported { what: format!("{name} from a file, together with {place}"), advice: advice.into() }
}

/// The fields over a flat place; their files are embedded.
pub(super) fn over(bounds: &Bounds<2>, job: &mut Structures, context: &RunContext<'_>) -> Result<Fields<2>> {
    let orientation = match &mut job.orient {
        Some(FieldSource::File(source)) => {
            context.files.embed(&mut source.file)?;
            Some(orientation_field(&source.file, bounds, context.files)?)
        }
        _ => Some(degrees(job, "")?)
            .filter(|turned| *turned != 0.0)
            .map(|turned| OrientationField::Constant(Matrix::rotation(turned.to_radians()))),
    };
    let scale = factor_field("scale", job.scale.as_mut(), bounds, SCALE_RANGE, context.files)?;
    Ok(Fields { orientation, scale, ..Fields::default() })
}

/// Rotations of the plane over a sheet in space.
#[derive(Debug)]
struct Raised(Arc<dyn Rotations<2>>);

impl Rotations<3> for Raised {
    fn at(&self, p: Vector<3>) -> Matrix<3> {
        about_z(self.0.at(Vector::xy(p[0], p[1])))
    }
}

/// A rotation of the plane as one about z.
fn about_z(m: Matrix<2>) -> Matrix<3> {
    let [[a, b], [c, d]] = m.0;
    Matrix([[a, b, 0.0], [c, d, 0.0], [0.0, 0.0, 1.0]])
}

/// Fields of the plane over a sheet in space: turned about z, and the same at any height.
pub(super) fn raised(fields: Fields<2>) -> Fields<3> {
    fn grid<T, U>(grid: Grid<2, T>, value: impl Fn(T) -> U) -> Grid<3, U> {
        let raised = |p: Vector<2>| Vector([p[0], p[1], 0.0]);
        Grid {
            bounds: Bounds::new(raised(grid.bounds.min), raised(grid.bounds.max)),
            nodes: [grid.nodes[0], grid.nodes[1], 1],
            values: grid.values.into_iter().map(value).collect(),
        }
    }
    let orientation = fields.orientation.map(|field| match field {
        OrientationField::Constant(m) => OrientationField::Constant(about_z(m)),
        OrientationField::Grid(g) => OrientationField::Grid(grid(g, about_z)),
        OrientationField::Of(rotations) => OrientationField::Of(Arc::new(Raised(rotations))),
    });
    let scale = match fields.scale {
        ScalarField::Constant(v) => ScalarField::Constant(v),
        ScalarField::Grid(g) => ScalarField::Grid(grid(g, |v| v)),
    };
    Fields { orientation, scale, ..Fields::default() }
}

/// The place without what is to be avoided, seen from above; the files are embedded.
pub(super) fn without_avoided<const D: usize>(
    place: Arc<dyn Territory<D>>,
    bounds: &Bounds<2>,
    inputs: &mut [Input],
    context: &RunContext<'_>,
) -> Result<Arc<dyn Territory<D>>> {
    if inputs.is_empty() {
        return Ok(place);
    }
    let (files, budget) = (context.files, context.budget());
    let size = bounds.size();
    let cell = size[0].max(size[1]) / CELLS;
    let [width, height] = size.0.map(|side| ((side / cell).ceil() as usize).max(1));
    let mut mask = MaskRaster::empty(*bounds, width, height, budget)?;
    for input in inputs {
        let bytes = files.embed(input)?;
        if png::is_png(&bytes) {
            mask.add_picture(input.name(), &bytes, budget)?;
            continue;
        }
        let text = file::decode_text(input.name(), &bytes, budget)?;
        let shape = svg::read_shape(&text, input.id.as_deref(), &options(input, files))?.0;
        mask.add_outline(shape.outline(), budget)?;
    }
    if mask.uniform() == Some(true) {
        let advice = "make the avoided regions smaller; of a picture, transparent and light pixels are free";
        return Err(Error::no_result("what is to be avoided covers the whole domain", advice));
    }
    Ok(Arc::new(Masked { place, free: Free::new(&mask) }))
}

/// A place of which some stays empty.
#[derive(Debug)]
struct Masked<const D: usize> {
    place: Arc<dyn Territory<D>>,
    free: Free,
}

/// Cells that are not avoided, and how many of them there are before each row and column.
#[derive(Debug)]
struct Free {
    bounds: Bounds<2>,
    cells: [usize; 2],
    /// Sums of the free cells up to each corner of a cell.
    sums: Vec<u32>,
}

impl Free {
    fn new(mask: &MaskRaster) -> Self {
        let cells = [mask.width, mask.height];
        let stride = mask.width + 1;
        let mut sums = vec![0_u32; stride * (mask.height + 1)];
        for (k, avoided) in mask.cells.iter().enumerate() {
            let (x, y) = (k % mask.width + 1, k / mask.width + 1);
            sums[y * stride + x] = sums[y * stride + x - 1] + sums[(y - 1) * stride + x]
                - sums[(y - 1) * stride + x - 1]
                + u32::from(!avoided);
        }
        Self { bounds: mask.bounds, cells, sums }
    }

    /// How many free cells lie in a square around a place, whose cell counts whole.
    fn around(&self, p: [f64; 2], half: f64) -> u32 {
        let size = self.bounds.size();
        let corner = |k: usize, at: f64| {
            ((at - self.bounds.min[k]) / size[k].max(f64::MIN_POSITIVE) * self.cells[k] as f64).floor()
        };
        let low = |k: usize| corner(k, p[k] - half).clamp(0.0, self.cells[k] as f64 - 1.0) as usize;
        let high = |k: usize| corner(k, p[k] + half).clamp(0.0, self.cells[k] as f64 - 1.0) as usize + 1;
        let at = |x: usize, y: usize| self.sums[y * (self.cells[0] + 1) + x];
        let (x, y) = ((low(0), high(0)), (low(1), high(1)));
        at(x.1, y.1) + at(x.0, y.0) - at(x.0, y.1) - at(x.1, y.0)
    }

    /// Share of all cells.
    fn share(&self) -> f64 {
        f64::from(self.sums.last().copied().unwrap_or(0)) / (self.cells[0] * self.cells[1]).max(1) as f64
    }
}

impl<const D: usize> Territory<D> for Masked<D> {
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        let mut sites = self.place.sites(plan, budget)?;
        sites.retain(|s| self.free.around([s.place[0], s.place[1]], plan.margin * s.scale) > 0);
        Ok(sites)
    }

    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool {
        self.free.around([p[0], p[1]], 0.0) > 0 && self.place.contains(p, plan)
    }

    fn surroundings(&self) -> Domain<D> {
        self.place.surroundings()
    }

    fn measure(&self, repeats: usize) -> f64 {
        self.place.measure(repeats) * self.free.share()
    }

    fn bounds(&self) -> Bounds<D> {
        self.place.bounds()
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Image, PointSet, Unobserved};
    use arabesque_io::raster::png::write_image;

    use super::*;
    use crate::{Artwork, Geometry, Input, Recipe, Resources};

    /// A picture of a few pixels in one row.
    fn picture(pixels: &[[u8; 3]]) -> Input {
        let pixels: Vec<[u8; 4]> = pixels.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect();
        let image = Image { width: pixels.len(), height: 1, pixels };
        Input::file("field.png").embedding(&write_image(&image, 1000.0, None, &Budget::default()).unwrap())
    }

    fn field(pixels: &[[u8; 3]]) -> Option<FieldSource> {
        let mut source = FieldSource::parse("field.png").unwrap();
        if let FieldSource::File(field) = &mut source {
            (field.file, field.range) = (picture(pixels), Some([0.5, 1.0]));
        }
        Some(source)
    }

    /// A square lattice, 0.1 apart; in space with a wave of small height.
    fn lattice(is_sheet: bool) -> String {
        let at = |k: u32| (0.05 + 0.1 * f64::from(k % 10), 0.05 + 0.1 * f64::from(k / 10));
        let row = |k| match (at(k), is_sheet) {
            ((x, y), false) => format!("{x},{y}\n"),
            ((x, y), true) => format!("{x},{y},{}\n", 0.01 * (x * 31.4).sin()),
        };
        format!("{}\n{}", if is_sheet { "x,y,z" } else { "x,y" }, (0..100).map(row).collect::<String>())
    }

    fn run(exemplar: &str, job: Structures) -> Result<Artwork> {
        let prepared =
            Recipe::new(Input::file("grid.csv").embedding(exemplar.as_bytes()), job).prepare(&Resources::default())?;
        prepared.run(&prepared.request(), &mut Unobserved)
    }

    fn points(exemplar: &str, job: Structures) -> Vec<[f64; 2]> {
        match run(exemplar, job).unwrap().geometry() {
            Geometry::PlanePoints(PointSet { positions, .. }) => positions.iter().map(|p| [p[0], p[1]]).collect(),
            Geometry::SpacePoints(PointSet { positions, .. }) => positions.iter().map(|p| [p[0], p[1]]).collect(),
            _ => panic!("points"),
        }
    }

    fn page() -> Structures {
        Structures { size: Some("2x1".parse().unwrap()), ..Structures::default() }
    }

    #[test]
    fn a_picture_scales_the_pattern_by_the_place() {
        for is_sheet in [false, true] {
            let job = Structures { scale: field(&[[0; 3], [0; 3], [0; 3], [255; 3], [255; 3], [255; 3]]), ..page() };
            let found = points(&lattice(is_sheet), job);
            // Half of the size is four times as many, away from the passage between them.
            let small = found.iter().filter(|p| p[0] < 0.8).count() as f64 / 0.8;
            let large = found.iter().filter(|p| p[0] > 1.2).count() as f64 / 0.8;
            assert!(
                (small / 400.0 - 1.0).abs() < 0.15 && (large / 100.0 - 1.0).abs() < 0.2,
                "{is_sheet}: {small} {large}"
            );
        }
    }

    #[test]
    fn the_hue_of_a_picture_turns_the_pattern() {
        // Yellow is 60 degrees; on a square lattice 60 is as good as -30.
        for is_sheet in [false, true] {
            let found = points(&lattice(is_sheet), Structures { orient: field(&[[255, 255, 0]; 2]), ..page() });
            let mut angles = Vec::new();
            for (i, p) in found.iter().enumerate() {
                for q in &found[..i] {
                    let (dx, dy) = (p[0] - q[0], p[1] - q[1]);
                    if (dx.hypot(dy) - 0.1).abs() < 0.02 {
                        angles.push(dy.atan2(dx).to_degrees().rem_euclid(90.0));
                    }
                }
            }
            let near = angles.iter().filter(|a| (**a - 60.0).abs() < 8.0).count();
            assert!(angles.len() > 200 && near * 10 > angles.len() * 9, "{is_sheet}: {near} of {}", angles.len());
        }
    }

    #[test]
    fn what_is_dark_in_a_picture_stays_free() {
        for is_sheet in [false, true] {
            let avoid = vec![picture(&[[255; 3], [255; 3], [0; 3], [255; 3]])];
            let found = points(&lattice(is_sheet), Structures { avoid, ..page() });
            assert!(found.iter().all(|p| p[0] <= 1.0 || p[0] >= 1.5), "{is_sheet}");
            assert!((125..=175).contains(&found.len()), "{is_sheet}: {}", found.len());
        }
        let shape = Input::file("hole.svg")
            .embedding(br#"<svg xmlns="http://www.w3.org/2000/svg"><rect width="1" height="1"/></svg>"#);
        let found = points(&lattice(false), Structures { avoid: vec![shape], ..page() });
        assert!(found.iter().all(|p| p[0] > 0.99) && found.len() > 80, "{}", found.len());
    }

    #[test]
    fn what_does_not_suit_the_place_is_refused() {
        let told = |exemplar: &str, job| run(exemplar, job).unwrap_err().to_string();
        let cube: String = (0..512).map(|k| format!("{},{},{}\n", k % 8, k / 8 % 8, k / 64)).collect();
        let cube = format!("x,y,z\n{cube}");
        let boxed = Structures::boxed("8x8x8".parse().unwrap());
        let dark = || vec![picture(&[[0; 3]])];
        let curve =
            Input::file("c.svg").embedding(br#"<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L9 0"/></svg>"#);
        for (exemplar, job, expected) in [
            (
                &cube,
                Structures { scale: field(&[[0; 3], [255; 3]]), ..boxed.clone() },
                "scale from a file, together with box",
            ),
            (
                &cube,
                Structures { orient: field(&[[0; 3], [255; 3]]), ..boxed.clone() },
                "orient from a file, together with box",
            ),
            (&cube, Structures { avoid: dark(), ..boxed.clone() }, "avoid for a place that is not flat"),
            (&cube, Structures { twist: Some(9.0), ..boxed.clone() }, "twist for a place other than curves"),
            (&cube, Structures { taper: Some("1..2".into()), ..boxed.clone() }, "taper for a place other than curves"),
            (&cube, Structures { radius: Some(1.0), ..boxed.clone() }, "tube for a place other than curves"),
            (
                &cube,
                Structures { direction: Some(crate::Direction::Towards([1.0; 3])), ..boxed },
                "direction for a place other than a mesh",
            ),
            (
                &lattice(false),
                Structures { twist: Some(9.0), ..Structures::along(curve.clone()) },
                "about which nothing turns",
            ),
            (
                &lattice(false),
                Structures { orient: Some(FieldSource::Constant(9.0)), ..Structures::along(curve) },
                "about which nothing turns",
            ),
            (&lattice(false), Structures { avoid: dark(), ..page() }, "covers the whole domain"),
            (&lattice(false), Structures { orient: field(&[[90; 3]; 2]), ..page() }, "one gray value all over"),
        ] {
            let message = told(exemplar, job);
            assert!(message.contains(expected), "{message} for {expected}");
        }
    }
}
