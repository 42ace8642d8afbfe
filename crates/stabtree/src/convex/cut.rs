//! Parts of portals, cut by planes that rounding cannot make too tight.
//!
//! A [`Part`] stands for a superset of the points in which some lines cross a portal: the convex hull of its
//! vertices, each grown to a ball: of radius zero for a corner of a flat portal, of twice its unevenness for a
//! corner of one that is not flat, and larger for a constructed vertex. With `m` the largest coordinate of the graph
//! and `u = 2^-53`:
//!
//! * A plane is evaluated with an error below `eps = 2^-48 m`: its normal has a length near 1, and a point
//!   differs from the plane's origin by at most `2 √3 m`, so that three products and their sum are off by less
//!   than `24 u m`.
//! * A vertex is constructed on an edge with an error below `8 u m = 2^-50 m` across the edge, so its radius is that
//!   of the larger of the edge's ends and `step = 2^-49 m` more; along the edge, it is placed beyond the plane, see
//!   [`Cutter::cut`].
//! * Each vertex carries its `clearance`: the radius and `eps`.
//! * Planes between two parts ([`Cutter::separators`]) have the first on one side and the second on the other,
//!   *strictly and by more than these errors*, but for one point that both have in common (a corner of two portals, the
//!   same bits), where the plane is exactly zero. So a line that passes the first, then the second, stays on the second
//!   side afterwards: exactly, not up to a tolerance. Where two parts share more than a corner, or come closer than
//!   errors, there is no such plane and nothing is cut.
//!
//! Source: the planes are those of Quake's vis (Abrash, Graphics Programming Black Book, chapter 70), there
//! with a tolerance of a tenth of a unit; Teller, PhD thesis, 1992, section 5.4. The margins are ours.

use super::vector::{Point3, add, cross, dot, scale, sub};
use std::ops::Range;

/// A corner of a part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point3,
    /// How far a plane has to be from it to be certainly on one side.
    pub(super) clearance: f64,
    /// Whether it is a corner of a flat portal, with no error at all.
    pub(super) exact: bool,
    /// Whether the edge that ends here was cut, and is not one of the portal.
    pub(super) cut: bool,
}

/// A convex part of a portal.
pub(super) type Part = Vec<Vertex>;

/// Square of the cosine above which two separating planes of two parts are so similar that one of them is enough.
const ALIKE: f64 = 1.0 - 1e-9;

/// Upper bound on the length of normals, rounding included.
const LONGEST: f64 = 1.02;

/// Most vertices of a part that is still cut; one with more stays uncut, which is a superset.
const MAX_VERTICES: usize = 24;

/// The points with `normal · (x - origin) + offset >= 0`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) normal: Point3,
    pub(super) origin: Point3,
    pub(super) offset: f64,
}

impl Plane {
    #[inline(always)]
    pub(super) fn at(&self, x: Point3) -> f64 {
        dot(self.normal, sub(x, self.origin)) + self.offset
    }

    /// Value at the corner of a box that is farthest on the positive side.
    #[inline(always)]
    pub(super) fn highest(&self, min: &Point3, max: &Point3) -> f64 {
        self.at(std::array::from_fn(|k| if self.normal[k] > 0.0 { max[k] } else { min[k] }))
    }

    fn flipped(self) -> Self {
        Self { normal: scale(self.normal, -1.0), origin: self.origin, offset: -self.offset }
    }
}

/// A ball that contains the corners of a portal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub(super) center: Point3,
    /// Rounded up.
    pub(super) radius: f64,
    /// That of the portal's corners.
    pub(super) clearance: f64,
}

/// Cuts parts and counts how often.
#[derive(Debug, Clone)]
pub(super) struct Cutter {
    pub(super) eps: f64,
    step: f64,
    /// Number of attempted cuts.
    pub(super) clips: u64,
    spare: Part,
}

impl Cutter {
    /// For a graph whose largest coordinate is `m`.
    pub(super) fn new(m: f64) -> Self {
        Self { eps: m * 2f64.powi(-48), step: m * 2f64.powi(-49), clips: 0, spare: Vec::new() }
    }

    /// Cuts off what lies below the plane; `false` if nothing is left, and then the part must not be used.
    ///
    /// The cut is made below the plane by the part's own inaccuracy and once more by the error of evaluation,
    /// so that a constructed vertex lies beyond the true cut.
    pub(super) fn cut(&mut self, part: &mut Part, plane: &Plane) -> bool {
        self.clips += 1;
        let n = part.len();
        if n > MAX_VERTICES {
            return true;
        }
        let mut values = [0.0f64; MAX_VERTICES];
        let (mut low, mut high, mut clearance) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
        for (v, f) in part.iter().zip(&mut values) {
            *f = plane.at(v.at);
            // What is not a number counts as neither.
            low = if *f < low { *f } else { low };
            high = if *f > high { *f } else { high };
            clearance = if v.clearance > clearance { v.clearance } else { clearance };
        }
        let below = LONGEST * clearance + self.eps;
        // NaN decides nothing.
        if !(low.is_finite() && high.is_finite()) {
            return true;
        }
        if high < -below {
            return false;
        }
        if low >= -below {
            return true;
        }
        self.spare.clear();
        let (mut before, mut f_before) = (part[n - 1], values[n - 1] + below);
        for (v, f) in part.iter().zip(&values) {
            let f = f + below;
            if (f < 0.0) != (f_before < 0.0) {
                let at = add(before.at, scale(sub(v.at, before.at), f_before / (f_before - f)));
                // Coming back up, the edge that ends here is the cut; going down it is what is left of v's.
                let clearance = before.clearance.max(v.clearance) + self.step;
                self.spare.push(Vertex { at, clearance, exact: false, cut: f >= 0.0 || v.cut });
            }
            if f >= 0.0 {
                self.spare.push(*v);
            }
            (before, f_before) = (*v, f);
        }
        std::mem::swap(part, &mut self.spare);
        part.len() >= 3
    }

    /// Cuts a part of a portal with all planes that the portal's ball does not show to leave it whole, or to leave
    /// nothing: the same as all cuts, with less work.
    #[inline(always)]
    pub(super) fn cut_all<'p>(
        &mut self,
        part: &mut Part,
        ball: &Ball,
        planes: impl Iterator<Item = &'p Plane>,
    ) -> bool {
        let radius = LONGEST * ball.radius;
        for plane in planes {
            let value = plane.at(ball.center);
            if value < radius && (value < -(radius + LONGEST * ball.clearance + self.eps) || !self.cut(part, plane)) {
                return false;
            }
        }
        true
    }

    /// Appends planes that have `first` below and `second` above: for each edge of either, the supporting plane of the
    /// other. Both run counter-clockwise about the direction in which lines pass them.
    pub(super) fn separators(&self, first: &[Vertex], second: &[Vertex], planes: &mut Vec<Plane>) {
        let mut shared = None;
        for a in first {
            for b in second {
                if a.exact && b.exact && a.at == b.at {
                    if shared.is_some() {
                        return;
                    }
                    shared = Some(a.at);
                }
            }
        }
        // Most share none, and then nothing has to be compared with it.
        match shared {
            None => leaning_both(first, second, None, planes),
            Some(_) => leaning_both(first, second, shared, planes),
        }
    }
}

/// Appends the planes of [`leaning`] for the edges of both parts.
#[inline(always)]
fn leaning_both(first: &[Vertex], second: &[Vertex], shared: Option<Point3>, planes: &mut Vec<Plane>) {
    let start = planes.len();
    leaning([first, second], 1.0, shared, start..start, planes);
    // Parallel edges support each other; one plane for both is enough.
    leaning([second, first], -1.0, shared, start..planes.len(), planes);
}

/// Appends, for each edge of `part`, the plane through it that supports `other`, if it separates the two: `part` on one
/// side, `other` on the other. `turn` is 1 if lines pass `part` first, and -1 if they pass it last: then its corners run
/// the other way round as seen from `other`. Planes like one of the `known` are left out.
#[inline(always)]
fn leaning(
    [part, other]: [&[Vertex]; 2],
    turn: f64,
    shared: Option<Point3>,
    known: Range<usize>,
    planes: &mut Vec<Plane>,
) {
    for_edges(part, |a, b| {
        let may_lean = shared.is_none() || is_shared(a, shared) || is_shared(b, shared);
        if !may_lean {
            return;
        }
        let others = other.iter().filter(|v| !is_shared(v, shared));
        let Some((v, normal)) = first_met(a, b, turn, others) else { return };
        let square = dot(normal, normal);
        let is_known = |known: &Plane| {
            let along = turn * dot(known.normal, normal);
            along > 0.0 && along * along > ALIKE * square
        };
        if planes[known.clone()].iter().any(is_known) {
            return;
        }
        if let Some(plane) = lean([a, b, v], normal, square, shared) {
            let (plane, [first, second]) =
                if turn > 0.0 { (plane, [part, other]) } else { (plane.flipped(), [other, part]) };
            if separates(&plane, first, second, shared) {
                planes.push(plane);
            }
        }
    });
}

#[inline(always)]
fn for_edges(part: &[Vertex], mut edge: impl FnMut(&Vertex, &Vertex)) {
    let mut last = &part[part.len() - 1];
    for b in part {
        edge(std::mem::replace(&mut last, b), b);
    }
}

/// Of the planes through an edge, the first one that meets one of the points as it turns from the edge's own part (or
/// towards it, with the other `turn`): the point and the normal, of any length, that has the others above.
#[inline(always)]
fn first_met<'v>(
    a: &Vertex,
    b: &Vertex,
    turn: f64,
    points: impl Iterator<Item = &'v Vertex>,
) -> Option<(&'v Vertex, Point3)> {
    let edge = scale(sub(b.at, a.at), turn);
    let mut met: Option<(&Vertex, Point3)> = None;
    for v in points {
        let from = sub(v.at, a.at);
        if met.is_none_or(|(_, normal)| dot(normal, from) < 0.0) {
            met = Some((v, cross(edge, from)));
        }
    }
    met
}

/// Appends planes that have both parts above, and with them all segments between the two: for each edge of either, the
/// supporting plane of the other. Where rounding or an unusual shape would put a point below, the plane is moved down
/// by as much, so the claim always holds.
pub(super) fn enclosing(first: &[Vertex], second: &[Vertex], planes: &mut Vec<Plane>) {
    for (part, other, turn) in [(first, second, -1.0), (second, first, 1.0)] {
        for_edges(part, |a, b| {
            let Some((_, normal)) = first_met(a, b, turn, other.iter()) else { return };
            let square = dot(normal, normal);
            // Three collinear points span no plane.
            if square.partial_cmp(&f64::MIN_POSITIVE) == Some(std::cmp::Ordering::Greater) {
                let mut plane = Plane { normal: scale(normal, 1.0 / square.sqrt()), origin: a.at, offset: 0.0 };
                let lowest = first.iter().chain(second).map(|v| plane.at(v.at) - v.clearance);
                plane.offset = -lowest.fold(f64::INFINITY, f64::min);
                planes.push(plane);
            }
        });
    }
}

/// The plane through the edge `a`, `b` and the point `v`, turned a little, so that the edge lies below it by one and
/// a half times its clearance, and `v` above by as much; a shared corner stays on it. `normal` is theirs, of any
/// length, and `nn` its square. `None` if the three are nearly in line, so that the turn would be large.
#[inline(always)]
fn lean([a, b, v]: [&Vertex; 3], normal: Point3, nn: f64, shared: Option<Point3>) -> Option<Plane> {
    let (e, f) = (sub(b.at, a.at), sub(v.at, a.at));
    let (ee, ff, ef) = (dot(e, e), dot(f, f), dot(e, f));
    // Otherwise the normal is mostly rounding; also false for what is not a number.
    if nn.partial_cmp(&(1e-12 * ee * ff)) != Some(std::cmp::Ordering::Greater) {
        return None;
    }
    let wanted = |x: &Vertex, side: f64| if is_shared(x, shared) { 0.0 } else { 1.5 * side * x.clearance };
    let (at_a, at_b, at_v) = (wanted(a, -1.0), wanted(b, -1.0), wanted(v, 1.0));
    // The gradient, within the plane of the three, of the linear function with these values.
    let (x, y) = ((at_b - at_a) * ff - (at_v - at_a) * ef, (at_v - at_a) * ee - (at_b - at_a) * ef);
    let inverse = 1.0 / nn.sqrt();
    let turn = scale(add(scale(e, x), scale(f, y)), inverse * inverse);
    // A normal longer than 1.01 would spoil the error bound of evaluation, and `LONGEST`.
    if dot(turn, turn) > 1e-4 {
        return None;
    }
    let normal = add(scale(normal, inverse), turn);
    Some(match shared {
        Some(corner) => Plane { normal, origin: corner, offset: 0.0 },
        None => Plane { normal, origin: a.at, offset: at_a },
    })
}

/// Whether all of `first` is certainly below the plane and all of `second` above, but for the shared corner,
/// which is the plane's origin and so exactly on it.
#[inline(always)]
fn separates(plane: &Plane, first: &[Vertex], second: &[Vertex], shared: Option<Point3>) -> bool {
    first.iter().all(|v| is_shared(v, shared) || plane.at(v.at) <= -LONGEST * v.clearance)
        && second.iter().all(|v| is_shared(v, shared) || plane.at(v.at) >= LONGEST * v.clearance)
}

/// Whether a vertex is the corner that two parts share.
#[inline(always)]
fn is_shared(v: &Vertex, shared: Option<Point3>) -> bool {
    v.exact && shared == Some(v.at)
}

/// Whether all of `inner` is certainly within `outer`, both of them parts of one portal with this normal, as far as
/// points of the portal itself are concerned: edges of the portal are not looked at.
pub(super) fn is_within(inner: &[Vertex], outer: &[Vertex], normal: Point3) -> bool {
    // A vertex that is also a vertex of the outer part, with no smaller clearance, is within it.
    let is_same = |v: &Vertex| outer.iter().any(|w| w.at == v.at && w.clearance >= v.clearance);
    if inner.len() > 64 {
        return false;
    }
    let mut others = 0u64;
    inner.iter().enumerate().for_each(|(k, v)| others |= u64::from(!is_same(v)) << k);
    let mut last = outer[outer.len() - 1];
    outer.iter().all(|&b| {
        let a = std::mem::replace(&mut last, b);
        if !b.cut {
            return true;
        }
        let inwards = cross(normal, sub(b.at, a.at));
        let length = dot(inwards, inwards).sqrt();
        // The ends of an edge are off by less than their clearances, so the shorter the edge, the less certain is its
        // direction; for an edge of length zero nothing is known, and nothing is within.
        inner.iter().enumerate().all(|(k, v)| {
            if others >> k & 1 == 0 {
                return true;
            }
            let from = sub(v.at, a.at);
            let off = length * (v.clearance + b.clearance) + (a.clearance + b.clearance) * dot(from, from).sqrt();
            dot(inwards, from) > off
        })
    })
}

/// The middle of the corners.
pub(super) fn middle(part: &[Vertex]) -> Point3 {
    scale(part.iter().fold([0.0; 3], |sum, v| add(sum, v.at)), 1.0 / part.len() as f64)
}

#[cfg(test)]
mod tests;
