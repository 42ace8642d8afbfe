//! GeoJSON texts one behind the other, each behind a record separator (RFC 8142).

use std::io::{self, Read};

/// The byte before each text of a sequence. No JSON text has it outside of a string, and in a string only escaped.
const RECORD_SEPARATOR: u8 = 0x1E;

/// Whether a text begins as a sequence.
pub(crate) fn is_sequence(text: &[u8]) -> bool {
    text.trim_ascii_start().first() == Some(&RECORD_SEPARATOR)
}

/// Reads a sequence with tabs for separators: white space outside of strings, and refused inside. A text that was cut off leaves a string or a
/// bracket open, so what is behind it makes no whole of it.
pub(super) struct Sequence<R>(pub(super) R);

impl<R: Read> Read for Sequence<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.0.read(buffer)?;
        buffer[..n].iter_mut().filter(|byte| **byte == RECORD_SEPARATOR).for_each(|byte| *byte = b'\t');
        Ok(n)
    }
}
