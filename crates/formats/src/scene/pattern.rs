//! Patterns of names, as a user writes them.

use std::fmt;
use std::str::FromStr;

/// A pattern of names: `*` stands for any text, `?` for any one character, all else for itself, in any case of ASCII letters.
/// The whole name has to match: `*glass*` matches `Old glass 2`, `glass` only `glass` and `Glass`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamePattern(Vec<char>);

/// Why a text is no pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an empty text matches no name")]
pub struct EmptyPattern;

impl FromStr for NamePattern {
    type Err = EmptyPattern;

    fn from_str(text: &str) -> Result<Self, EmptyPattern> {
        if text.is_empty() { Err(EmptyPattern) } else { Ok(Self(text.chars().collect())) }
    }
}

impl fmt::Display for NamePattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|c| write!(f, "{c}"))
    }
}

impl NamePattern {
    /// Whether a name matches. O(length of the pattern × length of the name).
    pub fn matches(&self, name: &str) -> bool {
        let (pattern, name): (&[char], Vec<char>) = (&self.0, name.chars().collect());
        let (mut p, mut n) = (0, 0);
        // Where the last `*` stands, and up to where the name is its.
        let mut star: Option<(usize, usize)> = None;
        while n < name.len() {
            match pattern.get(p) {
                Some('*') => {
                    star = Some((p, n));
                    p += 1;
                }
                Some(&c) if c == '?' || c.eq_ignore_ascii_case(&name[n]) => (p, n) = (p + 1, n + 1),
                _ => match star {
                    Some((at, end)) => {
                        star = Some((at, end + 1));
                        (p, n) = (at + 1, end + 1);
                    }
                    None => return false,
                },
            }
        }
        pattern[p..].iter().all(|&c| c == '*')
    }
}
