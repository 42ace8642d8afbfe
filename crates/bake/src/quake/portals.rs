//! Portals of a map that has no portal file, from its tree of planes.
//!
//! The leafs of the tree are the clusters; where two of them meet is decided exactly ([`sightlines_bsp::openings`]). What is solid closes an
//! opening only where opaque faces of the map cover it: some compilers store brushes as solid that eyes see through, such as fences and
//! brushes without drawn sides. Such holes lead into what is solid, and what is solid between two rooms with holes is a *passage*: a
//! cluster without leafs behind the others, of which nothing is known but its holes, so that every line through two of them counts. The sky is
//! closed like what is solid. Liquids are seen through, as many engines draw them so.

use super::covered::{Covers, is_sliver};
use rayon::prelude::*;
use sightlines_bsp::{Child, Node, Opening, Plane, Region, Tree, TreeError, openings};
use sightlines_formats::Malformed;
use sightlines_formats::quake::bsp::{BspChild, BspTree, LeafKind};
use sightlines_formats::quake::prt::{LeafList, PORTAL_POINTS};
use sightlines_formats::quake::{Bsp, Prt};
use sightlines_geometry::Point3;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// The cube in which leafs are looked for is as large as twice the largest distance of a plane and twice the bounds of the leafs, and at least this.
const LEAST_SIZE: f64 = 65536.0;
/// The largest distance of a plane, in map units.
const MOST_DISTANCE: f64 = 1_073_741_824.0;

/// Portals made from a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPortals {
    /// The portals. Clusters are the visible leafs of the map, or in Quake II its clusters; behind them come passages.
    pub prt: Prt,
    /// Number of passages: clusters without leafs, for what is solid and can be seen through.
    pub n_passages: u32,
}

/// Why no portals can be made from a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PortalsError {
    /// The tree, the faces or their textures cannot be read.
    #[error(transparent)]
    Bsp(#[from] Malformed),
    /// The map has no leafs that can be seen, or too many; or a portal is beyond what portal files hold.
    #[error(transparent)]
    Prt(Malformed),
    /// A plane has no normal, or is farther from the origin than 2^30 map units.
    #[error("node {node} of the map: its plane has no normal, or a distance of {distance}")]
    Plane {
        /// The node, as the file counts them.
        node: u32,
        /// The distance.
        distance: f64,
    },
    /// The nodes are not a tree.
    #[error("the map's tree: {0}")]
    Tree(#[from] TreeError),
    /// The planes of the tree cut each other so often that it is none of a map.
    #[error("the map's tree takes more cuts, or has more openings, than {n_nodes} nodes of a map explain")]
    TooManyCuts {
        /// Its nodes.
        n_nodes: usize,
    },
}

/// Makes the portals of a map from its tree of planes. O(nodes × some hundred + openings × faces of their plane); parallel, the same for any number of threads.
///
/// Corners of portals are rounded outwards. Nothing of an opening is left out, however small, so there may be slivers that compilers drop.
/// Detail brushes, which compilers leave out of their portals, are solid here: less is visible.
///
/// # Errors
/// [`PortalsError`] with the place in the map.
pub fn portals_of_map(bsp: &Bsp) -> Result<MapPortals, PortalsError> {
    let source = bsp.world_tree()?;
    let (tree, size) = tree_of(bsp, &source)?;
    let n_clusters = if bsp.format().has_clusters() { bsp.n_clusters() } else { bsp.n_visible_leafs() } as u32;
    Prt::new(n_clusters).map_err(PortalsError::Prt)?;
    let places = Places { bsp, n_clusters };
    let all = openings(&tree, size, |_| true);
    let all = all.ok_or(PortalsError::TooManyCuts { n_nodes: tree.nodes().len() })?;
    let covered = covered(bsp, &source, &places, &all)?;
    let passages = Passages::new(&places, &all, &covered);

    let mut prt = Prt::new(n_clusters + passages.n).map_err(PortalsError::Prt)?;
    for (opening, _) in all.iter().zip(&covered).filter(|(_, is_covered)| !**is_covered) {
        let cluster = |k: usize| places.cluster(opening.regions[k]);
        let passage = |k: usize| passages.of_region.get(&opening.regions[k]).map(|k| n_clusters + k);
        let pair = match places.between(opening.regions) {
            Between::Inside => continue,
            // A leaf that the map has no cluster for is part of a passage.
            Between::Open => [0, 1].map(|k| cluster(k).or_else(|| passage(k))),
            Between::DrawnFrom(side) => {
                let (room, hole) = (cluster(side).or_else(|| passage(side)), passage(1 - side));
                if side == 0 { [room, hole] } else { [hole, room] }
            }
        };
        // Seen from in front, corners go round counter-clockwise: so does a portal's from inside its second cluster.
        if let [Some(front), Some(back)] = pair
            && front != back
        {
            for piece in pieces(&opening.corners) {
                prt.push_portal([back, front], &piece).map_err(PortalsError::Prt)?;
            }
        }
    }
    // Clusters without leafs; what Quake II calls clusters are the leafs of such a file.
    if passages.n > 0 {
        prt = prt.with_leafs(LeafList::PerCluster, (0..n_clusters).collect()).map_err(PortalsError::Prt)?;
    }
    Ok(MapPortals { prt, n_passages: passages.n })
}

/// A convex polygon in parts of no more corners than a portal may have.
fn pieces(corners: &[Point3]) -> Vec<Vec<Point3>> {
    let most = *PORTAL_POINTS.end();
    if corners.len() <= most {
        return vec![corners.to_vec()];
    }
    // Fans around the first corner, each beginning where the one before ends.
    let starts = (1..corners.len() - 1).step_by(most - 2);
    starts.map(|k| [&corners[..1], &corners[k..corners.len().min(k + most - 1)]].concat()).collect()
}

/// The tree, and the size of a cube that has all of the map.
fn tree_of(bsp: &Bsp, source: &BspTree) -> Result<(Tree, f64), PortalsError> {
    let mut size = LEAST_SIZE;
    let bounds = bsp.leafs().iter().flat_map(|leaf| [leaf.mins, leaf.maxs]).flatten().map(|x| f64::from(x).abs());
    let farthest = bounds.filter(|x| *x <= MOST_DISTANCE).fold(0.0, f64::max);
    while size < 2.0 * farthest {
        size *= 2.0;
    }
    let mut nodes = Vec::with_capacity(source.nodes().len());
    for node in source.nodes() {
        let distance = node.distance;
        if distance.abs() > MOST_DISTANCE {
            return Err(PortalsError::Plane { node: node.index, distance });
        }
        while size < 2.0 * distance.abs() {
            size *= 2.0;
        }
        let children = node.children.map(|child| match child {
            BspChild::Node(at) => Child::Node(at),
            BspChild::Leaf(leaf) => Child::Leaf(leaf),
        });
        nodes.push(Node { plane: Plane { normal: node.normal, distance }, children });
    }
    Ok((Tree::new(nodes)?, size))
}

/// What the regions of a map's tree are.
struct Places<'b> {
    bsp: &'b Bsp,
    n_clusters: u32,
}

impl Places<'_> {
    fn kind(&self, region: Region) -> LeafKind {
        self.bsp.leafs()[region.leaf as usize].kind(self.bsp.format())
    }

    /// The cluster of a region, unless it is solid or nowhere.
    fn cluster(&self, region: Region) -> Option<u32> {
        if self.kind(region) == LeafKind::Solid {
            return None;
        }
        let cluster = match self.bsp.format().has_clusters() {
            true => self.bsp.leafs()[region.leaf as usize].cluster().map(u32::from),
            false => region.leaf.checked_sub(1),
        };
        cluster.filter(|&cluster| cluster < self.n_clusters)
    }

    /// What is on the two sides of an opening.
    fn between(&self, regions: [Region; 2]) -> Between {
        match regions.map(|region| self.kind(region)) {
            [LeafKind::Open, LeafKind::Open] | [LeafKind::Sky, LeafKind::Sky] => Between::Open,
            [LeafKind::Open, _] => Between::DrawnFrom(0),
            [_, LeafKind::Open] => Between::DrawnFrom(1),
            _ => Between::Inside,
        }
    }
}

/// What is on the two sides of an opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    /// Air on both sides.
    Open,
    /// Something closed, and air on this side: 0 in front, 1 behind.
    DrawnFrom(usize),
    /// Something closed on both sides: faces are not drawn there.
    Inside,
}

/// For each opening whether faces cover it.
fn covered(bsp: &Bsp, tree: &BspTree, places: &Places<'_>, all: &[Opening]) -> Result<Vec<bool>, PortalsError> {
    let (faces, kinds) = (bsp.world_faces()?, bsp.face_covers()?);
    // Where faces name no planes, what is solid is closed.
    let Some(kinds) = kinds else {
        return Ok(all.iter().map(|opening| places.between(opening.regions) != Between::Open).collect());
    };
    let covers = Covers::new(kinds.into_iter().enumerate().map(|(k, cover)| (cover, faces.corners(k))));
    let is_covered = |opening: &Opening| {
        let node = &tree.nodes()[opening.node as usize];
        let from = |side: usize| covers.cover((node.normal, node.distance), side, &opening.corners);
        match places.between(opening.regions) {
            Between::Open => false,
            Between::DrawnFrom(side) => is_sliver(node.normal, &opening.corners) || from(side),
            Between::Inside => from(0) || from(1),
        }
    };
    Ok(all.par_iter().map(is_covered).collect())
}

/// Ways through what is solid.
struct Passages {
    /// The passage that a region is part of: solid, sky, or a pocket.
    of_region: HashMap<Region, u32>,
    n: u32,
}

impl Passages {
    /// Finds what leads from one cluster that has faces to another through holes. Leafs that no opening joins to any leaf with faces are
    /// pockets inside of what is solid: compilers leave many, and do not draw them.
    fn new(places: &Places<'_>, all: &[Opening], covered: &[bool]) -> Self {
        let is_room = rooms(places, all);
        let is_room = |region: Region| {
            places.kind(region) == LeafKind::Open && places.cluster(region).is_some() && is_room[region.leaf as usize]
        };
        // What is inside of the solid, with the openings between, and those to rooms.
        let mut ways: HashMap<Region, Vec<Region>> = HashMap::new();
        let mut holes: BTreeMap<Region, BTreeSet<u32>> = BTreeMap::new();
        for (opening, _) in all.iter().zip(covered).filter(|(_, is_covered)| !**is_covered) {
            for (here, there) in [(0, 1), (1, 0)].map(|(i, j)| (opening.regions[i], opening.regions[j])) {
                match (is_room(here), is_room(there)) {
                    (true, _) => {}
                    (false, true) => holes.entry(here).or_default().extend(places.cluster(there)),
                    (false, false) => ways.entry(here).or_default().push(there),
                }
            }
        }
        let (mut passages, mut met) = (Self { of_region: HashMap::new(), n: 0 }, HashSet::new());
        for &start in holes.keys() {
            if !met.insert(start) {
                continue;
            }
            let (mut group, mut at, mut reached) = (vec![start], 0, BTreeSet::<u32>::new());
            while let Some(&region) = group.get(at) {
                reached.extend(holes.get(&region).into_iter().flatten());
                let next = ways.get(&region).into_iter().flatten().copied();
                group.extend(next.filter(|&region| met.insert(region)));
                at += 1;
            }
            // What leads back into one cluster shows nothing new.
            if reached.len() > 1 {
                passages.of_region.extend(group.into_iter().map(|region| (region, passages.n)));
                passages.n += 1;
            }
        }
        passages
    }
}

/// For each leaf whether openings join it to a leaf with faces.
fn rooms(places: &Places<'_>, all: &[Opening]) -> Vec<bool> {
    let leafs = places.bsp.leafs();
    let mut next: Vec<Vec<u32>> = vec![Vec::new(); leafs.len()];
    for opening in all.iter().filter(|opening| places.between(opening.regions) == Between::Open) {
        let [a, b] = opening.regions.map(|region| region.leaf);
        next[a as usize].push(b);
        next[b as usize].push(a);
    }
    let mut is_room: Vec<bool> = leafs.iter().map(|leaf| leaf.n_faces > 0).collect();
    let mut open: Vec<usize> = (0..leafs.len()).filter(|&leaf| is_room[leaf]).collect();
    while let Some(leaf) = open.pop() {
        for &other in &next[leaf] {
            if !std::mem::replace(&mut is_room[other as usize], true) {
                open.push(other as usize);
            }
        }
    }
    is_room
}
