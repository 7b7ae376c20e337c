//! Ribbons as files.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Decimals, Error, Held, Patch, Result, Snapshot, StopReason, Vector, Warning};
use arabesque_io::{
    json::ribbon,
    mesh::{
        gltf,
        obj::strips,
        strip::{Part, Strip},
    },
    raster::png,
    svg::{Area, Cell, Embedded, Filled, Look, Page, RibbonSheet, areas_markup, write_ribbons},
    text::unit::PIXELS_PER_INCH,
};
use arabesque_ribbons::{Piece, Ribbon, Rung, StripExemplar, facets, rungs, shown_areas};

use crate::{
    artwork::{Encoded, Geometry, Made, RibbonSummary, Sheet, Summary},
    recipe::{Format, OutputOptions, encode},
    ribbon::{picture, strips::RibbonStrips, track::Track},
};

/// Pixels per metre of an embedded picture.
const PER_METRE: f64 = PIXELS_PER_INCH / 0.0254;

/// Elements that a piece counts as, for the work of drawing it.
const DRAWN: f64 = 0.25;

/// Bytes and work of one cell of a strip: four corners with their places in the picture, and two triangles.
const CELL: usize = 4 * 40 + 2 * 12;
const CELL_WORK: u64 = 300;

/// Ribbons along curves.
#[derive(Debug)]
pub(crate) struct RibbonMade {
    strips: Arc<RibbonStrips>,
    track: Arc<Track>,
    laid: Laid,
    pub(crate) warnings: Vec<Warning>,
    stopped: StopReason,
}

/// Ribbons of the plane or of space, one for each curve; fewer when the run was stopped.
#[derive(Debug)]
pub(crate) enum Laid {
    Plane(Vec<Ribbon<2>>),
    Space(Vec<Ribbon<3>>),
}

impl From<Vec<Ribbon<2>>> for Laid {
    fn from(ribbons: Vec<Ribbon<2>>) -> Self {
        Self::Plane(ribbons)
    }
}

impl From<Vec<Ribbon<3>>> for Laid {
    fn from(ribbons: Vec<Ribbon<3>>) -> Self {
        Self::Space(ribbons)
    }
}

impl RibbonMade {
    pub(crate) fn new(
        strips: &Arc<RibbonStrips>,
        track: &Arc<Track>,
        laid: Laid,
        warnings: Vec<Warning>,
        stopped: StopReason,
    ) -> Self {
        Self { strips: Arc::clone(strips), track: Arc::clone(track), laid, warnings, stopped }
    }

    /// What a run in the plane has so far.
    pub(crate) fn of_plane(strips: &Arc<RibbonStrips>, track: &Arc<Track>, snapshot: Snapshot<2>) -> Self {
        Self::new(strips, track, Laid::Plane(vec![unfinished(snapshot)]), Vec::new(), StopReason::Stopped)
    }

    /// What a run in space has so far.
    pub(crate) fn of_space(strips: &Arc<RibbonStrips>, track: &Arc<Track>, snapshot: Snapshot<3>) -> Self {
        Self::new(strips, track, Laid::Space(vec![unfinished(snapshot)]), Vec::new(), StopReason::Stopped)
    }

    /// Refuses another resolution than that of the run where areas are avoided, which is done pixel by pixel.
    fn check_resolution(&self, sheet: &Sheet<'_>) -> Result<()> {
        let avoids = matches!(&*self.track, Track::Plane { request, .. } if request.avoid.is_some());
        let resolution = |output: &OutputOptions| (output.dpi, output.pixels_per_unit);
        if !avoids || resolution(sheet.output) == resolution(sheet.ran) {
            return Ok(());
        }
        Err(Error::Unsupported {
            what: "another resolution than that of the run, where areas are avoided pixel by pixel".into(),
            advice: "give the resolution in the recipe before it is prepared".into(),
        })
    }

    /// Number of pieces of each ribbon.
    fn lengths(&self) -> Vec<usize> {
        match &self.laid {
            Laid::Plane(ribbons) => ribbons.iter().map(|r| r.pieces.len()).collect(),
            Laid::Space(ribbons) => ribbons.iter().map(|r| r.pieces.len()).collect(),
        }
    }

    /// Number of pieces of all ribbons.
    pub(crate) fn pieces(&self) -> usize {
        self.lengths().iter().sum()
    }

    /// Cost of all ribbons together, in 8-bit colour steps.
    fn cost(&self) -> f64 {
        match &self.laid {
            Laid::Plane(ribbons) => ribbons.iter().map(|r| r.cost).sum(),
            Laid::Space(ribbons) => ribbons.iter().map(|r| r.cost).sum(),
        }
    }

    fn exemplars(&self) -> &[StripExemplar] {
        self.strips.engine.exemplars()
    }

    /// What each curve is called.
    fn names(&self) -> Vec<&str> {
        match &*self.track {
            Track::Plane { request, .. } => request.curves.iter().map(|(name, _)| name.as_str()).collect(),
            Track::Space { request } => request.curves.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    /// Largest side of what is shown.
    fn extent(&self) -> f64 {
        let sides = match (&self.laid, &*self.track) {
            (_, Track::Plane { page, .. }) => page.view.size().0.to_vec(),
            (Laid::Space(ribbons), _) => {
                let corners = ribbons.iter().flat_map(|r| &r.pieces).flat_map(|p| p.patch.corners);
                Bounds::around(corners).size().0.to_vec()
            }
            (Laid::Plane(_), Track::Space { .. }) => Vec::new(),
        };
        sides.into_iter().fold(0.0, f64::max)
    }

    fn json(&self, recipe: Option<&str>, budget: &Budget) -> Result<String> {
        match &self.laid {
            Laid::Plane(ribbons) => self.json_of(ribbons, recipe, budget),
            Laid::Space(ribbons) => self.json_of(ribbons, recipe, budget),
        }
    }

    fn json_of<const D: usize>(&self, ribbons: &[Ribbon<D>], recipe: Option<&str>, budget: &Budget) -> Result<String> {
        let lines = ribbons.iter().zip(self.names()).map(|(ribbon, name)| ribbon::RibbonLine {
            name,
            closed: ribbon.closed,
            cost: ribbon.cost,
            pieces: ribbon.pieces.iter().map(|p| (p.patch, p.shift.as_slice())).collect(),
        });
        let sizes = self.exemplars().iter().map(|e| [e.image.width, e.image.height]);
        ribbon::write_ribbons(&ribbon::Document {
            exemplars: self.strips.sources.iter().map(|s| s.name.as_str()).zip(sizes).collect(),
            ribbons: lines.collect(),
            page: match &*self.track {
                Track::Plane { page, .. } => Some([page.view.min.0, page.view.size().0]),
                Track::Space { .. } => None,
            },
            extent: self.extent(),
            warnings: &self.warnings,
            recipe,
            budget,
        })
    }

    /// A textured strip for each exemplar, and its memory.
    fn parts(&self, pictures: Pictures, budget: &Budget) -> Result<(Vec<Part>, Held)> {
        let mut parts = Vec::new();
        for (exemplar, source) in self.exemplars().iter().zip(&self.strips.sources) {
            let picture = match pictures {
                Pictures::Held => png::write_image(&exemplar.image, PER_METRE, None, budget)?,
                Pictures::Left => Vec::new(),
            };
            parts.push(Part { name: source.name.clone(), picture, strip: Strip::default() });
        }
        let held = match &self.laid {
            // A drawing has its y axis downwards, a mesh upwards.
            Laid::Plane(ribbons) => self.strips(ribbons, |p| [p[0], -p[1], 0.0], &mut parts, budget),
            Laid::Space(ribbons) => self.strips(ribbons, |p| p.0, &mut parts, budget),
        }?;
        Ok((parts, held))
    }

    fn strips<const D: usize>(
        &self,
        ribbons: &[Ribbon<D>],
        at: fn(Vector<D>) -> [f64; 3],
        parts: &mut [Part],
        budget: &Budget,
    ) -> Result<Held> {
        let cells = |p: &Piece<D>| p.shift.len() + 1;
        let most: usize = ribbons.iter().flat_map(|r| &r.pieces).map(cells).sum();
        let held = budget.hold("triangles of the strips", most.saturating_mul(CELL))?;
        budget.spend(CELL_WORK * most as u64)?;
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
        Ok(held)
    }

    /// The exemplars as areas, where they are drawings.
    fn drawings(&self) -> Option<Vec<&[Area]>> {
        self.strips.sources.iter().map(|s| s.areas.as_deref()).collect()
    }

    fn svg(&self, ribbons: &[Ribbon<2>], page: &Page, recipe: Option<&str>, budget: &Budget) -> Result<String> {
        let size = page.view.size();
        let decimals = Decimals::for_extent(size[0].max(size[1]));
        let drawings = self.drawings();
        let mut pictures = Vec::new();
        if drawings.is_none() {
            for exemplar in self.exemplars() {
                let data = encode(&png::write_image(&exemplar.image, PER_METRE, None, budget)?);
                pictures.push(Embedded { size: [exemplar.image.width, exemplar.image.height], data });
            }
        }
        let look = |ribbon: &Ribbon<2>| match &drawings {
            Some(drawings) => markup(ribbon, drawings, decimals, budget).map(Look::Markup),
            None => self.cells(ribbon, budget).map(Look::Cells),
        };
        let looks = ribbons.iter().zip(self.names()).map(|(r, name)| Ok((name.to_owned(), look(r)?)));
        let looks = looks.collect::<Result<Vec<_>>>()?;
        write_ribbons(&RibbonSheet { page: *page, pictures: &pictures, ribbons: &looks, recipe, budget })
    }

    /// The facets of all pieces, as SVG has them.
    fn cells(&self, ribbon: &Ribbon<2>, budget: &Budget) -> Result<Vec<Cell>> {
        let mut cells = Vec::new();
        for piece in &ribbon.pieces {
            let Some(exemplar) = self.exemplars().get(piece.patch.source) else { continue };
            let facets = facets(piece, &exemplar.image, budget)?;
            cells.extend(facets.into_iter().map(|f| Cell { source: f.source, ring: f.ring, matrix: f.matrix }));
        }
        Ok(cells)
    }
}

/// The pieces of a snapshot as one ribbon: which curve each follows is known when they are all laid.
fn unfinished<const D: usize>(snapshot: Snapshot<D>) -> Ribbon<D> {
    let pieces = snapshot.patches.into_iter().map(|patch| Piece { patch, shift: Vec::new() }).collect();
    Ribbon { pieces, closed: false, cost: 0.0 }
}

fn patches<const D: usize>(ribbons: &[Ribbon<D>]) -> Vec<Patch<D>> {
    ribbons.iter().flat_map(|r| &r.pieces).map(|piece| piece.patch).collect()
}

impl Made for RibbonMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let (recipe, budget) = (sheet.recipe, sheet.budget);
        budget.allow_elements(DRAWN * self.pieces() as f64);
        self.check_resolution(sheet)?;
        let mut warnings = Vec::new();
        let bytes = match (sheet.format, &self.laid, &*self.track) {
            (Format::Json, ..) => self.json(recipe, budget)?.into_bytes(),
            (Format::Obj, ..) => {
                let (parts, _held) = self.parts(Pictures::Left, budget)?;
                strips::write_strips(&parts, self.extent(), recipe, budget)?.into_bytes()
            }
            (Format::Glb, ..) => {
                let (parts, _held) = self.parts(Pictures::Held, budget)?;
                gltf::write_glb(&parts, recipe, budget)?
            }
            (Format::Png, Laid::Plane(ribbons), Track::Plane { request, page, .. }) => {
                let avoid = request.avoid.as_ref();
                let picture = match self.drawings() {
                    Some(_) => picture::of_drawing(&self.svg(ribbons, page, None, budget)?, avoid, page, sheet)?,
                    None => picture::of_pieces(ribbons, self.exemplars(), avoid, page, sheet)?,
                };
                warnings = picture.warnings;
                picture.bytes
            }
            (Format::Svg, Laid::Plane(ribbons), Track::Plane { page, .. }) => {
                self.svg(ribbons, page, recipe, budget)?.into_bytes()
            }
            _ => {
                let space = matches!(self.laid, Laid::Space(_));
                let (kind, advice) =
                    if space { ("in space ", "json, obj or glb") } else { ("", "png, svg, json, obj or glb") };
                let what = format!("a ribbon {kind}as {}", sheet.format.name());
                return Err(Error::Unsupported { what, advice: format!("write {advice}") });
            }
        };
        if sheet.output.expand {
            let message = "ribbons are always written in place: expand has no meaning for them";
            warnings.push(Warning::new(message, "leave it out"));
        }
        Ok(Encoded { bytes, warnings, companion: None })
    }

    fn summary(&self) -> Summary {
        let ribbons = self.lengths().iter().filter(|n| **n > 0).count();
        let summary = RibbonSummary { ribbons, pieces: self.pieces(), cost: self.cost() };
        Summary { ribbons: Some(summary), ..Summary::default() }
    }

    fn geometry(&self) -> Geometry {
        match &self.laid {
            Laid::Plane(ribbons) => Geometry::Plane(Snapshot { patches: patches(ribbons), ..Snapshot::default() }),
            Laid::Space(ribbons) => Geometry::Space(Snapshot { patches: patches(ribbons), ..Snapshot::default() }),
        }
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    fn stopped(&self) -> StopReason {
        self.stopped
    }
}

/// A ribbon of drawings, as SVG.
fn markup(ribbon: &Ribbon<2>, drawings: &[&[Area]], decimals: Decimals, budget: &Budget) -> Result<String> {
    let outlines: Vec<Vec<_>> = drawings.iter().map(|areas| areas.iter().map(|a| &a.outline).collect()).collect();
    let shown = shown_areas(ribbon, &outlines, budget)?;
    let filled = shown.iter().map(|s| {
        let Area { colour, opacity, .. } = &drawings[s.source][s.area];
        Filled { outline: &s.outline, tolerance: s.tolerance, colour, opacity: *opacity }
    });
    areas_markup(filled, decimals, budget)
}

/// Whether a mesh holds its pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pictures {
    Held,
    Left,
}
