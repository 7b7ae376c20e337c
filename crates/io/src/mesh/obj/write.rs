//! Curves in space as OBJ: polylines grouped by style, and the recipe in comment lines at the end.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Decimals, Drawn, Exemplar, Vector};

use crate::table::records;

/// What [`write_curves`] says beside the curves.
#[derive(Clone, Copy, Debug)]
pub struct Sheet<'a> {
    /// The box that was filled; its size sets the number of digits.
    pub frame: Bounds<3>,
    /// How far a polyline may lie from its curve.
    pub tolerance: f64,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
}

/// Writes curves as polylines, grouped by style, with six significant digits of the frame. Equal points are one vertex.
pub fn write_curves(exemplar: &Exemplar<3>, curves: &[Drawn<3>], sheet: &Sheet<'_>) -> String {
    let size = sheet.frame.size();
    let decimals = Decimals::for_extent(size.0.into_iter().fold(0.0, f64::max));
    let mut vertices = Vertices { decimals, numbers: BTreeMap::new(), listed: String::new() };
    let mut lines = String::new();
    for (style, class) in exemplar.styles.iter().enumerate() {
        let of_style = |c: &&Drawn<3>| exemplar.curves.get(c.source).is_some_and(|s| s.style == style);
        let members: Vec<_> = curves.iter().filter(of_style).collect();
        if !members.is_empty() {
            lines += &format!("g {}\n", class.name);
        }
        for drawn in members {
            let mut numbers: Vec<usize> =
                drawn.path.flatten(sheet.tolerance).into_iter().map(|p| vertices.number(p)).collect();
            numbers.dedup();
            if numbers.len() > 1 {
                let list: Vec<String> = numbers.iter().map(usize::to_string).collect();
                lines += &format!("l {}\n", list.join(" "));
            }
        }
    }
    let frame = format!("# box {} {}\n", vertices.text(sheet.frame.min), vertices.text(sheet.frame.max));
    let recipe = sheet.recipe.map(records::recipe_comments).unwrap_or_default();
    format!("# curves as polylines\n{frame}{}{lines}{recipe}", vertices.listed)
}

/// The vertices of a file, numbered from one.
struct Vertices {
    decimals: Decimals,
    numbers: BTreeMap<String, usize>,
    listed: String,
}

impl Vertices {
    fn text(&self, p: Vector<3>) -> String {
        p.0.map(|v| self.decimals.format(v)).join(" ")
    }

    fn number(&mut self, p: Vector<3>) -> usize {
        let text = self.text(p);
        let next = self.numbers.len() + 1;
        if let Some(&known) = self.numbers.get(&text) {
            return known;
        }
        self.listed += &format!("v {text}\n");
        self.numbers.insert(text, next);
        next
    }
}

/// The recipe in the comments of an OBJ file that this library wrote. Quotes in it are letters like any other.
pub fn recipe_of(text: &str) -> Option<String> {
    records::recipe_behind(text, |line| line == records::RECIPE_MARK)
}
