//! `draw`: a table as a picture.

pub(crate) mod space;

mod joints;
mod scene;
mod viewer;
use crate::command::{Answer, Done, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::input::refuse;
use crate::picture::{PictureKind, save_picture};
use crate::place::{self, Point};
use crate::sight::SightArgs;
use crate::{input, output};
use joints::Rings;
use sightlines::geometry::{Point2, check_coordinate};
use sightlines::pvs::Table;
use sightlines::report::{DrawOptions, Drawing, MAX_SIZE, MIN_SIZE, PictureSubject, Surfaces, plan_drawing};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use viewer::{Shown, Viewer};

#[derive(Debug, clap::Args)]
#[command(mut_arg("up", |up| up.help("Scenes in space: the axis that points up in the picture; with --dir also the up direction of the view, \
    which may be a vector [default: the one stored in the table, else y]").help_heading("Picture")))]
#[command(mut_arg("method", |method| method.help(crate::view::method_help(", side by side [default: exact]"))))]
pub(crate) struct DrawArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    #[arg(long, help_heading = "Picture", value_name = "SCENE", help = crate::input::with_formats(
        "Scenes in space: what the table was built from, a {scenes} or a Quake map. A floor plan shows all surfaces that it cuts, slanted \
         ones too, and an isometric view the surfaces in place of the cells; single-sided ones are left out from behind [default: what the \
         cells tell of]"
    ))]
    scene: Option<PathBuf>,
    #[arg(long, help_heading = "Picture", value_name = "PLAN", help = crate::input::with_formats(
        "Plans: what the table was built from, a {plans} or a WAD. Rings mark ends of walls that are joined to others within the gap of the \
         table, and ends that miss others by slightly more"
    ))]
    joints: Option<PathBuf>,
    /// With --joints and a WAD of several maps: the map
    #[arg(long, help_heading = "Picture", value_name = "NAME", requires = "joints")]
    map: Option<String>,
    /// Show what is visible from this cell
    #[arg(long, help_heading = "Viewer", value_name = "N", conflicts_with = "eye")]
    cell: Option<u32>,
    /// Show what a viewer at this point sees, in scene units, and paler what is seen from elsewhere in their cell; exit code 1 and no
    /// picture outside every cell
    #[arg(long, help_heading = "Viewer", value_name = "X,Y[,Z]", allow_hyphen_values = true)]
    eye: Option<Point>,
    #[command(flatten)]
    sight: SightArgs,
    /// Scenes in space: height of the floor plan, in scene units [default: that of the eye or of the middle of the
    /// cell]. With --isometric everything above is left out [default there without them: nothing is]
    #[arg(long, help_heading = "Picture", value_name = "Y", value_parser = height, allow_hyphen_values = true)]
    height: Option<f64>,
    /// Scenes in space: draw the cells as boxes, or the scene, viewed from the positive side of all axes
    #[arg(long, help_heading = "Picture")]
    isometric: bool,
    /// Leave out the legend and the scale bar
    #[arg(long, help_heading = "Picture")]
    no_legend: bool,
    /// Longer side of the picture, of each with --method all, in pixels
    #[arg(long, help_heading = "Picture", value_name = "PX", default_value_t = 1600)]
    #[arg(value_parser = clap::value_parser!(u32).range(i64::from(MIN_SIZE)..=i64::from(MAX_SIZE)))]
    size: u32,
    /// The picture to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.svg|OUT.png")]
    output: PathBuf,
}

fn height(text: &str) -> Result<f64, String> {
    let height: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    check_coordinate(height).map_err(|error| error.to_string())
}

pub(crate) fn run(args: &DrawArgs, _: Verbosity) -> Result<Done> {
    PictureKind::of(&args.output)?;
    let inputs: Vec<&Path> =
        std::iter::once(&args.table).chain(&args.scene).chain(&args.joints).map(PathBuf::as_path).collect();
    output::check(&inputs, &[&args.output])?;
    viewer::refuse_without_eye(args)?;
    let table = Arc::new(input::table(&args.table)?);
    input::refuse_without_places(&table, &args.table, "there is nothing to draw")?;
    let is_plan = table.dimension() == 2;
    if is_plan {
        let up = args.sight.lens.up().is_some();
        let given = [
            ("--height", args.height.is_some()),
            ("--isometric", args.isometric),
            ("--up", up),
            ("--scene", args.scene.is_some()),
        ];
        refuse(&args.table, &given, "scenes in space", "the table of a plan")?;
    } else {
        refuse(&args.table, &[("--joints", args.joints.is_some())], "plans", "the table of a scene in space")?;
    }
    let rings = args.joints.as_deref().map(|path| joints::of(path, args.map.as_deref(), &table)).transpose()?;
    let rings = &rings.unwrap_or_default();
    let viewer = match &args.eye {
        Some(eye) => {
            let viewer = Viewer::new(args, eye, &table)?;
            if viewer.is_outside() {
                let told = format!("the point {eye} is outside every cell\n");
                return Ok(Done::in_two_forms(false, || (), || told).answering(Answer::No));
            }
            Some(viewer)
        }
        None => None,
    };
    let surfaces = args.scene.as_deref().map(|path| scene::surfaces(path, &table)).transpose()?;
    let surfaces = surfaces.as_ref();
    let svg = match viewer {
        None => picture(args, &table, None, (surfaces, rings), !args.no_legend)?.to_svg(),
        Some(mut viewer) => {
            let (methods, has_panels) = (viewer.methods(), viewer.has_panels());
            let mut drawn = methods.into_iter().map(|method| {
                let (legend, shown) = (!args.no_legend && !has_panels, viewer.shown(method));
                let drawing = picture(args, &table, Some(&shown), (surfaces, rings), legend)?;
                Ok((format!("{}: {}", method.name(), shown.counts()), drawing))
            });
            if has_panels {
                let drawn = drawn.collect::<Result<Vec<_>>>()?;
                Drawing::side_by_side("What a viewer sees by each eye-to-cell method", &drawn)
            } else {
                drawn.next().expect("there is one method at least")?.1.to_svg()
            }
        }
    };
    save_picture(&svg, &args.output)?;
    Ok(Done::silently())
}

/// One picture of the table.
fn picture(
    args: &DrawArgs,
    table: &Table,
    shown: Option<&Shown<'_>>,
    (surfaces, rings): (Option<&Surfaces>, &Rings),
    legend: bool,
) -> Result<Drawing> {
    match table.dimension() {
        2 => plan(args, table, shown, rings, legend),
        _ => space::draw(args, table, shown, surfaces, legend),
    }
}

fn plan(
    args: &DrawArgs,
    table: &Table,
    shown: Option<&Shown<'_>>,
    Rings { joints, near_misses }: &Rings,
    legend: bool,
) -> Result<Drawing> {
    let view = match (args.cell, &args.eye) {
        (Some(id), _) => PictureSubject::Cell(place::cell(id, table, &args.table)?),
        (None, Some(eye)) => PictureSubject::Eye(eye.planar(&args.table)?),
        (None, None) => PictureSubject::Plan,
    };
    let sight = shown.map(|shown| shown.sight(|[x, y, _]| Point2::new(x, y)));
    let options = DrawOptions { view, sight, joints, near_misses, size: args.size, legend, ..DrawOptions::default() };
    plan_drawing(table, &options).in_file(&args.table)
}
