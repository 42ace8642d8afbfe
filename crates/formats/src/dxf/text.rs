//! Names in a drawing.

/// A text of a drawing: UTF-8, or Latin-1 where it is not; `\U+hhhh` is the character with that number.
pub(super) fn decode(bytes: &[u8]) -> String {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find("\\U+") {
        let behind = &rest[at + 3..];
        let digits = behind.get(..4).filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()));
        let decoded = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok()).and_then(char::from_u32);
        out.push_str(if decoded.is_some() { &rest[..at] } else { &rest[..at + 3] });
        rest = if decoded.is_some() { &behind[4..] } else { behind };
        out.extend(decoded);
    }
    out + rest
}

/// What names that are the same without regard to case have in common.
pub(super) fn folded(name: &str) -> String {
    name.to_lowercase()
}

/// Texts with commas between, the first `most` of them.
pub(super) fn list(all: impl ExactSizeIterator<Item = String>, most: usize) -> String {
    let n = all.len();
    let shown: Vec<String> = all.take(most).collect();
    let more = if n > most { format!(" and {} more", n - most) } else { String::new() };
    format!("{}{more}", shown.join(", "))
}
