//! Maps as text: the Universal Doom Map Format, and of it only what sight depends on.
//!
//! A text is a list of assignments, `name = value;`, and of blocks of assignments, `name { ... }`; blocks do not nest.
//! Blocks of one kind are numbered in their order. Letters of names count the same in both cases; of two assignments
//! to one name in a block the later counts. Blocks and names that are not needed are skipped. The namespace counts for what lines do.

mod lexer;
mod values;

use super::content::{Content, LineDef, Numbering, Thing};
use super::{Game, ML_TWOSIDED};
use crate::cursor::Place;
use crate::error::{Malformed, malformed};
use lexer::{Lexer, Piece};
use values::Value;

/// Reads a text. Memory within a small multiple of its length; each byte is looked at once or twice.
pub(super) fn parse(text: &[u8]) -> Result<Content, Malformed> {
    let (lexer, content) = (Lexer::new(text), Content::default());
    let mut reader = Reader { lexer, content, namespace: b"", lines: vec![], sides: vec![] };
    while reader.global()? {}
    reader.check()?;
    let Reader { mut content, namespace, .. } = reader;
    let is = |name: &str| namespace.eq_ignore_ascii_case(name.as_bytes());
    content.game = if is("hexen") { Some(Game::Hexen) } else { is("heretic").then_some(Game::Heretic) };
    content.numbering = match () {
        () if is("doom") || is("heretic") || is("strife") => Numbering::Doom,
        () if is("srb2") => Numbering::Srb2,
        // All other engines number what lines do as Hexen does.
        () => Numbering::Hexen,
    };
    Ok(content)
}

/// What a block of a kind takes, and where the block is.
struct Block<'t, const N: usize> {
    name: &'static str,
    index: usize,
    place: Place,
    keys: [&'static str; N],
    values: [Option<Value<'t>>; N],
}

struct Reader<'t> {
    lexer: Lexer<'t>,
    content: Content,
    namespace: &'t [u8],
    /// Where the blocks of lines are.
    lines: Vec<Place>,
    /// Where the blocks of sides are.
    sides: Vec<Place>,
}

impl<'t> Reader<'t> {
    /// Reads one assignment or block of the outermost level; `false` at the end of the text.
    fn global(&mut self) -> Result<bool, Malformed> {
        let (name, place) = match self.lexer.next()? {
            (Piece::End, _) => return Ok(false),
            (Piece::Mark(b';'), _) => return Ok(true),
            (piece, place) => (identifier(piece, place, "a name")?, place),
        };
        match self.lexer.next()? {
            (Piece::Mark(b'='), _) => {
                let value = self.value()?;
                if let (true, Piece::Quoted(text)) = (name.eq_ignore_ascii_case(b"namespace"), value.piece) {
                    self.namespace = text;
                }
            }
            (Piece::Mark(b'{'), _) => self.block_of(name, place)?,
            (piece, place) => return Err(expected("= or {", piece, place)),
        }
        Ok(true)
    }

    fn block_of(&mut self, name: &[u8], place: Place) -> Result<(), Malformed> {
        match name.to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let block = self.block(("vertex", self.content.vertices.len(), place), ["x", "y"])?;
                self.content.vertices.push([block.coordinate(0)?, block.coordinate(1)?]);
            }
            b"linedef" => {
                let keys = ["v1", "v2", "sidefront", "sideback", "twosided", "special"];
                let block = self.block(("linedef", self.content.lines.len(), place), keys)?;
                let flags = if block.flag(4)? { ML_TWOSIDED } else { 0 };
                let (right, left) = (block.optional_index(2)?, block.optional_index(3)?);
                let line = LineDef { v1: block.index(0)?, v2: block.index(1)?, flags, right, left };
                let special = if block.values[5].is_some() { block.integer(5)? } else { 0 };
                self.content.specials.push(special);
                self.content.lines.push(line);
                self.lines.push(place);
            }
            b"sidedef" => {
                let block = self.block(("sidedef", self.content.side_sectors.len(), place), ["sector"])?;
                self.content.side_sectors.push(block.index(0)?);
                self.sides.push(place);
            }
            b"sector" => {
                self.block(("sector", self.content.n_sectors, place), [])?;
                self.content.n_sectors += 1;
            }
            b"thing" => {
                let block = self.block(("thing", self.content.things.len(), place), ["x", "y", "type"])?;
                let thing = Thing { x: block.coordinate(0)?, y: block.coordinate(1)?, kind: block.integer(2)? };
                self.content.things.push(thing);
            }
            _ => _ = self.block(("block", 0, place), [])?,
        }
        Ok(())
    }

    /// Reads the assignments of a block up to its brace; keeps the values of `keys`.
    fn block<const N: usize>(
        &mut self,
        (name, index, place): (&'static str, usize, Place),
        keys: [&'static str; N],
    ) -> Result<Block<'t, N>, Malformed> {
        let mut values = [None; N];
        loop {
            let key = match self.lexer.next()? {
                (Piece::Mark(b'}'), _) => return Ok(Block { name, index, place, keys, values }),
                (Piece::Mark(b';'), _) => continue,
                (piece, place) => identifier(piece, place, "a name or }")?,
            };
            match self.lexer.next()? {
                (Piece::Mark(b'='), _) => {}
                (piece, place) => return Err(expected("=", piece, place)),
            }
            let value = self.value()?;
            if let Some(k) = keys.iter().position(|k| key.eq_ignore_ascii_case(k.as_bytes())) {
                values[k] = Some(value);
            }
        }
    }

    fn value(&mut self) -> Result<Value<'t>, Malformed> {
        let (piece, place) = self.lexer.next()?;
        if !matches!(piece, Piece::Word(_) | Piece::Quoted(_)) {
            return Err(expected("a value", piece, place));
        }
        match self.lexer.next()? {
            (Piece::Mark(b';'), _) => Ok(Value { piece, place }),
            (piece, place) => Err(expected(";", piece, place)),
        }
    }

    /// Refuses numbers of blocks that are not there.
    fn check(&self) -> Result<(), Malformed> {
        if let Some((index, wrong)) = self.content.wrong_line("vertex", "sidedef") {
            return Err(self.lines[index].error(wrong.within(format_args!("linedef {index}"))));
        }
        match self.content.wrong_side() {
            Some((index, wrong)) => Err(self.sides[index].error(wrong.within(format_args!("sidedef {index}")))),
            None => Ok(()),
        }
    }
}

/// A name: letters, digits and underscores, no digit first.
fn identifier<'t>(piece: Piece<'t>, place: Place, what: &str) -> Result<&'t [u8], Malformed> {
    let plain = |&b: &u8| b.is_ascii_alphanumeric() || b == b'_';
    match piece {
        Piece::Word(word) if !word[0].is_ascii_digit() && word.iter().all(plain) => Ok(word),
        _ => Err(expected(what, piece, place)),
    }
}

fn expected(what: &str, found: Piece<'_>, place: Place) -> Malformed {
    place.error(malformed!("{what} is expected, not {}", found.shown()))
}
