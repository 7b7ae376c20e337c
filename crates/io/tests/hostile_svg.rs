//! Drawings made to take long, to take much memory, or to go deep: each is read within its budget or refused, and told why.

use arabesque_core::{Budget, Error, FillRule, Limits, Outline, Vector};
use arabesque_io::svg::{Drawing, ReadOptions, read_exemplar, read_shape};

/// Fifty thousand of anything.
const MANY: usize = 50_000;

/// Sixty-four dots.
fn dots(attributes: &str) -> String {
    let dot = |k: usize| format!("<circle cx='{}' cy='{}' r='5' {attributes}/>", 20 + 20 * (k % 8), 20 + 20 * (k / 8));
    (0..64).map(dot).collect()
}

fn document(body: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 200'>{body}</svg>")
}

fn read(body: &str) -> (Result<Drawing, Error>, u64) {
    let options = ReadOptions::new("h.svg");
    let read = read_exemplar(&document(body), &options);
    (read, options.budget.work())
}

/// Reads what must not be refused, and take no more than so many millions of units.
fn reads(body: &str, most: u64) -> Drawing {
    let (read, work) = read(body);
    assert!(work <= most * 1_000_000, "{work} units of work");
    match read {
        Ok(drawing) => drawing,
        Err(error) => panic!("{error}"),
    }
}

/// Reads what must be refused for `reason`, and take no more than so many millions of units.
fn refuses(body: &str, most: u64, reason: &str) {
    let (read, work) = read(body);
    let message = read.map_or_else(|error| error.to_string(), |_| "it was read".to_owned());
    assert!(message.contains(reason) && message.contains("h.svg"), "{message}");
    assert!(message.len() < 400, "{message}");
    assert!(work <= most * 1_000_000, "{work} units of work: {message}");
}

fn times(n: usize, what: impl Fn(usize) -> String) -> String {
    (0..n).map(what).collect()
}

fn warned(drawing: &Drawing, of: &str) -> bool {
    drawing.warnings.iter().any(|w| w.message.contains(of))
}

/// A place on a raster of 200 columns.
fn place(k: usize) -> (usize, usize) {
    (k % 200, k / 200 % 200)
}

#[test]
fn fifty_thousand_closes_are_one() {
    for closes in ["z".repeat(MANY), "Z ".repeat(MANY), "z\n\tZ".repeat(MANY)] {
        let drawing = reads(&format!("{}<path d='M0 0h9v9{closes}'/>", dots("")), 100);
        assert_eq!(drawing.exemplar.elements.len(), 65);
        assert!(drawing.fragments.iter().all(|f| f.markup.len() < 200));
    }
    reads(&format!("{}<path d='{}'/>", dots(""), "M0 0z ".repeat(MANY)), 500);
}

#[test]
fn deep_groups_and_chains_of_references_are_refused() {
    refuses(&format!("{}{}{}", "<g>".repeat(MANY), dots(""), "</g>".repeat(MANY)), 1, "nested XML elements");
    let chain = times(MANY, |k| format!("<use id='u{}' href='#u{k}'/>", k + 1));
    let chained = format!("<defs><circle id='u0' r='5'/>{chain}</defs><use href='#u{MANY}'/>");
    refuses(&chained, 10, "nested groups, <use> resolved");
    let patterns =
        times(MANY, |k| format!("<pattern id='p{k}' width='9' height='9'><rect fill='url(#p{})'/></pattern>", k + 1));
    refuses(&format!("{patterns}{}", dots("fill='url(#p0)'")), 500, "in a chain");
}

#[test]
fn definitions_that_multiply_are_refused() {
    let uses = times(9, |k| format!("<g id='u{}'>{}</g>", k + 1, format!("<use href='#u{k}'/>").repeat(10)));
    let pattern = "<pattern id='p' width='9' height='9'><use href='#u9'/></pattern>";
    let bomb = format!("<defs><circle id='u0' r='5'/>{uses}{pattern}</defs>{}", dots("fill='url(#p)'"));
    refuses(&bomb, 100, "nodes of a definition");
    let patterns = times(9, |k| {
        let inner = format!("<rect width='5' height='5' fill='url(#p{})'/>", k + 1).repeat(10);
        format!("<pattern id='p{k}' width='9' height='9'>{inner}</pattern>")
    });
    refuses(&format!("{patterns}{}", dots("fill='url(#p0)'")), 100, "nodes of a definition");
}

#[test]
fn cycles_are_called_cycles() {
    let clip = "<clipPath id='c' clip-path='url(#c)'><rect width='200' height='200'/></clipPath>";
    assert!(warned(&reads(&format!("{clip}{}", dots("clip-path='url(#c)'")), 300), "cycle"));
    let gradient = "<linearGradient id='a' href='#b'/><linearGradient id='b' href='#a'/>";
    assert!(warned(&reads(&format!("{gradient}{}", dots("fill='url(#a)'")), 300), "cycle"));
    assert!(warned(&reads(&format!("<g id='g'><use href='#g'/>{}</g>", dots("")), 300), "cycle"));
    let pattern = "<pattern id='p' width='9' height='9'><rect width='5' height='5' fill='url(#p)'/></pattern>";
    reads(&format!("{pattern}{}", dots("fill='url(#p)'")), 300);
}

#[test]
fn numbers_out_of_range_are_shown_with_their_element() {
    let cases = [
        ("<circle id='a' r='1e155'/>", "r=\"1e155\", expected a number between"),
        ("<ellipse id='a' rx='1e200' ry='1e-200'/>", "rx=\"1e200\""),
        ("<rect id='a' width='1e20mm' height='1'/>", "width=\"1e20mm\""),
        ("<path id='a' d='M0 0A1e155 5 0 0 1 9 9'/>", "1e155"),
        ("<path id='a' d='M0 0L1e18 4'/>", "a coordinate is 1e18"),
        ("<path id='a' d='M0 0A1e14 1e14 0 0 1 1e-9 0'/>", "a radius of 1e14"),
        ("<rect id='a' width='9' height='9' stroke='red' stroke-width='1e12'/>", "a coordinate beyond 1e9"),
        ("<rect id='a' width='9' height='9' transform='scale(1e300) scale(1e300)'/>", "a coordinate beyond"),
        ("<g transform='scale(1e80)'><rect id='a' width='9' height='9' transform='scale(1e80)'/></g>", "1e9"),
    ];
    for (shape, reason) in cases {
        let (read, work) = read(&format!("{}\n{shape}", dots("")));
        let message = read.unwrap_err().to_string();
        assert!(message.starts_with("h.svg:2: <") && message.contains("id=\"a\""), "{message}");
        assert!(message.contains(reason) && work < 50_000_000, "{message}");
    }
}

#[test]
fn arcs_that_end_where_they_start_are_refused_in_thousands() {
    let arcs = "A1e5 1e5 0 0 1 1e-8 0A1e5 1e5 0 0 1 0 0".repeat(MANY);
    refuses(&format!("{}<path d='M0 0{arcs}'/>", dots("")), 100, "arcs end where they start");
    let few = "a9 9 0 0 1 1 1a9 9 0 0 1-1 1".repeat(2000);
    reads(&format!("{}<path d='M0 0{few}'/>", dots("")), 3000);
}

#[test]
fn style_sheets_of_any_size_are_read_or_refused() {
    let circles = times(MANY, |k| {
        let (x, y) = place(k);
        format!("<circle class='c{k}' cx='{x}' cy='{y}' r='.3'/>")
    });
    let rules = times(MANY, |k| format!(".a{k} path.b{k},circle[r='{k}']{{fill:#123}}"));
    refuses(&format!("<style>{rules}</style>{circles}"), 20_000, "style rules");
    let selectors =
        [vec!["circle"; MANY].join("+"), vec!["g"; MANY].join(" "), format!("g >{}a", "/**/ ".repeat(MANY))];
    for selector in selectors {
        reads(&format!("<style>{selector}{{fill:red}}</style>{}", dots("")), 500);
    }
    reads(&format!("<style>{}</style>{}", "a{b:}".repeat(200_000), dots("")), 500);
    reads(&format!("<path d='M0 0h9v9z' style='{}'/>{}", "fill:red;".repeat(MANY), dots("")), 300);
}

#[test]
fn what_would_be_written_again_and_again_is_bounded() {
    let uses = times(4000, |k| format!("<use href='#i' x='{}' y='{}'/>", place(k).0, place(k).1));
    let image = format!("<image id='i' width='9' height='9' href='data:image/png;base64,{}'/>", "A".repeat(1_000_000));
    refuses(&format!("<defs>{image}</defs>{uses}"), 1000, "--limit memory=");
    let named = format!("<g id='i' class='{}'><circle r='2'/></g>", "a".repeat(1_000_000));
    refuses(&format!("<defs>{named}</defs>{uses}"), 1000, "--limit memory=");
    let inherited = format!("<g color-interpolation='{}'>{}</g>", "a".repeat(1_000_000), dots(""));
    let drawing = reads(&inherited, 300);
    assert!(warned(&drawing, "style value") && drawing.fragments.iter().all(|f| f.markup.len() < 1000));
    let dashes = format!("<path d='M0 0H200' stroke='red' stroke-dasharray='{}'/>", "1 ".repeat(1_000_000));
    let drawing = reads(&format!("{}{dashes}", dots("")), 300);
    assert!(drawing.strokes.iter().flatten().all(|stroke| stroke.dashes.is_empty()));
}

#[test]
fn fifty_thousand_stops_are_averaged_once() {
    let stops = "<stop offset='0' stop-color='red'/>".repeat(MANY);
    let own = times(500, |k| format!("<linearGradient id='g{k}' href='#g'/>"));
    let dots = times(500, |k| format!("<circle cx='{}' cy='{}' r='2' fill='url(#g{k})'/>", k % 25 * 8, k / 25 * 8));
    let body = format!("<linearGradient id='g'>{stops}</linearGradient>{own}{dots}");
    let budget = Budget::new(Limits { memory: 1 << 27, ..Limits::default() });
    let options = ReadOptions { budget, ..ReadOptions::new("h.svg") };
    let error = read_exemplar(&document(&body), &options).unwrap_err().to_string();
    assert!(error.contains("--limit memory="), "every gradient is written with its stops: {error}");
    assert!(options.budget.work() < 5_000_000_000, "{}", options.budget.work());
}

#[test]
fn fifty_thousand_elements_take_their_share() {
    let circles = |attributes: &str| {
        times(MANY, |k| format!("<circle cx='{}' cy='{}' r='.3' {attributes}/>", place(k).0, place(k).1))
    };
    // The last ten thousand lie exactly on others.
    assert_eq!(reads(&circles(""), 6000).exemplar.elements.len(), MANY - 10_000);
    let off = times(MANY, |k| format!("<circle cx='{}' cy='1e6' r='3'/>", k * 1000));
    let drawing = reads(&format!("{}{off}", dots("")), 6000);
    assert!(drawing.exemplar.elements.len() == 64 && warned(&drawing, "beyond the frame"));
    let none = "<circle cx='4' cy='4' r='0'/><path d='M5 5h0'/>".repeat(MANY / 2);
    assert_eq!(reads(&format!("{}{none}", dots("")), 2000).exemplar.elements.len(), 64);
    let pieces = times(10_000, |k| format!("M{} {}h.4v.4z", place(k).0, place(k).1));
    assert_eq!(reads(&format!("<path d='{pieces}'/>"), 10_000).exemplar.elements.len(), 10_000);
}

#[test]
fn fifty_thousand_lines_at_one_place_draw_on_the_budget() {
    let circles = times(3000, |k| {
        format!("<circle cx='100' cy='100' r='{}' fill='none' stroke='red' stroke-width='.01'/>", 0.03 * (k + 1) as f64)
    });
    let drawing = reads(&format!("{circles}<path d='M0 0L200 200' stroke='red'/>"), 20_000);
    assert_eq!(drawing.exemplar.curves.len(), 3001);
    let bent = times(3000, |k| format!("<path d='M0 0L{} 200L200 {}' fill='none' stroke='red'/>", k / 20, k % 190));
    let (_, work) = read(&bent);
    assert!(work > 3000 * 1000, "{work}");
}

#[test]
fn outlines_that_cross_themselves_too_often_are_refused() {
    let corner = |k: usize| format!("{},{} ", k * 7919 % 200, k * 104_729 % 199);
    let scribble = format!("<polygon id='d' points='{}'/>", times(6000, corner));
    refuses(&format!("{scribble}{}", dots("")), 2000, "--limit crossings=");
    let options = ReadOptions::new("h.svg");
    let error = read_shape(&document(&scribble), None, &options).unwrap_err().to_string();
    assert!(error.starts_with("h.svg: places where edges of outlines cross"), "{error}");
    let raised = ReadOptions {
        budget: Budget::new(Limits { crossings: 100, ..Limits::default() }),
        ..ReadOptions::new("h.svg")
    };
    let star = "<path id='d' d='M100 0L160 190L5 70H195L40 190z'/>";
    assert!(read_shape(&document(star), None, &raised).is_ok());
}

#[test]
fn combs_spirals_and_nested_rings_are_shapes() {
    let shape = |path: &str| {
        let options = ReadOptions::new("h.svg");
        let read = read_shape(&document(&format!("<path fill-rule='evenodd' d='{path}'/>")), None, &options);
        assert!(options.budget.work() < 5_000_000_000, "{}", options.budget.work());
        read.unwrap().0.outline().clone()
    };
    let comb = format!("M0 0{}V201z", times(10_000, |_| "v200h.01v-200h.01".to_owned()));
    assert!(shape(&comb).points().count() > 20_000);
    let nested = times(4900, |k| {
        let (a, b) = (0.02 * k as f64, 200.0 - 0.02 * k as f64);
        format!("M{a} {a}H{b}V{b}H{a}z")
    });
    assert_eq!(shape(&nested).rings.len(), 4900);
    let pile = times(20_000, |k| format!("M{} {}h100v100h-100z", k * 7919 % 101, k * 104_729 % 103));
    let options = ReadOptions::new("h.svg");
    let (pile, _) = read_shape(&document(&format!("<path d='{pile}'/>")), None, &options).unwrap();
    let all = vec![Vector::xy(0.0, 0.0), Vector::xy(200.0, 0.0), Vector::xy(200.0, 202.0), Vector::xy(0.0, 202.0)];
    let all = Outline::try_union(&[all], FillRule::NonZero, &options.budget).unwrap();
    assert!((pile.outline().area() - all.area()).abs() < 0.1 * all.area(), "{}", pile.outline().area());
}

#[test]
fn a_stop_is_heard_at_every_check_of_reading() {
    let text = document(&format!("<style>circle{{stroke:red}}</style>{}<path d='M0 0h9v9z M20 20h5v5z'/>", dots("")));
    let counting = Budget::stopping_at(Limits::default(), u64::MAX);
    let options = |budget: &Budget| ReadOptions { budget: budget.clone(), ..ReadOptions::new("h.svg") };
    read_exemplar(&text, &options(&counting)).unwrap();
    let all = counting.checks();
    assert!(all > 100, "{all}");
    for n in (1..=all).step_by(7) {
        let stopped = read_exemplar(&text, &options(&Budget::stopping_at(Limits::default(), n)));
        assert!(matches!(stopped, Err(Error::Stopped { .. })), "{n} of {all}");
    }
}
