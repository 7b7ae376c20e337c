//! White noise: single elements at random places, as many of each class as the exemplar has for the area.

use arabesque_core::{Request, Result, Stream, Vector};

use crate::{
    border::Extent,
    exemplar::library::Library,
    output::{canvas::Canvas, draft::Item},
    streams,
};

/// Nanoseconds for a place that is tried.
const TRY: u64 = 300;

/// Scatters elements over the domain.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the canvas holds those scattered before.
pub(crate) fn scatter<const D: usize>(
    library: &Library<D>,
    request: &Request<D>,
    extent: &Extent<'_, D>,
    canvas: &mut Canvas<D>,
) -> Result<()> {
    let budget = request.budget.stage("scattering elements");
    let mut meter = budget.meter();
    let bounds = if request.domain.period().is_some() {
        request.domain.bounds()
    } else {
        request.domain.bounds().grown(extent.margin)
    };
    let mut random = Stream::new(request.seed, streams::INITIALISE, u64::MAX);
    let copyable: Vec<u32> = (0..library.len() as u32).filter(|&e| library.copyable[e]).collect();
    // Rejection keeps the density right under fields: a place is kept with the probability that its local density gives
    // it.
    let tightest = extent.smallest_spacing_scale;
    let tries = bounds.measure() / (library.spacing * tightest).powi(D as i32);
    for _ in 0..tries as usize {
        meter.spend(TRY)?;
        let p = Vector(std::array::from_fn(|k| random.range(bounds.min[k], bounds.max[k])));
        let source = copyable[random.below(copyable.len())];
        let keep = (tightest / request.fields.frame(p).spacing_scale).powi(D as i32);
        if random.unit() < keep && extent.admits(source, p) {
            canvas.push(Item { source, position: p, frozen: None });
        }
    }
    Ok(())
}
