//! Ribbons: widths, scales and steps out of range, and curves that are none.

use crate::case::{Case, EITHER};
use crate::pictures::flat;

/// What odd options may end with.
const ANY: &[i32] = &[0, 2, 3, 4];

fn strip() -> Vec<u8> {
    b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 160 60'><rect y='26' width='160' height='8'/><circle cx='40' cy='30' r='20'/><circle cx='110' cy='30' r='14'/></svg>".to_vec()
}

fn curve(d: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 400 200'><path d='{d}' fill='none' stroke='black'/></svg>"
    )
}

fn ribbon(name: impl Into<String>, options: &str, d: &str, codes: &'static [i32]) -> Case {
    let line = format!("ribbon strip.svg --along c.svg -o out.svg {options}");
    Case::new(name, line, codes).with("strip.svg", strip()).with("c.svg", curve(d))
}

pub(crate) fn cases() -> Vec<Case> {
    let wave = "M10 100C100 0 250 200 390 100";
    let mut cases = Vec::new();
    let values = ["0", "-1", "nan", "inf", "1e-300", "1e-9", "1e-3", "1e6", "1e9", "1e300"];
    for option in ["width", "scale", "step"] {
        for value in values {
            cases.push(ribbon(format!("{option} {value}"), &format!("--{option} {value}"), wave, ANY));
        }
    }
    for widths in ["40..0", "0..0", "0:20,0.5:1e9,1:20", "0:20,0:30,1:9", "1:20", "x", "0:20,2:30", "20..1e9"] {
        cases.push(ribbon(format!("width {widths}"), &format!("--width {widths}"), wave, ANY));
    }
    for ends in [
        "--start 0..30 --end 140..160",
        "--start 0..1",
        "--end 159..160",
        "--start 30..10",
        "--start 0..99999",
        "--first 99999",
        "--repetition 1e9",
        "--variety 1e9",
        "--window 100000",
        "--centring 1e300",
    ] {
        cases.push(ribbon(ends, &format!("{ends} --scale 0.5"), wave, ANY));
    }
    for (name, d) in curves() {
        cases.push(ribbon(name, "--scale 0.3", &d, EITHER));
    }
    for (w, h) in [(1, 1), (1, 60), (60, 1), (4_000, 60), (60, 4_000), (4_000, 4_000)] {
        let line = "ribbon strip.png --along c.svg -o out.png --scale 0.5";
        let picture = flat(w, h, png::ColorType::Rgba, png::BitDepth::Eight);
        cases.push(
            Case::new(format!("a strip of {w} x {h}"), line, EITHER)
                .with("strip.png", picture)
                .with("c.svg", curve(wave)),
        );
    }
    cases
}

fn curves() -> Vec<(String, String)> {
    let mut all = vec![
        ("a curve without length".to_owned(), "M50 50h0".to_owned()),
        ("a curve of a hair".into(), "M50 50h1e-6".into()),
        ("a curve there and back".into(), "M50 50h99h-99".into()),
        ("a closed curve of two points".into(), "M50 50h99z".into()),
        ("a cusp".into(), "M50 50C150 50 50 50 50 150".into()),
        ("a curve of 1e8".into(), "M0 0H1e8".into()),
        ("corners".into(), "M10 10L90 10L10 12L90 14L10 16L90 18".into()),
    ];
    for n in [500, 5_000, 50_000] {
        let zigzag: String =
            (0..n).map(|k| format!("L{} {}", f64::from(k) * 400.0 / f64::from(n), 100 + k % 2)).collect();
        all.push((format!("a zigzag of {n} corners"), format!("M0 100{zigzag}")));
        let tangle: String =
            (0..n).map(|k| format!("L{} {}", i64::from(k) * 7919 % 400, i64::from(k) * 104_729 % 199)).collect();
        all.push((format!("a tangle of {n} corners"), format!("M0 0{tangle}")));
        all.push((format!("{n} curves"), (0..n).map(|k| format!("M{} {}h30", k % 370, k / 370)).collect()));
        all.push((format!("a curve that closes {n} times"), format!("M5 5h30v30{}", "z".repeat(n as usize))));
    }
    all
}
