//! `light`: the soft shadows of an area light, with rays only where nothing is proven.

mod method;
pub(crate) mod outcome;

use crate::buffers::method_failed;
use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result};
use crate::eye::EyeArgs;
use crate::input;
use crate::named::one_of;
use crate::output;
use crate::region::Region;
use crate::surfaces::{self, SurfaceArgs};
use crate::view::Up;
use method::{UmbraMethod, union};
use outcome::Outcome;
use sightlines::area_light::{LightOptions, Shade, Shadows, Sides, shown};
use sightlines::multifocal::{FromRegion, Volume};
use sightlines::report::{LightPixel, light_png};
use sightlines::visible_surface::{DepthFormat, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer};
use std::path::PathBuf;
use std::time::Instant;

/// The most halvings: a face becomes up to two to the power of it.
const MOST_DEPTH: u32 = 24;
/// The most rays for a pixel.
const MOST_RAYS: u32 = 65_536;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Visible faces are divided into pieces until each is proven to be in full umbra (blue) or fully lit \
                  (pale), or is small. Pixels in doubt are red, paler where more of the light arrives, measured by \
                  rays to points of the light. A surface is lit on the side that the eye sees, by the part of the \
                  light in front of it; both sides of every surface cast shadows. With --grey the picture shows the \
                  visible share of the light only."
)]
pub(crate) struct LightArgs {
    #[arg(value_name = "SCENE", help = crate::input::with_formats("The scene: {scenes}"))]
    scene: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    /// The light as a box: its lower corner, then its upper one, in scene units; a flat box is a rectangle, an empty
    /// one a point light
    #[arg(long, help_heading = "Light", value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    light: Region,
    #[command(flatten)]
    eye: EyeArgs,
    /// Methods that find umbrae, separated by commas; each is tried where those before found nothing
    #[arg(
        long,
        help_heading = "Method",
        value_name = "NAME[,NAME...]",
        value_delimiter = ',',
        default_value = UmbraMethod::Sheets.name(),
        value_parser = one_of(&UmbraMethod::all(), UmbraMethod::name, UmbraMethod::about)
    )]
    method: Vec<UmbraMethod>,
    /// Maximum number of times that a face is halved
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 10)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=i64::from(MOST_DEPTH)))]
    depth: u32,
    /// Do not halve pieces whose longest edge is at most this long, in scene units
    #[arg(long, help_heading = "Method", value_name = "LENGTH", default_value_t = 0.0)]
    min_size: f64,
    /// Rays for each pixel in doubt
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 64)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_RAYS)))]
    rays: u32,
    /// Draw the visible share of the light in grey instead of the proven states
    #[arg(long, help_heading = "Output")]
    grey: bool,
    /// The picture to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.png")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &LightArgs, _: Verbosity) -> Result<Done> {
    output::check_ending(&args.output, "picture", "png")?;
    output::check(&[&args.scene], &[&args.output])?;
    input::check_is_scene(&args.scene)?;
    // All that hides casts shadows, and nothing else is drawn.
    let file = input::occluders(&args.scene, &args.surfaces.options_of_walls())?;
    let faces = Faces::of_scene(&file.scene.opaque_part()).in_file(&args.scene)?;
    surfaces::warn_not_drawn(&args.scene, &file);
    let light = Volume::new(args.light.0).about("--light")?;
    let camera = args.eye.camera(args.eye.up(Up::axis(file.info.up)))?;
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &FaceMask::all(&faces) };
    let image = ZBuffer::new(DepthFormat::Exact).picture(&shot).0;
    let chosen = shown(&faces, &image);

    let start = Instant::now();
    let mut method =
        union(&args.method, &file.scene.opaque_part()).map_err(|error| method_failed(&args.scene, error))?;
    let options = LightOptions { sides: Sides::Towards(camera.eye()), max_depth: args.depth, min_size: args.min_size };
    let shadows = Shadows::new(&faces);
    let lighting = shadows.classify(&chosen, &light, &mut method, &options).in_file(&args.scene)?;
    let decided = start.elapsed();
    let start = Instant::now();
    let picture = shadows.picture(&lighting, &camera, &image, args.rays);
    let drawn = start.elapsed();

    let pixels: Vec<LightPixel> = picture.shades.iter().map(|&shade| pixel(shade)).collect();
    let png = light_png(picture.size, &pixels, args.grey);
    let png = png.in_file(&args.output)?;
    let [pixels_umbra, pixels_lit, pixels_in_doubt] = picture.counts();
    let areas = lighting.areas();
    let outcome = Outcome {
        scene: args.scene.display().to_string(),
        n_faces: faces.len(),
        n_shown: chosen.len(),
        light: [args.light.0.min, args.light.0.max],
        method: method.name(),
        n_pieces: lighting.pieces().len(),
        area_umbra: areas.umbra,
        area_lit: areas.lit,
        area_in_doubt: areas.in_doubt,
        area_mixed: areas.mixed,
        size: picture.size,
        pixels_umbra,
        pixels_lit,
        pixels_in_doubt,
        rays: picture.n_rays,
        rays_else: picture.n_rays_else,
        decide_seconds: decided.as_secs_f64(),
        draw_seconds: drawn.as_secs_f64(),
        file: args.output.display().to_string(),
    };
    output::save(&args.output, &png)?;
    Ok(Done::new(args.json, outcome))
}

fn pixel(shade: Shade) -> LightPixel {
    match shade {
        Shade::Nothing => LightPixel::Nothing,
        Shade::Umbra => LightPixel::Umbra,
        Shade::Lit => LightPixel::Lit,
        Shade::Traced(share) => LightPixel::Doubt(share),
    }
}
