//! The layers of a drawing from bottom to top: the strokes of each paint, and the elements between them.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, Precedence, Result, Vote, precedence};

use crate::svg::{drawing::Layer, layers::covering::Counts};

/// Share of the meetings of two kinds that lie the other way round than the rest from which on they are said to weave.
const WEAVING: f64 = 0.02;

/// So many such meetings may be an oversight.
const FEW: u64 = 4;

/// What is to be put into layers. Kinds are numbers: first those of the paints of strokes, then those of the classes of
/// elements.
#[derive(Debug)]
pub(crate) struct Kinds<'a> {
    /// Paints of strokes.
    pub(crate) paints: usize,
    /// Classes of elements.
    pub(crate) classes: usize,
    /// The paints of each style of curves, from bottom to top.
    pub(crate) styles: &'a [Vec<usize>],
    /// Whether elements lie below strokes where nothing else is seen.
    pub(crate) elements_first: bool,
}

/// Layers, and in how many meetings those cover one another that are said to lie one below the other.
#[derive(Debug, PartialEq)]
pub(crate) struct Layered {
    pub(crate) layers: Vec<Layer>,
    pub(crate) weaving: u64,
}

/// Puts paints and classes into layers, as most of their meetings are.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn layered(kinds: &Kinds<'_>, counts: &Counts, budget: &Budget) -> Result<Layered> {
    let number = |kind: usize| match (kind < kinds.paints, kinds.elements_first) {
        (true, true) => kind + kinds.classes,
        (false, true) => kind - kinds.paints,
        (_, false) => kind,
    };
    let seen = counts.iter().map(|(&(low, high), &n)| (low, high, n as f64));
    let of_styles = kinds.styles.iter().flat_map(|paints| paints.windows(2).map(|w| (w[0], w[1], 1.0)));
    let votes: Vec<Vote> = seen
        .chain(of_styles)
        .map(|(low, high, weight)| Vote { first: number(low), second: number(high), weight })
        .collect();
    let Precedence { order, .. } = precedence(kinds.paints + kinds.classes, &votes, budget)?;
    let mut styles_of: Vec<Vec<(usize, usize)>> = vec![Vec::new(); kinds.paints];
    for (style, paints) in kinds.styles.iter().enumerate() {
        paints.iter().enumerate().for_each(|(paint, &kind)| styles_of[kind].push((style, paint)));
    }
    let mut kind_of = vec![0; order.len()];
    (0..order.len()).for_each(|kind| kind_of[number(kind)] = kind);
    let mut layers: Vec<Layer> = Vec::new();
    for kind in order.into_iter().map(|n| kind_of[n]) {
        match (styles_of.get(kind), layers.last_mut()) {
            (Some(of), _) => layers.extend(of.iter().map(|&(style, paint)| Layer::Strokes { style, paint })),
            (None, Some(Layer::Elements(classes))) => {
                classes.insert(kind - kinds.paints);
            }
            (None, _) => layers.push(Layer::Elements(BTreeSet::from([kind - kinds.paints]))),
        }
    }
    Ok(Layered { layers, weaving: weaving(kinds, counts) })
}

/// Meetings of strokes with something that lie the other way round than most between the same kinds.
fn weaving(kinds: &Kinds<'_>, counts: &Counts) -> u64 {
    turns(counts, |kind| kind < kinds.paints).into_iter().map(|(.., few)| few).sum()
}

/// The pairs of kinds, one of strokes at least, that lie on one another in turn, and how often the other way round than mostly.
pub(crate) fn turns(counts: &Counts, is_strokes: impl Fn(usize) -> bool) -> Vec<(usize, usize, u64)> {
    let mut pairs: BTreeMap<(usize, usize), [u64; 2]> = BTreeMap::new();
    for (&(low, high), &n) in counts.iter().filter(|((low, high), _)| is_strokes(*low) || is_strokes(*high)) {
        pairs.entry((low.min(high), low.max(high))).or_default()[usize::from(low > high)] += n;
    }
    let fewer = pairs.into_iter().map(|((a, b), n)| (a, b, n[0].min(n[1]), n[0] + n[1]));
    fewer
        .filter(|&(.., few, all)| few > FEW && few as f64 > WEAVING * all as f64)
        .map(|(a, b, few, _)| (a, b, few))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(styles: &[Vec<usize>], classes: usize, elements_first: bool) -> Kinds<'_> {
        let paints = styles.iter().flatten().max().map_or(0, |p| p + 1);
        Kinds { paints, classes, styles, elements_first }
    }

    fn elements(classes: &[usize]) -> Layer {
        Layer::Elements(classes.iter().copied().collect())
    }

    fn strokes(style: usize, paint: usize) -> Layer {
        Layer::Strokes { style, paint }
    }

    fn of(kinds: &Kinds<'_>, counts: &[((usize, usize), u64)]) -> Layered {
        layered(kinds, &counts.iter().copied().collect(), &Budget::default()).unwrap()
    }

    #[test]
    fn without_meetings_the_first_in_the_file_is_below() {
        let styles = [vec![0], vec![1]];
        assert_eq!(of(&kinds(&styles, 2, false), &[]).layers, [strokes(0, 0), strokes(1, 0), elements(&[0, 1])]);
        assert_eq!(of(&kinds(&styles, 2, true), &[]).layers, [elements(&[0, 1]), strokes(0, 0), strokes(1, 0)]);
        assert_eq!(of(&kinds(&[], 2, false), &[]).layers, [elements(&[0, 1])]);
    }

    #[test]
    fn all_casings_lie_below_all_cores() {
        let styles = [vec![0, 1], vec![0, 2]];
        let wanted = [strokes(0, 0), strokes(1, 0), strokes(0, 1), strokes(1, 1)];
        assert_eq!(of(&kinds(&styles, 0, false), &[]).layers, wanted);
    }

    #[test]
    fn elements_lie_between_strokes_where_they_do_in_the_file() {
        let styles = [vec![0], vec![1]];
        let found = of(&kinds(&styles, 2, true), &[((0, 2), 9), ((2, 1), 9), ((3, 0), 9)]);
        assert_eq!(found.layers, [elements(&[1]), strokes(0, 0), elements(&[0]), strokes(1, 0)]);
        assert_eq!(found.weaving, 0);
    }

    #[test]
    fn what_covers_one_another_in_turn_is_told() {
        let found = of(&kinds(&[vec![0], vec![1]], 0, false), &[((0, 1), 40), ((1, 0), 60)]);
        assert_eq!(found, Layered { layers: vec![strokes(1, 0), strokes(0, 0)], weaving: 40 });
    }
}
