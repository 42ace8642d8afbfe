//! The scene of a table, as it is checked against.

use super::Error;
use crate::error::InputError;
use crate::input::refuse;
use crate::input::{self, Input};
use sightlines::bake::PrtBakeError;
use sightlines::cells::{CellGraph, Convex, Plan, Scene};
use sightlines::formats::Prt;
use sightlines::formats::quake::bsp::{BspChild, BspError};
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::quake::{Bsp, graph_of_prt, read_prt};
use sightlines::verify::{Truth, WorldChild, WorldFace, WorldNode, WorldTree};
use std::path::Path;

/// A scene that was read.
pub(super) enum Real {
    Plan(Plan),
    Scene(Scene),
    Portals(CellGraph<Convex>),
    Map(CellGraph<Convex>, WorldTree),
}

impl Real {
    /// Reads a scene of any kind; of a map also its portals.
    pub(super) fn read(path: &Path, map: Option<&str>, prt: Option<&Path>) -> Result<Self, Error> {
        let input = input::read(path, map)?;
        if !matches!(input, Input::Map(_)) {
            refuse(path, &[("--prt", prt.is_some())], "Quake maps", "none")?;
        }
        Ok(match input {
            Input::Plan(file) => Self::Plan(file.plan),
            Input::Scene(file) => Self::Scene(file.scene),
            Input::Portals(prt) => Self::Portals(graph_of_prt(&prt)),
            Input::Map(bsp) => {
                let named = prt.map_or_else(|| path.with_extension("prt"), Path::to_owned);
                if prt.is_none() && !named.exists() {
                    return Err(InputError::MapWithoutPortals(path.to_owned()).into());
                }
                let portals = read_prt(&named)?;
                let other_map = |source| InputError::OtherMap {
                    prt: named.clone(),
                    bsp: path.to_owned(),
                    source: Box::new(source),
                };
                check_portals(&bsp, &portals).map_err(other_map)?;
                let broken =
                    |error: BspError| Error::BakePrt { path: path.to_owned(), source: PrtBakeError::Bsp(error) };
                Self::Map(graph_of_prt(&portals), world(&bsp, &portals).map_err(broken)?)
            }
        })
    }

    /// The same without what is seen in it, for a table that says nothing of objects.
    pub(super) fn without_objects(self) -> Self {
        match self {
            Self::Plan(plan) => {
                Self::Plan(Plan::new(plan.lines().to_vec(), Vec::new()).expect("the lines are those of a plan"))
            }
            Self::Map(graph, tree) => {
                let listed = vec![Vec::new(); tree.listed.len()];
                Self::Map(graph, WorldTree { faces: Vec::new(), listed, ..tree })
            }
            other => other,
        }
    }

    pub(super) fn truth(&self) -> Truth<'_> {
        match self {
            Self::Plan(plan) => Truth::Plan(plan),
            Self::Scene(scene) => Truth::Scene(scene),
            Self::Portals(graph) => Truth::Portals(graph),
            Self::Map(graph, tree) => Truth::World(graph, tree),
        }
    }
}

/// The tree of a map, with the cluster of each leaf, and its faces.
fn world(bsp: &Bsp, prt: &Prt) -> Result<WorldTree, BspError> {
    let (tree, faces, lists) = (bsp.world_tree()?, bsp.world_faces()?, bsp.leaf_faces()?);
    let of_leaf = prt.leaf_clusters();
    // Portal files count leafs from 0, maps from 1, and their leaf 0 is what is solid.
    let cluster = |leaf: u32| match (bsp.format().has_clusters(), leaf.checked_sub(1)) {
        (true, _) => bsp.leafs().get(leaf as usize).and_then(|leaf| leaf.cluster()).map(u32::from),
        (false, Some(leaf)) => of_leaf.cluster_of_leaf().get(leaf as usize).copied(),
        (false, None) => None,
    };
    let child = |child: BspChild| match child {
        BspChild::Node(node) => WorldChild::Node(node),
        BspChild::Leaf(leaf) => cluster(leaf).map_or(WorldChild::Solid, WorldChild::Cluster),
    };
    let nodes = tree
        .nodes()
        .iter()
        .map(|n| WorldNode { normal: n.normal, distance: n.distance, children: n.children.map(child) })
        .collect();
    let first = faces.range().start;
    let face =
        |k: usize| WorldFace { name: format!("face {}", first as usize + k), corners: faces.corners(k).to_vec() };
    let mut listed = vec![Vec::new(); prt.n_clusters() as usize];
    for leaf in 0..lists.n_leafs() {
        if let Some(list) = cluster(leaf as u32 + 1).and_then(|cluster| listed.get_mut(cluster as usize)) {
            list.extend(lists.of(leaf).iter().filter(|face| faces.range().contains(face)).map(|face| face - first));
        }
    }
    listed.iter_mut().for_each(|list: &mut Vec<u32>| {
        list.sort_unstable();
        list.dedup();
    });
    Ok(WorldTree { nodes, faces: (0..faces.n_faces()).map(face).collect(), listed })
}
