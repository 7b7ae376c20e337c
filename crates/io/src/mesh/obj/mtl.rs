//! MTL: the materials beside an OBJ file, as far as they are colours.

use arabesque_core::Decimals;

use crate::{
    mesh::{
        colour::linear,
        scene::{Alpha, Material},
    },
    text::short::short,
};

/// Comment that files of materials start with.
pub const MATERIALS_TITLE: &str = "# materials of elements";
/// Words of one line that are looked at.
const WORDS: usize = 16;

/// Reads materials: `newmtl`, `Kd`, `Ke`, `d` or `Tr`, `Ns`, `Pr` and `Pm`. Whatever else there is, and numbers that are none, are passed
/// over.
pub(super) fn read_materials(text: &str, most: usize) -> Vec<Material> {
    let mut found: Vec<Material> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if keyword == "newmtl" {
            if found.len() >= most {
                break;
            }
            found.push(Material { name: rest.trim().to_owned(), ..Material::default() });
            continue;
        }
        let Some(material) = found.last_mut() else { continue };
        let numbers: Vec<f64> = rest.split_whitespace().take(WORDS).map_while(|word| word.parse().ok()).collect();
        let share = |k: usize| numbers.get(k).copied().filter(|v: &f64| v.is_finite()).map(|v| v.clamp(0.0, 1.0));
        let colour = || Some([share(0)?, share(1).or(share(0))?, share(2).or(share(0))?].map(linear));
        match keyword {
            "Kd" => {
                if let Some([r, g, b]) = colour() {
                    material.base_colour = [r, g, b, material.base_colour[3]];
                }
            }
            "Ke" => material.emissive = colour().unwrap_or_default(),
            "d" | "Tr" => {
                let value = share(0).unwrap_or(1.0);
                material.base_colour[3] = if keyword == "d" { value } else { 1.0 - value };
                material.alpha = if material.base_colour[3] < 1.0 { Alpha::Blend } else { Alpha::Opaque };
            }
            // How sharp highlights are, up to 1000.
            "Ns" => {
                if let Some(value) = numbers.first().filter(|v| v.is_finite()) {
                    material.roughness = 1.0 - (value.clamp(0.0, 1000.0) / 1000.0).sqrt();
                }
            }
            "Pr" => material.roughness = share(0).unwrap_or(material.roughness),
            "Pm" => material.metallic = share(0).unwrap_or(material.metallic),
            _ => {}
        }
    }
    found
}

/// Materials as text, under the given names.
pub(super) fn materials_text<'a>(materials: impl Iterator<Item = (&'a str, &'a Material)>) -> String {
    let share = Decimals::for_extent(1.0);
    let mut out = format!("{MATERIALS_TITLE}\n");
    for (name, material) in materials {
        let [r, g, b] = material.screen_colour().map(|c| share.format(c));
        out += &format!("newmtl {name}\nKd {r} {g} {b}\n");
        if material.emissive != [0.0; 3] {
            let [r, g, b] = material.emissive.map(|c| share.format(crate::mesh::colour::srgb(c)));
            out += &format!("Ke {r} {g} {b}\n");
        }
        let numbers = [("d", material.base_colour[3]), ("Pr", material.roughness), ("Pm", material.metallic)];
        numbers.iter().for_each(|(key, value)| out += &format!("{key} {}\n", share.format(*value)));
    }
    out
}

/// A name as one word of a statement.
pub(super) fn word(name: &str) -> String {
    let word: String =
        short(name).chars().map(|c| if c.is_whitespace() || "#\\".contains(c) { '_' } else { c }).collect();
    if word.is_empty() { "part".to_owned() } else { word }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        let text = "Kd 1 1 1\nnewmtl wax red\n  Kd 0.5 0.25 0\nd 0.5\nPr 0.3\nNs x\nmap_Kd a.png\nnewmtl b\nKd 0.5\n";
        let found = read_materials(text, 10);
        assert_eq!((found.len(), found[0].name.as_str(), found[0].alpha), (2, "wax red", Alpha::Blend));
        let colour = found[0].screen_colour();
        assert!((colour[0] - 0.5).abs() < 1e-9 && (colour[1] - 0.25).abs() < 1e-9 && found[0].roughness == 0.3);
        assert!((found[1].screen_colour()[2] - 0.5).abs() < 1e-9);
        let back = read_materials(&materials_text([("wax", &found[0])].into_iter()), 10);
        assert!((back[0].base_colour[1] - found[0].base_colour[1]).abs() < 1e-6);
        assert_eq!(read_materials(text, 1).len(), 1);
        assert_eq!(word("a b#"), "a_b_");
    }
}
