//! A graph in the form that the search uses: every exit with all that a step needs, in one array.

use crate::zones::Zones;
use sightlines_cells::{Axial, AxialDoor, CellGraph, CellId, Exit, Planar, Space};
use sightlines_geometry::{Aabb, Portal2};

/// No zone.
pub(crate) const NO_ZONE: u32 = u32::MAX;

/// One exit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<P> {
    /// The portal, oriented for crossing it.
    pub(crate) portal: P,
    /// The side through which the cell is left.
    pub(crate) side: u32,
    /// The cell entered.
    pub(crate) to: u32,
    /// The side through which the cell is entered.
    pub(crate) entry_side: u32,
    /// The zone of the cell entered, or [`NO_ZONE`].
    pub(crate) zone: u32,
}

/// Objects and their positions.
#[derive(Debug, Clone)]
pub(crate) struct Objects<B> {
    /// The bounds of each object.
    pub(crate) bounds: Vec<B>,
    /// For each cell, the objects that touch it and the part of their bounds inside it.
    entries: Vec<(u32, B)>,
    /// Entries of cell `c` are `entries[first[c]..first[c + 1]]`; empty if there are no objects.
    first: Vec<u32>,
    /// Objects that touch a cell of each zone.
    pub(crate) of_zone: Vec<Vec<u32>>,
}

impl<B> Objects<B> {
    fn none(n_zones: usize) -> Self {
        Self { bounds: Vec::new(), entries: Vec::new(), first: Vec::new(), of_zone: vec![Vec::new(); n_zones] }
    }

    /// The objects of one cell.
    #[inline]
    pub(crate) fn in_cell(&self, cell: u32) -> &[(u32, B)] {
        match self.first.get(cell as usize..cell as usize + 2) {
            Some(&[from, to]) => &self.entries[from as usize..to as usize],
            _ => &[],
        }
    }
}

/// Cells, exits, zones and objects, ready for [`crate::visible_zones`]. `P` is the stabber's portal type, `B` its type
/// of bounds.
#[derive(Debug, Clone)]
pub struct Network<P, B> {
    pub(crate) steps: Vec<Step<P>>,
    /// Exits of cell `c` are `steps[first[c]..first[c + 1]]`.
    pub(crate) first: Vec<u32>,
    /// Exits that lead out of each zone: where its searches begin.
    pub(crate) sources: Vec<Vec<u32>>,
    /// The bounds of each zone.
    pub(crate) bounds: Vec<B>,
    pub(crate) objects: Objects<B>,
}

impl<P, B> Network<P, B> {
    /// Number of zones.
    pub fn n_zones(&self) -> usize {
        self.bounds.len()
    }

    /// Number of objects.
    pub fn n_objects(&self) -> usize {
        self.objects.bounds.len()
    }

    /// The objects that touch a cell of a zone, ascending if the zone is one cell.
    ///
    /// # Panics
    /// If there is no such zone.
    pub fn objects_of(&self, zone: usize) -> &[u32] {
        &self.objects.of_zone[zone]
    }

    /// Words of a row with a bit for each zone, followed, from the next whole word on, by one for each object.
    pub(crate) fn row_width(&self) -> usize {
        self.n_zones().div_ceil(64) + self.n_objects().div_ceil(64)
    }

    /// The bounds of the target of a bit of such a row.
    #[inline]
    pub(crate) fn target(&self, zone_width: usize, word: usize, bit: usize) -> &B {
        if word < zone_width {
            &self.bounds[word * 64 + bit]
        } else {
            &self.objects.bounds[(word - zone_width) * 64 + bit]
        }
    }
}

impl<P, const D: usize> Network<P, Aabb<D>> {
    /// The network of a graph whose exits are crossed as given by `crossing` and whose cells have `extent`.
    fn of<S: Space>(
        graph: &CellGraph<S>,
        zones: &Zones,
        crossing: impl Fn(&Exit) -> P,
        extent: impl Fn(CellId) -> Aabb<D>,
    ) -> Self {
        let mut bounds = vec![Aabb::EMPTY; zones.n_zones()];
        let mut sources = vec![Vec::new(); zones.n_zones()];
        let mut steps = Vec::with_capacity(graph.all_exits().len());
        let mut first = vec![0];
        for id in graph.cell_ids() {
            let own = zones.of(id);
            if let Some(zone) = own {
                let (all, cell) = (bounds[zone as usize], extent(id));
                bounds[zone as usize] = Aabb::<D>::with(Aabb::<D>::with(all, cell.min), cell.max);
            }
            for exit in graph.exits(id) {
                let zone = zones.of(exit.to);
                if let Some(own) = own.filter(|_| own != zone) {
                    sources[own as usize].push(steps.len() as u32);
                }
                steps.push(Step {
                    portal: crossing(exit),
                    side: exit.side,
                    to: exit.to.0,
                    entry_side: exit.entry_side,
                    zone: zone.unwrap_or(NO_ZONE),
                });
            }
            first.push(steps.len() as u32);
        }
        Self { steps, first, sources, bounds, objects: Objects::none(zones.n_zones()) }
    }
}

impl Network<Portal2, Aabb<2>> {
    /// The network of a planar graph, without objects.
    pub fn planar(graph: &CellGraph<Planar>, zones: &Zones) -> Self {
        Self::of(graph, zones, |exit| graph.crossing(exit), |id| graph.cell(id).bounds())
    }
}

impl Network<AxialDoor, Aabb<3>> {
    /// The network of boxes in space, with objects given by their boxes. An object is in every cell that its closed box
    /// touches, with the part of its box inside the cell.
    pub fn axial(graph: &CellGraph<Axial>, zones: &Zones, objects: &[Aabb<3>]) -> Self {
        let extent = |id: CellId| graph.cell(id).bounds;
        let mut network = Self::of(graph, zones, |exit| graph.door(exit), extent);
        let mut first = vec![0];
        for id in graph.cell_ids() {
            let cell = extent(id);
            for (object, bounds) in (0u32..).zip(objects) {
                let part = common(&cell, bounds);
                if !part.is_empty() {
                    network.objects.entries.push((object, part));
                    if let Some(zone) = zones.of(id) {
                        network.objects.of_zone[zone as usize].push(object);
                    }
                }
            }
            first.push(network.objects.entries.len() as u32);
        }
        network.objects.first = first;
        network.objects.bounds = objects.to_vec();
        network
    }
}

/// The intersection of two boxes; empty if they do not touch.
fn common(a: &Aabb<3>, b: &Aabb<3>) -> Aabb<3> {
    let mut part = *a;
    for k in 0..3 {
        part.min[k] = a.min[k].max(b.min[k]);
        part.max[k] = a.max[k].min(b.max[k]);
    }
    part
}
