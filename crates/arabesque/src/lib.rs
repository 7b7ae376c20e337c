//! Patterns by example: from one small example of a repeating pattern to as much of it as is wanted, in any shape.
//!
//! ```
//! use arabesque::{Input, OutputOptions, Recipe, Unobserved};
//!
//! let points = b"x,y\n0,0\n1,0\n2,0\n0,1\n1,1\n2,1\n0,2\n1,2\n2,2\n";
//! let mut recipe = Recipe::new(Input::file("grid.csv").carrying(points));
//! recipe.size = Some("6x6".into());
//! let prepared = recipe.prepare(None)?;
//! let artwork = prepared.run(1, &mut Unobserved)?;
//! let file = artwork.encode(&OutputOptions::default())?;
//! assert!(file.bytes.starts_with(b"<?xml"));
//! # Ok::<(), arabesque::Error>(())
//! ```
//!
//! A [`Recipe`] describes a run; [`Recipe::prepare`] reads its files and analyses the exemplar; [`Prepared::run`] fills the domain, as often
//! as wanted; [`Artwork::encode`] makes the bytes of a file, which carries its recipe ([`recipe_in`] finds it again). The engine and its
//! vocabulary are re-exported as [`core`], [`patterns`] and [`ribbons`], the file formats as [`io`].

mod artwork;
mod carrier;
mod format;
mod input;
mod inspect;
mod pool;
mod prepare;
mod recipe;
mod region;
mod rework;
mod ribbon;
mod ribbon_files;
mod ribbon_picture;
mod ribbon_recipe;
mod size;
mod space;
mod spacing;
mod subject;

pub use arabesque_core as core;
pub use arabesque_io as io;
pub use arabesque_patterns as patterns;
pub use arabesque_ribbons as ribbons;

pub use arabesque_core::{
    EnergyPoint, Error, Limits, Observer, Outcome, Progress, Result, StopReason, Unobserved, Warning,
};
pub use arabesque_io::nearest::nearest;
pub use artwork::{Artwork, Encoded};
pub use carrier::recipe_in;
pub use format::Format;
pub use input::{EMBEDDED_BYTES, Encoding, Input};
pub use inspect::{ClassReport, Report, StyleReport, inspect};
pub use pool::in_pool;
pub use prepare::Prepared;
pub use recipe::{BorderRule, FieldFile, FieldSource, Method, OutputOptions, Recipe};
pub use region::Region;
pub use ribbon::{Laid, RibbonArtwork, RibbonPrepared};
pub use ribbon_recipe::{ClosingRule, RIBBON_OPTIONS, RibbonOption, RibbonRecipe, WidthSource};
pub use size::Size;
pub use space::{SpaceArtwork, SpacePrepared};
pub use subject::Subject;
