//! Patterns by example: from one small example of a repeating pattern to as much of it as is wanted, in any shape.
//!
//! There is one door, whatever the method: a [`Recipe`] says what to read and which [`Job`] to do; [`Recipe::prepare`] reads the exemplar
//! and analyses it; [`Prepared::run`] carries out a [`Request`], as often as wanted; the [`Artwork`] that comes out is drawn, written and
//! counted. Fill a page:
//!
//! ```
//! use arabesque::{Fill, Input, OutputOptions, Recipe, Resources, Unobserved};
//!
//! let grid = b"x,y\n0,0\n1,0\n2,0\n0,1\n1,1\n2,1\n0,2\n1,2\n2,2\n";
//! let resources = Resources::default().with_input("grid.csv", &grid[..]);
//! let recipe = Recipe::new(Input::file("grid.csv"), Fill::page("6x6".parse()?));
//! let prepared = recipe.prepare(&resources)?;
//! let artwork = prepared.run(&prepared.request().with_seed(1), &mut Unobserved)?;
//! let file = artwork.encode(&OutputOptions::default())?;
//! assert!(file.bytes.starts_with(b"<?xml"));
//! # Ok::<(), arabesque::Error>(())
//! ```
//!
//! Fill a box in space:
//!
//! ```
//! use arabesque::{Format, Input, OutputOptions, Recipe, Resources, Space, Unobserved};
//!
//! let cube: String = (0..64).map(|k| format!("{},{},{}\n", k % 4, k / 4 % 4, k / 16)).collect();
//! let recipe = Recipe::new(Input::file("cube.csv").embedding(("x,y,z\n".to_owned() + &cube).as_bytes()), Space::new("5x5x5".parse()?));
//! let prepared = recipe.prepare(&Resources::default())?;
//! let artwork = prepared.run(&prepared.request(), &mut Unobserved)?;
//! assert!(artwork.summary().elements > 60);
//! let file = artwork.encode(&OutputOptions { format: Some(Format::Csv), ..OutputOptions::default() })?;
//! assert!(file.bytes.starts_with(b"x,y,z,class"));
//! # Ok::<(), arabesque::Error>(())
//! ```
//!
//! Lay a ribbon along a curve:
//!
//! ```
//! use arabesque::{Format, Input, OutputOptions, Recipe, Resources, Ribbon, Unobserved};
//!
//! let svg = |body: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' width='160' height='60' viewBox='0 0 160 60'>{body}</svg>");
//! let strip = svg("<rect y='26' width='160' height='8'/><circle cx='40' cy='30' r='20'/><circle cx='110' cy='30' r='14'/>");
//! let wave = svg("<path d='M5 30C50 0 110 60 155 30' fill='none' stroke='black'/>");
//! let resources = Resources::default().with_input("strip.svg", strip.into_bytes()).with_input("wave.svg", wave.into_bytes());
//! let recipe = Recipe::new(Input::file("strip.svg"), Ribbon { scale: Some(0.3), ..Ribbon::new(Input::file("wave.svg")) });
//! let prepared = recipe.prepare(&resources)?;
//! let artwork = prepared.run(&prepared.request(), &mut Unobserved)?;
//! let file = artwork.encode(&OutputOptions { format: Some(Format::Svg), ..OutputOptions::default() })?;
//! assert!(file.bytes.starts_with(b"<?xml"));
//! # Ok::<(), arabesque::Error>(())
//! ```
//!
//! Whoever watches a run gets [`Progress`] and, when wanted, the present state as an [`Artwork`]; see [`Watch`]. Files that carry a recipe
//! are read by [`recipe_in`]. The methods and their vocabulary are re-exported as [`core`], [`patterns`], [`ribbons`], [`structures`], [`reliefs`] and [`surfaces`], the file formats
//! as [`io`].

mod artwork;
mod edit;
mod exemplar;
mod inspect;
mod inspected;
mod measure;
mod method;
mod plane;
mod pool;
mod prepared;
mod recipe;
mod relief;
mod resources;
mod ribbon;
mod solid;
mod space;
mod spacing;
mod structure;
mod surface;

pub use arabesque_core as core;
pub use arabesque_io as io;
pub use arabesque_patterns as patterns;
pub use arabesque_reliefs as reliefs;
pub use arabesque_ribbons as ribbons;
pub use arabesque_structures as structures;
pub use arabesque_surface as surfaces;

pub use arabesque_core::suggest::nearest;
pub use arabesque_core::{
    Border, Budget, Cause, EnergyPoint, Error, Forecast, Limits, Progress, Result, Snapshot, StopReason, Stopper,
    Unobserved, Warning, Watch,
};
pub use arabesque_ribbons::Closing;
pub use artwork::{
    Artwork, Companion, Encoded, Geometry, PhysicsSummary, PlacedPoint, ReliefSummary, RibbonSummary, Summary,
};
pub use edit::{Change, EditSession, PlacedItem, Proposal};
pub use exemplar::LoadedExemplar;
pub use inspect::{ClassReport, RepeatReport, Report, StyleReport, UnderstoodReport};
pub use inspected::inspect;
pub use measure::{Family, FamilyFault, Measure, MeasureOptions, MeasureReport, Measurements, Verdict, measure};
pub use pool::in_pool;
pub use prepared::{Prepared, Request};
pub use recipe::{
    Carrier, Constraint, Cuboid, Deform, Direction, EMBEDDED_BYTES, Edit, Encoding, ExemplarTile, FieldFile,
    FieldSource, Fill, Format, Input, Insertion, Job, Method, OutputOptions, Parameters, Physics, Reading, Recipe,
    Redo, Region, Relief, Ribbon, Size, Space, Structures, Surface, Tile, Unit, Up, WidthSource, carried_recipe,
    is_result, recipe_in, ribbon_options,
};
pub use resources::Resources;
pub use space::is_scene_of_meshes;
