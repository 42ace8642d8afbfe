//! Closing portals and doors that a text names.

use crate::doors::Doors;
use sightlines_pvs::{DoorId, DoorRecord, PortalId, doors_named};
use std::collections::BTreeSet;

/// What makes the rest a name, whatever it looks like.
const PREFIX: &str = "door:";
/// How many names an error lists.
const MOST_NEAR: usize = 3;

/// A text names what a table does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CloseError {
    /// There is no such portal.
    #[error("there is no portal {portal}: the table has {n_portals} portals")]
    Portal {
        /// Its number.
        portal: u32,
        /// How many there are.
        n_portals: usize,
    },
    /// There is no such door.
    #[error("there is no door called {name:?}: {}", listed(nearest))]
    Door {
        /// The name.
        name: String,
        /// The names with the fewest changes of letters from it, the nearest first.
        nearest: Vec<String>,
    },
}

fn listed(near: &[String]) -> String {
    if near.is_empty() {
        return "the table has no doors".to_owned();
    }
    let names: Vec<String> = near.iter().map(|name| format!("{name:?}")).collect();
    format!("the nearest names are {}", names.join(", "))
}

impl Doors {
    /// Closes what a text names: portals by their numbers and doors by their names, separated by commas. All doors of a name are shut. A
    /// text that is the name of a door as a whole is that door, commas or not; what follows `door:` is a name, even if it is a number.
    ///
    /// * `doors`, `n_portals`: of the table
    ///
    /// # Errors
    /// [`CloseError`]; what the text names before is closed then.
    pub fn close_named(&mut self, text: &str, doors: &[DoorRecord], n_portals: usize) -> Result<(), CloseError> {
        let is_number = text.parse::<u32>().is_ok();
        let is_door = |name: &str| doors_named(doors, name).next().is_some();
        let whole = text.strip_prefix(PREFIX).filter(|name| is_door(name));
        if let Some(name) = whole.or_else(|| Some(text).filter(|name| !is_number && is_door(name))) {
            return self.shut_named(name, doors);
        }
        for part in text.split(',') {
            match (part.strip_prefix(PREFIX), part.trim().parse::<u32>()) {
                (None, Ok(portal)) if portal as usize >= n_portals => {
                    return Err(CloseError::Portal { portal, n_portals });
                }
                (None, Ok(portal)) => _ = self.close(PortalId(portal)),
                (name, _) => self.shut_named(name.unwrap_or(part), doors)?,
            }
        }
        Ok(())
    }

    fn shut_named(&mut self, name: &str, doors: &[DoorRecord]) -> Result<(), CloseError> {
        let ids: Vec<DoorId> = doors_named(doors, name).collect();
        if ids.is_empty() {
            return Err(CloseError::Door { name: name.to_owned(), nearest: nearest(name, doors) });
        }
        ids.into_iter().for_each(|door| _ = self.close_door(doors, door));
        Ok(())
    }
}

/// The names with the fewest changes of letters from this one, the nearest first, of several alike the first by alphabet.
fn nearest(name: &str, doors: &[DoorRecord]) -> Vec<String> {
    let names: BTreeSet<&str> = doors.iter().map(|door| &*door.name).collect();
    let mut names: Vec<&str> = names.into_iter().collect();
    names.sort_by_cached_key(|other| distance(name, other));
    names.into_iter().take(MOST_NEAR).map(str::to_owned).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

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
            let result = closed.close_named(text, &doors, 20);
            result.map(|()| closed.closed().map(|portal| portal.0).collect::<Vec<_>>()).map_err(|e| e.to_string())
        };
        assert_eq!(closed("front"), Ok(vec![1, 4]), "all doors of a name");
        assert_eq!(closed("12"), Ok(vec![12]), "a number is a portal");
        assert_eq!(closed("door:12"), Ok(vec![2]), "and this a door");
        assert_eq!(closed("a,b"), Ok(vec![3]), "a name with a comma alone");
        assert_eq!(closed("door:a,b"), Ok(vec![3]));
        assert_eq!(closed("front, 7,door:12"), Ok(vec![1, 2, 4, 7]));
        assert_eq!(closed("20"), Err("there is no portal 20: the table has 20 portals".into()));
        let error = "there is no door called \"Frond\": the nearest names are \"front\", \"12\", \"a,b\"";
        assert_eq!(closed("Frond"), Err(error.into()));
        assert!(closed("front,back").is_err_and(|error| error.contains("\"back\"")));
        let error = Doors::all_open().close_named("front", &[], 3).unwrap_err();
        assert_eq!(error.to_string(), "there is no door called \"front\": the table has no doors");
    }

    #[test]
    fn distances_are_counted_in_letters() {
        for (a, b, n) in [("", "", 0), ("a", "", 1), ("Tür", "tür", 0), ("front", "frond", 1), ("abc", "cab", 2)] {
            assert_eq!((distance(a, b), distance(b, a)), (n, n), "{a} {b}");
        }
    }
}
