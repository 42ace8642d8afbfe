//! Sequences of portals, drawn along a line.
//!
//! A *spine*, a line in dyadic coordinates, is crossed by a portal at some of its places, in order. With the spine
//! inside, portals are drawn around the crossings; otherwise they are moved aside, so that some sequences are open and
//! others are not. All coordinates are exact, so the spine passes strictly.

use crate::conformance::Random;
use sightlines_geometry::{Aabb, AxialDoor, Point2, Portal2, Portal3, orient2d};
use std::sync::Arc;

/// A sequence of portals between convex cells.
#[derive(Debug)]
pub struct Case<P, B> {
    /// The portals, in order.
    pub portals: Vec<P>,
    /// Whether the spine passes all of them.
    pub has_spine: bool,
    /// For each portal, a box beyond it, in the cell behind it, whose inside the spine meets.
    pub beyond: Vec<B>,
}

/// A source of sequences.
#[derive(Debug, Clone, Copy)]
pub struct Cases<P, B> {
    /// Draws a sequence, with a line through it if asked to.
    pub draw: fn(&mut Random, bool) -> Case<P, B>,
    /// About a half of a portal: a smaller portal at the same place.
    pub half: fn(&P) -> P,
}

/// Doors in the plane, upright and slanted.
pub(super) const PLANAR: Cases<Portal2, Aabb<2>> =
    Cases { draw: planar, half: |portal| Portal2 { left: portal.left, right: (portal.left + portal.right) / 2.0 } };

/// Axis-aligned doors, on planes of all three axes.
pub(super) const AXIAL: Cases<AxialDoor, Aabb<3>> =
    Cases { draw: |random, has_spine| doors(random, has_spine).0, half: half_door };

/// Convex polygons with four to eight corners, on planes of all three axes.
pub(super) const CONVEX: Cases<Arc<Portal3>, Aabb<3>> = Cases { draw: convex, half: half_polygon };

/// Distances between the crossings of the spine, along its first axis.
const STEP: f64 = 1.0;

fn planar(random: &mut Random, has_spine: bool) -> Case<Portal2, Aabb<2>> {
    let n = 2 + random.below(8);
    let slope = random.sixteenth(-1.0, 2);
    let mut portals: Vec<Portal2> = Vec::new();
    for i in 0..n {
        let x = i as f64 * STEP;
        let y = x * slope + if has_spine { 0.0 } else { random.sixteenth(-1.75, 3) };
        let (up, down) = (random.sixteenth(0.0625, 2), random.sixteenth(0.0625, 2));
        let slanted = [0, 1].map(|_| random.sixteenth(0.0, 1) / 4.0);
        let upright = Portal2 { left: Point2::new(x, y + up), right: Point2::new(x, y - down) };
        // Its ends before and behind the crossing: the spine, whose slope is at most 1, still passes between them.
        let door = Portal2 {
            left: Point2::new(x + slanted[0], y + up + slanted[0]),
            right: Point2::new(x - slanted[1], y - down - slanted[1]),
        };
        let follows = |door: &Portal2| {
            // Each lies beyond the other's line, so there is a convex cell between them.
            portals.last().is_none_or(|before: &Portal2| {
                [door.left, door.right].into_iter().all(|p| orient2d(before.left, before.right, p) > 0.0)
                    && [before.left, before.right].into_iter().all(|p| orient2d(door.left, door.right, p) < 0.0)
            })
        };
        let next = [door, upright].into_iter().find(follows);
        portals.extend(next);
    }
    let beyond = portals.iter().map(|door| {
        // Behind every slanted end of this door and before every one of the next.
        let x = ((door.left.x + door.right.x) / 2.0).round() + 0.5;
        Aabb { min: [x - 0.0625, x * slope - 0.0625], max: [x + 0.0625, x * slope + 0.0625] }
    });
    let beyond = beyond.collect();
    Case { portals, has_spine, beyond }
}

/// Doors along a spine, with the boxes beyond them and, for each door, how far its sides are from the crossing at
/// least.
fn doors(random: &mut Random, has_spine: bool) -> (Case<AxialDoor, Aabb<3>>, Vec<f64>) {
    let n = 2 + random.below(8);
    let quarter = |random: &mut Random| {
        let size = (1 + random.below(4)) as f64 / 4.0;
        if random.coin() { size } else { -size }
    };
    let direction = [1.0, quarter(random), quarter(random)];
    let at = |t: f64| direction.map(|d| t * d);
    let axes: Vec<usize> = (0..n).map(|_| [0, 0, 0, 1, 2][random.below(5)]).collect();
    let mut doors: Vec<AxialDoor> = Vec::new();
    let mut margins = Vec::new();
    for (i, &axis) in axes.iter().enumerate() {
        let t = i as f64 * STEP;
        let crossing = at(t);
        let (mut min, mut max) = (crossing, crossing);
        for k in (0..3).filter(|&k| k != axis) {
            let aside = if has_spine { 0.0 } else { random.sixteenth(-1.0, 2) };
            min[k] += aside - random.sixteenth(0.0625, 1);
            max[k] += aside + random.sixteenth(0.0625, 1);
            // The neighbours' planes bound the cells on both sides.
            for (j, side) in [(i.wrapping_sub(1), -1.0), (i + 1, 1.0)] {
                if axes.get(j) == Some(&k) {
                    let plane = at(j as f64 * STEP)[k];
                    if side * direction[k] > 0.0 { max[k] = max[k].min(plane) } else { min[k] = min[k].max(plane) }
                }
            }
            if min[k] >= max[k] {
                // Moved behind a neighbour's plane: around the crossing instead.
                (min[k], max[k]) = (crossing[k] - 0.0625, crossing[k] + 0.0625);
            }
        }
        let sides = (0..3).filter(|&k| k != axis).flat_map(|k| [crossing[k] - min[k], max[k] - crossing[k]]);
        margins.push(sides.fold(f64::INFINITY, f64::min));
        doors.push(AxialDoor { extent: Aabb { min, max }, axis: axis as u8, forward: direction[axis] > 0.0 });
    }
    let beyond = (0..n).map(|i| {
        let p = at((i as f64 + 0.5) * STEP);
        Aabb { min: p.map(|x| x - 0.03125), max: p.map(|x| x + 0.03125) }
    });
    (Case { portals: doors, has_spine, beyond: beyond.collect() }, margins)
}

fn half_door(door: &AxialDoor) -> AxialDoor {
    let mut half = *door;
    let k = (usize::from(door.axis) + 1) % 3;
    half.extent.max[k] = (door.extent.min[k] + door.extent.max[k]) / 2.0;
    half
}

fn convex(random: &mut Random, has_spine: bool) -> Case<Arc<Portal3>, Aabb<3>> {
    let (case, margins) = doors(random, has_spine);
    let portals = case.portals.iter().zip(margins).map(|(door, margin)| {
        let cut = if random.coin() { 0.0 } else { margin.max(0.0) / 2.0 };
        Arc::new(polygon(door, cut))
    });
    Case { portals: portals.collect(), has_spine, beyond: case.beyond }
}

fn half_polygon(portal: &Arc<Portal3>) -> Arc<Portal3> {
    let corners = portal.corners();
    Arc::new(Portal3::around(&corners[..=corners.len() / 2]).expect("three corners of a convex polygon"))
}

/// A door as a polygon, with its corners cut off by these lengths along the sides.
fn polygon(door: &AxialDoor, cut: f64) -> Portal3 {
    let axis = usize::from(door.axis);
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let (min, max) = (door.extent.min, door.extent.max);
    let cut = cut.min((max[u] - min[u]) / 4.0).min((max[v] - min[v]) / 4.0);
    let point = |a: f64, b: f64| {
        let mut p = min;
        (p[u], p[v]) = (a, b);
        p
    };
    // Counter-clockwise about the axis; corners that are not cut coincide.
    let mut points = vec![
        point(min[u] + cut, min[v]),
        point(max[u] - cut, min[v]),
        point(max[u], min[v] + cut),
        point(max[u], max[v] - cut),
        point(max[u] - cut, max[v]),
        point(min[u] + cut, max[v]),
        point(min[u], max[v] - cut),
        point(min[u], min[v] + cut),
    ];
    if !door.forward {
        points.reverse();
    }
    Portal3::around(&points).expect("the door has an area")
}
