//! Centre lines of filled outlines that are strokes of constant width in truth: networks, closed rings and lines that a drawing program
//! has turned into outlines.
//!
//! The outline is drawn as pixels, thinned to lines of one pixel and traced to a graph of nodes and lines (`graph`). What thinning
//! leaves of caps and corners is pruned, junctions that are one are merged. Then the pixels have done their work: places along the lines
//! move to the middle between the borders of the true outline (`stations`), nodes to where their lines meet (`nodes`), corners to
//! where the lines before and after them cross (`corners`). Smooth cubics and exactly straight segments are laid through (`fit`).
//! A shape is refused when its width is not constant or when strokes along the lines would not cover it.

mod border;
mod chains;
mod corners;
mod fit;
mod graph;
mod nodes;
mod raster;
mod stations;

use arabesque_core::{Bounds, Outline, Path, Vector};

use self::{
    border::Border,
    graph::{Graph, Line},
    raster::Raster,
};

/// Pixels a width that are tried in turn, until the picture is small enough.
const PIXELS: [f64; 3] = [9.0, 7.0, 5.0];
/// Most pixels of a picture.
const MOST_PIXELS: f64 = 6e7;
/// Largest spread of the width.
const MOST_SPREAD: f64 = 0.18;
/// Least length of all lines together, in widths.
const LEAST_LENGTH: f64 = 3.0;
/// Most length of all lines together, in widths: more are slivers that rounding has left.
const MOST_LENGTH: f64 = 2e5;
/// Largest share of the ink that strokes of the common width may leave open.
const MOST_OPEN: f64 = 0.03;
/// Radius in widths that a place on a line covers: more than half, for the corners of butt ends and mitres.
const COVER: f64 = 0.85;

/// Strokes with round caps and mitred corners that cover an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Centrelines {
    /// Long strokes through the junctions, in the order of their first pixels; smooth between corners, straight runs one segment.
    pub paths: Vec<Path<2>>,
    /// Common width of the strokes.
    pub width: f64,
    /// How much the width varies: from its first to its last decile, as a share of the median.
    pub spread: f64,
}

/// The centre lines of an outline; `None` where the outline is no set of strokes of one width, is degenerate or too vast.
///
/// Strokes that end on the side of `frame` run up to it; all others end half a width before the tip, where a round cap begins.
pub fn centrelines(outline: &Outline<2>, frame: Option<&Bounds<2>>) -> Option<Centrelines> {
    let estimate = estimated_width(outline)?;
    let (raster, pixel) =
        PIXELS.iter().find_map(|n| Some((Raster::new(outline, estimate / n, MOST_PIXELS)?, estimate / n)))?;
    let mut thin = raster.clone();
    thin.thin();
    let mut graph = Graph::trace(&thin);
    let border = Border::new(outline, estimate);
    graph.tidy(estimate, |line| is_spur(line, &border, estimate), |line| line.length() < 0.75 * estimate);
    let (mut tracks, width) = stations::centred(&graph, &border, (estimate, pixel), frame);
    let widths = stations::free_widths(&tracks, &graph, width, frame);
    let quantile = |share: f64| widths.get((share * widths.len() as f64) as usize).copied();
    let spread = (quantile(0.9)? - quantile(0.1)?) / width;
    let length: f64 = graph.lines.iter().map(Line::length).sum();
    if !spread.is_finite() || spread > MOST_SPREAD || !(LEAST_LENGTH..MOST_LENGTH).contains(&(length / width)) {
        return None;
    }
    nodes::settle(&mut graph, &mut tracks, &border, (width, frame));
    let paths: Vec<Path<2>> = chains::chained(&graph, &tracks, width)
        .iter()
        .map(|(chain, closed)| fit::fitted(&corners::with_corners(chain, *closed, width), *closed, width))
        .filter(|path| !path.is_empty() && path.cubics.iter().flatten().all(|p| p.is_finite()))
        .collect();
    (!paths.is_empty() && covers(&paths, raster, width)).then_some(Centrelines { paths, width, spread })
}

/// Whether a line from a junction to a free end only points into a corner of a cap or a mitre: it is short, or it tapers.
fn is_spur(line: &Line, border: &Border, width: f64) -> bool {
    let length = line.length();
    let (Some(&start), Some(&end)) = (line.points.first(), line.points.last()) else { return true };
    if length < 0.8 * width || length > 2.0 * width || (end - start).norm() < 0.5 * length {
        return length < 0.8 * width;
    }
    let way = (end - start) * (1.0 / (end - start).norm());
    let side = Vector::xy(-way[1], way[0]);
    let at = start + (end - start) * 0.8;
    let across: f64 = [side, -side].iter().map(|&d| border.reach(at, d, width).unwrap_or(width)).sum();
    (across - width).abs() > 0.25 * width
}

/// Twice the area over the length of the border; `None` where there is no area.
fn estimated_width(outline: &Outline<2>) -> Option<f64> {
    if !outline.points().all(|p| p.is_finite()) {
        return None;
    }
    let perimeter: f64 = outline.edges().map(|(a, b)| (b - a).norm()).sum();
    let width = 2.0 * outline.area() / perimeter;
    (width.is_finite() && width > 1e-9 * outline.bounds().size().norm()).then_some(width)
}

/// Whether strokes along the paths leave next to no ink open.
fn covers(paths: &[Path<2>], mut raster: Raster, width: f64) -> bool {
    let all = raster.pixels().len();
    for path in paths {
        let points = path.flatten(0.05 * width);
        for at in stations::evenly(&points, false, stations::STEP * width) {
            raster.erase_disc(at, COVER * width);
        }
    }
    raster.pixels().len() as f64 <= MOST_OPEN * all as f64
}

#[cfg(test)]
mod tests;
