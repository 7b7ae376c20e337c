//! The same bytes for any number of threads, and from any file that carries its recipe.

mod common;

use common::Folder;

#[test]
fn threads_do_not_change_the_bytes() {
    let folder = Folder::new();
    for (exemplar, place) in
        [("leaves.svg", "--size 200x150"), ("leaves.svg", "--tile 120x120"), ("points.csv", "--size 3x3")]
    {
        let made: Vec<_> = [1, 2, 8]
            .map(|n| {
                folder.ok(&format!("fill {exemplar} {place} --seed 3 --threads {n} -o {n}.json"));
                folder.read(&format!("{n}.json"))
            })
            .to_vec();
        assert!(made[0] == made[1] && made[1] == made[2], "{exemplar} {place}");
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
