//! Values of assignments: coordinates, numbers of blocks, flags.

use super::Block;
use super::lexer::Piece;
use crate::cursor::Place;
use crate::error::{Malformed, malformed};
use sightlines_geometry::check_coordinate;

/// What stands behind `=`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value<'t> {
    pub(super) piece: Piece<'t>,
    pub(super) place: Place,
}

impl Value<'_> {
    fn refuse(&self, key: &str, wanted: &str) -> Malformed {
        self.place.error(malformed!("{key} is {}, but it takes {wanted}", self.piece.shown()))
    }

    /// The double nearest to a number in decimal digits.
    fn number(&self) -> Option<f64> {
        let Piece::Word(word) = self.piece else { return None };
        // Letters of other words that Rust takes for numbers, such as `inf`, are none of these.
        let plain = |&b: &u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E');
        let text = std::str::from_utf8(word).ok().filter(|_| word.iter().all(plain))?;
        text.parse().ok()
    }

    /// A whole number in decimal digits, or in hexadecimal ones behind `0x`.
    ///
    /// Zeros before several other digits are refused: the grammar calls such a number octal, and programs that read it so and programs
    /// that read it as decimal would not mean the same block.
    fn integer(&self) -> Option<i64> {
        let Piece::Word(word) = self.piece else { return None };
        let text = std::str::from_utf8(word).ok()?;
        let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
        let hexadecimal = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X"));
        let (digits, radix) = hexadecimal.map_or((digits, 10), |digits| (digits, 16));
        let plain = !digits.is_empty() && digits.chars().all(|c| c.is_digit(radix));
        let magnitude = i64::from_str_radix(digits, radix).ok().filter(|_| plain)?;
        let has_zeros = radix == 10 && digits.len() > 1 && digits.starts_with('0');
        if has_zeros && i64::from_str_radix(digits, 8) != Ok(magnitude) {
            return None;
        }
        Some(if text.starts_with('-') { -magnitude } else { magnitude })
    }
}

impl<const N: usize> Block<'_, N> {
    fn require(&self, k: usize) -> Result<&Value<'_>, Malformed> {
        let missing = || malformed!("{} {} has no {}", self.name, self.index, self.keys[k]);
        self.values[k].as_ref().ok_or_else(|| self.place.error(missing()))
    }

    /// A coordinate for which predicates are exact.
    pub(super) fn coordinate(&self, k: usize) -> Result<f64, Malformed> {
        let (key, value) = (self.keys[k], self.require(k)?);
        let number = value.number().ok_or_else(|| value.refuse(key, "a number"))?;
        check_coordinate(number).map_err(|error| value.place.error(Malformed::from(error).within(key)))
    }

    fn whole<T: TryFrom<i64>>(&self, k: usize, wanted: &str) -> Result<T, Malformed> {
        let value = self.require(k)?;
        let number = value.integer().and_then(|n| T::try_from(n).ok());
        number.ok_or_else(|| value.refuse(self.keys[k], wanted))
    }

    pub(super) fn integer(&self, k: usize) -> Result<i32, Malformed> {
        self.whole(k, "a whole number")
    }

    pub(super) fn index(&self, k: usize) -> Result<u32, Malformed> {
        self.whole(k, "the number of a block")
    }

    /// The number of a block; `None` for -1 and where nothing is said.
    pub(super) fn optional_index(&self, k: usize) -> Result<Option<u32>, Malformed> {
        match &self.values[k] {
            None => Ok(None),
            Some(value) if value.integer() == Some(-1) => Ok(None),
            Some(_) => self.index(k).map(Some),
        }
    }

    /// A flag, which is off where nothing is said.
    pub(super) fn flag(&self, k: usize) -> Result<bool, Malformed> {
        let Some(value) = &self.values[k] else { return Ok(false) };
        match value.piece {
            Piece::Word(word) if word.eq_ignore_ascii_case(b"true") => Ok(true),
            Piece::Word(word) if word.eq_ignore_ascii_case(b"false") => Ok(false),
            _ => Err(value.refuse(self.keys[k], "true or false")),
        }
    }
}
