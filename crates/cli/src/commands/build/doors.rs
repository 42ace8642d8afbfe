//! Doors that are given as boxes, and what they close.

use crate::doors::DoorBox;
use crate::error::{Result, anyhow};
use crate::output::{JsonSchema, Serialize, count};
use sightlines::bake::{Bakeable, Baked};
use sightlines::pvs::{DoorRecord, Table};
use std::fmt;
use std::path::Path;

/// Refuses doors whose boxes have another dimension than what is baked.
pub(super) fn check(path: &Path, content: &Bakeable, given: &[DoorBox]) -> Result<()> {
    let dimension = if matches!(content, Bakeable::Plan { .. }) { 2 } else { 3 };
    match given.iter().find(|door| door.n_dimensions() != dimension) {
        None => Ok(()),
        Some(door) => {
            let (path, name) = (path.to_owned(), door.name.clone());
            Err(anyhow!(
                "{}: the box of the door {name:?} has {found} numbers: here it needs {needed}",
                path.display(),
                found = 2 * door.n_dimensions(),
                needed = 2 * dimension
            ))
        }
    }
}

/// Adds doors to the table of what was baked from `path`. Warns of those that close nothing.
pub(super) fn add(path: &Path, baked: Baked, given: &[DoorBox]) -> (Baked, Vec<GivenDoor>) {
    if given.is_empty() {
        return (baked, Vec::new());
    }
    let Baked { graph, table, report } = baked;
    let mut doors = table.doors().to_vec();
    let records: Vec<DoorRecord> = given.iter().map(|door| record(path, door, &table)).collect();
    let facts = records.iter().map(GivenDoor::new).collect();
    doors.extend(records);
    let table = table.with_doors(doors).expect("the portals within a box are portals of the table, ascending");
    (Baked { graph, table, report }, facts)
}

fn record(path: &Path, door: &DoorBox, table: &Table) -> DoorRecord {
    let [min, max] = door.corners();
    let portals = table.portals_within(min, max);
    let (path, name) = (path.display(), &door.name);
    if table.portals().is_empty() {
        tracing::warn!(
            "{path}: the door {name:?} closes nothing: the cells have no portals; --method sightlines without given cells cuts cells that have some"
        );
    } else if portals.is_empty() {
        let gap = table.frame().map_or(String::new(), |frame| {
            let wider = 3.0f64.sqrt() * frame.gap();
            format!("; as the table stands along axes of its own, it has to reach {wider:.1e} beyond them")
        });
        tracing::warn!("{path}: the door {name:?} closes nothing: no portal is wholly within its box{gap}");
    }
    DoorRecord { name: door.name.clone(), object: None, portals }
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
