//! Strokes on one geometry, and the layers of a drawing: read, written, and read back.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use arabesque_core::{Border, Bounds, Budget, Domain, Drawn, Outline, Placement, Similarity, Vector};
use arabesque_io::svg::{
    Drawing, Layer, Method, ReadOptions, Sheet, Style, read_exemplar, read_host_document, read_placed, write_svg,
};

fn read(body: &str) -> Drawing {
    read_exemplar(&file(body), &ReadOptions::new("l.svg")).unwrap()
}

fn file(body: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'>{body}</svg>")
}

fn line(data: &str, colour: &str, width: f64) -> String {
    format!("<path d='{data}' fill='none' stroke='{colour}' stroke-width='{width}'/>")
}

/// Widths of the paints of each curve.
fn widths(drawing: &Drawing) -> Vec<Vec<f64>> {
    drawing.strokes.iter().map(|paints| paints.iter().map(|p| p.width).collect()).collect()
}

fn strokes(style: usize, paint: usize) -> Layer {
    Layer::Strokes { style, paint }
}

const STREETS: [&str; 4] = ["M0 20H100", "M0 60H100", "M30 0V100", "M70 0V100"];

/// Streets with a casing and a core, layer by layer or street by street.
fn streets(by_layer: bool) -> String {
    let casings = STREETS.iter().map(|d| line(d, "#222222", 6.0));
    let cores = STREETS.iter().map(|d| line(d, "#eecc66", 4.0));
    match by_layer {
        true => casings.chain(cores).collect(),
        false => casings.zip(cores).map(|(casing, core)| casing + &core).collect(),
    }
}

#[test]
fn a_casing_and_its_core_are_one_stroke() {
    for by_layer in [true, false] {
        let d = read(&streets(by_layer));
        assert_eq!(widths(&d), vec![vec![6.0, 4.0]; 4]);
        assert_eq!(d.exemplar.curves[0].width, 6.0);
        // Street by street, the last two lie over the first two.
        let over = if by_layer { Vec::new() } else { vec![strokes(1, 0), strokes(1, 1)] };
        assert_eq!(d.layers, [vec![strokes(0, 0), strokes(0, 1)], over].concat());
        assert_eq!(d.exemplar.styles.len(), if by_layer { 1 } else { 2 });
    }
}

#[test]
fn nodes_direction_start_and_splits_do_not_matter() {
    let with = |core: &str| read(&[line("M10 50H90", "black", 6.0), core.to_owned()].concat());
    assert_eq!(widths(&with(&line("M90 50H40H10", "red", 2.0))), [[6.0, 2.0]], "another way, with more nodes");
    assert_eq!(widths(&with(&line("M10.004 50.003H90.002", "red", 2.0))), [[6.0, 2.0]], "rounded");
    assert_eq!(widths(&with(&line("M10 50H40M90 50H40", "red", 2.0))), [[6.0, 2.0], [6.0, 2.0]], "in two pieces");
    assert_eq!(widths(&with(&line("M10 50H60", "red", 2.0))), [vec![6.0, 2.0], vec![6.0]], "a part of it");
    assert_eq!(widths(&with(&line("M10 53H90", "red", 2.0))), [[6.0], [2.0]], "beside it");
    let third = [line("M90 50H10", "red", 4.0), line("M10 50H90", "white", 1.0)].concat();
    assert_eq!(widths(&with(&third)), [[6.0, 4.0, 1.0]]);
    let ring = |data: &str, colour: &str, width| line(data, colour, width);
    let rings =
        [ring("M10 10H90V90H10Z", "black", 6.0), ring("M90 90H10V10H90Z", "red", 2.0), line("M0 5H100", "blue", 1.0)];
    assert_eq!(widths(&read(&rings.concat())), [vec![6.0, 2.0], vec![1.0]]);
}

#[test]
fn lines_that_are_doubled_in_one_paint_are_dropped_and_told() {
    let body = [line("M10 50H90", "black", 6.0), line("M90 50H10", "black", 6.0), line("M10 50H90", "red", 2.0)];
    let d = read(&body.concat());
    assert_eq!(widths(&d), [[6.0, 2.0]]);
    assert!(d.warnings.iter().any(|w| w.message.contains("exactly on top of one like it")), "{:?}", d.warnings);
}

#[test]
fn a_filled_shape_with_the_same_stroke_stays_an_element() {
    let dot = "<circle cx='50' cy='20' r='5' fill='red' stroke='black' stroke-width='2'/>";
    let d = read(&[line("M10 50H90", "black", 2.0), dot.to_owned(), dot.replace("'50'", "'70'")].concat());
    assert_eq!((d.exemplar.elements.len(), widths(&d)), (2, vec![vec![2.0]]));
}

#[test]
fn hundreds_of_strokes_on_one_line_are_bounded_and_told() {
    let body: String = (0..200).map(|k| line("M0 50H100", &format!("#{k:02x}4488"), 400.0 - f64::from(k))).collect();
    let d = read(&body);
    assert_eq!(
        (d.strokes.len(), d.strokes[0].len(), d.strokes[0][0].width, d.strokes[0][31].width),
        (1, 32, 400.0, 201.0)
    );
    assert!(d.warnings.iter().any(|w| w.message.contains("under thirty others")), "{:?}", d.warnings);
}

#[test]
fn elements_lie_between_the_strokes_where_the_file_has_them() {
    let dots = |y: u32, colour: &str| -> String {
        (1..10).map(|k| format!("<circle cx='{}' cy='{y}' r='4' fill='{colour}'/>", 10 * k)).collect()
    };
    let wire = line("M0 20H100M0 60H100", "black", 2.0);
    let d = read(&[dots(20, "red"), wire.clone(), dots(60, "blue")].concat());
    assert!(
        matches!(d.layers.as_slice(), [Layer::Elements(a), Layer::Strokes { .. }, Layer::Elements(b)]
        if a.len() == 1 && b.len() == 1 && a != b),
        "{:?}",
        d.layers
    );
    // Where they do not meet, all elements are in one layer, as the first of them is.
    let d = read(&[dots(40, "red"), wire.clone(), dots(80, "blue")].concat());
    assert!(matches!(d.layers.as_slice(), [Layer::Elements(all), Layer::Strokes { .. }] if all.len() == 2));
    let d = read(&[wire, dots(20, "red"), dots(60, "blue")].concat());
    assert!(matches!(d.layers.as_slice(), [Layer::Strokes { .. }, Layer::Elements(_)]));
}

#[test]
fn strokes_that_weave_are_told() {
    let over = |k: u32| line(&format!("M0 {0}H100", 10 + 20 * k), "red", 4.0);
    let under = |k: u32| line(&format!("M{0} 0V100", 10 + 20 * k), "blue", 4.0);
    let woven: String = (0..5).map(|k| over(k) + &under(k)).collect();
    let told = |d: &Drawing| d.warnings.iter().any(|w| w.message.contains("over and under something in turn"));
    assert!(told(&read(&woven)));
    assert!(!told(&read(&(0..5).map(over).chain((0..5).map(under)).collect::<String>())));
    assert!(!told(&read(&streets(true))));
}

fn sheet<'a>(drawing: &'a Drawing, curves: &'a [Drawn<2>], domain: &'a Domain<2>, budget: &'a Budget) -> Sheet<'a> {
    Sheet {
        drawing,
        placements: &[],
        sequence: &[],
        areas: &[],
        curves,
        kept: None,
        host: None,
        page: drawing.page,
        domain,
        shape: None,
        border: Border::Clip,
        bend: None,
        style: Style::Linked,
        recipe: None,
        budget,
    }
}

fn itself(drawing: &Drawing) -> Vec<Drawn<2>> {
    let curves = drawing.exemplar.curves.iter().enumerate();
    curves.map(|(source, c)| Drawn { path: c.path.clone(), source, scale: 1.0, frozen: None }).collect()
}

fn page() -> Domain<2> {
    Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0)))
}

#[test]
fn casings_are_written_below_cores_and_read_back_as_the_same_strokes() {
    let drawing = read(&streets(true));
    let (curves, domain, budget) = (itself(&drawing), page(), Budget::default());
    let text = write_svg(&sheet(&drawing, &curves, &domain, &budget)).unwrap().text;
    let at = |part: &str| text.find(part).unwrap();
    assert!(
        at("stroke=\"#222222\"") < at("arabesque-curve-3\"") && at("arabesque-curve-3\"") < at("stroke=\"#eecc66\"")
    );
    assert_eq!(text.matches("<path").count(), 8);
    let kept = read_placed(&text, &drawing, &ReadOptions::new("out.svg")).unwrap();
    assert_eq!((&kept.curves, kept.obstacles.len()), (&curves, 0));
    assert_eq!(widths(&read_exemplar(&text, &ReadOptions::new("out.svg")).unwrap()), widths(&drawing));
    // What is kept lies in its layers, the new strokes of each on top of it.
    let kept_curves: Vec<Drawn<2>> = kept.curves.iter().map(|c| Drawn { frozen: Some(0), ..c.clone() }).collect();
    let all: Vec<Drawn<2>> = kept_curves.into_iter().chain(itself(&drawing).into_iter().take(1)).collect();
    let again = write_svg(&Sheet { kept: Some(&kept), ..sheet(&drawing, &all, &domain, &budget) }).unwrap().text;
    let places: Vec<usize> = again.match_indices("inkscape:label=\"Kept strokes\"").map(|m| m.0).collect();
    let new: Vec<usize> = again.match_indices("-curve-4").map(|m| m.0).collect();
    assert!(places.len() == 2 && new.len() == 2 && places[0] < new[0] && new[0] < places[1] && places[1] < new[1]);
}

#[test]
fn a_casing_alone_is_not_the_stroke() {
    let drawing = read(&streets(true));
    let text = file(
        &[line(STREETS[0], "#222222", 6.0), line(STREETS[1], "#222222", 6.0), line(STREETS[1], "#eecc66", 4.0)]
            .concat(),
    );
    let kept = read_placed(&text, &drawing, &ReadOptions::new("k.svg")).unwrap();
    assert_eq!((kept.curves.len(), kept.obstacles.len()), (1, 1));
}

#[test]
fn where_a_part_is_filled_again_both_paints_are_cut() {
    let text = file(&streets(true));
    let options = ReadOptions { method: Method::Auto, ..ReadOptions::new("r.svg") };
    let drawing = read_exemplar(&text, &options).unwrap();
    let corners = [(40.0, 40.0), (60.0, 40.0), (60.0, 80.0), (40.0, 80.0)].map(|(x, y)| Vector::xy(x, y));
    let host = read_host_document(&text, &drawing, &Outline { rings: vec![corners.to_vec()] }, &options).unwrap();
    assert_eq!((host.placed.curves.len(), host.placed.obstacles.len(), host.replaced), (5, 0, 2));
}

#[test]
fn elements_follow_their_layers_and_copies_their_sequence() {
    let dot = |x: u32, y: u32, colour: &str| format!("<circle cx='{x}' cy='{y}' r='4' fill='{colour}'/>");
    let body = [dot(20, 20, "red"), line("M0 20H100M0 60H100", "black", 2.0), dot(20, 60, "blue"), dot(60, 60, "blue")];
    let drawing = read(&body.concat());
    let domain = Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0)));
    let at = |source, y| Placement {
        source,
        transform: Similarity::shift(Vector::xy(0.0, y)),
        control: Vec::new(),
        frozen: None,
    };
    // The second blue dot reaches over the lower edge, and its copy lies below the first.
    let placements = [at(1, -50.0), at(2, 38.0), at(0, 0.0)];
    let instance = |placement, around| arabesque_core::Instance { placement, around };
    let sequence = [instance(1, [0, -1]), instance(0, [0, 0]), instance(1, [0, 0]), instance(2, [0, 0])];
    let (curves, budget) = (itself(&drawing), Budget::default());
    let sheet = Sheet { placements: &placements, sequence: &sequence, ..sheet(&drawing, &curves, &domain, &budget) };
    let text = write_svg(&sheet).unwrap().text;
    let place = |id: &str| text.find(&format!("id=\"arabesque-{id}\"")).unwrap();
    let order = [place("2"), place("style-0"), place("1-1"), place("0"), place("1")];
    assert!(order.is_sorted(), "{order:?} {text}");
}
