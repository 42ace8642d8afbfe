//! Leafs merged into clusters, which then need not be convex, as some compilers merge those of open places.

use sightlines::cells::{CellGraph, CellId, Convex, Portal3};
use sightlines::pvs::BitMatrix;
use sightlines::stabtree::{ConvexOptions, ConvexSearch, ConvexVisibility};
use sightlines_testkit::Random;

/// Clusters, and the portals between different ones.
#[derive(Debug, Clone)]
pub struct Merged {
    /// The cluster of each leaf.
    pub of: Vec<u32>,
    /// The graph of clusters.
    pub graph: CellGraph<Convex>,
}

impl Merged {
    /// The clusters of leafs, whatever they are called.
    pub fn new(leafs: &CellGraph<Convex>, names: &[u32]) -> Self {
        let mut sorted = names.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        let of: Vec<u32> = names.iter().map(|name| sorted.partition_point(|other| other < name) as u32).collect();
        let cluster = |leaf: CellId| CellId(of[leaf.idx()]);
        let portals = leafs.portals().iter().map(|p| (p.cells.map(cluster), p.shape.clone()));
        let graph = CellGraph::of_portals(sorted.len(), portals.filter(|(pair, _)| pair[0] != pair[1]).collect());
        Self { of, graph }
    }

    /// Up to half as many times as there are leafs two clusters are merged: neighbours, or any two.
    pub fn at_random(leafs: &CellGraph<Convex>, random: &mut Random, neighbours: bool) -> Self {
        let mut names: Vec<u32> = (0..leafs.n_cells() as u32).collect();
        for _ in 0..=random.below(leafs.n_cells() / 2) {
            let [a, b] = match neighbours && !leafs.portals().is_empty() {
                true => leafs.portals()[random.below(leafs.portals().len())].cells.map(|cell| names[cell.idx()]),
                false => [0; 2].map(|_| names[random.below(names.len())]),
            };
            names.iter_mut().filter(|name| **name == a).for_each(|name| *name = b);
        }
        Self::new(leafs, &names)
    }

    /// What clusters see if each sees what its leafs see, by a search among leafs. Pairs that are left undecided there are not seen.
    pub fn seen_by_leafs(&self, leafs: &ConvexVisibility) -> BitMatrix {
        let mut seen = BitMatrix::identity(self.graph.n_cells());
        for a in 0..self.of.len() {
            let is_open = |b: usize| leafs.undecided.contains(&[a.min(b) as u32, a.max(b) as u32]);
            leafs.cells.iter_ones(a).filter(|&b| !is_open(b)).for_each(|b| {
                seen.set(self.of[a] as usize, self.of[b] as usize, true);
            });
        }
        seen
    }

    /// The same clusters without the portals that have others of a cluster of theirs beyond their plane, wholly: an impostor, which takes
    /// clusters for convex.
    #[must_use]
    pub fn as_if_convex(&self) -> CellGraph<Convex> {
        let outwards = |cell: CellId| {
            let exits = self.graph.exits(cell).iter().map(|exit| (&self.graph.portal(exit.portal).shape, exit));
            exits.map(|(shape, exit)| if exit.forward { shape.clone() } else { shape.reversed() }).collect::<Vec<_>>()
        };
        let is_beyond = |plane: &Portal3, other: &Portal3| {
            let (n, o) = (plane.normal(), plane.corners()[0]);
            other.corners().iter().all(|p| (0..3).map(|k| n[k] * (p[k] - o[k])).sum::<f64>() > 1e-6)
        };
        let keeps = |cell: CellId, shape: &Portal3| !outwards(cell).iter().any(|other| is_beyond(shape, other));
        let portals = self.graph.portals().iter().map(|p| (p.cells, p.shape.clone()));
        let kept = portals.filter(|([a, b], shape)| keeps(*a, shape) && keeps(*b, &shape.reversed()));
        CellGraph::of_portals(self.graph.n_cells(), kept.collect())
    }
}

/// What cells see, exactly.
pub fn exact(graph: &CellGraph<Convex>) -> ConvexVisibility {
    let mut search = ConvexSearch::new(graph, ConvexOptions { fast: false, threads: 1 });
    search.run(None).expect("nobody cancels");
    search.finish()
}
