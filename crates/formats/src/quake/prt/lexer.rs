//! Pieces of a text with their places.

use crate::error::{Malformed, malformed};
use std::fmt::Display;

/// A piece of the text, or its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token<'t> {
    /// Its bytes; `None` at the end of the text.
    pub(super) bytes: Option<&'t [u8]>,
    /// The line, from 1.
    pub(super) line: usize,
    /// The byte in the line, from 1.
    pub(super) column: usize,
}

/// Most characters of a piece that an error shows.
const SHOWN: usize = 40;

impl Token<'_> {
    /// An error of this piece.
    pub(super) fn error(&self, what: Malformed) -> Malformed {
        what.within(format_args!("line {}, column {}", self.line, self.column))
    }

    /// The error where something else should stand.
    pub(super) fn unexpected(&self, expected: impl Display) -> Malformed {
        self.error(match self.bytes {
            Some(_) => malformed!("expected {expected}, found {:?}", self.shown()),
            None => malformed!("expected {expected}, found the end of the file"),
        })
    }

    /// The piece as an error shows it.
    pub(super) fn shown(&self) -> String {
        let bytes = self.bytes.unwrap_or_default();
        let cut = &bytes[..bytes.len().min(SHOWN)];
        let more = if cut.len() < bytes.len() { "..." } else { "" };
        format!("{}{more}", String::from_utf8_lossy(cut))
    }
}

/// Cuts a text into parentheses and words between whitespace.
#[derive(Debug, Clone)]
pub(super) struct Lexer<'t> {
    text: &'t [u8],
    at: usize,
    line: usize,
    line_start: usize,
}

impl<'t> Lexer<'t> {
    pub(super) fn new(text: &'t [u8]) -> Self {
        Self { text, at: 0, line: 1, line_start: 0 }
    }

    /// Number of bytes that are not cut yet.
    pub(super) fn n_left(&self) -> usize {
        self.text.len() - self.at
    }

    /// The next piece. O(its length and the whitespace before it).
    pub(super) fn next(&mut self) -> Token<'t> {
        while let Some(&byte) = self.text.get(self.at).filter(|&&b| is_space(b)) {
            self.at += 1;
            if byte == b'\n' {
                (self.line, self.line_start) = (self.line + 1, self.at);
            }
        }
        let start = self.at;
        let is_end = |&b: &u8| is_space(b) || matches!(b, b'(' | b')');
        let len = match self.text[start..].first() {
            None => 0,
            Some(b'(' | b')') => 1,
            Some(_) => self.text[start..].iter().position(is_end).unwrap_or(self.text.len() - start),
        };
        self.at += len;
        let bytes = Some(&self.text[start..self.at]).filter(|b| !b.is_empty());
        Token { bytes, line: self.line, column: start - self.line_start + 1 }
    }
}

fn is_space(byte: u8) -> bool {
    // What C calls space, since these files are read by C programs: a vertical tab counts too.
    byte.is_ascii_whitespace() || byte == 0x0B
}
