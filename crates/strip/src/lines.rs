//! What all lines from the eyes are blocked from, by line space.
//!
//! Objects are asked about as wholes first: the search goes down the tree of their triangles by itself. Where triangles count one by one, groups
//! of them are asked about, and halved while a group is not hidden.

use crate::witness::Aim;
use sightlines_geometry::{Aabb, BoxTree, Point3, orient3d};
use sightlines_line_space::{FaceEffort, FaceExit, FaceSearch, FaceTarget, Surface};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most triangles of a chain.
const LONGEST_CHAIN: usize = 300;

/// Most triangles of a group that is asked about as one.
const MOST_OF_GROUP: usize = 16;

/// How much is done for one question at most. More finds more hidden; nothing is ever hidden wrongly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineEffort {
    /// Cells of line space for the lines that leave one side of a box of eyes, for a part, at first; half a cell more for each triangle of it.
    pub first_cells: u32,
    /// The same for a part that is open after that, at most.
    pub most_cells: u32,
    /// How many of these all parts share that are open then. So the more of them there are, the less is spent on each.
    pub shared_cells: u64,
    /// Most sides of boxes of eyes that are looked out of, one by one, for an object. With more of them, nothing is proven by line space.
    pub sides: u32,
}

impl Default for LineEffort {
    fn default() -> Self {
        Self { first_cells: 200, most_cells: 20_000, shared_cells: 1_000_000, sides: 4096 }
    }
}

/// What was not found to be hidden.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Open {
    /// A line that may be free.
    pub(crate) line: Option<[Point3; 2]>,
    /// The triangle of the question at which it ends.
    pub(crate) triangle: Option<u32>,
}

/// The surface and the eyes, for all threads.
#[derive(Debug)]
pub(crate) struct Lines {
    surface: Arc<Surface>,
    exits: Vec<FaceExit>,
    sides: usize,
}

impl Lines {
    /// O(n log² n).
    pub(crate) fn new(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]], exits: Vec<FaceExit>, sides: u32) -> Self {
        Self { surface: Arc::new(Surface::with_fronts(both_sides, fronts)), exits, sides: sides as usize }
    }

    /// A search for one thread.
    pub(crate) fn search(&self) -> FaceSearch {
        FaceSearch::new(Arc::clone(&self.surface), LONGEST_CHAIN)
    }

    /// Whether all lines from the eyes to the triangles are blocked before they end there.
    ///
    /// * `from_fronts`: whether only the fronts of the triangles are seen
    /// * `cells`: of line space, for each side that is looked out of
    pub(crate) fn hide(
        &self,
        search: &mut FaceSearch,
        triangles: &[[Point3; 3]],
        from_fronts: bool,
        cells: u32,
    ) -> Result<(), Open> {
        search.forget();
        let target = FaceTarget::new(triangles).ok_or_else(Open::default)?;
        let facing: Vec<&FaceExit> = self.exits.iter().filter(|exit| exit.faces(target.bounds())).collect();
        let meets = |exit: &FaceExit| !are_apart(&exit.volume, target.bounds());
        // Of a box with all of the target in it no side faces the target.
        if facing.len() > self.sides || self.exits.iter().any(meets) {
            return Err(Open::default());
        }
        let more = u32::try_from(target.triangles().len() / 2).unwrap_or(u32::MAX);
        let effort =
            FaceEffort { cells: cells.saturating_add(more), triangle_cells: cells / 2, ..FaceEffort::default() };
        for exit in facing {
            let corners = exit.part.corners();
            // Where a line leaves the box, it is on the same side of what it ends at as its eye.
            let leave_out = |t: u32| {
                let [a, b, c] = target.triangles()[t as usize];
                from_fronts && corners.iter().all(|&corner| orient3d(a, b, c, corner) <= 0.0)
            };
            let found = search.is_blocked(exit, &target, None, &leave_out, &effort);
            found.map_err(|failed| Open { line: failed.line, triangle: failed.triangle })?;
        }
        Ok(())
    }

    /// Which of some triangles are hidden; calls `open` for those that are not, with a line that may be free.
    ///
    /// * `asked`: places among the triangles of `aim`
    /// * `cells`: for an object; a group of triangles gets a quarter of it
    pub(crate) fn hide_each(
        &self,
        search: &mut FaceSearch,
        aim: &Aim<'_>,
        asked: &[u32],
        (from_fronts, cells): (bool, u32),
        mut open: impl FnMut(u32, Option<[Point3; 2]>),
    ) -> Vec<u32> {
        let corners = |t: u32| aim.triangles[t as usize];
        let boxes: Vec<Aabb<3>> = asked.iter().map(|&t| Aabb::around(corners(t))).collect();
        if boxes.is_empty() {
            return Vec::new();
        }
        let tree = BoxTree::build(&boxes, 1);
        let mut hidden = Vec::new();
        let mut is_open: BTreeMap<u32, Option<[Point3; 2]>> = BTreeMap::new();
        let mut pending = vec![0];
        while let Some(node) = pending.pop() {
            let range = &tree.nodes()[node as usize];
            let of = |k: u32| asked[k as usize];
            let group: Vec<u32> =
                tree.order()[range.start as usize..range.end as usize].iter().map(|&k| of(k)).collect();
            let left: Vec<u32> = group.into_iter().filter(|t| !is_open.contains_key(t)).collect();
            if left.is_empty() {
                continue;
            }
            if left.len() <= MOST_OF_GROUP {
                let triangles: Vec<[Point3; 3]> = left.iter().map(|&t| corners(t)).collect();
                match self.hide(search, &triangles, from_fronts, cells.div_ceil(4)) {
                    Ok(()) => {
                        hidden.extend(left);
                        continue;
                    }
                    Err(failed) if left.len() == 1 => {
                        is_open.insert(left[0], failed.line);
                        continue;
                    }
                    Err(Open { line: Some(line), triangle: Some(t) }) => {
                        // A triangle without area stands for itself by the sides of its box, and has no place of its own.
                        if let Some(&t) = left.get(t as usize).filter(|_| has_places(&triangles)) {
                            is_open.insert(t, Some(line));
                        }
                    }
                    Err(_) => {}
                }
            }
            if range.is_leaf() {
                left.iter().for_each(|&t| _ = is_open.entry(t).or_default());
            } else {
                pending.extend(tree.children(node));
            }
        }
        is_open.into_iter().for_each(|(t, line)| open(t, line));
        hidden
    }
}

/// Whether the triangles of a target are those that it was made of, one by one.
fn has_places(triangles: &[[Point3; 3]]) -> bool {
    FaceTarget::new(triangles).is_some_and(|target| target.triangles() == triangles)
}

fn are_apart(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).any(|k| a.max[k] < b.min[k] || b.max[k] < a.min[k])
}
