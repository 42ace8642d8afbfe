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

mod keys;
mod shape;
mod turns;

use super::accessor::{AccessorRole, Elements};
use super::buffers::Buffers;
use super::json::{Document, Mesh, Primitive};
use super::transform::Transform;
use keys::Keyed;
use shape::Morphed;
use sightlines_cells::Point3;
use sightlines_geometry::Aabb;
use sightlines_geometry::range::{Range, RangeBox, bounded, box_of, mapped, rotations, united};
use std::cell::Cell;
use std::collections::BTreeMap;
use turns::unit;

/// The most steps for all boxes of a file: a small file can describe a long computation. Beyond, things may be anywhere.
const MOST_STEPS: u64 = 1 << 28;
/// More than the rounding of a few dozen operations on numbers up to 1.
const ROUNDING: f64 = 1.0 / (1u64 << 44) as f64;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Moves {
    pub(super) reason: String,
    pub(super) deforms: bool,
}

/// The vertices of a primitive, as they are in its mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertices<'m> {
    pub(super) corners: &'m [usize],
    pub(super) positions: &'m [Point3],
}

/// A primitive that moves; anywhere, if nothing else is said.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Moved {
    /// Its vertices at rest, in world coordinates, if they are not where its node puts them.
    pub(super) at_rest: Option<Vec<Point3>>,
    /// The box that it never leaves; `None` if it may be anywhere.
    pub(super) within: Option<Aabb<3>>,
}

/// What a node has of itself or of those above it.
#[derive(Debug, Clone, Copy, Default)]
struct Inherited {
    loose: Option<usize>,
    is_keyed: bool,
    appears: bool,
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
        if let Some(reason) = self.loose(node, mesh, primitive) {
            return says(&reason, false);
        }
        match &self.all_anywhere {
            Some(reason) => says(reason, false),
            None if self.inherited[node].is_keyed => says("an animation", false),
            None => None,
        }
    }

    /// Why programs may move a primitive of a node anywhere, if they may.
    fn loose(&self, node: usize, mesh: &Mesh, primitive: &Primitive) -> Option<String> {
        let of_node = self.inherited[node].loose.and_then(|loose| self.document.nodes[loose].loose());
        let material = |m: usize| self.document.materials.get(m)?.as_ref();
        let has_moving = || primitive.materials().into_iter().flatten().filter_map(material).any(|m| m.stated.moves());
        of_node.or_else(|| (mesh.stated.moves() || has_moving()).then(|| "extras".to_owned()))
    }

    /// Whether an animation lets a node, or one above it, come into sight or go.
    pub(super) fn appears(&self, node: usize) -> bool {
        self.inherited[node].appears
    }

    pub(super) fn moved(&self, node: usize, mesh: &Mesh, primitive: &Primitive, vertices: Vertices<'_>) -> Moved {
        let n = &self.document.nodes[node];
        let Some(Morphed { ranges, at_rest }) = self.morphed(node, n, mesh, primitive, vertices) else {
            return Moved::default();
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
        let moved = moved.unwrap_or_default();
        // Physics, programs and what is not understood move things as they like.
        let is_loose = self.all_anywhere.is_some() || self.loose(node, mesh, primitive).is_some();
        if is_loose { Moved { within: None, ..moved } } else { moved }
    }

    fn elements(&self, accessor: usize) -> Option<Elements<'a>> {
        Elements::new(self.document, self.buffers, accessor, AccessorRole::Attribute).ok()
    }

    fn world(&self, node: usize) -> Option<Transform> {
        self.chain(node).try_fold(Transform::IDENTITY, |world, above| {
            let is_certain = !self.is_torn[above] && self.step(1);
            is_certain.then(|| Transform::of_node(&self.document.nodes[above]).ok())?.map(|own| own.after(&world))
        })
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
}
