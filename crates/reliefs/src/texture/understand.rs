//! The texture as it is understood: its points as a surface, the box of the texture proper, its field, and where patches may be taken from.

use arabesque_core::{Bounds, Budget, Error, Held, PointSet, Result, Vector, Warning, rounded};
use arabesque_surface::{OrientedPoints, spacing_of};

use crate::{
    params::{ReliefParams, Search},
    sample::Sample,
    search::best::Searcher,
    search::field::{Field, Lattice},
    texture::{
        axes::Axes,
        gap::Gap,
        pieces::Pieces,
        reading::{axes, checked, fail, oriented, surface, told},
        repeat::Repeat,
        repetition::{Repetition, repetition},
    },
};

/// Cells of the lattice along a patch, at least.
const LEAST: f64 = 4.0;
/// Radius in which points count as one surface, in spacings.
const RADIUS: f64 = 2.5;
/// Side of a cell of the field, in spacings.
const CELL: f64 = 1.3;
/// Cells along the longer side of the field at most, where nobody says.
const CELLS: f64 = 400.0;
/// Rows of nodes above one another at most.
const ROWS: f64 = 10.0;
/// Cells of a field at most.
const NODES: usize = 4_000_000;
/// Places that are enough to choose from beside a gap.
const ENOUGH: usize = 12;
/// How much smaller patches become at most where parts of the box are bare.
const SMALLEST: f64 = 0.5;
/// Share of a patch that overlaps the next: least, and most.
const OVERLAP: (f64, f64) = (0.1, 0.2);
/// The same at most of a sheet that is high.
const OVERLAP_OF_SHEETS: f64 = 0.3;
/// Width of the overlap of a sheet at least, as a share of its height beyond what is low for a patch of side 1.
const CLIMB: f64 = 0.6;
const LOW: f64 = 0.35;
/// Normals of a sheet rise by more than this, and so many of them do.
const UPRIGHT: f64 = 0.02;
const SHEET: f64 = 0.99;
/// Mean surface variation of what has no edges.
const SMOOTH: f64 = 0.03;
/// Cells across an overlap that tell which way things go on there.
const OVERLAPPED: f64 = 4.0;
/// Share of a patch that its border is wide: least, and most.
const BORDER: (f64, f64) = (0.15, 0.25);
/// Cells across a border that tell where the surface goes on.
const PASTED: f64 = 6.0;
/// How far distances are told, in cells.
const REACH: f64 = 5.0;

/// The texture, understood.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) axes: Axes,
    pub(crate) points: OrientedPoints,
    pub(crate) variations: Vec<f32>,
    pub(crate) colours: Option<Vec<[f64; 3]>>,
    pub(crate) radii: Option<Vec<f64>>,
    pub(crate) groups: Option<Vec<i32>>,
    pub(crate) spacing: f64,
    pub(crate) radius: f64,
    /// Whether it lies over its plane as one sheet, as a height field does; and whether that is high for a patch.
    pub(crate) is_sheet: bool,
    pub(crate) is_high: bool,
    /// The box of the texture proper.
    pub(crate) bounds: Bounds<3>,
    pub(crate) lattice: Lattice,
    /// Corner of the field.
    pub(crate) origin: [f64; 2],
    pub(crate) field: Field,
    pub(crate) searcher: Option<Searcher>,
    pub(crate) repetition: Repetition,
    /// Cells along the side of a patch, of the overlap and of the border.
    pub(crate) patch: usize,
    pub(crate) overlap: usize,
    pub(crate) border: usize,
    /// Where patches may be taken from, row by row.
    pub(crate) places: Vec<[u32; 2]>,
    pub(crate) pieces: Pieces,
    /// The gap, where there is one to be filled.
    pub(crate) gap: Option<Gap>,
    /// What of its box is bare, so that no patch is taken from there.
    bare: Option<Gap>,
    pub(crate) warnings: Vec<Warning>,
    _held: Held,
}

impl Texture {
    /// Understands a texture. `bounds` is the box of the texture proper, in the axes of the file, where it is known.
    pub(crate) fn new(
        points: &PointSet<3>,
        (bounds, has_gap): (Option<Bounds<3>>, bool),
        params: &ReliefParams,
        budget: &Budget,
    ) -> Result<Self> {
        let mut warnings = Vec::new();
        let scattered = checked(points, budget)?;
        let set = oriented(scattered, budget, &mut warnings)?;
        let axes = axes((scattered, &set.positions), (params.plane, bounds.is_some(), has_gap), &mut warnings)?;
        let held = budget.hold("the texture", set.len() * 160)?;
        let positions: Vec<_> = set.positions.iter().map(|&p| axes.level(p)).collect();
        let normals: Vec<_> = set.normals.iter().flatten().map(|&n| axes.level(n)).collect();
        let spacing = spacing_of(&positions, budget)?;
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(fail("most points lie in one place", "give points that are spread over a surface"));
        }
        let radius = RADIUS * spacing;
        let all = Bounds::around(positions.iter().copied());
        let (points, contradicted) =
            surface(positions, (normals, scattered.normals.is_none()), (spacing, radius), budget)?;
        warnings.extend(told(contradicted, scattered.normals.is_none())?);
        let lattice = lattice(&all, spacing, params);
        let nodes = [0, 1].map(|k| (all.size()[k] / lattice.cell).floor() as usize);
        if nodes.iter().fold(lattice.heights.len(), |all, n| all.saturating_mul(*n)) > NODES {
            let least = (all.size()[0] * all.size()[1] * lattice.heights.len() as f64 / NODES as f64).sqrt();
            return Err(Error::parameter(
                "cell",
                lattice.cell,
                format!("at least {least:.4}, so that the field has at most {NODES} nodes"),
            ));
        }
        let origin = [0, 1].map(|k| all.min[k] + 0.5 * (all.size()[k] - nodes[k] as f64 * lattice.cell));
        let mut field = Field::new(&points, &lattice, origin, (nodes[0], nodes[1]), budget)?;
        let gap = if has_gap { Some(Gap::find(points.positions(), &all, spacing, budget)?) } else { None };
        let seeks_bare = !has_gap && bounds.is_none();
        let bare = if seeks_bare { Gap::bare(points.positions(), &all, spacing, budget)? } else { None };
        if let Some(empty) = gap.as_ref().or(bare.as_ref()) {
            field.leave_out(&lattice, |x, y| empty.contains(origin[0] + x, origin[1] + y));
        }
        let repetition = repetition(&field, budget)?;
        // What repeats is told by the shape alone: stones of a bond may have any colour.
        if let Some(colours) = &set.colours {
            field.add_colours(&points, colours, (&lattice, origin), budget)?;
        }
        budget.spend(points.len() as u64 * 900)?;
        let variations: Vec<f32> = points.variations();
        let upright = points.normals().iter().filter(|n| n[2] > UPRIGHT).count();
        let mut texture = Self {
            is_sheet: upright as f64 >= SHEET * points.len() as f64,
            is_high: false,
            axes,
            points,
            variations,
            colours: set.colours,
            radii: set.radii,
            groups: set.groups,
            spacing,
            radius,
            bounds: all,
            lattice,
            origin,
            field,
            searcher: None,
            repetition,
            patch: 0,
            overlap: 0,
            border: 0,
            places: Vec::new(),
            pieces: Pieces::default(),
            gap,
            bare,
            warnings,
            _held: held,
        };
        let given = bounds.map(|b| Bounds::around([axes.lie(b.min), axes.lie(b.max)]));
        texture.settle(&all, given, params)?;
        texture.pieces = Pieces::find(&texture.points, spacing, texture.patch_side(), budget)?;
        texture.searcher = texture.prepared_search(params.search, budget)?;
        Ok(texture)
    }

    /// The field prepared for searches, where that pays.
    fn prepared_search(&self, search: Search, budget: &Budget) -> Result<Option<Searcher>> {
        let (places, nodes) = (self.places.len(), self.patch * self.overlap);
        let wants = match search {
            Search::Auto => Searcher::is_faster(&self.field, places, nodes),
            Search::Fft => true,
            Search::Exhaustive => false,
        };
        Ok(if wants { Some(Searcher::new(&self.field, budget)?) } else { None })
    }

    /// Settles the patch: the usual one, or a smaller one where there is a gap, or where much of the box is bare.
    fn settle(&mut self, all: &Bounds<3>, given: Option<Bounds<3>>, params: &ReliefParams) -> Result<()> {
        let mut shrink = 1.0;
        loop {
            self.divide(all, given, params, shrink)?;
            if self.beside_gap() {
                break;
            }
            // Beside a gap there may be room for smaller patches only.
            let side = self.patch_side();
            let (is_given, cell) = (params.patch.is_some(), self.lattice.cell);
            if (is_given || 0.85 * side < 10.0 * cell) && self.places.len() >= ENOUGH {
                break;
            }
            if is_given || 0.85 * side < 6.0 * cell || self.bare.is_some() && shrink < SMALLEST {
                if self.bare.take().is_some() {
                    let message = "parts of its box are bare, and beside them there is no room for patches";
                    self.warnings.push(Warning::new(
                        message,
                        "say with --box which part of it is the texture, or give a smaller --patch",
                    ));
                    shrink = 1.0;
                    continue;
                }
                return Err(fail(
                    format!("beside the gap there is no room for patches of {side:.4}"),
                    "give a smaller patch, or a larger scan",
                ));
            }
            shrink *= 0.85;
        }
        Ok(())
    }

    /// Settles the patch, the box and the places that patches are taken from.
    fn divide(&mut self, all: &Bounds<3>, given: Option<Bounds<3>>, params: &ReliefParams, shrink: f64) -> Result<()> {
        let cell = self.lattice.cell;
        let short = all.size()[0].min(all.size()[1]);
        let room = given.map_or(short, |b| b.size()[0].min(b.size()[1]));
        given.map_or(Ok(()), |given| check_box(&given, all))?;
        let chosen = params.patch.unwrap_or_else(|| shrink * self.usual_patch(room));
        let patch = (chosen / cell).round().max(LEAST);
        if params.patch.is_some() && chosen < (LEAST - 0.5) * cell {
            self.tell_enlarged(chosen);
        }
        if params.patch.is_some() && chosen > room {
            return Err(Error::parameter(
                "patch",
                chosen,
                format!("at most {:.4}, a good part of the box of the texture, which is {room:.4} wide", 0.6 * room),
            ));
        }
        // What is missing of a border at the edge of the texture is hardly missed, but there have to be points that may be moved in.
        let margin = match given {
            Some(_) => 0.0,
            None => ((0.5 * params.reach * patch + 2.0) * cell).min(0.2 * short),
        };
        let inner = given.unwrap_or(Bounds::new(
            Vector([all.min[0] + margin, all.min[1] + margin, all.min[2]]),
            Vector([all.max[0] - margin, all.max[1] - margin, all.max[2]]),
        ));
        self.bounds = Bounds::new(
            Vector([inner.min[0], inner.min[1], all.min[2]]),
            Vector([inner.max[0], inner.max[1], all.max[2]]),
        );
        self.surround(patch, all.size()[2], params);
        let limits = |k: usize| {
            let low = ((self.bounds.min[k] - self.origin[k]) / cell - 1e-6).ceil().max(0.0);
            let high = ((self.bounds.max[k] - self.origin[k]) / cell + 1e-6)
                .floor()
                .min([self.field.width, self.field.height][k] as f64)
                - patch;
            (low, high)
        };
        let ((x0, x1), (y0, y1)) = (limits(0), limits(1));
        if x1 < x0 || y1 < y0 {
            let side = self.bounds.size();
            if params.patch.is_none() {
                let problem =
                    format!("no room for a patch in its box, which is {} by {}", rounded(side[0]), rounded(side[1]));
                return Err(fail(
                    problem,
                    "give more points, leave out those that lie far from all others, or say with --patch how large patches are",
                ));
            }
            return Err(Error::parameter(
                "patch",
                format!("{:.4}", patch * cell),
                format!(
                    "a patch smaller than the box of the texture, which is {:.4} by {:.4}, or a larger texture",
                    side[0], side[1]
                ),
            ));
        }
        let inside = self.count_in(&self.bounds.clone());
        let each = inside as f64 * (patch * cell).powi(2) / (self.bounds.size()[0] * self.bounds.size()[1]);
        if each < 20.0 {
            return Err(fail(
                format!("a patch of {:.4} holds {each:.0} points", patch * cell),
                "give a texture with more points, or a larger patch",
            ));
        }
        let (x0, x1, y0, y1) = (x0 as u32, x1 as u32, y0 as u32, y1 as u32);
        self.places = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| [x, y])).collect();
        Ok(())
    }

    /// Tells that patches are larger than was asked for.
    fn tell_enlarged(&mut self, chosen: f64) {
        let message = format!("patches of {} are smaller than this texture can tell apart", rounded(chosen));
        let least = rounded(LEAST * self.lattice.cell);
        let advice = format!("they are {least} here; give a texture of more points for smaller ones");
        let warning = Warning::new(message, advice);
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Settles a patch of so many cells a side, and what of it lies over others.
    fn surround(&mut self, patch: f64, height: f64, params: &ReliefParams) {
        self.patch = patch as usize;
        let mean = self.variations.iter().map(|v| f64::from(*v)).sum::<f64>() / self.variations.len() as f64;
        // Where there are edges, blending does more harm than steps do.
        let widest = if mean < SMOOTH { OVERLAP.1 } else { OVERLAP.0 };
        let usual = (OVERLAPPED / patch).clamp(OVERLAP.0, widest);
        // High sheets climb to one another over a wider part.
        let more = height / (patch * self.lattice.cell) - LOW;
        self.is_high = self.is_sheet && more > 0.0;
        let climb = if self.is_high { (CLIMB * more).min(OVERLAP_OF_SHEETS) } else { 0.0 };
        let overlap = params.overlap.unwrap_or(usual.max(climb));
        self.overlap = ((overlap * patch).round() as usize).clamp(2, self.patch / 2);
        let border = params.border.unwrap_or_else(|| (PASTED / patch).clamp(BORDER.0, BORDER.1));
        self.border = (border * patch).ceil() as usize;
    }

    /// Leaves out the places whose patches meet the gap; whether enough are left.
    fn beside_gap(&mut self) -> bool {
        let Some(gap) = self.gap.as_ref().or(self.bare.as_ref()) else { return true };
        let side = self.patch_side();
        let is_whole = |place: &[u32; 2]| {
            let corner = self.corner(*place);
            !gap.meets([corner[0], corner[1]], [corner[0] + side, corner[1] + side])
        };
        let places: Vec<_> = self.places.iter().filter(|p| is_whole(p)).copied().collect();
        self.places = places;
        // There has to be a place for every way in which what repeats may meet the gap.
        let is_gap = self.gap.is_some();
        let repeats = self.repetition.length.filter(|_| is_gap).map_or(0.0, |length| 1.5 * length * length);
        let goes_on = |repeat: &Repeat| repeat.is_covered(&self.places);
        let every_way = self.repetition.repeat.as_ref().filter(|_| is_gap).is_none_or(goes_on);
        self.places.len() >= ENOUGH.max(repeats as usize) && every_way
    }

    fn count_in(&self, bounds: &Bounds<3>) -> usize {
        let mut count = 0;
        self.points.inside(bounds, |_| count += 1);
        count
    }

    /// The patch for what repeats, within reason.
    fn usual_patch(&mut self, room: f64) -> f64 {
        let (least, most) = (8.0 * self.lattice.cell, 0.45 * room);
        let wanted = match self.repetition.length {
            Some(length) => 1.35 * length * self.lattice.cell,
            None => {
                let message = "the texture does not repeat itself: patches are a good third of it";
                let warning = Warning::new(message, "give the side of a patch with --patch, or a larger texture");
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
                0.4 * room
            }
        };
        wanted.max(0.4 * room).min(most).max(least)
    }

    /// Side of a patch.
    pub(crate) fn patch_side(&self) -> f64 {
        self.patch as f64 * self.lattice.cell
    }

    /// Point `i` where it is in the texture.
    pub(crate) fn sample(&self, i: usize) -> Sample {
        let (piece, from) = self.pieces.piece(i, self.points.positions()[i]);
        Sample {
            at: self.points.positions()[i],
            normal: self.points.normals()[i],
            colour: self.colours.as_ref().map_or([0.0; 3], |c| c[i].map(|v| v as f32)),
            variation: self.variations[i],
            source: i as u32,
            is_at_seam: false,
            piece,
            from,
        }
    }

    /// Corner of the patch at a place.
    pub(crate) fn corner(&self, [x, y]: [u32; 2]) -> Vector<3> {
        Vector([
            self.origin[0] + f64::from(x) * self.lattice.cell,
            self.origin[1] + f64::from(y) * self.lattice.cell,
            0.0,
        ])
    }
}

/// The box of the texture proper has to lie within the points.
fn check_box(given: &Bounds<3>, all: &Bounds<3>) -> Result<()> {
    let slack = 1e-6 * all.size()[0].min(all.size()[1]);
    if (0..2).all(|k| given.min[k] >= all.min[k] - slack && given.max[k] <= all.max[k] + slack) {
        return Ok(());
    }
    let shown = |bounds: &Bounds<3>, k: usize| format!("{:.4}..{:.4}", bounds.min[k], bounds.max[k]);
    let (x, y) = (shown(all, 0), shown(all, 1));
    Err(Error::parameter(
        "box",
        format!("{} and {}", shown(given, 0), shown(given, 1)),
        format!("a box within the points, which reach over {x} and {y} along the plane"),
    ))
}

/// Where the nodes of the field are.
fn lattice(all: &Bounds<3>, spacing: f64, params: &ReliefParams) -> Lattice {
    let size = all.size();
    let cell = params.cell.unwrap_or_else(|| (CELL * spacing).max(size[0].max(size[1]) / CELLS));
    let step = cell.max(size[2] / ROWS);
    let rows = (size[2] / step).ceil().max(1.0);
    let low = all.centre()[2] - 0.5 * (rows - 1.0) * step;
    Lattice {
        cell,
        heights: (0..rows as usize).map(|k| low + k as f64 * step).collect(),
        reach: REACH * cell.max(0.5 * step),
    }
}
