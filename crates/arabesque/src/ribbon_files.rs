//! Ribbons as files.

use arabesque_core::{Bounds, Decimals, Error, Result, Vector};
use arabesque_io::{
    gltf::{self, Part},
    obj_strip, png, ribbon_json,
    strip::Strip,
    svg::{Area, Cell, Embedded, Filled, Look, Page, RibbonSheet, areas_markup, write_ribbons},
};
use arabesque_ribbons::{Exemplar, Piece, Ribbon, Rung, facets, rungs, shown_areas};

use crate::{
    Encoded, Format, OutputOptions,
    input::encode,
    ribbon::{Laid, RibbonArtwork, Track},
};

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
    pub(crate) fn drawings(&self) -> Option<Vec<&[Area]>> {
        self.prepared.sources.iter().map(|s| s.areas.as_deref()).collect()
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

    /// The facets of a piece, as SVG has them.
    fn cells(&self, piece: &Piece<2>) -> impl Iterator<Item = Cell> {
        let exemplar = self.exemplars().get(piece.patch.source);
        let facets = exemplar.map(|exemplar| facets(piece, &exemplar.image)).unwrap_or_default();
        facets.into_iter().map(|f| Cell { source: f.source, ring: f.ring, matrix: f.matrix })
    }
}

/// A ribbon of drawings, as SVG.
fn markup(ribbon: &Ribbon<2>, drawings: &[&[Area]], decimals: Decimals) -> String {
    let outlines: Vec<Vec<_>> = drawings.iter().map(|areas| areas.iter().map(|a| &a.outline).collect()).collect();
    let shown = shown_areas(ribbon, &outlines);
    let filled = shown.iter().map(|s| {
        let Area { colour, opacity, .. } = &drawings[s.source][s.area];
        Filled { outline: &s.outline, tolerance: s.tolerance, colour, opacity: *opacity }
    });
    areas_markup(filled, decimals)
}

/// Whether a mesh holds its pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pictures {
    Held,
    Left,
}
