//! Rows of visibility as maps of Quake code them.

use proptest::prelude::*;
use sightlines_formats::quake::rle::{decode, encode, row_len};

fn encoded(row: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    encode(row, &mut out);
    out
}

#[test]
fn runs_are_counted() {
    assert!(encoded(&[]).is_empty());
    assert_eq!(encoded(&[7, 0, 0, 0, 9, 0]), [7, 0, 3, 9, 0, 1]);
    assert_eq!(encoded(&[0; 255]), [0, 255]);
    assert_eq!(encoded(&[0; 256]), [0, 255, 0, 1]);
    assert_eq!(encoded(&[0; 600]), [0, 255, 0, 255, 0, 90]);
    assert_eq!([0, 1, 8, 9, 1344].map(row_len), [0, 1, 1, 2, 168]);
}

#[test]
fn broken_rows_are_refused() {
    let decoded = |bytes: &[u8]| decode(bytes, &mut [0xAA; 4]).map_err(|error| error.to_string());
    let refused = |what: &str| Err(what.to_owned());
    assert_eq!(decoded(&[1, 2]), refused("the bytes end after 2 of 4 bytes of a row"));
    assert_eq!(decoded(&[1, 0]), refused("the bytes end after 1 of 4 bytes of a row"));
    assert_eq!(decoded(&[1, 0, 4]), refused("a run of 4 zeros at byte 1 of a row goes past its 4 bytes"));
    assert_eq!(decoded(&[1, 0, 0, 1, 1, 1]), refused("a run of no zeros at byte 1 of a row"));
    assert_eq!(decoded(&[1, 0, 2, 1, 99]), Ok(4));
}

proptest! {
    /// Rows are read as written, whatever stands behind them; a row that is cut off is refused.
    #[test]
    fn rows_read_as_written(
        pieces in proptest::collection::vec((0usize..400, any::<u8>()), 0..8),
        behind in proptest::collection::vec(any::<u8>(), 0..4),
    ) {
        let row: Vec<u8> = pieces.iter().flat_map(|&(n, b)| std::iter::repeat_n(0, n).chain([b])).collect();
        let code = encoded(&row);
        prop_assert!(code.len() <= row.len() + row.len() / 2 + 1);
        let mut read = vec![0x55; row.len()];
        prop_assert_eq!(decode(&[&code[..], &behind].concat(), &mut read), Ok(code.len()));
        prop_assert_eq!(&read, &row);
        for len in 0..code.len() {
            prop_assert!(decode(&code[..len], &mut read).is_err());
        }
    }

    /// No bytes cause a panic; what is read and written again is read as the same.
    #[test]
    fn any_bytes_are_a_row_or_not(bytes in proptest::collection::vec(0u8..5, 0..40), n in 0usize..60) {
        let mut row = vec![0; n];
        if let Ok(used) = decode(&bytes, &mut row) {
            prop_assert!(used <= bytes.len());
            let code = encoded(&row);
            prop_assert!(code.len() <= used);
            let mut again = vec![0; n];
            prop_assert_eq!(decode(&code, &mut again), Ok(code.len()));
            prop_assert_eq!(again, row);
        }
    }
}
