//! What is around the pattern: areas that stay free, and things that stay where they are.

use arabesque_core::{Domain, Error, Exemplar, Outline, Result, Shape, Warning};
use arabesque_io::svg::{self, Drawing, Placed};

use crate::{
    plane::place::{Units, options, read_shape},
    recipe::{Input, pixels_per_user},
    resources::Files,
};

/// The areas to keep free: those given, which are embedded, else the layer Avoid of the exemplar.
pub(crate) fn avoided(
    inputs: &mut [Input],
    drawing: &Drawing,
    units: Units,
    domain: &Domain<2>,
    files: &Files,
) -> Result<Vec<Outline<2>>> {
    let mut outlines = Vec::new();
    for input in inputs.iter_mut() {
        files.embed(input)?;
        outlines.push(read_shape(input, drawing, units, files)?.0);
    }
    if inputs.is_empty() {
        outlines.extend(drawing.job.avoid.clone());
    }
    let page = Shape::rectangle(domain.bounds());
    let budget = files.budget().stage("taking out what is avoided");
    let left = outlines.iter().try_fold(page, |left, shape| match left {
        Some(left) => left.without(shape, &budget),
        None => Ok(None),
    })?;
    if !outlines.is_empty() && left.is_none() {
        let advice = "make the avoided shapes smaller, or the domain larger";
        return Err(Error::no_result("the avoided shapes cover the whole domain", advice));
    }
    Ok(outlines.into_iter().map(|shape| shape.outline().clone()).collect())
}

/// What stays where it is in a file, which is embedded.
pub(crate) fn kept(input: &mut Input, drawing: &Drawing, units: Units, files: &Files) -> Result<Placed> {
    if units == Units::None {
        return Err(Error::Unsupported {
            what: "keeping elements beside an exemplar of points".into(),
            advice: "give an SVG exemplar".into(),
        });
    }
    files.embed(input)?;
    let mut placed = svg::read_placed(&files.text(input)?, drawing, &options(input, files))?;
    let factor = pixels_per_user(&placed.page) / pixels_per_user(&drawing.page);
    if (factor - 1.0).abs() > 1e-6 {
        placed.warnings.push(Warning::new(
            format!("{}: one unit of it is {factor:.4} units of the exemplar, and is taken for one", input.name()),
            "draw what is kept in the units of the exemplar",
        ));
    }
    Ok(placed)
}

/// Warns when nothing of what is to be kept comes near the domain.
pub(crate) fn kept_elsewhere(
    kept: &Placed,
    input: &Input,
    exemplar: &Exemplar<2>,
    domain: &Domain<2>,
) -> Option<Warning> {
    let corners = |outline: &Outline<2>| outline.rings.concat();
    let placed = kept.placements.iter().flat_map(|placement| {
        let element = &exemplar.elements[placement.source];
        let own = corners(&element.outline).into_iter().chain([element.centre]);
        own.map(|p| placement.transform.apply(p)).collect::<Vec<_>>()
    });
    let curves = kept.curves.iter().flat_map(|drawn| drawn.path.cubics.iter().flatten().copied());
    let others = kept.obstacles.iter().flat_map(corners);
    let reaches = curves.chain(placed).chain(others).any(|p| domain.contains(p));
    (!reaches).then(|| {
        Warning::new(
            format!("{}: nothing of what is to be kept lies in the domain", input.name()),
            "draw it where the pattern goes, in the coordinates of the result",
        )
    })
}
