//! Elements of small results, read and changed.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, Matrix, Similarity, Vector};

use super::SvgElements;
use crate::placed::{Changes, Paint, PlacedFile, Replaced};

const RESULT: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
xmlns:arabesque=\"urn:arabesque:1\" width=\"20\" height=\"10\" viewBox=\"0 0 20 10\">
<metadata>
<arabesque:recipe><![CDATA[seed = 1
]]></arabesque:recipe>
</metadata>
<defs>
<g id=\"arabesque-element-0\"><rect x=\"0\" y=\"0\" width=\"2\" height=\"2\" fill=\"red\"/></g>
<g id=\"arabesque-element-4\"><path d=\"M0 0H4V2H0Z\"/></g>
</defs>
<g inkscape:groupmode=\"layer\" inkscape:label=\"Arabesque output\" id=\"arabesque-output\">
<use id=\"arabesque-0\" href=\"#arabesque-element-0\" transform=\"translate(1 1)\" data-arabesque-source=\"0\" data-arabesque-class=\"dot\"/>
<use id=\"arabesque-1\" href=\"#arabesque-element-4\" transform=\"matrix(0 1 -1 0 12 3)\" data-arabesque-source=\"4\" data-arabesque-class=\"a &amp; b\"/>
<use id=\"arabesque-2\" href=\"#arabesque-element-0\" transform=\"translate(19 4)\" data-arabesque-source=\"0\" data-arabesque-class=\"dot\"/>
<use id=\"arabesque-2-1\" href=\"#arabesque-element-0\" transform=\"translate(-1 4)\" data-arabesque-source=\"0\" data-arabesque-class=\"dot\"/>
<g id=\"arabesque-3\" data-arabesque-source=\"0\" data-arabesque-class=\"dot\"><path d=\"M4 6L6 6L6 8L4 8Z\" fill=\"red\"/></g>
</g>
</svg>
";

fn open(text: &str) -> SvgElements {
    SvgElements::open("r.svg", text.to_owned(), true, &Budget::default()).unwrap()
}

fn moved(base: usize, motion: Similarity<2>) -> Replaced<2> {
    Replaced { base, motion, paint: Vec::new() }
}

fn changed(text: &str, changes: &Changes<2>) -> String {
    String::from_utf8(open(text).rewritten(changes, None, &Budget::default()).unwrap()).unwrap()
}

fn one(id: usize, replaced: Replaced<2>) -> Changes<2> {
    Changes { replaced: BTreeMap::from([(id, replaced)]), ..Changes::default() }
}

#[test]
fn elements_are_found_with_their_places() {
    let file = open(RESULT);
    let layout = file.layout();
    let found: Vec<_> =
        layout.items.iter().map(|item| (item.id, layout.classes[item.class].as_str(), item.centre)).collect();
    let expected = [
        (0, "dot", Vector::xy(2.0, 2.0)),
        (1, "a & b", Vector::xy(11.0, 5.0)),
        (2, "dot", Vector::xy(20.0, 5.0)),
        (3, "dot", Vector::xy(5.0, 7.0)),
    ];
    assert_eq!(found, expected);
    assert_eq!((layout.next, layout.items[1].source), (4, Some(4)));
    assert!((layout.items[0].reach - 2.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn nothing_changes_without_changes() {
    assert_eq!(changed(RESULT, &Changes::default()), RESULT);
    for id in 0..4 {
        assert_eq!(changed(RESULT, &one(id, moved(id, Similarity::identity()))), RESULT, "{id}");
    }
}

#[test]
fn motion_and_back_restores_every_byte() {
    for id in 0..4 {
        let centre = open(RESULT).layout().items[id].centre;
        let turned = Similarity::about(centre, centre + Vector::xy(0.3, 0.1), Matrix::rotation(0.3), 1.7);
        let there = changed(RESULT, &one(id, moved(id, turned)));
        assert_ne!(there, RESULT);
        let centre = open(&there).layout().items[id].centre;
        let back = Similarity::about(centre, centre - Vector::xy(0.3, 0.1), Matrix::rotation(-0.3), 1.0 / 1.7);
        assert_eq!(changed(&there, &one(id, moved(id, back))), RESULT, "{id}: {there}");
    }
}

#[test]
fn copies_on_a_tile_come_and_go() {
    let there = changed(RESULT, &one(2, moved(2, Similarity::shift(Vector::xy(-9.0, 4.0)))));
    assert!(
        there.contains("\"arabesque-2-1\"") && there.contains("translate(10 8)") && there.contains("translate(10 -2)")
    );
    let inside = changed(RESULT, &one(2, moved(2, Similarity::shift(Vector::xy(-9.0, 0.0)))));
    assert!(!inside.contains("\"arabesque-2-1\""), "{inside}");
    let back = changed(&inside, &one(2, moved(2, Similarity::shift(Vector::xy(9.0, 0.0)))));
    assert_eq!(back, RESULT);
}

#[test]
fn elements_are_removed_and_inserted() {
    let removed = changed(RESULT, &Changes { removed: BTreeSet::from([0, 2]), ..Changes::default() });
    assert!(!removed.contains("\"arabesque-0\"") && !removed.contains("\"arabesque-2-1\""), "{removed}");
    let ids: Vec<_> = open(&removed).layout().items.iter().map(|item| item.id).collect();
    assert_eq!(ids, [1, 3]);
    let shift = Similarity::shift(Vector::xy(1.0, 2.0));
    let inserted = Changes { inserted: vec![(4, moved(1, shift)), (5, moved(3, shift))], ..Changes::default() };
    let text = changed(RESULT, &inserted);
    let file = open(&text);
    assert_eq!(file.layout().item(4).unwrap().centre, Vector::xy(12.0, 7.0));
    assert_eq!(file.layout().item(5).unwrap().centre, Vector::xy(6.0, 9.0));
    let again = Changes { removed: BTreeSet::from([4, 5]), ..Changes::default() };
    assert_eq!(changed(&text, &again), RESULT);
}

#[test]
fn paint_makes_a_definition_that_goes_when_nothing_shows_it() {
    let paint = |value: &str| vec![Paint { property: "fill".into(), value: value.into() }];
    let blue = Replaced { paint: paint("#00f"), ..moved(0, Similarity::identity()) };
    let text = changed(RESULT, &one(0, blue));
    assert!(text.contains(
        "<g id=\"arabesque-element-0-1\"><rect x=\"0\" y=\"0\" width=\"2\" height=\"2\" fill=\"#00f\"/></g>"
    ));
    assert_eq!(text.matches("#arabesque-element-0-1\"").count(), 1, "{text}");
    let red = Replaced { paint: paint("red"), ..moved(0, Similarity::identity()) };
    assert_eq!(changed(&text, &one(0, red)), RESULT);
    let pale = Replaced {
        paint: vec![Paint { property: "opacity".into(), value: "0.5".into() }],
        ..moved(3, Similarity::identity())
    };
    let text = changed(RESULT, &one(3, pale));
    assert!(text.contains("<g id=\"arabesque-3\" opacity=\"0.5\" data"), "{text}");
}

#[test]
fn a_recipe_is_replaced_where_there_is_one() {
    let file = open(RESULT);
    let text = file.rewritten(&Changes::default(), Some("seed = 2\n]]>"), &Budget::default()).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert_eq!(crate::svg::recipe_of(&text).as_deref(), Some("seed = 2\n]]>"));
}

#[test]
fn what_is_no_result_is_refused() {
    let cases = [
        ("<svg xmlns='http://www.w3.org/2000/svg'/>".to_owned(), "no element that arabesque placed"),
        ("nonsense".to_owned(), "SVG"),
        (RESULT.replace("matrix(0 1 -1 0 12 3)", "matrix(1 0 0 -1 0 0)"), "element 1 is sheared, mirrored"),
        (RESULT.replace("translate(1 1)", "translate(nan)"), "element 0 is"),
    ];
    for (text, expected) in cases {
        let message = SvgElements::open("r.svg", text, false, &Budget::default()).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    let huge = one(2, moved(2, Similarity { scale: 1e9, ..Similarity::identity() }));
    let message = open(RESULT).rewritten(&huge, None, &Budget::default()).unwrap_err().to_string();
    assert!(message.contains("copies of one element"), "{message}");
}
