//! The members of a JSON object, looked at without reading all of it.

use crate::bytes::without_mark;
use crate::cursor::closing_quotes;
use crate::geojson::is_sequence;

/// Whether a text begins as a JSON object, or as a sequence of them.
pub(super) fn is_object(head: &[u8]) -> bool {
    inside(head).is_some() || is_sequence(without_mark(head))
}

/// What follows the brace that opens the object.
fn inside(head: &[u8]) -> Option<&[u8]> {
    without_mark(head).trim_ascii_start().strip_prefix(b"{")
}

/// Whether an object has a member of that name, as far as its text goes. Names with escapes count as others.
pub(super) fn has_member(head: &[u8], name: &str) -> bool {
    let Some(mut rest) = inside(head) else { return false };
    // How deep inside the object, and whether the next text names a member.
    let (mut depth, mut is_name) = (0_usize, true);
    while let Some((&byte, behind)) = rest.split_first() {
        rest = behind;
        match byte {
            b'"' => {
                let Some(end) = closing_quotes(rest) else { return false };
                if depth == 0 && is_name && &rest[..end] == name.as_bytes() {
                    return true;
                }
                rest = &rest[end + 1..];
            }
            b'{' | b'[' => depth += 1,
            b'}' | b']' if depth == 0 => return false,
            b'}' | b']' => depth -= 1,
            b':' if depth == 0 => is_name = false,
            b',' if depth == 0 => is_name = true,
            _ => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_of_the_object_itself_are_found() {
        let text = br#" {"a": {"b": [1, "c\"}"]}, "d": "e", "f\n": 1, "g"  : 2"#;
        let found = |name| has_member(text, name);
        assert_eq!(["a", "d", "g"].map(found), [true; 3]);
        // Members of members, texts that are values, and names with escapes are none.
        assert_eq!(["b", "c", "e", "f\n", "f", ""].map(found), [false; 6]);
        assert!(has_member(b"\xEF\xBB\xBF\n{\"a\":1}", "a") && !has_member(br#"{"a":1}"#, "b"));
        for none in [&br#"["a"]"#[..], br#"{} "a":"#, br#"{"a"#, b"", b"{", br#"}{"a":1}"#, br#"{"x":"a"#] {
            assert!(!has_member(none, "a"), "{}", String::from_utf8_lossy(none));
        }
    }
}
