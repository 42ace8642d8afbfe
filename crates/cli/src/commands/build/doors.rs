//! Doors that are given as boxes, and what they close.

use crate::doors::DoorArg;
use crate::error::{Result, anyhow};
use crate::output::{JsonSchema, Serialize, count};
use sightlines::bake::{Bakeable, Baked};
use sightlines::pvs::{DoorBox, DoorRecord, Table};
use std::fmt;
use std::path::Path;

/// Refuses doors whose boxes have another dimension than what is baked.
pub(super) fn check(path: &Path, content: &Bakeable, given: &[DoorArg]) -> Result<()> {
    let needed = if matches!(content, Bakeable::Plan { .. }) { 2 } else { 3 };
    match given.iter().find(|door| door.n_dimensions != needed) {
        None => Ok(()),
        Some(DoorArg { door, n_dimensions }) => Err(anyhow!(
            "{}: the box of the door {:?} has {} numbers: here it needs {}",
            path.display(),
            door.name,
            2 * n_dimensions,
            2 * needed
        )),
    }
}

/// Adds doors to the table of what was baked from `path`. Warns of those that close nothing.
pub(super) fn add(path: &Path, baked: Baked, given: &[DoorArg]) -> (Baked, Vec<GivenDoor>) {
    let Baked { graph, table, report } = baked;
    let n_own = table.doors().len();
    let boxes: Vec<DoorBox> = given.iter().map(|given| given.door.clone()).collect();
    let table = table.with_door_boxes(&boxes);
    let added = &table.doors()[n_own..];
    added.iter().filter(|door| door.portals.is_empty()).for_each(|door| warn(path, &door.name, &table));
    let facts = added.iter().map(GivenDoor::new).collect();
    (Baked { graph, table, report }, facts)
}

/// Warns of a door that closes nothing, and says why.
fn warn(path: &Path, name: &str, table: &Table) {
    let path = path.display();
    if table.portals().is_empty() {
        tracing::warn!(
            "{path}: the door {name:?} closes nothing: the cells have no portals; --method sightlines without given cells cuts cells that have some"
        );
        return;
    }
    let gap = table.frame().map_or(String::new(), |frame| {
        let wider = 3.0f64.sqrt() * frame.gap();
        format!("; as the table stands along axes of its own, it has to reach {wider:.1e} beyond them")
    });
    tracing::warn!("{path}: the door {name:?} closes nothing: no portal is wholly within its box{gap}");
}

/// A door that was given as a box.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct GivenDoor {
    /// Its name; names may repeat.
    name: String,
    /// The portals that it closes.
    portals: Vec<u32>,
}

impl GivenDoor {
    fn new(record: &DoorRecord) -> Self {
        Self { name: record.name.clone(), portals: record.portals.iter().map(|portal| portal.0).collect() }
    }
}

impl fmt::Display for GivenDoor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let portals = count(self.portals.len() as u64, "portal");
        writeln!(f, "given door     {:?}, open; closes {portals} when shut", self.name)
    }
}
