//! Joining strokes where one chart ends and another begins.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Domain, Drawn, Exemplar, GridIndex, Path, Result, Vector, straight};

use crate::regular::{
    bend::elements::{BAND, Bending},
    kept::lead,
};

/// Ends that are farther apart than this share of the shorter vector on the page are not joined; joined ones give way over
/// such a length.
const JOIN: (f64, f64) = (0.45, 0.8);

/// Bands reach over the seam at which they end by this share of their width.
const REACH: f64 = 0.5;

/// Strands whose widths differ by more than this share stay apart, end to end.
const WIDTH: f64 = 0.12;

/// Work for each end.
const END: u64 = 500;

/// A stroke of one chart.
#[derive(Clone, Debug)]
pub(crate) struct Strand {
    pub(crate) path: Path<2>,
    pub(crate) source: usize,
    pub(crate) scale: f64,
    /// Whether its start and its end lie where another chart goes on.
    pub(crate) ends: [bool; 2],
}

/// An end: the number of its strand, and which end.
type End = (usize, usize);

impl Strand {
    fn tip(&self, end: usize) -> Vector<2> {
        let tip = if end == 0 { self.path.start() } else { self.path.end() };
        tip.unwrap_or(Vector::ZERO)
    }

    /// Goes straight on at an end.
    fn lengthen(&mut self, end: usize, by: f64) {
        let (tip, way) = (self.tip(end), self.way(end));
        if end == 0 {
            self.path.cubics.insert(0, straight(tip + way * by, tip));
        } else {
            self.path.cubics.push(straight(tip, tip + way * by));
        }
    }

    /// The direction out of an end.
    fn way(&self, end: usize) -> Vector<2> {
        let cubic = if end == 0 { self.path.cubics.first() } else { self.path.cubics.last() };
        let way = cubic.map_or(Vector::ZERO, |c| if end == 0 { c[0] - c[3] } else { c[3] - c[0] });
        way.unit_or_zero()
    }
}

/// The strands, joined across the seams.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn joined(
    mut strands: Vec<Strand>,
    bending: &Bending<'_>,
    exemplar: &Exemplar<2>,
    budget: &Budget,
) -> Result<Vec<Drawn<2>>> {
    let partners = partners(&strands, bending, exemplar, budget)?;
    for (&(a, end), &(b, other)) in partners.iter().filter(|(a, b)| a < b) {
        let middle = (strands[a].tip(end) + strands[b].tip(other)) * 0.5;
        for (k, end) in [(a, end), (b, other)] {
            let over = JOIN.1 * bending.lattice.shorter() * strands[k].scale;
            let by = middle - strands[k].tip(end);
            let path = std::mem::take(&mut strands[k].path);
            let mut path = if end == 0 { path } else { path.reversed() };
            lead(&mut path, by, over);
            strands[k].path = if end == 0 { path } else { path.reversed() };
        }
    }
    for (k, strand) in strands.iter_mut().enumerate() {
        let width = exemplar.curves[strand.source].width;
        for end in 0..2 {
            let is_free = strand.ends[end] && !partners.contains_key(&(k, end));
            // Bands that end at a seam reach over it, so that no gap is left between them and what begins there.
            if is_free && width > BAND * bending.lattice.shorter() {
                strand.lengthen(end, REACH * width * strand.scale);
            }
        }
    }
    let alike = |a: usize, b: usize| (strands[a].scale / strands[b].scale - 1.0).abs() <= WIDTH;
    let partners: BTreeMap<End, End> = partners.into_iter().filter(|(a, b)| a.0 != b.0 && alike(a.0, b.0)).collect();
    let mut is_drawn = vec![false; strands.len()];
    let mut made = Vec::new();
    // Strands with a free end first: what is left then runs in rings.
    let is_free = |k: usize| (0..2).find(|end| !partners.contains_key(&(k, *end)));
    let starts = (0..strands.len()).filter_map(|k| Some((k, is_free(k)?))).chain((0..strands.len()).map(|k| (k, 0)));
    for (first, enters) in starts {
        if is_drawn[first] {
            continue;
        }
        let (mut at, mut enters) = (first, enters);
        let (mut path, mut scales) = (Path { cubics: Vec::new(), closed: strands[first].path.closed }, Vec::new());
        loop {
            is_drawn[at] = true;
            budget.spend(END)?;
            let strand = &strands[at];
            let part = if enters == 0 { strand.path.clone() } else { strand.path.reversed() };
            path.cubics.extend(part.cubics);
            scales.push(strand.scale);
            match partners.get(&(at, 1 - enters)) {
                Some(&(next, end)) if !is_drawn[next] => (at, enters) = (next, end),
                _ => break,
            }
        }
        let scale = scales.iter().sum::<f64>() / scales.len() as f64;
        made.push(Drawn { path, source: strands[first].source, scale, frozen: None });
    }
    Ok(made)
}

/// For every end at a seam the one that goes on there, both ways.
fn partners(
    strands: &[Strand],
    bending: &Bending<'_>,
    exemplar: &Exemplar<2>,
    budget: &Budget,
) -> Result<BTreeMap<End, End>> {
    let all = strands.iter().enumerate();
    let ends: Vec<End> = all.flat_map(|(k, s)| (0..2).filter(|&e| s.ends[e]).map(move |e| (k, e))).collect();
    let tips: Vec<Vector<2>> = ends.iter().map(|&(k, end)| strands[k].tip(end)).collect();
    if tips.is_empty() {
        return Ok(BTreeMap::new());
    }
    let largest = strands.iter().map(|s| s.scale).fold(0.0, f64::max);
    let reach = JOIN.0 * bending.lattice.shorter() * largest;
    let index = GridIndex::new(&tips, reach, &Domain::Box(Bounds::around(tips.iter().copied()).grown(reach)));
    let style = |k: usize| exemplar.curves[strands[k].source].style;
    let mut close = Vec::new();
    for (i, &(a, end)) in ends.iter().enumerate() {
        let looked = index.within(tips[i], JOIN.0 * bending.lattice.shorter() * strands[a].scale, |j, offset| {
            let (b, other) = ends[j];
            let goes_on = strands[a].way(end).dot(strands[b].way(other)) < -0.3;
            if i < j && style(a) == style(b) && goes_on {
                close.push((offset.norm(), i, j));
            }
        });
        budget.spend(END + 10 * looked)?;
    }
    close.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partners = BTreeMap::new();
    for (_, i, j) in close {
        if !partners.contains_key(&ends[i]) && !partners.contains_key(&ends[j]) {
            partners.insert(ends[i], ends[j]);
            partners.insert(ends[j], ends[i]);
        }
    }
    Ok(partners)
}
