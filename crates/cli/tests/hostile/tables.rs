//! Points as CSV, curves as OBJ.

use crate::case::{Case, DONE, EITHER, REFUSED};

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = points();
    cases.extend(broken_tables());
    cases.extend(curves());
    cases
}

fn csv(name: impl Into<String>, text: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "fill in.csv --size 30x30 -o out.csv", codes).with("in.csv", text)
}

fn rows(n: usize, row: impl Fn(usize) -> String) -> String {
    (0..n).map(|k| row(k) + "\n").collect()
}

fn points() -> Vec<Case> {
    let mut cases = vec![csv("a grid", rows(64, |k| format!("{},{}", k % 8, k / 8)), DONE)];
    for n in [1, 2, 3, 1_000, 50_000] {
        let page = if n < 10 { EITHER } else { REFUSED };
        cases.push(csv(format!("{n} equal points"), rows(n, |_| "1,1".into()), REFUSED));
        cases.push(csv(format!("{n} points on a line"), rows(n, |k| format!("{k},0")), page));
        cases.push(csv(format!("{n} points on a diagonal"), rows(n, |k| format!("{k},{k}")), EITHER));
        cases.push(csv(format!("{n} points at two places"), rows(n, |k| format!("{},{}", k % 2, k % 2)), EITHER));
        // As dense as that, a page has work for a minute, which is told: here it ends sooner.
        let closer = rows(n, |k| format!("{},{}", 0.5_f64.powi(k as i32), k % 7));
        let line = "fill in.csv --size 30x30 -o out.csv --limit work-per-element=0";
        cases.push(Case::new(format!("{n} points closer and closer"), line, EITHER).with("in.csv", closer));
    }
    for far in ["1e9", "1e12", "1e154", "1e308", "1e309", "-1e200", "nan", "inf", "0x10", "1e-300", "1,5", ""] {
        cases.push(csv(
            format!("a point at {far}"),
            rows(64, |k| format!("{},{}", k % 8, k / 8)) + &format!("{far},3\n"),
            EITHER,
        ));
    }
    cases.push(csv("more points than allowed", rows(200_000, |k| format!("{},{}", k % 500, k / 500)), REFUSED));
    cases
}

fn broken_tables() -> Vec<Case> {
    let mut cases = vec![
        csv("an open quote", "x,y,class\n0,0,\"a\n1,0,b\n0,1,c\n", REFUSED),
        csv("a quote in the middle", "x,y,class\n0,0,a\"b\n1,0,b\n0,1,c\n", EITHER),
        csv("rows of unequal length", "0,0\n1\n2,2,2,2\n", REFUSED),
        csv("words", "a,b\nc,d\n", REFUSED),
        csv("a header alone", "x,y\n", REFUSED),
        csv("an empty table", "", REFUSED),
        csv("a table of commas", ",,,,\n,,,,\n", REFUSED),
        csv("a table of zeros", vec![0; 5000], REFUSED),
        csv("a line of a million commas", ",".repeat(1_000_000), REFUSED),
        csv("a number of a million digits", "9".repeat(1_000_000) + ",1\n2,2\n", REFUSED),
        csv("a million classes", rows(50_000, |k| format!("{},{},c{k}", k % 250, k / 250)), EITHER),
    ];
    for comma in [";", "\t", " ", "|"] {
        cases.push(csv(
            format!("columns apart by {comma:?}"),
            rows(64, |k| format!("{}{comma}{}", k % 8, k / 8)),
            EITHER,
        ));
    }
    cases
}

fn obj(name: impl Into<String>, text: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "fill in.obj --box 5x5x5 -o out.obj", codes).with("in.obj", text)
}

fn curves() -> Vec<Case> {
    let mut cases = vec![
        obj("a line from a point to itself", "v 0 0 0\nv 1 1 1\nl 1 1 1 1\nl 1 2 1 2 1\n", EITHER),
        obj("a vertex alone", "v 0 0 0\n", REFUSED),
        obj("a line without vertices", "l 1 2\n", REFUSED),
        obj("a line to nowhere", "v 0 0 0\nv 1 1 1\nl 1 3\n", REFUSED),
        obj("a line to vertex 0", "v 0 0 0\nv 1 1 1\nl 0 1\n", REFUSED),
        obj("a line to vertex -9", "v 0 0 0\nv 1 1 1\nl -9 1\n", REFUSED),
        obj("an index of many digits", format!("v 0 0 0\nv 1 1 1\nl 1 {}\n", "9".repeat(100_000)), REFUSED),
        obj("a vertex of two numbers", "v 0 0\nv 1 1\nl 1 2\n", REFUSED),
        obj("a flat net", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nl 1 2 3 4 1\n", EITHER),
        obj("a straight net", "v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n", EITHER),
        obj("faces", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", EITHER),
        obj("an empty mesh", "", REFUSED),
        obj("words", "this is no mesh\n", REFUSED),
    ];
    for n in [40, 1_000, 50_000] {
        let star =
            rows(n, |k| format!("v {} {} {}", k % 13, k % 17, k % 11)) + &rows(n - 1, |k| format!("l 1 {}", k + 2));
        cases.push(obj(format!("{n} lines from one point"), star, EITHER));
        let tangle = rows(n, |k| format!("v {} {} {}", k * 7919 % 101, k * 104_729 % 103, k * 31 % 107));
        let all: Vec<String> = (1..=n).map(|k| k.to_string()).collect();
        cases.push(obj(format!("one line through {n} points"), format!("{tangle}l {}\n", all.join(" ")), EITHER));
        let same = format!("v 0 0 0\nv 1 1 1\nv 0 1 0\n{}", "l 1 2 3\n".repeat(n));
        cases.push(obj(format!("{n} equal lines"), same, EITHER));
        cases.push(obj(format!("{n} equal vertices"), rows(n, |_| "v 1 1 1".into()) + "l 1 2 3\n", EITHER));
    }
    for far in ["1e9", "1e154", "1e308", "1e309", "nan", "inf", "-"] {
        cases.push(obj(format!("a vertex at {far}"), format!("v 0 0 0\nv {far} 1 1\nv 0 1 0\nl 1 2 3\n"), EITHER));
    }
    cases
}
