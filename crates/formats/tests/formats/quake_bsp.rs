//! Maps: what is read, what is refused, and that another visibility lump changes nothing else.

use crate::common::quake::{SmallBsp, check_bsp, difference_besides_visibility, small_bsps};
use proptest::prelude::*;
use sightlines_formats::quake::bsp::{AmbientKind, AmbientTexture, AmbientTextures, LeafRow};
use sightlines_formats::quake::visibility::{
    self, VisibilityLump, ambient, check_match, check_portals, lump_with_new_hearing, lump_with_sounds, read_hearing,
    read_visibility,
};
use sightlines_formats::quake::{Bsp, BspFormat, LeafClusters, Prt, VisibilityError, read_bsp};
use sightlines_pvs::BitMatrix;
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

fn small(format: BspFormat) -> Bsp {
    Bsp::parse(SmallBsp::new(format).file(false)).unwrap()
}

fn refused(bytes: &[u8]) -> String {
    Bsp::parse(bytes.to_vec()).expect_err("a map that is wrong").to_string()
}

/// The leafs of the small maps in three clusters, the middle one of two leafs. In the order of Quake II.
fn three_clusters(format: BspFormat) -> LeafClusters {
    match format.has_clusters() {
        true => LeafClusters::identity(3).unwrap(),
        false => LeafClusters::new(3, vec![1, 2, 0, 1]).unwrap(),
    }
}

/// Cluster 0 sees 1, 1 sees 2, and back.
fn chain() -> BitMatrix {
    let mut seen = BitMatrix::identity(3);
    for (a, b) in [(0, 1), (1, 0), (1, 2), (2, 1)] {
        seen.set(a, b, true);
    }
    seen
}

#[test]
fn leafs_are_read() {
    for format in BspFormat::ALL {
        let bsp = small(format);
        assert_eq!((bsp.format(), bsp.leafs().len()), (format, 6));
        assert!(bsp.visibility().is_empty() && bsp.extra_lumps().is_empty());
        let leaf = bsp.leafs()[2];
        let contents = if format.has_clusters() { 0 } else { -1 };
        assert_eq!((leaf.contents, leaf.mins, leaf.maxs), (contents, [0.0; 3], [64.0; 3]));
        assert_eq!((leaf.first_face, leaf.n_faces), (1, 2));
        let rows: Vec<LeafRow> = bsp.leafs().iter().map(|l| l.row).collect();
        if format.has_clusters() {
            let [c0, c1, c2] = [0, 1, 2].map(LeafRow::Cluster);
            assert_eq!(rows, [LeafRow::Solid, c2, c0, c1, c0, LeafRow::Solid]);
            assert_eq!((bsp.n_clusters(), bsp.n_visible_leafs(), leaf.ambient), (3, 5, [0; 4]));
        } else {
            assert_eq!(rows, [LeafRow::All; 6]);
            assert_eq!((bsp.n_clusters(), bsp.n_visible_leafs(), leaf.ambient), (0, 4, [9; 4]));
        }
        assert_eq!(bsp.visible_leafs().len(), bsp.n_visible_leafs());
    }
}

#[test]
fn sounds_are_looked_up() {
    for format in BspFormat::ALL.into_iter().filter(|format| format.has_sounds()) {
        assert_eq!(small(format).leaf_sounds(), Ok(vec![0, 0b0001, 0, 0b1010]), "{format:?}");
        let levels = ambient(&small(format), &three_clusters(format), &chain()).unwrap();
        // Water and lava lie in cluster 2 and the middle one; cluster 0 sees only the middle one.
        let (some, all) = ([0, 255, 0, 255], [255, 255, 0, 255]);
        assert_eq!(levels, [all, all, some, all].map(|l: [u8; 4]| l));
        let alone = ambient(&small(format), &three_clusters(format), &BitMatrix::identity(3)).unwrap();
        assert_eq!(alone, [[0, 255, 0, 255], [255, 0, 0, 0], [0; 4], [0, 255, 0, 255]]);
    }
    assert_eq!(small(BspFormat::Quake2).leaf_sounds(), Ok(vec![0; 5]));
    assert_eq!(small(BspFormat::HalfLife).leaf_sounds(), Ok(vec![0; 4]));
    // A map without textures makes no sounds; one whose textures are cut off is refused.
    let with = |lump: usize, bytes: &[u8]| {
        let map = SmallBsp::new(BspFormat::Bsp29);
        let file = map.file(false);
        let mut changed = file.clone();
        let at = changed.len() as u32;
        changed[4 + 8 * lump..][..4].copy_from_slice(&at.to_le_bytes());
        changed[8 + 8 * lump..][..4].copy_from_slice(&(bytes.len() as u32).to_le_bytes());
        changed.extend(bytes);
        Bsp::parse(changed).unwrap().leaf_sounds().map_err(|error| error.to_string())
    };
    let no_texture = Err("leaf 1: face 0 has a texture that is not in the file".to_owned());
    assert_eq!(with(2, &[]), Ok(vec![0; 4]));
    assert_eq!(with(2, &[1, 0, 0, 0, 9, 0, 0, 0]), no_texture.clone());
    assert_eq!(with(7, &[]), Err("leaf 1: there is no face 0 among 0".to_owned()));
    assert_eq!(with(6, &[]), no_texture);
    let beyond = "leaf 2: faces 1 to 1 + 2 of the list are not among its 2";
    assert_eq!(with(11, &[0, 0, 1, 0]), Err(beyond.to_owned()));
}

#[test]
fn broken_maps_are_refused() {
    assert_eq!(refused(b""), "not a map: 0 bytes are less than a header of 124");
    assert_eq!(refused(b"BSP2 and then nothing"), "not a map: 21 bytes are less than a header of 124");
    let known = "not with version 29 or 30, BSP2, 2PSB, IBSP and version 38, 46 or 47, or QBSP and version 38";
    assert_eq!(refused(&[30; 200]), format!("not a map: it begins with \"{}\", {known}", "\\x1e".repeat(8)));
    assert_eq!(refused(b"IBSP\x30\0\0\0"), format!("not a map: it begins with \"IBSP0\\x00\\x00\\x00\", {known}"));
    let file = SmallBsp::new(BspFormat::Bsp29).file(false);
    let with = |at: usize, number: i32| {
        let mut bytes = file.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        refused(&bytes)
    };
    let place = |lump: usize| 4 + 8 * lump;
    let starts = |lump: usize| Bsp::parse(file.clone()).unwrap().lumps()[lump].start;
    let len = file.len();
    let long = format!("lump 5 (nodes): 3 bytes at byte {len} are not inside the file of {len} bytes");
    assert_eq!(with(place(5), len as i32), long);
    assert!(with(place(5), -4).starts_with("lump 5 (nodes): 3 bytes at byte -4 are not inside"));
    assert!(with(place(5) + 4, i32::MIN).starts_with("lump 5 (nodes): -2147483648 bytes at byte "));
    assert!(with(place(5) + 4, i32::MAX).starts_with("lump 5 (nodes): 2147483647 bytes at byte "));
    assert_eq!(with(place(0), 120), "lump 0 (entities) overlaps the header");
    assert_eq!(with(place(10) + 4, 29), "lump 10 (leafs): 29 bytes are no whole number of records of 28");
    assert_eq!(with(place(14) + 4, 0), "lump 14 (models): there is no model 0");
    for found in [-1, 6, i32::MAX] {
        let text = format!("model 0 has {found} visible leafs, but there are 6 leafs, one of them for what is solid");
        assert_eq!(with(starts(14) + 52, found), text);
    }
    assert_eq!(with(starts(10) + 3 * 28 + 4, -7), "leaf 3: -7 is no place of a row");
    let mut quake2 = SmallBsp::new(BspFormat::Quake2);
    quake2.clusters[1] = -2;
    assert_eq!(refused(&quake2.file(false)), "leaf 2: -2 is no cluster");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.bsp");
    std::fs::write(&path, &file[..100]).unwrap();
    let text = read_bsp(&path).unwrap_err().to_string();
    assert!(text.ends_with("room.bsp: not a map: 100 bytes are less than a header of 124"), "{text}");
}

#[test]
fn additional_lumps_are_checked() {
    let mut map = SmallBsp::new(BspFormat::Bsp2);
    map.extra = Some(vec![("A", vec![7; 6]), ("B", vec![8; 3])]);
    let file = map.file(false);
    let bsp = Bsp::parse(file.clone()).unwrap();
    let extra: Vec<_> = bsp.extra_lumps().into_iter().map(|(name, range)| (name, &file[range])).collect();
    assert_eq!(extra, [(&b"A"[..], &[7; 6][..]), (b"B", &[8; 3])]);
    let at = file.windows(4).position(|w| w == b"BSPX").unwrap();
    let with = |place: usize, number: u32| {
        let mut bytes = file.clone();
        bytes[at + place..at + place + 4].copy_from_slice(&number.to_le_bytes());
        refused(&bytes)
    };
    let text = |n: u32, bad: usize| {
        format!("the BSPX directory at byte {at} is not sound: {n} lumps, the first bad one is {bad}")
    };
    assert_eq!(with(4, 1_000_000_000), text(1_000_000_000, 0));
    assert_eq!(with(8 + 32 + 28, 4), text(2, 1));
    assert_eq!(with(8 + 24, 8), text(2, 0));
    assert_eq!(with(8 + 28, u32::MAX), text(2, 0));
}

#[test]
fn visibility_is_written_as_engines_load_it() {
    for format in BspFormat::ALL.into_iter().filter(|format| !format.has_clusters()) {
        let lump = visibility::lump(&small(format), &three_clusters(format), &chain()).unwrap();
        // Bits are leafs 2 0 3 1 by cluster 0, 1, 1, 2: rows of clusters 0, 1 and 2.
        assert_eq!(lump.bytes, [0b1101, 0b1111, 0b1011]);
        assert_eq!(lump.leaf_rows, [1, 2, 0, 1]);
    }
    let bsp = small(BspFormat::Quake2);
    let lump = visibility::lump(&bsp, &three_clusters(BspFormat::Quake2), &chain()).unwrap();
    let numbers: Vec<u32> = lump.bytes[..28].chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(numbers, [3, 28, 31, 29, 32, 30, 33]);
    assert_eq!(lump.bytes[28..], [0b011, 0b111, 0b110, 0b111, 0b111, 0b111]);
    assert!(lump.leaf_rows.is_empty() && lump.ambient.is_empty());
    let after = Bsp::parse(bsp.with_visibility(&lump).unwrap()).unwrap();
    assert_eq!(read_hearing(&after).unwrap().unwrap().count_ones(), 9);
    assert_eq!(read_hearing(&bsp), Ok(None));
}

/// Hearing is made anew from what is visible, whatever was heard; visibility is left as it is.
#[test]
fn hearing_is_made_from_visibility() {
    let mut map = SmallBsp::new(BspFormat::Quake2);
    let places: Vec<u8> = [3u32, 28, 28, 29, 28, 30, 28].iter().flat_map(|n| n.to_le_bytes()).collect();
    map.visibility = [&places[..], &[3, 7, 6]].concat();
    let before = Bsp::parse(map.file(false)).unwrap();
    assert_eq!(read_hearing(&before).unwrap().unwrap().count_ones(), 6, "too little");
    let made = lump_with_new_hearing(&before).unwrap().unwrap();
    let leafs = three_clusters(BspFormat::Quake2);
    assert_eq!(made, visibility::lump(&before, &leafs, &chain()).unwrap());
    let after = Bsp::parse(before.with_visibility(&made).unwrap()).unwrap();
    assert_eq!(read_visibility(&after, &leafs), read_visibility(&before, &leafs));
    assert_eq!(read_hearing(&after).unwrap().unwrap().count_ones(), 9);
    // A row that is not there; and maps in which nothing is heard, or seen yet.
    map.visibility.truncate(30);
    let text = lump_with_new_hearing(&Bsp::parse(map.file(false)).unwrap()).unwrap_err().to_string();
    assert_eq!(text, "cluster 2: its row begins at byte 30 of the 30 bytes of the visibility lump");
    let none = |file: &[u8]| lump_with_new_hearing(&Bsp::parse(file.to_vec()).unwrap()).unwrap().is_none();
    // One of Quake II and one of Qbism has rows.
    assert_eq!(small_bsps().iter().filter(|file| !none(file)).count(), 2);
}

/// Each kind of texture is silent when it is turned off, and no other.
#[test]
fn textures_are_silenced_one_by_one() {
    for format in [BspFormat::Bsp29, BspFormat::Bsp2, BspFormat::Bsp2Psb] {
        let mut map = SmallBsp::new(format);
        map.leafs = vec![vec!["*water1"], vec!["*slime"], vec!["SKY1", "*04water"], vec!["*lava", "brick"]];
        let bsp = Bsp::parse(map.file(false)).unwrap();
        let all = [0b0001, 0b0001, 0b0011, 0b1000];
        assert_eq!(bsp.leaf_sounds().unwrap(), all);
        for (texture, left) in [
            (AmbientTexture::Water, [0, 1, 0b0010, 0b1000]),
            (AmbientTexture::Slime, [1, 0, 0b0011, 0b1000]),
            (AmbientTexture::Sky, [1, 1, 0b0001, 0b1000]),
            (AmbientTexture::Lava, [1, 1, 0b0011, 0]),
        ] {
            let loud = AmbientTextures::ALL.without(texture);
            assert_eq!(bsp.leaf_sounds_of(loud).unwrap(), left, "{texture:?}");
            let leafs = LeafClusters::identity(4).unwrap();
            let made = lump_with_sounds(&bsp, &leafs, &BitMatrix::identity(4), loud).unwrap();
            let bits = |levels: &[u8; 4]| (0..4).fold(0, |bits, k| bits | u8::from(levels[k] == 255) << k);
            assert_eq!(made.ambient.iter().map(bits).collect::<Vec<_>>(), left, "{texture:?}");
        }
    }
}

#[test]
fn another_lump_changes_nothing_else() {
    for file in small_bsps() {
        let bsp = Bsp::parse(file).unwrap();
        let leafs = three_clusters(bsp.format());
        let lump = visibility::lump(&bsp, &leafs, &chain()).unwrap();
        for n_more in [0, 1, 2, 3, 4, 97] {
            let bytes = [lump.bytes.clone(), vec![1; n_more]].concat();
            let written = bsp.with_visibility(&VisibilityLump { bytes: bytes.clone(), ..lump.clone() }).unwrap();
            let after = Bsp::parse(written).unwrap();
            assert_eq!(after.visibility(), bytes);
            assert_eq!(difference_besides_visibility(&bsp, &after), None);
            assert_eq!(read_visibility(&after, &leafs), Ok(Some(chain())));
            let rows: Vec<LeafRow> = lump.leaf_rows.iter().map(|&row| LeafRow::At(row)).collect();
            if !bsp.format().has_clusters() {
                let found: Vec<_> = after.visible_leafs().iter().map(|l| (l.row, l.ambient)).collect();
                let levels = if bsp.format().has_sounds() { lump.ambient.clone() } else { vec![[9; 4]; 4] };
                assert_eq!(found, rows.into_iter().zip(levels).collect::<Vec<_>>());
                assert_eq!(after.leafs()[5], bsp.leafs()[5], "what cannot be seen stays as it was");
            }
            assert!(after.as_bytes().len() <= bsp.as_bytes().len() + bytes.len() + 7);
            assert_eq!(after.extra_lumps().len(), bsp.extra_lumps().len());
        }
    }
}

/// The comparison that the tests rest on sees one changed byte anywhere but in visibility.
#[test]
fn differences_are_found() {
    let mut n_found = 0;
    for file in small_bsps() {
        let before = Bsp::parse(file.clone()).unwrap();
        let format = before.format();
        for lump in (0..before.lumps().len()).filter(|&k| k != format.visibility_lump()) {
            let mut changed = file.clone();
            changed[before.lumps()[lump].start] ^= 1;
            let Ok(after) = Bsp::parse(changed) else { continue };
            assert!(difference_besides_visibility(&before, &after).is_some_and(|text| text.contains("differs")));
            n_found += 1;
        }
        for (_, range) in before.extra_lumps().into_iter().filter(|(_, range)| !range.is_empty()) {
            let mut changed = file.clone();
            changed[range.start] ^= 1;
            assert!(difference_besides_visibility(&before, &Bsp::parse(changed).unwrap()).is_some());
        }
    }
    assert!(n_found > 100, "{n_found}");
}

#[test]
fn lumps_that_share_bytes_are_not_torn() {
    let file = SmallBsp { visibility: vec![15, 0, 1], ..SmallBsp::new(BspFormat::Bsp29) }.file(false);
    let bsp = Bsp::parse(file.clone()).unwrap();
    let leafs = three_clusters(BspFormat::Bsp29);
    let lump = visibility::lump(&bsp, &leafs, &chain()).unwrap();
    // Visibility inside the textures, at an odd place, and at a place that is none: it goes to the end.
    let inside = bsp.lumps()[2].start as u32 + 8;
    for (offset, len) in
        [(inside, 3u32), (inside, 0), (inside + 1, 0), (7, 0), (u32::MAX, 0), (file.len() as u32 + 9, 0)]
    {
        let mut bytes = file.clone();
        bytes[4 + 8 * 4..][..4].copy_from_slice(&offset.to_le_bytes());
        bytes[8 + 8 * 4..][..4].copy_from_slice(&len.to_le_bytes());
        let before = Bsp::parse(bytes).unwrap();
        let after = Bsp::parse(before.with_visibility(&lump).unwrap()).unwrap();
        assert_eq!(difference_besides_visibility(&before, &after), None);
        assert_eq!(read_visibility(&after, &leafs), Ok(Some(chain())));
        assert!(after.lumps()[4].start >= file.len() && after.lumps()[4].start.is_multiple_of(4));
    }
    // Entities over leafs, which have to change: refused.
    let mut bytes = file.clone();
    let start = bsp.lumps()[10].start as u32 + 28;
    bytes[4..8].copy_from_slice(&start.to_le_bytes());
    let shared = "lump 10 (leafs) has to change, but lump 0 (entities) lies over it";
    let under = Bsp::parse(bytes).unwrap();
    assert_eq!(under.with_visibility(&lump).unwrap_err().to_string(), shared);
    assert_eq!(under.check_leafs().unwrap_err().to_string(), shared, "known before there is a lump");
    assert_eq!(bsp.check_leafs(), Ok(()));
    let few = VisibilityLump { leaf_rows: vec![0; 3], ..lump };
    let few = bsp.with_visibility(&few).unwrap_err().to_string();
    assert_eq!(few, "the rows are for 3 leafs, the map has 4 that can be seen");
}

#[test]
fn portals_of_another_map_are_refused() {
    let bsp = small(BspFormat::Bsp29);
    let text = |leafs: LeafClusters, bsp: &Bsp| check_match(bsp, &leafs).unwrap_err().to_string();
    let other = LeafClusters::identity(5).unwrap();
    assert_eq!(text(other.clone(), &bsp), "the portals are of a map with 5 leafs, this one has 4 that can be seen");
    let quake2 = small(BspFormat::Quake2);
    assert_eq!(text(other.clone(), &quake2), "the portals are of a map with 5 clusters, this one has 3");
    let wrong = VisibilityError::Leafs { portals: 5, map: 4 };
    assert_eq!(visibility::lump(&bsp, &other, &BitMatrix::identity(5)), Err(wrong.clone()));
    assert_eq!(read_visibility(&bsp, &other), Err(wrong.clone()));
    assert_eq!(ambient(&bsp, &other, &BitMatrix::identity(5)), Err(wrong));
    // As many leafs, but elsewhere: the leafs are a cube of 64 units at the origin.
    let portals = |at: f64, n_far: usize| {
        let mut prt = Prt::new(4).unwrap();
        for portal in 0..4 {
            let x = if portal < n_far { at } else { 64.0 };
            prt.push_portal([0, 1], &[[x, 0.0, 0.0], [x, 64.0, 0.0], [x, 0.0, 65.0]]).unwrap();
        }
        check_portals(&bsp, &prt)
    };
    assert_eq!([portals(66.0, 0), portals(65.0, 4), portals(66.0, 2)], [Ok(()), Ok(()), Ok(())]);
    assert_eq!(portals(66.0, 3), Err(VisibilityError::OtherMap { n_outside: 6, n_sides: 8 }));
    let text = "the portals are of another map: 8 of 8 sides lie outside the leafs that they belong to";
    assert_eq!(portals(-1e6, 4).unwrap_err().to_string(), text);
    assert!(
        check_portals(&quake2, &Prt::new(3).unwrap()).is_ok() && check_portals(&quake2, &Prt::new(4).unwrap()).is_err()
    );
    let small = visibility::lump(&bsp, &three_clusters(BspFormat::Bsp29), &BitMatrix::identity(2)).unwrap_err();
    assert_eq!(small.to_string(), "2 rows of 2 bits are not for 3 clusters");
}

#[test]
fn broken_rows_are_refused() {
    let map = |visibility: Vec<u8>, row: i32| {
        let mut file = SmallBsp { visibility, ..SmallBsp::new(BspFormat::Bsp29) }.file(false);
        let start = Bsp::parse(file.clone()).unwrap().lumps()[10].start;
        file[start + 3 * 28 + 4..][..4].copy_from_slice(&row.to_le_bytes());
        read_visibility(&Bsp::parse(file).unwrap(), &LeafClusters::identity(4).unwrap())
    };
    let seen = map(vec![0b0110], 0).unwrap().unwrap();
    // Leaf 3 is column 2; all others see everything.
    assert_eq!(seen.iter_ones(2).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(seen.count_ones(), 4 + 4 + 2 + 4);
    assert_eq!(map(vec![], 0), Ok(None));
    let text = |bytes: Vec<u8>, row| map(bytes, row).unwrap_err().to_string();
    assert_eq!(text(vec![1], 1), "leaf 3: its row begins at byte 1 of the 1 bytes of the visibility lump");
    assert_eq!(
        text(vec![1], i32::MAX),
        "leaf 3: its row begins at byte 2147483647 of the 1 bytes of the visibility lump"
    );
    let row = "leaf 3: its row at byte 0 of the visibility lump: ";
    assert_eq!(text(vec![0], 0), format!("{row}the bytes end after 0 of 1 bytes of a row"));
    assert_eq!(text(vec![0, 2], 0), format!("{row}a run of 2 zeros at byte 0 of a row goes past its 1 bytes"));
    let quake2 = |visibility: Vec<u8>| {
        let file = SmallBsp { visibility, ..SmallBsp::new(BspFormat::Quake2) }.file(false);
        let read = read_visibility(&Bsp::parse(file).unwrap(), &LeafClusters::identity(3).unwrap());
        read.unwrap_err().to_string()
    };
    let numbers = |n: &[u32]| n.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    assert_eq!(
        quake2(vec![3, 0]),
        "the visibility lump of 2 bytes has no room for the places of the rows of 0 clusters"
    );
    assert_eq!(
        quake2(numbers(&[3])),
        "the visibility lump of 4 bytes has no room for the places of the rows of 3 clusters"
    );
    assert_eq!(quake2(numbers(&[1 << 30])), "the visibility lump is for 1073741824 clusters, the leafs have 3");
    let last = "cluster 0: its row begins at byte 28 of the 28 bytes of the visibility lump";
    assert_eq!(quake2(numbers(&[3, 28, 0, 0, 0, 0, 0])), last);
    let short = "cluster 0: its row at byte 27 of the visibility lump: the bytes end after 0 of 1 bytes of a row";
    assert_eq!(quake2(numbers(&[3, 27, 0, 0, 0, 0, 0])), short);
}

#[test]
fn every_prefix_and_flipped_bit_is_read_or_refused() {
    for file in small_bsps() {
        assert!(check_bsp(&file));
        // Every lump ends before the end of what lies behind it, so few prefixes have all of them.
        let n_read = (0..file.len()).filter(|&len| check_bsp(&file[..len])).count();
        assert!(n_read < 160, "{n_read} prefixes of {} are read", file.len());
        let flipped = flipped_bits(&file).filter(|f| check_bsp(f)).count();
        assert!(flipped > file.len(), "{flipped} flipped files of {} are read", file.len());
    }
}

#[test]
fn damaged_maps_are_read_or_refused() {
    let rounds = crate::common::setting("SIGHTLINES_FUZZ_ROUNDS", 5_000);
    let first = crate::common::setting("SIGHTLINES_FUZZ_SEED", 0);
    let files = small_bsps();
    let accepted = (first..first + rounds)
        .filter(|&number| {
            let broken = mutate(&files[number as usize % files.len()], &mut SplitMix::new(number));
            std::panic::catch_unwind(|| check_bsp(&broken)).unwrap_or_else(|_| {
                panic!("replay with SIGHTLINES_FUZZ_ROUNDS=1 SIGHTLINES_FUZZ_SEED={number}: {broken:?}")
            })
        })
        .count() as u64;
    assert!((rounds / 100..=rounds * 95 / 100).contains(&accepted) || rounds < 1000, "{accepted} of {rounds} accepted");
}

/// A map of Quake with this many leafs, all of them of one cluster each.
fn rooms(n: usize) -> Bsp {
    let leafs = vec![vec!["brick"]; n];
    Bsp::parse(SmallBsp { leafs, n_visible: n, ..SmallBsp::new(BspFormat::Bsp29) }.file(false)).unwrap()
}

/// What an engine does with a lump: the row of a leaf, bit by bit. `None` where the bytes end too soon.
fn engine_sees(lump: &[u8], offset: u32, n_leafs: usize) -> Option<Vec<bool>> {
    let (mut at, mut bits) = (offset as usize, Vec::new());
    while bits.len() < n_leafs {
        let byte = *lump.get(at)?;
        let repeat = if byte == 0 { usize::from(*lump.get(at + 1)?) } else { 1 };
        at += if byte == 0 { 2 } else { 1 };
        bits.extend((0..8 * repeat).map(|k| byte >> (k % 8) & 1 == 1));
    }
    bits.truncate(n_leafs);
    Some(bits)
}

proptest! {
    /// Invariant: an engine that loads the map sees from a leaf exactly the leafs of the clusters that the leaf's
    /// cluster sees, and reading the map gives the matrix back.
    #[test]
    fn visibility_reads_as_written(
        clusters in proptest::collection::vec(0..40u32, 1..200),
        pairs in proptest::collection::vec((0..40usize, 0..40usize), 0..300),
        flip in any::<(prop::sample::Index, prop::sample::Index)>(),
    ) {
        let n_leafs = clusters.len();
        let (bsp, leafs) = (rooms(n_leafs), LeafClusters::new(40, clusters.clone()).unwrap());
        let mut seen = BitMatrix::identity(40);
        pairs.into_iter().for_each(|(a, b)| seen.set(a, b, true));
        let lump = visibility::lump(&bsp, &leafs, &seen).unwrap();
        for (leaf, &row) in lump.leaf_rows.iter().enumerate() {
            let bits = engine_sees(&lump.bytes, row, n_leafs).unwrap();
            let expected: Vec<bool> = clusters.iter().map(|&c| seen.get(clusters[leaf] as usize, c as usize)).collect();
            prop_assert_eq!(bits, expected);
        }
        let after = Bsp::parse(bsp.with_visibility(&lump).unwrap()).unwrap();
        prop_assert_eq!(difference_besides_visibility(&bsp, &after), None);
        let read = read_visibility(&after, &leafs).unwrap().unwrap();
        // Clusters without leafs see nothing and are not seen, for they are not in the map.
        let real = |c: usize| !leafs.leafs_of(c).is_empty();
        for (a, b) in (0..40).flat_map(|a| (0..40).map(move |b| (a, b))) {
            prop_assert_eq!(read.get(a, b), seen.get(a, b) && real(a) && real(b), "{} sees {}", a, b);
        }
        // Impostor: one pair the other way, and the lump is another.
        let [a, b] = [flip.0, flip.1].map(|i| clusters[i.index(n_leafs)] as usize);
        seen.set(a, b, !seen.get(a, b));
        prop_assert!(visibility::lump(&bsp, &leafs, &seen).unwrap().bytes != lump.bytes);
    }

    /// The same for Quake II, where what is heard is what is seen from whatever is seen.
    #[test]
    fn quake2_visibility_reads_as_written(
        n in 1..80usize,
        pairs in proptest::collection::vec(any::<(prop::sample::Index, prop::sample::Index)>(), 0..200),
    ) {
        let map = SmallBsp {
            leafs: vec![vec![]; n],
            clusters: (0..n as i16).collect(),
            ..SmallBsp::new(BspFormat::Quake2)
        };
        let bsp = Bsp::parse(map.file(false)).unwrap();
        let leafs = LeafClusters::identity(n as u32).unwrap();
        let mut seen = BitMatrix::identity(n);
        pairs.into_iter().for_each(|(a, b)| seen.set(a.index(n), b.index(n), true));
        let lump = visibility::lump(&bsp, &leafs, &seen).unwrap();
        let number = |at: usize| u32::from_le_bytes(lump.bytes[at..at + 4].try_into().unwrap());
        prop_assert_eq!(number(0) as usize, n);
        for a in 0..n {
            let sees = engine_sees(&lump.bytes, number(4 + 8 * a), n).unwrap();
            let hears = engine_sees(&lump.bytes, number(8 + 8 * a), n).unwrap();
            for b in 0..n {
                prop_assert_eq!(sees[b], seen.get(a, b));
                prop_assert_eq!(hears[b], (0..n).any(|c| seen.get(a, c) && seen.get(c, b)));
            }
        }
        let after = Bsp::parse(bsp.with_visibility(&lump).unwrap()).unwrap();
        prop_assert_eq!(difference_besides_visibility(&bsp, &after), None);
        prop_assert_eq!(read_visibility(&after, &leafs), Ok(Some(seen)));
        // Leafs do not change at all.
        prop_assert_eq!(after.lump_bytes(8), bsp.lump_bytes(8));
    }
}

#[test]
fn textures_sound_by_their_names() {
    let kind = |name: &str| AmbientTexture::of_name(name.as_bytes()).map(AmbientTexture::sound);
    for name in ["*water1", "*WATER", "*04water2", "*slime0", "*Slime"] {
        assert_eq!(kind(name), Some(AmbientKind::Water), "{name}");
    }
    assert_eq!(AmbientTexture::of_name(b"*slime0"), Some(AmbientTexture::Slime));
    assert_eq!((kind("sky4"), kind("SKY")), (Some(AmbientKind::Sky), Some(AmbientKind::Sky)));
    assert_eq!((kind("*lava"), kind("*lava1")), (Some(AmbientKind::Lava), Some(AmbientKind::Lava)));
    for name in ["", "sk", "water", "*teleport", "*04mwat1", "brick\0*water", "*wate\0"] {
        assert_eq!(kind(name), None, "{name:?}");
    }
}

#[test]
fn textures_are_turned_off_one_by_one() {
    let mut loud = AmbientTextures::ALL;
    for (k, texture) in AmbientTexture::ALL.into_iter().enumerate() {
        loud = loud.without(texture).without(texture);
        assert_eq!(AmbientTexture::ALL.map(|t| loud.has(t)), std::array::from_fn(|other| other > k));
    }
}
