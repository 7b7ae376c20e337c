//! A drawing of which a part is refilled: everything else stays as the file has it, to the last byte.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
};

use arabesque_core::{Bounds, Error, Outline, Result};
use kurbo::Affine;
use roxmltree::NodeId;

use crate::{
    svg::{
        drawing::{Anchor, Anchored, Drawing, HostDocument, Page, Placed},
        options::{LargeFills, Method, ReadOptions},
        parse::{definitions::Definitions, geometry::LARGEST, guard, source::Source},
        read::{
            document::{Document, Opened},
            host_text::{Around, around},
            matcher::Matcher,
            sorter::{Sorted, Sorter},
        },
        shape::{extent::bounds, idle::without_idle_clips, painted_area::Painter},
        understand::{
            fragment::fragment,
            frame::is_frame_mark,
            item::{Item, Kind, Selection},
            outlined_lines::{take_areas, take_backgrounds, trace},
            parts::bands::follow_bands,
            select::select,
            surroundings::Surroundings,
        },
    },
    text::unit::Unit,
};

/// Reads a drawing of which a part is refilled from a text of which nothing else is read.
///
/// # Errors
/// As for [`Document::with`] and [`Document::host`].
pub fn read_host_document(
    text: &str,
    drawing: &Drawing,
    area: &Outline<2>,
    options: &ReadOptions,
) -> Result<HostDocument> {
    Document::with(text, options, |document| document.host(drawing, area))
}

impl Document<'_> {
    /// Reads a drawing of which everything in `area` is refilled: elements with their centre in it go, strokes are cut
    /// at its border.
    ///
    /// # Errors
    /// As [`crate::svg::read_placed`]; [`Error::Unsupported`] when something in the area is drawn by a `<use>` that
    /// draws other things too.
    pub fn host(&self, drawing: &Drawing, area: &Outline<2>) -> Result<HostDocument> {
        let Opened { source, root, page, is_stretched } = self.open()?;
        let source = &source;
        if is_stretched {
            return Err(Error::Unsupported {
                what: format!(
                    "{}: filling a region of a drawing that preserveAspectRatio=\"none\" stretches",
                    source.name
                ),
                advice: "give the page the proportions of its viewBox".into(),
            });
        }
        refuse_closes(source)?;
        let painter = Painter::new(source);
        painter.check_all(&root, Affine::IDENTITY)?;
        let content = bounds(&root, Affine::IDENTITY);
        let page = page.unwrap_or(Page { view: content, unit: Unit::Px, unit_per_user: 1.0 });
        let root = without_idle_clips(&painter, &root, Affine::IDENTITY, &page.view)?;
        let roots = [(Surroundings::new(Affine::IDENTITY).without(&self.options.without), root)];
        let mut found =
            select(&painter, page.view, (self.options.method, self.options.parts, self.options.large_fills), &roots)?;
        found.items.retain(|item| !is_frame_mark(item));
        if self.options.method != Method::Elements {
            self.take_lines(source, &painter, &mut found, &page.view)?;
            refuse_cut_bands(source, &found.items, area, &page.view)?;
        }
        let sorter = Sorter {
            painter: &painter,
            matcher: Matcher::of_itself(drawing),
            area: Some(area),
            window: content.union(&page.view),
        };
        let mut definitions = Definitions::new(source, "kept");
        let kept = sorter.sort(&found.items, &mut definitions)?;
        let affected = affected(source, &found.items, &kept)?;
        let (left, definitions) = rewritten(source, &sorter, &found.items, &affected)?;
        let replaced = kept.iter().filter(|k| is_changed(k)).count();
        let mut placed = Placed::on(page);
        let mut anchors = Vec::new();
        for (item, kept) in found.items.iter().zip(kept) {
            let what = match &kept {
                Sorted::Element(_) => Some(Anchored::Element(placed.placements.len())),
                Sorted::Strokes { paint, .. } => paint.map(|(style, paint)| Anchored::Strokes(style, paint)),
                Sorted::Removed | Sorted::Obstacle { .. } => None,
            };
            let node = item.parts.last().map(|(_, node)| node.meta.xml.get()).filter(|id| is_in_the_open(source, *id));
            anchors.extend(node.zip(what));
            placed.freeze(kept);
        }
        placed.warnings = source.notes.warnings(source.name);
        let Around { head, tail, copied } = around(source, &affected, &left.in_place);
        let anchors =
            anchors.into_iter().filter_map(|(id, what)| Some(Anchor { range: copied.find(source, id)?, what }));
        let anchors = anchors.collect();
        Ok(HostDocument { placed, content, replaced, head, anchors, tail, moved: left.moved, definitions })
    }

    /// Takes fills for the lines or areas that the example has of them.
    fn take_lines(
        &self,
        source: &Source<'_>,
        painter: &Painter<'_, '_>,
        found: &mut Selection,
        page: &Bounds<2>,
    ) -> Result<()> {
        if self.options.large_fills != LargeFills::AreasAlike {
            follow_bands(source, &mut found.items, page)?;
        }
        if self.options.large_fills.are_areas() {
            take_areas(&mut found.items, page, self.options.large_fills == LargeFills::AreasAlike);
            take_backgrounds(found, painter, page)?;
        }
        trace(source, &mut found.items, page)
    }
}

/// How near to a side of the page something reaches it, as a share of the page.
const NEAR: f64 = 0.02;

/// Refuses a region that cuts something that runs through the page and is neither a line nor an area: as an element it would go, or
/// stay, as a whole.
fn refuse_cut_bands(source: &Source<'_>, items: &[Item], region: &Outline<2>, page: &Bounds<2>) -> Result<()> {
    let (size, around) = (page.size(), region.bounds());
    let runs = |outline: &Bounds<2>, k: usize| {
        let near = NEAR * size[k];
        outline.min[k] <= page.min[k] + near && outline.max[k] >= page.max[k] - near
    };
    for item in items.iter().filter(|item| matches!(item.kind, Kind::Element | Kind::Large)) {
        let extent = item.outline.bounds();
        source.budget.spend(PER_ITEM)?;
        if runs(&extent, 0) != runs(&extent, 1)
            && extent.intersects(&around)
            && item.outline.try_intersection(region, source.budget)?.area() > 0.0
        {
            return Err(Error::Unsupported {
                what: format!(
                    "{}: filling a region that cuts {}, which runs through the page and is no line of one width",
                    source.name,
                    item.name(source)
                ),
                advice: "draw such bands as strokes, or fill the whole page again".into(),
            });
        }
    }
    Ok(())
}

/// Work for looking at one item.
const PER_ITEM: u64 = 100;

/// Refuses path data that closes so often in a row that no program could draw the file, whose text stays.
fn refuse_closes(source: &Source<'_>) -> Result<()> {
    let closes = |data: &str| matches!(guard::path_data(data, LARGEST), Ok(Cow::Owned(_)));
    let mut nodes = source.xml.descendants();
    match nodes.find(|node| node.attribute("d").is_some_and(closes)) {
        Some(node) => {
            Err(Error::input(source.place(node), "a path closes hundreds of times in a row", "close it once"))
        }
        None => Ok(()),
    }
}

fn is_changed(kept: &Sorted) -> bool {
    match kept {
        Sorted::Removed => true,
        Sorted::Element(_) => false,
        Sorted::Strokes { is_touched, .. } | Sorted::Obstacle { is_touched, .. } => *is_touched,
    }
}

/// The nodes of the file that go: those of changed items, and of items that share a node with them.
fn affected(source: &Source<'_>, items: &[Item], kept: &[Sorted]) -> Result<BTreeSet<u32>> {
    let nodes = |item: &Item| item.parts.iter().map(|(_, node)| node.meta.xml.get()).collect::<Vec<_>>();
    let changed = items.iter().zip(kept).filter(|(_, kept)| is_changed(kept));
    let mut affected: BTreeSet<u32> = changed.flat_map(|(item, _)| nodes(item)).collect();
    loop {
        let before = affected.len();
        source.budget.spend(PER_ITEM * items.len() as u64)?;
        for item in items {
            let own = nodes(item);
            if own.iter().any(|id| affected.contains(id)) {
                affected.extend(own);
            }
        }
        if affected.len() == before {
            break;
        }
    }
    // The same node under two transforms is drawn twice, by `<use>`.
    let mut transforms: BTreeMap<u32, Affine> = BTreeMap::new();
    for (parent, node) in items.iter().flat_map(|item| &item.parts) {
        let id = node.meta.xml.get();
        let twice = *transforms.entry(id).or_insert(*parent) != *parent;
        let xml = source.xml.get_node(NodeId::new(id));
        let defined = xml.is_some_and(|n| n.ancestors().any(|a| matches!(a.tag_name().name(), "defs" | "symbol")));
        if affected.contains(&id) && (twice || defined) {
            let place = xml.map_or_else(|| source.name.to_owned(), |xml| source.place(xml));
            return Err(Error::Unsupported {
                what: format!("{place}: replacing a part of something that <use> draws"),
                advice: "unlink the clone in the drawing program (Inkscape: Edit > Clone > Unlink Clone)".into(),
            });
        }
    }
    Ok(affected)
}

/// Markup of what is left of items of which something goes.
#[derive(Default)]
struct Left {
    /// By the node whose place in the file it takes.
    in_place: BTreeMap<u32, String>,
    /// What cannot stay where it was, in root coordinates.
    moved: String,
}

/// What is left of affected items, with the definitions that it refers to.
fn rewritten<'a, 's>(
    source: &'s Source<'a>,
    sorter: &Sorter<'a, 's, '_, '_>,
    items: &[Item],
    affected: &BTreeSet<u32>,
) -> Result<(Left, String)> {
    let mut definitions = Definitions::new(source, "kept");
    let mut left = Left::default();
    for item in items.iter().filter(|item| item.parts.iter().any(|(_, node)| affected.contains(&node.meta.xml.get()))) {
        let Some(cut) = sorter.rest(item, &mut definitions)? else { continue };
        let markup = cut.unwrap_or_else(|| fragment(item, &mut definitions).markup);
        let place = item.parts.last().map(|(_, node)| node.meta.xml.get()).filter(|id| is_in_the_open(source, *id));
        let into = place.map_or(&mut left.moved, |id| left.in_place.entry(id).or_default());
        into.push_str(&markup);
        into.push('\n');
    }
    Ok((left, definitions.finish()?))
}

/// Whether what is drawn in the place of a node looks the same as at the end of the file: no container around it moves
/// it, cuts it or changes its looks.
fn is_in_the_open(source: &Source<'_>, id: u32) -> bool {
    let Some(node) = source.xml.get_node(NodeId::new(id)) else { return false };
    let is_plain = |a: roxmltree::Node<'_, '_>| {
        let changes = |name: &str| {
            matches!(name, "transform" | "style" | "class" | "opacity" | "clip-path" | "mask" | "filter")
                || name.starts_with("marker")
        };
        matches!(a.tag_name().name(), "g" | "a") && !a.attributes().any(|attribute| changes(attribute.name()))
    };
    let root = source.xml.root_element();
    node.ancestors().skip(1).take_while(|a| *a != root).all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::read::exemplar::read_exemplar;
    use arabesque_core::{Bounds, Vector};

    fn rest(body: &str) -> Result<HostDocument> {
        let text =
            format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'><!-- mine -->{body}\n</svg>\n");
        let options = ReadOptions { method: Method::Auto, ..ReadOptions::new("r.svg") };
        let drawing = read_exemplar(&text, &options)?;
        let corners = [(40.0, 40.0), (60.0, 40.0), (60.0, 60.0), (40.0, 60.0)].map(|(x, y)| Vector::xy(x, y));
        read_host_document(&text, &drawing, &Outline { rings: vec![corners.to_vec()] }, &options)
    }

    #[test]
    fn what_is_not_touched_stays_to_the_last_byte() {
        let line = "<path  d='M0,10 h100'\tstroke='red' fill='none'  id='a'/>";
        let dot = "<circle cx='50' cy='50' r='3'/>";
        let rest = rest(&format!("{line}\n  {dot}<rect x='80' y='80' width='9' height='9' />")).unwrap();
        assert!(rest.head.contains(line) && rest.head.contains("<!-- mine -->") && rest.head.contains("height='9' />"));
        assert!(!rest.head.contains("circle") && rest.moved.is_empty());
        assert_eq!((rest.tail.as_str(), rest.replaced), ("</svg>\n", 1));
        assert_eq!((rest.placed.placements.len(), rest.placed.curves.len()), (1, 1));
    }

    #[test]
    fn strokes_are_cut_at_the_border_and_their_outside_stays() {
        let rest = rest("<path d='M0 50H100M0 5H100' stroke='red' stroke-width='3' fill='none'/>").unwrap();
        let x = |p: Option<Vector<2>>| p.unwrap()[0].round();
        let ends: Vec<_> = rest.placed.curves.iter().map(|c| (x(c.path.start()), x(c.path.end()))).collect();
        assert_eq!(ends, [(0.0, 40.0), (60.0, 100.0), (0.0, 100.0)]);
        // Where they were, at the place of the path that they are left of.
        assert!(rest.moved.is_empty() && !rest.head.contains("M0 50H100"));
        assert_eq!(rest.head.matches("<path").count(), 3);
        assert!(rest.head.contains("M60 50L100 50") && rest.head.contains("stroke-width=\"3\""), "{}", rest.head);
    }

    #[test]
    fn what_a_group_would_move_goes_to_the_end() {
        let line = "<path d='M0 40H100' stroke='red' stroke-width='3' fill='none'/>";
        let [high, low] = ["5", "75"].map(|y| line.replace("40", y));
        let layer =
            "<g xmlns:i='http://www.inkscape.org/namespaces/inkscape' i:groupmode='layer' transform='translate(0 10)'>";
        let rest = rest(&format!("{layer}{line}{low}</g>{high}")).unwrap();
        assert_eq!((rest.head.matches("<path").count(), rest.moved.matches("<path").count()), (2, 2));
        // What stays can have something drawn before or after it, unless a group moves it.
        let texts: Vec<&str> = rest.anchors.iter().map(|a| &rest.head[a.range.clone()]).collect();
        assert!(texts.len() == 1 && texts[0].starts_with("<path d='M0 5H100'"), "{texts:?}");
    }

    #[test]
    fn a_band_that_is_neither_line_nor_area_is_not_lost() {
        let band = |y: i32| {
            format!("<rect x='-5' y='{y}' width='110' height='8' fill='#fa0' stroke='black' stroke-width='1'/>")
        };
        let body: String = (0..5).map(|k| band(4 + 20 * k)).collect();
        let error = rest(&body).err().unwrap().to_string();
        assert!(error.contains("a region that cuts <rect> in line 1, which runs through the page"), "{error}");
        // Beside the region they stay as they are.
        let body: String = [4, 24, 66, 86].map(band).concat();
        assert_eq!(rest(&body).unwrap().head.matches("<rect").count(), 4);
    }

    #[test]
    fn areas_are_cut_at_the_border_and_stay_in_their_place() {
        let wave = |y: i32| {
            format!("<path d='M-5 {y}L50 {}L105 {y}V{}L50 {}L-5 {}Z' fill='#27a'/>", y + 4, y + 6, y + 13, y + 6)
        };
        let body: String = (0..8).map(|k| wave(12 * k)).collect();
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{body}</svg>");
        let options = ReadOptions { large_fills: LargeFills::Areas, ..ReadOptions::new("r.svg") };
        let drawing = read_exemplar(&text, &options).unwrap();
        let corners = [(40.0, 40.0), (60.0, 40.0), (60.0, 60.0), (40.0, 60.0)].map(|(x, y)| Vector::xy(x, y));
        let area = Outline { rings: vec![corners.to_vec()] };
        let rest = read_host_document(&text, &drawing, &area, &options).unwrap();
        assert_eq!(drawing.exemplar.areas.len(), 8);
        assert!(rest.placed.obstacles.is_empty() && rest.moved.is_empty());
        assert!(rest.replaced >= 2 && rest.head.matches("fill-rule=\"evenodd\"").count() == rest.replaced);
    }

    #[test]
    fn numbers_of_another_exemplar_do_not_count() {
        let line = |y: u32, width: u32| {
            format!("<path d='M0 {y}H100' stroke='red' stroke-width='{width}' data-arabesque-curve='0'/>")
        };
        let rest = rest(&[line(10, 1), line(20, 3), line(30, 1), line(50, 3)].concat()).unwrap();
        let sources: Vec<_> = rest.placed.curves.iter().map(|c| (c.source, c.scale)).collect();
        assert_eq!(sources, [(0, 1.0), (1, 1.0), (0, 1.0), (1, 1.0), (1, 1.0)]);
    }

    #[test]
    fn pieces_of_one_path_are_parted() {
        let squares = "M45 45h9v9h-9zM5 5h9v9h-9zM75 5h9v9h-9z";
        let rest = rest(&format!("<path d='{squares}'/>")).unwrap();
        assert_eq!(rest.head.matches("<path").count(), 2);
        assert_eq!(rest.placed.placements.len(), 2);
    }

    #[test]
    fn outlines_of_nets_are_cut_as_the_strokes_that_they_are() {
        let holes: String = (0..16).map(|k| format!("M{} {}v20h20v-20z", 4 + 24 * (k % 4), 4 + 24 * (k / 4))).collect();
        let rest = rest(&format!("<path fill='red' fill-rule='evenodd' d='M0 0H100V100H0Z{holes}M105 105h1v1h-1z'/>"))
            .unwrap();
        // The piece beside the page is all that is not a line.
        assert!(rest.placed.obstacles.len() == 1 && rest.placed.curves.len() > 6);
        assert!(rest.head.contains("stroke=\"#ff0000\""), "{}", rest.head);
        let area = Bounds::new(Vector::xy(40.0, 40.0), Vector::xy(60.0, 60.0)).grown(-1e-6);
        let points = rest.placed.curves.iter().flat_map(|c| c.path.flatten(0.1));
        assert!(points.into_iter().all(|p| !area.contains(p)));
    }

    #[test]
    fn parts_of_clones_cannot_be_replaced() {
        let net = "<defs><g id='n'><path d='M0 50H100M0 20H100M50 0V100' stroke='red' fill='none'/></g></defs><use \
             href='#n'/>";
        assert!(rest(net).unwrap_err().to_string().contains("Unlink Clone"));
    }
}
