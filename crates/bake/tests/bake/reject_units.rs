//! REJECT lumps by several processes: maps are units of work.

use crate::reject::with_door;
use sightlines_bake::{RejectError, RejectOptions, reject_wad};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Wad};
use sightlines_progress::{Halt, Units};
use sightlines_testkit::units::{Memory, Results};

/// Three processes that each do some maps, and one that puts them together, give the file of one process.
#[test]
fn maps_are_units_of_work() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    for (k, width) in [3, 9, 5, 7].into_iter().enumerate() {
        let name = LumpName::new(&format!("MAP0{}", k + 1)).unwrap();
        with_door(width).0.add_to(&mut builder, name).unwrap();
    }
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let run = |store: Option<&Memory>| {
        let units = Units(store.map(|store| store as _));
        reject_wad(&wad, &RejectOptions { threads: 1, units, ..RejectOptions::default() })
    };
    let mut kept = Results::new();
    for third in 0..3 {
        let store = Memory::default().of_part(third, 3);
        assert_eq!(run(Some(&store)), Err(RejectError::Halted(Halt::Shared)));
        kept.append(&mut store.into_results());
    }
    assert_eq!(kept.len(), 4);
    // Of none of the processes: nothing is left to compute.
    let merge = |results: &Results| run(Some(&Memory::with(results).of_part(3, 3)));
    let (alone, merged) = (run(None).unwrap(), merge(&kept).unwrap());
    assert_eq!(merged.bytes, alone.bytes);
    assert!(merged.maps.iter().zip(&alone.maps).all(|(a, b)| (a.name, &a.status) == (b.name, &b.status)));
    // The impostor: the table of another map.
    let [a, b] = [0, 1].map(|k| *kept.keys().nth(k).expect("four results"));
    let (of_a, of_b) = (kept[&a].clone(), kept[&b].clone());
    kept.extend([(a, of_b), (b, of_a)]);
    assert!(merge(&kept).map_or(true, |mixed| mixed.bytes != alone.bytes));
}
