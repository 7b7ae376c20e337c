//! Centre lines of filled outlines that are strokes of constant width, really: networks, closed rings and lines that a
//! drawing program has turned into outlines.
//!
//! The outline is drawn as pixels, thinned to lines of one pixel and traced to a graph of nodes and lines (`graph`).
//! What thinning leaves of caps and corners is pruned, junctions that are one are merged. Then the pixels have done
//! their work: places along the lines move to the middle between the borders of the true outline (`stations`), nodes to
//! where their lines meet (`nodes`), corners to where the lines before and after them cross (`corners`). Smooth cubics
//! and exactly straight segments are laid through (`fit`). A shape is refused when its width is not constant or when
//! strokes along the lines would not cover it.

mod border;
mod chains;
mod corners;
mod fit;
mod graph;
mod nodes;
mod raster;
mod stations;

use arabesque_core::{Bounds, Budget, Outline, Path, Result, Vector};

use self::{
    border::OutlineBorder,
    graph::{Graph, Line},
    raster::Raster,
    stations::Track,
};

/// Pixels per width that are tried in turn, until the picture is small enough.
const PIXELS: [f64; 3] = [9.0, 7.0, 5.0];
/// Most pixels of a picture.
const MAX_PIXELS: f64 = 6e7;
/// Bytes and work for each of them.
const BYTES: usize = 12;
const PER_PIXEL: u64 = 20;
/// Largest spread of the width.
const MAX_SPREAD: f64 = 0.18;
/// Least length of all lines together, in widths.
const MIN_LENGTH: f64 = 3.0;
/// Most length of all lines together, in widths: more are slivers that rounding has left.
const MAX_LENGTH: f64 = 2e5;
/// Largest share of the ink that strokes of the common width may leave open, and of what is theirs that may be no ink.
const MAX_OPEN: f64 = 0.03;
/// Radius in widths around a place on a line that holds nothing but ink: less than half, for what the pixels leave out.
const CORE: f64 = 0.35;
/// Distance in widths from the sides of the frame within which the middle of a line along them is only that of the part
/// that the frame has left of it.
const HALVED: f64 = 0.45;
/// Distance in widths from the sides of the frame up to which ink may be such a part.
const RIM: f64 = 0.75;
/// Radius in widths that a place on a line covers: more than half, for the corners of butt ends and mitres.
const COVER: f64 = 0.85;

/// Strokes with round caps and mitred corners that cover an outline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Centrelines {
    /// Long strokes through the junctions, in the order of their first pixels; smooth between corners, straight runs
    /// one segment.
    pub(crate) paths: Vec<Path<2>>,
    /// Common width of the strokes.
    pub(crate) width: f64,
    /// How much the width varies: from its first to its last decile, as a share of the median.
    pub(crate) spread: f64,
}

/// The centre lines of an outline; `None` where the outline is not a set of strokes of one width, is degenerate or too
/// vast.
///
/// Strokes that end on the side of `frame` run up to it; all others end half a width before the tip, where a round cap
/// begins. What is left of strokes that run along a side of it is dropped.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or memory for it is used up.
pub(crate) fn centrelines(
    outline: &Outline<2>,
    frame: Option<&Bounds<2>>,
    budget: &Budget,
) -> Result<Option<Centrelines>> {
    let Some(estimate) = estimated_width(outline) else { return Ok(None) };
    let drawn = |n: &f64| Some((Raster::new(outline, estimate / n, MAX_PIXELS)?, estimate / n));
    let Some((raster, pixel)) = PIXELS.iter().find_map(drawn) else { return Ok(None) };
    let pixels = raster.ink.len();
    let _held = budget.hold("centre lines", BYTES * pixels)?;
    budget.spend(PER_PIXEL * pixels as u64)?;
    let mut thin = raster.clone();
    thin.thin(budget)?;
    Ok(followed(outline, Drawn { raster, thin, estimate, pixel }, frame))
}

/// An outline as pixels.
struct Drawn {
    raster: Raster,
    /// The same, thinned to lines.
    thin: Raster,
    /// About the width of the strokes.
    estimate: f64,
    /// Side of a pixel.
    pixel: f64,
}

/// The lines that the pixels lead to.
fn followed(outline: &Outline<2>, drawn: Drawn, frame: Option<&Bounds<2>>) -> Option<Centrelines> {
    let Drawn { raster, thin, estimate, pixel } = drawn;
    let mut graph = Graph::trace(&thin);
    let border = OutlineBorder::new(outline, estimate);
    graph.tidy(estimate, |line| is_spur(line, &border, estimate), |line| line.length() < 0.75 * estimate);
    let (mut tracks, width) = stations::centred(&graph, &border, estimate, pixel, frame);
    let widths = stations::free_widths(&tracks, &graph, width, frame);
    let quantile = |share: f64| widths.get((share * widths.len() as f64) as usize).copied();
    let spread = (quantile(0.9)? - quantile(0.1)?) / width;
    let length: f64 = graph.lines.iter().map(Line::length).sum();
    if !spread.is_finite() || spread > MAX_SPREAD || !(MIN_LENGTH..MAX_LENGTH).contains(&(length / width)) {
        return None;
    }
    drop_halved(&mut graph, &mut tracks, width, frame);
    nodes::settle(&mut graph, &mut tracks, &border, width, frame);
    let paths: Vec<Path<2>> = chains::chained(&graph, &tracks, width)
        .iter()
        .map(|(chain, closed)| fit::fitted(&corners::with_corners(chain, *closed, width), *closed, width))
        .filter(|path| !path.is_empty() && path.cubics.iter().flatten().all(|p| p.is_finite()))
        .collect();
    (!paths.is_empty() && fits(&paths, &raster, width) && covers(&paths, raster, width, frame)).then_some(Centrelines {
        paths,
        width,
        spread,
    })
}

/// Whether a line from a junction to a free end only points into a corner of a cap or a mitre: it is short, or it
/// tapers.
fn is_spur(line: &Line, border: &OutlineBorder, width: f64) -> bool {
    let length = line.length();
    let (Some(&start), Some(&end)) = (line.points.first(), line.points.last()) else { return true };
    if length < 0.8 * width || length > 2.0 * width || (end - start).norm() < 0.5 * length {
        return length < 0.8 * width;
    }
    let way = (end - start).unit();
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

/// Whether strokes along the paths cover next to nothing but ink.
fn fits(paths: &[Path<2>], raster: &Raster, width: f64) -> bool {
    let (mut blank, mut all) = (0, 0);
    for path in paths {
        for at in stations::evenly(&path.flatten(0.05 * width), false, stations::STEP * width) {
            let (outside, pixels) = raster.blank_in_disc(at, CORE * width);
            blank += outside;
            all += pixels;
        }
    }
    blank as f64 <= MAX_OPEN * all as f64
}

/// Whether strokes along the paths leave next to no ink open.
fn covers(paths: &[Path<2>], mut raster: Raster, width: f64, frame: Option<&Bounds<2>>) -> bool {
    let ink = |raster: &Raster| {
        let pixels = raster.pixels().into_iter();
        pixels.filter(|&p| !is_within(raster.centre(p), frame, RIM * width)).count() as f64
    };
    let all = ink(&raster);
    for path in paths {
        let points = path.flatten(0.05 * width);
        for at in stations::evenly(&points, false, stations::STEP * width) {
            raster.erase_disc(at, COVER * width);
        }
    }
    ink(&raster) <= MAX_OPEN * all
}

/// Takes away lines of which the frame has left less than one side.
fn drop_halved(graph: &mut Graph, tracks: &mut Vec<Track>, width: f64, frame: Option<&Bounds<2>>) {
    let stays = |track: &Track| {
        // Where other lines meet it, it is drawn towards them.
        let within = |reach: f64| track.stations.iter().filter(|s| is_within(s.at, frame, reach * width)).count();
        within(1.0) < track.stations.len() || 2 * within(HALVED) < track.stations.len()
    };
    let mut stay = tracks.iter().map(stays).collect::<Vec<_>>().into_iter();
    graph.lines.retain(|_| stay.next().unwrap_or(true));
    tracks.retain(stays);
}

/// Whether a place lies within `reach` of the sides of the frame.
fn is_within(p: Vector<2>, frame: Option<&Bounds<2>>, reach: f64) -> bool {
    frame.is_some_and(|frame| frame.signed_distance(p).abs() < reach)
}

#[cfg(test)]
mod tests;
