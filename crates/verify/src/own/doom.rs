//! The REJECT lump of a Doom map.

use super::{LumpKind, OwnError, OwnSummary, OwnVisibility, Side, hidden_pairs};
use sightlines_cells::{CellGraph, ConvexCell2, Planar};
use sightlines_formats::{DoomMap, RejectTable};
use sightlines_pvs::{BitMatrix, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};

impl OwnVisibility {
    /// What the REJECT lump of a map says, for the cells of a subdivision of the map's plan, whose groups are sectors: rays need
    /// places to begin at.
    ///
    /// Where lines disagree about the sector of a cell, it is hidden only if it is whichever of them is meant. Bytes past the end of
    /// the lump's table do not count. Costs O(cells² + sectors²).
    ///
    /// # Errors
    /// [`OwnError::Missing`] without a lump or with an empty one, [`OwnError::Length`] for one that is too short.
    ///
    /// # Panics
    /// If a group of `graph` is no sector of the map.
    pub fn of_reject(map: &DoomMap, graph: &CellGraph<Planar>) -> Result<Self, OwnError> {
        let (reject, n_bytes) = reject_of(map)?;
        let groups: Vec<&[u32]> = graph.cells().iter().map(|cell| cell.groups.as_slice()).collect();

        let n = map.n_sectors();
        let mut hidden = BitMatrix::new(n as usize, n as usize);
        let mut seen = BitMatrix::new(n as usize, n as usize);
        for a in 0..n {
            for b in 0..n {
                hidden.set(a as usize, b as usize, reject.get(a, b));
                seen.set(a as usize, b as usize, !reject.get(a, b) && !reject.get(b, a));
            }
        }
        let sees = |x: &[u32], y: &[u32]| {
            let is_seen = |a: &u32| y.iter().any(|&b| seen.get(*a as usize, b as usize));
            x.is_empty() || y.is_empty() || x.iter().any(is_seen)
        };
        let mut rows = BitMatrix::identity(groups.len());
        for (x, of_x) in groups.iter().enumerate() {
            for (y, of_y) in groups.iter().enumerate().filter(|&(y, _)| y != x) {
                rows.set(x, y, sees(of_x, of_y));
            }
        }
        let mut has_places = vec![false; n as usize];
        groups.iter().filter(|list| list.len() == 1).for_each(|list| has_places[list[0] as usize] = true);
        let [n_hidden_pairs, n_hidden_one_way] = hidden_pairs(&hidden);
        let about = OwnSummary {
            lump: LumpKind::Reject,
            n_bytes,
            n_leafs: None,
            sides: "sector",
            n_sides: n as usize,
            n_hidden_pairs,
            n_hidden_one_way,
            n_uneven_clusters: 0,
        };
        let side_of = groups.iter().map(|list| list.first().copied()).collect();
        let side = |(k, has_places)| Side { name: format!("sector {k}"), has_places };
        let sides = has_places.into_iter().enumerate().map(side).collect();
        Ok(Self { table: table(graph, rows), about, side_of, sides, hidden })
    }
}

impl OwnVisibility {
    /// Refuses what [`of_reject`](Self::of_reject) refuses, before the map is cut into cells.
    ///
    /// # Errors
    /// As [`of_reject`](Self::of_reject).
    pub fn check_reject(map: &DoomMap) -> Result<(), OwnError> {
        reject_of(map).map(|_| ())
    }
}

/// The table that an engine reads from the lump, and the bytes of the lump.
fn reject_of(map: &DoomMap) -> Result<(RejectTable, usize), OwnError> {
    let lump = map.reject().filter(|lump| !lump.is_empty()).ok_or(OwnError::Missing(LumpKind::Reject))?;
    let needed = usize::try_from(RejectTable::byte_len(map.n_sectors())).unwrap_or(usize::MAX);
    let table = RejectTable::from_bytes(map.n_sectors(), lump.get(..needed).unwrap_or(lump));
    Ok((table.map_err(OwnError::Length)?, lump.len()))
}

/// The table of the cells.
fn table(graph: &CellGraph<Planar>, rows: BitMatrix) -> Table {
    let cells: Vec<CellRecord> = graph.cells().iter().map(cell_record).collect();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    let portals = graph.portals().iter().map(|p| {
        let points = [p.shape.left, p.shape.right].map(|p| [p.x, p.y, 0.0]).to_vec();
        PortalRecord { cells: p.cells, sides: p.sides, points }
    });
    let parts = TableParts {
        portals: portals.collect(),
        rows,
        cell_objects: vec![Vec::new(); cells.len()],
        locator: Locator::build(&bounds, 2),
        cells,
        ..TableParts::empty(2, TableKind::PlanTriangulation)
    };
    Table::new(parts).expect("cells and portals of a graph, and rows that were made symmetric")
}

fn cell_record(cell: &ConvexCell2) -> CellRecord {
    let bounds = cell.bounds();
    let lift = |[x, y]: [f64; 2]| [x, y, 0.0];
    CellRecord {
        min: lift(bounds.min),
        max: lift(bounds.max),
        // Where lines disagree, the first sector speaks for the cell.
        group: cell.groups.first().copied(),
        polygon: cell.polygon.iter().map(|p| [p.x, p.y]).collect(),
    }
}
