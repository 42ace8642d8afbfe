//! Which portals of two tables are the same.

use sightlines_eye_to_cell::CellSource;
use sightlines_pvs::{CellId, PortalId};
use std::collections::BTreeMap;

/// The corners of a portal, starting with the least one and in the lesser direction, so that they are equal from both
/// sides.
type Corners = Vec<[u64; 3]>;

/// For each portal of `old`, by number, the portal of `new` with the same corners, bit for bit; in any direction.
/// `None` if there is none, or several, or several in `old`; and for all of them if the tables stand along different axes
/// ([`CellSource::frame`]), where equal numbers are different places. Zeros of both signs are equal.
///
/// Reads the exits of all cells of both tables: O(portals · log portals); too slow for every frame.
///
/// # Errors
/// The first of a source.
pub fn same_portals<A, B>(old: &A, new: &B) -> Result<Vec<Option<PortalId>>, A::Error>
where
    A: CellSource + ?Sized,
    B: CellSource<Error = A::Error> + ?Sized,
{
    let (before, after) = (by_corners(old)?, by_corners(new)?);
    let n = before.values().flatten().map(|&portal| portal.idx() + 1).max().unwrap_or(0);
    let mut same = vec![None; n];
    if axes(old) != axes(new) {
        return Ok(same);
    }
    for (corners, portals) in &before {
        if let ([portal], Some([other])) = (&portals[..], after.get(corners).map(|list| &list[..])) {
            same[portal.idx()] = Some(*other);
        }
    }
    Ok(same)
}

/// The axes along which the corners of a source are.
fn axes<S: CellSource + ?Sized>(source: &S) -> [[f64; 3]; 3] {
    const PLAIN: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    source.frame().map_or(PLAIN, |frame| frame.axes())
}

/// The portals of each outline, ascending.
fn by_corners<S: CellSource + ?Sized>(source: &S) -> Result<BTreeMap<Corners, Vec<PortalId>>, S::Error> {
    let mut all: BTreeMap<Corners, Vec<PortalId>> = BTreeMap::new();
    for cell in (0..source.n_cells() as u32).map(CellId) {
        source.portal_edges(cell, &mut |way| {
            // Each portal is an exit of both its cells; one is enough.
            if way.forward {
                all.entry(canonical(way.corners)).or_default().push(way.portal);
            }
        })?;
    }
    all.values_mut().for_each(|portals| portals.sort_unstable());
    Ok(all)
}

fn canonical(corners: &[[f64; 3]]) -> Corners {
    // Adding zero makes a negative zero positive.
    let bits: Corners = corners.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    let turned = |corners: &Corners| {
        let mut corners = corners.clone();
        let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or(0);
        corners.rotate_left(least);
        corners
    };
    let mut back = bits.clone();
    back.reverse();
    turned(&bits).min(turned(&back))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_eye_to_cell::TableCells;
    use sightlines_pvs::{BitMatrix, CellRecord, Frame, Locator, PortalRecord, Table, TableKind, TableParts};

    /// Rooms in a row with these doors: their lower ends, and whether they are listed from the other side.
    fn row(doors: &[(u32, f64, bool)]) -> TableCells<Table> {
        let cells: Vec<CellRecord> = (0..4u32)
            .map(|i| CellRecord {
                min: [f64::from(i), 0.0, 0.0],
                max: [f64::from(i) + 1.0, 1.0, 0.0],
                group: None,
                polygon: vec![],
            })
            .collect();
        let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
        let door = |&(i, y, is_turned): &(u32, f64, bool)| {
            let x = f64::from(i) + 1.0;
            let (mut cells, mut points) = ([CellId(i), CellId(i + 1)], vec![[x, 0.75, 0.0], [x, y, 0.0]]);
            if is_turned {
                cells.reverse();
                points.reverse();
            }
            PortalRecord { cells, sides: [0, 1], points }
        };
        let parts = TableParts {
            rows: BitMatrix::identity(4),
            portals: doors.iter().map(door).collect(),
            cell_objects: vec![vec![]; 4],
            locator: Locator::build(&bounds, 2),
            cells,
            ..TableParts::empty(2, TableKind::Unspecified)
        };
        TableCells::new(Table::new(parts).unwrap())
    }

    #[test]
    fn portals_are_found_again() {
        let old = row(&[(0, 0.0, false), (1, 0.25, false), (2, 0.5, false)]);
        let new = row(&[(2, 0.5, true), (1, 0.3, false), (0, -0.0, false)]);
        assert_eq!(same_portals(&old, &new).unwrap(), [Some(PortalId(2)), None, Some(PortalId(0))]);
        assert_eq!(same_portals(&old, &old).unwrap(), [Some(PortalId(0)), Some(PortalId(1)), Some(PortalId(2))]);
        let twice = row(&[(0, 0.0, false), (0, 0.0, false)]);
        assert_eq!(same_portals(&twice, &old).unwrap(), [None, None]);
        assert_eq!(same_portals(&old, &twice).unwrap(), [None, None, None]);
        assert_eq!(same_portals(&row(&[]), &old).unwrap(), []);
    }

    /// Equal numbers along other axes are other places; a frame along the axes of the scene moves none.
    #[test]
    fn portals_along_other_axes_are_others() {
        let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let turned = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
        let along = |axes| {
            let cell = CellRecord { min: [0.0; 3], max: [1.0; 3], group: None, polygon: vec![] };
            let next = CellRecord { min: [1.0, 0.0, 0.0], max: [2.0, 1.0, 1.0], ..cell.clone() };
            let points = vec![[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
            let portal = PortalRecord { cells: [CellId(0), CellId(1)], sides: [0, 1], points };
            let cells = vec![cell, next];
            let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
            let parts = TableParts {
                rows: BitMatrix::identity(2),
                portals: vec![portal],
                cell_objects: vec![vec![]; 2],
                locator: Locator::build(&bounds, 3),
                cells,
                ..TableParts::empty(3, TableKind::Unspecified)
            };
            let frame = Frame::new(axes, 0.25).unwrap();
            TableCells::new(Table::new(parts).unwrap().with_frame(Some(frame)).unwrap())
        };
        let same = |a, b| same_portals(&along(a), &along(b)).unwrap();
        assert_eq!(same(turned, turned), [Some(PortalId(0))]);
        assert_eq!(same(plain, turned), [None]);
    }

    #[test]
    fn outlines_are_turned_to_one_form() {
        let square = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        let other = [square[2], square[1], square[0], square[3]];
        let crossed = [square[0], square[2], square[1], square[3]];
        assert_eq!(canonical(&square), canonical(&other));
        assert_ne!(canonical(&square), canonical(&crossed));
    }
}
