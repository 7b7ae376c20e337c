//! Writing results as SVG.
//!
//! The page keeps the units of the exemplar, layers carry Inkscape's labels, each exemplar element that is used stands once in `<defs>` and
//! is placed by `<use>`; or every element is written out in place ([`Style::Expanded`]). The recipe travels in `<metadata>`.

use std::{collections::BTreeSet, fmt::Write as _};

use arabesque_core::{Border, Bounds, Domain, Drawn, Outline, Placement, Result, Vector, Warning};

use crate::{
    svg::{
        drawing::{Drawing, Page, Placed, Stacking},
        read::host_document::Rest,
        write::{
            background::background,
            curves::curves,
            flat::{Flattener, Warp},
            kept::free_prefix,
            text::{escape, matrix, outline_data, rectangle, unit_name},
        },
    },
    text::number::Decimals,
};

/// Namespace of the elements and attributes that only arabesque understands.
pub const NAMESPACE: &str = "urn:arabesque:1";

/// How placed elements are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Each exemplar element once in `<defs>`, placed by `<use>`.
    #[default]
    Linked,
    /// Every element written out in page coordinates, for cutters and plotters.
    Expanded,
}

/// Bends deformed elements: `(placement, point of the exemplar) -> point of the output`.
pub type Bend<'a> = dyn Fn(usize, Vector<2>) -> Vector<2> + 'a;

/// Everything that one SVG file is made of.
pub struct Sheet<'a> {
    /// How the elements look.
    pub drawing: &'a Drawing,
    /// Where they lie.
    pub placements: &'a [Placement<2>],
    /// The strokes.
    pub curves: &'a [Drawn<2>],
    /// The looks of frozen placements and of what else is kept.
    pub kept: Option<&'a Placed>,
    /// The drawing of which a part is made anew: then the result is that file with the new in it.
    pub host: Option<&'a Rest>,
    /// Page of the result.
    pub page: Page,
    /// The filled domain, in page coordinates.
    pub domain: &'a Domain<2>,
    /// The outline of the domain where it is a shape.
    pub shape: Option<&'a Outline<2>>,
    /// Whether elements are cut at the border.
    pub border: Border,
    /// How deformed placements are bent; without it they are drawn rigid.
    pub bend: Option<&'a Bend<'a>>,
    /// Linked or expanded.
    pub style: Style,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
}

/// An SVG text and what could not be written as asked.
#[derive(Clone, Debug)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Elements that stayed links or were clipped instead of cut.
    pub warnings: Vec<Warning>,
}

/// Writes a result.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when the markup of an element cannot be taken apart for expanding or bending.
pub fn write_svg(sheet: &Sheet<'_>) -> Result<Written> {
    let extent = sheet.page.view.size();
    let mut writer = Writer {
        sheet,
        decimals: Decimals::for_extent(extent[0].max(extent[1])),
        prefix: free_prefix(sheet),
        out: String::new(),
        warnings: Vec::new(),
    };
    writer.document()?;
    Ok(Written { text: writer.out, warnings: writer.warnings })
}

/// The recipe in an SVG text that [`write_svg`] wrote.
pub fn recipe_of(text: &str) -> Option<String> {
    let document = roxmltree::Document::parse(text).ok()?;
    let node = document.descendants().find(|n| n.has_tag_name((NAMESPACE, "recipe")))?;
    Some(node.children().filter_map(|n| n.text()).collect())
}

/// A file on its way.
pub(crate) struct Writer<'a> {
    pub(crate) sheet: &'a Sheet<'a>,
    decimals: Decimals,
    pub(crate) prefix: String,
    pub(crate) out: String,
    warnings: Vec<Warning>,
}

impl<'a> Writer<'a> {
    fn document(&mut self) -> Result<()> {
        if let Some(host) = self.sheet.host {
            return self.hosted(host);
        }
        self.root();
        self.metadata();
        self.definitions();
        self.background()?;
        let strokes_above = self.sheet.drawing.stacking == Stacking::CurvesAbove;
        if !strokes_above {
            self.kept_strokes();
        }
        self.elements()?;
        if strokes_above {
            self.kept_strokes();
        }
        self.obstacles();
        self.out.push_str("</svg>\n");
        Ok(())
    }

    fn root(&mut self) {
        let (view, size) = (self.sheet.page.view, self.sheet.page.view.size());
        let d = self.decimals;
        let per_user = self.sheet.page.unit_per_user;
        let unit = unit_name(self.sheet.page.unit);
        let lengths = Decimals::for_extent(size[0].max(size[1]) * per_user);
        let _ = write!(
            self.out,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" \
             xmlns:xlink=\"http://www.w3.org/1999/xlink\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
             xmlns:arabesque=\"{NAMESPACE}\" version=\"1.1\" width=\"{}{unit}\" height=\"{}{unit}\" viewBox=\"{} {} {} {}\">\n",
            lengths.format(size[0] * per_user),
            lengths.format(size[1] * per_user),
            d.format(view.min[0]),
            d.format(view.min[1]),
            d.format(size[0]),
            d.format(size[1]),
        );
    }

    pub(crate) fn metadata(&mut self) {
        if let Some(recipe) = self.sheet.recipe {
            // "]]>" would end the section: it is cut in two.
            let safe = recipe.replace("]]>", "]]]]><![CDATA[>");
            let _ =
                write!(self.out, "<metadata>\n<arabesque:recipe><![CDATA[{safe}]]></arabesque:recipe>\n</metadata>\n");
        }
    }

    pub(crate) fn definitions(&mut self) {
        self.out.push_str("<defs>\n");
        let of_kept = self.sheet.kept.map(|k| &k.definitions);
        let of_host = self.sheet.host.map(|h| &h.definitions);
        for text in [Some(&self.sheet.drawing.definitions), of_kept, of_host].into_iter().flatten() {
            if !text.trim().is_empty() {
                self.out.push_str(text.trim_end());
                self.out.push('\n');
            }
        }
        if let Some(shape) = self.sheet.shape {
            let _ = writeln!(
                self.out,
                "<clipPath id=\"{}-domain\"><path d=\"{}\" clip-rule=\"evenodd\"/></clipPath>",
                self.prefix,
                outline_data(shape, self.decimals)
            );
        }
        if self.sheet.style == Style::Linked {
            for source in self.linked_sources() {
                let markup = &self.sheet.drawing.fragments[source].markup;
                let _ = writeln!(self.out, "<g id=\"{}-element-{source}\">{markup}</g>", self.prefix);
            }
        }
        self.out.push_str("</defs>\n");
    }

    /// The exemplar elements that are placed by `<use>`, each once.
    fn linked_sources(&self) -> BTreeSet<usize> {
        let is_new = |p: &&Placement<2>| !self.is_hosted(p) && self.kept_markup(p).is_none();
        let own = self.sheet.placements.iter().filter(|p| !self.is_bent(p)).filter(is_new);
        own.map(|p| p.source).collect()
    }

    fn background(&mut self) -> Result<()> {
        let Some(markup) = &self.sheet.drawing.background else { return Ok(()) };
        let (ground, warning) = background(markup, self.sheet, &self.prefix, self.decimals)?;
        self.warnings.extend(warning);
        let _ = write!(
            self.out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"Background\" id=\"{}-background\">\n{ground}\n</g>\n",
            self.prefix
        );
        Ok(())
    }

    pub(crate) fn elements(&mut self) -> Result<()> {
        let _ = write!(
            self.out,
            "<g inkscape:groupmode=\"layer\" inkscape:label=\"Arabesque output\" id=\"{}-output\"",
            self.prefix
        );
        if self.clips_by_reference() {
            let _ = write!(self.out, " clip-path=\"url(#{}-domain)\"", self.prefix);
        }
        self.out.push_str(">\n");
        let cut = self.cut_outline();
        let clip = self.sheet.shape.map(|_| format!("{}-domain", self.prefix));
        let flattener = Flattener::new(self.sheet.drawing, cut.as_ref(), clip.as_deref(), self.decimals);
        if self.sheet.drawing.stacking == Stacking::ElementsAbove {
            self.curves();
        }
        let mut clipped = 0;
        let sheet = self.sheet;
        let is_new = |p: &Placement<2>| sheet.host.is_none() || p.frozen.is_none();
        for (index, placement) in sheet.placements.iter().enumerate().filter(|(_, p)| is_new(p)) {
            for (copy, shift) in self.copies(placement).into_iter().enumerate() {
                let id = if copy == 0 {
                    format!("{}-{index}", self.prefix)
                } else {
                    format!("{}-{index}-{copy}", self.prefix)
                };
                clipped += self.element(&flattener, index, &id, shift)?;
            }
        }
        if self.sheet.drawing.stacking == Stacking::CurvesAbove {
            self.curves();
        }
        self.out.push_str("</g>\n");
        if clipped > 0 {
            self.warnings.push(Warning::new(
                format!("{clipped} pieces (pictures, text, linked parts, or pieces with gradients, clips or filters) were not flattened"),
                "convert them to plain paths in the exemplar where the receiving machine needs that",
            ));
        }
        Ok(())
    }

    fn curves(&mut self) {
        let text = curves(self.sheet, &self.prefix, self.decimals.minus(1), &|bounds| self.shifts(bounds));
        self.out.push_str(&text);
    }

    /// Writes one copy of one placement; returns how many of its pieces could not be flattened.
    fn element(&mut self, flattener: &Flattener<'_>, index: usize, id: &str, shift: Vector<2>) -> Result<usize> {
        let placement = &self.sheet.placements[index];
        let exemplar = &self.sheet.drawing.exemplar;
        let class = escape(&exemplar.classes[exemplar.elements[placement.source].class].name);
        let data = format!("data-arabesque-source=\"{}\" data-arabesque-class=\"{class}\"", placement.source);
        if let Some(markup) = self.kept_markup(placement) {
            let _ = writeln!(
                self.out,
                "<g id=\"{id}\" {data} data-arabesque-kept=\"true\"{}>{markup}</g>",
                self.shifted(shift)
            );
            return Ok(0);
        }
        let bent = self.is_bent(placement);
        if self.sheet.style == Style::Linked && !bent {
            let matrix = matrix(placement, shift, self.decimals);
            let _ = writeln!(
                self.out,
                "<use id=\"{id}\" href=\"#{}-element-{}\" transform=\"{matrix}\" {data}/>",
                self.prefix, placement.source
            );
            return Ok(0);
        }
        let bend = |p: Vector<2>| match self.sheet.bend {
            Some(bend) => bend(index, p) + shift,
            None => placement.transform.apply(p) + shift,
        };
        let mut moved = placement.transform;
        moved.translation += shift;
        let warp = if bent { Warp::Bent(&bend, moved) } else { Warp::Rigid(moved) };
        let flat = flattener.element(placement.source, &warp, self.sheet.style)?;
        if !flat.markup.is_empty() {
            let _ = writeln!(self.out, "<g id=\"{id}\" {data}>{}</g>", flat.markup);
        }
        Ok(flat.kept_whole)
    }

    pub(crate) fn shifted(&self, shift: Vector<2>) -> String {
        if shift == Vector::ZERO {
            return String::new();
        }
        format!(" transform=\"translate({} {})\"", self.decimals.format(shift[0]), self.decimals.format(shift[1]))
    }

    fn is_bent(&self, placement: &Placement<2>) -> bool {
        self.sheet.bend.is_some() && !placement.control.is_empty()
    }

    fn clips_by_reference(&self) -> bool {
        self.sheet.border == Border::Clip && self.sheet.shape.is_some() && self.sheet.style == Style::Linked
    }

    /// What expanded elements are cut with: nothing on a torus, whose copies must stay whole to meet across the seam.
    fn cut_outline(&self) -> Option<Outline<2>> {
        if self.sheet.border != Border::Clip || self.sheet.style == Style::Linked {
            return None;
        }
        match (self.sheet.shape, self.sheet.domain) {
            (Some(shape), _) => Some(shape.clone()),
            (None, Domain::Box(b)) => Some(rectangle(b)),
            (None, _) => None,
        }
    }

    /// The shifts under which a placement is seen.
    fn copies(&self, placement: &Placement<2>) -> Vec<Vector<2>> {
        if !matches!(self.sheet.domain, Domain::Torus(_)) {
            return vec![Vector::ZERO];
        }
        let outline = &self.sheet.drawing.exemplar.elements[placement.source].outline;
        self.shifts(&Bounds::around(outline.points().map(|p| placement.transform.apply(p))))
    }

    /// The shifts under which a box is seen: none, or on a torus one for every tile that it reaches into.
    pub(crate) fn shifts(&self, bounds: &Bounds<2>) -> Vec<Vector<2>> {
        let Domain::Torus(tile) = self.sheet.domain else { return vec![Vector::ZERO] };
        if bounds.is_empty() {
            return vec![Vector::ZERO];
        }
        let size = tile.size();
        let range = |k: usize| {
            let first = ((tile.min[k] - bounds.max[k]) / size[k]).ceil() as i64;
            let last = ((tile.max[k] - bounds.min[k]) / size[k]).floor() as i64;
            first..=last
        };
        let mut shifts: Vec<_> = range(1).flat_map(|y| range(0).map(move |x| (x, y))).collect();
        shifts.sort_by_key(|&(x, y)| (x != 0 || y != 0, y, x));
        shifts.into_iter().map(|(x, y)| Vector::xy(x as f64 * size[0], y as f64 * size[1])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::drawing::Unit;
    use crate::svg::drawing::{Fragment, Job};
    use arabesque_core::{Exemplar, Similarity};

    /// Two dots at (2, 2) and (8, 8) in a 10 x 10 frame.
    fn drawing() -> Drawing {
        let centres = [Vector::xy(2.0, 2.0), Vector::xy(8.0, 8.0)];
        let mut exemplar = Exemplar::from_points("t", &centres, &[0, 0], &["a \"dot\"".into()]).unwrap();
        exemplar.window = Bounds::new(Vector::ZERO, Vector::xy(10.0, 10.0));
        for e in &mut exemplar.elements {
            e.outline = rectangle(&Bounds::new(e.centre - Vector::splat(1.0), e.centre + Vector::splat(1.0)));
        }
        let dot = |p: &Vector<2>| Fragment {
            markup: format!(
                "<rect id=\"arabesque-1\" x=\"{}\" y=\"{}\" width=\"2\" height=\"2\"/>",
                p[0] - 1.0,
                p[1] - 1.0
            ),
            layer: None,
            label: None,
        };
        Drawing {
            fragments: centres.iter().map(dot).collect(),
            strokes: Vec::new(),
            stacking: Stacking::default(),
            background: Some("<rect width=\"10\" height=\"10\" fill=\"#fed\"/>".into()),
            definitions: String::new(),
            page: Page { view: exemplar.window, unit: Unit::Mm, unit_per_user: 2.0 },
            job: Job::default(),
            warnings: Vec::new(),
            exemplar,
        }
    }

    fn written(domain: &Domain<2>, style: Style, recipe: Option<&str>) -> String {
        let drawing = drawing();
        let at = |source, x, y| Placement {
            source,
            transform: Similarity::shift(Vector::xy(x, y)),
            control: Vec::new(),
            frozen: None,
        };
        let page = Page { view: domain.bounds(), ..drawing.page };
        let sheet = Sheet {
            drawing: &drawing,
            placements: &[at(0, -2.0, 8.0), at(0, 5.0, 5.0)],
            curves: &[],
            kept: None,
            host: None,
            page,
            domain,
            shape: None,
            border: Border::Clip,
            bend: None,
            style,
            recipe,
        };
        write_svg(&sheet).unwrap().text
    }

    fn tile() -> Domain<2> {
        Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(20.0, 10.0)))
    }

    #[test]
    fn a_corner_element_is_drawn_in_all_four_corners() {
        let text = written(&tile(), Style::Linked, None);
        for at in ["translate(-2 8)", "translate(18 8)", "translate(-2 -2)", "translate(18 -2)", "translate(5 5)"] {
            assert_eq!(text.matches(&format!("\"{at}\"")).count(), 1, "{at}: {text}");
        }
    }

    #[test]
    fn page_ids_and_names_are_safe() {
        let text = written(&tile(), Style::Linked, None);
        assert!(text.contains("width=\"40mm\" height=\"20mm\" viewBox=\"0 0 20 10\""));
        assert!(text.contains("id=\"arabesque2-element-0\"") && !text.contains("arabesque2-element-1"));
        assert!(text.contains("data-arabesque-class=\"a &quot;dot&quot;\""));
        assert!(text.contains("fill=\"#fed\""));
        roxmltree::Document::parse(&text).unwrap();
    }

    #[test]
    fn any_recipe_comes_back() {
        let recipe = "a = \"]]>]]]>\"\nb = '<&'\n";
        assert_eq!(recipe_of(&written(&tile(), Style::Linked, Some(recipe))).unwrap(), recipe);
        assert_eq!(recipe_of("<svg/>"), None);
    }

    #[test]
    fn a_page_cuts_expanded_elements_and_a_tile_does_not() {
        let page = Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(20.0, 10.0)));
        let cut = written(&page, Style::Expanded, None);
        assert!(!cut.contains("-1 ") && cut.contains("0 10") && cut.contains("1 9"), "{cut}");
        assert!(written(&tile(), Style::Expanded, None).contains("M-1 9L1 9L1 11L-1 11Z"));
    }
}
