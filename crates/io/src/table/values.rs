//! Tables of places in space with a value at each.

use arabesque_core::{Budget, Error, Result, Vector};

use crate::{table::records::records, text::short::short};

/// Coordinates and values are no larger than this.
const LARGEST: f64 = 1e12;

/// Reads `x,y,z,value` in any separator, with a header or without: the line, the place and the value of each record.
///
/// # Errors
/// [`Error::Input`] with the line for records of another length and for what is not a number, [`Error::Limit`] for too many lines.
pub fn read_values(name: &str, text: &str, budget: &Budget) -> Result<Vec<(usize, Vector<3>, f64)>> {
    let records = records(name, text, budget, usize::MAX)?;
    let mut found = Vec::with_capacity(records.len());
    for (n, (line, fields)) in records.iter().enumerate() {
        let place = || format!("{name}: line {line}");
        if n == 0 && fields.iter().all(|field| field.parse::<f64>().is_err()) {
            continue;
        }
        if fields.len() != 4 {
            let problem = format!("{} fields, expected four: x, y, z and value", fields.len());
            return Err(Error::input(place(), problem, "give a place and a value on each line"));
        }
        let mut numbers = [0.0; 4];
        for (number, field) in numbers.iter_mut().zip(fields) {
            let read = field.parse().ok().filter(|v: &f64| v.abs() <= LARGEST);
            *number = read.ok_or_else(|| {
                Error::input(place(), format!("{} is not a number", short(field)), "give x, y, z and value as numbers")
            })?;
        }
        let [x, y, z, value] = numbers;
        found.push((*line, Vector([x, y, z]), value));
    }
    if found.is_empty() {
        return Err(Error::input(name, "no line with a place and a value", "give x, y, z and value on each line"));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_may_stand_first_and_anything_else_is_told_with_its_line() {
        let read = |text: &str| read_values("f.csv", text, &Budget::default());
        let plain = read("0 0 0 1\n# far\n1 2 3 0.5\n").unwrap();
        assert_eq!(plain, [(1, Vector::ZERO, 1.0), (3, Vector([1.0, 2.0, 3.0]), 0.5)]);
        assert_eq!(read("x,y,z,scale\n1,2,3,0.5").unwrap().len(), 1);
        for (text, told) in [
            ("", "no line"),
            ("x,y,z,scale\n", "no line"),
            ("1,2,3", "3 fields"),
            ("0,0,0,1\n1,2,x,4", "line 2: x is not a number"),
            ("0,0,0,inf", "inf is not a number"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(told), "{text:?}: {error}");
        }
    }
}
