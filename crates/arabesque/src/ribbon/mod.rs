//! Ribbons: pictures and drawings along curves of the plane or of space.

mod made;
mod picture;
mod strips;
mod track;

use std::sync::Arc;

use arabesque_core::{Error, Result, Watch};

use crate::{
    artwork::Artwork,
    method::{Preparation, Ready, RunContext, Show},
    recipe::Ribbon,
};
use made::RibbonMade;
use picture::resolution_of_canvas;
use strips::RibbonStrips;
use track::Track;

/// Exemplars of ribbons, analysed.
#[derive(Debug)]
pub(crate) struct Strips(Arc<RibbonStrips>);

/// Reads the exemplars of a ribbon.
pub(crate) fn prepare(ribbon: &Ribbon, preparation: &mut Preparation<'_>) -> Result<Strips> {
    Ok(Strips(Arc::new(strips::read(ribbon, preparation)?)))
}

impl Ready for Strips {
    fn understood(&self) -> String {
        let sizes = self.0.engine.exemplars().iter().map(|e| format!("{} x {} pixels", e.image.width, e.image.height));
        let sizes = sizes.collect::<Vec<_>>().join(", then ");
        match self.0.engine.objects() {
            Some(1) => format!("exemplar: {sizes}: one object, laid whole"),
            Some(n) => format!("exemplar: {sizes}: {n} separate objects, laid whole with gaps like its own"),
            None => format!("exemplar: {sizes}"),
        }
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        resolution_of_canvas(context.output(), None)?;
        let track = Arc::new(Track::of(&mut context, self.0.finer)?);
        track.check_picture(context.output(), context.budget())?;
        let origin = context.origin();
        let mut made = match &*track {
            Track::Plane { request, .. } => {
                let make = |snapshot| RibbonMade::of_plane(&self.0, &track, snapshot);
                let outcome = self.0.engine.run(request, &mut Show { watch, origin: &origin, make })?;
                RibbonMade::new(&self.0, &track, outcome.ribbons.into(), outcome.warnings, outcome.stopped)
            }
            Track::Space { request } => {
                let make = |snapshot| RibbonMade::of_space(&self.0, &track, snapshot);
                let outcome = self.0.engine.run_in_space(request, &mut Show { watch, origin: &origin, make })?;
                RibbonMade::new(&self.0, &track, outcome.ribbons.into(), outcome.warnings, outcome.stopped)
            }
        };
        if made.pieces() == 0 {
            return Err(Error::no_result("stopped before anything was placed", "give it more time"));
        }
        made.warnings.splice(0..0, context.warnings);
        Ok(Artwork::new(origin, made))
    }
}
