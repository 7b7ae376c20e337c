//! Pseudo elements: curve samples as elements of one sample each, so that the engine can handle them like any others.

use std::sync::Arc;

use arabesque_core::{Budget, Class, Element, Exemplar, Outline, Result, Role, Similarity, Vector};

use crate::exemplar::graph::{
    net::Net,
    skeleton::{Knot, Skeleton},
};

/// The exemplar of one level: its elements, then one pseudo element per curve sample.
#[derive(Clone, Debug)]
pub(crate) struct PseudoElements<const D: usize> {
    pub(crate) exemplar: Exemplar<D>,
    /// First pseudo element.
    pub(crate) base: usize,
    pub(crate) net: Arc<Net<D>>,
}

impl<const D: usize> PseudoElements<D> {
    /// Samples the skeleton at `spacing` and appends the samples to the elements of `exemplar`.
    pub(crate) fn new(
        exemplar: &Exemplar<D>,
        skeleton: &Arc<Skeleton<D>>,
        spacing: f64,
        budget: &Budget,
    ) -> Result<Self> {
        let mut meter = budget.meter();
        let mut net = Net::new(skeleton, spacing, budget)?;
        let mut pseudo = exemplar.clone();
        let mut kinds: Vec<Vec<usize>> = Vec::new();
        for number in 0..net.nodes.len() as u32 {
            let styles = styles(exemplar, &net, number);
            net.nodes[number].styles.clone_from(&styles);
            meter.spend(1000 + 5 * kinds.len() as u64)?;
            let kind = kinds.iter().position(|k| *k == styles).unwrap_or_else(|| {
                kinds.push(styles);
                kinds.len() - 1
            });
            let node = &net.nodes[number];
            let tips = net.directions(number).into_iter().map(|t| node.position + t * spacing);
            pseudo.elements.push(Element {
                class: exemplar.classes.len() + kind,
                centre: node.position,
                pose: Similarity::shift(node.position),
                outline: Outline { rings: vec![std::iter::once(node.position).chain(tips).collect()] },
                colour: exemplar.curves[node.curve as usize].colour,
                lean: [Vector::ZERO; 3],
                role: if node.knot == Some(Knot::Cut) { Role::Context } else { Role::Source },
            });
        }
        pseudo.classes.extend(kinds.iter().enumerate().map(|(k, _)| Class { name: format!("curve {k}") }));
        Ok(Self { exemplar: pseudo, base: exemplar.elements.len(), net: Arc::new(net) })
    }
}

/// The styles of all strokes through a node, sorted: only samples with the same ones match.
fn styles<const D: usize>(exemplar: &Exemplar<D>, net: &Net<D>, node: u32) -> Vec<usize> {
    let lines = &net.skeleton.lines;
    let own = &net.nodes[node];
    let arms = own.arms.iter().map(|arm| lines[arm.piece.line].curve);
    let mut styles: Vec<_> =
        arms.chain(std::iter::once(own.curve)).map(|c| exemplar.curves[c as usize].style).collect();
    styles.sort_unstable();
    styles.dedup();
    styles
}
