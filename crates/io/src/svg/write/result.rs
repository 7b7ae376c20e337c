//! A result as an SVG file: page, metadata, definitions, layers; or the file of which a part was refilled, with the new
//! part in it.
//!
//! The page keeps the units of the exemplar, layers carry Inkscape's labels, each exemplar element that is used stands
//! once in `<defs>` and is placed by `<use>`; or every element is written out in place
//! ([`Style::Expanded`](crate::svg::Style::Expanded)). The recipe travels in `<metadata>`.

use std::fmt::Write as _;

use arabesque_core::Result;

use crate::svg::{
    drawing::HostDocument,
    write::{
        background::background,
        document::{DECLARATION, PREFIXES, Root, length_decimals},
        sheet::{Sheet, Written},
        writer::Writer,
    },
};

/// Writes a result.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when the markup of an element cannot be taken apart for expanding or bending,
/// [`arabesque_core::Error::Limit`] when the work for it is used up.
pub fn write_svg(sheet: &Sheet<'_>) -> Result<Written> {
    let mut writer = Writer::new(sheet);
    writer.document()?;
    Ok(Written { text: writer.out, warnings: writer.warnings })
}

impl Writer<'_> {
    fn document(&mut self) -> Result<()> {
        if let Some(host) = self.sheet.host {
            return self.hosted(host);
        }
        self.root();
        self.metadata();
        self.definitions();
        self.background()?;
        self.output()?;
        self.obstacles();
        self.out.push_str("</svg>\n");
        Ok(())
    }

    /// Declaration and start tag.
    fn root(&mut self) {
        let page = self.sheet.page;
        let root = Root {
            page,
            decimals: self.decimals,
            lengths: length_decimals(&page),
            prefixes: &PREFIXES,
            attributes: " version=\"1.1\"",
        };
        self.out.push_str(DECLARATION);
        self.out.push_str(&root.start_tag());
    }

    /// The new at the end of the file that it belongs to.
    fn hosted(&mut self, host: &HostDocument) -> Result<()> {
        self.metadata();
        self.definitions();
        if !host.moved.is_empty() {
            let _ = write!(
                self.out,
                "<g inkscape:groupmode=\"layer\" inkscape:label=\"Kept\" id=\"{}-kept\">\n{}</g>\n",
                self.prefix, host.moved
            );
        }
        self.written_from = self.out.len();
        self.output()?;
        self.at_end.push_str(&self.out.split_off(self.written_from));
        // What comes before, in the order of the places; for one place in the order in which it was written.
        let mut inserted = std::mem::take(&mut self.inserted);
        inserted.sort_by_key(|(place, _)| *place);
        let (mut text, mut from) = (String::new(), 0);
        for (place, new) in inserted {
            text.push_str(host.head.get(from..place).unwrap_or_default());
            text.push_str(&new);
            from = place;
        }
        text.push_str(host.head.get(from..).unwrap_or_default());
        text.push_str(&self.out);
        text.push_str(&self.at_end);
        text.push_str(&host.tail);
        self.out = text;
        Ok(())
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
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Border, Bounds, Budget, Domain, Exemplar, Placement, Similarity, Vector};

    use super::*;
    use crate::{
        svg::{
            drawing::{Drawing, Fragment, Job, Layer, Page},
            options::Parts,
            write::{document::recipe_of, sheet::Style, text::rectangle},
        },
        text::unit::Unit,
    };

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
            source: None,
        };
        Drawing {
            fragments: centres.iter().map(dot).collect(),
            strokes: Vec::new(),
            fills: Vec::new(),
            layers: vec![Layer::all_elements(&exemplar)],
            background: Some("<rect width=\"10\" height=\"10\" fill=\"#fed\"/>".into()),
            parts: Parts::Together,
            definitions: String::new(),
            page: Page { view: exemplar.window, unit: Unit::Mm, unit_per_user: 2.0 },
            job: Job::default(),
            understood: Vec::new(),
            warnings: Vec::new(),
            exemplar: exemplar.into(),
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
            sequence: &[],
            curves: &[],
            areas: &[],
            kept: None,
            host: None,
            page,
            domain,
            shape: None,
            border: Border::Clip,
            bend: None,
            style,
            recipe,
            budget: &Budget::default(),
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
