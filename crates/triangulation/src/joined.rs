//! What the joints of a plan become: cuts, common corners, and pieces of their own.

use crate::noding::Piece;
use crate::piece::{JOINT, reach_of};
use sightlines_cells::{Joint, Plan};
use sightlines_geometry::{Point2, Segment2};
use std::collections::BTreeMap;

/// Joints, ready for the first round of cutting.
#[derive(Debug, Default)]
pub(crate) struct Joined {
    /// Where lines are cut.
    pub(crate) cuts: Vec<(u32, Point2)>,
    /// Joints that are longer than rounding.
    pub(crate) pieces: Vec<Piece>,
    /// Of ends that become one corner, each but that corner, and an earlier one.
    corners: BTreeMap<[u64; 2], Point2>,
}

impl Joined {
    pub(crate) fn new(plan: &Plan) -> Self {
        let mut joined = Self::default();
        let mut long = Vec::new();
        for joint in plan.joints() {
            if joint.inside {
                long.extend(joined.cut(plan, joint));
            } else if joint.from.distance(joint.to) <= NEAR * reach_of(joint.from) {
                joined.merge(joint.from, joint.to);
            } else {
                long.push([joint.from, joint.to]);
            }
        }
        let ends = long.into_iter().map(|ends| ends.map(|end| joined.corner(end))).filter(|[a, b]| a != b);
        joined.pieces = ends.map(|[a, b]| Piece { a, b, opaque: true, line: JOINT }).collect();
        joined
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.cuts.is_empty() && self.pieces.is_empty() && self.corners.is_empty()
    }

    /// The corner that a point becomes.
    pub(crate) fn corner(&self, mut at: Point2) -> Point2 {
        while let Some(&earlier) = self.corners.get(&key(at)) {
            at = earlier;
        }
        at
    }

    fn merge(&mut self, a: Point2, b: Point2) {
        let (a, b) = (self.corner(a), self.corner(b));
        if a != b {
            self.corners.insert(key(b), a);
        }
    }

    /// Cuts the line that a joint leads to, and returns what is left of the joint.
    fn cut(&mut self, plan: &Plan, joint: &Joint) -> Option<[Point2; 2]> {
        let line = &plan.lines()[joint.line.0 as usize];
        let wall = Segment2::new(line.a, line.b);
        let along = wall.b - wall.a;
        let foot = || wall.a + along * ((joint.from - wall.a).dot(along) / along.length_squared());
        let at = if wall.contains(joint.to) { joint.to } else { foot() };
        let is_long = joint.from.distance(at) > NEAR * reach_of(joint.from);
        let at = if is_long { at } else { joint.from };
        self.cuts.push((joint.line.0, at));
        is_long.then_some([joint.from, at])
    }
}

/// How many times `reach` an end may be off to become a corner of what it is joined to.
const NEAR: f64 = 8.0;

fn key(p: Point2) -> [u64; 2] {
    p.to_array().map(f64::to_bits)
}
