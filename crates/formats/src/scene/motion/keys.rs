//! What animations put properties of nodes to.

use super::turns::{MOST_PIECES, SAME, one_arc, thin, turned_between};
use super::{Motions, ROUNDING};
use crate::scene::accessor::{AccessorRole, Elements};
use crate::scene::json::{Channel, Node, Sampler};
use serde_json::Value;
use sightlines_cells::Point3;
use sightlines_geometry::range::{Range, RangeBox, united};

#[derive(Debug, Default)]
pub(super) struct Keyed {
    pub(super) translation: Option<RangeBox>,
    pub(super) scale: Option<RangeBox>,
    pub(super) rotation: Vec<[Range; 4]>,
    /// How many channels turn it.
    pub(super) n_turning: usize,
    /// The ends of the arc that it turns on, if it turns to and fro on one.
    pub(super) arc: Option<[[f64; 4]; 2]>,
    /// Of each morph target.
    pub(super) weights: Vec<Range>,
    /// Whether its place takes values that are not known.
    pub(super) is_anywhere: bool,
    /// Whether its weights do.
    pub(super) has_any_weights: bool,
    /// Whether it comes into sight, or goes.
    pub(super) appears: bool,
}

impl Keyed {
    /// A box around all rotations and all between two of them, as programs go from one animation to another, or from rest to
    /// one; `None` if these are on the one arc that it turns on.
    ///
    /// What lies between two quaternions on the shorter arc is a sum of positive parts of them, if they are less than a right
    /// angle apart; then it is a multiple of a point of any box around both.
    pub(super) fn blended(&self, rest: [f64; 4]) -> Option<[Range; 4]> {
        const ANY: [Range; 4] = [Range { low: -1.0, high: 1.0 }; 4];
        let negative = |piece: &[Range; 4]| piece.map(|range| Range { low: -range.high, high: -range.low });
        let is_rest =
            |end: &[f64; 4]| [1.0, -1.0].iter().any(|sign| (0..4).all(|k| (rest[k] - sign * end[k]).abs() < SAME));
        let starts_at_rest = self.arc.is_some_and(|ends| ends.iter().any(is_rest));
        if self.rotation.is_empty() || (self.n_turning < 2 && starts_at_rest) {
            return None;
        }
        let dot = |a: &[Range; 4], b: &[Range; 4]| (1..4).fold(a[0].times(b[0]), |sum, k| sum.plus(a[k].times(b[k])));
        let mut all = rest.map(Range::of);
        for piece in &self.rotation {
            let piece = if dot(&all, piece).high < 0.0 { negative(piece) } else { *piece };
            all = std::array::from_fn(|k| all[k].with(piece[k]));
        }
        Some(if dot(&all, &all).low > 0.0 { all } else { ANY })
    }

    pub(super) fn moves(&self) -> bool {
        self.is_anywhere || self.translation.is_some() || self.scale.is_some() || !self.rotation.is_empty()
    }
}

impl Motions<'_, '_> {
    pub(super) fn add(&mut self, channel: &Channel, samplers: &[Sampler]) {
        let (nodes, path) = match (&*channel.target.path, channel.target.node) {
            ("pointer", _) => match pointed(channel.target.extensions.as_ref()) {
                Some(Pointed::Node(node, path)) => (vec![node], path),
                Some(Pointed::Mesh(mesh)) => {
                    let has = |(_, node): &(usize, &Node)| node.mesh == Some(mesh);
                    let nodes = self.document.nodes.iter().enumerate().filter(has).map(|(k, _)| k).collect();
                    (nodes, "weights/")
                }
                Some(Pointed::Other) => return,
                None => {
                    self.all_anywhere.get_or_insert_with(|| "an animation".to_owned());
                    return;
                }
            },
            (_, None) => return,
            (path, Some(node)) => (vec![node], path),
        };
        let sampler = samplers.get(channel.sampler);
        for node in nodes {
            let n_targets = self.n_targets(node);
            let curve = sampler.and_then(|sampler| self.curve(sampler, path, n_targets));
            let keyed = self.keyed.entry(node).or_default();
            match (path, curve) {
                ("translation", Some(Curve::Places(places))) => merge(&mut keyed.translation, places),
                ("scale", Some(Curve::Places(places))) => merge(&mut keyed.scale, places),
                ("rotation", Some(Curve::Turns(turns, arc))) => {
                    keyed.rotation.extend(turns);
                    keyed.n_turning += 1;
                    keyed.arc = arc;
                    thin(&mut keyed.rotation);
                }
                ("weights", Some(Curve::Weights(weights))) => {
                    for (k, range) in weights.into_iter().enumerate() {
                        match keyed.weights.get_mut(k) {
                            Some(before) => *before = before.with(range),
                            None => keyed.weights.push(range),
                        }
                    }
                }
                ("weights" | "weights/", _) => keyed.has_any_weights = true,
                ("visible", _) => keyed.appears = true,
                _ => keyed.is_anywhere = true,
            }
        }
    }

    fn n_targets(&self, node: usize) -> usize {
        let mesh = self.document.nodes.get(node).and_then(|n| self.document.meshes.get(n.mesh?));
        mesh.and_then(|mesh| mesh.primitives.iter().map(|p| p.targets.len()).max()).unwrap_or(0)
    }

    /// What a sampler puts a property to; `None` if there is no telling.
    fn curve(&self, sampler: &Sampler, path: &str, n_targets: usize) -> Option<Curve> {
        let times = Elements::new(self.document, self.buffers, sampler.input, AccessorRole::Attribute).ok()?;
        let values = self.elements(sampler.output)?;
        let is_cubic = match sampler.interpolation.as_deref() {
            None | Some("LINEAR" | "STEP") => false,
            Some("CUBICSPLINE") => true,
            Some(_) => return None,
        };
        if !self.step(values.count.saturating_mul(8)) {
            return None;
        }
        // Elements of a key: its tangents before and behind it, and its values.
        let n_each = if path == "weights" { n_targets } else { 1 };
        let n_parts = if is_cubic { 3 } else { 1 };
        if n_each == 0 || values.count != times.count.checked_mul(n_each * n_parts)? {
            return None;
        }
        let value = |key: usize, part: usize, k: usize| values.normalized_numbers((key * n_parts + part) * n_each + k);
        let time = |key: usize| times.numbers(key).first().copied().unwrap_or(f64::NAN);
        // The control points of the curve between two keys.
        let control = |key: usize, k: usize| -> Vec<Vec<f64>> {
            if !is_cubic {
                return vec![value(key, 0, k), value(key + 1, 0, k)];
            }
            let third = (time(key + 1) - time(key)) / 3.0;
            let off = |at: Vec<f64>, by: Vec<f64>, third: f64| at.iter().zip(&by).map(|(a, b)| a + third * b).collect();
            let (first, last) = (value(key, 1, k), value(key + 1, 1, k));
            let (out, into) = (value(key, 2, k), value(key + 1, 0, k));
            vec![first.clone(), off(first, out, third), off(last.clone(), into, -third), last]
        };
        let n_keys = times.count;
        let all = |k: usize| {
            let middle = usize::from(is_cubic);
            let single = (n_keys == 1).then(|| vec![value(0, middle, k)]);
            let between = (0..n_keys.saturating_sub(1)).map(move |key| (key, k));
            single.into_iter().chain(between.map(|(key, k)| control(key, k)))
        };
        match path {
            "translation" | "scale" => {
                let points = all(0).flatten().map(|p| Some(around_rounded(p.try_into().ok()?)));
                Some(Curve::Places(points.collect::<Option<Vec<_>>>()?.into_iter().reduce(united)?))
            }
            "rotation" => {
                let mut turns = Vec::new();
                for points in all(0) {
                    let points: Vec<[f64; 4]> =
                        points.into_iter().map(|p| p.try_into().ok()).collect::<Option<Vec<_>>>()?;
                    turned_between(&points, &mut turns)?;
                    // Memory stays in proportion to what is kept, not to the keys.
                    if turns.len() > 8 * MOST_PIECES {
                        thin(&mut turns);
                    }
                }
                thin(&mut turns);
                let arc = if is_cubic { None } else { one_arc((0..n_keys).map(|key| value(key, 0, 0))) };
                Some(Curve::Turns(turns, arc))
            }
            "weights" => {
                let of = |k: usize| {
                    let numbers = all(k).flatten().flatten().map(|w| Range::of(w).wider(w.abs() * ROUNDING));
                    numbers.reduce(Range::with).filter(|range| range.is_finite())
                };
                (0..n_targets).map(of).collect::<Option<Vec<_>>>().map(Curve::Weights)
            }
            _ => None,
        }
    }
}

/// All values of a property.
enum Curve {
    Places(RangeBox),
    /// And the ends of the arc, if all are on one.
    Turns(Vec<[Range; 4]>, Option<[[f64; 4]; 2]>),
    Weights(Vec<Range>),
}

enum Pointed {
    Node(usize, &'static str),
    Mesh(usize),
    Other,
}

fn pointed(extensions: Option<&Value>) -> Option<Pointed> {
    let pointer = extensions?.get("KHR_animation_pointer")?.get("pointer")?.as_str()?;
    let mut parts = pointer.strip_prefix('/')?.splitn(3, '/');
    let (what, index) = (parts.next()?, parts.next().and_then(|index| index.parse().ok()));
    Some(match (what, index) {
        ("nodes", Some(node)) => {
            let path = parts.next().unwrap_or_default();
            let known = ["translation", "rotation", "scale", "weights"].into_iter().find(|known| *known == path);
            Pointed::Node(
                node,
                match path {
                    "extensions/KHR_node_visibility/visible" => "visible",
                    _ if path.starts_with("weights/") => "weights/",
                    _ => known.unwrap_or("anything"),
                },
            )
        }
        ("meshes", Some(mesh)) => Pointed::Mesh(mesh),
        ("nodes" | "meshes", None) => return None,
        _ => Pointed::Other,
    })
}

/// Widens a box so that it holds another.
pub(super) fn merge(all: &mut Option<RangeBox>, more: RangeBox) {
    *all = Some(all.map_or(more, |all| united(all, more)));
}

/// A point with the rounding of how it was computed.
fn around_rounded(p: Point3) -> RangeBox {
    p.map(|x| Range::of(x).wider(x.abs() * ROUNDING))
}
