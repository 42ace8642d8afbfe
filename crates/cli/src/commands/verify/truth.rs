//! The scene that a table is checked against.

use super::own::JUDGED_FOR;
use crate::error::{ErrorAbout, Result};
use crate::input::{self, refuse};
use crate::map_portals::{do_not_fit, portals_for};
use sightlines::bake::{Bakeable, Gap, stated_gap};
use sightlines::cells::{CellGraph, Convex, Plan, Scene};
use sightlines::formats::quake::graph_of_prt;
use sightlines::formats::quake::visibility::check_portals;
use sightlines::formats::scene::SceneReadOptions;
use sightlines::formats::{Input, InputKind, PlanReadOptions};
use sightlines::pvs::Table;
use sightlines::verify::{MapTree, Truth, VerifyError, along_frame};
use std::path::Path;

/// A scene that was read.
pub(super) enum Real {
    Plan(Plan),
    /// With the triangles of the file that the scene does not have.
    Scene(Scene, Vec<[u32; 2]>),
    Portals(CellGraph<Convex>),
    Map(CellGraph<Convex>, MapTree),
}

impl Real {
    /// The triangles of the file of a scene that the scene does not have.
    pub(super) fn left_out(&self) -> &[[u32; 2]] {
        if let Self::Scene(_, left_out) = self { left_out } else { &[] }
    }

    pub(super) fn read(
        path: &Path,
        map: Option<&str>,
        prt: Option<&Path>,
        (options, plan): (&SceneReadOptions, &PlanReadOptions),
    ) -> Result<Self> {
        let input = input::read(path, map, options, plan)?;
        let portals = match &input {
            Input::Bsp(bsp) => Some(portals_for(bsp, path, prt)?),
            _ => None,
        };
        if portals.is_none() {
            refuse(path, &[("--prt", prt.is_some())], "Quake maps", "none")?;
        }
        let (file, portals) = portals.map(|portals| (portals.path, portals.prt)).unzip();
        Ok(match input::bakeable(path, input, map, portals)? {
            Bakeable::Plan { plan, .. } => Self::Plan(plan),
            Bakeable::Scene(file) => Self::Scene(file.scene, file.info.left_out_triangles),
            Bakeable::Portals(prt) => Self::Portals(graph_of_prt(&prt)),
            Bakeable::Map(bsp, portals) => {
                let file = file.unwrap_or_default();
                check_portals(&bsp, &portals).map_err(|source| do_not_fit(&file, path, &source))?;
                Self::Map(graph_of_prt(&portals), MapTree::of_map(&bsp, &portals).in_file(path)?)
            }
        })
    }

    /// What every engine shows of a map of a WAD; others as they are.
    pub(super) fn for_every_engine(self, path: &Path, name: Option<&str>) -> Result<Self> {
        if input::kind_of(path)? != Some(InputKind::Wad) {
            return Ok(self);
        }
        Ok(Self::Plan(input::doom(path, name)?.plan_for(JUDGED_FOR)?))
    }

    /// The same without objects, for a table that has none.
    pub(super) fn without_objects(self) -> Self {
        match self {
            Self::Plan(plan) => {
                let gap = plan.gap();
                let plan = Plan::new(plan.lines().to_vec(), Vec::new()).and_then(|plan| plan.joined(gap));
                Self::Plan(plan.expect("the lines and the gap are those of a plan"))
            }
            Self::Map(graph, tree) => {
                let listed = vec![Vec::new(); tree.listed.len()];
                Self::Map(graph, MapTree { faces: Vec::new(), listed, ..tree })
            }
            other => other,
        }
    }

    /// The same with walls of a plan joined as for a table.
    pub(super) fn joined_for(self, path: &Path, table: &Table) -> Result<Self> {
        match self {
            Self::Plan(plan) => Ok(Self::Plan(plan.joined(stated_gap(table)).in_file(path)?)),
            other => Ok(other),
        }
    }

    /// The gap within which walls of a plan were joined; 0 for others.
    pub(super) const fn gap(&self) -> f64 {
        match self {
            Self::Plan(plan) => plan.gap(),
            _ => 0.0,
        }
    }

    /// The table without its frame, and the scene along its axes; none if the table has none.
    pub(super) fn along(&self, table: &Table) -> Result<Option<(Table, Self)>, VerifyError> {
        match self {
            Self::Scene(scene, left_out) if table.dimension() == 3 => {
                Ok(along_frame(table, scene)?.map(|(table, scene)| (table, Self::Scene(scene, left_out.clone()))))
            }
            _ => Ok(None),
        }
    }

    /// How many times what single precision explains in a scene the gap of a table is, if that is much.
    pub(super) fn times_too_wide(&self, gap: f64) -> Option<f64> {
        match self {
            Self::Scene(scene, _) => Gap::times_too_wide(scene, gap),
            _ => None,
        }
    }

    pub(super) fn truth(&self) -> Truth<'_> {
        match self {
            Self::Plan(plan) => Truth::Plan(plan),
            Self::Scene(scene, _) => Truth::Scene(scene),
            Self::Portals(graph) => Truth::Portals(graph),
            Self::Map(graph, tree) => Truth::World(graph, tree),
        }
    }
}
