//! What drawings as people make them are taken for, each kind in a tiny drawing, with drawings beside it that are of
//! another kind.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use arabesque_core::{Error, Role, Vector};
use arabesque_io::svg::{Drawing, LargeFills, Method, ReadOptions, Reason, Tiling, read_exemplar};

const NAMESPACES: &str = "xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' \
     xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape'";

fn read_with(body: &str, method: Method) -> Result<Drawing, Error> {
    let text = format!("<svg {NAMESPACES} width='100' height='100' viewBox='0 0 100 100'>{body}</svg>");
    read_exemplar(&text, &ReadOptions { method, tiling: Tiling::Page, ..ReadOptions::new("t.svg") })
}

fn read(body: &str) -> Drawing {
    read_with(body, Method::Auto).unwrap()
}

/// Elements and curves.
fn counts(drawing: &Drawing) -> (usize, usize) {
    (drawing.exemplar.elements.len(), drawing.exemplar.curves.len())
}

/// How many things were taken for what they are for that reason.
fn because(drawing: &Drawing, reason: Reason) -> usize {
    drawing.understood.iter().filter(|known| known.reason == reason).map(|known| known.count).sum()
}

fn stroked(body: &str) -> String {
    format!("<g fill='none' stroke='#225' stroke-width='1' stroke-linecap='round'>{body}</g>")
}

fn at_places(what: &str) -> String {
    [(8, 9), (40, 12), (75, 8), (12, 45), (47, 50), (80, 42), (9, 80), (44, 84), (79, 78)]
        .map(|(x, y)| format!("<g transform='translate({x} {y})'>{what}</g>"))
        .concat()
}

#[test]
fn small_strokes_beside_a_net_are_elements() {
    let net = "<path d='M0 30H100M0 65H100M33 0V100M66 0V100'/>";
    let spirals =
        "<path d='M15 15c2-3 5 0 3 2s-7 1-6-3'/><path d='M50 48l4 4M54 48l-4 4'/><circle cx='84' cy='85' r='3'/>";
    let d = read(&stroked(&(net.to_owned() + spirals)));
    assert_eq!(counts(&d), (3, 4), "a spiral, a cross of two subpaths, a ring, and four lines");
    assert_eq!((because(&d, Reason::Through), because(&d, Reason::Stroke)), (4, 3));
    assert_eq!(counts(&read_with(&stroked(net), Method::Elements).unwrap()), (1, 0));
    assert_eq!(read_with(&stroked(spirals), Method::Curves).unwrap().exemplar.elements.len(), 0);
}

#[test]
fn twigs_and_what_the_frame_cuts_off_belong_to_the_net() {
    let d = read(&stroked(
        "<path d='M0 30H100'/><path d='M50 30v9'/><path d='M95 0v20q0 3 5 3'/><path d='M20 70q6-6 12 0'/>",
    ));
    assert_eq!(counts(&d), (1, 3), "the bow alone is a thing of its own");
    assert_eq!(because(&d, Reason::Beside), 1);
}

#[test]
fn dashes_of_one_path_are_elements_each() {
    let dashes = "M8 9l6 3M40 12l5 5M75 8l2-6M12 45l6 3M47 50l-5 5M80 42l0 7M9 80l7 0M44 84l3 6M79 78l5-5";
    let d = read(&stroked(&format!("<path d='{dashes}'/>")));
    assert_eq!(counts(&d), (9, 0));
    assert_eq!(because(&d, Reason::Stroke), 9);
}

#[test]
fn loose_strokes_of_an_icon_are_one_element() {
    let sun = "<circle r='3'/><path d='M5 0h2'/><path d='M-7 0h2'/><path d='M0 5v2'/><path d='M0 -7v2'/>";
    let d = read(&stroked(&at_places(sun)));
    assert_eq!((counts(&d), because(&d, Reason::Group)), ((9, 0), 9));
    let loose: String = at_places("")
        .split("<g transform='")
        .skip(1)
        .map(|g| g.split('\'').next().unwrap())
        .fold(String::new(), |all, place| all + &sun.replace("/>", &format!(" transform='{place}'/>")));
    let d = read(&stroked(&loose));
    assert_eq!(counts(&d), (9, 0));
    assert_eq!(because(&d, Reason::Together), 9);
    assert_eq!(d.exemplar.classes.len(), 1);
}

#[test]
fn strokes_and_the_fills_that_they_touch_are_one_element() {
    let flowers = "<circle cx='-5' cy='-5' r='3' fill='red'/><path d='M-5 -5v12' fill='none' stroke='green'/>";
    let loose: String = [(20, 20), (70, 25), (30, 70), (80, 75)]
        .map(|(x, y)| flowers.replace("/>", &format!(" transform='translate({x} {y})'/>")))
        .concat();
    let d = read(&loose);
    assert_eq!((counts(&d), because(&d, Reason::Touching)), ((4, 0), 4));
}

/// Traces on squared paper with a pad at each end; `step` from line to line.
fn traces(shapes: &[&[(i32, i32)]], step: f64) -> String {
    let at = |n: i32| step * f64::from(n) + 3.0;
    let trace = |shape: &&[(i32, i32)]| {
        let points: String = shape.iter().map(|&(x, y)| format!("{},{} ", at(x), at(y))).collect();
        let pad = |&(x, y): &(i32, i32)| format!("<circle cx='{}' cy='{}' r='1.5' fill='#fff'/>", at(x), at(y));
        let pads: String = shape.first().into_iter().chain(shape.last()).map(pad).collect();
        format!("<polyline points='{points}'/>{pads}")
    };
    stroked(&shapes.iter().map(trace).collect::<String>())
}

#[test]
fn traces_of_many_shapes_on_squared_paper_are_one_net_and_their_pads_are_elements() {
    let shapes: [&[(i32, i32)]; 8] = [
        &[(0, 0), (3, 0), (5, 2)],
        &[(1, 2), (1, 5)],
        &[(3, 3), (6, 3), (6, 6)],
        &[(8, 0), (8, 4), (10, 6)],
        &[(0, 7), (4, 7)],
        &[(2, 9), (5, 9), (7, 11)],
        &[(9, 8), (11, 8), (11, 11)],
        &[(0, 11), (3, 11)],
    ];
    let d = read(&traces(&shapes, 8.0));
    assert_eq!((counts(&d), because(&d, Reason::Ruled)), ((16, 8), 8));
    // The same ones at any distance keep to no paper.
    let loose: String = shapes.iter().zip(0..).map(|(shape, k)| traces(&[shape], 5.0 + 0.37 * f64::from(k))).collect();
    assert_eq!(because(&read(&loose), Reason::Ruled), 0);
    // A thing that comes again is a thing.
    let again: Vec<[(i32, i32); 3]> = (0..9)
        .map(|k| [(4 * (k % 3), 4 * (k / 3)), (4 * (k % 3) + 2, 4 * (k / 3)), (4 * (k % 3) + 2, 4 * (k / 3) + 1)])
        .collect();
    let again: Vec<&[(i32, i32)]> = again.iter().map(|shape| shape.as_slice()).collect();
    assert_eq!(because(&read(&traces(&again, 8.0)), Reason::Ruled), 0);
}

#[test]
fn cells_with_narrow_gaps_are_a_net_and_cells_apart_are_not() {
    let cells = |side: f64| -> String {
        let cell = |k: u32| {
            let (x, y) = (f64::from(k % 9) * 12.0 - 3.0, f64::from(k / 9) * 12.0 - 3.0);
            format!("<rect x='{x}' y='{y}' width='{side}' height='{side}' rx='2'/>")
        };
        (0..81).map(cell).collect()
    };
    let net = read(&stroked(&cells(10.0)));
    assert_eq!((counts(&net), because(&net, Reason::Crowded)), ((0, 81), 77), "the corners belong to it as well");
    assert_eq!(counts(&read(&stroked(&cells(7.0)))), (81, 0));
}

#[test]
fn strokes_of_no_length_are_dots_or_squares() {
    let dots = "M10 10h0M30 12zM50 9l0 0M70 13h0M20 40h0M60 45h0";
    let stroke = |cap: &str| format!("<path d='{dots}' stroke='red' stroke-width='4' stroke-linecap='{cap}'/>");
    let d = read(&stroke("round"));
    assert_eq!((counts(&d), because(&d, Reason::Dot)), ((6, 0), 6));
    let area = d.exemplar.elements[0].outline.area();
    assert!((area - 4.0 * std::f64::consts::PI).abs() < 0.2, "{area}");
    assert_eq!(read(&stroke("square")).exemplar.elements[0].outline.area(), 16.0);
    assert!(read_with(&stroke("butt"), Method::Auto).unwrap_err().to_string().contains("without length"));
}

#[test]
fn closed_outlines_that_share_edges_are_one_net_without_doubles() {
    let cell = |k: u32| {
        let (x, y) = (f64::from(k % 7) * 18.005 - 10.0, f64::from(k / 7) * 18.0 - 10.0);
        format!("<rect x='{x:.2}' y='{y:.2}' width='18' height='18'/>")
    };
    let d = read(&stroked(&(0..49).map(cell).collect::<String>()));
    let length: f64 = d.exemplar.curves.iter().flat_map(|c| &c.path.cubics).map(|c| (c[3] - c[0]).norm()).sum();
    assert!(d.exemplar.elements.is_empty() && d.exemplar.curves.iter().all(|c| !c.path.closed));
    assert!((1300.0..2100.0).contains(&length), "{length}, of 3528 with doubles");
    let tiles = (0..49).map(cell).collect::<String>().replace("/>", " fill='red'/>");
    assert_eq!(read(&tiles).exemplar.curves.len(), 0, "filled tiles stay elements");
}

#[test]
fn what_is_covered_is_left_out() {
    let dots = at_places("<circle r='5'/>");
    let under = "<rect x='6' y='7' width='4' height='4' fill='red'/>";
    let d = read(&format!("{under}{dots}"));
    assert_eq!((counts(&d), because(&d, Reason::Covered)), ((9, 0), 1));
    let shows = read(&format!("{under}{}", dots.replace("<circle", "<circle fill-opacity='.9'")));
    assert_eq!(shows.exemplar.elements.len(), 10);
    let clone = |k: u32| {
        let (x, y) = (k % 4 * 25, k / 4 * 25);
        format!("<use xlink:href='#o' inkscape:tiled-clone-of='#o' transform='translate({x} {y})' opacity='.7'/>")
    };
    let clones = read(&format!("<path id='o' d='M4 4h9v9z'/>{}", (0..16).map(clone).collect::<String>()));
    assert_eq!((counts(&clones), because(&clones, Reason::Original)), ((16, 0), 1));
}

#[test]
fn a_clip_like_the_frame_cuts_nothing() {
    let dots = at_places("<circle r='5'/>") + "<circle cx='100' cy='60' r='6'/>";
    let clip = |side: u32| {
        format!("<clipPath id='c'><rect width='{side}' height='{side}'/></clipPath><g clip-path='url(#c)'>{dots}</g>")
    };
    let whole = |d: &Drawing| d.exemplar.elements.iter().all(|e| e.role == Role::Source);
    assert!(whole(&read(&clip(100))) && !whole(&read(&clip(98))));
    assert_eq!(read(&clip(100)).exemplar.elements, read(&dots).exemplar.elements);
    let mask = "<mask id='m' maskUnits='userSpaceOnUse' x='0' y='0' width='100' height='100'>
        <path d='M0 0H100V100H0z' fill='#fff'/></mask>";
    let masked = read(&format!("{mask}<g mask='url(#m)'>{dots}</g>"));
    assert!(whole(&masked) && masked.warnings.is_empty());
    let each = "<circle clip-path='url(#c)' cx='20' cy='30' r='5'/><circle clip-path='url(#c)' cx='99' cy='70' r='5'/>";
    let each = read(&format!("<clipPath id='c'><rect width='100' height='100'/></clipPath>{each}"));
    assert!(whole(&each) && each.fragments.iter().all(|f| !f.markup.contains("clip")));
}

#[test]
fn strokes_that_end_on_the_frame_are_cut_by_it() {
    let bows = at_places("<path d='M-3 0q3-5 6 0'/>");
    let d = read(&stroked(&(bows + "<path d='M0 60q5 3 6 8'/><path d='M96 60q3 3 8 3'/>")));
    let cut = d.exemplar.elements.iter().filter(|e| e.role == Role::Context).count();
    assert_eq!((counts(&d), cut), ((11, 0), 1), "the other one reaches over it");
}

#[test]
fn bands_through_the_frame_are_strokes() {
    let stripe = |k: u32| format!("<rect x='{}' y='-5' width='9' height='110' fill='blue'/>", 20 * k);
    let stripes: String = (0..5).map(stripe).collect();
    let d = read(&stripes);
    assert_eq!((counts(&d), because(&d, Reason::Band)), ((0, 5), 5));
    let c = &d.exemplar.curves[1];
    assert_eq!(
        (c.width, c.path.start(), c.path.end()),
        (9.0, Some(Vector::xy(24.5, -5.0)), Some(Vector::xy(24.5, 105.0)))
    );
    let across = stripes.replace("rect", "rect transform='matrix(0 1 1 0 0 0)' fill-opacity='.5'");
    let gingham = read(&format!("{stripes}{across}"));
    assert_eq!((counts(&gingham), gingham.exemplar.styles.len()), ((0, 10), 2));
    let slanted = |k: i32| {
        let x = 22 * k - 100;
        format!("<path d='M{x} -10h8l120 120h-8z' fill='red'/>")
    };
    let d = read(&(0..9).map(slanted).collect::<String>());
    assert_eq!(d.exemplar.elements.len(), 0, "those that cut off a corner too");
}

#[test]
fn tiles_and_bars_are_no_bands() {
    let tile = |k: u32| {
        format!(
            "<rect x='{}' y='{}' width='20' height='20' fill='#{}'/>",
            k % 5 * 20,
            k / 5 * 20,
            ["222", "ddd"][k as usize % 2]
        )
    };
    assert_eq!(read(&(0..25).map(tile).collect::<String>()).exemplar.curves.len(), 0);
    let brick = |k: u32| {
        format!(
            "<rect x='{}' y='{}' width='28' height='9' fill='#a43'/>",
            (k % 4) as i32 * 30 - 15 * (k / 4 % 2) as i32,
            k / 4 * 10
        )
    };
    assert_eq!(read(&(0..40).map(brick).collect::<String>()).exemplar.curves.len(), 0);
    assert_eq!(read(&at_places("<rect x='-6' width='14' height='3'/>")).exemplar.curves.len(), 0);
}

#[test]
fn a_wave_of_one_width_is_a_stroke() {
    let top: String = "q10 -8 20 0t20 0".repeat(3);
    let back: String = "q-10 8 -20 0t-20 0".repeat(3);
    let wave = |k: u32| format!("<path d='M-10 {}{top}v5{back}z' fill='#08a'/>", 5 + 18 * k);
    let d = read(&(0..6).map(wave).collect::<String>());
    assert_eq!((counts(&d), because(&d, Reason::Traced)), ((0, 6), 6));
    let short = wave(2).replace("M-10", "M5").replace(&top, "q10 -8 20 0").replace(&back, "q-10 -8 -20 0");
    assert_eq!(counts(&read(&format!("{short}{}", at_places("<circle r='4'/>")))), (10, 0));
}

/// Groups of `each` in seven rows over the page, moved along by what `off` says.
fn in_rows(each: &str, off: impl Fn(usize) -> f64) -> String {
    (0..7).map(|k| format!("<g transform='translate({} {})'>{each}</g>", off(k), 15 * k)).collect()
}

/// Copies of one thing, `step` apart.
fn in_a_row(one: &str, count: usize, step: usize) -> String {
    (0..count).map(|k| format!("<g transform='translate({} 0)'>{one}</g>", k * step)).collect()
}

const BRICK: &str = "<rect width='18' height='13' fill='#a54'/>";
const FLOWER: &str = "<ellipse cx='6' cy='3' rx='3' ry='2' fill='#d35'/><ellipse cx='3' cy='6' rx='2' ry='3' fill='#d35'/>\
     <ellipse cx='9' cy='6' rx='2' ry='3' fill='#d35'/><circle cx='6' cy='6' r='2' fill='#fc0'/>";

#[test]
fn rows_that_were_saved_as_groups_are_things_each() {
    let wall = in_rows(&in_a_row(BRICK, 7, 20), |k| if k % 2 == 0 { -5.0 } else { -15.0 });
    let bricks = counts(&read(&wall));
    assert!(bricks.0 > 35 && bricks.1 == 0, "{bricks:?}");
    assert_eq!(counts(&read_with(&wall, Method::Elements).unwrap()), bricks);
    let course = format!("<defs><g id='course'>{}</g></defs>", in_a_row(BRICK, 7, 20));
    let uses: String =
        (0..7).map(|k| format!("<use href='#course' x='{}' y='{}'/>", -5 - k % 2 * 10, 15 * k)).collect();
    assert_eq!(counts(&read(&(course + &uses))), bricks);
    let two = format!("<g>{0}</g><g transform='translate(-10 15)'>{0}</g>", in_a_row(BRICK, 7, 20));
    let pairs: String = (0..4).map(|k| format!("<g transform='translate(-5 {})'>{two}</g>", 30 * k)).collect();
    assert_eq!(counts(&read(&pairs)), bricks, "courses in pairs");
    let flowers = counts(&read(&in_rows(&in_a_row(FLOWER, 5, 20), |_| 4.0)));
    assert_eq!(flowers, (35, 0), "a flower of petals in a row of flowers is one thing");
    let columns: String = in_rows(&in_a_row(BRICK, 7, 20), |_| -5.0);
    let turned = format!("<g transform='matrix(0 1 1 0 0 0)'>{columns}</g>");
    assert!(counts(&read(&turned)).0 > 35, "columns");
}

#[test]
fn rows_that_are_things_stay_whole() {
    let dashes = "<rect width='4' height='2' fill='#06c'/>";
    assert_eq!(counts(&read(&at_places(&in_a_row(dashes, 3, 5)))), (9, 0), "small against the frame");
    let rail = "<rect width='104' height='2' y='4' fill='#742'/>";
    let fence = format!("{rail}{}", in_a_row("<rect width='3' height='11' fill='#953'/>", 13, 8));
    assert_eq!(counts(&read_with(&in_rows(&fence, |_| -2.0), Method::Elements).unwrap()), (7, 0), "with a rail");
    let letters = ["M0 0h3v8h-3z", "M12 0h9v3h-6v5h-3z", "M34 0h9l-4 8z", "M56 0q9 4 0 8z", "M80 0c9 0 9 8 0 8l-4-4z"];
    let word: String = letters.iter().map(|d| format!("<path d='{d}' fill='#333'/>")).collect();
    assert_eq!(counts(&read(&in_rows(&word, |_| 6.0))), (7, 0), "a word");
    let alone = format!("<g transform='translate(5 40)'>{}</g>", in_a_row(BRICK, 5, 18));
    let one = counts(&read(&(alone + &at_places("<circle r='3' fill='#36a'/>"))));
    assert_eq!(one, (10, 0), "one of its kind, in the frame");
}

/// Rows of scallops down the page, each closed so far below its edge.
fn scallops(depth: i32, colours: &[&str]) -> String {
    let row = |k: i32| {
        let (x, y, colour) =
            (-43 - k.rem_euclid(2) * 10, 12 * k + 4, colours[k.rem_euclid(colours.len() as i32) as usize]);
        let edge = "q10 -12 20 0".repeat(9);
        format!("<path d='M{x} {y}{edge}v{depth}H{x}z' fill='{colour}' stroke='#135' stroke-width='1'/>")
    };
    (-2..11).map(row).collect()
}

#[test]
fn of_rows_that_lie_on_the_last_only_what_shows_is_drawn() {
    for colours in [&["#fff"][..], &["#8cf", "#48c"], &["#8cf", "#48c", "#fed"]] {
        for depth in [20, 30, 200] {
            let text = format!("<svg {NAMESPACES} width='100' height='100'>{}</svg>", scallops(depth, colours));
            let options =
                ReadOptions { large_fills: LargeFills::Areas, tiling: Tiling::Page, ..ReadOptions::new("t.svg") };
            let drawing = read_exemplar(&text, &options).unwrap();
            let curves = &drawing.exemplar.curves;
            let heights = curves.iter().map(|curve| curve.path.bounds().size()[1]);
            let flat = heights.filter(|height| *height < 0.5).count();
            assert_eq!(flat, 0, "lower edges {depth} below, in {} colours, of {} curves", colours.len(), curves.len());
            assert!((8..=15).contains(&curves.len()), "one edge of each row, the first in parts: {}", curves.len());
        }
    }
}

#[test]
fn fills_painted_like_those_at_the_frame_are_areas_where_that_is_asked() {
    let ring = |x: i32, r: i32| format!("M{x} {}h{r}v{r}h-{r}zm2 2v{}h{}v-{}z", 60 - r, r - 4, r - 4, r - 4);
    let lines = format!("M-5 70l60 9 50 -9v9l-60 8 -50 -8z{}{}", ring(20, 40), ring(30, 20));
    let body = format!(
        "<path fill='#234' d='{lines}'/><path fill='#234' d='M70 20h9v9z'/><path fill='#a11' d='M80 40h9v9z'/>\
         <path fill='#1a1' d='M5 5h9v9zM25 5h9v9z'/><path fill='#11a' d='M40 -5h9v9zM60 5h9v9z'/>"
    );
    let text = format!("<svg {NAMESPACES} width='100' height='100'>{body}</svg>");
    let of = |large_fills| {
        let options = ReadOptions { large_fills, tiling: Tiling::Page, ..ReadOptions::new("t.svg") };
        let drawing = read_exemplar(&text, &options).unwrap();
        (drawing.exemplar.areas.len(), drawing.exemplar.elements.len(), because(&drawing, Reason::AreaAlike))
    };
    assert_eq!(of(LargeFills::Areas), (1, 7, 0), "two rings, one in the other, are one thing");
    // Red, and green of which nothing reaches the frame, are things still.
    assert_eq!(of(LargeFills::AreasAlike), (5, 3, 4));
}
