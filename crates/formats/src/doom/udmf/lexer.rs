//! Words, strings and marks of a text, and where they are.

use crate::bytes::line_end;
use crate::error::{Malformed, malformed};

/// A place in the text; both count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    line: u32,
    column: u32,
}

impl Place {
    pub(super) fn error(self, what: Malformed) -> Malformed {
        what.within(format_args!("line {}, column {}", self.line, self.column))
    }
}

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

/// The pieces of a text, one after the other. No memory, whatever the text; each byte is looked at once or twice.
#[derive(Debug)]
pub(super) struct Lexer<'t> {
    text: &'t [u8],
    at: usize,
    line: u32,
    line_start: usize,
}

impl<'t> Lexer<'t> {
    /// Without a byte order mark, and without the zeros that fill lumps up.
    pub(super) fn new(text: &'t [u8]) -> Self {
        let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
        let text = &text[..text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1)];
        Self { text, at: 0, line: 1, line_start: 0 }
    }

    /// The next piece and its place; comments and space before it are skipped.
    pub(super) fn next(&mut self) -> Result<(Piece<'t>, Place), Malformed> {
        self.skip()?;
        let place = self.place();
        let Some(&first) = self.text.get(self.at) else { return Ok((Piece::End, place)) };
        if first == b'"' {
            return Ok((Piece::Quoted(self.string(place)?), place));
        }
        if is_mark(first) {
            self.at += 1;
            return Ok((Piece::Mark(first), place));
        }
        let rest = &self.text[self.at..];
        let ends = |k: &usize| !is_word(rest[*k]) || rest[*k..].starts_with(b"//") || rest[*k..].starts_with(b"/*");
        let word = &rest[..(1..rest.len()).find(ends).unwrap_or(rest.len())];
        self.at += word.len();
        Ok((Piece::Word(word), place))
    }

    fn place(&self) -> Place {
        // A lump has fewer than 2^31 bytes.
        Place { line: self.line, column: (self.at - self.line_start + 1) as u32 }
    }

    /// Goes past one byte.
    fn step(&mut self) {
        if self.text[self.at] == b'\n' {
            self.line += 1;
            self.line_start = self.at + 1;
        }
        self.at += 1;
    }

    /// Goes past space and comments.
    fn skip(&mut self) -> Result<(), Malformed> {
        loop {
            let rest = &self.text[self.at..];
            match rest {
                [first, ..] if first.is_ascii_whitespace() => self.step(),
                [b'/', b'/', ..] => {
                    let end = line_end(self.text);
                    self.at += rest.iter().position(|&b| b == end).unwrap_or(rest.len());
                }
                [b'/', b'*', ..] => self.comment()?,
                _ => return Ok(()),
            }
        }
    }

    fn comment(&mut self) -> Result<(), Malformed> {
        let place = self.place();
        self.at += 2;
        while !self.text[self.at..].starts_with(b"*/") {
            if self.at == self.text.len() {
                return Err(place.error(malformed!("this comment has no end")));
            }
            self.step();
        }
        self.at += 2;
        Ok(())
    }

    /// Goes past a string; `\` takes its meaning from the character behind it.
    fn string(&mut self, place: Place) -> Result<&'t [u8], Malformed> {
        self.at += 1;
        let start = self.at;
        loop {
            match self.text[self.at..] {
                [b'"', ..] => break,
                [b'\\', _, ..] => {
                    self.at += 1;
                    self.step();
                }
                [_, ..] => self.step(),
                [] => return Err(place.error(malformed!("this string has no end"))),
            }
        }
        self.at += 1;
        Ok(&self.text[start..self.at - 1])
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
