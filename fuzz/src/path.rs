//! Feeds arbitrary path data to the reader, in one or several paths (a line each) that are filled, stroked, dashed or clip others.
#![no_main]

use arabesque_fuzz::read;
use libfuzzer_sys::fuzz_target;

/// What is said of a path beside its data.
const LOOKS: [&str; 8] = [
    "",
    "fill-rule='evenodd'",
    "fill='none' stroke='red'",
    "fill='none' stroke='red' stroke-width='3' stroke-linejoin='round' stroke-linecap='round'",
    "fill='none' stroke='red' stroke-width='0.1' stroke-dasharray='1 0.5 2'",
    "stroke='red' stroke-width='40' stroke-linejoin='miter' stroke-miterlimit='100'",
    "transform='matrix(1 2 -3 4 5 6)' stroke='red' vector-effect='non-scaling-stroke'",
    "clip-path='url(#clip)' fill='#123'",
];

fuzz_target!(|data: &[u8]| {
    let Some((&which, data)) = data.split_first() else { return };
    let Ok(text) = std::str::from_utf8(data) else { return };
    let look = LOOKS[usize::from(which) % LOOKS.len()];
    let paths: String = text.lines().map(|d| format!("<path d=\"{}\" {look}/>", read::attribute(d))).collect();
    let clip = text.lines().next().map(read::attribute).unwrap_or_default();
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 99 99'><clipPath id='clip'><path d=\"{clip}\"/></clipPath>{paths}</svg>"
    );
    read::drawing(&svg, usize::from(which / 8));
});
