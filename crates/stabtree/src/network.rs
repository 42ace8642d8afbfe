//! A graph as the search walks it: every exit with all that a step needs, in one array.

use crate::zones::Zones;
use sightlines_cells::{CellGraph, Planar};
use sightlines_geometry::{Aabb, Portal2};

/// No zone.
pub(crate) const NO_ZONE: u32 = u32::MAX;

/// One exit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<P> {
    /// The portal, as who crosses it sees it.
    pub(crate) portal: P,
    /// The side of the cell that is left by.
    pub(crate) side: u32,
    /// The cell entered.
    pub(crate) to: u32,
    /// The side that is entered by.
    pub(crate) entry_side: u32,
    /// The zone of the cell entered, or [`NO_ZONE`].
    pub(crate) zone: u32,
}

/// Cells, exits and zones, ready for [`crate::visible_zones`]. `P` is the stabber's portal, `B` what it
/// takes for bounds.
#[derive(Debug, Clone)]
pub struct Network<P, B> {
    pub(crate) steps: Vec<Step<P>>,
    /// Exits of cell `c` are `steps[first[c]..first[c + 1]]`.
    pub(crate) first: Vec<u32>,
    /// Exits out of each zone into something else: where its searches begin.
    pub(crate) sources: Vec<Vec<u32>>,
    /// What each zone lies inside of.
    pub(crate) bounds: Vec<B>,
}

impl<P, B> Network<P, B> {
    /// Number of zones.
    pub fn n_zones(&self) -> usize {
        self.bounds.len()
    }
}

impl Network<Portal2, Aabb<2>> {
    /// The network of a planar graph.
    pub fn planar(graph: &CellGraph<Planar>, zones: &Zones) -> Self {
        let mut bounds = vec![Aabb::EMPTY; zones.n_zones()];
        let mut sources = vec![Vec::new(); zones.n_zones()];
        let mut steps = Vec::with_capacity(graph.all_exits().len());
        let mut first = vec![0];
        for id in graph.cell_ids() {
            let own = zones.of(id);
            if let Some(zone) = own {
                let corners = graph.cell(id).polygon.iter();
                bounds[zone as usize] = corners.fold(bounds[zone as usize], |b: Aabb<2>, p| b.with([p.x, p.y]));
            }
            for exit in graph.exits(id) {
                let zone = zones.of(exit.to);
                if let Some(own) = own.filter(|_| own != zone) {
                    sources[own as usize].push(steps.len() as u32);
                }
                steps.push(Step {
                    portal: graph.crossing(exit),
                    side: exit.side,
                    to: exit.to.0,
                    entry_side: exit.entry_side,
                    zone: zone.unwrap_or(NO_ZONE),
                });
            }
            first.push(steps.len() as u32);
        }
        Self { steps, first, sources, bounds }
    }
}
