//! What can go wrong, as one line for the user.

use crate::commands::render::RenderError;
use crate::commands::walk::{Found, PathError, UnlikeLevels};
use sightlines::bake::quake::StateError;
use sightlines::bake::region::GridError;
use sightlines::bake::{BakeError, CertifyError, PrtBakeError, RegionBakeError, RejectError, StabBakeError};
use sightlines::eye_to_cell::{Method, ViewError};
use sightlines::formats::quake::VisibilityError;
use sightlines::formats::reject::RejectLengthError;
use sightlines::formats::scene::{RewriteError, SceneWriteError};
use sightlines::formats::{ReadError, WriteError};
use sightlines::multifocal::{BackendError, JobError, PlaneError, VolumeError};
use sightlines::packed::{PackError, PackedError};
use sightlines::pvs::DecodeError;
use sightlines::report::{DrawError, PngError};
use sightlines::scenes::SceneError;
use sightlines::simplify::{SimplifyError, ViewsError};
use sightlines::verify::{ProofError, VerifyError};
use std::io;
use std::path::{Path, PathBuf};

/// Why a command failed; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// A WAD, a plan or a scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Open { path: PathBuf, source: io::Error },
    /// A file is no sound table.
    #[error("{}: {source}", path.display())]
    Table { path: PathBuf, source: DecodeError },
    /// A file is no sound packed table.
    #[error("{}: {source}", path.display())]
    Packed { path: PathBuf, source: PackedError },
    /// A packed table where a plain one is needed.
    #[error("{}: the table is packed; `sightlines unpack` makes it a plain one, which this command takes", path.display())]
    IsPacked { path: PathBuf },
    /// A table cannot be packed.
    #[error("{}: {source}", path.display())]
    Pack { path: PathBuf, source: PackError },
    /// A file is none of the kinds that the command takes.
    #[error("{}: neither {expected}", path.display())]
    Kind { path: PathBuf, expected: &'static str },
    /// A scene is written as GLB, so its name should say so.
    #[error("{}: the scene is written as GLB; give a name that ends in .glb", path.display())]
    NotGlb { path: PathBuf },
    /// A WAD without maps.
    #[error("{}: there are no maps in the file", .0.display())]
    NoMaps(PathBuf),
    /// A WAD with several maps, and none was named.
    #[error("{}: there are {} maps in the file; choose one with --map: {}", path.display(), names.len(), list(names))]
    WhichMap { path: PathBuf, names: Vec<String> },
    /// A map that is not in the WAD.
    #[error("{}: there is no map {name} in the file; there are {}", path.display(), list(names))]
    NoSuchMap { path: PathBuf, name: String, names: Vec<String> },
    /// `--map` for something without maps.
    #[error("{}: --map is for WADs, and this is none", .0.display())]
    MapOfPlan(PathBuf),
    /// An option that means nothing for what the file holds.
    #[error("{}: {option} is for {meant}, and this is {found}", path.display())]
    Option { path: PathBuf, option: &'static str, meant: &'static str, found: &'static str },
    /// A plan or a scene cannot be baked.
    #[error("{}: {}{source}", path.display(), of_map(map.as_ref()))]
    Bake { path: PathBuf, map: Option<String>, source: BakeError },
    /// A scene cannot be baked by what is hidden from its cells.
    #[error("{}: {source}", path.display())]
    BakeRegion { path: PathBuf, source: RegionBakeError },
    /// Buffers too large to be kept.
    #[error("{}: {planes} planes on each side with {texels} texels along a side take up to {bytes} bytes for each thread; {most} are allowed", path.display())]
    Buffers { path: PathBuf, planes: u32, texels: u32, bytes: u64, most: u64 },
    /// There is no such grid of cells.
    #[error("{}: {source}", path.display())]
    Grid { path: PathBuf, source: GridError },
    /// A portal file, or the map that it is of, cannot be baked.
    #[error("{}: {source}", path.display())]
    BakePrt { path: PathBuf, source: PrtBakeError },
    /// A table cannot have proofs.
    #[error("{}: {source}", path.display())]
    Certify { path: PathBuf, source: CertifyError },
    /// Proofs cannot be compared with a table.
    #[error("{}: {source} (the table is {})", path.display(), table.display())]
    Proofs { path: PathBuf, table: PathBuf, source: ProofError },
    /// Strictness without proofs.
    #[error("{}: --strict is for tables with proofs, and there are none: no --proofs, and no {}", path.display(), beside.display())]
    NoProofs { path: PathBuf, beside: PathBuf },
    /// A table cannot have stab trees.
    #[error("{}: {source}", path.display())]
    Stab { path: PathBuf, source: StabBakeError },
    /// A portal file of another map.
    #[error("{}: does not go with {}: {source}", prt.display(), bsp.display())]
    OtherMap { prt: PathBuf, bsp: PathBuf, source: Box<VisibilityError> },
    /// A Quake map where its portals are needed, without a portal file beside it.
    #[error("{}: a map does not have its portals, and there is no {} beside it: qbsp writes that file with the map, unless the map leaks; \
             one elsewhere is named with --prt FILE.prt", .0.display(), name_with(.0, "prt"))]
    MapWithoutPortals(PathBuf),
    /// A portal file where the map is needed that it is of.
    #[error("{}: these are the portals of a map, and the map itself is needed: {command} {} --prt {}", path.display(),
            path.with_extension("bsp").display(), path.display())]
    PortalsForMap { path: PathBuf, command: &'static str },
    /// What a table is built from, where the table is needed.
    #[error("{}: is {found}, not a table: build one first: sightlines build {}{} -o {}", path.display(), path.display(),
            if *found == SOME_WAD { " --map NAME" } else { "" }, path.with_extension("pvs").display())]
    NotTable { path: PathBuf, found: &'static str },
    /// A table that does not know where its cells are.
    #[error("{}: the table is of a portal file, which does not say where its cells are: {what}", path.display())]
    NoPlaces { path: PathBuf, what: &'static str },
    /// A point where a portal file, or the table of one, has no places.
    #[error("{}: a portal file does not say where its clusters are: name them by their numbers", .0.display())]
    NoPoints(PathBuf),
    /// A cluster that a portal file does not have.
    #[error("{}: there is no cluster {cluster}: there are {n_clusters}", path.display())]
    NoSuchCluster { path: PathBuf, cluster: u32, n_clusters: usize },
    /// What was found out about two clusters contradicts what is listed of them.
    #[error("{}: clusters {} and {} are listed as {listed}, but {found}; nothing was written", path.display(), pair[0], pair[1])]
    Contradiction { path: PathBuf, pair: [u32; 2], listed: &'static str, found: &'static str },
    /// The state of a search is none that can be resumed.
    #[error("{}: {source}; without --resume the search begins anew", path.display())]
    State { path: PathBuf, source: StateError },
    /// Something else is where the state of the search would be written.
    #[error("{}: this is no state of a search, and would be overwritten; name another with --state", .0.display())]
    NotState(PathBuf),
    /// The REJECT lumps of a WAD cannot be built.
    #[error("{}: {source}", path.display())]
    Reject { path: PathBuf, source: RejectError },
    /// A cell that the table does not have.
    #[error("{}: there is no cell {cell}: the table has {n_cells} cells", path.display())]
    NoSuchCell { path: PathBuf, cell: u32, n_cells: usize },
    /// A portal that the table does not have.
    #[error("{}: there is no portal {portal}: the table has {n_portals} portals", path.display())]
    NoSuchPortal { path: PathBuf, portal: u32, n_portals: usize },
    /// A direction, or what else says how a viewer looks, that is none.
    #[error("{option}: {source}")]
    View { option: &'static str, source: ViewError },
    /// An angle of view, and nothing that says where it is looked.
    #[error("--fov, --aspect and --up need --dir: without it the viewer looks all round")]
    LensWithoutDirection,
    /// A path that cannot be walked.
    #[error("{}: {source}", path.display())]
    Path { path: PathBuf, source: PathError },
    /// A table in which nobody can walk.
    #[error("{}: no cell has a portal, so there is nowhere to go; name a path with --path", .0.display())]
    NoWay(PathBuf),
    /// A method found something that a coarser one did not find: our own fault.
    #[error("{}: frame {frame}: {finer} finds {what}, which {coarser} does not; this is a defect of the program", path.display())]
    Nesting { path: PathBuf, frame: usize, finer: Method, coarser: Method, what: Found },
    /// A point with the wrong number of coordinates.
    #[error("{}: the table has {dimension} dimensions, but the point has {found} coordinates", path.display())]
    Dimension { path: PathBuf, dimension: u8, found: usize },
    /// A table whose cells and portals are not there, so that no lines can be sought.
    #[error("{}: the table has no polygons and portals to look for lines in", .0.display())]
    Stripped(PathBuf),
    /// A floor plan of which nobody said where it lies.
    #[error("{}: a floor plan of a scene in space needs --height (cells reach from {low} to {high}), --eye or --cell; \
             without, there is --isometric", path.display())]
    WhichHeight { path: PathBuf, low: f64, high: f64 },
    /// A table that cannot be of the scene that it is to be checked against.
    #[error("{}: is no table of {}: {source}", table.display(), scene.display())]
    Verify { table: PathBuf, scene: PathBuf, source: VerifyError },
    /// A map without visibility of its own.
    #[error("{}: {}there is no {what} to check, or an empty one; {command} writes it", path.display(), of_map(map.as_ref()))]
    NoOwn { path: PathBuf, map: Option<String>, what: &'static str, command: &'static str },
    /// The own visibility of a map cannot be read.
    #[error("{}: {source}", path.display())]
    OwnVisibility { path: PathBuf, source: Box<VisibilityError> },
    /// The REJECT lump of a map has another length than its sectors need.
    #[error("{}: map {map}: {source}", path.display())]
    OwnLength { path: PathBuf, map: String, source: RejectLengthError },
    /// The REJECT lump of another map.
    #[error("{}: is no map of {}: it has {} sectors, not {}", path.display(), scene.display(), n_sectors[0], n_sectors[1])]
    OwnSectors { path: PathBuf, scene: PathBuf, n_sectors: [u32; 2] },
    /// The own visibility of a map, and a scene of another kind.
    #[error("{}: is a map, whose own visibility is checked against {needed}; {} is none", path.display(), scene.display())]
    OwnScene { path: PathBuf, scene: PathBuf, needed: &'static str },
    /// A scene cannot be generated.
    #[error(transparent)]
    Generate(#[from] SceneError),
    /// A scene cannot be written as GLB.
    #[error("{}: {source}", path.display())]
    Glb { path: PathBuf, source: SceneWriteError },
    /// A picture cannot be drawn.
    #[error("{}: {source}", path.display())]
    Draw { path: PathBuf, source: DrawError },
    /// A picture cannot be rendered.
    #[error("{}: {source}", path.display())]
    Png { path: PathBuf, source: PngError },
    /// A picture whose name does not say which kind it is.
    #[error("{}: the name of a picture ends in .svg or .png", .0.display())]
    PictureKind(PathBuf),
    /// A picture that is always PNG, and is not called so.
    #[error("{}: the picture is written as PNG; give a name that ends in .png", .0.display())]
    NotPng(PathBuf),
    /// Two outputs for one file.
    #[error("{}: two outputs would be written to this file", .0.display())]
    TwoOutputs(PathBuf),
    /// A box that is no volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// A plane on which no buffer can be.
    #[error("--plane {plane}: {source}")]
    Plane { plane: String, source: PlaneError },
    /// A plane with eyes on both sides, or on it.
    #[error(
        "--plane {plane}: the plane goes through the view volume, which reaches from {axis}={low} to {axis}={high}"
    )]
    PlaneInVolume { plane: String, axis: &'static str, low: f64, high: f64 },
    /// A plane and a volume that do not go together.
    #[error("--plane {plane}: {source}")]
    Job { plane: String, source: JobError },
    /// Nobody could fill the buffer.
    #[error("{}: {source}", path.display())]
    Backend { path: PathBuf, source: BackendError },
    /// What one eye sees cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A scene whose triangles were moved, where something is to hide.
    #[error("{}: the scene was simplified and its triangles were moved, so that it may hide what can be seen: use the original \
             that it was made from", .0.display())]
    NoOccluder(PathBuf),
    /// A scene that cannot be simplified.
    #[error("{}: {source}", path.display())]
    Simplify { path: PathBuf, source: SimplifyError },
    /// Places of the eye that are none.
    #[error("{}: {source}", path.display())]
    Views { path: PathBuf, source: ViewsError },
    /// A scene that cannot be written again.
    #[error("{}: {source}", path.display())]
    Rewrite { path: PathBuf, source: RewriteError },
    /// An index of levels for another table.
    #[error("{}: {source}", path.display())]
    LevelsOf { path: PathBuf, source: UnlikeLevels },
    /// A folder that holds what nobody asked to be replaced.
    #[error("{}: the folder has {name:?} in it, which is no level: name a new folder, or one that only holds levels", path.display())]
    NotLevels { path: PathBuf, name: String },
    /// An output file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A folder cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// An output that would replace the input it is made from.
    #[error("{}: the output would replace the input", .0.display())]
    SameFile(PathBuf),
    /// Standard output cannot be written.
    #[error("standard output: {0}")]
    Print(io::Error),
}

/// Names the map of a file, if it has one.
fn of_map(map: Option<&String>) -> String {
    map.map_or(String::new(), |name| format!("map {name}: "))
}

/// A WAD, as [`CliError::NotTable`] calls it.
pub(crate) const SOME_WAD: &str = "a WAD";

/// The name of a file, without its folder, with another ending.
fn name_with(path: &Path, ending: &str) -> String {
    path.with_extension(ending).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn list(names: &[String]) -> String {
    const MOST: usize = 40;
    let shown = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}
