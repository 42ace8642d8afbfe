//! Portal files: the clusters of a map, the openings between them, and which leafs they are made of.
//!
//! Text, in pieces that whitespace divides; a carriage return is whitespace.
//!
//! ```text
//! PRT1     clusters portals           portal*
//! PRT2     leafs clusters portals     portal*  (leaf* -1){clusters}
//! PRT1-AM  clusters portals leafs     portal*  cluster{leafs}
//!          clusters portals           count{clusters}  portal*
//! PRT1     clusters portals faces     hinted*  face*
//! portal = points a b ("(" x y z ")"){points}
//! hinted = points a b hint ("(" x y z ")"){points}
//! face   = points cluster ("(" x y z ")"){points}
//! ```
//!
//! The fourth is of Half-Life: it begins with a number. The last is of Quake III. It begins as the first does, and the pieces behind
//! the two counts tell them apart ([`PrtDialect::Quake3`]).
//!
//! Behind the last piece nothing may follow: more would mean that a count is wrong, or that the file is of a
//! dialect that only begins alike.

mod dialect;
mod faces;
mod lexer;
mod orientation;
mod read;
mod write;

pub use dialect::{LeafList, PrtDialect};
pub use faces::SolidFace;
pub use read::{line_of_portal, parse_prt};
pub use write::write_prt;

use super::{LeafClusters, MAX_CLUSTERS};
use crate::error::{Malformed, Within, malformed};
use crate::point::{are_collinear, check_point};
use sightlines_cells::{CellGraph, CellId, Convex, Point3, Portal3};
use std::collections::HashSet;
use std::fmt::Display;
use std::ops::RangeInclusive;

/// How far the points of a portal may be from a plane, in map units, beside what doubles of their size cannot hold
/// (2^-44 of the largest).
///
/// Compilers round what they write: to 17 digits (ericw-tools), or to six decimals and, nearer than 0.001 to 0.05, to
/// whole numbers (id Software's and those that follow it). Rounding three coordinates by 0.05 each moves a point by
/// 0.09 and the plane of the others by as much at most; this is somewhat more.
pub const MAX_UNEVENNESS: f64 = 0.25;

/// How many points a portal may have.
pub const PORTAL_POINTS: RangeInclusive<usize> = 3..=64;

/// The clusters of a map and the portals between them, checked: there is a cluster, portals join two
/// clusters that exist, have 3 to 64 points and coordinates that predicates accept; if leafs are listed, each
/// is in one cluster; the points of a portal go round an area and are within [`MAX_UNEVENNESS`] of a plane, or lie on
/// one line. Their corners may turn inwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Prt {
    n_clusters: u32,
    portals: Vec<Record>,
    points: Vec<Point3>,
    leafs: Option<(LeafList, LeafClusters)>,
    /// In Quake III the hints of the portals, and the solid faces.
    faces: Option<(Vec<u32>, Vec<SolidFace>)>,
}

/// A portal, without its points: they end at `end`, and begin where those of the portal before end.
#[derive(Debug, Clone, PartialEq)]
struct Record {
    clusters: [u32; 2],
    end: usize,
}

fn beyond<T: Display>(found: impl Display, range: RangeInclusive<T>) -> Malformed {
    malformed!("{found} is not from {} to {}", range.start(), range.end())
}

/// An opening between two clusters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrtPortal<'p> {
    /// The clusters `a` and `b` that it joins; any order of numbers occurs.
    pub clusters: [u32; 2],
    /// Its 3 to 64 corners in turn, in scene units. Their right-hand normal points from `a` into `b`: seen from
    /// inside `b` they go round counter-clockwise.
    pub points: &'p [Point3],
}

impl PrtPortal<'_> {
    /// Whether all points lie on one line, exactly: nothing is seen through such a portal.
    pub fn is_degenerate(&self) -> bool {
        let first = self.points[0];
        let Some(&other) = self.points.iter().find(|&&p| p != first) else { return true };
        self.points.iter().all(|&p| are_collinear([first, other, p]))
    }
}

impl Prt {
    /// Clusters without portals, each of them one leaf: a `PRT1`.
    ///
    /// # Errors
    /// [`Malformed`] unless there are 1 to [`MAX_CLUSTERS`].
    pub fn new(n_clusters: u32) -> Result<Self, Malformed> {
        if !(1..=MAX_CLUSTERS).contains(&n_clusters) {
            return Err(beyond(n_clusters, 1..=MAX_CLUSTERS).within("the number of clusters"));
        }
        Ok(Self { n_clusters, portals: Vec::new(), points: Vec::new(), leafs: None, faces: None })
    }

    /// Adds a portal. Its points keep their order; coordinates nearer to zero than 2^-140 become zero.
    ///
    /// # Errors
    /// [`Malformed`] with the number of the portal; it is then not added.
    pub fn push_portal(&mut self, clusters: [u32; 2], points: &[Point3]) -> Result<(), Malformed> {
        let portal = self.portals.len();
        if !PORTAL_POINTS.contains(&points.len()) {
            let place = format_args!("the number of points of portal {portal}");
            return Err(beyond(points.len(), PORTAL_POINTS).within(place));
        }
        if let Some(&cluster) = clusters.iter().find(|&&c| c >= self.n_clusters) {
            let place = format_args!("a cluster of portal {portal}");
            return Err(beyond(cluster, 0..=self.n_clusters - 1).within(place));
        }
        if clusters[0] == clusters[1] {
            return Err(malformed!("portal {portal} joins cluster {} with itself", clusters[0]));
        }
        let before = self.points.len();
        for (point, &p) in points.iter().enumerate() {
            let checked = check_point(p).within(format_args!("portal {portal}, point {point}"));
            let checked = checked.inspect_err(|_| self.points.truncate(before))?;
            self.points.push(checked);
        }
        self.portals.push(Record { clusters, end: self.points.len() });
        let added = self.portal(portal);
        let largest = added.points.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let wrong = match Portal3::around(added.points).map(|shape| shape.unevenness()) {
            None if !added.is_degenerate() => {
                malformed!("portal {portal} is not a convex polygon: its points go round no area")
            }
            Some(by) if by > MAX_UNEVENNESS.max(largest * 2f64.powi(-44)) => {
                malformed!("portal {portal} is not flat: a point is {by:.3} units off the plane of the others")
            }
            _ => return Ok(()),
        };
        self.portals.pop();
        self.points.truncate(before);
        Err(wrong)
    }

    /// The same portals, but clusters are made of these leafs: a `PRT2`, a `PRT1-AM`, or the form of Half-Life.
    ///
    /// # Errors
    /// [`Malformed`] if a leaf is in a cluster that is not there, or if the leafs of clusters do not follow each other and the list is
    /// of their counts.
    pub fn with_leafs(mut self, list: LeafList, cluster_of_leaf: Vec<u32>) -> Result<Self, Malformed> {
        if let (LeafList::Counts, Some(k)) = (list, cluster_of_leaf.windows(2).position(|pair| pair[0] > pair[1])) {
            let (leaf, cluster) = (k + 1, cluster_of_leaf[k + 1]);
            return Err(malformed!("leaf {leaf} is of cluster {cluster}, and the leaf before it of a later one"));
        }
        self.faces = None;
        self.leafs = Some((list, LeafClusters::new(self.n_clusters, cluster_of_leaf)?));
        Ok(self)
    }

    /// How it is written.
    pub fn dialect(&self) -> PrtDialect {
        match (&self.leafs, &self.faces) {
            (_, Some(_)) => PrtDialect::Quake3,
            (None, None) => PrtDialect::Prt1,
            (Some((LeafList::PerCluster, _)), None) => PrtDialect::Prt2,
            (Some((LeafList::PerLeaf, _)), None) => PrtDialect::Prt1Am,
            (Some((LeafList::Counts, _)), None) => PrtDialect::HalfLife,
        }
    }

    /// Number of clusters, at least 1.
    pub fn n_clusters(&self) -> u32 {
        self.n_clusters
    }

    /// Number of portals; each is passed in both directions.
    pub fn n_portals(&self) -> usize {
        self.portals.len()
    }

    /// A portal.
    ///
    /// # Panics
    /// If there is no portal of that number.
    pub fn portal(&self, portal: usize) -> PrtPortal<'_> {
        let start = portal.checked_sub(1).map_or(0, |before| self.portals[before].end);
        let Record { clusters, end } = self.portals[portal];
        PrtPortal { clusters, points: &self.points[start..end] }
    }

    /// The portals, in the order of the file.
    pub fn portals(&self) -> impl ExactSizeIterator<Item = PrtPortal<'_>> {
        (0..self.portals.len()).map(|k| self.portal(k))
    }

    /// The leafs of the clusters, where the file lists them.
    pub fn listed_leafs(&self) -> Option<&LeafClusters> {
        self.leafs.as_ref().map(|(_, leafs)| leafs)
    }

    /// The leafs of the clusters; where the file does not list them, every leaf is a cluster.
    pub fn leaf_clusters(&self) -> LeafClusters {
        let identity = || LeafClusters::identity(self.n_clusters).expect("a Prt has 1 to MAX_CLUSTERS clusters");
        self.listed_leafs().cloned().unwrap_or_else(identity)
    }

    /// For each portal whether one before it joins the same clusters and has the same corners, whichever of them is the first and from whichever side they
    /// are seen. Once is enough: a line that passes the one passes the other, and a search would follow both. O(points).
    pub fn repeats(&self) -> Vec<bool> {
        let mut seen = HashSet::new();
        self.portals().map(|portal| !seen.insert(key(&portal))).collect()
    }

    /// Number of [repeats](Self::repeats).
    pub fn n_repeats(&self) -> usize {
        self.repeats().into_iter().filter(|&is_repeat| is_repeat).count()
    }
}

/// The same for equal portals: seen from the cluster with the larger number, beginning with the least corner.
fn key(portal: &PrtPortal<'_>) -> ([u32; 2], Vec<[u64; 3]>) {
    let [a, b] = portal.clusters;
    let mut corners: Vec<[u64; 3]> = portal.points.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    if a > b {
        corners.reverse();
    }
    let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or(0);
    corners.rotate_left(least);
    ([a.min(b), a.max(b)], corners)
}

/// The graph of clusters: cell `k` is cluster `k`. Portals without area are left out, as nothing is seen through
/// them, and so are [repeats](Prt::repeats); corners that convex polygons do not have are left out too, which only widens a portal. O(n log n).
pub fn graph_of_prt(prt: &Prt) -> CellGraph<Convex> {
    let shape = |points: &[_]| Portal3::around(points);
    let once = prt.portals().zip(prt.repeats()).filter(|(_, is_repeat)| !is_repeat).map(|(portal, _)| portal);
    let portals = once.filter_map(|p| Some((p.clusters.map(CellId), shape(p.points)?)));
    CellGraph::of_portals(prt.n_clusters() as usize, portals.collect())
}
