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
