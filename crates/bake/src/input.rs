//! What can be baked.

use sightlines_cells::{Plan, Scene};
use sightlines_formats::quake::{Bsp, Prt};
use sightlines_formats::{SceneFile, SceneInfo};

/// An input of a bake, borrowed.
#[derive(Debug, Clone, Copy)]
pub enum BakeInput<'a> {
    /// A plan: a floor plan, or a map of Doom.
    Plan(&'a Plan),
    /// A scene in space, with the axes and units that its file states, if it came from one.
    Scene(&'a Scene, Option<&'a SceneInfo>),
    /// The portal file of a Quake map alone: its cells are the clusters, at unknown places.
    Portals(&'a Prt),
    /// A Quake map with its portal file.
    Map(&'a Bsp, &'a Prt),
}

impl<'a> From<&'a Plan> for BakeInput<'a> {
    fn from(plan: &'a Plan) -> Self {
        Self::Plan(plan)
    }
}

impl<'a> From<&'a Scene> for BakeInput<'a> {
    fn from(scene: &'a Scene) -> Self {
        Self::Scene(scene, None)
    }
}

impl<'a> From<&'a SceneFile> for BakeInput<'a> {
    fn from(file: &'a SceneFile) -> Self {
        Self::Scene(&file.scene, Some(&file.info))
    }
}

impl<'a> From<&'a Prt> for BakeInput<'a> {
    fn from(prt: &'a Prt) -> Self {
        Self::Portals(prt)
    }
}

impl<'a> From<(&'a Bsp, &'a Prt)> for BakeInput<'a> {
    fn from((bsp, prt): (&'a Bsp, &'a Prt)) -> Self {
        Self::Map(bsp, prt)
    }
}
