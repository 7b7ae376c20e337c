//! The elements of a scene as nodes of its document, those of several meshes with a node below them for each.

use std::{collections::BTreeMap, ops::Range};

use arabesque_core::{Bounds, Budget, Error, Result, Vector};
use serde::Deserialize;
use serde_json::{Value, value::RawValue};

use super::{
    looks::{ADVICE, Looks},
    node::{NodeIn, NodeText, item, place as place_of, with_children, with_mesh},
};
use crate::{
    mesh::gltf::container::{RECIPE, chunks, container},
    placed::{
        ids::{numbers, runs},
        layout::{Changes, Item, Layout, PER_BYTE, PER_ITEM, PlacedFile, Replaced},
        splice::Splices,
    },
};

/// Where in `asset` the numbers of elements stand.
const IDS: &str = "arabesque ids";
/// Memory of a byte that is read.
const GROWTH: usize = 8;

/// A scene, with the elements in it.
#[derive(Debug)]
pub struct GlbElements {
    /// The document and the bytes of the file.
    text: String,
    binary: Vec<u8>,
    layout: Layout<3>,
    /// Every node, in order.
    pub(super) nodes: Vec<NodeText>,
    /// Index of the node of each element.
    of_item: Vec<usize>,
    spans: Spans,
}

/// Where things stand in the document.
#[derive(Debug)]
struct Spans {
    asset: Range<usize>,
    ids: Option<Range<usize>>,
    recipe: Option<Range<usize>>,
    nodes: Range<usize>,
    /// The list of nodes of the scene.
    shown: Range<usize>,
    meshes: Range<usize>,
    materials: Option<Range<usize>>,
}

#[derive(Deserialize)]
struct DocumentIn<'a> {
    #[serde(borrow)]
    asset: &'a RawValue,
    #[serde(borrow)]
    scenes: Vec<SceneIn<'a>>,
    #[serde(borrow)]
    nodes: &'a RawValue,
    #[serde(borrow)]
    meshes: &'a RawValue,
    #[serde(borrow, default)]
    materials: Option<&'a RawValue>,
    accessors: Vec<AccessorIn>,
}

#[derive(Deserialize)]
struct AssetIn<'a> {
    #[serde(borrow, default)]
    extras: BTreeMap<&'a str, &'a RawValue>,
}

#[derive(Deserialize)]
struct SceneIn<'a> {
    #[serde(borrow)]
    nodes: &'a RawValue,
    #[serde(default)]
    extras: Value,
}

#[derive(Deserialize)]
struct AccessorIn {
    #[serde(default)]
    min: Vec<f64>,
    #[serde(default)]
    max: Vec<f64>,
}

#[derive(Deserialize)]
struct MeshIn {
    primitives: Vec<PrimitiveIn>,
}

#[derive(Deserialize)]
struct PrimitiveIn {
    attributes: BTreeMap<String, usize>,
    #[serde(default)]
    mode: Option<u64>,
}

/// Where a value stands in the text that it was read from.
fn place(text: &str, raw: &RawValue) -> Range<usize> {
    let at = (raw.get().as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    at..at + raw.get().len()
}

impl GlbElements {
    /// The elements of a scene.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is no GLB, or has nodes that arabesque would not write; [`Error::Limit`] for too large a file.
    pub fn open(name: &str, bytes: &[u8], budget: &Budget) -> Result<Self> {
        let budget = budget.stage("reading elements");
        budget.spend(PER_BYTE.saturating_mul(bytes.len() as u64))?;
        let (document, binary) = chunks(name, bytes)?;
        let _held = budget.hold("nodes", document.len().saturating_mul(GROWTH))?;
        let text = std::str::from_utf8(document).map_err(|e| Error::input(name, e.to_string(), ADVICE))?;
        let text = text.trim_end_matches([' ', '\0']).to_owned();
        let broken = |e: serde_json::Error| Error::input(name, e.to_string(), ADVICE);
        let document: DocumentIn<'_> = serde_json::from_str(&text).map_err(broken)?;
        let asset: AssetIn<'_> = serde_json::from_str(document.asset.get()).map_err(broken)?;
        let raws: Vec<&RawValue> = serde_json::from_str(document.nodes.get()).map_err(broken)?;
        let meshes: Vec<MeshIn> = serde_json::from_str(document.meshes.get()).map_err(broken)?;
        budget.within(&format!("{name}: nodes"), raws.len(), ("nodes", budget.limits().nodes))?;
        let [scene] = &document.scenes[..] else {
            return Err(Error::input(name, "several scenes, or none", ADVICE));
        };
        let bounds: Vec<Option<Bounds<3>>> = meshes.iter().map(|mesh| bounds(mesh, &document.accessors)).collect();
        let mut file = Self {
            spans: Spans {
                asset: place(&text, document.asset),
                ids: asset.extras.get(IDS).map(|raw| place(&text, raw)),
                recipe: asset.extras.get(RECIPE).map(|raw| place(&text, raw)),
                nodes: place(&text, document.nodes),
                shown: place(&text, scene.nodes),
                meshes: place(&text, document.meshes),
                materials: document.materials.map(|raw| place(&text, raw)),
            },
            layout: Layout {
                items: Vec::with_capacity(raws.len()),
                classes: Vec::new(),
                frame: frame(&scene.extras).unwrap_or(Bounds::EMPTY),
                is_tile: false,
                turns: true,
                paints: true,
                next: 0,
            },
            nodes: Vec::with_capacity(raws.len()),
            of_item: Vec::with_capacity(raws.len()),
            binary: binary.to_vec(),
            text: String::new(),
        };
        file.read_nodes((name, &text), &raws, &bounds, &budget)?;
        if file.layout.items.is_empty() {
            return Err(Error::input(name, "a scene without meshes", "edit a result that has elements"));
        }
        let ids = asset.extras.get(IDS).and_then(|raw| serde_json::from_str::<String>(raw.get()).ok());
        if let Some(ids) = ids.and_then(|ids| numbers(&ids, file.layout.items.len())) {
            file.layout.items.iter_mut().zip(ids).for_each(|(item, id)| item.id = id);
        }
        file.layout.next = file.layout.items.iter().map(|item| item.id + 1).max().unwrap_or(0);
        file.text = text;
        Ok(file)
    }
}

impl GlbElements {
    /// Takes down the nodes of a document, and the elements that they are.
    fn read_nodes(
        &mut self,
        (name, text): (&str, &str),
        raws: &[&RawValue],
        bounds: &[Option<Bounds<3>>],
        budget: &Budget,
    ) -> Result<()> {
        let refused = |number: usize, what: String| Error::input(format!("{name}: node {number}"), what, ADVICE);
        let (mut boxes, mut places) = (Vec::with_capacity(raws.len()), Vec::with_capacity(raws.len()));
        let mut is_below = vec![false; raws.len()];
        for (number, raw) in raws.iter().enumerate() {
            budget.spend(PER_ITEM)?;
            let node: NodeIn<'_> = serde_json::from_str(raw.get()).map_err(|e| refused(number, e.to_string()))?;
            let own = node.mesh.and_then(|mesh| bounds.get(mesh).copied().flatten());
            let text = NodeText::new(place(text, raw), &node, own)
                .ok_or_else(|| refused(number, "a rotation that is none".into()))?;
            let at = place_of(&node, &text, budget.limits().coordinate).ok_or_else(|| {
                refused(
                    number,
                    "a place that is not finite, beyond the limit of coordinates (--limit coordinate), or stretched"
                        .into(),
                )
            })?;
            if node.mesh.is_some() != node.children.is_empty() {
                return Err(refused(number, "neither a mesh nor nodes below it, or both".into()));
            }
            for &child in &node.children {
                match is_below.get_mut(child).filter(|_| child != number) {
                    Some(below) => *below = true,
                    None => return Err(refused(number, format!("node {child} below it, which does not exist"))),
                }
            }
            boxes.push(own);
            places.push(at);
            self.nodes.push(text);
        }
        let mut known = BTreeMap::new();
        for number in (0..raws.len()).filter(|&number| !is_below[number]) {
            budget.spend(PER_ITEM)?;
            let children = &self.nodes[number].children;
            if children.iter().any(|&child| !self.nodes[child].children.is_empty()) {
                return Err(refused(number, "nodes below nodes below it".into()));
            }
            let below = |all: Bounds<3>, &child: &usize| match &boxes[child] {
                Some(own) => all.union(&moved_box(own, &places[child])),
                None => all,
            };
            let whole = children.iter().fold(Bounds::EMPTY, below);
            let Some(own) = boxes[number].or(Some(whole).filter(|whole| !whole.is_empty())) else { continue };
            let (item, class) = item(&self.nodes[number], places[number], own);
            let class = *known.entry(class).or_insert_with_key(|class: &String| {
                self.layout.classes.push(class.clone());
                self.layout.classes.len() - 1
            });
            self.layout.items.push(Item { id: self.of_item.len(), class, ..item });
            self.of_item.push(number);
        }
        Ok(())
    }

    /// The text of a node as it is, or as an element that is changed, and those of the nodes below it.
    fn texts(&self, number: usize, replaced: Option<(&Item<3>, &Replaced<3>)>, looks: &mut Looks) -> Result<Texts> {
        let node = &self.nodes[number];
        let own = |n: usize| &self.text[self.nodes[n].range.clone()];
        let mut below = Vec::with_capacity(node.children.len());
        for &child in &node.children {
            let mesh = match (replaced, self.nodes[child].mesh) {
                (Some((_, replaced)), Some(mesh)) => {
                    Some(looks.painted(mesh, &replaced.paint)?).filter(|new| *new != mesh)
                }
                _ => None,
            };
            below.push(mesh.and_then(|mesh| with_mesh(own(child), mesh)).unwrap_or_else(|| own(child).to_owned()));
        }
        let Some((item, replaced)) = replaced else { return Ok((own(number).to_owned(), below)) };
        let mesh = node.mesh.map(|mesh| looks.painted(mesh, &replaced.paint)).transpose()?;
        Ok((node.moved(item, replaced, mesh), below))
    }
}

/// The text of a node, and those of the nodes below it.
type Texts = (String, Vec<String>);

/// The box around a box in another place.
fn moved_box(own: &Bounds<3>, place: &arabesque_core::Similarity<3>) -> Bounds<3> {
    let corner = |k: u8| Vector([0, 1, 2].map(|a| if k >> a & 1 == 1 { own.max[a] } else { own.min[a] }));
    Bounds::around((0..8).map(|k| place.apply(corner(k))))
}

/// All nodes in order, those below others behind the rest, and how many are not below others.
fn in_order(all: Vec<Texts>) -> Result<(Vec<String>, usize)> {
    let top = all.len();
    let (mut texts, mut behind) = (Vec::with_capacity(top), Vec::new());
    for (text, below) in all {
        if below.is_empty() {
            texts.push(text);
            continue;
        }
        let first = top + behind.len();
        let missing = || Error::input("scene", "a node without the list of those below it", ADVICE);
        texts.push(with_children(&text, first..first + below.len()).ok_or_else(missing)?);
        behind.extend(below);
    }
    texts.extend(behind);
    Ok((texts, top))
}

impl PlacedFile<3> for GlbElements {
    fn layout(&self) -> &Layout<3> {
        &self.layout
    }

    fn rewritten(&self, changes: &Changes<3>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
        let budget = budget.stage("writing elements");
        budget.spend(PER_BYTE.saturating_mul((self.text.len() + self.binary.len()) as u64))?;
        let index = self.layout.numbers();
        let mut looks = Looks::new(&self.text, &self.spans.meshes, self.spans.materials.as_ref())?;
        let of_node: BTreeMap<usize, usize> = self.of_item.iter().enumerate().map(|(n, node)| (*node, n)).collect();
        let is_below = |all: &mut Vec<bool>, node: &NodeText| node.children.iter().for_each(|&child| all[child] = true);
        let mut below = vec![false; self.nodes.len()];
        self.nodes.iter().for_each(|node| is_below(&mut below, node));
        let (mut texts, mut ids) = (Vec::with_capacity(self.nodes.len()), Vec::new());
        for number in (0..self.nodes.len()).filter(|&number| !below[number]) {
            let item = of_node.get(&number).map(|n| &self.layout.items[*n]);
            if item.is_some_and(|item| changes.removed.contains(&item.id)) {
                continue;
            }
            ids.extend(item.map(|item| item.id));
            budget.spend(PER_ITEM)?;
            let replaced = item.and_then(|item| Some((item, changes.replaced.get(&item.id)?)));
            texts.push(self.texts(number, replaced, &mut looks)?);
        }
        for (id, inserted) in &changes.inserted {
            budget.spend(PER_ITEM)?;
            let missing =
                || Error::input("changes", format!("no element {}", inserted.base), "name an element of the file");
            let number = *index.get(&inserted.base).ok_or_else(missing)?;
            let replaced = Some((&self.layout.items[number], inserted));
            texts.push(self.texts(self.of_item[number], replaced, &mut looks)?);
            ids.push(*id);
        }
        let (texts, top) = in_order(texts)?;
        let mut splices = Splices::default();
        looks.write(&self.spans.meshes, self.spans.materials.as_ref(), &mut splices);
        let shown: Vec<String> = (0..top).map(|n| n.to_string()).collect();
        splices.put(self.spans.nodes.clone(), format!("[{}]", texts.join(",")));
        splices.put(self.spans.shown.clone(), format!("[{}]", shown.join(",")));
        self.say(&ids, recipe, &mut splices)?;
        let text = splices.apply(&self.text);
        let document = RawValue::from_string(text).map_err(|e| Error::input("scene", e.to_string(), ADVICE))?;
        container(&document, &self.binary, "insert fewer elements")
    }
}

impl GlbElements {
    /// Puts the numbers of elements and the recipe into the asset.
    fn say(&self, ids: &[usize], recipe: Option<&str>, splices: &mut Splices) -> Result<()> {
        if let (Some(range), Some(recipe)) = (&self.spans.recipe, recipe) {
            let text = serde_json::to_string(recipe).map_err(|e| Error::input("recipe", e.to_string(), ADVICE))?;
            splices.put(range.clone(), text);
        }
        let said = runs(ids).map(|runs| format!("\"{runs}\""));
        match (said, &self.spans.ids, &self.spans.recipe) {
            (Some(said), Some(range), _) => splices.put(range.clone(), said),
            (Some(said), None, Some(recipe)) => {
                let name = self.text[..recipe.start].rfind('"').and_then(|end| self.text[..end].rfind('"'));
                let name = name.unwrap_or(recipe.start);
                splices.put(name..name, format!("\"{IDS}\":{said},"));
            }
            (Some(said), None, None) => {
                let at = self.spans.asset.start + 1;
                splices.put(at..at, format!("\"extras\":{{\"{IDS}\":{said}}},"));
            }
            (None, Some(range), _) => splices.put(range.clone(), "\"\""),
            (None, None, _) => {}
        }
        Ok(())
    }
}

/// The box around a mesh of triangles.
fn bounds(mesh: &MeshIn, accessors: &[AccessorIn]) -> Option<Bounds<3>> {
    let mut all = Bounds::EMPTY;
    for primitive in &mesh.primitives {
        if primitive.mode.is_some_and(|mode| mode < 4) {
            return None;
        }
        let accessor = accessors.get(*primitive.attributes.get("POSITION")?)?;
        let corner = |list: &[f64]| Some(Vector(<[f64; 3]>::try_from(list).ok()?)).filter(|corner| corner.is_finite());
        all = all.union(&Bounds::new(corner(&accessor.min)?, corner(&accessor.max)?));
    }
    (!all.is_empty()).then_some(all)
}

/// The box that a scene says it fills.
fn frame(extras: &Value) -> Option<Bounds<3>> {
    let corner = |k: usize| -> Option<Vector<3>> {
        let list: Vec<f64> = extras.get("box")?.get(k)?.as_array()?.iter().filter_map(Value::as_f64).collect();
        Some(Vector(list.try_into().ok()?))
    };
    corner(0).zip(corner(1)).filter(|(a, b)| (0..3).all(|k| a[k] < b[k])).map(|(a, b)| Bounds::new(a, b))
}
