//! The parsed file that all readers look at: its drawing, the layers that play a part in a job, and items by id.

use std::{cell::OnceCell, rc::Rc};

use arabesque_core::{Error, Result, suggest::nearest};
use kurbo::Affine;

use crate::svg::{
    drawing::Page,
    options::ReadOptions,
    parse::{
        length::{self, Viewport},
        meta::Part,
        scene::{self, Node},
        source::{Source, with_source},
    },
};
use crate::text::short::list;

/// An SVG file, parsed once for everything that is read of it: the text is checked and parsed, styles and `<use>` are
/// resolved, and each reader ([`Document::exemplar`], [`Document::shape`] and so on) starts from there. Every reader
/// reports its own warnings.
pub struct Document<'a> {
    source: Source<'a>,
    pub(crate) options: &'a ReadOptions,
    /// The drawing, from the first reader on.
    drawn: OnceCell<Opened<'a>>,
}

/// A file as a reader finds it.
#[derive(Clone)]
pub(crate) struct Opened<'a> {
    /// The file, with notes of what was found while the drawing was made; further ones are the reader's own.
    pub(crate) source: Source<'a>,
    pub(crate) root: Rc<Node>,
    /// `None` where the file states no size.
    pub(crate) page: Option<Page>,
    /// Whether the page shows the content stretched more one way than the other.
    pub(crate) is_stretched: bool,
}

impl<'a> Document<'a> {
    /// Parses `text` and hands it to `work`: what was parsed borrows the text, so it cannot outlive this call.
    ///
    /// # Errors
    /// [`Error::Input`] when the text is not usable SVG, [`Error::Limit`] when it is too large; those of `work`.
    pub fn with<T>(text: &str, options: &ReadOptions, work: impl FnOnce(&Document<'_>) -> Result<T>) -> Result<T> {
        with_source(text, options, |source| work(&Document { source: source.clone(), options, drawn: OnceCell::new() }))
    }

    /// The file for one reader.
    pub(crate) fn open(&self) -> Result<Opened<'a>> {
        if let Some(drawn) = self.drawn.get() {
            return Ok(drawn.clone());
        }
        let source = self.source.clone();
        let sheet = length::page(&source)?;
        let viewport = sheet.map_or(Viewport { width: 100.0, height: 100.0 }, |sheet| sheet.viewport());
        let [x, y] = sheet.map_or([1.0; 2], |sheet| sheet.stretch);
        let mut root = scene::build(&source, viewport)?;
        root.transform = Affine::scale_non_uniform(x, y) * root.transform;
        let (root, page, is_stretched) = (Rc::new(root), sheet.map(|sheet| sheet.page), x != y);
        Ok(self.drawn.get_or_init(|| Opened { source, root, page, is_stretched }).clone())
    }
}

/// The nodes that play a part in the job, with the transforms from their parents to the root.
pub(crate) fn parts(root: &Rc<Node>, part: Part) -> Vec<(Affine, Rc<Node>)> {
    fn walk(node: &Rc<Node>, parent: Affine, part: Part, found: &mut Vec<(Affine, Rc<Node>)>) {
        if node.meta.part == Some(part) {
            found.push((parent, Rc::clone(node)));
            return;
        }
        let world = parent * node.transform;
        node.children().iter().for_each(|child| walk(child, world, part, found));
    }
    let mut found = Vec::new();
    walk(root, Affine::IDENTITY, part, &mut found);
    found
}

/// The node with an id or a label, and the transform from its parent to the root.
pub(crate) fn by_id(source: &Source<'_>, root: &Rc<Node>, id: &str) -> Result<(Affine, Rc<Node>)> {
    fn walk(node: &Rc<Node>, parent: Affine, id: &str, known: &mut Vec<String>) -> Option<(Affine, Rc<Node>)> {
        if node.meta.id.as_deref() == Some(id) || node.meta.label.as_deref() == Some(id) {
            return Some((parent, Rc::clone(node)));
        }
        known.extend(node.meta.id.iter().chain(&node.meta.label).cloned());
        let world = parent * node.transform;
        node.children().iter().find_map(|child| walk(child, world, id, known))
    }
    let mut known = Vec::new();
    walk(root, Affine::IDENTITY, id, &mut known).ok_or_else(|| {
        let advice = match (nearest(id, known.iter().map(String::as_str)), known.is_empty()) {
            (Some(near), _) => format!("did you mean \"{near}\"?"),
            (None, true) => "give the shape an id".to_owned(),
            (None, false) => format!("use one of its ids, such as {}", list(known.iter().take(8))),
        };
        Error::input(source.name, format!("nothing visible has the id \"{id}\""), advice)
    })
}

#[cfg(test)]
mod tests {
    use std::fmt::Debug;

    use arabesque_core::{Budget, Limits, Outline, Vector};

    use super::*;
    use crate::svg::read::{
        domain::read_shape, exemplar::read_exemplar, flow::read_flow, guides::read_lines,
        host_document::read_host_document, painted_areas::read_areas, placed::read_placed,
    };

    /// A file in which every reader finds something, and something to warn of.
    const TEXT: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>
        <style>.dot{fill:red}</style><clipPath id='c'><rect width='90' height='90'/></clipPath>
        <defs><circle id='d' class='dot' r='4'/></defs><text id='t'>no path</text>
        <use href='#d' x='20' y='20'/><use href='#d' x='50' y='50'/><use href='#d' x='80' y='20'/>
        <g clip-path='url(#c)'><path d='M0 80H100' stroke='blue' fill='none' transform='rotate(9deg)'/></g></svg>";

    fn area() -> Outline<2> {
        let corners = [(40.0, 40.0), (60.0, 40.0), (60.0, 60.0), (40.0, 60.0)].map(|(x, y)| Vector::xy(x, y));
        Outline { rings: vec![corners.to_vec()] }
    }

    fn is_same<T: Debug>(alone: Result<T>, shared: Result<T>) {
        assert_eq!(format!("{shared:?}"), format!("{alone:?}"));
    }

    #[test]
    fn all_readers_look_at_one_drawing_and_find_what_each_finds_alone() {
        let options = ReadOptions::new("d.svg");
        let drawing = read_exemplar(TEXT, &options).unwrap();
        assert!(!drawing.warnings.is_empty());
        Document::with(TEXT, &options, |document| {
            let before = document.open()?.root;
            // Twice, for what one reader notes and counts must not reach the next.
            for _ in 0..2 {
                is_same(read_exemplar(TEXT, &options), document.exemplar());
                is_same(read_shape(TEXT, None, &options), document.shape(None));
                is_same(read_shape(TEXT, Some("x"), &options), document.shape(Some("x")));
                is_same(read_flow(TEXT, &options), document.flow());
                is_same(read_lines(TEXT, None, &options), document.guides(None));
                is_same(read_areas(TEXT, &options), document.painted_areas());
                is_same(read_placed(TEXT, &drawing, &options), document.placed(&drawing));
                is_same(read_host_document(TEXT, &drawing, &area(), &options), document.host(&drawing, &area()));
            }
            assert!(Rc::ptr_eq(&before, &document.open()?.root));
            Ok(())
        })
        .unwrap();
    }

    #[test]
    fn limits_count_for_each_reader_by_itself() {
        let mut options = ReadOptions::new("d.svg");
        let alone = |limit: usize| {
            let mut options = ReadOptions::new("d.svg");
            options.budget = Budget::new(Limits { segments: limit, ..Limits::default() });
            read_exemplar(TEXT, &options).is_ok()
        };
        let least = (1..1000).find(|&limit| alone(limit)).unwrap();
        options.budget = Budget::new(Limits { segments: least, ..Limits::default() });
        let read = Document::with(TEXT, &options, |document| {
            document.exemplar()?;
            document.painted_areas()?;
            document.exemplar()
        });
        assert!(read.is_ok());
    }
}
