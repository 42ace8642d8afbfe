//! Texts that are read piece by piece, and the places of the pieces.

use crate::error::{Malformed, malformed};

/// A place in a text; both count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) line: usize,
    /// The byte in the line.
    pub(crate) column: usize,
}

impl Place {
    pub(crate) fn error(self, what: Malformed) -> Malformed {
        what.within(format_args!("line {}, column {}", self.line, self.column))
    }
}

/// How far a text was read. No memory, whatever the text.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<'t> {
    text: &'t [u8],
    at: usize,
    line: usize,
    line_start: usize,
}

impl<'t> Cursor<'t> {
    pub(crate) fn new(text: &'t [u8]) -> Self {
        Self { text, at: 0, line: 1, line_start: 0 }
    }

    pub(crate) fn rest(&self) -> &'t [u8] {
        &self.text[self.at..]
    }

    pub(crate) fn place(&self) -> Place {
        Place { line: self.line, column: self.at - self.line_start + 1 }
    }

    pub(crate) fn take(&mut self, n: usize) -> &'t [u8] {
        let taken = &self.rest()[..n];
        for (k, _) in taken.iter().enumerate().filter(|(_, byte)| **byte == b'\n') {
            (self.line, self.line_start) = (self.line + 1, self.at + k + 1);
        }
        self.at += n;
        taken
    }

    /// Reads up to an end of what begins here, and that end, which is behind so many bytes; `what` has none otherwise.
    pub(crate) fn take_to(&mut self, end: Option<usize>, what: &str) -> Result<&'t [u8], Malformed> {
        let place = self.place();
        end.map(|end| self.take(end)).ok_or_else(|| place.error(malformed!("this {what} has no end")))
    }
}

/// Where the quotes are that end a text in quotes; `\` takes its meaning from the character behind it.
pub(crate) fn closing_quotes(text: &[u8]) -> Option<usize> {
    let mut is_escaped = false;
    text.iter().position(|&byte| {
        let ends = byte == b'"' && !is_escaped;
        is_escaped = byte == b'\\' && !is_escaped;
        ends
    })
}
