//! Triangles in samples.
//!
//! A mesh in several places is drawn a batch of places at a time, from the nearest on. Places that lie behind what was drawn before are passed
//! over; of the others all vertices are brought to where they are seen, and then each band of the picture draws the triangles that reach into
//! it, in their order, so that the picture is the same for any number of threads.

use arabesque_core::{Bounds, Budget, Held, Meter, Result, Similarity, TriangleMesh, Vector};
use rayon::prelude::*;

use super::frame::{Ball, Band, Frame, Projection, Reach, Sample};

/// Work of the ball around one place, of one vertex, of one triangle, and of one sample of its box.
const PER_BALL: u64 = 60;
const PER_VERTEX: u64 = 30;
const PER_TRIANGLE: u64 = 30;
const PER_SAMPLE: u64 = 4;

/// Vertices, or triangles, of a batch, unless one place has more.
const BATCH: usize = 1 << 16;
/// Vertices that one thread takes at a time.
const SHARE: usize = 1 << 12;
/// Triangles that are passed over together.
const RUN: usize = 128;

/// A mesh as it is drawn, in several places.
pub(super) struct Placed<'a> {
    pub(super) mesh: &'a TriangleMesh,
    pub(super) places: &'a [Similarity<3>],
    /// Directions at the corners of the triangles.
    pub(super) normals: &'a [[Vector<3>; 3]],
    /// The colour of a vertex in a place.
    pub(super) colour: &'a (dyn Fn(usize, u32) -> [u8; 3] + Sync),
}

/// How the corners of a triangle look: their directions as the picture has them, and their colours.
#[derive(Clone, Copy, Debug)]
struct Corners {
    normals: [[f32; 3]; 3],
    colours: [[u8; 3]; 3],
}

/// Draws a mesh in its places, the nearest first. What lies between corners is between them in every respect.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
pub(super) fn draw(placed: &Placed<'_>, projection: &Projection, frame: &mut Frame, budget: &Budget) -> Result<()> {
    let Placed { mesh, places, .. } = placed;
    let each = mesh.positions.len().max(mesh.triangles.len()).max(1);
    let balls = balls(mesh, places, projection, budget)?;
    for batch in balls.chunks((BATCH / each).max(1)) {
        let hidden = batch.par_iter().map(|ball| frame.hides(ball, budget)).collect::<Result<Vec<bool>>>()?;
        let shown = batch.iter().zip(&hidden).filter(|(_, is_hidden)| !**is_hidden);
        let numbers = shown.map(|(ball, _)| ball.number).collect();
        let seen = Seen::new(placed, numbers, projection, budget)?;
        frame
            .bands()
            .into_par_iter()
            .try_for_each(|mut band| seen.draw(placed, projection, &mut band, &mut budget.meter()))?;
        budget.spend(0)?;
    }
    Ok(())
}

/// The balls around the mesh in its places, the nearest first: most of a heap is behind what is in front.
fn balls(mesh: &TriangleMesh, places: &[Similarity<3>], projection: &Projection, budget: &Budget) -> Result<Vec<Ball>> {
    budget.spend(PER_BALL * places.len() as u64 + mesh.positions.len() as u64)?;
    let centre = Bounds::around(mesh.positions.iter().copied()).centre();
    let radius = mesh.positions.iter().map(|p| (*p - centre).norm()).fold(0.0, f64::max);
    let ball = |(number, place): (usize, &Similarity<3>)| Ball {
        number,
        place: projection.place(place.apply(centre)),
        radius: radius * place.scale * projection.scale,
    };
    let mut balls: Vec<Ball> = places.iter().enumerate().map(ball).collect();
    balls.par_sort_by(|a, b| b.near().total_cmp(&a.near()).then(a.number.cmp(&b.number)));
    Ok(balls)
}

/// The mesh in those places of a batch where something of it may be seen.
struct Seen {
    /// The numbers of the places.
    numbers: Vec<usize>,
    /// For each of them, the vertices as columns, rows and nearness in samples.
    vertices: Vec<[f64; 3]>,
    /// For each of them, the rows of each run of triangles.
    reaches: Vec<Reach>,
    /// Vertices and runs of one place.
    each: [usize; 2],
    _held: [Held; 2],
}

impl Seen {
    fn new(placed: &Placed<'_>, numbers: Vec<usize>, projection: &Projection, budget: &Budget) -> Result<Self> {
        let Placed { mesh, places, .. } = placed;
        let each = [mesh.positions.len(), mesh.triangles.len().div_ceil(RUN)];
        let (mut vertices, held) = budget.list("vertices as they are seen", each[0] * numbers.len())?;
        vertices.resize(each[0] * numbers.len(), [0.0; 3]);
        vertices.par_chunks_mut(SHARE).enumerate().try_for_each(|(share, list)| {
            budget.spend(PER_VERTEX * list.len() as u64)?;
            for (k, seen) in list.iter_mut().enumerate() {
                let k = share * SHARE + k;
                *seen = projection.place(places[numbers[k / each[0]]].apply(mesh.positions[k % each[0]]));
            }
            Ok(())
        })?;
        let (mut reaches, runs) = budget.list("triangles as they are seen", each[1] * numbers.len())?;
        reaches.resize(each[1] * numbers.len(), Reach::NONE);
        let mut seen = Self { numbers, vertices, reaches: Vec::new(), each, _held: [held, runs] };
        reaches.par_iter_mut().enumerate().try_for_each(|(k, reach)| {
            let (place, run) = (k / each[1], k % each[1]);
            let triangles = mesh.triangles.chunks(RUN).nth(run).unwrap_or_default();
            budget.spend(PER_TRIANGLE * triangles.len() as u64)?;
            let rows = triangles.iter().flatten().map(|&v| seen.vertex(place, v)[1]);
            *reach = rows.fold(Reach::NONE, |reach, row| reach.joined(row, row));
            Ok(())
        })?;
        budget.spend(0)?;
        seen.reaches = reaches;
        Ok(seen)
    }

    fn vertex(&self, place: usize, v: u32) -> [f64; 3] {
        self.vertices[place * self.each[0] + v as usize]
    }

    /// Draws what reaches into a band.
    fn draw(
        &self,
        placed: &Placed<'_>,
        projection: &Projection,
        band: &mut Band<'_>,
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        let Placed { mesh, places, normals, colour } = placed;
        for (k, reach) in self.reaches.iter().enumerate() {
            if band.rows(reach.from, reach.to).is_empty() {
                continue;
            }
            let (place, run) = (k / self.each[1], k % self.each[1]);
            let (number, end) = (self.numbers[place], ((run + 1) * RUN).min(mesh.triangles.len()));
            let turn = |n: Vector<3>| projection.axes.turned(places[number].rotation.apply(n)).0.map(|c| c as f32);
            for t in run * RUN..end {
                let triangle = mesh.triangles[t];
                let corners =
                    || Corners { normals: normals[t].map(turn), colours: triangle.map(|v| colour(number, v)) };
                draw_one(triangle.map(|v| self.vertex(place, v)), corners, band, meter)?;
            }
        }
        Ok(())
    }
}

/// Draws one triangle with its corners at `places`; how they look is asked for where something of it is seen.
fn draw_one(
    places: [[f64; 3]; 3],
    corners: impl Fn() -> Corners,
    band: &mut Band<'_>,
    meter: &mut Meter<'_>,
) -> Result<()> {
    let [a, b, c] = places;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if !area.is_normal() {
        return Ok(());
    }
    let extreme = |k: usize, pick: fn(f64, f64) -> f64| pick(pick(a[k], b[k]), c[k]);
    let mut asked = None;
    for y in band.rows(extreme(1, f64::min), extreme(1, f64::max)) {
        let row = y as f64 + 0.5;
        let Some([from, to]) = crossed(places, row) else { continue };
        let columns = Frame::span(from, to, band.width);
        meter.spend(PER_SAMPLE * (1 + columns.len() as u64))?;
        for x in columns {
            let p = [x as f64 + 0.5, row];
            // Shares of the corners: each is the area of the triangle that the place makes with the other two.
            let share =
                |u: [f64; 3], v: [f64; 3]| ((v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0])) / area;
            let shares = [share(b, c), share(c, a), share(a, b)].map(|s| s.clamp(0.0, 1.0));
            let depth = (0..3).map(|k| shares[k] * places[k][2]).sum::<f64>() as f32;
            if band.is_free(x, y, depth) {
                band.put(x, y, between(asked.get_or_insert_with(&corners), shares, depth));
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

fn between(Corners { normals, colours }: &Corners, shares: [f64; 3], depth: f32) -> Sample {
    let shares = shares.map(|s| s as f32);
    let normal = std::array::from_fn(|axis| (0..3).map(|k| shares[k] * normals[k][axis]).sum());
    let colour = match colours[0] == colours[1] && colours[1] == colours[2] {
        true => colours[0],
        false => {
            std::array::from_fn(|c| (0..3).map(|k| shares[k] * f32::from(colours[k][c])).sum::<f32>().round() as u8)
        }
    };
    Sample::new(depth, normal, colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws triangles whose corners face the eye, redder to the right.
    fn drawn(triangles: &[[[f64; 3]; 3]], size: [usize; 2]) -> Frame {
        let budget = Budget::default();
        let mut frame = Frame::empty(size, &budget).unwrap();
        for places in triangles {
            let colours = places.map(|[x, ..]| [(x * 10.0) as u8, 0, 0]);
            let corners = || Corners { normals: [[0.0, 0.0, 1.0]; 3], colours };
            for mut band in frame.bands() {
                draw_one(*places, corners, &mut band, &mut budget.meter()).unwrap();
            }
        }
        frame
    }

    #[test]
    fn a_square_of_two_triangles_has_no_seam() {
        let [a, b, c, d] = [[3.0, 3.0, 0.0], [17.0, 3.0, 0.0], [17.0, 17.0, 14.0], [3.0, 17.0, 14.0]];
        let frame = drawn(&[[a, b, c], [c, d, a]], [10, 10]);
        let covered = frame.samples.iter().filter(|s| s.is_something()).count();
        assert_eq!(covered, 14 * 14);
        let middle = frame.samples[10 * frame.width + 10];
        assert!((middle.depth - 7.5).abs() < 1e-6 && (95..=110).contains(&middle.colour[0]), "{middle:?}");
    }

    #[test]
    fn what_lies_outside_or_has_no_area_draws_nothing() {
        let far = [[50.0, 50.0, 0.0], [60.0, 50.0, 0.0], [50.0, 60.0, 0.0]];
        let thin = [[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [2.0, 2.0, 0.0]];
        let broken = [[f64::NAN, 0.0, 0.0], [4.0, 4.0, 0.0], [2.0, 7.0, 0.0]];
        let frame = drawn(&[far, thin, broken], [4, 4]);
        assert!(frame.samples.iter().all(|s| !s.is_something()));
    }
}
