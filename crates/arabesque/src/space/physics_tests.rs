//! Small heaps of dice.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use arabesque_core::{Budget, Similarity, TriangleMesh, Unobserved, Vector};
use arabesque_io::mesh::gltf::{Scene, SceneMesh, SceneNode, read_scene, write_scene};

use crate::{Artwork, Border, Format, Input, OutputOptions, Physics, Recipe, Resources, Space, in_pool, recipe_in};

/// A cube of side 1 around the origin.
fn cube(height: f64) -> TriangleMesh {
    let corner = |k: u32| Vector([0, 1, 2].map(|a| (f64::from(k >> a & 1) - 0.5) * if a == 1 { height } else { 1.0 }));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    TriangleMesh { positions: (0..8).map(corner).collect(), triangles, ..TriangleMesh::default() }
}

/// Dice in two layers with gaps between them, on a floor at height 0.
fn dice(height: f64) -> Vec<u8> {
    let node = |k: u32| SceneNode {
        name: format!("die {k}"),
        mesh: 0,
        transform: Similarity::shift(Vector([
            f64::from(k % 4) * 1.3 + 0.05 * f64::from(k % 3),
            0.5 + 1.15 * f64::from(k / 16),
            f64::from(k / 4 % 4) * 1.3 + 0.06 * f64::from(k % 5),
        ])),
        ..SceneNode::default()
    };
    let meshes = vec![SceneMesh::new("die", cube(height))];
    let scene =
        Scene { meshes, nodes: (0..32).map(node).collect(), ..Scene::of_points(arabesque_core::PointSet::default()) };
    write_scene(&scene, None, &Budget::default()).unwrap()
}

fn recipe(change: impl FnOnce(&mut Space)) -> Recipe {
    let mut job = Space { floor: true, ..Space::new("6x2.5x6".parse().unwrap()) };
    job.params.set.insert("iterations".into(), "3".into());
    change(&mut job);
    Recipe::new(Input::file("dice.glb").embedding(&dice(1.0)), job)
}

fn run(recipe: &Recipe) -> crate::Result<Artwork> {
    let prepared = recipe.prepare(&Resources::default())?;
    prepared.run(&prepared.request(), &mut Unobserved)
}

fn bytes(artwork: &Artwork) -> Vec<u8> {
    artwork.encode(&OutputOptions { format: Some(Format::Glb), ..OutputOptions::default() }).unwrap().bytes
}

#[test]
fn dice_come_to_lie_on_the_floor_and_on_one_another_and_the_recipe_repeats_it() {
    for physics in [Physics::Settle, Physics::default()] {
        let artwork = run(&recipe(|job| job.physics = Some(physics))).unwrap();
        let told = artwork.summary().physics.unwrap();
        assert!(told.steps > 0 && told.floating <= told.floating_before, "{physics}: {told:?}");
        assert!(
            told.deepest < told.deepest_before.max(0.03) && told.overlaps <= told.overlaps_before,
            "{physics}: {told:?}"
        );
        let file = bytes(&artwork);
        let scene = read_scene("out.glb", &file, &Budget::default()).unwrap();
        // 16 stand on 26 square units, so that about 21 do here, and as many lie on them.
        assert!((32..56).contains(&scene.nodes.len()), "{}", scene.nodes.len());
        let lowest = scene.nodes.iter().map(|n| n.transform.translation[1]).fold(f64::INFINITY, f64::min);
        assert!((0.45..0.6).contains(&lowest), "{lowest}");
        let again = recipe_in("out.glb", &file).unwrap();
        assert!(matches!(&again.job, crate::Job::Space(job) if job.physics == Some(physics)));
        assert_eq!(bytes(&run(&again).unwrap()), file);
    }
}

#[test]
fn the_bytes_are_the_same_for_any_number_of_threads() {
    let made = |threads| {
        in_pool(Some(threads), || bytes(&run(&recipe(|job| job.physics = Some(Physics::default()))).unwrap()))
    };
    assert_eq!(made(1).unwrap(), made(3).unwrap());
}

#[test]
fn walls_hold_dice_in_a_box_with_border_inside_and_gravity_may_go_anywhere() {
    let artwork = run(&recipe(|job| {
        job.physics = Some(Physics::Settle);
        job.border = Some(Border::Inside);
        job.gravity = Some([1.0, 0.0, 0.0]);
        job.friction = Some(0.0);
    }))
    .unwrap();
    let scene = read_scene("out.glb", &bytes(&artwork), &Budget::default()).unwrap();
    let largest = scene.nodes.iter().map(|n| n.transform.translation[0]).fold(0.0, f64::max);
    assert!((5.4..5.55).contains(&largest), "{largest}");
    assert_eq!(artwork.summary().physics.unwrap().floating, 0);
}

#[test]
fn what_physics_cannot_do_is_refused() {
    let error = |change: fn(&mut Space)| run(&recipe(change)).unwrap_err().to_string();
    assert!(error(|job| job.friction = Some(0.1)).contains("friction"));
    assert!(error(|job| job.gravity = Some([0.0; 3])).contains("without physics"));
    let with = |job: &mut Space| job.physics = Some(Physics::Settle);
    let too_strong = run(&recipe(|job| (with(job), job.gravity = Some([0.0, -1e9, 0.0])).0)).unwrap_err().to_string();
    assert!(too_strong.contains("no longer than 10"), "{too_strong}");
    let slippery = run(&recipe(|job| (with(job), job.friction = Some(-1.0)).0)).unwrap_err().to_string();
    assert!(slippery.contains("friction"), "{slippery}");
    let mut flat = recipe(with);
    flat.exemplar = Input::file("dice.glb").embedding(&dice(0.0));
    assert!(run(&flat).unwrap_err().to_string().contains("flat"));
    let points: String = (0..64).map(|k| format!("{},{},{}\n", k % 4, k / 4 % 4, k / 16)).collect();
    let job = Space { physics: Some(Physics::Settle), ..Space::new("5x5x5".parse().unwrap()) };
    let recipe = Recipe::new(Input::file("p.csv").embedding(("x,y,z\n".to_owned() + &points).as_bytes()), job);
    assert!(run(&recipe).unwrap_err().to_string().contains("physics for points and curves"));
}

/// Boards on a wall at two heights, three crates on each, and the same on the floor.
fn shelves() -> Vec<u8> {
    let sized = |size: [f64; 3]| {
        let mut mesh = cube(1.0);
        mesh.positions.iter_mut().for_each(|p| *p = Vector([0, 1, 2].map(|a| p[a] * size[a])));
        mesh
    };
    let mut nodes = Vec::new();
    let mut node = |mesh: usize, at: [f64; 3]| {
        let name = format!("{} {}", ["board", "crate"][mesh], nodes.len());
        nodes.push(SceneNode { name, mesh, transform: Similarity::shift(Vector(at)), ..SceneNode::default() });
    };
    for k in 0..18_u32 {
        let at = [k % 3, k / 3 % 3, k / 9].map(f64::from);
        let (x, y, z) = (3.2 * at[0] + 1.6, 1.8 * at[1] + 0.05, 2.5 * at[2] + 0.6);
        node(0, [x, y, z]);
        for n in 0..3_u32 {
            let shaken = 0.05 * f64::from((k + n) % 3);
            node(1, [x + 0.9 * (f64::from(n) - 1.0) + shaken, y + 0.35, z + shaken]);
        }
    }
    let meshes = vec![SceneMesh::new("board", sized([3.0, 0.1, 1.0])), SceneMesh::new("crate", sized([0.6; 3]))];
    let scene = Scene { meshes, nodes, ..Scene::of_points(arabesque_core::PointSet::default()) };
    write_scene(&scene, None, &Budget::default()).unwrap()
}

#[test]
fn boards_that_hang_stay_and_every_crate_stands_on_one() {
    let mut job = Space { floor: true, ..Space::new("13x5.4x9".parse().unwrap()) };
    job.physics = Some(Physics::default());
    let artwork = run(&Recipe::new(Input::file("shelves.glb").embedding(&shelves()), job)).unwrap();
    assert_eq!(artwork.summary().physics.unwrap().floating, 0);
    let scene = read_scene("out.glb", &bytes(&artwork), &Budget::default()).unwrap();
    let places = |mesh: &str| {
        let shown = scene.nodes.iter().filter(|n| scene.meshes[n.mesh].name == mesh);
        shown.map(|n| n.transform.translation).collect::<Vec<_>>()
    };
    let (boards, crates) = (places("board"), places("crate"));
    assert!(boards.len() > 20 && crates.len() == 3 * boards.len(), "{} {}", boards.len(), crates.len());
    for place in crates {
        let stands = |board: &Vector<3>| {
            let off = place - *board;
            (off[1] - 0.35).abs() < 0.02 && off[0].abs() < 1.4 && off[2].abs() < 0.5
        };
        assert!(boards.iter().any(stands), "{place:?}");
    }
}
