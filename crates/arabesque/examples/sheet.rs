//! Lays drawings out on one sheet, each with a label: `sheet OUT.png COLUMNS FILE[=LABEL] ...`, row by row.
//!
//! Files are SVG or PNG; OUT ends in `.png` or `.svg`. A label may hold letters, digits and a few signs; `-` in place of a file leaves
//! its cell empty. `cargo run --release -p arabesque --example sheet -- sheet.png 2 examples/lace.svg=exemplar lace.svg=result`

use std::{fmt::Write, fs};

use arabesque::{
    Budget,
    io::raster::png::{RenderJob, Resolution, is_png, write_png},
};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const USAGE: &str = "usage: sheet OUT.png|OUT.svg COLUMNS FILE[=LABEL] ...";

/// Side of a drawing on the sheet, distance of drawings, and height of the line with the label.
const CELL: [usize; 3] = [160, 8, 16];

/// Side of a dot of a letter.
const DOT: f64 = 1.4;

/// Letters of three by five dots: the rows from the top, three bits each.
const LETTERS: &[(char, u16)] = &[
    ('A', 0b010_101_111_101_101),
    ('B', 0b110_101_110_101_110),
    ('C', 0b011_100_100_100_011),
    ('D', 0b110_101_101_101_110),
    ('E', 0b111_100_110_100_111),
    ('F', 0b111_100_110_100_100),
    ('G', 0b011_100_101_101_011),
    ('H', 0b101_101_111_101_101),
    ('I', 0b111_010_010_010_111),
    ('J', 0b001_001_001_101_010),
    ('K', 0b101_110_100_110_101),
    ('L', 0b100_100_100_100_111),
    ('M', 0b101_111_111_101_101),
    ('N', 0b110_101_101_101_101),
    ('O', 0b010_101_101_101_010),
    ('P', 0b110_101_110_100_100),
    ('Q', 0b010_101_101_110_011),
    ('R', 0b110_101_110_101_101),
    ('S', 0b011_100_010_001_110),
    ('T', 0b111_010_010_010_010),
    ('U', 0b101_101_101_101_111),
    ('V', 0b101_101_101_101_010),
    ('W', 0b101_101_111_111_101),
    ('X', 0b101_101_010_101_101),
    ('Y', 0b101_101_010_010_010),
    ('Z', 0b111_001_010_100_111),
    ('0', 0b111_101_101_101_111),
    ('1', 0b010_110_010_010_111),
    ('2', 0b110_001_010_100_111),
    ('3', 0b110_001_010_001_110),
    ('4', 0b101_101_111_001_001),
    ('5', 0b111_100_110_001_110),
    ('6', 0b011_100_111_101_111),
    ('7', 0b111_001_010_010_010),
    ('8', 0b111_101_111_101_111),
    ('9', 0b111_101_111_001_110),
    ('-', 0b000_000_111_000_000),
    ('.', 0b000_000_000_000_010),
    (',', 0b000_000_000_010_100),
    (':', 0b000_010_000_010_000),
    ('+', 0b000_010_111_010_000),
    ('=', 0b000_111_000_111_000),
];

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, columns, entries @ ..] = arguments.as_slice() else { return Err(USAGE.into()) };
    let columns: usize = columns.parse().ok().filter(|c| (1..=64).contains(c)).ok_or(USAGE)?;
    let [side, gap, line] = CELL;
    let rows = entries.len().div_ceil(columns).max(1);
    let (width, height) = (columns * (side + gap) + gap, rows * (side + line + gap) + gap);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (k, entry) in entries.iter().enumerate() {
        let corner = [gap + k % columns * (side + gap), gap + k / columns * (side + line + gap)];
        let (file, label) = entry.split_once('=').unwrap_or((entry, ""));
        write_label(&mut svg, label, corner)?;
        if file != "-" {
            let source = embedded(&fs::read(file).map_err(|e| format!("{file}: {e}"))?);
            let [x, y] = [corner[0], corner[1] + line];
            // The nested drawing cuts off what reaches out of its page.
            let place = format!("width=\"{side}\" height=\"{side}\"");
            writeln!(svg, "<svg x=\"{x}\" y=\"{y}\" {place}><image {place} href=\"{source}\"/></svg>")?;
        }
    }
    svg.push_str("</svg>\n");
    if out.ends_with(".svg") {
        return Ok(fs::write(out, svg)?);
    }
    let plate = RenderJob {
        svg: &svg,
        units: [width as f64, height as f64],
        resolution: Resolution::PerUnit(1.0),
        recipe: None,
    };
    Ok(fs::write(out, write_png(&plate, &Budget::default())?)?)
}

/// A file as the address of an image: drawings inside images keep their names and styles to themselves.
fn embedded(bytes: &[u8]) -> String {
    let kind = if is_png(bytes) { "image/png" } else { "image/svg+xml" };
    let mut address = format!("data:{kind},");
    for &byte in bytes {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'-' | b',' | b' ' | b'/' | b'=' => {
                address.push(char::from(byte));
            }
            // Writing to a string cannot fail.
            _ => _ = write!(address, "%{byte:02X}"),
        }
    }
    address
}

/// Draws a label, so that the sheet needs no font.
fn write_label(svg: &mut String, label: &str, [x, y]: [usize; 2]) -> Result<()> {
    svg.push_str("<path fill=\"#333333\" d=\"");
    for (k, letter) in label.to_uppercase().chars().enumerate() {
        let bits = match LETTERS.iter().find(|(l, _)| *l == letter) {
            Some((_, bits)) => *bits,
            None if letter == ' ' => 0,
            None => return Err(format!("the label `{label}` holds `{letter}`, for which there is no letter").into()),
        };
        for dot in (0..15).filter(|dot| bits >> (14 - dot) & 1 == 1) {
            let left = x as f64 + DOT * (4 * k + dot % 3) as f64;
            let top = y as f64 + 4.0 + DOT * (dot / 3) as f64;
            write!(svg, "M{left:.1},{top:.1}h{DOT}v{DOT}h-{DOT}z")?;
        }
    }
    svg.push_str("\"/>\n");
    Ok(())
}
