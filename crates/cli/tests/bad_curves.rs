//! Odd and broken strokes: each is drawn, told of or refused with a message that says what to do; nothing hangs and nothing is lost.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

mod common;

use std::fmt::Write as _;

use common::{Folder, attributes, drawn, stderr, svg};

const PAINT: &str = "fill=\"none\" stroke=\"#234\" stroke-width=\"1.5\"";

/// A path in [`PAINT`].
fn stroke(data: &str) -> String {
    format!("<path d=\"{data}\" {PAINT}/>\n")
}

/// `n` lines each way, `step` apart, as wide as told.
fn net(n: u32, step: u32, width: f64) -> String {
    let side = n * step;
    let line = |k: u32| {
        let at = step / 2 + step * k;
        let paint = format!("fill=\"none\" stroke=\"#234\" stroke-width=\"{width}\"");
        format!("<path d=\"M0 {at}H{side}\" {paint}/>\n<path d=\"M{at} 0V{side}\" {paint}/>\n")
    };
    (0..n).map(line).collect()
}

/// The columns of a net of 5 by 5.
fn columns() -> String {
    (0..5).map(|k| stroke(&format!("M{} 0V100", 10 + 20 * k))).collect()
}

/// For each row of a net of 5 by 5, a path that `data` makes of its height.
fn rows(data: impl Fn(u32) -> String) -> String {
    (0..5).map(|k| stroke(&data(10 + 20 * k))).collect()
}

fn page(body: &str) -> String {
    svg("100", "100", "0 0 100 100", body)
}

/// Fills with the exemplar. Returns what was said and the paths that came out.
fn filled(body: &str, options: &str) -> (String, Vec<String>) {
    let folder = Folder::new();
    folder.write("odd.svg", page(body));
    let told = stderr(&folder.ok(&format!("fill odd.svg --size 140x100 {options} -o out.svg")));
    let text = folder.text("out.svg");
    // What elements look like is kept apart.
    let part: String = drawn(&text).lines().filter(|line| !line.contains("id=\"arabesque-element-")).collect();
    assert_eq!(attributes(&part, "data-arabesque-curve").len(), attributes(&part, "d").len(), "{part}");
    (told, attributes(&part, "d").into_iter().map(str::to_owned).collect())
}

/// The numbers of a path. A minus sign starts a number without a blank before it, unless it belongs to an exponent.
fn numbers(data: &str) -> Vec<f64> {
    let apart = data.replace('-', " -").replace("e -", "e-");
    let parts = apart.split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | 'e')));
    parts.filter(|n| !n.is_empty()).map(|n| n.parse().unwrap_or_else(|e| panic!("{n} in {data}: {e}"))).collect()
}

/// Whether a result is the net 20 apart on 140 x 100: seven lines down and five across, from side to side.
fn assert_net(name: &str, paths: &[String]) {
    let spans = |k: usize, length: f64| {
        let long = |data: &&String| {
            let along: Vec<f64> = numbers(data).into_iter().skip(k).step_by(2).collect();
            let (low, high) = along.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            high - low > 0.8 * length
        };
        paths.iter().filter(long).count()
    };
    assert!((5..=9).contains(&spans(1, 100.0)), "{name}: {paths:#?}");
    assert!((4..=7).contains(&spans(0, 140.0)), "{name}: {paths:#?}");
}

#[test]
fn strokes_without_length_are_left_out_and_told() {
    let dots = stroke("M5 5L5 5") + &stroke("M50 50Z") + &stroke("M20 20C20 20 20 20 20 20");
    let (told, paths) = filled(&(net(5, 20, 1.5) + &dots), "");
    assert!(told.contains("odd.svg: stroke without length ignored (3 times)"), "{told}");
    assert_net("zero length", &paths);
    let folder = Folder::new();
    folder.write("dots.svg", page(&dots));
    let message = folder.fails(3, "fill dots.svg --size 80x80 -o out.svg");
    assert!(message.contains("dots.svg: no element and no curve found (stroke without length"), "{message}");
    let dust: String = (0..40_u32).map(|k| stroke(&format!("M{} {}l.01 .01", k * 37 % 100, k * 61 % 100))).collect();
    folder.write("dust.svg", page(&dust));
    // Clear of one another, they are small things; as curves, they are too short.
    folder.ok("fill dust.svg --size 140x100 -o out.svg");
    let message = folder.fails(3, "fill dust.svg --method curves --set repeat=off --size 140x100 -o none.svg");
    assert!(message.contains("dust.svg: every curve lies outside the frame or is too short"), "{message}");
    let (told, paths) = filled(&(net(5, 20, 1.5) + &dust), "");
    // Eleven touch the net and are part of it, two of these in its junctions; the others are things between its lines.
    assert!(told.contains("strokes too short to be seen left out: 9,"), "{told}");
    assert_net("dust", &paths);
    let (told, paths) = filled(&(net(5, 20, 1.5) + &stroke("M50 50l.01 .01")), "");
    assert!(!told.contains("too short"), "{told}");
    assert_net("speck in a junction", &paths);
}

#[test]
fn strokes_of_no_width_are_told() {
    let folder = Folder::new();
    folder.write("thin.svg", page(&net(5, 20, 0.0)));
    let message = folder.fails(3, "fill thin.svg --size 80x80 -o out.svg");
    assert!(message.contains("thin.svg") && message.contains("stroke of no width ignored (10x)"), "{message}");
}

#[test]
fn coincident_points_and_overlaps_change_nothing() {
    let repeated = rows(|y| format!("M0 {y}L0 {y}L50 {y}L50 {y}L50 {y}L100 {y}L100 {y}"));
    let doubled_back = rows(|y| format!("M0 {y}H60H20H100"));
    let minced = rows(|y| (1..=4000).fold(format!("M0 {y}"), |d, k| d + &format!("L{} {y}", f64::from(k) * 0.025)));
    for (name, body) in [("coincident points", repeated), ("tiny segments", minced)] {
        let (told, paths) = filled(&(columns() + &body), "");
        assert!(!told.contains("warning"), "{name}: {told}");
        assert_net(name, &paths);
    }
    let (told, paths) = filled(&(columns() + &doubled_back), "");
    assert!(!told.contains("warning"), "{told}");
    assert_covered(&paths);
}

/// Whether the rows of the net 20 apart go from side to side, in whatever pieces they are drawn.
fn assert_covered(paths: &[String]) {
    let pieces: Vec<[f64; 4]> = paths
        .iter()
        .flat_map(|data| {
            let places = numbers(data);
            places.windows(4).step_by(2).map(|p| [p[0], p[1], p[2], p[3]]).collect::<Vec<_>>()
        })
        .collect();
    for (row, x) in (0..5).flat_map(|row| (1..140).map(move |x| (f64::from(row) * 20.0 + 10.0, f64::from(x)))) {
        let covers = |p: &[f64; 4]| p[1] == row && p[3] == row && p[0].min(p[2]) <= x && x <= p[0].max(p[2]);
        assert!(pieces.iter().any(covers), "nothing at {x} {row}: {paths:#?}");
    }
}

#[test]
fn cusps_and_spikes_come_out_whole() {
    let each = |data: &dyn Fn(u32, u32) -> String| -> String {
        (0..25).map(|k| stroke(&data(20 * (k % 5), 20 * (k / 5)))).collect()
    };
    // Both handles beyond the other end: a cusp in the middle.
    let cusps =
        each(&|x, y| format!("M{} {}C{} {} {} {} {} {}", x + 4, y + 16, x + 16, y + 4, x + 4, y + 4, x + 16, y + 16));
    let spikes = each(&|x, y| format!("M{} {}h14h-14", x + 3, y + 10));
    let twice_around = each(&|x, y| format!("M{} {}{}", x + 4, y + 4, "h12v12h-12v-12".repeat(2)));
    for (name, body) in [("cusps", cusps), ("spikes", spikes), ("twice around", twice_around)] {
        let (told, paths) = filled(&body, "--method curves");
        assert!(!told.contains("warning"), "{name}: {told}");
        assert!((20..=90).contains(&paths.len()), "{name}: {}", paths.len());
        assert!(paths.iter().flat_map(|d| numbers(d)).all(|v| (-1.0..=141.0).contains(&v)), "{name}");
    }
}

#[test]
fn identical_strokes_count_once() {
    let backwards = net(5, 20, 1.5) + &rows(|y| format!("M100 {y}H0"));
    let other_nodes = net(5, 20, 1.5) + &rows(|y| format!("M0 {y}H30C40 {y} 60 {y} 70 {y}H100"));
    for (name, body, count) in
        [("the same", net(5, 20, 1.5).repeat(2), 10), ("backwards", backwards, 5), ("other nodes", other_nodes, 5)]
    {
        let (told, paths) = filled(&body, "");
        let expected = format!("odd.svg: stroke exactly on top of one like it ignored ({count} times)");
        assert!(told.contains(&expected), "{name}: {told}");
        assert_net(name, &paths);
    }
    // In another paint, both are meant: a line with an edge of another colour.
    let (told, paths) = filled(&(net(5, 20, 4.0) + &net(5, 20, 1.5)), "");
    assert!(!told.contains("on top") && paths.len() > 20, "{told}");
}

#[test]
fn a_single_closed_circle_is_told_to_be_too_little() {
    let folder = Folder::new();
    folder.write("one.svg", page(&format!("<circle cx=\"50\" cy=\"50\" r=\"30\" {PAINT}/>")));
    let message = folder.fails(3, "fill one.svg --size 140x100 -o out.svg");
    assert!(message.contains("one.svg: one element only") && message.contains("repeat the element"), "{message}");
    let told = stderr(&folder.ok("fill one.svg --method curves --size 140x100 -o out.svg"));
    assert!(told.contains("there is nothing to repeat"), "{told}");
    assert!(!attributes(drawn(&folder.text("out.svg")), "data-arabesque-curve").is_empty());
}

#[test]
fn what_never_repeats_is_told() {
    let body = stroke("M5 95Q40 5 60 50T95 5") + &stroke("M10 20L30 60L90 80") + &stroke("M55 70A15 15 0 1 1 85 70");
    for (name, body) in [("three strokes", body), ("one line", stroke("M0 50H100")), ("one dash", stroke("M20 50H80"))]
    {
        let (told, paths) = filled(&body, "");
        assert!(told.contains("there is nothing to repeat; draw the pattern several times"), "{name}: {told}");
        assert!(!paths.is_empty(), "{name}");
    }
    let (told, _) = filled(&net(5, 20, 1.5), "");
    assert!(!told.contains("warning"), "{told}");
}

#[test]
fn strokes_wider_than_their_spacing_are_told_once() {
    let (told, paths) = filled(&net(10, 10, 14.0), "--set repeat=off");
    assert_eq!(told.matches("warning").count(), 1, "{told}");
    assert!(told.contains("as wide as their spacing: they cover 100 %"), "{told}");
    assert!(!paths.is_empty());
    let (told, _) = filled(&net(10, 10, 6.0), "--set repeat=off");
    assert!(!told.contains("warning"), "{told}");
    // Continued by their repeat, they cover as much as in the exemplar and no more.
    let (told, paths) = filled(&net(10, 10, 14.0), "");
    assert!(!told.contains("warning") && paths.len() >= 24, "{told}");
}

#[test]
fn an_exemplar_smaller_than_a_neighbourhood_is_told() {
    let folder = Folder::new();
    folder.write("tiny.svg", svg("10", "10", "0 0 10 10", &(stroke("M0 5H10") + &stroke("M5 0V10"))));
    let told = stderr(&folder.ok("fill tiny.svg --exemplar-tile=no --size 40x40 -o out.svg"));
    assert!(told.contains("hardly larger than one neighbourhood: 10.0000 across"), "{told}");
    let message = folder.fails(2, "fill tiny.svg --exemplar-tile=no --size 40x40 --radius 20 -o other.svg");
    assert!(message.contains("radius = 20: expected at most 10"), "{message}");
}

#[test]
fn a_tangle_is_refused_before_it_takes_long() {
    let mut scribble = "M0 50".to_owned();
    for k in 0..3000_u32 {
        write!(scribble, "L{} {}", k * 7919 % 1000 / 10, k * 104_729 % 997 / 10).unwrap();
    }
    for (name, body) in [("scribble.svg", stroke(&scribble)), ("dense.svg", net(120, 1, 0.1))] {
        let folder = Folder::new();
        folder.write(name, svg("120", "120", "0 0 120 120", &body));
        let message = folder.fails(3, &format!("fill {name} --size 80x80 --set repeat=off -o out.svg"));
        assert!(message.contains(name) && message.contains("over the limit of 10000"), "{message}");
        assert!(message.contains("show a smaller part"), "{message}");
        let line = format!("fill {name} --size 80x80 -o out.svg");
        if name == "scribble.svg" {
            assert_eq!(folder.fails(3, &line), message);
        } else {
            // A net that repeats is continued without looking at where its lines meet.
            folder.ok(&line);
            assert!(attributes(drawn(&folder.text("out.svg")), "data-arabesque-curve").len() >= 160);
        }
    }
}

#[test]
fn strokes_far_beyond_the_page_do_not_count() {
    let (told, paths) = filled(&(net(5, 20, 1.5) + &stroke("M0 30L1e9 40")), "");
    assert!(!told.contains("error"), "{told}");
    assert!(paths.len() >= 10, "{paths:?}");
    let folder = Folder::new();
    folder.write("far.svg", page(&(net(5, 20, 1.5) + &stroke("M0 30L1e30 40"))));
    assert!(
        folder
            .fails(3, "fill far.svg --size 80x80 -o out.svg")
            .contains("far.svg:12: <path>: a coordinate is 1e30, expected")
    );
    folder.write("nan.svg", page(&(net(5, 20, 1.5) + &stroke("M0 30Lnan 40"))));
    assert!(
        folder.fails(3, "fill nan.svg --size 80x80 -o out.svg").contains("nan.svg:12: <path>: the path data cannot")
    );
    folder.write("off.svg", page(&(stroke("M-50 -50L-10 -20") + &stroke("M200 200H300"))));
    assert!(folder.fails(3, "fill off.svg --size 80x80 -o out.svg").contains("off.svg: no element and no curve found"));
}

#[test]
fn what_is_kept_must_touch_the_domain() {
    let folder = Folder::new();
    folder.write("net.svg", page(&net(5, 20, 1.5)));
    folder.write("far.svg", page(&stroke("M500 500L600 600")));
    folder.write("blank.svg", page(""));
    for name in ["far.svg", "blank.svg"] {
        let told = stderr(&folder.ok(&format!("fill net.svg --size 140x100 --keep {name} -o out.svg")));
        assert!(told.contains(&format!("{name}: nothing of what is to be kept lies in the domain")), "{told}");
    }
    let text = folder.text("out.svg");
    folder.write("near.svg", page(&stroke("M0 30H60")));
    let told = stderr(&folder.ok("fill net.svg --size 140x100 --keep near.svg -o kept.svg"));
    assert!(!told.contains("warning") && text != folder.text("kept.svg"), "{told}");
}

#[test]
fn regions_that_touch_nothing_are_named() {
    let folder = Folder::new();
    let wide = svg(
        "300",
        "100",
        "0 0 300 100",
        &(net(5, 20, 1.5) + "<rect id=\"void\" x=\"200\" y=\"20\" width=\"80\" height=\"60\" fill=\"none\"/>"),
    );
    folder.write("net.svg", wide);
    let before = folder.text("net.svg");
    for (code, line, expected) in [
        (3, "--redo 500,500,20,20", "net.svg: region 500,500,20,20: the region lies off the page"),
        (3, "--redo -50,-50,20,20", "net.svg: region -50,-50,20,20: the region lies off the page"),
        (3, "--redo 200,20,80,60", "net.svg: region 200,20,80,60: nothing of the drawing lies in or around the region"),
        (3, "--redo #void", "net.svg: region #void: nothing of the drawing lies in or around the region"),
        (3, "--redo #other", "nothing visible has the id \"other\"; use one of its ids, such as void"),
        (4, "--redo 12,12,2,2 --set repeat=off", "net.svg: region 12,12,2,2: the domain"),
        (3, "--redo 0,0,100,100", "leaves too little of the drawing to be the example"),
        (3, "--from 0,0,50,50 --to 500,0,50,50", "net.svg: region 500,0,50,50: the region lies off the page"),
        (3, "--from 500,0,50,50 --to 0,0,50,50", "net.svg: region 500,0,50,50: the region to copy from lies off"),
        (
            3,
            "--from 12,12,6,6 --to 50,50,50,50",
            "net.svg: region 12,12,6,6: nothing of the drawing lies in the region",
        ),
        (2, "--from 0,0,0,50 --to 20,20,50,50", "a positive width and height"),
    ] {
        let message = folder.fails(code, &format!("fill net.svg {line} -o out.svg"));
        assert!(message.contains(expected), "{line}: {message}");
    }
    let told = stderr(&folder.ok("fill net.svg --from 0,0,100,100 --to 260,20,80,60 -o out.svg"));
    assert!(told.contains("region 260,20,80,60: 50 % of the region lie off the page"), "{told}");
    assert_eq!(before, folder.text("net.svg"));
}
