//! Strategies for small well-formed sector plans, as a flat Doom map would be.
//!
//! A grid of squares has its corners moved a little, so that all cells stay convex; some cells are cut
//! into two triangles. Each cell gets a sector or none (solid). Lines are drawn between cells of
//! different sectors, and sometimes inside a sector; all sides that face a face then name its sector.

use proptest::prelude::*;
use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::Point2;
use std::collections::BTreeMap;

/// Distance between grid lines. Corners move by up to 1 along both axes, so a side has a length of at
/// least 3 along its axis and at most 2 across, and all angles stay below 180 degrees.
const STEP: i32 = 5;

type Corner = [i32; 2];

/// The small numbers that a plan is built from.
#[derive(Debug, Clone)]
struct Recipe {
    width: usize,
    n_sectors: u8,
    moved: Vec<Corner>,
    /// Per square: label of the one half and of the other (7 is solid), and how it is cut: 0 rising,
    /// 1 falling, otherwise not at all.
    squares: Vec<(u8, u8, u8)>,
    /// Per edge, in the order of their corners: what kind of line it becomes.
    edges: Vec<u8>,
    shear: [i32; 4],
}

/// A well-formed sector plan and the convex cells that it was made from.
#[derive(Debug, Clone)]
pub struct Sectors {
    cells: Vec<(Option<u32>, Vec<Corner>)>,
    lines: Vec<PlanLine>,
    shear: [i32; 4],
}

impl Sectors {
    /// The plan: sectors are groups, every line has its group on both sides (none towards solid
    /// space), a line with a side towards solid space is opaque, some others are too.
    pub fn plan(&self) -> Plan {
        Plan::new(self.lines.clone(), Vec::new()).expect("corners of a cell are distinct")
    }

    /// Every convex cell that belongs to a sector, with it; corners counter-clockwise.
    pub fn cells(&self) -> impl Iterator<Item = (u32, Vec<Point2>)> + '_ {
        let polygon = |corners: &[Corner]| corners.iter().map(|&c| sheared(c, self.shear)).collect();
        self.cells.iter().filter_map(move |(sector, corners)| Some((((*sector)?), polygon(corners))))
    }
}

/// 2 to 4 squares by 1 to 3, 2 to 7 sectors, some solid cells, some opaque lines between sectors, a
/// few lines with the same sector on both sides; sometimes sheared.
pub fn small_sectors() -> impl Strategy<Value = Sectors> {
    let shear = prop::sample::select(vec![[1, 0, 0, 1], [1, 1, 0, 1], [2, 1, 1, 1], [0, -1, 1, 0]]);
    let size = (2usize..=4, 1usize..=3, 2u8..=7, shear);
    let recipe = size.prop_flat_map(|(width, height, n_sectors, shear)| {
        let corner = [-1i32..=1, -1i32..=1];
        let moved = prop::collection::vec(corner, (width + 1) * (height + 1));
        let squares = prop::collection::vec((0u8..8, 0u8..8, 0u8..5), width * height);
        let edges = prop::collection::vec(0u8..24, 6 * (width + 1) * (height + 1));
        let drawn = (moved, squares, edges);
        drawn.prop_map(move |(moved, squares, edges)| Recipe { width, n_sectors, moved, squares, edges, shear })
    });
    recipe.prop_filter_map("a plan with a sector", |r| {
        let sectors = build(&r);
        (!sectors.lines.is_empty()).then_some(sectors)
    })
}

/// The plans of [`small_sectors`].
pub fn small_sector_plan() -> impl Strategy<Value = Plan> {
    small_sectors().prop_map(|sectors| sectors.plan())
}

fn sheared([x, y]: Corner, [a, b, c, d]: [i32; 4]) -> Point2 {
    Point2::new(f64::from(a * x + b * y), f64::from(c * x + d * y))
}

fn build(recipe: &Recipe) -> Sectors {
    let mut cells = cells(recipe);
    renumber(&mut cells);
    let mut sides: BTreeMap<[Corner; 2], [Option<u32>; 2]> = BTreeMap::new();
    for (sector, corners) in &cells {
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            // A cell is on the left of its sides.
            let (key, side) = if a < b { ([a, b], 0) } else { ([b, a], 1) };
            sides.entry(key).or_default()[side] = *sector;
        }
    }
    let lines = sides.iter().zip(&recipe.edges).filter_map(|((&ends, &groups), &kind)| {
        let [a, b] = ends.map(|c| sheared(c, recipe.shear));
        line(a, b, groups, kind)
    });
    Sectors { lines: lines.collect(), cells, shear: recipe.shear }
}

fn cells(recipe: &Recipe) -> Vec<(Option<u32>, Vec<Corner>)> {
    let columns = recipe.width + 1;
    let corner = |x: usize, y: usize| -> Corner {
        let [dx, dy] = recipe.moved[y * columns + x];
        let grid = |i: usize| STEP * i32::try_from(i).expect("a small grid");
        [grid(x) + dx, grid(y) + dy]
    };
    let mut cells = Vec::new();
    for (i, &(one, other, cut)) in recipe.squares.iter().enumerate() {
        let (x, y) = (i % recipe.width, i / recipe.width);
        let c = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        let sector = |label: u8| (label < 7).then_some(u32::from(label % recipe.n_sectors));
        let (one, other) = (sector(one), sector(other));
        match cut {
            0 => cells.extend([(one, vec![c[0], c[1], c[2]]), (other, vec![c[0], c[2], c[3]])]),
            1 => cells.extend([(one, vec![c[0], c[1], c[3]]), (other, vec![c[1], c[2], c[3]])]),
            _ => cells.push((one, c.to_vec())),
        }
    }
    cells
}

/// Makes the sectors that occur dense from 0.
fn renumber(cells: &mut [(Option<u32>, Vec<Corner>)]) {
    let mut used: Vec<u32> = cells.iter().filter_map(|(sector, _)| *sector).collect();
    used.sort_unstable();
    used.dedup();
    for sector in cells.iter_mut().filter_map(|(sector, _)| sector.as_mut()) {
        let rank = used.binary_search(sector).expect("it was collected above");
        *sector = u32::try_from(rank).expect("seven sectors at most");
    }
}

/// The line between two cells, if there is one; `kind` is below 24.
fn line(a: Point2, b: Point2, groups: [Option<u32>; 2], kind: u8) -> Option<PlanLine> {
    let [left, right] = groups;
    let opaque = match (left, right) {
        (None, None) => return None,
        // Inside a sector: a line in six, half of them opaque.
        (Some(l), Some(r)) if l == r && !kind.is_multiple_of(6) => return None,
        (Some(l), Some(r)) if l == r => kind.is_multiple_of(12),
        (Some(_), Some(_)) => kind % 12 < 5,
        _ => true,
    };
    let forward = PlanLine { a, b, opaque, left, right };
    let turned = PlanLine { a: b, b: a, opaque, left: right, right: left };
    Some(if kind.is_multiple_of(3) { turned } else { forward })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_geometry::{is_convex_ccw, signed_area};

    proptest! {
        #[test]
        fn sector_plans_are_well_formed(sectors in small_sectors()) {
            let plan = sectors.plan();
            let mut area = vec![0.0; plan.n_groups() as usize];
            for (sector, polygon) in sectors.cells() {
                prop_assert!(is_convex_ccw(&polygon), "{:?}", polygon);
                area[sector as usize] += signed_area(&polygon);
            }
            // By the sides that name it, every sector goes round the area of its cells.
            for l in plan.lines() {
                let twice = l.a.perp_dot(l.b);
                l.left.into_iter().for_each(|g| area[g as usize] -= 0.5 * twice);
                l.right.into_iter().for_each(|g| area[g as usize] += 0.5 * twice);
                prop_assert!(l.opaque || (l.left.is_some() && l.right.is_some()));
            }
            prop_assert!(area.iter().all(|&a| a == 0.0), "{:?}", area);
        }
    }

    /// Open lines, opaque lines between sectors, lines inside a sector and solid cells all occur.
    #[test]
    fn sector_plans_are_mixed() {
        let mut counts = [0; 4];
        for sectors in crate::draw(&small_sectors(), 100) {
            let some = |test: &dyn Fn(&PlanLine) -> bool| usize::from(sectors.lines.iter().any(test));
            counts[0] += some(&|l| !l.opaque);
            counts[1] += some(&|l| l.opaque && l.left.is_some() && l.right.is_some());
            counts[2] += some(&|l| l.left == l.right);
            counts[3] += usize::from(sectors.cells.iter().any(|(sector, _)| sector.is_none()));
        }
        assert!(counts.iter().all(|&n| n > 20), "{counts:?}");
    }
}
