//! Pictures as fields, as areas to avoid and as exemplars.

use crate::case::{Case, DONE, EITHER, REFUSED, dots_and};

/// A picture of one colour.
pub(crate) fn flat(width: u32, height: u32, colour: png::ColorType, depth: png::BitDepth) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let row = (width as usize * colour.samples() * depth as usize).div_ceil(8);
    let mut writer = encoder.write_header().unwrap();
    let mut stream = writer.stream_writer().unwrap();
    let line: Vec<u8> = (0..row).map(|k| (k * 31 % 251) as u8).collect();
    for _ in 0..height {
        std::io::Write::write_all(&mut stream, &line).unwrap();
    }
    stream.finish().unwrap();
    drop(writer);
    bytes
}

/// A picture that says it is of another size.
fn lying(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = flat(4, 4, png::ColorType::Grayscale, png::BitDepth::Eight);
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = crc(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

/// The check sum of a chunk.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 })
    })
}

fn chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [&kind[..], data].concat();
    [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
}

fn pictures() -> Vec<(String, Vec<u8>, &'static [i32])> {
    use png::{BitDepth as D, ColorType as C};
    let whole = flat(40, 30, C::Rgb, D::Eight);
    let mut all = vec![
        ("a picture".to_owned(), whole.clone(), DONE),
        ("one pixel".into(), flat(1, 1, C::Grayscale, D::Eight), EITHER),
        ("10 000 x 10 000 in black and white".into(), flat(10_000, 10_000, C::Grayscale, D::One), DONE),
        ("5 000 x 5 000 of 16 bits".into(), flat(5_000, 5_000, C::Rgba, D::Sixteen), DONE),
        ("a line of 30 000".into(), flat(30_000, 1, C::Grayscale, D::Eight), EITHER),
        ("a column of 30 000".into(), flat(1, 30_000, C::Grayscale, D::Eight), EITHER),
        ("an empty file".into(), Vec::new(), REFUSED),
        ("a signature".into(), b"\x89PNG\r\n\x1a\n".to_vec(), REFUSED),
        ("GIF".into(), b"GIF89a".to_vec(), REFUSED),
        ("JPEG".into(), vec![0xFF, 0xD8, 0xFF, 0xE0], REFUSED),
        ("SVG".into(), b"<svg/>".to_vec(), REFUSED),
        ("zeros".into(), vec![0; 4096], REFUSED),
    ];
    for (w, h) in [
        (0, 4),
        (4, 0),
        (60_000, 60_000),
        (u32::MAX, 1),
        (1 << 31, 1 << 31),
        (9_999, 9_999),
        (4, 5),
        (i32::MAX as u32, 2),
    ] {
        all.push((format!("a picture that says it is {w} x {h}"), lying(w, h), REFUSED));
    }
    for share in [20, 60, 95] {
        all.push((format!("{share} per cent of a picture"), whole[..whole.len() * share / 100].to_vec(), REFUSED));
    }
    for kind in [*b"zTXt", *b"iTXt", *b"iCCP", *b"tEXt", *b"eXIf", *b"PLTE", *b"tRNS", *b"fcTL", *b"acTL"] {
        let strange = chunk(kind, &[0x78; 3000]);
        let name = String::from_utf8_lossy(&kind).into_owned();
        all.push((format!("a strange {name}"), [&whole[..33], &strange, &whole[33..]].concat(), EITHER));
        let cut = [&whole[..33], &u32::MAX.to_be_bytes(), &kind, &whole[33..]].concat();
        all.push((format!("an endless {name}"), cut, REFUSED));
    }
    all
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, bytes, codes) in pictures() {
        for field in ["density", "orient"] {
            let line = format!("fill in.svg --size 100x100 --{field} p.png -o out.svg");
            let codes = if field == "orient" && codes == DONE { EITHER } else { codes };
            cases.push(
                Case::new(format!("{name} as {field}"), line, codes)
                    .with("in.svg", dots_and(""))
                    .with("p.png", bytes.clone()),
            );
        }
        let codes = if codes == REFUSED { REFUSED } else { EITHER };
        let curve = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 100'><path d='M10 50H190' fill='none' stroke='red'/></svg>";
        let line = "ribbon p.png --along c.svg -o out.svg";
        cases.push(Case::new(format!("{name} as a strip"), line, codes).with("p.png", bytes).with("c.svg", curve));
    }
    for range in ["0..1", "1..0", "nan..1", "0..inf", "-1..1", "1e300..1e308", "..", "1", "0.5..0.5"] {
        let line = format!("fill in.svg --size 100x100 --scale p.png@{range} -o out.svg");
        let picture = flat(8, 8, png::ColorType::Grayscale, png::BitDepth::Eight);
        cases.push(
            Case::new(format!("a range of {range}"), line, &[0, 2, 3, 4])
                .with("in.svg", dots_and(""))
                .with("p.png", picture),
        );
    }
    cases
}
