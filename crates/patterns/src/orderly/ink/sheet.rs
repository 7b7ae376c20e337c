//! Fills of an exemplar as distances from their borders.

use arabesque_core::{Budget, Domain, Exemplar, FillRule, GridIndex, Outline, Result, Shape, Vector};

/// Ways in which fills are painted, at most.
const PAINTS: usize = 4;
/// Places for the width of a fill, and along the shorter side of the frame, at least and at most.
const PLACES: (f64, f64, f64) = (5.0, 40.0, 150.0);
/// How far distances are told, in widths.
const FAR: f64 = 2.0;
/// How near to a side of the frame a border runs along it, as a share of the side; and how near two colours are one.
const ALONG: f64 = 2e-3;
const COLOUR: f64 = 0.02;
/// Borders are looked at in such steps of the distance of places.
const STEP: f64 = 0.25;
/// Work for each place.
const WORK: u64 = 400;

/// Distances from borders on a grid over the frame: for each paint, positive where it is.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// The first area of each paint, from bottom to top.
    pub(crate) sources: Vec<usize>,
    /// Places along x and y.
    pub(crate) size: [usize; 2],
    /// Distance of places.
    pub(crate) step: f64,
    /// Mean distance from one border to the next.
    pub(crate) apart: f64,
    /// Row by row, the distances for all paints one after the other.
    pub(crate) values: Vec<f32>,
    /// The most that is told.
    pub(crate) far: f64,
    /// Whether these are heights, of which one sheet may lie whole numbers above another.
    pub(crate) is_height: bool,
}

impl Sheet {
    /// The fills of an exemplar; `None` where anything else is drawn.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        if !is_all_ink(exemplar) {
            return Ok(None);
        }
        let Some((sources, inks)) = inks(exemplar) else { return Ok(None) };
        let rings = inks.iter().flat_map(|ink| ink.rings.iter());
        let length: f64 = rings.map(|ring| shown(ring, exemplar)).sum();
        let area = exemplar.window.measure();
        if length <= 0.0 {
            return Ok(None);
        }
        let apart = area / length;
        let sides = exemplar.window.size();
        let shorter = sides[0].min(sides[1]);
        let step = (apart / PLACES.0).clamp(shorter / PLACES.2, shorter / PLACES.1);
        let size = [0, 1].map(|k| (sides[k] / step).floor() as usize + 1);
        let _held = budget.hold("distances from borders", size[0] * size[1] * inks.len() * size_of::<f32>())?;
        let mut sheet = Self { sources, size, step, apart, values: Vec::new(), far: FAR * apart, is_height: false };
        sheet.values = vec![0.0; size[0] * size[1] * inks.len()];
        for (channel, ink) in inks.iter().enumerate() {
            sheet.measure(channel, ink, exemplar, budget)?;
        }
        Ok(Some(sheet))
    }

    pub(crate) fn channels(&self) -> usize {
        self.sources.len()
    }

    /// Distances from the borders of one ink.
    fn measure(&mut self, channel: usize, ink: &Outline<2>, exemplar: &Exemplar<2>, budget: &Budget) -> Result<()> {
        let Some(shape) = Shape::try_new(&ink.rings, FillRule::NonZero, budget)? else { return Ok(()) };
        let mut places: Vec<Vector<2>> = Vec::new();
        for (a, b) in ink.edges().filter(|side| !is_along(*side, exemplar)) {
            let count = ((b - a).norm() / (STEP * self.step)).ceil().clamp(1.0, 1e4) as usize;
            budget.spend(count as u64)?;
            places.extend((0..count).map(|k| a + (b - a) * (k as f64 / count as f64)));
        }
        let index = GridIndex::new(&places, self.step, &Domain::Box(exemplar.window));
        let count = self.channels();
        for n in 0..self.size[0] * self.size[1] {
            let place = [n % self.size[0], n / self.size[0]].map(|i| i as f64 * self.step);
            let p = exemplar.window.min + Vector(place);
            budget.spend(WORK)?;
            let (nearest, looked) = index.nearest_counted(p, self.far, None);
            budget.spend(looked)?;
            let distance = nearest.map_or(self.far, |(_, distance)| distance);
            let sign = if shape.outline().contains(p) { 1.0 } else { -1.0 };
            self.values[n * count + channel] = (sign * distance) as f32;
        }
        Ok(())
    }
}

/// Whether nothing but fills of a few paints is drawn.
pub(crate) fn is_all_ink(exemplar: &Exemplar<2>) -> bool {
    let has_fills_alone = !exemplar.areas.is_empty() && exemplar.curves.is_empty() && exemplar.hole.is_none();
    has_fills_alone && inks(exemplar).is_some()
}

/// The first area of each paint, and all that is painted so; `None` for too many, or where elements are painted otherwise.
fn inks(exemplar: &Exemplar<2>) -> Option<(Vec<usize>, Vec<Outline<2>>)> {
    let (mut sources, mut inks): (Vec<usize>, Vec<Outline<2>>) = (Vec::new(), Vec::new());
    for (a, area) in exemplar.areas.iter().enumerate() {
        let k = sources.iter().position(|&s| exemplar.areas[s].style == area.style).unwrap_or_else(|| {
            sources.push(a);
            inks.push(Outline::default());
            sources.len() - 1
        });
        inks[k].rings.extend(area.outline.rings.iter().cloned());
    }
    for element in &exemplar.elements {
        let is_like = |s: &usize| {
            let other = exemplar.areas[*s].colour;
            element.colour.iter().zip(other).all(|(a, b)| (a - b).abs() < COLOUR)
        };
        let k = sources.iter().position(is_like)?;
        inks[k].rings.extend(element.outline.rings.iter().cloned());
    }
    (sources.len() <= PAINTS).then_some((sources, inks))
}

/// Whether a side of a ring runs along the frame, or beyond it.
fn is_along((a, b): (Vector<2>, Vector<2>), exemplar: &Exemplar<2>) -> bool {
    let window = &exemplar.window;
    (0..2).any(|k| {
        let near = ALONG * window.size()[k];
        let [low, high] = [window.min[k] + near, window.max[k] - near];
        (a[k] <= low && b[k] <= low) || (a[k] >= high && b[k] >= high)
    })
}

/// Length of a ring in the frame.
fn shown(ring: &[Vector<2>], exemplar: &Exemplar<2>) -> f64 {
    let sides = ring.iter().copied().zip(ring.iter().copied().cycle().skip(1));
    sides.filter(|side| !is_along(*side, exemplar)).map(|(a, b)| (b - a).norm()).sum()
}
