//! Rows of bits as maps store them: runs of zero bytes are counted.
//!
//! Bit `j % 8` of byte `j / 8` stands for column `j`. A byte that is not 0 stands for itself; a 0 is followed
//! by a byte that says how many zeros there are, 1 to 255.

use crate::error::{Malformed, malformed};

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
/// [`Malformed`]; the content of `row` is then unspecified.
pub fn decode(bytes: &[u8], row: &mut [u8]) -> Result<usize, Malformed> {
    let needed = row.len();
    let (mut read, mut at) = (0, 0);
    while at < needed {
        let truncated = || malformed!("the bytes end after {at} of {needed} bytes of a row");
        let byte = *bytes.get(read).ok_or_else(truncated)?;
        if byte != 0 {
            row[at] = byte;
            (read, at) = (read + 1, at + 1);
            continue;
        }
        let run = *bytes.get(read + 1).ok_or_else(truncated)?;
        if run == 0 {
            return Err(malformed!("a run of no zeros at byte {at} of a row"));
        }
        let Some(zeros) = row.get_mut(at..at + usize::from(run)) else {
            return Err(malformed!("a run of {run} zeros at byte {at} of a row goes past its {needed} bytes"));
        };
        zeros.fill(0);
        (read, at) = (read + 2, at + usize::from(run));
    }
    Ok(read)
}
