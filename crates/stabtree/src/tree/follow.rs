//! What a tree grows along: sequences of gates, extended and shortened by one.

use sightlines_cells::{CellGraph, Exit, PortalId, Space};
use sightlines_sightline::Stabber;
use std::sync::Arc;

/// The number of a gate: twice its portal, and one more if it leads from the portal's second cell into the first.
pub const fn gate_of(exit: &Exit) -> u32 {
    2 * exit.portal.0 + !exit.forward as u32
}

/// The portal of a gate, and whether it is crossed from its first cell into its second.
pub const fn portal_of(gate: u32) -> (PortalId, bool) {
    (PortalId(gate / 2), gate.is_multiple_of(2))
}

/// Follows a sequence of gates (see [`gate_of`]), which leads from cell to cell and is empty at first.
///
/// Contract: `push` returns `None` only if no open set of lines passes the sequence and the gate; the sequence is then
/// unchanged. Its answer depends on nothing but the sequence.
pub trait Follower: Clone + Send + Sync {
    /// What makes it cheap to push a passable gate again.
    type Note: Copy + Send;

    /// Adds a gate; `None` and no change if no line passes.
    fn push(&mut self, gate: u32) -> Option<Self::Note>;

    /// Adds a gate again after the same sequence as before.
    fn push_again(&mut self, gate: u32, note: Self::Note);

    /// Undoes the last gate.
    fn pop(&mut self);

    /// How many times `push` has accepted a gate because it was undecided; pushing again does not count.
    fn n_undecided(&self) -> u64 {
        0
    }
}

/// Follows sequences with a stabber that decides gate by gate. Exact if the stabber is.
#[derive(Debug, Clone)]
pub struct ByStabber<S: Stabber> {
    stabber: S,
    /// By gate, oriented for crossing it.
    portals: Arc<[S::Portal]>,
    /// How to undo each gate; `None` for the first.
    undos: Vec<Option<S::Undo>>,
}

impl<S: Stabber> ByStabber<S> {
    /// For the portals of a graph; `turned` gives a portal's shape, as seen from its second cell for `false`.
    pub fn new<C: Space>(graph: &CellGraph<C>, stabber: S, turned: impl Fn(&C::Portal, bool) -> S::Portal) -> Self {
        let both = |shape: &C::Portal| [turned(shape, true), turned(shape, false)];
        let portals = graph.portals().iter().flat_map(|p| both(&p.shape)).collect();
        Self { stabber, portals, undos: Vec::new() }
    }
}

impl<S> Follower for ByStabber<S>
where
    S: Stabber + Sync,
    S::Portal: Send + Sync,
    S::Undo: Send + Sync,
{
    type Note = ();

    fn push(&mut self, gate: u32) -> Option<()> {
        let portal = self.portals[gate as usize].clone();
        let undo = if self.undos.is_empty() {
            self.stabber.start(portal);
            None
        } else {
            Some(self.stabber.push(portal)?)
        };
        self.undos.push(undo);
        Some(())
    }

    fn push_again(&mut self, gate: u32, (): ()) {
        assert!(self.push(gate).is_some(), "the stabber answers alike, whenever it is asked");
    }

    fn pop(&mut self) {
        if let Some(Some(undo)) = self.undos.pop() {
            self.stabber.undo(undo);
        }
    }
}
