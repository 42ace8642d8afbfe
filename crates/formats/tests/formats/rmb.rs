//! Option files of RMB.

use sightlines_formats::doom::RmbFile;
use sightlines_formats::{LumpName, RejectTable};

fn name(text: &str) -> LumpName {
    LumpName::new(text).unwrap()
}

/// The table of a map of four sectors after the options of a file, from one in which 0 and 3 do not see each other.
fn table(text: &str, map: &str) -> (String, u64) {
    let mut table = RejectTable::new(4);
    table.set(0, 3, true);
    table.set(3, 0, true);
    let n = RmbFile::parse(text.as_bytes()).unwrap().apply(name(map), &mut table).unwrap();
    let bit = |a, b| if table.get(a, b) { '1' } else { '0' };
    let rows: Vec<String> = (0..4).map(|a| (0..4).map(|b| bit(a, b)).collect()).collect();
    (rows.join(" "), n)
}

#[test]
fn options_have_the_effects_that_they_name() {
    for (text, rows, n) in [
        ("", "0001 0000 0000 1000", 0),
        ("BLIND 0 (1)", "0001 1111 0000 1000", 4),
        ("blind 1 (0 1)", "0111 1011 0000 1000", 5),
        ("SAFE 0 1", "0101 0100 0100 1100", 4),
        ("safe 1 (3)", "0001 0001 0001 1000", 2),
        ("INCLUDE (0) (3 2)", "0000 0000 0000 1000", 1),
        ("EXC 1 (2 0)", "0001 1010 0000 1000", 2),
        // The later of two counts, whatever the order of others.
        ("SAFE 0 1\nSAFE 1 1", "0101 0000 0100 1100", 3),
        ("EXCLUDE (1) (2)\nINCLUDE (1) (2 3)\nBLIND 0 (1)", "0001 1110 0000 1000", 3),
        ("BLIND 0 2\nSAFE 1 2", "0011 0010 1111 1010", 7),
        ("NOMAP\nPERFECT # as always\n\n# a comment\nPREPROCESS 4\nPROC (1 2)", "0001 0000 0000 1000", 0),
    ] {
        assert_eq!(table(text, "MAP01"), (rows.to_owned(), n), "{text}");
    }
}

#[test]
fn headings_choose_maps() {
    let text = "BLIND 0 (0)\nE1M1\nINC (0) (1)\nmap02\nEXCLUDE(3)(3)\ne1m1\nSAFE 0 (2)";
    assert_eq!(table(text, "E1M1").0, "1011 0010 0010 1010");
    assert_eq!(table(text, "MAP02").0, "1111 0000 0000 1001");
    assert_eq!(table(text, "MAP03").0, "1111 0000 0000 1000");
    let file = RmbFile::parse(b"E1M1\nBLIND 0 (0)").unwrap();
    assert!(file.is_for(name("e1m1")) && !file.is_for(name("E1M2")));
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (text, error) in [
        ("\nFOO 1", "line 2: FOO is not an option of RMB"),
        ("B 1 2", "line 1: B is not an option of RMB"),
        ("(1)", "line 1: (1) is not an option of RMB"),
        ("# x\nLEFT 311", "line 2: the option LEFT is not supported"),
        ("INV BLIND 1 (2)", "line 1: the option INVERT is not supported"),
        ("BLIND 2 (1)", "line 1: the distance 2 is not supported, only 0 and 1 are"),
        ("SAFE (1)", "line 1: SAFE takes a distance and a list of sectors"),
        ("BLIND 0", "line 1: BLIND takes a distance and a list of sectors"),
        ("BLIND 0 ()", "line 1: BLIND takes a distance and a list of sectors"),
        ("BLIND 0 (1", "line 1: BLIND takes a distance and a list of sectors"),
        ("BLIND 0 1 2", "line 1: BLIND takes a distance and a list of sectors"),
        ("BLIND 99999999999 (1)", "line 1: BLIND takes a distance and a list of sectors"),
        ("INCLUDE (1) (x)", "line 1: INCLUDE takes two lists of sectors"),
        ("EXCLUDE (1)", "line 1: EXCLUDE takes two lists of sectors"),
    ] {
        assert_eq!(RmbFile::parse(text.as_bytes()).unwrap_err().to_string(), error, "{text}");
    }
    let mut table = RejectTable::new(4);
    let file = RmbFile::parse(b"BLIND 0 1\nE1M1\nEXCLUDE 1 4").unwrap();
    let error = file.apply(name("E1M1"), &mut table).unwrap_err();
    assert_eq!(error.to_string(), "line 3: sector 4 is not among the 4 of map E1M1");
    assert_eq!(table, RejectTable::new(4));
    assert_eq!(file.apply(name("E1M2"), &mut table), Ok(4));
}

#[test]
fn broken_bytes_are_refused() {
    for k in 0..=255 {
        for text in [vec![k], [&b"BLIND 0 "[..], &[k]].concat(), [&b"INCLUDE ("[..], &[k, b')']].concat()] {
            drop(RmbFile::parse(&text));
        }
    }
    assert!(RmbFile::parse(&[0xff; 1000]).is_err());
}
