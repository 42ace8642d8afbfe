//! Words, strings and marks of a text, and where they are.

use crate::bytes::{line_end, without_mark};
use crate::cursor::{Cursor, Place, closing_quotes};
use crate::error::Malformed;

/// A piece of the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece<'t> {
    /// A name, a number or a keyword.
    Word(&'t [u8]),
    /// A string in quotes: what is between them, as it stands.
    Quoted(&'t [u8]),
    /// One of `{ } = ; ( ) '`.
    Mark(u8),
    /// The end of the text.
    End,
}

impl Piece<'_> {
    /// The piece as an error shows it: not too long, and without control characters.
    pub(super) fn shown(&self) -> String {
        const LONGEST: usize = 24;
        match self {
            Self::Word(word) if word.len() > LONGEST => format!("{}...", word[..LONGEST].escape_ascii()),
            Self::Word(word) => word.escape_ascii().to_string(),
            Self::Quoted(_) => "a string".to_owned(),
            Self::Mark(mark) => char::from(*mark).to_string(),
            Self::End => "the end of the text".to_owned(),
        }
    }
}

/// The pieces of a text, one after the other. Each byte is looked at a few times at most.
#[derive(Debug)]
pub(super) struct Lexer<'t> {
    cursor: Cursor<'t>,
    line_end: u8,
}

impl<'t> Lexer<'t> {
    /// Without a byte order mark, and without the zeros that fill lumps up.
    pub(super) fn new(text: &'t [u8]) -> Self {
        let text = without_mark(text);
        let text = &text[..text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1)];
        Self { cursor: Cursor::new(text), line_end: line_end(text) }
    }

    /// The next piece and its place; comments and space before it are skipped.
    pub(super) fn next(&mut self) -> Result<(Piece<'t>, Place), Malformed> {
        self.skip()?;
        let (place, rest) = (self.cursor.place(), self.cursor.rest());
        let Some(&first) = rest.first() else { return Ok((Piece::End, place)) };
        if first == b'"' {
            let quoted = self.cursor.take_to(closing_quotes(&rest[1..]).map(|end| end + 2), "string")?;
            return Ok((Piece::Quoted(&quoted[1..quoted.len() - 1]), place));
        }
        if is_mark(first) {
            self.cursor.take(1);
            return Ok((Piece::Mark(first), place));
        }
        let ends = |k: &usize| !is_word(rest[*k]) || rest[*k..].starts_with(b"//") || rest[*k..].starts_with(b"/*");
        Ok((Piece::Word(self.cursor.take((1..rest.len()).find(ends).unwrap_or(rest.len()))), place))
    }

    /// Goes past space and comments.
    fn skip(&mut self) -> Result<(), Malformed> {
        loop {
            let rest = self.cursor.rest();
            match rest {
                [first, ..] if first.is_ascii_whitespace() => self.cursor.take(1),
                [b'/', b'/', ..] => {
                    self.cursor.take(rest.iter().position(|&b| b == self.line_end).unwrap_or(rest.len()))
                }
                [b'/', b'*', inside @ ..] => {
                    let end = inside.windows(2).position(|pair| pair == b"*/");
                    self.cursor.take_to(end.map(|end| end + 4), "comment")?
                }
                _ => return Ok(()),
            };
        }
    }
}

fn is_mark(byte: u8) -> bool {
    matches!(byte, b'{' | b'}' | b'=' | b';' | b'(' | b')' | b'\'')
}

fn is_word(byte: u8) -> bool {
    !is_mark(byte) && byte != b'"' && !byte.is_ascii_whitespace()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &str) -> Result<Vec<String>, Malformed> {
        let mut lexer = Lexer::new(text.as_bytes());
        let mut found = Vec::new();
        loop {
            match lexer.next()? {
                (Piece::End, _) => return Ok(found),
                (piece, place) => found.push(format!("{}:{} {}", place.line, place.column, piece.shown())),
            }
        }
    }

    #[test]
    fn pieces_are_found_where_they_are() {
        let text = "a=1;// x = {\n\t/* \" \n */b{ c = \"}\\\"\n\";}\r\n-1.5e+3/**/z/y//";
        let expected = "1:1 a|1:2 =|1:3 1|1:4 ;|3:4 b|3:5 {|3:7 c|3:9 =|3:11 a string|4:2 ;|4:3 }|5:1 -1.5e+3|5:12 z/y";
        assert_eq!(pieces(text).unwrap().join("|"), expected);
        assert_eq!(pieces(" \n ").unwrap(), [""; 0]);
        assert_eq!(pieces("\u{e4}\u{1}'").unwrap(), ["1:1 \\xc3\\xa4\\x01", "1:4 '"]);
    }
}
