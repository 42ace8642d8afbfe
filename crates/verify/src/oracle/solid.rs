//! Scenes in space: every triangle stops sight, but for those of objects that are see-through. What moves is seen wherever it may
//! be.

use super::{RayOracle, Sample, at, chosen, climb, clip, extreme, length, neighbours_of, scale_of, sub};
use crate::borders::{middles, pairs};
use crate::exact::{
    segment_and_polygon_apart, segment_and_triangle_apart, segment_crosses_polygon, segment_crosses_triangle, snapped,
};
use crate::sight::{SightSegment, Target};
use sightlines_cells::{CellId, Scene};
use sightlines_geometry::{Aabb, BoxTree, Point3, Random};
use sightlines_pvs::{PortalRecord, Table};
use std::cell::Cell;

/// A scene with the cells of a table.
#[derive(Debug)]
pub(crate) struct SolidWorld {
    triangles: Vec<[Point3; 3]>,
    object_of: Vec<u32>,
    /// The triangles of each object, as a range.
    of_object: Vec<[u32; 2]>,
    /// For each triangle the area of those of its object up to it; rounded.
    areas: Vec<f64>,
    /// For each object whether its triangles stop sight.
    is_opaque: Vec<bool>,
    /// For each object whether they stop it from their fronts only.
    hides_from_front: Vec<bool>,
    /// For each object whether only the fronts of its triangles are seen.
    is_single_sided: Vec<bool>,
    /// The objects that move, ascending, and the boxes that they do not leave.
    movers: Vec<(u32, Aabb<3>)>,
    mover_tree: BoxTree<3>,
    /// Around everything that stands still, and the cells.
    bounds: Aabb<3>,
    tree: BoxTree<3>,
    cells: Vec<Aabb<3>>,
    cell_tree: BoxTree<3>,
    next: Vec<Vec<u32>>,
    /// Around boxes in rounded questions.
    slack: f64,
    size: f64,
    /// Whether cells may reach into solid matter, and the table says nothing of eyes there.
    only_in_air: bool,
}

impl SolidWorld {
    pub(crate) fn new(table: &Table, scene: &Scene) -> Self {
        let (mut triangles, mut object_of, mut of_object) = (Vec::new(), Vec::new(), Vec::new());
        for (object, o) in (0u32..).zip(scene.objects()) {
            let first = triangles.len() as u32;
            triangles.extend(o.corners());
            object_of.resize(triangles.len(), object);
            of_object.push([first, triangles.len() as u32]);
        }
        let mut areas: Vec<f64> =
            triangles.iter().map(|&t| 0.5 * length(sightlines_geometry::vector::normal(t))).collect();
        for &[first, end] in &of_object {
            let mut sum = 0.0;
            areas[first as usize..end as usize].iter_mut().for_each(|area| {
                sum += *area;
                *area = sum;
            });
        }
        let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
        let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
        let all = boxes.iter().chain(&cells).fold(Aabb::EMPTY, |all: Aabb<3>, b| all.with(b.min).with(b.max));
        let scale = if all.is_empty() { 1.0 } else { scale_of(all.min.into_iter().chain(all.max)) };
        let movers: Vec<(u32, Aabb<3>)> =
            scene.moving().iter().map(|moving| (moving.object, scene.extent(moving.object))).collect();
        let mover_boxes: Vec<Aabb<3>> = movers.iter().map(|mover| mover.1).collect();
        Self {
            mover_tree: BoxTree::build(&mover_boxes, 4),
            movers,
            bounds: all,
            tree: BoxTree::build(&boxes, 4),
            cell_tree: BoxTree::build(&cells, 4),
            triangles,
            areas,
            object_of,
            of_object,
            is_opaque: (0u32..).zip(scene.objects()).map(|(object, _)| scene.is_opaque(object)).collect(),
            hides_from_front: (0u32..).zip(scene.objects()).map(|(object, _)| scene.hides_from_front(object)).collect(),
            is_single_sided: (0u32..).zip(scene.objects()).map(|(object, _)| scene.is_single_sided(object)).collect(),
            cells,
            next: neighbours_of(table),
            slack: scale * 2f64.powi(-40),
            size: if all.is_empty() { 0.0 } else { length(sub(all.max, all.min)) },
            only_in_air: table.kind().only_in_air(),
        }
    }

    fn is_inside(&self, cell: u32, p: Point3) -> bool {
        let b = &self.cells[cell as usize];
        (0..3).all(|k| b.min[k] < p[k] && p[k] < b.max[k])
    }

    /// A random point strictly inside of a cell, `None` if doubles have none.
    fn place(&self, cell: u32, random: &mut Random) -> Option<Point3> {
        let b = &self.cells[cell as usize];
        (0..8).find_map(|_| {
            let p = std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * extreme(random));
            Some(snapped(p)).filter(|&p| self.is_inside(cell, p))
        })
    }

    /// Visits the triangles near the segment from `p` to `p + limit d`, until the limit is lowered below them.
    fn near(&self, p: Point3, d: Point3, limit: &Cell<f64>, each: impl FnMut(u32)) {
        self.tree.visit(|b| clip(p, d, b, [0.0, limit.get()], self.slack).is_some(), each);
    }

    /// Whether a triangle shows an eye a side that is seen. Exact.
    fn shows(&self, triangle: u32, eye: Point3) -> bool {
        let [a, b, c] = self.triangles[triangle as usize];
        !self.is_single_sided[self.object_of[triangle as usize] as usize]
            || sightlines_geometry::orient3d(a, b, c, eye) > 0.0
    }

    /// Whether a triangle stops the sight of an eye. Exact.
    fn stops_sight(&self, triangle: u32, eye: Point3) -> bool {
        let object = self.object_of[triangle as usize] as usize;
        self.is_opaque[object]
            || self.hides_from_front[object] && {
                let [a, b, c] = self.triangles[triangle as usize];
                sightlines_geometry::orient3d(a, b, c, eye) > 0.0
            }
    }

    /// The first triangle that stops a ray from an eye, and where, as a multiple of its direction; rounded.
    fn hit(&self, p: Point3, d: Point3, far: f64) -> (f64, Option<u32>) {
        self.first(p, d, far, |i| self.stops_sight(i, p))
    }

    /// The first of some triangles that a ray meets, and where.
    fn first(&self, p: Point3, d: Point3, far: f64, counts: impl Fn(u32) -> bool) -> (f64, Option<u32>) {
        let limit = Cell::new(far);
        let mut first = None;
        self.near(p, d, &limit, |i| {
            if counts(i)
                && let Some(t) = meet(p, d, &self.triangles[i as usize])
                && t < limit.get()
            {
                limit.set(t);
                first = Some(i);
            }
        });
        (limit.get(), first)
    }

    /// How little is in the way of a segment: the shares before the first and behind the last thing.
    fn openness(&self, [p, q]: [Point3; 2]) -> f64 {
        let d = sub(q, p);
        match self.hit(p, d, 1.0) {
            (_, None) => 1.0,
            (before, Some(_)) => {
                let (behind, _) = self.hit(q, sub(p, q), 1.0);
                (before + behind).min(1.0 - f64::EPSILON)
            }
        }
    }

    /// Whether nothing that stops sight touches the closed segment but triangles of one object, of which it crosses one
    /// properly, or nothing at all, if there is no such object. Backs of a single-sided object are obstacles. Exact.
    fn is_free(&self, p: Point3, q: Point3, but: Option<u32>) -> bool {
        let d = sub(q, p);
        let limit = Cell::new(1.0);
        let (mut free, mut crosses) = (true, but.is_none());
        self.near(p, d, &limit, |i| {
            let triangle = &self.triangles[i as usize];
            if !free {
                return;
            }
            if but == Some(self.object_of[i as usize]) && self.shows(i, p) {
                crosses |= segment_crosses_triangle(p, q, triangle);
            } else if self.stops_sight(i, p) && !segment_and_triangle_apart(p, q, triangle) {
                free = false;
                limit.set(f64::NEG_INFINITY);
            }
        });
        free && crosses
    }

    /// Whether a point may be an eye: not if the first thing in some direction shows its back, where the table does not
    /// speak of eyes inside of things.
    fn is_in_air(&self, p: Point3) -> bool {
        const DIRECTIONS: [Point3; 4] =
            [[0.62, 0.53, 0.58], [-0.71, 0.41, 0.57], [0.33, -0.82, -0.47], [-0.51, -0.45, -0.73]];
        !self.only_in_air
            || DIRECTIONS.iter().all(|&d| {
                match self.first(p, d, 2.0 * self.size, |i| self.is_opaque[self.object_of[i as usize] as usize]) {
                    (_, Some(i)) => {
                        let [a, b, c] = self.triangles[i as usize];
                        sightlines_geometry::orient3d(a, b, c, p) > 0.0
                    }
                    _ => true,
                }
            })
    }

    fn sight(from: u32, target: Target, segment: [Point3; 2]) -> SightSegment {
        SightSegment { from: CellId(from), target, segment: segment.map(snapped) }
    }

    /// From a point to just behind where a ray meets something.
    fn just_behind(p: Point3, d: Point3, t: f64) -> [Point3; 2] {
        [p, at(p, d, t * (1.0 + 2f64.powi(-40)))]
    }

    fn on_object(&self, object: u32, random: &mut Random) -> Option<Point3> {
        let [first, end] = self.of_object[object as usize];
        let triangle = &self.triangles[first as usize..end as usize];
        if triangle.is_empty() {
            return None;
        }
        let [a, b, c] = triangle[random.below(triangle.len())];
        let (u, v) = (extreme(random), extreme(random));
        let (u, v) = (u.min(v), 1.0 - u.max(v));
        Some(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * u + (c[k] - a[k]) * v))
    }

    /// The box that an object does not leave, if it moves.
    fn extent(&self, object: u32) -> Option<&Aabb<3>> {
        self.movers.binary_search_by_key(&object, |mover| mover.0).ok().map(|k| &self.movers[k].1)
    }

    /// A point where something that moves may be, in the part of space where there is something to be seen from.
    fn in_extent(&self, extent: &Aabb<3>, random: &mut Random) -> Option<Point3> {
        let p = std::array::from_fn(|k| {
            let (low, high) = (extent.min[k].max(self.bounds.min[k]), extent.max[k].min(self.bounds.max[k]));
            low + (high - low) * extreme(random)
        });
        Some(snapped(p)).filter(|&p| extent.contains(p))
    }

    /// The sight along a ray to a point of an object, if nothing else is met before.
    fn sight_of_object(&self, from: u32, object: u32, p: Point3, q: Point3) -> Option<SightSegment> {
        let d = sub(q, p);
        // What is see-through is no obstacle, but may be the aim.
        let counts = |i: u32| self.stops_sight(i, p) || self.object_of[i as usize] == object && self.shows(i, p);
        let (t, first) = self.first(p, d, 1.0 + 2f64.powi(-20), counts);
        first.filter(|&i| self.object_of[i as usize] == object)?;
        let sight = Self::sight(from, Target::Object(object), Self::just_behind(p, d, t));
        self.proves(&sight).then_some(sight)
    }

    /// A place of a cell, each as likely as another; `None` if rounding led out of it.
    fn any_place(&self, cell: u32, random: &mut Random) -> Option<Point3> {
        Some(snapped(random.point(&self.cells[cell as usize]))).filter(|&p| self.is_inside(cell, p))
    }

    /// A place where something that moves may be, each as likely as another, in the part of space where there is something to be seen from.
    fn any_place_in(&self, extent: &Aabb<3>, random: &mut Random) -> Option<Point3> {
        let within = Aabb {
            min: [0, 1, 2].map(|k| extent.min[k].max(self.bounds.min[k])),
            max: [0, 1, 2].map(|k| extent.max[k].min(self.bounds.max[k])),
        };
        (!within.is_empty()).then(|| snapped(random.point(&within))).filter(|&p| extent.contains(p))
    }

    /// A place on an object, each as likely as another.
    fn any_place_on(&self, object: u32, random: &mut Random) -> Option<Point3> {
        let [first, end] = self.of_object[object as usize].map(|i| i as usize);
        let [a, b, c] = self.triangles[first + chosen(&self.areas[first..end], random)?];
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = (u.min(v), 1.0 - u.max(v));
        Some(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * u + (c[k] - a[k]) * v))
    }

    fn aim_at_object(&self, from: u32, object: u32, tries: u32, random: &mut Random) -> Option<SightSegment> {
        let extent = self.extent(object);
        for k in 0..tries {
            // What moves is aimed at where it may be, and every other time where it is at rest.
            if let Some(extent) = extent
                .filter(|_| k % 2 == 0 || self.of_object[object as usize][0] == self.of_object[object as usize][1])
            {
                let p = self.place(from, random)?;
                let sight = self.in_extent(extent, random).map(|q| Self::sight(from, Target::Object(object), [p, q]));
                if let Some(sight) = sight.filter(|sight| self.proves(sight)) {
                    return Some(sight);
                }
                continue;
            }
            let (p, q) = (self.place(from, random)?, self.on_object(object, random)?);
            if let Some(sight) = self.sight_of_object(from, object, p, q) {
                return Some(sight);
            }
        }
        None
    }

    fn aim_at_cell(&self, table: &Table, from: u32, to: u32, tries: u32, random: &mut Random) -> Option<SightSegment> {
        let boxes = [&self.cells[from as usize], &self.cells[to as usize]];
        let is_good = |segment| self.proves(&Self::sight(from, Target::Cell(CellId(to)), segment));
        // A few beginnings, each moved for a while.
        let n_starts = (tries / 16).max(1);
        for _ in 0..n_starts {
            let start = [self.place(from, random)?, self.start_in(table, from, to, random)?];
            let found = climb(start, boxes, tries / n_starts, random, |s| self.openness(s), is_good);
            if let Some(segment) = found {
                return Some(Self::sight(from, Target::Cell(CellId(to)), segment));
            }
        }
        None
    }

    /// A point of a cell to begin with: often one just behind a portal that leads into it from a cell that is seen.
    fn start_in(&self, table: &Table, from: u32, to: u32, random: &mut Random) -> Option<Point3> {
        let seen: Vec<u32> =
            self.next[to as usize].iter().copied().filter(|&c| table.sees(CellId(from), CellId(c))).collect();
        if seen.is_empty() || random.below(2) == 0 {
            return self.place(to, random);
        }
        // Where the two cells touch.
        let (a, b) = (&self.cells[seen[random.below(seen.len())] as usize], &self.cells[to as usize]);
        let p = std::array::from_fn(|k| {
            let (low, high) = (a.min[k].max(b.min[k]), a.max[k].min(b.max[k]));
            let x = low + (high - low) * extreme(random);
            let inwards = (0.5 * (b.min[k] + b.max[k]) - x) * 2f64.powi(-(random.below(20) as i32));
            x + inwards
        });
        Some(snapped(p)).filter(|&p| self.is_inside(to, p)).or_else(|| self.place(to, random))
    }
}

/// Where a ray meets a triangle, as a multiple of its direction; rounded. Its own on purpose, not `geometry::ray_triangle`: what
/// checks tables shares no code with what makes them.
///
/// # Source
/// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997.
fn meet(p: Point3, d: Point3, [a, b, c]: &[Point3; 3]) -> Option<f64> {
    let cross =
        |u: Point3, v: Point3| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let (e, f, o) = (sub(*b, *a), sub(*c, *a), sub(p, *a));
    let n = cross(d, f);
    let det = super::dot(e, n);
    let m = cross(o, e);
    let (u, v, t) = (super::dot(o, n) / det, super::dot(d, m) / det, super::dot(f, m) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
}

impl RayOracle for SolidWorld {
    const CELLS_ARE_CONVEX: bool = true;

    fn shoot(&self, from: u32, random: &mut Random, visit: &mut dyn FnMut(SightSegment)) -> Option<()> {
        let p = self.place(from, random)?;
        let d = random.direction();
        let (far, first) = self.hit(p, d, 2.0 * self.size);
        self.cell_tree.visit(
            |b| clip(p, d, b, [0.0, far], self.slack).is_some(),
            |cell| {
                if let Some([s, t]) = clip(p, d, &self.cells[cell as usize], [0.0, far], 0.0) {
                    visit(Self::sight(from, Target::Cell(CellId(cell)), [p, at(p, d, 0.5 * (s + t))]));
                }
            },
        );
        if let Some(i) = first {
            let target = Target::Object(self.object_of[i as usize]);
            visit(Self::sight(from, target, Self::just_behind(p, d, far)));
        }
        if self.is_opaque.iter().all(|is_opaque| *is_opaque) {
            return Some(());
        }
        // What may be on the way is seen.
        self.mover_tree.visit(
            |b| clip(p, d, b, [0.0, far], self.slack).is_some(),
            |k| {
                let (object, extent) = &self.movers[k as usize];
                if let Some([s, t]) = clip(p, d, extent, [0.0, far], 0.0) {
                    visit(Self::sight(from, Target::Object(*object), [p, at(p, d, 0.5 * (s + t))]));
                }
            },
        );
        // All that is see-through on the way is seen.
        let limit = Cell::new(far);
        let mut passed = Vec::new();
        self.near(p, d, &limit, |i| {
            if !self.stops_sight(i, p)
                && let Some(t) = meet(p, d, &self.triangles[i as usize]).filter(|&t| t < far)
            {
                passed.push((i, t));
            }
        });
        for (i, t) in passed {
            let target = Target::Object(self.object_of[i as usize]);
            visit(Self::sight(from, target, Self::just_behind(p, d, t)));
        }
        Some(())
    }

    fn proves(&self, sight: &SightSegment) -> bool {
        let [p, q] = sight.segment;
        if p == q || !self.is_inside(sight.from.0, p) || !self.is_in_air(p) {
            return false;
        }
        match sight.target {
            Target::Cell(cell) => self.is_inside(cell.0, q) && self.is_free(p, q, None),
            Target::Object(object) => {
                let may_be_there = self.extent(object).is_some_and(|extent| extent.contains(q));
                (may_be_there && self.is_free(p, q, None)) || self.is_free(p, q, Some(object))
            }
        }
    }

    fn aim(&self, table: &Table, from: u32, target: Target, tries: u32, random: &mut Random) -> Option<SightSegment> {
        match target {
            Target::Cell(to) => self.aim_at_cell(table, from, to.0, tries, random),
            Target::Object(object) => self.aim_at_object(from, object, tries, random),
        }
    }

    const SAMPLES: [bool; 2] = [true, true];

    fn sample(
        &self,
        from: u32,
        target: Target,
        random: &mut Random,
        may_lead: &dyn Fn(&SightSegment) -> bool,
    ) -> Sample {
        let Some(p) = self.any_place(from, random) else { return Sample::Nowhere };
        let end = match target {
            Target::Cell(to) => self.any_place(to.0, random),
            Target::Object(object) => match self.extent(object) {
                Some(extent) => self.any_place_in(extent, random),
                None => self.any_place_on(object, random),
            },
        };
        let Some(q) = end else { return Sample::Nowhere };
        let sight = Self::sight(from, target, [p, q]);
        let [p, q] = sight.segment;
        match target {
            Target::Object(object) if self.extent(object).is_none() => {
                Sample::of(may_lead(&sight).then(|| self.sight_of_object(from, object, p, q)).flatten())
            }
            Target::Object(_) => Sample::of(self.proves(&sight).then_some(sight)),
            Target::Cell(_) => {
                let is_free = || self.hit(p, sub(q, p), 1.0).1.is_none();
                Sample::of((may_lead(&sight) && is_free() && self.proves(&sight)).then_some(sight))
            }
        }
    }

    fn has_one_way(&self) -> bool {
        self.hides_from_front.contains(&true)
    }

    fn neighbours(&self) -> &[Vec<u32>] {
        &self.next
    }

    fn misses(&self, portal: &PortalRecord, [p, q]: [Point3; 2]) -> bool {
        segment_and_polygon_apart(p, q, &portal.points)
    }

    fn crosses(&self, portal: &PortalRecord, [p, q]: [Point3; 2]) -> bool {
        segment_crosses_polygon(p, q, &portal.points)
    }

    fn through_borders(&self, from: u32, portals: &[&PortalRecord]) -> Vec<SightSegment> {
        let own = &self.cells[from as usize];
        let touches = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= own.max[k] && own.min[k] <= b.max[k]);
        let (mut found, mut near) = (Vec::new(), Vec::new());
        self.cell_tree.visit(touches, |other| near.push(other));
        near.sort_unstable();
        for other in near {
            for axis in (0..3).filter(|&axis| self.cells[other as usize].min[axis] == own.max[axis]) {
                found.extend(self.through_border([from, other], axis, portals));
            }
        }
        found
    }
}

impl SolidWorld {
    /// Segments through the border of two boxes, of which the second lies beyond the first along an axis.
    fn through_border(&self, [from, to]: [u32; 2], axis: usize, portals: &[&PortalRecord]) -> Vec<SightSegment> {
        let [a, b] = [from, to].map(|cell| &self.cells[cell as usize]);
        let place = a.max[axis];
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let common = across.map(|k| [a.min[k].max(b.min[k]), a.max[k].min(b.max[k])]);
        if common.iter().any(|[low, high]| low >= high) {
            return Vec::new();
        }
        let portals = portals.iter().map(|portal| Aabb::<3>::around(portal.points.iter().copied()));
        let portals: Vec<Aabb<3>> = portals.filter(|b| b.min[axis] == place && b.max[axis] == place).collect();
        // What is on the border changes only where corners of what touches it are.
        let mut corners: Vec<Point3> = portals.iter().flat_map(|b| [b.min, b.max]).collect();
        let border = |b: &Aabb<3>| {
            let meets = |(&k, [low, high]): (&usize, &[f64; 2])| b.min[k] <= *high && *low <= b.max[k];
            b.min[axis] <= place && place <= b.max[axis] && across.iter().zip(&common).all(meets)
        };
        self.tree.visit(border, |i| corners.extend(self.triangles[i as usize].iter().filter(|p| p[axis] == place)));
        let [u, v] = [0, 1].map(|i| middles(common[i], corners.iter().map(|p| p[across[i]]).collect()));
        let is_covered = |p: Point3| portals.iter().any(|b| b.contains(p));
        let mut found = Vec::new();
        for [u, v] in pairs(&u, &v) {
            let mut middle = [place; 3];
            (middle[across[0]], middle[across[1]]) = (u, v);
            if is_covered(middle) {
                continue;
            }
            for share in DEPTHS {
                let (mut p, mut q) = (middle, middle);
                p[axis] -= (place - a.min[axis]) * share;
                q[axis] += (b.max[axis] - place) * share;
                found.push(Self::sight(from, Target::Cell(CellId(to)), [p, q]));
            }
        }
        found
    }
}

/// How far segments through a border reach into cells, as shares of the cells' depth: little, as something may be near, and more, as doubles may
/// not resolve little.
const DEPTHS: [f64; 2] = [1.0 / (1u64 << 20) as f64, 1.0 / 16.0];
