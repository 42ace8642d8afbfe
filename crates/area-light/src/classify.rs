//! Umbra, lit, or in doubt: from whole groups of faces down to small pieces.

use crate::hull::{Hull, Light};
use crate::lighting::{LightCounters, Lighting};
use crate::rays::Blockers;
use crate::vector::area;
use crate::{LightOptions, LightingAreas, Piece, Side, State};
use sightlines_geometry::{Aabb, BoxTree, Point3, check_coordinate};
use sightlines_multifocal::{BackendError, FromRegion, Umbra, Volume};
use sightlines_visible_surface::{FaceMask, Faces};

/// Number of faces in a leaf of the tree of faces to classify.
const PER_LEAF: usize = 4;

/// A scene whose surfaces are classified: all of its faces block light from both sides.
#[derive(Debug)]
pub struct Shadows<'a> {
    pub(crate) faces: &'a Faces,
    pub(crate) blockers: Blockers<'a>,
}

impl<'a> Shadows<'a> {
    /// Makes a scene ready. O(n log² n).
    pub fn new(faces: &'a Faces) -> Self {
        Self { faces, blockers: Blockers::build(faces) }
    }

    /// Classifies the chosen faces: which parts are in umbra, lit, or in doubt.
    ///
    /// A point of the light lights a point of a face's side if it is strictly in front of that side's plane, and no
    /// face is met between the two. A light shines from all of its points to all sides; what lies on its border, such
    /// as the ceiling that a lamp is flush with, hides nothing from it that other points of the light see; nothing is
    /// guaranteed for points of the light on a surface. [`Piece`] defines a piece of a face.
    ///
    /// * *umbra*: the light is behind the side's plane or on it, or `method` finds the piece hidden. This
    ///   is as sure as [`FromRegion::guarantee`] says, and as complete as the method is. The method has to be made for the same faces, or some of them.
    /// * *lit*: the light is in front of the side's plane or on it, and no face meets the interior of the hull of light and piece: proven by exact
    ///   predicates and bounds of rounding, whatever the method.
    /// * *in doubt*: the rest. A face whose plane cuts through the light is nowhere wholly lit.
    ///
    /// Faces without area have no pieces and hide nothing. A light of one point or within one plane is a light like any other; a light within a solid
    /// leaves everything outside in umbra, if the method can tell. The same input gives the same answer.
    ///
    /// Cost: a few rays for each piece, and for those of which all rays arrive, or none, a search for blockers or a query of the method.
    ///
    /// # Errors
    /// [`BackendError`] of the method.
    ///
    /// # Panics
    /// If the faces are not as many as those that were chosen from.
    pub fn classify(
        &self,
        chosen: &FaceMask,
        light: &Volume,
        method: &mut dyn FromRegion,
        options: &LightOptions,
    ) -> Result<Lighting, BackendError> {
        let guarantee = method.guarantee();
        let mut asking = Asking {
            shadows: self,
            light: Light::new(light),
            options,
            umbra: method.umbra(light)?,
            counters: LightCounters::default(),
            pieces: Vec::new(),
            stack: Vec::new(),
        };
        let ids: Vec<u32> = self.faces.ids().filter(|&f| chosen.has(f) && self.faces.has_area(f)).collect();
        let is_hidden = asking.groups(&ids);
        for (&face, is_hidden) in ids.iter().zip(is_hidden) {
            for side in options.sides.of(*self.faces.of(face)) {
                asking.face(face, side, is_hidden);
            }
        }
        let Asking { counters, pieces, .. } = asking;
        let mut areas = LightingAreas::default();
        pieces.iter().for_each(|piece| areas.add(piece, area(*self.faces.of(piece.face))));
        Ok(Lighting { light: *light, guarantee, pieces, areas, counters })
    }

    /// The share of a light that lights a point of a face's side, from 0 to 1, by `n` rays (one, if 0) to points that
    /// fill the light evenly. An estimate in doubles.
    ///
    /// * `p`: a point of the face
    /// * `seed`: the same one gives the same rays
    ///
    /// # Panics
    /// If there is no such face.
    pub fn share(&self, light: &Volume, p: Point3, face: u32, side: Side, n: u32, seed: u64) -> f64 {
        self.blockers.share(light, p, face, side, n, seed)
    }
}

struct Asking<'a, 'u> {
    shadows: &'a Shadows<'a>,
    light: Light,
    options: &'a LightOptions,
    umbra: Box<dyn Umbra + 'u>,
    counters: LightCounters,
    pieces: Vec<Piece>,
    stack: Vec<(Piece, Option<u32>)>,
}

impl Asking<'_, '_> {
    /// Which of these faces are hidden with all that is around them.
    fn groups(&mut self, ids: &[u32]) -> Vec<bool> {
        let boxes: Vec<Aabb<3>> = ids.iter().map(|&f| self.shadows.faces.bounds(f)).collect();
        let tree = BoxTree::build(&boxes, PER_LEAF);
        let mut is_hidden = vec![false; ids.len()];
        let mut stack = if ids.is_empty() { Vec::new() } else { vec![0] };
        while let Some(n) = stack.pop() {
            let node = &tree.nodes()[n as usize];
            // What cannot be hidden is not tested.
            let v = self.light.volume.bounds();
            let meets = (0..3).all(|k| v.min[k] <= node.bounds.max[k] && node.bounds.min[k] <= v.max[k]);
            self.counters.n_asked += u64::from(!meets);
            if !meets && self.umbra.hides(&node.bounds) {
                let group = &tree.order()[node.start as usize..node.end as usize];
                group.iter().for_each(|&i| is_hidden[i as usize] = true);
                self.counters.n_in_groups += group.len() as u64;
            } else if !node.is_leaf() {
                stack.extend(tree.children(n));
            }
        }
        is_hidden
    }

    /// All pieces of a side of a face.
    fn face(&mut self, face: u32, side: Side, is_hidden: bool) {
        let corners = *self.shadows.faces.of(face);
        let turned = side.turned(corners);
        let whole = Piece::whole(face, side, corners);
        let [any_front, any_behind] = self.light.about(turned);
        if !any_front || is_hidden {
            self.counters.n_facing_away += u64::from(!any_front);
            self.pieces.push(Piece { state: State::Umbra, ..whole });
            return;
        }
        self.stack.push((whole, None));
        while let Some((mut piece, hint)) = self.stack.pop() {
            let hint = self.decide(&mut piece, &turned, !any_behind, hint);
            let is_done = piece.state != State::InDoubt
                || piece.depth >= self.options.max_depth
                || piece.longest().1 <= self.options.min_size;
            match piece.halves().filter(|_| !is_done) {
                Some(halves) => {
                    let fresh = |half| (Piece { is_mixed: false, ..half }, hint);
                    self.stack.extend(halves.into_iter().rev().map(fresh));
                }
                None => self.pieces.push(piece),
            }
        }
    }

    /// Decides a piece as a whole, if that can be. A face that may stand in the way of light is returned, to be tested
    /// first for its halves.
    fn decide(&mut self, piece: &mut Piece, turned: &[Point3; 3], may_be_lit: bool, hint: Option<u32>) -> Option<u32> {
        let blockers = &self.shadows.blockers;
        let probe = blockers.probe(&self.light, turned, &piece.corners, piece.face);
        self.counters.n_rays += 4;
        piece.is_mixed = probe.any_blocked && probe.any_free;
        let mut found = hint;
        if !probe.any_blocked && may_be_lit {
            self.counters.n_hulls += 1;
            let hull = Hull::new(&self.light, *self.shadows.faces.of(piece.face), piece);
            found = blockers.any_in(&hull, piece.face, hint, &mut self.counters.n_tested);
            if found.is_none() {
                piece.state = State::Lit;
            }
        } else if !probe.any_free {
            let around = piece.around();
            let usable = around.iter().flatten().all(|&x| check_coordinate(x).is_ok());
            self.counters.n_asked += u64::from(usable);
            if usable && self.umbra.hides_points(&around) {
                piece.state = State::Umbra;
            }
        }
        found
    }
}
