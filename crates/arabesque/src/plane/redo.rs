//! Filling a region of a drawing again, from what lies around it or from another region.

use arabesque_core::{Border, Bounds, Budget, Error, Result, Shape, Vector, Warning};
use arabesque_io::{
    file,
    svg::{Document, Drawing, HostDocument, LargeFills, Parts, ReadOptions, Tiling},
};
use arabesque_patterns::regular;

use crate::{
    exemplar::{has_recurring_parts, repeats},
    method::Preparation,
    plane::{
        exemplar::{PlaneExemplar, RegionOfFile},
        place::{Place, Units, read_shape},
    },
    recipe::{Job, Redo, Region},
    resources::Files,
    spacing::spacing,
};

/// Shortest side of what serves as the example, in mean spacings.
const MIN_SIDE: f64 = 1.5;

/// A region hangs over the page when more than this share of it does.
const OVERHANG: f64 = 0.01;

/// Reads the drawing, and takes it apart into the example, the region and what stays.
pub(crate) fn read(redo: &Redo, large_fills: LargeFills, preparation: &mut Preparation<'_>) -> Result<PlaneExemplar> {
    check_border(redo.border)?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let name = preparation.exemplar.name().to_owned();
    let text = drawing_text(&name, &bytes, preparation.files.budget())?;
    let own = |region: &Region| if let Region::Own(id) = region { Some(id.clone()) } else { None };
    let mut options = ReadOptions {
        budget: preparation.files.budget().clone(),
        method: redo.method.of_drawings()?,
        tiling: Tiling::Page,
        large_fills,
        without: std::iter::once(&redo.region).chain(&redo.from).filter_map(own).collect(),
        ..ReadOptions::new(&*name)
    };
    // One parse serves the example, the regions and what stays.
    let (files, mut warnings) = (preparation.files, Vec::new());
    let mut split = |options: &ReadOptions| {
        warnings.clear();
        Document::with(&text, options, |document| HostFile { document, name: &name, files }.split(redo, &mut warnings))
    };
    let (mut drawing, mut region) = split(&options)?;
    if has_recurring_parts(&drawing) {
        // What a repeat keeps in place needs not be put together.
        let apart = ReadOptions { parts: Parts::Apart, ..options.clone() };
        if let Ok(found) = split(&apart)
            && repeats(&found.0, files.budget())?
        {
            (drawing, region) = found;
            options = apart;
        } else {
            (drawing, region) = split(&options)?;
        }
    }
    if !drawing.exemplar.areas.is_empty() && regular(&drawing.exemplar, files.budget())?.is_none() {
        // Without a repeat, lines are all that can be made of areas.
        (drawing, region) = split(&ReadOptions { large_fills: LargeFills::Lines, ..options })?;
    }
    preparation.warnings.append(&mut warnings);
    preparation.exemplar = preparation.exemplar.embedding(&bytes);
    let mut job = redo.clone();
    for region in std::iter::once(&mut job.region).chain(job.from.as_mut()) {
        if let Region::Shape(input) = region {
            preparation.files.embed(input)?;
        }
    }
    preparation.job = Job::Redo(job);
    Ok(PlaneExemplar { drawing, points: None, region: Some(region) })
}

/// Refuses strokes that turn at the border of a region.
pub(crate) fn check_border(border: Option<Border>) -> Result<()> {
    if border != Some(Border::Turn) {
        return Ok(());
    }
    let expected = "inside, cross or clip: at the border of a region that is filled again the strokes around it go on";
    Err(Error::parameter("border", "turn", expected))
}

/// The text of a drawing.
fn drawing_text(name: &str, bytes: &[u8], budget: &Budget) -> Result<String> {
    let text =
        if arabesque_io::raster::png::is_png(bytes) { String::new() } else { file::decode_text(name, bytes, budget)? };
    if text.trim_start().starts_with('<') {
        return Ok(text);
    }
    Err(Error::Unsupported {
        what: format!("{name}: filling a region of anything but an SVG drawing again"),
        advice: "give an SVG drawing".into(),
    })
}

/// The drawing of which a region is filled again.
struct HostFile<'a, 'd> {
    document: &'a Document<'d>,
    name: &'a str,
    files: &'a Files,
}

impl HostFile<'_, '_> {
    /// The part that serves as the example, and the region with everything that stays.
    fn split(&self, redo: &Redo, warnings: &mut Vec<Warning>) -> Result<(Drawing, RegionOfFile)> {
        let target = &redo.region;
        let drawing = self.document.exemplar()?;
        let whole = self.shape(target, &drawing)?;
        let budget = self.files.budget().stage("cutting the region at the page");
        let on_page = |page: Shape| whole.within(&page, &budget);
        let Some(shape) = Shape::rectangle(drawing.page.view).map_or(Ok(None), on_page)? else {
            let advice = "give a region on the page: x,y,w,h in the units of the file, or the id of a shape";
            return Err(Error::input(self.place_of(target), "the region lies off the page", advice));
        };
        let area = whole.outline().area();
        warnings.extend(overhang(&self.place_of(target), area - shape.outline().area(), area));
        let rest = self.document.host(&drawing, shape.outline())?;
        let (window, hole) = match &redo.from {
            Some(from) => (self.source_window(from, &drawing)?, None),
            None => {
                let hole = shape.outline().bounds();
                check_rim(&drawing, &hole, &rest, &self.place_of(target))?;
                (drawing.exemplar.window, Some(hole))
            }
        };
        let page = drawing.page;
        let place = self.place_of(redo.from.as_ref().unwrap_or(target));
        let drawing = drawing.within(window, hole, &place).map_err(|_| {
            let advice = "choose a region that holds a few elements or curves of the pattern";
            Error::input(place, "nothing of the drawing lies in the region that is to be the example", advice)
        })?;
        // What stays is matched to what is left as the example.
        let rest = self.document.host(&drawing, shape.outline())?;
        let region = RegionOfFile { name: target.to_string(), place: Place::shaped(shape, page), rest };
        Ok((drawing, region))
    }

    fn place_of(&self, region: &Region) -> String {
        format!("{}: region {region}", self.name)
    }

    fn shape(&self, region: &Region, drawing: &Drawing) -> Result<Shape> {
        match region {
            Region::Box([x, y, w, h]) => {
                region.check()?;
                let corner = Vector::xy(*x, *y);
                let shape = Shape::rectangle(Bounds::new(corner, corner + Vector::xy(*w, *h)));
                shape.ok_or_else(|| Error::parameter("region", region, "a box with an area"))
            }
            Region::Own(id) => Ok(self.document.shape(Some(id))?.0),
            Region::Shape(input) => Ok(read_shape(input, drawing, Units::OfPage, self.files)?.0),
        }
    }

    /// The window of the example: the box around the region that is copied from.
    fn source_window(&self, from: &Region, drawing: &Drawing) -> Result<Bounds<2>> {
        let own = self.shape(from, drawing)?.outline().bounds();
        let all = drawing.exemplar.window;
        let window = Bounds::new(own.min.zip(all.min, f64::max), own.max.zip(all.max, f64::min));
        if !window.is_empty() && window.measure() > 0.0 {
            return Ok(window);
        }
        let advice = "give a region that the pattern covers";
        Err(Error::input(self.place_of(from), "the region to copy from lies off the drawing", advice))
    }
}

/// Warns of a region of which a part lies off the page.
fn overhang(place: &str, lost: f64, area: f64) -> Option<Warning> {
    (lost > OVERHANG * area).then(|| {
        Warning::new(
            format!("{place}: {:.0} % of the region lie off the page and are not filled", 100.0 * lost / area),
            "make the page larger, or the region smaller",
        )
    })
}

/// Refuses a hole that leaves too little around it, for what lies in the hole is to be no example.
fn check_rim(drawing: &Drawing, hole: &Bounds<2>, rest: &HostDocument, place: &str) -> Result<()> {
    if !hole.intersects(&rest.content) {
        let advice = "give a region that the drawing reaches into";
        return Err(Error::input(place, "nothing of the drawing lies in or around the region", advice));
    }
    let all = drawing.exemplar.window;
    let strip = |k: usize, low: f64, high: f64| {
        let (mut a, mut b) = (all.min, all.max);
        (a[k], b[k]) = (a[k].max(low), b[k].min(high));
        Bounds::new(a, b)
    };
    let strips = (0..2).flat_map(|k| [strip(k, f64::NEG_INFINITY, hole.min[k]), strip(k, hole.max[k], f64::INFINITY)]);
    if !drawing.exemplar.areas.is_empty() {
        // Whether enough of them is left for a repeat shows when that is looked for.
        return Ok(());
    }
    let least = MIN_SIDE * spacing(&drawing.exemplar);
    if strips.filter(|s| !s.is_empty()).any(|s| s.size()[0].min(s.size()[1]) >= least) {
        return Ok(());
    }
    Err(Error::input(
        place,
        "the region leaves too little of the drawing to be the example",
        "make the region smaller, or say with --from REGION --to REGION where the example is",
    ))
}
