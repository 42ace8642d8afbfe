//! Simplifying scenes: how, as arguments; what is read, and what is written.

use crate::buffers::{BufferArgs, method_failed};
use crate::error::{ErrorAbout, Result, bail};
use crate::input;
use crate::named::one_of;
use crate::numbers::share;
use crate::output::{JsonSchema, Serialize, count};
use crate::surfaces::{self, SurfaceArgs};
use sightlines::bake::methods::{OcclusionMethod, OcclusionMethodFactory};
use sightlines::cells::{Scene, Unlike};
use sightlines::formats::scene::{
    self, Rounding, SceneReadOptions, read_scene_with_source_and, write_rounded_glb, write_simplified_obj,
};
use sightlines::formats::{GltfSource, SceneFile};
use sightlines::pvs::Table;
use sightlines::simplify::SimplifyError;
use sightlines::simplify::{Simplified, SimplifyOptions};
use sightlines::verify::along_frame;
use std::fmt;
use std::path::Path;

/// Whether a scene has faces of which engines draw the fronts only: a table takes their backs to be unseen. Displayed behind a promise
/// for every eye, as what that leaves out.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[serde(transparent)]
pub(crate) struct SingleSided(bool);

impl SingleSided {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self(!scene.single_sided().is_empty())
    }
}

impl fmt::Display for SingleSided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0 { " that sees the back of no single-sided face" } else { "" })
    }
}

/// How to simplify, as arguments.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct HowArgs {
    #[command(flatten)]
    pub(crate) surfaces: SurfaceArgs,
    /// Share of the sphere of directions in which the visible face may change, 0 to 1; 0 removes only what is hidden
    #[arg(long, help_heading = "Method", value_name = "SHARE", default_value_t = 0.0, value_parser = share, allow_hyphen_values = true)]
    budget: f64,
    /// Share of the budget for collapsing edges instead of removing triangles, 0 to 1
    #[arg(long, help_heading = "Method", value_name = "SHARE", default_value_t = SimplifyOptions::default().collapse)]
    #[arg(value_parser = share, allow_hyphen_values = true)]
    collapse: f64,
    /// Also merge coplanar triangles of an object, exactly: no surface changes; interpolated attributes such as texture
    /// coordinates stay the same only where they are linear
    #[arg(long, help_heading = "Method")]
    flat: bool,
    /// Ignore mirrors; otherwise scenes with mirrors are refused, because mirrors show hidden things
    #[arg(long, help_heading = "Method")]
    ignore_mirrors: bool,
    /// The method that proves triangles hidden, besides a table
    #[arg(long, help_heading = "Method", value_name = "HOW", default_value = OcclusionMethod::Multifocal.name(), value_parser = one_of(&method_choices(), choice_name, choice_about))]
    method: MethodChoice,
    #[command(flatten)]
    buffers: BufferArgs,
    /// Number of threads; 0 uses every core
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    pub(crate) threads: usize,
}

/// The method that proves triangles hidden, if any does besides the table.
type MethodChoice = Option<OcclusionMethod>;

/// All methods, and none.
fn method_choices() -> Vec<MethodChoice> {
    OcclusionMethod::ALL.into_iter().map(Some).chain([None]).collect()
}

fn choice_name(choice: MethodChoice) -> &'static str {
    choice.map_or("none", OcclusionMethod::name)
}

fn choice_about(choice: MethodChoice) -> &'static str {
    choice.map_or("Nothing but the table", OcclusionMethod::about)
}

impl HowArgs {
    pub(crate) fn budget(&self) -> f64 {
        self.budget
    }

    /// The name of the method, and the method prepared for a scene that came from `path`; none if only the table is used.
    pub(crate) fn prepare(&self, path: &Path, scene: &Scene) -> Result<(&'static str, Option<OcclusionMethodFactory>)> {
        let options = self.buffers.options();
        let failed = |error| method_failed(path, error);
        options.check().map_err(|error| failed(error.into()))?;
        let prepare = |method| OcclusionMethodFactory::new(method, scene, &options).map_err(failed);
        Ok((choice_name(self.method), self.method.map(prepare).transpose()?))
    }

    /// The same with as many threads as there are cores: what decides the result.
    pub(crate) fn for_any_threads(&self) -> Self {
        Self { threads: 0, ..self.clone() }
    }

    pub(crate) fn options(&self, n_parts: usize) -> SimplifyOptions {
        let standard = SimplifyOptions::default();
        let Self { budget, collapse, flat, ignore_mirrors, threads, .. } = *self;
        SimplifyOptions { budget, collapse, flat, ignore_mirrors, threads, n_parts, ..standard }
    }
}

/// A scene, and the source that is needed to write its file again.
#[derive(Debug)]
pub(crate) struct ReadScene {
    pub(crate) file: SceneFile,
    /// None for an OBJ.
    pub(crate) source: Option<GltfSource>,
}

/// Reads a scene to simplify. A scene whose triangles were moved is refused, because its own surfaces are used as occluders.
pub(crate) fn read(path: &Path, options: &SceneReadOptions) -> Result<ReadScene> {
    input::check_is_scene(path)?;
    let (file, source) = read_scene_with_source_and(path, options)?;
    surfaces::warn(path, &file);
    input::check_occluder(path, &file)?;
    if source.is_none() {
        tracing::warn!("{}: of an OBJ, triangles and names are kept; materials are not", path.display());
    }
    Ok(ReadScene { file, source })
}

/// A table without its frame, and the scene along it: what is simplified there has the corners of the original, by number. `None` for a
/// table without a frame. Refuses a scene that has changed since: along the frame, its digests are others in any case.
///
/// * `scene_path`, `table_path`: the files, for errors
pub(crate) fn along(
    [scene_path, table_path]: [&Path; 2],
    table: &Table,
    scene: &Scene,
) -> Result<Option<(Table, Scene)>> {
    let along = along_frame(table, scene).in_file(scene_path)?;
    if along.is_some() && table.digest().is_some_and(|digest| digest != scene.digest()) {
        return Err(SimplifyError::OtherScene(Unlike::Changed)).in_file(table_path);
    }
    Ok(along)
}

/// How a scene is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OutFormat {
    Glb,
    Obj,
}

impl OutFormat {
    /// By the end of the name of the output.
    pub(crate) fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|end| end.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("glb") => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            _ => bail!(
                "{}: the scene is written as GLB or, if it was read from one, as OBJ; give a name that ends in .glb or .obj",
                path.display()
            ),
        }
    }

    /// Refuses to write a glTF as OBJ.
    pub(crate) fn check(self, path: &Path, source: Option<&GltfSource>) -> Result<()> {
        match (self, source) {
            (Self::Obj, Some(_)) => {
                bail!(
                    "{}: a glTF is written as GLB, which keeps its materials; give a name that ends in .glb",
                    path.display()
                )
            }
            _ => Ok(()),
        }
    }
}

/// A file, and how it differs from what was to be written.
#[derive(Debug)]
pub(crate) struct Written {
    pub(crate) bytes: Vec<u8>,
    /// What single precision did not hold.
    pub(crate) rounding: Rounding,
    /// Whether it may be used to hide.
    pub(crate) occluder: bool,
}

/// Coordinates that were rounded because the file holds single precision.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Rounded {
    /// Coordinates that were rounded.
    n_coordinates: u64,
    /// The largest change of a coordinate, in scene units.
    largest: f64,
}

impl Rounded {
    /// None if nothing was rounded, in none of the files.
    pub(crate) fn of(all: impl IntoIterator<Item = Rounding>) -> Option<Self> {
        let sum = all.into_iter().fold(Rounding::default(), |a, b| Rounding {
            n_coordinates: a.n_coordinates + b.n_coordinates,
            largest: a.largest.max(b.largest),
        });
        let Rounding { n_coordinates, largest } = sum;
        (n_coordinates > 0).then_some(Self { n_coordinates, largest })
    }
}

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_coordinates, largest } = self;
        let what = count(*n_coordinates, "coordinate");
        write!(f, "{what} to single precision, by at most {largest:.3e} units, beside what is promised")
    }
}

/// What is left of a scene, as a file. As OBJ, coordinates are those of the scene; as GLB made of an OBJ, they are rounded to single precision.
///
/// * `is_framed`: whether it was simplified along a frame, with other corners than those of the file
pub(crate) fn written(
    path: &Path,
    scene: &Scene,
    source: Option<&GltfSource>,
    simplified: &Simplified,
    is_framed: bool,
    format: OutFormat,
) -> Result<Written> {
    let occluder = simplified.is_occluder(is_framed);
    let said = scene::Simplification { occluder };
    let exact = |bytes| Written { bytes, rounding: Rounding::default(), occluder };
    if let Some(source) = source {
        let change = |(k, list): (usize, &Vec<[u32; 3]>)| simplified.changes(scene, k).then(|| list.clone());
        let changes: Vec<_> = simplified.triangles.iter().enumerate().map(change).collect();
        return Ok(exact(source.rewrite(&changes, Some(said)).in_file(path)?));
    }
    let left = simplified.left(scene).expect("it is made of this scene");
    match format {
        OutFormat::Obj => Ok(exact(write_simplified_obj(&left, said).in_file(path)?)),
        OutFormat::Glb => {
            let (bytes, rounding) = write_rounded_glb(&left, &scene.bounds(), said).in_file(path)?;
            Ok(Written { bytes, rounding, occluder: occluder && rounding.n_coordinates == 0 })
        }
    }
}
