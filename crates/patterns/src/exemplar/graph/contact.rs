//! Where lines touch one another.

use arabesque_core::{Bounds, Budget, Domain, Error, GridIndex, Held, Numbered, Result, Vector};

use crate::exemplar::graph::line::Line;

/// No more crossings are looked for when there are so many.
pub(crate) const MAX_CONTACTS: usize = 200_000;

/// Bits of lines of which the mean one has so many around it are lines on top of one another.
const MAX_CROWDING: f64 = 1000.0;

/// Nanoseconds that comparing two bits of lines takes.
const PAIR: u64 = 6;

/// Two passages of lines through one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact<const D: usize> {
    pub(crate) place: Vector<D>,
    /// (line, arc length) of both.
    pub(crate) sides: [(u32, f64); 2],
}

/// A straight bit of a line.
#[derive(Clone, Copy, Debug)]
struct Chord<const D: usize> {
    line: u32,
    /// Number along the line.
    number: u32,
    a: Vector<D>,
    b: Vector<D>,
    arc: [f64; 2],
}

impl<const D: usize> Chord<D> {
    fn middle(&self) -> Vector<D> {
        (self.a + self.b) * 0.5
    }

    fn arc_at(&self, t: f64) -> f64 {
        self.arc[0] + t * (self.arc[1] - self.arc[0])
    }
}

/// The chords of all lines, none longer than `longest`, with an index of their middles.
struct Chords<const D: usize> {
    all: Vec<Chord<D>>,
    longest: f64,
    index: GridIndex<D>,
    _held: Held,
}

impl<const D: usize> Chords<D> {
    fn new(lines: &Numbered<Line<D>>, longest: f64, budget: &Budget) -> Result<Self> {
        let pieces = |points: &[Vector<D>]| -> f64 {
            points.windows(2).map(|w| ((w[1] - w[0]).norm() / longest).ceil().max(1.0)).sum()
        };
        let count = lines.iter().map(|l| pieces(l.measured.points())).sum::<f64>() as usize;
        // Beside each bit its middle, and its place in the index.
        let held =
            budget.hold("bits of curves", count.saturating_mul(size_of::<Chord<D>>() + 4 * size_of::<Vector<D>>()))?;
        budget.spend(count as u64 * 50)?;
        let mut all = Vec::with_capacity(count);
        for (line, l) in lines.iter().enumerate() {
            let (points, mut number) = (l.measured.points(), 0);
            for k in 1..points.len() {
                let (a, b) = (points[k - 1], points[k]);
                let pieces = ((b - a).norm() / longest).ceil().max(1.0);
                let (from, to) = (l.measured.arc_of(k - 1), l.measured.arc_of(k));
                for i in 0..pieces as usize {
                    let at = |i: usize| i as f64 / pieces;
                    let ends = [at(i), at(i + 1)];
                    let [p, q] = ends.map(|t| a + (b - a) * t);
                    all.push(Chord {
                        line: line as u32,
                        number,
                        a: p,
                        b: q,
                        arc: ends.map(|t| from + t * (to - from)),
                    });
                    number += 1;
                }
            }
        }
        let middles: Vec<_> = all.iter().map(Chord::middle).collect();
        let index = GridIndex::new(&middles, longest, &Domain::Box(Bounds::around(middles.iter().copied())));
        let chords = Self { all, longest, index, _held: held };
        chords.check_crowding()?;
        Ok(chords)
    }

    /// Refuses lines that lie on top of one another: each bit of them would have to be compared with all others.
    fn check_crowding(&self) -> Result<()> {
        let crowding = self.index.crowding();
        let Some((_, place)) = self.index.fullest().filter(|_| crowding > MAX_CROWDING) else { return Ok(()) };
        Err(Error::Limit {
            what: "curves on top of one another".into(),
            found: format!("about {crowding:.0} around {:.4?}", place.0),
            limit: MAX_CROWDING.to_string(),
            advice: "draw each of them once".into(),
        })
    }

    /// Whether two chords are neighbours on one line.
    fn adjoin(&self, lines: &Numbered<Line<D>>, a: &Chord<D>, b: &Chord<D>) -> bool {
        if a.line != b.line {
            return false;
        }
        let measured = &lines[a.line].measured;
        let gap = (a.arc[0] - b.arc[0]).abs();
        let around = if measured.is_closed() { gap.min(measured.length() - gap) } else { gap };
        a.number.abs_diff(b.number) <= 1 || around <= 1.5 * self.longest
    }
}

/// Places where lines cross, themselves included. In space, where they come closer than `near`. Stops after
/// [`MAX_CONTACTS`].
pub(crate) fn crossings<const D: usize>(
    lines: &Numbered<Line<D>>,
    side: f64,
    near: f64,
    budget: &Budget,
) -> Result<Vec<Contact<D>>> {
    let chords = Chords::new(lines, side / 100.0, budget)?;
    let mut meter = budget.meter();
    let mut found = Vec::new();
    for (i, a) in chords.all.iter().enumerate() {
        if found.len() >= MAX_CONTACTS {
            break;
        }
        let looked = chords.index.within(a.middle(), chords.longest + near, |j, _| {
            let b = &chords.all[j];
            if j <= i || chords.adjoin(lines, a, b) {
                return;
            }
            if let Some((t, u)) = crossing(a, b, near) {
                let place = (a.a + (a.b - a.a) * t + b.a + (b.b - b.a) * u) * 0.5;
                found.push(Contact { place, sides: [(a.line, a.arc_at(t)), (b.line, b.arc_at(u))] });
            }
        });
        meter.spend(looked * PAIR)?;
    }
    Ok(found)
}

/// Parameters at which two chords cross.
fn crossing<const D: usize>(a: &Chord<D>, b: &Chord<D>, near: f64) -> Option<(f64, f64)> {
    let (r, s, w) = (a.b - a.a, b.b - b.a, b.a - a.a);
    let (rr, ss, rs) = (r.norm2(), s.norm2(), r.dot(s));
    let det = rr * ss - rs * rs;
    // Nearly parallel chords run side by side: they do not cross.
    if det <= 1e-4 * rr * ss {
        return None;
    }
    let t = (w.dot(r) * ss - w.dot(s) * rs) / det;
    let u = (w.dot(r) * rs - w.dot(s) * rr) / det;
    let hit = (-1e-9..=1.0 + 1e-9).contains(&t) && (-1e-9..=1.0 + 1e-9).contains(&u);
    let gap = (a.a + r * t - b.a - s * u).norm();
    (hit && gap <= near).then_some((t.clamp(0.0, 1.0), u.clamp(0.0, 1.0)))
}

/// Ends that come within `reach` (of their line) of another line, or of their own far from the end.
pub(crate) fn end_contacts<const D: usize>(
    lines: &Numbered<Line<D>>,
    reach: &[f64],
    side: f64,
    budget: &Budget,
) -> Result<Vec<Contact<D>>> {
    let chords = Chords::new(lines, side / 100.0, budget)?;
    let mut meter = budget.meter();
    let mut found = Vec::new();
    for (l, line) in lines.iter().enumerate().filter(|(_, line)| !line.measured.is_closed()) {
        let length = line.measured.length();
        for arc in [0.0, length] {
            let p = line.measured.point(arc);
            let looked = nearest_by_line(&chords, p, reach[l], |chord, t, d| {
                let own = chord.line as usize == l;
                if d > reach[l] || (own && (chord.arc_at(t) - arc).abs() < (4.0 * reach[l]).min(0.5 * length)) {
                    return;
                }
                let q = chord.a + (chord.b - chord.a) * t;
                found.push(Contact { place: q, sides: [(l as u32, arc), (chord.line, chord.arc_at(t))] });
            });
            meter.spend(looked * 5 * PAIR)?;
        }
        if found.len() >= MAX_CONTACTS {
            break;
        }
    }
    Ok(found)
}

/// The nearest place of each line around `p`, and of each distant part of a line. Returns how many bits of lines were looked at.
fn nearest_by_line<const D: usize>(
    chords: &Chords<D>,
    p: Vector<D>,
    reach: f64,
    mut visit: impl FnMut(&Chord<D>, f64, f64),
) -> u64 {
    let mut near: Vec<(u32, usize, f64, f64)> = Vec::new();
    let looked = chords.index.within(p, reach + chords.longest, |j, _| {
        let chord = &chords.all[j];
        let r = chord.b - chord.a;
        let t = ((p - chord.a).dot(r) / r.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        near.push((chord.line, j, t, (chord.a + r * t - p).norm()));
    });
    near.sort_by_key(|n| (n.0, n.1));
    // Neighbouring chords are one passage of the line; only its nearest place counts.
    for passage in near.chunk_by(|a, b| a.0 == b.0 && b.1 == a.1 + 1) {
        if let Some(best) = passage.iter().min_by(|a, b| a.3.total_cmp(&b.3)) {
            visit(&chords.all[best.1], best.2, best.3);
        }
    }
    looked
}
