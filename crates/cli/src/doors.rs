//! Doors and closed portals as arguments.

use crate::error::{Result, bail};
use crate::numbers::coordinates;
use crate::region::refuse_reversed;
use sightlines::eye_to_cell::Doors;
use sightlines::pvs::{DoorId, DoorRecord, PortalId, doors_named};
use std::collections::BTreeSet;
use std::path::Path;
use std::str::FromStr;

/// What makes the rest a name, whatever it looks like.
const PREFIX: &str = "door:";
/// How many names an error lists.
const MOST_NEAR: usize = 3;

fn listed(near: &[String]) -> String {
    if near.is_empty() {
        return "the table has no doors".to_owned();
    }
    let names: Vec<String> = near.iter().map(|name| format!("{name:?}")).collect();
    format!("the nearest names are {}", names.join(", "))
}

/// Closes what a text names: portals by their numbers and doors by their names, separated by commas. All doors of a name are shut. A
/// text that is the name of a door as a whole is that door, commas or not; what follows `door:` is a name, even if it is a number.
pub(crate) fn close(text: &str, doors: &[DoorRecord], n_portals: usize, path: &Path, closed: &mut Doors) -> Result<()> {
    let is_number = text.parse::<u32>().is_ok();
    let whole = text.strip_prefix(PREFIX).filter(|name| doors_named(doors, name).next().is_some());
    let whole = whole.or_else(|| Some(text).filter(|name| !is_number && doors_named(doors, name).next().is_some()));
    if let Some(name) = whole {
        return shut(name, doors, path, closed);
    }
    for part in text.split(',') {
        match (part.strip_prefix(PREFIX), part.trim().parse::<u32>()) {
            (Some(name), _) => shut(name, doors, path, closed)?,
            (None, Ok(portal)) if portal as usize >= n_portals => {
                bail!("{}: there is no portal {portal}: the table has {n_portals} portals", path.display());
            }
            (None, Ok(portal)) => _ = closed.close(PortalId(portal)),
            (None, Err(_)) => shut(part, doors, path, closed)?,
        }
    }
    Ok(())
}

fn shut(name: &str, doors: &[DoorRecord], path: &Path, closed: &mut Doors) -> Result<()> {
    let ids: Vec<DoorId> = doors_named(doors, name).collect();
    if ids.is_empty() {
        let near = nearest(name, doors.iter().map(|door| door.name.as_str()));
        bail!("{}: there is no door called {name:?}: {}", path.display(), listed(&near));
    }
    ids.into_iter().for_each(|door| _ = closed.close_door(doors, door));
    Ok(())
}

/// The names with the fewest changes of letters from this one, the nearest first, of several alike the first by alphabet.
fn nearest<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: BTreeSet<&str> = names.collect();
    let mut by_distance: Vec<(usize, &str)> = names.into_iter().map(|other| (distance(name, other), other)).collect();
    by_distance.sort_unstable();
    by_distance.into_iter().take(MOST_NEAR).map(|(_, name)| name.to_owned()).collect()
}

/// Letters to be inserted, removed or replaced, in lower case (Levenshtein's distance).
fn distance(a: &str, b: &str) -> usize {
    let letters = |text: &str| text.to_lowercase().chars().collect::<Vec<_>>();
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// A door that is given as a box: `NAME=X0,Y0,Z0,X1,Y1,Z1`, in the plane `NAME=X0,Y0,X1,Y1`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DoorBox {
    pub(crate) name: String,
    min: Vec<f64>,
    max: Vec<f64>,
}

impl FromStr for DoorBox {
    type Err = anyhow::Error;

    /// The name is all before the last `=`.
    fn from_str(text: &str) -> Result<Self> {
        let form = "a door is a name and a box, such as front=0,0,0,1,2,0.1";
        let Some((name, corners)) = text.rsplit_once('=') else { bail!("{form}") };
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            bail!("a door needs a name before the '='");
        }
        let mut min = coordinates(corners)?;
        if !matches!(min.len(), 4 | 6) {
            bail!("{form}");
        }
        let max = min.split_off(min.len() / 2);
        refuse_reversed(&min, &max)?;
        Ok(Self { name: name.to_owned(), min, max })
    }
}

impl DoorBox {
    /// Number of coordinates of a corner.
    pub(crate) fn n_dimensions(&self) -> usize {
        self.min.len()
    }

    /// The corners, with z = 0 in the plane.
    pub(crate) fn corners(&self) -> [[f64; 3]; 2] {
        [&self.min, &self.max].map(|p| std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doors_are_parsed() {
        let door = |text: &str| text.parse::<DoorBox>().map_err(|error| error.to_string());
        let front = door("front=0,0,0,1,2.5,0").unwrap();
        assert_eq!((front.name.as_str(), front.n_dimensions()), ("front", 3));
        assert_eq!(front.corners(), [[0.0; 3], [1.0, 2.5, 0.0]]);
        assert_eq!(
            door("a=b=-1,2,3,4").map(|d| (d.name.clone(), d.corners()[0])),
            Ok(("a=b".into(), [-1.0, 2.0, 0.0]))
        );
        let refused = |text: &str, error: &str| assert!(door(text).is_err_and(|e| e.starts_with(error)), "{text}");
        for bad in ["front", "front=1,2,3", "front=1,2,3,4,5"] {
            refused(bad, "a door is a name and a box");
        }
        for bad in ["=0,0,1,1", " =0,0,1,1", "a\nb=0,0,1,1"] {
            refused(bad, "a door needs a name");
        }
        refused("a=0,x,1,1", "'x' is not a number");
        refused("a=0,5,1,4", "the lower corner is above the upper one: 5 is more than 4");
        refused("a=0,NaN,1,4", "");
    }

    #[test]
    fn portals_and_doors_are_closed() {
        let record = |name: &str, portals: &[u32]| DoorRecord {
            name: name.to_owned(),
            object: None,
            portals: portals.iter().copied().map(PortalId).collect(),
        };
        let doors = [record("front", &[1]), record("12", &[2]), record("a,b", &[3]), record("front", &[4])];
        let closed = |text: &str| {
            let mut closed = Doors::all_open();
            let result = close(text, &doors, 20, Path::new("t.pvs"), &mut closed);
            result.map(|()| closed.closed().map(|portal| portal.0).collect::<Vec<_>>()).map_err(|e| e.to_string())
        };
        assert_eq!(closed("front"), Ok(vec![1, 4]), "all doors of a name");
        assert_eq!(closed("12"), Ok(vec![12]), "a number is a portal");
        assert_eq!(closed("door:12"), Ok(vec![2]), "and this a door");
        assert_eq!(closed("a,b"), Ok(vec![3]), "a name with a comma alone");
        assert_eq!(closed("door:a,b"), Ok(vec![3]));
        assert_eq!(closed("front, 7,door:12"), Ok(vec![1, 2, 4, 7]));
        assert_eq!(closed("20"), Err("t.pvs: there is no portal 20: the table has 20 portals".into()));
        let error = "t.pvs: there is no door called \"Frond\": the nearest names are \"front\", \"12\", \"a,b\"";
        assert_eq!(closed("Frond"), Err(error.into()));
        assert!(closed("front,back").is_err_and(|error| error.contains("\"back\"")));
        let error = close("front", &[], 3, Path::new("t.pvs"), &mut Doors::all_open()).unwrap_err();
        assert_eq!(error.to_string(), "t.pvs: there is no door called \"front\": the table has no doors");
    }

    #[test]
    fn distances_are_counted_in_letters() {
        for (a, b, n) in [("", "", 0), ("a", "", 1), ("Tür", "tür", 0), ("front", "frond", 1), ("abc", "cab", 2)] {
            assert_eq!((distance(a, b), distance(b, a)), (n, n), "{a} {b}");
        }
    }
}
