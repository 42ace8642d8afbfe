//! Rows of bits as maps store them: runs of zero bytes are counted.
//!
//! Bit `j % 8` of byte `j / 8` stands for column `j`. A byte that is not 0 stands for itself; a 0 is followed
//! by a byte that says how many zeros there are, 1 to 255.

/// Why bytes are not a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RleError {
    /// The bytes end within the row.
    #[error("the bytes end after {found} of {needed} bytes of a row")]
    Truncated {
        /// Bytes of the row so far.
        found: usize,
        /// Bytes of a row.
        needed: usize,
    },
    /// A run of zeros goes past the end of the row.
    #[error("a run of {run} zeros at byte {at} of a row goes past its {needed} bytes")]
    Overrun {
        /// Zeros in the run.
        run: u8,
        /// Where it begins in the row.
        at: usize,
        /// Bytes of a row.
        needed: usize,
    },
    /// A run has no zeros. No compiler writes that.
    #[error("a run of no zeros at byte {at} of a row")]
    EmptyRun {
        /// Where it is in the row.
        at: usize,
    },
}

/// Bytes of a row of `n_columns` bits.
pub fn row_len(n_columns: usize) -> usize {
    n_columns.div_ceil(8)
}

/// Appends a row to `out`: each run of zeros is as long as it can be, so that a row has one code only.
/// O(row). At most 3 bytes for 2 of the row, and one more.
pub fn encode(row: &[u8], out: &mut Vec<u8>) {
    let mut rest = row;
    while let Some((&first, behind)) = rest.split_first() {
        if first != 0 {
            out.push(first);
            rest = behind;
            continue;
        }
        let run = rest.iter().take(usize::from(u8::MAX)).take_while(|&&b| b == 0).count();
        // At most `u8::MAX`, by the line above.
        out.extend_from_slice(&[0, run as u8]);
        rest = &rest[run..];
    }
}

/// Fills `row` from the front of `bytes`; returns how many of them it takes. O(row).
///
/// # Errors
/// [`RleError`]; the content of `row` is then unspecified.
pub fn decode(bytes: &[u8], row: &mut [u8]) -> Result<usize, RleError> {
    let needed = row.len();
    let (mut read, mut at) = (0, 0);
    while at < needed {
        let truncated = RleError::Truncated { found: at, needed };
        let byte = *bytes.get(read).ok_or(truncated)?;
        if byte != 0 {
            row[at] = byte;
            (read, at) = (read + 1, at + 1);
            continue;
        }
        let run = *bytes.get(read + 1).ok_or(truncated)?;
        if run == 0 {
            return Err(RleError::EmptyRun { at });
        }
        let zeros = row.get_mut(at..at + usize::from(run)).ok_or(RleError::Overrun { run, at, needed })?;
        zeros.fill(0);
        (read, at) = (read + 2, at + usize::from(run));
    }
    Ok(read)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
        let decoded = |bytes: &[u8]| decode(bytes, &mut [0xAA; 4]);
        assert_eq!(decoded(&[1, 2]), Err(RleError::Truncated { found: 2, needed: 4 }));
        assert_eq!(decoded(&[1, 0]), Err(RleError::Truncated { found: 1, needed: 4 }));
        assert_eq!(decoded(&[1, 0, 4]), Err(RleError::Overrun { run: 4, at: 1, needed: 4 }));
        assert_eq!(decoded(&[1, 0, 0, 1, 1, 1]), Err(RleError::EmptyRun { at: 1 }));
        assert_eq!(decoded(&[1, 0, 2, 1, 99]), Ok(4));
        let text = decoded(&[1, 0, 4]).unwrap_err().to_string();
        assert_eq!(text, "a run of 4 zeros at byte 1 of a row goes past its 4 bytes");
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
}
