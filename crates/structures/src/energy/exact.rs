//! The error density and its slopes as they are written down, for tests: sums over all pairs, with nothing left out.

use arabesque_core::{Matrix, Vector};

/// One scene: points and attributes of the output around a site, those of the exemplar around a match, and the frame between them.
#[derive(Clone)]
pub(crate) struct Scene<const D: usize> {
    pub(crate) x: Vec<Vector<D>>,
    pub(crate) a: Vec<Vec<f64>>,
    pub(crate) e: Vec<Vector<D>>,
    pub(crate) b: Vec<Vec<f64>>,
    pub(crate) q: Vector<D>,
    pub(crate) m: Vector<D>,
    pub(crate) rotation: Matrix<D>,
    pub(crate) scale: f64,
    pub(crate) sigma: f64,
    pub(crate) delta: f64,
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<const D: usize> Scene<D> {
    fn widths(&self) -> (f64, f64) {
        (self.sigma * self.scale, self.delta * self.scale)
    }

    pub(crate) fn w(&self, u: Vector<D>, v: Vector<D>) -> f64 {
        let (sigma, delta) = self.widths();
        let s2 = sigma * sigma;
        let a = 2.0 / s2 + 1.0 / (delta * delta);
        let e = -(u.norm2() + v.norm2()) / s2 + (u + v).norm2() / (s2 * s2 * a);
        (std::f64::consts::PI / a).powf(D as f64 / 2.0) * e.exp()
    }

    fn d1w(&self, u: Vector<D>, v: Vector<D>) -> Vector<D> {
        let (sigma, delta) = self.widths();
        let s2 = sigma * sigma;
        let a = 2.0 / s2 + 1.0 / (delta * delta);
        (u * (-2.0 / s2) + (u + v) * (2.0 / (s2 * s2 * a))) * self.w(u, v)
    }

    fn u(&self) -> Vec<Vector<D>> {
        self.x.iter().map(|&x| x - self.q).collect()
    }

    fn v(&self) -> Vec<Vector<D>> {
        self.e.iter().map(|&e| self.rotation.apply(e - self.m) * self.scale).collect()
    }

    /// `S`.
    pub(crate) fn error(&self) -> f64 {
        let (u, v) = (self.u(), self.v());
        let sum = |p: &[Vector<D>], a: &[Vec<f64>], q: &[Vector<D>], b: &[Vec<f64>]| -> f64 {
            p.iter().zip(a).flat_map(|(p, a)| q.iter().zip(b).map(move |(q, b)| inner(a, b) * self.w(*p, *q))).sum()
        };
        sum(&u, &self.a, &u, &self.a) - 2.0 * sum(&u, &self.a, &v, &self.b) + sum(&v, &self.b, &v, &self.b)
    }

    /// Its slope by the place of point `i`.
    pub(crate) fn by_place(&self, i: usize) -> Vector<D> {
        let (u, v) = (self.u(), self.v());
        let mut sum = Vector::ZERO;
        for j in 0..u.len() {
            sum += self.d1w(u[i], u[j]) * (2.0 * inner(&self.a[i], &self.a[j]));
        }
        for j in 0..v.len() {
            sum += self.d1w(u[i], v[j]) * (-2.0 * inner(&self.a[i], &self.b[j]));
        }
        sum
    }

    /// Its slope by attribute `c` of point `i`.
    pub(crate) fn by_attribute(&self, i: usize, c: usize) -> f64 {
        let (u, v) = (self.u(), self.v());
        let own: f64 = (0..u.len()).map(|j| self.a[j][c] * self.w(u[i], u[j])).sum();
        let wanted: f64 = (0..v.len()).map(|j| self.b[j][c] * self.w(u[i], v[j])).sum();
        2.0 * (own - wanted)
    }

    /// Its slope by the match.
    pub(crate) fn by_match(&self) -> Vector<D> {
        let (u, v) = (self.u(), self.v());
        let mut sum = Vector::ZERO;
        for j in 0..v.len() {
            for l in 0..v.len() {
                sum += self.d1w(v[j], v[l]) * (2.0 * inner(&self.b[j], &self.b[l]));
            }
            for i in 0..u.len() {
                sum += self.d1w(v[j], u[i]) * (-2.0 * inner(&self.b[j], &self.a[i]));
            }
        }
        self.rotation.transpose().apply(sum) * -self.scale
    }

    /// The sampling error density of [Roveri 2015 eq. 7], for masses of 1.
    pub(crate) fn sampling(&self) -> f64 {
        let (sigma, delta) = self.widths();
        let (s2, d2) = (sigma * sigma, delta * delta);
        let sum = |p: Vec<Vector<D>>| p.iter().map(|p| (-p.norm2() / (s2 + d2)).exp()).sum::<f64>();
        (std::f64::consts::PI * s2 * d2 / (s2 + d2)).powf(D as f64 / 2.0) * (sum(self.u()) - sum(self.v()))
    }

    /// The integrals themselves, by sums on a fine grid: of the squared difference and of the difference of masses, under the window.
    pub(crate) fn integrals(&self) -> (f64, f64) {
        let (sigma, delta) = self.widths();
        let (reach, step) = (4.5 * delta, sigma / 4.0);
        let n = (reach / step) as i64;
        let side = 2 * n + 1;
        let (u, v) = (self.u(), self.v());
        let field = |p: &[Vector<D>], a: &[Vec<f64>], at: Vector<D>, c: usize| -> f64 {
            p.iter().zip(a).map(|(p, a)| a[c] * (-(at - *p).norm2() / (sigma * sigma)).exp()).sum()
        };
        let (mut square, mut mass) = (0.0, 0.0);
        for index in 0..side.pow(D as u32) {
            let mut rest = index;
            let at = Vector(std::array::from_fn(|_| {
                let c = rest % side - n;
                rest /= side;
                c as f64 * step
            }));
            let weight = (-at.norm2() / (delta * delta)).exp() * step.powi(D as i32);
            for c in 0..self.a[0].len() {
                let off = field(&u, &self.a, at, c) - field(&v, &self.b, at, c);
                square += weight * off * off;
                mass += if c == 0 { weight * off } else { 0.0 };
            }
        }
        (square, mass)
    }
}

mod tests {
    use arabesque_core::{Similarity, Stage, Stream};

    use super::*;

    fn scene<const D: usize>(seed: u64, turn: Matrix<D>, scale: f64) -> Scene<D> {
        let mut s = Stream::new(seed, Stage::TEST, 0);
        let mut place = |size: f64| Vector(std::array::from_fn(|_| s.range(-size, size)));
        let x: Vec<Vector<D>> = (0..6).map(|_| place(2.0 * scale)).collect();
        let e: Vec<Vector<D>> = (0..5).map(|_| place(2.0)).collect();
        let (q, m) = (place(0.4), place(0.4));
        let mut s = Stream::new(seed, Stage::TEST, 1);
        let mut attribute = |_: usize| vec![1.0, s.range(-1.0, 1.0), s.range(-1.0, 1.0)];
        let a = (0..6).map(&mut attribute).collect();
        let b = (0..5).map(&mut attribute).collect();
        Scene { x, a, e, b, q, m, rotation: turn, scale, sigma: 0.8, delta: 1.3 }
    }

    fn close(found: f64, slope: f64, size: f64) {
        assert!((found - slope).abs() <= 1e-5 * size.max(slope.abs()), "{found} for {slope}");
    }

    fn check<const D: usize>(scene: &Scene<D>) {
        let h = 1e-5;
        let difference = |change: &dyn Fn(&mut Scene<D>, f64)| {
            let at = |h: f64| {
                let mut moved = scene.clone();
                change(&mut moved, h);
                moved.error()
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        let size = scene.by_match().norm().max(scene.by_place(0).norm());
        for k in 0..D {
            for i in 0..scene.x.len() {
                close(difference(&|s, h| s.x[i][k] += h), scene.by_place(i)[k], size);
            }
            close(difference(&|s, h| s.m[k] += h), scene.by_match()[k], size);
        }
        for c in 0..3 {
            close(difference(&|s, h| s.a[2][c] += h), scene.by_attribute(2, c), size);
        }
        let (square, mass) = scene.integrals();
        close(scene.error(), square, square);
        close(scene.sampling(), mass, square.sqrt());
    }

    #[test]
    fn slopes_are_those_of_finite_differences_and_sums_those_of_integrals() {
        for seed in 0..4 {
            check(&scene::<2>(seed, Matrix::rotation(0.4 + seed as f64), 1.0 + 0.3 * seed as f64));
        }
        let (c, s) = (0.6_f64, 0.8_f64);
        check(&scene::<3>(9, Matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), 1.0));
    }

    #[test]
    fn an_output_that_is_the_exemplar_has_no_error() {
        let mut scene = scene::<2>(3, Matrix::rotation(0.9), 1.4);
        scene.x = scene.e.iter().map(|&e| scene.q + scene.rotation.apply(e - scene.m) * scene.scale).collect();
        scene.a.clone_from(&scene.b);
        assert!(scene.error().abs() < 1e-12 && scene.sampling().abs() < 1e-12 && scene.by_match().norm() < 1e-12);
        // Twice the same point never helps.
        let before = scene.error();
        scene.x.push(scene.x[1]);
        scene.a.push(scene.a[1].clone());
        assert!(scene.error() > before && scene.sampling() > 0.0);
    }

    proptest::proptest! {
        /// Where the output is and how it is turned says nothing, nor where the exemplar is.
        #[test]
        fn motions_change_nothing(seed in 0_u64..1000, angle in -3.2..3.2_f64, shift in -50.0..50.0_f64, factor in 0.3..3.0_f64) {
            let before = scene::<2>(seed, Matrix::rotation(0.3), 1.0);
            let mut after = before.clone();
            let motion = Similarity::about(Vector::ZERO, Vector::xy(shift, -2.0 * shift), Matrix::rotation(angle), factor);
            after.x.iter_mut().for_each(|x| *x = motion.apply(*x));
            after.q = motion.apply(after.q);
            (after.rotation, after.scale) = (motion.rotation.compose(&before.rotation), factor);
            let moved = Vector::xy(-shift, 3.0);
            after.e.iter_mut().for_each(|e| *e += moved);
            after.m += moved;
            // Areas grow with the square of the scale.
            let error = after.error() / (factor * factor);
            proptest::prop_assert!((error - before.error()).abs() < 1e-8 * before.error().abs(), "{} {}", error, before.error());
        }

        /// A second point in one place always costs more than the first one did.
        #[test]
        fn the_second_of_two_points_helps_less(seed in 0_u64..1000, x in -1.0..1.0_f64, y in -1.0..1.0_f64) {
            let mut scene = scene::<2>(seed, Matrix::identity(), 1.0);
            let mut errors = vec![scene.error()];
            for _ in 0..2 {
                scene.x.push(Vector::xy(x, y));
                scene.a.push(vec![1.0, 0.3, -0.4]);
                errors.push(scene.error());
            }
            proptest::prop_assert!(errors[2] - errors[1] > errors[1] - errors[0]);
        }
    }
}
