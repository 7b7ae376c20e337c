//! The exemplar, analysed: what every later stage looks up.

use arabesque_core::{
    Bounds, Budget, Domain, Exemplar, GridIndex, Meter, Numbered, Result, Role, Stream, Vector, View,
};

use crate::exemplar::{
    closest::ClosestDistances,
    differences::Differences,
    features::Feature,
    kinds::kinds,
    places::{Placed, Places},
    upright::upright,
};

/// Random places that are tried where most of the window is a hole.
const TRIES: usize = 64;

/// Elements whose ink reaches farther than so many diagonals of the frame are no part of a pattern that the frame could show.
const FAR: f64 = 2.0;

/// Nanoseconds for an element that is looked at, whether it is near or not.
const LOOK: u64 = 4;

/// How often the reach is doubled, at most, in which the element nearest to a place, and to another element, is looked for.
const DOUBLINGS: (u32, u32) = (6, 8);

/// Elements that are asked how crowded they stand, and how many times as many as an even exemplar has they may have about them.
const CROWD: (usize, f64) = (200, 4.0);

/// Nanoseconds for a corner of an outline that is described.
const CORNER: u64 = 60;

/// The analysed exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Library<const D: usize> {
    /// Centre of each element.
    pub(crate) centre: Numbered<Vector<D>>,
    /// Kind of each element: its class, divided by colour where the class comes in several. What this crate calls a
    /// class of the library.
    pub(crate) class: Numbered<u32>,
    /// How the attributes of the elements differ.
    pub(crate) differences: Differences,
    /// Distance from the centre to the farthest ink of each element.
    pub(crate) radius: Numbered<f64>,
    /// Whether each element keeps its angle.
    pub(crate) upright: Numbered<bool>,
    /// Whether each element may be copied.
    pub(crate) copyable: Numbered<bool>,
    /// How far ink reaches from the centre of an element, those left out that are out of all proportion.
    pub(crate) reach: f64,
    /// How many elements are out of all proportion: they are not copied.
    pub(crate) giants: usize,
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
    /// Smallest distance between the centres of two classes; as far as the elements are looked for when they never come
    /// close.
    closest: ClosestDistances,
    members: Numbered<Vec<u32>>,
    /// The elements of each class by place, within their outlier distance.
    places: Numbered<Places<D>>,
    all: GridIndex<D>,
}

impl<const D: usize> Library<D> {
    /// `strokes`: the first pseudo class, that of curve samples, and the distance of these along their stroke, which is
    /// their outlier distance [Tu 2020 §4.2.3].
    pub(crate) fn new(exemplar: &Exemplar<D>, strokes: Option<(usize, f64)>, budget: &Budget) -> Result<Self> {
        let corners: usize =
            exemplar.elements.iter().map(|e| e.outline.rings.iter().map(Vec::len).sum::<usize>()).sum();
        budget.spend(corners as u64 * CORNER + exemplar.elements.len() as u64 * 500)?;
        let centre: Numbered<_> = exemplar.elements.iter().map(|e| e.centre).collect();
        let (class, classes) = kinds(exemplar);
        let class = Numbered::from(class);
        let spacing = exemplar.spacing();
        let plane = Domain::Box(exemplar.window);
        let all = GridIndex::new(&centre, spacing, &plane);
        let nearest: Numbered<_> = nearest_distances(&centre, &all, spacing, budget)?;
        let closest = ClosestDistances::new(&centre, &class, classes, (&all, 2.0 * spacing), budget)?;
        let mut outlier = outlier_distances(&nearest, &class, classes, spacing);
        if let Some((first, distance)) = strokes {
            let of_strokes = exemplar.elements.iter().zip(&class).filter(|(e, _)| e.class >= first);
            of_strokes.for_each(|(_, &c)| outlier[c] = distance);
        }
        let mut members = Numbered::filled(Vec::new(), classes);
        class.iter().zip(0..).for_each(|(&c, i)| members[c].push(i));
        let mut meter = budget.meter();
        let places = members.iter().zip(&outlier).map(|(m, &k)| Places::new(m, |i| centre[i], k, &mut meter));
        let places = places.collect::<Result<_>>()?;
        let elements = &exemplar.elements;
        let radius: Numbered<_> = elements.iter().map(|e| e.outline.radius(e.centre)).collect();
        let far = farthest(&exemplar.window);
        Ok(Self {
            upright: upright(exemplar, &members, budget)?,
            differences: Differences::new(
                elements.iter().map(|e| Feature::of(e, spacing)).collect(),
                members.iter().map(Vec::as_slice),
            ),
            copyable: elements.iter().zip(&radius).map(|(e, r)| e.role == Role::Source && *r <= far).collect(),
            reach: radius.iter().copied().filter(|r| *r <= far).fold(0.0, f64::max),
            giants: elements.iter().zip(&radius).filter(|(e, r)| e.role == Role::Source && **r > far).count(),
            radius,
            view: exemplar.view(),
            centre,
            class,
            spacing,
            outlier,
            nearest,
            closest,
            emptiness: emptiness(&exemplar.view(), &all, spacing, budget)?,
            members,
            places,
            all,
        })
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
        &self.members[class]
    }

    /// Number of classes.
    pub(crate) fn classes(&self) -> usize {
        self.members.len()
    }

    /// Calls `visit(element, offset)` for the elements within `radius` of `p`. Returns about how many nanoseconds it took.
    pub(crate) fn within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(u32, Vector<D>)) -> u64 {
        self.all.within(p, radius, |i, offset| visit(i as u32, offset)) * LOOK
    }

    /// The elements of the class of element `like` nearer to `p` than its outlier distance, position and attributes together: best first
    /// of at most two, with the squared distance.
    #[inline]
    pub(crate) fn alike(&self, like: u32, p: Vector<D>, meter: &mut Meter<'_>) -> Result<[Option<(u32, f32)>; 2]> {
        let class = self.class[like];
        let k2 = self.outlier[class] * self.outlier[class];
        let most = k2 as f32;
        let mut best = [None::<(u32, f32)>; 2];
        let near = self.places[class].near(p);
        let like = self.differences.from(like);
        for &Placed { place, element } in near {
            let d2 = (place - p).norm2();
            if d2 > k2 {
                continue;
            }
            let cost = d2 as f32 + like.of(element);
            if cost >= most {
                continue;
            }
            let ahead = |other: Option<(u32, f32)>| other.is_none_or(|(j, c)| (cost, element) < (c, j));
            if ahead(best[0]) {
                best = [Some((element, cost)), best[0]];
            } else if ahead(best[1]) {
                best[1] = Some((element, cost));
            }
        }
        meter.spend(LOOK * (2 + near.len() as u64))?;
        Ok(best)
    }

    /// Smallest distance of the centres of two elements of these classes in the exemplar.
    pub(crate) fn closest(&self, a: u32, b: u32) -> f64 {
        self.closest.of(a, b)
    }

    /// Largest distance that [`Library::closest`] gives for a class.
    pub(crate) fn widest(&self, a: u32) -> f64 {
        self.closest.widest(a)
    }

    /// [`Library::radius_for`], smaller where elements crowd: along a line, or in heaps with empty space between them, the radius of
    /// `count` elements on average over the window has many times as many about each of them.
    pub(crate) fn crowded_radius(&self, count: f64, budget: &Budget) -> Result<f64> {
        let radius = self.radius_for(count);
        let (asked, most) = (self.len().min(CROWD.0), CROWD.1 * count);
        let mut distances = Vec::new();
        let mut meter = budget.meter();
        for k in 0..asked {
            let place = self.centre[k * self.len() / asked];
            meter.spend(self.within(place, radius, |_, offset| distances.push(offset.norm2())))?;
        }
        let allowed = (most * asked as f64) as usize;
        if distances.len() <= allowed {
            return Ok(radius);
        }
        meter.spend(LOOK * distances.len() as u64)?;
        let (_, farthest, _) = distances.select_nth_unstable_by(allowed, f64::total_cmp);
        Ok(farthest.sqrt())
    }

    /// Radius of the ball that holds `count` elements on average.
    pub(crate) fn radius_for(&self, count: f64) -> f64 {
        let disc = self.spacing * (count / std::f64::consts::PI).sqrt();
        let thinnest = self.view.window.size().0.into_iter().fold(f64::INFINITY, f64::min);
        if D == 2 || thinnest < self.spacing {
            return disc;
        }
        self.spacing * (count / (4.0 / 3.0 * std::f64::consts::PI)).cbrt()
    }
}

/// Largest distance to the nearest centre, over the places of the window that lie farther from its sides than from that
/// centre.
fn emptiness<const D: usize>(view: &View<D>, all: &GridIndex<D>, spacing: f64, budget: &Budget) -> Result<f64> {
    let mut meter = budget.meter();
    let (window, size) = (view.window, view.window.size());
    let step = if D == 2 { 0.2 * spacing } else { 0.34 * spacing };
    let cells: [usize; D] = std::array::from_fn(|k| ((size[k] / step).ceil() as usize).clamp(1, 2048));
    let mut largest = 0.0_f64;
    // Along a row distances grow by no more than the way: what cannot come to more than is known, or lies nearer to a side, is not asked.
    let stride = size[0] / cells[0] as f64;
    let mut nothing_before = 0;
    for c in 0..cells.iter().product() {
        if c % cells[0] == 0 {
            nothing_before = c;
        }
        if c < nothing_before {
            continue;
        }
        let p = window.cell_centre(c, &cells);
        let side = view.signed_distance(p);
        meter.spend(LOOK)?;
        // What is farther than the sides, or no farther than what is known already, changes nothing.
        let mut reach = spacing;
        for _ in 0..DOUBLINGS.0 {
            if side <= largest {
                break;
            }
            let (found, looked) = all.nearest_counted(p, reach, None);
            meter.spend(LOOK * (4 + looked))?;
            let distance = found.map_or(reach, |(_, distance)| distance);
            if found.is_some() && distance <= side {
                largest = largest.max(distance);
            }
            if found.is_some() || reach >= side {
                let known = if found.is_some() { largest - distance } else { 0.0 };
                let steps = known.max(0.5 * (distance - side)) / stride - 1e-6;
                nothing_before = c + 1 + steps.floor().max(0.0) as usize;
                break;
            }
            reach *= 2.0;
        }
    }
    Ok(if largest > 0.0 { largest } else { spacing })
}

/// How far ink may reach from its centre before it is out of all proportion to what the window can show.
pub(crate) fn farthest<const D: usize>(window: &Bounds<D>) -> f64 {
    FAR * window.size().norm()
}

fn nearest_distances<const D: usize>(
    centre: &[Vector<D>],
    all: &GridIndex<D>,
    spacing: f64,
    budget: &Budget,
) -> Result<Numbered<f64>> {
    let mut meter = budget.meter();
    // Doubling the radius finds the neighbour of a lonely element without scanning everything for the others.
    let mut nearest = Numbered::new();
    for (i, &p) in centre.iter().enumerate() {
        let mut distance = spacing;
        for doubling in 0..DOUBLINGS.1 {
            let (found, looked) = all.nearest_counted(p, spacing * f64::from(1 << doubling), Some(i));
            meter.spend(LOOK * looked)?;
            if let Some((_, found)) = found {
                distance = found;
                break;
            }
        }
        nearest.push(distance);
    }
    Ok(nearest)
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
