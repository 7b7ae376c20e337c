//! Charts of a mesh around a place: where points of the shell lie in the plane, by geodesics from sample to sample [Schmidt 2006].

use std::{cmp::Reverse, collections::BinaryHeap};

use arabesque_core::{Bounds, Budget, Error, Result, Vector};
use arabesque_surface::{Closest, MeshIndex, OrientedPoints, SurfaceFrame, scatter};
use rayon::prelude::*;

/// Samples at most.
const MOST: f64 = 400_000.0;
/// How far samples know one another, in their spacings.
const BESIDE: f64 = 2.4;
/// Samples from which a place is told, in their spacings.
const NEAR: f64 = 1.8;

/// Samples of a mesh that know their neighbours.
pub(crate) struct Samples {
    pub(crate) feet: Vec<Closest>,
    pub(crate) points: OrientedPoints,
    pub(crate) beside: Vec<Vec<u32>>,
    pub(crate) spacing: f64,
}

impl Samples {
    /// Samples about `spacing` apart.
    pub(crate) fn new(mesh: &MeshIndex, spacing: f64, budget: &Budget) -> Result<Self> {
        let spacing = spacing.max((mesh.area() / MOST).sqrt());
        let feet = scatter(mesh, spacing, 0, budget)?;
        if feet.len() < 4 {
            return Err(Error::no_result("the mesh is smaller than a patch", "give a larger mesh, or a smaller scale"));
        }
        let positions = feet.iter().map(|f| f.point).collect();
        let normals = feet.iter().map(|f| f.normal).collect();
        let points = OrientedPoints::new(positions, normals, BESIDE * spacing, budget)?;
        budget.spend(feet.len() as u64 * 1500)?;
        let of = |foot: &Closest| {
            let mut near = Vec::new();
            points.around(foot.point, BESIDE * spacing, |j, d2| {
                if points.normals()[j].dot(foot.normal) > 0.3 && d2 > 0.0 {
                    near.push(j as u32);
                }
            });
            near.sort_unstable();
            near
        };
        let beside = feet.par_iter().map(of).collect();
        Ok(Self { beside, points, feet, spacing })
    }
}

/// A sample in a chart: where it is, and which way the axes of the plane run there.
#[derive(Clone, Copy, Debug)]
struct Station {
    at: [f64; 2],
    along: Vector<3>,
    across: Vector<3>,
}

/// A part of a mesh, laid out in the plane around the origin.
pub(crate) struct Chart<'a> {
    samples: &'a Samples,
    mesh: &'a MeshIndex,
    stations: Stations,
    /// Samples by the cell of the plane they lie in, row by row; the first cell of a row lies so far to the left and below, in cells.
    cells: Vec<Vec<u32>>,
    across: usize,
    corner: [i32; 2],
}

/// Samples that are laid out.
struct Stations {
    /// For each sample of the mesh its place in the list, or [`NONE`].
    places: Vec<u32>,
    list: Vec<(u32, Station)>,
}

/// No place.
const NONE: u32 = u32::MAX;

impl Stations {
    fn get(&self, sample: u32) -> Option<&Station> {
        self.list.get(self.places[sample as usize] as usize).map(|(_, station)| station)
    }

    fn insert(&mut self, sample: u32, station: Station) {
        self.places[sample as usize] = self.list.len() as u32;
        self.list.push((sample, station));
    }
}

impl<'a> Chart<'a> {
    /// The chart around a sample, as far as `reach`; `frame` says which way the plane runs there.
    pub(crate) fn new(
        (samples, mesh): (&'a Samples, &'a MeshIndex),
        start: u32,
        frame: &SurfaceFrame,
        reach: f64,
        budget: &Budget,
    ) -> Result<Self> {
        let (tangent, bitangent) = (frame.tangent, frame.bitangent());
        budget.spend(samples.feet.len() as u64 * 4)?;
        let mut stations = Stations { places: vec![NONE; samples.feet.len()], list: Vec::new() };
        let mut offered = vec![f64::INFINITY; samples.feet.len()];
        let mut heap = BinaryHeap::from([(Reverse(0_u64), start)]);
        let mut meter = budget.meter();
        while let Some((Reverse(bits), i)) = heap.pop() {
            meter.spend(1500)?;
            if stations.get(i).is_some() {
                continue;
            }
            let far = f64::from_bits(bits);
            let station = if i == start {
                Station { at: [0.0; 2], along: tangent, across: bitangent }
            } else {
                let Some(station) = reached(samples, &stations, i) else { continue };
                station
            };
            stations.insert(i, station);
            if station.at[0].abs().max(station.at[1].abs()) > reach {
                continue;
            }
            let here = samples.feet[i as usize].point;
            for &j in &samples.beside[i as usize] {
                let next = far + (samples.feet[j as usize].point - here).norm();
                if stations.get(j).is_none() && next < offered[j as usize] {
                    offered[j as usize] = next;
                    // Distances are not negative, so that their bits are in their order.
                    heap.push((Reverse(next.to_bits()), j));
                }
            }
        }
        Ok(Self::sorted(samples, mesh, stations))
    }

    /// With its samples in cells.
    fn sorted(samples: &'a Samples, mesh: &'a MeshIndex, stations: Stations) -> Self {
        let mut chart = Self { samples, mesh, stations, cells: Vec::new(), across: 0, corner: [0; 2] };
        let mut places: Vec<(u32, [i32; 2])> = chart.laid().map(|(i, at)| (i, chart.cell(at))).collect();
        places.sort_unstable_by_key(|(i, _)| *i);
        let [mut low, mut high] = [[0; 2]; 2];
        for (_, cell) in &places {
            (low, high) = ([0, 1].map(|k| cell[k].min(low[k])), [0, 1].map(|k| cell[k].max(high[k])));
        }
        chart.corner = low;
        chart.across = (high[0] - low[0]) as usize + 1;
        chart.cells.resize(chart.across * ((high[1] - low[1]) as usize + 1), Vec::new());
        for (i, [x, y]) in places {
            let k = (y - low[1]) as usize * chart.across + (x - low[0]) as usize;
            chart.cells[k].push(i);
        }
        chart
    }

    /// The samples in a cell.
    fn in_cell(&self, x: i32, y: i32) -> &[u32] {
        let column = usize::try_from(x.saturating_sub(self.corner[0])).ok().filter(|column| *column < self.across);
        let row = usize::try_from(y.saturating_sub(self.corner[1])).ok();
        let cell = column.zip(row).and_then(|(column, row)| self.cells.get(row.checked_mul(self.across)? + column));
        cell.map_or(&[], Vec::as_slice)
    }

    fn cell(&self, at: [f64; 2]) -> [i32; 2] {
        at.map(|v| (v / (NEAR * self.samples.spacing)).floor() as i32)
    }

    /// The samples of the chart with where they lie.
    pub(crate) fn laid(&self) -> impl Iterator<Item = (u32, [f64; 2])> + '_ {
        self.stations.list.iter().map(|(i, s)| (*i, s.at))
    }

    /// The sample that is nearest to a place of the plane, if there is one within reach.
    pub(crate) fn sample_at(&self, at: [f64; 2]) -> Option<u32> {
        self.near(at).map(|near| near[0].1)
    }

    /// The samples around a place of the plane, nearest first.
    fn near(&self, at: [f64; 2]) -> Option<Vec<(f64, u32)>> {
        let reach = NEAR * self.samples.spacing;
        let [x, y] = self.cell(at);
        let mut found = Vec::new();
        for j in y.saturating_sub(1)..=y.saturating_add(1) {
            for i in x.saturating_sub(1)..=x.saturating_add(1) {
                for &k in self.in_cell(i, j) {
                    let s = self.stations.get(k)?;
                    let d = ((s.at[0] - at[0]).powi(2) + (s.at[1] - at[1]).powi(2)).sqrt();
                    if d < reach {
                        found.push((d, k));
                    }
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        (!found.is_empty()).then_some(found)
    }

    /// From the shell to the plane: place and direction. `None` for what lies beyond the chart.
    pub(crate) fn flattened(&self, p: Vector<3>, normal: Vector<3>) -> Option<(Vector<3>, Vector<3>)> {
        let foot = self.mesh.closest(p);
        let height = self.mesh.height(&foot, p);
        let reach = NEAR * self.samples.spacing;
        let (mut at, mut along, mut across, mut sum) = ([0.0; 2], Vector::ZERO, Vector::ZERO, 0.0);
        let mut first: Option<[f64; 2]> = None;
        let mut around: Vec<(f64, u32)> = Vec::new();
        self.samples.points.around(foot.point, reach, |i, d2| around.push((d2.sqrt(), i as u32)));
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (d, i) in around {
            let Some(s) = self.stations.get(i) else { continue };
            let own = &self.samples.feet[i as usize];
            if own.normal.dot(foot.normal) < 0.0 {
                continue;
            }
            let step = foot.point - own.point;
            let here = [s.at[0] + s.along.dot(step), s.at[1] + s.across.dot(step)];
            // On the far side of a closed shape the chart meets itself: what is nearest says where.
            let first = *first.get_or_insert(here);
            if (here[0] - first[0]).hypot(here[1] - first[1]) > 1.5 * reach {
                continue;
            }
            let w = (1.0 - d / reach).powi(2);
            at = [at[0] + here[0] * w, at[1] + here[1] * w];
            along += s.along * w;
            across += s.across * w;
            sum += w;
        }
        if sum <= 1e-9 {
            return None;
        }
        let (along, across) = framed(along, across, foot.normal)?;
        let turned = Vector([normal.dot(along), normal.dot(across), normal.dot(foot.normal)]);
        Some((Vector([at[0] / sum, at[1] / sum, height]), turned))
    }

    /// From the plane back to the shell.
    pub(crate) fn raised(&self, p: Vector<3>, normal: Vector<3>) -> Option<(Vector<3>, Vector<3>)> {
        let near = self.near([p[0], p[1]])?;
        let reach = NEAR * self.samples.spacing;
        let main = &self.samples.feet[near[0].1 as usize];
        // Beyond an open border there is nothing.
        if near[0].0 > 1.3 * self.samples.spacing {
            return None;
        }
        let (mut at, mut along, mut across, mut sum) = (Vector::ZERO, Vector::ZERO, Vector::ZERO, 0.0);
        for (d, i) in near {
            let s = self.stations.get(i)?;
            let own = &self.samples.feet[i as usize];
            if (own.point - main.point).norm() > 2.0 * reach {
                continue;
            }
            let w = (1.0 - d / reach).powi(2);
            at += (own.point + s.along * (p[0] - s.at[0]) + s.across * (p[1] - s.at[1])) * w;
            along += s.along * w;
            across += s.across * w;
            sum += w;
        }
        if sum <= 1e-9 {
            return None;
        }
        let foot = self.mesh.closest(at * (1.0 / sum));
        let (along, across) = framed(along, across, foot.normal)?;
        let turned = along * normal[0] + across * normal[1] + foot.normal * normal[2];
        Some((foot.point + foot.normal * p[2], turned.unit_if_longer(1e-9)?))
    }

    /// The smallest box around the samples of the chart.
    pub(crate) fn bounds(&self) -> Bounds<3> {
        Bounds::around(self.stations.list.iter().map(|(i, _)| self.samples.feet[*i as usize].point))
    }
}

/// Two directions, made right-angled and tangent to `normal`.
fn framed(along: Vector<3>, across: Vector<3>, normal: Vector<3>) -> Option<(Vector<3>, Vector<3>)> {
    let flat = |v: Vector<3>| v - normal * normal.dot(v);
    let (a, b) = (flat(along).unit_if_longer(1e-9)?, flat(across).unit_if_longer(1e-9)?);
    // Half of what is missing to a right angle goes to each.
    let lean = 0.5 * a.dot(b);
    Some(((a - b * lean).unit_if_longer(1e-9)?, (b - a * lean).unit_if_longer(1e-9)?))
}

/// Where a sample lies in a chart, by the samples around it that are laid out already.
fn reached(samples: &Samples, stations: &Stations, i: u32) -> Option<Station> {
    let own = &samples.feet[i as usize];
    let (mut at, mut along, mut across, mut sum) = ([0.0; 2], Vector::ZERO, Vector::ZERO, 0.0);
    let mut first: Option<[f64; 2]> = None;
    for &j in &samples.beside[i as usize] {
        let Some(s) = stations.get(j) else { continue };
        let other = &samples.feet[j as usize];
        let step = own.point - other.point;
        let length = step.norm();
        let flat = step - other.normal * other.normal.dot(step);
        // The way along the surface is as long as the step, and leads where the step leads.
        let way = flat.unit_or_zero() * length;
        let here = [s.at[0] + s.along.dot(way), s.at[1] + s.across.dot(way)];
        let first = *first.get_or_insert(here);
        if (here[0] - first[0]).hypot(here[1] - first[1]) > 2.0 * samples.spacing {
            continue;
        }
        let w = 1.0 / (length * length).max(1e-12 * samples.spacing * samples.spacing);
        at = [at[0] + here[0] * w, at[1] + here[1] * w];
        let turned = |v: Vector<3>| carried(v, other.normal, own.normal);
        along += turned(s.along) * w;
        across += turned(s.across) * w;
        sum += w;
    }
    if sum <= 0.0 {
        return None;
    }
    let (along, across) = framed(along, across, own.normal)?;
    Some(Station { at: [at[0] / sum, at[1] / sum], along, across })
}

/// A tangent of one plane as a tangent of another: turned as their normals are.
fn carried(v: Vector<3>, from: Vector<3>, to: Vector<3>) -> Vector<3> {
    let cos = from.dot(to);
    if cos < -0.99 {
        return v;
    }
    let axis = from.cross(to);
    v * cos + axis.cross(v) + axis * (axis.dot(v) / (1.0 + cos))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use arabesque_core::TriangleMesh;

    use super::*;

    /// An open tube of radius 1 along z.
    fn tube() -> MeshIndex {
        let (around, up) = (48, 40);
        let at = |k: usize| {
            let angle = TAU * (k % around) as f64 / around as f64;
            Vector([angle.cos(), angle.sin(), 0.1 * (k / around) as f64])
        };
        let positions = (0..around * (up + 1)).map(at).collect();
        let mut triangles = Vec::new();
        for j in 0..up {
            for i in 0..around {
                let v = |di: usize, dj: usize| ((j + dj) * around + (i + di) % around) as u32;
                triangles.extend([[v(0, 0), v(1, 0), v(1, 1)], [v(0, 0), v(1, 1), v(0, 1)]]);
            }
        }
        let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
        MeshIndex::new(&mesh, "tube", &Budget::default()).unwrap()
    }

    #[test]
    fn a_tube_is_unrolled_and_rolled_up_again() {
        let (mesh, budget) = (tube(), Budget::default());
        let samples = Samples::new(&mesh, 0.08, &budget).unwrap();
        let middle = Vector([1.0, 0.0, 2.0]);
        let far = |f: &Closest| (f.point - middle).norm();
        let start =
            (0..samples.feet.len()).min_by(|&a, &b| far(&samples.feet[a]).total_cmp(&far(&samples.feet[b]))).unwrap();
        let origin = samples.feet[start].point;
        let frame = SurfaceFrame { tangent: Vector([0.0, 0.0, 1.0]), normal: samples.feet[start].normal };
        let chart = Chart::new((&samples, &mesh), start as u32, &frame, 0.9, &budget).unwrap();
        for (angle, z, h) in [(0.5, 0.3, 0.0), (-0.6, -0.5, 0.1), (0.1, 0.7, -0.05)] {
            let turned = angle + origin[1].atan2(origin[0]);
            let out = Vector([turned.cos(), turned.sin(), 0.0]);
            let p = Vector([0.0, 0.0, origin[2] + z]) + out * (1.0 + h);
            let (flat, normal) = chart.flattened(p, out).unwrap();
            let across = frame.bitangent().dot(Vector([0.0, 1.0, 0.0])).signum() * angle;
            assert!((flat - Vector([z, across, h])).norm() < 0.03, "{flat:?} for {angle} {z} {h}");
            assert!(normal[2] > 0.99);
            let (back, normal) = chart.raised(flat, normal).unwrap();
            assert!((back - p).norm() < 0.02 && normal.dot(out) > 0.99, "{back:?} {p:?}");
        }
    }
}
