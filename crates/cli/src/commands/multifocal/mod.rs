//! `multifocal`: the multifocal buffer of a scene on one plane as a picture, and the fields beside it.

mod chart;
pub(crate) mod outcome;

use crate::buffers::method_failed;
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::input;
use crate::named::{measure, one_of};
use crate::output;
use crate::picture::{self, PictureKind};
use crate::region::Region;
use crate::surfaces::SurfaceArgs;
use outcome::{FieldInfo, Outcome};
use sightlines::bake::methods::{Backend, NotBuiltIn};
use sightlines::geometry::Point3;
use sightlines::multifocal::mesh::{Mesh, PatchOptions, patches_of};
use sightlines::multifocal::{
    Buffer, BufferJob, BufferPlane, Measure, Occluder, PlaneChoice, Texels, Volume, render_by_first,
};
use sightlines::multifocal_cpu::fields::{Features, NearestField};
use sightlines::report::{PngError, buffer_png, distance_png, voronoi_png};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The picture has one pixel for each texel: blue where nothing is known to block; otherwise grey, from \
                  black, where only what lies behind the plane is hidden, to white for the largest height or distance \
                  in the picture, which is printed. A texel blocked at height 0 thus differs from one that is not \
                  blocked. In the Voronoi map vertices are dark, edges bright and faces pale. The axis after that of \
                  the plane (in the order x, y, z, x, y) points to the right, the next one up."
)]
pub(crate) struct MultifocalArgs {
    #[arg(value_name = "SCENE", help = crate::input::with_formats("The scene: {scenes}"))]
    scene: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    /// The view volume as a box: its lower corner, then its upper one, in scene units
    #[arg(long, help_heading = "Viewer", value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    volume: Region,
    /// The plane behind the scene, such as z=20, and a window on it along the two axes that follow (for y: z and x), in
    /// scene units [default: the shadow of the scene's box, or its sides where it is beside the volume]
    #[arg(long, help_heading = "Picture", value_name = "AXIS=AT[:U0,V0,U1,V1]", allow_hyphen_values = true)]
    plane: PlaneChoice,
    /// Texels along the longer side of the window (texels are then nearly square), or along both
    #[arg(long, help_heading = "Picture", value_name = "N|WxH", default_value = "256")]
    texels: Texels,
    /// The measure: distances to the texel, with or without parts that no eye sees there, or heights above the plane,
    /// of corners or of the parts that eyes see
    #[arg(long, help_heading = "Method", default_value = Measure::default().name(), value_parser = measure())]
    measure: Measure,
    /// The backend that fills the buffer. If one is not available or fails, the next takes over: gpu, cpu, reference
    /// (slow)
    #[arg(long, help_heading = "Method", default_value = Backend::Cpu.name(), value_parser = one_of(&Backend::ALL, Backend::name, Backend::about))]
    backend: Backend,
    /// Use each triangle as an occluder by itself, as in Marsden's slides, instead of merging neighbours into larger
    /// occluders
    #[arg(long, help_heading = "Method")]
    triangles: bool,
    /// The picture of the buffer to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.png")]
    output: PathBuf,
    /// Also write the buffer as a picture for people: upright, as seen from the volume, with its window and a scale of its values
    #[arg(long, help_heading = "Output", value_name = "OUT.svg|OUT.png")]
    chart: Option<PathBuf>,
    /// Also write a Voronoi map: the feature (vertex, edge or face) nearest to each texel
    #[arg(long, help_heading = "Output", value_name = "OUT.png")]
    voronoi: Option<PathBuf>,
    /// Also write a distance field: the distance of each texel to the nearest feature, black for 0, white for the
    /// largest
    #[arg(long, help_heading = "Output", value_name = "OUT.png")]
    distance: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &MultifocalArgs, _: Verbosity) -> Result<Done> {
    check_outputs(args)?;
    input::check_is_scene(&args.scene)?;
    let file = input::occluders(&args.scene, &args.surfaces.options_of_walls())?;
    let (up, scene) = (file.info.up, file.scene);
    let both_sides: Vec<[Point3; 3]> = scene.occluding_triangles().collect();
    let fronts: Vec<[Point3; 3]> = scene.front_occluding_triangles().collect();
    let volume = Volume::new(args.volume.0).about("--volume")?;
    let about = format!("--plane {}", args.plane);
    let plane = args.plane.plane(&volume, &scene.bounds(), args.texels).about(&about)?;
    let occluders = occluders(&both_sides, &fronts, args.triangles);
    let job = BufferJob::new(volume, vec![plane], &occluders, args.measure, false).about(&about)?;
    let failed = |error: NotBuiltIn| method_failed(&args.scene, error.into());
    let chain = args.backend.open(|text| tracing::warn!("{text}")).map_err(failed)?.chain();
    let (mut buffers, taken_over) = (Vec::new(), |error| tracing::warn!("{error}; the next one takes over"));
    let by = render_by_first(chain, &job, &mut buffers, taken_over).in_file(&args.scene)?;
    let buffer = buffers.pop().expect("a backend fills a buffer for each plane, and there is one");
    let fields = (args.voronoi.is_some() || args.distance.is_some()).then(|| {
        let features = Features::new(both_sides.iter().chain(&fronts).copied());
        let field = NearestField::new(&features, &plane);
        (features, field)
    });
    let white = white(&buffer);
    let outcome = Outcome {
        scene: args.scene.display().to_string(),
        n_triangles: both_sides.len() + fronts.len(),
        n_occluders: job.occluders().len(),
        volume: [args.volume.0.min, args.volume.0.max],
        axis: plane.axis(),
        at: plane.at(),
        window: [plane.origin(), plane.end()],
        texels: plane.texels(),
        measure: job.measure().name(),
        backend: by,
        unit: job.unit(),
        n_texels: plane.texels().map(u64::from).iter().product(),
        n_blocked: buffer.n_blocked(),
        white: f64::from(white) * job.unit(),
        fields: fields.as_ref().map(|(features, field)| FieldInfo::new(features, field)),
        files: outputs(args).map(|path| path.display().to_string()).collect(),
    };
    let chart = args.chart.as_deref().map(|path| chart::svg(path, &outcome, &buffer, white, up).map(|svg| (path, svg)));
    let chart = chart.transpose()?;
    write(args, &plane, &buffer, fields.as_ref())?;
    if let Some((path, svg)) = chart {
        picture::save_picture(&svg, path)?;
    }
    Ok(Done::new(args.json, outcome))
}

fn outputs(args: &MultifocalArgs) -> impl Iterator<Item = &PathBuf> {
    pixels(args).chain(&args.chart)
}

/// Those with a pixel for each texel.
fn pixels(args: &MultifocalArgs) -> impl Iterator<Item = &PathBuf> {
    [Some(&args.output), args.voronoi.as_ref(), args.distance.as_ref()].into_iter().flatten()
}

/// Refuses names of pictures that are no PNG, that name the same file twice, or the scene, and files that cannot be written.
fn check_outputs(args: &MultifocalArgs) -> Result<()> {
    pixels(args).try_for_each(|path| output::check_ending(path, "picture", "png"))?;
    args.chart.iter().try_for_each(|path| PictureKind::of(path).map(drop))?;
    output::check(&[&args.scene], &outputs(args).map(PathBuf::as_path).collect::<Vec<_>>())
}

/// What hides: patches, or each triangle that has an area.
fn occluders(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]], each: bool) -> Vec<Occluder> {
    if each {
        let occluder = |&corners: &[Point3; 3]| Occluder::triangle(corners).ok();
        let fronts = fronts.iter().filter_map(occluder).map(Occluder::from_front);
        both_sides.iter().filter_map(occluder).chain(fronts).collect()
    } else {
        patches_of(&Mesh::weld_with_fronts(both_sides, fronts), &PatchOptions::default())
    }
}

/// The largest height or distance in a buffer, in units of the job; 0 if nothing blocks.
fn white(buffer: &Buffer) -> u32 {
    buffer.values().iter().copied().max().unwrap_or(0).saturating_sub(1)
}

fn write(
    args: &MultifocalArgs,
    plane: &BufferPlane,
    buffer: &Buffer,
    fields: Option<&(Features, NearestField)>,
) -> Result<()> {
    let texels = plane.texels();
    let mut pictures: Vec<(&Path, Result<Vec<u8>, PngError>)> =
        vec![(&args.output, buffer_png(texels, buffer.values(), white(buffer)))];
    if let Some((features, field)) = fields {
        if let Some(path) = &args.voronoi {
            let ids: Vec<Option<u32>> = field.nearest().iter().map(|n| n.map(|n| n.feature)).collect();
            pictures.push((path, voronoi_png(texels, &ids, features.first_edge(), features.first_face())));
        }
        if let Some(path) = &args.distance {
            let distances: Vec<f64> = field.nearest().iter().map(|n| n.map_or(0.0, |n| n.distance)).collect();
            pictures.push((path, distance_png(texels, &distances, field.farthest())));
        }
    }
    let drawn = pictures.into_iter().map(|(path, png)| Ok((path, png.in_file(path)?)));
    let drawn: Vec<(&Path, Vec<u8>)> = drawn.collect::<Result<_>>()?;
    drawn.iter().try_for_each(|(path, png)| output::save(path, png))
}
