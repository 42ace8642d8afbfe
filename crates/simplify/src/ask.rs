//! Which faces may be visible from which of many boxes of eyes, asked of groups of boxes first.
//!
//! What is hidden from a box is hidden from all boxes in it. So a tree is built over the boxes of eyes, and what the box around a
//! group of them does not see is asked only once. A face that a ray from a group reaches cannot be hidden from it, and is not asked there. Faces are in a tree too:
//! where none is known to be visible, the box around several is asked about before each of them.
//!
//! Rays and guesses of what pays only steer the work. Every face that is called hidden was proven hidden from a box that contains the eyes.

use rayon::prelude::*;
use sightlines_geometry::{Aabb, BoxTree, Point3, Random};
use sightlines_multifocal::{BackendError, FromRegion, RaySampler, Umbra, Volume};
use sightlines_visible_surface::Faces;
use std::sync::Mutex;

/// Makes a from-region method for the scene, for one thread.
pub type MakeMethod<'a> = &'a (dyn Fn() -> Box<dyn FromRegion + Send> + Sync);

/// Rays towards each face that is open, from a group of boxes.
const N_RAYS_OF_GROUP: u32 = 2;
/// Rays from each box towards each face that is open.
const N_RAYS: u32 = 4;
/// The same, if no ray from the group of the box reached the face.
const N_RAYS_OF_UNSEEN: u32 = 1;
/// Most boxes of a group that is asked about, if each box is wanted.
const MOST_BOXES: usize = 8;
/// Faces of samples.
const N_SAMPLES: usize = 48;
/// Classes of the sizes of boxes, by powers of two.
const N_CLASSES: usize = 32;

/// What is known of a face and a box of eyes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Hidden,
    /// Not hidden by what was asked so far.
    Open,
    /// A ray reached it, or everything was asked.
    Visible,
}

/// What is known of all faces and a box of eyes.
type Row = Vec<State>;

/// Faces that are asked about, in their tree.
#[derive(Debug)]
pub(crate) struct Asker<'a> {
    faces: &'a Faces,
    tree: BoxTree<3>,
    /// Where each face stands in the order of the tree.
    place: Vec<u32>,
    sampler: RaySampler,
}

impl<'a> Asker<'a> {
    /// O(n log n).
    pub(crate) fn new(faces: &'a Faces) -> Self {
        let boxes: Vec<Aabb<3>> = faces.ids().map(|face| faces.bounds(face)).collect();
        let tree = BoxTree::build(&boxes, 1);
        let mut place = vec![0; faces.len()];
        (0..).zip(tree.order()).for_each(|(k, &face)| place[face as usize] = k);
        Self { faces, tree, place, sampler: RaySampler::new(faces.corners().iter().map(std::slice::from_ref)) }
    }

    /// For each box the faces that may be visible from it.
    ///
    /// * `start`: for each box the faces that are not known to be hidden
    pub(crate) fn each(
        &self,
        make: MakeMethod<'_>,
        boxes: &[Volume],
        start: Vec<Vec<bool>>,
    ) -> Result<Vec<Vec<bool>>, BackendError> {
        let search = self.search(make, boxes);
        let mut rows = search.rows(&start);
        if !self.faces.is_empty() {
            search.node(0, self.all(), &mut rows, None)?;
        }
        let mut visible = start;
        for (row, &of) in rows.iter().zip(search.boxes.order()) {
            for (visible, &place) in visible[of as usize].iter_mut().zip(&self.place) {
                *visible = row[place as usize] != State::Hidden;
            }
        }
        Ok(visible)
    }

    /// The faces that may be visible from some of the boxes: cheaper than [`Self::each`], as nothing is asked about a face once it is
    /// known to be one.
    pub(crate) fn any(
        &self,
        make: MakeMethod<'_>,
        boxes: &[Volume],
        start: &[Vec<bool>],
    ) -> Result<Vec<bool>, BackendError> {
        let search = self.search(make, boxes);
        let mut known = vec![false; self.faces.len()];
        if !self.faces.is_empty() {
            search.node(0, self.all(), &mut search.rows(start), Some(&mut known))?;
        }
        Ok(self.place.iter().map(|&place| known[place as usize]).collect())
    }

    fn all(&self) -> Vec<u32> {
        (0..self.faces.len() as u32).collect()
    }

    fn search<'s>(&'s self, make: MakeMethod<'s>, boxes: &'s [Volume]) -> Search<'s> {
        let bounds: Vec<Aabb<3>> = boxes.iter().map(|volume| *volume.bounds()).collect();
        Search { asker: self, make, methods: Mutex::new(Vec::new()), volumes: boxes, boxes: BoxTree::build(&bounds, 1) }
    }

    fn face(&self, place: u32) -> &[Point3; 3] {
        self.faces.of(self.tree.order()[place as usize])
    }

    fn bounds(&self, place: u32) -> Aabb<3> {
        self.faces.bounds(self.tree.order()[place as usize])
    }
}

type RegionMethod = Box<dyn FromRegion + Send>;

/// A search about some boxes of eyes. Faces are numbered by their places in the tree, boxes in the order of theirs.
struct Search<'a> {
    asker: &'a Asker<'a>,
    make: MakeMethod<'a>,
    /// Those that no thread uses.
    methods: Mutex<Vec<RegionMethod>>,
    volumes: &'a [Volume],
    boxes: BoxTree<3>,
}

impl Search<'_> {
    fn rows(&self, start: &[Vec<bool>]) -> Vec<Row> {
        let row = |&of: &u32| {
            let open = |&face: &u32| if start[of as usize][face as usize] { State::Open } else { State::Hidden };
            self.asker.tree.order().iter().map(open).collect()
        };
        self.boxes.order().par_iter().map(row).collect()
    }

    fn volume(&self, at: usize) -> &Volume {
        &self.volumes[self.boxes.order()[at] as usize]
    }

    /// Decides about the boxes of a node.
    ///
    /// * `open`: faces, ascending; all others are decided for these boxes
    /// * `rows`: what is known, for each of these boxes
    /// * `known`: whether each face is visible from any box, if that is all that is asked
    fn node(&self, n: u32, open: Vec<u32>, rows: &mut [Row], known: Option<&mut [bool]>) -> Result<(), BackendError> {
        let node = &self.boxes.nodes()[n as usize];
        let start = node.start as usize;
        if let Some(known) = known {
            return self.any_of_group(&node.bounds, start, open, rows, known);
        }
        if node.len() <= MOST_BOXES {
            return self.each_of_group(&node.bounds, start, open, rows);
        }
        let [first, second] = self.boxes.children(n);
        let middle = self.boxes.nodes()[second as usize].start as usize - start;
        let (low, high) = rows.split_at_mut(middle);
        let copy = open.clone();
        let (a, b) = rayon::join(|| self.node(first, copy, low, None), || self.node(second, open, high, None));
        a.and(b)
    }

    /// Decides about each box of a group.
    fn each_of_group(
        &self,
        around: &Aabb<3>,
        start: usize,
        open: Vec<u32>,
        rows: &mut [Row],
    ) -> Result<(), BackendError> {
        // Towards what no ray from the group reached, few are sent from each box.
        let mut seen = vec![true; self.asker.faces.len()];
        if rows.len() > 1 {
            self.shoot(|_| N_RAYS_OF_GROUP, start, &open, rows, None);
            let is_seen = |f: usize| rows.iter().any(|row| row[f] == State::Visible);
            seen.iter_mut().enumerate().for_each(|(f, seen)| *seen = is_seen(f));
            let mut question = Vec::new();
            self.with_method(|method| {
                let mut umbra = method.umbra(&volume_of(around))?;
                question = self.hide_groups(&mut *umbra, &in_doubt(&open, rows, None), rows);
                if self.pays(&mut *umbra, &question, rows.len()) {
                    self.hide_singles(&mut *umbra, &question, rows);
                }
                Ok(())
            })?;
        }
        let rows = rows.par_iter_mut().enumerate();
        let n_rays = |f: u32| if seen[f as usize] { N_RAYS } else { N_RAYS_OF_UNSEEN };
        rows.try_for_each(|(k, row)| self.decide(start + k, &open, n_rays, std::slice::from_mut(row), None))
    }

    /// Decides which faces some box of a group sees.
    fn any_of_group(
        &self,
        around: &Aabb<3>,
        start: usize,
        open: Vec<u32>,
        rows: &mut [Row],
        known: &mut [bool],
    ) -> Result<(), BackendError> {
        if rows.len() > 1 {
            self.shoot(|_| N_RAYS_OF_GROUP, start, &open, rows, Some(&mut *known));
            self.with_method(|method| {
                let mut umbra = method.umbra(&volume_of(around))?;
                self.hide_groups(&mut *umbra, &in_doubt(&open, rows, Some(known)), rows);
                Ok(())
            })?;
        }
        let n_rays = if rows.len() > 1 { N_RAYS_OF_UNSEEN } else { N_RAYS };
        for k in 0..rows.len() {
            // What one box sees is not asked of the next.
            self.decide(start + k, &open, |_| n_rays, &mut rows[k..=k], Some(&mut *known))?;
            if k == 0 && rows.len() > 1 {
                // Most of what is not hidden from the first box is seen from it, and is not asked of the group.
                self.with_method(|method| {
                    let asked = in_doubt(&open, rows, Some(known));
                    let mut umbra = method.umbra(&volume_of(around))?;
                    if self.pays(&mut *umbra, &asked, rows.len()) {
                        self.hide_singles(&mut *umbra, &asked, rows);
                    }
                    Ok(())
                })?;
            }
        }
        Ok(())
    }

    /// Decides about all open faces and one box.
    ///
    /// * `n_rays`: how many rays are sent towards a face
    fn decide(
        &self,
        at: usize,
        open: &[u32],
        n_rays: impl Fn(u32) -> u32,
        rows: &mut [Row],
        mut known: Option<&mut [bool]>,
    ) -> Result<(), BackendError> {
        let open = in_doubt(open, rows, known.as_deref());
        self.shoot(n_rays, at, &open, rows, known.as_deref_mut());
        let open = in_doubt(&open, rows, known.as_deref());
        if open.is_empty() {
            return Ok(());
        }
        self.with_method(|method| {
            let mut umbra = method.umbra(self.volume(at))?;
            let rest = self.hide_groups(&mut *umbra, &open, rows);
            self.hide_singles(&mut *umbra, &rest, rows);
            Ok(())
        })?;
        for f in in_doubt(&open, rows, known.as_deref()) {
            rows[0][f as usize] = State::Visible;
            known.iter_mut().for_each(|known| known[f as usize] = true);
        }
        Ok(())
    }

    fn with_method(
        &self,
        run: impl FnOnce(&mut dyn FromRegion) -> Result<(), BackendError>,
    ) -> Result<(), BackendError> {
        let mut method = self.methods.lock().expect("no thread panics").pop().unwrap_or_else(self.make);
        run(&mut *method)?;
        self.methods.lock().expect("no thread panics").push(method);
        Ok(())
    }

    /// Hides faces by boxes around several; returns those that are left.
    fn hide_groups(&self, umbra: &mut dyn Umbra, asked: &[u32], rows: &mut [Row]) -> Vec<u32> {
        let n = self.asker.faces.len();
        let mut n_visible = vec![0; n + 1];
        for f in 0..n {
            n_visible[f + 1] = n_visible[f] + u32::from(rows.iter().any(|row| row[f] == State::Visible));
        }
        let tries = [[0; 2]; N_CLASSES];
        let mut question =
            Question { asker: self.asker, umbra, n_visible, tries, hidden: Vec::new(), rest: Vec::new() };
        question.node(0, asked, usize::MAX);
        hide(&question.hidden, rows);
        question.rest
    }

    /// Hides faces one by one.
    fn hide_singles(&self, umbra: &mut dyn Umbra, asked: &[u32], rows: &mut [Row]) {
        let hidden = asked.iter().copied().filter(|&f| umbra.hides_points_by_any(self.asker.face(f)));
        hide(&hidden.collect::<Vec<u32>>(), rows);
    }

    /// Whether enough faces are hidden from a group of boxes that asking about all of them saves questions about each box.
    fn pays(&self, umbra: &mut dyn Umbra, asked: &[u32], n_boxes: usize) -> bool {
        let n = asked.len().min(N_SAMPLES);
        let hidden = (0..n).filter(|k| umbra.hides_points_by_any(self.asker.face(asked[k * asked.len() / n])));
        n_boxes * hidden.count() > 2 * n
    }

    /// Sends rays towards faces, from boxes for which they are open, and notes what they hit.
    fn shoot(
        &self,
        n_rays: impl Fn(u32) -> u32,
        start: usize,
        open: &[u32],
        rows: &mut [Row],
        mut known: Option<&mut [bool]>,
    ) {
        let asker = self.asker;
        let b = self.volume(start).bounds();
        let seed = b.min[0].to_bits() ^ b.max[1].to_bits().rotate_left(17) ^ b.min[2].to_bits().rotate_left(41);
        let mut random = Random::new(seed ^ rows.len() as u64);
        for &f in open {
            let t = asker.face(f);
            for _ in 0..n_rays(f) {
                let any = random.below(rows.len());
                let is_decided = match &known {
                    Some(known) => known[f as usize],
                    None => rows.iter().any(|row| row[f as usize] == State::Visible),
                };
                if is_decided {
                    break;
                }
                // The first from there on for which it is open.
                let of = (any..rows.len()).chain(0..any).find(|&k| rows[k][f as usize] == State::Open);
                let Some(of) = of else { break };
                let origin = random.point(self.volume(start + of).bounds());
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let way = [0, 1, 2].map(|k| t[0][k] + u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k]) - origin[k]);
                let Some(hit) = asker.sampler.first_triangle(origin, way) else { continue };
                let hit = asker.place[hit as usize] as usize;
                if rows[of][hit] == State::Open {
                    rows[of][hit] = State::Visible;
                    known.iter_mut().for_each(|known| known[hit] = true);
                }
            }
        }
    }
}

fn volume_of(around: &Aabb<3>) -> Volume {
    Volume::new(*around).expect("a box around volumes is one")
}

fn hide(faces: &[u32], rows: &mut [Row]) {
    faces.iter().for_each(|&f| rows.iter_mut().for_each(|row| row[f as usize] = State::Hidden));
}

/// Those of `open` that may be hidden from all boxes of `rows`, and are not known to be.
fn in_doubt(open: &[u32], rows: &[Row], known: Option<&[bool]>) -> Vec<u32> {
    let is_in_doubt = |&f: &u32| {
        let is = |state| rows.iter().any(|row| row[f as usize] == state);
        !known.is_some_and(|known| known[f as usize]) && is(State::Open) && !is(State::Visible)
    };
    open.iter().copied().filter(is_in_doubt).collect()
}

/// Questions about one box of eyes.
struct Question<'a> {
    asker: &'a Asker<'a>,
    umbra: &'a mut dyn Umbra,
    /// How many faces before each are known to be visible.
    n_visible: Vec<u32>,
    /// For boxes around so many faces, by the power of two: how often one was asked about, and how often it was hidden.
    tries: [[u32; 2]; N_CLASSES],
    hidden: Vec<u32>,
    /// What has to be asked one by one.
    rest: Vec<u32>,
}

impl Question<'_> {
    /// Asks about those of `asked`, which are in a node.
    ///
    /// * `n_failed`: the number of faces of the last box around this node that was asked about and is not hidden
    fn node(&mut self, n: u32, asked: &[u32], mut n_failed: usize) {
        let asker = self.asker;
        if asked.len() < 2 {
            self.rest.extend_from_slice(asked);
            return;
        }
        let node = &asker.tree.nodes()[n as usize];
        let is_mixed = self.n_visible[node.start as usize] < self.n_visible[node.end as usize];
        if !is_mixed && asked.len() < n_failed && self.pays(asked.len()) {
            let corners = asked.iter().map(|&f| asker.bounds(f)).flat_map(|b| [b.min, b.max]);
            let is_hidden = self.umbra.hides(&Aabb::around(corners));
            let [asks, hits] = &mut self.tries[class(asked.len())];
            (*asks, *hits) = (*asks + 1, *hits + u32::from(is_hidden));
            if is_hidden {
                self.hidden.extend_from_slice(asked);
                return;
            }
            n_failed = asked.len();
        }
        let [first, second] = asker.tree.children(n);
        let middle = asker.tree.nodes()[second as usize].start;
        let (low, high) = asked.split_at(asked.partition_point(|&f| f < middle));
        self.node(first, low, n_failed);
        self.node(second, high, n_failed);
    }

    /// Whether the boxes around so many faces have been hidden often enough to save questions.
    fn pays(&self, n: usize) -> bool {
        let [asks, hits] = self.tries[class(n)];
        asks < 16 || u64::from(hits) * n as u64 >= u64::from(asks)
    }
}

fn class(n: usize) -> usize {
    (n.ilog2() as usize).min(N_CLASSES - 1)
}

#[cfg(test)]
mod tests;
