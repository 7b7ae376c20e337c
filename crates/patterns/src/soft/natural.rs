//! What the exemplar shows of its elements: how near they come to one another, and how many there are.

use arabesque_core::{Budget, Exemplar, Result, Role};

use super::{bodies::Laid, form::Form};

/// Elements are pushed apart to a distance that this share of what is in the exemplar falls short of.
const CLOSE: f64 = 0.25;
/// Distances are looked for as far as so many thicknesses.
const FAR: f64 = 3.0;
/// Work for a piece that is looked at.
pub(super) const LOOK: u64 = 12;

/// What the exemplar shows.
#[derive(Clone, Debug)]
pub(super) struct Natural {
    classes: usize,
    /// Distance of surfaces to which elements of two classes are pushed apart.
    gap: Vec<f64>,
    /// Elements of each class in a unit of space.
    pub(super) density: Vec<f64>,
    /// Diameter of a typical element with the gap around it.
    pub(super) width: f64,
}

impl Natural {
    pub(super) fn new<const D: usize>(exemplar: &Exemplar<D>, forms: &[Form<D>], budget: &Budget) -> Result<Self> {
        let classes = exemplar.classes.len();
        let laid = laid(exemplar, forms);
        let mut meter = budget.meter();
        let mut found: Vec<Vec<f64>> = vec![Vec::new(); classes * classes];
        let mut nearest = Vec::new();
        let most = FAR * 2.0 * laid.thickest;
        let view = exemplar.view();
        for (n, body) in laid.bodies.list.iter().enumerate() {
            let form = &forms[body.source];
            for (p, r) in laid.bodies.samples(body, form).iter().zip(&form.soft.radii) {
                if !view.contains(*p) {
                    continue;
                }
                let mut of_class = vec![most; classes];
                let cost = laid.near(*p, most + laid.thickest, |piece, d| {
                    if piece.body as usize != n {
                        let gap = &mut of_class[piece.class as usize];
                        *gap = gap.min(d - piece.radius - r);
                    }
                });
                meter.spend(LOOK * cost)?;
                nearest.push(of_class.iter().copied().fold(most, f64::min));
                for (c, gap) in of_class.into_iter().enumerate().filter(|(_, gap)| *gap < most) {
                    found[form.class * classes + c].push(gap);
                }
            }
        }
        let any = quantile(&mut nearest, CLOSE).unwrap_or(0.0);
        let mut gap = vec![any; classes * classes];
        for a in 0..classes {
            for b in a..classes {
                let mut list = std::mem::take(&mut found[a * classes + b]);
                if a != b {
                    list.append(&mut found[b * classes + a]);
                }
                let own = quantile(&mut list, CLOSE).map_or(any, |own| own.min(any));
                (gap[a * classes + b], gap[b * classes + a]) = (own, own);
            }
        }
        let volume = view.measure();
        let mut density = vec![0.0; classes];
        let whole = exemplar.elements.iter().filter(|e| e.role == Role::Source);
        whole.for_each(|e| density[e.class] += 1.0 / volume);
        let mut radii: Vec<f64> = forms.iter().map(|f| f.thickest).collect();
        let width = 2.0 * quantile(&mut radii, 0.5).unwrap_or(0.0) + any;
        Ok(Self { classes, gap, density, width: width.max(1e-9) })
    }

    /// Distance of surfaces to which elements of these classes are pushed apart.
    pub(super) fn gap(&self, a: u32, b: u32) -> f64 {
        self.gap[a as usize * self.classes + b as usize]
    }

    /// The largest of these distances.
    pub(super) fn widest(&self) -> f64 {
        self.gap.iter().copied().fold(0.0, f64::max)
    }
}

/// The exemplar, laid out as it is.
pub(super) fn laid<const D: usize>(exemplar: &Exemplar<D>, forms: &[Form<D>]) -> Laid<D> {
    let (half, thickest) = sizes(forms);
    let bounds = forms.iter().flat_map(|f| f.soft.samples.iter()).fold(exemplar.window, |b, p| b.joined(*p));
    let mut laid = Laid::new(bounds, (2.0 * half).max(2.0 * thickest).max(1e-9), half, thickest);
    for (source, form) in forms.iter().enumerate() {
        laid.push(source, form, &form.soft.samples, 1.0, None);
    }
    laid
}

/// Half of the longest piece, and the thickest.
pub(super) fn sizes<const D: usize>(forms: &[Form<D>]) -> (f64, f64) {
    let most = |f: &dyn Fn(&Form<D>) -> f64| forms.iter().map(f).fold(0.0, f64::max);
    (0.5 * most(&|f| f.longest), most(&|f| f.thickest))
}

/// The value below which a share of a list lies.
pub(super) fn quantile(list: &mut [f64], share: f64) -> Option<f64> {
    list.sort_by(f64::total_cmp);
    list.get(((list.len() as f64 * share) as usize).min(list.len().saturating_sub(1))).copied()
}
