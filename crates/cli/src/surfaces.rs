//! What of a scene hides and what is only seen: arguments, and lines of reports.

use crate::output::count;
use schemars::JsonSchema;
use serde::Serialize;
use sightlines::bake::{Backs, stated_reading};
use sightlines::cells::Scene;
use sightlines::formats::SceneFile;
use sightlines::formats::scene::{BackFaces, NamePattern, Role, SceneInfo, SceneReadOptions};
use sightlines::pvs::Table;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Names that are listed of a kind of objects.
const MOST_NAMES: usize = 5;

/// How a scene is read, as arguments.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct SurfaceArgs {
    /// Scenes in space: objects that are seen and hide nothing, beside those with transparent materials; by the name of
    /// the object, node, mesh or material. * stands for any text, ? for a character; may be given several times
    #[arg(long, help_heading = "Input", value_name = "PATTERN")]
    see_through: Vec<NamePattern>,
    /// Scenes in space: objects that hide what is behind them, although their material is transparent; by the same names.
    /// --see-through is stronger, and what moves hides nothing
    #[arg(long, help_heading = "Input", value_name = "PATTERN")]
    opaque: Vec<NamePattern>,
    /// Scenes in space: objects that never move, although the file has animations, physics or other extensions that could
    /// move them; by the same names. Does not hold for skins and morph targets
    #[arg(long, help_heading = "Input", value_name = "PATTERN")]
    still: Vec<NamePattern>,
    /// glTF: what your engine does with the backs of single-sided faces (materials that are not doubleSided). either: such
    /// faces hide from their front only, and are seen from both sides, which is right for every engine, for viewers who are not
    /// inside of closed things; culled: they are seen from the front only; drawn: they hide from both sides. Closed objects hide
    /// from both sides in any case. To `render`, `light` and `multifocal`, which show walls and no views, such faces have two
    /// sides unless this says otherwise, and to `plan` always [default: either]
    #[arg(long, help_heading = "Input", value_name = "WHAT", conflicts_with_all = ["single_sided", "both_sides"])]
    backs: Option<BackFaces>,
    /// The old name of --backs culled; with --both-sides that of --backs either
    #[arg(long, hide = true)]
    single_sided: bool,
    /// The old name of --backs drawn
    #[arg(long, hide = true)]
    both_sides: bool,
    /// A glTF with several scenes: the one to read, by its name or index [default: the default scene]
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    scene_name: Option<String>,
}

impl SurfaceArgs {
    pub(crate) fn options(&self) -> SceneReadOptions {
        let Self { opaque, see_through, still, scene_name, .. } = self.clone();
        SceneReadOptions { opaque, see_through, still, backs: self.backs().unwrap_or_default(), scene: scene_name }
    }

    /// The same for what shows walls and no views: backs count as drawn where nothing is said.
    pub(crate) fn options_of_walls(&self) -> SceneReadOptions {
        SceneReadOptions { backs: self.backs().unwrap_or(BackFaces::Drawn), ..self.options() }
    }

    fn backs(&self) -> Option<BackFaces> {
        let old = match (self.single_sided, self.both_sides) {
            (false, false) => return self.backs,
            (true, false) => BackFaces::Culled,
            (false, true) => BackFaces::Drawn,
            (true, true) => BackFaces::Either,
        };
        tracing::warn!("--single-sided and --both-sides are old names: use --backs {}", old.name());
        Some(old)
    }

    /// The same, and what the scene of a table was read with, by the information of that table.
    pub(crate) fn options_with(&self, info: &[(String, String)]) -> SceneReadOptions {
        let (mut options, stated) = (self.options(), stated_reading(info));
        options.opaque.extend(stated.opaque);
        options.see_through.extend(stated.see_through);
        options.still.extend(stated.still);
        options.backs = self.backs().unwrap_or(stated.backs);
        options.scene = options.scene.or(stated.scene);
        options
    }

    pub(crate) fn given(&self) -> [(&'static str, bool); 5] {
        [
            ("--see-through", !self.see_through.is_empty()),
            ("--opaque", !self.opaque.is_empty()),
            ("--still", !self.still.is_empty()),
            ("--backs", self.backs.is_some() || self.single_sided || self.both_sides),
            ("--scene-name", self.scene_name.is_some()),
        ]
    }
}

/// Says on standard error what a user should hear of a scene's file.
pub(crate) fn warn(path: &Path, file: &SceneFile) {
    for warning in &file.info.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
}

/// Says on standard error how many objects a picture does not show because they hide nothing.
pub(crate) fn warn_not_drawn(path: &Path, file: &SceneFile) {
    let n = file.scene.see_through().len() as u64;
    if n > 0 {
        tracing::warn!("{}: see-through and not drawn: {}", path.display(), count(n, "object"));
    }
}

/// Objects that are classified alike, for the same reason.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct ClassGroup {
    /// How they were classified: `occluder` (hide although their material or an extension says otherwise), `see-through`, `detail`, `door` (all
    /// three are seen and hide nothing), `portal`, `view-volume` or `ignore` (not seen, and hide nothing).
    role: &'static str,
    /// Whether they move or change their shape; they are seen wherever they may be, and hide nothing.
    moves: bool,
    /// Why, for people: `alphaMode BLEND`, `an animation`, `the pattern glass*`.
    reason: String,
    /// How many they are.
    n_objects: usize,
    /// Names of the first few.
    names: Vec<String>,
}

/// What of a scene hides, and what does not.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Surfaces {
    /// How the objects that are not simply walls were classified, grouped by role and reason; the largest groups first.
    surfaces: Vec<ClassGroup>,
    /// Objects with the role `view-volume` that are ignored: those without a triangle that has an area, and all if the box around them is flat.
    n_ignored_view_volumes: usize,
    /// Names of the first few view volumes that are ignored.
    ignored_view_volumes: Vec<String>,
    /// Triangles that hide, of which engines may draw the fronts only.
    n_single_sided_triangles: usize,
    /// Those of them that hide from their front only, as they are not of a closed object.
    n_front_occluding_triangles: usize,
}

/// The surfaces of a scene, and how many backs viewers in the cells of a table can see.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct SeenSurfaces {
    #[serde(flatten)]
    pub(crate) all: Surfaces,
    /// If triangles that hide have one side: how many of them viewers in the cells of the table can see from behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    backs: Option<SeenBacks>,
}

/// Backs of single-sided triangles that can be seen.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct SeenBacks {
    /// An upper bound: those with a cell right behind them, or, of given cells and places, with any part of a cell behind their plane.
    n_at_most: usize,
    /// A lower bound: those whose back rays from cells met first, of those that the upper bound counts.
    n_by_rays: usize,
}

impl Surfaces {
    pub(crate) fn new(file: &SceneFile) -> Self {
        let SceneInfo { surfaces, n_single_sided_triangles, n_front_occluding_triangles, .. } = &file.info;
        let ignored_view_volumes = &file.info.ignored_view_volumes;
        let mut groups: BTreeMap<(Role, bool, &str), Vec<u32>> = BTreeMap::new();
        for found in surfaces {
            groups.entry((found.role, found.moves, &found.reason)).or_default().push(found.object);
        }
        let name = |object: &u32| file.scene.objects()[*object as usize].name.clone();
        let group = |((role, moves, reason), objects): ((Role, bool, &str), Vec<u32>)| ClassGroup {
            role: role.name(),
            moves,
            reason: reason.to_owned(),
            n_objects: objects.len(),
            names: objects.iter().take(MOST_NAMES).map(name).collect(),
        };
        let mut surfaces: Vec<ClassGroup> = groups.into_iter().map(group).collect();
        surfaces.sort_by_key(|group| std::cmp::Reverse(group.n_objects));
        Self {
            surfaces,
            n_ignored_view_volumes: ignored_view_volumes.len(),
            ignored_view_volumes: ignored_view_volumes.iter().take(MOST_NAMES).map(name).collect(),
            n_single_sided_triangles: *n_single_sided_triangles,
            n_front_occluding_triangles: *n_front_occluding_triangles,
        }
    }

    /// The same, with what viewers in the cells of a table of the scene can see from behind, unless both sides are drawn.
    pub(crate) fn seen(self, table: &Table, scene: &Scene) -> SeenSurfaces {
        let Backs { n_triangles, n_at_most, n_by_rays } = Backs::of(table, scene);
        SeenSurfaces { all: self, backs: (n_triangles > 0).then_some(SeenBacks { n_at_most, n_by_rays }) }
    }

    /// The same in few words: how many objects are what, and how many triangles have one side.
    pub(crate) fn brief(&self) -> Vec<String> {
        let mut kinds: Vec<(&str, usize)> = Vec::new();
        for group in &self.surfaces {
            // Doors are doors, whether they move or not.
            let kind = if group.moves && group.role == "see-through" { "moving" } else { group.role };
            match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, n)) => *n += group.n_objects,
                None => kinds.push((kind, group.n_objects)),
            }
        }
        let words = |(kind, n): (&str, usize)| match kind {
            "occluder" => format!("{n} taken for occluders"),
            "door" | "portal" => count(n as u64, kind),
            "view-volume" => count(n as u64, "view volume"),
            "ignore" => format!("{n} ignored"),
            kind => format!("{n} {kind}"),
        };
        let mut all: Vec<String> = kinds.into_iter().map(words).collect();
        if self.n_ignored_view_volumes > 0 {
            all.push(count(self.n_ignored_view_volumes as u64, "flat view volume") + " ignored");
        }
        if self.n_single_sided_triangles > 0 {
            let fronts = match self.n_front_occluding_triangles {
                0 => String::new(),
                n => format!(", of which {n} hide from their fronts only"),
            };
            all.push(count(self.n_single_sided_triangles as u64, "single-sided triangle") + &fronts);
        }
        all
    }
}

impl fmt::Display for Surfaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for group in &self.surfaces {
            let ClassGroup { role, moves, reason, n_objects, names } = group;
            let more = if names.len() < *n_objects { ", …" } else { "" };
            let objects = count(*n_objects as u64, if *moves { "moving object" } else { "object" });
            writeln!(f, "{role:<14} {objects}, classified by {reason}: {}{more}", names.join(", "))?;
        }
        if self.n_ignored_view_volumes > 0 {
            let (n, names) = (self.n_ignored_view_volumes, &self.ignored_view_volumes);
            let volumes = count(n as u64, "flat view volume");
            let more = if names.len() < n { ", …" } else { "" };
            writeln!(f, "ignored        {volumes}, where viewers have no room: {}{more}", names.join(", "))?;
        }
        if self.n_single_sided_triangles > 0 {
            let triangles = count(self.n_single_sided_triangles as u64, "triangle");
            let n = self.n_front_occluding_triangles;
            writeln!(
                f,
                "single-sided   {triangles}; {n} hide from their fronts only, and the others, of closed objects, from both sides"
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for SeenSurfaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.all)?;
        let Some(SeenBacks { n_at_most, n_by_rays }) = self.backs else { return Ok(()) };
        writeln!(
            f,
            "               from behind, viewers in cells see at most {n_at_most} of them; rays met {n_by_rays}"
        )
    }
}
