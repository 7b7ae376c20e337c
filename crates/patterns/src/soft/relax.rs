//! Taking apart what lies too near, while lengths and shapes stay: positions are moved to where each link and each pair of pieces wants
//! them, in turn, many times [Mueller 2007].

use arabesque_core::{Budget, Domain, GridIndex, Request, Result, Vector};

use super::{
    bodies::{Bodies, Piece, nearest, pieces_of},
    form::Form,
    natural::{LOOK, Natural},
    wall,
};

/// Rounds in the end and before; after how many of them pairs are looked for again.
pub(super) const ROUNDS: usize = 60;
pub(super) const BETWEEN: usize = 25;
const EVERY: usize = 5;
/// Rounds at the end in which only overlaps are taken apart.
const LAST: usize = 12;
/// Pairs count that are nearer than they should be by no more than this share of a width.
const SLACK: f64 = 0.5;
/// Share of what two pieces lie too near by that is made up in a round.
const PUSH: f64 = 0.5;
/// Of one strand, pieces come near one another from so many thicknesses along it on.
const SELF: f64 = 4.0;
/// How near the surfaces of one strand may come, in radii.
const TOUCH: f64 = 0.0;
/// What lies deeper in something else than this share of the thinner one's radius, and more than in the exemplar, is taken out.
const DEEP: f64 = 0.35;
/// So many radii elements stay away from walls, and no fewer than so many in the end: a surface of six sides lies a tenth beyond its mean.
const CLEAR: f64 = 1.16;
pub(super) const SURE: f64 = 1.1;
/// How often lengths and walls are looked after in turn at the end, at most, and work of a sample then.
const AT_WALLS: usize = 60;
const AT_WALL: u64 = 3000;
/// Work of a pair, and of a link.
const PAIR: u64 = 60;
const LINK: u64 = 15;

/// Two pieces that may be too near.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: u32,
    b: u32,
    /// How far their middle lines should be apart, and must be.
    apart: f64,
    least: f64,
}

/// Moves samples.
pub(super) struct Relaxation<'a, const D: usize> {
    pub(super) request: &'a Request<D>,
    pub(super) forms: &'a [Form<D>],
    pub(super) natural: &'a Natural,
}

impl<const D: usize> Relaxation<'_, D> {
    /// Takes all elements apart, in so many rounds.
    pub(super) fn run(
        &self,
        (bodies, rounds): (&mut Bodies<D>, usize),
        budget: &Budget,
        heard: &mut dyn FnMut(&Bodies<D>, f64) -> Result<()>,
    ) -> Result<()> {
        let pieces: Vec<Piece> =
            bodies.list.iter().enumerate().flat_map(|(n, b)| pieces_of(n, b, &self.forms[b.source])).collect();
        let mut pairs = Vec::new();
        for round in 0..rounds {
            if round % EVERY == 0 {
                pairs = self.pairs(bodies, &pieces, budget)?;
                heard(bodies, round as f64 / rounds as f64)?;
            }
            let links: usize = bodies.list.iter().map(|b| self.forms[b.source].links.len()).sum();
            budget.spend(PAIR * pairs.len() as u64 + LINK * links as u64)?;
            let is_last = round + LAST >= rounds;
            for pair in &pairs {
                push(bodies, &pieces, pair, is_last);
            }
            for n in 0..bodies.list.len() {
                if bodies.list[n].frozen.is_none() {
                    self.hold(bodies, n, is_last);
                }
            }
        }
        let again = if wall::is_there(self.request) { AT_WALLS } else { 0 };
        for n in (0..bodies.list.len()).filter(|n| bodies.list[*n].frozen.is_none()).collect::<Vec<_>>() {
            self.stretch(bodies, n);
            for _ in 0..again {
                budget.spend(AT_WALL * self.forms[bodies.list[n].source].len() as u64)?;
                if self.is_within(bodies, n) {
                    break;
                }
                self.confine(bodies, n);
                self.bend_in(bodies, n);
                self.stretch(bodies, n);
            }
        }
        Ok(())
    }

    /// Whether an element lies within the border and above the ground.
    fn is_within(&self, bodies: &Bodies<D>, n: usize) -> bool {
        let body = bodies.list[n];
        let form = &self.forms[body.source];
        let radius = |k: usize| SURE * form.soft.radii[k] * body.scale;
        wall::holds(self.request, (bodies.samples(&body, form), form.is_line()), radius)
    }

    /// Keeps the line between the samples of a strand within, as [`Relaxation::confine`] keeps these.
    fn bend_in(&self, bodies: &mut Bodies<D>, n: usize) {
        let body = bodies.list[n];
        let form = &self.forms[body.source];
        if !form.is_line() {
            return;
        }
        let middles: Vec<Vector<D>> = wall::middles(bodies.samples(&body, form)).collect();
        for (k, p) in middles.into_iter().enumerate() {
            let by = wall::within(self.request, p, CLEAR * form.soft.radii[k] * body.scale) - p;
            bodies.points[body.first + k] += by;
            bodies.points[body.first + k + 1] += by;
        }
    }

    /// Takes out what lies too deep in something else, the deepest first.
    pub(super) fn thin(&self, bodies: &mut Bodies<D>, budget: &Budget) -> Result<()> {
        let pieces: Vec<Piece> =
            bodies.list.iter().enumerate().flat_map(|(n, b)| pieces_of(n, b, &self.forms[b.source])).collect();
        let mut deep: Vec<(f64, u32, u32)> = Vec::new();
        for pair in self.pairs(bodies, &pieces, budget)? {
            let (a, b) = (&pieces[pair.a as usize], &pieces[pair.b as usize]);
            let lack = (pair.least - between(bodies, a, b).1.norm()) / a.radius.min(b.radius).max(f64::MIN_POSITIVE);
            if lack > DEEP && a.body != b.body {
                deep.push((lack, a.body, b.body));
            }
        }
        deep.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut trouble = vec![0.0; bodies.list.len()];
        deep.iter().for_each(|(lack, a, b)| [a, b].into_iter().for_each(|n| trouble[*n as usize] += lack));
        let mut is_gone = vec![false; bodies.list.len()];
        for (_, a, b) in deep {
            let (a, b) = (a as usize, b as usize);
            if is_gone[a] || is_gone[b] {
                continue;
            }
            let worse = if trouble[b] > trouble[a] { [b, a] } else { [a, b] };
            if let Some(n) = worse.into_iter().find(|n| bodies.list[*n].frozen.is_none()) {
                is_gone[n] = true;
            }
        }
        bodies.drop(self.forms, &is_gone);
        Ok(())
    }

    /// Pieces that are or may come too near to one another.
    fn pairs(&self, bodies: &Bodies<D>, pieces: &[Piece], budget: &Budget) -> Result<Vec<Pair>> {
        let ends = |p: &Piece| p.ends.map(|k| bodies.points[k as usize]);
        let middles: Vec<Vector<D>> = pieces.iter().map(|p| (ends(p)[0] + ends(p)[1]) * 0.5).collect();
        let half = pieces.iter().map(|p| 0.5 * (ends(p)[1] - ends(p)[0]).norm()).fold(0.0, f64::max);
        let thickest = pieces.iter().map(|p| p.radius).fold(0.0, f64::max);
        let scale = self.request.fields.scale.range().1;
        let slack = SLACK * self.natural.width * scale;
        let reach = 2.0 * (half + thickest) + self.natural.widest().max(0.0) * scale + slack;
        let space = Domain::Box(self.request.domain.bounds());
        let index = GridIndex::new(&middles, reach, &space);
        let mut meter = budget.meter();
        let mut found = Vec::new();
        for (i, a) in pieces.iter().enumerate() {
            let mut near = Vec::new();
            let looked = index.within(middles[i], reach, |j, _| {
                if j > i {
                    near.push(j);
                }
            });
            meter.spend(LOOK * looked)?;
            near.sort_unstable();
            for j in near {
                let b = &pieces[j];
                if a.body == b.body && !self.may_cross(bodies, a, b) {
                    continue;
                }
                let touching = a.radius + b.radius;
                let own_scale = bodies.list[a.body as usize].scale;
                let gap = if a.body == b.body { TOUCH } else { self.natural.gap(a.class, b.class) * own_scale };
                let apart = touching + gap;
                if between(bodies, a, b).1.norm() < apart + slack {
                    found.push(Pair { a: i as u32, b: j as u32, apart, least: touching + gap.min(0.0) });
                }
            }
        }
        Ok(found)
    }

    /// Whether two pieces of one element are far enough from one another along it to cross.
    fn may_cross(&self, bodies: &Bodies<D>, a: &Piece, b: &Piece) -> bool {
        let body = bodies.list[a.body as usize];
        let form = &self.forms[body.source];
        let along = f64::from(b.ends[0].abs_diff(a.ends[1])) * form.longest * body.scale;
        form.soft.build == arabesque_core::Build::Strand && along > SELF * a.radius
    }

    /// Keeps the samples of an element within the border and above the ground.
    fn confine(&self, bodies: &mut Bodies<D>, n: usize) {
        let body = bodies.list[n];
        let form = &self.forms[body.source];
        let points = &mut bodies.points[body.first..body.first + form.len()];
        for (p, r) in points.iter_mut().zip(&form.soft.radii) {
            *p = wall::within(self.request, *p, CLEAR * r * body.scale);
        }
    }

    /// Links of an element, and the border.
    fn hold(&self, bodies: &mut Bodies<D>, n: usize, is_last: bool) {
        if wall::is_there(self.request) {
            self.confine(bodies, n);
        }
        let body = bodies.list[n];
        let form = &self.forms[body.source];
        let points = &mut bodies.points[body.first..body.first + form.len()];
        for link in &form.links {
            let (a, b) = (points[link.a as usize], points[link.b as usize]);
            let way = b - a;
            let length = way.norm();
            if length <= 0.0 {
                continue;
            }
            let share = if is_last && link.share < 1.0 { 0.5 * link.share } else { link.share };
            let by = way * (0.5 * share * (1.0 - link.length * body.scale / length));
            points[link.a as usize] += by;
            points[link.b as usize] -= by;
        }
    }

    /// Gives the steps of a strand their exact lengths, from its middle on; anything rigid gets its exact shape.
    fn stretch(&self, bodies: &mut Bodies<D>, n: usize) {
        let body = bodies.list[n];
        let form = &self.forms[body.source];
        let own = &form.soft.samples;
        let points = &mut bodies.points[body.first..body.first + form.len()];
        match form.soft.build {
            arabesque_core::Build::Strand => {
                let middle = points.len() / 2;
                let step = |k: usize, l: usize| (own[k] - own[l]).norm() * body.scale;
                let before: Vec<Vector<D>> = points.to_vec();
                for k in middle + 1..points.len() {
                    points[k] = points[k - 1] + (before[k] - before[k - 1]).unit_or_zero() * step(k, k - 1);
                }
                for k in (0..middle).rev() {
                    points[k] = points[k + 1] + (before[k] - before[k + 1]).unit_or_zero() * step(k, k + 1);
                }
            }
            arabesque_core::Build::Rigid => {
                let fit = arabesque_core::Similarity::fit(own, points, body.scale, arabesque_core::Matrix::identity());
                points.iter_mut().zip(own).for_each(|(p, q)| *p = fit.apply(*q));
            }
            arabesque_core::Build::Bag => {}
        }
    }
}

/// Where two pieces are nearest to one another, as shares of them, and the way from the first to the second there.
fn between<const D: usize>(bodies: &Bodies<D>, a: &Piece, b: &Piece) -> ([f64; 2], Vector<D>) {
    let ends = |p: &Piece| p.ends.map(|k| bodies.points[k as usize]);
    let (first, second) = (ends(a), ends(b));
    let [s, t] = nearest(first, second);
    let way = (second[0] + (second[1] - second[0]) * t) - (first[0] + (first[1] - first[0]) * s);
    ([s, t], way)
}

/// Moves the ends of two pieces apart where they are too near.
fn push<const D: usize>(bodies: &mut Bodies<D>, pieces: &[Piece], pair: &Pair, is_last: bool) {
    let (a, b) = (&pieces[pair.a as usize], &pieces[pair.b as usize]);
    let ([s, t], way) = between(bodies, a, b);
    let distance = way.norm();
    let apart = if is_last { pair.least.max(0.9 * pair.apart) } else { pair.apart };
    let lack = apart - distance;
    if lack <= 0.0 {
        return;
    }
    let way = way.unit_if_longer(1e-9 * apart).unwrap_or_else(|| {
        let along = |p: &Piece| bodies.points[p.ends[1] as usize] - bodies.points[p.ends[0] as usize];
        across(along(a), along(b))
    });
    let is_fixed = |p: &Piece| bodies.list[p.body as usize].frozen.is_some();
    let (stays, other_stays) = (is_fixed(a), is_fixed(b));
    if stays && other_stays {
        return;
    }
    let each = if stays || other_stays { PUSH } else { 0.5 * PUSH };
    if !stays {
        shift(bodies, a, s, way * (-each * lack));
    }
    if !other_stays {
        shift(bodies, b, t, way * (each * lack));
    }
}

/// Moves a piece so that its place at `t` moves by `by`.
fn shift<const D: usize>(bodies: &mut Bodies<D>, piece: &Piece, t: f64, by: Vector<D>) {
    let [i, j] = piece.ends.map(|k| k as usize);
    if i == j {
        bodies.points[i] += by;
        return;
    }
    let whole = 1.0 / ((1.0 - t) * (1.0 - t) + t * t);
    bodies.points[i] += by * ((1.0 - t) * whole);
    bodies.points[j] += by * (t * whole);
}

/// A direction across two others, of length 1.
fn across<const D: usize>(u: Vector<D>, v: Vector<D>) -> Vector<D> {
    let u = u.unit_or_zero();
    let v = (v - u * v.dot(u)).unit_or_zero();
    let rest = |k: usize| {
        let mut axis = Vector::ZERO;
        axis[k] = 1.0;
        axis - u * u[k] - v * v[k]
    };
    (0..D).map(rest).max_by(|a, b| a.norm2().total_cmp(&b.norm2())).map_or(Vector::ZERO, Vector::unit_or_zero)
}
