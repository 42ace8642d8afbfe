//! Random segments between what the table hides from each other: not where something is likely to be found, but everywhere alike, so that what was not found has a bound.
//!
//! If a free segment joins a hidden pair, there are two cells on it, the nearest to each other, that are hidden from each other: each is visible from the neighbour
//! of the other on the segment. So where cells leave no gaps, only pairs are looked at of which each sees a neighbour of the other, and of these only segments
//! that pass such neighbours ([`Near`]): every free segment of a hidden pair is one of these, of this or of a nearer pair.

use super::mixed;
use super::seen::Seen;
use super::ways::Ways;
use crate::counts::Sampled;
use crate::options::VerifyOptions;
use crate::oracle::{RayOracle, Sample};
use crate::sight::{SightSegment, Target};
use rayon::prelude::*;
use sightlines_geometry::Random;
use sightlines_progress::{Cancelled, Counter, Observer};
use sightlines_pvs::{CellId, PortalId, Table};

/// Segments of all pairs together, at most: of tables with portals, by which nearly all are ruled out at once, and of others.
const MOST: [u64; 2] = [1 << 28, 1 << 22];
/// Where there are not even so many for each pair, pairs are chosen at random.
const LEAST_EACH: u64 = 16;
/// How often a segment is drawn again because an end was nowhere that is certain, as a multiple of the number of segments.
const REDRAWN: u64 = 16;

/// Shoots random segments at hidden pairs, as many at each; what they see, in the order of the pairs, and how many were shot.
pub(super) fn shoot<R: RayOracle>(
    world: &R,
    table: &Table,
    seen: &Seen,
    ways: Option<&Ways<'_>>,
    options: &VerifyOptions<'_>,
    observer: Option<&dyn Observer>,
) -> Result<(Vec<SightSegment>, Sampled), Cancelled> {
    let n_cells = table.n_cells();
    if R::SAMPLES == [false; 2] || options.segments == 0 {
        return Ok((Vec::new(), Sampled::default()));
    }
    let near = Near::new(world, table);
    // Who is not convex may be left and entered again.
    let ways = ways.filter(|_| R::CELLS_ARE_CONVEX);
    let n_all: u64 =
        (0..n_cells as u32).into_par_iter().map(|cell| near.candidates(table, seen, CellId(cell)).len() as u64).sum();
    let most = MOST[usize::from(ways.is_none())];
    let stride = (n_all * LEAST_EACH).div_ceil(most).max(1);
    let n_each = (most * stride).checked_div(n_all).unwrap_or(0).min(u64::from(options.segments));
    let counter = Counter::new(observer, "random segments", n_cells);
    let shoot = |cell: u32| {
        let (mut found, mut n_pairs) = (Vec::new(), 0u64);
        for target in near.candidates(table, seen, CellId(cell)) {
            let hash = super::suspects::hash_of(cell, target);
            if !hash.is_multiple_of(stride) {
                continue;
            }
            let mut random = Random::new(mixed(options.seed, hash));
            let gates = ways.map(|ways| near.gates(ways, table, seen, CellId(cell), target));
            let leads = |sight: &SightSegment| {
                let passes = |(ways, gates): (&Ways<'_>, &Gates)| {
                    gates.iter().flatten().all(|gates| ways.is_near_any(gates, sight.segment)) && ways.may_lead(sight)
                };
                ways.zip(gates.as_ref()).is_none_or(passes)
            };
            let mut left = n_each;
            for _ in 0..n_each.saturating_mul(REDRAWN) {
                match world.sample(cell, target, &mut random, &leads) {
                    Sample::Nowhere => continue,
                    Sample::Blocked => left -= 1,
                    Sample::Free(sight) => {
                        found.push(sight);
                        left = 0;
                    }
                }
                if left == 0 {
                    break;
                }
            }
            n_pairs += u64::from(left == 0);
        }
        counter.step().map(|()| (found, n_pairs))
    };
    let found: Vec<(Vec<SightSegment>, u64)> =
        (0..n_cells as u32).into_par_iter().map(shoot).collect::<Result<_, Cancelled>>()?;
    let n_pairs = found.iter().map(|found| found.1).sum();
    let sampled = if n_pairs == 0 { Sampled::default() } else { Sampled { n_pairs, n_each } };
    Ok((found.into_iter().flat_map(|found| found.0).collect(), sampled))
}

/// The portals by which a segment leaves the cell of a pair, and those by which it enters the other one, if that is a cell.
type Gates = [Option<Vec<PortalId>>; 2];

/// What is next to what.
struct Near<'w> {
    cells: &'w [Vec<u32>],
    /// For each object the cells that it touches; empty if objects are seen with the cells that they touch.
    touched: Vec<Vec<u32>>,
    /// Cells that nothing is next to, ascending.
    alone: Vec<u32>,
    /// Whether a segment may be outside of all cells on its way: then neighbours tell nothing.
    has_gaps: bool,
    /// Whether one cell may see another that does not see it.
    has_one_way: bool,
}

impl<'w> Near<'w> {
    fn new<R: RayOracle>(world: &'w R, table: &Table) -> Self {
        let has_objects = R::SAMPLES[1] && table.parts().objects_seen.is_some();
        let n_objects = if has_objects { table.objects().len() } else { 0 };
        let mut touched: Vec<Vec<u32>> = vec![Vec::new(); n_objects];
        for cell in (0..table.n_cells() as u32).filter(|_| n_objects > 0) {
            table.objects_of(CellId(cell)).iter().for_each(|o| touched[o.idx()].push(cell));
        }
        let cells = world.neighbours();
        let alone = (0u32..).zip(cells).filter(|(_, next)| next.is_empty()).map(|(cell, _)| cell).collect();
        Self { cells, touched, alone, has_gaps: table.kind().leaves_gaps(), has_one_way: world.has_one_way() }
    }

    /// What is hidden from a cell although it sees something next to it, and something next to the cell sees it; cells with larger numbers only, each pair once, unless the one may see
    /// the other that does not see it.
    /// What nothing is next to is looked at as well; where cells leave gaps, all that is hidden.
    fn candidates(&self, table: &Table, seen: &Seen, cell: CellId) -> Vec<Target> {
        let own = &self.cells[cell.idx()];
        let any = |list: &[u32], sees: &dyn Fn(CellId) -> bool| {
            self.has_gaps || list.is_empty() || list.iter().any(|&c| sees(CellId(c)))
        };
        // By what is visible, so that large tables cost no more than they show.
        let mut others: Vec<u32> = if own.is_empty() || self.has_gaps {
            (0..table.n_cells() as u32).collect()
        } else {
            let next = table.visible(cell).flat_map(|c| self.cells[c.idx()].iter().copied());
            next.chain(self.alone.iter().copied()).collect()
        };
        others.retain(|&other| {
            (other > cell.0 || other < cell.0 && self.has_one_way) && !table.sees(cell, CellId(other))
        });
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

    /// The portals of a pair that lead into what its other side sees: no others are passed by the segments that this pair is looked at for. None of a cell without
    /// portals.
    fn gates(&self, ways: &Ways<'_>, table: &Table, seen: &Seen, cell: CellId, target: Target) -> Gates {
        let other_side = |id: PortalId, of: CellId| {
            let [a, b] = ways.portal(id).cells;
            if a == of { b } else { a }
        };
        let gates = |of: CellId, sees: &dyn Fn(CellId) -> bool| {
            let own = ways.portals_of(of);
            (!own.is_empty()).then(|| own.iter().copied().filter(|&id| sees(other_side(id, of))).collect())
        };
        let entries = match target {
            Target::Cell(to) => gates(to, &|c| table.sees(cell, c)),
            Target::Object(_) => None,
        };
        [gates(cell, &|c| seen.has(c, target)), entries]
    }
}
