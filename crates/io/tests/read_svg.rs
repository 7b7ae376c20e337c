//! Traits of SVG files as artists save them, each in a tiny file of its own.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use arabesque_core::{Budget, Error, Limits, Region, Role, Vector};
use arabesque_io::svg::{Drawing, Layer, Method, ReadOptions, Unit, read_exemplar, read_flow, read_placed, read_shape};

const NAMESPACES: &str = "xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' \
     xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape'";

const DOTS: &str = "<circle cx='20' cy='20' r='5'/><circle cx='50' cy='20' r='5'/><circle cx='80' cy='20' r='5'/>
    <circle cx='20' cy='60' r='5'/><circle cx='50' cy='60' r='5'/><circle cx='80' cy='60' r='5'/>";

fn page(body: &str) -> String {
    format!("<svg {NAMESPACES} width='100' height='100' viewBox='0 0 100 100'>{body}</svg>")
}

fn read_with(text: &str, method: Method) -> Result<Drawing, Error> {
    read_exemplar(text, &ReadOptions { method, ..ReadOptions::new("t.svg") })
}

fn read(body: &str) -> Drawing {
    let drawing = read_with(&page(body), Method::Auto).unwrap();
    assert_self_contained(&drawing);
    drawing
}

/// The fragments with the definitions are a well-formed file, and every reference in it leads somewhere.
fn assert_self_contained(drawing: &Drawing) {
    let body: String = drawing.fragments.iter().map(|f| f.markup.as_str()).collect();
    let text = format!("<svg {NAMESPACES}><defs>{}</defs>{body}</svg>", drawing.definitions);
    let document = roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    let ids: Vec<_> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    for value in document.descendants().flat_map(|n| n.attributes().map(|a| a.value())) {
        if let Some(id) = value.strip_prefix("url(#") {
            assert!(ids.contains(&id.trim_end_matches(')')), "{value} in {text}");
        }
    }
}

fn error(text: &str) -> String {
    read_with(text, Method::Auto).unwrap_err().to_string()
}

fn class_sizes(drawing: &Drawing) -> Vec<usize> {
    let e = &drawing.exemplar;
    (0..e.classes.len()).map(|k| e.elements.iter().filter(|x| x.class == k).count()).collect()
}

fn roles(drawing: &Drawing) -> Vec<Role> {
    drawing.exemplar.elements.iter().map(|e| e.role).collect()
}

fn warns(drawing: &Drawing, part: &str) -> bool {
    drawing.warnings.iter().any(|w| w.message.contains(part))
}

#[test]
fn inkscape_layers_are_containers_and_name_the_fragments() {
    let d = read(&format!("<g inkscape:groupmode='layer' inkscape:label='Berries' id='layer1'>{DOTS}</g>"));
    assert_eq!(d.exemplar.elements.len(), 6);
    assert!(d.fragments.iter().all(|f| f.layer.as_deref() == Some("Berries")));
}

#[test]
fn a_page_wide_group_is_opened_and_a_compact_group_is_one_element() {
    let cherry = "<g><circle cx='10' cy='20' r='4' fill='red'/><circle cx='20' cy='22' r='4' fill='red'/>
        <path d='M10 16 Q14 8 16 6 M20 18 L16 6' fill='none' stroke='green'/></g>";
    let (right, below) = ("<g transform='translate(60 0)'>", "<g transform='translate(30 60)'>");
    let d = read(&format!("<g>{cherry}{right}{cherry}</g>{below}{cherry}</g></g>"));
    assert_eq!(class_sizes(&d), [3]);
}

#[test]
fn transforms_nest_and_reach_the_outline() {
    let d = read(
        "<g transform='translate(10 10)'><rect transform='rotate(45) scale(2)' width='10' height='10'/></g>
        <circle cx='80' cy='80' r='4'/>",
    );
    let e = &d.exemplar.elements[0];
    assert!((e.centre - Vector::xy(10.0, 10.0 + 200.0_f64.sqrt())).norm() < 1e-6, "{:?}", e.centre);
    assert!((e.outline.area() - 400.0).abs() < 1e-3);
}

#[test]
fn copies_by_use_are_a_class_with_their_poses() {
    let d = read(
        "<defs><path id='leaf' d='M0 0 Q10 -6 20 0 Q12 4 0 0z'/></defs>
        <use href='#leaf' x='10' y='20'/><use xlink:href='#leaf' transform='translate(50 50) rotate(90)'/>
        <use href='#leaf' transform='translate(20 80) scale(1.5)'/>",
    );
    assert_eq!(class_sizes(&d), [3]);
    assert_eq!(d.exemplar.classes[0].name, "leaf");
    let pose = d.exemplar.elements[1].pose;
    assert!((pose.rotation.angle().to_degrees() - 90.0).abs() < 2.0, "{pose:?}");
    assert!((d.exemplar.elements[2].pose.scale - 1.5).abs() < 0.01);
}

#[test]
fn symbols_are_fitted_and_cut_to_their_box() {
    let d = read(
        "<symbol id='s' viewBox='0 0 10 10'><rect width='20' height='10'/></symbol>
        <use href='#s' x='10' y='10' width='20' height='20'/><use href='#s' x='50' y='50' width='20' height='20'/>",
    );
    assert_eq!(d.exemplar.elements.len(), 2);
    assert!((d.exemplar.elements[0].outline.area() - 400.0).abs() < 1e-3);
    assert!(d.definitions.contains("<clipPath"));
}

#[test]
fn style_sheets_are_resolved_into_the_fragments() {
    let d = read(
        "<style type='text/css'><![CDATA[ .st0{fill:#00ff00;stroke:none} #warm circle{fill:#ff0000} ]]></style>
        <rect class='st0' x='10' y='10' width='9' height='9'/><rect class='st0' x='70' y='60' width='9' height='9'/>
        <g id='warm' style='stroke:blue;stroke-width:2'><circle cx='50' cy='50' r='5'/></g>",
    );
    assert!(d.fragments[0].markup.contains("fill=\"#00ff00\""), "{}", d.fragments[0].markup);
    assert!(d.fragments[2].markup.contains("fill=\"#ff0000\"") && d.fragments[2].markup.contains("stroke-width=\"2\""));
    assert_eq!(d.exemplar.elements[0].colour, [0.0, 1.0, 0.0]);
    // A class that only carries style does not name what it styles.
    assert_eq!(d.exemplar.classes[0].name, "class 1");
}

#[test]
fn gradients_and_clips_come_along_under_new_ids() {
    let d = read(
        "<defs><linearGradient id='base'><stop offset='0' stop-color='red'/><stop offset='1' stop-color='#0000ff'/>
          </linearGradient>
          <radialGradient id='r' xlink:href='#base' gradientUnits='userSpaceOnUse' cx='50%' cy='20' r='9'/>
          <clipPath id='half'><rect width='30' height='100'/></clipPath></defs>
        <circle cx='30' cy='30' r='9' fill='url(#r)' clip-path='url(#half)'/>
        <rect x='70' y='70' width='9' height='9' fill='url(#base)'/>",
    );
    assert!((d.exemplar.elements[0].outline.area() - 127.0).abs() < 2.0);
    assert_eq!(d.exemplar.elements[1].colour, [0.5, 0.0, 0.5]);
    let parts =
        ["<radialGradient id=\"exemplar-r\"", "cx=\"50\"", "stop-color=\"#0000ff\"", "<clipPath id=\"exemplar-half\""];
    for part in parts {
        assert!(d.definitions.contains(part), "{part} in {}", d.definitions);
    }
    assert!(d.fragments[0].markup.contains("fill=\"url(#exemplar-r)\""));
}

#[test]
fn patterns_masks_and_filters_come_along_with_what_they_refer_to() {
    let d = read(
        "<defs><circle id='spot' r='1' fill='red'/><pattern id='p' width='10%' height='4' patternUnits='userSpaceOnUse'>
          <use href='#spot' x='2' y='2'/></pattern><pattern id='q' xlink:href='#p' patternTransform='rotate(9)'/>
          <mask id='m'><rect width='50' height='50' style='fill:white'/></mask>
          <filter id='f'><feGaussianBlur stdDeviation='1'/></filter></defs>
        <g mask='url(#m)' filter='url(#f)'><rect x='10' y='10' width='20' height='20' fill='url(#q)'/></g>
        <rect x='70' y='70' width='20' height='20' fill='url(#gone) lime'/>",
    );
    for part in
        ["id=\"exemplar-q\" ", "width=\"10\"", "rotate(9)", "id=\"exemplar-spot\"", "<feGaussianBlur stdDeviation"]
    {
        assert!(d.definitions.contains(part), "{part} in {}", d.definitions);
    }
    assert!(d.fragments[0].markup.contains("mask=\"url(#exemplar-m)\""));
    assert!(d.fragments[1].markup.contains("fill=\"#00ff00\""), "{}", d.fragments[1].markup);
    assert!(warns(&d, "does not exist"));
}

#[test]
fn what_a_transform_presses_onto_a_line_is_not_drawn() {
    let d = read(&format!("{DOTS}<rect width='9' height='9' stroke='red' transform='matrix(0 0 6 -1 0 90)'/>"));
    assert_eq!(d.exemplar.elements.len(), 6);
}

#[test]
fn physical_units_are_kept() {
    let body = "<rect x='1' y='1' width='150' height='9'/><rect width='9' height='250' x='100' y='20'/>";
    let text = format!("<svg {NAMESPACES} width='210mm' height='297mm' viewBox='0 0 210 297'>{body}</svg>");
    let d = read_with(&text, Method::Auto).unwrap();
    assert_eq!((d.page.unit, d.page.view.max), (Unit::Mm, Vector::xy(210.0, 297.0)));
    assert!((d.page.unit_per_user - 1.0).abs() < 1e-12);
    let old = format!("<svg {NAMESPACES} inkscape:version='0.48.4 r9939' width='100' height='100'>{DOTS}</svg>");
    assert!(warns(&read_with(&old, Method::Auto).unwrap(), "0.92"));
}

#[test]
fn compound_paths_fall_into_pieces_with_their_holes() {
    let ring = |x: u32, y: u32| format!("M{x} {y}h20v20h-20z M{} {}v10h10v-10z", x + 5, y + 5);
    let data = format!("{}{}{}M50 90h4v4h-4z", ring(10, 10), ring(60, 10), ring(10, 60));
    let d = read(&format!("<path fill='#123456' d='{data}'/>"));
    assert_eq!(class_sizes(&d), [3, 1]);
    assert!((d.exemplar.elements[0].outline.area() - 300.0).abs() < 1e-3);
    assert_eq!(d.fragments[0].markup.matches('M').count(), 2);
}

#[test]
fn a_paw_print_stays_together_however_many_pieces_it_has() {
    let toes = "m0 -4h2v3h-2z m3 0h2v3h-2z m3 0h2v3h-2z";
    let paw = |x: u32, y: u32| format!("<path d='M{x} {y}h8v6h-8z {toes}'/>");
    let d = read(&(paw(10, 20) + &paw(50, 30) + &paw(20, 80) + &paw(80, 70)));
    assert_eq!(class_sizes(&d), [4]);
}

#[test]
fn pieces_cut_by_a_tile_are_joined_again() {
    let tile = "<path fill='navy' d='M0 10h10v10h-10z M40 10h10v10h-10z M20 30h8v8h-8z'/>";
    let d = read(&format!("<g>{tile}</g><g transform='translate(50 0)'>{tile}</g><circle cx='50' cy='90' r='5'/>"));
    let whole = d.exemplar.elements.iter().filter(|e| e.role == Role::Source);
    let areas: Vec<_> = whole.map(|e| e.outline.area().round()).collect();
    assert!(areas.contains(&200.0) && !areas.contains(&100.0), "{areas:?}");
}

#[test]
fn open_strokes_are_curves() {
    let stem = "<path class='stem' d='M34 12 C34 30 36 50 34 95' fill='none' stroke='green'/>";
    let body = format!("{DOTS}{stem}<line x1='2' x2='90' y1='5' y2='7' stroke='red'/>");
    let d = read(&body);
    assert_eq!((d.exemplar.elements.len(), d.exemplar.curves.len(), d.strokes.len()), (6, 2, 2));
    assert_eq!(d.exemplar.styles.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["stem", "style 2"]);
    assert_eq!(
        d.exemplar.curves[0].path.cubics,
        [[(34., 12.), (34., 30.), (36., 50.), (34., 95.)].map(|(x, y)| Vector::xy(x, y))]
    );
    assert!(matches!(d.layers.as_slice(), [Layer::Elements(_), Layer::Strokes { .. }, ..]));
    assert_eq!(read_with(&page(&body), Method::Elements).unwrap().exemplar.elements.len(), 8);
}

#[test]
fn curves_need_no_element() {
    let d = read("<path d='M0 50H100M50 0V100' fill='none' stroke='red' stroke-width='2'/>");
    assert_eq!((d.exemplar.elements.len(), d.exemplar.curves.len()), (0, 2));
    assert_eq!((d.exemplar.curves[0].width, d.exemplar.curves[0].colour), (2.0, [1.0, 0.0, 0.0]));
}

#[test]
fn transforms_go_into_the_line_and_its_lengths() {
    let d = read(
        "<g transform='translate(10 0) scale(2)' opacity='.5'><path d='M0 10h30q5 0 5 5' fill='none' stroke='#00f' \
         stroke-width='1.5' stroke-dasharray='3 1' stroke-dashoffset='1' stroke-linecap='round'/></g>",
    );
    let path = &d.exemplar.curves[0].path;
    assert_eq!((path.start(), path.end()), (Some(Vector::xy(10.0, 20.0)), Some(Vector::xy(80.0, 30.0))));
    let stroke = &d.strokes[0][0];
    assert_eq!((stroke.width, stroke.dashes.as_slice(), stroke.dash_offset), (3.0, &[6.0, 2.0][..], 2.0));
    assert_eq!(stroke.paint, " fill=\"none\" stroke=\"#0000ff\" stroke-linecap=\"round\"");
    assert_eq!(stroke.effects, " opacity=\"0.5\"");
}

#[test]
fn uneven_transforms_take_the_mean_width_and_say_so() {
    let d = read("<path transform='scale(1 4)' d='M0 1H90' fill='none' stroke='red' stroke-width='2'/>");
    assert_eq!(d.exemplar.curves[0].width, 4.0);
    assert!(warns(&d, "stretched more one way"));
}

#[test]
fn closed_strokes_beside_open_ones_are_curves_too() {
    let ring = "<circle cx='50' cy='80' r='9' fill='none' stroke='red'/>";
    let pair = "<g stroke='blue'><path d='M60 60l9 9'/><path d='M69 60l-9 9'/></g>";
    let alone = read(&format!("{DOTS}{ring}{pair}"));
    assert_eq!((alone.exemplar.elements.len(), alone.exemplar.curves.len()), (8, 0));
    let beside = read(&format!("{DOTS}{ring}{pair}<path d='M0 90H100' stroke='red'/>"));
    assert_eq!((beside.exemplar.elements.len(), beside.exemplar.curves.len()), (7, 2));
    assert!(beside.exemplar.curves[0].path.closed);
    let all = read_with(&page(&format!("{DOTS}{ring}{pair}")), Method::Curves).unwrap();
    assert_eq!((all.exemplar.elements.len(), all.exemplar.curves.len()), (6, 3));
}

#[test]
fn degenerate_strokes_are_left_out_with_a_warning() {
    let net = "<path id='p' d='M0 50H100' fill='none' stroke='red'/>";
    let dot = "<path d='M5 5h0' fill='none' stroke='red'/>";
    let d = read(&format!(
        "{net}{dot}<path d='M100 50H0' fill='none' stroke='red'/><path d='M10 10L10 10L60 10L60 10' fill='none' \
         stroke='red'/>"
    ));
    assert_eq!(d.exemplar.curves.iter().map(|c| c.path.cubics.len()).collect::<Vec<_>>(), [1, 1]);
    assert!(warns(&d, "stroke without length") && warns(&d, "on top of one like it"));
}

#[test]
fn strokes_are_cut_by_the_clips_around_them() {
    let clip = "<clipPath id='c'><rect width='100' height='40'/></clipPath>";
    let d = read(&format!(
        "{clip}<g inkscape:groupmode='layer' clip-path='url(#c)'><path d='M10 10V90' stroke='red'/><path d='M0 \
         20H100' stroke='red'/></g>"
    ));
    let ends: Vec<_> = d.exemplar.curves.iter().map(|c| c.path.end().unwrap()).collect();
    assert_eq!(ends, [Vector::xy(10.0, 40.0), Vector::xy(100.0, 20.0)]);
}

/// A filled outline of a net over the whole frame, with holes of the given sides in turn.
fn outline_of_a_net(sides: [u32; 2]) -> String {
    let mut net = "M0 0H100V100H0Z".to_owned();
    for k in 0..16 {
        let (x, y, side) = (4 + 24 * (k % 4), 4 + 24 * (k / 4), sides[(k % 2) as usize]);
        net += &format!("M{x} {y}v{side}h{side}v-{side}z");
    }
    page(&format!("<path id='net' fill='#123' fill-rule='evenodd' d='{net}M105 105h1v1h-1z'/>"))
}

#[test]
fn outlines_of_lines_of_one_width_are_taken_for_strokes() {
    let d = read_with(&outline_of_a_net([20, 20]), Method::Auto).unwrap();
    assert!(d.exemplar.curves.len() >= 6 && d.exemplar.elements.is_empty());
    assert!(d.exemplar.curves.iter().all(|c| (c.width - 4.0).abs() < 0.1));
    assert!(d.strokes[0][0].paint.contains("stroke=\"#112233\"") && d.strokes[0][0].paint.contains("fill=\"none\""));
    assert!(warns(&d, "taken for strokes"));
}

/// Copies of a tile of 20 by 20 side by side over the whole frame.
fn tiled(data: &str) -> String {
    let tile = |k: u32| {
        let (x, y) = (20 * (k % 5), 20 * (k / 5));
        format!("<g transform='translate({x} {y})'><path d='{data}' fill='#123' fill-rule='evenodd'/></g>")
    };
    page(&(0..25).map(tile).collect::<String>())
}

#[test]
fn lines_that_tiles_cut_at_their_seams_are_whole_again() {
    // Half of a line of width 2 along the border of each tile.
    let d = read_with(&tiled("M0 0H20V20H0ZM1 1V19H19V1Z"), Method::Auto).unwrap();
    assert!(d.exemplar.elements.is_empty() && d.exemplar.curves.len() >= 8, "{}", d.exemplar.curves.len());
    let inner =
        d.exemplar.curves.iter().filter(|c| c.path.bounds().centre().0.iter().all(|v| (10.0..90.0).contains(v)));
    assert!(inner.clone().count() >= 8 && inner.clone().all(|c| (c.width - 2.0).abs() < 0.1));
    let each = read_with(&tiled("M0 0H20V20H0ZM1 1V19H19V1Z"), Method::Elements).unwrap();
    assert!(each.exemplar.curves.is_empty());
}

#[test]
fn a_net_and_what_lies_in_its_meshes_are_told_apart() {
    // The net along the borders of the tiles, and in each mesh a frame with a dot in it.
    let motif = "M6 6H14V14H6ZM8 8V12H12V8ZM9 9H11V11H9Z";
    let d = read_with(&tiled(&format!("M0 0H20V20H0ZM1 1V19H19V1Z{motif}")), Method::Auto).unwrap();
    assert!(d.exemplar.curves.len() >= 8 && d.exemplar.curves.iter().all(|c| (c.width - 2.0).abs() < 0.1));
    assert_eq!(class_sizes(&d), [25]);
    assert!((d.exemplar.elements[0].outline.area() - 52.0).abs() < 0.1);
}

#[test]
fn outlines_that_tiles_cut_at_their_seams_are_whole_elements() {
    // Frames in the middle of the upper and the lower side of each tile, half of them in either.
    let d = read_with(&tiled("M4 0V6H16V0H15V5H5V0ZM4 20V14H16V20H15V15H5V20Z"), Method::Auto).unwrap();
    let whole: Vec<_> = d.exemplar.elements.iter().filter(|e| e.role == Role::Source).collect();
    assert_eq!((whole.len(), d.exemplar.elements.len()), (20, 30));
    assert!(whole.iter().all(|e| (e.outline.area() - 44.0).abs() < 0.1));
}

#[test]
fn tiles_that_are_no_lines_together_stay_elements() {
    // Filled squares side by side, and squares that only touch at corners.
    for (data, count) in [("M0 0H20V20H0Z", 25), ("M0 0H10V10H0ZM10 10H20V20H10Z", 25)] {
        let d = read_with(&tiled(data), Method::Auto).unwrap();
        assert!(d.exemplar.curves.is_empty());
        assert_eq!(d.exemplar.elements.len(), count, "{data}");
    }
}

#[test]
fn outlines_of_other_networks_are_refused_by_name() {
    let message = error(&outline_of_a_net([21, 9]));
    assert!(message.contains("1 outline that reaches several sides of the frame (\"net\")"), "{message}");
    assert!(message.contains("--method elements"), "{message}");
}

#[test]
fn touching_strokes_are_one_element_when_asked_for() {
    let cross = |x: u32| format!("<path d='M{x} 20h20' stroke='red'/><path d='M{} 10v20' stroke='red'/>", x + 10);
    let d = read_with(&page(&(cross(10) + &cross(60))), Method::Elements).unwrap();
    assert_eq!(class_sizes(&d), [2]);
    assert!((d.exemplar.elements[0].outline.area() - 39.0).abs() < 0.1);
}

#[test]
fn closed_strokes_and_groups_of_strokes_are_elements() {
    let d = read(
        "<circle cx='20' cy='20' r='6' fill='none' stroke='red'/>
        <g stroke='blue'><path d='M60 60l9 9'/><path d='M69 60l-9 9'/></g>",
    );
    assert_eq!(d.exemplar.elements.len(), 2);
}

#[test]
fn overrides_beat_the_rules() {
    let marked = |mark: &str| format!("<rect id='r' data-arabesque='{mark}' width='9' height='9' y='80'/>");
    let stroke = "<path data-arabesque='element' d='M10 40h20' stroke='red'/>";
    assert_eq!(read(&format!("{DOTS}{stroke}{}", marked("ignore"))).exemplar.elements.len(), 7);
    assert!(
        error(&page(&format!("{DOTS}{}", marked("curve"))))
            .contains("marked as a curve but not the outline of lines of one width")
    );
    let outlined = format!("{DOTS}{}", marked("curve").replace("width=", "stroke='red' width="));
    assert_eq!(read(&outlined).exemplar.curves.len(), 1);
    assert!(warns(&read(&format!("{DOTS}{}", marked("thing"))), "unknown data-arabesque"));
}

#[test]
fn backgrounds_are_kept_apart() {
    let paper = "<rect width='100%' height='100%' fill='#ffe'/>";
    let border = "<rect x='1' y='1' width='98' height='98' fill='none' stroke='red'/>";
    let d = read(&format!("{paper}{border}{DOTS}"));
    assert_eq!(d.exemplar.elements.len(), 6);
    assert!(d.background.as_deref().unwrap().contains("#ffffee"));
    assert!(warns(&d, "stroke along the frame"));
}

#[test]
fn what_the_file_cuts_at_the_frame_is_context_and_what_reaches_over_is_not() {
    let d = read(&format!("{DOTS}<path d='M0 80a8 8 0 0 1 0 16z' fill='red'/><circle cx='100' cy='90' r='8'/>"));
    assert_eq!(roles(&d)[6..], [Role::Context, Role::Source]);
    let clipped = read(
        "<clipPath id='c'><rect width='95' height='100'/></clipPath><g inkscape:groupmode='layer' clip-path='url(#c)'>
        <circle cx='50' cy='50' r='8'/><circle cx='95' cy='10' r='8'/><circle cx='10' cy='90' r='8'/></g>",
    );
    assert_eq!(roles(&clipped), [Role::Source, Role::Context, Role::Source]);
    assert_eq!(clipped.exemplar.classes.len(), 1);
}

#[test]
fn classes_by_name() {
    let named = read(
        "<g class='leaf'><rect width='9' height='9'/></g><g class='leaf'><circle cx='50' cy='50' r='5'/></g>
        <circle cx='80' cy='80' r='5'/>",
    );
    let names: Vec<_> = named.exemplar.classes.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["leaf", "class 2"]);
    let labelled = read(
        "<rect inkscape:label='Dot 1' width='9' height='9'/>
        <circle inkscape:label='dot copy 2' cx='80' cy='80' r='5'/>",
    );
    assert_eq!(labelled.exemplar.classes[0].name, "dot");
}

#[test]
fn classes_by_paint_and_outline() {
    let red = DOTS.replace("<circle", "<circle transform='translate(0 18)' fill='red'");
    assert_eq!(class_sizes(&read(&format!("{DOTS}{red}"))), [6, 6]);
    let squares =
        DOTS.replace("<circle c", "<rect width='9' height='9' transform='translate(0 14)' ").replace("cy=", "y=");
    assert_eq!(class_sizes(&read(&format!("{DOTS}{squares}"))), [6, 6]);
}

#[test]
fn hand_cut_chips_of_one_colour_are_one_class() {
    let chip = |k: u32| {
        let (x, y) = (k % 4 * 25 + 12, k / 4 * 25 + 12);
        let corner = |j: u32| {
            let (turn, radius) = (f64::from(j) * 1.2566 + f64::from(k), 5.0 + f64::from((k * 7 + j * 13) % 5));
            format!("{:.2},{:.2} ", f64::from(x) + radius * turn.cos(), f64::from(y) + radius * turn.sin())
        };
        format!("<polygon fill='#c96f4a' points='{}'/>", (0..5).map(corner).collect::<String>())
    };
    let d = read(&(0..16).map(chip).collect::<String>());
    assert_eq!(class_sizes(&d), [16]);
}

#[test]
fn one_file_can_be_a_whole_job() {
    let layer = |name: &str, body: &str| format!("<g inkscape:groupmode='layer' inkscape:label='{name}'>{body}</g>");
    let frame = "<rect id='frame' width='30' height='30' fill='none' stroke='red'/>";
    let body = layer("EXEMPLAR", &format!("<g transform='scale(.3)'>{DOTS}</g>{frame}"))
        + &layer("Domain", "<path fill='none' stroke='red' d='M0 40h90v50h-90z M10 50h20v20h-20z'/>")
        + &layer("avoid", "<circle cx='60' cy='60' r='10'/>")
        + &layer("Flow", "<path d='M0 40L90 90' fill='none' stroke='red'/>");
    let d = read(&body);
    assert_eq!(d.exemplar.elements.len(), 6);
    assert_eq!(d.exemplar.window.max, Vector::xy(30.0, 30.0));
    assert!((d.job.domain.unwrap().measure() - 4100.0).abs() < 1e-3);
    assert!((d.job.avoid.unwrap().measure() - 314.0).abs() < 3.0);
    assert_eq!(d.job.flow, [vec![Vector::xy(0.0, 40.0), Vector::xy(90.0, 90.0)]]);
}

#[test]
fn a_drawing_in_a_corner_of_its_page_has_its_own_frame() {
    let d = read(&format!("<g transform='scale(.3)'>{DOTS}</g>"));
    assert!(warns(&d, "only a part of the page"));
    assert!(d.exemplar.window.max[0] < 45.0);
}

#[test]
fn hidden_and_empty_things_are_ignored() {
    let d = read(&format!(
        "{DOTS}<g style='display:none'><circle r='9'/></g><rect visibility='hidden' width='9' height='9'/>
        <path d='M5 5h0' stroke='red'/><rect width='9' height='9' fill='none'/>"
    ));
    assert_eq!(d.exemplar.elements.len(), 6);
    assert!(warns(&d, "stroke without length"));
}

#[test]
fn text_and_outside_references_are_reported_not_fetched() {
    let d = read(&format!(
        "<style>@import url('http://x/y.css');</style>{DOTS}<text>Hello</text>
        <image href='file:///etc/passwd' width='9' height='9'/><use href='other.svg#a'/>
        <rect x='5' y='80' width='9' height='9' fill='url(http://x/y.svg)'/>"
    ));
    assert!(warns(&d, "text ignored"));
    let outside = d.warnings.iter().find(|w| w.message.contains("not fetched")).unwrap();
    for part in ["@import", "/etc/passwd", "other.svg"] {
        assert!(outside.message.contains(part), "{}", outside.message);
    }
}

#[test]
fn shapes_have_holes_and_may_be_chosen_by_id() {
    let options = ReadOptions::new("d.svg");
    let square = "M10 10h60v60h-60z M20 20h10v10h-10z";
    let body = format!(
        "<rect width='100' height='100' fill='white'/><path id='a' fill-rule='evenodd' d='{square}'/>
        <rect id='b' x='80' y='80' width='10' height='10'/>"
    );
    let area = |id| read_shape(&page(&body), id, &options).map(|(shape, _)| shape.measure());
    assert!((area(None).unwrap() - 3600.0).abs() < 1e-3);
    assert!((area(Some("b")).unwrap() - 100.0).abs() < 1e-3);
    let missing = area(Some("heart")).unwrap_err().to_string();
    assert!(missing.contains("id \"heart\"") && missing.contains("a, b"), "{missing}");
    let slip = area(Some("c")).unwrap_err().to_string();
    assert!(slip.contains("did you mean \"a\"?"), "{slip}");
    let open = page("<path id='o' d='M0 0h9v9' fill='none' stroke='red'/>");
    assert!(read_shape(&open, None, &options).unwrap_err().to_string().contains("open (o)"));
    let flat = page("<path id='o' d='M0 0h9z'/>");
    assert!(read_shape(&flat, None, &options).unwrap_err().to_string().contains("no shape with an area"));
}

#[test]
fn flow_strokes_keep_their_direction() {
    let text = page("<path d='M9 0L0 0' fill='none' stroke='red'/><polyline points='0,9 9,9'/>");
    let strokes = read_flow(&text, &ReadOptions::new("f.svg")).unwrap();
    assert_eq!(strokes, [vec![Vector::xy(9.0, 0.0), Vector::ZERO], vec![Vector::xy(0.0, 9.0), Vector::xy(9.0, 9.0)]]);
    assert!(read_flow(&page(""), &ReadOptions::new("f.svg")).is_err());
}

#[test]
fn kept_elements_are_matched_back() {
    let exemplar =
        read("<rect x='5' y='5' width='20' height='8' fill='red'/><circle cx='70' cy='70' r='6' fill='blue'/>");
    let kept = page(
        "<defs><g id='e0'><rect x='5' y='5' width='20' height='8' fill='red'/></g></defs>
        <use href='#e0' data-arabesque-source='0' transform='translate(30 40) rotate(30)'/>
        <circle cx='20' cy='80' r='6' fill='blue'/><path d='M60 10 l30 5 l-20 20 l8 -18z' fill='lime'/>",
    );
    let placed = read_placed(&kept, &exemplar, &ReadOptions::new("k.svg")).unwrap();
    assert_eq!(placed.placements.iter().map(|p| p.source).collect::<Vec<_>>(), [0, 1]);
    assert!((placed.placements[0].transform.rotation.angle().to_degrees() - 30.0).abs() < 1e-9);
    let centre = placed.placements[1].transform.apply(Vector::xy(70.0, 70.0));
    assert!((centre - Vector::xy(20.0, 80.0)).norm() < 0.01, "{centre:?}");
    assert_eq!((placed.obstacles.len(), placed.fragments.len(), placed.obstacle_fragments.len()), (1, 2, 1));
}

#[test]
fn bad_input_says_what_and_where() {
    let cases = [
        ("", "nothing in it"),
        ("hello", "t.svg:1:1: not well-formed"),
        ("<html/>", "expected <svg>"),
        ("<svg xmlns='http://www.w3.org/2000/svg'><g>", "not well-formed"),
        ("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>", "no element and no curve found"),
    ];
    for (text, part) in cases {
        let message = error(text);
        assert!(message.starts_with("t.svg") && message.contains(part), "{message}");
    }
    let cut =
        page("<path d='M0 80a8 8 0 0 1 0 16z'/><path d='M0 20a8 8 0 0 1 0 16z'/><path d='M100 50a8 8 0 0 0 0 16z'/>");
    assert!(error(&cut).contains("cut by the frame"));
}

#[test]
fn absurd_numbers_are_errors_with_a_place() {
    for number in ["1e300", "-1e300", "1e12", "nan", "inf"] {
        let message = error(&page(&format!("{DOTS}<path id='x' d='M0 0L{number} 5L5 5z'/>")));
        assert!(message.contains("<path id=\"x\">"), "{message}");
    }
    let blown = "<g transform='scale(1e200)'><path id='x' d='M0 0L1e200 5L5 5z'/></g>";
    assert!(error(&page(&format!("{DOTS}{blown}"))).contains("<path id=\"x\">"));
    let tiny = format!("<svg {NAMESPACES} viewBox='0 0 1e-300 1e-300'>{DOTS}</svg>");
    assert!(error(&tiny).contains("no area"));
}

#[test]
fn limits_are_errors_that_name_themselves() {
    let deep = page(&format!("{}{}", "<g>".repeat(10_000), "</g>".repeat(10_000)));
    assert!(matches!(read_with(&deep, Method::Auto), Err(Error::Limit { .. })));
    let mut options = ReadOptions::new("t.svg");
    options.budget = Budget::new(Limits { elements: 5, ..Limits::default() });
    let message = read_exemplar(&page(DOTS), &options).unwrap_err().to_string();
    assert!(message.contains("elements: 6 is over the limit of 5"), "{message}");
    options.budget = Budget::new(Limits { segments: 10, ..Limits::default() });
    assert!(read_exemplar(&page(DOTS), &options).unwrap_err().to_string().contains("path segments"));
}

const WEB: &str = "<path d='M0 20H100M0 60H100' fill='none' stroke='#123' stroke-width='2' stroke-dasharray='3 1'/>
    <path d='M30 0V100' fill='none' stroke='red'/>";

#[test]
fn kept_strokes_are_known_by_their_paint() {
    let d = read(WEB);
    let kept = "<g transform='translate(5 0)'><path d='M0,20 h 20 m5 7 h40' fill='none' stroke='#112233' \
         stroke-width='2' \
                stroke-dasharray='3 1'/></g><path d='M0 90H50' fill='none' stroke='blue'/><rect x='70' y='70' \
                width='9' height='9'/>";
    let placed = read_placed(&page(kept), &d, &ReadOptions::new("k.svg")).unwrap();
    assert_eq!(placed.curves.iter().map(|c| (c.source, c.scale)).collect::<Vec<_>>(), [(0, 1.0), (0, 1.0)]);
    assert_eq!(placed.curves[1].path.start(), Some(Vector::xy(30.0, 27.0)));
    assert_eq!((placed.curve_fragments.len(), placed.obstacles.len()), (1, 2));
    let markup = &placed.curve_fragments[0].fragment.markup;
    assert!(markup.contains("d=\"M0,20 h 20 m5 7 h40\""), "not as it was drawn: {markup}");
}

#[test]
fn strokes_that_arabesque_made_wider_are_known_by_their_number() {
    let d = read(WEB);
    let wide = |mark: &str| {
        format!("<path d='M0 9H50' {mark} fill='none' stroke='#123' stroke-width='3' stroke-dasharray='4.5 1.5'/>")
    };
    let keep = |text: &str| read_placed(&page(text), &d, &ReadOptions::new("k.svg")).unwrap();
    let stated = keep(&wide("data-arabesque-curve='1'"));
    assert_eq!(stated.curves.iter().map(|c| (c.source, c.scale)).collect::<Vec<_>>(), [(1, 1.5)]);
    assert_eq!(keep(&wide("data-arabesque-curve='2'")).obstacles.len(), 1);
    assert_eq!(keep(&wide("")).obstacles.len(), 1);
}
