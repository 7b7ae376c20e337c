//! What is told of strokes: loose ends, junctions, kinks, length, width, bends, directions.

use arabesque_core::{Bounds, Vector};

use super::graph::{Graph, Piece};
use crate::{
    natural::{Natural, Rule, Side},
    report::{Fault, Mark, Measure},
    scene::Scene,
    verdict::Family,
};

/// Borders of the classes of curvature: turn for each spacing, in radians.
const BENDS: [f64; 6] = [0.05, 0.2, 0.5, 1.0, 2.0, 5.0];
/// Classes of direction within half a turn.
const DIRECTIONS: usize = 12;
/// Loose ends that are marked.
const MARKS: usize = 8;
/// Junctions for each square spacing below which they tell nothing.
const FEW_NODES: f64 = 0.08;
/// What is nearer to the border than this belongs to it, in spacings.
const EDGE: f64 = 0.2;

/// Figures of the strokes in a part.
#[derive(Clone, Debug, Default)]
struct Figures {
    length: f64,
    ends: f64,
    /// Junctions with three, four, and more strokes.
    junctions: [f64; 3],
    kinks: f64,
    bends: [f64; BENDS.len() + 1],
    directions: [f64; DIRECTIONS],
    width: f64,
    measure: f64,
}

/// The strokes of a scene.
pub(crate) struct Strokes<'a, const D: usize> {
    pub(crate) scene: &'a Scene<'a, D>,
    pub(crate) graph: &'a Graph<D>,
}

impl<const D: usize> Strokes<'_, D> {
    fn edge(&self) -> f64 {
        let widest = self.scene.lines.iter().map(|l| l.width).fold(0.0, f64::max);
        (EDGE * self.scene.spacing).max(widest).min(self.scene.margin)
    }

    fn figures(&self, part: Option<&Bounds<D>>) -> Figures {
        let edge = self.edge();
        let is_in =
            |p: Vector<D>| part.is_none_or(|part| part.contains(p)) && self.scene.domain.signed_distance(p) >= edge;
        let mut figures = Figures::default();
        for piece in self.graph.pieces.iter().filter(|piece| is_in(piece.middle())) {
            figures.add(piece, self.scene);
        }
        for (_, bend) in self.graph.bends.iter().filter(|(p, _)| is_in(*p)) {
            figures.bends[BENDS.iter().position(|b| bend < b).unwrap_or(BENDS.len())] += 1.0;
        }
        for node in self.graph.nodes.iter().filter(|node| is_in(node.at)) {
            match node.degree {
                1 => figures.ends += 1.0,
                3 => figures.junctions[0] += 1.0,
                4 => figures.junctions[1] += 1.0,
                _ => figures.junctions[2] += 1.0,
            }
        }
        figures.kinks = self.graph.kinks.iter().filter(|p| is_in(**p)).count() as f64;
        figures.measure = part.map_or(self.scene.domain.measure(), Bounds::measure);
        figures
    }
}

impl Figures {
    fn add<const D: usize>(&mut self, piece: &Piece<D>, scene: &Scene<'_, D>) {
        let length = piece.length();
        self.length += length;
        self.width += length * scene.lines[piece.line].width;
        if D == 2 {
            let way = piece.ends.1 - piece.ends.0;
            let turn = way[1].atan2(way[0]).rem_euclid(std::f64::consts::PI) / std::f64::consts::PI;
            // Shared between the two nearest classes, so that a line on a border does not jump.
            let at = turn * DIRECTIONS as f64;
            let (low, share) = (at.floor() as usize, at.fract());
            self.directions[low % DIRECTIONS] += length * (1.0 - share);
            self.directions[(low + 1) % DIRECTIONS] += length * share;
        }
    }

    /// Loose ends and kinks for a hundred spacings of length.
    fn for_length(&self, count: f64, spacing: f64) -> f64 {
        100.0 * count * spacing / self.length.max(1e-12)
    }

    /// Share of the junctions that have so many strokes.
    fn share(&self, class: usize) -> f64 {
        self.junctions[class] / self.junctions.iter().sum::<f64>().max(1.0)
    }

    fn mean_width(&self) -> f64 {
        self.width / self.length.max(1e-12)
    }
}

/// Half of the summed differences of two distributions: 0 the same, 1 nothing in common.
fn apart<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let sum = |v: &[f64; N]| v.iter().sum::<f64>().max(1e-12);
    (0..N).map(|k| (a[k] / sum(a) - b[k] / sum(b)).abs()).sum::<f64>() * 0.5
}

/// One figure with its rule.
type Told<'a> = (Rule, Box<dyn Fn(&Figures) -> f64 + 'a>);

fn told<'a, const D: usize>(own: &'a Figures, spacing: f64, are_turns_judged: bool) -> Vec<Told<'a>> {
    let rule =
        |name, unit, means, side, (least, most)| Rule { name, family: Family::Strokes, unit, means, side, least, most };
    let (ends, kinks) = (own.for_length(own.ends, spacing), own.for_length(own.kinks, spacing));
    let length = move |f: &Figures| f.length * spacing.powi(D as i32 - 1) / f.measure.max(1e-12);
    let own_length = length(own);
    let mut all: Vec<Told<'a>> = vec![
        (
            rule(
                "loose ends",
                "per 100 spacings",
                "Ends of strokes that meet nothing, for their length; more means broken lines.",
                Side::Both,
                (1.0 + 0.15 * ends, 2.0 + 0.4 * ends),
            ),
            Box::new(move |f| f.for_length(f.ends, spacing)),
        ),
        (
            rule(
                "kinks",
                "per 100 spacings",
                "Sharp corners of strokes away from junctions, for their length.",
                Side::Above,
                (1.5 + 0.15 * kinks, 3.0 + 0.4 * kinks),
            ),
            Box::new(move |f| f.for_length(f.kinks, spacing)),
        ),
        (
            rule(
                "length of strokes",
                "per square spacing",
                "Length of strokes for each unit of area; less means gaps.",
                Side::Both,
                (0.05 * own_length, 0.25 * own_length),
            ),
            Box::new(length),
        ),
        (
            rule(
                "width of strokes",
                "spacings",
                "Mean width of strokes.",
                Side::Both,
                (0.05 * own.mean_width() / spacing + 1e-3, 0.4 * own.mean_width() / spacing + 2e-3),
            ),
            Box::new(move |f| f.mean_width() / spacing),
        ),
        (
            rule(
                "bends of strokes",
                "share",
                "Share of the length that bends more or less than strokes of the exemplar do.",
                Side::Above,
                (0.05, 0.2),
            ),
            Box::new(|f| apart(&f.bends, &own.bends)),
        ),
    ];
    if D == 2 && are_turns_judged {
        all.push((
            rule(
                "directions of strokes",
                "share",
                "Share of the length that runs another way than strokes of the exemplar do.",
                Side::Above,
                (0.05, 0.3),
            ),
            Box::new(|f| apart(&f.directions, &own.directions)),
        ));
    }
    all.extend(junctions::<D>(own, spacing));
    all
}

/// What is told of places where strokes meet.
fn junctions<'a, const D: usize>(own: &'a Figures, spacing: f64) -> Vec<Told<'a>> {
    let rule = |name, unit, means, (least, most)| Rule {
        name,
        family: Family::Strokes,
        unit,
        means,
        side: Side::Both,
        least,
        most,
    };
    let nodes = move |f: &Figures| f.junctions.iter().sum::<f64>() * spacing.powi(D as i32) / f.measure.max(1e-12);
    let own_nodes = nodes(own);
    let mut all: Vec<Told<'a>> = Vec::new();
    // Where strokes hardly ever meet, that they touch here or there is chance.
    let met = own.junctions.iter().sum::<f64>();
    let are_few = met < 6.0 || own_nodes < FEW_NODES;
    let chance = if are_few { FEW_NODES } else { 0.0 };
    all.push((
        rule(
            "junctions",
            "per square spacing",
            "Places where strokes meet, for each unit of area; more where they should not means that they cross.",
            (0.07 * own_nodes + chance, 0.3 * own_nodes + chance),
        ),
        Box::new(nodes),
    ));
    if !are_few {
        let names = ["junctions of three", "junctions of four", "junctions of more"];
        let means = [
            "Share of the junctions where three strokes meet.",
            "Share of the junctions where four strokes meet or two cross.",
            "Share of the junctions where five strokes or more meet.",
        ];
        for class in 0..3 {
            let share = own.share(class).clamp(0.05, 0.95);
            let chance = 2.5 * (share * (1.0 - share) / met).sqrt();
            all.push((
                rule(names[class], "share of junctions", means[class], (chance.max(0.05), 0.25)),
                Box::new(move |f| f.share(class)),
            ));
        }
    }
    all
}

/// Compares strokes.
pub(crate) fn strokes<const D: usize>(
    exemplar: &Strokes<'_, D>,
    result: &Strokes<'_, D>,
    are_turns_judged: bool,
) -> (Vec<Measure>, Vec<Mark>) {
    let (own, found) = (exemplar.figures(None), result.figures(None));
    let spacing = exemplar.scene.spacing;
    if own.length < 4.0 * spacing {
        return (Vec::new(), Vec::new());
    }
    let parts: Vec<(Figures, f64)> =
        exemplar.scene.parts().into_iter().map(|(part, share)| (exemplar.figures(Some(&part)), share)).collect();
    let times = result.scene.domain.measure() / exemplar.scene.domain.measure();
    let told = told::<D>(&own, spacing, are_turns_judged);
    let measures = told.iter().map(|(rule, of)| {
        let natural =
            Natural { whole: of(&own), parts: parts.iter().map(|(f, share)| (of(f), *share)).collect(), times };
        rule.judge(&natural, of(&found))
    });
    let measures: Vec<Measure> = measures.collect();
    // Ends are marked where the exemplar has next to none.
    let is_closed = own.for_length(own.ends, spacing) < 1.0 && measures[0].fault > 0.2;
    (measures, if is_closed { loose_ends(result) } else { Vec::new() })
}

fn loose_ends<const D: usize>(result: &Strokes<'_, D>) -> Vec<Mark> {
    let edge = result.edge();
    let loose =
        result.graph.nodes.iter().filter(|n| n.degree == 1 && result.scene.domain.signed_distance(n.at) >= edge);
    let mark = |node: &super::Node<D>| Mark {
        fault: Fault::LooseEnd,
        at: node.at.0.to_vec(),
        radius: 0.3 * result.scene.spacing,
        says: "a stroke ends here, where those of the exemplar go on".to_owned(),
        outline: Vec::new(),
    };
    loose.take(MARKS).map(mark).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_have_a_distance_from_nothing_to_one() {
        assert_eq!(apart(&[1.0, 1.0, 0.0], &[2.0, 2.0, 0.0]), 0.0);
        assert_eq!(apart(&[1.0, 0.0, 0.0], &[0.0, 0.0, 3.0]), 1.0);
    }
}
