//! The same bytes for any number of threads, and from any file that carries its recipe.

mod common;

use common::Folder;

#[test]
fn threads_do_not_change_the_bytes() {
    let folder = Folder::new();
    for (exemplar, place) in
        [("leaves.svg", "--size 200x150"), ("leaves.svg", "--tile 120x120"), ("points.csv", "--size 3x3")]
    {
        let made = [1, 2, 3, 8].map(|n| {
            folder.ok(&format!("fill {exemplar} {place} --seed 3 --threads {n} -o {n}.json"));
            folder.read(&format!("{n}.json"))
        });
        assert!(made.iter().all(|other| *other == made[0]), "{exemplar} {place}");
    }
}

#[test]
fn every_format_repeats_itself() {
    let folder = Folder::new();
    for format in ["svg", "png", "json", "csv"] {
        folder.ok(&format!("fill leaves.svg --domain ring.svg --density ramp.png --orient 20 --seed 9 -o a.{format}"));
        folder.ok(&format!("run a.{format} -o b.{format}"));
        assert!(folder.read(&format!("a.{format}")) == folder.read(&format!("b.{format}")), "{format}");
    }
}

#[test]
fn a_moved_result_needs_no_other_file() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --domain ring.svg --expand --seed 4 -o a.svg");
    let moved = Folder::new();
    for name in ["leaves.svg", "ring.svg", "points.csv", "ramp.png"] {
        std::fs::remove_file(moved.path(name)).unwrap();
    }
    moved.write("a.svg", folder.read("a.svg"));
    let output = moved.ok("run a.svg");
    assert!(output.stdout == folder.read("a.svg"));
}

#[test]
fn another_version_is_told() {
    let folder = Folder::new();
    folder.write("old.toml", "arabesque = \"0.0.1\"\nexemplar = \"leaves.svg\"\nsize = \"80x80\"\n");
    let output = folder.ok("run old.toml -o a.svg");
    assert!(common::stderr(&output).contains("version 0.0.1"), "{}", common::stderr(&output));
}

#[test]
fn a_recipe_makes_the_same_in_any_format() {
    let folder = Folder::new();
    folder.ok("fill leaves.svg --size 90x90 --seed 2 -o job.toml");
    folder.ok("fill leaves.svg --size 90x90 --seed 2 -o a.svg");
    folder.ok("run job.toml -o b.svg");
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    folder.ok("fill leaves.svg --size 90x90 --seed 2 -o a.png");
    folder.ok("run a.svg -o b.png");
    assert!(folder.read("a.png") == folder.read("b.png"));
    folder.ok("run a.svg --seed 3 -o c.svg");
    assert!(folder.read("a.svg") != folder.read("c.svg"));
}

#[test]
fn a_recipe_by_hand_is_short_and_relative_to_itself() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).unwrap();
    folder.write("sub/mine.svg", common::leaves());
    folder.write(
        "sub/job.toml",
        "exemplar = \"mine.svg\"\nsize = \"80x80\"\nseed = 8\n[set]\nlevels = 2\n[output]\npath = \"made.svg\"\n",
    );
    folder.ok("run sub/job.toml");
    folder.ok("fill leaves.svg --size 80x80 --seed 8 --set levels=2 -o a.svg");
    let without_name = |name: &str| folder.text(name).replace("mine.svg", "leaves.svg");
    assert_eq!(without_name("sub/made.svg"), without_name("a.svg"));
}

#[test]
fn bad_recipes_are_explained() {
    let folder = Folder::new();
    for (text, expected) in [
        ("exemplar = \"leaves.svg\"\nsize = \"80x80\"\nsede = 1\n", "did you mean `seed`"),
        ("size = \"80x80\"\n", "exemplar"),
        ("exemplar = \n", "line 1"),
    ] {
        folder.write("bad.toml", text);
        let message = folder.fails(3, "run bad.toml -o a.svg");
        assert!(message.contains("bad.toml") && message.contains(expected), "{message}");
    }
    assert!(folder.fails(3, "run leaves.svg -o a.svg").contains("without a recipe"));
    assert!(folder.fails(3, "run ramp.png -o a.svg").contains("without a recipe"));
    assert!(folder.fails(3, "run points.csv -o a.svg").contains("without a recipe"));
    folder.write("big.toml", "exemplar = { path = \"leaves.svg\", hash = \"0\" }\nsize = \"80x80\"\n");
    assert!(folder.fails(3, "run big.toml -o a.svg").contains("has changed"));
}

#[test]
fn bare_results_carry_nothing() {
    let folder = Folder::new();
    folder.ok("fill points.csv --size 1x1 --no-recipe -o a.csv");
    assert!(!folder.text("a.csv").contains('#'));
    folder.ok("fill leaves.svg --size 80x80 --no-recipe -o a.svg");
    assert!(!folder.text("a.svg").contains("arabesque:recipe>"));
}

/// A page of 120 x 90 of something at each place of a grid of 20 x 10, every other row moved by half.
fn rows(of: impl Fn(i32, i32) -> String) -> String {
    let places = (-1..10).flat_map(|row| (-1..7).map(move |k| (20 * k + 10 * (row & 1), 10 * row)));
    let body: String = places.map(|(x, y)| of(x, y)).collect();
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='120' height='90' viewBox='0 0 120 90'>\n{body}</svg>\n")
}

#[test]
fn a_region_of_scales_comes_back_under_the_rows_below_it() {
    let folder = Folder::new();
    let circle = |x: i32, y: i32| format!("<circle cx='{x}' cy='{y}' r='10' fill='#045' stroke='#fff'/>\n");
    folder.write("scales.svg", rows(circle));
    folder.ok("fill scales.svg --redo 35,25,40,22 --seed 3 --no-recipe -o out.svg");
    let text = folder.text("out.svg");
    let centre = |x: i32, y: i32| text.find(&format!("cx='{x}' cy='{y}'"));
    assert!(centre(40, 40).is_none() && centre(40, 20).is_some());
    // Two rows have their centres in the region, at 30 and 40; what lies below them comes later in the file.
    let new: Vec<usize> = text.match_indices("<use ").map(|(k, _)| k).collect();
    assert_eq!(new.len(), 4, "{text}");
    assert!(new.iter().all(|k| *k > centre(40, 20).unwrap() && *k < centre(50, 50).unwrap()));
}

#[test]
fn bands_and_areas_in_a_region_come_back_where_they_were() {
    let folder = Folder::new();
    let page = |body: String| {
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='120' height='90' viewBox='0 0 120 90'>\n{body}</svg>\n")
    };
    let band =
        |k: i32| format!("<rect x='{}' y='-5' width='6' height='100' fill='#c33' fill-opacity='0.5'/>\n", 12 * k);
    folder.write("bands.svg", page((0..10).map(band).collect()));
    folder.ok("fill bands.svg --redo 30,25,40,30 -o out.svg");
    let text = folder.text("out.svg");
    for x in [39, 51, 63] {
        assert!(
            text.contains(&format!("d=\"M{x} 25L{x} 55\"")) || text.contains(&format!("d=\"M{x} 55L{x} 25\"")),
            "{text}"
        );
    }
    assert!(!text.contains("stroke-linecap=\"round\""));
    // Waves of varying width, as areas.
    let wave = |k: i32| {
        let at = |x: i32, y: i32| format!("{},{}", 10 * x, 20 * k + y);
        let top: String = (-1..14).map(|x| format!("L{}", at(x, if x & 1 == 0 { 3 } else { 7 }))).collect();
        let back: String = (-1..14).rev().map(|x| format!("L{}", at(x, if x & 1 == 0 { 12 } else { 14 }))).collect();
        format!("<path d='M-15,{}{top}{back}Z' fill='#27a'/>\n", 20 * k + 10)
    };
    folder.write("waves.svg", page((-1..5).map(wave).collect()));
    folder.ok("fill waves.svg --redo 35,25,30,40 -o out.svg");
    let text = folder.text("out.svg");
    assert!(text.contains("data-arabesque-area=") && text.contains("fill-rule=\"evenodd\""), "{text}");
    folder.ok("run out.svg -o again.svg");
    assert_eq!(text, folder.text("again.svg"));
}
