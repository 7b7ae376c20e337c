//! Editing a result in two steps: what would change, and the change.

use arabesque_core::{Budget, Error, Result};
use arabesque_io::file;
use serde::Serialize;

use super::{
    elements::{AnyChanges, Elements},
    resolve::{Resolved, resolve},
};
use crate::{
    artwork::{Artwork, Sheet},
    plane::drawn,
    recipe::{Edit, Format, OutputOptions, Recipe, carried_recipe},
    resources::Resources,
};

/// An element of a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlacedItem {
    /// Its number, by which edits name it.
    pub id: usize,
    /// Its class.
    pub class: String,
    /// Its centre, in the units of the page: two coordinates in the plane, three in space.
    pub centre: Vec<f64>,
    /// How it is turned against the exemplar, in degrees from x towards y; of the plane alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// How large it is against the exemplar.
    pub scale: f64,
    /// Whether it is one that the user placed: an edit does not spread to it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub kept: bool,
}

/// An element that an edit would change, delete or insert.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Its number.
    pub id: usize,
    /// Its class, from then on.
    pub class: String,
    /// Where its centre was; nowhere, where it is new.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<Vec<f64>>,
    /// Where its centre is from then on; nowhere, where it is deleted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<Vec<f64>>,
    /// How far it reaches from there; 0 where the file does not say.
    #[serde(skip)]
    pub reach: f64,
    /// How unlike its neighbourhood is to that of the element that was named, in mean spacings.
    pub distance: f64,
}

/// What an edit would change. It is a token for [`EditSession::apply`], as long as nothing else was applied.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The elements, in their order of drawing; inserted ones last.
    pub changed: Vec<Change>,
    edit: Edit,
    changes: AnyChanges,
    /// The state that it was made for.
    of: String,
}

/// A result that is edited: the file, as often as wanted, without the run that made it.
///
/// ```
/// use arabesque::{Edit, EditSession, Fill, Format, Input, OutputOptions, Recipe, Resources, Unobserved};
///
/// let grid: String = (0..36).map(|k| format!("{},{},dot\n", k % 6, k / 6)).collect();
/// let recipe = Recipe::new(Input::file("grid.csv").embedding(("x,y,class\n".to_owned() + &grid).as_bytes()), Fill::page("9x9".parse()?));
/// let prepared = recipe.prepare(&Resources::default())?;
/// let artwork = prepared.run(&prepared.request(), &mut Unobserved)?;
/// let mut session = artwork.edit(&OutputOptions::default(), &Resources::default())?;
/// let edit = Edit { shift: vec![0.25, 0.0], propagate: Some(0.1), ..Edit::of_items([40]) };
/// let proposal = session.propose(&edit)?;
/// assert_eq!(proposal.changed.len(), session.items().len());
/// session.apply(&proposal)?;
/// assert!(session.apply(&proposal).is_err(), "it is of the state before");
/// assert_eq!(session.recipe().map_or(0, |recipe| recipe.edits.len()), 1);
/// # Ok::<(), arabesque::Error>(())
/// ```
#[derive(Debug)]
pub struct EditSession {
    name: String,
    bytes: Vec<u8>,
    format: Format,
    elements: Elements,
    recipe: Option<Recipe>,
    budget: Budget,
}

impl Proposal {
    pub(super) fn changes(&self) -> &AnyChanges {
        &self.changes
    }
}

impl EditSession {
    pub(super) fn elements(&self) -> &Elements {
        &self.elements
    }

    pub(super) fn budget(&self) -> &Budget {
        &self.budget
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// A result as its file has it; `name` is that of the file, for messages and for what its ending says.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is no result or has no elements, [`Error::Unsupported`] for formats that do not say where each
    /// element is, [`Error::Limit`] when a limit is reached.
    pub fn open(name: &str, bytes: Vec<u8>, resources: &Resources) -> Result<Self> {
        let budget = resources.budget();
        let format = format_of(name, &bytes);
        let recipe = match carried_recipe(name, &bytes) {
            Ok((_, crate::Carrier::Recipe)) => {
                let advice = "run it first: arabesque run RECIPE -o RESULT, and edit the result";
                return Err(Error::input(name, "a recipe, where a result was expected", advice));
            }
            Ok((recipe, _)) => Some(recipe),
            // Results may be written without one.
            Err(Error::Input { problem, .. }) if problem.ends_with("without a recipe") => None,
            Err(error) => return Err(error),
        };
        let elements = Elements::open(name, &bytes, format, recipe.as_ref(), &budget)?;
        Ok(Self { name: name.to_owned(), bytes, format, elements, recipe, budget })
    }

    /// Millions of units of work that reading and editing took so far.
    pub fn work(&self) -> u64 {
        self.budget.millions()
    }

    /// The format of the file.
    pub fn format(&self) -> Format {
        self.format
    }

    /// The recipe of the file with all edits, where it has one.
    pub fn recipe(&self) -> Option<&Recipe> {
        self.recipe.as_ref()
    }

    /// The file as it is now.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The file as it is now in a format: its own, which is the default, or for SVG also PNG, as its recipe says how large.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for other formats; those of drawing.
    pub fn encode(&self, format: Option<Format>) -> Result<Vec<u8>> {
        self.written(self.bytes.clone(), format)
    }

    /// A file of the format of this one, in another format.
    pub(super) fn written(&self, bytes: Vec<u8>, format: Option<Format>) -> Result<Vec<u8>> {
        match (self.format, format.unwrap_or(self.format), &self.elements) {
            (own, wanted, _) if own == wanted => Ok(bytes),
            (Format::Svg, Format::Png, Elements::Plane(placed)) => {
                let recipe = self.recipe.clone().map(|mut recipe| {
                    recipe.output.format = Some(Format::Png);
                    recipe
                });
                let output = recipe.as_ref().map(|recipe| recipe.output.clone()).unwrap_or_default();
                let recipe = recipe.as_ref().map(Recipe::to_toml).transpose()?;
                let budget = self.budget.fresh().stage("drawing");
                let recipe = recipe.as_deref();
                let sheet = Sheet {
                    format: Format::Png,
                    output: &output,
                    ran: &output,
                    recipe,
                    budget: &budget,
                    is_draft: false,
                };
                let svg = file::decode_text(&self.name, &bytes, &budget)?;
                Ok(drawn(&svg, placed.layout().frame.size().0, &sheet)?.bytes)
            }
            (own, wanted, _) => Err(Error::Unsupported {
                what: format!("writing an edited {} as {}", own.name(), wanted.name()),
                advice: format!(
                    "write it as {}; arabesque run makes other formats of that, with the edits",
                    own.name()
                ),
            }),
        }
    }

    /// How many coordinates places have: 2 or 3.
    pub fn dimension(&self) -> usize {
        self.elements.dimension()
    }

    /// The elements, in their order of drawing.
    pub fn items(&self) -> Vec<PlacedItem> {
        match &self.elements {
            Elements::Plane(file) => {
                let angle = |n: usize| Some(file.layout().items[n].place.rotation.angle().to_degrees());
                items(file.layout(), angle)
            }
            Elements::Space(file) => items(file.layout(), |_| None),
        }
    }

    /// The number of the element whose centre is nearest to a place; `None` where the place has another number of coordinates.
    pub fn nearest(&self, at: &[f64]) -> Option<usize> {
        let items = self.items();
        let square = |item: &PlacedItem| item.centre.iter().zip(at).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let near = items.iter().filter(|item| item.centre.len() == at.len());
        near.min_by(|a, b| square(a).total_cmp(&square(b))).map(|item| item.id)
    }

    /// What an edit would change. Nothing is run for that, and nothing changes yet.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an edit that contradicts itself, or names elements or classes that are not there; [`Error::Unsupported`] for
    /// what the file cannot say; [`Error::Limit`] when a limit is reached.
    pub fn propose(&self, edit: &Edit) -> Result<Proposal> {
        let budget = self.budget.fresh();
        let of = self.elements.fingerprint();
        // As text a scene is the same document.
        let on = if self.format == Format::Gltf { Format::Glb } else { self.format };
        let edit = Edit { on: Some(on), of: Some(of.clone()), ..edit.clone() };
        let (changed, changes) = match &self.elements {
            Elements::Plane(file) => told(resolve(&edit, file.layout(), &budget)?, AnyChanges::Plane),
            Elements::Space(file) => told(resolve(&edit, file.layout(), &budget)?, AnyChanges::Space),
        };
        Ok(Proposal { changed, edit, changes, of })
    }

    /// Makes the change of a proposal.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a proposal that was made before another change; those of writing.
    pub fn apply(&mut self, proposal: &Proposal) -> Result<()> {
        let budget = self.budget.fresh();
        if proposal.of != self.elements.fingerprint() {
            let expected = "one of the present state; propose the edit again";
            return Err(Error::parameter("proposal", "of a state before another change", expected));
        }
        let recipe = self.recipe.clone().map(|mut recipe| {
            recipe.edits.push(proposal.edit.clone());
            recipe
        });
        let text = recipe.as_ref().map(Recipe::to_toml).transpose()?;
        let bytes = self.elements.rewritten(&proposal.changes, text.as_deref(), &budget)?;
        self.elements = Elements::open(&self.name, &bytes, self.format, recipe.as_ref(), &budget)?;
        (self.bytes, self.recipe) = (bytes, recipe);
        Ok(())
    }
}

fn told<const D: usize>(
    resolved: Resolved<D>,
    any: impl FnOnce(arabesque_io::placed::Changes<D>) -> AnyChanges,
) -> (Vec<Change>, AnyChanges) {
    let changed = resolved.touched.into_iter().map(|touched| Change {
        id: touched.id,
        class: touched.class,
        from: touched.from.map(|p| p.0.to_vec()),
        to: touched.to.map(|p| p.0.to_vec()),
        reach: touched.reach,
        distance: touched.distance,
    });
    (changed.collect(), any(resolved.changes))
}

fn items<const D: usize>(
    layout: &arabesque_io::placed::Layout<D>,
    angle: impl Fn(usize) -> Option<f64>,
) -> Vec<PlacedItem> {
    let item = |(n, item): (usize, &arabesque_io::placed::Item<D>)| PlacedItem {
        id: item.id,
        class: layout.classes[item.class].clone(),
        centre: item.centre.0.to_vec(),
        angle: angle(n),
        scale: item.place.scale,
        kept: item.kept,
    };
    layout.items.iter().enumerate().map(item).collect()
}

/// The format of a result, by what it begins with.
fn format_of(name: &str, bytes: &[u8]) -> Format {
    let by_name = Format::of_path(name).ok().flatten();
    match bytes.trim_ascii_start() {
        [0x89, b'P', b'N', b'G', ..] => Format::Png,
        [b'g', b'l', b'T', b'F', ..] => Format::Glb,
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => Format::Ply,
        [b'<', ..] => Format::Svg,
        _ if file::is_packed(bytes) => Format::Svg,
        [b'{', ..] if by_name == Some(Format::Gltf) => Format::Gltf,
        [b'{', ..] => Format::Json,
        [b'x', b',', ..] => Format::Csv,
        _ => by_name.unwrap_or(Format::Toml),
    }
}

impl Artwork {
    /// The artwork as a file that can be edited, written as `output` says; the edits end in the recipe of that file. `resources` say within
    /// which limits.
    ///
    /// # Errors
    /// Those of [`Artwork::encode`] and of [`EditSession::open`].
    pub fn edit(&self, output: &OutputOptions, resources: &Resources) -> Result<EditSession> {
        let format = output.format.unwrap_or_else(|| self.usual_format());
        let encoded = self.encode(&OutputOptions { format: Some(format), ..output.clone() })?;
        EditSession::open(&format!("result.{}", format.name()), encoded.bytes, resources)
    }
}
