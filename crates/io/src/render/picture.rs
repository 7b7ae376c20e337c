//! Pictures: what is drawn, how, and as which file.

use arabesque_core::{Bounds, Budget, Error, Image, Result, Similarity, TriangleMesh, Vector};
use rayon::prelude::*;

use super::{
    dabs::{self, Dab},
    frame::{FINE, Frame, Projection, Sample},
    light::Lamp,
    normals::corner_normals,
    occlusion::openness,
    palette::{CLAY, of_number},
    spacing::spacing,
    subject::{Cloud, Item, bytes},
    triangles::{self, Placed},
    view::{Axes, View},
};
use crate::{
    raster::{
        png,
        size::{Picture, checked_size, shrunk},
    },
    text::unit::{INCHES_PER_METRE, PIXELS_PER_INCH},
};

/// Free border, as a share of the side.
const BORDER: f64 = 0.04;
/// How far light is kept away by what is near, and by what forms hollows, as shares of the larger side.
const REACHES: [f32; 2] = [0.014, 0.06];
/// Radii of points without one, in mean distances to their neighbours: of those of a surface, which are to hide what is behind it, and
/// of others.
const SKIN: f64 = 0.57;
const BALL: f64 = 0.32;
/// Radius of points that are all in one place, in pixels.
const LONE: f64 = 8.0;
/// Work of shading one pixel.
const PER_PIXEL: u64 = 120;
/// Pixels of the longer side where nobody says.
const USUAL: usize = 1200;
/// The longer side is at most so many times as long as the shorter one.
const LONGEST: f64 = 4.0;

/// What is behind everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// White paper.
    #[default]
    White,
    /// Nothing.
    Transparent,
}

/// How large a picture is, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Width and height.
    Exactly([usize; 2]),
    /// The longer side; the other one as what is drawn has it, but at least a quarter.
    Longer(usize),
}

impl Default for Extent {
    fn default() -> Self {
        Self::Longer(USUAL)
    }
}

/// How a picture looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Where the eye stands; from above for points in the plane, else as [`View::default`], where nobody says.
    pub view: Option<View>,
    /// Its size.
    pub extent: Extent,
    /// What is behind everything.
    pub background: Background,
}

/// Draws things as PNG, with the recipe as every picture carries it ([`crate::raster::png::recipe_of`] finds it).
///
/// # Errors
/// As [`draw`].
pub fn write_picture(items: &[Item<'_>], look: &Look, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    write_picture_within(items, look, usize::MAX, recipe, budget).map(|picture| picture.bytes)
}

/// As [`write_picture`], but with `most` pixels, in the same proportion, where it would have more.
///
/// # Errors
/// As [`draw`].
pub fn write_picture_within(
    items: &[Item<'_>],
    look: &Look,
    most: usize,
    recipe: Option<&str>,
    budget: &Budget,
) -> Result<Picture> {
    let (image, wanted) = draw_within(items, look, most, budget)?;
    let bytes = png::write_image(&image, PIXELS_PER_INCH * INCHES_PER_METRE, recipe, budget)?;
    Ok(Picture { bytes, size: [image.width, image.height], wanted })
}

/// Draws things without perspective, so that they fill the picture but for a small border.
///
/// # Errors
/// [`Error::Input`] where there is nothing to draw; [`Error::Limit`] for more than [`arabesque_core::Limits::pixels`] pixels, or when the
/// work or the memory is used up; [`Error::Stopped`] when somebody asked to stop.
pub fn draw(items: &[Item<'_>], look: &Look, budget: &Budget) -> Result<Image> {
    draw_within(items, look, usize::MAX, budget).map(|(image, _)| image)
}

/// The same with so many pixels at most, and the size that was wanted.
fn draw_within(items: &[Item<'_>], look: &Look, most: usize, budget: &Budget) -> Result<(Image, [usize; 2])> {
    let budget = &budget.stage("drawing");
    let flat = items.iter().all(|item| matches!(item, Item::Plane(_)));
    let axes = Axes::of(look.view.unwrap_or(if flat { View::TOP } else { View::default() }));
    let clouds = clouds(items, budget)?;
    let seen = extent_of(items, &clouds, &axes, budget)?;
    if seen.is_empty() {
        return Err(Error::input("picture", "nothing to draw", "give points or a mesh"));
    }
    let wanted = size_of(look.extent, &seen, budget)?;
    let size = shrunk(wanted.map(|n| n as f64), most).map(|n| n as usize);
    let mut frame = Frame::empty(size, budget)?;
    let projection = Projection::fitted(axes, &seen, size, BORDER);
    for item in items {
        match item {
            Item::Mesh(mesh) => draw_mesh(mesh, &[Similarity::identity()], false, &projection, &mut frame, budget)?,
            Item::Placed(mesh, places) => draw_mesh(mesh, places, true, &projection, &mut frame, budget)?,
            Item::Points(_) | Item::Plane(_) => {}
        }
    }
    for (cloud, radius) in &clouds {
        dabs::draw(cloud.positions.len(), dab_of(cloud, *radius, &projection), &mut frame, budget)?;
    }
    Ok((shaded(&frame, &projection, look.background, budget)?, wanted))
}

/// The points among the items, with the radius of those that have none.
fn clouds<'a>(items: &[Item<'a>], budget: &Budget) -> Result<Vec<(Cloud<'a>, f64)>> {
    let mut clouds = Vec::new();
    for item in items {
        let cloud = match item {
            Item::Points(points) => Cloud::of_space(points),
            Item::Plane(points) => Cloud::of_plane(points),
            Item::Mesh(_) | Item::Placed(..) => continue,
        };
        let share = if cloud.normals.is_some() { SKIN } else { BALL };
        let radius = if cloud.radii.is_some() { 0.0 } else { share * spacing(&cloud.positions, budget)? };
        clouds.push((cloud, radius));
    }
    Ok(clouds)
}

/// The box around everything in the directions of the picture.
fn extent_of(items: &[Item<'_>], clouds: &[(Cloud<'_>, f64)], axes: &Axes, budget: &Budget) -> Result<Bounds<3>> {
    let mut seen = Bounds::EMPTY;
    for (cloud, radius) in clouds {
        budget.spend(10 * cloud.positions.len() as u64)?;
        for (n, p) in cloud.positions.iter().enumerate() {
            let around = Vector::splat(cloud.radii.map_or(*radius, |radii| radii[n]));
            let p = axes.turned(*p);
            seen = seen.joined(p - around).joined(p + around);
        }
    }
    for item in items {
        let (mesh, places) = match item {
            Item::Mesh(mesh) => (*mesh, &[Similarity::identity()][..]),
            Item::Placed(mesh, places) => (*mesh, *places),
            Item::Points(_) | Item::Plane(_) => continue,
        };
        // A vertex without triangles is not seen.
        let mut used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|v| used[*v as usize] = true);
        for place in places {
            budget.spend(30 * mesh.positions.len() as u64)?;
            let corners = mesh.positions.iter().zip(&used).filter(|(_, used)| **used);
            seen = corners.fold(seen, |seen, (p, _)| seen.joined(axes.turned(place.apply(*p))));
        }
    }
    Ok(seen)
}

fn size_of(extent: Extent, seen: &Bounds<3>, budget: &Budget) -> Result<[usize; 2]> {
    let size = match extent {
        Extent::Exactly(size) => size.map(|n| n as f64),
        Extent::Longer(longer) => {
            let longer = longer as f64;
            let [width, height] = [seen.size()[0], seen.size()[1]];
            let shorter = |share: f64| (longer * share.clamp(1.0 / LONGEST, 1.0)).round();
            let share = |a: f64, b: f64| if b > 0.0 { a / b } else { 1.0 };
            if width >= height {
                [longer, shorter(share(height, width))]
            } else {
                [shorter(share(width, height)), longer]
            }
        }
    };
    let size = size.map(|n| n.max(1.0));
    Ok(checked_size("size of the picture", size, budget, "ask for fewer pixels")?.map(|n| n as usize))
}

fn draw_mesh(
    mesh: &TriangleMesh,
    places: &[Similarity<3>],
    numbered: bool,
    projection: &Projection,
    frame: &mut Frame,
    budget: &Budget,
) -> Result<()> {
    let _held = budget.hold("directions of the mesh", mesh.triangles.len().saturating_mul(100))?;
    let normals = corner_normals(mesh, budget)?;
    let colours = mesh.colours.as_ref().filter(|c| c.len() == mesh.positions.len());
    let colour = |number: usize, v: u32| match colours {
        Some(colours) => bytes(colours[v as usize]),
        None if numbered => of_number(number as i32),
        None => CLAY,
    };
    triangles::draw(&Placed { mesh, places, normals: &normals, colour: &colour }, projection, frame, budget)
}

/// How point `n` is drawn.
fn dab_of<'a>(cloud: &'a Cloud<'_>, radius: f64, projection: &'a Projection) -> impl Fn(usize) -> Dab + Sync + 'a {
    let lone = LONE * FINE as f64;
    move |n| {
        let radius = cloud.radii.map_or(radius, |radii| radii[n]) * projection.scale;
        let normal = cloud.normals.filter(|_| cloud.radii.is_none()).map(|normals| normals[n]);
        Dab {
            place: projection.place(cloud.positions[n]),
            radius: if radius > 0.0 { radius } else { lone },
            // A direction without a length is none.
            normal: normal.filter(|n| *n != Vector::ZERO).map(|n| projection.axes.turned(n).0.map(|c| c as f32)),
            colour: cloud.colours[n],
        }
    }
}

fn shaded(frame: &Frame, projection: &Projection, background: Background, budget: &Budget) -> Result<Image> {
    let [width, height] = [frame.width / FINE, frame.height / FINE];
    let longer = width.max(height) as f32;
    let open = openness(frame, REACHES.map(|share| (share * longer).max(2.0)), budget)?;
    let up = projection.axes.turned(Vector([0.0, 0.0, 1.0])).0.map(|c| c as f32);
    let lamp = Lamp::new(up, depths(&frame.samples));
    let (mut pixels, _held) = budget.list("pixels of the picture", width.saturating_mul(height))?;
    pixels.resize(width * height, [0; 4]);
    pixels.par_chunks_mut(width).zip(open.par_chunks(width)).enumerate().try_for_each(|(y, (row, open))| {
        budget.spend(PER_PIXEL * width as u64)?;
        for (x, (shown, open)) in row.iter_mut().zip(open).enumerate() {
            let pixel = lamp.pixel(&frame.of_pixel(x, y), *open);
            *shown = if background == Background::White { lamp.on_white(pixel) } else { pixel };
        }
        Ok(())
    })?;
    budget.spend(0)?;
    Ok(Image { width, height, pixels })
}

/// Farthest and nearest of what is seen.
fn depths(samples: &[Sample]) -> [f32; 2] {
    let found = samples.par_iter().filter(|s| s.is_something()).map(|s| [s.depth; 2]);
    found.reduce(|| [f32::INFINITY, f32::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
