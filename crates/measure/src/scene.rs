//! What is measured: elements, strokes and areas of an exemplar or of a result, in the part of the plane or of space that they fill.

use arabesque_core::{
    Bounds, Budget, Domain, Exemplar, Measured, Outline, Path, Result, Role, Vector, net_line_spacing,
};

/// Chords of strokes stay within this share of the spacing.
const TOLERANCE: f64 = 0.01;
/// Corners of outlines may be off by this share of the spacing.
const SIMPLER: f64 = 0.004;
/// What stands for a distance where there are areas alone, as a share of the side of the frame.
const AREAS: f64 = 0.02;
/// Work for each point of a stroke or an outline.
const POINT: u64 = 40;

/// An element, ready to be measured.
#[derive(Clone, Debug)]
pub(crate) struct Body<const D: usize> {
    pub(crate) class: usize,
    pub(crate) centre: Vector<D>,
    /// Its ink, with as few corners as will do; none for a point.
    pub(crate) outline: Outline<D>,
    pub(crate) bounds: Bounds<D>,
    pub(crate) radius: f64,
    /// Whether it is seen as a whole.
    pub(crate) is_whole: bool,
}

/// A stroke, as the points along it.
#[derive(Clone, Debug)]
pub(crate) struct Line<const D: usize> {
    pub(crate) points: Vec<Vector<D>>,
    /// Points at which the stroke itself has a node, by number: what lies between is smooth.
    pub(crate) nodes: Vec<usize>,
    pub(crate) is_closed: bool,
    pub(crate) width: f64,
}

/// Everything that is measured, with where it lies.
#[derive(Clone, Debug)]
pub(crate) struct Scene<'a, const D: usize> {
    pub(crate) content: &'a Exemplar<D>,
    pub(crate) domain: Domain<D>,
    pub(crate) bodies: Vec<Body<D>>,
    pub(crate) lines: Vec<Line<D>>,
    classes: usize,
    /// Mean distance of elements or lines: that of the exemplar in both scenes.
    pub(crate) spacing: f64,
    /// What lies nearer to the border than this is seen in part only.
    pub(crate) margin: f64,
}

/// Mean distance of elements, or of the lines of a net, whichever is smaller.
pub(crate) fn spacing<const D: usize>(exemplar: &Exemplar<D>) -> f64 {
    let of_elements = exemplar.spacing();
    if exemplar.elements.is_empty() && exemplar.curves.is_empty() {
        return AREAS * exemplar.view().side();
    }
    if exemplar.curves.is_empty() {
        return of_elements;
    }
    let tolerance = 1e-3 * exemplar.window.size().norm();
    let mut length = 0.0;
    for curve in &exemplar.curves {
        let points = Measured::new(curve.path.clone(), tolerance).points().to_vec();
        let inside = |w: &&[Vector<D>]| exemplar.window.contains((w[0] + w[1]) * 0.5);
        length += points.windows(2).filter(inside).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    }
    let of_lines = net_line_spacing::<D>(exemplar.window.measure(), length).min(exemplar.window.size().norm());
    if exemplar.elements.is_empty() { of_lines } else { of_elements.min(of_lines) }
}

/// How wide the margin is in which things are seen in part only, in spacings, and at most as a share of the shorter side.
const MARGIN: (f64, f64) = (1.25, 0.15);

impl<'a, const D: usize> Scene<'a, D> {
    /// What `content` shows in `domain`, with lengths to be told in `spacing`.
    pub(crate) fn new(content: &'a Exemplar<D>, domain: Domain<D>, spacing: f64, budget: &Budget) -> Result<Self> {
        let mut meter = budget.meter();
        let mut bodies = Vec::with_capacity(content.elements.len());
        for element in &content.elements {
            meter.spend(POINT * (1 + element.outline.points().count() as u64))?;
            let outline = simplified(&element.outline, SIMPLER * spacing);
            let bounds = outline.bounds().joined(element.centre);
            bodies.push(Body {
                class: element.class,
                centre: element.centre,
                radius: outline.radius(element.centre),
                outline,
                bounds,
                is_whole: element.role == Role::Source,
            });
        }
        let mut lines = Vec::with_capacity(content.curves.len());
        for curve in &content.curves {
            let line = Line::new(&curve.path, TOLERANCE * spacing, curve.width);
            meter.spend(POINT * line.points.len() as u64)?;
            lines.push(line);
        }
        let side = domain.bounds().size().0.into_iter().fold(f64::INFINITY, f64::min);
        let margin = if domain.period().is_some() { 0.0 } else { (MARGIN.0 * spacing).min(MARGIN.1 * side) };
        Ok(Self { content, domain, bodies, lines, classes: content.classes.len(), spacing, margin })
    }

    /// Whether everything around a place is seen.
    pub(crate) fn is_inner(&self, p: Vector<D>) -> bool {
        self.domain.signed_distance(p) >= self.margin
    }

    /// The parts of which the natural range is told: halves, overlapping halves and quarters (in space octants), with their shares.
    pub(crate) fn parts(&self) -> Vec<(Bounds<D>, f64)> {
        let all = self.domain.bounds();
        let size = all.size();
        let mut parts = Vec::new();
        for axis in 0..D {
            for start in [0.0, 0.25, 0.5] {
                let mut part = all;
                part.min[axis] = all.min[axis] + start * size[axis];
                part.max[axis] = part.min[axis] + 0.5 * size[axis];
                parts.push((part, 0.5));
            }
        }
        let share = 0.5_f64.powi(D as i32);
        for corner in 0..1_usize << D {
            let mut part = all;
            for axis in 0..D {
                part.min[axis] += if corner >> axis & 1 == 1 { 0.5 * size[axis] } else { 0.0 };
                part.max[axis] = part.min[axis] + 0.5 * size[axis];
            }
            parts.push((part, share));
        }
        parts
    }

    /// The classes of the exemplar: what is of none of them has their number as its class.
    pub(crate) fn classes(&self) -> usize {
        self.classes
    }

    /// The same with other classes for its elements, `classes` of them.
    pub(crate) fn with_classes(mut self, of: impl Iterator<Item = Option<usize>>, classes: usize) -> Self {
        self.bodies.iter_mut().zip(of).for_each(|(body, class)| body.class = class.unwrap_or(classes));
        Self { classes, ..self }
    }
}

impl<const D: usize> Line<D> {
    fn new(path: &Path<D>, tolerance: f64, width: f64) -> Self {
        let (mut points, mut nodes) = (Vec::new(), Vec::new());
        for (k, cubic) in path.cubics.iter().enumerate() {
            let piece = Path { cubics: vec![*cubic], closed: false }.flatten(tolerance);
            points.extend(piece.into_iter().skip(usize::from(k > 0)));
            nodes.push(points.len() - 1);
        }
        Self { points, nodes, is_closed: path.closed, width }
    }
}

/// The same outline as one of the plane; `None` in space.
pub(crate) fn flat<const D: usize>(outline: &Outline<D>) -> Option<Outline<2>> {
    let rings = outline.rings.iter().map(|ring| ring.iter().map(|p| Vector::xy(p[0], p[1])).collect());
    (D == 2).then(|| Outline { rings: rings.collect() })
}

/// The outline with corners left out that lie within `tolerance` of the chord between those that stay.
pub(crate) fn simplified<const D: usize>(outline: &Outline<D>, tolerance: f64) -> Outline<D> {
    let rings = outline.rings.iter().map(|ring| {
        let mut kept: Vec<Vector<D>> = Vec::with_capacity(ring.len());
        let mut from = 0;
        for k in 0..ring.len() {
            let next = ring[(k + 1) % ring.len()];
            let skipped = &ring[(from + 1).min(k)..=k];
            // A long row of corners is kept in part, so that the look back stays short.
            let is_near = skipped.len() <= 16
                && kept.last().is_some_and(|&last| {
                    skipped.iter().all(|&p| arabesque_core::segment::distance((last, next), p) <= tolerance)
                });
            if !is_near {
                kept.push(ring[k]);
                from = k;
            }
        }
        if kept.len() < 3 { ring.clone() } else { kept }
    });
    Outline { rings: rings.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_keeps_its_area_with_fewer_corners() {
        let corner = |k: u32| {
            let turn = f64::from(k) / 200.0 * std::f64::consts::TAU;
            Vector::xy(turn.cos(), turn.sin()) * 10.0
        };
        let circle = Outline { rings: vec![(0..200).map(corner).collect()] };
        let less = simplified(&circle, 0.05);
        assert!(less.rings[0].len() < 80, "{}", less.rings[0].len());
        assert!((less.area() / circle.area() - 1.0).abs() < 0.01);
    }

    #[test]
    fn the_spacing_of_a_grid_is_its_step() {
        let points: Vec<_> = (0..100).map(|k| Vector::xy(f64::from(k % 10) * 3.0, f64::from(k / 10) * 3.0)).collect();
        let mut exemplar = Exemplar::from_points("t", &points, &[0; 100], &["a".into()]).unwrap();
        exemplar.window = Bounds::new(Vector::splat(-1.5), Vector::splat(28.5));
        assert!((spacing(&exemplar) - 3.0).abs() < 1e-9);
        let scene = Scene::new(&exemplar, Domain::Box(exemplar.window), 3.0, &Budget::default()).unwrap();
        assert_eq!((scene.parts().len(), scene.bodies.len(), scene.classes()), (10, 100, 1));
        assert!(scene.is_inner(Vector::xy(13.0, 13.0)) && !scene.is_inner(Vector::xy(1.0, 13.0)));
    }
}
