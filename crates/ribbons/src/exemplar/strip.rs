//! Exemplars as the search sees them: premultiplied pixels of all exemplars side by side.

use std::{ops::Range, sync::Arc};

use arabesque_core::{Budget, Error, Held, Image, Result, Vector};

use crate::{exemplar::bits::Bits, geometry::cage::ROWS};

/// Alpha in [0, 255] from which a pixel counts as ink that must not be cut.
const CUT_INK: f32 = 26.0;
/// Alpha in [0, 255] from which a pixel counts as ink that must not fall on a forbidden place.
const ANY_INK: f32 = 1.0;

/// Half of the length over which slopes are taken, in heights of the strip.
const SLOPE: f64 = 0.06;

/// Most pixels of all exemplars together that are searched: rows take time with the square of it.
pub const PIXELS: usize = 250_000;

/// Most columns of all exemplars together: places of pieces are counted in 16 bits.
const COLUMNS: usize = u16::MAX as usize - 1;

/// Work of one pixel of an exemplar, and of one pixel of the search.
const PIXEL: u64 = 4;
const SEARCHED: u64 = 60;

/// One exemplar: a picture whose pattern runs from left to right, and the parts of it that are kept for the ends of the curve.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StripExemplar {
    /// The picture.
    pub image: Image,
    /// Columns that begin an open curve, and are used nowhere else.
    pub start: Option<Range<usize>>,
    /// Columns that end an open curve, and are used nowhere else.
    pub end: Option<Range<usize>>,
}

impl StripExemplar {
    /// An exemplar without ends.
    pub fn new(image: Image) -> Self {
        Self { image, start: None, end: None }
    }
}

/// The exemplars side by side; x counts through all of them.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Premultiplied red, green, blue, then alpha, in [0, 255].
    pixels: Vec<[f32; 4]>,
    /// Slopes of alpha and brightness: along x, then along y.
    slopes: Vec<[f32; 4]>,
    /// Columns of each exemplar.
    pub(crate) spans: Vec<Range<usize>>,
    /// Empty rows above each exemplar.
    pub(crate) above: Vec<usize>,
    /// Columns of the parts for the ends.
    pub(crate) starts: Vec<Option<Range<usize>>>,
    pub(crate) ends: Vec<Option<Range<usize>>>,
    /// Where ink would be cut visibly.
    pub(crate) ink: Bits,
    /// Any ink at all, and two pixels around it.
    pub(crate) trace: Bits,
    /// The memory of all this.
    _held: Arc<Held>,
}

impl Strip {
    /// Joins `exemplars`, each averaged over squares of `coarse` pixels.
    ///
    /// # Errors
    /// [`Error::Limit`] when the work or the memory is used up.
    pub(crate) fn new(exemplars: &[StripExemplar], coarse: usize, budget: &Budget) -> Result<Self> {
        let small: Vec<(usize, usize)> =
            exemplars.iter().map(|e| (e.image.width.div_ceil(coarse), e.image.height.div_ceil(coarse))).collect();
        let width: usize = small.iter().map(|s| s.0).sum();
        let height = small.iter().map(|s| s.1).max().unwrap_or(0);
        let all: usize = width * height;
        let held = Arc::new(budget.hold("pixels of the exemplars", all.saturating_mul(2 * size_of::<[f32; 4]>() + 1))?);
        budget.spend(SEARCHED.saturating_mul(all as u64))?;
        let mut pixels = vec![[0.0; 4]; width * height];
        let (mut spans, mut above) = (Vec::new(), Vec::new());
        let mut left = 0;
        for (exemplar, &(w, h)) in exemplars.iter().zip(&small) {
            // Lower exemplars lie in the middle, so that their patterns meet.
            let offset = (height - h) / 2;
            above.push(offset);
            for y in 0..h {
                budget.spend(PIXEL * (w * coarse * coarse) as u64)?;
                for x in 0..w {
                    pixels[(y + offset) * width + left + x] = average(&exemplar.image, x * coarse, y * coarse, coarse);
                }
            }
            spans.push(left..left + w);
            left += w;
        }
        let scaled = |range: &Option<Range<usize>>, span: &Range<usize>| {
            range.as_ref().map(|r| span.start + r.start / coarse..(span.start + r.end.div_ceil(coarse)).min(span.end))
        };
        let pick = |of: fn(&StripExemplar) -> &Option<Range<usize>>| {
            exemplars.iter().zip(&spans).map(|(e, span)| scaled(of(e), span)).collect()
        };
        let (starts, ends) = (pick(|e| &e.start), pick(|e| &e.end));
        let bits = |least: f32| Bits::from_fn(width, height, |x, y| pixels[y * width + x][3] >= least);
        // Grown by what a sample reaches beside its place, and half a pixel of the canvas.
        let (ink, trace) = (bits(CUT_INK), bits(ANY_INK).grown(2));
        let slopes = slopes(&pixels, &spans, height);
        Ok(Self { width, height, above, spans, starts, ends, ink, trace, pixels, slopes, _held: held })
    }

    /// Pixel in column `x` of row `y`, and the slopes there; transparent outside.
    pub(crate) fn pixel_at(&self, x: i64, y: i64) -> ([f32; 4], [f32; 4]) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return ([0.0; 4], [0.0; 4]);
        }
        let k = y as usize * self.width + x as usize;
        (self.pixels[k], self.slopes[k])
    }

    /// Columns of the longest exemplar.
    pub(crate) fn longest(&self) -> usize {
        self.spans.iter().map(ExactSizeIterator::len).max().unwrap_or(0)
    }

    /// Which exemplar column `x` belongs to.
    pub(crate) fn owner(&self, x: usize) -> usize {
        self.spans.partition_point(|span| span.end <= x).min(self.spans.len() - 1)
    }
}

/// Bilinear sample of a picture at `p`, pixel centres at half-integers: premultiplied, in [0, 255]; transparent above and below.
pub(crate) fn sample(image: &Image, p: Vector<2>) -> [f32; 4] {
    let (x, y) = (p[0] - 0.5, p[1] - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (fx, fy) = ((x - column) as f32, (y - row) as f32);
    let clamp = |c: f64| (c.max(0.0) as usize).min(image.width - 1);
    let (x0, x1, y0) = (clamp(column), clamp(column + 1.0), row as i64);
    let pixel = |x: usize, y: i64| match usize::try_from(y) {
        Ok(y) if y < image.height => premultiplied(image.pixel(x, y)),
        _ => [0.0; 4],
    };
    let (a, b) = (pixel(x0, y0), pixel(x1, y0));
    let (c, d) = (pixel(x0, y0.saturating_add(1)), pixel(x1, y0.saturating_add(1)));
    std::array::from_fn(|k| {
        let (above, below) = (a[k] + (b[k] - a[k]) * fx, c[k] + (d[k] - c[k]) * fx);
        above + (below - above) * fy
    })
}

/// Red, green and blue times alpha, and alpha, in [0, 255].
fn premultiplied(pixel: [u8; 4]) -> [f32; 4] {
    let [r, g, b, a] = pixel.map(f32::from);
    let share = a / 255.0;
    [r * share, g * share, b * share, a]
}

/// Differences over [`SLOPE`] heights of the strip, within each exemplar.
fn slopes(pixels: &[[f32; 4]], spans: &[Range<usize>], height: usize) -> Vec<[f32; 4]> {
    let reach = ((SLOPE * height as f64).round() as usize).max(1);
    let width = spans.last().map_or(0, |s| s.end);
    let values = |x: usize, y: usize| {
        let [r, g, b, a] = pixels[y * width + x];
        [a, 0.299 * r + 0.587 * g + 0.114 * b]
    };
    let mut slopes = vec![[0.0; 4]; pixels.len()];
    for span in spans {
        for x in span.clone() {
            let (before, after) = (x.saturating_sub(reach).max(span.start), (x + reach).min(span.end - 1));
            for y in 0..height {
                let [l, r] = [values(before, y), values(after, y)];
                let [o, u] = [values(x, y.saturating_sub(reach)), values(x, (y + reach).min(height - 1))];
                slopes[y * width + x] = [r[0] - l[0], r[1] - l[1], u[0] - o[0], u[1] - o[1]];
            }
        }
    }
    slopes
}

/// Mean of a square of premultiplied pixels, cut at the border of the picture.
fn average(image: &Image, x: usize, y: usize, side: usize) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for row in y..(y + side).min(image.height) {
        for column in x..(x + side).min(image.width) {
            let pixel = premultiplied(image.pixel(column, row));
            sum.iter_mut().zip(pixel).for_each(|(total, value)| *total += value);
        }
    }
    sum.map(|total| total / (side * side) as f32)
}

/// Refuses exemplars that no pattern can be read from.
pub(crate) fn check(exemplars: &[StripExemplar], coarse: usize, relax: bool, budget: &Budget) -> Result<()> {
    if exemplars.is_empty() {
        return Err(Error::input(
            "exemplar",
            "none was given, where at least one picture was expected",
            "name a picture",
        ));
    }
    let pixels = exemplars.iter().map(|e| e.image.width.saturating_mul(e.image.height));
    for (k, exemplar) in exemplars.iter().enumerate() {
        let place = if exemplars.len() == 1 { "exemplar".to_owned() } else { format!("exemplar {}", k + 1) };
        budget.spend(exemplar.image.pixels.len() as u64)?;
        check_one(exemplar, &place, relax)?;
    }
    check_pixels(pixels.fold(0, usize::saturating_add), coarse)?;
    let columns: usize = exemplars.iter().map(|e| e.image.width.div_ceil(coarse)).sum();
    let rows = exemplars.iter().map(|e| e.image.height.div_ceil(coarse)).max().unwrap_or(0);
    for (what, found, limit) in [("columns", columns, COLUMNS), ("rows", rows, ROWS)] {
        if found > limit {
            let what = format!("{what} of the exemplar");
            let advice = "cut the picture, scale it down, or search at a lower resolution with --coarse".to_owned();
            return Err(Error::Limit { what, found: found.to_string(), limit: limit.to_string(), advice });
        }
    }
    Ok(())
}

/// Refuses exemplars of more than [`PIXELS`] pixels together once `coarse` by `coarse` of them are averaged to one.
///
/// # Errors
/// [`Error::Limit`] for more.
pub fn check_pixels(pixels: usize, coarse: usize) -> Result<()> {
    let limit = PIXELS * coarse * coarse;
    if pixels <= limit {
        return Ok(());
    }
    let enough = (1..=16).find(|c| pixels <= PIXELS * c * c);
    let advice = match enough {
        Some(c) => format!("search at a lower resolution with --coarse {c}, or scale the picture down"),
        None => "scale the picture down".to_owned(),
    };
    let what = "pixels of the exemplar".to_owned();
    Err(Error::Limit { what, found: pixels.to_string(), limit: limit.to_string(), advice })
}

fn check_one(exemplar: &StripExemplar, place: &str, relax: bool) -> Result<()> {
    let image = &exemplar.image;
    if image.width < 4 || image.height < 2 {
        let problem = format!("{} x {} pixels, where at least 4 x 2 were expected", image.width, image.height);
        return Err(Error::input(place, problem, "use a larger picture"));
    }
    let opaque = image.pixels.iter().filter(|p| p[3] > 0).count();
    if opaque == 0 {
        let problem = "every pixel is transparent, where an opaque pattern was expected";
        return Err(Error::input(place, problem, "draw the pattern opaque on a transparent background"));
    }
    if opaque == image.pixels.len() && !relax {
        let problem = "no pixel is transparent, where the background was expected to outline the pattern";
        let advice =
            "make the background transparent, or use --relax, which takes the picture as a texture and cuts it";
        return Err(Error::input(place, problem, advice));
    }
    for (name, range) in [("start", &exemplar.start), ("end", &exemplar.end)] {
        if let Some(range) = range
            && (range.start >= range.end || range.end > image.width)
        {
            let problem = format!("the {name} covers columns {} to {} of {}", range.start, range.end, image.width);
            return Err(Error::input(
                place,
                problem,
                "give a range of columns that lies in the picture, such as 0..60",
            ));
        }
    }
    Ok(())
}
