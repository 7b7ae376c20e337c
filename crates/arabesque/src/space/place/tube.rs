//! A tube around curves in space.

use arabesque_core::{Bounds, Error, Matrix, Region, Result, Rotations, Vector, rounded};
use arabesque_structures::{Along, Foot, Thread, Tube as Threads};

/// What lies nearer to curves than a radius; open curves end in flat ends.
#[derive(Debug)]
pub(super) struct Tube {
    threads: Threads<3>,
    radius: f64,
}

/// Corners nearer to one another than this share of the radius are left out: each question to the tube looks at many of them.
const FINE: f64 = 0.1;
/// Most corners.
const MOST: usize = 100_000;

/// A line without corners that are close to the one before; its ends stay.
fn thinned(line: Vec<Vector<3>>, least: f64) -> Vec<Vector<3>> {
    let last = line.last().copied();
    let mut kept: Vec<Vector<3>> = Vec::new();
    for p in line {
        if kept.last().is_none_or(|before| (p - *before).norm() >= least) {
            kept.push(p);
        }
    }
    if let Some(last) = last.filter(|last| kept.last() != Some(last)) {
        kept.push(last);
    }
    kept
}

impl Tube {
    /// A tube in which the pattern is turned about the curve by some degrees at its start, and by some more until its end.
    ///
    /// # Errors
    /// [`Error::Parameter`] for numbers out of range, [`Error::Input`] for curves that have too many corners for their radius.
    pub(super) fn new(lines: Vec<Vec<Vector<3>>>, radius: f64, [turned, twist]: [f64; 2]) -> Result<Self> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(Error::parameter("tube", radius, "a radius above 0"));
        }
        if !twist.is_finite() {
            return Err(Error::parameter("twist", twist, "degrees"));
        }
        let ends = [turned, turned + twist].map(f64::to_radians);
        let lines: Vec<_> = lines.into_iter().map(|line| thinned(line, FINE * radius)).collect();
        let corners: usize = lines.iter().map(Vec::len).sum();
        if corners > MOST {
            let problem =
                format!("{corners} corners for a tube of radius {}, at most {MOST} are possible", rounded(radius));
            return Err(Error::input("the curves", problem, "simplify them, or make the tube wider"));
        }
        let thread = |line| Thread { roll: Along(vec![(0.0, ends[0]), (1.0, ends[1])]), ..Thread::new(line) };
        Ok(Self { threads: Threads::new(lines.into_iter().map(thread).collect(), radius)?, radius })
    }

    fn depth(&self, foot: &Foot<3>) -> f64 {
        let beside = (foot.distance.powi(2) - foot.beyond.powi(2)).max(0.0).sqrt();
        if foot.beyond > 0.0 { (self.radius - beside).min(-foot.beyond) } else { self.radius - foot.distance }
    }
}

impl Region<3> for Tube {
    fn bounds(&self) -> Bounds<3> {
        self.threads.bounds().grown(self.radius)
    }

    fn measure(&self) -> f64 {
        self.threads.length() * std::f64::consts::PI * self.radius * self.radius
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        self.depth(&self.threads.foot(p))
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        let foot = self.threads.foot(p);
        let tangent = Vector([0, 1, 2].map(|r| foot.rotation.0[r][0]));
        let away = p - foot.point;
        let beside = away - tangent * away.dot(tangent);
        let across = beside.unit_if_longer(1e-12).unwrap_or_else(|| Vector([0, 1, 2].map(|r| foot.rotation.0[r][1])));
        if foot.beyond > 0.0 {
            foot.point + across * beside.norm().min(self.radius)
        } else {
            foot.point + across * self.radius
        }
    }
}

impl Rotations<3> for Tube {
    fn at(&self, p: Vector<3>) -> Matrix<3> {
        self.threads.foot(p).rotation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight() -> Tube {
        Tube::new(vec![vec![Vector([0.0, 0.0, 0.0]), Vector([0.0, 0.0, 4.0])]], 0.5, [0.0, 90.0]).unwrap()
    }

    #[test]
    fn distances_are_those_of_a_cylinder() {
        let tube = straight();
        for (p, expected) in [
            ([0.0, 0.0, 2.0], 0.5),
            ([0.3, 0.4, 1.0], 0.0),
            ([2.0, 0.0, 1.0], -1.5),
            ([0.1, 0.0, 4.7], -0.7),
            ([0.0, 0.2, -0.25], -0.25),
        ] {
            assert!((tube.signed_distance(Vector(p)) - expected).abs() < 1e-9, "{p:?}");
        }
        assert!((tube.measure() - std::f64::consts::PI).abs() < 1e-9);
        let nearest = tube.nearest_boundary(Vector([2.0, 0.0, 1.0]));
        assert!((nearest - Vector([0.5, 0.0, 1.0])).norm() < 1e-9);
        let end = tube.nearest_boundary(Vector([0.1, 0.0, 4.7]));
        assert!((end - Vector([0.1, 0.0, 4.0])).norm() < 1e-9);
    }

    #[test]
    fn x_runs_along_the_curve_and_the_twist_turns_the_rest() {
        let tube = straight();
        let [start, end] = [0.0, 4.0].map(|z| tube.at(Vector([0.0, 0.0, z])));
        for rotation in [start, end] {
            assert!((rotation.apply(Vector([1.0, 0.0, 0.0])) - Vector([0.0, 0.0, 1.0])).norm() < 1e-9);
        }
        let y = Vector([0.0, 1.0, 0.0]);
        assert!(start.apply(y).dot(end.apply(y)).abs() < 1e-9, "a quarter turn");
    }

    #[test]
    fn tubes_without_a_radius_or_a_line_are_refused() {
        assert!(Tube::new(vec![vec![Vector::ZERO, Vector::splat(1.0)]], 0.0, [0.0; 2]).is_err());
        assert!(Tube::new(Vec::new(), 1.0, [0.0; 2]).is_err());
        assert!(Tube::new(vec![vec![Vector::ZERO]], 1.0, [0.0; 2]).is_err());
        let dense = (0..200_000).map(|k| Vector([f64::from(k), 0.0, 0.0])).collect();
        let refused = Tube::new(vec![dense], 0.5, [0.0; 2]).unwrap_err();
        assert!(refused.to_string().contains("200000 corners for a tube of radius 0.5"), "{refused}");
        let fine = (0..200_000).map(|k| Vector([1e-4 * f64::from(k), 0.0, 0.0])).collect();
        assert!(Tube::new(vec![fine], 0.5, [0.0; 2]).is_ok());
    }
}
