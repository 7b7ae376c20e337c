//! The layer of a result that holds what was made: placed elements and strokes.

use std::fmt::Write as _;

use arabesque_core::{Border, Bounds, Domain, Outline, Placement, Result, Vector, Warning};

use crate::{
    svg::{
        drawing::Stacking,
        write::{
            curves::curves,
            flat::{Flattener, Warp},
            sheet::Style,
            text::{matrix, rectangle},
            writer::Writer,
        },
    },
    text::xml::escape,
};

/// Work for writing one element.
const PER_ELEMENT: u64 = 3000;

impl Writer<'_> {
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
        let flattener =
            Flattener::new(self.sheet.drawing, cut.as_ref(), clip.as_deref(), self.decimals, self.sheet.budget)?;
        if self.sheet.drawing.stacking == Stacking::ElementsAbove {
            self.curves();
        }
        let mut clipped = 0;
        let sheet = self.sheet;
        let is_new = |p: &Placement<2>| sheet.host.is_none() || p.frozen.is_none();
        for (index, placement) in sheet.placements.iter().enumerate().filter(|(_, p)| is_new(p)) {
            self.sheet.budget.spend(PER_ELEMENT)?;
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
                format!(
                    "{clipped} pieces (pictures, text, linked parts, or pieces with gradients, clips or filters) \
                     were not flattened"
                ),
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
}
