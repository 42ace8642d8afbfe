//! Doors: portals that open and close.

use crate::asset::PvsTable;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use sightlines_pvs::PortalId;
use std::collections::BTreeSet;

/// A door: while it is shut, nothing is seen through its portals.
///
/// That holds for the methods that follow portals ([`PvsMethod::ConnectedComponent`](crate::PvsMethod::ConnectedComponent) and those after
/// it) and for every camera whose table has these portals. A door that is shut has to fill its opening: what can be seen past it or
/// through it would be hidden.
#[derive(Component, Debug, Clone, PartialEq, Reflect)]
#[reflect(Component, Clone, PartialEq)]
pub struct PvsDoor {
    /// Which portals.
    pub way: PvsDoorway,
    /// Whether they can be seen through.
    pub is_open: bool,
}

/// The portals of a door.
#[derive(Debug, Clone, PartialEq, Reflect)]
#[reflect(Clone, PartialEq)]
pub enum PvsDoorway {
    /// Those of the doors of this name, of which the table knows the portals: of leaves that were named or marked as doors in the file, and of
    /// those that `sightlines build --door` was given.
    Name(String),
    /// These, by number.
    Portals(Vec<u32>),
    /// Those that lie within a box, in the coordinates of the scene as its file has them.
    Within {
        /// Lower corner.
        min: Vec3,
        /// Upper corner.
        max: Vec3,
    },
}

impl PvsDoor {
    /// A door that is open, by its name in the table.
    pub fn named(name: impl Into<String>) -> Self {
        Self { way: PvsDoorway::Name(name.into()), is_open: true }
    }

    /// The same door, shut.
    #[must_use]
    pub fn shut(self) -> Self {
        Self { is_open: false, ..self }
    }

    /// A door that is open, by the numbers of its portals.
    pub fn portals(portals: impl IntoIterator<Item = u32>) -> Self {
        Self { way: PvsDoorway::Portals(portals.into_iter().collect()), is_open: true }
    }

    /// A door that is open, of the portals within a box.
    pub const fn within(min: Vec3, max: Vec3) -> Self {
        Self { way: PvsDoorway::Within { min, max }, is_open: true }
    }
}

/// How often doors have changed.
#[derive(Resource, Debug, Default)]
pub(crate) struct DoorVersion(u64);

/// Notes whether doors have changed.
pub(crate) fn note_doors(
    mut version: ResMut<DoorVersion>,
    changed: Query<(), Changed<PvsDoor>>,
    mut gone: RemovedComponents<PvsDoor>,
) {
    let is_less = gone.read().count() > 0;
    version.0 += u64::from(is_less || !changed.is_empty());
}

/// All doors.
#[derive(SystemParam)]
pub(crate) struct Doorways<'w, 's> {
    version: Res<'w, DoorVersion>,
    doors: Query<'w, 's, &'static PvsDoor>,
}

impl Doorways<'_, '_> {
    /// Changes when a door does.
    pub(crate) fn version(&self) -> u64 {
        self.version.0
    }

    /// The portals of a table that are shut.
    pub(crate) fn closed(&self, table: &PvsTable) -> BTreeSet<PortalId> {
        let mut closed = BTreeSet::new();
        for door in self.doors.iter().filter(|door| !door.is_open) {
            match &door.way {
                PvsDoorway::Name(name) => {
                    let named = table.doors().iter().filter(|record| record.name == *name);
                    closed.extend(named.flat_map(|record| record.portals.iter().copied()));
                }
                PvsDoorway::Portals(portals) => closed.extend(portals.iter().copied().map(PortalId)),
                PvsDoorway::Within { min, max } => {
                    closed.extend(table.portals_within(min.to_array().map(f64::from), max.to_array().map(f64::from)));
                }
            }
        }
        closed
    }
}
