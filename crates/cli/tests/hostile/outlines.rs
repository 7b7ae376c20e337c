//! Shapes to be filled or avoided: combs, tangles, crowds, and shapes that are none.

use std::f64::consts::TAU;

use crate::case::{Case, EITHER, dots_and};

/// Path data by name.
fn paths() -> Vec<(String, String)> {
    let mut all = vec![
        ("no area".to_owned(), "M0 0H100".to_owned()),
        ("a point".into(), "M50 50z".into()),
        ("an open corner".into(), "M0 0H100V100".into()),
        ("a hair".into(), "M0 0H100V1e-9H0z".into()),
        ("a speck".into(), "M50 50h1e-7v1e-7z".into()),
        ("a plain of 1e8".into(), "M0 0H1e8V1e8H0z".into()),
        ("a bow tie".into(), "M0 0L100 100V0L0 100z".into()),
        ("one shape twice".into(), "M0 0H100V100H0zM0 0H100V100H0z".into()),
        ("a shape and its mirror".into(), "M0 0H100V100H0zM0 0V100H100V0z".into()),
        ("shapes that touch".into(), "M0 0H50V50H0zM50 50H100V100H50zM50 0H100V50H50z".into()),
    ];
    for n in [300, 5_000, 20_000] {
        let step = 400.0 / f64::from(n);
        let comb: String = (0..n / 2).map(|_| format!("h{step}V400h{step}V0")).collect();
        all.push((format!("a comb of {n} teeth"), format!("M0 0{comb}")));
        let star: String = (0..n)
            .map(|k| {
                let (s, c) = (f64::from(k) / f64::from(n) * TAU).sin_cos();
                let r = if k % 2 == 0 { 190.0 } else { 100.0 };
                format!("L{:.4} {:.4}", 200.0 + r * c, 200.0 + r * s)
            })
            .collect();
        all.push((format!("a star of {n} corners"), format!("M390 200{star}z")));
        let spiral = |from: f64, sign: f64| -> String {
            (0..n)
                .map(|k| {
                    let t = if sign > 0.0 { f64::from(k) } else { f64::from(n - k) } / f64::from(n);
                    let (s, c) = (t * 40.0 * TAU).sin_cos();
                    format!("L{:.4} {:.4}", 200.0 + (from + 180.0 * t) * c, 200.0 + (from + 180.0 * t) * s)
                })
                .collect()
        };
        all.push((format!("a spiral of {n} corners"), format!("M200 200{}{}z", spiral(2.0, 1.0), spiral(4.0, -1.0))));
        let tangle: String =
            (0..n).map(|k| format!("L{} {}", i64::from(k) * 7919 % 400, i64::from(k) * 104_729 % 399)).collect();
        all.push((format!("a tangle of {n} corners"), format!("M0 0{tangle}z")));
        let crowd: String = (0..n).map(|k| format!("M{} {}h2v2h-2z", k % 130 * 3, k / 130 * 3)).collect();
        all.push((format!("{n} squares"), crowd));
        let pile: String = (0..n).map(|k| format!("M{} {}h90v90h-90z", k % 300, k * 7 % 300)).collect();
        all.push((format!("{n} squares in a pile"), pile));
    }
    all
}

pub(crate) fn cases() -> Vec<Case> {
    let shape =
        |d: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 400 400'><path d='{d}'/></svg>");
    let mut cases = Vec::new();
    for (name, d) in paths() {
        let borders: &[&str] = if d.len() < 100_000 { &["clip", "inside", "cross", "turn"] } else { &["clip"] };
        for border in borders {
            let line = format!("fill in.svg --domain shape.svg --border {border} -o out.svg");
            cases.push(
                Case::new(format!("{name} as the domain, {border}"), line, EITHER)
                    .with("in.svg", dots_and(""))
                    .with("shape.svg", shape(&d)),
            );
        }
        let line = "fill in.svg --size 400x400 --avoid shape.svg -o out.svg";
        cases.push(
            Case::new(format!("{name} avoided"), line, EITHER)
                .with("in.svg", dots_and(""))
                .with("shape.svg", shape(&d)),
        );
    }
    cases
}
