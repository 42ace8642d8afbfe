//! The walls of a graph of boxes, as few large rectangles.
//!
//! A wall of a cell is opaque wherever there is no portal. Walls of many cells that lie on one plane are merged, and
//! covered by maximal rectangles: each blocks as much as one rectangle can.

use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::{Aabb, OneWayRectangle};
use sightlines_sightline::Blockers;
use std::collections::BTreeMap;

/// Most fields of a plane that are painted at once; larger planes are split.
pub(super) const MAX_FIELDS: usize = 1 << 24;

/// A rectangle on a plane, by its extents along two axes.
pub(super) type Patch = Aabb<2>;

/// What lies on one plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Plane {
    pub(super) walls: Vec<Patch>,
    pub(super) portals: Vec<Patch>,
    /// Cross-sections of solid boxes.
    pub(super) solid: Vec<Patch>,
    /// What hides from the side in question, where it lies in portals.
    pub(super) fronts: Vec<Patch>,
}

/// A double as a key with the order of its value.
pub(super) fn key(x: f64) -> u64 {
    // Negative zero is zero.
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The axes of a plane's extents.
pub(super) const fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Rectangles that together cover exactly the closed walls of a graph that are not portals. They may overlap; none can
/// be enlarged within the walls of its plane.
///
/// `solid` are boxes that no line from a cell enters: with them, walls continue through what stands between them.
pub(super) fn opaque_rectangles(graph: &CellGraph<Axial>, solid: &[Aabb<3>]) -> Vec<Aabb<3>> {
    Walls::of(graph, solid, &Walls::default()).rectangles().collect()
}

/// The walls of a graph, and the parts of `fronts` in its portals, each as large as what else stops lines in the same direction allows.
/// Arguments as for [`axial_visibility`](super::axial_visibility).
pub(super) fn blockers_of(graph: &CellGraph<Axial>, solid: &[Aabb<3>], fronts: &[OneWayRectangle]) -> Blockers {
    let walls = Walls::of(graph, solid, &Walls::default());
    let one_way = [true, false].map(|up| (up, walls.one_way(fronts.iter().filter(|front| front.front_up == up))));
    let one_way = one_way.into_iter().flat_map(|(front_up, rectangles)| {
        rectangles.into_iter().map(move |bounds| OneWayRectangle { bounds, front_up })
    });
    Blockers::with_one_way(walls.rectangles(), one_way)
}

/// Rectangles that cover all walls of a graph, enlarged as far as possible without a part of them inside a cell or a
/// portal: they continue through everything that is not a cell. `solid` is not needed for that.
pub(crate) fn opaque_without_solid(graph: &CellGraph<Axial>) -> Vec<Aabb<3>> {
    let all = Aabb::<3>::around(graph.cells().iter().flat_map(|c| [c.bounds.min, c.bounds.max]));
    let mut planes = Walls::planes(graph);
    planes.par_iter_mut().for_each(|(&(axis, _), covered)| {
        let through =
            graph.cells().iter().map(|c| &c.bounds).filter(|b| b.min[axis] < covered.at && covered.at < b.max[axis]);
        covered.plane.portals.extend(through.map(|b| flat(b, axis)));
        covered.plane.solid.push(flat(&all, axis));
        covered.cover(axis, Field::Wall);
    });
    Walls { planes }.rectangles().collect()
}

fn flat(b: &Aabb<3>, axis: usize) -> Patch {
    let [u, v] = others(axis);
    Patch { min: [b.min[u], b.min[v]], max: [b.max[u], b.max[v]] }
}

/// The walls of a graph, plane by plane.
#[derive(Debug, Clone, Default)]
pub(super) struct Walls {
    planes: BTreeMap<(usize, u64), Covered>,
}

/// What lies on a plane, and the rectangles that cover it.
#[derive(Debug, Clone)]
struct Covered {
    at: f64,
    plane: Plane,
    rectangles: Vec<Aabb<3>>,
}

impl Walls {
    /// The walls of a graph; arguments as for [`opaque_rectangles`]. Planes with the same content as in `before` are
    /// not covered anew, which is most of the cost.
    pub(super) fn of(graph: &CellGraph<Axial>, solid: &[Aabb<3>], before: &Self) -> Self {
        let mut planes = Self::planes(graph);
        planes.par_iter_mut().for_each(|(&(axis, at_key), covered)| {
            let through = solid.iter().filter(|b| b.min[axis] <= covered.at && covered.at <= b.max[axis]);
            covered.plane.solid.extend(through.map(|b| flat(b, axis)));
            match before.planes.get(&(axis, at_key)).filter(|same| same.plane == covered.plane) {
                Some(same) => covered.rectangles.clone_from(&same.rectangles),
                None => covered.cover(axis, Field::Wall),
            }
        });
        Self { planes }
    }

    /// The planes of a graph with their walls and portals, not yet covered.
    fn planes(graph: &CellGraph<Axial>) -> BTreeMap<(usize, u64), Covered> {
        let mut planes: BTreeMap<(usize, u64), Covered> = BTreeMap::new();
        for cell in graph.cells() {
            for axis in 0..3 {
                for at in [cell.bounds.min[axis], cell.bounds.max[axis]] {
                    let new = || Covered { at, plane: Plane::default(), rectangles: Vec::new() };
                    let covered = planes.entry((axis, key(at))).or_insert_with(new);
                    covered.plane.walls.push(flat(&cell.bounds, axis));
                }
            }
        }
        for portal in graph.portals() {
            let axis = usize::from(portal.shape.axis);
            if let Some(covered) = planes.get_mut(&(axis, key(portal.shape.at()))) {
                covered.plane.portals.push(flat(&portal.shape.extent, axis));
            }
        }
        planes
    }

    /// Rectangles that cover the parts of `fronts`, all of which face the same way, that lie in portals. They continue through walls.
    fn one_way<'f>(&self, fronts: impl Iterator<Item = &'f OneWayRectangle>) -> Vec<Aabb<3>> {
        let mut by_plane: BTreeMap<(usize, u64), Vec<Patch>> = BTreeMap::new();
        for bounds in fronts.map(|front| &front.bounds) {
            if let Some(axis) = (0..3).find(|&k| bounds.min[k] == bounds.max[k]) {
                by_plane.entry((axis, key(bounds.min[axis]))).or_default().push(flat(bounds, axis));
            }
        }
        let cover = |((axis, at_key), fronts): ((usize, u64), Vec<Patch>)| {
            let mut covered = self.planes.get(&(axis, at_key))?.clone();
            covered.plane.fronts = fronts;
            covered.rectangles.clear();
            covered.cover(axis, Field::Front);
            Some(covered.rectangles)
        };
        by_plane.into_par_iter().filter_map(cover).flatten().collect()
    }

    /// The rectangles, plane by plane.
    pub(super) fn rectangles(&self) -> impl Iterator<Item = Aabb<3>> + '_ {
        self.planes.values().flat_map(|covered| covered.rectangles.iter().copied())
    }
}

impl Covered {
    /// Covers the fields of a kind of a plane perpendicular to an axis.
    fn cover(&mut self, axis: usize, kind: Field) {
        let (at, [u, v], rectangles) = (self.at, others(axis), &mut self.rectangles);
        self.plane.cover(kind, &mut |patch| {
            let (mut min, mut max) = ([at; 3], [at; 3]);
            (min[u], min[v], max[u], max[v]) = (patch.min[0], patch.min[1], patch.max[0], patch.max[1]);
            rectangles.push(Aabb { min, max });
        });
    }
}

impl Plane {
    /// The distinct coordinates along one extent, ascending.
    pub(super) fn lines(&self, k: usize) -> Vec<f64> {
        let all = self.walls.iter().chain(&self.portals).chain(&self.solid).chain(&self.fronts);
        let mut lines: Vec<f64> = all.flat_map(|p| [p.min[k], p.max[k]]).collect();
        lines.sort_unstable_by(f64::total_cmp);
        lines.dedup();
        lines
    }

    fn cover(&self, kind: Field, take: &mut impl FnMut(Patch)) {
        let (us, vs) = (self.lines(0), self.lines(1));
        if us.len().saturating_mul(vs.len()) > MAX_FIELDS {
            let (k, at) = if us.len() >= vs.len() { (0, us[us.len() / 2]) } else { (1, vs[vs.len() / 2]) };
            let [low, high] = self.halves(k, at);
            low.cover(kind, take);
            high.cover(kind, take);
            return;
        }
        Painting::new(self, us, vs).cover(kind, take);
    }

    /// The parts on either side of a line.
    fn halves(&self, k: usize, at: f64) -> [Self; 2] {
        let part = |patches: &[Patch], low: bool| {
            let cut = |p: &Patch| {
                let mut p = *p;
                let bound = if low { &mut p.max[k] } else { &mut p.min[k] };
                *bound = if low { bound.min(at) } else { bound.max(at) };
                (p.min[k] < p.max[k]).then_some(p)
            };
            patches.iter().filter_map(cut).collect()
        };
        [true, false].map(|low| Self {
            walls: part(&self.walls, low),
            portals: part(&self.portals, low),
            solid: part(&self.solid, low),
            fronts: part(&self.fronts, low),
        })
    }
}

/// A plane cut into fields by all lines of its patches.
pub(super) struct Painting {
    us: Vec<f64>,
    vs: Vec<f64>,
    /// What each field is, row by row.
    pub(super) fields: Vec<Field>,
}

/// What a field of a plane is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    /// Inside a cell, or in none.
    Free,
    /// Open.
    Portal,
    /// In a portal, and it stops lines of the direction in question.
    Front,
    /// Inside a solid box.
    Solid,
    /// The wall of a cell.
    Wall,
}

impl Painting {
    pub(super) fn new(plane: &Plane, us: Vec<f64>, vs: Vec<f64>) -> Self {
        let n = us.len().saturating_sub(1) * vs.len().saturating_sub(1);
        let mut painting = Self { us, vs, fields: vec![Field::Free; n] };
        plane.solid.iter().for_each(|p| painting.paint(p, Field::Solid));
        plane.walls.iter().for_each(|p| painting.paint(p, Field::Wall));
        plane.portals.iter().for_each(|p| painting.paint(p, Field::Portal));
        plane.fronts.iter().for_each(|p| painting.paint(p, Field::Front));
        painting
    }

    fn width(&self) -> usize {
        self.us.len() - 1
    }

    fn paint(&mut self, patch: &Patch, field: Field) {
        let place = |lines: &[f64], x: f64| lines.partition_point(|l| *l < x);
        let (u0, u1) = (place(&self.us, patch.min[0]), place(&self.us, patch.max[0]));
        let (v0, v1) = (place(&self.vs, patch.min[1]), place(&self.vs, patch.max[1]));
        let width = self.width();
        for v in v0..v1 {
            let fields = &mut self.fields[v * width + u0..v * width + u1];
            match field {
                Field::Front => fields.iter_mut().filter(|f| **f == Field::Portal).for_each(|f| *f = field),
                _ => fields.fill(field),
            }
        }
    }

    /// Passes on rectangles that cover all fields of a kind, as large as everything opaque allows.
    fn cover(&self, kind: Field, take: &mut impl FnMut(Patch)) {
        if self.fields.is_empty() {
            return;
        }
        let (width, height) = (self.width(), self.vs.len() - 1);
        let mut covered = vec![false; self.fields.len()];
        let opaque = |f: &Field| !matches!(f, Field::Free | Field::Portal);
        let row = |v: usize, u: [usize; 2]| self.fields[v * width + u[0]..v * width + u[1]].iter().all(opaque);
        let column = |u: usize, v: [usize; 2]| (v[0]..v[1]).all(|v| opaque(&self.fields[v * width + u]));
        for field in 0..self.fields.len() {
            if covered[field] || self.fields[field] != kind {
                continue;
            }
            let (u, v) = (field % width, field / width);
            let wide = grow([u, u + 1], width, |k| column(k, [v, v + 1]));
            let wide = (wide, grow([v, v + 1], height, |k| row(k, wide)));
            let high = grow([v, v + 1], height, |k| row(k, [u, u + 1]));
            let high = (grow([u, u + 1], width, |k| column(k, high)), high);
            let mut give = |(u, v): ([usize; 2], [usize; 2])| {
                for v in v[0]..v[1] {
                    covered[v * width + u[0]..v * width + u[1]].fill(true);
                }
                take(Patch { min: [self.us[u[0]], self.vs[v[0]]], max: [self.us[u[1]], self.vs[v[1]]] });
            };
            give(wide);
            if high != wide {
                give(high);
            }
        }
    }
}

/// The largest range around `range`, below `n`, all members of which are accepted.
fn grow([mut low, mut high]: [usize; 2], n: usize, accept: impl Fn(usize) -> bool) -> [usize; 2] {
    while low > 0 && accept(low - 1) {
        low -= 1;
    }
    while high < n && accept(high) {
        high += 1;
    }
    [low, high]
}
