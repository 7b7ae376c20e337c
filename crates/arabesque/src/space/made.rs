//! Points and curves in space as files.

use std::{path::Path, sync::Arc};

use arabesque_core::{
    Bounds, EnergyPoint, Error, Exemplar, Matrix, Outcome, Result, Similarity, Snapshot, StopReason, Vector, Warning,
};
use arabesque_io::{
    file::is_standard_output,
    json::{
        self,
        placements::{PlacementsOptions, write_placements},
    },
    mesh::{
        gltf::{GltfOptions, Scene, read_scene, write_scene_with},
        obj,
        scene::{Convention, Up},
        usd::write_usda,
    },
    render::Item,
    table::{centres::write_centres_ply, csv},
};

use crate::{
    artwork::{Companion, Encoded, Geometry, Made, PhysicsSummary, PlacedPoint, Sheet, Summary, points},
    plane::{snapshot, unfinished},
    recipe::Format,
    solid::write::{Said, encode_mesh, picture},
    space::{
        scene::Bodies,
        skinned::{skinned, without_unused},
    },
    spacing::spacing,
};

/// How far a written polyline may lie from its curve, in mean spacings.
const CHORD: f64 = 0.005;

/// The ending of files of materials.
const MATERIALS: &str = "mtl";

/// The name of the file of materials beside a file; none for standard output.
fn materials_beside(path: &str) -> Option<String> {
    if is_standard_output(path) {
        return None;
    }
    Some(Path::new(path).with_extension(MATERIALS).file_name()?.to_string_lossy().into_owned())
}

/// What takes y to z, and z to the front.
const UPRIGHT: Matrix<3> = Matrix([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);

/// Points and curves in a box.
#[derive(Debug)]
pub(crate) struct VolumeMade {
    pub(crate) exemplar: Arc<Exemplar<3>>,
    /// The meshes of its elements, where it is a scene.
    pub(crate) bodies: Option<Arc<Bodies>>,
    /// The box.
    pub(crate) frame: Bounds<3>,
    /// Of the exemplar's file.
    pub(crate) convention: Convention,
    pub(crate) outcome: Outcome<3>,
    /// What physics did at the end, where it did.
    pub(crate) physics: Option<PhysicsSummary>,
}

impl VolumeMade {
    /// What a run has so far.
    pub(crate) fn of_snapshot(
        (exemplar, bodies): (&Arc<Exemplar<3>>, &Option<Arc<Bodies>>),
        (frame, convention): (Bounds<3>, Convention),
        snapshot: Snapshot<3>,
    ) -> Self {
        Self {
            exemplar: Arc::clone(exemplar),
            bodies: bodies.clone(),
            frame,
            convention,
            outcome: unfinished(snapshot),
            physics: None,
        }
    }

    /// Meshes in their places.
    fn scene(&self, bodies: &Bodies) -> Scene {
        let (placements, frame) = (&self.outcome.placements, Some(self.frame));
        if self.exemplar.softs.is_empty() {
            bodies.placed(placements, frame)
        } else {
            skinned(bodies, placements, frame)
        }
    }

    /// A scene as a file; `centre_lines` are those of elements that bend.
    fn encode_scene(&self, scene: Scene, centre_lines: &[Vec<Vector<3>>], sheet: &Sheet<'_>) -> Result<Encoded> {
        let budget = sheet.budget;
        match sheet.format {
            Format::Glb => {
                let scene = scene.converted(&self.convention, &Convention::default());
                let options = GltfOptions { recipe: sheet.recipe, instancing: sheet.output.instancing };
                Ok(Encoded {
                    bytes: write_scene_with(&scene, &options, budget)?,
                    warnings: Vec::new(),
                    companion: None,
                })
            }
            Format::Obj => {
                // What has a name has its materials in a file beside it.
                let mtl = sheet.output.path.as_deref().and_then(materials_beside);
                let written = obj::write_scene(&scene, mtl.as_deref(), sheet.recipe, budget)?;
                let companion = written.mtl.map(|text| Companion { ending: MATERIALS, bytes: text.into_bytes() });
                Ok(Encoded { bytes: written.obj.into_bytes(), warnings: written.warnings, companion })
            }
            Format::Usda => {
                let (text, warnings) = write_usda(&scene, &self.convention, sheet.recipe, budget)?;
                Ok(Encoded { bytes: text.into_bytes(), warnings, companion: None })
            }
            Format::Json => {
                let options = PlacementsOptions { recipe: sheet.recipe, centre_lines };
                let text = write_placements(&without_unused(scene), &options, budget)?;
                Ok(Encoded { bytes: text.into_bytes(), warnings: Vec::new(), companion: None })
            }
            Format::Ply if sheet.output.centres => {
                let text = write_centres_ply(&scene, sheet.recipe, budget)?;
                Ok(Encoded { bytes: text.into_bytes(), warnings: Vec::new(), companion: None })
            }
            Format::Png => {
                // Pictures have z up, scenes y.
                let rotation = if self.convention.up == Up::Y { UPRIGHT } else { Matrix::identity() };
                let upright = Similarity { rotation, ..Similarity::identity() };
                let places: Vec<Vec<_>> = (0..scene.meshes.len())
                    .map(|m| scene.places(m).iter().map(|place| upright.after(place)).collect())
                    .collect();
                let shown = scene.meshes.iter().zip(&places).filter(|(_, places)| !places.is_empty());
                let items: Vec<_> = shown.map(|(m, places)| Item::Placed(&m.mesh, places)).collect();
                picture(&items, sheet)
            }
            _ => {
                budget.within("triangles in all places", scene.triangles(), ("nodes", budget.limits().nodes))?;
                let mesh = Scene { warnings: Vec::new(), ..scene }.into_geometry("").into_mesh("")?;
                let said = Said { warnings: &self.outcome.warnings, stopped: self.outcome.stopped };
                encode_mesh(&mesh, sheet, said)
            }
        }
    }
}

impl Made for VolumeMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let (exemplar, outcome, frame) = (&*self.exemplar, &self.outcome, self.frame);
        if let Some(bodies) = &self.bodies
            && sheet.format != Format::Csv
        {
            let lines = self.outcome.placements.iter().map(|p| p.control.iter().map(|(_, to)| *to).collect());
            return self.encode_scene(self.scene(bodies), &lines.collect::<Vec<_>>(), sheet);
        }
        let (points, curves) = (outcome.placements.len(), outcome.curves.len());
        let (text, warnings) = match sheet.format {
            Format::Obj => {
                let page = obj::Sheet { frame, tolerance: CHORD * spacing(exemplar), recipe: sheet.recipe };
                let warnings = left_out([points, curves], ["points", "curves"])?;
                (obj::write_curves(exemplar, &outcome.curves, &page), warnings)
            }
            Format::Csv => {
                let extent = frame.size().0.into_iter().fold(0.0, f64::max);
                let warnings = left_out([curves, points], ["curves", "points"])?;
                (csv::write_points(exemplar, &outcome.placements, extent, sheet.recipe), warnings)
            }
            Format::Json => {
                let page = json::Frame { view: frame, unit: None, recipe: sheet.recipe };
                (json::write_json(exemplar, outcome, &page)?, Vec::new())
            }
            Format::Svg | Format::Png | Format::Glb | Format::Gltf | Format::Ply | Format::Usda | Format::Toml => {
                let what = format!("a result in space as {}", sheet.format.name());
                let advice = "write obj (curves), csv (points) or json (both)";
                return Err(Error::Unsupported { what, advice: advice.into() });
            }
        };
        Ok(Encoded { bytes: text.into_bytes(), warnings, companion: None })
    }

    fn drawn_from(&self, format: Format) -> Option<Format> {
        // Tables have the coordinates of the exemplar, and a GLB file may have others.
        let is_apart = format == Format::Csv && self.convention == Convention::default();
        (self.bodies.is_some() && format != Format::Glb && !is_apart).then_some(Format::Glb)
    }

    fn encode_edited(&self, edited: &[u8], sheet: &Sheet<'_>) -> Result<Encoded> {
        if sheet.format == Format::Csv {
            return Err(Error::Unsupported {
                what: "an edited scene of another unit or axis as CSV".into(),
                advice: "write GLB or JSON, or edit the CSV file".into(),
            });
        }
        let scene = read_scene("edited scene", edited, sheet.budget)?;
        self.encode_scene(scene.converted(&Convention::default(), &self.convention), &[], sheet)
    }

    fn summary(&self) -> Summary {
        Summary { physics: self.physics, ..Summary::of(&*self.exemplar, &self.outcome) }
    }

    fn geometry(&self) -> Geometry {
        Geometry::Space(snapshot(&self.outcome))
    }

    fn points(&self) -> Vec<PlacedPoint> {
        points(&self.exemplar, &self.outcome.placements)
    }

    fn warnings(&self) -> &[Warning] {
        &self.outcome.warnings
    }

    fn energy(&self) -> &[EnergyPoint] {
        &self.outcome.energy
    }

    fn stopped(&self) -> StopReason {
        self.outcome.stopped
    }
}

/// Tells that a format holds only the second of two kinds; an error where there is nothing of it.
fn left_out([lost, held]: [usize; 2], [what, kept]: [&str; 2]) -> Result<Vec<Warning>> {
    let message = format!("{lost} {what} in a file of {kept}");
    let advice = "write json, which holds both, or csv for points and obj for curves";
    match (lost, held) {
        (0, _) => Ok(Vec::new()),
        (_, 0) => Err(Error::Unsupported { what: message, advice: advice.into() }),
        _ => Ok(vec![Warning::new(format!("{message} cannot be written: left out"), advice)]),
    }
}
