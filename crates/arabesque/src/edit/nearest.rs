//! The nearest element of a class.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Domain, Error, GridIndex, Result, Vector, suggest::did_you_mean};
use arabesque_io::placed::{Item, Layout};

/// Elements by class, for questions after the nearest.
pub(super) struct Nearest<'a, const D: usize> {
    layout: &'a Layout<D>,
    of_class: BTreeMap<usize, (Vec<usize>, GridIndex<D>, f64)>,
}

impl<'a, const D: usize> Nearest<'a, D> {
    pub(super) fn new(layout: &'a Layout<D>) -> Self {
        Self { layout, of_class: BTreeMap::new() }
    }

    /// The element of the class called `class` that is nearest to `p`.
    pub(super) fn of(&mut self, class: &str, p: Vector<D>, budget: &Budget) -> Result<&'a Item<D>> {
        let layout = self.layout;
        let unknown = || {
            let known = layout.classes.iter().map(String::as_str);
            let hint = did_you_mean(class, known.clone());
            let list = known.take(8).collect::<Vec<_>>().join(", ");
            Error::parameter("class", format!("\"{class}\""), format!("a class of the result, such as {list}{hint}"))
        };
        let number = layout.classes.iter().position(|known| known == class).ok_or_else(unknown)?;
        let (members, index, start) = self.of_class.entry(number).or_insert_with(|| indexed(layout, number));
        let mut radius = *start;
        // As often as a radius can be doubled.
        for _ in 0..1100 {
            let (found, cost) = index.nearest_counted(p, radius, None);
            budget.spend(cost)?;
            if let Some((n, _)) = found {
                return Ok(&layout.items[members[n]]);
            }
            radius *= 2.0;
        }
        Err(unknown())
    }
}

fn indexed<const D: usize>(layout: &Layout<D>, class: usize) -> (Vec<usize>, GridIndex<D>, f64) {
    let members: Vec<usize> = (0..layout.items.len()).filter(|&n| layout.items[n].class == class).collect();
    let centres: Vec<_> = members.iter().map(|&n| layout.items[n].centre).collect();
    let domain = domain(layout);
    let longest = domain.bounds().size().0.into_iter().fold(0.0, f64::max);
    let radius = (longest / (members.len().max(1) as f64).powf(1.0 / D as f64)).max(f64::MIN_POSITIVE);
    (members, GridIndex::new(&centres, radius, &domain), radius)
}

/// What the elements fill.
pub(super) fn domain<const D: usize>(layout: &Layout<D>) -> Domain<D> {
    let around = Bounds::around(layout.items.iter().map(|item| item.centre));
    let frame = if layout.frame.is_empty() { around } else { layout.frame };
    if layout.is_tile { Domain::Torus(frame) } else { Domain::Box(frame) }
}
