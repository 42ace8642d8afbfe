//! The WAD container: what is read, what is refused, and what an edit changes.

use proptest::prelude::*;
use sightlines_formats::ReadErrorKind;
use sightlines_formats::wad::{Edit, Lump, LumpName, Wad, WadError};
use std::fs::File;

/// A WAD with the given directory: 12 bytes of header, `body` bytes, then the entries.
fn raw(body: usize, entries: &[(i32, i32, &str)]) -> Vec<u8> {
    let mut bytes = b"PWAD".to_vec();
    bytes.extend((entries.len() as i32).to_le_bytes());
    bytes.extend((12 + body as i32).to_le_bytes());
    bytes.extend((0..body).map(|k| k as u8));
    for (offset, size, name) in entries {
        bytes.extend(offset.to_le_bytes());
        bytes.extend(size.to_le_bytes());
        bytes.extend(LumpName::new(name).unwrap().raw());
    }
    bytes
}

fn refused(body: usize, entries: &[(i32, i32, &str)]) -> String {
    Wad::parse(raw(body, entries)).unwrap_err().to_string()
}

#[test]
fn sound_directories_are_read() {
    let wad = Wad::parse(raw(8, &[(12, 4, "A"), (-5, 0, "B"), (16, 4, "C"), (12, 4, "D"), (999, 0, "E")])).unwrap();
    let sizes: Vec<usize> = wad.lumps().iter().map(Lump::size).collect();
    assert_eq!(sizes, [4, 0, 4, 4, 0]);
    assert_eq!((wad.lump_bytes(2), wad.lump_bytes(3)), (&[4, 5, 6, 7][..], &[0, 1, 2, 3][..]));
    assert_eq!(Wad::parse(raw(0, &[])).unwrap().lumps(), []);
    let zeros = Wad::parse(raw(8, &[(12, 4, "REJECT"), (12, 7, "REJECT"), (12, 7, "REJECT")]));
    assert!(zeros.is_ok(), "tables of zeros share their start");
}

#[test]
fn broken_headers_are_refused() {
    let error = |bytes: &[u8]| Wad::parse(bytes.to_vec()).unwrap_err().to_string();
    assert_eq!(error(b"PWAD"), "not a WAD: 4 bytes are less than a header");
    assert_eq!(error(b"PK\x03\x04 and more bytes"), r#"not a WAD: it begins with "PK\x03\x04", not IWAD or PWAD"#);
    let directory = |count: i32, offset: i32| {
        let mut bytes = raw(0, &[]);
        bytes[4..8].copy_from_slice(&count.to_le_bytes());
        bytes[8..12].copy_from_slice(&offset.to_le_bytes());
        error(&bytes)
    };
    let expected = "the directory (2147483647 lumps at byte 12) is not inside the file of 12 bytes";
    assert_eq!(directory(i32::MAX, 12), expected);
    for (count, offset) in [(-1, 12), (0, -1), (i32::MIN, i32::MIN), (1, 0), (0, 13)] {
        assert!(directory(count, offset).contains("is not inside the file"), "{count} {offset}");
    }
}

#[test]
fn broken_lumps_are_refused_by_index_and_name() {
    let place = "are not inside the file of 52 bytes";
    let fine = (12, 4, "FINE");
    assert_eq!(refused(8, &[fine, (20, 33, "A")]), format!("lump 1 (A): 33 bytes at byte 20 {place}"));
    assert_eq!(refused(8, &[fine, (-1, 3, "A")]), format!("lump 1 (A): 3 bytes at byte -1 {place}"));
    assert_eq!(refused(8, &[fine, (12, -3, "A")]), format!("lump 1 (A): -3 bytes at byte 12 {place}"));
    assert_eq!(refused(8, &[fine, (i32::MAX, i32::MAX, "A")]).split(' ').next(), Some("lump"));
    assert_eq!(refused(8, &[fine, (11, 2, "A")]), "lump 1 (A) overlaps the header");
    assert_eq!(refused(8, &[fine, (19, 2, "A")]), "lump 1 (A) overlaps the directory");
    assert_eq!(refused(8, &[(14, 4, "A"), (40, 0, "B"), fine]), "lump 0 (A) and lump 2 (FINE) overlap");
    assert_eq!(refused(8, &[(12, 4, "A"), (12, 5, "B")]), "lump 0 (A) and lump 1 (B) overlap");
    assert_eq!(refused(8, &[(12, 8, "A"), (14, 1, "B"), (16, 1, "C")]), "lump 0 (A) and lump 1 (B) overlap");
    // Those of REJECT are replaced anyway.
    for lost in [(12, 9, "REJECT"), (-1, 3, "REJECT"), (12, -3, "REJECT"), (11, 2, "reject"), (19, 2, "REJECT")] {
        let wad = Wad::parse(raw(8, &[fine, lost])).unwrap();
        assert!(wad.lumps()[1].is_lost() && !wad.lumps()[0].is_lost() && wad.lump_bytes(1).is_empty(), "{lost:?}");
        let after = Wad::parse(wad.with_edits(&[Edit::Replace { lump: 1, bytes: vec![7] }]).unwrap()).unwrap();
        assert!(!after.lumps()[1].is_lost() && after.lump_bytes(1) == [7] && after.lump_bytes(0) == wad.lump_bytes(0));
    }
    assert!(!Wad::parse(raw(8, &[(77, 0, "REJECT")])).unwrap().lumps()[0].is_lost(), "an empty one may be anywhere");
    assert_eq!(refused(8, &[(12, 5, "REJECT"), (13, 4, "REJECT")]), "lump 0 (REJECT) and lump 1 (REJECT) overlap");
    assert_eq!(refused(8, &[(12, 5, "REJECT"), (12, 4, "FOO")]), "lump 0 (REJECT) and lump 1 (FOO) overlap");
}

#[test]
fn files_are_refused_by_name_and_early() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("junk.wad");
    let file = File::create(&path).unwrap();
    // A hundred megabytes of zeros that take no space: only twelve bytes of them are read.
    file.set_len(100 << 20).unwrap();
    let error = Wad::read(&path).unwrap_err().to_string();
    assert!(error.ends_with(r#"junk.wad: not a WAD: it begins with "\x00\x00\x00\x00", not IWAD or PWAD"#), "{error}");
    let absent = Wad::read(folder.path().join("absent.wad")).unwrap_err();
    assert!(matches!(absent.kind, ReadErrorKind::Io(_)) && absent.to_string().contains("absent.wad: "));
    std::fs::write(&path, raw(4, &[(12, 4, "A")])).unwrap();
    assert_eq!(Wad::read(&path).unwrap().lump_bytes(0), [0, 1, 2, 3]);
}

/// Whether a directory is sound, by the definition: pair by pair.
fn sound(body: i32, entries: &[(i32, i32, &str)]) -> bool {
    let (begin, end) = (12, 12 + body);
    let inside = |e: &(i32, i32, &str)| e.1 > 0 && begin <= e.0 && e.0 + e.1 <= end;
    let real: Vec<_> = entries.iter().filter(|e| e.1 != 0 && (inside(e) || e.2 != "REJECT")).collect();
    let apart = |a: &(i32, i32, &str), b: &(i32, i32, &str)| a.0 + a.1 <= b.0 || b.0 + b.1 <= a.0;
    let zeros = |a: &(i32, i32, &str), b: &(i32, i32, &str)| a.0 == b.0 && a.2 == "REJECT" && b.2 == "REJECT";
    let same = |a: &(i32, i32, &str), b: &(i32, i32, &str)| (a.0, a.1) == (b.0, b.1);
    // Names decide only between lumps that are not the same bytes.
    real.iter().all(|e| inside(e)) && real.iter().all(|a| real.iter().all(|b| apart(a, b) || same(a, b) || zeros(a, b)))
}

fn directories() -> impl Strategy<Value = Vec<(i32, i32, &'static str)>> {
    prop::collection::vec((11i32..22, -1i32..5, prop::sample::select(vec!["A", "REJECT"])), 0..6)
}

proptest! {
    /// Invariant: a WAD is read exactly if no lump is outside or meets another in part.
    #[test]
    fn wad_agrees_with_the_definition(entries in directories()) {
        prop_assert_eq!(Wad::parse(raw(8, &entries)).is_ok(), sound(8, &entries));
    }

    /// Invariant: an edited file has the edited lumps and all others, in their order, with their names.
    #[test]
    fn edits_change_what_they_say_and_nothing_else(
        entries in directories(),
        edits in prop::collection::vec((0usize..6, any::<bool>(), prop::collection::vec(any::<u8>(), 0..5)), 0..4),
    ) {
        let Ok(wad) = Wad::parse(raw(8, &entries)) else { return Ok(()) };
        let n = wad.lumps().len();
        let mut expected: Vec<Vec<(LumpName, Vec<u8>)>> =
            (0..n).map(|k| vec![(wad.lumps()[k].name, wad.lump_bytes(k).to_vec())]).collect();
        let mut list = Vec::new();
        for (lump, replace, bytes) in edits.into_iter().filter(|e| e.0 < n) {
            let name = LumpName::from_raw(*b"NEW\0junk");
            if replace {
                expected[lump][0].1.clone_from(&bytes);
                list.push(Edit::Replace { lump, bytes });
            } else {
                expected[lump].truncate(1);
                expected[lump].push((name, bytes.clone()));
                list.push(Edit::InsertAfter { lump, name, bytes });
            }
        }
        let after = Wad::parse(wad.with_edits(&list).unwrap()).unwrap();
        let lumps = after.lumps().iter().enumerate();
        let found: Vec<_> = lumps.map(|(k, lump)| (lump.name, after.lump_bytes(k).to_vec())).collect();
        prop_assert_eq!(found, expected.concat());
        prop_assert_eq!(after.kind(), wad.kind());
    }
}

#[test]
fn no_edit_and_no_change_keep_every_byte() {
    let bytes = raw(9, &[(12, 4, "A"), (12, 4, "B"), (77, 0, "C"), (17, 3, "D")]);
    let wad = Wad::parse(bytes.clone()).unwrap();
    assert_eq!(wad.with_edits(&[]).unwrap(), bytes);
    let same = Edit::Replace { lump: 1, bytes: wad.lump_bytes(1).to_vec() };
    assert_eq!(wad.with_edits(&[same]).unwrap(), bytes, "not even shared bytes are moved");
    let mut expected = bytes;
    expected[17..20].fill(9);
    assert_eq!(wad.with_edits(&[Edit::Replace { lump: 3, bytes: vec![9; 3] }]).unwrap(), expected, "in place");
}

#[test]
fn shared_lumps_stay_shared_unless_replaced() {
    let wad = Wad::parse(raw(8, &[(12, 8, "A"), (12, 8, "B"), (12, 8, "C")])).unwrap();
    let after = Wad::parse(wad.with_edits(&[Edit::Replace { lump: 1, bytes: vec![7; 8] }]).unwrap()).unwrap();
    assert_eq!(after.lumps()[0].range(), after.lumps()[2].range());
    assert_eq!((after.lump_bytes(1), after.lump_bytes(2)), (&[7; 8][..], wad.lump_bytes(2)));
    let n_lumps = 3;
    let missing = wad.with_edits(&[Edit::Replace { lump: 3, bytes: vec![] }]);
    assert_eq!(missing, Err(WadError::NoSuchLump { lump: 3, n_lumps }));
}

#[test]
fn names_end_at_the_first_zero() {
    let junk = LumpName::from_raw(*b"MAP01\0XY");
    assert!(junk.is("MAP01") && junk.is("map01") && !junk.is("MAP0") && !junk.is("MAP01\0"));
    assert_eq!((junk.to_string(), junk.raw()), ("MAP01".to_owned(), *b"MAP01\0XY"));
    assert_ne!(junk, LumpName::new("MAP01").unwrap());
    let full = LumpName::new("LINEDEFS").unwrap();
    assert!(full.is("LINEDEFS") && !full.is("LINEDEF"));
}

#[test]
fn odd_names_are_refused_or_shown_escaped() {
    for bad in ["", "NINECHARS", "ä", "A\0B"] {
        assert!(LumpName::new(bad).is_err(), "{bad:?}");
    }
    assert_eq!(LumpName::from_raw([7, 0xFF, b'A', 0, 0, 0, 0, 0]).to_string(), r"\x07\xffA");
}
