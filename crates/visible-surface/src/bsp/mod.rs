//! Binary space partition: the planes of faces cut space, once for all eyes; a walk through the tree gives the order for any one.
//!
//! At a node, everything on the eye's side of the plane may hide what lies in the plane, and that may hide what lies beyond, never
//! the other way round. Fragments are known by the planes that cut them, so the tree is exact, however deep.
//!
//! Sources: Fuchs, Kedem and Naylor, "On visible surface generation by a priori tree structures", SIGGRAPH 1980; candidates by weighted cost:
//! Abrash, "Graphics Programming Black Book", chapter 64. Skipping what no chosen face lies in is how Quake follows its table
//! of visible leafs. Planes across axes in large nodes, and the weights, are our own choice.

mod choose;
mod tree;

use crate::counters::Counters;
use crate::faces::Faces;
use crate::fragment::Fragment;
use crate::image::Image;
use crate::method::{Canvas, RenderInput, RenderOutput, VisibleSurface, drawn};
use crate::plane::InputPlane;
pub(crate) use choose::{Parts, Tally, WEIGHTS, cut};
use std::ops::ControlFlow;
pub(crate) use tree::{Child, Slot, Tree, Walked};

/// Which of the candidates' planes cuts a node. Ties go to the first candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heuristic {
    /// That of the face with the lowest id: no choice at all.
    FirstFace,
    /// That of any face, by chance: the same for the same seed.
    Random {
        /// Where chance starts.
        seed: u64,
    },
    /// That which splits fewest fragments; of those the most balanced.
    FewestSplits,
    /// That with the most equal numbers of fragments on both sides; of those the one with fewest splits.
    Balanced,
    /// That with the least `splits * number of splits + balance * difference between the sides`.
    Weighted {
        /// What a split costs.
        splits: f64,
        /// What a fragment more on one side costs.
        balance: f64,
    },
}

/// How a tree is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BspOptions {
    /// How planes are chosen.
    pub heuristic: Heuristic,
    /// How many faces of a node are candidates, at least one; spread evenly from a place that chance chooses, always the same.
    pub candidates: usize,
    /// Nodes with more fragments are cut by a plane across an axis if that parts them, so that large trees take about `n log n`;
    /// `usize::MAX` for never: then all planes are of faces.
    pub axis_above: usize,
}

impl Default for BspOptions {
    fn default() -> Self {
        let [splits, balance] = WEIGHTS;
        Self { heuristic: Heuristic::Weighted { splits, balance }, candidates: 12, axis_above: 64 }
    }
}

/// What a tree is like.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BspStats {
    /// Faces in it: all that have an area.
    pub faces: usize,
    /// What they were split into; as many more as there were splits.
    pub fragments: usize,
    /// How often a fragment was split in two.
    pub splits: u64,
    /// Nodes, each with a plane.
    pub nodes: usize,
    /// Nodes in whose plane, which is across an axis, no face lies.
    pub axis_nodes: usize,
    /// Nodes on the longest way down.
    pub depth: usize,
}

/// In which order a tree is walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// The farthest first.
    BackToFront,
    /// The nearest first.
    FrontToBack,
}

/// A node of a tree, to be shown.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceBspNode {
    /// What cuts the space there.
    pub plane: InputPlane,
    /// The nodes behind the plane and in front of it.
    pub children: [Option<u32>; 2],
    /// The faces of which a part lies in the plane, ascending.
    pub faces: Vec<u32>,
}

/// A binary space partition of faces. See the module.
#[derive(Debug, Clone)]
pub struct FaceBsp {
    tree: Tree,
    stats: BspStats,
    order: Order,
}

impl FaceBsp {
    /// Makes the tree of all faces that have an area. Never deeper in calls, however deep the tree.
    ///
    /// Cost: about `n log n` where planes part the scene well; each node costs candidates times at most 256 fragments.
    pub fn build(faces: &Faces, options: &BspOptions) -> Self {
        let all: Vec<Fragment> = faces.ids().filter(|&f| faces.has_area(f)).map(Fragment::whole).collect();
        let mut stats = BspStats { faces: all.len(), ..BspStats::default() };
        let mut tree = Tree::default();
        let mut todo: Vec<(Slot, Vec<Fragment>)> = vec![(None, all)];
        while let Some((place, fragments)) = todo.pop() {
            if fragments.is_empty() {
                continue;
            }
            let (plane, parts) = cut(faces, &fragments, options, tree.n_nodes() as u64);
            drop(fragments);
            stats.splits += parts.splits;
            stats.axis_nodes += usize::from(parts.within.is_empty());
            // Fragments come in the order of ids, and every cut keeps it.
            let node = tree.add(place, Some(plane), parts.within);
            todo.push((Some((node, Child::Behind)), parts.behind));
            todo.push((Some((node, Child::Front)), parts.front));
        }
        tree.finish(faces.len());
        (stats.nodes, stats.fragments, stats.depth) = (tree.n_nodes(), tree.n_fragments(), tree.depth());
        Self { tree, stats, order: Order::BackToFront }
    }

    /// The same tree, walked from the nearest to the farthest.
    #[must_use]
    pub fn front_to_back(mut self) -> Self {
        self.order = Order::FrontToBack;
        self
    }

    /// The nodes, the root first, parents before their children. O(nodes + fragments).
    pub fn nodes(&self) -> impl Iterator<Item = FaceBspNode> + '_ {
        (0u32..).take(self.tree.n_nodes()).filter_map(|node| {
            let (plane, children) = self.tree.parts(node);
            let mut faces: Vec<u32> = self.tree.own(node).iter().map(Fragment::face).collect();
            faces.dedup();
            Some(FaceBspNode { plane: plane?, children, faces })
        })
    }

    /// What it is like.
    pub fn stats(&self) -> BspStats {
        self.stats
    }

    /// Calls `at` for each node in the order of the eye with the fragments in its plane by ascending id; until it has enough.
    fn walk(&self, input: &RenderInput<'_>, mut at: impl FnMut(&[Fragment]) -> ControlFlow<()>) -> Walked {
        assert_eq!(self.tree.n_faces(), input.faces.len(), "a tree is walked with the faces of which it was made");
        self.tree.walk(input.faces, input.camera.eye(), self.order, input.mask, |node| at(self.tree.own(node)))
    }

    /// The chosen faces' fragments in the order of the eye. Those in one plane come so that the lower id is seen.
    fn ordered(&self, input: &RenderInput<'_>, counters: &mut Counters) -> Vec<Fragment> {
        let mut out = Emitted::new(input);
        let walked = self.walk(input, |own| {
            match self.order {
                Order::BackToFront => own.iter().rev().for_each(|f| out.push(f)),
                Order::FrontToBack => own.iter().for_each(|f| out.push(f)),
            }
            ControlFlow::Continue(())
        });
        out.finish(walked, counters)
    }
}

impl VisibleSurface for FaceBsp {
    fn name(&self) -> &'static str {
        match self.order {
            Order::BackToFront => "bsp",
            Order::FrontToBack => "bsp-front",
        }
    }

    /// # Panics
    /// If the faces are not as many as those of which the tree was made.
    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        let fragments = self.ordered(input, counters);
        match self.order {
            Order::BackToFront => RenderOutput::BackToFront(fragments),
            Order::FrontToBack => RenderOutput::FrontToBack(fragments),
        }
    }

    /// From the nearest to the farthest, the walk ends when the picture is full.
    fn picture(&self, input: &RenderInput<'_>) -> (Image, Counters) {
        if self.order == Order::BackToFront {
            return drawn(self, input);
        }
        let mut counters = Counters::default();
        let mut canvas = Canvas::new(input);
        let mut is_counted = vec![false; input.faces.len()];
        let walked = self.walk(input, |own| {
            for fragment in own.iter().filter(|f| input.mask.has(f.face())) {
                let new = !std::mem::replace(&mut is_counted[fragment.face() as usize], true);
                counters.polygons += u64::from(new);
                if canvas.draw(fragment, &mut counters) == 0 {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        walked.count(&mut counters);
        let image = canvas.finish();
        counters.covered = image.n_covered();
        (image, counters)
    }
}

/// Fragments as a walk gives them, without those of faces that are not chosen.
pub(crate) struct Emitted<'a> {
    input: &'a RenderInput<'a>,
    fragments: Vec<Fragment>,
    is_counted: Vec<bool>,
    n_faces: u64,
}

impl<'a> Emitted<'a> {
    pub(crate) fn new(input: &'a RenderInput<'a>) -> Self {
        Self { input, fragments: Vec::new(), is_counted: vec![false; input.faces.len()], n_faces: 0 }
    }

    pub(crate) fn push(&mut self, fragment: &Fragment) {
        let face = fragment.face();
        if self.input.mask.has(face) {
            self.n_faces += u64::from(!std::mem::replace(&mut self.is_counted[face as usize], true));
            self.fragments.push(fragment.clone());
        }
    }

    pub(crate) fn finish(self, walked: Walked, counters: &mut Counters) -> Vec<Fragment> {
        counters.polygons += self.n_faces;
        walked.count(counters);
        self.fragments
    }
}
