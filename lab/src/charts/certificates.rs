//! Proofs of whole tables: their size, and the time to find and to check them.

use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::bake::{
    PlanBakeOptions, PrtOptions, SceneBakeOptions, bake_plan, bake_prt, bake_scene, certify_table, from_table,
};
use sightlines::formats::Prt;
use sightlines::formats::quake::read_prt;
use sightlines::pvs::Table;
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::stabtree::{CertifyOptions, ConvexOptions};
use sightlines::verify::check_proofs;
use sightlines_benches::chart::{Panel, Point, Series};
use sightlines_tests::world_files::prt_of_world;

const NAME: &str = "certificates";
/// The steps, each a row.
const STEPS: [&str; 3] = ["bake", "prove", "check"];
/// The kinds of tables.
const KINDS: [&str; 3] = ["office plans", "towers", "Quake levels"];
/// Real maps, beside levels that are generated.
const MAPS: [&str; 2] = ["e1m7", "dm3"];

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Size of proofs, and time to find and check them.
#[derive(Debug, Clone, Copy)]
pub struct Certificates;

impl Family for Certificates {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Certificates: what proofs of whole tables cost"
    }

    fn about(&self) -> &'static str {
        "For each table, a proof of every pair of cells: a line for those that see each other, and a reason for those that do not. Time to bake the \
         table, to find the proofs, and to read their bytes and check them with a checker that shares no code with the solvers; on one thread where \
         there is a choice. Bytes of the table as a file, and of the proofs. What is reported are pairs that the checker calls proven; what is left open is in the notes."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        let (rooms, floors): (&[u32], &[u32]) = settings.pick((&[2, 4], &[1]), (&[2, 4, 8, 16], &[1, 2, 4]));
        for &side in rooms {
            let bake = || -> Result<Table, Failure> {
                let plan = office(OfficeOptions { rooms_x: side, rooms_y: side, ..OfficeOptions::default() })?;
                Ok(bake_plan(&plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() })?.table)
            };
            one(settings, KINDS[0], &format!("{side} x {side} rooms"), bake, &mut rows)?;
        }
        for &floors in floors {
            let few = TowerOptions { floors, ..TowerOptions::default() };
            let options = settings.pick(TowerOptions { rooms_x: 2, rooms_y: 2, furniture: 0, ..few }, few);
            let bake = || -> Result<Table, Failure> {
                let scene = tower(options)?;
                Ok(bake_scene(&scene, &SceneBakeOptions { threads: 1, ..SceneBakeOptions::default() })?.table)
            };
            one(settings, KINDS[1], &format!("{floors} floors"), bake, &mut rows)?;
        }
        let levels: &[u32] = settings.pick(&[1], &[1, 2]);
        for &side in levels {
            let options = QuakeLikeOptions { seed: 1, rooms_x: side, rooms_y: side, floors: side };
            let world = quake_like(options).map_err(|e| ChartError::measure(NAME, "a level", e))?;
            one(
                settings,
                KINDS[2],
                &format!("{side} x {side} x {side} rooms"),
                || level(&prt_of_world(&world)),
                &mut rows,
            )?;
        }
        for map in settings.data.iter().flat_map(|data| MAPS.map(|map| data.join("quake").join(map))) {
            let name = map.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let prt = read_prt(map.with_extension("prt")).map_err(|e| ChartError::measure(NAME, &name, e))?;
            one(settings, KINDS[2], &name, || level(&prt), &mut rows)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let panel = |kind: &str, unit: &str, steps: &[&str], y: &dyn Fn(&Row) -> Option<f64>| {
            let series = |(slot, step): (usize, &&str)| {
                let own = rows.iter().filter(|r| r.scene == kind && r.method == **step);
                let point = |r: &Row| Some(Point { at: [r.size as f64, y(r)?], is_unsafe: false });
                Series { name: (**step).to_owned(), slot, points: own.filter_map(point).collect(), is_joined: true }
            };
            Panel {
                title: kind.to_owned(),
                names: ["cells".to_owned(), unit.to_owned()],
                series: steps.iter().enumerate().map(series).collect(),
                has_front: false,
            }
        };
        let bytes = |r: &Row| r.bytes.map(|b| b as f64);
        let both = |kind: &&str| {
            [
                panel(kind, "seconds", &STEPS, &|r| r.seconds),
                panel(kind, "bytes: bake, table; prove, proofs", &STEPS[..2], &bytes),
            ]
        };
        KINDS.iter().flat_map(both).collect()
    }
}

/// The table of a portal file, by one thread.
fn level(prt: &Prt) -> Result<Table, Failure> {
    let search = ConvexOptions { threads: 1, ..ConvexOptions::default() };
    Ok(bake_prt(prt, PrtOptions { search, ..PrtOptions::default() })?.table)
}

fn one(
    settings: &Settings,
    kind: &str,
    which: &str,
    bake: impl Fn() -> Result<Table, Failure>,
    rows: &mut Vec<Row>,
) -> Result<(), ChartError> {
    let failed = |e: Failure| ChartError::measure(NAME, &format!("{kind} of {which}"), e);
    let (table, baking, n_baking) = settings.best_of(&bake);
    let table = table.map_err(failed)?;
    let graph = from_table::graph(&table).ok_or_else(|| failed("a table without portals".into()))?;
    let (found, proving, n_proving) = settings.best_of(|| certify_table(&table, &graph, &CertifyOptions::default()));
    let proofs = found.map_err(|e| failed(e.into()))?.proofs.to_bytes();
    let (checked, checking, n_checking) = settings.best_of(|| check_proofs(&table, &proofs));
    let checked = checked.map_err(|e| failed(e.into()))?;
    let n = table.n_cells() as u64;
    let all = n * n.saturating_sub(1) / 2;
    let proven = checked.n_visible + checked.n_hidden;
    let note = format!("{which}; {} visible; {} hidden; {} open", checked.n_visible, checked.n_hidden, all - proven);
    let bytes = [Some(table.to_bytes().len() as u64), Some(proofs.len() as u64), None];
    let times = [(baking, n_baking), (proving, n_proving), (checking, n_checking)];
    for ((step, (seconds, repeats)), bytes) in STEPS.into_iter().zip(times).zip(bytes) {
        rows.push(Row {
            size: n,
            size_of: "cells".to_owned(),
            repeats,
            seconds: Some(seconds),
            reported: Some(proven),
            truth: Some(all),
            truth_by: "all pairs".to_owned(),
            bytes,
            note: note.clone(),
            ..settings.row(NAME, step, kind)
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_tables_are_proven_whole() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let mut rows = Vec::new();
        let bake = || -> Result<Table, Failure> {
            let plan = office(OfficeOptions { rooms_x: 3, rooms_y: 2, ..OfficeOptions::default() })?;
            Ok(bake_plan(&plan, &PlanBakeOptions::default())?.table)
        };
        one(&settings, KINDS[0], "3 x 2 rooms", bake, &mut rows).unwrap();
        assert_eq!(rows.iter().map(|r| r.method.as_str()).collect::<Vec<_>>(), STEPS);
        assert!(rows.iter().all(|r| r.reported == r.truth && r.truth > Some(20) && r.seconds > Some(0.0)), "{rows:?}");
        assert!(rows[0].bytes > Some(0) && rows[1].bytes > Some(0));
        assert_eq!(Certificates.panels(&rows).iter().flat_map(|p| &p.series).map(|s| s.points.len()).sum::<usize>(), 5);
        let options = QuakeLikeOptions { seed: 1, rooms_x: 1, rooms_y: 1, floors: 1 };
        let prt = prt_of_world(&quake_like(options).unwrap());
        one(&settings, KINDS[2], "a room", || level(&prt), &mut rows).unwrap();
        assert!(rows[3..].iter().all(|r| r.scene == "Quake levels" && r.reported == r.truth), "{rows:?}");
    }
}
