//! Codings of tables: bytes against the time to read a row.

use super::panels::{Layout, by_scene};
use super::row::Row;
use super::{ChartError, Family, Settings};
use sightlines::bake::{PlanBakeOptions, PrtOptions, SceneBakeOptions, bake_plan, bake_prt, bake_scene};
use sightlines::packed::{Distinct, PackOptions, Packed, pack_report};
use sightlines::pvs::{CellId, Table};
use sightlines::scenes::doom_like;
use sightlines_benches::chart::Panel;
use sightlines_benches::codings::{CodedRows, RowCoding, unpack_runs, zero_runs};
use sightlines_benches::quake::MapSpec;
use sightlines_benches::spec::SceneSpec;
use sightlines_testkit::mutate::SplitMix;
use std::time::Instant;

const NAME: &str = "speed_packed";

/// Bytes against time to read a row.
#[derive(Debug, Clone, Copy)]
pub struct PackedFamily;

impl Family for PackedFamily {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Packed tables: bytes against time to read a row"
    }

    fn about(&self) -> &'static str {
        "The rows of one table in several codings, none of which loses anything. Up: bytes of all rows. To the right: microseconds to read one \
         row, on average over random rows; of codings with blocks, a block is unpacked each time. Dense rows are one bit for each pair; zero \
         runs are Quake's coding; the others keep equal rows and columns once and pack blocks of 64 or 256 rows with zstd, as \
         they are, as differences from the row above, or from three neighbours. The last is the file format of the program, which \
         chooses for itself, with nothing in its cache and with everything."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let mut rows = Vec::new();
        for (name, table) in tables(settings)? {
            codings(settings, &name, &table, &mut rows)?;
        }
        Ok(rows)
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        let at = |r: &Row| Some([r.seconds? * 1e6, r.bytes? as f64]);
        by_scene(
            rows,
            &Layout { names: ["time to read a row, microseconds", "bytes of all rows"], at: &at, has_front: true },
        )
    }
}

fn tables(settings: &Settings) -> Result<Vec<(String, Table)>, ChartError> {
    let failed = |name: &str| {
        let name = name.to_owned();
        move |e: Box<dyn std::error::Error + Send + Sync>| ChartError::measure(NAME, &name, e)
    };
    let mut tables = Vec::new();
    let size = settings.pick(4, 12);
    let name = format!("doom-like {size}");
    let plan = doom_like(1, size).map_err(|e| failed(&name)(e.into()))?;
    tables.push((
        name.clone(),
        bake_plan(&plan, &PlanBakeOptions::default()).map_err(|e| failed(&name)(e.into()))?.table,
    ));
    let name = settings.pick("tower:1:2:2:1", "tower:4:6:4:2");
    let scene = name.parse::<SceneSpec>().and_then(|s| s.load()).map_err(|e| failed(name)(e.into()))?;
    let baked = bake_scene(&scene, &SceneBakeOptions::default()).map_err(|e| failed(name)(e.into()))?;
    tables.push((name.to_owned(), baked.table));
    if let Some(data) = &settings.data {
        let path = data.join("quake/e1m1.prt");
        let prt = sightlines::formats::quake::read_prt(&path).map_err(|e| failed("e1m1")(e.into()))?;
        let baked = bake_prt(&prt, PrtOptions::default()).map_err(|e| failed("e1m1")(e.into()))?;
        tables.push((MapSpec::File(path).name(), baked.table));
    }
    Ok(tables)
}

/// Seconds that `ask` takes for random rows below `n`, on average; the least of several rounds.
fn time(settings: &Settings, n_asked: usize, n: usize, mut ask: impl FnMut(usize)) -> f64 {
    let mut random = SplitMix::new(1);
    let asked: Vec<usize> = (0..n_asked).map(|_| random.below(n)).collect();
    let mut round = || {
        let start = Instant::now();
        asked.iter().for_each(|&row| ask(row));
        start.elapsed().as_secs_f64() / n_asked as f64
    };
    (0..settings.pick(3, 5)).map(|_| round()).fold(f64::INFINITY, f64::min)
}

fn codings(settings: &Settings, name: &str, table: &Table, rows: &mut Vec<Row>) -> Result<(), ChartError> {
    let failed = |e: Box<dyn std::error::Error + Send + Sync>| ChartError::measure(NAME, name, e);
    let matrix = &table.parts().rows;
    let n = table.n_cells();
    let n_asked = settings.pick(200, 2000);
    let mut add = |method: &str, bytes: usize, seconds: f64| {
        rows.push(Row {
            size: n as u64,
            size_of: "cells".to_owned(),
            repeats: settings.pick(3, 5),
            seconds: Some(seconds),
            bytes: Some(bytes as u64),
            ..settings.row(NAME, method, name)
        });
    };
    let mut cells: Vec<CellId> = Vec::new();
    let dense = time(settings, n_asked, n, |i| {
        cells.clear();
        cells.extend(table.visible(CellId(i as u32)));
    });
    add("dense", n * n.div_ceil(8), dense);
    let runs: Vec<Vec<u8>> = (0..n).map(|i| zero_runs(matrix.row(i), n)).collect();
    let mut out = Vec::new();
    let seconds = time(settings, n_asked, n, |i| unpack_runs(&runs[i], n, &mut out));
    add("zero runs (Quake)", runs.iter().map(Vec::len).sum::<usize>() + 4 * n, seconds);
    let distinct = Distinct::new(matrix);
    let bits = &distinct.bits;
    let map = if bits.n_rows() == n { 0 } else { 4 * n };
    for coding in RowCoding::ALL {
        for per_block in [64, 256] {
            let coded = CodedRows::new(bits, coding, per_block).map_err(|e| failed(e.into()))?;
            let n_asked = n_asked.min(300);
            let seconds = time(settings, n_asked, bits.n_rows(), |i| coded.row(i, &mut out));
            let name = format!("zstd ({coding:?}): {per_block} rows a block").to_lowercase();
            add(&name, coded.n_bytes() + map, seconds);
        }
    }
    let (bytes, report) = pack_report(table, &PackOptions::default()).map_err(|e| failed(e.into()))?;
    for (cache, what) in [(0, "packed (nothing cached)"), (usize::MAX, "packed (all cached)")] {
        let packed = Packed::open(bytes.clone(), cache).map_err(|e| failed(e.into()))?;
        if cache > 0 {
            (0..n).try_for_each(|i| packed.visible(CellId(i as u32), &mut cells)).map_err(|e| failed(e.into()))?;
        }
        let mut broken = None;
        let seconds = time(settings, n_asked.min(500), n, |i| {
            if let Err(error) = packed.visible(CellId(i as u32), &mut cells) {
                broken = Some(error);
            }
        });
        if let Some(error) = broken {
            return Err(failed(error.into()));
        }
        add(what, report.row_bytes as usize, seconds);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codings_save_bytes() {
        let settings = Settings { quick: true, data: None, machine: "test".into(), commit: "test".into() };
        let rows = PackedFamily.measure(&settings).unwrap();
        assert_eq!(rows.len(), 20, "two tables in ten codings");
        assert!(rows.iter().all(|r| r.seconds > Some(0.0) && r.bytes > Some(0)));
        // Of tables of a few hundred bytes the heads weigh more than what is saved.
        let bytes = |name: &str| rows[..10].iter().find(|r| r.method.starts_with(name)).unwrap().bytes.unwrap();
        assert!(bytes("packed") < bytes("dense") && bytes("zstd (plain)") < bytes("zero runs"), "{rows:?}");
        assert_eq!(PackedFamily.panels(&rows).len(), 2);
    }
}
