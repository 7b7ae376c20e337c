//! What an edit comes to for each element.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, Error, Matrix, Result, Similarity, Vector, rounded, suggest::did_you_mean};
use arabesque_io::placed::{Changes, Item, Layout, Paint, Replaced};
use arabesque_patterns::alike::{Places, Spot, Turned};

use super::nearest::{Nearest, domain};
use crate::recipe::Edit;

/// Units of work for a place where an element is inserted.
const PER_PLACE: u64 = 2000;

/// What an edit comes to.
#[derive(Clone, Debug)]
pub(super) struct Resolved<const D: usize> {
    pub(super) changes: Changes<D>,
    /// The elements that are changed, deleted or inserted, by number.
    pub(super) touched: Vec<Touched<D>>,
}

/// An element that an edit touches.
#[derive(Clone, Debug)]
pub(super) struct Touched<const D: usize> {
    pub(super) id: usize,
    pub(super) class: String,
    /// Where it was; nowhere, where it is new.
    pub(super) from: Option<Vector<D>>,
    /// Where it is; nowhere, where it is gone.
    pub(super) to: Option<Vector<D>>,
    /// How far it reaches.
    pub(super) reach: f64,
    /// How unlike its neighbourhood is to that of the element that was named, in mean spacings.
    pub(super) distance: f64,
}

/// An element that gets the edit of another: how it is turned and scaled against that one, and how unlike their places are.
#[derive(Clone, Copy, Debug)]
struct Match<const D: usize> {
    /// Index of the element that was named.
    of: usize,
    rotation: Matrix<D>,
    ratio: f64,
    distance: f64,
}

/// Works an edit out.
///
/// # Errors
/// [`Error::Parameter`] for an edit that contradicts itself, or names elements or classes that are not there; [`Error::Unsupported`] for what
/// the file cannot say.
pub(super) fn resolve<const D: usize>(edit: &Edit, layout: &Layout<D>, budget: &Budget) -> Result<Resolved<D>> {
    edit.check(D)?;
    supported(edit, layout)?;
    let budget = budget.stage("editing");
    let named = named(edit, layout)?;
    let matches = matches(edit, layout, &named, &budget)?;
    let mut resolving = Resolving { edit, layout, nearest: Nearest::new(layout), budget: &budget };
    if edit.delete {
        if matches.len() == layout.items.len() {
            return Err(Error::no_result("nothing would be left", "leave some elements, or delete the file"));
        }
        return Ok(resolving.deleted(&matches));
    }
    let resolved = if edit.insert.is_empty() { resolving.changed(&matches) } else { resolving.inserted(&matches) }?;
    within_reach(edit, &resolved, &budget)?;
    Ok(resolved)
}

/// Refuses what no reader would take: elements beyond the largest coordinate.
fn within_reach<const D: usize>(edit: &Edit, resolved: &Resolved<D>, budget: &Budget) -> Result<()> {
    let most = budget.limits().coordinate;
    let is_beyond = |touched: &&Touched<D>| {
        touched.to.is_some_and(|to| to.0.iter().any(|c| c.abs() > most - touched.reach || !c.is_finite()))
    };
    let Some(far) = resolved.touched.iter().find(is_beyond) else { return Ok(()) };
    let option = match (&edit.scale, edit.insert.is_empty()) {
        (_, false) => "insert",
        (Some(_), true) => "scale",
        (None, true) => "move",
    };
    let expected =
        format!("an edit after which element {} lies between -{} and {}", far.id, rounded(most), rounded(most));
    Err(Error::parameter(option, "too far", expected))
}

/// Refuses what the file cannot say.
fn supported<const D: usize>(edit: &Edit, layout: &Layout<D>) -> Result<()> {
    let refused = |what: &str, advice: &str| Err(Error::Unsupported { what: what.into(), advice: advice.into() });
    if !layout.turns && (edit.turn.is_some() || edit.scale.is_some()) {
        return refused("turning or scaling points of a table", "edit the result as SVG, JSON or GLB");
    }
    if !layout.paints && !edit.set.is_empty() {
        return refused("painting elements of a file that has no paint", "edit the result as SVG or GLB");
    }
    Ok(())
}

/// Indices of the elements that are named, each once.
fn named<const D: usize>(edit: &Edit, layout: &Layout<D>) -> Result<BTreeSet<usize>> {
    let index: BTreeMap<usize, usize> = layout.items.iter().enumerate().map(|(n, item)| (item.id, n)).collect();
    let find = |id: &usize| {
        index.get(id).copied().ok_or_else(|| {
            let last = index.keys().next_back().map_or(0, |last| *last);
            let expected = format!("the number of one of the {} elements, which are at most {last}", index.len());
            Error::parameter("item", id, expected)
        })
    };
    let unknown = edit.class.iter().chain(edit.insert.iter().map(|i| &i.class)).find(|c| !layout.classes.contains(c));
    if let Some(class) = unknown {
        let known = layout.classes.iter().map(String::as_str);
        let hint = did_you_mean(class, known.clone());
        let list = known.take(8).collect::<Vec<_>>().join(", ");
        return Err(Error::parameter("class", format!("\"{class}\""), format!("a class of the result: {list}{hint}")));
    }
    edit.items.iter().map(find).collect()
}

/// The elements that get the edit, by index.
fn matches<const D: usize>(
    edit: &Edit,
    layout: &Layout<D>,
    named: &BTreeSet<usize>,
    budget: &Budget,
) -> Result<BTreeMap<usize, Match<D>>> {
    let itself = |of: usize| Match { of, rotation: Matrix::identity(), ratio: 1.0, distance: 0.0 };
    let mut matches: BTreeMap<usize, Match<D>> = named.iter().map(|&n| (n, itself(n))).collect();
    let Some(threshold) = edit.propagate else { return Ok(matches) };
    let spot = |item: &Item<D>| Spot {
        centre: item.centre,
        rotation: item.place.rotation,
        scale: item.place.scale,
        class: if edit.any_class { 0 } else { item.class },
    };
    let spots = layout.items.iter().map(spot).collect();
    let places = Places::new(spots, &domain(layout), edit.radius, budget)?;
    for &of in named {
        let own = &layout.items[of].place;
        for alike in places.alike(of, threshold, budget)? {
            let item = &layout.items[alike.spot];
            // What the user placed stays, unless it is named.
            if item.kept || named.contains(&alike.spot) {
                continue;
            }
            let (rotation, ratio) = match alike.turned {
                Turned::WithPage => (Matrix::identity(), 1.0),
                Turned::WithElement => {
                    (item.place.rotation.compose(&own.rotation.transpose()), item.place.scale / own.scale)
                }
            };
            let new = Match { of, rotation, ratio, distance: alike.distance };
            let old = matches.entry(alike.spot).or_insert(new);
            if new.distance < old.distance {
                *old = new;
            }
        }
    }
    Ok(matches)
}

struct Resolving<'a, const D: usize> {
    edit: &'a Edit,
    layout: &'a Layout<D>,
    nearest: Nearest<'a, D>,
    budget: &'a Budget,
}

impl<const D: usize> Resolving<'_, D> {
    fn touched(&self, index: usize, to: Option<Vector<D>>, distance: f64) -> Touched<D> {
        let item = &self.layout.items[index];
        let class = self.layout.classes[item.class].clone();
        Touched { id: item.id, class, from: Some(item.centre), to, reach: item.reach, distance }
    }

    fn deleted(&self, matches: &BTreeMap<usize, Match<D>>) -> Resolved<D> {
        let removed = matches.keys().map(|&n| self.layout.items[n].id).collect();
        let touched = matches.iter().map(|(&n, found)| self.touched(n, None, found.distance)).collect();
        Resolved { changes: Changes { removed, ..Changes::default() }, touched }
    }

    fn changed(&mut self, matches: &BTreeMap<usize, Match<D>>) -> Result<Resolved<D>> {
        let (shift, turn) = (vector(&self.edit.shift), self.turn());
        let scale = self.edit.scale.unwrap_or(1.0);
        let (mut replaced, mut touched) = (BTreeMap::new(), Vec::new());
        for (&n, found) in matches {
            let item = &self.layout.items[n];
            let target = item.centre + found.rotation.apply(shift) * found.ratio;
            let turn = found.rotation.compose(&turn).compose(&found.rotation.transpose());
            let (base, rotation, scale) = match &self.edit.class {
                None => (item, turn, scale),
                Some(class) => {
                    let like = self.nearest.of(class, item.centre, self.budget)?;
                    let own = item.place.rotation.compose(&like.place.rotation.transpose());
                    (like, turn.compose(&own), scale * item.place.scale / like.place.scale)
                }
            };
            // Exactly the same frame: not even the last bit is turned.
            let is_still = base.id == item.id && self.edit.turn.is_none();
            let rotation = if is_still { Matrix::identity() } else { rotation };
            let motion = about(base.centre, target, rotation, scale);
            replaced.insert(item.id, Replaced { base: base.id, motion, paint: self.edit.paint() });
            let class = self.layout.classes[base.class].clone();
            let reach = base.reach * scale;
            touched.push(Touched { class, reach, ..self.touched(n, Some(target), found.distance) });
        }
        Ok(Resolved { changes: Changes { replaced, ..Changes::default() }, touched })
    }

    /// The rotation that the edit asks for.
    fn turn(&self) -> Matrix<D> {
        let radians = self.edit.turn.unwrap_or(0.0).to_radians();
        let (sin, cos) = (exact(radians.sin()), exact(radians.cos()));
        if D == 2 {
            let rows = [[cos, -sin], [sin, cos]];
            return Matrix(std::array::from_fn(|r| std::array::from_fn(|c| rows[r][c])));
        }
        let axis = self.edit.axis.unwrap_or([0.0, 1.0, 0.0]);
        let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
        let [x, y, z] = axis.map(|v| v / length);
        let t = 1.0 - cos;
        let rows = [
            [t * x * x + cos, t * x * y - sin * z, t * x * z + sin * y],
            [t * x * y + sin * z, t * y * y + cos, t * y * z - sin * x],
            [t * x * z - sin * y, t * y * z + sin * x, t * z * z + cos],
        ];
        Matrix(std::array::from_fn(|r| std::array::from_fn(|c| rows[r][c])))
    }

    fn inserted(&mut self, matches: &BTreeMap<usize, Match<D>>) -> Result<Resolved<D>> {
        let (mut inserted, mut touched): (Vec<(usize, Replaced<D>)>, Vec<Touched<D>>) = (Vec::new(), Vec::new());
        let mut next = self.layout.next;
        for insertion in &self.edit.insert {
            let at = vector(&insertion.at);
            let like = self.nearest.of(&insertion.class, at, self.budget)?;
            let mut places: Vec<(Vector<D>, Matrix<D>, f64, f64)> = vec![(at, Matrix::identity(), 1.0, 0.0)];
            if self.edit.propagate.is_some() {
                let is_inside = self.is_inside(at);
                // The place itself comes from the named element that is nearest to it.
                let from = |n: &usize| (self.layout.items[*n].centre - at).norm2();
                let of = matches.values().map(|m| m.of).min_by(|a, b| from(a).total_cmp(&from(b)));
                for (&n, found) in matches.iter().filter(|(n, found)| Some(found.of) == of && **n != found.of) {
                    let offset = at - self.layout.items[found.of].centre;
                    let there = self.layout.items[n].centre + found.rotation.apply(offset) * found.ratio;
                    if !is_inside || self.is_inside(there) {
                        places.push((there, found.rotation, found.ratio, found.distance));
                    }
                }
            }
            self.budget.spend(PER_PLACE.saturating_mul(places.len() as u64))?;
            let count = self.layout.items.len() + inserted.len() + places.len();
            self.budget.within("elements after inserting", count, ("elements", self.budget.limits().elements))?;
            for (there, rotation, ratio, distance) in places {
                let motion = about(like.centre, there, rotation, ratio);
                inserted.push((next, Replaced { base: like.id, motion, paint: Vec::<Paint>::new() }));
                let class = insertion.class.clone();
                touched.push(Touched {
                    id: next,
                    class,
                    from: None,
                    to: Some(there),
                    reach: like.reach * ratio,
                    distance,
                });
                next += 1;
            }
        }
        Ok(Resolved { changes: Changes { inserted, ..Changes::default() }, touched })
    }

    fn is_inside(&self, p: Vector<D>) -> bool {
        self.layout.is_tile || self.layout.frame.contains(p)
    }
}

/// Turned and scaled about a centre, which lands on `target`; a mere shift is exactly that.
fn about<const D: usize>(centre: Vector<D>, target: Vector<D>, rotation: Matrix<D>, scale: f64) -> Similarity<D> {
    if rotation == Matrix::identity() && (scale - 1.0).abs() < f64::EPSILON {
        return Similarity::shift(target - centre);
    }
    Similarity::about(centre, target, rotation, scale)
}

fn vector<const D: usize>(list: &[f64]) -> Vector<D> {
    Vector(std::array::from_fn(|k| list.get(k).copied().unwrap_or(0.0)))
}

/// Sine and cosine of quarter turns without the last bit.
fn exact(value: f64) -> f64 {
    if value.abs() < 1e-15 { 0.0 } else { value }
}
