//! The ways that free segments take through a table: from cell to cell by its portals, and along the branches of its stab trees. These are what the run time
//! follows. Wherever something is visible, the portals and stab trees must lead there.

use crate::exact::snapped;
use crate::findings::Violation;
use crate::oracle::{RayOracle, clip, extreme, scale_of, sub};
use crate::sight::{SightSegment, Target};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_pvs::{CellId, ObjectId, PortalId, PortalRecord, Table};

/// Portals that one segment passes at most.
const LONGEST: usize = 4096;

/// The portals of a table, by cells.
#[derive(Debug)]
pub(super) struct Ways<'t> {
    table: &'t Table,
    portals_of: Vec<Vec<PortalId>>,
    boxes: Vec<Aabb<3>>,
    /// Around boxes in rounded questions: more than twice the clearance of plans with rounded crossings, so that no portal is ruled out that they may be near to.
    slack: f64,
}

/// Where a segment leads.
enum Way {
    /// To its end.
    Open,
    /// Too near to the border of a portal to be followed.
    Unsure,
    /// Nowhere, by the table.
    Ends(Violation),
}

impl<'t> Ways<'t> {
    /// `None` for a table without portals: then nothing follows them.
    pub(super) fn of(table: &'t Table) -> Option<Self> {
        if table.portals().is_empty() {
            return None;
        }
        let mut portals_of = vec![Vec::new(); table.n_cells()];
        for (id, portal) in (0u32..).map(PortalId).zip(table.portals()) {
            portal.cells.iter().for_each(|cell| portals_of[cell.idx()].push(id));
        }
        let boxes = table.portals().iter().map(|portal| Aabb::around(portal.points.iter().copied())).collect();
        let scale = scale_of(table.cells().iter().flat_map(|cell| cell.min.into_iter().chain(cell.max)));
        Some(Self { table, portals_of, boxes, slack: 4.0 * scale * 2f64.powi(-40) })
    }

    pub(super) fn table(&self) -> &'t Table {
        self.table
    }

    pub(super) fn portals_of(&self, cell: CellId) -> &[PortalId] {
        &self.portals_of[cell.idx()]
    }

    /// The box around a portal.
    pub(super) fn around(&self, id: PortalId) -> &Aabb<3> {
        &self.boxes[id.idx()]
    }

    pub(super) fn portal(&self, id: PortalId) -> &'t PortalRecord {
        &self.table.portals()[id.idx()]
    }

    /// Follows a segment through the table; says how many ways were followed, none or one, and the fault if the table does not lead to its end.
    pub(super) fn follow<R: RayOracle>(&self, world: &R, sight: &SightSegment) -> (u64, Option<Violation>) {
        match self.way(world, sight) {
            Way::Open => (1, None),
            Way::Unsure => (0, None),
            // Proofs cost more than ways.
            Way::Ends(violation) if world.proves_way(sight) => (1, Some(violation)),
            Way::Ends(_) => (0, None),
        }
    }

    fn way<R: RayOracle>(&self, world: &R, &SightSegment { from, target, segment }: &SightSegment) -> Way {
        let Target::Cell(to) = target else { return Way::Unsure };
        let (stab, mut cell) = (self.table.stab(), from);
        // What may be crossed next by the stab tree; anything if it was cut here.
        let mut next = stab.filter(|stab| !stab.is_root_open(from)).map(|stab| stab.roots(from));
        let mut passed: Vec<PortalId> = Vec::new();
        let d = sub(segment[1], segment[0]);
        while cell != to {
            let is_near = |id: PortalId| clip(segment[0], d, &self.boxes[id.idx()], [0.0, 1.0], self.slack).is_some();
            let is_met =
                |&&id: &&PortalId| passed.last() != Some(&id) && is_near(id) && !world.misses(self.portal(id), segment);
            let mut met = self.portals_of[cell.idx()].iter().filter(is_met);
            let portal = match (met.next(), met.next()) {
                (None, _) if R::CELLS_ARE_CONVEX => return Way::Ends(Violation::MissingPortal { cell, segment }),
                (Some(&id), None) if world.crosses(self.portal(id), segment) => id,
                _ => return Way::Unsure,
            };
            if passed.len() >= LONGEST {
                return Way::Unsure;
            }
            passed.push(portal);
            let [a, b] = self.portal(portal).cells;
            let forward = a == cell;
            if let (Some(stab), Some(nodes)) = (stab, next) {
                let Some(&node) = nodes.iter().find(|&&node| stab.gate(node) == (portal, forward)) else {
                    return Way::Ends(Violation::MissingSequence { cell: from, portals: passed, segment });
                };
                next = (!stab.is_open(node)).then(|| stab.children(node));
            }
            cell = if forward { b } else { a };
        }
        Way::Open
    }

    /// Whether a segment comes near one of some portals.
    pub(super) fn is_near_any(&self, portals: &[PortalId], [p, q]: [Point3; 2]) -> bool {
        let d = sub(q, p);
        portals.iter().any(|id| clip(p, d, &self.boxes[id.idx()], [0.0, 1.0], self.slack).is_some())
    }

    /// Whether the portals of the table may lead along a segment to its end, or to a cell that its object touches: no only where the segment leaves a cell and comes
    /// near no portal there, which for a free one the borders of that cell would have shown.
    pub(super) fn may_lead(&self, &SightSegment { from, target, segment: [p, q] }: &SightSegment) -> bool {
        let (mut cell, mut last) = (from, None);
        let d = sub(q, p);
        for _ in 0..LONGEST {
            if target == Target::Cell(cell) {
                return true;
            }
            let is_near = |&&id: &&PortalId| {
                last != Some(id) && clip(p, d, &self.boxes[id.idx()], [0.0, 1.0], self.slack).is_some()
            };
            let mut near = self.portals_of[cell.idx()].iter().filter(is_near);
            let portal = match (near.next(), near.next()) {
                (Some(&id), None) => id,
                (None, _) => {
                    return match target {
                        Target::Cell(_) => false,
                        Target::Object(object) => self.table.objects_of(cell).binary_search(&ObjectId(object)).is_ok(),
                    };
                }
                _ => return true,
            };
            let [a, b] = self.portal(portal).cells;
            (cell, last) = (if a == cell { b } else { a }, Some(portal));
        }
        true
    }

    /// A portal that a cell lacks where its border is open.
    pub(super) fn missing_portal<R: RayOracle>(&self, world: &R, cell: CellId) -> Option<Violation> {
        let own: Vec<&PortalRecord> = self.portals_of(cell).iter().map(|&id| self.portal(id)).collect();
        let is_missing =
            |sight: &SightSegment| own.iter().all(|portal| world.misses(portal, sight.segment)) && world.proves(sight);
        let sight = world.through_borders(cell.0, &own).into_iter().find(is_missing)?;
        Some(Violation::MissingPortal { cell, segment: sight.segment })
    }

    /// Follows a segment from inside of a cell through one of its portals.
    pub(super) fn through_one<R: RayOracle>(
        &self,
        world: &R,
        from: CellId,
        portal: PortalId,
        random: &mut Random,
    ) -> Option<Violation> {
        let record = self.portal(portal);
        let to = record.cells[usize::from(record.cells[0] == from)];
        let middle = |cell: CellId| {
            let cell = &self.table.cells()[cell.idx()];
            [0, 1, 2].map(|k| 0.5 * cell.min[k] + 0.5 * cell.max[k])
        };
        (0..8).find_map(|k| {
            let x = inside(&record.points, random);
            let share = 2f64.powi(-3 * k);
            let towards = |cell| snapped([0, 1, 2].map(|k| x[k] + (middle(cell)[k] - x[k]) * share));
            let sight = SightSegment { from, target: Target::Cell(to), segment: [towards(from), towards(to)] };
            self.follow(world, &sight).1
        })
    }
}

/// A random point inside of a convex polygon or a segment.
pub(super) fn inside(corners: &[Point3], random: &mut Random) -> Point3 {
    let weights: Vec<f64> = corners.iter().map(|_| extreme(random).max(f64::MIN_POSITIVE)).collect();
    let sum: f64 = weights.iter().sum();
    [0, 1, 2].map(|k| corners.iter().zip(&weights).map(|(p, w)| p[k] * (w / sum)).sum())
}
