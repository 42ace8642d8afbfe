//! `render`: what one eye sees of a scene, drawn by one method, or by all side by side.

mod cull;
pub(crate) mod outcome;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::eye::EyeArgs;
use crate::input;
use crate::named::one_of;
use crate::output::{self, count};
use crate::progress::Bar;
use crate::surfaces::{self, SurfaceArgs};
use crate::tables::{self, CACHE};
use crate::view::Up;
use cull::{leave_out, seen_by_table};
use outcome::{Outcome, Row};
use sightlines::formats::scene::BackFaces;
use sightlines::report::{PngError, SheetPicture, faces_png, sheet_png, sheet_size};
use sightlines::visible_surface::{
    Camera, Comparison, CullStep, DepthFormat, FaceMask, Faces, NOTHING, Preparer, RenderInput, Technique, compare,
};
use std::path::{Path, PathBuf};

/// The most pixels of a sheet: 400 MB of colours.
const MOST_PIXELS: u64 = 1 << 27;

#[derive(Debug, clap::Args)]
#[command(
    group = clap::ArgGroup::new("drawn by").args(["method", "compare"]).required(true).multiple(true),
    after_help = "Each face has its own colour, so that pictures can be compared pixel by pixel; the background is \
                  dark. All methods except the painter's sort and rounded z-buffers are exact: a pixel shows the face \
                  that the ray through its centre meets first, and of faces at equal depth the first one in the scene. \
                  With --compare the sheet has one numbered picture for each method, as in the printed table: faces \
                  are darkened, and pixels that differ from the ray caster (run with back-face culling at most) are \
                  magenta, except where its ray meets both faces at equal depth. Faces are drawn from both sides."
)]
pub(crate) struct RenderArgs {
    #[arg(value_name = "SCENE", help = crate::input::with_formats("The scene: {scenes}"))]
    scene: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    eye: EyeArgs,
    /// The method; this or --compare is needed. With --compare several, separated by commas
    #[arg(long, help_heading = "Method", value_name = "NAME[,NAME...]", value_delimiter = ',')]
    #[arg(value_parser = one_of(&Technique::ALL, Technique::name, Technique::about))]
    method: Vec<Technique>,
    /// Draw all methods, or those of --method, side by side with the ray caster in one sheet, and count the pixels that
    /// differ from it
    #[arg(long, help_heading = "Method")]
    compare: bool,
    /// Depth format of the z-buffer [default: exact; all with --compare]
    #[arg(long, help_heading = "Method", value_name = "FORMAT", value_parser = one_of(&DepthFormat::ALL, DepthFormat::name, DepthFormat::about))]
    depth: Option<DepthFormat>,
    /// What to cull before drawing, in this order; separated by commas
    #[arg(long, help_heading = "Method", value_name = "WAY[,WAY...]", value_delimiter = ',')]
    #[arg(value_parser = one_of(&CullStep::ALL, CullStep::name, cull::about))]
    cull: Vec<CullStep>,
    /// For --cull pvs: the table of the scene, plain or packed
    #[arg(long, help_heading = "Method", value_name = "FILE.pvs")]
    table: Option<PathBuf>,
    /// Colour objects instead of faces
    #[arg(long, help_heading = "Output")]
    by_object: bool,
    /// The picture to write
    #[arg(short, long, help_heading = "Output", value_name = "OUT.png")]
    output: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &RenderArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    check(args)?;
    input::check_is_scene(&args.scene)?;
    let table =
        args.table.as_ref().map(|path| Ok::<_, anyhow::Error>((path, tables::open(path, CACHE)?))).transpose()?;
    let mut options = args.surfaces.options_with(table.as_ref().map_or(&[], |(_, opened)| opened.info()));
    // A table that is right whatever becomes of backs is right for a picture that shows them.
    if options.backs == BackFaces::Either {
        options.backs = BackFaces::Drawn;
    }
    let file = input::scene(&args.scene, &options)?;
    if args.cull.contains(&CullStep::Pvs) {
        input::check_occluder(&args.scene, &file)?;
        if !file.scene.front_occluders().is_empty() {
            bail!(
                "{}: --cull pvs: the table takes backs to be culled (--backs culled), and this picture does not show walls of one side",
                args.scene.display()
            );
        }
    }
    let faces = Faces::of_scene(&file.scene.opaque_part()).in_file(&args.scene)?;
    surfaces::warn_not_drawn(&args.scene, &file);
    let up = args.eye.up(Up::axis(file.info.up));
    let camera = args.eye.camera(up)?;
    let methods = methods(args, &camera)?;
    let seen = match &table {
        Some((path, opened)) => seen_by_table(opened, path, &args.scene, &file.scene, camera.eye())?,
        None => None,
    };
    let mut chosen = FaceMask::all(&faces);
    let culled = leave_out(&args.cull, &faces, &camera, seen.as_deref(), &mut chosen);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let bar = Bar::new("pictures", show_progress);
    let (rows, png) = if args.compare {
        side_by_side(args, &shot, &methods, &bar)
    } else {
        let (kind, depth) = methods[0];
        let (image, row) = Row::draw(&Preparer::new(&faces).prepare(kind, depth), &shot);
        (vec![row], faces_png(camera.size(), &shown(args, &faces, image.faces())))
    };
    drop(bar);
    let png = png.in_file(&args.output)?;
    let outcome = Outcome {
        scene: args.scene.display().to_string(),
        n_objects: file.scene.objects().len(),
        n_faces: faces.len(),
        n_drawn: chosen.len(),
        eye: args.eye.eye,
        look_at: args.eye.look_at,
        up,
        fov: args.eye.fov,
        size: camera.size(),
        near: camera.depths()[0],
        far: Some(camera.depths()[1]).filter(|far| far.is_finite()),
        culled,
        compared: args.compare,
        pictures: rows,
        file: args.output.display().to_string(),
    };
    output::save(&args.output, &png)?;
    Ok(Done::new(args.json, outcome))
}

/// Refuses options that do not go together, and outputs that would replace what is read.
fn check(args: &RenderArgs) -> Result<()> {
    output::check_ending(&args.output, "picture", "png")?;
    let inputs: Vec<&Path> = std::iter::once(&args.scene).chain(&args.table).map(PathBuf::as_path).collect();
    output::check(&inputs, &[&args.output])?;
    let has_buffer = args.method.contains(&Technique::Zbuffer) || args.method.is_empty();
    match (args.cull.contains(&CullStep::Pvs), &args.table) {
        (true, None) => Err(anyhow!("--cull pvs: this needs a table of the scene: name it with --table")),
        (false, Some(_)) => Err(anyhow!("--table: the table is not used: add --cull pvs")),
        _ if args.method.len() > 1 && !args.compare => {
            Err(anyhow!("--method: several methods are drawn with --compare only; name one"))
        }
        _ if args.depth.is_some() && !has_buffer => {
            Err(anyhow!("--depth: this is the format of a z-buffer, and none is drawn: add --method zbuffer"))
        }
        _ => Ok(()),
    }
}

/// The methods that are drawn. With `--compare` the ray caster is one of them, and their sheet is not too large.
fn methods(args: &RenderArgs, camera: &Camera) -> Result<Vec<(Technique, DepthFormat)>> {
    if !args.compare {
        return Ok(args.method.iter().map(|&kind| (kind, args.depth.unwrap_or_default())).collect());
    }
    let methods = compared(&args.method, args.depth);
    let (n, size) = (methods.len(), camera.size());
    match sheet_size(size, n) {
        Some([w, h]) if u64::from(w) * u64::from(h) <= MOST_PIXELS => Ok(methods),
        _ => Err(anyhow!(
            "--size: {n} pictures of {} by {} pixels make a sheet of more than {MOST_PIXELS} pixels; name fewer methods, or a smaller size",
            size[0],
            size[1]
        )),
    }
}

/// The methods that are compared, each with what a z-buffer keeps: those that are named and the ray caster, or all if none are; z-buffers
/// of all formats unless one is named.
fn compared(named: &[Technique], depth: Option<DepthFormat>) -> Vec<(Technique, DepthFormat)> {
    let named = if named.is_empty() { &Technique::ALL } else { named };
    let mut all = Vec::new();
    for &technique in named {
        match (technique, depth) {
            (Technique::Zbuffer, None) => all.extend(DepthFormat::ALL.map(|format| (technique, format))),
            _ => all.push((technique, depth.unwrap_or_default())),
        }
    }
    if !named.contains(&Technique::Raycast) {
        all.push((Technique::Raycast, DepthFormat::Exact));
    }
    all
}

/// Draws by several methods, and compares with what the ray caster sees where nothing but back faces was left out.
fn side_by_side(
    args: &RenderArgs,
    shot: &RenderInput<'_>,
    methods: &[(Technique, DepthFormat)],
    bar: &Bar,
) -> (Vec<Row>, Result<Vec<u8>, PngError>) {
    let RenderInput { faces, camera, .. } = *shot;
    let mut preparer = Preparer::new(faces);
    let caster = preparer.prepare(Technique::Raycast, DepthFormat::Exact);
    let mut whole = FaceMask::all(faces);
    let facing: Vec<CullStep> = args.cull.iter().copied().filter(|way| *way == CullStep::Backface).collect();
    leave_out(&facing, faces, camera, None, &mut whole);
    let reference = caster.method.picture(&RenderInput { mask: &whole, ..*shot }).0;
    let mut all: Vec<(Vec<u32>, Comparison)> = Vec::new();
    let mut rows = Vec::new();
    for (k, &(kind, depth)) in methods.iter().enumerate() {
        bar.set(k, methods.len());
        let (image, row) = match kind {
            Technique::Raycast => Row::draw(&caster, shot),
            _ => Row::draw(&preparer.prepare(kind, depth), shot),
        };
        let comparison = compare(shot, &reference, &image);
        rows.push(row.compared(&comparison));
        all.push((shown(args, faces, image.faces()), comparison));
    }
    let notes: Vec<String> = all.iter().map(|(_, c)| count(c.wrong.len() as u64, "wrong pixel")).collect();
    let pictures: Vec<SheetPicture<'_>> = (0..all.len())
        .map(|k| SheetPicture { title: rows[k].method, note: &notes[k], faces: &all[k].0, marked: &all[k].1.wrong })
        .collect();
    let png = sheet_png(camera.size(), &pictures);
    (rows, png)
}

fn shown(args: &RenderArgs, faces: &Faces, seen: &[u32]) -> Vec<u32> {
    let shown = |&face: &u32| if args.by_object && face != NOTHING { faces.object(face) } else { face };
    seen.iter().map(shown).collect()
}
