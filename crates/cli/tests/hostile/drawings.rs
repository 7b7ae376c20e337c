//! Elements at one place, of no size, far too large, far too many; strokes that meet in one point.

use crate::case::{Case, DONE, EITHER, REFUSED, dots, dots_and, page};

const COUNTS: [usize; 3] = [300, 3_000, 50_000];

fn repeated(n: usize, item: impl Fn(usize) -> String) -> String {
    page(&(0..n).map(item).collect::<String>())
}

pub(crate) fn cases() -> Vec<Case> {
    [places(), sizes(), strokes(), mixtures()].concat_cases()
}

trait Concat {
    fn concat_cases(self) -> Vec<Case>;
}

impl<const N: usize> Concat for [Vec<Case>; N] {
    fn concat_cases(self) -> Vec<Case> {
        self.into_iter().flatten().collect()
    }
}

fn places() -> Vec<Case> {
    let mut cases = Vec::new();
    for n in COUNTS {
        let mut add = |name: &str, item: &dyn Fn(usize) -> String| {
            cases.push(Case::fill(format!("{n} {name}"), repeated(n, item), EITHER));
        };
        add("dots at one place", &|_| "<circle cx='60' cy='60' r='3'/>".into());
        add("squares at one place", &|_| "<rect x='50' y='50' width='9' height='9'/>".into());
        add("dots at two places", &|k| format!("<circle cx='{}' cy='60' r='3'/>", 30 + k % 2 * 60));
        add("dots almost at one place", &|k| format!("<circle cx='{}' cy='60' r='3'/>", 60.0 + k as f64 * 1e-9));
        add("dots on one line", &|k| format!("<circle cx='{}' cy='60' r='.1'/>", k as f64 * 120.0 / n as f64));
        // What crowds is worked on for as long as its limit allows: a few thousand show it.
        if n < 10_000 {
            let chance = |k: usize| ((k as f64 * 12.9898).sin() * 43_758.545).rem_euclid(1.0);
            add("dots scattered on a line", &|k| format!("<circle cx='{}' cy='60' r='.01'/>", 120.0 * chance(k)));
            add("dots in two heaps", &|k| {
                let (x, y, size) = if k % 9 == 0 { (90.0, 80.0, 20.0) } else { (30.0, 30.0, 0.5) };
                format!("<circle cx='{}' cy='{}' r='.01'/>", x + size * chance(k), y + size * chance(k + 1_000_000))
            });
        }
        add("nested rings", &|k| {
            format!(
                "<circle cx='60' cy='60' r='{}' fill='none' stroke='red' stroke-width='.001'/>",
                1.0 + k as f64 * 50.0 / n as f64
            )
        });
        add("dots off the page", &|k| format!("<circle cx='{}' cy='-900' r='3'/>", k * 10));
    }
    cases
}

fn sizes() -> Vec<Case> {
    let mut cases = Vec::new();
    for size in ["1e3", "1e4", "1e5", "1e6", "1e8"] {
        cases.push(Case::fill(
            format!("an element of {size}"),
            dots_and(&format!("<circle r='{size}' fill='red'/>")),
            EITHER,
        ));
        cases.push(Case::fill(
            format!("a bar of {size}"),
            dots_and(&format!("<rect width='{size}' height='2'/>")),
            EITHER,
        ));
        cases.push(Case::fill(
            format!("a stroke of {size}"),
            dots_and(&format!("<path d='M5 5q3 4 9 0' fill='none' stroke='red' stroke-width='{size}'/>")),
            EITHER,
        ));
        cases.push(Case::fill(
            format!("a curve to {size}"),
            dots_and(&format!("<path d='M5 5C{size} 4 9 -{size} 7 7' stroke='red'/>")),
            EITHER,
        ));
    }
    for size in ["1e-3", "1e-6", "1e-9", "1e-12", "1e-30", "0"] {
        let small = format!(
            "<circle cx='5' cy='5' r='{size}'/><circle cx='50' cy='50' r='{size}'/><circle cx='15' cy='65' r='{size}'/>"
        );
        cases.push(Case::fill(format!("elements of {size}"), page(&small), EITHER));
        cases.push(Case::fill(format!("one element of {size} among others"), dots_and(&small), EITHER));
        cases.push(Case::fill(
            format!("bars of no height {size}"),
            dots_and(&format!("<rect width='50' height='{size}'/>")),
            EITHER,
        ));
    }
    cases.push(Case::fill("nothing", page(""), REFUSED));
    cases.push(Case::fill("one dot", page("<circle cx='9' cy='9' r='4'/>"), DONE));
    cases
}

fn strokes() -> Vec<Case> {
    let line = |d: &str| format!("<path d='{d}' fill='none' stroke='#000'/>");
    let mut cases = Vec::new();
    for n in [40, 400, 4_000] {
        let star: String = (0..n)
            .map(|k| {
                let (s, c) = (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
                line(&format!("M60 60L{} {}", 60.0 + 50.0 * c, 60.0 + 50.0 * s))
            })
            .collect();
        cases.push(Case::fill(format!("{n} lines from one point"), page(&star), EITHER));
        let same = line("M10 60H110").repeat(n as usize);
        cases.push(Case::fill(format!("{n} lines upon each other"), page(&same), EITHER));
        let tangle: String = (0..n).map(|k| format!("L{} {}", k * 7919 % 120, k * 104_729 % 120)).collect();
        cases.push(Case::fill(
            format!("a line that crosses itself, {n} corners"),
            page(&line(&format!("M0 0{tangle}"))),
            EITHER,
        ));
        let grid: String = (0..n.min(1000))
            .map(|k| {
                let at = f64::from(k) * 120.0 / f64::from(n.min(1000));
                line(&format!("M{at} 0V120")) + &line(&format!("M0 {at}H120"))
            })
            .collect();
        cases.push(Case::fill(format!("a grid of {n} lines"), page(&grid), EITHER));
        let still = line("M50 50h0").repeat(n as usize);
        cases.push(Case::fill(format!("{n} strokes without length"), page(&still), EITHER));
        let short: String = (0..n).map(|k| line(&format!("M{} {}h1e-7", k % 110, k / 110))).collect();
        cases.push(Case::fill(format!("{n} strokes of a hair"), page(&short), EITHER));
    }
    let dashes = |gap: &str| format!("<path d='M0 60H120' stroke='red' stroke-dasharray='{gap}'/>");
    for gap in ["1e-9", "1e-30", "0", "0 0", "1e9", "-1", "nan", "1e-9 1e-9 1e9", "1%"] {
        cases.push(Case::fill(format!("dashes of {gap}"), dots_and(&dashes(gap)), EITHER));
    }
    cases
}

fn mixtures() -> Vec<Case> {
    let mut cases = Vec::new();
    for n in [1_000, 20_000, 100_000] {
        let squares: String = (0..n).map(|k| format!("M{} {}h1v1h-1z", k % 317 * 2, k / 317 * 2)).collect();
        let wide = |path: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 640 640'>{path}</svg>");
        cases.push(Case::fill(format!("{n} squares in one path"), wide(&format!("<path d='{squares}'/>")), EITHER));
        let touching: String = (0..n).map(|k| format!("M{} {}h2v2h-2z", k % 317 * 2, k / 317 * 2)).collect();
        cases.push(Case::fill(
            format!("{n} touching squares in one path"),
            wide(&format!("<path d='{touching}'/>")),
            EITHER,
        ));
        let stacked = "M9 9h50v50h-50z".repeat(n);
        cases.push(Case::fill(
            format!("{n} squares at one place in one path"),
            dots_and(&format!("<path d='{stacked}'/>")),
            EITHER,
        ));
    }
    let noise: String = (0..5_000).map(|k| format!("L{} {}", k * 7919 % 1200, k * 104_729 % 1200)).collect();
    cases.push(Case::fill(
        "a filled scribble of 5 000 corners",
        format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1200 1200'><path d='M0 0{noise}z'/></svg>"),
        EITHER,
    ));
    let groups: String = (0..300).map(|k| format!("<g>{}</g>", dots().replace("cx='", &format!("cx='{k}")))).collect();
    cases.push(Case::fill("300 groups of dots", page(&groups), EITHER));
    cases.push(Case::fill("dots", dots_and(""), DONE));
    cases
}
