//! What an edit would change, marked in the result.

use arabesque_core::{Error, Result, Vector};
use arabesque_io::{
    file,
    svg::{Mark, with_marks},
};

use super::{
    elements::{AnyChanges, Elements},
    session::{Change, EditSession, Proposal},
};
use crate::recipe::Format;

impl EditSession {
    /// The result with the change made and marked: a ring around every element that changes, dashed where it was before; what would be
    /// deleted is there still, and crossed out. The session stays as it is.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for other results than SVG; those of writing.
    pub fn preview(&self, proposal: &Proposal, format: Option<Format>) -> Result<Vec<u8>> {
        let (Elements::Plane(file), AnyChanges::Plane(changes), Format::Svg) =
            (self.elements(), proposal.changes(), self.format())
        else {
            return Err(Error::Unsupported {
                what: format!("marking changes in {}", self.format().name()),
                advice: "leave -o out to be told of them, or edit the result as SVG".into(),
            });
        };
        let mut shown = changes.clone();
        shown.removed.clear();
        let bytes = file.rewritten(&shown, None, &self.budget().fresh())?;
        let marks: Vec<Mark> = proposal.changed.iter().map(mark).collect();
        let text = file::decode_text(self.name(), &bytes, &self.budget().fresh())?;
        let marked = with_marks(&text, &file.layout().frame, &marks);
        self.written(marked.into_bytes(), format)
    }
}

fn mark(change: &Change) -> Mark {
    let place = |list: &Option<Vec<f64>>| list.as_ref().filter(|p| p.len() == 2).map(|p| Vector::xy(p[0], p[1]));
    Mark { from: place(&change.from), to: place(&change.to), reach: change.reach }
}
