//! Joints: ends of walls that lie on other walls up to rounding are joined to them, and nothing is moved.
//!
//! An end E of an opaque line that misses another opaque line W by no more than the gap of the plan leaves an opening that nobody drew. A joint
//! closes it: a short opaque segment from E to the end of W if that is nearest, else across W or to a point exactly on it. Exact predicates on
//! its final coordinates decide that the segment meets W; its other end is rounded, and sticks out of W by at most the [least
//! gap](Plan::least_gap).
//!
//! **Which ends.** Of the lines within the gap of E, those that hang together by exact meetings need no joint: what they enclose with the opening
//! at E is nowhere wider than twice the gap, as each of them passes E. So what touches, crosses, or is joined by short pieces of a curve stays as
//! it is, and a plan that is joined already has no joints.
//!
//! **On which side it errs.** Distances are computed with an error of less than 2^-48 M, where M is the largest coordinate: of [`orient2d`], whose
//! value is off by less than 2^-51 of the sum of its two products, divided by the length of a line. A joint is made only if the distance and
//! that bound are within the gap. So no opening wider than the gap is closed, and all that are narrower than the gap by 2^-47 M.

use super::{LineId, Plan, PlanError, PlanLine};
use sightlines_geometry::{Aabb, BoxTree, Point2, Segment2, check_coordinate, orient2d};
use std::collections::BTreeSet;

/// A segment that closes the opening between an end of an opaque line and another opaque line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// The end, or the corner of two joints that run along the axes.
    pub from: Point2,
    /// An end of the other line, or that corner; or a point on the other line or just beyond it.
    pub to: Point2,
    /// The other line.
    pub line: LineId,
    /// Whether it leads to the inside of the other line, not to its end.
    pub inside: bool,
}

impl Joint {
    /// The joint as a segment.
    pub const fn segment(&self) -> Segment2 {
        Segment2::new(self.from, self.to)
    }
}

impl Plan {
    /// The same plan, where ends of opaque lines are joined to opaque lines that they miss by no more than `gap`, in units of the plan, by
    /// [joints](Self::joints). Lines stay what they are. Joints of a plan that has some are made anew; 0 makes none.
    ///
    /// Openings wider than `gap` stay open. O(n log n) for n lines of which few are near each other; deterministic.
    ///
    /// # Errors
    /// [`PlanError::Gap`] for a gap that is no number from [`Plan::least_gap`] on, nor 0.
    pub fn joined(&self, gap: f64) -> Result<Self, PlanError> {
        let least = self.least_gap();
        if gap != 0.0 && !(gap >= least && gap.is_finite()) {
            return Err(PlanError::Gap { gap, least });
        }
        let joints = if gap > 0.0 { find(self, gap).joints } else { Vec::new() };
        Ok(Self { joints, gap, ..self.clone() })
    }

    /// What was added where lines meet up to the [gap](Self::gap): opaque segments, in the order of the ends that they join.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Openings up to this width are closed by [joints](Self::joints); 0 where coordinates are taken exactly as they are.
    pub const fn gap(&self) -> f64 {
        self.gap
    }

    /// All that blocks sight: the opaque lines, in input order, and then the joints.
    pub fn walls(&self) -> impl Iterator<Item = Segment2> + Clone + '_ {
        let lines = self.lines.iter().filter(|line| line.opaque).map(|line| Segment2::new(line.a, line.b));
        lines.chain(self.joints.iter().map(Joint::segment))
    }

    /// The ends of opaque lines that [joints](Self::joints) join to others. As [`Plan::joined`].
    pub fn joined_ends(&self) -> Vec<Point2> {
        if self.gap > 0.0 { find(self, self.gap).ends } else { Vec::new() }
    }

    /// The ends of opaque lines that miss others by more than the [gap](Self::gap) and yet by little, and so perhaps by mistake: at most 32 times
    /// the gap and 2^-10 of the longer side of the plan; or 2^-14 of that side, or what [digits](Self::precision) explain, where that is more. None if the source [states](Self::stated_precision) that
    /// coordinates are exact. For remarks only. As [`Plan::joined`].
    pub fn near_misses(&self) -> Vec<Point2> {
        if self.stated_precision() == Some(0.0) {
            return Vec::new();
        }
        let side = self.longer_side();
        let near = (32.0 * self.gap).min(side / 1024.0).max(side / 16384.0).max(self.precision());
        if near <= self.gap || near < self.least_gap() {
            return Vec::new();
        }
        let joined: BTreeSet<[u64; 2]> = self.joined_ends().into_iter().map(bits).collect();
        find(self, near).ends.into_iter().filter(|end| !joined.contains(&bits(*end))).collect()
    }

    /// The ends of opaque lines, repeated as often as they occur.
    pub(super) fn opaque_ends(&self) -> impl Iterator<Item = Point2> + '_ {
        self.lines.iter().filter(|line| line.opaque).flat_map(|line| [line.a, line.b])
    }
}

/// What was found.
struct Found {
    joints: Vec<Joint>,
    /// Ends of opaque lines with joints.
    ends: Vec<Point2>,
}

/// Joints of all ends within a gap, in the order of the ends.
fn find(plan: &Plan, gap: f64) -> Found {
    let walls = Walls::new(plan, gap);
    let mut found = Found { joints: Vec::new(), ends: Vec::new() };
    let (mut known, mut made) = (BTreeSet::new(), BTreeSet::new());
    let mut near = Vec::new();
    for end in plan.opaque_ends().filter(|end| known.insert(bits(*end))) {
        walls.near(end, &mut near);
        let mut add = |joint: Joint| {
            let [a, b] = [bits(joint.from), bits(joint.to)];
            if made.insert([a.min(b), a.max(b)]) {
                found.joints.push(joint);
            }
        };
        if walls.join(end, &mut near, &mut add) {
            found.ends.push(end);
        }
    }
    found
}

fn bits(p: Point2) -> [u64; 2] {
    [p.x.to_bits(), p.y.to_bits()]
}

/// Where a line is nearest to a point.
#[derive(Debug, Clone, Copy)]
enum Nearest {
    End(Point2),
    Inside,
}

/// A line within the gap of an end.
#[derive(Debug, Clone, Copy)]
struct Near {
    wall: u32,
    distance: f64,
    nearest: Nearest,
}

/// The opaque lines of a plan, by place.
struct Walls<'p> {
    plan: &'p Plan,
    ids: Vec<LineId>,
    /// Boxes around parts of long lines, widened so that each has all points within the gap of its part.
    parts: Vec<(u32, Aabb<2>)>,
    tree: BoxTree<2>,
    gap: f64,
    /// More than a computed distance is off.
    error: f64,
}

impl<'p> Walls<'p> {
    fn new(plan: &'p Plan, gap: f64) -> Self {
        let ids: Vec<LineId> =
            (0u32..).map(LineId).zip(plan.lines()).filter(|(_, line)| line.opaque).map(|(id, _)| id).collect();
        let largest = plan.largest();
        let length = |id: &LineId| plan.lines()[id.0 as usize].a.distance(plan.lines()[id.0 as usize].b);
        let mean = ids.iter().map(length).sum::<f64>() / ids.len() as f64;
        // Rounding of the ends of parts is far below this.
        let slack = gap + largest / (1u64 << 44) as f64;
        let mut parts = Vec::new();
        for (wall, id) in (0..).zip(&ids) {
            let line = &plan.lines()[id.0 as usize];
            // In all at most two parts for each line.
            let n = (length(id) / mean).clamp(1.0, 4096.0) as u32;
            let at = |k: u32| line.a + (line.b - line.a) * (f64::from(k) / f64::from(n));
            for k in 0..n {
                let ends = [if k == 0 { line.a } else { at(k) }, if k + 1 == n { line.b } else { at(k + 1) }];
                let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                let (min, max) = ((low - Point2::splat(slack)).to_array(), (high + Point2::splat(slack)).to_array());
                parts.push((wall, Aabb { min, max }));
            }
        }
        let boxes: Vec<Aabb<2>> = parts.iter().map(|(_, bounds)| *bounds).collect();
        Self { plan, ids, parts, tree: BoxTree::build(&boxes, 4), gap, error: largest / (1u64 << 48) as f64 }
    }

    fn line(&self, wall: u32) -> &PlanLine {
        &self.plan.lines()[self.ids[wall as usize].0 as usize]
    }

    fn segment(&self, wall: u32) -> Segment2 {
        let line = self.line(wall);
        Segment2::new(line.a, line.b)
    }

    /// The lines that are certainly within the gap of a point, ascending.
    fn near(&self, end: Point2, near: &mut Vec<Near>) {
        near.clear();
        let has = |bounds: &Aabb<2>| bounds.contains(end.to_array());
        self.tree.visit(has, |part| {
            let (wall, bounds) = &self.parts[part as usize];
            if has(bounds) {
                let (distance, nearest) = nearest(&self.segment(*wall), end);
                if distance == 0.0 || distance + self.error <= self.gap {
                    near.push(Near { wall: *wall, distance, nearest });
                }
            }
        });
        near.sort_by_key(|near| near.wall);
        near.dedup_by_key(|near| near.wall);
    }

    /// Joins an end with the lines near it that do not hang together with it, each group of them once, at the nearest. Whether there was one.
    fn join(&self, end: Point2, near: &mut Vec<Near>, add: &mut impl FnMut(Joint)) -> bool {
        let mut own: Vec<u32> =
            near.extract_if(.., |near| self.segment(near.wall).contains(end)).map(|n| n.wall).collect();
        let is_axial = own.iter().any(|&wall| is_axial(self.line(wall)));
        let level = own.iter().any(|&wall| self.line(wall).a.y == self.line(wall).b.y);
        self.reach(&mut own, near);
        let mut found = false;
        while let Some(next) = near.iter().copied().min_by(|n, m| n.distance.total_cmp(&m.distance)) {
            found = true;
            near.retain(|near| near.wall != next.wall);
            let wall = self.line(next.wall);
            let line = self.ids[next.wall as usize];
            let across = matches!(next.nearest, Nearest::Inside).then(|| self.across(end, next.wall)).flatten();
            let to_end = |to: Point2, add: &mut dyn FnMut(Joint)| {
                let joint = |from, to| Joint { from, to, line, inside: false };
                if end.x != to.x && end.y != to.y && is_axial && self::is_axial(wall) {
                    // Along the axes, the wall that ends here first.
                    let corner = if level { Point2::new(to.x, end.y) } else { Point2::new(end.x, to.y) };
                    add(joint(end, corner));
                    add(joint(corner, to));
                } else {
                    add(joint(end, to));
                }
            };
            match (across, next.nearest) {
                (Some(to), _) => add(Joint { from: end, to, line, inside: true }),
                (None, Nearest::End(to)) => to_end(to, add),
                // Next to an end of the wall, where no double lies beyond it.
                (None, Nearest::Inside) => {
                    let to = if end.distance(wall.a) <= end.distance(wall.b) { wall.a } else { wall.b };
                    if end.distance(to) + self.error <= self.gap {
                        to_end(to, add);
                    }
                }
            }
            self.reach(&mut vec![next.wall], near);
        }
        found
    }

    /// Takes from `others` what hangs together with some lines.
    fn reach(&self, lines: &mut Vec<u32>, others: &mut Vec<Near>) {
        while let Some(line) = lines.pop() {
            let segment = self.segment(line);
            lines.extend(others.extract_if(.., |other| segment.meets(&self.segment(other.wall))).map(|n| n.wall));
        }
    }

    /// A point on the inside of a wall, or as little as possible beyond it, so that the segment from `end` to it meets the wall.
    fn across(&self, end: Point2, wall: u32) -> Option<Point2> {
        let wall = self.segment(wall);
        let along = wall.b - wall.a;
        let share = (end - wall.a).dot(along) / along.length_squared();
        let foot = wall.a + along * share;
        let foot = match (wall.a.x == wall.b.x, wall.a.y == wall.b.y) {
            (true, _) => Point2::new(wall.a.x, end.y),
            (_, true) => Point2::new(end.x, wall.a.y),
            _ => foot,
        };
        let side = if orient2d(wall.a, wall.b, end) > 0.0 { 1.0 } else { -1.0 };
        let beyond = Point2::new(along.y, -along.x) * (side / along.length());
        let unit = f64::EPSILON * foot.x.abs().max(foot.y.abs()).max(end.x.abs()).max(end.y.abs());
        // Four steps of the larger coordinate are beyond the wall but where its ends are much farther from the origin.
        (0..=7).map(|k| if k == 0 { 0.0 } else { unit * f64::from(1u32 << (k - 1)) }).find_map(|step| {
            let to = foot + beyond * step;
            let to = Point2::new(check_coordinate(to.x).ok()?, check_coordinate(to.y).ok()?);
            (to != end && Segment2::new(end, to).meets(&wall)).then_some(to)
        })
    }
}

fn is_axial(line: &PlanLine) -> bool {
    line.a.x == line.b.x || line.a.y == line.b.y
}

/// The distance of a point from a segment, and where that is.
fn nearest(s: &Segment2, p: Point2) -> (f64, Nearest) {
    let along = s.b - s.a;
    if (p - s.a).dot(along) <= 0.0 {
        (p.distance(s.a), Nearest::End(s.a))
    } else if (p - s.b).dot(along) >= 0.0 {
        (p.distance(s.b), Nearest::End(s.b))
    } else {
        (orient2d(s.a, s.b, p).abs() / along.length(), Nearest::Inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(walls: &[[f64; 4]]) -> Plan {
        Plan::from_walls(walls.iter().map(|w| (Point2::new(w[0], w[1]), Point2::new(w[2], w[3])))).unwrap()
    }

    /// Joints as ends and lines.
    fn joints(walls: &[[f64; 4]], gap: f64) -> Vec<([f64; 4], u32, bool)> {
        let joined = plan(walls).joined(gap).unwrap();
        assert_eq!(joined.lines(), plan(walls).lines());
        joined.joints().iter().map(|j| ([j.from.x, j.from.y, j.to.x, j.to.y], j.line.0, j.inside)).collect()
    }

    #[test]
    fn ends_are_joined_within_the_gap_and_no_farther() {
        let slanted = [[0., 0., 9., 3.], [4., 8., 4.03, 1.35]];
        let [(at, 0, true)] = joints(&slanted, 0.01)[..] else { panic!("one joint") };
        assert_eq!(at[..2], [4.03, 1.35]);
        assert!(
            plan(&slanted).joined(0.01).unwrap().joints()[0]
                .segment()
                .meets(&Segment2::new(Point2::ZERO, Point2::new(9., 3.)))
        );
        let distance = nearest(&Segment2::new(Point2::ZERO, Point2::new(9., 3.)), Point2::new(4.03, 1.35)).0;
        assert_eq!([0.99, 1.01].map(|times| joints(&slanted, times * distance).len()), [0, 1]);
        // Ends of three walls, each near the others: they hang together by two joints at least.
        let corner = joints(&[[0., 0., 5., 1.], [5.001, 1., 8., 7.], [5., 1.001, 1., 9.]], 0.01);
        assert!((2..=4).contains(&corner.len()), "{corner:?}");
    }

    #[test]
    fn joints_run_along_the_axes_where_walls_do() {
        // To the inside, and from one end to another, of a wall that is level and of one that is not.
        assert_eq!(joints(&[[0., 0., 0., 8.], [0.25, 4., 6., 4.]], 0.5), [([0.25, 4., 0., 4.], 0, true)]);
        let corner = joints(&[[0., 0., 5., 0.], [5.25, 0.5, 5.25, 6.]], 1.0);
        assert_eq!(corner, [([5., 0., 5.25, 0.], 1, false), ([5.25, 0., 5.25, 0.5], 1, false)]);
    }

    #[test]
    fn what_hangs_together_has_no_joints() {
        // A corner, a T, a cross that sticks out by little, and a curve of short pieces.
        let touching = [[0., 0., 5., 0.], [5., 0., 5., 4.], [2., 0., 2., 4.], [3., -0.01, 3., 4.]];
        assert!(joints(&touching, 0.1).is_empty());
        let curve: Vec<[f64; 4]> = (0..60)
            .map(|k| {
                let at = |k: i32| f64::from(k) * 0.05;
                [at(k), at(k) * at(k), at(k + 1), at(k + 1) * at(k + 1)]
            })
            .collect();
        assert!(joints(&curve, 0.12).is_empty());
        // The impostor: one piece is missing.
        let torn: Vec<[f64; 4]> = curve.iter().enumerate().filter(|(k, _)| *k != 9).map(|(_, w)| *w).collect();
        assert_eq!(joints(&torn, 0.12).len(), 1);
        // Glass is not joined.
        let glass = PlanLine { opaque: false, ..PlanLine::wall(Point2::new(4., 8.), Point2::new(4., 0.01)) };
        let plan = Plan::new(vec![PlanLine::wall(Point2::ZERO, Point2::new(9., 0.)), glass], vec![]).unwrap();
        assert!(plan.joined(0.1).unwrap().joints().is_empty());
    }

    #[test]
    fn near_misses_are_counted() {
        let walls = [[0., 0., 40., 0.], [40., 0., 40., 30.], [20., 30., 20., 0.002], [30., 30., 30., 0.5]];
        assert_eq!(plan(&walls).near_misses().len(), 1);
        assert_eq!(plan(&walls).joined(0.01).unwrap().near_misses().len(), 0);
        assert_eq!(plan(&walls).joined(0.001).unwrap().near_misses().len(), 1);
        // What the digits explain is near, also in a small plan. The twin is the same in thirds, in full.
        let small = [[0., 0., 3.999, 0.], [3.999, 0., 3.999, 3.051], [1.001, 0.001, 1.001, 2.5], [0., 0., 0., 3.051]];
        assert_eq!(plan(&small).near_misses().len(), 1);
        assert_eq!(plan(&small.map(|wall| wall.map(|x| x / 3.0))).near_misses().len(), 0);
        let error = plan(&walls).joined(1e-300).unwrap_err().to_string();
        assert!(error.starts_with("a gap of 1e-300 is neither 0 nor at least 1.14e-12, "), "{error}");
        assert!(plan(&walls).joined(f64::NAN).is_err() && plan(&walls).joined(-1.0).is_err());
    }
}
