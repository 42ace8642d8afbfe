//! Meshes that change their shape: morph targets and skins.

use super::keys::merge;
use super::{Motions, Moved, ROUNDING, Vertices};
use crate::json::as_index;
use crate::scene::accessor::{AccessorRole, Elements};
use crate::scene::json::{Mesh, Node, Primitive};
use crate::scene::transform::Transform;
use sightlines_cells::Point3;
use sightlines_geometry::range::{Range, RangeBox, bounded, box_of, mapped, united};

pub(super) struct Morphed {
    /// Where they may be.
    pub(super) ranges: Vec<RangeBox>,
    /// Where they are at rest; `None` if that is where they are without targets.
    pub(super) at_rest: Option<Vec<Point3>>,
}

struct Joint {
    node: usize,
    /// From the mesh to the joint.
    bind: Transform,
    /// From the mesh to the world, at rest.
    at_rest: Transform,
}

impl<'a> Motions<'a, '_> {
    pub(super) fn morphed(
        &self,
        node: usize,
        n: &Node,
        mesh: &Mesh,
        primitive: &Primitive,
        vertices: Vertices<'_>,
    ) -> Option<Morphed> {
        let mut ranges: Vec<RangeBox> = vertices.positions.iter().map(|&p| box_of(p)).collect();
        if primitive.targets.is_empty() {
            return Some(Morphed { ranges, at_rest: None });
        }
        if !self.step(primitive.targets.len().saturating_mul(vertices.corners.len())) {
            return None;
        }
        let keyed = self.keyed.get(&node);
        let weights = n.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default();
        let mut at_rest = vertices.positions.to_vec();
        for (k, target) in primitive.targets.iter().enumerate() {
            let Some(accessor) = target.position else { continue };
            let moves = Elements::new(self.document, self.buffers, accessor, AccessorRole::Positions).ok()?;
            let usual = weights.get(k).copied().unwrap_or(0.0);
            let keys = keyed.and_then(|keyed| keyed.weights.get(k).copied());
            let mut weight = Range { low: 0.0, high: 1.0 }.with(Range::of(usual));
            weight = keys.map_or(weight, |keys| weight.with(keys));
            if keyed.is_some_and(|keyed| keyed.has_any_weights) || !weight.is_finite() {
                return None;
            }
            for ((range, rest), &corner) in ranges.iter_mut().zip(&mut at_rest).zip(vertices.corners) {
                if corner >= moves.count {
                    return None;
                }
                let by = moves.position(corner);
                *range = std::array::from_fn(|axis| range[axis].plus(weight.times(Range::of(by[axis]))));
                *rest = std::array::from_fn(|axis| rest[axis] + usual * by[axis]);
            }
        }
        Some(Morphed { ranges, at_rest: Some(at_rest) })
    }

    pub(super) fn skinned(
        &self,
        node: usize,
        skin: usize,
        primitive: &Primitive,
        vertices: Vertices<'_>,
        ranges: &[RangeBox],
        at_rest: Option<&[Point3]>,
    ) -> Option<Moved> {
        let skin = self.document.skins.get(skin)?.as_ref()?;
        let binds = match skin.inverse_bind_matrices {
            Some(accessor) => Some(self.elements(accessor)?),
            None => None,
        };
        let joints = self.joints(&skin.joints, binds.as_ref())?;
        // For each joint the box of what it moves, in its own coordinates.
        let mut boxes: Vec<Option<RangeBox>> = vec![None; joints.len()];
        let (mut sum, mut rest) = (Range::of(1.0), Vec::with_capacity(ranges.len()));
        let sets = self.sets(primitive)?;
        if sets.is_empty() || !self.step(ranges.len().saturating_mul(4 * sets.len())) {
            return None;
        }
        for (k, (&corner, range)) in vertices.corners.iter().zip(ranges).enumerate() {
            let (mut weights, mut place) = (0.0, [0.0; 3]);
            for (of_joints, of_weights) in &sets {
                if corner >= of_joints.count || corner >= of_weights.count {
                    return None;
                }
                for (j, w) in of_joints.numbers(corner).into_iter().zip(of_weights.normalized_numbers(corner)) {
                    if w == 0.0 {
                        continue;
                    }
                    if !(w > 0.0 && w.is_finite()) {
                        return None;
                    }
                    let joint = joints.get(j as usize)?;
                    let bound = mapped(&joint.bind.ranges(), *range);
                    merge(&mut boxes[j as usize], bound);
                    let p = joint.at_rest.apply(at_rest.map_or(vertices.positions[k], |rest| rest[k]));
                    weights += w;
                    place = std::array::from_fn(|axis| place[axis] + w * p[axis]);
                }
                // Some programs take the first sets only, so each part of the sum counts. Without any weight there is no telling.
                if weights == 0.0 {
                    return None;
                }
                sum = sum.with(Range::of(weights).wider(weights * ROUNDING));
            }
            rest.push(place.map(|x| x / weights));
        }
        let mut all: Option<RangeBox> = None;
        for (joint, bound) in joints.iter().zip(boxes) {
            let Some(bound) = bound else { continue };
            merge(&mut all, self.swept_box(joint.node, bound)?);
        }
        // Weights that do not add up to 1 pull a vertex away from the hull: to the origin or to the node of the mesh, by how a
        // program computes it, or nowhere if it divides by the sum.
        let all = all?;
        // Two ways to write the same: one is tighter for weights near 1, one where `to` is small.
        let pulled = |to: RangeBox| -> RangeBox {
            std::array::from_fn(|k| {
                let from = all[k].minus(to[k]);
                let by_difference = all[k].plus(sum.minus(Range::of(1.0)).times(from));
                by_difference.within(to[k].plus(sum.times(from)))
            })
        };
        let mesh = self.swept_box(node, box_of([0.0; 3]))?;
        let within = united(all, united(pulled(box_of([0.0; 3])), pulled(mesh)));
        Some(Moved { at_rest: Some(rest), within: bounded(within) })
    }

    fn joints(&self, nodes: &[usize], binds: Option<&Elements<'_>>) -> Option<Vec<Joint>> {
        let joint = |(k, &node): (usize, &usize)| {
            self.document.nodes.get(node)?;
            let bind = match binds {
                Some(binds) if k < binds.count => {
                    let columns: [f64; 16] = binds.numbers(k).try_into().ok()?;
                    Transform::from_columns(&columns).ok()?
                }
                Some(_) => return None,
                None => Transform::IDENTITY,
            };
            let at_rest = self.world(node)?.after(&bind);
            Some(Joint { node, bind, at_rest })
        };
        nodes.iter().enumerate().map(joint).collect()
    }

    fn sets(&self, primitive: &Primitive) -> Option<Vec<(Elements<'a>, Elements<'a>)>> {
        let accessor = |name: String| {
            let value = primitive.attributes.others.get(&name)?;
            Some(as_index(value).and_then(|a| self.elements(a)))
        };
        let mut sets = Vec::new();
        for k in 0.. {
            match (accessor(format!("JOINTS_{k}")), accessor(format!("WEIGHTS_{k}"))) {
                (None, None) => break,
                (Some(Some(joints)), Some(Some(weights))) => sets.push((joints, weights)),
                _ => return None,
            }
        }
        Some(sets)
    }
}
