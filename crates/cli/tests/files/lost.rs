//! No file is lost: outputs that are inputs, files of others, places that a recipe names.

use crate::common::{self, Folder, stderr};

/// A folder with inputs of every role, small enough for all of them to be run.
fn workshop() -> Folder {
    let folder = Folder::new();
    folder
        .write("keep.svg", common::svg("80", "80", "0 0 80 80", "<circle cx=\"40\" cy=\"40\" r=\"3\" fill=\"#c22\"/>"));
    folder.write(
        "flow.svg",
        common::svg("80", "80", "0 0 80 80", "<path d=\"M0 40H80\" fill=\"none\" stroke=\"black\"/>"),
    );
    folder.write("strip.png", common::strip());
    folder.write("second.png", common::strip());
    folder.write("curves.svg", common::curves());
    folder
}

/// Every role that a file can have, with a command in which `FILE` has it.
const ROLES: &[(&str, &str, &str)] = &[
    ("exemplar", "leaves.svg", "fill FILE --size 80x80"),
    ("exemplar", "leaves.svg", "fill FILE --redo 20,20,30,30"),
    ("exemplar", "points.csv", "fill FILE --size 1x1"),
    ("--domain", "ring.svg", "fill leaves.svg --domain FILE"),
    ("--domain", "ring.svg", "fill leaves.svg --domain FILE#ring"),
    ("--keep", "keep.svg", "fill leaves.svg --size 80x80 --keep FILE"),
    ("--avoid", "ring.svg", "fill leaves.svg --size 400x400 --avoid FILE"),
    ("--orient", "flow.svg", "fill leaves.svg --size 80x80 --orient FILE"),
    ("--scale", "ramp.png", "fill leaves.svg --size 80x80 --scale FILE"),
    ("--density", "ramp.png", "fill leaves.svg --size 80x80 --density FILE@0.5..1"),
    ("--redo", "ring.svg", "fill leaves.svg --redo FILE#ring"),
    ("exemplar", "strip.png", "ribbon FILE --along curves.svg#wave"),
    ("exemplar", "second.png", "ribbon strip.png FILE --along curves.svg#wave"),
    ("--along", "curves.svg", "ribbon strip.png --along FILE#wave"),
    ("--avoid", "ramp.png", "ribbon strip.png --along curves.svg#wave --avoid FILE"),
    ("exemplar", "leaves.svg", "inspect FILE"),
];

#[test]
fn an_output_that_is_an_input_is_refused_under_any_name() {
    let folder = workshop();
    for (role, file, line) in ROLES {
        let before = folder.read(file);
        let ending = file.rsplit_once('.').unwrap().1;
        let mut names = vec![(*file).to_owned(), format!("./{file}")];
        #[cfg(unix)]
        {
            let (soft, hard) = (format!("soft.{ending}"), format!("hard.{ending}"));
            for name in [&soft, &hard] {
                let _ = std::fs::remove_file(folder.path(name));
            }
            std::os::unix::fs::symlink(file, folder.path(&soft)).unwrap();
            std::fs::hard_link(folder.path(file), folder.path(&hard)).unwrap();
            names.extend([soft, hard]);
        }
        let line = line.replace("FILE", file);
        // A picture of points is drawn, not written as points.
        let format = if line.starts_with("inspect") || ending != "csv" { "" } else { " --format csv" };
        for out in names {
            let message = folder.fails(1, &format!("{line}{format} -o {out}"));
            assert!(
                message.contains(&format!("an input as well ({role} ")) && message.contains("--force"),
                "{message}"
            );
            assert!(folder.read(file) == before, "{line} -o {out}");
        }
    }
}

#[cfg(unix)]
#[test]
fn an_input_is_not_appended_to_either() {
    let folder = workshop();
    let before = folder.read("leaves.svg");
    let appended = std::fs::OpenOptions::new().append(true).open(folder.path("leaves.svg")).unwrap();
    let output = folder.command("fill leaves.svg --size 80x80 -o -").stdout(appended).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let given = std::fs::File::open(folder.path("leaves.svg")).unwrap();
    let output = folder.command("fill - --size 80x80 -o leaves.svg").stdin(given).output().unwrap();
    assert!(stderr(&output).contains("exemplar standard input"), "{}", stderr(&output));
    assert!(folder.read("leaves.svg") == before);
}

#[test]
fn force_keeps_copies_that_never_replace_one_another() {
    let folder = workshop();
    let before = folder.read("leaves.svg");
    let output = folder.ok("fill leaves.svg --redo 20,20,30,30 -o leaves.svg --force");
    assert!(stderr(&output).contains("leaves.svg.orig"), "{}", stderr(&output));
    let first = folder.read("leaves.svg");
    assert!(folder.read("leaves.svg.orig") == before && first != before);
    folder.ok("fill leaves.svg --redo 40,40,30,30 --seed 1 -o leaves.svg --force");
    assert!(folder.read("leaves.svg.orig") == before && folder.read("leaves.svg.orig.1") == first);
}

#[test]
fn a_recipe_is_not_written_over_by_its_own_run() {
    let folder = workshop();
    folder.ok("fill leaves.svg --size 80x80 -o job.toml");
    folder.ok("fill leaves.svg --size 80x80 -o made.svg");
    for line in ["run job.toml -o job.toml", "run made.svg -o made.svg", "run made.svg --seed 3 -o ./made.svg"] {
        let message = folder.fails(1, line);
        assert!(message.contains("an input as well (recipe "), "{message}");
    }
    // What the recipe was made from is not written over either, though its content is in the recipe.
    let message = folder.fails(1, "run made.svg -o leaves.svg");
    assert!(message.contains("an input as well (exemplar "), "{message}");
}

#[test]
fn files_of_others_are_replaced_only_by_force() {
    let folder = workshop();
    let recipe = "exemplar = \"leaves.svg\"\n[fill]\nsize = \"80x80\"\n";
    let drawing = common::leaves();
    for (out, content) in [
        ("a.svg", &*drawing),
        ("b.svg", "precious"),
        ("c.png", "precious"),
        ("d.json", "{\"precious\": 1}"),
        ("e.csv", "x,y,class\n1,2,a\n"),
        ("f.toml", recipe),
    ] {
        folder.write(out, content);
        let line = format!("fill leaves.svg --size 80x80 -o {out}");
        let message = folder.fails(1, &line);
        assert!(message.contains(out) && message.contains("--force"), "{message}");
        assert_eq!(folder.text(out), content);
        folder.ok(&format!("{line} --force"));
        assert!(folder.read(out) != content.as_bytes());
    }
    folder.write("seen.svg", &drawing);
    folder.fails(1, "inspect leaves.svg -o seen.svg");
    folder.ok("inspect leaves.svg -o seen.svg --force");
    // Of several files none is made when one of them must not be.
    folder.write("v-2.svg", "precious");
    folder.fails(1, "fill leaves.svg --size 80x80 --variations 3 -o v.svg");
}

#[test]
fn results_are_replaced_again_and_again() {
    let folder = workshop();
    folder.write("empty.svg", "");
    folder.ok("fill leaves.svg --size 80x80 -o empty.svg");
    for line in [
        "fill leaves.svg --size 80x80 -o a.svg",
        "fill leaves.svg --size 80x80 --expand -o a.svg",
        "fill leaves.svg --size 80x80 --no-recipe -o a.svg",
        "fill leaves.svg --size 80x80 -o a.png",
        "fill leaves.svg --size 80x80 -o a.json",
        "fill leaves.svg --size 80x80 --no-recipe -o a.json",
        "fill leaves.svg --size 80x80 -o a.csv",
        "fill leaves.svg --size 80x80 -o a.toml",
        "fill leaves.svg --redo 20,20,30,30 -o redone.svg",
        "ribbon strip.png --along curves.svg#wave -o r.png",
        "ribbon strip.png --along curves.svg#wave -o r.svg",
        "ribbon strip.png --along curves.svg#wave -o r.json",
        "ribbon strip.png --along curves.svg#wave -o r.obj",
        "ribbon strip.png --along curves.svg#wave -o r.glb",
        "ribbon strip.png --along curves.svg#wave --no-recipe -o r.glb",
        "inspect leaves.svg -o seen.svg",
        "inspect leaves.svg -o seen.png",
        "fill leaves.svg --size 80x80 --variations 2 -o v.svg",
    ] {
        folder.ok(line);
        folder.ok(line);
    }
    assert!(
        folder.names().iter().all(|name| !name.contains(".orig") && !name.contains(".part")),
        "{:?}",
        folder.names()
    );
    assert!(folder.fails(3, "run seen.png -o again.png").contains("without a recipe"));
    // These say nothing of where they come from.
    for line in ["--no-recipe -o bare.csv", "--no-recipe -o bare.png"] {
        let line = format!("fill leaves.svg --size 80x80 {line}");
        folder.ok(&line);
        folder.fails(1, &line);
        folder.ok(&format!("{line} --force"));
    }
}

#[test]
fn a_result_does_not_say_where_its_repetition_goes() {
    let folder = workshop();
    let evil = folder.path("evil.svg").to_str().unwrap().to_owned();
    for (name, line_end) in [("a.svg", "\n"), ("a.json", "\\n"), ("a.csv", "\n# ")] {
        folder.ok(&format!("fill leaves.svg --size 80x80 -o {name}"));
        let quote = if name == "a.json" { "\\\"" } else { "\"" };
        let text = folder.text(name);
        let planted = format!("[output]{line_end}path = {quote}{evil}{quote}{line_end}");
        let tampered = text.replace(&format!("[output]{line_end}"), &planted);
        assert!(tampered != text, "{name}");
        folder.write("tampered", &tampered);
        let output = folder.ok("run tampered --allow-path");
        assert!(output.stdout == text.as_bytes(), "{name}");
        assert!(!folder.path("evil.svg").exists(), "{name}");
    }
}

#[test]
fn a_recipe_writes_into_its_own_folder() {
    let folder = workshop();
    std::fs::create_dir_all(folder.path("home/sub")).unwrap();
    let write = |path: &str| {
        let recipe = format!("exemplar = \"leaves.svg\"\n[fill]\nsize = \"80x80\"\n[output]\npath = \"{path}\"\n");
        folder.write("home/job.toml", recipe);
    };
    folder.write("home/leaves.svg", common::leaves());
    for path in ["a.svg", "sub/b.svg", "./c.svg"] {
        write(path);
        folder.ok("run home/job.toml");
        assert!(folder.path("home").join(path).exists(), "{path}");
    }
    let absolute = folder.path("abs.svg").to_str().unwrap().to_owned();
    let mut outside = vec!["../up.svg", "sub/../../up.svg", &*absolute];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("..", folder.path("home/out")).unwrap();
        outside.push("out/through.svg");
    }
    for path in outside {
        write(path);
        let message = folder.fails(2, "run home/job.toml");
        assert!(message.contains("--allow-path") && message.contains(path), "{message}");
        folder.ok("run home/job.toml --allow-path");
        assert!(folder.path("home").join(path).exists(), "{path}");
        std::fs::remove_file(folder.path("home").join(path)).unwrap();
        folder.ok("run home/job.toml -o elsewhere.svg");
    }
    // The recipe may not name an input of its own, nor what is nobody's to replace.
    write("leaves.svg");
    assert!(folder.fails(1, "run home/job.toml").contains("an input as well"));
    folder.write("home/notes.svg", "precious");
    write("notes.svg");
    assert!(folder.fails(1, "run home/job.toml --allow-path").contains("--force"));
    write("");
    assert!(folder.fails(1, "run home/job.toml").contains("empty name"));
}

/// Leaves in a file that is too large to travel in a recipe.
fn large() -> String {
    common::leaves().replace("</svg>", &format!("<desc>{}</desc></svg>", "x".repeat(1_100_000)))
}

#[test]
fn a_result_repeats_from_any_folder_where_its_large_input_can_be_found() {
    let folder = workshop();
    std::fs::create_dir_all(folder.path("in")).unwrap();
    std::fs::create_dir_all(folder.path("out/deep")).unwrap();
    folder.write("in/large.svg", large());
    folder.ok("fill in/large.svg --size 80x80 -o out/deep/a.svg");
    let again = |line: &str| {
        let output = folder.ok(&format!("run {line}"));
        assert!(output.stdout == folder.read("out/deep/a.svg"), "{line}");
    };
    again("out/deep/a.svg");
    let elsewhere = Folder::new();
    let path = folder.path("out/deep/a.svg").to_str().unwrap().to_owned();
    // From another folder: it is found above the result, then beside it under another name.
    assert!(elsewhere.ok(&format!("run {path}")).stdout == folder.read("out/deep/a.svg"));
    std::fs::rename(folder.path("in/large.svg"), folder.path("out/deep/renamed.svg")).unwrap();
    assert!(elsewhere.ok(&format!("run {path}")).stdout == folder.read("out/deep/a.svg"));
    // What is found under another name is an input too.
    let renamed = folder.path("out/deep/renamed.svg").to_str().unwrap().to_owned();
    assert!(elsewhere.fails(1, &format!("run {path} -o {renamed}")).contains("an input as well"));
    std::fs::remove_file(folder.path("out/deep/renamed.svg")).unwrap();
    let message = elsewhere.fails(3, &format!("run {path} -o b.svg"));
    let text = folder.text("out/deep/a.svg");
    let digest = text.split("hash = \"").nth(1).unwrap().split('"').next().unwrap();
    assert!(message.contains("exemplar in/large.svg: no such file") && message.contains(digest), "{message}");
    folder.write("in/large.svg", large().replace("xx", "xy"));
    let message = folder.fails(3, "run out/deep/a.svg -o b.svg");
    assert!(message.contains("has changed") && message.contains(digest), "{message}");
}
