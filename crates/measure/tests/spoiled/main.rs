//! True pages of patterns of our own are told from spoiled ones, and what spoiled them is named.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

mod drawing;

use arabesque_core::{Bounds, Budget, Domain, Error, Exemplar, Limits, Stage, Stream, Vector};
use arabesque_measure::{Family, Fault, Options, Report, Subject, Verdict, measure};
use drawing::{LARGE, SMALL, Spoil, drawn, net, spoiled, stroked, tossed};

fn told(exemplar: &Exemplar<2>, content: &Exemplar<2>) -> Report {
    let subject = Subject { content, domain: Domain::Box(content.window), sources: &[] };
    measure("page", exemplar, &subject, Options::default(), &Budget::default()).unwrap()
}

fn fault(report: &Report, family: Family) -> f64 {
    report.families.iter().find(|f| f.family == family).map_or(0.0, |f| f.fault)
}

fn has(report: &Report, fault: Fault) -> bool {
    report.marks.iter().any(|m| m.fault == fault)
}

#[test]
fn spoiled_pages_of_things_are_worse_than_true_ones_and_say_why() {
    for seed in [1, 2] {
        let small = tossed(seed, SMALL);
        let large = tossed(seed + 100, LARGE);
        let exemplar = drawn(&small, SMALL);
        let truth = told(&exemplar, &drawn(&large, LARGE));
        assert!(truth.verdict != Verdict::Bad && truth.fault < 0.35, "{seed}: {truth:#?}");
        let expected = [
            (Spoil::Holes, Family::Evenness, Some(Fault::Hole)),
            (Spoil::Jitter, Family::Distances, Some(Fault::Overlap)),
            (Spoil::Overlap, Family::Overlaps, Some(Fault::Overlap)),
            (Spoil::Turned, Family::Elements, Some(Fault::Turned)),
            (Spoil::Pasted, Family::Copies, Some(Fault::Copy)),
        ];
        for (how, family, mark) in expected {
            let report = told(&exemplar, &drawn(&spoiled(&large, &small, how), LARGE));
            assert!(report.fault > truth.fault + 0.15, "{seed}, {how:?}: {} after {}", report.fault, truth.fault);
            assert!(fault(&report, family) > 0.5, "{seed}, {how:?}: {:?}", report.families);
            assert!(mark.is_none_or(|mark| has(&report, mark)), "{seed}, {how:?}: {:?}", report.marks);
        }
    }
}

#[test]
fn the_same_page_is_at_most_a_copy() {
    let exemplar = drawn(&tossed(1, SMALL), SMALL);
    let report = told(&exemplar, &exemplar);
    for measure in report.measures.iter().filter(|m| m.family != Family::Copies) {
        assert!(measure.fault < 0.1, "{measure:?}");
    }
    assert!(fault(&report, Family::Copies) > 0.4);
}

#[test]
fn sources_that_a_result_states_are_believed_only_where_outlines_agree() {
    let small = tossed(1, SMALL);
    let exemplar = drawn(&small, SMALL);
    let content = drawn(&tossed(101, LARGE), LARGE);
    let flag = exemplar.elements.iter().position(|e| e.class == 0);
    // Everything says that it is a copy of one flag; discs do not look like one.
    let sources = vec![flag; content.elements.len()];
    let subject = Subject { content: &content, domain: Domain::Box(content.window), sources: &sources };
    let report = measure("page", &exemplar, &subject, Options::default(), &Budget::default()).unwrap();
    assert!(fault(&report, Family::Density) < 0.5 && fault(&report, Family::Elements) < 0.5, "{:?}", report.families);
}

#[test]
fn spoiled_nets_have_loose_ends() {
    let exemplar = stroked(&net(1, SMALL), SMALL);
    let edges = net(7, LARGE);
    let truth = told(&exemplar, &stroked(&edges, LARGE));
    assert!(truth.fault < 0.35, "{truth:#?}");
    let hole = |e: &&[Vector<2>; 2]| (e[0] - Vector::xy(300.0, 250.0)).norm() > 60.0;
    let holes = told(&exemplar, &stroked(&edges.iter().filter(hole).copied().collect::<Vec<_>>(), LARGE));
    assert!(fault(&holes, Family::Evenness) > 0.5 && has(&holes, Fault::Hole), "{:?}", holes.families);
    let mut random = Stream::new(3, Stage::TEST, 0);
    let mut moved = |p: Vector<2>, by: Vector<2>| p + by * random.range(0.0, 1.0);
    let shaken: Vec<_> = edges.iter().map(|e| e.map(|p| moved(p, Vector::xy(6.0, -5.0)))).collect();
    let shaken = told(&exemplar, &stroked(&shaken, LARGE));
    assert!(fault(&shaken, Family::Strokes) > 0.5, "{:?}", shaken.families);
}

#[test]
fn points_are_measured_in_the_plane_and_in_space() {
    let cloud = |seed: u64, side: f64, count: usize| -> Vec<Vector<3>> {
        let mut random = Stream::new(seed, Stage::TEST, 0);
        let mut points: Vec<Vector<3>> = Vec::new();
        while points.len() < count {
            let p = Vector(std::array::from_fn(|_| random.range(0.0, side)));
            if points.iter().all(|q| (p - *q).norm() > 0.7) {
                points.push(p);
            }
        }
        points
    };
    let scene = |points: &[Vector<3>], side: f64| {
        let mut scene = Exemplar::from_points("t", points, &vec![0; points.len()], &["a".into()]).unwrap();
        scene.window = Bounds::new(Vector::ZERO, Vector::splat(side));
        scene
    };
    let own = scene(&cloud(1, 6.0, 220), 6.0);
    let large = cloud(2, 9.0, 740);
    let report = |points: &[Vector<3>]| {
        let content = scene(points, 9.0);
        let subject = Subject { content: &content, domain: Domain::Box(content.window), sources: &[] };
        measure("page", &own, &subject, Options::default(), &Budget::default()).unwrap()
    };
    let truth = report(&large);
    let middle = Vector::splat(4.5);
    let hole: Vec<_> = large.iter().filter(|p| (**p - middle).norm() > 2.2).copied().collect();
    let holes = report(&hole);
    assert!(truth.fault < 0.4 && holes.fault > truth.fault + 0.1, "{} {}", truth.fault, holes.fault);
    assert!(has(&holes, Fault::Hole) && !has(&truth, Fault::Hole));
}

#[test]
fn any_number_of_threads_tells_the_same() {
    let exemplar = drawn(&tossed(1, SMALL), SMALL);
    let page = drawn(&spoiled(&tossed(101, LARGE), &tossed(1, SMALL), Spoil::Jitter), LARGE);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let budget = Budget::default();
        let subject = Subject { content: &page, domain: Domain::Box(page.window), sources: &[] };
        let report = pool.install(|| measure("page", &exemplar, &subject, Options::default(), &budget).unwrap());
        (format!("{report:?}"), budget.work())
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn limits_and_small_pages_are_told() {
    let exemplar = drawn(&tossed(1, SMALL), SMALL);
    let subject = |side: f64| Subject {
        content: &exemplar,
        domain: Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side))),
        sources: &[],
    };
    let told = |side: f64, budget: &Budget| measure("p.svg", &exemplar, &subject(side), Options::default(), budget);
    let small = told(20.0, &Budget::default()).unwrap_err().to_string();
    assert!(small.starts_with("p.svg: 20 across"), "{small}");
    let budget = Budget::new(Limits { work: 1, ..Limits::default() });
    assert!(matches!(told(SMALL, &budget), Err(Error::Limit { what, .. }) if what == "measuring"));
    let stopped = Budget::stopping_at(Limits::default(), 20);
    assert!(matches!(told(SMALL, &stopped), Err(Error::Stopped { .. })));
}
