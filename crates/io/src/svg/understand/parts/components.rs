//! Strokes without a fill: each connected piece is an element, or part of a net.
//!
//! A net is what runs through: a connected piece that reaches from one side of the frame to the opposite one, or over
//! half of it, or pieces that do so together while they leave no clear space between them. A smaller piece is a thing of its own, with the fills that it touches, unless it is painted like a net
//! and either cut off it by the frame or so near that there is no clear space around it: the inner of two arcs, a stitch
//! beside stitches.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Bounds, Budget, Outline, Result};

use crate::svg::{
    parse::style::Property as P,
    reason::Reason,
    shape::{
        adjacency::{Edge, Looks, edges_meet, meeting},
        extent::longer,
        painted_area::Painter,
        stroke::growth,
    },
    understand::{
        item::{HALF, Item, Kind, Origin},
        join::{SEAM, connected},
        parts::{
            beside::{PAIR as PART, is_part_of},
            crowds::crowds,
            groups::{is_small_fill, together},
        },
        ruled::on_paper,
    },
};

/// Pairs of edges that are looked at for what lies close to a net.
const EDGE_PAIRS: u64 = 50_000_000;
/// Work for each of them.
const PAIR: u64 = 10;
/// How near to a side of the frame something reaches it, as a share of the frame.
const NEAR: f64 = 1e-3;
/// Space around a piece painted like a net that makes it a thing of its own, as a share of its size.
const CLEAR: f64 = 0.2;

/// How much wider one stroke of a pen may be than another.
const PEN: f64 = 1.5;

/// Whether a stroke is sorted by what it is joined to.
fn is_loose(item: &Item) -> bool {
    item.origin == Origin::Stroke && item.reason == Reason::Stroke
}

/// Sorts the strokes that nothing is decided about into elements and nets, and puts together what is one thing.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn sort_strokes(mut items: Vec<Item>, painter: &Painter<'_, '_>, frame: Bounds<2>) -> Result<Vec<Item>> {
    if !items.iter().any(|item| item.origin == Origin::Stroke) {
        return Ok(items);
    }
    let tolerance = SEAM * longer(&frame);
    let both_loose = |i: usize, j: usize| is_loose(&items[i]) && is_loose(&items[j]);
    let groups = connected(&items, both_loose, tolerance, painter)?;
    let mut pieces: Vec<Component> = groups
        .into_iter()
        .filter(|group| is_loose(&items[group[0]]))
        .map(|group| Component::new(group, &items, &frame))
        .collect();
    let pens = pens(&items);
    weave(&mut pieces, &items, &pens, &frame, painter.source.budget)?;
    claim(&mut pieces, &items, &pens, (painter, &frame))?;
    if let [piece] = pieces.as_mut_slice()
        && items.len() == 1
        && !piece.is_at_side
        && items[0].outline.rings.len() > 1
    {
        // One ring in the middle of nothing shows no net, however large it is.
        piece.fate = Fate::Element;
    }
    for piece in &pieces {
        if let Fate::Net(reason) = piece.fate {
            for &i in &piece.members {
                (items[i].kind, items[i].reason) = (Kind::Curve, reason);
            }
        }
    }
    rule(&mut items, &mut pieces, &frame);
    put_together(items, &pieces, painter, frame)
}

/// Makes lines on squared paper parts of one net; what else lies there, such as pads, is a thing by itself.
fn rule(items: &mut [Item], pieces: &mut Vec<Component>, frame: &Bounds<2>) {
    let is_line = {
        let members: Vec<&[usize]> = pieces.iter().map(|piece| piece.members.as_slice()).collect();
        on_paper(items, &members, frame)
    };
    if !is_line.contains(&true) {
        return;
    }
    for piece in pieces.iter() {
        for &i in &piece.members {
            if !is_line[i] {
                (items[i].kind, items[i].reason) = (Kind::Element, Reason::Stroke);
            } else if items[i].kind == Kind::Element {
                (items[i].kind, items[i].reason) = (Kind::Curve, Reason::Ruled);
            }
        }
    }
    pieces.clear();
}

/// What becomes of a connected piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Element,
    Net(Reason),
}

impl Fate {
    /// The same, or part of a net for that reason.
    fn or(self, reason: Reason) -> Self {
        if self == Self::Element { Self::Net(reason) } else { self }
    }
}

/// Strokes that touch one another.
struct Component {
    members: Vec<usize>,
    extent: Bounds<2>,
    /// Whether it reaches a side of the frame.
    is_at_side: bool,
    fate: Fate,
}

impl Component {
    fn new(members: Vec<usize>, items: &[Item], frame: &Bounds<2>) -> Self {
        let extent = members.iter().fold(Bounds::EMPTY, |all, &i| all.union(&items[i].outline.bounds()));
        let near = NEAR * longer(frame);
        let low = |k: usize| extent.min[k] <= frame.min[k] + near;
        let high = |k: usize| extent.max[k] >= frame.max[k] - near;
        let seen = |k: usize| extent.max[k].min(frame.max[k]) - extent.min[k].max(frame.min[k]);
        let fate = if (0..2).any(|k| low(k) && high(k)) {
            Fate::Net(Reason::Through)
        } else if (0..2).any(|k| seen(k) >= HALF * frame.size()[k]) {
            Fate::Net(Reason::Vast)
        } else {
            Fate::Element
        };
        Self { members, extent, is_at_side: (0..2).any(|k| low(k) || high(k)), fate }
    }

    fn pens<'i>(&'i self, pens: &'i [usize]) -> impl Iterator<Item = usize> + 'i {
        self.members.iter().map(|&i| pens[i])
    }
}

/// Numbers of the pens that items are drawn with: of one colour and about one width.
fn pens(items: &[Item]) -> Vec<usize> {
    let mut order: Vec<(String, f64, usize)> =
        items.iter().enumerate().map(|(i, item)| (item.painted.colours_key(), width(item), i)).collect();
    order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut pens = vec![0; items.len()];
    let mut pen = (0, "", 0.0);
    for (colour, width, i) in &order {
        if pen.1 != colour || *width > PEN * pen.2 {
            pen = (pen.0 + 1, colour, *width);
        }
        pens[*i] = pen.0;
    }
    pens
}

/// Makes nets of pieces painted alike that leave no clear space between them: cells with a narrow gap around each,
/// stitches.
fn weave(pieces: &mut [Component], items: &[Item], pens: &[usize], frame: &Bounds<2>, budget: &Budget) -> Result<()> {
    let mut alike: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, piece) in pieces.iter().enumerate() {
        alike.entry(pens[piece.members[0]]).or_default().push(k);
    }
    for numbers in alike.into_values() {
        let outlines: Vec<Vec<&Outline<2>>> =
            numbers.iter().map(|&k| pieces[k].members.iter().map(|&i| &items[i].outline).collect()).collect();
        for group in crowds(&outlines, budget)? {
            let members = group.iter().flat_map(|&n| pieces[numbers[n]].members.iter().copied()).collect();
            if Component::new(members, items, frame).fate == Fate::Net(Reason::Through) {
                let all = group.iter().map(|&n| numbers[n]);
                all.for_each(|k| pieces[k].fate = pieces[k].fate.or(Reason::Crowded));
            }
        }
    }
    Ok(())
}

/// Gives small pieces to the nets that they are painted like, where these are near or the frame may have cut them off.
fn claim(
    pieces: &mut [Component],
    items: &[Item],
    pens: &[usize],
    (painter, frame): (&Painter<'_, '_>, &Bounds<2>),
) -> Result<()> {
    let is_net = |piece: &Component| matches!(piece.fate, Fate::Net(_));
    let nets: BTreeSet<usize> =
        pieces.iter().filter(|piece| is_net(piece)).flat_map(|piece| piece.pens(pens)).collect();
    if nets.is_empty() {
        return Ok(());
    }
    let is_like = |piece: &Component| piece.pens(pens).all(|pen| nets.contains(&pen));
    let mut reach = BTreeMap::new();
    let (mut at_side, mut near_net) = (Vec::new(), BTreeMap::new());
    for (k, piece) in pieces.iter().enumerate().filter(|(_, piece)| !is_net(piece) && is_like(piece)) {
        if piece.is_at_side {
            at_side.push(k);
        } else {
            near_net.insert(k, false);
            reach.extend(piece.members.iter().map(|&i| (i, (k, CLEAR * longer(&piece.extent)))));
        }
    }
    let net_members: BTreeSet<usize> =
        pieces.iter().filter(|piece| is_net(piece)).flat_map(|piece| piece.members.iter().copied()).collect();
    let involved: Vec<usize> = reach.keys().chain(&net_members).copied().collect();
    let boxes: Vec<_> = involved.iter().map(|&i| items[i].outline.bounds()).collect();
    let edges: Vec<Vec<Edge>> = involved.iter().map(|&i| items[i].outline.edges().collect()).collect();
    let mut left = Looks(EDGE_PAIRS);
    meeting(
        &boxes,
        |n| reach.get(&involved[n]).map_or(0.0, |(_, reach)| *reach),
        painter.source.budget,
        |m, n| {
            let (small, gap) = match (reach.get(&involved[m]), reach.get(&involved[n])) {
                (Some(&(k, gap)), None) | (None, Some(&(k, gap))) if !near_net[&k] => (k, gap),
                _ => return true,
            };
            let near = edges_meet(&edges[m], &edges[n], gap, &mut left);
            if near == Some(true) {
                near_net.insert(small, true);
            }
            near.is_some()
        },
    )?;
    painter.source.budget.spend(PAIR * (EDGE_PAIRS - left.0))?;
    agree(pieces, &near_net, items);
    let whole: Vec<usize> = near_net.keys().copied().filter(|&k| pieces[k].fate == Fate::Element).collect();
    for k in at_side {
        if !is_cut_off(&pieces[k], whole.iter().map(|&w| &pieces[w]), (items, pens), (frame, painter.source.budget))? {
            pieces[k].fate = Fate::Net(Reason::Beside);
        }
    }
    Ok(())
}

/// Things of a pen that something at a side of the frame is compared with.
const MODELS: usize = 8;

/// Whether something at a side of the frame is what that has left of a thing like one of the `whole` ones.
fn is_cut_off<'c>(
    piece: &Component,
    whole: impl Iterator<Item = &'c Component>,
    (items, pens): (&[Item], &[usize]),
    (frame, budget): (&Bounds<2>, &Budget),
) -> Result<bool> {
    let outlines = |piece: &Component| piece.members.iter().map(|&i| &items[i].outline).collect::<Vec<_>>();
    let part = outlines(piece);
    for model in whole.filter(|model| pens[model.members[0]] == pens[piece.members[0]]).take(MODELS) {
        let (is_part, looked) = is_part_of(&part, &outlines(model), frame);
        budget.spend(PART * looked)?;
        if is_part {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Claims for nets the pieces of a kind, drawn with one width, most of which are near a net: all of them or none.
fn agree(pieces: &mut [Component], near_net: &BTreeMap<usize, bool>, items: &[Item]) {
    let kind = |piece: &Component| {
        let item = &items[piece.members[0]];
        (item.painted.colours_key(), (50.0 * width(item).ln()).round() as i64)
    };
    let mut kinds: BTreeMap<(String, i64), Vec<usize>> = BTreeMap::new();
    near_net.keys().for_each(|&k| kinds.entry(kind(&pieces[k])).or_default().push(k));
    for members in kinds.into_values() {
        let near = members.iter().filter(|&k| near_net[k]).count();
        if 2 * near > members.len() {
            members.iter().for_each(|&k| pieces[k].fate = Fate::Net(Reason::Beside));
        }
    }
}

/// Width of the widest stroke of an item.
fn width(item: &Item) -> f64 {
    let widths =
        item.parts.iter().map(|(parent, node)| growth(*parent * node.transform) * node.style.number(P::StrokeWidth));
    widths.fold(0.0, f64::max)
}

/// Makes one item of each connected piece that is an element, with the fills that it touches, and of those that lie
/// close together with clear space around them.
fn put_together(
    items: Vec<Item>,
    pieces: &[Component],
    painter: &Painter<'_, '_>,
    frame: Bounds<2>,
) -> Result<Vec<Item>> {
    let tolerance = SEAM * longer(&frame);
    let is_stroke = |item: &Item| item.kind == Kind::Element && item.origin == Origin::Stroke;
    let small: BTreeSet<usize> = pieces
        .iter()
        .filter(|piece| piece.fate == Fate::Element)
        .flat_map(|piece| piece.members.iter().copied())
        .collect();
    let may_touch = |i: usize, j: usize| {
        let is_part = |k: usize| is_stroke(&items[k]) || is_small_fill(&items[k]);
        is_part(i) && is_part(j) && (small.contains(&i) || small.contains(&j))
    };
    let touching = connected(&items, may_touch, tolerance, painter)?;
    let touching = small_only(touching, &items, &frame, |group| {
        pieces
            .iter()
            .filter(|p| p.fate == Fate::Element && group.contains(&p.members[0]))
            .map(|p| p.members.clone())
            .collect()
    });
    let merged = merge(&items, &touching, Reason::Touching, painter, frame)?;
    let groups = together(&merged, frame, painter.source.budget)?;
    merge(&merged, &groups, Reason::Together, painter, frame)
}

/// The groups, those larger than elements taken apart into what `apart` says and single items.
fn small_only(
    groups: Vec<Vec<usize>>,
    items: &[Item],
    frame: &Bounds<2>,
    apart: impl Fn(&BTreeSet<usize>) -> Vec<Vec<usize>>,
) -> Vec<Vec<usize>> {
    let is_small = |group: &[usize]| {
        let extent = group.iter().fold(Bounds::EMPTY, |all, &i| all.union(&items[i].outline.bounds()));
        (0..2).all(|k| extent.size()[k] < HALF * frame.size()[k])
    };
    let mut out = Vec::with_capacity(groups.len());
    for group in groups {
        if group.len() < 2 || is_small(&group) {
            out.push(group);
            continue;
        }
        let members: BTreeSet<usize> = group.into_iter().collect();
        let strokes = apart(&members);
        let taken: BTreeSet<usize> = strokes.iter().flatten().copied().collect();
        out.extend(strokes);
        out.extend(members.difference(&taken).map(|&i| vec![i]));
    }
    out
}

/// One item of each group, in the order of their first members.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn merge(
    items: &[Item],
    groups: &[Vec<usize>],
    reason: Reason,
    painter: &Painter<'_, '_>,
    frame: Bounds<2>,
) -> Result<Vec<Item>> {
    let mut groups: Vec<&Vec<usize>> = groups.iter().collect();
    groups.sort_by_key(|group| group[0]);
    let one = |group: &Vec<usize>| {
        let item = Item::merged(items, group, frame, painter.source.budget)?;
        let many = group.len() > 1;
        Ok(if many { Item { kind: Kind::Element, origin: Origin::Whole, reason, ..item } } else { item })
    };
    groups.into_iter().map(one).collect()
}
