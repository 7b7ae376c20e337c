//! Every way of reading a drawing, with checks of what comes out.

use std::sync::LazyLock;

use arabesque_core::Budget;
use arabesque_io::svg::{
    Drawing, Method, ReadOptions, read_areas, read_exemplar, read_flow, read_lines, read_placed, read_shape,
};

use crate::{check, limits};

/// An exemplar that kept files are matched to.
static EXEMPLAR: LazyLock<Option<Drawing>> = LazyLock::new(|| {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><circle cx='2' cy='2' r='1'/><path d='M5 5h2l2 3z'/></svg>";
    read_exemplar(text, &ReadOptions::new("exemplar.svg")).ok()
});

/// Reads a drawing as an exemplar and in one other way at most; `which` chooses. One or two ways a run: more runs a second find more.
pub fn drawing(text: &str, which: usize) {
    let method = [Method::Auto, Method::Elements, Method::Curves][which % 3];
    let options = ReadOptions { method, budget: Budget::new(limits()), ..ReadOptions::new("fuzz.svg") };
    if let Ok(drawing) = read_exemplar(text, &options) {
        check::drawing(&drawing);
    }
    let options = ReadOptions { budget: Budget::new(limits()), ..options };
    match (which / 2 % 6, &*EXEMPLAR) {
        (0, _) => drop(read_shape(text, None, &options)),
        (1, _) => drop(read_flow(text, &options)),
        (2, Some(drawing)) => {
            if let Ok(placed) = read_placed(text, drawing, &options) {
                let all = placed.fragments.iter().chain(&placed.obstacle_fragments);
                check::fragments(&placed.definitions, all, None);
            }
        }
        (3, _) => {
            if let Ok(lines) = read_lines(text, None, &options) {
                assert!(!lines.paths.is_empty());
                assert!(lines.paths.iter().flat_map(|(_, path)| path.cubics.iter().flatten()).all(|p| p.is_finite()));
            }
        }
        (4, _) => {
            if let Ok(taken) = read_areas(text, &options) {
                assert!(taken.areas.iter().all(|a| a.outline.points().all(|p| p.is_finite()) && a.opacity <= 1.0));
            }
        }
        _ => {}
    }
}

/// Text as the value of an XML attribute in double quotes; what XML cannot hold becomes a space.
pub fn attribute(text: &str) -> String {
    let plain = |c: char| if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c };
    let text: String = text.chars().map(plain).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
