//! Doors that are given as boxes, and what they close.

use super::Error;
use crate::doors::DoorBox;
use serde::Serialize;
use sightlines::bake::Baked;
use sightlines::pvs::{DoorRecord, Table};
use std::fmt;
use std::path::Path;

/// Adds doors to the table of what was baked from `path`. Warns of those that close nothing.
pub(super) fn add(path: &Path, baked: Baked, given: &[DoorBox]) -> Result<(Baked, Vec<GivenDoor>), Error> {
    if given.is_empty() {
        return Ok((baked, Vec::new()));
    }
    let Baked { graph, table, report } = baked;
    let mut doors = table.doors().to_vec();
    let records: Vec<DoorRecord> = given.iter().map(|door| record(path, door, &table)).collect::<Result<_, _>>()?;
    let facts = records.iter().map(GivenDoor::new).collect();
    doors.extend(records);
    let table = table.with_doors(doors).expect("the portals within a box are portals of the table, ascending");
    Ok((Baked { graph, table, report }, facts))
}

fn record(path: &Path, door: &DoorBox, table: &Table) -> Result<DoorRecord, Error> {
    let (found, dimension) = (door.n_dimensions(), usize::from(table.dimension()));
    if found != dimension {
        let (path, name) = (path.to_owned(), door.name.clone());
        return Err(Error::DoorDimension { path, name, found: 2 * found, needed: 2 * dimension });
    }
    let [min, max] = door.corners();
    let portals = table.portals_within(min, max);
    let (path, name) = (path.display(), &door.name);
    if table.portals().is_empty() {
        tracing::warn!("{path}: the door {name:?} closes nothing: the cells have no portals");
    } else if portals.is_empty() {
        let gap = table.frame().map_or(String::new(), |frame| {
            let wider = 3.0f64.sqrt() * frame.gap();
            format!("; as the table stands along axes of its own, it has to reach {wider:.1e} beyond them")
        });
        tracing::warn!("{path}: the door {name:?} closes nothing: no portal is wholly within its box{gap}");
    }
    Ok(DoorRecord { name: door.name.clone(), object: None, portals })
}

/// A door that was given as a box.
#[derive(Debug, Serialize)]
pub(super) struct GivenDoor {
    name: String,
    portals: Vec<u32>,
}

impl GivenDoor {
    fn new(record: &DoorRecord) -> Self {
        Self { name: record.name.clone(), portals: record.portals.iter().map(|portal| portal.0).collect() }
    }
}

impl fmt::Display for GivenDoor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "given door     {:?}, open; closes {} portals when shut", self.name, self.portals.len())
    }
}
