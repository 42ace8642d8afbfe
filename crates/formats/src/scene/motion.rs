//! What moves: boxes that a mesh never leaves, whatever its animations, skin and morph targets do.
//!
//! Animations may be played in any order, together and blended, so each property of each node takes any of its values at
//! any time. Boxes go up from the mesh to the root: where a node puts a box is computed in ranges that are rounded outwards,
//! for all of its translations, rotations and scales. Where no bound can be derived, the mesh may be anywhere.
//!
//! * Between keys, translations and scales lie on the segment, or, with tangents, in the hull of the control points.
//! * Rotations lie on the arc between two unit quaternions, or, with tangents, in the cone of the control points. Arcs and
//!   curves are cut into short pieces, each with a box around it.
//! * A vertex of a skin lies in the hull of where its joints put it.
//! * A vertex of a mesh with morph targets lies where weights from 0 to 1, and all that the file states, put it.

use super::accessor::Elements;
use super::buffers::Buffers;
use super::error::AccessorRole;
use super::json::{Channel, Document, Mesh, Node, Primitive, Sampler};
use super::range::{Range, RangeBox, bounded, box_of, mapped, rotations, united};
use super::transform::Transform;
use serde_json::Value;
use sightlines_cells::Point3;
use sightlines_geometry::Aabb;
use std::cell::Cell;
use std::collections::BTreeMap;

/// The most steps for all boxes of a file: a small file can describe a long computation. Beyond, things may be anywhere.
const MOST_STEPS: u64 = 1 << 28;
/// The most pieces of the rotations of a node; beyond, neighbours are put together.
const MOST_PIECES: usize = 1024;
/// More than the rounding of a few dozen operations on numbers up to 1.
const ROUNDING: f64 = 1.0 / (1u64 << 44) as f64;

/// Why a mesh moves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Moves {
    /// In a few words.
    pub(super) reason: String,
    /// Whether it changes its shape.
    pub(super) deforms: bool,
}

/// The vertices of a primitive, as they are in its mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertices<'m> {
    /// Their indices in the accessors.
    pub(super) corners: &'m [usize],
    /// Their positions.
    pub(super) positions: &'m [Point3],
}

/// A primitive that moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moved {
    /// Its vertices at rest, in world coordinates, if they are not where its node puts them.
    pub(super) at_rest: Option<Vec<Point3>>,
    /// The box that it never leaves; `None` if it may be anywhere.
    pub(super) within: Option<Aabb<3>>,
}

/// What animations do to a node.
#[derive(Debug, Default)]
struct Keyed {
    translation: Option<RangeBox>,
    scale: Option<RangeBox>,
    /// Quaternions, a box around each piece.
    rotation: Vec<[Range; 4]>,
    /// How many channels turn it.
    n_turning: usize,
    /// The ends of the arc that it turns on, if it turns to and fro on one.
    arc: Option<[[f64; 4]; 2]>,
    /// Of each morph target.
    weights: Vec<Range>,
    /// Whether its place takes values that are not known.
    is_anywhere: bool,
    /// Whether its weights do.
    has_any_weights: bool,
    /// Whether it comes into sight, or goes.
    appears: bool,
}

/// What a node has of itself or of those above it.
#[derive(Debug, Clone, Copy, Default)]
struct Inherited {
    /// The node that programs may move anywhere.
    loose: Option<usize>,
    /// Whether an animation moves it.
    is_keyed: bool,
    /// Whether an animation lets it come into sight, or go.
    appears: bool,
}

impl Keyed {
    /// A box around all rotations and all between two of them, as programs go from one animation to another, or from rest to
    /// one; `None` if these are on the one arc that it turns on.
    ///
    /// What lies between two quaternions on the shorter arc is a sum of positive parts of them, if they are less than a right
    /// angle apart; then it is a multiple of a point of any box around both.
    fn blended(&self, rest: [f64; 4]) -> Option<[Range; 4]> {
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

    fn moves(&self) -> bool {
        self.is_anywhere || self.translation.is_some() || self.scale.is_some() || !self.rotation.is_empty()
    }
}

/// All that moves in a document.
#[derive(Debug)]
pub(super) struct Motions<'a, 'b> {
    document: &'a Document,
    buffers: &'a Buffers<'b>,
    /// In the scene that is read; of nodes outside of it, in the document.
    parents: Vec<Option<usize>>,
    /// Whether a node outside of the scene has several parents.
    is_torn: Vec<bool>,
    /// What each node has of itself or of those above it.
    inherited: Vec<Inherited>,
    keyed: BTreeMap<usize, Keyed>,
    /// Why anything may be anywhere, if it may: an extension, or an animation of something that is not understood.
    all_anywhere: Option<String>,
    n_steps: Cell<u64>,
}

impl<'a, 'b> Motions<'a, 'b> {
    /// * `above`: of each node in the scene that is read its parent there, `Some(None)` for a root; `None` for other nodes
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'b>, above: &[Option<Option<usize>>]) -> Self {
        let mut parents: Vec<Option<usize>> = above.iter().map(|above| above.flatten()).collect();
        let mut is_torn = vec![false; parents.len()];
        for (parent, node) in document.nodes.iter().enumerate() {
            for &child in node.children.iter().filter(|&&child| above.get(child) == Some(&None)) {
                is_torn[child] = parents[child].replace(parent).is_some_and(|other| other != parent) || is_torn[child];
            }
        }
        let (n_steps, keyed, inherited) = (Cell::new(0), BTreeMap::new(), Vec::new());
        let all_anywhere = document.moves_everything().map(str::to_owned);
        let mut motions = Self { document, buffers, parents, is_torn, inherited, keyed, all_anywhere, n_steps };
        for animation in &document.animations {
            for channel in &animation.channels {
                motions.add(channel, &animation.samplers);
            }
        }
        motions.inherited = motions.inherit();
        motions
    }

    /// What accessors are in.
    pub(super) fn buffers(&self) -> &'a Buffers<'b> {
        self.buffers
    }

    /// What each node has of itself or of those above it: parents before children, so that depth costs nothing. Nodes in
    /// circles are of no scene.
    fn inherit(&self) -> Vec<Inherited> {
        let nodes = &self.document.nodes;
        let mut all = vec![Inherited::default(); nodes.len()];
        let mut stack: Vec<usize> = (0..nodes.len()).filter(|&node| self.parents[node].is_none()).collect();
        let mut is_done = vec![false; nodes.len()];
        while let Some(node) = stack.pop() {
            // A node may list a child twice.
            if std::mem::replace(&mut is_done[node], true) {
                continue;
            }
            let above = self.parents[node].map_or(Inherited::default(), |parent| all[parent]);
            let keyed = self.keyed.get(&node);
            all[node] = Inherited {
                loose: above.loose.or_else(|| nodes[node].loose().map(|_| node)),
                is_keyed: above.is_keyed || keyed.is_some_and(Keyed::moves),
                appears: above.appears || keyed.is_some_and(|keyed| keyed.appears),
            };
            let own = |&&child: &&usize| self.parents.get(child) == Some(&Some(node));
            stack.extend(nodes[node].children.iter().filter(own));
        }
        all
    }

    /// The node, those above it, and so on up to a root; ends with what would be a circle.
    fn chain(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(node), |&node| self.parents[node]).take(self.document.nodes.len())
    }

    fn step(&self, n: usize) -> bool {
        self.n_steps.set(self.n_steps.get().saturating_add(n as u64));
        self.n_steps.get() <= MOST_STEPS
    }

    /// Why a primitive of a node moves, if it does.
    pub(super) fn why(&self, node: usize, mesh: &Mesh, primitive: &Primitive) -> Option<Moves> {
        let n = &self.document.nodes[node];
        let says = |reason: &str, deforms: bool| Some(Moves { reason: reason.to_owned(), deforms });
        if n.skin.is_some() {
            return says("a skin", true);
        }
        let weights = n.weights.as_deref().or(mesh.weights.as_deref());
        if !primitive.targets.is_empty() || weights.is_some_and(|weights| weights.iter().any(|&w| w != 0.0)) {
            return says("morph targets", true);
        }
        if let Some(reason) = self.inherited[node].loose.and_then(|loose| self.document.nodes[loose].loose()) {
            return says(&reason, false);
        }
        match &self.all_anywhere {
            Some(reason) => says(reason, false),
            None if self.inherited[node].is_keyed => says("an animation", false),
            None => None,
        }
    }

    /// Whether an animation lets a node, or one above it, come into sight or go.
    pub(super) fn appears(&self, node: usize) -> bool {
        self.inherited[node].appears
    }

    /// Where a primitive that moves may be.
    pub(super) fn moved(&self, node: usize, mesh: &Mesh, primitive: &Primitive, vertices: Vertices<'_>) -> Moved {
        let n = &self.document.nodes[node];
        let Some(Morphed { ranges, at_rest }) = self.morphed(node, n, mesh, primitive, vertices) else {
            return Moved { at_rest: None, within: None };
        };
        let moved = match n.skin {
            Some(skin) => self.skinned(node, skin, primitive, vertices, &ranges, at_rest.as_deref()),
            None => {
                let within = self.swept(node, &ranges);
                // Where the node puts what has no other shape, the caller knows.
                let world = at_rest.as_ref().and_then(|_| self.world(node));
                let at_rest = at_rest.zip(world).map(|(rest, world)| rest.iter().map(|&p| world.apply(p)).collect());
                Some(Moved { at_rest, within })
            }
        };
        let moved = moved.unwrap_or(Moved { at_rest: None, within: None });
        // Physics, programs and what is not understood move things as they like.
        let is_loose = self.all_anywhere.is_some() || self.inherited[node].loose.is_some();
        if is_loose { Moved { within: None, ..moved } } else { moved }
    }

    /// What morph targets do to vertices; `None` if there is no telling.
    fn morphed(
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

    /// Where joints bring vertices.
    fn skinned(
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
                    let entry = &mut boxes[j as usize];
                    *entry = Some(entry.map_or(bound, |entry| united(entry, bound)));
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
            let swept = self.swept_box(joint.node, bound)?;
            all = Some(all.map_or(swept, |all| united(all, swept)));
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
                    Transform::of_columns(&columns)?
                }
                Some(_) => return None,
                None => Transform::IDENTITY,
            };
            let at_rest = self.world(node)?.after(&bind);
            Some(Joint { node, bind, at_rest })
        };
        nodes.iter().enumerate().map(joint).collect()
    }

    /// The sets of joints and weights of a primitive.
    fn sets(&self, primitive: &Primitive) -> Option<Vec<(Elements<'a>, Elements<'a>)>> {
        let accessor = |name: String| {
            let value = primitive.attributes.others.get(&name)?;
            Some(value.as_u64().and_then(|a| usize::try_from(a).ok()).and_then(|a| self.elements(a)))
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

    fn elements(&self, accessor: usize) -> Option<Elements<'a>> {
        Elements::new(self.document, self.buffers, accessor, AccessorRole::Attribute).ok()
    }

    /// Where a node is at rest.
    fn world(&self, node: usize) -> Option<Transform> {
        let mut world = Transform::IDENTITY;
        for above in self.chain(node) {
            if self.is_torn[above] || !self.step(1) {
                return None;
            }
            world = Transform::of_node(&self.document.nodes[above]).ok()?.after(&world);
        }
        Some(world)
    }

    /// The box of some vertices of a node, wherever it and those above it move. What does not move below the first that
    /// does is applied to each vertex.
    fn swept(&self, node: usize, vertices: &[RangeBox]) -> Option<Aabb<3>> {
        let mut world = Transform::IDENTITY;
        let mut first = None;
        for above in self.chain(node) {
            if self.keyed.contains_key(&above) {
                first = Some(above);
                break;
            }
            if !self.step(1) {
                return None;
            }
            world = Transform::of_node(&self.document.nodes[above]).ok()?.after(&world);
        }
        let rows = world.ranges();
        let all = vertices.iter().map(|&v| mapped(&rows, v)).reduce(united)?;
        match first {
            Some(first) => self.swept_box(first, all).and_then(bounded),
            None => bounded(all),
        }
    }

    /// A box in the coordinates of a node, wherever it and those above it move.
    fn swept_box(&self, node: usize, mut b: RangeBox) -> Option<RangeBox> {
        if self.inherited[node].loose.is_some() {
            return None;
        }
        for above in self.chain(node) {
            let n = &self.document.nodes[above];
            if self.is_torn[above] || !self.step(1) {
                return None;
            }
            let Some(keyed) = self.keyed.get(&above).filter(|keyed| keyed.moves()) else {
                b = mapped(&Transform::of_node(n).ok()?.ranges(), b);
                continue;
            };
            if keyed.is_anywhere || n.matrix.is_some() || !self.step(keyed.rotation.len().max(1)) {
                return None;
            }
            // What it is at rest counts, too: nothing may be playing.
            let usual = |given: Option<&Point3>, without: f64| box_of(given.copied().unwrap_or([without; 3]));
            let with = |usual: RangeBox, keys: Option<RangeBox>| keys.map_or(usual, |keys| united(usual, keys));
            let translation = with(usual(n.translation.as_deref(), 0.0), keyed.translation);
            let scale = with(usual(n.scale.as_deref(), 1.0), keyed.scale);
            let scaled: RangeBox = std::array::from_fn(|axis| scale[axis].times(b[axis]));
            let rest = unit(n.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]))?;
            let turned = |q: &[Range; 4]| {
                let [x, y, z] = rotations(*q);
                let row = |row: [Range; 3], t: Range| [row[0], row[1], row[2], t];
                mapped(&[row(x, translation[0]), row(y, translation[1]), row(z, translation[2])], scaled)
            };
            b = match keyed.blended(rest) {
                Some(all) => turned(&all),
                None => keyed.rotation.iter().map(turned).fold(turned(&rest.map(Range::of)), united),
            };
        }
        b.iter().all(|range| range.is_finite()).then_some(b)
    }

    /// Notes what a channel of an animation does.
    fn add(&mut self, channel: &Channel, samplers: &[Sampler]) {
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
                ("translation", Some(Curve::Places(places))) => keyed.translation = merged(keyed.translation, places),
                ("scale", Some(Curve::Places(places))) => keyed.scale = merged(keyed.scale, places),
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

/// Vertices of a mesh with morph targets.
struct Morphed {
    /// Where they may be.
    ranges: Vec<RangeBox>,
    /// Where they are at rest; `None` if that is where they are without targets.
    at_rest: Option<Vec<Point3>>,
}

/// A joint of a skin.
struct Joint {
    node: usize,
    /// From the mesh to the joint.
    bind: Transform,
    /// From the mesh to the world, at rest.
    at_rest: Transform,
}

/// All values of a property.
enum Curve {
    Places(RangeBox),
    /// And the ends of the arc, if all are on one.
    Turns(Vec<[Range; 4]>, Option<[[f64; 4]; 2]>),
    Weights(Vec<Range>),
}

/// What a pointer of `KHR_animation_pointer` points at.
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
            let path = match parts.next() {
                Some("translation") => "translation",
                Some("rotation") => "rotation",
                Some("scale") => "scale",
                Some("weights") => "weights",
                Some(path) if path.starts_with("weights/") => "weights/",
                Some("extensions/KHR_node_visibility/visible") => "visible",
                _ => "anything",
            };
            Pointed::Node(node, path)
        }
        ("meshes", Some(mesh)) => Pointed::Mesh(mesh),
        ("nodes" | "meshes", None) => return None,
        _ => Pointed::Other,
    })
}

fn merged(before: Option<RangeBox>, more: RangeBox) -> Option<RangeBox> {
    Some(before.map_or(more, |before| united(before, more)))
}

/// The two rotations that all keys are, as unit quaternions; `None` if there are more.
fn one_arc(keys: impl Iterator<Item = Vec<f64>>) -> Option<[[f64; 4]; 2]> {
    let mut found: Vec<[f64; 4]> = Vec::new();
    for key in keys {
        let key = unit(key.try_into().ok()?)?;
        if !found.iter().any(|q| *q == key || q.map(|x| -x) == key) {
            found.push(key);
        }
        if found.len() > 2 {
            return None;
        }
    }
    Some([*found.first()?, *found.last()?])
}

/// A point with the rounding of how it was computed.
fn around_rounded(p: Point3) -> RangeBox {
    p.map(|x| Range::of(x).wider(x.abs() * ROUNDING))
}

/// Puts neighbours together while there are too many.
fn thin(pieces: &mut Vec<[Range; 4]>) {
    while pieces.len() > MOST_PIECES {
        let joined = |pair: &[[Range; 4]]| {
            let [first, last] = [pair[0], pair[pair.len() - 1]];
            std::array::from_fn(|k| first[k].with(last[k]))
        };
        *pieces = pieces.chunks(2).map(joined).collect();
    }
}

/// Adds boxes around all quaternions between two keys, which have these control points; `None` if one is no rotation.
fn turned_between(points: &[[f64; 4]], out: &mut Vec<[Range; 4]>) -> Option<()> {
    match *points {
        [q] => add_arc(unit(q)?, unit(q)?, 0, out),
        [a, b] => {
            let (a, b) = (unit(a)?, unit(b)?);
            let cosine: f64 = (0..4).map(|k| a[k] * b[k]).sum();
            // The shorter arc; of two that are nearly as long, both.
            if cosine > -0.001 {
                add_arc(a, b, MOST_HALVINGS, out);
            }
            if cosine < 0.001 {
                add_arc(a, b.map(|x| -x), MOST_HALVINGS, out);
            }
        }
        [a, b, c, d] => add_curve([a, b, c, d], MOST_HALVINGS, out)?,
        _ => return None,
    }
    Some(())
}

/// Rotations that differ by less count as equal: single precision rounds them by less. Boxes around arcs are wider by twice
/// as much, so that what lies between a point of the arc and one that is so near to its end is in them.
const SAME: f64 = 1e-6;
/// How often an arc or a curve is halved at most.
const MOST_HALVINGS: u32 = 5;
/// Chords from this length on are halved: about 6 degrees of a unit quaternion, 12 of a rotation.
const LONG_CHORD: f64 = 0.1;

fn unit(q: [f64; 4]) -> Option<[f64; 4]> {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| q.map(|x| x / length))
}

/// Boxes around the arc between two unit quaternions. The arc is nowhere farther from its chord c than 1 - sqrt(1 - c²/4),
/// which is at most c²/4.
fn add_arc(a: [f64; 4], b: [f64; 4], halvings: u32, out: &mut Vec<[Range; 4]>) {
    let squared: f64 = (0..4).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
    let middle = std::array::from_fn(|k| a[k] + b[k]);
    match unit(middle) {
        Some(middle) if squared > LONG_CHORD * LONG_CHORD && halvings > 0 => {
            add_arc(a, middle, halvings - 1, out);
            add_arc(middle, b, halvings - 1, out);
        }
        _ => {
            let off = squared / 4.0 + 2.0 * SAME;
            out.push(std::array::from_fn(|k| Range::of(a[k]).with(Range::of(b[k])).wider(off)));
        }
    }
}

/// Boxes around a cubic curve of quaternions, which programs bring to unit length afterwards.
fn add_curve(points: [[f64; 4]; 4], halvings: u32, out: &mut Vec<[Range; 4]>) -> Option<()> {
    if points.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let between = |a: [f64; 4], b: [f64; 4]| -> [f64; 4] { std::array::from_fn(|k| 0.5 * (a[k] + b[k])) };
    let span = (0..4).map(|k| {
        let of = points.map(|p| p[k]);
        of.into_iter().fold(f64::NEG_INFINITY, f64::max) - of.into_iter().fold(f64::INFINITY, f64::min)
    });
    if halvings > 0 && span.fold(0.0, f64::max) > LONG_CHORD {
        let [a, b, c, d] = points;
        let (ab, bc, cd) = (between(a, b), between(b, c), between(c, d));
        let (abc, bcd) = (between(ab, bc), between(bc, cd));
        let middle = between(abc, bcd);
        add_curve([a, ab, abc, middle], halvings - 1, out)?;
        return add_curve([middle, bcd, cd, d], halvings - 1, out);
    }
    let largest = points.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
    let hull = |k: usize| points.iter().map(|p| Range::of(p[k])).reduce(Range::with).unwrap_or(Range::ALL);
    out.push(std::array::from_fn(|k| hull(k).wider(largest * ROUNDING)));
    Some(())
}
