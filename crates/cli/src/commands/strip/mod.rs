//! `strip`: a scene without what nobody can ever see.

mod from;
pub(crate) mod outcome;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::output;
use crate::progress::Bar;
use crate::simplification::{OutFormat, ReadScene, read};
use crate::surfaces::SurfaceArgs;
use from::From;
use outcome::{MadeFile, Outcome, Part, Report};
use sightlines::cells::Scene;
use sightlines::formats::GltfSource;
use sightlines::formats::scene::{NamePattern, Removal, Simplification, write_simplified_obj};
use sightlines::strip::{Grain, StripOptions, Stripped, strip};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The version of the form of reports.
const REPORT_VERSION: u32 = 1;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "What is seen is shown by a free segment, what is hidden is hidden from every eye: exactly, but for what is hidden by the gap or by a \
                  table. What is neither stays. Everything else in a glTF stays byte for byte, also vertices that nothing uses any more; --compact and --triangles \
                  write buffers anew. Backs of single-sided faces count as --backs says. Mirrors show what is hidden: scenes with mirrors are refused unless \
                  mirrors are ignored."
)]
pub(crate) struct StripArgs {
    /// The scene: GLB or glTF; from an OBJ only triangles and names are kept
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    /// Where eyes are: outside (everywhere outside of the box around the scene), box=X0,Y0,Z0,X1,Y1,Z1 and cells=FILE.json (boxes, as `build --cells` takes
    /// them; several of both may be given), walk=X,Y,Z (wherever a way leads from a point that no surface bars; several may be given) or walk (the same from the
    /// view volumes of the file), or the cells of a table, which also hides what it hides
    #[arg(long, help_heading = "Viewer", value_name = "PLACE", default_value = "outside", allow_hyphen_values = true)]
    from: Vec<From>,
    /// Decide for whole objects, which are primitives of nodes: the default
    #[arg(long, help_heading = "Method")]
    parts: bool,
    /// Decide for each triangle
    #[arg(long, help_heading = "Method", conflicts_with_all = ["parts", "flag"])]
    triangles: bool,
    /// Openings through which no ball of this diameter fits count as closed, in scene units; 0 for none. For parts that touch each other without being joined
    #[arg(long, help_heading = "Method", value_name = "WIDTH", default_value_t = 0.0, value_parser = crate::numbers::size, allow_hyphen_values = true)]
    gap: f64,
    /// Objects that stay, by name; * stands for any text, ? for a character; may be given several times
    #[arg(long, help_heading = "Method", value_name = "PATTERN")]
    keep: Vec<NamePattern>,
    /// Ignore mirrors; otherwise scenes with mirrors are refused, because mirrors show hidden things
    #[arg(long, help_heading = "Method")]
    ignore_mirrors: bool,
    /// Cells of line space that all parts share that are not decided quickly; more decide more
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = StripOptions::default().effort.shared_cells)]
    effort: u64,
    /// Seed of the rays that look for what is seen
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = StripOptions::default().seed)]
    seed: u64,
    /// Number of threads; 0 uses every core. Does not change the result
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::numbers::threads)]
    threads: usize,
    /// Make nodes of which nothing is seen invisible by KHR_node_visibility instead of taking their meshes away
    #[arg(long, help_heading = "Output", conflicts_with = "compact")]
    flag: bool,
    /// Leave out vertices, accessors and meshes that nothing uses any more
    #[arg(long, help_heading = "Output")]
    compact: bool,
    /// The scene to write: in the format of the input, or with --compact and --triangles of a glTF as GLB
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb|OUT.gltf|OUT.obj", required_unless_present_any = ["report", "explain"])]
    output: Option<PathBuf>,
    /// Also write what was found for each object, as JSON
    #[arg(long, help_heading = "Output", value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Also print what was found for the objects with these names; patterns, as for --keep
    #[arg(long, help_heading = "Output", value_name = "PATTERN")]
    explain: Vec<NamePattern>,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &StripArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let outputs: Vec<&Path> = args.output.iter().chain(&args.report).map(PathBuf::as_path).collect();
    let tables = args.from.iter().filter_map(|from| match from {
        From::Table(path) | From::Cells(path) => Some(path.as_path()),
        _ => None,
    });
    output::check(&tables.collect::<Vec<_>>(), &outputs)?;
    let start = Instant::now();
    let table = from::table(&args.from)?;
    let info = table.as_ref().map_or(&[][..], |(_, table)| table.info());
    let ReadScene { file, source } = read(&args.scene, &args.surfaces.options_with(info))?;
    if let Some(path) = &args.output {
        check_format(args, path, source.as_ref())?;
    }
    let (eyes, along) = from::eyes(&args.from, table.as_ref(), &args.scene, &file)?;
    let scene = along.as_ref().unwrap_or(&file.scene);
    let is_kept = |name: &str| args.keep.iter().any(|pattern| pattern.matches(name));
    let keep = (0u32..).zip(scene.objects()).filter(|(_, of)| is_kept(&of.name)).map(|(k, _)| k).collect();
    let standard = StripOptions::default();
    let mut effort = standard.effort;
    effort.shared_cells = args.effort;
    let options = StripOptions {
        grain: if args.triangles { Grain::Triangles } else { Grain::Objects },
        gap: args.gap,
        keep,
        effort,
        ignore_mirrors: args.ignore_mirrors,
        seed: args.seed,
        threads: args.threads,
        ..standard
    };
    let bar = Bar::new("stripping", show_progress);
    let stripped = strip(scene, &eyes, &options, Some(&bar)).in_file(&args.scene)?;
    drop(bar);
    let parts = Part::all(scene, &stripped);
    let made = args.output.as_ref().map(|_| write(args, &file.scene, source.as_ref(), &stripped)).transpose()?;
    let from: Vec<String> = args.from.iter().map(ToString::to_string).collect();
    if let Some(path) = &args.report {
        let report =
            Report { version: REPORT_VERSION, scene: args.scene.display().to_string(), from: &from, parts: &parts };
        let text = serde_json::to_string(&report).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        output::save(path, text.as_bytes())?;
    }
    if let (Some(path), Some(made)) = (&args.output, &made) {
        output::save(path, &made.bytes)?;
    }
    let is_explained = |part: &Part| args.explain.iter().any(|pattern| pattern.matches(part.name()));
    let explained: Vec<Part> = parts.into_iter().filter(is_explained).collect();
    if !args.explain.is_empty() && explained.is_empty() {
        bail!("{}: --explain: no object has such a name", args.scene.display());
    }
    let outcome = Outcome::new(args, from, (scene, &stripped), made.as_ref(), explained, start.elapsed());
    Ok(Done::new(args.json, outcome))
}

/// Refuses names of outputs that are of another format than what is written.
fn check_format(args: &StripArgs, path: &Path, source: Option<&GltfSource>) -> Result<()> {
    let Some(source) = source else {
        if args.flag {
            bail!("{}: --flag is for glTF, and this is an OBJ", args.scene.display());
        }
        return output::check_ending(path, "OBJ scene", "obj");
    };
    if args.compact || args.triangles {
        OutFormat::of(path)?.check(path, Some(source))
    } else if source.is_glb() {
        output::check_ending(path, "scene", "glb")
    } else if output::has_ending(path, "gltf") {
        // Its buffers and images are found from its folder.
        let folder = |path: &Path| path.parent().map(Path::to_path_buf).unwrap_or_default();
        let is_beside = output::is_one_place(&folder(&args.scene).join("."), &folder(path).join("."));
        if is_beside {
            Ok(())
        } else {
            bail!(
                "{}: files that the glTF names are beside it, so what is written has to be too; or write a GLB with --compact",
                path.display()
            )
        }
    } else {
        bail!(
            "{}: a glTF text is written as one; give a name that ends in .gltf, or write a GLB with --compact",
            path.display()
        )
    }
}

/// The file without what is hidden.
fn write(args: &StripArgs, scene: &Scene, source: Option<&GltfSource>, stripped: &Stripped) -> Result<MadeFile> {
    let Some(source) = source else {
        // An OBJ has no objects without triangles.
        let rest = stripped.rest_of(scene).in_file(&args.scene)?;
        let left = rest.objects().iter().filter(|object| !object.triangles.is_empty()).cloned().collect();
        let rest = Scene::new(left).in_file(&args.scene)?;
        let bytes = write_simplified_obj(&rest, Simplification { occluder: true }).in_file(&args.scene)?;
        return Ok(MadeFile { bytes, n_stay: 0 });
    };
    if args.compact || args.triangles {
        let change = |(of, found): (&sightlines::cells::SceneObject, &sightlines::strip::ObjectFate)| {
            let left: Vec<[u32; 3]> =
                of.triangles.iter().enumerate().filter(|(t, _)| !found.hides(*t)).map(|(_, t)| *t).collect();
            (left.len() < of.triangles.len()).then_some(left)
        };
        let changes: Vec<_> = scene.objects().iter().zip(&stripped.objects).map(change).collect();
        let bytes = source.rewrite(&changes, None).in_file(&args.scene)?;
        return Ok(MadeFile { bytes, n_stay: 0 });
    }
    let hidden: Vec<bool> = stripped.objects.iter().map(|of| of.fate.is_hidden()).collect();
    let how = if args.flag { Removal::Flag } else { Removal::Delete };
    let removed = source.without(&hidden, how).in_file(&args.scene)?;
    let n_stay = removed.stay.iter().filter(|stay| **stay).count();
    Ok(MadeFile { bytes: removed.bytes, n_stay })
}
