//! XYZ: points as lines of three numbers, or of six with a normal or a colour.
//!
//! Three numbers behind a point are its normal where they have length 1 everywhere, and a colour where they are whole numbers from 0
//! to 255. A line above them that says how many there are is passed over, and so are comments behind `#` or `//`. A header
//! names other columns, as in CSV.

use arabesque_core::{Budget, Result};

use crate::{
    geometry::{Geometry, attributes::Attribute},
    table::points::{Found, Table},
};

/// How far from 1 the length of a normal may be in a file.
const ROUNDED: f64 = 0.05;

/// Reads points in space.
///
/// # Errors
/// As [`crate::table::points::read_table`].
pub fn read_xyz(name: &str, text: &str, budget: &Budget) -> Result<Geometry> {
    let made_up = |fields: usize| match fields {
        3 => Some(["x", "y", "z"].as_slice()),
        6 => Some(["x", "y", "z", "nx", "ny", "nz"].as_slice()),
        _ => None,
    };
    let expected = "three columns, or six with normals or colours, or a header that names them";
    let table = Table { name, budget, made_up: &made_up, expected };
    let mut found = table.read(&without_count(text))?;
    if holds_colours(&found) {
        for k in 0..3 {
            let [from, to] = [Attribute::Normal(k), Attribute::Colour(k)].map(Attribute::index);
            found.columns.values.swap(from, to);
        }
        found.columns.full = Some(255.0);
    }
    found.into_geometry(name, budget)
}

/// The text without a first line that is the number of the lines after it.
fn without_count(text: &str) -> std::borrow::Cow<'_, str> {
    let mut data = text.lines().filter(|line| !line.trim().is_empty());
    let count: Option<usize> = data.next().and_then(|line| line.trim().parse().ok());
    match count {
        Some(count) if count == data.count() => {
            let blank = text.find(|c: char| !c.is_whitespace()).unwrap_or(0);
            let end = text[blank..].find(['\n', '\r']).map_or(text.len(), |at| blank + at);
            // The number of each line after it stays what it is.
            format!("{}{}", &text[..blank], &text[end..]).into()
        }
        _ => text.into(),
    }
}

/// Whether what stands where normals would stand are colours.
fn holds_colours(found: &Found) -> bool {
    let [x, y, z] = [0, 1, 2].map(|k| &found.columns.values[Attribute::Normal(k).index()]);
    let mut rows = x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z]);
    let is_unit = |v: [f64; 3]| (v.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).abs() < ROUNDED;
    let is_colour = |v: [f64; 3]| v.iter().all(|c| (0.0..=255.0).contains(c) && c.fract() == 0.0);
    !x.is_empty() && !rows.clone().all(is_unit) && rows.all(is_colour)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{PointSet, Vector};

    use super::*;
    use crate::geometry::Cloud;

    fn read(text: &str) -> PointSet<3> {
        match read_xyz("a.xyz", text, &Budget::default()).unwrap().points {
            Cloud::Space(points) => points,
            Cloud::Plane(_) => panic!("there is a z"),
        }
    }

    #[test]
    fn three_columns_are_places() {
        let points = read("// exported\n 1 2  3\n\n4\t5 6\r\n");
        assert_eq!(points, PointSet::at(vec![Vector([1.0, 2.0, 3.0]), Vector([4.0, 5.0, 6.0])]));
    }

    #[test]
    fn three_more_are_a_normal_or_a_colour() {
        let with_normals = read("0 0 0 0 0 1\n1 0 0 0.6 0 -0.8\n");
        assert_eq!(with_normals.normals.map(|n| n[0]), Some(Vector([0.0, 0.0, 1.0])));
        let with_colours = read("0 0 0 0 0 1\n1 0 0 255 51 0\n");
        assert!(with_colours.normals.is_none());
        assert_eq!(with_colours.colours.map(|c| c[1]), Some([1.0, 0.2, 0.0]));
        // Directions of any length are normals.
        assert!(read("0 0 0 0 0 2\n1 0 0 -1 0.5 0\n").normals.is_some());
    }

    #[test]
    fn a_count_above_is_passed_over() {
        assert_eq!(read("2\n0 0 1\n0 0 2\n").len(), 2);
        let message = read_xyz("a.xyz", "3\n0 0 1\n0 0 2\n", &Budget::default()).unwrap_err().to_string();
        assert!(message.contains("line 1: 1 columns without a header, expected three columns"), "{message}");
        let message = read_xyz("a.xyz", "2\n0 0 1\n0 0 x\n", &Budget::default()).unwrap_err().to_string();
        assert!(message.contains("line 3, column z"), "{message}");
    }

    #[test]
    fn a_header_names_other_columns() {
        let points = read("X Y Z Radius\n0 0 0 2\n");
        assert_eq!(points.radii, Some(vec![2.0]));
    }
}
