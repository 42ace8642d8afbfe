//! REJECT lumps by several processes: maps are units of work.

use crate::reject::with_door;
use sightlines_bake::{RejectError, RejectOptions, reject_wad};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Wad};
use sightlines_progress::{Halt, Phase, UnitStore, Units};
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Keeps what was computed, and wants only some maps.
#[derive(Default)]
struct Third(Mutex<BTreeMap<usize, Vec<u8>>>, AtomicUsize, usize);

impl UnitStore for Third {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        self.1.store(phase.costs.len(), Relaxed);
        Ok(())
    }

    fn wants(&self, _: &'static str, unit: usize) -> bool {
        unit % 3 == self.2
    }

    fn load(&self, _: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        Ok(self.0.lock().unwrap().get(&unit).cloned())
    }

    fn save(&self, _: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        self.0.lock().unwrap().insert(unit, result.to_vec());
        Ok(())
    }

    fn end(&self, _: &'static str) -> Result<(), Halt> {
        let n = self.1.load(Relaxed);
        if self.0.lock().unwrap().len() == n { Ok(()) } else { Err(Halt::Shared) }
    }
}

/// Three processes that each do some maps, and one that puts them together, give the file of one process.
#[test]
fn maps_are_units_of_work() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    for (k, width) in [3, 9, 5, 7].into_iter().enumerate() {
        let name = LumpName::new(&format!("MAP0{}", k + 1)).unwrap();
        with_door(width).0.add_to(&mut builder, name).unwrap();
    }
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let run = |store: Option<&Third>| {
        let units = Units(store.map(|store| store as _));
        reject_wad(&wad, &RejectOptions { threads: 1, units, ..RejectOptions::default() })
    };
    let mut kept = BTreeMap::new();
    for third in 0..3 {
        let store = Third(Mutex::default(), 0.into(), third);
        assert_eq!(run(Some(&store)), Err(RejectError::Halted(Halt::Shared)));
        kept.append(&mut store.0.lock().unwrap());
    }
    assert_eq!(kept.len(), 4);
    let (alone, merge) = (run(None).unwrap(), Third(Mutex::new(kept), 0.into(), 9));
    let merged = run(Some(&merge)).unwrap();
    assert_eq!(merged.bytes, alone.bytes);
    assert!(merged.maps.iter().zip(&alone.maps).all(|(a, b)| (a.name, &a.status) == (b.name, &b.status)));
    // The impostor: the table of another map.
    let mut others = merge.0.lock().unwrap();
    let (a, b) = (others[&0].clone(), others[&1].clone());
    others.extend([(0, b), (1, a)]);
    drop(others);
    assert!(run(Some(&merge)).map_or(true, |mixed| mixed.bytes != alone.bytes));
}
