//! What is taken for one period, and how it is put together.

use std::f64::consts::PI;

use arabesque_core::{Budget, Limits, Role, Vector};

use crate::svg::{
    drawing::Drawing,
    options::{LargeFills, ReadOptions, Tiling},
    read::exemplar::read_exemplar,
};

fn read(size: [u32; 2], body: &str, tiling: Tiling) -> arabesque_core::Result<Drawing> {
    let [w, h] = size;
    let text =
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='{w}' height='{h}' viewBox='0 0 {w} {h}'>{body}</svg>");
    read_exemplar(&text, &ReadOptions { tiling, large_fills: LargeFills::Areas, ..ReadOptions::new("t.svg") })
}

fn period(size: [u32; 2], body: &str) -> Drawing {
    read(size, body, Tiling::Period).unwrap()
}

/// Whether the elements have these areas, each element one of them, as well as outlines of few corners can.
fn has_areas(drawing: &Drawing, expected: &[f64]) -> bool {
    let found: Vec<f64> = drawing.exemplar.elements.iter().map(|e| e.outline.area()).collect();
    let is_near = |a: f64, b: f64| (a - b).abs() <= 0.02 * b;
    found.iter().all(|a| expected.iter().any(|b| is_near(*a, *b)))
        && expected.iter().all(|b| found.iter().any(|a| is_near(*a, *b)))
}

fn per_period(drawing: &Drawing) -> f64 {
    let [p, q] = drawing.exemplar.period.unwrap();
    let inside = drawing.exemplar.elements.iter().filter(|e| drawing.exemplar.window.contains(e.centre)).count();
    inside as f64 * (p[0] * q[1] - p[1] * q[0]).abs() / drawing.exemplar.window.measure()
}

const HALVES: &str = "<g fill='#c63'><path d='M0 12a8 8 0 0 1 0 16z'/><path d='M60 12a8 8 0 0 0 0 16z'/>
    <path d='M22 0a8 8 0 0 0 16 0z'/><path d='M22 40a8 8 0 0 1 16 0z'/></g><circle cx='30' cy='20' r='5' fill='#369'/>";

#[test]
fn halves_at_opposite_edges_become_wholes() {
    let drawing = period([60, 40], HALVES);
    assert!(has_areas(&drawing, &[25.0 * PI, 64.0 * PI]));
    assert!((per_period(&drawing) - 3.0).abs() < 1e-9, "{}", per_period(&drawing));
    assert!(drawing.exemplar.elements.iter().all(|e| e.role == Role::Source));
    let [p, q] = drawing.exemplar.period.unwrap();
    assert_eq!((p.0, q.0), ([60.0, 0.0], [0.0, 40.0]));
    let periods = drawing.exemplar.window.size();
    assert!((0..2).all(|k| (periods[k] / [60.0, 40.0][k]).fract() == 0.0 && periods[k] / [60.0, 40.0][k] >= 2.0));
}

#[test]
fn quarters_at_the_corners_become_one() {
    let body = "<path d='M0 0h10a10 10 0 0 1-10 10zM50 0v10a10 10 0 0 1-10-10zM0 50v-10a10 10 0 0 1 10 10zM50 \
                50h-10a10 10 0 0 1 10-10z'/>";
    let drawing = period([50, 50], body);
    assert!(has_areas(&drawing, &[100.0 * PI]));
    assert!((per_period(&drawing) - 1.0).abs() < 1e-9);
}

#[test]
fn what_is_drawn_once_more_at_the_opposite_edge_is_one_thing() {
    let at =
        |x: u32, y: u32| format!("<g transform='translate({x} {y})'><circle r='9'/><circle r='4' fill='red'/></g>");
    let body = [at(0, 0), at(80, 0), at(0, 60), at(80, 60), at(40, 30)].concat();
    for tiling in [Tiling::Period, Tiling::Auto] {
        let drawing = read([80, 60], &body, tiling).unwrap();
        assert!(has_areas(&drawing, &[81.0 * PI]));
        assert!((per_period(&drawing) - 2.0).abs() < 1e-9, "{}", per_period(&drawing));
    }
}

#[test]
fn strokes_go_on_over_the_edges() {
    let drawing = period([60, 60], "<path d='M0 15C15 0 45 30 60 15M20 0V60' fill='none' stroke='red'/>");
    let exemplar = &drawing.exemplar;
    let reach = |k: usize| exemplar.window.size()[k];
    assert!(exemplar.elements.is_empty() && !exemplar.curves.is_empty());
    for curve in &exemplar.curves {
        let size = curve.path.bounds().size();
        assert!(size[0] >= reach(0) || size[1] >= reach(1), "{size:?}");
    }
}

#[test]
fn an_edge_that_does_not_fit_is_told_with_its_place() {
    let body = "<path d='M0 12a8 8 0 0 1 0 16z'/><path d='M60 15a8 8 0 0 0 0 16z'/><circle cx='30' cy='20' r='5'/>";
    let told = read([60, 40], body, Tiling::Period).unwrap_err().to_string();
    assert!(
        told.starts_with("t.svg:1: <path>: the opposite edges of the period do not fit: the left edge cuts this 20")
    );
    assert!(read([60, 40], body, Tiling::Auto).is_ok());
    let stroke = "<path d='M0 12C20 0 40 30 60 30' fill='none' stroke='red'/>";
    assert!(read([60, 40], stroke, Tiling::Period).unwrap_err().to_string().contains("12 from the top"));
    // Squares that end at an edge are whole.
    let chess = "<rect width='20' height='20'/><rect x='20' y='20' width='20' height='20'/>";
    assert!(has_areas(&period([40, 40], chess), &[400.0]));
}

#[test]
fn cuts_that_meet_in_part_are_one_thing() {
    let drawing = period([40, 40], "<path d='M0 10H8V30H0z'/><path d='M40 10H34V20H40z'/>");
    assert!(has_areas(&drawing, &[220.0]));
    assert!((per_period(&drawing) - 1.0).abs() < 1e-9);
    // Beside what goes on, the outline follows the edge, on either side and with two parts at once.
    let drawing = period([40, 40], "<path d='M0 5H8V35H0z'/><path d='M40 2H34V10H40z'/><path d='M40 20H34V25H40z'/>");
    assert!(has_areas(&drawing, &[240.0 + 48.0 + 30.0]));
    // Each key is joined to the next ones by parts of its sides.
    let keys = period([35, 35], "<path d='M0 0h35v5H5v25h20V15h-5v5h-5V10h15v25H0z'/>");
    assert_eq!(keys.exemplar.elements.len(), 0);
}

#[test]
fn pages_that_fit_by_chance_or_not_at_all_stay_pages() {
    let squares: String = (0..25)
        .map(|k| format!("<rect x='{}' y='{}' width='20' height='20'/>", k % 5 * 20, k / 5 * 20))
        .enumerate()
        .filter(|(k, _)| k % 2 == 0)
        .map(|(_, text)| text)
        .collect();
    let dots = |shift: f64| -> String {
        (0..20)
            .map(|k| {
                format!(
                    "<circle cx='{}' cy='{}' r='6'/>",
                    25 * (k % 5),
                    f64::from(25 * (k / 5)) + f64::from(k % 3) * shift
                )
            })
            .collect()
    };
    let pages = [
        squares,
        dots(3.0),
        dots(7.5),
        "<circle cx='30' cy='30' r='9'/><circle cx='70' cy='60' r='9'/>".to_owned(),
        "<path d='M0 20H100M0 50H100M0 80H100M20 0V100M60 0V100' fill='none' stroke='red'/>".to_owned(),
        "<rect y='10' width='100' height='12'/><rect y='40' width='100' height='12'/><rect x='10' width='9' height='100'/>".to_owned(),
        HALVES.replace("M60 12", "M60 13"),
        "<path d='M0 20C30 0 60 40 100 20M0 60C30 40 60 80 100 60' fill='none' stroke='red'/>".to_owned(),
        "<path d='M0 0L50 40L100 0M0 100L50 60L100 100' fill='none' stroke='red'/><circle cx='50' cy='50' r='4'/>".to_owned(),
        "<g fill='red'><circle cx='0' cy='50' r='9'/></g><g fill='blue'><circle cx='100' cy='50' r='9'/></g>".to_owned(),
    ];
    for body in pages {
        let found = read([100, 100], &format!("{body}<circle cx='33' cy='71' r='3' fill='lime'/>"), Tiling::Auto);
        assert!(found.unwrap().exemplar.period.is_none(), "{body}");
    }
    assert!(read([60, 40], HALVES, Tiling::Auto).unwrap().exemplar.period.is_some());
    assert!(read([60, 40], HALVES, Tiling::Page).unwrap().exemplar.period.is_none());
}

fn pattern(attributes: &str, content: &str) -> arabesque_core::Result<Drawing> {
    let body =
        format!("<pattern id='p' {attributes}>{content}</pattern><rect width='200' height='100' fill='url(#p)'/>");
    read([200, 100], &body, Tiling::Auto)
}

#[test]
fn patterns_have_their_own_units_and_transforms() {
    let dot = "<circle cx='5' cy='5' r='3'/>";
    let vectors = |attributes: &str, content: &str| {
        let [p, q] = pattern(attributes, content).unwrap().exemplar.period.unwrap();
        [p[0], p[1], q[0], q[1]].map(|v| (v * 1e3).round() / 1e3)
    };
    assert_eq!(vectors("width='10' height='12' patternUnits='userSpaceOnUse'", dot), [10.0, 0.0, 0.0, 12.0]);
    assert_eq!(vectors("width='.1' height='.2'", dot), [20.0, 0.0, 0.0, 20.0]);
    let turned = "width='10' height='12' patternUnits='userSpaceOnUse' patternTransform='rotate(90) scale(2)'";
    assert_eq!(vectors(turned, dot), [0.0, 20.0, -24.0, 0.0]);
    let boxed = "width='.1' height='.2' patternContentUnits='objectBoundingBox'";
    let drawing = pattern(boxed, "<circle cx='.05' cy='.1' r='.02'/>").unwrap();
    let size = drawing.exemplar.elements[0].outline.bounds().size();
    assert!((size[0] - 8.0).abs() < 0.1 && (size[1] - 4.0).abs() < 0.1, "{size:?}");
    let viewed = "width='20' height='20' patternUnits='userSpaceOnUse' viewBox='0 0 10 10'";
    assert!(has_areas(&pattern(viewed, dot).unwrap(), &[36.0 * PI]));
    // The content has its origin at x and y.
    let shifted = "x='4' y='3' width='10' height='10' patternUnits='userSpaceOnUse'";
    assert!(has_areas(&pattern(shifted, dot).unwrap(), &[9.0 * PI]));
    let boxed = "x='.02' y='.03' width='.1' height='.2' patternContentUnits='objectBoundingBox'";
    let drawing = pattern(boxed, "<rect x='.01' y='.02' width='.08' height='.16'/>").unwrap();
    assert!(has_areas(&drawing, &[16.0 * 16.0]));
    let inherited = "<pattern id='q' width='10' height='10' patternUnits='userSpaceOnUse'><circle cx='5' cy='5' r='3'/>\
                     </pattern><pattern id='p' href='#q' patternTransform='scale(3)'/>\
                     <rect width='200' height='100' fill='url(#p)'/>";
    assert!(has_areas(&read([200, 100], inherited, Tiling::Auto).unwrap(), &[81.0 * PI]));
}

#[test]
fn what_a_pattern_does_not_show_is_not_there() {
    let units = "width='30' height='30' patternUnits='userSpaceOnUse'";
    let drawing = pattern(units, "<circle cx='30' cy='15' r='6'/><rect x='5' y='5' width='8' height='8'/>").unwrap();
    assert!(has_areas(&drawing, &[18.0 * PI, 64.0]));
    let alone = pattern(units, "<rect width='30' height='30' fill='#eee'/><circle cx='15' cy='15' r='6'/>").unwrap();
    assert!(alone.background.unwrap().contains("#eeeeee"));
}

#[test]
fn patterns_that_cannot_be_repeated_are_refused() {
    let units = "patternUnits='userSpaceOnUse'";
    let dot = "<circle cx='5' cy='5' r='3'/>";
    let told = |attributes: &str, content: &str| pattern(attributes, content).unwrap_err().to_string();
    assert!(told(units, dot).contains("a pattern of no size: width none, height none"));
    assert!(told(&format!("{units} width='0' height='10'"), dot).contains("no size"));
    assert!(told(&format!("{units} width='1e-12' height='10'"), dot).contains("no size"));
    assert!(told(&format!("{units} width='10' height='10' href='#p'"), dot).contains("refers to itself"));
    assert!(told(&format!("{units} width='10' height='10'"), "").contains("draws nothing"));
    let own = "<rect width='5' height='5' fill='url(#p)'/>";
    assert!(told(&format!("{units} width='10' height='10'"), own).contains("fills something in itself"));
    let flat = format!("{units} width='10' height='10' patternTransform='scale(1 0)'");
    assert!(told(&flat, dot).contains("leaves nothing of it"));
    let sheared = format!("{units} width='10' height='10' patternTransform='skewX(89.9999)'");
    assert!(pattern(&sheared, dot).is_err());
    // A million cells on the page are as few as one.
    assert!(pattern(&format!("{units} width='.1' height='.1'"), "<circle cx='.05' cy='.05' r='.03'/>").is_ok());
}

#[test]
fn large_periods_meet_a_limit() {
    let dots: String = (0..3000).map(|k| format!("<circle cx='{}.5' cy='{}.5' r='.3'/>", k % 60, k / 60)).collect();
    let text = format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 60 60'>{dots}</svg>");
    let budget = Budget::new(Limits { nodes: 7000, ..Limits::default() });
    let options = ReadOptions { tiling: Tiling::Period, budget, ..ReadOptions::new("l.svg") };
    let told = read_exemplar(&text, &options).unwrap_err().to_string();
    assert!(told.contains("copies of what one period holds"), "{told}");
}

/// What a page is taken for without being asked, when its edges say most, and when it shows too little.
fn is_taken(size: [u32; 2], body: &str) -> [bool; 2] {
    [Tiling::Likely, Tiling::Possible]
        .map(|tiling| read(size, body, tiling).is_ok_and(|drawing| drawing.exemplar.period.is_some()))
}

#[test]
fn swatches_whose_edges_say_most_are_taken_for_periods() {
    // A slanted bar, and a wedge that ends at the upper edge.
    let bar = "<path d='M0 10L10 0h6L0 16zM40 10L10 40h6L40 16zM22 0h6l-3 6z'/>";
    assert_eq!(is_taken([40, 40], bar), [true; 2]);
    // A weave of bars that end at the edges.
    let weave = "<path d='M0 2h18v4H0zM0 10h18v4H0zM22 0h4v18h-4zM30 0h4v18h-4zM2 20h4v20H2zM10 20h4v20h-4zM20 22h20v4H20zM20 30h20v4H20z'/>";
    assert!(is_taken([40, 40], weave)[0]);
    // Bricks with gaps, flush with the upper and the left edge.
    let brick = |k: usize| format!("<rect x='{}' y='{}' width='12' height='6'/>", k % 5 * 14, k / 5 * 8);
    let bricks: String = (0..25).filter(|k| k * k % 7 != 2).map(brick).collect();
    assert!(is_taken([70, 40], &bricks)[0]);
    let away = bricks.replace("x='0'", "x='1.5'");
    assert!(!is_taken([70, 40], &away)[0]);
}

#[test]
fn one_thing_alone_is_a_period_and_a_heap_is_none() {
    assert_eq!(is_taken([24, 24], "<path d='M8 4l4 2-4 2-2 4-2-4-4-2 4-2 2-4z'/>"), [false, true]);
    assert_eq!(is_taken([24, 24], "<circle cx='30' cy='12' r='9'/>"), [false, false]);
    let heap = "<circle cx='12' cy='12' r='9'/>".repeat(9);
    assert_eq!(is_taken([24, 24], &heap), [false, false]);
}

#[test]
fn a_part_cut_out_of_something_larger_is_no_period() {
    // Blobs that the edges cut where they like, and the same with each of them going on at the opposite edge.
    let cut = "<path d='M0 20C12 16 12 36 0 32zM40 0C42 20 60 16 62 0zM100 50C80 46 84 72 100 66zM22 100C24 86 40 84 48 100z'/>";
    assert_eq!(is_taken([100, 100], cut), [false; 2]);
    let whole = "<path d='M0 20C12 16 12 36 0 32zM100 20C90 16 90 36 100 32zM40 0C42 20 60 16 62 0zM40 100C42 84 60 86 62 100z'/>";
    assert!(is_taken([100, 100], whole)[1]);
    // What stands on the lower edge was put there.
    assert!(is_taken([100, 100], "<path d='M10 100C24 60 30 60 40 100zM60 100C74 50 80 60 90 100z'/>")[1]);
}

#[test]
fn strokes_by_hand_come_to_both_edges_of_any_page() {
    let line =
        |at: f64, off: f64| format!("<path d='M0 {at}Q50 {} 100 {}' fill='none' stroke='red'/>", at + 9.0, at + off);
    let drawn = |off: f64| (1..5).map(|k| line(20.0 * f64::from(k), off)).collect::<String>();
    assert!(is_taken([100, 100], &drawn(0.0))[0]);
    assert_eq!(is_taken([100, 100], &drawn(0.8)), [false; 2]);
}

#[test]
fn an_area_that_narrows_to_a_point_at_an_edge_keeps_its_holes() {
    // Round windows that touch the upper and lower edge in one point, each in two halves.
    let body = "<path fill-rule='evenodd' d='M0 0h40v20H0zM20 0a10 10 0 0 1 0 20a10 10 0 0 1 0-20z'/>";
    let drawing = period([40, 20], body);
    let is_filled = |x: f64, y: f64| drawing.exemplar.areas.iter().any(|area| area.outline.contains(Vector::xy(x, y)));
    for (i, j) in [(1, 1), (2, 2), (3, 4)].map(|(i, j)| (f64::from(i), f64::from(j))) {
        assert!(is_filled(40.0 * i + 1.0, 20.0 * j + 1.0) && is_filled(40.0 * i + 3.0, 20.0 * j + 10.0), "{i} {j}");
        assert!(!is_filled(40.0 * i + 20.0, 20.0 * j + 10.0) && !is_filled(40.0 * i + 20.0, 20.0 * j + 1.0), "{i} {j}");
    }
}

#[test]
fn what_ends_at_an_edge_may_but_halves_have_to_meet() {
    let arch = "<path d='M10 40a10 10 0 0 1 20 0z'/><circle cx='20' cy='15' r='6'/>";
    assert!(has_areas(&period([40, 40], arch), &[50.0 * PI, 36.0 * PI]));
    let off = "<path d='M10 40a10 10 0 0 1 20 0z'/><path d='M12 0a10 10 0 0 0 20 0z'/><circle cx='20' cy='15' r='2'/>";
    let told = read([40, 40], off, Tiling::Period).unwrap_err().to_string();
    assert!(told.contains("does not go on at the"), "{told}");
    let beams = "<path d='M0 0h24v4H0zM6 12h4v10h24v-4h6v6H16v16H4V30h2z'/>";
    assert!(read([40, 40], beams, Tiling::Period).is_ok());
}
