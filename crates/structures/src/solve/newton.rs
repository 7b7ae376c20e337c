//! A direction downhill for all points at once.
//!
//! `T` is a sum of squares of fields, so the product of their slopes stands in for its second derivatives (Gauss-Newton); points of
//! one rigid element move as one. The equations are solved roughly, by conjugate gradients.

use arabesque_core::{Budget, Matrix, Result, Vector};
use rayon::prelude::*;

use super::apart::Crowd;
use crate::{
    energy::{
        exp::exp,
        level::{Level, Near, Pull},
    },
    exemplar::channels::inner,
    output::state::Output,
};

/// Steps of conjugate gradients.
const STEPS: usize = 8;
/// Work for each pair of points: for its entry, and in each step.
const PAIR: u64 = 60;
const PRODUCT: u64 = 5;
/// Rows that one task makes.
const BLOCK: usize = 256;
/// Share of its diagonal that is added to the matrix: the energy hardly tells how points lie along a line or a surface.
const DAMPING: f64 = 0.02;

/// What a pair adds to the matrix: its weight, and its offset in widths of the Gaussian.
type Entry<const D: usize> = (f32, [f32; D]);

/// The equations, and their right-hand side.
pub(crate) struct System<const D: usize> {
    /// Slopes of `T` by the places of the points; zero for those that stay.
    pub(crate) slopes: Vec<Vector<D>>,
    diagonal: Vec<f64>,
    /// For each pair in the order of the lists.
    entries: Vec<Entry<D>>,
}

impl<const D: usize> System<D> {
    /// For the points as they are.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        level: &Level<'_, D>,
        output: &Output<D>,
        near: &Near,
        (pulls, crowd): (&[Pull<D>], &Crowd),
        budget: &Budget,
    ) -> Result<Self> {
        let sigma = level.tables.kernel.sigma;
        let row = |i: usize| {
            let (x, a, here) = (output.places[i], &output.weights[i], &pulls[i]);
            let mut own = f64::from(inner(a, a));
            let mut slope = Vector::ZERO;
            let mut entries = Vec::with_capacity(near.pairs.span(i).len());
            for k in near.pairs.span(i) {
                let j = near.pairs.items()[k] as usize;
                let r = level.domain.offset(output.places[j], x);
                let per = 2.0 / (sigma * (here.scale + pulls[j].scale));
                let h = f64::from(exp((-0.5 * r.norm2() * per * per) as f32)) * near.alike(output, i, k);
                own += h;
                slope += r * (-h * per * per * (here.cover + pulls[j].cover));
                let cover = (here.cover * pulls[j].cover).max(0.0).sqrt();
                entries.push(((2.0 * cover * h * per * per) as f32, r.0.map(|c| (c * per) as f32)));
            }
            let slope = slope + here.cover_slope * own - here.wanted_slope * 2.0;
            (if output.is_kept(i) { Vector::ZERO } else { slope }, entries)
        };
        let blocks: Result<Vec<(Vec<Vector<D>>, Vec<Entry<D>>)>> = (0..output.places.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let (mut slopes, mut entries) = (Vec::with_capacity(BLOCK), Vec::new());
                let range = block * BLOCK..(block * BLOCK + BLOCK).min(output.places.len());
                budget.spend(range.clone().map(|i| near.pairs.span(i).len() as u64 * PAIR).sum())?;
                for i in range {
                    let (slope, own) = row(i);
                    slopes.push(slope);
                    entries.extend(own);
                }
                Ok((slopes, entries))
            })
            .collect();
        let (mut slopes, mut entries) =
            (Vec::with_capacity(output.places.len()), Vec::with_capacity(near.pairs.total()));
        for (more, rows) in blocks? {
            slopes.extend(more);
            entries.extend(rows);
        }
        let mut diagonal: Vec<f64> = (0..output.places.len())
            .map(|i| {
                let width = sigma * pulls[i].scale;
                2.0 * f64::from(inner(&output.weights[i], &output.weights[i])) * pulls[i].cover / (width * width)
            })
            .collect();
        crowd.slopes(level, output, |i, slope, curve| {
            slopes[i] += if output.is_kept(i) { Vector::ZERO } else { slope };
            diagonal[i] += curve;
        });
        Ok(Self { slopes, diagonal, entries })
    }

    fn product(&self, near: &Near, x: &[Vector<D>]) -> Vec<Vector<D>> {
        (0..x.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let mut sum = x[i] * (self.diagonal[i] * (1.0 + DAMPING));
                let span = near.pairs.span(i);
                for ((weight, r), &j) in self.entries[span.clone()].iter().zip(&near.pairs.items()[span]) {
                    let other = x[j as usize];
                    let along: f64 = (0..D).map(|k| f64::from(r[k]) * other[k]).sum();
                    let w = f64::from(*weight);
                    for k in 0..D {
                        sum[k] += w * (other[k] - along * f64::from(r[k]));
                    }
                }
                sum
            })
            .collect()
    }
}

/// The direction for the slopes of `system`: `T` falls along it at first.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn direction<const D: usize>(
    output: &Output<D>,
    near: &Near,
    system: &System<D>,
    budget: &Budget,
) -> Result<Vec<Vector<D>>> {
    let slopes = &system.slopes;
    let precondition = |r: &[Vector<D>]| -> Vec<Vector<D>> {
        let mut z: Vec<_> = r.iter().zip(&system.diagonal).map(|(r, d)| *r * (1.0 / d.max(1e-30))).collect();
        admissible(output, &mut z);
        z
    };
    let mut x = vec![Vector::ZERO; slopes.len()];
    let mut r: Vec<Vector<D>> = slopes.iter().map(|&g| -g).collect();
    admissible(output, &mut r);
    let mut z = precondition(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let stop = 1e-3 * rz;
    for _ in 0..STEPS {
        if rz <= stop || rz <= 0.0 {
            break;
        }
        budget.spend(near.pairs.total() as u64 * PRODUCT)?;
        let mut product = system.product(near, &p);
        admissible(output, &mut product);
        let curve = dot(&p, &product);
        if curve <= 0.0 {
            break;
        }
        let step = rz / curve;
        for i in 0..x.len() {
            x[i] += p[i] * step;
            r[i] += product[i] * -step;
        }
        z = precondition(&r);
        let next = dot(&r, &z);
        let beta = next / rz;
        rz = next;
        for i in 0..p.len() {
            p[i] = z[i] + p[i] * beta;
        }
    }
    Ok(x)
}

fn dot<const D: usize>(a: &[Vector<D>], b: &[Vector<D>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// The nearest movement in which rigid elements stay rigid, at first order, and kept points stay.
pub(crate) fn admissible<const D: usize>(output: &Output<D>, moves: &mut [Vector<D>]) {
    moves[..output.kept].fill(Vector::ZERO);
    for body in output.bodies.iter().filter(|b| b.first >= output.kept) {
        let range = body.first..body.first + body.count;
        let places = &output.places[range.clone()];
        let n = 1.0 / body.count.max(1) as f64;
        let mean = |v: &[Vector<D>]| v.iter().fold(Vector::ZERO, |s, &p| s + p) * n;
        let (centre, shift) = (mean(places), mean(&moves[range.clone()]));
        let spin = spin(places, centre, &moves[range.clone()]);
        for i in range {
            moves[i] = shift + spin.apply(output.places[i] - centre);
        }
    }
}

/// The skew matrix that best explains `moves` of `places` as a turn about `centre`.
pub(crate) fn spin<const D: usize>(places: &[Vector<D>], centre: Vector<D>, moves: &[Vector<D>]) -> Matrix<D> {
    let mut spin = Matrix::zero();
    // Moment of the movements, and the inertia of the points, in the planes of two coordinates.
    let planes: Vec<(usize, usize)> = (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b))).collect();
    let mut moment = [0.0; 3];
    let mut inertia = [[0.0; 3]; 3];
    for (&p, &v) in places.iter().zip(moves) {
        let r = p - centre;
        // Rows: the movement at r for a unit turn in each plane.
        let unit = |(a, b): (usize, usize)| {
            let mut u = Vector::<D>::ZERO;
            (u[a], u[b]) = (-r[b], r[a]);
            u
        };
        for (s, &plane) in planes.iter().enumerate() {
            let u = unit(plane);
            moment[s] += u.dot(v);
            for (t, &other) in planes.iter().enumerate() {
                inertia[s][t] += u.dot(unit(other));
            }
        }
    }
    let trace: f64 = (0..planes.len()).map(|s| inertia[s][s]).sum();
    if trace <= 0.0 {
        return spin;
    }
    for (s, row) in inertia.iter_mut().enumerate() {
        // Thin rods and single points do not turn about themselves.
        row[s] += if s < planes.len() { 1e-6 * trace } else { 1.0 };
    }
    let turn = solve(inertia, moment);
    for (s, (a, b)) in planes.into_iter().enumerate() {
        spin.0[a][b] = -turn[s];
        spin.0[b][a] = turn[s];
    }
    spin
}

/// Solves three equations of a positive definite matrix.
fn solve(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| Vector(a).cross(Vector(b));
    let (x, y, z) = (cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    let determinant = Vector(m[0]).dot(x);
    let sum = x * v[0] + y * v[1] + z * v[2];
    (sum * (1.0 / determinant)).0
}
