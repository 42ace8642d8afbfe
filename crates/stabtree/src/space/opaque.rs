//! The walls of a graph of boxes, as few large rectangles.
//!
//! A wall of a cell is opaque wherever no portal is. Walls of many cells that lie on one plane are put
//! together, and covered by rectangles that cannot be made larger: each blocks as much as can be blocked
//! by one.

use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::Aabb;
use std::collections::BTreeMap;

/// Fields of a plane that are painted at once; larger planes are cut.
const MAX_FIELDS: usize = 1 << 24;

/// A rectangle on a plane, by its extents along two axes.
type Patch = Aabb<2>;

/// What lies on one plane.
#[derive(Debug, Default)]
struct Plane {
    walls: Vec<Patch>,
    portals: Vec<Patch>,
    /// Cross-sections of what no line gets into.
    solid: Vec<Patch>,
}

/// A double as a key with the order of its value.
fn key(x: f64) -> u64 {
    // Negative zero is zero.
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The axes of a plane's extents.
const fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Rectangles that together cover exactly the closed walls of a graph that are not portals. They may
/// overlap; none can be made larger within the walls of its plane.
///
/// `solid` are boxes that no line from a cell gets into: with them, walls go on through what stands
/// between them.
pub(super) fn opaque_rectangles(graph: &CellGraph<Axial>, solid: &[Aabb<3>]) -> Vec<Aabb<3>> {
    let mut planes: BTreeMap<(usize, u64), (f64, Plane)> = BTreeMap::new();
    let flat = |b: &Aabb<3>, axis: usize| {
        let [u, v] = others(axis);
        Patch { min: [b.min[u], b.min[v]], max: [b.max[u], b.max[v]] }
    };
    for cell in graph.cells() {
        for axis in 0..3 {
            for at in [cell.bounds.min[axis], cell.bounds.max[axis]] {
                let plane = planes.entry((axis, key(at))).or_insert_with(|| (at, Plane::default()));
                plane.1.walls.push(flat(&cell.bounds, axis));
            }
        }
    }
    for portal in graph.portals() {
        let axis = usize::from(portal.shape.axis);
        if let Some(plane) = planes.get_mut(&(axis, key(portal.shape.at()))) {
            plane.1.portals.push(flat(&portal.shape.extent, axis));
        }
    }
    let mut rectangles = Vec::new();
    for ((axis, _), (at, mut plane)) in planes {
        plane.solid.extend(solid.iter().filter(|b| b.min[axis] <= at && at <= b.max[axis]).map(|b| flat(b, axis)));
        let [u, v] = others(axis);
        plane.cover(&mut |patch| {
            let (mut min, mut max) = ([at; 3], [at; 3]);
            (min[u], min[v], max[u], max[v]) = (patch.min[0], patch.min[1], patch.max[0], patch.max[1]);
            rectangles.push(Aabb { min, max });
        });
    }
    rectangles
}

impl Plane {
    /// The distinct coordinates along one extent, ascending.
    fn lines(&self, k: usize) -> Vec<f64> {
        let mut lines: Vec<f64> =
            self.walls.iter().chain(&self.portals).chain(&self.solid).flat_map(|p| [p.min[k], p.max[k]]).collect();
        lines.sort_unstable_by(f64::total_cmp);
        lines.dedup();
        lines
    }

    fn cover(self, take: &mut impl FnMut(Patch)) {
        let (us, vs) = (self.lines(0), self.lines(1));
        if us.len().saturating_mul(vs.len()) > MAX_FIELDS {
            let (k, at) = if us.len() >= vs.len() { (0, us[us.len() / 2]) } else { (1, vs[vs.len() / 2]) };
            let [low, high] = self.halves(k, at);
            low.cover(take);
            high.cover(take);
            return;
        }
        Painting::new(&self, us, vs).cover(take);
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
        })
    }
}

/// A plane cut into fields by all lines of its patches.
struct Painting {
    us: Vec<f64>,
    vs: Vec<f64>,
    /// What each field is, row by row.
    fields: Vec<Field>,
}

/// What a field of a plane is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Field {
    /// Open, or of no cell.
    Free,
    /// Inside of what no line gets into.
    Solid,
    /// The wall of a cell.
    Wall,
}

impl Painting {
    fn new(plane: &Plane, us: Vec<f64>, vs: Vec<f64>) -> Self {
        let n = us.len().saturating_sub(1) * vs.len().saturating_sub(1);
        let mut painting = Self { us, vs, fields: vec![Field::Free; n] };
        plane.solid.iter().for_each(|p| painting.paint(p, Field::Solid));
        plane.walls.iter().for_each(|p| painting.paint(p, Field::Wall));
        plane.portals.iter().for_each(|p| painting.paint(p, Field::Free));
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
            self.fields[v * width + u0..v * width + u1].fill(field);
        }
    }

    /// Hands out rectangles that cover all walls, as large as walls and solid things allow.
    fn cover(&self, take: &mut impl FnMut(Patch)) {
        if self.fields.is_empty() {
            return;
        }
        let (width, height) = (self.width(), self.vs.len() - 1);
        let mut covered = vec![false; self.fields.len()];
        let opaque = |f: &Field| *f != Field::Free;
        let row = |v: usize, u: [usize; 2]| self.fields[v * width + u[0]..v * width + u[1]].iter().all(opaque);
        let column = |u: usize, v: [usize; 2]| (v[0]..v[1]).all(|v| opaque(&self.fields[v * width + u]));
        for field in 0..self.fields.len() {
            if covered[field] || self.fields[field] != Field::Wall {
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

/// The largest range around `range` below `n` of which every member is accepted.
fn grow([mut low, mut high]: [usize; 2], n: usize, accept: impl Fn(usize) -> bool) -> [usize; 2] {
    while low > 0 && accept(low - 1) {
        low -= 1;
    }
    while high < n && accept(high) {
        high += 1;
    }
    [low, high]
}
