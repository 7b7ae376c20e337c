//! Files of results as elements in places.

use arabesque_core::{Budget, Error, Result};
use arabesque_io::{
    file,
    json::{
        broken::flaw,
        placed::{self as json, JsonElements},
    },
    mesh::gltf::{GlbElements, GltfElements},
    placed::{Changes, Layout, PlacedFile},
    svg::SvgElements,
    table::placed::{self as csv, CsvElements},
};

use crate::recipe::{Format, Job, Recipe};

/// The elements of a file, in the plane or in space.
#[derive(Debug)]
pub(crate) enum Elements {
    Plane(Box<dyn PlacedFile<2>>),
    Space(Box<dyn PlacedFile<3>>),
}

/// What changes in a file, in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum AnyChanges {
    Plane(Changes<2>),
    Space(Changes<3>),
}

/// The formats that can be edited, in words.
const EDITABLE: &str = "edit the result as SVG, JSON, CSV, GLB or glTF";

impl Elements {
    /// The elements of a file of that format; `recipe` says whether its page is a tile.
    pub(crate) fn open(
        name: &str,
        bytes: &[u8],
        format: Format,
        recipe: Option<&Recipe>,
        budget: &Budget,
    ) -> Result<Self> {
        let is_tile = recipe.is_some_and(is_tile);
        let text = || file::decode_text(name, bytes, budget);
        match format {
            Format::Svg => Ok(Self::Plane(Box::new(SvgElements::open(name, text()?, is_tile, budget)?))),
            Format::Csv => {
                let text = text()?;
                match csv::dimension(&text) {
                    Some(2) => Ok(Self::Plane(Box::new(CsvElements::open(name, text, None, budget)?))),
                    Some(_) => Ok(Self::Space(Box::new(CsvElements::open(name, text, None, budget)?))),
                    None => Err(Error::input(name, "a table that arabesque did not write", EDITABLE)),
                }
            }
            Format::Json => {
                let text = text()?;
                match json::dimension(&text) {
                    Some(2) => Ok(Self::Plane(Box::new(JsonElements::open(name, text, is_tile, budget)?))),
                    Some(_) => Ok(Self::Space(Box::new(JsonElements::open(name, text, is_tile, budget)?))),
                    None => Err(match flaw(&text) {
                        Some(flaw) => Error::input(name, flaw, "give the whole file, as it was written"),
                        None => {
                            let problem = "a JSON file without a page and placements on it";
                            Error::input(name, problem, "edit a scene of meshes as GLB")
                        }
                    }),
                }
            }
            Format::Glb => Ok(Self::Space(Box::new(GlbElements::open(name, bytes, budget)?))),
            Format::Gltf => Ok(Self::Space(Box::new(GltfElements::open(name, &text()?, budget)?))),
            Format::Png | Format::Obj | Format::Ply | Format::Usda | Format::Toml => Err(Error::Unsupported {
                what: format!("{name}: editing {}, which does not say where each element is,", format.name()),
                advice: EDITABLE.into(),
            }),
        }
    }

    /// How many coordinates places have.
    pub(crate) fn dimension(&self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }

    /// The file with these changes, and with another recipe where one is given.
    pub(crate) fn rewritten(&self, changes: &AnyChanges, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        match (self, changes) {
            (Self::Plane(file), AnyChanges::Plane(changes)) => file.rewritten(changes, recipe, budget),
            (Self::Space(file), AnyChanges::Space(changes)) => file.rewritten(changes, recipe, budget),
            _ => Err(Error::parameter("edit", "of the plane and of space", "one of the two")),
        }
    }

    /// A number that tells these elements from others.
    pub(crate) fn fingerprint(&self) -> String {
        match self {
            Self::Plane(file) => fingerprint(file.layout()),
            Self::Space(file) => fingerprint(file.layout()),
        }
    }
}

/// Whether what the recipe makes repeats without a seam.
fn is_tile(recipe: &Recipe) -> bool {
    matches!(&recipe.job, Job::Fill(fill) if fill.tile.is_some())
}

/// FNV-1a over numbers, classes and places.
fn fingerprint<const D: usize>(layout: &Layout<D>) -> String {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut take = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    };
    for item in &layout.items {
        take(&(item.id as u64).to_le_bytes());
        take(layout.classes[item.class].as_bytes());
        let place = &item.place;
        let numbers =
            place.translation.0.into_iter().chain(place.rotation.0.into_iter().flatten()).chain([place.scale]);
        // The sign of a zero tells nothing.
        numbers.for_each(|v| take(&(v + 0.0).to_bits().to_le_bytes()));
    }
    format!("{hash:032x}")
}
