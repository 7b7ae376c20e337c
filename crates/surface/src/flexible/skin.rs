//! A mesh that follows samples which have moved.
//!
//! Along a line every vertex stays where it is from the line: seen from a frame that goes along without turning about it more than it did.
//! In a volume every vertex moves by the rigid motion that suits the samples best, the near ones most [Zhu 2007]. Where the samples have
//! moved as a rigid thing, so does the mesh, to rounding.

use arabesque_core::{Build, Matrix, Similarity, Vector};

/// Samples around the middle of a line that tell how it is turned there.
const AROUND: usize = 3;
/// Steps between two samples in which the nearest place of a line is looked for.
const STEPS: usize = 6;
/// Exponent of the distance by which samples in a volume count, and what is added to it, in squared distances of samples.
const FALL: f64 = 2.0;
const SOFTEN: f64 = 0.05;

/// Where the vertices of a mesh are from its samples.
#[derive(Clone, Debug)]
pub struct Skin {
    build: Build,
    samples: Vec<Vector<3>>,
    vertices: Vec<Vector<3>>,
    /// Along a line: how many samples each vertex is from its start.
    along: Vec<f64>,
    /// In a volume: mean squared distance of a sample from its nearest one.
    near: f64,
}

impl Skin {
    /// Vertices and the samples that stand for them, in the same coordinates.
    pub fn new(build: Build, samples: &[Vector<3>], vertices: &[Vector<3>]) -> Self {
        let is_line = build == Build::Strand && samples.len() > 1;
        let along = if is_line { vertices.iter().map(|v| nearest(samples, *v)).collect() } else { Vec::new() };
        let near = |p: &Vector<3>| {
            samples.iter().map(|q| (*q - *p).norm2()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
        };
        let all: Vec<f64> = samples.iter().map(near).filter(|d| d.is_finite()).collect();
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        let build = if is_line { Build::Strand } else { build };
        Self { build, samples: samples.to_vec(), vertices: vertices.to_vec(), along, near: mean }
    }

    /// The vertices once the samples are at `to`, `scale` times as large, and how each is turned.
    pub fn moved(&self, to: &[Vector<3>], scale: f64) -> (Vec<Vector<3>>, Vec<Matrix<3>>) {
        if to.len() != self.samples.len() {
            return (self.vertices.clone(), vec![Matrix::identity(); self.vertices.len()]);
        }
        match self.build {
            Build::Strand => self.along_line(to, scale),
            Build::Bag if to.len() > 1 => self.in_volume(to, scale),
            Build::Bag | Build::Rigid => {
                let fit = Similarity::fit(&self.samples, to, scale, Matrix::identity());
                let turned = vec![fit.rotation; self.vertices.len()];
                (self.vertices.iter().map(|v| fit.apply(*v)).collect(), turned)
            }
        }
    }

    fn along_line(&self, to: &[Vector<3>], scale: f64) -> (Vec<Vector<3>>, Vec<Matrix<3>>) {
        let frames = frames(&self.samples, to);
        let one = |(v, &x): (&Vector<3>, &f64)| {
            let (before, way) = on_line(&self.samples, x);
            let (after, new) = on_line(to, x);
            let frame = &frames[(x.round() as usize).min(frames.len() - 1)];
            let turn = shortest(frame.apply(way), new).compose(frame);
            (after + turn.apply(*v - before) * scale, turn)
        };
        self.vertices.iter().zip(&self.along).map(one).unzip()
    }

    fn in_volume(&self, to: &[Vector<3>], scale: f64) -> (Vec<Vector<3>>, Vec<Matrix<3>>) {
        let one = |v: &Vector<3>| {
            let weight = |p: &Vector<3>| ((*p - *v).norm2() + SOFTEN * self.near).max(f64::MIN_POSITIVE).powf(-FALL);
            let weights: Vec<f64> = self.samples.iter().map(weight).collect();
            let total: f64 = weights.iter().sum();
            let mean = |places: &[Vector<3>]| {
                places.iter().zip(&weights).fold(Vector::ZERO, |sum, (p, w)| sum + *p * *w) * (1.0 / total)
            };
            let (from, target) = (mean(&self.samples), mean(to));
            let mut covariance = Matrix::<3>::zero();
            for ((p, q), w) in self.samples.iter().zip(to).zip(&weights) {
                let (p, q) = (*p - from, (*q - target) * (*w / total));
                for r in 0..3 {
                    for c in 0..3 {
                        covariance.0[r][c] += q[r] * p[c];
                    }
                }
            }
            let turn = covariance.nearest_rotation();
            (target + turn.apply(*v - from) * scale, turn)
        };
        self.vertices.iter().map(one).unzip()
    }
}

/// Place and direction, of length 1, of a smooth line through samples, `x` samples from its start [Catmull 1974].
fn on_line(samples: &[Vector<3>], x: f64) -> (Vector<3>, Vector<3>) {
    let last = samples.len() - 1;
    let k = (x.max(0.0) as usize).min(last.saturating_sub(1));
    let t = x - k as f64;
    let (b, c) = (samples[k], samples[k + 1]);
    let a = if k == 0 { b * 2.0 - c } else { samples[k - 1] };
    let d = if k + 2 > last { c * 2.0 - b } else { samples[k + 2] };
    let (m, n) = ((c - a) * 0.5, (d - b) * 0.5);
    let (t2, t3) = (t * t, t * t * t);
    let place = b * (2.0 * t3 - 3.0 * t2 + 1.0) + m * (t3 - 2.0 * t2 + t) + c * (3.0 * t2 - 2.0 * t3) + n * (t3 - t2);
    let way =
        b * (6.0 * t2 - 6.0 * t) + m * (3.0 * t2 - 4.0 * t + 1.0) + c * (6.0 * t - 6.0 * t2) + n * (3.0 * t2 - 2.0 * t);
    (place, way.unit_if_longer(0.0).unwrap_or_else(|| (c - b).unit_or_zero()))
}

/// Where on the line through samples the place nearest to `v` is.
fn nearest(samples: &[Vector<3>], v: Vector<3>) -> f64 {
    let steps = (samples.len() - 1) * STEPS;
    let at = |n: usize| n as f64 / STEPS as f64;
    let far = |x: f64| (on_line(samples, x).0 - v).norm2();
    let best = (0..=steps).fold((f64::INFINITY, 0), |best, n| {
        let d = far(at(n));
        if d < best.0 { (d, n) } else { best }
    });
    let (mut low, mut high) = (at(best.1.saturating_sub(1)), at((best.1 + 1).min(steps)));
    for _ in 0..20 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if far(a) <= far(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// How a line is turned at each sample: as its middle as a whole, and from there without turning about itself.
fn frames(from: &[Vector<3>], to: &[Vector<3>]) -> Vec<Matrix<3>> {
    let count = from.len();
    let middle = count / 2;
    let around = middle.saturating_sub(AROUND)..(middle + AROUND + 1).min(count);
    let way = |samples: &[Vector<3>], k: usize| on_line(samples, k as f64).1;
    let whole = Similarity::fit(&from[around.clone()], &to[around], 1.0, Matrix::identity()).rotation;
    let mut frames = vec![whole; count];
    let along = |frame: &Matrix<3>, k: usize| shortest(frame.apply(way(from, k)), way(to, k)).compose(frame);
    frames[middle] = along(&whole, middle);
    for k in middle + 1..count {
        frames[k] = along(&frames[k - 1], k);
    }
    for k in (0..middle).rev() {
        frames[k] = along(&frames[k + 1], k);
    }
    frames
}

/// The shortest rotation that takes one direction to another, both of length 1.
fn shortest(from: Vector<3>, to: Vector<3>) -> Matrix<3> {
    let (axis, cos) = (from.cross(to), from.dot(to));
    if cos < -1.0 + 1e-9 {
        // Half a turn about anything across.
        let least = (0..3).fold(0, |best, k| if from[k].abs() < from[best].abs() { k } else { best });
        let mut unit = Vector::ZERO;
        unit[least] = 1.0;
        let axis = from.cross(unit).unit_or_zero();
        return Matrix(std::array::from_fn(|r| {
            std::array::from_fn(|c| 2.0 * axis[r] * axis[c] - f64::from(u8::from(r == c)))
        }));
    }
    let [x, y, z] = axis.0;
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let scale = 1.0 / (1.0 + cos);
    Matrix(std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let square: f64 = (0..3).map(|k| cross[r][k] * cross[k][c]).sum();
            f64::from(u8::from(r == c)) + cross[r][c] + scale * square
        })
    }))
}
