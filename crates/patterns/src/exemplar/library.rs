//! The exemplar, analysed: what every later stage looks up.

use arabesque_core::{Domain, Exemplar, GridIndex, Numbered, Role, Stream, Vector, View};

use crate::exemplar::{features::Feature, kinds::kinds};

/// Random places that are tried where most of the window is a hole.
const TRIES: usize = 64;

/// Elements of one class, for look-ups by place.
#[derive(Clone, Debug)]
struct ClassIndex<const D: usize> {
    /// Element numbers, parallel to the points of `grid`.
    members: Vec<u32>,
    grid: GridIndex<D>,
}

/// The analysed exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Library<const D: usize> {
    /// Centre of each element.
    pub(crate) centre: Numbered<Vector<D>>,
    /// Kind of each element: its class, divided by colour where the class comes in several. What this crate calls a
    /// class of the library.
    pub(crate) class: Numbered<u32>,
    /// Attributes of each element.
    pub(crate) feature: Numbered<Feature>,
    /// Distance from the centre to the farthest ink of each element.
    pub(crate) radius: Numbered<f64>,
    /// Whether each element may be copied.
    pub(crate) copyable: Numbered<bool>,
    /// Where the exemplar is known.
    pub(crate) view: View<D>,
    /// Mean element spacing: (window measure / elements)^(1/D).
    pub(crate) spacing: f64,
    /// Outlier distance `k` of each class [Tu 2020 §4.2.3]: its mean nearest-neighbour distance, any class counted.
    pub(crate) outlier: Numbered<f64>,
    /// Distance of each element to its nearest neighbour, any class counted.
    pub(crate) nearest: Numbered<f64>,
    /// Radius of the largest ball without a centre that the exemplar surely shows.
    pub(crate) emptiness: f64,
    /// Smallest distance between the centres of two classes, row by row; as far as the elements are looked for when
    /// they never come close.
    closest: Vec<f64>,
    by_class: Numbered<ClassIndex<D>>,
    all: GridIndex<D>,
}

impl<const D: usize> Library<D> {
    /// `strokes`: the first pseudo class, that of curve samples, and the distance of these along their stroke, which is
    /// their outlier distance [Tu 2020 §4.2.3].
    pub(crate) fn new(exemplar: &Exemplar<D>, strokes: Option<(usize, f64)>) -> Self {
        let centre: Numbered<_> = exemplar.elements.iter().map(|e| e.centre).collect();
        let (class, classes) = kinds(exemplar);
        let class = Numbered::from(class);
        let spacing = exemplar.spacing();
        let plane = Domain::Box(exemplar.window);
        let all = GridIndex::new(&centre, spacing, &plane);
        let nearest: Numbered<_> = nearest_distances(&centre, &all, spacing);
        let closest = closest_distances(&centre, &class, classes, &all, spacing);
        let mut outlier = outlier_distances(&nearest, &class, classes, spacing);
        if let Some((first, distance)) = strokes {
            let of_strokes = exemplar.elements.iter().zip(&class).filter(|(e, _)| e.class >= first);
            of_strokes.for_each(|(_, &c)| outlier[c] = distance);
        }
        let by_class = (0..classes)
            .map(|c| {
                let members: Vec<u32> = (0..class.len() as u32).filter(|&i| class[i] == c as u32).collect();
                let points: Vec<_> = members.iter().map(|&i| centre[i]).collect();
                ClassIndex { grid: GridIndex::new(&points, outlier[c], &plane), members }
            })
            .collect();
        let elements = &exemplar.elements;
        Self {
            feature: elements.iter().map(|e| Feature::of(e, spacing)).collect(),
            radius: elements.iter().map(|e| e.outline.radius(e.centre)).collect(),
            copyable: elements.iter().map(|e| e.role == Role::Source).collect(),
            view: exemplar.view(),
            centre,
            class,
            spacing,
            outlier,
            nearest,
            closest,
            emptiness: emptiness(&exemplar.view(), &all, spacing),
            by_class,
            all,
        }
    }

    /// A random place that the exemplar shows.
    pub(crate) fn any_place(&self, random: &mut Stream) -> Vector<D> {
        let (a, b) = (self.view.window.min, self.view.window.max);
        let mut draw = || Vector(std::array::from_fn(|k| random.range(a[k], b[k])));
        let mut place = draw();
        for _ in 0..TRIES {
            if self.view.contains(place) {
                break;
            }
            place = draw();
        }
        place
    }

    /// Number of elements.
    pub(crate) fn len(&self) -> usize {
        self.centre.len()
    }

    /// The members of a class.
    pub(crate) fn members(&self, class: u32) -> &[u32] {
        &self.by_class[class].members
    }

    /// Number of classes.
    pub(crate) fn classes(&self) -> usize {
        self.by_class.len()
    }

    /// Calls `visit(element, offset)` for the elements within `radius` of `p`.
    pub(crate) fn within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(u32, Vector<D>)) {
        self.all.within(p, radius, |i, offset| visit(i as u32, offset));
    }

    /// The elements of `class` nearer to `p` than its outlier distance, position and attributes together: best first of
    /// at most two, with the squared distance.
    pub(crate) fn alike(&self, class: u32, p: Vector<D>, feature: &Feature) -> [Option<(u32, f32)>; 2] {
        let index = &self.by_class[class];
        let k = self.outlier[class];
        let k2 = (k * k) as f32;
        let mut best = [None::<(u32, f32)>; 2];
        index.grid.within(p, k, |slot, offset| {
            let i = index.members[slot];
            let cost = offset.norm2() as f32 + self.feature[i].distance2(feature);
            if cost >= k2 {
                return;
            }
            let ahead = |other: Option<(u32, f32)>| other.is_none_or(|(j, c)| (cost, i) < (c, j));
            if ahead(best[0]) {
                best = [Some((i, cost)), best[0]];
            } else if ahead(best[1]) {
                best[1] = Some((i, cost));
            }
        });
        best
    }

    /// Smallest distance of the centres of two elements of these classes in the exemplar.
    pub(crate) fn closest(&self, a: u32, b: u32) -> f64 {
        self.closest[a as usize * self.classes() + b as usize]
    }

    /// Largest distance that [`Library::closest`] gives for a class.
    pub(crate) fn widest(&self, a: u32) -> f64 {
        (0..self.classes() as u32).map(|b| self.closest(a, b)).fold(0.0, f64::max)
    }

    /// Radius of the ball that holds `count` elements on average.
    pub(crate) fn radius_for(&self, count: f64) -> f64 {
        let unit = if D == 3 { 4.0 / 3.0 * std::f64::consts::PI } else { std::f64::consts::PI };
        self.spacing * (count / unit).powf(1.0 / D as f64)
    }
}

/// Largest distance to the nearest centre, over the places of the window that lie farther from its sides than from that
/// centre.
fn emptiness<const D: usize>(view: &View<D>, all: &GridIndex<D>, spacing: f64) -> f64 {
    let (window, size) = (view.window, view.window.size());
    let step = if D == 2 { 0.2 * spacing } else { 0.34 * spacing };
    let cells: [usize; D] = std::array::from_fn(|k| ((size[k] / step).ceil() as usize).clamp(1, 2048));
    let mut largest = 0.0_f64;
    for c in 0..cells.iter().product() {
        let p = window.cell_centre(c, &cells);
        let side = view.signed_distance(p);
        let Some((_, distance)) = (0..6).find_map(|n| all.nearest(p, spacing * f64::from(1 << n), None)) else {
            continue;
        };
        if distance <= side {
            largest = largest.max(distance);
        }
    }
    if largest > 0.0 { largest } else { spacing }
}

/// Smallest centre distances of all pairs of classes, none larger than two mean spacings.
fn closest_distances<const D: usize>(
    centre: &[Vector<D>],
    class: &[u32],
    classes: usize,
    all: &GridIndex<D>,
    spacing: f64,
) -> Vec<f64> {
    let mut closest = vec![2.0 * spacing; classes * classes];
    for (i, &p) in centre.iter().enumerate() {
        all.within(p, 2.0 * spacing, |j, offset| {
            if i != j {
                let entry = &mut closest[class[i] as usize * classes + class[j] as usize];
                *entry = entry.min(offset.norm());
            }
        });
    }
    closest
}

fn nearest_distances<const D: usize>(centre: &[Vector<D>], all: &GridIndex<D>, spacing: f64) -> Numbered<f64> {
    // Doubling the radius finds the neighbour of a lonely element without scanning everything for the others.
    let search = |i: usize| (0..8).find_map(|n| all.nearest(centre[i], spacing * f64::from(1 << n), Some(i)));
    (0..centre.len()).map(|i| search(i).map_or(spacing, |(_, d)| d)).collect()
}

fn outlier_distances(nearest: &[f64], class: &[u32], classes: usize, spacing: f64) -> Numbered<f64> {
    let mut sum = Numbered::filled((0.0, 0.0), classes);
    for (&distance, &c) in nearest.iter().zip(class) {
        let entry = &mut sum[c];
        entry.0 += distance.max(0.25 * spacing);
        entry.1 += 1.0;
    }
    sum.into_iter().map(|(total, n): (f64, f64)| if n > 0.0 { total / n } else { spacing }).collect()
}
