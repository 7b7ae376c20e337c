//! STL as bytes: 80 of any content, the number of triangles, and 50 for each of them.

use arabesque_core::{Budget, Error, Result, Vector, Warning};

use super::weld::Welded;
use crate::geometry::{Geometry, attributes::Attribute};

/// Bytes above the triangles, and of each of them.
pub(super) const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// The number of triangles that the header says, and how many there is room for; `None` for less than a header.
pub(super) fn counts(bytes: &[u8]) -> Option<(usize, usize)> {
    let count = bytes.get(80..HEADER)?.try_into().ok().map(u32::from_le_bytes)?;
    Some((count as usize, (bytes.len() - HEADER) / TRIANGLE))
}

/// Whether the length of the file is what its header says, to the byte: no text is so long.
pub(super) fn is_exact(bytes: &[u8]) -> bool {
    counts(bytes).is_some_and(|(count, room)| count == room && bytes.len() == HEADER + TRIANGLE * count)
}

pub(super) fn read(name: &str, bytes: &[u8], budget: &Budget) -> Result<Geometry> {
    let (count, room) = counts(bytes).unwrap_or((0, 0));
    if count > room {
        let problem = format!("{count} triangles where there is room for {room} at most");
        return Err(Error::input(name, problem, "give an STL file; it may have been cut off"));
    }
    budget.within(&format!("{name}: triangles"), count, ("nodes", budget.limits().nodes))?;
    let mut welded = Welded::new(budget);
    let mut coloured = 0;
    for (number, facet) in bytes[HEADER..].chunks_exact(TRIANGLE).take(count).enumerate() {
        let [normal, corners @ ..]: [Vector<3>; 4] =
            std::array::from_fn(|k| Vector(std::array::from_fn(|axis| float(facet, 3 * k + axis))));
        let coordinate = Attribute::Position(0);
        for value in corners.iter().flat_map(|corner| corner.0) {
            coordinate.checked(value, || value.to_string(), budget.limits()).map_err(|(problem, _)| {
                let place = format!("{name}: triangle {number}, counted from 0");
                Error::input(place, problem, "write the file again; it is damaged, or not STL")
            })?;
        }
        coloured += usize::from(facet[48..] != [0, 0]);
        welded.push(number, normal, corners)?;
    }
    let mut warnings = Vec::new();
    if coloured > 0 {
        let message = format!("{name}: what else is said of {coloured} triangles, such as colours, is passed over");
        warnings.push(Warning::new(message, "save it as PLY or OBJ if the colours matter"));
    }
    if bytes.len() > HEADER + TRIANGLE * count {
        let message = format!("{name}: bytes behind the last triangle are passed over");
        warnings.push(Warning::new(message, "correct the count of triangles"));
    }
    welded.finish((name, "triangle"), warnings)
}

fn float(facet: &[u8], at: usize) -> f64 {
    let mut word = [0; 4];
    word.copy_from_slice(&facet[4 * at..4 * at + 4]);
    f64::from(f32::from_le_bytes(word))
}
