//! Fragments that wait for their turn, and the tests of one against another.

use super::cone::{Common, Outline, Sight};
use crate::camera::Camera;
use crate::faces::Faces;
use crate::fragment::{Extents, Fragment, Relation};
use crate::method::RenderInput;
use crate::plane::InputPlane;
use std::cell::{Cell, OnceCell};

/// The tests, in the order in which they are made; the last is our own.
pub(super) const TESTS: [&str; 7] =
    ["depth", "across", "down", "behind plane of Q", "in front of plane of P", "projection", "nearer in common part"];

/// What is known of a fragment.
#[derive(Debug)]
pub(super) struct Item {
    pub(super) fragment: Fragment,
    pub(super) plane: InputPlane,
    /// 1 if the eye is in front of the plane, -1 if behind.
    eye: i32,
    /// Of what the camera may see of it.
    pub(super) extents: Extents,
    outline: OnceCell<Outline>,
    /// Which items are still to be tested against it, the next one last; none if it has not begun.
    pub(super) rest: Option<Vec<u32>>,
    pub(super) state: State,
}

/// What has become of an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// It waits.
    Waiting,
    /// It waits for others that have to be drawn before it, and they for it not to come in between.
    Marked,
    /// It is drawn.
    Drawn,
    /// It was split into these; [`NO_ITEM`] in the place of one that is not seen.
    Split([u32; 2]),
}

/// No index of an item.
pub(super) const NO_ITEM: u32 = u32::MAX;

impl Item {
    /// Nothing if the camera sees nothing of it.
    pub(super) fn new(input: &RenderInput<'_>, fragment: Fragment) -> Option<Self> {
        let RenderInput { faces, camera, .. } = *input;
        let plane = InputPlane::of(faces, fragment.face());
        let eye = plane.side(faces, camera.eye());
        if eye == 0 {
            return None;
        }
        let extents = seen(&fragment, camera, faces)?;
        Some(Self { fragment, plane, eye, extents, outline: OnceCell::new(), rest: None, state: State::Waiting })
    }

    /// The farthest first, of equal ones that of the higher id.
    pub(super) fn key(&self, item: u32) -> (u64, u32) {
        // Of numbers that are not negative the bits are in the order of the numbers.
        (self.extents.depth[1].to_bits(), item)
    }

    pub(super) fn is_gone(&self) -> bool {
        matches!(self.state, State::Drawn | State::Split(_))
    }

    fn outline(&self, sight: &Sight<'_>) -> &Outline {
        self.outline.get_or_init(|| Outline::new(sight, &self.fragment, self.plane, self.eye))
    }
}

/// Between which pixels of the picture and which of the depths that the camera sees a fragment lies, if anywhere.
fn seen(fragment: &Fragment, camera: &Camera, faces: &Faces) -> Option<Extents> {
    let extents = fragment.extents(camera, faces);
    if extents.window(camera).is_empty() {
        return None;
    }
    let ([width, height], [near, far]) = (camera.size().map(f64::from), camera.depths());
    let within = |[low, high]: [f64; 2], least: f64, most: f64| [low.clamp(least, most), high.clamp(least, most)];
    let pixels = [within(extents.pixels[0], 0.0, width), within(extents.pixels[1], 0.0, height)];
    Some(Extents { pixels, depth: within(extents.depth, near, far.min(f64::MAX)) })
}

/// The tests and how often each was made.
#[derive(Debug)]
pub(super) struct Tests<'a> {
    pub(super) input: &'a RenderInput<'a>,
    pub(super) made: [u64; 7],
    /// How often doubles could not tell.
    pub(super) n_exact: Cell<u64>,
}

impl Tests<'_> {
    /// Whether what the camera sees of two fragments has overlapping bounds: the first three tests.
    pub(super) fn overlap(&mut self, p: &Extents, q: &Extents) -> bool {
        let apart = |a: [f64; 2], b: [f64; 2]| a[1] < b[0] || b[1] < a[0];
        self.made[0] += 1;
        // What is wholly nearer than p may come after it.
        if q.depth[1] < p.depth[0] {
            return false;
        }
        (0..2).all(|axis| {
            self.made[1 + axis] += 1;
            !apart(p.pixels[axis], q.pixels[axis])
        })
    }

    /// Whether p may be drawn before q, whose bounds overlap: there is no direction with others around it in which both
    /// are met, and p before q, or both in one plane and p with the lower id. Exact.
    pub(super) fn may_precede(&mut self, p: &Item, q: &Item) -> bool {
        let faces = self.input.faces;
        let (id, other) = (p.fragment.face(), q.fragment.face());
        if id == other {
            return true;
        }
        self.made[3] += 1;
        let relation = p.fragment.relation(faces, &q.plane);
        let coplanar = relation == Relation::In;
        if (coplanar && id > other) || lies(relation, -q.eye) {
            return true;
        }
        self.made[4] += 1;
        if !coplanar && lies(q.fragment.relation(faces, &p.plane), p.eye) {
            return true;
        }
        self.made[5] += 1;
        let sight = Sight { input: self.input, n_exact: &self.n_exact };
        let Some(common) = Common::of(&sight, p.outline(&sight), q.outline(&sight)) else { return true };
        if coplanar {
            return false;
        }
        self.made[6] += 1;
        !common.is_nearer(&sight, (p.plane, p.eye), (q.plane, q.eye))
    }
}

/// Whether a relation says: on this side or on the plane.
fn lies(relation: Relation, side: i32) -> bool {
    match relation {
        Relation::Front => side > 0,
        Relation::Behind => side < 0,
        Relation::In | Relation::Across => false,
    }
}
