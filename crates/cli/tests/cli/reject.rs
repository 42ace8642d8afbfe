//! REJECT lumps through the command line.

use crate::common::{Folder, wad};
use serde_json::json;
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::{RejectTable, Wad};

pub(crate) fn tables(bytes: Vec<u8>) -> Vec<Option<RejectTable>> {
    let wad = Wad::parse(bytes).expect("a sound WAD");
    let table =
        |map: DoomMap| map.reject().map(|lump| RejectTable::from_bytes(map.n_sectors(), lump).expect("a full table"));
    list_maps(&wad).iter().map(|lumps| table(DoomMap::parse(&wad, lumps).expect("a sound map"))).collect()
}

#[test]
fn tables_are_written_and_hand_made_ones_kept() {
    let folder = Folder::with_wad();
    let reply = folder.run(&["reject", "maps.wad", "-o", "out.wad", "--json"]).expect(0).json();
    let status = |i: usize| reply["maps"][i]["status"].as_str().unwrap().to_owned();
    assert_eq!([status(0), status(1), status(2)], ["written", "kept", "written"]);
    let made = tables(folder.read("out.wad"));
    for i in [0, 2] {
        let table = made[i].as_ref().expect("a table");
        assert!(table.n_rejected() > 0 && !table.has_hand_made_effects());
        assert_eq!(reply["maps"][i]["n_rejected"], table.n_rejected());
    }
    assert_eq!(made[1], tables(folder.read("maps.wad"))[1]);
    let forced = folder.run(&["reject", "maps.wad", "-o", "forced.wad", "--force"]).expect(0).out;
    assert!(forced.starts_with("MAP01 ") && forced.ends_with("wrote forced.wad: 3 of 3 maps built\n"), "{forced}");
    assert!(!tables(folder.read("forced.wad"))[1].as_ref().unwrap().has_hand_made_effects());
}

#[test]
fn only_the_named_maps_are_done_and_other_lumps_stay() {
    let folder = Folder::with_wad();
    let reply = folder.run(&["reject", "maps.wad", "-o", "out.wad", "--map", "map03", "--json"]).expect(0).json();
    assert_eq!((reply["maps"].as_array().unwrap().len(), &reply["maps"][0]["name"]), (1, &json!("MAP03")));
    let made = tables(folder.read("out.wad"));
    assert!(made[0].is_none() && made[2].is_some());
    let [before, after] = ["maps.wad", "out.wad"].map(|name| Wad::parse(folder.read(name)).unwrap());
    let others = |wad: &Wad| -> Vec<(String, Vec<u8>)> {
        let lump = |i: usize| (wad.lumps()[i].name.to_string(), wad.lump_bytes(i).to_vec());
        (0..wad.lumps().len()).map(lump).filter(|(name, _)| name != "REJECT").collect()
    };
    assert_eq!(others(&before), others(&after));
}

/// The output may be the input, and the same bytes come out with any number of threads.
#[test]
fn files_are_replaced_in_place_and_deterministically() {
    let folder = Folder::with_wad();
    folder.run(&["reject", "maps.wad", "-o", "one.wad", "--threads", "1"]).expect(0);
    folder.run(&["reject", "maps.wad", "-o", "two.wad", "--threads", "2"]).expect(0);
    folder.run(&["reject", "maps.wad", "-o", "maps.wad"]).expect(0);
    assert_eq!(folder.read("one.wad"), folder.read("two.wad"));
    assert_eq!(folder.read("one.wad"), folder.read("maps.wad"));
    assert_ne!(folder.read("one.wad"), wad(&["MAP01", "MAP02", "MAP03"]));
    // What was built is built the same again, now in place.
    folder.run(&["reject", "maps.wad", "-o", "maps.wad"]).expect(0);
    assert_eq!(folder.read("one.wad"), folder.read("maps.wad"));
    assert_eq!(folder.names(), ["maps.wad", "one.wad", "two.wad"]);
}

/// Pairs both rejected and witnessed: bytes of the lump AND bytes of what was seen.
fn n_wrong(table: &RejectTable, seen: &[u8]) -> u32 {
    assert_eq!(table.as_bytes().len(), seen.len(), "both speak of the same sectors");
    table.as_bytes().iter().zip(seen).map(|(a, b)| (a & b).count_ones()).sum()
}

/// On a real map: nothing that was seen is rejected, and nearly all else is.
#[test]
fn a_real_map_is_rejected_soundly_and_tightly() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED: SIGHTLINES_DATA is not set, no real map was tried");
        return;
    };
    let doom = std::path::Path::new(&data).join("doom");
    let folder = Folder::new();
    folder.write("e1m6.wad", std::fs::read(doom.join("freedoom1_E1M6.wad")).expect("the map"));
    let seen = std::fs::read(doom.join("freedoom1_E1M6.seen.bin")).expect("what was seen");
    folder.run(&["reject", "e1m6.wad", "-o", "out.wad"]).expect(0);
    let Some(Some(table)) = tables(folder.read("out.wad")).pop() else { panic!("a table") };
    assert_eq!(n_wrong(&table, &seen), 0);
    let n = u64::from(table.n_sectors());
    let n_seen: u64 = seen.iter().map(|b| u64::from(b.count_ones())).sum();
    let tightness = table.n_rejected() as f64 / (n * n - n_seen) as f64;
    assert!(tightness > 0.999, "only {tightness} of what was not seen is rejected");
    // The impostor: the lump that the map was shipped with rejects what was seen.
    let Some(Some(shipped)) = tables(folder.read("e1m6.wad")).pop() else { panic!("a table") };
    assert!(n_wrong(&shipped, &seen) > 0);
}

/// The effects of an option file of RMB are made on top of what was built, again and again; what is wrong in it is named with its line.
#[test]
fn effects_of_option_files_are_made() {
    let folder = Folder::with_wad();
    folder.run(&["reject", "maps.wad", "-o", "plain.wad", "--force"]).expect(0);
    folder.write("maps.rej", "# sector 1 is blind but to itself\nMAP01\nblind 1 (1)\nMAP02\nINC 0 (0)\nEXC (2) (2)\n");
    let args = ["reject", "maps.wad", "-o", "out.wad", "--rmb", "maps.rej"];
    let said = folder.run(&args).expect(0).out;
    let reply = folder.run(&[&args[..], &["--json"]].concat()).expect(0).json();
    let [plain, made] = ["plain.wad", "out.wad"].map(|name| tables(folder.read(name)));
    let n = plain[0].as_ref().expect("a table").n_sectors();
    for (k, changes) in [(0, true), (1, true), (2, false)] {
        let [plain, made] = [&plain, &made].map(|tables| tables[k].as_ref().expect("a table"));
        let mut expected = plain.clone();
        match k {
            0 => (0..n).filter(|&s| s != 1).for_each(|s| expected.set(1, s, true)),
            1 => expected.set(2, 2, true),
            _ => {}
        }
        assert_eq!(made, &expected);
        let n_effects = expected.n_rejected() - plain.n_rejected();
        assert_eq!((n_effects > 0, &reply["maps"][k]["n_effects"]), (changes, &json!(n_effects)));
        assert_eq!(made.has_hand_made_effects(), changes);
    }
    assert!(said.contains("1 pair changed by effects"), "{said}");
    // The next time, the file still has the last word; without it, what it made is kept.
    folder.run(&["reject", "out.wad", "-o", "again.wad", "--rmb", "maps.rej"]).expect(0);
    folder.run(&["reject", "out.wad", "-o", "kept.wad"]).expect(0);
    assert!(folder.read("again.wad") == folder.read("out.wad") && folder.read("kept.wad") == folder.read("out.wad"));

    for (options, place) in [
        ("BLIND 0 (1)\nLEFT 3\n", "bad.rej: line 2: the option LEFT is not supported"),
        ("\nBLIND 0 (60000)\n", "bad.rej: line 2: sector 60000 is not among the "),
    ] {
        folder.write("bad.rej", options);
        let error = folder.refused(&["reject", "maps.wad", "-o", "none.wad", "--rmb", "bad.rej"]);
        assert!(error.starts_with(place), "{error}");
    }
    let error = folder.refused(&["reject", "maps.wad", "-o", "none.wad", "--rmb", "absent.rej"]);
    assert!(error.starts_with("absent.rej: "), "{error}");
    assert!(!folder.names().contains(&"none.wad".to_owned()));
}
