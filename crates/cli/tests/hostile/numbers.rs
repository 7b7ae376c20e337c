//! Numbers out of range wherever a drawing may have one.

use crate::case::{Case, EITHER, dots_and};

/// Values that are not sensible anywhere.
const VALUES: [&str; 12] = [
    "1e9",
    "1e20",
    "1e38",
    "1e154",
    "1e200",
    "1e308",
    "1e309",
    "-1e155",
    "nan",
    "inf",
    "1e-320",
    "99999999999999999999999999999999",
];

/// Where they are put.
const PLACES: [(&str, &str); 17] = [
    ("radius", "<circle cx='5' cy='5' r='#'/>"),
    ("radii", "<ellipse cx='5' cy='5' rx='#' ry='1e-200'/>"),
    ("centre", "<circle cx='#' cy='#' r='5'/>"),
    ("width", "<rect width='#' height='3'/>"),
    ("corner", "<rect width='9' height='3' rx='#'/>"),
    ("path", "<path d='M0 0L# 4L4 #z'/>"),
    ("curve", "<path d='M0 0C# 4 4 # 9 9z'/>"),
    ("arc", "<path d='M0 0A# # 0 1 1 9 9z'/>"),
    ("turned arc", "<path d='M0 0A9 9 # 1 1 9 9z'/>"),
    ("points", "<polygon points='0,0 #,4 4,#'/>"),
    ("stroke", "<path d='M0 0L9 9' stroke='red' stroke-width='#'/>"),
    ("miter", "<path d='M0 0L9 9L0 1' stroke='red' stroke-miterlimit='#'/>"),
    ("scale", "<g transform='scale(#)'><circle r='5'/></g>"),
    (
        "nested scales",
        "<g transform='scale(#)'><g transform='scale(#)'><g transform='scale(#)'><circle r='5'/></g></g></g>",
    ),
    ("turn", "<circle r='5' cx='9' transform='rotate(#)'/>"),
    ("matrix", "<circle r='5' transform='matrix(# 0 0 # # 1)'/>"),
    ("nested view", "<svg width='#' height='9' viewBox='0 0 # 3'><circle r='5'/></svg>"),
];

pub(crate) fn cases() -> Vec<Case> {
    let every = PLACES.iter().flat_map(|(place, markup)| {
        VALUES
            .iter()
            .map(move |value| Case::fill(format!("{place} {value}"), dots_and(&markup.replace('#', value)), EITHER))
    });
    let views = VALUES.iter().flat_map(|value| {
        let root = |attributes: String| format!("<svg xmlns='http://www.w3.org/2000/svg' {attributes}><circle r='5'/><circle cx='30' r='5'/><circle cy='30' r='4'/></svg>");
        [
            Case::fill(format!("view {value}"), root(format!("viewBox='0 0 {value} 120'")), EITHER),
            Case::fill(format!("corner of the view {value}"), root(format!("viewBox='{value} 0 120 120'")), EITHER),
            Case::fill(format!("page {value}"), root(format!("width='{value}' height='{value}'")), EITHER),
        ]
    });
    every.chain(views).collect()
}
