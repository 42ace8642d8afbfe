//! Clusters and separating planes: the oldest of list-priority methods. What lies on the eye's side of a plane between clusters may
//! hide what lies on the other; and within a cluster the order of faces is one and the same for all eyes.
//!
//! Such an order exists if the relation "P can hide Q while both face the eye" has no cycle. For that, a point of P must be in front
//! of Q, and a point of Q behind P. As faces are seen from both sides here, each stands in the order twice, once for each side, and
//! an eye draws the one that faces it. Clusters are the scene's objects; where no plane goes between them, or their faces have
//! no fixed order, they are cut by planes, which are exact as in [`crate::bsp`]: in the worst case this is a BSP tree.
//!
//! Sources: Schumacker, Brand, Gilliland and Sharp, "Study for applying computer-generated images to visual simulation", AFHRL-TR-69-14,
//! 1969; the survey by Sutherland, Sproull and Schumacker, Computing Surveys 6(1), 1974. There planes and clusters are made by hand;
//! how they are found, and the cutting, are our own.

mod fixed;
mod separate;

use crate::bsp::{self, BspOptions, Child, Emitted, Order, Parts, Slot, Tree};
use crate::counters::Counters;
use crate::faces::Faces;
use crate::fragment::Fragment;
use crate::method::{RenderInput, RenderOutput, VisibleSurface};
use crate::plane::InputPlane;
use fixed::Fixed;
use std::ops::{ControlFlow, Range};

/// How clusters are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SchumackerOptions {
    /// Clusters of more faces are cut before an order is sought, unless they are convex: seeking compares all pairs.
    pub max_faces: usize,
}

impl Default for SchumackerOptions {
    fn default() -> Self {
        Self { max_faces: 64 }
    }
}

/// What the clusters are like.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SchumackerStats {
    /// Clusters at first: objects that have a face with an area.
    pub objects: usize,
    /// Clusters in the end, each with a fixed order.
    pub clusters: usize,
    /// Of these the ones in which every face has all others on one side or in its plane.
    pub convex: usize,
    /// Planes that part clusters, or parts of them.
    pub planes: usize,
    /// Of these the ones that cut no cluster.
    pub clean: usize,
    /// Clusters that were cut as they were too large.
    pub too_large: usize,
    /// Clusters that were cut as their faces can hide each other in a cycle.
    pub cyclic: usize,
    /// How often a fragment was split in two.
    pub splits: u64,
    /// Fragments in the end.
    pub fragments: usize,
    /// Planes and a cluster on the longest way down.
    pub depth: usize,
}

/// Clusters with fixed orders at the leaves of a tree of separating planes. See the module.
#[derive(Debug, Clone)]
pub struct Schumacker {
    tree: Tree,
    /// For each node where its copies are; none but in leaves.
    copies_of: Vec<Range<usize>>,
    /// Farthest first.
    copies: Vec<Copy>,
    stats: SchumackerStats,
    order: Order,
}

/// One side of a fragment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Copy {
    /// Index among the fragments of its cluster.
    fragment: u32,
    /// Whether this is the side of the fragment's plane that is positive.
    is_front: bool,
}

impl Schumacker {
    /// Finds planes and orders for all faces that have an area. Never deeper in calls, however deep the tree.
    ///
    /// Cost: sorting of clusters for each plane between them; the square of the number of faces in a cluster.
    pub fn build(faces: &Faces, options: &SchumackerOptions) -> Self {
        let objects = by_object(faces);
        let mut build =
            Build { faces, options, tree: Tree::default(), stats: SchumackerStats::default(), leaves: Vec::new() };
        build.stats.objects = objects.len();
        build.run(objects);
        let Build { mut tree, mut stats, leaves, .. } = build;
        tree.finish(faces.len());
        (stats.fragments, stats.depth) = (tree.n_fragments(), tree.depth());
        let mut out =
            Self { copies_of: vec![0..0; tree.n_nodes()], copies: Vec::new(), tree, stats, order: Order::BackToFront };
        for (node, copies) in leaves {
            let start = out.copies.len();
            out.copies.extend(copies);
            out.copies_of[node as usize] = start..out.copies.len();
        }
        out
    }

    /// The same clusters, the nearest first.
    #[must_use]
    pub fn front_to_back(mut self) -> Self {
        self.order = Order::FrontToBack;
        self
    }

    /// What they are like.
    pub fn stats(&self) -> SchumackerStats {
        self.stats
    }

    /// The chosen faces' fragments in the order of the eye.
    fn ordered(&self, input: &RenderInput<'_>, counters: &mut Counters) -> Vec<Fragment> {
        let eye = input.camera.eye();
        // Nothing for faces that were not tested yet.
        let mut sides = vec![None; input.faces.len()];
        let mut out = Emitted::new(input);
        let mut n_copies = 0;
        let walked = self.tree.walk(input.faces, eye, self.order, input.mask, |node| {
            let own = self.tree.own(node);
            let copy = |copy: &Copy| {
                let fragment = &own[copy.fragment as usize];
                let face = fragment.face();
                if input.mask.has(face) {
                    n_copies += 1;
                    let side = sides[face as usize]
                        .get_or_insert_with(|| InputPlane::of(input.faces, face).side(input.faces, eye));
                    if *side == if copy.is_front { 1 } else { -1 } {
                        out.push(fragment);
                    }
                }
            };
            let copies = &self.copies[self.copies_of[node as usize].clone()];
            match (self.tree.is_leaf(node), self.order) {
                (true, Order::BackToFront) => copies.iter().for_each(copy),
                (true, Order::FrontToBack) => copies.iter().rev().for_each(copy),
                (false, Order::BackToFront) => own.iter().rev().for_each(|f| out.push(f)),
                (false, Order::FrontToBack) => own.iter().for_each(|f| out.push(f)),
            }
            ControlFlow::Continue(())
        });
        counters.tested("sides of faces", n_copies);
        out.finish(walked, counters)
    }
}

impl VisibleSurface for Schumacker {
    fn name(&self) -> &'static str {
        "schumacker"
    }

    /// # Panics
    /// If the faces are not as many as those of which the clusters were made.
    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput {
        assert_eq!(self.tree.n_faces(), input.faces.len(), "clusters are drawn with the faces of which they were made");
        let fragments = self.ordered(input, counters);
        match self.order {
            Order::BackToFront => RenderOutput::BackToFront(fragments),
            Order::FrontToBack => RenderOutput::FrontToBack(fragments),
        }
    }
}

/// The faces that have an area, for each object that has any.
fn by_object(faces: &Faces) -> Vec<Vec<Fragment>> {
    let mut all: Vec<(u32, u32)> = faces.ids().filter(|&f| faces.has_area(f)).map(|f| (faces.object(f), f)).collect();
    all.sort_unstable();
    all.chunk_by(|a, b| a.0 == b.0).map(|of| of.iter().map(|&(_, f)| Fragment::whole(f)).collect()).collect()
}

/// What is to be put under a node, and the box in which it lies as far as planes across axes tell.
struct Work {
    place: Slot,
    clusters: Vec<Vec<Fragment>>,
    region: Region,
}

/// The least and the greatest coordinate along each axis.
type Region = [[f64; 2]; 3];

struct Build<'a> {
    faces: &'a Faces,
    options: &'a SchumackerOptions,
    tree: Tree,
    stats: SchumackerStats,
    leaves: Vec<(u32, Vec<Copy>)>,
}

impl Build<'_> {
    fn run(&mut self, objects: Vec<Vec<Fragment>>) {
        let region = [[f64::NEG_INFINITY, f64::INFINITY]; 3];
        let mut todo = vec![Work { place: None, clusters: objects, region }];
        while let Some(work) = todo.pop() {
            let parts = match work.clusters.as_slice() {
                [] => continue,
                [one] => match self.leaf(work.place, one) {
                    None => continue,
                    Some((plane, parts)) => (plane, ClusterParts::of_one(parts)),
                },
                several => self.part(several, &work.region),
            };
            self.hang(&work, parts, &mut todo);
        }
    }

    /// Makes a leaf of a cluster if its faces have a fixed order, else cuts it.
    fn leaf(&mut self, place: Slot, cluster: &[Fragment]) -> Option<(InputPlane, Parts)> {
        let (copies, is_convex) = match fixed::order(self.faces, cluster, self.options.max_faces) {
            Fixed::Convex(copies) => (copies, true),
            Fixed::Order(copies) => (copies, false),
            Fixed::TooLarge => {
                self.stats.too_large += 1;
                return Some(bsp::cut(self.faces, cluster, &BspOptions::default(), self.tree.n_nodes() as u64));
            }
            Fixed::Cycle(planes) => {
                self.stats.cyclic += 1;
                return Some(separate::cheapest(self.faces, cluster, &planes));
            }
        };
        self.stats.clusters += 1;
        self.stats.convex += usize::from(is_convex);
        let node = self.tree.add(place, None, cluster.iter().cloned());
        self.leaves.push((node, copies));
        None
    }

    /// Parts several clusters.
    fn part(&self, clusters: &[Vec<Fragment>], region: &Region) -> (InputPlane, ClusterParts) {
        let plane = separate::plane(self.faces, clusters, region).unwrap_or_else(|| {
            let all: Vec<Fragment> = clusters.iter().flatten().cloned().collect();
            bsp::cut(self.faces, &all, &BspOptions::default(), self.tree.n_nodes() as u64).0
        });
        (plane, ClusterParts::of(self.faces, clusters, &plane))
    }

    fn hang(&mut self, work: &Work, (plane, parts): (InputPlane, ClusterParts), todo: &mut Vec<Work>) {
        self.stats.planes += 1;
        self.stats.clean += usize::from(parts.n_cut == 0);
        self.stats.splits += parts.splits;
        let mut within = parts.within;
        within.sort_by_key(Fragment::face);
        let node = self.tree.add(work.place, Some(plane), within);
        let (mut front, mut behind) = (work.region, work.region);
        if let InputPlane::Axis(axis, at) = plane {
            front[usize::from(axis)][0] = front[usize::from(axis)][0].max(at);
            behind[usize::from(axis)][1] = behind[usize::from(axis)][1].min(at);
        }
        todo.push(Work { place: Some((node, Child::Behind)), clusters: parts.behind, region: behind });
        todo.push(Work { place: Some((node, Child::Front)), clusters: parts.front, region: front });
    }
}

/// What a plane makes of clusters.
#[derive(Default)]
struct ClusterParts {
    front: Vec<Vec<Fragment>>,
    behind: Vec<Vec<Fragment>>,
    within: Vec<Fragment>,
    splits: u64,
    /// Clusters on both sides.
    n_cut: usize,
}

impl ClusterParts {
    fn of(faces: &Faces, clusters: &[Vec<Fragment>], plane: &InputPlane) -> Self {
        let mut out = Self::default();
        clusters.iter().for_each(|cluster| out.add(Parts::of(faces, cluster, plane)));
        out
    }

    fn of_one(parts: Parts) -> Self {
        let mut out = Self::default();
        out.add(parts);
        out
    }

    fn add(&mut self, parts: Parts) {
        self.splits += parts.splits;
        self.n_cut += usize::from(!parts.front.is_empty() && !parts.behind.is_empty());
        self.within.extend(parts.within);
        for (side, part) in [(&mut self.front, parts.front), (&mut self.behind, parts.behind)] {
            if !part.is_empty() {
                side.push(part);
            }
        }
    }
}
