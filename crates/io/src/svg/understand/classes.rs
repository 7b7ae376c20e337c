//! Which elements are the same kind of thing.
//!
//! By name where the file gives one to several elements; else by paint, and by outline after the best similarity. Where
//! nearly every outline is one of its own, as with hand-cut chips, paint and size alone decide.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Class, Result, Signature, Similarity};

use crate::svg::{
    parse::{css::StyleRules, meta::Meta},
    understand::item::Item,
};

/// Mean distance of borders up to which two outlines are the same by hand, in radii.
pub(crate) const WOBBLE: f64 = 0.08;

/// Work for comparing two outlines.
const FIT: u64 = 12_000;
/// Work for looking at an item that may be of the same class.
const LOOK: u64 = 4;

/// Shapes of one paint beyond which outlines tell nothing.
const MAX_SHAPES: usize = 64;

/// Class and pose of every element.
#[derive(Debug, Default)]
pub(crate) struct Classes {
    pub(crate) classes: Vec<Class>,
    /// Class of item `i`, and the similarity from the first element of the class.
    pub(crate) members: Vec<(usize, Similarity<2>)>,
}

/// Sorts items into classes. Items that are cut take part by name and paint only: their outlines are not their own.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn classify(items: &[Item], is_whole: &[bool], sheet: &StyleRules<'_>, budget: &Budget) -> Result<Classes> {
    let signatures: Vec<Option<Signature>> = items.iter().map(|item| Signature::new(&item.outline)).collect();
    let names = shared_names(items, sheet);
    let mut labels: Vec<Option<Label>> = names.into_iter().map(|n| n.map(Label::Name)).collect();
    let unnamed: Vec<usize> = (0..items.len()).filter(|&i| labels[i].is_none() && is_whole[i]).collect();
    let paints: Vec<String> = items.iter().map(|item| item.painted.colours_key()).collect();
    for (i, label) in by_paint_and_outline(&unnamed, &paints, &signatures, budget)? {
        labels[i] = Some(label);
    }
    for i in 0..items.len() {
        if labels[i].is_none() {
            budget.spend(LOOK * items.len() as u64)?;
            labels[i] = nearest_by_paint(i, &labels, &paints, &signatures).or(Some(Label::Made(paints[i].clone(), 0)));
        }
    }
    budget.spend(FIT * items.len() as u64)?;
    Ok(numbered(&labels.into_iter().flatten().collect::<Vec<_>>(), is_whole, &signatures))
}

/// What makes a class.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Label {
    /// Its name in the file.
    Name(String),
    /// Paint and number of the shape among those of that paint.
    Made(String, usize),
}

/// For each item the first of its names that another item has too.
fn shared_names(items: &[Item], sheet: &StyleRules<'_>) -> Vec<Option<String>> {
    let names: Vec<Vec<String>> = items.iter().map(|item| names_of(&item.meta, sheet)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in names.iter().flatten() {
        *counts.entry(name).or_default() += 1;
    }
    let shared = |item: &Item, names: &[String]| {
        let stated = item.meta.kind.clone();
        stated.or_else(|| names.iter().find(|n| counts.get(n.as_str()).is_some_and(|c| *c > 1)).cloned())
    };
    items.iter().zip(&names).map(|(item, names)| shared(item, names)).collect()
}

/// The names of an item that may tell its kind: what a `<use>` shows, classes without a style, the label.
pub(crate) fn names_of(meta: &Meta, sheet: &StyleRules<'_>) -> Vec<String> {
    let shown = meta.shows.as_deref().map(|s| s.trim_start_matches('#').to_owned());
    let classes = meta.class.as_deref().unwrap_or_default().split_whitespace();
    let classes = classes.filter(|c| !sheet.styles_class(c)).map(str::to_owned);
    let label = meta.label.as_deref().map(bare_label).filter(|l| !l.is_empty());
    meta.kind.clone().into_iter().chain(shown).chain(classes).chain(label).collect()
}

/// A label without what drawing programs append to copies: `Leaf copy 3` and `leaf-12` are leaves.
fn bare_label(label: &str) -> String {
    let numbers = |c: char| c.is_ascii_digit() || matches!(c, ' ' | '-' | '_' | '#' | '.');
    let mut bare = label.trim().trim_end_matches(numbers);
    while let Some(rest) = bare.strip_suffix("copy").or_else(|| bare.strip_suffix("Copy")) {
        if rest.is_empty() {
            break;
        }
        bare = rest.trim_end_matches(numbers);
    }
    bare.to_lowercase()
}

fn by_paint_and_outline(
    items: &[usize],
    paints: &[String],
    signatures: &[Option<Signature>],
    budget: &Budget,
) -> Result<Vec<(usize, Label)>> {
    let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for &i in items {
        groups.entry(&paints[i]).or_default().push(i);
    }
    let mut labels = Vec::with_capacity(items.len());
    for (paint, members) in &groups {
        let shapes = shapes(members, signatures, budget)?;
        labels.extend(members.iter().zip(shapes).map(|(&i, shape)| (i, Label::Made((*paint).to_owned(), shape))));
    }
    let classes = labels.iter().map(|(_, l)| l).collect::<std::collections::BTreeSet<_>>().len();
    if items.len() >= 6 && 2 * classes > items.len() {
        // Every colour is used once or twice: it tells nothing, so outlines alone decide.
        let shapes = shapes(items, signatures, budget)?;
        return Ok(items.iter().zip(shapes).map(|(&i, shape)| (i, Label::Made(String::new(), shape))).collect());
    }
    Ok(labels)
}

/// Numbers the shapes among `members`: by outline, or by size where hardly any two outlines are alike.
fn shapes(members: &[usize], signatures: &[Option<Signature>], budget: &Budget) -> Result<Vec<usize>> {
    let mut failed = None;
    let alike = |a: &Signature, b: &Signature| {
        let fits = |()| a.fit(b).distance <= WOBBLE;
        let paid = if a.may_match(b) { budget.spend(FIT).map(fits) } else { Ok(false) };
        paid.unwrap_or_else(|error| {
            // Everything is alike from here on, which ends soon, and is thrown away.
            failed.get_or_insert(error);
            true
        })
    };
    let outlines = greedy(members, signatures, MAX_SHAPES, alike);
    if let Some(error) = failed {
        return Err(error);
    }
    let firsts = outlines.as_ref().map_or(0, |(_, count)| count * count);
    budget.spend(FIT * (members.len() + firsts) as u64)?;
    let told = outlines.filter(|(_, count)| members.len() < 3 || 2 * count <= members.len());
    if let Some((shapes, _)) = told.filter(|(shapes, _)| is_clear_cut(members, shapes, signatures)) {
        return Ok(shapes);
    }
    Ok(by_size(members, signatures))
}

/// Numbers sizes: those within a factor of three of the median are one, the rest is divided again.
fn by_size(members: &[usize], signatures: &[Option<Signature>]) -> Vec<usize> {
    let size = |k: usize| signatures[members[k]].as_ref().map_or(0.0, |s| s.size);
    let mut rest: Vec<usize> = (0..members.len()).collect();
    rest.sort_by(|&a, &b| size(a).total_cmp(&size(b)).then(a.cmp(&b)));
    let mut shapes = vec![0; members.len()];
    let mut shape = 0;
    while let Some(&middle) = rest.get(rest.len() / 2) {
        let near = |k: usize| size(k) == size(middle) || (1.0 / 3.0..=3.0).contains(&(size(k) / size(middle)));
        rest.retain(|&k| {
            if near(k) {
                shapes[k] = shape;
            }
            !near(k)
        });
        shape += 1;
    }
    shapes
}

/// Share of the distance between shapes that members may be off their own shape, in the mean.
const CLEAR: f64 = 0.3;

/// Whether members are much nearer to the first of their shape than the shapes are to each other. Where they are not,
/// the shapes are accidents of cutting one cloud of outlines into pieces.
fn is_clear_cut(members: &[usize], shapes: &[usize], signatures: &[Option<Signature>]) -> bool {
    let mut firsts: Vec<Option<&Signature>> = Vec::new();
    let mut off = Vec::new();
    for (&i, &shape) in members.iter().zip(shapes) {
        firsts.resize(firsts.len().max(shape + 1), None);
        match (&firsts[shape], &signatures[i]) {
            (Some(first), Some(own)) => off.push(first.fit(own).distance),
            (first, own) => firsts[shape] = first.or(own.as_ref()),
        }
    }
    let firsts: Vec<&Signature> = firsts.into_iter().flatten().collect();
    let nearest = |k: usize| {
        let others = (0..firsts.len()).filter(|&j| j != k && firsts[k].has_size_of(firsts[j]));
        others.map(|j| firsts[k].fit(firsts[j]).distance).reduce(f64::min)
    };
    let apart: Vec<f64> = (0..firsts.len()).filter_map(nearest).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    apart.is_empty() || off.is_empty() || mean(&off) <= CLEAR * mean(&apart)
}

/// Gives each member the first shape that it is like, or a new one; `None` when there are more than `most`.
fn greedy(
    members: &[usize],
    signatures: &[Option<Signature>],
    most: usize,
    mut alike: impl FnMut(&Signature, &Signature) -> bool,
) -> Option<(Vec<usize>, usize)> {
    let mut firsts: Vec<&Signature> = Vec::new();
    let mut shapes = Vec::with_capacity(members.len());
    for &i in members {
        let Some(signature) = &signatures[i] else {
            shapes.push(0);
            continue;
        };
        let known = firsts.iter().position(|first| alike(first, signature));
        shapes.push(known.unwrap_or(firsts.len()));
        if known.is_none() {
            firsts.push(signature);
        }
        if firsts.len() > most {
            return None;
        }
    }
    Some((shapes, firsts.len().max(1)))
}

/// The class of the item of the same paint that is nearest in size.
fn nearest_by_paint(
    i: usize,
    labels: &[Option<Label>],
    paints: &[String],
    signatures: &[Option<Signature>],
) -> Option<Label> {
    let size = |k: usize| signatures[k].as_ref().map_or(0.0, |s| s.size);
    let same = (0..labels.len()).filter(|&k| k != i && labels[k].is_some() && paints[k] == paints[i]);
    let gap = |k: &usize| (size(*k) - size(i)).abs();
    same.min_by(|a, b| gap(a).total_cmp(&gap(b)).then(a.cmp(b))).and_then(|k| labels[k].clone())
}

/// Numbers the classes in the order in which they appear and finds the poses.
fn numbered(labels: &[Label], is_whole: &[bool], signatures: &[Option<Signature>]) -> Classes {
    let mut found = Classes::default();
    let mut numbers: BTreeMap<&Label, usize> = BTreeMap::new();
    let mut firsts: Vec<Option<&Signature>> = Vec::new();
    for (i, label) in labels.iter().enumerate() {
        let number = *numbers.entry(label).or_insert_with(|| {
            let name = match label {
                Label::Name(name) => name.clone(),
                Label::Made(..) => format!("class {}", found.classes.len() + 1),
            };
            found.classes.push(Class { name });
            firsts.push(None);
            found.classes.len() - 1
        });
        if firsts[number].is_none() && is_whole[i] {
            firsts[number] = signatures[i].as_ref();
        }
        found.members.push((number, Similarity::identity()));
    }
    for (i, member) in found.members.iter_mut().enumerate() {
        if let (Some(first), Some(signature)) = (firsts[member.0], &signatures[i]) {
            let is_first = std::ptr::eq(first, signature);
            member.1 = if is_first { Similarity::identity() } else { first.fit(signature).pose };
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_copies_are_the_same() {
        for label in ["Leaf", "leaf 2", "Leaf copy", "leaf copy 3", "leaf-12", "Leaf_07"] {
            assert_eq!(bare_label(label), "leaf", "{label}");
        }
        assert_eq!(bare_label("copy 2"), "copy");
        assert_eq!(bare_label("12"), "");
    }
}
