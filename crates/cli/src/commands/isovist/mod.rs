//! `isovist`: what is seen from points of a floor plan, or of a scene in space.

pub(crate) mod space;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow};
use crate::input::{self, refuse};
use crate::output::{self, JsonSchema, Serialize, bytes, count};
use crate::output_kind::OutputKind as Kind;
use crate::place::Point;
use crate::plans::{GapArg, PlanArgs, walls};
use crate::surfaces::SurfaceArgs;
use sightlines::bake::Bakeable;
use sightlines::cells::Plan;
use sightlines::formats::points::read_points;
use sightlines::formats::scene::SceneReadOptions;
use sightlines::formats::{Input, InputKind};
use sightlines::geometry::Point2;
use sightlines::isovist::{Boundary, Isovist, IsovistFinder, LimitError, Limits, Measures, Sector, WallMesh};
use sightlines::report::{Area, AreaEdge, MAX_SIZE, MIN_SIZE, areas_csv, areas_geojson, areas_png, areas_svg};
use std::fmt;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct IsovistArgs {
    #[arg(value_name = "PLAN|SCENE", help = crate::input::with_formats(
        "A plan as {plans}, or a map of a WAD; or a scene in space, of which `plan --height` cuts a plan"
    ))]
    plan: PathBuf,
    /// The map of the WAD; optional if there is only one
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    map: Option<String>,
    #[command(flatten)]
    plans: PlanArgs,
    #[command(flatten)]
    gap: GapArg,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    /// Scenes in space: the scene's table, so that no rays are spent on objects that it hides
    #[arg(long, help_heading = "Input", value_name = "FILE.pvs")]
    table: Option<PathBuf>,
    /// Scenes in space: rays of each eye; more give narrower intervals
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 20_000)]
    #[arg(value_parser = clap::value_parser!(u32).range(100..=100_000_000))]
    rays: u32,
    /// A point to look from; may be given several times
    #[arg(
        long,
        help_heading = "Viewer",
        value_name = "X,Y[,Z]",
        allow_hyphen_values = true,
        required_unless_present = "points"
    )]
    at: Vec<Point>,
    /// Points to look from: CSV (x,y[,name]) or GeoJSON
    #[arg(long, help_heading = "Viewer", value_name = "FILE")]
    points: Option<PathBuf>,
    /// How far is seen, in units of the plan [default: as far as walls let]
    #[arg(long, help_heading = "Viewer", value_name = "R", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// The direction of view; needs --fov [default: all directions]
    #[arg(long, help_heading = "Viewer", value_name = "DX,DY", allow_hyphen_values = true)]
    dir: Option<Point>,
    /// The angle of view around --dir, in degrees
    #[arg(long, help_heading = "Viewer", value_name = "DEGREES", allow_negative_numbers = true)]
    fov: Option<f64>,
    /// Pictures: longer side of the plan in pixels
    #[arg(long, help_heading = "Picture", value_name = "PX", default_value_t = 1600)]
    #[arg(value_parser = clap::value_parser!(u32).range(i64::from(MIN_SIZE)..=i64::from(MAX_SIZE)))]
    size: u32,
    /// What to write: polygons with their measures, measures alone, or a picture. Of scenes in space, CSV with the volume of the isovist
    /// and the visible share of each object, with their intervals of 95 %
    #[arg(short, long, help_heading = "Output", value_name = "OUT.geojson|OUT.csv|OUT.svg|OUT.png")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// A point to look from, and how errors name it.
struct Eye {
    at: Point2,
    name: Option<String>,
    from: String,
}

pub(crate) fn run(args: &IsovistArgs, _: Verbosity) -> Result<Done> {
    let kind = Kind::of(&args.output, "result ends in .geojson, .json, .csv, .svg or .png")?;
    let inputs = std::iter::once(&args.plan).chain(&args.points).chain(&args.table).map(PathBuf::as_path);
    output::check(&inputs.collect::<Vec<_>>(), &[&args.output])?;
    if input::kind_of(&args.plan)? == Some(InputKind::Scene) {
        return space::run(args, kind);
    }
    refuse(&args.plan, &[("--table", args.table.is_some())], "scenes in space", "a plan")?;
    refuse(&args.plan, &args.surfaces.given(), "scenes in space", "a plan")?;
    let limits = limits(args)?;
    let (plan, crs) = plan(args)?;
    let plan = args.gap.join(&args.plan, plan)?;
    let mesh = WallMesh::new(&plan).in_file(&args.plan)?;
    let areas = areas(&mesh, &eyes(args)?, &limits)?;
    let names = Measures::default().named().map(|(name, _)| name);
    let bytes = match kind {
        Kind::GeoJson => areas_geojson(&areas, &names, crs.as_deref()).into_bytes(),
        Kind::Csv => areas_csv(&areas, &names).into_bytes(),
        Kind::Svg => areas_svg(&areas, &walls(&plan), args.size, &legend(&areas)).into_bytes(),
        Kind::Png => areas_png(&areas, &walls(&plan), args.size, &legend(&areas)).in_file(&args.output)?,
    };
    output::save(&args.output, &bytes)?;
    let total = |value: &dyn Fn(&Area) -> f64| areas.iter().map(value).sum::<f64>() / areas.len() as f64;
    let outcome = Outcome {
        out: args.output.display().to_string(),
        n_bytes: bytes.len() as u64,
        n_walls: walls(&plan).len(),
        n_isovists: areas.len(),
        mean_area: total(&|area| area.values[0]),
        mean_occlusivity: total(&|area| area.values[2]),
    };
    Ok(Done::new(args.json, outcome))
}

fn legend(areas: &[Area]) -> String {
    match areas {
        [area] => format!("isovist of ({}, {}): area {:.4}", area.eye.x, area.eye.y, area.values[0]),
        _ => format!("{} isovists: the darker, the more points see it", areas.len()),
    }
}

fn plan(args: &IsovistArgs) -> Result<(Plan, Option<String>)> {
    let (path, map) = (&args.plan, args.map.as_deref());
    match input::read(path, map, &SceneReadOptions::default(), &args.plans.options(path)?)? {
        Input::Plan(file) => Ok((file.plan, file.crs)),
        other => match input::bakeable(path, other, map, None)? {
            Bakeable::Plan { plan, .. } => Ok((plan, None)),
            _ => Err(input::neither(path, "a plan nor a WAD nor a scene in space")),
        },
    }
}

fn limits(args: &IsovistArgs) -> Result<Limits> {
    let sector = match (&args.dir, args.fov) {
        (Some(direction), Some(angle)) => Some(Sector { direction: direction.planar(&args.plan)?, angle }),
        (None, None) => None,
        _ => return Err(anyhow!("--dir and --fov go together: a direction, and how wide the view around it is")),
    };
    let limits = Limits { radius: args.radius, sector, deviation: None };
    // Checked before the plan is read, with a view that has nothing in it.
    let of = |source: LimitError| {
        let option = match source {
            LimitError::Angle(_) => "--fov",
            LimitError::Direction(_) => "--dir",
            _ => "--radius",
        };
        anyhow!("{option}: {source}")
    };
    Isovist::default().limited(&limits).map_err(of)?;
    Ok(limits)
}

fn eyes(args: &IsovistArgs) -> Result<Vec<Eye>> {
    let mut eyes = Vec::new();
    for point in &args.at {
        eyes.push(Eye { at: point.planar(&args.plan)?, name: None, from: "--at".to_owned() });
    }
    if let Some(path) = &args.points {
        let points = read_points(path)?;
        eyes.extend(points.into_iter().zip(1..).map(|(point, number)| Eye {
            at: point.point,
            name: point.name,
            from: format!("{}: point {number}", path.display()),
        }));
    }
    Ok(eyes)
}

fn areas(mesh: &WallMesh, eyes: &[Eye], limits: &Limits) -> Result<Vec<Area>> {
    let mut viewer = IsovistFinder::new(mesh);
    let mut isovist = Isovist::default();
    let is_limited = *limits != Limits::default();
    let mut area = |eye: &Eye| {
        viewer.look(eye.at, &mut isovist).about(&eye.from)?;
        if is_limited {
            isovist = isovist.limited(limits).about("--radius")?;
        }
        let measures = isovist.measures();
        let edge = |boundary: &Boundary| match *boundary {
            Boundary::Wall(line) => AreaEdge::Wall(line.0),
            Boundary::Occluding => AreaEdge::Occluding,
            Boundary::Frame => AreaEdge::Frame,
            Boundary::Limit => AreaEdge::Limit,
        };
        Ok(Area {
            name: eye.name.clone(),
            eye: isovist.eye(),
            outline: isovist.vertices().to_vec(),
            edges: isovist.boundaries().iter().map(edge).collect(),
            values: measures.named().map(|(_, value)| value).to_vec(),
        })
    };
    eyes.iter().map(&mut area).collect()
}

/// Isovists of a plan.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The file that was written.
    out: String,
    /// Bytes of the file.
    n_bytes: u64,
    /// Lines of the plan that block sight.
    n_walls: usize,
    /// Points that were looked from.
    n_isovists: usize,
    /// Mean area, in square units of the plan.
    mean_area: f64,
    /// Mean length of the edges that are no wall, in units of the plan.
    mean_occlusivity: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes))?;
        writeln!(f, "plan           {}", count(self.n_walls as u64, "wall"))?;
        writeln!(f, "isovists       {}", self.n_isovists)?;
        writeln!(f, "mean area      {:.4}", self.mean_area)?;
        writeln!(f, "occlusivity    {:.4} on average", self.mean_occlusivity)
    }
}
