//! Portals that are closed for now.

use sightlines_pvs::{DoorId, DoorRecord, PortalId};
use std::collections::BTreeMap;

/// Which portals are closed: doors, hatches, whatever stands in an opening at the moment.
///
/// A table is made with all portals open, so it stays right whatever is closed: a closed portal only keeps the methods
/// that follow portals from going on behind it. Nothing is computed anew.
///
/// A portal is closed on its own account ([`Doors::close`]), by doors that are shut ([`Doors::close_door`]), or by both: it is
/// passed again when the last of them is opened.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Doors {
    /// On whatever account.
    closed: Portals,
    /// On their own account.
    own: Portals,
    /// The doors that are shut, with the portals that each closes.
    shut: BTreeMap<DoorId, Vec<PortalId>>,
    /// How many shut doors close each portal.
    n_shut: BTreeMap<PortalId, u32>,
}

impl Doors {
    /// All portals are open.
    pub fn all_open() -> Self {
        Self::default()
    }

    /// Closes a portal on its own account; whether it was open. A portal that the table does not have changes no answer. O(1).
    pub fn close(&mut self, portal: PortalId) -> bool {
        self.own.insert(portal);
        self.closed.insert(portal)
    }

    /// Opens a portal that was closed on its own account. Returns whether it can be passed from now on, and could not before: a shut
    /// door keeps it closed. O(log n) for n portals that shut doors close.
    pub fn open(&mut self, portal: PortalId) -> bool {
        self.own.remove(portal);
        !self.n_shut.contains_key(&portal) && self.closed.remove(portal)
    }

    /// Shuts a door of a table, given the table's doors; whether it was open. A door that there is not changes nothing.
    /// O(k log n) for k portals of the door and n that shut doors close.
    pub fn close_door(&mut self, doors: &[DoorRecord], door: DoorId) -> bool {
        let Some(record) = doors.get(door.idx()).filter(|_| !self.shut.contains_key(&door)) else { return false };
        for &portal in &record.portals {
            *self.n_shut.entry(portal).or_insert(0) += 1;
            self.closed.insert(portal);
        }
        self.shut.insert(door, record.portals.clone());
        true
    }

    /// Opens a door; whether it was shut. Its portals can be passed unless another shut door closes them, or they are closed on their
    /// own account. As [`Doors::close_door`].
    pub fn open_door(&mut self, door: DoorId) -> bool {
        let Some(portals) = self.shut.remove(&door) else { return false };
        for portal in portals {
            let n_shut = self.n_shut.get_mut(&portal).expect("a portal of a shut door is counted");
            *n_shut -= 1;
            if *n_shut == 0 {
                self.n_shut.remove(&portal);
                if !self.own.contains(portal) {
                    self.closed.remove(portal);
                }
            }
        }
        true
    }

    /// Opens all portals and doors.
    pub fn open_all(&mut self) {
        self.closed.clear();
        self.own.clear();
        self.shut.clear();
        self.n_shut.clear();
    }

    /// Whether a portal can be passed. O(1).
    #[inline]
    pub fn is_open(&self, portal: PortalId) -> bool {
        !self.closed.contains(portal)
    }

    /// Whether a door is shut.
    pub fn is_shut(&self, door: DoorId) -> bool {
        self.shut.contains_key(&door)
    }

    /// The doors that are shut, ascending.
    pub fn shut(&self) -> impl Iterator<Item = DoorId> + '_ {
        self.shut.keys().copied()
    }

    /// The closed portals, on whatever account, ascending. O(largest portal that was ever closed / 64 + closed ones).
    pub fn closed(&self) -> impl Iterator<Item = PortalId> + '_ {
        self.closed.iter()
    }

    /// The portals that are closed on their own account, ascending, whether or not shut doors close them too. Costs as
    /// [`Doors::closed`].
    pub fn closed_alone(&self) -> impl Iterator<Item = PortalId> + '_ {
        self.own.iter()
    }

    /// Number of closed portals.
    pub fn n_closed(&self) -> usize {
        self.closed.len
    }
}

/// A set of portals, as bits.
#[derive(Debug, Clone, Default)]
struct Portals {
    words: Vec<u64>,
    len: usize,
}

impl Portals {
    /// Whether it was not in the set.
    fn insert(&mut self, portal: PortalId) -> bool {
        let word = portal.idx() / 64;
        if self.words.len() <= word {
            self.words.resize(word + 1, 0);
        }
        let bit = 1u64 << (portal.0 % 64);
        let is_new = self.words[word] & bit == 0;
        self.words[word] |= bit;
        self.len += usize::from(is_new);
        is_new
    }

    /// Whether it was in the set.
    fn remove(&mut self, portal: PortalId) -> bool {
        let was_in = self.contains(portal);
        if was_in {
            self.words[portal.idx() / 64] &= !(1u64 << (portal.0 % 64));
            self.len -= 1;
        }
        was_in
    }

    #[inline]
    fn contains(&self, portal: PortalId) -> bool {
        self.len > 0 && self.words.get(portal.idx() / 64).is_some_and(|word| word >> (portal.0 % 64) & 1 == 1)
    }

    fn clear(&mut self) {
        self.words.fill(0);
        self.len = 0;
    }

    fn iter(&self) -> impl Iterator<Item = PortalId> + '_ {
        (0u32..).zip(&self.words).flat_map(|(word, &bits)| {
            (0..u64::BITS).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| PortalId(u64::BITS * word + bit))
        })
    }
}

/// Sets are equal if they have the same portals, however long their words are.
impl PartialEq for Portals {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.iter().eq(other.iter())
    }
}

impl Eq for Portals {}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    #[test]
    fn doors_open_and_close() {
        let mut doors = Doors::all_open();
        assert!(doors.is_open(PortalId(7)) && !doors.open(PortalId(7)));
        assert!(
            doors.close(PortalId(200))
                && !doors.close(PortalId(200))
                && !doors.is_open(PortalId(200))
                && doors.is_open(PortalId(199))
        );
        assert_eq!(doors.n_closed(), 1);
        doors.close(PortalId(63));
        assert_eq!(doors.closed().collect::<Vec<_>>(), [PortalId(63), PortalId(200)]);
        doors.open(PortalId(63));
        assert!(doors.open(PortalId(200)) && doors.is_open(PortalId(200)));
        assert_eq!(doors, Doors::all_open(), "what was opened again is as if it had never been closed");
        doors.close(PortalId(3));
        doors.open_all();
        assert!(doors.is_open(PortalId(3)) && doors.n_closed() == 0);
    }

    fn record(portals: impl Iterator<Item = u32>) -> DoorRecord {
        DoorRecord { name: String::new(), object: None, portals: portals.map(PortalId).collect() }
    }

    fn door(portals: &[u32]) -> DoorRecord {
        record(portals.iter().copied())
    }

    #[test]
    fn a_portal_of_two_doors_stays_closed_until_both_are_open() {
        let all = [door(&[1, 70]), door(&[70, 200]), door(&[])];
        let mut doors = Doors::all_open();
        assert!(doors.close_door(&all, DoorId(0)) && !doors.close_door(&all, DoorId(0)), "it is shut already");
        assert!(doors.close_door(&all, DoorId(1)) && doors.close_door(&all, DoorId(2)));
        assert!(!doors.close_door(&all, DoorId(3)), "there is no such door");
        assert_eq!(doors.closed().collect::<Vec<_>>(), [1, 70, 200].map(PortalId));
        assert_eq!((doors.n_closed(), doors.closed_alone().count()), (3, 0));
        assert!(doors.open_door(DoorId(0)) && !doors.open_door(DoorId(0)));
        assert_eq!(doors.closed().collect::<Vec<_>>(), [70, 200].map(PortalId), "the other door is shut");
        assert!(doors.is_open(PortalId(1)) && !doors.is_shut(DoorId(0)) && doors.is_shut(DoorId(1)));
        assert_eq!(doors.shut().collect::<Vec<_>>(), [1, 2].map(DoorId));
        // A portal by its number, and a door in it.
        assert!(!doors.close(PortalId(70)) && !doors.open(PortalId(70)), "the door is still shut");
        doors.close(PortalId(70));
        assert!(doors.open_door(DoorId(1)) && !doors.is_open(PortalId(70)) && doors.is_open(PortalId(200)));
        assert!(doors.open(PortalId(70)) && doors.open_door(DoorId(2)));
        assert_eq!(doors, Doors::all_open());
    }

    /// The oracle: what is closed by number, and which doors are shut; nothing else is kept.
    #[derive(Default)]
    struct Plain {
        own: BTreeSet<u32>,
        shut: BTreeSet<u32>,
    }

    impl Plain {
        fn closed(&self, doors: &[DoorRecord]) -> BTreeSet<u32> {
            let by_doors = self.shut.iter().flat_map(|&door| &doors[door as usize].portals).map(|portal| portal.0);
            by_doors.chain(self.own.iter().copied()).collect()
        }
    }

    proptest! {
        /// Invariant: a portal is closed if and only if it was closed by its number, or a shut door closes it.
        #[test]
        fn doors_keep_what_a_plain_list_keeps(
            doors in prop::collection::vec(prop::collection::btree_set(0u32..130, 0..6), 1..6),
            steps in prop::collection::vec((0u8..9, any::<prop::sample::Index>(), 0u32..130), 0..60),
        ) {
            let all: Vec<DoorRecord> = doors.iter().map(|door| record(door.iter().copied())).collect();
            let (mut doors, mut plain) = (Doors::all_open(), Plain::default());
            for (step, door, portal) in steps {
                let (before, door) = (plain.closed(&all), door.index(all.len()) as u32);
                match step {
                    0..3 => prop_assert_eq!(doors.close_door(&all, DoorId(door)), plain.shut.insert(door)),
                    3..6 => prop_assert_eq!(doors.open_door(DoorId(door)), plain.shut.remove(&door)),
                    6 => {
                        plain.own.insert(portal);
                        prop_assert_eq!(doors.close(PortalId(portal)), !before.contains(&portal));
                    }
                    7 => {
                        plain.own.remove(&portal);
                        let opens = before.contains(&portal) && !plain.closed(&all).contains(&portal);
                        prop_assert_eq!(doors.open(PortalId(portal)), opens);
                    }
                    _ => {
                        // Rarely, or nothing would be shut for long.
                        if portal < 5 {
                            plain = Plain::default();
                            doors.open_all();
                        }
                    }
                }
                let closed = plain.closed(&all);
                prop_assert!((0..130).all(|p| doors.is_open(PortalId(p)) != closed.contains(&p)));
                prop_assert!(doors.closed().map(|p| p.0).eq(closed.iter().copied()));
                prop_assert!(doors.closed_alone().map(|p| p.0).eq(plain.own.iter().copied()));
                prop_assert!(doors.shut().map(|d| d.0).eq(plain.shut.iter().copied()));
                prop_assert_eq!(doors.n_closed(), closed.len());
                prop_assert_eq!(doors == Doors::all_open(), plain.own.is_empty() && plain.shut.is_empty());
            }
        }
    }
}
