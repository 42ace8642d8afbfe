//! Simplified variants of a scene for the cells of a table, within a memory budget.
//!
//! A cell's variant is what is left of the scene for eyes in that cell. Cells that see much the same share one:
//! variants are merged, those that grow least first, until all of them together fit.

mod groups;

use crate::hidden::{HiddenBy, Hider};
use crate::intercepts::Intercepts;
use crate::kept::{read_flags, read_simplified, write_flags};
use crate::mesh::Mesh;
use crate::options::SimplifyOptions;
use crate::select::{Account, least_visible};
use crate::simplified::Simplified;
use crate::simplify::{SimplifyError, check_mirrors, check_table, in_threads, within_budget};
use crate::views::Views;
use groups::{Bits, Groups};
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_progress::{Counter, Halt, Kept, Observer, Phase, Units, read_whole};
use sightlines_pvs::{CellId, Table};
use sightlines_visible_surface::Faces;
use std::collections::BTreeMap;

/// Options for levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelOptions {
    /// How to simplify for each group of cells.
    pub simplify: SimplifyOptions,
    /// Most bytes that all levels together may take.
    pub memory: u64,
    /// Bytes of a stored triangle: three indices and its share of vertices.
    pub bytes_per_triangle: u64,
}

impl Default for LevelOptions {
    /// No budget of rays, one part for each cell, 64 MiB, and a triangle with half a vertex of 32 bytes.
    fn default() -> Self {
        let simplify = SimplifyOptions { n_parts: 1, ..SimplifyOptions::default() };
        Self { simplify, memory: 64 << 20, bytes_per_triangle: 28 }
    }
}

/// A variant of the scene for some cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// The cells that it may be drawn for, ascending.
    pub cells: Vec<CellId>,
    /// What is left of the scene.
    pub simplified: Simplified,
    /// Its size, by the options' measure.
    pub n_bytes: u64,
}

/// Variants for cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// The level of each cell of the table.
    pub of_cell: Vec<u32>,
    /// The levels, by their first cells.
    pub levels: Vec<Level>,
}

/// Who is told how far the work is, and where results of its units are kept. Neither changes a result.
#[derive(Clone, Copy, Default)]
pub struct WorkOptions<'a> {
    /// Is told how far the work is, and may cancel it.
    pub observer: Option<&'a dyn Observer>,
    /// Where results are kept, to go on after a stop: what cells see (the phase `visible-faces`) and levels (`levels`). How many levels are tried is not known
    /// before, so a store is for one process.
    pub units: Units<'a>,
}

impl std::fmt::Debug for WorkOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("WorkOptions");
        out.field("observer", &self.observer.is_some()).field("units", &self.units).finish()
    }
}

/// Cells, one after the other in the table, about which a method is asked together.
const N_TOGETHER: usize = 64;

/// The phases of units of work.
const FACES: &str = "visible-faces";
const LEVELS: &str = "levels";

/// Makes levels for all cells of a table, whose cells have to be boxes.
///
/// * `by`: what proves faces hidden, in addition to the table itself
///
/// Each level keeps the guarantee of [`simplify`](crate::simplify) for all eyes in its cells. Memory counts triangles,
/// not files. Deterministic. Costs a simplification for each cell and each merged level, and for each cell the bounds
/// of what it may see; merging is quadratic in the number of cells in the worst case, times the number of triangles
/// over 64.
///
/// # Errors
/// [`SimplifyError`]; [`SimplifyError::Memory`] if a single level for all cells is too large.
pub fn levels(
    scene: &Scene,
    table: &Table,
    by: &HiddenBy<'_>,
    options: &LevelOptions,
) -> Result<Levels, SimplifyError> {
    levels_with(scene, table, by, options, &WorkOptions::default())
}

/// As [`levels()`], with an observer and a store of units.
///
/// # Errors
/// As there, and [`SimplifyError::Halted`] by either of them.
pub fn levels_with(
    scene: &Scene,
    table: &Table,
    by: &HiddenBy<'_>,
    options: &LevelOptions,
    effort: &WorkOptions<'_>,
) -> Result<Levels, SimplifyError> {
    options.simplify.check()?;
    check_mirrors(scene, &options.simplify)?;
    check_table(scene, table)?;
    in_threads(options.simplify.threads, || {
        let (whole, scene) = (scene, &*scene.still_part());
        let faces = Faces::of_scene(scene)?;
        let hider = Hider::new(&faces, &HiddenBy { method: by.method, table: Some(table) });
        let maker = LevelBuilder { whole, scene, table, faces: &faces, hider, mesh: Mesh::new(scene), options };
        let (visible, kept): (Vec<Vec<bool>>, Vec<Bits>) = maker.seen(effort)?.into_iter().unzip();
        let mut groups = Groups::new(table, kept, options.bytes_per_triangle);
        groups.merge_equal();
        let mut made: BTreeMap<Vec<CellId>, Level> = BTreeMap::new();
        // Each group of cells that comes to be is made once at most: there are as many merges as cells, less one.
        let most = (2 * table.n_cells()).saturating_sub(1);
        effort.units.begin(&Phase::new(LEVELS, &vec![1.0; most]))?;
        let mut n_made = 0;
        loop {
            let wanted = groups.cells();
            made.retain(|cells, _| wanted.contains(cells));
            let missing: Vec<&Vec<CellId>> = wanted.iter().filter(|cells| !made.contains_key(*cells)).collect();
            let counter = Counter::new(effort.observer, LEVELS, missing.len());
            let new = missing
                .par_iter()
                .enumerate()
                .map(|(k, cells)| {
                    counter.check().map_err(Halt::from)?;
                    let level = maker.kept_level(cells, &visible, (effort.units, n_made + k))?;
                    counter.step().map_err(Halt::from)?;
                    Ok(level)
                })
                .collect::<Result<Vec<Level>, SimplifyError>>()?;
            n_made += missing.len();
            made.extend(new.into_iter().map(|level| (level.cells.clone(), level)));
            let n_bytes = made.values().fold(0u64, |sum, level| sum.saturating_add(level.n_bytes));
            if n_bytes <= options.memory {
                return Ok(Levels::new(table.n_cells(), made.into_values().collect()));
            }
            // What is kept is about in proportion to what levels take.
            let share = n_bytes as f64 / groups.n_bytes().max(1) as f64;
            if !groups.merge_cheapest() {
                return Err(SimplifyError::Memory { asked: options.memory, least: n_bytes });
            }
            while groups.n_bytes() as f64 * share > options.memory as f64 && groups.merge_cheapest() {}
        }
    })
}

impl Levels {
    fn new(n_cells: usize, levels: Vec<Level>) -> Self {
        let mut of_cell = vec![0; n_cells];
        for (id, level) in (0..).zip(&levels) {
            level.cells.iter().for_each(|cell| of_cell[cell.idx()] = id);
        }
        Self { of_cell, levels }
    }

    /// Bytes of all levels.
    pub fn n_bytes(&self) -> u64 {
        self.levels.iter().fold(0, |sum, level| sum.saturating_add(level.n_bytes))
    }
}

/// What results of units are of.
const OF: &str = "this scene";

/// The input of levels.
struct LevelBuilder<'a> {
    whole: &'a Scene,
    /// What does not move.
    scene: &'a Scene,
    table: &'a Table,
    faces: &'a Faces,
    hider: Hider<'a>,
    mesh: Mesh,
    options: &'a LevelOptions,
}

impl LevelBuilder<'_> {
    /// For each cell the faces that may be visible, and those of them that remain.
    fn seen(&self, effort: &WorkOptions<'_>) -> Result<Vec<(Vec<bool>, Bits)>, SimplifyError> {
        let WorkOptions { observer, units } = *effort;
        let all: Vec<CellId> = (0..self.table.n_cells() as u32).map(CellId).collect();
        let parts: Vec<&[CellId]> = all.chunks(N_TOGETHER).collect();
        let costs: Vec<f64> = parts.iter().map(|cells| cells.len() as f64).collect();
        let counter = Counter::new(observer, "visible faces", parts.len());
        let part = |(unit, cells): (usize, &&[CellId])| {
            counter.check().map_err(Halt::from)?;
            let compute = || {
                let visible = self.hider.may_see(&Views::of_cells(self.table, cells)?)?;
                let kept: Vec<Bits> = cells
                    .par_iter()
                    .zip(&visible)
                    .map(|(&cell, visible)| self.kept(cell, visible))
                    .collect::<Result<_, SimplifyError>>()?;
                Ok::<Vec<_>, SimplifyError>(visible.into_iter().zip(kept).collect())
            };
            let read = |bytes: &[u8]| self.read_seen(bytes, cells.len());
            let (found, _) = units.value((FACES, unit, OF), compute, |found| self.write_seen(found), read)?;
            let found = found.ok_or(Halt::Shared)?;
            counter.step().map_err(Halt::from)?;
            Ok(found)
        };
        let found = units.through(&Phase::new(FACES, &costs), || {
            parts.par_iter().enumerate().map(part).collect::<Result<Vec<Vec<_>>, SimplifyError>>()
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    fn write_seen(&self, found: &[(Vec<bool>, Bits)]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (visible, kept) in found {
            write_flags(visible, &mut bytes);
            write_flags(&kept.flags(self.faces.len()), &mut bytes);
        }
        bytes
    }

    fn read_seen(&self, bytes: &[u8], n_cells: usize) -> Option<Vec<(Vec<bool>, Bits)>> {
        let n = self.faces.len();
        let one = |bytes: &mut &[u8]| Some((read_flags(bytes, n)?, Bits::of(&read_flags(bytes, n)?)));
        read_whole(bytes, |bytes| (0..n_cells).map(|_| one(bytes)).collect())
    }

    /// A level, kept or made and then kept.
    fn kept_level(
        &self,
        cells: &[CellId],
        visible: &[Vec<bool>],
        (units, unit): (Units<'_>, usize),
    ) -> Result<Level, SimplifyError> {
        let read = |bytes: &[u8]| Some(self.with_size(cells, read_simplified(bytes, self.whole)?));
        let compute = || self.level(cells, visible);
        let (level, _) = units.value((LEVELS, unit, OF), compute, |level| level.simplified.to_bytes(), read)?;
        Ok(level.ok_or(Halt::Shared)?)
    }

    fn with_size(&self, cells: &[CellId], simplified: Simplified) -> Level {
        let n_bytes = (simplified.counts.left as u64).saturating_mul(self.options.bytes_per_triangle);
        Level { cells: cells.to_vec(), simplified, n_bytes }
    }

    /// Those of the faces that may be visible for the eyes of one cell that remain, without collapsing: accurate enough to choose
    /// merges.
    fn kept(&self, cell: CellId, visible: &[bool]) -> Result<Bits, SimplifyError> {
        let mut kept = Bits::new(self.faces.len());
        let in_sight = || self.faces.ids().filter(|&f| visible[f as usize]);
        in_sight().for_each(|face| kept.set(face, true));
        let budget = self.options.simplify.budget;
        if budget > 0.0 {
            let views = Views::of_cells(self.table, &[cell])?;
            let intercepts =
                Intercepts::of_visible(self.faces, &views, &[visible.to_vec()], self.options.simplify.depth);
            let mut account = Account::new(1);
            least_visible(&intercepts, in_sight(), budget, &mut account, |face| kept.set(face, false));
        }
        Ok(kept)
    }

    /// * `visible`: for each cell the faces that may be visible
    fn level(&self, cells: &[CellId], visible: &[Vec<bool>]) -> Result<Level, SimplifyError> {
        let options = &self.options.simplify;
        let views = Views::of_cells(self.table, cells)?;
        let (views, intercepts) = if options.n_parts <= cells.len() {
            let of_cells = || cells.iter().map(|cell| &visible[cell.idx()]);
            let intercepts = if options.budget > 0.0 {
                let of_cells: Vec<Vec<bool>> = of_cells().cloned().collect();
                Intercepts::of_visible(self.faces, &views, &of_cells, options.depth)
            } else {
                let is_visible = |face: u32| of_cells().any(|visible| visible[face as usize]);
                Intercepts::of_any(&self.faces.ids().map(is_visible).collect::<Vec<bool>>())
            };
            (views, intercepts)
        } else {
            let views = views.cut(options.n_parts);
            let intercepts = Intercepts::of_hider(self.faces, &views, &self.hider, options.depth)?;
            (views, intercepts)
        };
        let simplified = within_budget(self.scene, self.faces, || self.mesh.clone(), &views, &intercepts, options);
        Ok(self.with_size(cells, simplified.with_moving_of(self.whole)))
    }
}
