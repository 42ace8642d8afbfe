//! Ray oracles: what is really there, ready for rays. Vectors and rays are written out here on purpose, as this checks what others compute. Doubles propose segments; what [`RayOracle::proves`] says alone counts.

mod climb;
mod convex;
pub(crate) mod plan;
mod solid;
mod world;

pub(crate) use climb::climb;
pub(crate) use convex::PortalWorld;
pub(crate) use plan::PlanWorld;
pub(crate) use solid::SolidWorld;
pub(crate) use world::MapWorld;

use crate::sight::{SightSegment, Target};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_pvs::{PortalRecord, Table};

/// A scene with the cells of a table in it.
pub(crate) trait RayOracle: Sync {
    /// Whether cells are convex, disjoint, and known by more than their portals: then a segment that leaves a cell does so once, and by a portal.
    const CELLS_ARE_CONVEX: bool;

    /// A ray in a random direction from a random place inside of a cell; `visit` gets what may be visible along it, as
    /// proposals. `None` if no place was found.
    fn shoot(&self, from: u32, random: &mut Random, visit: &mut dyn FnMut(SightSegment)) -> Option<()>;

    /// Whether a sight is one: certainly, or the answer is no.
    fn proves(&self, sight: &SightSegment) -> bool;

    /// Looks for a sight from a cell to a cell or an object, with about so many rays; what is found is proven.
    fn aim(&self, table: &Table, from: u32, target: Target, tries: u32, random: &mut Random) -> Option<SightSegment>;

    /// Whether [`RayOracle::sample`] knows places in cells, and on objects.
    const SAMPLES: [bool; 2];

    /// Shoots a random segment from a cell to a cell or an object: every place of the cells is as likely as another, by volume or area, and every place on
    /// the object, or in the box that it does not leave.
    ///
    /// * `may_lead`: rules out segments that cannot be free
    fn sample(
        &self,
        from: u32,
        target: Target,
        random: &mut Random,
        may_lead: &dyn Fn(&SightSegment) -> bool,
    ) -> Sample;

    /// Whether one cell may see another that does not see it.
    fn has_one_way(&self) -> bool {
        false
    }

    /// The cells next to each cell, ascending.
    fn neighbours(&self) -> &[Vec<u32>];

    /// Whether a segment certainly misses a portal, whatever is uncertain of the scene.
    fn misses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool;

    /// Whether a segment certainly crosses a portal between its borders.
    fn crosses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool;

    /// Short segments from inside of a cell to inside of the cells next to it, as proposals: one or more through each part of their common border that
    /// none of the cell's portals covers. A border of two cells has to be looked at from one of them only. None if cells are known by their portals
    /// alone.
    fn through_borders(&self, _from: u32, _portals: &[&PortalRecord]) -> Vec<SightSegment> {
        Vec::new()
    }

    /// Whether a sight to a cell is one along the portals that it crosses: certainly, or the answer is no.
    fn proves_way(&self, sight: &SightSegment) -> bool {
        self.proves(sight)
    }
}

/// What became of a random segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sample {
    /// It was not shot: an end is nowhere that is certain, or on nothing.
    Nowhere,
    /// It is not free for certain, or ruled out.
    Blocked,
    /// It is free, which is proven.
    Free(SightSegment),
}

impl Sample {
    /// A segment that was shot.
    pub(crate) fn of(free: Option<SightSegment>) -> Self {
        free.map_or(Self::Blocked, Self::Free)
    }
}

/// From 0 to 1, and as likely near an end as in the middle, however near.
pub(crate) fn extreme(random: &mut Random) -> f64 {
    let x = random.unit();
    match random.below(4) {
        0 | 1 => x,
        end => {
            // Smaller by a random power of two, down to a few units in the last place.
            let near = x * 2f64.powi(-(random.below(50) as i32));
            if end == 2 { near } else { 1.0 - near }
        }
    }
}

/// A random number from 0 to a sum, as the place in the sums of weights up to each that it falls on; `None` if all weights are 0.
pub(crate) fn chosen(sums: &[f64], random: &mut Random) -> Option<usize> {
    let all = sums.last().copied().filter(|&all| all > 0.0)?;
    let at = all * random.unit();
    Some(sums.partition_point(|&sum| sum <= at).min(sums.len() - 1))
}

/// The part of the line `p + t d` in a box, as a range of `t` within the given one; rounded. `None` if there is none.
pub(crate) fn clip<const D: usize>(
    p: [f64; D],
    d: [f64; D],
    b: &Aabb<D>,
    within: [f64; 2],
    slack: f64,
) -> Option<[f64; 2]> {
    let [mut low, mut high] = within;
    for k in 0..D {
        let (min, max) = (b.min[k] - slack, b.max[k] + slack);
        if d[k] == 0.0 {
            if p[k] < min || p[k] > max {
                return None;
            }
            continue;
        }
        let (s, t) = ((min - p[k]) / d[k], (max - p[k]) / d[k]);
        low = low.max(s.min(t));
        high = high.min(s.max(t));
    }
    (low <= high).then_some([low, high])
}

/// The cells next to each cell: joined by a portal, or, in tables without portals, with boxes that touch.
pub(crate) fn neighbours_of(table: &Table) -> Vec<Vec<u32>> {
    let mut next = vec![Vec::new(); table.n_cells()];
    for portal in table.portals() {
        let [a, b] = portal.cells;
        next[a.idx()].push(b.0);
        next[b.idx()].push(a.0);
    }
    if table.portals().is_empty() {
        let mut pending = Vec::new();
        for (id, cell) in table.cells().iter().enumerate() {
            table.for_each_touching(cell.min, cell.max, &mut pending, |other| {
                next[id].push(other.0);
                true
            });
        }
    }
    for (id, list) in next.iter_mut().enumerate() {
        list.sort_unstable();
        list.dedup();
        list.retain(|&other| other as usize != id);
    }
    next
}

/// The largest magnitude of some coordinates; 1 if there is none.
pub(crate) fn scale_of(points: impl IntoIterator<Item = f64>) -> f64 {
    let largest = points.into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

pub(crate) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The point `p + t d`.
pub(crate) fn at<const D: usize>(p: [f64; D], d: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|k| p[k] + t * d[k])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
