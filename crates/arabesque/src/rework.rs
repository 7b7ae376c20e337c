//! Making a part of a drawing anew: redo of a region, and copying the pattern of one region into another.

use arabesque_core::{Bounds, Error, Result, Shape, Vector, Warning};
use arabesque_io::{
    file,
    svg::{self, Drawing, ReadOptions, Rest},
};

use crate::{
    Region,
    prepare::{Place, Preparation, shaped},
    recipe::{BorderRule, Method},
    spacing::spacing,
};

/// Shortest side of what serves as the example, in mean spacings.
const LEAST_SIDE: f64 = 1.5;

/// A region hangs over the page when more than this share of it does.
const OVERHANG: f64 = 0.01;

/// A drawing of which a part is made anew.
pub(crate) struct Rework {
    /// The part that serves as the example.
    pub(crate) drawing: Drawing,
    pub(crate) place: Place,
    /// Everything that stays.
    pub(crate) rest: Rest,
}

impl Preparation<'_> {
    /// What is made anew, if the recipe says so.
    pub(crate) fn rework(&mut self, bytes: &[u8]) -> Result<Option<Rework>> {
        let Some(target) = self.target()? else { return Ok(None) };
        let name = self.recipe.exemplar.name().to_owned();
        let text = self.drawing_text(bytes)?;
        let mut options = ReadOptions { limits: self.limits, method: self.method()?, ..ReadOptions::new(&*name) };
        for region in [Some(&target), self.recipe.from.as_ref()].into_iter().flatten() {
            if let Region::Own(id) = region {
                options.without.push(id.clone());
            }
        }
        let drawing = svg::read_exemplar(&text, &options)?;
        let place_of = |region: &Region| format!("{name}: region {region}");
        let whole = self.region(&target, &text, &drawing)?;
        let page = Shape::rectangle(drawing.page.view);
        let Some(shape) = page.and_then(|page| whole.within(&page)) else {
            let advice = "give a region on the page: x,y,w,h in the units of the file, or the id of a shape";
            return Err(Error::input(place_of(&target), "the region lies off the page", advice));
        };
        self.note_overhang(&place_of(&target), whole.outline().area() - shape.outline().area(), whole.outline().area());
        let rest = svg::read_rest(&text, &drawing, shape.outline(), &options)?;
        let (window, hole) = match self.recipe.from.clone() {
            Some(from) => (self.source_window(&from, &text, &drawing)?, None),
            None => {
                let hole = shape.outline().bounds();
                check_rim(&drawing, &hole, &rest, &place_of(&target))?;
                (drawing.exemplar.window, Some(hole))
            }
        };
        let page = drawing.page;
        let place = place_of(self.recipe.from.as_ref().unwrap_or(&target));
        let drawing = drawing.within(window, hole, &place).map_err(|_| {
            let advice = "choose a region that holds a few elements or curves of the pattern";
            Error::input(place, "nothing of the drawing lies in the region that is to be the example", advice)
        })?;
        // What stays is matched to what is left as the example.
        let rest = svg::read_rest(&text, &drawing, shape.outline(), &options)?;
        self.carry_regions()?;
        Ok(Some(Rework { drawing, place: shaped(shape, page), rest }))
    }

    /// The region that is made anew.
    fn target(&self) -> Result<Option<Region>> {
        let recipe = &self.recipe;
        let target = match (&recipe.redo, &recipe.from, &recipe.to) {
            (None, None, None) => return Ok(None),
            (Some(region), None, None) | (None, Some(_), Some(region)) => region.clone(),
            (Some(_), ..) => {
                return Err(Error::parameter("redo", "given with from or to", "redo alone, or from and to"));
            }
            (None, Some(_), None) => return Err(Error::parameter("from", "given without to", "both from and to")),
            (None, None, Some(_)) => return Err(Error::parameter("to", "given without from", "both from and to")),
        };
        if recipe.border == Some(BorderRule::Turn) {
            let expected =
                "inside, cross or clip: at the border of a region that is made anew the strokes around it go on";
            return Err(Error::parameter("border", "turn", expected));
        }
        let others = [recipe.size.is_some(), recipe.tile.is_some(), recipe.domain.is_some(), recipe.keep.is_some()];
        if others.contains(&true) {
            let name = if recipe.redo.is_some() { "redo" } else { "to" };
            let value = "given with size, tile, domain or keep";
            return Err(Error::parameter(
                name,
                value,
                "the region alone: the page and what stays are those of the file",
            ));
        }
        Ok(Some(target))
    }

    fn method(&self) -> Result<svg::Method> {
        match self.recipe.method {
            Method::Auto => Ok(svg::Method::Auto),
            Method::Elements => Ok(svg::Method::Elements),
            Method::Curves => Ok(svg::Method::Curves),
            Method::Structures => Err(Error::parameter(
                "method",
                "structures",
                "auto, elements or curves; structures are not handled yet",
            )),
        }
    }

    fn drawing_text(&self, bytes: &[u8]) -> Result<String> {
        let name = self.recipe.exemplar.name();
        let text = if arabesque_io::png::is_png(bytes) { String::new() } else { file::decode_text(name, bytes)? };
        if text.trim_start().starts_with('<') {
            return Ok(text);
        }
        Err(Error::Unsupported {
            what: format!("{name}: making a region anew of anything but an SVG drawing"),
            advice: "give an SVG drawing".into(),
        })
    }

    fn region(&self, region: &Region, text: &str, drawing: &Drawing) -> Result<Shape> {
        let name = self.recipe.exemplar.name();
        match region {
            Region::Box([x, y, w, h]) => {
                let corner = Vector::xy(*x, *y);
                let shape = Shape::rectangle(Bounds::new(corner, corner + Vector::xy(*w, *h)));
                shape.ok_or_else(|| Error::parameter("region", region, "a box with an area"))
            }
            Region::Own(id) => {
                let options = ReadOptions { limits: self.limits, ..ReadOptions::new(name) };
                Ok(svg::read_shape(text, Some(id), &options)?.0)
            }
            Region::Shape(input) => Ok(self.shape(input, drawing, false)?.0),
        }
    }

    /// The window of the example: the box around the region that is copied from.
    fn source_window(&self, from: &Region, text: &str, drawing: &Drawing) -> Result<Bounds<2>> {
        let own = self.region(from, text, drawing)?.outline().bounds();
        let all = drawing.exemplar.window;
        let window = Bounds::new(own.min.zip(all.min, f64::max), own.max.zip(all.max, f64::min));
        if !window.is_empty() && window.measure() > 0.0 {
            return Ok(window);
        }
        let place = format!("{}: region {from}", self.recipe.exemplar.name());
        let advice = "give a region that the pattern covers";
        Err(Error::input(place, "the region to copy from lies off the drawing", advice))
    }

    /// Warns of a region of which a part lies off the page.
    fn note_overhang(&mut self, place: &str, lost: f64, area: f64) {
        if lost > OVERHANG * area {
            self.warnings.push(Warning::new(
                format!("{place}: {:.0} % of the region lie off the page and are not filled", 100.0 * lost / area),
                "make the page larger, or the region smaller",
            ));
        }
    }

    /// Puts the files of the regions into the recipe.
    fn carry_regions(&mut self) -> Result<()> {
        let carried = |this: &Self, region: &Option<Region>| match region {
            Some(Region::Shape(input)) => Ok::<_, Error>(Some(Region::Shape(this.embedded(input)?))),
            other => Ok(other.clone()),
        };
        let (redo, from, to) =
            (carried(self, &self.recipe.redo)?, carried(self, &self.recipe.from)?, carried(self, &self.recipe.to)?);
        (self.recipe.redo, self.recipe.from, self.recipe.to) = (redo, from, to);
        Ok(())
    }
}

/// Refuses a hole that leaves too little around it, for what lies in the hole is to be no example.
fn check_rim(drawing: &Drawing, hole: &Bounds<2>, rest: &Rest, place: &str) -> Result<()> {
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
    let least = LEAST_SIDE * spacing(&drawing.exemplar);
    if strips.filter(|s| !s.is_empty()).any(|s| s.size()[0].min(s.size()[1]) >= least) {
        return Ok(());
    }
    Err(Error::input(
        place,
        "the region leaves too little of the drawing to be the example",
        "make the region smaller, or say with --from REGION --to REGION where the example is",
    ))
}
