//! The surface of one part.

use arabesque_core::{Budget, Error, PointSet, Result, Vector};
use rayon::prelude::*;

use super::{
    lid::{is_closed, trimmed},
    report::Notes,
};
use crate::{
    cloud::{Neighbours, buried, contradictions, estimated, mended, sheets, turned},
    implicit::{Balls, Field, Kernel, Oriented, border_offset, metaballs, rimls, rimls_bytes},
    isosurface::{Patch, beyond_border, crumbs, cut, march, pinches},
    mesh::MeshIndex,
    params::{Method, Normals, SurfaceParams},
};

/// Fewest points that make a surface.
pub(super) const LEAST: usize = 4;
/// Side of a cell where nobody says, in spacings: about six triangles for each point.
pub(super) const CELL: f64 = 0.68;
/// Side of a cell of metaballs where nobody says, in radii of the smaller ones.
const CELL_OF_BALLS: f64 = 0.4;
/// Most memory that nodes take of what is allowed, where nobody says how large cells are.
const AFFORDABLE: f64 = 0.4;
/// Memory of the nodes around a point that lies as others do, at most, in bytes: about half of it on spheres.
const OF_POINT: f64 = 3000.0;
/// Share of contradicting normals from which all are turned anew.
const CONTRARY: f64 = 0.2;
/// Pieces of surface smaller than so many squares of the spacing are crumbs.
const CRUMB: f64 = 3.0;
/// Crumbs are told where they are a larger share of the surface.
const WORTH: f64 = 0.02;

/// Work of sorting one point.
const PER_SORTED: u64 = 60;

/// Whether most points lie where more than `count` lie at exactly one place.
fn is_heap(positions: &[Vector<3>], count: usize) -> bool {
    let mut keys: Vec<_> = positions.iter().map(|p| p.0.map(|c| (c + 0.0).to_bits())).collect();
    keys.par_sort_unstable();
    let heaped: usize = keys.chunk_by(|a, b| a == b).map(<[_]>::len).filter(|&n| n > count).sum();
    2 * heaped > positions.len()
}

/// What is asked for, with what goes for all parts.
pub(super) struct Job<'a> {
    pub(super) params: &'a SurfaceParams,
    /// Side of a cell, where it was given.
    pub(super) cell: Option<f64>,
    pub(super) trim: Option<&'a MeshIndex>,
    pub(super) budget: &'a Budget,
}

/// Points of a part with what a surface needs of them.
struct Cloud {
    positions: Vec<Vector<3>>,
    normals: Vec<Vector<3>>,
    colours: Option<Vec<[f64; 3]>>,
    spacing: Vec<f64>,
    /// The points of each sheet.
    sheets: Vec<Vec<usize>>,
}

impl Job<'_> {
    /// How points become a surface.
    pub(super) fn method(&self, points: &PointSet<3>) -> Method {
        match (self.params.method, &points.radii, &points.normals) {
            (Method::Auto, Some(_), None) => Method::Metaballs,
            (Method::Auto, ..) => Method::Rimls,
            (method, ..) => method,
        }
    }

    /// The surfaces of one part's points.
    pub(super) fn patches(&self, points: &PointSet<3>, name: &str, notes: &mut Notes) -> Result<Vec<Patch>> {
        if self.method(points) == Method::Metaballs {
            let (field, grain) = self.of_balls(points)?;
            return Ok(vec![self.patch(field, false, grain, notes)?]);
        }
        let cloud = self.cloud(points, name, notes)?;
        let mut sorted = cloud.spacing.clone();
        sorted.sort_by(f64::total_cmp);
        let grain = sorted[sorted.len() / 2];
        let mut patches = Vec::with_capacity(cloud.sheets.len());
        for sheet in &cloud.sheets {
            let field = self.of_sheet(&cloud, sheet, grain, notes)?;
            patches.push(self.patch(field, true, grain, notes)?);
        }
        Ok(patches)
    }

    /// The surface of a field.
    fn patch(&self, field: Field, is_open: bool, grain: f64, notes: &mut Notes) -> Result<Patch> {
        let mut patch = march(&field, self.budget)?;
        self.budget.spend(patch.triangles.len() as u64 * 200)?;
        if is_open {
            let values = beyond_border(&patch);
            patch = cut(patch, &values);
        }
        let lidded = match self.trim {
            Some(trim) if is_closed(&patch) => trimmed(&field, &patch, trim, self.budget)?,
            _ => None,
        };
        drop(field);
        if let Some(field) = lidded {
            patch = march(&field, self.budget)?;
        } else if let Some(trim) = self.trim {
            let places: Vec<_> = patch.vertices.iter().map(|v| v.at).collect();
            let values: Vec<f32> = trim.signed_distances(&places, self.budget)?.iter().map(|d| -d as f32).collect();
            patch = cut(patch, &values);
        }
        let (dropped, share) = crumbs(&mut patch, CRUMB * grain * grain);
        // What is left of grooves and of borders is not worth a word.
        notes.crumbs += if share > WORTH { dropped } else { 0 };
        pinches(&mut patch);
        Ok(patch)
    }

    fn of_balls(&self, points: &PointSet<3>) -> Result<(Field, f64)> {
        let Some(radii) = &points.radii else {
            return Err(Error::parameter("method", "metaballs", "rimls, or points with radii"));
        };
        let mut sorted = radii.clone();
        sorted.sort_by(f64::total_cmp);
        let small = sorted[sorted.len() / 10];
        let cell = self.cell.unwrap_or(CELL_OF_BALLS * small);
        let balls = Balls { positions: &points.positions, radii, colours: points.colours.as_deref() };
        Ok((metaballs(&balls, self.params.reach, cell, self.budget)?, small))
    }

    /// The field of one sheet of points; `grain` is the spacing of most points.
    fn of_sheet(&self, cloud: &Cloud, sheet: &[usize], grain: f64, notes: &mut Notes) -> Result<Field> {
        let positions: Vec<_> = sheet.iter().map(|&i| cloud.positions[i]).collect();
        let normals: Vec<_> = sheet.iter().map(|&i| cloud.normals[i]).collect();
        let colours: Option<Vec<_>> = cloud.colours.as_ref().map(|c| sheet.iter().map(|&i| c[i]).collect());
        let kernel = Kernel {
            rounds: self.params.rounds,
            residual: self.params.residual as f32,
            sharpness: self.params.sharpness as f32,
            border: border_offset((self.params.border - 0.5) / self.params.kernel) as f32,
        };
        let radii = |cell: f64| -> Vec<f64> {
            // A cell at the surface has all its nodes within reach of points.
            let radius = |s: f64| (self.params.kernel * s).max(1.8 * cell + 0.7 * s);
            sheet.iter().map(|&i| radius(cloud.spacing[i])).collect()
        };
        let mut oriented =
            Oriented { positions: &positions, normals: &normals, colours: colours.as_deref(), radii: &[] };
        let cell = match self.cell {
            Some(cell) => cell,
            None => self.affordable(CELL * grain, oriented, &radii, notes)?,
        };
        let radii = radii(cell);
        oriented.radii = &radii;
        rimls(&oriented, kernel, cell, self.budget)
    }

    /// The side of a cell where nobody says: the usual one, or as much larger as the nodes have to be fewer.
    fn affordable(
        &self,
        usual: f64,
        points: Oriented<'_>,
        radii: &dyn Fn(f64) -> Vec<f64>,
        notes: &mut Notes,
    ) -> Result<f64> {
        let most = AFFORDABLE * self.budget.limits().memory as f64;
        if points.positions.len() as f64 * OF_POINT < most {
            return Ok(usual);
        }
        let mut cell = usual;
        loop {
            let radii = radii(cell);
            let bytes = rimls_bytes(&Oriented { radii: &radii, ..points }, cell, self.budget)? as f64;
            if bytes <= most {
                break;
            }
            // Nodes lie along the surface.
            cell *= (bytes / most).sqrt().max(1.05);
        }
        if cell > usual && notes.coarser.is_none_or(|(_, largest)| cell > largest) {
            notes.coarser = Some((usual, cell));
        }
        Ok(cell)
    }

    /// The points with normals and spacings.
    fn cloud(&self, points: &PointSet<3>, name: &str, notes: &mut Notes) -> Result<Cloud> {
        let heaped = || {
            Error::input(
                name,
                "most points lie in one place, expected points spread over a surface",
                "remove points that are there more than once",
            )
        };
        // In a heap each point has all others for neighbours, and looking for them takes long.
        self.budget.spend(PER_SORTED * points.len() as u64)?;
        if is_heap(&points.positions, self.params.neighbours) {
            return Err(heaped());
        }
        let neighbours = Neighbours::new(&points.positions, self.params.neighbours, self.budget)?;
        let median = neighbours.median_spacing();
        if median.is_nan() || median <= 0.0 {
            return Err(heaped());
        }
        let mut left_out = Vec::new();
        let normals = match (&points.normals, self.params.normals) {
            (Some(given), Normals::Auto | Normals::Given) => self.given(points, given, &neighbours, notes)?,
            (None, Normals::Given) => {
                return Err(Error::input(
                    name,
                    "points without normals, expected nx, ny and nz",
                    "set normals=auto to have them estimated",
                ));
            }
            _ => {
                let found = estimated(&points.positions, &neighbours, self.budget)?;
                if found.are_in_line {
                    return Err(Error::input(
                        name,
                        "all points lie along lines, expected points spread over a surface",
                        "give normals or radii, so that there is a surface around them",
                    ));
                }
                notes.estimated += points.len();
                notes.pieces += found.parts;
                left_out = found.outliers;
                found.normals
            }
        };
        let spacing = neighbours.even_spacing();
        if points.len() - left_out.len() < LEAST {
            left_out.clear();
        }
        notes.outliers += left_out.len();
        let sheets = sheets(&points.positions, &normals, &neighbours);
        let bare = |mut sheet: Vec<usize>| -> Result<Vec<usize>> {
            sheet.retain(|i| left_out.binary_search(i).is_err());
            let hidden = buried(&points.positions, &normals, &spacing, &sheet, self.budget)?;
            notes.buried += hidden.len();
            sheet.retain(|i| hidden.binary_search(i).is_err());
            Ok(sheet)
        };
        let sheets: Result<Vec<_>> = sheets.into_iter().map(bare).collect();
        Ok(Cloud {
            positions: points.positions.clone(),
            normals,
            colours: points.colours.clone(),
            spacing,
            sheets: sheets?.into_iter().filter(|sheet| !sheet.is_empty()).collect(),
        })
    }

    /// Normals as they were given, but for what cannot be.
    fn given(
        &self,
        points: &PointSet<3>,
        given: &[Vector<3>],
        neighbours: &Neighbours,
        notes: &mut Notes,
    ) -> Result<Vec<Vector<3>>> {
        self.budget.spend(points.len() as u64 * 200)?;
        let (mut normals, missing) = mended(&points.positions, given, neighbours);
        notes.mended += missing;
        let share = contradictions(&points.positions, &normals, neighbours);
        if share > CONTRARY && self.params.normals == Normals::Auto {
            let before = normals.clone();
            turned(&points.positions, &mut normals, neighbours, self.budget)?;
            // Most of them say which side is outside.
            let kept = before.iter().zip(&normals).filter(|(a, b)| a.dot(**b) > 0.0).count();
            if kept * 2 < normals.len() {
                normals.iter_mut().for_each(|n| *n = -*n);
            }
            notes.turned += kept.min(normals.len() - kept);
        } else {
            notes.contradictions = notes.contradictions.max(share);
        }
        Ok(normals)
    }
}
