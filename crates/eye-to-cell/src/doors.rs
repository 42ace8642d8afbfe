//! Portals that are closed for now.

use sightlines_pvs::PortalId;

/// Which portals are closed: doors, hatches, whatever stands in an opening at the moment.
///
/// A table is made with all portals open, so it stays right whatever is closed: a closed portal only keeps the methods
/// that follow portals from going on behind it. Opening and closing are O(1); nothing is computed anew.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Doors {
    closed: Vec<u64>,
    n_closed: usize,
}

impl Doors {
    /// All portals are open.
    pub fn all_open() -> Self {
        Self::default()
    }

    /// Closes a portal; whether it was open. A portal that the table does not have changes no answer.
    pub fn close(&mut self, portal: PortalId) -> bool {
        let word = portal.idx() / 64;
        if self.closed.len() <= word {
            self.closed.resize(word + 1, 0);
        }
        let bit = 1u64 << (portal.0 % 64);
        let was_open = self.closed[word] & bit == 0;
        self.closed[word] |= bit;
        self.n_closed += usize::from(was_open);
        was_open
    }

    /// Opens a portal. Returns whether it was closed.
    pub fn open(&mut self, portal: PortalId) -> bool {
        let was_closed = !self.is_open(portal);
        if was_closed {
            self.closed[portal.idx() / 64] &= !(1u64 << (portal.0 % 64));
            self.n_closed -= 1;
        }
        was_closed
    }

    /// Opens all.
    pub fn open_all(&mut self) {
        self.closed.fill(0);
        self.n_closed = 0;
    }

    /// Whether a portal can be passed.
    #[inline]
    pub fn is_open(&self, portal: PortalId) -> bool {
        self.n_closed == 0 || self.closed.get(portal.idx() / 64).is_none_or(|word| word >> (portal.0 % 64) & 1 == 0)
    }

    /// The closed portals, ascending. O(largest portal that was ever closed / 64 + closed ones).
    pub fn closed(&self) -> impl Iterator<Item = PortalId> + '_ {
        (0u32..).zip(&self.closed).flat_map(|(word, &bits)| {
            (0..u64::BITS).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| PortalId(u64::BITS * word + bit))
        })
    }

    /// Number of closed portals.
    pub fn n_closed(&self) -> usize {
        self.n_closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        doors.close(PortalId(3));
        doors.open_all();
        assert!(doors.is_open(PortalId(3)) && doors.n_closed() == 0);
    }
}
