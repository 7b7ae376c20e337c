//! Fields over a part of space, from files.

use arabesque_core::{Bounds, Budget, Error, Grid, Matrix, OrientationField, Result, ScalarField, Vector};
use arabesque_io::table::values::read_values;

use crate::{method::RunContext, plane::constant_factor, recipe::FieldSource};

/// Nodes of a field along the longest side.
const NODES: f64 = 32.0;
/// Points along all strokes at most, and work for a point at a node.
const POINTS: usize = 2000;
const LOOK: u64 = 4;

/// Factors: a number, or places with values.
pub(super) fn scalar(
    name: &str,
    source: Option<&mut FieldSource>,
    bounds: &Bounds<3>,
    context: &mut RunContext<'_>,
) -> Result<ScalarField<3>> {
    let Some(FieldSource::File(field)) = source else { return constant_factor(name, source.as_deref()) };
    if field.range.is_some() {
        let advice = "leave the range out: the values of the table are the factors";
        return Err(Error::Unsupported { what: format!("{name} with a range, in space"), advice: advice.into() });
    }
    context.files.embed(&mut field.file)?;
    let text = context.files.text(&field.file)?;
    let values = read_values(field.file.name(), &text, context.budget())?;
    for (line, _, value) in &values {
        constant_factor::<3>(name, Some(&FieldSource::Constant(*value))).map_err(|_| {
            let place = format!("{}: line {line}", field.file.name());
            Error::input(place, format!("the {name} {value}"), "give factors between 0.001 and 1000")
        })?;
    }
    let budget = context.budget().stage("spreading a field");
    let mut grid = empty(bounds, 1.0);
    budget.spend(LOOK * (grid.values.len() * values.len()) as u64)?;
    for n in 0..grid.values.len() {
        let p = grid.node(n);
        let near = |at: Vector<3>| 1.0 / ((at - p).norm2().powi(2) + 1e-12 * bounds.size().norm2().powi(2));
        let (sum, weights) = values.iter().fold((0.0, 0.0), |(sum, weights), (_, at, value)| {
            let weight = near(*at);
            (sum + weight * value.ln(), weights + weight)
        });
        grid.values[n] = (sum / weights).exp();
    }
    Ok(ScalarField::Grid(grid))
}

/// Rotations that take x along strokes and keep what is up as much up as that allows; between strokes they blend.
pub(super) fn along_strokes(
    strokes: &[Vec<Vector<3>>],
    (bounds, up): (&Bounds<3>, Vector<3>),
    budget: &Budget,
) -> Result<OrientationField<3>> {
    let budget = budget.stage("spreading strokes");
    let ways: Vec<(Vector<3>, Vector<3>)> = strokes
        .iter()
        .flat_map(|line| line.windows(2))
        .filter_map(|w| Some(((w[0] + w[1]) * 0.5, (w[1] - w[0]).unit_if_longer(1e-12)?)))
        .collect();
    if ways.is_empty() {
        return Err(Error::input("orient", "no line of any length", "give lines of an OBJ file"));
    }
    let step = ways.len().div_ceil(POINTS);
    let ways: Vec<_> = ways.into_iter().step_by(step).collect();
    let mut grid = empty(bounds, Matrix::identity());
    budget.spend(LOOK * (grid.values.len() * ways.len()) as u64)?;
    for n in 0..grid.values.len() {
        let p = grid.node(n);
        let (mut sum, mut nearest) = (Vector::ZERO, (f64::INFINITY, ways[0].1));
        for (at, way) in &ways {
            let far = (*at - p).norm2();
            sum += *way * (1.0 / (far * far + 1e-12 * bounds.size().norm2().powi(2)));
            if far < nearest.0 {
                nearest = (far, *way);
            }
        }
        let x = sum.unit_if_longer(1e-300).unwrap_or(nearest.1);
        grid.values[n] = upright(x, up);
    }
    Ok(OrientationField::Grid(grid))
}

/// The rotation that takes x there and keeps up as much up as that allows.
fn upright(x: Vector<3>, up: Vector<3>) -> Matrix<3> {
    let level = |axis: Vector<3>| (axis - x * axis.dot(x)).unit_if_longer(1e-6);
    let fallback = Vector([up[1], up[2], up[0]]);
    let up_there = level(up).or_else(|| level(fallback)).unwrap_or(up);
    // Which of y and z is up says what is across.
    let columns = if up[1] > 0.5 { [x, up_there, x.cross(up_there)] } else { [x, up_there.cross(x), up_there] };
    Matrix(std::array::from_fn(|r| columns.map(|c| c[r])))
}

fn empty<T: Clone>(bounds: &Bounds<3>, value: T) -> Grid<3, T> {
    let size = bounds.size();
    let cell = size.0.into_iter().fold(0.0, f64::max) / NODES;
    let nodes = size.0.map(|side| (side / cell).ceil().max(1.0) as usize + 1);
    Grid { bounds: *bounds, nodes, values: vec![value; nodes.iter().product()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_turn_x_and_leave_y_up() {
        let stroke = vec![Vector([0.0, 0.0, 0.0]), Vector([0.0, 0.5, 4.0])];
        let bounds = Bounds::new(Vector::ZERO, Vector::splat(4.0));
        let field = along_strokes(&[stroke], (&bounds, Vector([0.0, 1.0, 0.0])), &Budget::default()).unwrap();
        let rotation = field.at(Vector::splat(1.3));
        let along = Vector([0.0, 0.5, 4.0]).unit_or_zero();
        assert!((rotation.apply(Vector([1.0, 0.0, 0.0])) - along).norm() < 1e-6);
        assert!(rotation.apply(Vector([0.0, 1.0, 0.0]))[1] > 0.98);
        let z_up = upright(along, Vector([0.0, 0.0, 1.0]));
        assert!(z_up.apply(Vector([0.0, 0.0, 1.0]))[2] > 0.0);
        assert!((Vector(z_up.0[0]).cross(Vector(z_up.0[1])).dot(Vector(z_up.0[2])) - 1.0).abs() < 1e-9);
    }
}
