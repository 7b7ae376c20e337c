//! Patterns of all seventeen wallpaper groups: an asymmetric motif in a general position, and the operations of the
//! International Tables.

use arabesque_core::Vector;

use crate::drawing::{Motif, Pattern, Piece, xy};

/// An operation in terms of the vectors of the cell: a linear part, row by row, and a shift.
type Operation = ([[f64; 2]; 2], [f64; 2]);

const ONE: Operation = ([[1.0, 0.0], [0.0, 1.0]], [0.0, 0.0]);
const HALF_TURN: Operation = ([[-1.0, 0.0], [0.0, -1.0]], [0.0, 0.0]);

fn flip_x(shift: [f64; 2]) -> Operation {
    ([[-1.0, 0.0], [0.0, 1.0]], shift)
}

fn flip_y(shift: [f64; 2]) -> Operation {
    ([[1.0, 0.0], [0.0, -1.0]], shift)
}

fn centred(operations: &[Operation]) -> Vec<Operation> {
    let moved = operations.iter().map(|(m, s)| (*m, [s[0] + 0.5, s[1] + 0.5]));
    operations.iter().copied().chain(moved).collect()
}

fn linear(rows: &[[[f64; 2]; 2]], shift: [f64; 2]) -> Vec<Operation> {
    rows.iter().map(|m| (*m, shift)).collect()
}

const THIRDS: [[[f64; 2]; 2]; 3] = [[[1.0, 0.0], [0.0, 1.0]], [[0.0, -1.0], [1.0, -1.0]], [[-1.0, 1.0], [-1.0, 0.0]]];
const OPPOSITE: [[[f64; 2]; 2]; 3] = [[[-1.0, 0.0], [0.0, -1.0]], [[0.0, 1.0], [-1.0, 1.0]], [[1.0, -1.0], [1.0, 0.0]]];
const M1: [[[f64; 2]; 2]; 3] = [[[0.0, -1.0], [-1.0, 0.0]], [[-1.0, 1.0], [0.0, 1.0]], [[1.0, 0.0], [1.0, -1.0]]];
const ONE_M: [[[f64; 2]; 2]; 3] = [[[0.0, 1.0], [1.0, 0.0]], [[1.0, -1.0], [0.0, -1.0]], [[-1.0, 0.0], [-1.0, 1.0]]];
const QUARTERS: [[[f64; 2]; 2]; 4] =
    [[[1.0, 0.0], [0.0, 1.0]], [[-1.0, 0.0], [0.0, -1.0]], [[0.0, -1.0], [1.0, 0.0]], [[0.0, 1.0], [-1.0, 0.0]]];
const FLIPS: [[[f64; 2]; 2]; 4] =
    [[[-1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, -1.0]], [[0.0, 1.0], [1.0, 0.0]], [[0.0, -1.0], [-1.0, 0.0]]];

/// The names of all groups.
pub(crate) const NAMES: [&str; 17] =
    ["p1", "p2", "pm", "pg", "cm", "pmm", "pmg", "pgg", "cmm", "p4", "p4m", "p4g", "p3", "p3m1", "p31m", "p6", "p6m"];

fn operations(name: &str) -> Vec<Operation> {
    let none = [0.0, 0.0];
    let half = [0.5, 0.5];
    match name {
        "p1" => vec![ONE],
        "p2" => vec![ONE, HALF_TURN],
        "pm" => vec![ONE, flip_x(none)],
        "pg" => vec![ONE, flip_x([0.0, 0.5])],
        "cm" => centred(&[ONE, flip_x(none)]),
        "pmm" => vec![ONE, HALF_TURN, flip_x(none), flip_y(none)],
        "pmg" => vec![ONE, HALF_TURN, flip_x([0.5, 0.0]), flip_y([0.5, 0.0])],
        "pgg" => vec![ONE, HALF_TURN, flip_x(half), flip_y(half)],
        "cmm" => centred(&[ONE, HALF_TURN, flip_x(none), flip_y(none)]),
        "p4" => linear(&QUARTERS, none),
        "p4m" => [linear(&QUARTERS, none), linear(&FLIPS, none)].concat(),
        "p4g" => [linear(&QUARTERS, none), linear(&FLIPS, half)].concat(),
        "p3" => linear(&THIRDS, none),
        "p3m1" => [linear(&THIRDS, none), linear(&M1, none)].concat(),
        "p31m" => [linear(&THIRDS, none), linear(&ONE_M, none)].concat(),
        "p6" => [linear(&THIRDS, none), linear(&OPPOSITE, none)].concat(),
        _ => [&THIRDS, &OPPOSITE, &M1, &ONE_M].map(|rows| linear(rows, none)).concat(),
    }
}

/// The cell of a group, where its motif lies in terms of the vectors, and how large it may be.
fn cell(name: &str) -> ([Vector<2>; 2], [f64; 2], f64) {
    match name {
        "p1" | "p2" => ([xy(1.0, 0.1), xy(0.3, 0.8)], [0.24, 0.19], 0.12),
        "cm" | "cmm" => ([xy(1.0, 0.0), xy(0.0, 1.3)], [0.13, 0.12], 0.09),
        "pm" | "pg" | "pmm" | "pmg" | "pgg" => ([xy(1.0, 0.0), xy(0.0, 1.3)], [0.12, 0.14], 0.09),
        "p4" | "p4m" => ([xy(1.0, 0.0), xy(0.0, 1.0)], [0.36, 0.14], 0.1),
        "p4g" => ([xy(1.0, 0.0), xy(0.0, 1.0)], [0.16, 0.12], 0.09),
        _ => ([xy(1.0, 0.0), xy(-0.5, 0.75_f64.sqrt())], [0.389, 0.111], 0.075),
    }
}

/// A flag, which no turn and no reflection takes to itself.
const FLAG: [[f64; 2]; 6] = [[-0.35, -0.95], [-0.1, -0.95], [-0.1, 0.05], [0.9, 0.45], [0.05, 0.6], [-0.35, 0.95]];
/// A hook.
const HOOK: [[f64; 2]; 4] = [[-0.5, -0.8], [-0.3, 0.7], [0.6, 0.6], [0.75, 0.1]];

fn images(name: &str, shape: &[[f64; 2]]) -> ([Vector<2>; 2], Vec<Vec<Vector<2>>>) {
    let (vectors, place, size) = cell(name);
    let [a, b] = vectors;
    let at = |p: [f64; 2]| a * p[0] + b * p[1];
    let measure = a.cross(b);
    let coordinates = |v: Vector<2>| [v.cross(b) / measure, a.cross(v) / measure];
    let image = |(m, shift): Operation| -> Vec<Vector<2>> {
        let one = |q: &[f64; 2]| {
            let c = coordinates(at(place) + xy(q[0], q[1]) * size);
            at([0, 1].map(|k| m[k][0] * c[0] + m[k][1] * c[1] + shift[k]))
        };
        shape.iter().map(one).collect()
    };
    (vectors, operations(name).into_iter().map(image).collect())
}

/// A pattern of this group whose motif is an element.
pub(crate) fn of_elements(name: &str) -> Pattern {
    let (vectors, rings) = images(name, &FLAG);
    Pattern::of_motifs(vectors, rings.into_iter().map(|ring| Motif { ring, class: 0 }).collect())
}

/// A pattern of this group whose motif is a stroke.
pub(crate) fn of_strokes(name: &str) -> Pattern {
    let (vectors, lines) = images(name, &HOOK);
    Pattern::of_pieces(vectors, lines.into_iter().map(|points| Piece { points, style: 0 }).collect())
}

/// A pattern of this group with a stroke in every element.
pub(crate) fn of_both(name: &str) -> Pattern {
    Pattern { pieces: of_strokes(name).pieces, ..of_elements(name) }
}
