//! Pieces of a text with their places.

use crate::cursor::{Cursor, Place};
use crate::error::{Malformed, malformed};
use std::fmt::Display;

/// A piece of the text, or its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token<'t> {
    /// Its bytes; `None` at the end of the text.
    pub(super) bytes: Option<&'t [u8]>,
    pub(super) place: Place,
}

/// Most characters of a piece that an error shows.
const SHOWN: usize = 40;

impl Token<'_> {
    pub(super) fn unexpected(&self, expected: impl Display) -> Malformed {
        self.place.error(match self.bytes {
            Some(_) => malformed!("expected {expected}, found {:?}", self.shown()),
            None => malformed!("expected {expected}, found the end of the file"),
        })
    }

    pub(super) fn shown(&self) -> String {
        let bytes = self.bytes.unwrap_or_default();
        let cut = &bytes[..bytes.len().min(SHOWN)];
        let more = if cut.len() < bytes.len() { "..." } else { "" };
        format!("{}{more}", String::from_utf8_lossy(cut))
    }
}

/// The next piece of a text: a parenthesis, or a word between whitespace. O(its length and the whitespace before it).
pub(super) fn next<'t>(text: &mut Cursor<'t>) -> Token<'t> {
    text.take(text.rest().iter().take_while(|&&b| is_space(b)).count());
    let is_end = |&b: &u8| is_space(b) || matches!(b, b'(' | b')');
    let (place, rest) = (text.place(), text.rest());
    let len = match rest {
        [b'(' | b')', ..] => 1,
        _ => rest.iter().position(is_end).unwrap_or(rest.len()),
    };
    Token { bytes: Some(text.take(len)).filter(|b| !b.is_empty()), place }
}

fn is_space(byte: u8) -> bool {
    // What C calls space, since these files are read by C programs: a vertical tab counts too.
    byte.is_ascii_whitespace() || byte == 0x0B
}
