//! What to bake, by the names that every face of the project has for it.

use crate::error::Meaningless;
use crate::eye_level::EyeLevelOptions;
use crate::gap::Gap;
use crate::input::BakeInput;
use crate::methods::{Backend, BufferOptions};
use crate::options::{Recipe, SceneMethod};
use crate::places::PlaceOptions;
use crate::region::CellsFrom;
use crate::subdivide::Subdivide;
use sightlines_geometry::Aabb;
use sightlines_kdtree::SceneOptions;
use sightlines_multifocal::Split;
use sightlines_progress::{Budget, Observer, Units};
use std::fmt;

/// What to bake: one request for inputs of every kind. Nothing said means the best that is known for the input.
///
/// What means nothing for an input, or for a method that was named, is refused by name when the request is
/// [prepared](BakeRequest::prepare). Everything but the threads and the observer is here, so a request says which table
/// is made, byte for byte.
///
/// With the feature `serde` it is read from JSON, by the names of the program's options with `_` for `-`; `"cells"` takes a name, or what a file of
/// cells holds:
///
/// ```
/// # #[cfg(feature = "serde")]
/// # let _ = || {
/// use sightlines_bake::{BakeRequest, CellsFrom};
///
/// let request = BakeRequest::from_json(r#"{"grid": [8, 1, 6], "method": "line-space"}"#)?;
/// assert_eq!(request.cells, Some(CellsFrom::Grid([8, 1, 6])));
/// # Ok::<(), sightlines_bake::RequestError>(())
/// # };
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(try_from = "crate::named::Named"))]
pub struct BakeRequest {
    /// Scenes: the cells. None: those of a k-d tree where nearly all walls are perpendicular to an axis, where there are mirrors, and for
    /// sightlines alone; else cells at the height of [eyes](crate::eye_level), or [`places`](crate::places) where viewers may fly.
    pub cells: Option<CellsFrom>,
    /// Scenes: the width of cells that are not named, at most, in scene units: of those at the height of eyes, or else of [`places`](crate::places),
    /// which then take the place of cells of a k-d tree. None: by their kind.
    pub cell_size: Option<f64>,
    /// Scenes: what decides. None: what the properties of the scene suggest, as for [`SceneMethod::Auto`]; sightlines alone for what has
    /// [proofs or stab trees](Self::for_proofs), and for cells of a k-d tree with mirrors, of which they report what does not reflect.
    pub method: Option<SceneMethod>,
    /// Plans and scenes: how precise coordinates are. In plans it decides which ends of walls are joined to others; in scenes whether walls that
    /// are nearly across an axis, of the file or of the building, are taken to be so.
    pub gap: Gap,
    /// Scenes: where viewers can be, in scene units. None: the box around the view volumes that the file states, unless the cells are
    /// given boxes; else the box of the scene.
    pub view_region: Option<Aabb<3>>,
    /// Scenes: objects smaller than this in every direction, in scene units, are drawn and hide nothing from sightlines; 0 for none.
    /// None: chosen from the scene.
    pub detail_below: Option<f64>,
    /// Scenes: fail if there are more cells. None: 65,536.
    pub max_cells: Option<u32>,
    /// Scenes: keep the insides of solids as cells, for eyes that can get into them.
    pub keep_solid: bool,
    /// K-d trees: split only along walls that cover at least this share of a cell, from 0 to 1. None: 0, every wall.
    pub tau: Option<f64>,
    /// Plans: how to cut. None: by the directions and groups of its walls.
    pub subdivide: Option<Subdivide>,
    /// Scenes by [`OcclusionMethod::Multifocal`](crate::methods::OcclusionMethod::Multifocal): how buffers and sheets are made.
    pub buffers: BufferRequest,
    /// Scenes by a from-region method: when a cell is cut into smaller volumes. None: never.
    pub split: Option<Split>,
    /// Scenes: objects of more triangles than this are split into parts of at most that many, and the table lists which cells may see each part
    /// ([`ObjectPart`](sightlines_pvs::ObjectPart)). None: no object is split.
    pub parts: Option<u32>,
    /// Quake maps and portal files: only the first, coarse bound; quick, and shows much that is hidden.
    pub fast: bool,
    /// Whether proofs or stab trees are to be made, which are of sightlines through portals. Cells that are not named are then those of a k-d
    /// tree, and a method that is not named is sightlines alone, unless the cells that are named have no portals. Where there are portals, walls
    /// that hide from one side only hide nothing from sightlines, but where two stand back to back: portals have no sides.
    pub for_proofs: bool,
}

/// How multifocal buffers and sheets are made. `None` takes the default of [`BufferOptions`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BufferRequest {
    /// Planes on each side of a cell; 0 for no buffers.
    pub planes: Option<u32>,
    /// Texels along the longer side of a plane.
    pub texels: Option<u32>,
    /// The most occluders drawn on each side of a cell.
    pub occluders: Option<u32>,
    /// Whether what is known on a plane is carried over to the next one.
    pub carry: Option<bool>,
    /// The most edges of triangles visited to find a sheet; 0 for no sheets.
    pub sheets: Option<u32>,
    /// What draws the buffers.
    pub backend: Option<Backend>,
}

impl BufferRequest {
    /// These options with every default filled in.
    pub fn options(&self) -> BufferOptions {
        let standard = BufferOptions::default();
        let Self { planes, texels, occluders, carry, sheets, backend } = *self;
        BufferOptions {
            planes: planes.unwrap_or(standard.planes),
            texels: texels.unwrap_or(standard.texels),
            occluders: occluders.unwrap_or(standard.occluders),
            carry: carry.unwrap_or(standard.carry),
            sheets: sheets.unwrap_or(standard.sheets),
            backend: backend.unwrap_or(standard.backend),
            ..standard
        }
    }

    /// The names of all options, and whether each was named.
    const fn named(&self) -> [(&'static str, bool); 6] {
        let Self { planes, texels, occluders, carry, sheets, backend } = self;
        [
            ("planes", planes.is_some()),
            ("texels", texels.is_some()),
            ("occluders", occluders.is_some()),
            ("carry", carry.is_some()),
            ("sheets", sheets.is_some()),
            ("backend", backend.is_some()),
        ]
    }
}

/// On what a bake runs, and who hears of it. Nothing of it changes the table, but for a budget that is spent.
#[derive(Clone, Copy)]
pub struct Runtime<'a> {
    /// Number of threads; 0 for one for each core.
    pub threads: usize,
    /// Receives reports, and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// Scenes: what may be spent, such as time. What is not decided then counts as visible, and the table depends on when that was; see
    /// [`LimitReport`](crate::LimitReport).
    pub budget: Option<&'a dyn Budget>,
    /// Where results of units of work are kept, to go on after a stop or to share a bake among processes.
    pub units: Units<'a>,
    /// Called with a line for people, such as when one backend takes over from another.
    pub warn: fn(&str),
}

impl Default for Runtime<'_> {
    fn default() -> Self {
        Self { threads: 0, progress: None, budget: None, units: Units::default(), warn: |_| {} }
    }
}

impl fmt::Debug for Runtime<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Runtime").field("threads", &self.threads).finish_non_exhaustive()
    }
}

/// What takes options that others do not.
const SCENES: &str = "scenes in space";

impl BakeRequest {
    /// Whether sightlines alone decide because proofs or stab trees are to be made, which are of cells with portals.
    pub(crate) fn is_for_proofs_alone(&self) -> bool {
        self.method.is_none() && self.for_proofs && self.has_portals()
    }

    /// Whether a method is named, or an option of one, that means nothing for cells at the height of eyes, or would take each of the thousands by
    /// itself.
    pub(crate) fn is_for_places(&self) -> bool {
        !matches!(self.method, None | Some(SceneMethod::Auto))
            || self.split.is_some()
            || self.tau.is_some()
            || self.detail_below.is_some()
            || self.keep_solid
    }

    /// Whether cells of a scene are joined by portals if [proofs or stab trees](Self::for_proofs) are to be made.
    fn has_portals(&self) -> bool {
        self.cell_size.is_none() && self.cells.as_ref().is_none_or(CellsFrom::have_portals)
    }

    /// Cells that are not named, as wide as is asked for.
    pub(crate) fn of_width(&self, own: CellsFrom) -> CellsFrom {
        match (self.cell_size, own) {
            (None, own) => own,
            (cell_size, CellsFrom::EyeLevel(how)) => CellsFrom::EyeLevel(EyeLevelOptions { cell_size, ..how }),
            (cell_size, _) => CellsFrom::Places(PlaceOptions { n_cells: None, cell_size }),
        }
    }

    /// What is known without the input.
    pub(crate) fn recipe(&self) -> Recipe {
        let standard = SceneOptions::default();
        Recipe {
            subdivide: self.subdivide.unwrap_or_default(),
            cut: SceneOptions {
                view_region: self.view_region,
                tau: self.tau.unwrap_or(standard.tau),
                detail_below: self.detail_below,
                max_cells: self.max_cells.unwrap_or(standard.max_cells),
                keep_solid: self.keep_solid,
                only_both_sides: self.for_proofs && self.has_portals(),
            },
            frame: None,
            digest: None,
            method: SceneMethod::Sightlines,
            cells: CellsFrom::KdTree,
            buffers: self.buffers.options(),
            split: self.split.unwrap_or_default(),
            surroundings: Vec::new(),
            parts: self.parts,
            fast: self.fast,
        }
    }

    /// Options that mean something for scenes only, and whether each was named.
    fn of_scenes(&self) -> [(&'static str, bool); 11] {
        let cells = |is: fn(&CellsFrom) -> bool| self.cells.as_ref().is_some_and(is);
        let is_auto = matches!(self.method, None | Some(SceneMethod::Auto));
        [
            ("view_region", self.view_region.is_some()),
            ("detail_below", self.detail_below.is_some()),
            ("max_cells", self.max_cells.is_some()),
            ("keep_solid", self.keep_solid),
            ("method", !is_auto),
            ("cells", cells(|cells| matches!(cells, CellsFrom::Boxes(_) | CellsFrom::KdTree))),
            ("grid", cells(|cells| matches!(cells, CellsFrom::Grid(_)))),
            ("eye_height", cells(|cells| matches!(cells, CellsFrom::EyeLevel(_)))),
            ("n_cells", cells(|cells| matches!(cells, CellsFrom::Places(_)))),
            ("cell_size", self.cell_size.is_some()),
            ("parts", self.parts.is_some()),
        ]
    }

    /// Refuses what means nothing for an input.
    pub(crate) fn check(&self, input: &BakeInput<'_>) -> Result<(), Meaningless> {
        let refuse = |named: &[(&'static str, bool)], meant, found| match named.iter().find(|(_, is_named)| *is_named) {
            Some(&(option, _)) => Err(Meaningless { option, meant, found }),
            None => Ok(()),
        };
        let found = match input {
            BakeInput::Plan(_) => "a plan",
            BakeInput::Scene(..) => "a scene in space",
            BakeInput::Portals(_) | BakeInput::Map(..) => "a portal file",
        };
        if !matches!(input, BakeInput::Plan(_)) {
            refuse(&[("subdivide", self.subdivide.is_some())], "plans", found)?;
        }
        if self.subdivide == Some(Subdivide::Triangulation) {
            refuse(&[("tau", self.tau.is_some())], "k-d trees", "a triangulation")?;
        }
        if matches!(input, BakeInput::Portals(_) | BakeInput::Map(..)) {
            let named = [("tau", self.tau.is_some()), ("gap", self.gap != Gap::OfFile)];
            refuse(&named, "plans and scenes in space", found)?;
        } else {
            refuse(&[("fast", self.fast)], "portal files", found)?;
        }
        let by = [("split", self.split.is_some())];
        if !matches!(input, BakeInput::Scene(..)) {
            refuse(&self.of_scenes(), SCENES, found)?;
            refuse(&self.buffers.named(), SCENES, found)?;
            return refuse(&by, SCENES, found);
        }
        let parts = [("parts", self.parts.is_some())];
        if let BakeInput::Scene(scene, _) = input
            && !scene.mirrors().is_empty()
        {
            refuse(&parts, "scenes without mirrors", "a scene with mirrors")?;
        }
        if self.for_proofs {
            refuse(&parts, "tables alone", "a bake with proofs or stab trees")?;
        }
        refuse(&[("parts", self.parts == Some(0))], "numbers of triangles from 1 on", "0")?;
        let are_given = matches!(self.cells, Some(CellsFrom::Boxes(_)));
        refuse(&[("view_region", self.view_region.is_some() && are_given)], "cells that are cut", "given boxes")?;
        let are_boxes = are_given || matches!(self.cells, Some(CellsFrom::Grid(_)));
        let found = if are_given { "given boxes" } else { "a grid" };
        refuse(&[("keep_solid", self.keep_solid && are_boxes)], "cells that are cut along walls", found)?;
        let are_named = self.cells.is_some();
        refuse(&[("cell_size", self.cell_size.is_some() && are_named)], "cells that are not named", "named cells")?;
        let at_eyes = matches!(self.cells, Some(CellsFrom::EyeLevel(_)));
        let named = [("keep_solid", self.keep_solid && at_eyes), ("split", self.split.is_some() && at_eyes)];
        refuse(&named, "other cells", "cells at the height of eyes")?;
        let method =
            self.method.unwrap_or(if self.is_for_proofs_alone() { SceneMethod::Sightlines } else { SceneMethod::Auto });
        if !method.has_buffers() {
            let found = if method == SceneMethod::Auto { "the method chosen by the scene" } else { method.name() };
            refuse(&self.buffers.named(), "the methods multifocal and both", found)?;
        }
        if !method.by_sightlines() && !self.has_portals() {
            let named = [("tau", self.tau.is_some()), ("detail_below", self.detail_below.is_some())];
            refuse(&named, "the cells of a k-d tree and for sightlines", method.name())?;
        }
        if method == SceneMethod::Sightlines {
            refuse(&by, "methods that look from whole cells", method.name())?;
        }
        Ok(())
    }
}

/// Refuses parts of objects where tables cannot have them.
pub(crate) fn refuse_parts(parts: Option<u32>, found: &'static str) -> Result<(), Meaningless> {
    let refused = Meaningless { option: "parts", meant: "tables that are made in memory", found };
    parts.map_or(Ok(()), |_| Err(refused))
}
