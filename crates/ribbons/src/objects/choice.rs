//! Which objects follow one another, and how far apart: drawn so that they fill a stretch of a curve.

use arabesque_core::{Budget, Result, Stage, Stream};

use crate::objects::find::Objects;

/// What the choice of objects is drawn for.
const CHOICE: Stage = Stage::new(2);
/// Sequences that are drawn, of which the one is kept that fits best.
const TRIES: u64 = 24;
/// Work of one object of one of them, and of one object that may follow.
const DRAWN: u64 = 30;

/// One object of a sequence, and the gap before it that was drawn from the exemplar's, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chosen {
    pub(crate) object: usize,
    gap: f64,
    range: [f64; 2],
}

impl Chosen {
    /// The gap before it: the smallest of the exemplar at -1, the one that was drawn at 0, the largest at 1, and beyond that more by
    /// the same length.
    pub(crate) fn gap(&self, stretch: f64) -> f64 {
        let [least, most] = self.range;
        if stretch <= 0.0 {
            self.gap + stretch * (self.gap - least)
        } else {
            self.gap + stretch.min(1.0) * (most - self.gap) + (stretch - 1.0).max(0.0)
        }
    }
}

/// A stretch of a curve that is to be filled, in pixels.
#[derive(Clone, Debug)]
pub(crate) struct Stretch {
    pub(crate) length: f64,
    /// Whether its last object is followed by its first.
    pub(crate) closed: bool,
    /// Objects at its beginning and at its end.
    pub(crate) first: Vec<usize>,
    pub(crate) last: Vec<usize>,
    /// The exemplars that are shown, up to which part of its length each.
    pub(crate) sources: Vec<(usize, f64)>,
}

/// What sequences are drawn from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chooser<'a> {
    pub(crate) objects: &'a Objects,
    pub(crate) seed: u64,
    /// Strength of the aversion to showing an object again soon.
    pub(crate) repetition: f64,
    /// Whether the order is random.
    pub(crate) varied: bool,
    pub(crate) budget: &'a Budget,
}

impl Chooser<'_> {
    /// The sequence that fills `stretch` best with the exemplar's own gaps; `item` tells stretches apart.
    pub(crate) fn choose(&self, stretch: &Stretch, item: u64) -> Result<Vec<Chosen>> {
        let mut best: Option<(f64, Vec<Chosen>)> = None;
        for attempt in 0..if self.varied { TRIES } else { 1 } {
            let mut stream = Stream::new(self.seed, CHOICE, item * TRIES + attempt);
            let drawn = self.draw(stretch, &mut stream)?;
            for n in (drawn.len().saturating_sub(2).max(1)..=drawn.len()).rev() {
                let chosen = self.ended(&drawn[..n.min(drawn.len())], stretch);
                let misfit = misfit(&chosen, self.objects, stretch);
                if best.as_ref().is_none_or(|(least, _)| misfit < *least) {
                    best = Some((misfit, chosen));
                }
            }
        }
        Ok(best.map_or_else(Vec::new, |b| b.1))
    }

    fn chosen(&self, object: usize, stream: &mut Stream) -> Chosen {
        let source = self.objects.list[object].source;
        let gaps = &self.objects.gaps[source];
        let gap = gaps.get(stream.below(gaps.len())).copied().unwrap_or(1.0);
        Chosen { object, gap, range: self.objects.range(source) }
    }

    /// Objects until the stretch is full even with the smallest gaps.
    fn draw(&self, stretch: &Stretch, stream: &mut Stream) -> Result<Vec<Chosen>> {
        let bodies: Vec<Vec<usize>> = (0..self.objects.gaps.len()).map(|s| self.objects.body(s)).collect();
        let mut shown: Vec<Option<usize>> = vec![None; self.objects.list.len()];
        let (mut chosen, mut done) = (Vec::new(), 0.0);
        let mut meter = self.budget.meter();
        loop {
            let k = chosen.len();
            let source = stretch.sources.iter().find(|s| done < s.1).or(stretch.sources.last()).map_or(0, |s| s.0);
            let object = match stretch.first.get(k) {
                Some(&first) => first,
                None => self.next(&bodies[source], &shown, k, stream),
            };
            meter.spend(DRAWN * bodies[source].len() as u64)?;
            let next = self.chosen(object, stream);
            done += self.objects.list[object].length() + if k > 0 { next.gap(-1.0) } else { 0.0 };
            if done > stretch.length && k > 0 {
                return Ok(chosen);
            }
            shown[object] = Some(k);
            chosen.push(next);
            if done > stretch.length {
                return Ok(chosen);
            }
        }
    }

    /// One of `body`: the longer it was not shown, the likelier.
    fn next(&self, body: &[usize], shown: &[Option<usize>], k: usize, stream: &mut Stream) -> usize {
        if !self.varied {
            return body[k % body.len()];
        }
        let most = body.len();
        let weight = |object: usize| {
            let age = shown[object].map_or(most, |last| (k - last - 1).min(most));
            (age as f64 / most as f64).powf(2.0 * self.repetition.min(4.0))
        };
        let total: f64 = body.iter().map(|&object| weight(object)).sum();
        let mut left = stream.unit() * total;
        for &object in body {
            left -= weight(object);
            if left < 0.0 {
                return object;
            }
        }
        body[k % body.len()]
    }

    /// The sequence with the objects at its end that are due there.
    fn ended(&self, drawn: &[Chosen], stretch: &Stretch) -> Vec<Chosen> {
        let kept = drawn.len().saturating_sub(stretch.last.len()).max(stretch.first.len().min(drawn.len()));
        let mut chosen = drawn[..kept].to_vec();
        chosen.extend(stretch.last.iter().map(|&object| {
            let range = self.objects.range(self.objects.list[object].source);
            Chosen { object, gap: 0.5 * (range[0] + range[1]), range }
        }));
        chosen
    }
}

/// How ill a sequence fills its stretch: by how much its gaps must differ from those that were drawn.
fn misfit(chosen: &[Chosen], objects: &Objects, stretch: &Stretch) -> f64 {
    let between = &chosen[usize::from(!stretch.closed).min(chosen.len())..];
    let lengths: f64 = chosen.iter().map(|c| objects.list[c.object].length()).sum();
    let total = |at: f64| lengths + between.iter().map(|c| c.gap(at)).sum::<f64>();
    let [least, own, most] = [-1.0, 0.0, 1.0].map(total);
    let length = stretch.length;
    if length < least {
        // It does not fit at all.
        1e3 + (least - length)
    } else if length < own {
        (own - length) / (own - least)
    } else if length < most {
        (length - own) / (most - own)
    } else {
        1.0 + (length - most) / objects.height
    }
}
