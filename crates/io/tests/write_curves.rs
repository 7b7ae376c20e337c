//! Strokes written as SVG, and read again.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use arabesque_core::{Border, Bounds, Budget, Domain, Drawn, Outline, Path, Vector};
use arabesque_io::svg::{Drawing, Method, Page, ReadOptions, Sheet, Style, read_exemplar, write_svg};

const NET: &str = "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape'
    width='100' height='100' viewBox='0 0 100 100'><g inkscape:groupmode='layer' inkscape:label='Web'>
    <path d='M0 20H100M0 70C30 60 60 80 100 70' fill='none' stroke='#7a4a12' stroke-width='1.7' \
    stroke-linecap='round'/></g>
    <path class='thread' d='M50 0V100' fill='none' stroke='red' stroke-dasharray='4 2' opacity='.5'/>
    <circle class='thread' cx='50' cy='45' r='9' fill='none' stroke='red' stroke-dasharray='4 2' opacity='.5'/></svg>";

fn net() -> Drawing {
    read_exemplar(NET, &ReadOptions::new("net.svg")).unwrap()
}

fn itself(drawing: &Drawing) -> Vec<Drawn<2>> {
    let drawn = |(source, curve): (usize, &arabesque_core::Curve<2>)| Drawn {
        path: curve.path.clone(),
        source,
        scale: 1.0,
        frozen: None,
    };
    drawing.exemplar.curves.iter().enumerate().map(drawn).collect()
}

fn written(drawing: &Drawing, curves: &[Drawn<2>], domain: &Domain<2>, shape: Option<&Outline<2>>) -> String {
    let sheet = Sheet {
        drawing,
        placements: &[],
        sequence: &[],
        areas: &[],
        curves,
        kept: None,
        host: None,
        page: Page { view: domain.bounds(), ..drawing.page },
        domain,
        shape,
        border: Border::Clip,
        bend: None,
        style: Style::Linked,
        recipe: None,
        budget: &Budget::default(),
    };
    write_svg(&sheet).unwrap().text
}

fn page() -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0))
}

#[test]
fn what_is_written_reads_as_the_same_curves() {
    let drawing = net();
    let text = written(&drawing, &itself(&drawing), &Domain::Box(page()), None);
    let again = read_exemplar(&text, &ReadOptions { method: Method::Curves, ..ReadOptions::new("out.svg") }).unwrap();
    let names = |d: &Drawing| d.exemplar.styles.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
    assert_eq!((names(&drawing), drawing.exemplar.curves.len()), (vec!["style 1".into(), "thread".into()], 4));
    assert_eq!(again.exemplar.curves.len(), 4);
    for (a, b) in drawing.exemplar.curves.iter().zip(&again.exemplar.curves) {
        assert_eq!((a.width, a.colour, a.path.closed), (b.width, b.colour, b.path.closed));
        let middle = |p: &Path<2>| p.flatten(0.01)[p.flatten(0.01).len() / 2];
        assert!((middle(&a.path) - middle(&b.path)).norm() < 0.5, "{a:?} {b:?}");
    }
    for (a, b) in drawing.strokes.iter().flatten().zip(again.strokes.iter().flatten()) {
        assert_eq!((&a.paint, &a.effects, &a.dashes), (&b.paint, &b.effects, &b.dashes));
    }
}

#[test]
fn strokes_painted_alike_share_a_layer_and_lines_stay_lines() {
    let drawing = net();
    let text = written(&drawing, &itself(&drawing), &Domain::Box(page()), None);
    assert_eq!(text.matches("stroke=\"#7a4a12\"").count(), 1);
    assert_eq!(text.matches("stroke-dasharray=\"4 2\"").count(), 1);
    assert!(
        text.contains("inkscape:groupmode=\"layer\" inkscape:label=\"Web\"")
            && text.contains("inkscape:label=\"thread\"")
    );
    assert!(text.contains("d=\"M0 20L100 20\"") && text.contains("d=\"M0 70C30 60 60 80 100 70\""), "{text}");
    // Opacity on the group would change how strokes look where they cross.
    assert_eq!(text.matches("opacity=\"0.5\"/>").count(), 2);
    assert_eq!(text.matches("<path id=").count(), 4);
}

#[test]
fn scaled_strokes_have_scaled_widths_and_dashes() {
    let drawing = net();
    let mut curves = itself(&drawing);
    curves[2].scale = 2.0;
    let text = written(&drawing, &curves, &Domain::Box(page()), None);
    assert!(text.contains("stroke-width=\"2\" stroke-dasharray=\"8 4\""), "{text}");
}

#[test]
fn a_stroke_over_the_edge_of_a_tile_is_drawn_on_the_other_side_too() {
    let drawing = net();
    let line = Path::polyline(&[Vector::xy(90.0, 50.0), Vector::xy(130.0, 50.0)]);
    let drawn = Drawn { path: line, source: 0, scale: 1.0, frozen: None };
    let text = written(&drawing, &[drawn], &Domain::Torus(page()), None);
    assert!(text.contains("M90 50L130 50") && text.contains("M-10 50L30 50"), "{text}");
    assert_eq!(text.matches("<path id=").count(), 2);
}

#[test]
fn a_shape_clips_wide_strokes() {
    let drawing = net();
    let ring = vec![Vector::xy(10.0, 10.0), Vector::xy(90.0, 10.0), Vector::xy(50.0, 90.0)];
    let text = written(&drawing, &itself(&drawing), &Domain::Box(page()), Some(&Outline { rings: vec![ring] }));
    assert!(text.contains("clip-path=\"url(#arabesque-domain)\""));
    assert!(text.find("clip-path=\"url").unwrap() < text.find("arabesque-style-0").unwrap());
}
