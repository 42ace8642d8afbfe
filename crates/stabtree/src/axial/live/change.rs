//! Where walls were added and where they were removed.

use super::super::opaque::{Field, MAX_FIELDS, Painting, Patch, Plane, key, others};
use super::matching::{Matching, same_boxes};
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::Aabb;
use std::collections::BTreeMap;

/// How the walls of two graphs differ.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Change {
    /// Closed rectangles that cover all walls that were added, and maybe more.
    pub(super) closed: Vec<Aabb<3>>,
    /// Closed rectangles that cover all walls that were removed, and maybe more.
    pub(super) opened: Vec<Aabb<3>>,
}

/// A plane that has changed.
struct Site {
    at: f64,
    /// The part of it that contains all differences.
    region: Patch,
    /// What lies in that part, before and after.
    planes: [Plane; 2],
}

type Sites = BTreeMap<(usize, u64), Site>;

/// How the walls of `new` differ from those of `old`.
///
/// Only planes where cells or portals differ are examined. O(cells + portals), plus the cost of painting those parts.
pub(super) fn between(old: &CellGraph<Axial>, new: &CellGraph<Axial>, cells: &Matching) -> Change {
    let mut sites = Sites::new();
    let removed = old.cells().iter().zip(&cells.new_of).filter(|(_, new)| new.is_none());
    let added = new.cells().iter().zip(&cells.old_of).filter(|(_, old)| old.is_none());
    for (cell, _) in removed.chain(added) {
        for (axis, at) in sides(&cell.bounds) {
            touch(&mut sites, axis, at, &patch(&cell.bounds, axis));
        }
    }
    let extents =
        |graph: &CellGraph<Axial>| -> Vec<Aabb<3>> { graph.portals().iter().map(|p| p.shape.extent).collect() };
    let portals = Matching::of(&same_boxes(&extents(old), &extents(new)), old.portals().len());
    let removed = old.portals().iter().zip(&portals.new_of).filter(|(_, new)| new.is_none());
    let added = new.portals().iter().zip(&portals.old_of).filter(|(_, old)| old.is_none());
    for (portal, _) in removed.chain(added) {
        let axis = usize::from(portal.shape.axis);
        touch(&mut sites, axis, portal.shape.at(), &patch(&portal.shape.extent, axis));
    }
    if sites.is_empty() {
        return Change::default();
    }
    for (which, graph) in [old, new].into_iter().enumerate() {
        for cell in graph.cells() {
            for (axis, at) in sides(&cell.bounds) {
                if let Some(site) = sites.get_mut(&(axis, key(at))) {
                    site.planes[which].walls.extend(common(&patch(&cell.bounds, axis), &site.region));
                }
            }
        }
        for portal in graph.portals() {
            let axis = usize::from(portal.shape.axis);
            if let Some(site) = sites.get_mut(&(axis, key(portal.shape.at()))) {
                site.planes[which].portals.extend(common(&patch(&portal.shape.extent, axis), &site.region));
            }
        }
    }
    let mut change = Change::default();
    for ((axis, _), site) in sites {
        site.compare(&mut |patch, which| {
            let [u, v] = others(axis);
            let (mut min, mut max) = ([site.at; 3], [site.at; 3]);
            (min[u], min[v], max[u], max[v]) = (patch.min[0], patch.min[1], patch.max[0], patch.max[1]);
            let rectangles = if which == 0 { &mut change.opened } else { &mut change.closed };
            rectangles.push(Aabb { min, max });
        });
    }
    change
}

fn sides(b: &Aabb<3>) -> impl Iterator<Item = (usize, f64)> + use<> {
    let b = *b;
    (0..3).flat_map(move |axis| [(axis, b.min[axis]), (axis, b.max[axis])])
}

fn patch(b: &Aabb<3>, axis: usize) -> Patch {
    let [u, v] = others(axis);
    Patch { min: [b.min[u], b.min[v]], max: [b.max[u], b.max[v]] }
}

fn touch(sites: &mut Sites, axis: usize, at: f64, patch: &Patch) {
    let new = || Site { at, region: Patch::EMPTY, planes: [Plane::default(), Plane::default()] };
    let site = sites.entry((axis, key(at))).or_insert_with(new);
    site.region = site.region.with(patch.min).with(patch.max);
}

/// The part of a patch in a region, if it has an area.
fn common(patch: &Patch, region: &Patch) -> Option<Patch> {
    let part = Patch {
        min: [0, 1].map(|k| patch.min[k].max(region.min[k])),
        max: [0, 1].map(|k| patch.max[k].min(region.max[k])),
    };
    (0..2).all(|k| part.min[k] < part.max[k]).then_some(part)
}

impl Site {
    /// Passes on rectangles that cover walls before and not after, with 0, and walls after and not before, with 1.
    fn compare(&self, give: &mut impl FnMut(Patch, usize)) {
        let [before, after] = &self.planes;
        let both = Plane {
            walls: before.walls.iter().chain(&after.walls).copied().collect(),
            portals: before.portals.iter().chain(&after.portals).copied().collect(),
            ..Plane::default()
        };
        let (us, vs) = (both.lines(0), both.lines(1));
        if us.len().saturating_mul(vs.len()) > MAX_FIELDS {
            // Too large to paint: anything there may differ.
            for (which, plane) in self.planes.iter().enumerate() {
                plane.walls.iter().for_each(|wall| give(*wall, which));
            }
            return;
        }
        let painted = [before, after].map(|plane| Painting::new(plane, us.clone(), vs.clone()));
        let width = us.len().saturating_sub(1);
        for which in [0, 1] {
            let fields = painted[which].fields.iter().zip(&painted[1 - which].fields);
            let only = fields.map(|(own, other)| *own == Field::Wall && *other != Field::Wall);
            cover(only.collect(), width, &mut |u, v| {
                give(Patch { min: [us[u[0]], vs[v[0]]], max: [us[u[1]], vs[v[1]]] }, which);
            });
        }
    }
}

/// Covers fields, given row by row, with disjoint rectangles of them.
fn cover(mut open: Vec<bool>, width: usize, give: &mut impl FnMut([usize; 2], [usize; 2])) {
    for field in 0..open.len() {
        if !open[field] {
            continue;
        }
        let (u, v) = (field % width, field / width);
        let height = open.len() / width;
        let wide = (u + 1..width).find(|&k| !open[v * width + k]).unwrap_or(width);
        let row = |k: usize| open[k * width + u..k * width + wide].iter().all(|open| *open);
        let high = (v + 1..height).find(|&k| !row(k)).unwrap_or(height);
        let down = (v + 1..height).find(|&k| !open[k * width + u]).unwrap_or(height);
        let column = |k: usize| (v..down).all(|v| open[v * width + k]);
        let along = (u + 1..width).find(|&k| !column(k)).unwrap_or(width);
        let (u1, v1) = if (wide - u) * (high - v) >= (along - u) * (down - v) { (wide, high) } else { (along, down) };
        (v..v1).for_each(|k| open[k * width + u..k * width + u1].fill(false));
        give([u, u1], [v, v1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_covered_once() {
        // An angle, a frame around a hole, and nothing.
        for rows in [["##..", "#...", "#..."], ["####", "#..#", "####"], ["....", "....", "...."]] {
            let open: Vec<bool> = rows.concat().bytes().map(|b| b == b'#').collect();
            let mut times = [0; 12];
            cover(open.clone(), 4, &mut |u, v| {
                for k in v[0]..v[1] {
                    times[4 * k + u[0]..4 * k + u[1]].iter_mut().for_each(|n| *n += 1);
                }
            });
            assert_eq!(times.map(|n| n == 1).as_slice(), open, "{rows:?}");
            assert!(times.iter().all(|n| *n < 2), "{rows:?}");
        }
    }
}
