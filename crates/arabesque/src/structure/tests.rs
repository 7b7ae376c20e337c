//! Structures through the door.

use std::ops::ControlFlow;

use arabesque_core::{Progress, Unobserved, Vector};

use super::*;
use crate::{Format, Geometry, Input, OutputOptions, Recipe, Resources, recipe_in};

/// A square lattice of points in the plane, 0.1 apart, on the unit square.
fn lattice() -> String {
    let rows = (0..100).map(|k| format!("{},{}\n", 0.05 + 0.1 * f64::from(k % 10), 0.05 + 0.1 * f64::from(k / 10)));
    format!("x,y\n{}", rows.collect::<String>())
}

/// A screw along x, of length 1.
fn screw() -> String {
    let rows = (0..160).map(|k| {
        let x = (f64::from(k) + 0.5) / 160.0;
        let (sin, cos) = (8.0 * std::f64::consts::TAU * x).sin_cos();
        format!("{x},{},{}\n", 0.08 * cos, 0.08 * sin)
    });
    format!("x,y,z\n{}", rows.collect::<String>())
}

fn run(name: &str, text: &str, job: Structures) -> Result<Artwork> {
    let prepared = Recipe::new(Input::file(name).embedding(text.as_bytes()), job).prepare(&Resources::default())?;
    prepared.run(&prepared.request(), &mut Unobserved)
}

#[test]
fn points_in_the_plane_fill_a_page_and_the_recipe_repeats_it() {
    let job = Structures { size: Some("1.6x1.2".parse().unwrap()), ..Structures::default() };
    let artwork = run("grid.csv", &lattice(), job).unwrap();
    let count = artwork.summary().points;
    assert!((150..240).contains(&count), "{count}");
    for format in [Format::Csv, Format::Json, Format::Ply] {
        let bytes = artwork.encode(&OutputOptions { format: Some(format), ..OutputOptions::default() }).unwrap().bytes;
        let again = recipe_in(&format!("grid-out.{}", format.name()), &bytes).unwrap();
        assert!(matches!(again.job, Job::Structures(_)));
        let prepared = again.prepare(&Resources::default()).unwrap();
        let other = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
        assert_eq!(other.encode(&again.output).unwrap().bytes, bytes, "{}", format.name());
    }
}

#[test]
fn points_in_space_follow_a_curve() {
    let curve = Input::file("c.obj").embedding(b"v 0 0 0\nv 0.8 0.1 0\nv 1.5 0.6 0.2\nv 2 1.4 0\nl 1 2 3 4\n");
    let artwork = run("screw.csv", &screw(), Structures::along(curve)).unwrap();
    assert!((300..520).contains(&artwork.summary().points), "{}", artwork.summary().points);
    let Geometry::SpacePoints(points) = artwork.geometry() else { panic!("points in space") };
    assert!(points.bounds().size()[1] > 1.2);
}

#[test]
fn places_that_do_not_suit_are_refused() {
    let told = |name: &str, text: &str, job: Structures| run(name, text, job).unwrap_err().to_string();
    assert!(told("grid.csv", &lattice(), Structures::default()).contains("one of size"));
    let both = Structures { size: Some("1x1".parse().unwrap()), ..Structures::boxed("1x1x1".parse().unwrap()) };
    assert!(told("grid.csv", &lattice(), both).contains("size and box"));
    assert!(told("grid.csv", &lattice(), Structures::boxed("1x1x1".parse().unwrap())).contains("in space"));
    let millimetres = Structures { size: Some("10mmx10mm".parse().unwrap()), ..Structures::default() };
    assert!(told("grid.csv", &lattice(), millimetres).contains("no unit of length"));
    assert!(
        told(
            "few.csv",
            "x,y\n0,0\n1,0\n0,1\n",
            Structures { size: Some("9x9".parse().unwrap()), ..Structures::default() }
        )
        .contains("few.csv")
    );
}

/// A sheet of low waves along x and y, 12 points to a side of 1.
fn sheet() -> String {
    let rows = (0..144).map(|k| {
        let (x, y) = ((f64::from(k % 12) + 0.5) / 12.0, (f64::from(k / 12) + 0.5) / 12.0);
        format!("{x},{y},{}\n", 0.02 * (12.0 * x).sin() * (12.0 * y).cos())
    });
    format!("x,y,z\n{}", rows.collect::<String>())
}

#[test]
fn a_tile_of_a_sheet_closes_sideways_and_stays_a_sheet() {
    let job = Structures { tile: Some("1x1".parse().unwrap()), ..Structures::default() };
    let Geometry::SpacePoints(points) = run("sheet.csv", &sheet(), job).unwrap().geometry() else { panic!("points") };
    let all = &points.positions;
    assert!((115..=175).contains(&all.len()), "{}", all.len());
    assert!(all.iter().all(|p| (0.0..=1.0).contains(&p[0]) && (0.0..=1.0).contains(&p[1]) && p[2].abs() < 0.06));
    // Across the seams points have neighbours as near as elsewhere.
    let nearest = |p: Vector<3>| {
        let others = all.iter().filter(|q| **q != p).map(|q| {
            let wrapped = |d: f64| d - d.round();
            wrapped(q[0] - p[0]).hypot(wrapped(q[1] - p[1])).hypot(q[2] - p[2])
        });
        others.fold(f64::INFINITY, f64::min)
    };
    let at_seam = |p: &&Vector<3>| (0..2).any(|k| p[k] < 0.05 || p[k] > 0.95);
    let far: Vec<f64> = all.iter().filter(at_seam).map(|p| nearest(*p)).collect();
    let mean = far.iter().sum::<f64>() / far.len() as f64;
    assert!(far.len() > 20 && (mean * 12.0 - 1.0).abs() < 0.25, "{mean} of {}", far.len());
}

/// Asks to stop at a step.
struct StopAt(usize);

impl Watch<Artwork> for StopAt {
    fn step(&mut self, _: &Progress, _: &dyn Fn() -> Artwork) -> ControlFlow<()> {
        self.0 -= 1;
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_stop_with_a_mesh_leaves_the_points_of_the_best_so_far() {
    let job = Structures { size: Some("1.2x1".parse().unwrap()), mesh: true, ..Structures::default() };
    let recipe = Recipe::new(Input::file("sheet.csv").embedding(sheet().as_bytes()), job);
    let prepared = recipe.prepare(&Resources::default()).unwrap();
    let artwork = prepared.run(&prepared.request(), &mut StopAt(2)).unwrap();
    assert_eq!(artwork.stopped(), StopReason::Stopped);
    assert!(artwork.summary().points > 100 && artwork.summary().triangles == 0, "{:?}", artwork.summary());
    assert!(artwork.warnings().iter().any(|w| w.message.contains("no time for the surface")));
    let options = OutputOptions { format: Some(Format::Glb), ..OutputOptions::default() };
    assert!(artwork.encode(&options).unwrap().bytes.starts_with(b"glTF"));
}
