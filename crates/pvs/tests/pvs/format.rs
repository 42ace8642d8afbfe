//! The byte format: what is written can be read, and nothing else can.

use crate::common::file::{
    File, Part, assert_damage_is_noticed, assert_every_changed_byte_is_an_error, assert_every_prefix_is_an_error,
    changes, fix_header, forged,
};
use crate::common::{any_parts, assert_well_formed, rooms};
use proptest::prelude::*;
use sightlines_pvs::{CellId, DecodeErrorKind as Kind, LocatorError, Table, TableError};

fn house() -> Table {
    Table::new(rooms()).unwrap()
}

/// A changed file is refused, or is one that would be written.
fn assert_error_or_well_formed(bytes: &[u8]) -> bool {
    match Table::from_bytes(bytes) {
        Ok(table) => {
            assert_well_formed(&table);
            true
        }
        Err(error) => {
            assert!(error.offset <= bytes.len() as u64, "{error}");
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

proptest! {
    #[test]
    fn format_round_trip_is_bit_identical(parts in any_parts()) {
        let table = Table::new(parts).unwrap();
        let bytes = table.to_bytes();
        let read = Table::from_bytes(&bytes).unwrap();
        prop_assert_eq!(&read, &table);
        prop_assert_eq!(read.to_bytes(), bytes);
        let bare = table.strip_geometry();
        prop_assert_eq!(Table::from_bytes(&bare.to_bytes()).unwrap(), bare);
    }

    #[test]
    fn format_damage_is_an_error(parts in any_parts(), at in any::<prop::sample::Index>(), flip in 1u8..=255) {
        assert_damage_is_noticed(&Table::new(parts).unwrap(), at, flip);
    }

    #[test]
    fn format_garbage_is_an_error(bytes in prop::collection::vec(any::<u8>(), 0..400), with_magic in any::<bool>()) {
        let mut bytes = bytes;
        if with_magic && bytes.len() >= 32 {
            let len = bytes.len() as u64;
            bytes[..8].copy_from_slice(&sightlines_pvs::format::MAGIC);
            bytes[8..12].copy_from_slice(&[1, 0, 0, 0]);
            let n_sections = u32::from(bytes[12] % 4);
            bytes[12..16].copy_from_slice(&n_sections.to_le_bytes());
            bytes[16..24].copy_from_slice(&len.to_le_bytes());
            fix_header(&mut bytes);
        }
        prop_assert!(Table::from_bytes(&bytes).is_err());
    }

    /// Bytes changed, removed or added inside sections, with correct checksums: the checks behind the checksums. No
    /// panic; what is accepted is a valid table, and is written as it was read.
    #[test]
    fn format_forgeries_are_errors_or_tables(
        parts in any_parts(),
        changes in changes(),
    ) {
        let mut file = File::parse(&Table::new(parts).unwrap().to_bytes());
        for change in changes {
            let n = file.parts.len();
            let bytes = &mut file.parts[change.part.index(n)].bytes;
            change.apply(bytes);
        }
        assert_error_or_well_formed(&file.write());
    }

    #[test]
    fn format_forged_headers_are_errors(parts in any_parts(), at in any::<prop::sample::Index>(), value in any::<u8>()) {
        let bytes = Table::new(parts).unwrap().to_bytes();
        let parts = File::parse(&bytes).parts;
        let at = at.index(24 + 32 * parts.len());
        let mut forged = bytes.clone();
        forged[at] = value;
        fix_header(&mut forged);
        // A minor version may change, and an optional section may become an unknown one.
        let renamed = at >= 24 && (at - 24) % 32 < 4 && parts[(at - 24) / 32].flags == 1;
        let harmless = forged == bytes || at == 10 || at == 11 || renamed;
        prop_assert_eq!(assert_error_or_well_formed(&forged), harmless, "byte {}", at);
    }
}

/// Every strict prefix, and whatever follows the end.
#[test]
fn every_prefix_is_an_error() {
    assert_every_prefix_is_an_error(&house());
    let bytes = house().to_bytes();
    for surplus in 1..20 {
        let longer = [&bytes[..], &vec![0; surplus]].concat();
        assert!(Table::from_bytes(&longer).is_err());
    }
    assert_eq!(Table::from_bytes(&bytes), Ok(house()));
}

/// Every byte, changed into every other value.
#[test]
fn every_changed_byte_is_an_error() {
    assert_every_changed_byte_is_an_error(&house());
}

/// Every byte of every section, changed in every bit and into a few other values, with correct checksums.
#[test]
fn every_forged_byte_is_an_error_or_a_table() {
    let original = house().to_bytes();
    let file = File::parse(&original);
    assert_eq!(file.write(), original, "the files of these tests are right themselves");
    let (mut n_tables, mut n_errors) = (0, 0);
    for part in 0..file.parts.len() {
        for at in 0..file.parts[part].bytes.len() {
            for flip in (0..8).map(|bit| 1 << bit).chain([0xff, 0x7f, 0xf0]) {
                let mut forged = file.clone();
                forged.parts[part].bytes[at] ^= flip;
                let bytes = forged.write();
                let loaded = assert_error_or_well_formed(&bytes);
                if loaded {
                    assert_eq!(Table::from_bytes(&bytes).unwrap().to_bytes(), bytes, "not written as it was read");
                }
                *(if loaded { &mut n_tables } else { &mut n_errors }) += 1;
            }
        }
    }
    assert!(n_tables > 100 && n_errors > 1000, "{n_tables} tables, {n_errors} errors");
}

/// The file of the first version must be read as long as there is a reader.
#[test]
fn golden_v1_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/v1.pvs");
    let bytes = house().to_bytes();
    if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
        std::fs::write(path, &bytes).unwrap();
    }
    let golden = std::fs::read(path).expect("tests/golden/v1.pvs is missing; write it with BLESS=1");
    assert_eq!(Table::from_bytes(&golden), Ok(house()));
    assert!(golden == bytes, "the bytes of version 1 have changed");
}

#[test]
fn unknown_sections_are_skipped_if_optional() {
    let mut file = File::parse(&house().to_bytes());
    file.parts.insert(2, Part { id: *b"NEW!", flags: 1, bytes: vec![1, 2, 3] });
    file.minor = 7;
    assert_eq!(Table::from_bytes(&file.write()), Ok(house()));
    file.parts[2].flags = 0;
    let error = Table::from_bytes(&file.write()).unwrap_err();
    assert_eq!(error.kind, Kind::Unknown);
    assert_eq!(error.to_string(), "byte 88, section NEW!: the section is needed and unknown");
    file.parts[2].flags = 3;
    assert_eq!(Table::from_bytes(&file.write()).unwrap_err().kind, Kind::Flags { flags: 3 });
}

#[test]
fn optional_sections_may_go_and_others_not() {
    let file = File::parse(&house().to_bytes());
    for i in 0..file.parts.len() {
        let mut fewer = file.clone();
        let gone = fewer.parts.remove(i);
        match (gone.flags, Table::from_bytes(&fewer.write())) {
            (1, Ok(table)) => assert_well_formed(&table),
            (0, Err(error)) => assert_eq!((error.section.unwrap().0, error.kind), (gone.id, Kind::Missing)),
            (_, other) => panic!("without {:?}: {other:?}", gone.id),
        }
        let mut twice = file.clone();
        twice.parts.push(gone);
        assert_eq!(Table::from_bytes(&twice.write()).unwrap_err().kind, Kind::Repeated);
        let mut other = file.clone();
        other.parts[i].flags ^= 1;
        assert!(matches!(Table::from_bytes(&other.write()).unwrap_err().kind, Kind::Flags { .. }));
    }
    let mut bare = file.clone();
    bare.parts.retain(|part| part.flags == 0);
    assert_eq!(Table::from_bytes(&bare.write()), Ok(house().strip_geometry()));
    assert_eq!(bare.write(), house().strip_geometry().to_bytes());
}

#[test]
fn versions_are_reported() {
    let mut file = File::parse(&house().to_bytes());
    for major in [0, 2, u16::MAX] {
        file.major = major;
        assert_eq!(Table::from_bytes(&file.write()).unwrap_err().kind, Kind::Major { major });
    }
    let text = |bytes: &[u8]| Table::from_bytes(bytes).unwrap_err().to_string();
    assert_eq!(text(b"PNG"), "byte 0: this is no visibility table");
    assert_eq!(text(b""), "byte 0: the header needs 32 bytes, but there are 0");
}

/// A padding byte is covered by no checksum, and must be zero.
#[test]
fn padding_is_checked() {
    let mut bytes = house().to_bytes();
    let last = bytes.len() - 1;
    assert_ne!(File::parse(&bytes).parts.last().unwrap().bytes.len() % 8, 0, "the house ends with padding");
    bytes[last] = 1;
    let error = Table::from_bytes(&bytes).unwrap_err();
    assert_eq!((error.kind, error.offset), (Kind::NotZero, last as u64));
}

/// Writes `value` at `at` of a section and returns the error, which must name the section.
fn forge(id: &[u8; 4], at: usize, value: &[u8]) -> Kind {
    forged(&house(), id, |bytes| bytes[at..at + value.len()].copy_from_slice(value))
}

/// Counts that exceed the content are refused before any memory is allocated for them.
#[test]
fn forged_counts_are_refused() {
    let huge = u32::MAX.to_le_bytes();
    for (id, at) in [(b"CELL", 4), (b"POLY", 0), (b"PORT", 0), (b"PORT", 20), (b"LOCA", 0), (b"LOCA", 4)] {
        assert!(matches!(forge(id, at, &huge), Kind::Cut { .. }), "{id:?} {at}");
    }
    for (id, at) in [(b"OBJS", 0), (b"OBJS", 36), (b"COBJ", 0), (b"INFO", 0), (b"INFO", 4)] {
        assert!(matches!(forge(id, at, &huge), Kind::Cut { .. }), "{id:?} {at}");
    }
    assert!(matches!(forge(b"INFO", 0, &1u32.to_le_bytes()), Kind::Surplus { .. }));
}

#[test]
fn forged_contents_are_refused() {
    let table = |error: TableError| Kind::Table(error);
    assert_eq!(forge(b"CELL", 0, &[4]), Kind::Value { value: 4 });
    assert_eq!(forge(b"CELL", 40, &[2]), Kind::Value { value: 2 });
    // Cell 1 has no group, and so no group number.
    assert_eq!(forge(b"CELL", 8 + 40 + 36, &[9]), Kind::Value { value: 9 });
    assert_eq!(forge(b"ROWS", 0, &[0]), table(TableError::NotReflexive(CellId(0))));
    assert_eq!(forge(b"ROWS", 0, &[3]), Kind::PastDiagonal { row: 0 });
    let nan = f64::NAN.to_le_bytes();
    assert!(matches!(forge(b"POLY", 20, &nan), Kind::Table(TableError::NotFinite { .. })));
    assert!(matches!(forge(b"PORT", 4, &[9]), Kind::Table(TableError::PortalCell { .. })));
    assert!(matches!(forge(b"COBJ", 20, &[7]), Kind::Table(TableError::UnknownObject { .. })));
    assert_eq!(forge(b"OBJS", 40, &[0xff]), Kind::Text);
    assert_eq!(forge(b"INFO", 8, b"z"), table(TableError::InfoOrder(1)));
    // The root of the locator as its own high child, a node that does not exist, a leaf too long.
    for child in [0u32, 1, 99] {
        let kind = forge(b"LOCA", 8 + 4, &child.to_le_bytes());
        assert_eq!(kind, table(TableError::Locator(LocatorError::Child { node: 0, child })));
    }
    assert!(matches!(forge(b"LOCA", 8 + 8, &nan), Kind::Table(TableError::Locator(LocatorError::Split { node: 0 }))));
    assert!(matches!(forge(b"LOCA", 8, &[2]), Kind::Table(TableError::Locator(LocatorError::Axis { .. }))));
    assert!(matches!(forge(b"LOCA", 8 + 32 + 4, &[9]), Kind::Table(TableError::Locator(LocatorError::Order { .. }))));
    assert!(matches!(forge(b"LOCA", 8 + 80, &[9]), Kind::Table(TableError::Locator(_))));
}

/// Half a symmetric matrix cannot be asymmetric: a removed pair is removed on both sides.
#[test]
fn forged_rows_stay_symmetric() {
    let mut file = File::parse(&house().to_bytes());
    file.part(b"ROWS").bytes[8] = 0b10;
    let table = Table::from_bytes(&file.write()).unwrap();
    assert!(!table.sees(CellId(0), CellId(1)) && !table.sees(CellId(1), CellId(0)));
    assert_well_formed(&table);
}
