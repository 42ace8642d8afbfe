//! Quake maps: the tree of planes says what is solid and which cluster is where.

use super::convex::PortalWorld;
use super::{RayOracle, Sample, at, clip, dot, extreme, length, scale_of, sub};
use crate::exact::snapped;
use crate::sight::{SightSegment, Target};
use crate::truth::{MapChild, MapFace, MapTree};
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random};
use sightlines_pvs::{PortalRecord, Table};

/// A map with its portals.
#[derive(Debug)]
pub(crate) struct MapWorld<'a> {
    portals: PortalWorld,
    tree: &'a MapTree,
    cells: Vec<Aabb<3>>,
    faces: BoxTree<3>,
    size: f64,
}

/// How far a segment has to stay away from all that is not on its way, in units of the map.
///
/// Compilers take what is nearer than 0.1 units to a plane as on it, and drop portals that are not wider; planes and corners are
/// rounded by far less. So a segment that keeps this distance passes nothing that the file could have lost.
const MARGIN: f64 = 0.25;

/// A stretch of a segment near a leaf.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    from: f64,
    to: f64,
    /// `None` for what is solid.
    cluster: Option<u32>,
}

/// Where a segment is in one cluster, for sure.
#[derive(Debug, Clone, Copy)]
struct Stay {
    from: f64,
    to: f64,
    cluster: u32,
}

impl<'a> MapWorld<'a> {
    pub(crate) fn new(table: &Table, graph: &CellGraph<Convex>, tree: &'a MapTree) -> Self {
        let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
        let boxes: Vec<Aabb<3>> = tree.faces.iter().map(MapFace::bounds).collect();
        let scale = scale_of(cells.iter().flat_map(|b| b.min.into_iter().chain(b.max)));
        Self { portals: PortalWorld::new(graph), tree, cells, faces: BoxTree::build(&boxes, 4), size: 4.0 * scale }
    }

    /// What the segment from `p` to `p + d` is near to, within a margin in scene units.
    fn stretches(&self, p: Point3, d: Point3, margin: f64) -> Vec<Stretch> {
        let mut found = Vec::new();
        if self.tree.nodes.is_empty() {
            return found;
        }
        let mut open = vec![(MapChild::Node(0), 0.0f64, 1.0f64)];
        while let Some((child, from, to)) = open.pop() {
            let node = match child {
                MapChild::Node(node) => &self.tree.nodes[node as usize],
                MapChild::Cluster(cluster) => {
                    found.push(Stretch { from, to, cluster: Some(cluster) });
                    continue;
                }
                MapChild::Solid => {
                    found.push(Stretch { from, to, cluster: None });
                    continue;
                }
            };
            let margin = margin * length(node.normal);
            let (height, slope) = (dot(node.normal, p) - node.distance, dot(node.normal, d));
            for (child, sign) in node.children.into_iter().zip([1.0, -1.0]) {
                // Where sign * (height + t slope) >= -margin.
                let (h, s) = (sign * height + margin, sign * slope);
                let (mut low, mut high) = (from, to);
                if s == 0.0 {
                    if h < 0.0 {
                        continue;
                    }
                } else if s > 0.0 {
                    low = low.max(-h / s);
                } else {
                    high = high.min(-h / s);
                }
                if low <= high {
                    open.push((child, low, high));
                }
            }
        }
        found
    }

    /// Where a segment is for sure, in order, up to the first place where it comes near something solid, near three clusters at once,
    /// or near two where it passes no portal between them. Also, where that is.
    fn stays(&self, p: Point3, d: Point3) -> (Vec<Stay>, f64) {
        let mut near = self.stretches(p, d, MARGIN);
        let solid = near.iter().filter(|s| s.cluster.is_none()).map(|s| s.from).fold(f64::INFINITY, f64::min);
        near.retain(|s| s.cluster.is_some());
        near.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.to.total_cmp(&b.to)).then(a.cluster.cmp(&b.cluster)));
        // One stretch for each cluster, where its leafs follow each other.
        let mut joined: Vec<Stay> = Vec::new();
        for s in near {
            let cluster = s.cluster.expect("solid ones are gone");
            match joined.iter_mut().rfind(|j| j.cluster == cluster && s.from <= j.to) {
                Some(j) => j.to = j.to.max(s.to),
                None => joined.push(Stay { from: s.from, to: s.to, cluster }),
            }
        }
        let mut end = solid.min(1.0);
        let mut stays: Vec<Stay> = Vec::new();
        for (k, stay) in joined.iter().enumerate() {
            if stay.from >= end {
                break;
            }
            // Each may share places with the one before, and no other.
            for (i, other) in joined[..k].iter().enumerate() {
                let shares = other.to >= stay.from;
                let pair = [other.cluster, stay.cluster];
                if shares && (i + 1 < k || !self.portals.joins(pair, p, d, [stay.from, other.to])) {
                    end = end.min(stay.from);
                }
            }
            if k > 0 && joined[k - 1].to < stay.from {
                end = end.min(joined[k - 1].to);
            }
            if stay.from < end {
                let before = joined[..k].iter().map(|o| o.to).fold(0.0, f64::max);
                let after = joined[k + 1..].iter().map(|o| o.from).fold(f64::INFINITY, f64::min);
                stays.push(Stay { from: stay.from.max(before), to: stay.to.min(after), cluster: stay.cluster });
            }
        }
        stays.iter_mut().for_each(|s| s.to = s.to.min(end));
        stays.retain(|s| s.from < s.to);
        (stays, end)
    }

    /// A random point that is in a cluster for sure.
    fn place(&self, cell: u32, random: &mut Random) -> Option<Point3> {
        let b = &self.cells[cell as usize];
        (0..24).find_map(|_| {
            let p = snapped(std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * extreme(random)));
            let here = self.stretches(p, [0.0; 3], MARGIN);
            here.iter().all(|s| s.cluster == Some(cell)).then_some(p).filter(|_| !here.is_empty())
        })
    }

    fn is_free(&self, from: u32, to: u32, p: Point3, q: Point3) -> bool {
        let (stays, end) = self.stays(p, sub(q, p));
        let is_at = |stay: Option<&Stay>, cluster: u32, t: f64| {
            stay.is_some_and(|s| s.cluster == cluster && s.from <= t && t <= s.to)
        };
        end >= 1.0 && is_at(stays.first(), from, 0.0) && is_at(stays.last(), to, 1.0)
    }

    /// Where a segment crosses a face from one side to the other, further from its edges than the margin: the share of the segment, and the
    /// polygon of the face.
    fn crosses_face(&self, face: u32, p: Point3, q: Point3) -> Option<(f64, &'a [Point3])> {
        let tree: &'a MapTree = self.tree;
        let polygons = tree.faces[face as usize].polygons.iter();
        polygons.map(|corners| &corners[..]).find_map(|corners| Some((Self::crosses(corners, p, q)?, corners)))
    }

    fn crosses(corners: &[Point3], p: Point3, q: Point3) -> Option<f64> {
        let a = *corners.first()?;
        let cross =
            |u: Point3, v: Point3| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let edges = || (0..corners.len()).map(|i| (corners[i], sub(corners[(i + 1) % corners.len()], corners[i])));
        let normal = edges().fold([0.0; 3], |n, (u, e)| at(n, cross(sub(u, a), e), 1.0));
        let normal = normal.map(|x| x / length(normal));
        let (hp, hq) = (dot(normal, sub(p, a)), dot(normal, sub(q, a)));
        if hp.abs() < MARGIN || hq.abs() < MARGIN || (hp > 0.0) == (hq > 0.0) {
            return None;
        }
        let t = hp / (hp - hq);
        let there = at(p, sub(q, p), t);
        let inside = |(u, e): (Point3, Point3)| dot(cross(normal, e), sub(there, u)) > MARGIN * length(e);
        edges().filter(|(_, e)| length(*e) > 0.0).all(inside).then_some(t)
    }

    /// Whether a segment from a cluster is free up to a face, behind which it is in something solid.
    fn shows_face(&self, from: u32, face: u32, p: Point3, q: Point3) -> bool {
        // Faces lie on planes of the tree but for rounding, which is far below this.
        const NEAR: f64 = 0.01;
        let d = sub(q, p);
        let Some((t, corners)) = self.crosses_face(face, p, q) else { return false };
        let (stays, end) = self.stays(p, d);
        let (Some(first), Some(last)) = (stays.first(), stays.last()) else { return false };
        if first.cluster != from || first.from > 0.0 || end > t || last.to < end {
            return false;
        }
        // From there on it is close to the face; on the way nothing but the same cluster.
        let steep = (height(corners, q) - height(corners, p)).abs() / length(d);
        let before = t - 4.0 * NEAR / (steep.max(NEAR) * length(d));
        let (x, rest) = (at(p, d, end), d.map(|c| c * (before - end)));
        let way = self.stretches(x, rest, NEAR);
        let behind = self.stretches(q, [0.0; 3], NEAR);
        before >= end
            && way.iter().all(|s| s.cluster == Some(last.cluster))
            && behind.iter().all(|s| s.cluster.is_none())
            && !behind.is_empty()
    }

    /// Proposes the faces behind which a ray is in something solid.
    fn propose_faces(&self, from: u32, p: Point3, d: Point3, end: f64, visit: &mut dyn FnMut(SightSegment)) {
        // A little further than where it comes near something solid.
        let n = length(d);
        let q = at(p, d, end + 8.0 / n);
        let near_end = at(p, d, (end - 8.0 / n).max(0.0));
        let rest = sub(q, near_end);
        self.faces.visit(
            |b| clip(near_end, rest, b, [0.0, 1.0], 1.0).is_some(),
            |face| {
                if let Some((t, corners)) = self.crosses_face(face, p, q) {
                    let height = height(corners, p).abs();
                    // Two units behind it.
                    let behind = at(p, sub(q, p), t * (1.0 + 2.0 / height.max(MARGIN)));
                    let segment = [p, behind].map(snapped);
                    visit(SightSegment { from: CellId(from), target: Target::Object(face), segment });
                }
            },
        );
    }
}

/// How far a point is from the plane of a polygon, in scene units; rounded.
fn height(corners: &[Point3], p: Point3) -> f64 {
    let plane = sightlines_geometry::Portal3::of_corners(corners.to_vec());
    plane.map_or(0.0, |s| dot(s.normal(), sub(p, corners[0])) / length(s.normal()))
}

impl RayOracle for MapWorld<'_> {
    const CELLS_ARE_CONVEX: bool = false;

    fn shoot(&self, from: u32, random: &mut Random, visit: &mut dyn FnMut(SightSegment)) -> Option<()> {
        if random.below(2) == 0 {
            return self.portals.shoot(from, random, visit);
        }
        let p = self.place(from, random)?;
        let d = random.direction().map(|x| x * self.size);
        let (stays, end) = self.stays(p, d);
        for stay in &stays {
            let segment = [p, at(p, d, 0.5 * (stay.from + stay.to))].map(snapped);
            visit(SightSegment { from: CellId(from), target: Target::Cell(CellId(stay.cluster)), segment });
        }
        self.propose_faces(from, p, d, end, visit);
        Some(())
    }

    fn proves(&self, sight: &SightSegment) -> bool {
        let [p, q] = sight.segment;
        match sight.target {
            Target::Cell(to) => self.is_free(sight.from.0, to.0, p, q) || self.portals.proves(sight),
            Target::Object(face) => self.shows_face(sight.from.0, face, p, q),
        }
    }

    fn aim(&self, table: &Table, from: u32, target: Target, tries: u32, random: &mut Random) -> Option<SightSegment> {
        let Target::Cell(to) = target else { return None };
        if let Some(sight) = self.portals.aim(table, from, target, tries, random) {
            return Some(sight);
        }
        (0..tries / 4).find_map(|_| {
            let segment = [self.place(from, random)?, self.place(to.0, random)?];
            let sight = SightSegment { from: CellId(from), target, segment };
            self.proves(&sight).then_some(sight)
        })
    }

    const SAMPLES: [bool; 2] = [true, false];

    fn sample(
        &self,
        from: u32,
        target: Target,
        random: &mut Random,
        may_lead: &dyn Fn(&SightSegment) -> bool,
    ) -> Sample {
        let Target::Cell(to) = target else { return Sample::Nowhere };
        let any_place = |cell: u32, random: &mut Random| {
            let p = snapped(random.point(&self.cells[cell as usize]));
            let here = self.stretches(p, [0.0; 3], MARGIN);
            (!here.is_empty() && here.iter().all(|s| s.cluster == Some(cell))).then_some(p)
        };
        let Some(p) = any_place(from, random) else { return Sample::Nowhere };
        let Some(q) = any_place(to.0, random) else { return Sample::Nowhere };
        let sight = SightSegment { from: CellId(from), target, segment: [p, q] };
        Sample::of((may_lead(&sight) && self.is_free(from, to.0, p, q)).then_some(sight))
    }

    fn neighbours(&self) -> &[Vec<u32>] {
        self.portals.neighbours()
    }

    fn misses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool {
        self.portals.misses(portal, segment)
    }

    fn crosses(&self, portal: &PortalRecord, segment: [Point3; 2]) -> bool {
        self.portals.crosses(portal, segment)
    }

    fn proves_way(&self, sight: &SightSegment) -> bool {
        // What stays clear of all that is solid need not stay clear of the borders of portals.
        self.portals.proves(sight)
    }
}
