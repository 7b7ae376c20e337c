//! How a structure is turned and scaled over its place, and what of the place stays free.
//!
//! Pictures lie over flat places: pages, tiles and shapes of the plane, and sheets in space, which they cover seen from above. As in
//! drawings, the first row of a picture is where y is smallest.

use std::sync::Arc;

use arabesque_core::{
    Bounds, Budget, Domain, Error, Fields, Grid, Matrix, OrientationField, Result, ScalarField, Vector,
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
    let turned = |m: Matrix<2>| {
        let [[a, b], [c, d]] = m.0;
        Matrix([[a, b, 0.0], [c, d, 0.0], [0.0, 0.0, 1.0]])
    };
    let orientation = fields.orientation.map(|field| match field {
        OrientationField::Constant(m) => OrientationField::Constant(turned(m)),
        OrientationField::Grid(g) => OrientationField::Grid(grid(g, turned)),
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
