//! Lines to lay a pattern along: every path and shape of a file, or of one item of it.

use std::rc::Rc;

use arabesque_core::{Error, Measured, Path, Result, Warning};
use kurbo::{Affine, BezPath};

use crate::svg::{
    drawing::Page,
    options::ReadOptions,
    parse::{
        meta::{Mark, Meta},
        scene::{Content, Node},
        source::Source,
        style::Property as P,
    },
    read::document::{Document, Opened, by_id},
    shape::{
        extent::bounds,
        painted_area::Painter,
        subpath::{is_closed, line},
    },
};

/// The lines of a file.
#[derive(Clone, Debug)]
pub struct Lines {
    /// The lines in drawing order, in the user coordinates of the page, with the names that messages call them by.
    pub paths: Vec<(String, Path<2>)>,
    /// The page; `None` where the file states no size.
    pub page: Option<Page>,
    /// What was noticed while reading.
    pub warnings: Vec<Warning>,
}

/// Reads the lines to lay a pattern along from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::guides`].
pub fn read_lines(text: &str, id: Option<&str>, options: &ReadOptions) -> Result<Lines> {
    Document::with(text, options, |document| document.guides(id))
}

impl Document<'_> {
    /// Reads every path and shape of the file, or of the item (a shape, a group or a layer) with the given id or label.
    /// Each subpath is a line of its own; paint does not count. A fill that covers the whole page is a background,
    /// where the file holds anything else.
    ///
    /// # Errors
    /// [`Error::Input`] when the text is not usable SVG, nothing has that id, or no line has a length; [`Error::Limit`]
    /// when it is too large.
    pub fn guides(&self, id: Option<&str>) -> Result<Lines> {
        let Opened { source, root, page, .. } = self.open()?;
        let source = &source;
        let painter = Painter::new(source);
        let (place, start) = match id {
            Some(id) => (format!("{}#{id}", source.name), by_id(source, &root, id)?),
            None => (source.name.to_owned(), (Affine::IDENTITY, Rc::clone(&root))),
        };
        let mut finder = Finder { painter: &painter, page, whole: id.is_none(), found: Vec::new(), covers: Vec::new() };
        finder.walk(&start.1, start.0)?;
        let mut warnings = finder.leave_background();
        let (paths, points) = finder.lines();
        if paths.is_empty() {
            let (problem, advice) = match points {
                0 => ("no path or shape found", "draw a line, or name an item that holds one"),
                _ => ("a line without any length, where a pattern is to be laid along it", "draw it longer"),
            };
            return Err(Error::input(place, problem, advice));
        }
        if points > 0 {
            let message = format!("{place}: {points} lines without length are left out");
            warnings.push(Warning::new(message, "remove them, or draw them longer"));
        }
        warnings.extend(source.notes.warnings(source.name));
        Ok(Lines { paths, page, warnings })
    }
}

/// Walks a drawing and gathers its paths.
struct Finder<'a, 's, 'i> {
    painter: &'i Painter<'a, 's>,
    page: Option<Page>,
    /// Whether the whole file is looked at.
    whole: bool,
    found: Vec<(String, BezPath)>,
    /// Which of the found ones are fills that cover the page.
    covers: Vec<bool>,
}

impl Finder<'_, '_, '_> {
    fn walk(&mut self, node: &Node, parent: Affine) -> Result<()> {
        if self.whole && node.meta.mark == Some(Mark::Ignore) {
            return Ok(());
        }
        let world = parent * node.transform;
        if let Content::Shape(geometry) = &node.content {
            self.painter.check(node, geometry, world)?;
            let covers = self.page.is_some_and(|page| {
                let own = bounds(node, parent);
                let slack = page.view.size() * 0.025;
                let reaches = (0..2)
                    .all(|k| own.min[k] <= page.view.min[k] + slack[k] && own.max[k] >= page.view.max[k] - slack[k]);
                node.style.get(P::Fill) != "none" && reaches
            });
            self.covers.push(covers);
            self.found.push((name(self.painter.source, &node.meta, self.found.len()), world * geometry.path.clone()));
        }
        node.children().iter().try_for_each(|child| self.walk(child, world))
    }

    /// Drops fills that cover the page, where there is something else.
    fn leave_background(&mut self) -> Vec<Warning> {
        if !self.whole || !self.covers.contains(&true) || !self.covers.contains(&false) {
            return Vec::new();
        }
        let (found, covers) = (std::mem::take(&mut self.found), std::mem::take(&mut self.covers));
        let mut warnings = Vec::new();
        for ((name, path), covers) in found.into_iter().zip(covers) {
            if covers {
                let message = format!("{name} covers the page and is taken for its background");
                warnings.push(Warning::new(message, "to lay a pattern along it, name it, as in FILE.svg#ID"));
            } else {
                self.found.push((name, path));
            }
        }
        warnings
    }

    /// The subpaths that have a length, and the number of those that have none.
    fn lines(&self) -> (Vec<(String, Path<2>)>, usize) {
        let (mut lines, mut points) = (Vec::new(), 0);
        let least = self.painter.source.limits.extent;
        for (name, path) in &self.found {
            let parts: Vec<Path<2>> = path
                .subpaths()
                .map(|elements| line(&BezPath::from_vec(elements.to_vec()), is_closed(elements), least))
                .collect();
            let many = parts.len() > 1;
            for (k, part) in parts.into_iter().enumerate() {
                if part.is_empty() || Measured::new(part.clone(), 0.01 * part.bounds().size().norm()).length() <= least
                {
                    points += 1;
                    continue;
                }
                let name = if many { format!("{name}, subpath {}", k + 1) } else { name.clone() };
                lines.push((name, part));
            }
        }
        (lines, points)
    }
}

/// What messages call a shape: its tag, and its id, label or place in the file.
fn name(source: &Source<'_>, meta: &Meta, number: usize) -> String {
    match meta.id.as_ref().or(meta.label.as_ref()) {
        Some(id) => format!("{}: {} \"{id}\"", source.name, meta.tag),
        None => format!("{}: {} number {}", source.name, meta.tag, number + 1),
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    fn read(body: &str, id: Option<&str>) -> Result<Lines> {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' \
             xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 100 100'>{body}</svg>"
        );
        read_lines(&text, id, &ReadOptions::new("c.svg"))
    }

    const SCENE: &str = "<rect width='100' height='100' fill='white'/>
        <g id='g' inkscape:groupmode='layer' inkscape:label='Vines' transform='translate(10 0)'>
        <line id='l' x1='0' y1='5' x2='20' y2='5'/><circle cx='40' cy='40' r='10'/></g>
        <path id='p' d='M0 50H50 M0 60H50V70Z' fill='none'/><use href='#l' y='30' id='u'/>";

    #[test]
    fn every_shape_is_a_line_in_drawing_order() {
        let lines = read(SCENE, None).unwrap();
        let names: Vec<&str> = lines.paths.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "c.svg: line \"l\"",
                "c.svg: circle number 3",
                "c.svg: path \"p\", subpath 1",
                "c.svg: path \"p\", subpath 2",
                "c.svg: line \"l\""
            ]
        );
        let closed: Vec<bool> = lines.paths.iter().map(|(_, path)| path.closed).collect();
        assert_eq!(closed, [false, true, false, true, false]);
        assert_eq!(lines.paths[0].1.start(), Some(Vector::xy(10.0, 5.0)));
        assert_eq!(lines.paths[4].1.start(), Some(Vector::xy(0.0, 35.0)));
        assert!(lines.warnings[0].message.contains("background"), "{:?}", lines.warnings);
    }

    #[test]
    fn an_id_or_a_label_takes_one_item() {
        assert_eq!(read(SCENE, Some("p")).unwrap().paths.len(), 2);
        assert_eq!(read(SCENE, Some("g")).unwrap().paths.len(), 2);
        assert_eq!(read(SCENE, Some("Vines")).unwrap().paths.len(), 2);
        let error = read(SCENE, Some("vinse")).unwrap_err().to_string();
        assert!(error.contains("c.svg") && error.contains("did you mean \"Vines\"?"), "{error}");
    }

    #[test]
    fn lines_without_length_are_told() {
        for body in ["", "<path d=''/>", "<path d='M5 5'/>", "<path id='d' d='M5 5L5 5'/>", "<circle r='0'/>"] {
            let error = read(body, None).unwrap_err().to_string();
            assert!(error.starts_with("c.svg"), "{error}");
        }
        assert_eq!(read("<path d='M5 5h0M1 1h9'/>", None).unwrap().warnings.len(), 1);
    }
}
