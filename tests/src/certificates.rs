//! Proofs of small tables for fuzzing: whatever is read from broken bytes is refused by the checker, or true.

use sightlines::bake::{
    Baked, BakedPlan, BakedPrt, BakedScene, PlanBakeOptions, PrtOptions, SceneBakeOptions, bake_plan, bake_prt,
    bake_scene,
};
use sightlines::certificates::axial::AxialProofs;
use sightlines::certificates::convex::ConvexProofs;
use sightlines::certificates::planar::PlanarProofs;
use sightlines::certificates::{Kind, kind_of};
use sightlines::formats::Prt;
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::world::{BspWorldOptions, bsp_world, corridor};
use sightlines::scenes::{self, TowerOptions, tower};
use sightlines::stabtree::CertifyOptions;
use sightlines::verify::{boxes_of, convex_of, plan_of};
use std::sync::OnceLock;

/// Tables, and proofs of them as bytes; made once.
fn proven() -> &'static [(Table, Vec<u8>)] {
    static PROVEN: OnceLock<Vec<(Table, Vec<u8>)>> = OnceLock::new();
    PROVEN.get_or_init(|| {
        let plans = scenes::maze(1, 3, 2).into_iter().chain(scenes::doom_like(1, 1));
        let plans =
            plans.filter_map(|plan| bake_plan(&plan, &PlanBakeOptions::default()).ok().map(BakedPlan::into_any));
        let storey = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
        let storey = tower(storey).ok();
        let storey = storey.and_then(|scene| bake_scene(&scene, &SceneBakeOptions::default()).ok());
        let proofs = |baked: Baked| {
            let made = baked.certify(&CertifyOptions::default()).expect("the table has cells and portals");
            (baked.table, made.proofs.to_bytes())
        };
        let leafs = BspWorldOptions { seed: 3, leafs: 12, solid_percent: 45, tilted_percent: 60 };
        let worlds = bsp_world(leafs).into_iter().chain(corridor(7, [1, 2], 7));
        let maps = worlds.filter_map(|world| {
            let mut prt = Prt::new(world.graph.n_cells() as u32).ok()?;
            for portal in world.graph.portals() {
                prt.push_portal(portal.cells.map(|cell| cell.0), portal.shape.corners()).ok()?;
            }
            bake_prt(&prt, PrtOptions::default()).ok().map(BakedPrt::into_any)
        });
        plans.chain(storey.map(BakedScene::into_any)).chain(maps).map(proofs).collect()
    })
}

/// Proofs to break.
pub fn seeds() -> Vec<Vec<u8>> {
    proven().iter().map(|(_, bytes)| bytes.clone()).collect()
}

/// Reads bytes as they are and under a right checksum; what is read is written again the same way, and proves nothing wrong of
/// any table. Returns whether something was read.
///
/// # Panics
/// If that is not so.
pub fn check(bytes: &[u8]) -> bool {
    let mut sealed = bytes.to_vec();
    if let Some(end) = bytes.len().checked_sub(4) {
        let checksum = crc32fast::hash(&sealed[..end]);
        sealed[end..].copy_from_slice(&checksum.to_le_bytes());
    }
    [bytes, &sealed].into_iter().filter(|bytes| check_one(bytes)).count() > 0
}

fn check_one(bytes: &[u8]) -> bool {
    let proven = match kind_of(bytes) {
        Ok(Kind::Planar) => {
            let Ok(proofs) = PlanarProofs::from_bytes(bytes) else { return false };
            assert_eq!(PlanarProofs::from_bytes(&proofs.to_bytes()).as_ref(), Ok(&proofs));
            let of = |table: &Table| proofs.check(&plan_of(table).ok()?).ok();
            proven().iter().map(|(table, _)| (table, of(table))).collect::<Vec<_>>()
        }
        Ok(Kind::Axial) => {
            let Ok(proofs) = AxialProofs::from_bytes(bytes) else { return false };
            assert_eq!(AxialProofs::from_bytes(&proofs.to_bytes()).as_ref(), Ok(&proofs));
            let of = |table: &Table| proofs.check(&boxes_of(table).ok()?).ok();
            proven().iter().map(|(table, _)| (table, of(table))).collect()
        }
        Ok(Kind::Convex) => {
            let Ok(proofs) = ConvexProofs::from_bytes(bytes) else { return false };
            assert_eq!(ConvexProofs::from_bytes(&proofs.to_bytes()).as_ref(), Ok(&proofs));
            let of = |table: &Table| proofs.check(&convex_of(table).ok()?).ok();
            proven().iter().map(|(table, _)| (table, of(table))).collect()
        }
        Err(_) => return false,
    };
    for (table, proven) in proven {
        let Some(proven) = proven else { continue };
        let sees = |[a, b]: [u32; 2]| table.sees(CellId(a), CellId(b));
        assert!(proven.visible.iter().all(sees), "something hidden is proven to be visible");
        assert!(!proven.hidden.iter().any(sees), "something visible is proven to be hidden");
    }
    true
}
