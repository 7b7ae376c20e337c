//! One door for every method: what is prepared serves any number of requests, in any thread, and is never consumed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::{ops::ControlFlow, path::Path, thread};

use arabesque::{
    Artwork, Error, Fill, Format, Geometry, Input, Job, Limits, OutputOptions, Prepared, Progress, Recipe, Redo,
    Region, Request, Resources, Ribbon, Space, StopReason, Surface, Unobserved, Watch,
};

fn folder() -> Resources {
    Resources::beside(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recipes"))
}

fn leaves(job: impl Into<Job>) -> Recipe {
    Recipe::new(Input::file("leaves.svg"), job)
}

fn bytes(artwork: &Artwork) -> Vec<u8> {
    artwork.encode(&OutputOptions::default()).unwrap().bytes
}

fn run(prepared: &Prepared, request: &Request) -> Artwork {
    prepared.run(request, &mut Unobserved).unwrap()
}

#[test]
fn one_prepared_exemplar_serves_many_domains_and_seeds() {
    let pages = [
        Fill::page("120x90".parse().unwrap()),
        Fill { tile: Some("90x100".parse().unwrap()), ..Fill::default() },
        Fill { domain: Some(Input::shape("ring.svg#ring")), avoid: vec![], ..Fill::default() },
    ];
    let prepared = leaves(Fill::default()).prepare(&folder()).unwrap();
    for (page, seed) in pages.into_iter().zip([3, 4, 5]) {
        let request = Request::new(page.clone()).with_seed(seed);
        let shared = bytes(&run(&prepared, &request));
        let whole = Recipe { seed, ..leaves(page) }.prepare(&folder()).unwrap();
        assert_eq!(bytes(&run(&whole, &whole.request())), shared);
        assert_eq!(bytes(&run(&prepared, &request)), shared, "the same request once more");
    }
}

#[test]
fn fields_kept_and_avoided_things_belong_to_the_request() {
    let prepared = leaves(Fill::default()).prepare(&folder()).unwrap();
    let plain = Fill::page("100x100".parse().unwrap());
    let scaled = Fill { scale: Some(arabesque::FieldSource::Constant(0.8)), ..plain.clone() };
    let avoiding =
        Fill { avoid: vec![Input::file("ring.svg")], size: Some("160x160".parse().unwrap()), ..Fill::default() };
    for fill in [plain, scaled, avoiding] {
        let whole = leaves(fill.clone()).prepare(&folder()).unwrap();
        assert_eq!(bytes(&run(&prepared, &Request::new(fill))), bytes(&run(&whole, &whole.request())));
    }
}

#[test]
fn a_request_cannot_change_what_was_prepared() {
    let prepared = leaves(Fill::page("50x50".parse().unwrap())).prepare(&folder()).unwrap();
    let mut other = Fill::page("50x50".parse().unwrap());
    other.params.set.insert("levels".into(), "1".into());
    let region = Redo::of(Region::Box([20.0, 20.0, 20.0, 20.0]));
    for request in [Request::new(other), Request::new(region), Request::new(Space::new("1x1x1".parse().unwrap()))] {
        let refused = prepared.run(&request, &mut Unobserved).unwrap_err();
        assert!(matches!(refused, Error::Parameter { .. }) && refused.to_string().contains("request"), "{refused}");
    }
}

#[test]
fn ribbons_follow_other_curves_without_being_prepared_again() {
    let recipe =
        Recipe::new(Input::file("strip.svg"), Ribbon { scale: Some(0.8), ..Ribbon::new(Input::file("curve.svg")) });
    let prepared = recipe.prepare(&folder()).unwrap();
    let straight = "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='60'><path d='M9 30H190'/></svg>";
    let mut request = prepared.request();
    let Job::Ribbon(ribbon) = &mut request.job else { panic!() };
    ribbon.along = Input::file("straight.svg").embedding(straight.as_bytes());
    let (wave, line) = (run(&prepared, &prepared.request()), run(&prepared, &request));
    assert_ne!(bytes(&wave), bytes(&line));
    let whole = Recipe { job: request.job, ..recipe }.prepare(&folder()).unwrap();
    assert_eq!(bytes(&run(&whole, &whole.request())), bytes(&line));
}

#[test]
fn prepared_recipes_and_artworks_are_shared_between_threads() {
    let prepared = leaves(Fill::page("60x60".parse().unwrap())).prepare(&folder()).unwrap();
    let here: Vec<_> = (0..4).map(|seed| bytes(&run(&prepared, &prepared.request().with_seed(seed)))).collect();
    let handles: Vec<_> = (0..4)
        .map(|seed| {
            let prepared = prepared.clone();
            thread::spawn(move || run(&prepared, &prepared.request().with_seed(seed)))
        })
        .collect();
    drop(prepared);
    let there: Vec<_> = handles.into_iter().map(|handle| bytes(&handle.join().unwrap())).collect();
    assert_eq!(here, there);
}

/// Keeps every preview of a run.
struct Keep(Vec<(Progress, Artwork)>);

impl Watch<Artwork> for Keep {
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Artwork) -> ControlFlow<()> {
        self.0.push((progress.clone(), preview()));
        ControlFlow::Continue(())
    }
}

/// Two balls of points with normals, apart, as two groups.
fn balls() -> String {
    let row = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k % 300) + 1.0) / 300.0;
        let (angle, r) = (2.4 * f64::from(k), (1.0 - z * z).sqrt());
        let (x, y) = (r * angle.cos(), r * angle.sin());
        format!("{},{y},{z},{x},{y},{z},{}\n", x + 3.0 * f64::from(k / 300), k / 300)
    };
    format!("x,y,z,nx,ny,nz,group\n{}", (0..600).map(row).collect::<String>())
}

#[test]
fn one_watch_draws_the_previews_of_every_method() {
    let cube: String = (0..64).map(|k| format!("{},{},{}\n", k % 4, k / 4 % 4, k / 16)).collect();
    let cube = Input::file("cube.csv").embedding(("x,y,z\n".to_owned() + &cube).as_bytes());
    let recipes = [
        leaves(Fill::page("100x80".parse().unwrap())),
        leaves(Redo::of(Region::Box([20.0, 20.0, 20.0, 20.0]))),
        Recipe::new(cube, Space::new("5x5x5".parse().unwrap())),
        Recipe::new(Input::file("strip.svg"), Ribbon { scale: Some(0.8), ..Ribbon::new(Input::file("curve.svg")) }),
        Recipe::new(Input::file("balls.csv").embedding(balls().as_bytes()), Surface::default()),
    ];
    for recipe in recipes {
        let mut keep = Keep(Vec::new());
        let prepared = recipe.prepare(&folder()).unwrap();
        prepared.run(&prepared.request(), &mut keep).unwrap();
        let (progress, preview) = keep.0.last().unwrap();
        assert!(progress.fraction > 0.5 && progress.done <= progress.total, "{progress}");
        assert_eq!(preview.stopped(), StopReason::Stopped);
        let placed = match preview.geometry() {
            Geometry::Plane(snapshot) => snapshot.placements.len() + snapshot.curves.len() + snapshot.patches.len(),
            Geometry::Space(snapshot) => snapshot.placements.len() + snapshot.curves.len() + snapshot.patches.len(),
            Geometry::Mesh(mesh) => mesh.triangles.len(),
            Geometry::PlanePoints(points) => points.len(),
            Geometry::SpacePoints(points) => points.len(),
        };
        assert!(placed > 0, "{progress}");
        assert_eq!(preview.points().len(), preview.summary().elements, "{progress}");
        let format = match recipe.job {
            Job::Space(_) => Format::Csv,
            Job::Surface(_) => Format::Ply,
            _ => Format::Svg,
        };
        let drawn = preview.encode(&OutputOptions { format: Some(format), bare: true, ..OutputOptions::default() });
        assert!(drawn.unwrap().bytes.len() > 100);
    }
}

#[test]
fn files_in_memory_are_not_looked_for_and_limits_reach_them() {
    let svg = std::fs::read(folder().base.unwrap().join("leaves.svg")).unwrap();
    let memory = Resources::default().with_input("nowhere/leaves.svg", svg);
    let recipe = Recipe::new(Input::file("nowhere/leaves.svg"), Fill::page("60x60".parse().unwrap()));
    let prepared = recipe.prepare(&memory).unwrap();
    assert!(run(&prepared, &prepared.request()).summary().elements > 4);
    let limits = |change: fn(&mut Limits)| {
        let mut limits = Limits::default();
        change(&mut limits);
        Resources { limits, ..memory.clone() }
    };
    let few = recipe.prepare(&limits(|l| l.elements = 3)).unwrap_err();
    assert!(matches!(few, Error::Limit { .. }), "{few}");
    let prepared = recipe.prepare(&limits(|l| l.output_elements = 3)).unwrap();
    assert!(matches!(prepared.run(&prepared.request(), &mut Unobserved), Err(Error::Limit { .. })));
    let prepared = recipe.prepare(&limits(|l| l.pixels = 10)).unwrap();
    let png = OutputOptions { format: Some(Format::Png), ..OutputOptions::default() };
    assert!(matches!(run(&prepared, &prepared.request()).encode(&png), Err(Error::Limit { .. })));
}

#[test]
fn the_job_that_was_prepared_is_accepted_as_it_was_written() {
    let region = Region::Shape(Input::shape("ring.svg#ring"));
    let redo = Redo { from: Some(Region::Box([0.0, 0.0, 60.0, 60.0])), ..Redo::of(region) };
    let recipe = leaves(redo);
    let prepared = recipe.prepare(&folder()).unwrap();
    let as_written = run(&prepared, &Request::new(recipe.job));
    assert_eq!(bytes(&as_written), bytes(&run(&prepared, &prepared.request())));
}

#[test]
fn a_request_is_checked_like_the_recipe() {
    let prepared = leaves(Redo::of(Region::Box([20.0, 20.0, 20.0, 20.0]))).prepare(&folder()).unwrap();
    let mut request = prepared.request();
    let Job::Redo(redo) = &mut request.job else { panic!() };
    redo.border = Some(arabesque::Border::Turn);
    assert!(matches!(prepared.run(&request, &mut Unobserved), Err(Error::Parameter { .. })));
    for region in [[f64::NAN; 4], [20.0, 20.0, f64::INFINITY, 5.0], [40.0, 40.0, -20.0, -20.0]] {
        let refused = leaves(Redo::of(Region::Box(region))).prepare(&folder());
        assert!(matches!(refused, Err(Error::Parameter { .. })), "{region:?}");
    }
}

#[test]
fn files_are_read_for_each_request() {
    let dir = tempfile::tempdir().unwrap();
    let square = |side: u32| {
        let page = "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='200' viewBox='0 0 200 200'>";
        std::fs::write(dir.path().join("d.svg"), format!("{page}<path d='M0 0h{side}v{side}h-{side}z'/></svg>"))
            .unwrap();
    };
    std::fs::copy(folder().base.unwrap().join("leaves.svg"), dir.path().join("leaves.svg")).unwrap();
    square(60);
    let recipe = leaves(Fill { domain: Some(Input::file("d.svg")), ..Fill::default() });
    let prepared = recipe.prepare(&Resources::beside(dir.path())).unwrap();
    let small = run(&prepared, &prepared.request()).summary().elements;
    square(120);
    assert!(run(&prepared, &prepared.request()).summary().elements > 2 * small);
}

#[test]
fn what_is_avoided_is_avoided_at_the_resolution_of_the_run() {
    let mut ribbon = Ribbon { scale: Some(0.8), relax: true, ..Ribbon::new(Input::file("curve.svg")) };
    let corner = "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='80'><path d='M0 0h4v4h-4z'/></svg>";
    ribbon.avoid = vec![Input::file("corner.svg").embedding(corner.as_bytes())];
    let prepared = Recipe::new(Input::file("strip.svg"), ribbon).prepare(&folder()).unwrap();
    let artwork = run(&prepared, &prepared.request());
    assert!(artwork.encode(&OutputOptions::default()).is_ok());
    let finer = OutputOptions { pixels_per_unit: Some(4.0), ..OutputOptions::default() };
    assert!(matches!(artwork.encode(&finer), Err(Error::Unsupported { .. })));
}
