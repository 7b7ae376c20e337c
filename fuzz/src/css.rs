//! Feeds an arbitrary style sheet, then after a line `%%` an arbitrary style attribute, and after another one single attributes, a line
//! each (`stroke-width: 3`), to a drawing that has something of every kind.
#![no_main]

use arabesque_fuzz::read;
use libfuzzer_sys::fuzz_target;

/// Attributes that may be set by themselves.
const ATTRIBUTES: [&str; 16] = [
    "fill",
    "stroke",
    "stroke-width",
    "stroke-dasharray",
    "stroke-dashoffset",
    "stroke-linecap",
    "stroke-linejoin",
    "stroke-miterlimit",
    "transform",
    "clip-path",
    "opacity",
    "fill-rule",
    "display",
    "visibility",
    "class",
    "color",
];

fuzz_target!(|data: &[u8]| {
    let Some((&which, data)) = data.split_first() else { return };
    let Ok(text) = std::str::from_utf8(data) else { return };
    let mut parts = text.splitn(3, "\n%%\n");
    let [sheet, style, single] = [(); 3].map(|()| parts.next().unwrap_or_default());
    let sheet = read::attribute(sheet);
    let style = read::attribute(style);
    let single: String = ATTRIBUTES
        .iter()
        .filter_map(|name| {
            let value = single.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
            Some(format!(" {name}=\"{}\"", read::attribute(value)))
        })
        .collect();
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 99 99'><style>{sheet}</style><defs>\
         <linearGradient id='paint'><stop offset='0' style=\"{style}\"/><stop offset='1' class='a'/></linearGradient>\
         <clipPath id='clip'><circle class='b' r='20'/></clipPath><rect id='used' class='c' width='4' height='3'/></defs>\
         <g class='a b' id='group' style=\"{style}\"><rect class='a' x='10' y='10' width='9' height='9'/>\
         <path class='b' d='M30 30 40 35 30 45' fill='none' stroke='red'/><use href='#used' x='50' y='50'/></g>\
         <ellipse id='one' cx='70' cy='70' rx='5' ry='4'{single}/><line class='a c' x2='9' y2='90' stroke='blue' style=\"{style}\"/></svg>"
    );
    read::drawing(&svg, usize::from(which));
});
