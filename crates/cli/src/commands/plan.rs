//! `plan`: a floor plan as GeoJSON, cut from a scene at a height, or from a file of another format.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow};
use crate::input::{self, refuse};
use crate::output::{self, JsonSchema, Serialize, bytes, coordinate};
use crate::plans::PlanArgs;
use crate::surfaces::SurfaceArgs;
use crate::up::UpArgs;
use sightlines::bake::{Bakeable, FloorCut};
use sightlines::cells::Plan;
use sightlines::formats::geojson::{write_plan, write_plan_file};
use sightlines::formats::{Input, InputKind, SceneFile};
use std::fmt;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct PlanCommandArgs {
    #[arg(value_name = "IN", help = crate::input::with_formats(
        "A scene as {scenes}; or a plan: {plans}, or a map of a WAD"
    ))]
    input: PathBuf,
    /// Scenes in space: the height to cut at, in units of the scene along the axis that points up. Best between those of corners: a
    /// plane that touches an edge closes it
    #[arg(long, help_heading = "Method", value_name = "H", allow_negative_numbers = true)]
    height: Option<f64>,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    up: UpArgs,
    #[command(flatten)]
    plans: PlanArgs,
    /// The plan to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.geojson")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &PlanCommandArgs, _: Verbosity) -> Result<Done> {
    let (path, out) = (&args.input, &args.output);
    output::check(&[path], &[out])?;
    let map = args.map.as_deref();
    if matches!(input::kind_of(path)?, Some(InputKind::Plan | InputKind::Wad)) {
        refuse(path, &[("--height", args.height.is_some())], "scenes in space", "none")?;
        refuse(path, &args.surfaces.given(), "scenes in space", "none")?;
    }
    let mut read = input::read(path, map, &args.surfaces.options(), &args.plans.options(path)?)?;
    args.up.put_into(path, &mut read)?;
    let (text, outcome) = match read {
        Input::Scene(file) => {
            let cut = cut(path, &file, args.height)?;
            (write_plan(&cut.plan), Outcome::new(out, &cut.plan, args.height.zip(Some(&cut))))
        }
        Input::Plan(file) => (write_plan_file(&file), Outcome::new(out, &file.plan, None)),
        other => match input::bakeable(path, other, map, None)? {
            Bakeable::Plan { plan, .. } => (write_plan(&plan), Outcome::new(out, &plan, None)),
            _ => {
                let expected = "a scene in space nor a plan nor a WAD";
                return Err(input::neither(path, expected));
            }
        },
    };
    output::save(out, text.as_bytes())?;
    Ok(Done::new(args.json, Outcome { n_bytes: text.len(), ..outcome }))
}

fn cut(path: &Path, file: &SceneFile, height: Option<f64>) -> Result<FloorCut> {
    input::check_occluder(path, file)?;
    let (bounds, up) = (file.scene.bounds(), file.info.up as usize);
    let height = height.ok_or_else(|| {
        anyhow!(
            "{}: --height is missing: at which height is the scene cut? It is from {} to {}",
            path.display(),
            coordinate(bounds.min[up]),
            coordinate(bounds.max[up])
        )
    })?;
    FloorCut::of_file(file, height).in_file(path)
}

/// The plan that was written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The GeoJSON file that was written.
    out: String,
    /// Lines that block sight.
    n_walls: usize,
    /// Lines that do not block sight.
    n_transparent: usize,
    /// Of the walls, those that are mirrors.
    n_mirrors: usize,
    /// Objects.
    n_objects: usize,
    /// Bytes of the file.
    n_bytes: usize,
    /// Of scenes in space: how they were cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut: Option<Cut>,
}

/// How a scene was cut.
#[derive(Debug, Serialize, JsonSchema)]
struct Cut {
    /// The height.
    height: f64,
    /// Triangles that the plane meets in a segment.
    n_triangles: usize,
    /// Triangles that lie in the plane, which were left out.
    n_flat: usize,
    /// Segments that were dropped because they repeat others or have no length.
    n_dropped: usize,
    /// Segments that were joined to another on the same line.
    n_joined: usize,
}

impl Outcome {
    fn new(out: &Path, plan: &Plan, cut: Option<(f64, &FloorCut)>) -> Self {
        let n_walls = plan.lines().iter().filter(|line| line.opaque).count();
        Self {
            out: out.display().to_string(),
            n_walls,
            n_transparent: plan.lines().len() - n_walls,
            n_mirrors: plan.mirrors().len(),
            n_objects: plan.objects().len(),
            n_bytes: 0,
            cut: cut.map(|(height, cut)| Cut {
                height,
                n_triangles: cut.n_cut,
                n_flat: cut.n_flat,
                n_dropped: cut.n_doubled + cut.n_without_length,
                n_joined: cut.n_joined,
            }),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        if let Some(Cut { height, n_triangles, n_flat, n_dropped, n_joined }) = self.cut {
            writeln!(f, "cut            {n_triangles} triangles at height {height}; {n_flat} lie in the plane")?;
            writeln!(f, "segments       {n_dropped} dropped, {n_joined} joined to others")?;
        }
        let mirrors = if self.n_mirrors > 0 { format!(", {} of them mirrors", self.n_mirrors) } else { String::new() };
        writeln!(f, "walls          {}{mirrors}", self.n_walls)?;
        writeln!(f, "transparent    {}", self.n_transparent)?;
        writeln!(f, "objects        {}", self.n_objects)
    }
}
