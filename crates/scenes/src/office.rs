//! Office floors: corridors, rooms of many sizes, meeting rooms, open-plan areas with pillars, desks.
//!
//! Everything is laid out on a grid of eighths of a unit (a unit is a metre). The layout is shared with
//! the floors of towers.

use crate::error::{GenerateError, check_range};
use crate::layout::{Layout, Piece, PieceKind, STEPS};
use crate::rng::Rng;
use crate::stroke::{Stroke, merge, outline};
use sightlines_cells::{Plan, PlanLine, PlanObject};
use sightlines_geometry::Aabb;

/// Options of [`office`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfficeOptions {
    /// Determines every random choice.
    pub seed: u64,
    /// Room places side by side in a row, from 1 to 128; some rooms take two places.
    pub rooms_x: u32,
    /// Rows of rooms, from 1 to 128.
    pub rooms_y: u32,
    /// Room places between two corridors that run across the rows, from 1 to 128.
    pub block: u32,
    /// Thickness of walls in units: 0 (a wall is a line), 0.25 or 0.5. Doors get narrower by it.
    pub wall_thickness: f64,
    /// Whether desks and tables are set up, as objects.
    pub furniture: bool,
}

impl Default for OfficeOptions {
    /// About 80 rooms with thin walls and furniture.
    fn default() -> Self {
        Self { seed: 1, rooms_x: 18, rooms_y: 6, block: 6, wall_thickness: 0.0, furniture: true }
    }
}

/// An office floor in metres with corner (0, 0), walls moved outwards by half their thickness. Axial,
/// coordinates are multiples of 1/8, the outer wall is closed, every room has a door to a corridor.
///
/// # Errors
/// [`GenerateError`] for a count out of its range or an unknown thickness.
pub fn office(options: OfficeOptions) -> Result<Plan, GenerateError> {
    let half = half_thickness(options.wall_thickness)?;
    let floor = build(&options)?;
    let strokes = if half == 0 {
        merge(all_strokes(&floor))
    } else {
        outline(&all_strokes(&floor).iter().map(|s| s.thick(half)).collect::<Vec<_>>())
    };
    let lines: Vec<PlanLine> = strokes.into_iter().map(|s| s.wall(STEPS)).collect();
    let objects = if options.furniture { objects(&floor.pieces) } else { Vec::new() };
    Ok(Plan::new(lines, objects).expect("walls on a grid of eighths make a plan"))
}

/// The layout of the floor.
fn build(options: &OfficeOptions) -> Result<Layout, GenerateError> {
    check_range("rooms_x", options.rooms_x, 1, 128)?;
    check_range("rooms_y", options.rooms_y, 1, 128)?;
    check_range("block", options.block, 1, 128)?;
    let mut floor = Layout::new(Rng::new(options.seed, 3), options.rooms_x, options.rooms_y, options.block);
    floor.build();
    Ok(floor)
}

/// Walls, and the sides of pillars.
fn all_strokes(floor: &Layout) -> Vec<Stroke> {
    floor.strokes.iter().copied().chain(floor.pillars.iter().flat_map(|&r| Stroke::sides(r))).collect()
}

/// Half the wall thickness in grid steps.
pub(crate) fn half_thickness(wall_thickness: f64) -> Result<i32, GenerateError> {
    [0.0, 0.25, 0.5]
        .iter()
        .zip(0..)
        .find_map(|(&t, half)| (t == wall_thickness).then_some(half))
        .ok_or(GenerateError::WallThickness(wall_thickness))
}

/// Desks and tables as objects of a plan.
fn objects(pieces: &[Piece]) -> Vec<PlanObject> {
    let unit = |x: i32| f64::from(x) / f64::from(STEPS);
    let object = |(i, &Piece { kind, rect: r, .. }): (usize, &Piece)| {
        let kind = match kind {
            PieceKind::Desk => "desk",
            PieceKind::Table => "table",
        };
        let bounds = Aabb { min: [unit(r.x0), unit(r.y0)], max: [unit(r.x1), unit(r.y1)] };
        PlanObject { name: format!("{kind}-{i}"), bounds }
    };
    pieces.iter().enumerate().map(object).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{checksum, outer_boundary_is_closed};

    fn thick(seed: u64) -> OfficeOptions {
        OfficeOptions { seed, wall_thickness: 0.25, ..OfficeOptions::default() }
    }

    #[test]
    fn office_is_deterministic_closed_and_axial() {
        let plans = [office(OfficeOptions::default()).unwrap(), office(thick(2)).unwrap()];
        assert_eq!(plans.each_ref().map(checksum), PINNED);
        for plan in &plans {
            assert!(plan.is_axial() && outer_boundary_is_closed(plan));
            assert!(plan.points().all(|p| (p * 8.0).fract() == glam::DVec2::ZERO));
        }
        assert_ne!(office(OfficeOptions { seed: 9, ..Default::default() }).unwrap(), plans[0]);
    }

    const PINNED: [u64; 2] = [12329706014378933290, 10390705085092429357];

    #[test]
    fn office_default_has_the_rooms_of_a_demo() {
        for seed in 0..50 {
            let n_rooms = build(&OfficeOptions { seed, ..Default::default() }).unwrap().rooms.len();
            assert!((60..=100).contains(&n_rooms), "{n_rooms} rooms from seed {seed}");
        }
    }

    /// Flood fill over squares of one grid step: all free space inside is connected, so every room has a door, and the
    /// outside is another component.
    fn free_pieces(options: &OfficeOptions) -> usize {
        let half = half_thickness(options.wall_thickness).unwrap();
        let floor = build(options).unwrap();
        // Twice as fine, so that thin walls occupy squares too.
        let (w, h) = ((2 * floor.outer.x1 + 17) as usize, (2 * floor.outer.y1 + 17) as usize);
        let mut wall = vec![false; w * h];
        for s in &all_strokes(&floor) {
            let r = s.thick(half);
            for y in 2 * r.y0 + 8..=2 * r.y1 + 8 {
                let row = y as usize * w;
                wall[row + (2 * r.x0 + 8) as usize..=row + (2 * r.x1 + 8) as usize].fill(true);
            }
        }
        // Pillars are hollow in a plan of thin walls: their small insides are not counted.
        let mut pieces = 0;
        for start in 0..w * h {
            if wall[start] {
                continue;
            }
            let (mut stack, mut size) = (vec![start], 0);
            wall[start] = true;
            while let Some(c) = stack.pop() {
                size += 1;
                let beside = [(c % w > 0, c.wrapping_sub(1)), (c % w + 1 < w, c + 1)];
                let above = [(c >= w, c.wrapping_sub(w)), (c + w < w * h, c + w)];
                for (_, n) in beside.into_iter().chain(above).filter(|&(inside, _)| inside) {
                    if !std::mem::replace(&mut wall[n], true) {
                        stack.push(n);
                    }
                }
            }
            pieces += usize::from(size > 100);
        }
        pieces
    }

    #[test]
    fn office_rooms_are_all_connected() {
        for seed in 0..5 {
            assert_eq!(free_pieces(&OfficeOptions { seed, ..Default::default() }), 2, "seed {seed}");
            assert_eq!(free_pieces(&thick(seed)), 2, "seed {seed}, thick walls");
        }
        let odd = OfficeOptions { rooms_x: 3, rooms_y: 1, block: 1, wall_thickness: 0.5, ..Default::default() };
        assert_eq!(free_pieces(&odd), 2);
    }

    #[test]
    fn office_sizes_scale() {
        let at = |rooms_x, rooms_y| office(OfficeOptions { rooms_x, rooms_y, ..Default::default() }).unwrap();
        assert!(at(32, 12).lines().len() > 2 * at(16, 6).lines().len());
        assert!(at(1, 1).lines().len() >= 5 && outer_boundary_is_closed(&at(1, 1)));
        assert!(outer_boundary_is_closed(&at(128, 128)));
        let plan = at(18, 6);
        let b = plan.bounds();
        assert!(plan.objects().len() > 60);
        assert!(plan.objects().iter().all(|o| b.contains(o.bounds.min) && b.contains(o.bounds.max)));
        let bare = office(OfficeOptions { furniture: false, ..Default::default() }).unwrap();
        assert!(bare.objects().is_empty() && bare.lines() == plan.lines());
    }

    #[test]
    fn office_options_are_checked() {
        let bad = |o: OfficeOptions| office(o).unwrap_err().to_string();
        let d = OfficeOptions::default();
        assert_eq!(bad(OfficeOptions { rooms_x: 0, ..d }), "rooms_x is 0, but must be from 1 to 128");
        assert_eq!(bad(OfficeOptions { rooms_y: 129, ..d }), "rooms_y is 129, but must be from 1 to 128");
        assert_eq!(bad(OfficeOptions { block: 0, ..d }), "block is 0, but must be from 1 to 128");
        let message = "wall thickness NaN is not one of 0, 0.25 and 0.5";
        assert_eq!(bad(OfficeOptions { wall_thickness: f64::NAN, ..d }), message);
    }
}
