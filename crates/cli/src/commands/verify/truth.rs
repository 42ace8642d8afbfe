//! The scene of a table, as it is checked against.

use super::Error;
use crate::error::InputError;
use crate::input::refuse;
use crate::input::{self, Input};
use sightlines::bake::PrtBakeError;
use sightlines::cells::{CellGraph, Convex, Plan, Scene};
use sightlines::formats::quake::bsp::BspError;
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::quake::{graph_of_prt, read_prt};
use sightlines::verify::{Truth, WorldTree};
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
                Self::Map(graph_of_prt(&portals), WorldTree::of_map(&bsp, &portals).map_err(broken)?)
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
