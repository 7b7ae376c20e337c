//! Columns of numbers as points with attributes.

use arabesque_core::{Budget, Error, Held, PointSet, Result, Vector, Warning};

use super::{
    attributes::{Attribute, NAMES},
    found::{Cloud, Geometry},
};

/// Work of putting one point together.
const PER_POINT: u64 = 40;
/// How far from 1 the length of a normal may be that was rounded when it was written, such as to three decimals.
const ROUNDED: f64 = 0.01;

/// One column for each attribute that a file has, and what they mean.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    /// Values of the attributes in the order of [`NAMES`], already checked; empty for what the file does not have.
    pub(crate) values: [Vec<f64>; NAMES.len()],
    /// What stands for full red, green and blue; found from the values where it is not known.
    pub(crate) full: Option<f64>,
    held: Vec<Held>,
}

impl Columns {
    /// Room for `count` points with the given attributes.
    ///
    /// # Errors
    /// [`Error::Limit`] when the memory is used up.
    pub(crate) fn with_room(has: [bool; NAMES.len()], count: usize, budget: &Budget) -> Result<Self> {
        let mut columns = Self::default();
        for (values, _) in columns.values.iter_mut().zip(has).filter(|(_, has)| *has) {
            let (list, held) = budget.list("values of the points", count)?;
            *values = list;
            columns.held.push(held);
        }
        Ok(columns)
    }

    /// Puts the points together.
    ///
    /// # Errors
    /// [`Error::Input`] naming `name` where a coordinate is missing; those of the budget.
    pub(crate) fn into_geometry(mut self, name: &str, budget: &Budget) -> Result<Geometry> {
        let count = self.values[0].len();
        budget.spend(PER_POINT * count as u64)?;
        let _held = budget.hold("points with attributes", count.saturating_mul(self.bytes_of_a_point()))?;
        for axis in [0, 1] {
            if self.column(Attribute::Position(axis)).len() != count || count == 0 {
                let problem = format!("points without a coordinate {}", Attribute::Position(axis).name());
                return Err(Error::input(name, problem, "give x, y and, in space, z for every point"));
            }
        }
        let mut notes = Notes { name, zero_normals: 0, warnings: Vec::new() };
        let points = match self.column(Attribute::Position(2)).is_empty() {
            true => Cloud::Plane(self.points([0, 1], &mut notes)),
            false => Cloud::Space(self.points([0, 1, 2], &mut notes)),
        };
        let Notes { zero_normals, warnings, .. } = notes;
        Ok(Geometry { zero_normals, warnings, ..Geometry::of_points(points) })
    }

    fn bytes_of_a_point(&self) -> usize {
        8 * self.values.iter().filter(|v| !v.is_empty()).count()
    }

    fn column(&self, attribute: Attribute) -> &[f64] {
        &self.values[attribute.index()]
    }

    fn points<const D: usize>(&mut self, axes: [usize; D], notes: &mut Notes<'_>) -> PointSet<D> {
        let positions = self.vectors(axes.map(Attribute::Position)).unwrap_or_default();
        let normals = self.vectors(axes.map(Attribute::Normal));
        if normals.is_none() && (0..3).any(|k| !self.column(Attribute::Normal(k)).is_empty()) {
            notes.warn("normals without all their coordinates are left out", "give nx and ny and, in space, nz");
        }
        let normals = normals.and_then(|normals| notes.units(normals));
        let colours = self.colours(notes);
        let whole = |values: Vec<f64>| {
            Some(values.into_iter().map(|v| v as i32).collect()).filter(|list: &Vec<i32>| !list.is_empty())
        };
        let mut take = |attribute: Attribute| std::mem::take(&mut self.values[attribute.index()]);
        let radii = Some(take(Attribute::Radius)).filter(|radii| !radii.is_empty());
        let [groups, elements, classes] =
            [Attribute::Group, Attribute::Element, Attribute::Class].map(|a| whole(take(a)));
        PointSet { positions, normals, colours, radii, groups, elements, classes }
    }

    /// Vectors of three or two columns, where all of them are there.
    fn vectors<const D: usize>(&self, attributes: [Attribute; D]) -> Option<Vec<Vector<D>>> {
        let columns = attributes.map(|a| self.column(a));
        let count = columns[0].len();
        let complete = count > 0 && columns.iter().all(|c| c.len() == count);
        complete.then(|| (0..count).map(|n| Vector(columns.map(|c| c[n]))).collect())
    }

    fn colours(&self, notes: &mut Notes<'_>) -> Option<Vec<[f64; 3]>> {
        let channels = [0, 1, 2].map(Attribute::Colour);
        let Some(values) = self.vectors(channels) else {
            if channels.iter().any(|c| !self.column(*c).is_empty()) {
                notes.warn("colours without all of red, green and blue are left out", "give all three");
            }
            return None;
        };
        let most = values.iter().flat_map(|v| v.0).fold(0.0, f64::max);
        let found = [1.0, 255.0].into_iter().find(|full| most <= *full).unwrap_or(65535.0);
        let full = match self.full {
            Some(full) if most <= full => full,
            _ => found,
        };
        Some(values.into_iter().map(|v| v.0.map(|c| c / full)).collect())
    }
}

/// What is to be told of the points.
struct Notes<'a> {
    name: &'a str,
    zero_normals: usize,
    warnings: Vec<Warning>,
}

impl Notes<'_> {
    fn warn(&mut self, message: &str, advice: &str) {
        self.warnings.push(Warning::new(format!("{}: {message}", self.name), advice));
    }

    /// Normals at length 1; those without a length stay zero and are told. Where none has a length there are no normals.
    fn units<const D: usize>(&mut self, normals: Vec<Vector<D>>) -> Option<Vec<Vector<D>>> {
        let zero: Vec<usize> = (0..normals.len()).filter(|&n| normals[n] == Vector::ZERO).collect();
        if zero.len() == normals.len() {
            self.warn("every normal is zero; they are left out", "compute normals where the points come from");
            return None;
        }
        if let Some(first) = zero.first() {
            let message = format!("{} normals are zero, the first at point {}", zero.len(), first + 1);
            self.warn(&message, "compute normals where the points come from, or remove these points");
        }
        self.zero_normals = zero.len();
        let stretched = normals.iter().filter(|n| **n != Vector::ZERO && (n.norm() - 1.0).abs() > ROUNDED).count();
        if stretched > 0 {
            let message = format!("{stretched} normals do not have length 1; they count by their directions");
            self.warn(&message, "write normals of length 1");
        }
        Some(normals.into_iter().map(unit).collect())
    }
}

/// A vector at length 1, however short or long it is; zero stays zero.
fn unit<const D: usize>(v: Vector<D>) -> Vector<D> {
    let largest = v.0.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    if largest == 0.0 { v } else { v.map(|c| c / largest).unit() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(columns: &[(Attribute, &[f64])], full: Option<f64>) -> Geometry {
        let mut all = Columns { full, ..Columns::default() };
        for (attribute, values) in columns {
            all.values[attribute.index()] = values.to_vec();
        }
        all.into_geometry("a.ply", &Budget::default()).unwrap()
    }

    const PLACES: [(Attribute, &[f64]); 2] =
        [(Attribute::Position(0), &[0.0, 1.0, 2.0]), (Attribute::Position(1), &[5.0, 5.0, 6.0])];

    fn plane(more: &[(Attribute, &[f64])], full: Option<f64>) -> (PointSet<2>, Vec<String>) {
        let geometry = read(&[PLACES.as_slice(), more].concat(), full);
        let Cloud::Plane(points) = geometry.points else { panic!("no z was given") };
        (points, geometry.warnings.into_iter().map(|w| w.message).collect())
    }

    #[test]
    fn a_column_z_makes_space() {
        let geometry = read(&[PLACES.as_slice(), &[(Attribute::Position(2), &[0.0; 3])]].concat(), None);
        assert!(matches!(&geometry.points, Cloud::Space(points) if points.len() == 3));
        let mut without_y = Columns::default();
        without_y.values[0] = vec![1.0];
        let message = without_y.into_geometry("a.ply", &Budget::default()).unwrap_err().to_string();
        assert!(message.contains("without a coordinate y"), "{message}");
    }

    #[test]
    fn normals_get_length_one_and_zeros_are_counted() {
        let columns = [(Attribute::Normal(0), &[2.0, 0.0, 1e-300][..]), (Attribute::Normal(1), &[0.0, 0.0, 0.0])];
        let (points, warnings) = plane(&columns, None);
        let along = Vector::xy(1.0, 0.0);
        assert_eq!(points.normals.unwrap(), [along, Vector::ZERO, along]);
        assert!(warnings[0].contains("1 normals are zero, the first at point 2"), "{warnings:?}");
        assert!(warnings[1].contains("2 normals do not have length 1"), "{warnings:?}");
    }

    #[test]
    fn normals_that_are_all_zero_or_incomplete_are_left_out() {
        let (points, warnings) = plane(&[(Attribute::Normal(0), &[0.0; 3]), (Attribute::Normal(1), &[0.0; 3])], None);
        assert!(points.normals.is_none() && warnings[0].contains("every normal is zero"), "{warnings:?}");
        let (points, warnings) = plane(&[(Attribute::Normal(0), &[1.0; 3])], None);
        assert!(points.normals.is_none() && warnings[0].contains("without all their coordinates"), "{warnings:?}");
    }

    #[test]
    fn colours_are_shares_of_what_stands_for_full() {
        let colours = |most: f64, full| {
            let values = [0.0, most, 0.0];
            let columns: Vec<_> = (0..3).map(|k| (Attribute::Colour(k), &values[..])).collect();
            plane(&columns, full).0.colours.unwrap()[1][0]
        };
        assert_eq!(colours(1.0, None), 1.0);
        assert_eq!(colours(51.0, None), 0.2);
        assert_eq!(colours(13_107.0, None), 0.2);
        assert_eq!(colours(1.0, Some(255.0)), 1.0 / 255.0);
        // Floats of 0 to 255, which some programs write.
        assert_eq!(colours(255.0, Some(1.0)), 1.0);
    }

    #[test]
    fn groups_and_elements_are_whole_numbers() {
        let (points, _) = plane(&[(Attribute::Group, &[1.0, 2.0, 2.0]), (Attribute::Element, &[-1.0, 0.0, 7.0])], None);
        assert_eq!((points.groups, points.elements), (Some(vec![1, 2, 2]), Some(vec![-1, 0, 7])));
    }
}
