//! Random segments between what the table hides from each other: not where something is likely to be found, but everywhere alike, so that what was not found has a bound.
//!
//! If a free segment joins a hidden pair, there are two places on it, the nearest to each other, that are hidden from each other: each is visible from the neighbours
//! of the other on the segment. So only pairs are looked at of which each sees a neighbour of the other ([`candidates`]): every false hidden segment
//! passes one of them.

use super::mixed;
use super::seen::Seen;
use super::ways::Ways;
use crate::findings::Sampled;
use crate::options::VerifyOptions;
use crate::real::RayOracle;
use crate::sight::{Sight, Target};
use rayon::prelude::*;
use sightlines_geometry::Random;
use sightlines_progress::{Cancelled, Counter, Observer};
use sightlines_pvs::{CellId, PortalId, Table};

/// Segments of all pairs together, at most: of tables with portals, by which nearly all are ruled out at once, and of others.
const MOST: [u64; 2] = [1 << 28, 1 << 22];

/// Shoots random segments at hidden pairs next to visible ones, as many at each; what they see, in the order of the pairs, and how many were shot.
pub(super) fn shoot<R: RayOracle>(
    world: &R,
    table: &Table,
    seen: &Seen,
    ways: Option<&Ways<'_>>,
    options: &VerifyOptions<'_>,
    observer: Option<&dyn Observer>,
) -> Result<(Vec<Sight>, Sampled), Cancelled> {
    let n_cells = table.n_cells();
    if R::SAMPLES == [false; 2] || options.segments == 0 {
        return Ok((Vec::new(), Sampled::default()));
    }
    let near = Near::new(world, table);
    let of_cell = |cell: u32| near.candidates(table, seen, CellId(cell));
    // Who is not convex may be left and entered again.
    let ways = ways.filter(|_| R::CELLS_ARE_CONVEX);
    let n_pairs: u64 = (0..n_cells as u32).into_par_iter().map(|cell| of_cell(cell).len() as u64).sum();
    let most = MOST[usize::from(ways.is_none())];
    let n_each = most.checked_div(n_pairs).unwrap_or(0).min(u64::from(options.segments)).max(1);
    let counter = Counter::new(observer, "random segments", n_cells);
    let shoot = |cell: u32| {
        let mut found = Vec::new();
        for target in of_cell(cell) {
            let mut random = Random::new(mixed(options.seed, super::suspects::hash_of(cell, target)));
            let gates = ways.map(|ways| near.gates(ways, table, seen, CellId(cell), target));
            let leads = |sight: &Sight| {
                let passes = |(ways, gates): (&Ways<'_>, &Gates)| {
                    gates.iter().flatten().all(|gates| ways.is_near_any(gates, sight.segment)) && ways.may_lead(sight)
                };
                ways.zip(gates.as_ref()).is_none_or(passes)
            };
            found.extend((0..n_each).find_map(|_| world.sample(cell, target, &mut random, &leads)));
        }
        counter.step().map(|()| found)
    };
    let found: Vec<Vec<Sight>> = (0..n_cells as u32).into_par_iter().map(shoot).collect::<Result<_, Cancelled>>()?;
    Ok((found.into_iter().flatten().collect(), Sampled { n_pairs, n_each }))
}

/// The portals by which a segment leaves the cell of a pair, and those by which it enters the other one, if that is a cell.
type Gates = [Option<Vec<PortalId>>; 2];

/// What is next to what.
struct Near<'w> {
    cells: &'w [Vec<u32>],
    /// For each object the cells that it touches; empty if objects are seen with the cells that they touch.
    touched: Vec<Vec<u32>>,
}

impl<'w> Near<'w> {
    fn new<R: RayOracle>(world: &'w R, table: &Table) -> Self {
        let has_objects = R::SAMPLES[1] && table.parts().objects_seen.is_some();
        let n_objects = if has_objects { table.objects().len() } else { 0 };
        let mut touched: Vec<Vec<u32>> = vec![Vec::new(); n_objects];
        for cell in (0..table.n_cells() as u32).filter(|_| n_objects > 0) {
            table.objects_of(CellId(cell)).iter().for_each(|o| touched[o.idx()].push(cell));
        }
        Self { cells: world.neighbours(), touched }
    }

    /// What is hidden from a cell although it sees something next to it, and something next to the cell sees it; cells with larger numbers only, each pair once.
    /// What nothing is next to is looked at as well.
    fn candidates(&self, table: &Table, seen: &Seen, cell: CellId) -> Vec<Target> {
        let own = &self.cells[cell.idx()];
        let any =
            |list: &[u32], sees: &dyn Fn(CellId) -> bool| list.is_empty() || list.iter().any(|&c| sees(CellId(c)));
        // By what is visible, so that large tables cost no more than they show.
        let mut others: Vec<u32> = if own.is_empty() {
            (cell.0 + 1..table.n_cells() as u32).collect()
        } else {
            let next = table.visible(cell).flat_map(|c| self.cells[c.idx()].iter().copied());
            next.chain((0u32..).zip(self.cells).filter(|(_, next)| next.is_empty()).map(|(lone, _)| lone)).collect()
        };
        others.retain(|&other| other > cell.0 && !table.sees(cell, CellId(other)));
        others.sort_unstable();
        others.dedup();
        others.retain(|&other| {
            let other = CellId(other);
            any(&self.cells[other.idx()], &|c| table.sees(cell, c)) && any(own, &|c| table.sees(other, c))
        });
        let cells = others.into_iter().map(|other| Target::Cell(CellId(other)));
        let objects = (0u32..).zip(&self.touched).filter(|&(object, touched)| {
            let target = Target::Object(object);
            !seen.has(cell, target) && any(touched, &|c| table.sees(cell, c)) && any(own, &|c| seen.has(c, target))
        });
        cells.chain(objects.map(|(object, _)| Target::Object(object))).collect()
    }

    /// The portals of a pair that lead into what its other side sees: no others are passed by the segments that this pair is looked at for.
    fn gates(&self, ways: &Ways<'_>, table: &Table, seen: &Seen, cell: CellId, target: Target) -> Gates {
        let other_side = |id: PortalId, of: CellId| {
            let [a, b] = ways.portal(id).cells;
            if a == of { b } else { a }
        };
        let gates = |of: CellId, sees: &dyn Fn(CellId) -> bool| {
            ways.portals_of(of).iter().copied().filter(|&id| sees(other_side(id, of))).collect()
        };
        let entries = match target {
            Target::Cell(to) => Some(gates(to, &|c| table.sees(cell, c))),
            Target::Object(_) => None,
        };
        [Some(gates(cell, &|c| seen.has(c, target))), entries]
    }
}
