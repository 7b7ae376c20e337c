//! OBJ: ribbons as triangles with texture coordinates, and a material for each picture.

use arabesque_core::{Budget, Decimals, Result};

use crate::{mesh::strip::Part, table::records};

/// Comment that files of strips start with.
pub const TITLE: &str = "# ribbons as textured strips";

/// Work and bytes of the lines of one corner.
const CORNER: u64 = 1_500;
const BYTES: usize = 120;

/// Writes strips as triangles with texture coordinates, those of each picture under a material (`usemtl exemplar-1`,
/// ...) whose picture a comment names: an OBJ file cannot hold pictures. `extent` sets the number of digits. Parts
/// without triangles are left out.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to
/// stop.
pub fn write_strips(parts: &[Part], extent: f64, recipe: Option<&str>, budget: &Budget) -> Result<String> {
    let corners: usize = parts.iter().map(|part| part.strip.positions.len()).sum();
    let _held = budget.hold("the text of the strips", corners.saturating_mul(2 * BYTES))?;
    let (d, t) = (Decimals::for_extent(extent), Decimals::for_extent(1.0));
    let mut out = format!("{TITLE}\n");
    let mut before = 0;
    for (k, part) in parts.iter().enumerate().filter(|(_, part)| !part.strip.triangles.is_empty()) {
        let name = part.name.replace(['\n', '\r'], " ");
        out += &format!("# picture of exemplar-{}: {name}\n", k + 1);
        for p in &part.strip.positions {
            budget.spend(CORNER)?;
            out += &format!("v {}\n", p.map(|v| d.format(v)).join(" "));
        }
        for [u, v] in &part.strip.texture {
            out += &format!("vt {} {}\n", t.format(*u), t.format(1.0 - v));
        }
        out += &format!("usemtl exemplar-{}\n", k + 1);
        for corners in &part.strip.triangles {
            let corners = corners.map(|c| c as usize + before + 1);
            out += &format!("f {}\n", corners.map(|c| format!("{c}/{c}")).join(" "));
        }
        before += part.strip.positions.len();
    }
    Ok(out + &recipe.map(records::recipe_comments).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::strip::Strip;

    #[test]
    fn triangles_refer_to_their_own_corners() {
        let corner = |x: f64, y: f64| ([x, y, 0.0], [x, y]);
        let mut strip = Strip::default();
        strip.push([corner(0.0, 0.0), corner(1.0, 0.0)], [corner(0.0, 1.0), corner(1.0, 1.0)]);
        let part = |name: &str| Part { name: name.into(), picture: Vec::new(), strip: strip.clone() };
        let text = write_strips(&[part("a.png"), part("b.png")], 1.0, Some("seed = 3\n"), &Budget::default()).unwrap();
        assert!(text.contains("# picture of exemplar-2: b.png\n"));
        assert!(text.contains("usemtl exemplar-2\nf 5/5 7/7 6/6\nf 6/6 7/7 8/8\n"));
        assert!(text.contains("vt 0 1\n"));
        assert_eq!(records::recipe_of(&text).unwrap(), "seed = 3\n");
    }
}
