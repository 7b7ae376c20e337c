//! Recipes and results that were tampered with.

use crate::case::{Case, DONE, dots_and};

/// What a broken recipe may end with.
const BROKEN: &[i32] = &[2, 3, 4];
const ANY: &[i32] = &[0, 2, 3, 4];

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = whole();
    cases.extend(knobs());
    cases.extend(broken());
    cases
}

fn run(name: impl Into<String>, toml: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "run r.toml -o out.svg", codes).with("in.svg", dots_and("")).with("r.toml", toml)
}

fn whole() -> Vec<Case> {
    vec![
        run("a short recipe", "exemplar = 'in.svg'\n[fill]\nsize = '90x90'\n", DONE),
        run("an exemplar that is missing", "exemplar = 'none.svg'\n[fill]\nsize = '90x90'\n", BROKEN),
        run("an exemplar that is the recipe", "exemplar = 'r.toml'\n[fill]\nsize = '90x90'\n", BROKEN),
        run("an exemplar that is a folder", "exemplar = '.'\n[fill]\nsize = '90x90'\n", BROKEN),
        run("an exemplar without a name", "exemplar = ''\n[fill]\nsize = '90x90'\n", BROKEN),
        run("an exemplar that is a device", "exemplar = '/dev/zero'\n[fill]\nsize = '90x90'\n", BROKEN),
        run(
            "a name of a million letters",
            format!("exemplar = '{}'\n[fill]\nsize = '90x90'\n", "a".repeat(1_000_000)),
            BROKEN,
        ),
    ]
}

/// Every number of the engine at its ends.
fn knobs() -> Vec<Case> {
    let most = "samples=64\ncoarse-neighbours=200\nfine-neighbours=200\niterations=1000\n";
    let mut cases =
        vec![run("every knob at its largest", format!("exemplar='in.svg'\nsize='200x200'\n[set]\n{most}"), ANY)];
    for line in most.lines() {
        cases.push(run(line, format!("exemplar='in.svg'\nsize='200x200'\n[set]\n{line}\n"), ANY));
    }
    for (key, values) in [
        ("iterations", ["-1", "0", "1001", "1e99", "'x'", "true"]),
        ("levels", ["-1", "0", "6", "1e99", "'x'", "[]"]),
        ("radius", ["-1", "0", "1e-300", "1e300", "nan", "inf"]),
        ("samples", ["-1", "0", "65", "9999999999999999999", "'x'", "{}"]),
    ] {
        for value in values {
            let toml = format!("exemplar='in.svg'\n[fill]\nsize='90x90'\n[fill.params]\n{key}={value}\n");
            cases.push(run(format!("{key}={value}"), toml, ANY));
        }
    }
    for seed in ["-1", "18446744073709551615", "99999999999999999999999", "1.5", "'x'"] {
        cases.push(run(format!("seed={seed}"), format!("exemplar='in.svg'\nseed={seed}\n[fill]\nsize='90x90'\n"), ANY));
    }
    cases
}

fn broken() -> Vec<Case> {
    let good = "exemplar = 'in.svg'\n[fill]\nsize = '90x90'\n";
    let mut cases = vec![
        run("an empty recipe", "", BROKEN),
        run("words", "this is no recipe", BROKEN),
        run("zeros", vec![0; 1000], BROKEN),
        run("nested arrays", format!("exemplar = {}{}", "[".repeat(50_000), "]".repeat(50_000)), BROKEN),
        run("nested tables", format!("exemplar = {}1{}", "{a=".repeat(50_000), "}".repeat(50_000)), BROKEN),
        run("a key of many parts", format!("{}a = 1\n{good}", "a.".repeat(50_000)), BROKEN),
        run("a table of many parts", format!("{good}[{}a]\n", "a.".repeat(50_000)), BROKEN),
        run("50 000 keys", good.to_owned() + &(0..50_000).map(|k| format!("k{k}=1\n")).collect::<String>(), BROKEN),
        run("two jobs", format!("{good}[redo]\nregion='0,0,9,9'\n"), BROKEN),
        run("no job", "exemplar = 'in.svg'\n", ANY),
        run("an unknown job", "exemplar = 'in.svg'\n[weave]\n", BROKEN),
        run(
            "base 64 that is none",
            "[exemplar]\npath='a.svg'\nencoding='base64'\ncontent='****'\n[fill]\nsize='90x90'\n",
            BROKEN,
        ),
        run(
            "content of another hash",
            "[exemplar]\npath='in.svg'\nhash='00000000000000000000000000000000'\n[fill]\nsize='90x90'\n",
            BROKEN,
        ),
        run("an output elsewhere", format!("{good}[output]\npath='/elsewhere/a.svg'\n"), ANY),
    ];
    for share in [5, 30, 60, 95] {
        cases.push(run(format!("{share} per cent of a recipe"), &good.as_bytes()[..good.len() * share / 100], BROKEN));
    }
    for (name, text) in [
        ("svg", dots_and("")),
        ("json", "{}".to_owned()),
        ("json", "[".repeat(100_000)),
        ("csv", "x,y\n0,0\n".into()),
        ("obj", "v 0 0 0\n".into()),
    ] {
        let line = format!("run r.{name} -o out.svg");
        cases.push(
            Case::new(format!("{name} without a recipe, {} bytes", text.len()), line, BROKEN)
                .with(&format!("r.{name}"), text),
        );
    }
    cases
}
