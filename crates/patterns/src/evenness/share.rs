//! The share of ink around every place of a page: clumps and thin places that no single gap tells of.
//!
//! Elements count as masses at their centres, under a kernel as wide as their spacing; elements count by their ink there, so
//! that dots between leaves make it no narrower. A place costs something when its share is off by more than it often is in
//! the exemplar.

use arabesque_core::{Budget, Domain, Lattice, Meter, Numbered, Result, Vector};

use crate::{border::Extent, dimension::Dimension, exemplar::library::Library};

/// Radius of the kernel, in spacings of the ink.
const RADIUS: f64 = 1.8;

/// Cells to a radius of the kernel, and most cells of a page.
const CELLS: (f64, usize) = (2.5, 1 << 20);

/// Places whose kernel lies inside by less than this share tell nothing.
const INSIDE: f64 = 0.75;

/// Deviations that cost nothing.
const NATURAL: f64 = 1.7;

/// Price of a place that is off by one deviation more.
const PRICE: f64 = 0.04;

/// Nanoseconds for an element and a cell.
const WORK: u64 = 4;

/// How the ink of the exemplar is spread.
#[derive(Clone, Debug)]
pub(crate) struct Spread {
    /// Ink of each element.
    mass: Numbered<f64>,
    /// Radius of the kernel.
    radius: f64,
    mean: f64,
    /// Standard deviation, relative to the mean.
    deviation: f64,
}

impl Spread {
    /// Measures an exemplar, whose elements have so much ink; `None` where too little is seen of it.
    pub(crate) fn new<const D: usize>(
        library: &Library<D>,
        mass: Numbered<f64>,
        budget: &Budget,
    ) -> Result<Option<Self>> {
        let (sum, squares) = mass.iter().fold((0.0, 0.0), |(s, q), m| (s + m, q + m * m));
        if squares <= 0.0 {
            return Ok(None);
        }
        let shown = mass.numbers().filter(|&e| library.view.contains(library.centre[e])).count() as f64;
        let many = sum * sum / squares * shown / mass.len() as f64;
        let spacing = (library.view.measure() / many.max(1.0)).powf(1.0 / D as f64);
        let radius = RADIUS * spacing;
        let step = radius / CELLS.0;
        let size = library.view.window.size();
        let counts: [usize; D] = std::array::from_fn(|k| ((size[k] / step).ceil() as usize).clamp(1, 256));
        let margin = 0.6 * radius;
        let mut meter = budget.meter();
        let mut shares = Vec::new();
        for c in 0..counts.iter().product() {
            let p = library.view.window.cell_centre(c, &counts);
            if library.view.signed_distance(p) < margin {
                continue;
            }
            let mut share = 0.0;
            let looked = library.within(p, radius, |e, offset| {
                if (e as usize) < mass.len() {
                    share += mass[e] * kernel::<D>(offset.norm2(), radius);
                }
            });
            meter.spend(looked)?;
            shares.push(share);
        }
        if shares.len() < 12 {
            return Ok(None);
        }
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let variance = shares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / shares.len() as f64;
        let deviation = (variance.sqrt() / mean.max(f64::MIN_POSITIVE)).max(0.02);
        Ok((mean > 0.0).then_some(Self { mass, radius, mean, deviation }))
    }
}

/// Weight of a mass at a squared distance: 1 in all.
#[inline]
fn kernel<const D: usize>(distance2: f64, radius: f64) -> f64 {
    let x = 1.0 - distance2 / (radius * radius);
    if x <= 0.0 {
        return 0.0;
    }
    let whole = if D == 2 { std::f64::consts::PI / 4.0 } else { 64.0 * std::f64::consts::PI / 315.0 };
    x * x * x / (whole * radius.powi(D as i32))
}

/// A place at which the share is known.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Ink under the kernel.
    ink: f64,
    /// Radius of the kernel here.
    radius: f64,
    /// From ink to deviations; 0 where it tells nothing.
    scale: f64,
    /// What is usual, in deviations.
    usual: f64,
}

/// The share of ink over a page.
pub(crate) struct Shares<'a, const D: usize> {
    spread: &'a Spread,
    domain: &'a Domain<D>,
    lattice: Lattice<D>,
    places: Vec<Place>,
    /// Radius of the widest kernel.
    widest: f64,
    /// Price of a place.
    price: f64,
}

/// What is known around one element without it: places, ink and how it counts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Around<const D: usize>(Vec<(Vector<D>, Place)>);

impl<'a, const D: usize> Shares<'a, D>
where
    Vector<D>: Dimension<D>,
{
    /// An empty page.
    pub(crate) fn new(spread: &'a Spread, extent: &Extent<'a, D>, budget: &Budget) -> Result<Self> {
        let request = extent.request();
        let bounds = request.domain.bounds();
        let step = spread.radius * extent.smallest_spacing_scale / CELLS.0;
        let counts = bounds.size().0.map(|side| ((side / step).ceil().max(1.0) as usize).min(1 << 16));
        let lattice = Lattice::at_most(bounds, counts, request.domain.period().is_some(), CELLS.1);
        let is_inside: Vec<bool> = (0..lattice.count()).map(|c| extent.room(lattice.centre(c)) > 0.0).collect();
        let mut meter = budget.meter();
        let mut places = Vec::with_capacity(lattice.count());
        let measure: f64 = lattice.cell().0.into_iter().product();
        for c in 0..lattice.count() {
            let p = lattice.centre(c);
            let frame = request.fields.frame(p);
            let radius = spread.radius * frame.spacing_scale;
            let (mut inside, mut looked) = (0.0, 0);
            lattice.around(p, radius, |o, at| {
                looked += 1;
                if is_inside[o] {
                    inside += measure * kernel::<D>((lattice.centre_at(at) - p).norm2(), radius);
                }
            });
            meter.spend(WORK * looked)?;
            let usual = spread.mean * (frame.element_scale / frame.spacing_scale).powi(D as i32);
            let tells = is_inside[c] && inside > INSIDE;
            // Of a kernel that is cut off, the share depends on where the cut happens to be.
            let trust = inside.min(1.0).powi(4);
            let scale = if tells { trust / (usual * inside * spread.deviation) } else { 0.0 };
            let offset = trust / spread.deviation;
            places.push(Place { ink: 0.0, radius, scale, usual: offset });
        }
        let widest = spread.radius * extent.largest_spacing_scale;
        let price = PRICE * (spread.radius / RADIUS * extent.smallest_spacing_scale).powi(-(D as i32)) * measure;
        Ok(Self { spread, domain: &request.domain, lattice, places, widest, price })
    }
}

impl<const D: usize> Shares<'_, D> {
    /// How far an element counts, at most.
    pub(crate) fn widest(&self) -> f64 {
        self.widest
    }

    /// Ink of an element; only what lies inside counts, as only places inside do.
    fn mass(&self, (source, scale): (u32, f64), centre: Vector<D>) -> f64 {
        if self.domain.contains(centre) { self.spread.mass[source] * scale.powi(D as i32) } else { 0.0 }
    }

    /// The places in the box around a ball.
    pub(crate) fn part_around(&self, p: Vector<D>, radius: f64) -> Self {
        let lattice = self.lattice.part(p, radius);
        let mut places = Vec::with_capacity(lattice.count());
        self.lattice.around(p, radius, |c, _| places.push(self.places[c]));
        Self { lattice, places, ..*self }
    }

    /// Adds an element, or takes one away with `sign` -1.
    pub(crate) fn count(&mut self, (source, scale): (u32, f64), centre: Vector<D>, sign: f64) {
        let mass = sign * self.mass((source, scale), centre);
        let (places, lattice) = (&mut self.places, &self.lattice);
        lattice.around(centre, self.widest, |c, at| {
            let place = &mut places[c];
            place.ink += mass * kernel::<D>((lattice.centre_at(at) - centre).norm2(), place.radius);
        });
    }

    /// The places within `step` more than a kernel of `centre`, without an element that is there: its source, scale and centre.
    pub(crate) fn around(
        &self,
        centre: Vector<D>,
        step: f64,
        without: Option<((u32, f64), Vector<D>)>,
        meter: &mut Meter<'_>,
    ) -> Result<Around<D>> {
        let mut found = Vec::new();
        self.lattice.around(centre, self.widest + step, |c, at| {
            let mut place = self.places[c];
            if place.scale <= 0.0 {
                return;
            }
            let p = self.lattice.centre_at(at);
            if let Some(((source, scale), own)) = without {
                let mass = self.mass((source, scale), own);
                place.ink -= mass * kernel::<D>((p - own).norm2(), place.radius);
            }
            found.push((p, place));
        });
        meter.spend(WORK * found.len() as u64)?;
        Ok(Around(found))
    }

    /// Price of these places with an element among them.
    pub(crate) fn price(&self, around: &Around<D>, element: Option<((u32, f64), Vector<D>)>) -> f64 {
        let (mass, centre) = element
            .map_or((0.0, Vector::ZERO), |((source, scale), centre)| (self.mass((source, scale), centre), centre));
        let mut sum = 0.0;
        for (p, place) in &around.0 {
            let ink = place.ink + mass * kernel::<D>((*p - centre).norm2(), place.radius);
            sum += self.excess(ink, place).powi(2);
        }
        sum * self.price
    }

    /// Price of the whole page.
    #[cfg(test)]
    pub(crate) fn total(&self) -> f64 {
        self.places.iter().map(|place| self.excess(place.ink, place).powi(2)).sum::<f64>() * self.price
    }

    /// By how many deviations a place is off, beyond what is natural.
    fn excess(&self, ink: f64, place: &Place) -> f64 {
        if place.scale <= 0.0 {
            return 0.0;
        }
        let off = ink * place.scale - place.usual;
        (off.abs() - NATURAL).max(0.0)
    }

    /// Places that are off, the worst first: how far, below or above 0, and where.
    pub(crate) fn off(&self) -> Vec<(f64, Vector<D>)> {
        let off = |(c, place): (usize, &Place)| {
            let excess = self.excess(place.ink, place);
            let is_thin = place.ink * place.scale < place.usual;
            (excess > 0.0).then(|| (if is_thin { -excess } else { excess }, self.lattice.centre(c)))
        };
        let mut found: Vec<_> = self.places.iter().enumerate().filter_map(off).collect();
        // Ties keep the order of the cells.
        found.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        found
    }
}
