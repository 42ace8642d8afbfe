//! Simplified variants of a scene for the cells of a table, within a memory budget.
//!
//! A cell's variant is what is left of the scene for eyes in that cell. Cells that see much the same share one:
//! variants are merged, those that grow least first, until all of them together fit.

use crate::hidden::{HiddenBy, Hider};
use crate::intercepts::Intercepts;
use crate::mesh::Mesh;
use crate::options::SimplifyOptions;
use crate::select::{Account, least_visible};
use crate::simplified::Simplified;
use crate::simplify::{SimplifyError, check_mirrors, check_table, in_threads, within_budget};
use crate::views::Views;
use rayon::prelude::*;
use sightlines_cells::Scene;
use sightlines_pvs::{CellId, Table};
use sightlines_visible_surface::Faces;
use std::collections::{BTreeMap, BTreeSet};

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
    options.simplify.check()?;
    check_mirrors(scene, &options.simplify)?;
    check_table(scene, table)?;
    in_threads(options.simplify.threads, || {
        let (whole, scene) = (scene, &*scene.still_part());
        let faces = Faces::of_scene(scene)?;
        let hider = Hider::new(&faces, &HiddenBy { method: by.method, table: Some(table) });
        let maker = LevelBuilder { whole, scene, table, faces: &faces, hider, mesh: Mesh::new(scene), options };
        let all: Vec<CellId> = (0..table.n_cells() as u32).map(CellId).collect();
        // A table may have no cells.
        let visible = if all.is_empty() { vec![] } else { maker.hider.may_see(&Views::of_cells(table, &all)?)? };
        let kept: Vec<Bits> = all
            .par_iter()
            .zip(&visible)
            .map(|(&cell, visible)| maker.kept(cell, visible))
            .collect::<Result<_, SimplifyError>>()?;
        let mut groups = Groups::new(table, kept, options.bytes_per_triangle);
        groups.merge_equal();
        let mut made: BTreeMap<Vec<CellId>, Level> = BTreeMap::new();
        loop {
            let wanted = groups.cells();
            made.retain(|cells, _| wanted.contains(cells));
            let missing: Vec<&Vec<CellId>> = wanted.iter().filter(|cells| !made.contains_key(*cells)).collect();
            let new = missing
                .par_iter()
                .map(|cells| maker.level(cells, &visible))
                .collect::<Result<Vec<Level>, SimplifyError>>()?;
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
        let simplified = simplified.with_moving_of(self.whole);
        let n_bytes = simplified.counts.left as u64;
        let n_bytes = n_bytes.saturating_mul(self.options.bytes_per_triangle);
        Ok(Level { cells: cells.to_vec(), simplified, n_bytes })
    }
}

/// A set of faces.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Bits(Vec<u64>);

impl Bits {
    fn new(n: usize) -> Self {
        Self(vec![0; n.div_ceil(64)])
    }

    fn set(&mut self, face: u32, to: bool) {
        let (word, bit) = (&mut self.0[face as usize / 64], 1 << (face % 64));
        *word = if to { *word | bit } else { *word & !bit };
    }

    fn count(&self) -> u64 {
        self.0.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    fn count_with(&self, other: &Self) -> u64 {
        self.0.iter().zip(&other.0).map(|(a, b)| u64::from((a | b).count_ones())).sum()
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a |= b);
    }
}

/// Cells that share their remaining faces.
struct Group {
    cells: Vec<CellId>,
    kept: Bits,
    n_kept: u64,
    /// Groups with which it may be merged.
    near: BTreeSet<usize>,
}

/// A partition of the cells.
struct Groups {
    /// `None` where one was merged into another.
    all: Vec<Option<Group>>,
    /// Pairs that may be merged, by the increase of stored triangles.
    pairs: BTreeSet<(i64, usize, usize)>,
    bytes_per_triangle: u64,
}

impl Groups {
    /// Each cell by itself. Two cells may be merged if a portal joins them, or if they are consecutive in the table.
    fn new(table: &Table, kept: Vec<Bits>, bytes_per_triangle: u64) -> Self {
        let n = kept.len();
        let mut near = vec![BTreeSet::new(); n];
        let mut join = |a: usize, b: usize| {
            if a != b {
                near[a].insert(b);
                near[b].insert(a);
            }
        };
        (1..n).for_each(|cell| join(cell - 1, cell));
        table.portals().iter().for_each(|p| join(p.cells[0].idx(), p.cells[1].idx()));
        let group = |((cell, kept), near): ((u32, Bits), BTreeSet<usize>)| {
            Some(Group { cells: vec![CellId(cell)], n_kept: kept.count(), kept, near })
        };
        let all: Vec<Option<Group>> = (0..).zip(kept).zip(near).map(group).collect();
        let mut groups = Self { all, pairs: BTreeSet::new(), bytes_per_triangle };
        for a in 0..n {
            let later: Vec<usize> = groups.group(a).near.iter().copied().filter(|b| *b > a).collect();
            later.into_iter().for_each(|b| groups.offer(a, b));
        }
        groups
    }

    fn group(&self, id: usize) -> &Group {
        self.all[id].as_ref().expect("only existing groups are looked up")
    }

    /// The cost of a merge: triangles of the union, minus those of both.
    fn cost(&self, a: usize, b: usize) -> i64 {
        let (a, b) = (self.group(a), self.group(b));
        a.kept.count_with(&b.kept) as i64 - a.n_kept as i64 - b.n_kept as i64
    }

    fn offer(&mut self, a: usize, b: usize) {
        self.pairs.insert((self.cost(a, b), a.min(b), a.max(b)));
    }

    fn n_bytes(&self) -> u64 {
        self.all.iter().flatten().map(|g| g.n_kept).sum::<u64>().saturating_mul(self.bytes_per_triangle)
    }

    fn cells(&self) -> BTreeSet<Vec<CellId>> {
        self.all.iter().flatten().map(|g| g.cells.clone()).collect()
    }

    /// Merges all groups with equal faces.
    fn merge_equal(&mut self) {
        let mut first: BTreeMap<Bits, usize> = BTreeMap::new();
        for id in 0..self.all.len() {
            let kept = self.group(id).kept.clone();
            match first.get(&kept) {
                Some(&other) => self.merge(other, id),
                None => drop(first.insert(kept, id)),
            }
        }
    }

    /// Merges the two that save most; returns whether there were two.
    fn merge_cheapest(&mut self) -> bool {
        match self.pairs.first() {
            Some(&(_, a, b)) => {
                self.merge(a, b);
                true
            }
            None => false,
        }
    }

    fn merge(&mut self, a: usize, b: usize) {
        for id in [a, b] {
            let near: Vec<usize> = self.group(id).near.iter().copied().collect();
            for other in near {
                let pair = (self.cost(id, other), id.min(other), id.max(other));
                self.pairs.remove(&pair);
            }
        }
        let Some(gone) = self.all[b].take() else { return };
        let into = self.all[a].as_mut().expect("only groups that are there are merged");
        into.cells.extend(gone.cells);
        into.cells.sort_unstable();
        into.kept.add(&gone.kept);
        into.n_kept = into.kept.count();
        into.near.extend(&gone.near);
        into.near.retain(|&id| id != a && id != b);
        let near: Vec<usize> = into.near.iter().copied().collect();
        for other in near {
            if let Some(other) = self.all[other].as_mut() {
                other.near.remove(&b);
                other.near.insert(a);
            }
            self.offer(a, other);
        }
    }
}
