//! What a user wants a map to say of pairs of leafs, whatever is visible.
//!
//! A text with a line for each pair: `show A B` or `hide A B`, with the numbers of two leafs in the map. `#` begins a comment.

use crate::bytes::text_lines;
use crate::error::{Malformed, malformed};

/// What should be said of a pair of leafs. It counts for all leafs of their clusters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Override {
    /// Whether the two see each other; else the first does not see the second, as from behind a one-way mirror.
    pub shows: bool,
    /// The leafs, by their numbers in the map.
    pub leafs: [u32; 2],
}

/// Reads a text. O(length).
///
/// # Errors
/// [`Malformed`] with the line.
pub fn parse_overrides(text: &[u8]) -> Result<Vec<Override>, Malformed> {
    let mut found = Vec::new();
    for (line, bytes) in (1..).zip(text_lines(text)) {
        let wrong = || malformed!("neither `show A B` nor `hide A B`, with the numbers of two leafs").on_line(line);
        let text = std::str::from_utf8(bytes).map_err(|_| wrong())?;
        let words: Vec<&str> = text.split('#').next().unwrap_or_default().split_ascii_whitespace().collect();
        let (shows, numbers) = match words[..] {
            [] => continue,
            ["show", a, b] => (true, [a, b]),
            ["hide", a, b] => (false, [a, b]),
            _ => return Err(wrong()),
        };
        let [Ok(a), Ok(b)] = numbers.map(str::parse) else { return Err(wrong()) };
        found.push(Override { shows, leafs: [a, b] });
    }
    Ok(found)
}
