//! Which exemplars consist of objects with transparent columns between them, and which objects and gaps they have.
//!
//! A run of columns with ink is an object. An exemplar most of which is one long run is a pattern that goes on, whatever lies beside it.

use std::ops::Range;

use arabesque_core::{Budget, Image, Result};

use crate::exemplar::strip::StripExemplar;

/// A run as long as this share of the exemplar, and as this many heights of it, is a pattern that goes on.
const LONG_SHARE: f64 = 0.6;
const LONG: f64 = 3.0;
/// A single run up to this many heights long, with room on both sides, is an object.
const SINGLE: f64 = 1.5;
/// Alpha from which a pixel belongs to the outline of its object.
const OUTLINED: u8 = 26;
/// Most columns of an object at which its outline is taken.
const COLUMNS: usize = 48;
/// Work of one pixel.
const PIXEL: u64 = 2;

/// One object of an exemplar. Lengths are in pixels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Object {
    /// Which exemplar.
    pub(crate) source: usize,
    /// Where its ink begins and ends along the exemplar.
    pub(crate) left: f64,
    pub(crate) right: f64,
    /// The columns and rows that show it and nothing else.
    pub(crate) shown: [f64; 4],
    /// The row that lies on the curve.
    pub(crate) middle: f64,
    /// Points of its outline, from its left end and from the middle row.
    pub(crate) outline: Vec<[f64; 2]>,
}

impl Object {
    pub(crate) fn length(&self) -> f64 {
        self.right - self.left
    }

    /// How far its ink reaches above and below the middle row.
    pub(crate) fn reach(&self) -> [f64; 2] {
        self.outline.iter().fold([0.0, 0.0], |[up, down], p| [up.max(-p[1]), down.max(p[1])])
    }
}

/// The objects of all exemplars.
#[derive(Clone, Debug)]
pub(crate) struct Objects {
    pub(crate) list: Vec<Object>,
    /// The gaps of each exemplar, in rising order, in pixels.
    pub(crate) gaps: Vec<Vec<f64>>,
    /// Rows of the highest exemplar.
    pub(crate) height: f64,
    /// Objects that begin and end an open curve, and are used nowhere else.
    pub(crate) first: Vec<usize>,
    pub(crate) last: Vec<usize>,
}

impl Objects {
    /// The smallest and the largest gap of exemplar `source`.
    pub(crate) fn range(&self, source: usize) -> [f64; 2] {
        let gaps = &self.gaps[source];
        [gaps.first().copied().unwrap_or(1.0), gaps.last().copied().unwrap_or(1.0)]
    }

    /// The objects that may lie between the ends.
    pub(crate) fn body(&self, source: usize) -> Vec<usize> {
        let own = |k: &usize| self.list[*k].source == source;
        let free = |k: &usize| !self.first.contains(k) && !self.last.contains(k);
        let inner: Vec<usize> = (0..self.list.len()).filter(own).filter(free).collect();
        if inner.is_empty() { (0..self.list.len()).filter(own).collect() } else { inner }
    }
}

/// The objects of `exemplars`; `None` unless all of them consist of objects.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work is used up.
pub(crate) fn find(exemplars: &[StripExemplar], budget: &Budget) -> Result<Option<Objects>> {
    let height = exemplars.iter().map(|e| e.image.height).max().unwrap_or(0) as f64;
    let mut objects = Objects { list: Vec::new(), gaps: Vec::new(), height, first: Vec::new(), last: Vec::new() };
    for (source, exemplar) in exemplars.iter().enumerate() {
        let image = &exemplar.image;
        budget.spend(PIXEL * image.pixels.len() as u64)?;
        let runs = runs(image);
        let Some(whole) = objects_among(&runs, image) else { return Ok(None) };
        objects.gaps.push(gaps(&runs, image));
        for k in whole {
            let object = object(image, source, &runs[k]);
            let within = |part: &Option<Range<usize>>| {
                part.as_ref().is_some_and(|p| p.start <= runs[k].start && runs[k].end <= p.end)
            };
            let number = objects.list.len();
            if source == 0 && within(&exemplar.start) {
                objects.first.push(number);
            } else if source + 1 == exemplars.len() && within(&exemplar.end) {
                objects.last.push(number);
            }
            objects.list.push(object);
        }
    }
    Ok(Some(objects))
}

/// The runs of columns that have any ink.
fn runs(image: &Image) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for x in 0..image.width {
        if (0..image.height).all(|y| image.pixel(x, y)[3] == 0) {
            continue;
        }
        match runs.last_mut() {
            Some(run) if run.end == x => run.end = x + 1,
            _ => runs.push(x..x + 1),
        }
    }
    runs
}

/// Which runs are whole objects; `None` where the exemplar goes on as one pattern.
fn objects_among(runs: &[Range<usize>], image: &Image) -> Option<Vec<usize>> {
    let (width, height) = (image.width as f64, image.height as f64);
    let longest = runs.iter().map(ExactSizeIterator::len).max()? as f64;
    let touches = |run: &Range<usize>| run.start == 0 || run.end == image.width;
    if runs.len() == 1 {
        return (longest <= SINGLE * height && !touches(&runs[0])).then(|| vec![0]);
    }
    if longest > LONG_SHARE * width && longest > LONG * height {
        return None;
    }
    // What touches a side of the picture may have been cut there: it then is narrower than the others.
    let least = runs.iter().filter(|run| !touches(run)).map(ExactSizeIterator::len).min();
    let whole = |run: &Range<usize>| !touches(run) || least.is_none_or(|least| run.len() >= least);
    Some((0..runs.len()).filter(|&k| whole(&runs[k])).collect())
}

/// The gaps between neighbouring runs, in rising order; of a single one, the room around it.
fn gaps(runs: &[Range<usize>], image: &Image) -> Vec<f64> {
    let ends: Vec<[f64; 2]> = runs.iter().map(|run| ends(image, run)).collect();
    let mut gaps: Vec<f64> = ends.windows(2).map(|pair| pair[1][0] - pair[0][1]).collect();
    if let [[left, right]] = ends[..] {
        gaps.push(left + image.width as f64 - right);
    }
    gaps.sort_by(f64::total_cmp);
    gaps
}

/// Where the ink of a run begins and ends, to a part of a pixel.
fn ends(image: &Image, run: &Range<usize>) -> [f64; 2] {
    let most = |x: usize| (0..image.height).map(|y| image.pixel(x, y)[3]).max().unwrap_or(0);
    let part = |x: usize| f64::from(most(x)) / 255.0;
    [run.start as f64 + 1.0 - part(run.start), run.end as f64 - 1.0 + part(run.end - 1)]
}

fn object(image: &Image, source: usize, run: &Range<usize>) -> Object {
    let middle = 0.5 * image.height as f64;
    let [left, right] = ends(image, run);
    let n = run.len().clamp(2, COLUMNS);
    let mut outline = Vec::new();
    let (mut top, mut bottom) = (image.height, 0);
    for x in run.clone() {
        let inked = |least: u8| (0..image.height).filter(move |&y| image.pixel(x, y)[3] >= least);
        top = top.min(inked(1).min().unwrap_or(top));
        bottom = bottom.max(inked(1).max().map_or(bottom, |y| y + 1));
    }
    for k in 0..n {
        let from = run.start + k * run.len() / n;
        let to = (run.start + (k + 1) * run.len() / n).max(from + 1);
        let rows = (from..to).flat_map(|x| (0..image.height).filter(move |&y| image.pixel(x, y)[3] >= OUTLINED));
        let Some((up, down)) = rows.fold(None, |found: Option<(usize, usize)>, y| {
            Some(found.map_or((y, y), |(up, down)| (up.min(y), down.max(y))))
        }) else {
            continue;
        };
        let x = (right - left) * k as f64 / (n - 1) as f64;
        outline.extend([[x, up as f64 - middle], [x, down as f64 + 1.0 - middle]]);
    }
    if outline.is_empty() {
        outline = vec![[0.0, top as f64 - middle], [right - left, bottom as f64 - middle]];
    }
    let shown = [
        (run.start as f64 - 0.5).max(0.0),
        (run.end as f64 + 0.5).min(image.width as f64),
        (top as f64 - 1.0).max(0.0),
        (bottom as f64 + 1.0).min(image.height as f64),
    ];
    Object { source, left, right, shown, middle, outline }
}
