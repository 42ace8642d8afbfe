//! Chains of triangles that block every line of a cell.
//!
//! Let `F` be a set of triangles of a mesh, and its *rim* the edges at which an odd number of them end. If
//! 1. no triangle of `F` has a point in the relative interior of either end, but for triangles on the plane where lines begin or
//!    beyond it, which lines cross as they begin,
//! 2. no line between inner points of the ends meets the rim, because all pass it on one side, or it lies outside of their hull or off
//!    their [side](crate::side) of an edge, or on the border of the triangle inside of which they end, where they begin on one side of its plane,
//! 3. one such line crosses `F` an odd number of times, nowhere at an edge,
//!
//! then every line of the cell meets `F`. Lines between inner points can be moved into each other without passing the rim (2) or
//! having an end on `F` (1), so the number of crossings stays odd (3); all others are limits of these, and `F` is closed. For the lines
//! on one side of an edge all three are needed only of those, if they are connected: then they too can be moved into each other.
//!
//! An end that a triangle of `F` crosses is [cut](crate::end) by its plane, into parts that know on which side they are: no rounding puts points of
//! them on the other side. Lines are connected as well if only a convex part of an end counts.
//!
//! Where `F` has triangles that block from their fronts only, the number of crossings is counted with signs; see [`crate::sense`].
//!
//! `F` is found by growth: from a triangle that the middle line hits, over every edge of the rim that lines pass on both sides, to
//! the next triangle. Where there is none, or only one that folds back, as at a silhouette, the lines on the far side of that edge are left to other
//! chains. Growth is a heuristic; the conditions are checked exactly.
//!
//! Source: parity as for the ShieldTester of Navazo, Rossignac, Jou and Shariff, Computer Graphics Forum 22(3), 2003; cells of
//! line space and the growth within them were chosen here.

use crate::cell::{Cell, Passing};
use crate::end::End;
use crate::hull::{Code, Hull};
use crate::marks::Marks;
use crate::orient::sign;
use crate::sense::Sense;
use crate::side::{Limit, Side};
use crate::surface::Surface;
use crate::touch::{Start, Target};
use sightlines_geometry::vector::{cross, dot, sub};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_multifocal::mesh::collinear;

/// Why a chain does not block a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Gap {
    /// Lines pass an edge on both sides, and nothing continues the chain there; with the triangle that ends at it.
    Edge { edge: u32, triangle: u32 },
    /// A triangle touches the end where lines begin.
    Start { triangle: u32 },
    /// A triangle touches the target.
    Target { triangle: u32 },
    /// The chain is too long, or is crossed an even number of times.
    Other,
}

/// What a chain blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Blocked {
    /// All lines in question.
    All,
    /// Those on this side of an edge, roughly such a share of the lines of the cell.
    Side { limit: Limit, share: f64 },
}

/// Why a chain blocks nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Failure {
    /// Where.
    pub(crate) gap: Gap,
    /// Whether it met a silhouette where it could have folded back.
    pub(crate) can_fold: bool,
}

/// How a chain goes on at a silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AtFold {
    /// At one edge it leaves the lines beyond to other chains; not in a cell that is limited to a side already.
    Leave,
    /// It folds back, and has at most so many triangles from the first fold on.
    Follow(usize),
}

/// A cell with what its chains share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaft {
    pub(crate) cell: Cell,
    pub(crate) start: Start,
    pub(crate) hull: Hull,
    /// Around both ends.
    bounds: Aabb<3>,
    /// Inner points of the ends.
    pub(crate) line: [Point3; 2],
    /// How far the second of them may be from the true end.
    pub(crate) rounding: Point3,
    /// The lines in question, if not all: they are connected, and the middle line is one.
    side: Option<Side>,
    /// The triangle that lines end at, if all that begin at inner points come from one side of its plane. They meet the plane inside of it only,
    /// so not its border.
    ends_in: Option<[Point3; 3]>,
}

impl Shaft {
    /// None for ends without inner points.
    pub(crate) fn new(
        mut cell: Cell,
        start: Start,
        target: &Target,
        surface: &Surface,
        random: &mut Random,
    ) -> Option<Self> {
        let mut weights = || [0; 4].map(|_| 0.7 + 0.6 * random.unit());
        let from = match cell.from.inner_part(weights(), |t| surface.corners(t)) {
            None if cell.from.is_partial() => {
                // Asks more.
                cell.from = cell.from.whole();
                cell.from.inner(weights())?
            }
            found => found?,
        };
        let (to, rounding) = cell.to.inner(weights())?;
        let (a, b) = (cell.from.bounds(), cell.to.bounds());
        let bounds = a.with(b.min).with(b.max);
        let (hull, line, ends_in) =
            (Hull::of(&cell, surface.reach()), [from.0, to], target.seen_from_one_side(&cell.from));
        Some(Self { cell, start, hull, bounds, line, rounding, side: None, ends_in })
    }

    /// Of the lines of the cell those on a side; says whether they are certainly connected, and one was found.
    pub(crate) fn limit(&mut self, side: Side, random: &mut Random) -> bool {
        if !side.is_connected(&self.cell) {
            return false;
        }
        let [i, j] = side.farthest();
        let mut others = 1.0;
        while self.sign_of_middle(side.limit.edge) != side.limit.sign {
            others /= 4.0;
            let mut near = |end: &End, corner: usize| {
                end.inner(end.weights_near(corner, others).map(|w| w * (0.7 + 0.6 * random.unit())))
            };
            let is_partial = self.cell.from.is_partial();
            let from = if is_partial { Some((self.line[0], [0.0; 3])) } else { near(&self.cell.from, i) };
            let ends = from.zip(near(&self.cell.to, j));
            let Some(((from, _), (to, rounding))) = ends.filter(|_| others > NEAREST) else { return false };
            (self.line, self.rounding) = ([from, to], rounding);
        }
        self.side = Some(side);
        true
    }

    /// The sign of the side on which the middle line passes an edge; 0 if that is not certain.
    fn sign_of_middle(&self, [x, y]: [Point3; 2]) -> f64 {
        let [p, q] = self.line;
        f64::from(sign(x, y, p, q, self.rounding))
    }

    /// The lines of the cell that pass an edge on the same side as the middle line, if that is certain.
    fn side_of_middle(&self, edge: [Point3; 2]) -> Option<Side> {
        let sign = self.sign_of_middle(edge);
        (sign != 0.0).then(|| Side::new(&self.cell, Limit { edge, sign }))
    }
}

/// How near to corners of the ends lines are tried to find one on a side.
const NEAREST: f64 = 1.0 / (1u64 << 24) as f64;

/// Memory for the search of chains in one surface.
#[derive(Debug)]
pub(crate) struct ChainFinder {
    /// For vertices of the present cell.
    codes: Marks<Code>,
    /// For edges of the present cell whether lines may pass them on both sides.
    mixed: Marks<bool>,
    /// For edges of the present chain how often triangles end there, by their senses; odd for the rim.
    ends: Marks<i32>,
    /// For triangles of the present chain their sense: in which direction a crossing counts.
    senses: Marks<i8>,
    /// What triangles with one side do to lines from a volume.
    sense: Sense,
    /// Whether the present chain blocks only what crosses it in one direction.
    has_direction: bool,
    chain: Vec<u32>,
    open: Vec<(u32, u32)>,
    /// How many triangles a chain has at most.
    longest: usize,
}

impl ChainFinder {
    pub(crate) fn new(surface: &Surface, longest: usize) -> Self {
        let mesh = surface.mesh();
        Self {
            codes: Marks::new(mesh.vertices().len()),
            mixed: Marks::new(mesh.edges().len()),
            ends: Marks::new(mesh.edges().len()),
            senses: Marks::new(mesh.triangles().len()),
            sense: Sense::new(surface),
            has_direction: false,
            chain: Vec::new(),
            open: Vec::new(),
            longest,
        }
    }

    /// Has to come before the chains of lines from another volume.
    pub(crate) fn look_from(&mut self, volume: &Aabb<3>) {
        self.sense.look_from(volume);
    }

    /// Whether a triangle that the middle line meets blocks it, as doubles have it.
    pub(crate) fn blocks(&mut self, surface: &Surface, shaft: &Shaft, triangle: u32) -> bool {
        self.sense.blocks_always(surface, triangle) || surface.is_met_from_front(triangle, &shaft.line)
    }

    /// Has to come before the chains of another cell.
    pub(crate) fn next_cell(&mut self) {
        self.codes.forget();
        self.mixed.forget();
    }

    fn next_chain(&mut self) {
        self.ends.forget();
        self.senses.forget();
        self.has_direction = false;
        self.chain.clear();
        self.open.clear();
    }

    /// Grows a chain from a triangle; what it blocks of the lines of the cell, or of those on a side of it.
    pub(crate) fn block(
        &mut self,
        surface: &Surface,
        shaft: &Shaft,
        target: &Target,
        start: u32,
        at_fold: AtFold,
    ) -> Result<Blocked, Failure> {
        self.next_chain();
        let mut longest = self.longest;
        let (mut folded, mut left, mut can_fold) = (None, None, false);
        let failure = |gap, can_fold| Failure { gap, can_fold };
        // What the middle line meets counts, in whichever direction.
        let sense = if !surface.has_fronts() || surface.is_met_from_front(start, &shaft.line) { 1 } else { -1 };
        self.add(surface, shaft, target, start, sense).map_err(|gap| failure(gap, can_fold))?;
        while let Some((edge, triangle)) = self.open.pop() {
            if !self.is_odd(edge) || !self.is_mixed(surface, shaft, edge) {
                continue;
            }
            let ends = surface.edge(edge);
            if left.is_some_and(|side: Side| side.misses(&shaft.cell, ends)) {
                continue;
            }
            let gap = Gap::Edge { edge, triangle };
            let next = self.next_triangle(surface, shaft, target, edge, triangle);
            match (next, at_fold) {
                (None, AtFold::Follow(_)) => return Err(failure(folded.unwrap_or(gap), false)),
                (Some((next, sense, false)), _) => {
                    if self.chain.len() >= longest {
                        return Err(failure(folded.unwrap_or(Gap::Other), can_fold));
                    }
                    self.add(surface, shaft, target, next, sense).map_err(|gap| failure(gap, can_fold))?;
                }
                (Some((next, sense, true)), AtFold::Follow(most)) => {
                    if folded.is_none() {
                        folded = Some(gap);
                        longest = longest.min(self.chain.len() + most);
                    }
                    if self.chain.len() >= longest {
                        return Err(failure(folded.unwrap_or(Gap::Other), can_fold));
                    }
                    self.add(surface, shaft, target, next, sense).map_err(|gap| failure(gap, can_fold))?;
                }
                (_, AtFold::Leave) => {
                    can_fold |= next.is_some();
                    folded = folded.or(Some(gap));
                    let is_first = shaft.side.is_none() && left.is_none();
                    let on_side = if is_first { shaft.side_of_middle(ends) } else { None };
                    let Some(on_side) = on_side.filter(|side| side.is_connected(&shaft.cell) && !side.is_nearly_all())
                    else {
                        return Err(failure(folded.unwrap_or(gap), can_fold));
                    };
                    left = Some(on_side);
                }
            }
        }
        if !self.is_crossed(surface, shaft) || self.has_direction && !self.agrees(surface, shaft, left) {
            return Err(failure(folded.unwrap_or(Gap::Other), can_fold));
        }
        let of_side = |side: Side| Blocked::Side { limit: side.limit, share: side.share() };
        Ok(left.map_or(Blocked::All, of_side))
    }

    fn add(&mut self, surface: &Surface, shaft: &Shaft, target: &Target, triangle: u32, sense: i8) -> Result<(), Gap> {
        let (corners, bounds) = (surface.corners(triangle), surface.bounds(triangle));
        if !shaft.start.is_clear_of(surface, &corners, bounds, &shaft.cell.from) {
            return Err(Gap::Start { triangle });
        }
        if !target.is_clear_of(surface, &corners, bounds, &shaft.cell.to) {
            return Err(Gap::Target { triangle });
        }
        self.senses.set(triangle, sense);
        self.has_direction |= !self.sense.blocks_always(surface, triangle);
        self.chain.push(triangle);
        for (i, &edge) in surface.mesh().outline_edges(triangle).iter().enumerate() {
            let way = if surface.has_fronts() { sense * surface.way_along(triangle, i) } else { 1 };
            let ends = self.ends.get(edge).unwrap_or_default() + i32::from(way);
            self.ends.set(edge, ends);
            if ends % 2 != 0 {
                self.open.push((edge, triangle));
            }
        }
        Ok(())
    }

    /// Whether a triangle was part of the last chain.
    pub(crate) fn has(&self, triangle: u32) -> bool {
        self.senses.get(triangle).is_some()
    }

    fn is_odd(&self, edge: u32) -> bool {
        self.ends.get(edge).is_some_and(|ends| ends % 2 != 0)
    }

    /// Whether the lines in question may pass an edge on both sides, and meet it.
    fn is_mixed(&mut self, surface: &Surface, shaft: &Shaft, edge: u32) -> bool {
        if let Some(mixed) = self.mixed.get(edge) {
            return mixed;
        }
        let ends = surface.mesh().edges()[edge as usize];
        let [p, q] = surface.edge(edge);
        // No line leaves the box around the ends; most edges are far from it.
        let around = &shaft.bounds;
        if (0..3).any(|k| p[k].max(q[k]) < around.min[k] || p[k].min(q[k]) > around.max[k]) {
            self.mixed.set(edge, false);
            return false;
        }
        let [s, t] = [(ends[0], p), (ends[1], q)].map(|(v, at)| self.code(shaft, v, at));
        let mixed = !shaft.hull.misses(s, t)
            && shaft.cell.passing(p, q) == Passing::Both
            && shaft.side.is_none_or(|side| !side.misses(&shaft.cell, [p, q]))
            && !shaft.ends_in.is_some_and(|triangle| is_on_border(&triangle, [p, q]));
        self.mixed.set(edge, mixed);
        mixed
    }

    fn code(&mut self, shaft: &Shaft, vertex: u32, at: Point3) -> Code {
        if let Some(code) = self.codes.get(vertex) {
            return code;
        }
        let code = shaft.hull.code(at);
        self.codes.set(vertex, code);
        code
    }

    /// The triangle that continues the chain beyond an edge with its sense, and whether the chain folds back there: the largest one on the
    /// other side of the edge as seen along the middle line, else one on the same side.
    fn next_triangle(
        &mut self,
        surface: &Surface,
        shaft: &Shaft,
        target: &Target,
        edge: u32,
        triangle: u32,
    ) -> Option<(u32, i8, bool)> {
        let mesh = surface.mesh();
        let [p, q] = mesh.edges()[edge as usize].map(|v| sub(mesh.vertices()[v as usize], shaft.line[0]));
        let normal = cross(p, q);
        let side = |t: u32| dot(normal, sub(surface.middle(t), shaft.line[0])) > 0.0;
        let here = side(triangle);
        let way = self.senses.get(triangle).unwrap_or(1) * surface.way_at(triangle, edge);
        let mut best: Option<(bool, f64, u32, i8)> = None;
        for &other in mesh.triangles_at(edge) {
            if other == triangle || self.has(other) {
                continue;
            }
            let sense = -way * surface.way_at(other, edge);
            if sense < 0 && !self.sense.blocks_always(surface, other) {
                continue;
            }
            let (corners, bounds) = (surface.corners(other), surface.bounds(other));
            if !shaft.start.is_clear_of(surface, &corners, bounds, &shaft.cell.from)
                || !target.is_clear_of(surface, &corners, bounds, &shaft.cell.to)
            {
                continue;
            }
            let candidate = (side(other) != here, surface.area(other), other, sense);
            if best.is_none_or(|b| (candidate.0, candidate.1) > (b.0, b.1)) {
                best = Some(candidate);
            }
        }
        best.map(|(continues, _, t, sense)| (t, sense, !continues))
    }

    /// Of a chain with a direction: whether its triangles agree at every edge within it that the lines in question may pass on both sides.
    fn agrees(&mut self, surface: &Surface, shaft: &Shaft, left: Option<Side>) -> bool {
        let outlines = self.chain.iter().flat_map(|&t| surface.mesh().outline_edges(t));
        let mut edges: Vec<u32> =
            outlines.copied().filter(|&e| self.ends.get(e).is_some_and(|ends| ends != 0)).collect();
        edges.retain(|&edge| self.is_mixed(surface, shaft, edge));
        edges.iter().all(|&edge| left.is_some_and(|side| side.misses(&shaft.cell, surface.edge(edge))))
    }

    /// Condition 3, of the middle line; in a chain with a direction more often in it than against it.
    fn is_crossed(&self, surface: &Surface, shaft: &Shaft) -> bool {
        let (mut n, mut along) = (0u32, 0i32);
        let [p, q] = shaft.line;
        let far = |b: &Aabb<3>, k: usize| {
            b.max[k] < p[k].min(q[k] - shaft.rounding[k]).next_down()
                || b.min[k] > p[k].max(q[k] + shaft.rounding[k]).next_up()
        };
        for &t in &self.chain {
            if (0..3).any(|k| far(surface.bounds(t), k)) {
                continue;
            }
            match crosses(shaft, surface.corners(t)) {
                Some(0) => {}
                Some(way) => {
                    n += 1;
                    along += i32::from(way * self.senses.get(t).unwrap_or(1));
                }
                None => return false,
            }
        }
        n % 2 == 1 && (!self.has_direction || along > 0)
    }
}

/// Whether an edge is a part of the border of a triangle, exactly.
fn is_on_border(triangle: &[Point3; 3], edge: [Point3; 2]) -> bool {
    (0..3).any(|i| {
        let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
        edge.iter().all(|&p| p == a || p == b || collinear(a, b, p))
    })
}

/// Whether the middle line crosses a triangle in its interior: 1 from its front to its back, -1 the other way, 0 not; none if that is not
/// certain.
fn crosses(shaft: &Shaft, [a, b, c]: [Point3; 3]) -> Option<i8> {
    let [p, q] = shaft.line;
    let mut sides = [0i8; 3];
    for (side, [x, y]) in sides.iter_mut().zip([[a, b], [b, c], [c, a]]) {
        *side = sign(x, y, p, q, shaft.rounding);
    }
    if sides.contains(&1) && sides.contains(&-1) {
        return Some(0);
    }
    let end = sign(a, b, c, q, shaft.rounding);
    let start = sign(a, b, c, p, [0.0; 3]);
    if sides.contains(&0) || end == 0 {
        return None;
    }
    // A line that begins on a triangle crosses it there: condition 1 leaves only those that it comes to from behind.
    Some(if start == end { 0 } else { -end })
}
