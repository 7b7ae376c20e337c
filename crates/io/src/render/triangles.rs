//! Triangles in samples.

use arabesque_core::{Budget, Result};

use super::frame::{Frame, Sample};

/// Work of one triangle, and of one sample of its box.
const PER_TRIANGLE: u64 = 60;
const PER_SAMPLE: u64 = 4;

/// A corner as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Column, row and nearness, in samples.
    pub(super) place: [f64; 3],
    /// Direction as the picture has it.
    pub(super) normal: [f32; 3],
    pub(super) colour: [u8; 3],
}

/// Draws triangles. What lies between corners is between them in every respect.
pub(super) fn draw(triangles: impl Iterator<Item = [Corner; 3]>, frame: &mut Frame, budget: &Budget) -> Result<()> {
    let mut meter = budget.meter();
    for corners in triangles {
        meter.spend(PER_TRIANGLE)?;
        let [a, b, c] = corners.map(|corner| corner.place);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if !area.is_normal() {
            continue;
        }
        let extreme = |k: usize, pick: fn(f64, f64) -> f64| pick(pick(a[k], b[k]), c[k]);
        let rows = Frame::span(extreme(1, f64::min), extreme(1, f64::max), frame.height);
        for y in rows {
            let row = y as f64 + 0.5;
            let Some([from, to]) = crossed([a, b, c], row) else { continue };
            let columns = Frame::span(from, to, frame.width);
            meter.spend(PER_SAMPLE * (1 + columns.len() as u64))?;
            for x in columns {
                let p = [x as f64 + 0.5, row];
                // Shares of the corners: each is the area of the triangle that the place makes with the other two.
                let share =
                    |u: [f64; 3], v: [f64; 3]| ((v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0])) / area;
                let shares = [share(b, c), share(c, a), share(a, b)].map(|s| s.clamp(0.0, 1.0));
                let depth = (0..3).map(|k| shares[k] * corners[k].place[2]).sum::<f64>() as f32;
                if frame.is_free(x, y, depth) {
                    frame.put(x, y, between(&corners, shares, depth));
                }
            }
        }
    }
    Ok(())
}

/// From where to where a triangle covers a row.
fn crossed(corners: [[f64; 3]; 3], row: f64) -> Option<[f64; 2]> {
    let mut found: Option<[f64; 2]> = None;
    for k in 0..3 {
        let [u, v] = [corners[k], corners[(k + 1) % 3]];
        if (u[1] - row) * (v[1] - row) > 0.0 || u[1] == v[1] {
            continue;
        }
        let x = u[0] + (v[0] - u[0]) * ((row - u[1]) / (v[1] - u[1]));
        found = Some(found.map_or([x, x], |[from, to]| [from.min(x), to.max(x)]));
    }
    found
}

fn between(corners: &[Corner; 3], shares: [f64; 3], depth: f32) -> Sample {
    let shares = shares.map(|s| s as f32);
    let normal = std::array::from_fn(|axis| (0..3).map(|k| shares[k] * corners[k].normal[axis]).sum());
    let colour = match corners[0].colour == corners[1].colour && corners[1].colour == corners[2].colour {
        true => corners[0].colour,
        false => std::array::from_fn(|c| {
            (0..3).map(|k| shares[k] * f32::from(corners[k].colour[c])).sum::<f32>().round() as u8
        }),
    };
    Sample::new(depth, normal, colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f64, y: f64, depth: f64) -> Corner {
        Corner { place: [x, y, depth], normal: [0.0, 0.0, 1.0], colour: [(x * 10.0) as u8, 0, 0] }
    }

    #[test]
    fn a_square_of_two_triangles_has_no_seam() {
        let mut frame = Frame::empty([10, 10], &Budget::default()).unwrap();
        let square = [corner(3.0, 3.0, 0.0), corner(17.0, 3.0, 0.0), corner(17.0, 17.0, 14.0), corner(3.0, 17.0, 14.0)];
        let [a, b, c, d] = square;
        draw([[a, b, c], [c, d, a]].into_iter(), &mut frame, &Budget::default()).unwrap();
        let covered = frame.samples.iter().filter(|s| s.is_something()).count();
        assert_eq!(covered, 14 * 14);
        let middle = frame.samples[10 * frame.width + 10];
        assert!((middle.depth - 7.5).abs() < 1e-6 && (95..=110).contains(&middle.colour[0]), "{middle:?}");
    }

    #[test]
    fn what_lies_outside_or_has_no_area_draws_nothing() {
        let mut frame = Frame::empty([4, 4], &Budget::default()).unwrap();
        let far = [corner(50.0, 50.0, 0.0), corner(60.0, 50.0, 0.0), corner(50.0, 60.0, 0.0)];
        let thin = [corner(0.0, 0.0, 0.0), corner(4.0, 4.0, 0.0), corner(2.0, 2.0, 0.0)];
        let broken = [corner(f64::NAN, 0.0, 0.0), corner(4.0, 4.0, 0.0), corner(2.0, 7.0, 0.0)];
        draw([far, thin, broken].into_iter(), &mut frame, &Budget::default()).unwrap();
        assert!(frame.samples.iter().all(|s| !s.is_something()));
    }
}
