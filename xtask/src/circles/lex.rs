//! Rust source text as words and signs, without comments, strings and numbers.

/// A word or a sign, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token<'a> {
    /// An identifier or keyword, `::`, or one other character.
    pub(super) text: &'a str,
    /// Line, from 1.
    pub(super) line: usize,
}

impl Token<'_> {
    /// Whether it is an identifier or a keyword.
    pub(super) fn is_word(&self) -> bool {
        self.text.starts_with(is_word_start)
    }
}

const fn is_word_start(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

const fn is_word_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The tokens of a text. Literals and lifetimes are left out. Whatever the text is, this ends.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut line, mut rest) = (Vec::new(), 1, text);
    while let Some(first) = rest.chars().next() {
        let length = skipped(rest).unwrap_or_else(|| {
            let word = rest.find(|c| !is_word_part(c)).unwrap_or(rest.len());
            let length = match first {
                ':' if rest.starts_with("::") => 2,
                c if is_word_start(c) => word,
                c if c.is_ascii_digit() => return word,
                c => c.len_utf8(),
            };
            found.push(Token { text: &rest[..length], line });
            length
        });
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    found
}

/// How many bytes at the beginning are white space, a comment, a string, a character or a lifetime.
fn skipped(rest: &str) -> Option<usize> {
    let first = rest.chars().next()?;
    if first.is_whitespace() {
        return Some(first.len_utf8());
    }
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if rest.starts_with("/*") {
        return Some(block_comment(rest));
    }
    if first == '\'' {
        return Some(character_or_lifetime(rest));
    }
    let prefix = rest.find(|c| !is_word_part(c)).unwrap_or(rest.len());
    let (word, after) = rest.split_at(prefix);
    match word {
        "" | "b" | "c" if after.starts_with('"') => Some(prefix + string(after)),
        "b" if after.starts_with('\'') => Some(prefix + character_or_lifetime(after)),
        "r" | "br" | "cr" => raw_string(after).map(|length| prefix + length),
        _ => None,
    }
}

fn block_comment(rest: &str) -> usize {
    let (mut depth, mut at) = (0u32, 0);
    while at < rest.len() {
        match &rest.as_bytes()[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    rest.len()
}

/// The length of a string that begins with its quotation mark.
fn string(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let mut at = 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    let mut end = (at + 1).min(rest.len());
    while !rest.is_char_boundary(end) {
        end += 1;
    }
    end
}

/// The length of what follows the `r` of a raw string; none if no raw string follows.
fn raw_string(after: &str) -> Option<usize> {
    let n_hashes = after.find(|c| c != '#')?;
    if !after[n_hashes..].starts_with('"') {
        return None;
    }
    let end = format!("\"{}", &after[..n_hashes]);
    let inside = &after[n_hashes + 1..];
    Some(inside.find(&end).map_or(after.len(), |at| n_hashes + 1 + at + end.len()))
}

fn character_or_lifetime(rest: &str) -> usize {
    let inside = &rest[1..];
    let Some(first) = inside.chars().next() else { return 1 };
    if first == '\\' {
        // The character that is escaped may be the apostrophe itself.
        let escaped = inside.chars().nth(1).map_or(0, char::len_utf8);
        return inside.get(1 + escaped..).and_then(|tail| tail.find('\'')).map_or(rest.len(), |at| at + escaped + 3);
    }
    if inside[first.len_utf8()..].starts_with('\'') {
        return first.len_utf8() + 2;
    }
    1 + inside.find(|c| !is_word_part(c)).unwrap_or(inside.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        tokens(text).into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn literals_and_comments_are_left_out() {
        assert_eq!(texts("a::b // c::d\n/* e /* f */ g */ h"), ["a", "::", "b", "h"]);
        assert_eq!(
            texts(r##"f("x\"y", r#"z"z"#, b"w", 'q', '\'', '\n', b'k', 1_0.5e3, "é")"##),
            ["f", "(", ",", ",", ",", ",", ",", ",", ",", ".", ",", ")"]
        );
        assert_eq!(texts("&'a str, 'x: loop r#type"), ["&", "str", ",", ":", "loop", "r", "#", "type"]);
    }

    #[test]
    fn lines_are_counted_in_strings_and_comments() {
        let found = tokens("a\n\"b\nc\"\n/*\n*/ d");
        assert_eq!(found.iter().map(|t| (t.text, t.line)).collect::<Vec<_>>(), [("a", 1), ("d", 5)]);
    }

    #[test]
    fn half_a_text_ends_too() {
        for text in ["\"abc", "r#\"abc", "/* abc", "'", "'\\", "'\\'", "b'", "\"\\", "é\"é\\é"] {
            assert!(tokens(text).len() <= 2, "{text}");
        }
    }
}
