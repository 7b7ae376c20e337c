//! Exemplars of any file kind, as a drawing.

use std::sync::Arc;

use arabesque_core::{Budget, Error, Exemplar, Outline, Result, Vector, Warning};
use arabesque_io::{
    file,
    mesh::obj,
    svg::{self, Dashes, Drawing, Fragment, Job, LargeFills, Layer, PALETTE, Page, Parts, ReadOptions, Reason, Unit},
    table::csv::{self, Points},
};
use arabesque_patterns::{Known, regular, repeat::Extent};

use crate::recipe::{Input, Reading};

/// An exemplar as it was read.
#[derive(Clone, Debug)]
pub enum LoadedExemplar {
    /// An SVG drawing, and what was found out of how it repeats.
    Drawing(Box<Drawing>, Known),
    /// Points of the plane.
    Points(Exemplar<2>),
    /// Points or curves of space, and what was noticed while reading.
    Space(Exemplar<3>, Vec<Warning>),
}

/// Points are drawn as dots of this radius, in mean spacings.
const DOT_RADIUS: f64 = 0.2;
/// Corners of the outline of a dot.
const DOT_CORNERS: usize = 24;
/// A mean spacing of points is drawn this long, in CSS pixels.
const DOT_SPACING_PIXELS: f64 = 24.0;

impl LoadedExemplar {
    /// Reads an exemplar from the bytes of a file: SVG, CSV or OBJ, by its name and content.
    ///
    /// # Errors
    /// As [`svg::read_exemplar`], [`csv::read_points`] and [`obj::read_curves`]; [`Error::Unsupported`] for methods that do not exist yet.
    pub fn read(input: &Input, bytes: &[u8], reading: impl Into<Reading>, budget: &Budget) -> Result<Self> {
        let name = input.name();
        let options = reading.into().of_drawings(name)?;
        if arabesque_io::raster::png::is_png(bytes) {
            let problem = "a picture where an SVG drawing or a CSV file of points was expected";
            return Err(Error::input(name, problem, "draw the elements as vectors"));
        }
        if arabesque_io::mesh::gltf::is_glb(bytes) {
            let problem = "a scene in space where a drawing or points were expected";
            return Err(Error::input(
                name,
                problem,
                "fill a part of space: --box, --inside or --on, or use --method structures",
            ));
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            let problem = "points or a mesh as PLY where a drawing, points as CSV or curves as OBJ were expected";
            return Err(Error::input(name, problem, "fill with --method structures, or use relief or surface"));
        }
        let text = file::decode_text(name, bytes, budget)?;
        let start = text.trim_start();
        let foreign = [("{", "JSON"), ("#usda", "a scene as USD")];
        if let Some((_, what)) = foreign.into_iter().find(|(mark, _)| start.starts_with(mark)) {
            let problem = format!("{what} where a drawing, points as CSV or curves as OBJ were expected");
            return Err(Error::input(name, problem, "give the result as SVG or CSV, or the exemplar itself"));
        }
        if looks_like_curves(name, &text) {
            let net = obj::read_curves(name, &text, budget)?;
            return Ok(Self::Space(net.exemplar, net.warnings));
        }
        if looks_like_points(name, &text) {
            return Ok(match csv::read_points(name, &text, budget)? {
                Points::Plane(exemplar) => Self::Points(exemplar),
                Points::Space(exemplar) => Self::Space(exemplar, Vec::new()),
            });
        }
        let options = ReadOptions { budget: budget.clone(), ..options };
        let (drawing, regular) = read_drawing(&text, options, budget)?;
        Ok(Self::Drawing(Box::new(drawing), regular))
    }
}

/// Reads a drawing as what can be continued best, and how it repeats, where that is found out on the way.
fn read_drawing(text: &str, options: ReadOptions, budget: &Budget) -> Result<(Drawing, Known)> {
    let (drawing, mut known) = read_parts(text, options.clone(), budget)?;
    if has_recurring_parts(&drawing) {
        // What a repeat keeps in place needs not be put together.
        let apart = read_parts(text, ReadOptions { parts: Parts::Apart, ..options.clone() }, budget);
        if let Ok((apart, known)) = apart
            && repeats(&apart, budget)?
        {
            return Ok((apart, known));
        }
    }
    // What hangs together over the cell of a repeat is cut by the frame here and runs through it there.
    if let Some(found) = known.repeat()
        && found.lost() > 0
        && has(&drawing, &[Reason::Piece, Reason::Fill])
        && drawing.exemplar.period.is_none()
        && let as_page = (ReadOptions { tiling: svg::Tiling::Page, ..options.clone() })
        && let Some((alike, other)) = areas_alike(text, &as_page, budget)?
        && other.repeat().is_some_and(|other| other.lost() < found.lost())
    {
        return Ok((alike, other));
    }
    // Elements that repeat, or are strewn over one period, are better kept apart.
    if known.repeat().is_none() && drawing.exemplar.period.is_none() && has(&drawing, &[Reason::Piece]) {
        known = Known::Found(known.or_find(&drawing.exemplar, budget)?);
        if known.repeat().is_none()
            && let Some(alike) = areas_alike(text, &options, budget)?
        {
            return Ok(alike);
        }
    }
    Ok((drawing, known))
}

/// Whether loose parts were put together, because they come together in the same way again and again.
pub(crate) fn has_recurring_parts(drawing: &Drawing) -> bool {
    drawing.understood.iter().any(|known| known.reason == Reason::Recurring)
}

/// Whether something in a drawing was taken for what it is for one of these reasons.
fn has(drawing: &Drawing, reasons: &[Reason]) -> bool {
    drawing.understood.iter().any(|known| reasons.contains(&known.reason))
}

/// Whether a drawing repeats in all directions.
pub(crate) fn repeats(drawing: &Drawing, budget: &Budget) -> Result<bool> {
    Ok(regular(&drawing.exemplar, budget)?.is_some_and(|found| found.repeat().extent == Extent::Plane))
}

/// Reads a drawing with its loose parts as the options say.
fn read_parts(text: &str, options: ReadOptions, budget: &Budget) -> Result<(Drawing, Known)> {
    let (drawing, mut known) = match options.tiling {
        svg::Tiling::Auto => page_or_period(text, &options, budget)?,
        _ => (svg::read_exemplar(text, &options)?, Known::Unasked),
    };
    let is_dashed = drawing.strokes.iter().flatten().any(|stroke| !stroke.dashes.is_empty());
    if !drawing.exemplar.areas.is_empty() || is_dashed && options.large_fills == LargeFills::Areas {
        known = Known::Found(known.or_find(&drawing.exemplar, budget)?);
    }
    let is_shifted = drawing.strokes.iter().flatten().any(|stroke| stroke.dash_offset != 0.0);
    if known.repeat().is_none() && is_shifted && options.large_fills == LargeFills::Areas {
        // Lines that repeat but for where their dashes begin are taken for lines alike.
        let shifted = ReadOptions { dashes: Dashes::Shifted, ..options.clone() };
        let other = svg::read_exemplar(text, &shifted)?;
        if let Some(found) = regular(&other.exemplar, budget)? {
            return Ok((other, Known::Found(Some(found))));
        }
    }
    if is_dashed && known.repeat().is_some() {
        // Where the dashes repeat too, each has its place.
        let apart = ReadOptions { dashes: Dashes::Apart, ..options.clone() };
        if let Ok(dashes) = svg::read_exemplar(text, &apart)
            && let Some(found) = regular(&dashes.exemplar, budget)?
        {
            return Ok((dashes, Known::Found(Some(found))));
        }
    }
    let is_asked = options.tiling != svg::Tiling::Auto || shown(&drawing) > SMALL;
    if known.repeat().is_none()
        && is_asked
        && has(&drawing, &THROUGH)
        && let Some(alike) = areas_alike(text, &options, budget)?
    {
        return Ok(alike);
    }
    if drawing.exemplar.areas.is_empty() || known.repeat().is_some() {
        return Ok((drawing, known));
    }
    // Without a repeat, lines are all that can be made of areas.
    let options = ReadOptions { large_fills: LargeFills::Lines, ..options };
    Ok((svg::read_exemplar(text, &options)?, Known::Unasked))
}

/// A drawing whose fills repeat once all that are painted like those at the frame are areas: contour lines turned into
/// outlines, of which some close in the frame and lie in one another.
fn areas_alike(text: &str, options: &ReadOptions, budget: &Budget) -> Result<Option<(Drawing, Known)>> {
    if options.large_fills != LargeFills::Areas {
        return Ok(None);
    }
    let alike = ReadOptions { large_fills: LargeFills::AreasAlike, parts: Parts::Apart, ..options.clone() };
    let Ok(other) = svg::read_exemplar(text, &alike) else { return Ok(None) };
    if other.exemplar.areas.is_empty() {
        return Ok(None);
    }
    Ok(regular(&other.exemplar, budget)?.map(|found| (other, Known::Found(Some(found)))))
}

/// Why fills that run through the frame are taken for what they are.
const THROUGH: [Reason; 3] = [Reason::Area, Reason::Band, Reason::Traced];

/// A page whose repeat cannot be told and that shows no more elements than this is taken for one period.
const FEW: usize = 6;
/// A page that shows more than this is not read again.
const SMALL: usize = 1000;

/// Reads a drawing of which nobody says whether it is a page or one period of a pattern, with its repeat where that was looked for.
fn page_or_period(text: &str, options: &ReadOptions, budget: &Budget) -> Result<(Drawing, Known)> {
    let read = |tiling| svg::read_exemplar(text, &ReadOptions { tiling, ..options.clone() });
    let (page, period) = match read(svg::Tiling::Auto) {
        Ok(drawing) if drawing.exemplar.period.is_some() => (read(svg::Tiling::Page), Some(drawing)),
        page => (page, None),
    };
    // What is too large, or was stopped, is not read once more.
    if matches!(page, Err(Error::Limit { .. } | Error::Stopped { .. })) {
        return page.map(|page| (page, Known::Unasked));
    }
    let known = match &page {
        Ok(page) if period.is_some() || shown(page) <= SMALL => Known::Found(regular(&page.exemplar, budget)?),
        _ => Known::Unasked,
    };
    // A page that repeats by itself is no period, even if what its edges cut fits together by chance.
    if known.repeat().is_some() || matches!(&page, Ok(page) if shown(page) > SMALL && period.is_none()) {
        return page.map(|page| (page, known));
    }
    let as_page = ReadOptions { tiling: svg::Tiling::Page, ..options.clone() };
    if matches!(&page, Ok(page) if has(page, &THROUGH))
        && let Some(alike) = areas_alike(text, &as_page, budget)?
    {
        return Ok(alike);
    }
    if options.method != svg::Method::Auto && period.is_none() {
        return page.map(|page| (page, known));
    }
    // Strokes fit too easily to be taken for a period where they show enough as they are.
    let is_net = matches!(&page, Ok(page) if !page.exemplar.curves.is_empty());
    if let Some(period) = period.filter(|_| !is_net) {
        return Ok((period, Known::Unasked));
    }
    // Areas need a repeat, and a handful of elements shows no arrangement.
    let is_enough = |Exemplar { elements, curves, areas, .. }: &Exemplar<2>| {
        areas.is_empty() && elements.len() + curves.len() > FEW
    };
    let tiling = match &page {
        Ok(page) if is_enough(&page.exemplar) => svg::Tiling::Likely,
        _ => svg::Tiling::Possible,
    };
    // To find out that there is no period takes far less than to read the drawing once more.
    let as_period = ReadOptions { tiling, ..options.clone() };
    if page.is_ok() && !matches!(svg::shows_period(text, &as_period), Ok(true)) {
        return page.map(|page| (page, known));
    }
    match read(tiling) {
        Ok(period) if period.exemplar.period.is_some() => Ok((period, Known::Unasked)),
        _ => page.map(|page| (page, known)),
    }
}

/// How many things a drawing shows.
fn shown(drawing: &Drawing) -> usize {
    let Exemplar { elements, curves, areas, .. } = &*drawing.exemplar;
    elements.len() + curves.len() + areas.len()
}

/// By the extension, or else by the first statement that is not a comment.
fn looks_like_curves(name: &str, text: &str) -> bool {
    let first = text.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#'));
    let keyword = first.and_then(|l| l.split_whitespace().next());
    let unnamed = !name.contains('.') || name.starts_with("standard");
    name.to_ascii_lowercase().ends_with(".obj") || (unnamed && matches!(keyword, Some("v" | "o" | "g")))
}

/// By the extension where it is one of the usual, else by the first character.
fn looks_like_points(name: &str, text: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    let has = |endings: &[&str]| endings.iter().any(|e| lower.ends_with(e));
    has(&[".csv", ".tsv", ".txt", ".xyz"])
        || !(has(&[".svg", ".svgz"]) || text.trim_start().starts_with('<') || text.is_empty())
}

/// Points as a drawing of dots, one colour a class.
pub(crate) fn points_as_drawing(points: &Exemplar<2>) -> Drawing {
    let spacing = points.spacing();
    let radius = DOT_RADIUS * spacing;
    let mut exemplar = points.clone();
    for element in &mut exemplar.elements {
        element.outline = Outline { rings: vec![circle(element.centre, radius)] };
    }
    let fragments = points.elements.iter().map(|e| Fragment {
        markup: format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"{}\"/>",
            e.centre[0],
            e.centre[1],
            PALETTE[e.class % PALETTE.len()]
        ),
        layer: None,
        label: Some(points.classes[e.class].name.clone()),
        source: None,
    });
    Drawing {
        fragments: fragments.collect(),
        strokes: Vec::new(),
        fills: Vec::new(),
        layers: vec![Layer::all_elements(&exemplar)],
        background: None,
        parts: Parts::default(),
        definitions: String::new(),
        page: Page { view: exemplar.window, unit: Unit::Px, unit_per_user: DOT_SPACING_PIXELS / spacing },
        job: Job::default(),
        understood: Vec::new(),
        warnings: Vec::<Warning>::new(),
        exemplar: Arc::new(exemplar),
    }
}

fn circle(centre: Vector<2>, radius: f64) -> Vec<Vector<2>> {
    (0..DOT_CORNERS)
        .map(|k| {
            let (s, c) = (k as f64 / DOT_CORNERS as f64 * std::f64::consts::TAU).sin_cos();
            centre + Vector::xy(c, s) * radius
        })
        .collect()
}

/// The exemplar of elements and curves, in words.
pub(crate) fn understood<const D: usize>(exemplar: &Exemplar<D>) -> String {
    let (elements, classes) = (exemplar.elements.len(), exemplar.classes.len());
    let (curves, styles) = (exemplar.curves.len(), exemplar.styles.len());
    let of_curves = if curves > 0 { format!(", {curves} curves in {styles} styles") } else { String::new() };
    let of_areas = if exemplar.areas.is_empty() { String::new() } else { format!(", {} areas", exemplar.areas.len()) };
    format!("exemplar: {elements} elements in {classes} classes{of_curves}{of_areas}")
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::recipe::Method;

    fn read(name: &str, bytes: &[u8]) -> Result<LoadedExemplar> {
        LoadedExemplar::read(&Input::file(name), bytes, Method::Auto, &Budget::default())
    }

    #[test]
    fn the_content_decides_where_the_name_does_not() {
        assert!(matches!(read("-", b"x,y\n0,0\n1,0\n0,1\n"), Ok(LoadedExemplar::Points(_))));
        assert!(matches!(read("a.csv", b"x,y,z\n0,0,0\n1,0,1\n0,1,0\n"), Ok(LoadedExemplar::Space(..))));
        assert!(read("a.svg", b"\x89PNG\r\n\x1a\n").unwrap_err().to_string().contains("a picture where"));
    }

    #[test]
    fn curves_in_space_are_known_by_name_or_content() {
        let net = b"# net\nv 0 0 0\nv 1 1 1\nl 1 2\n";
        for name in ["a.obj", "-"] {
            assert!(matches!(read(name, net), Ok(LoadedExemplar::Space(e, _)) if e.curves.len() == 1));
        }
    }

    #[test]
    fn later_methods_are_refused_by_name() {
        let err = LoadedExemplar::read(&Input::file("a.csv"), b"0,0\n1,1\n", Method::Structures, &Budget::default())
            .unwrap_err();
        assert!(err.to_string().contains("structures are points"));
    }

    #[test]
    fn dots_have_area_and_colour() {
        let Ok(LoadedExemplar::Points(points)) = read("a.csv", b"x,y,class\n0,0,a\n1,0,b\n0,1,a\n") else { panic!() };
        let drawing = points_as_drawing(&points);
        assert!(drawing.exemplar.elements[0].outline.area() > 0.0);
        assert_ne!(drawing.fragments[0].markup, drawing.fragments[1].markup);
    }

    /// Rings in rings over columns 50 apart, cut by the sides of the page, with a line of uneven width
    /// through it; `off`: how far each row lies beside the last.
    fn rings_in_rings(off: impl Fn(usize) -> f64) -> String {
        let at = |x: f64, y: f64| format!("{x} {y}");
        let mut data = String::new();
        for row in 0..4_usize {
            let (top, by) = (50.0 * row as f64, off(row));
            for column in 0..4_usize {
                let (x, y) = (50.0 * column as f64 - 20.0 + by, top + 20.0);
                for r in [18.0, 16.5, 9.0, 7.0] {
                    let corners = [at(x - r, y), at(x, y - 0.8 * r), at(x + r, y), at(x, y + 0.9 * r)];
                    let _ = write!(data, "M{}z", corners.join("L"));
                }
            }
            let wave = |down: f64| (0..8).map(move |k| (25.0 * f64::from(k) - 20.0, down * f64::from(k % 2)));
            let upper = wave(5.0).map(|(x, y)| at(x + by, top + 40.0 + y));
            let lower = wave(3.0).map(|(x, y)| at(x + by, top + 44.0 + y)).rev();
            let _ = write!(data, "M{}z", upper.chain(lower).collect::<Vec<_>>().join("L"));
        }
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='125' height='160'><path fill-rule='evenodd' d='{data}'/></svg>"
        )
    }

    #[test]
    fn outlines_that_repeat_are_areas_together_and_others_are_not() {
        let budget = Budget::default();
        let alike = |text: &str| {
            let large_fills = LargeFills::Areas;
            let options = ReadOptions { large_fills, tiling: svg::Tiling::Page, ..ReadOptions::new("t.svg") };
            areas_alike(text, &options, &budget).unwrap()
        };
        let (drawing, found) = alike(&rings_in_rings(|_| 0.0)).unwrap();
        assert!(
            drawing.exemplar.elements.is_empty() && found.repeat().is_some_and(|f| f.repeat().extent == Extent::Plane)
        );
        let cell = regular(&drawing.exemplar, &budget).unwrap().unwrap().repeat().lattice.cell();
        assert!((cell - 2500.0).abs() < 1.0, "{cell}");
        assert!(alike(&rings_in_rings(|row| [0.0, 13.0, 4.0, 21.0][row])).is_none(), "rows that slip");
    }

    /// Bands across the page with prongs that hang over the next cells of 50 x 50, as one compound path cut at the sides of the page; and what
    /// they cover.
    fn prongs() -> (String, f64) {
        let ring = |corners: &[(f64, f64)]| corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>();
        let mut rings = Vec::new();
        for row in 0..4_u32 {
            let y = 20.0 + 50.0 * f64::from(row);
            rings.push(ring(&[(-9.0, y), (200.0, y), (200.0, y + 9.0), (-9.0, y + 9.0)]));
            for column in 0..6_u32 {
                let x = 50.0 * f64::from(column) - 90.0;
                rings.push(ring(&[(x, y), (x + 68.0, y - 30.0), (x + 76.0, y - 30.0), (x + 14.0, y)]));
            }
        }
        let page = Outline { rings: vec![ring(&[(0.0, 0.0), (112.0, 0.0), (112.0, 108.0), (0.0, 108.0)])] };
        let whole = Outline::union(&rings, arabesque_core::FillRule::NonZero).intersection(&page);
        let mut data = String::new();
        for ring in &whole.rings {
            let corners: Vec<_> = ring.iter().map(|p| format!("{} {}", p[0], p[1])).collect();
            let _ = write!(data, "M{}z", corners.join("L"));
        }
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg' width='112' height='108'><path d='{data}'/></svg>");
        (text, whole.area())
    }

    #[test]
    fn what_hangs_together_over_the_cell_is_continued_whole() {
        let (text, covered) = prongs();
        let alone =
            ReadOptions { large_fills: LargeFills::Areas, tiling: svg::Tiling::Page, ..ReadOptions::new("t.svg") };
        let page = svg::read_exemplar(&text, &alone).unwrap();
        let found = regular(&page.exemplar, &Budget::default()).unwrap().unwrap();
        assert!(found.lost() > 0, "prongs that the sides of the page have cut off their bands");
        let Ok(LoadedExemplar::Drawing(drawing, Known::Found(Some(found)))) = read("t.svg", text.as_bytes()) else {
            panic!()
        };
        assert_eq!((drawing.exemplar.elements.len(), found.lost()), (0, 0));
        let ink: f64 = drawing.exemplar.areas.iter().map(|area| area.outline.area()).sum();
        assert!((ink - covered).abs() < 0.5, "{ink} {covered}");
    }
}
