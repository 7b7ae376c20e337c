//! Points with attributes, continued as structures or made surfaces.

use crate::case::{Case, DONE, EITHER, REFUSED, USAGE};

/// Refused, as an option that does not suit or as a file that does not.
const TOLD: &[i32] = &[2, 3, 4];

/// Points of a bent sheet over the unit square, with normals and whatever `more` appends.
fn sheet(head: &str, more: impl Fn(usize) -> String) -> String {
    let row = |k: usize| {
        let (x, y) = ((k % 12) as f64 / 12.0, (k / 12) as f64 / 12.0);
        format!("{x:.4},{y:.4},{:.4},0,0,1{}\n", 0.03 * (x * 12.566).sin(), more(k))
    };
    format!("x,y,z,nx,ny,nz{head}\n{}", (0..144).map(row).collect::<String>())
}

fn structure(name: &str, points: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "fill in.csv --method structures --size 2x2 -o out.ply", codes).with("in.csv", points)
}

pub(crate) fn cases() -> Vec<Case> {
    let good = sheet("", |_| String::new());
    let mut cases = vec![
        structure("a bent sheet", good.clone(), DONE),
        structure("nine points", good.lines().take(10).map(|l| l.to_owned() + "\n").collect::<String>(), EITHER),
        structure("points at one place", "x,y,z\n".to_owned() + &"1,1,1\n".repeat(500), TOLD),
        structure(
            "points of a line",
            "x,y,z\n".to_owned() + &(0..300).map(|k| format!("{k},0,0\n")).collect::<String>(),
            EITHER,
        ),
        structure("a radius below zero", sheet(",radius", |_| ",-1".into()), TOLD),
        structure("a radius of 1e154", sheet(",radius", |_| ",1e154".into()), TOLD),
        structure("a group for each point", sheet(",group", |k| format!(",{k}")), EITHER),
        structure("an element for each point", sheet(",element", |k| format!(",{k}")), EITHER),
        structure("one element", sheet(",element", |_| ",0".into()), EITHER),
        structure("normals of no length", good.replace(",0,0,1\n", ",0,0,0\n"), EITHER),
        structure("a coordinate that is not a number", good.clone() + "nan,0,0,0,0,1\n", REFUSED),
        structure("a far point", good.clone() + "1e9,0,0,0,0,1\n", EITHER),
        structure("nothing", "", REFUSED),
    ];
    for (options, codes) in [
        ("--size 0x1", TOLD),
        ("--size 1e9x1e9", REFUSED),
        ("--box 2x2", USAGE),
        ("--size 2x2 --set sigma=1e-9", TOLD),
        ("--size 2x2 --set window=1e9", TOLD),
        ("--size 2x2 --scale 1e-9", TOLD),
        ("--size 2x2 --limit memory=1048576", TOLD),
        ("--size 2x2 --time-limit 1ms", EITHER),
        ("--size 2x2 --mesh --surface resolution=1e9", TOLD),
        ("--on m.obj", EITHER),
        ("--inside m.obj", TOLD),
        ("--along m.obj", TOLD),
    ] {
        let line = format!("fill in.csv --method structures {options} -o out.ply");
        let case = Case::new(format!("a structure with {options}"), line, codes);
        cases.push(case.with("in.csv", good.clone()).with("m.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n"));
    }
    for (name, points, codes) in [
        ("a surface of a sheet", good, DONE),
        ("a surface of two points", "x,y,z\n0,0,0\n1,1,1\n".to_owned(), EITHER),
        ("a surface of one place", "x,y,z\n".to_owned() + &"1,1,1\n".repeat(500), TOLD),
        (
            "a surface of points that are far apart",
            "x,y,z\n0,0,0\n1e9,0,0\n0,1e9,0\n0,0,1e9\n1,1,1\n".to_owned(),
            EITHER,
        ),
    ] {
        cases.push(Case::new(name, "surface in.csv -o out.ply", codes).with("in.csv", points));
    }
    cases
}
