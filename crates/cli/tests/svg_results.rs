//! What SVG results are made of.

mod common;

use common::{Folder, attributes, drawn, pixels, svg};

#[test]
fn layers_labels_and_links() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 -o a.svg");
    let text = folder.text("a.svg");
    assert!(text.contains("inkscape:groupmode=\"layer\" inkscape:label=\"Arabesque output\""));
    assert!(text.contains("inkscape:label=\"Background\""));
    let body = drawn(&text);
    let defined: Vec<_> = attributes(body, "id").into_iter().filter(|id| id.contains("-element-")).collect();
    let links: Vec<_> = attributes(body, "href").into_iter().map(|h| h.trim_start_matches('#')).collect();
    assert!(links.len() > defined.len());
    assert!(links.iter().all(|l| defined.contains(l)), "a link leads nowhere");
    assert!(defined.iter().all(|d| links.contains(d)), "an element is defined and not used");
    assert!(attributes(body, "data-arabesque-class").contains(&"berry"));
}

#[test]
fn ids_are_unique_in_every_style() {
    let folder = Folder::new();
    let busy = common::leaves().replace("<circle class", "<circle id=\"arabesque-7\" class");
    folder.write("busy.svg", busy.replacen("id=\"arabesque-7\"", "id=\"arabesque-element-0\"", 1));
    for (name, options) in
        [("leaves", ""), ("leaves", "--expand"), ("busy", "--expand"), ("leaves", "--domain ring.svg --expand")]
    {
        let place = if options.contains("domain") { "" } else { "--size 120x120" };
        folder.ok(&format!("fill {name}.svg {place} {options} -o a.svg"));
        let text = folder.text("a.svg");
        let mut ids = attributes(drawn(&text), "id");
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all, "{name} {options}");
    }
}

#[test]
fn expanded_results_hold_nothing_but_paths() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 120x120 --expand -o a.svg");
    let text = folder.text("a.svg");
    let body = drawn(&text);
    for word in ["<use", "transform=", "<circle", "href"] {
        assert!(!body.contains(word), "{word}");
    }
}

#[test]
fn expanded_and_linked_results_look_the_same() {
    let folder = Folder::new();
    for place in ["--size 120x100", "--domain ring.svg", "--tile 90x70"] {
        folder.ok(&format!("fill leaves.svg {place} -o linked.svg"));
        folder.ok(&format!("fill leaves.svg {place} --expand -o expanded.svg"));
        let draw = |name: &str| {
            let tree = resvg::usvg::Tree::from_data(&folder.read(name), &resvg::usvg::Options::default()).unwrap();
            let size = tree.size().to_int_size();
            let mut pixmap = resvg::tiny_skia::Pixmap::new(size.width(), size.height()).unwrap();
            resvg::render(&tree, resvg::tiny_skia::Transform::identity(), &mut pixmap.as_mut());
            pixmap.data().to_vec()
        };
        let (a, b) = (draw("linked.svg"), draw("expanded.svg"));
        assert_eq!(a.len(), b.len());
        let differing = a
            .chunks_exact(4)
            .zip(b.chunks_exact(4))
            .filter(|(p, q)| p.iter().zip(*q).any(|(x, y)| x.abs_diff(*y) > 64))
            .count();
        assert!(differing * 200 < a.len() / 4, "{place}: {differing} of {} pixels differ", a.len() / 4);
    }
}

#[test]
fn expanded_elements_are_cut_at_the_border() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --domain ring.svg --expand -o a.svg");
    let text = folder.text("a.svg");
    let output = text.split("id=\"arabesque-output\"").nth(1).unwrap();
    let mut numbers = 0;
    for data in attributes(output, "d") {
        let values: Vec<f64> =
            data.split(|c: char| c.is_ascii_alphabetic() || c == ' ').filter_map(|v| v.parse().ok()).collect();
        for p in values.chunks_exact(2) {
            let r = (p[0] - 80.0).hypot(p[1] - 80.0);
            // Control points of curves that are not cut may lie a little outside.
            assert!(r < 73.0 && r > 22.0, "a point at radius {r}");
            numbers += 1;
        }
    }
    assert!(numbers > 200);
}

#[test]
fn gradients_stay_with_their_elements() {
    let folder = Folder::new();
    let gradient = "<defs><linearGradient id=\"g\"><stop offset=\"0\" stop-color=\"#f00\"/><stop offset=\"1\" stop-color=\"#00f\"/></linearGradient></defs>";
    let dots: String = (0..16)
        .map(|k| {
            format!("<circle cx=\"{}\" cy=\"{}\" r=\"5\" fill=\"url(#g)\"/>", 10 + 20 * (k % 4), 10 + 20 * (k / 4))
        })
        .collect();
    folder.write("g.svg", svg("80", "80", "0 0 80 80", &(gradient.to_owned() + &dots)));
    folder.ok("fill g.svg --size 100x100 -o a.svg");
    folder.ok("fill g.svg --size 100x100 -o a.png --pixels-per-unit 1");
    let (_, _, rgba) = pixels(&folder.read("a.png"));
    let (mut reds, mut blues) = (0, 0);
    for p in rgba.chunks_exact(4).filter(|p| p[3] == 255) {
        reds += usize::from(p[0] > 180);
        blues += usize::from(p[2] > 180);
    }
    assert!(reds > 100 && blues > 100, "{reds} red and {blues} blue pixels");
}

#[test]
fn a_tile_meets_itself_across_its_edges() {
    let folder = Folder::new();
    folder.ok(&format!("fill {} --tile 90x70 -o a.svg", common::example("birds.svg")));
    let text = folder.text("a.svg");
    let places: Vec<(f64, f64, &str)> = drawn(&text)
        .lines()
        .filter(|l| l.starts_with("<use"))
        .map(|l| {
            let transform = attributes(l, "transform")[0];
            let numbers: Vec<f64> =
                transform.trim_end_matches(')').split(['(', ' ']).filter_map(|v| v.parse().ok()).collect();
            (numbers[numbers.len() - 2], numbers[numbers.len() - 1], attributes(l, "id")[0])
        })
        .collect();
    assert!(places.iter().any(|p| p.2.matches('-').count() == 2), "nothing crosses an edge");
    for (x, y, id) in places.iter().filter(|p| p.2.matches('-').count() == 2) {
        let original = id.rsplit_once('-').unwrap().0;
        let (ox, oy, _) = places.iter().find(|p| p.2 == original).unwrap();
        let steps = |d: f64, period: f64| (d / period - (d / period).round()).abs() < 1e-9 && (d / period).abs() < 1.5;
        assert!(steps(x - ox, 90.0) && steps(y - oy, 70.0), "{id}: {x} {y} against {ox} {oy}");
    }
}
