//! Bytes of files: numbers in them, and marks before texts.

/// What follows the three bytes that some editors put before a text.
pub(crate) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text)
}

/// What ends the lines of a text: LF, behind CR or not; CR alone in texts of old programs, which have no other.
pub(crate) fn line_end(text: &[u8]) -> u8 {
    if text.contains(&b'\n') { b'\n' } else { b'\r' }
}

/// The lines of a text, without their ends: LF, CR and LF, or CR alone, each wherever it stands.
pub(crate) fn text_lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lines = text.split(|&byte| byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    lines.flat_map(|line| line.split(|&byte| byte == b'\r'))
}

/// Whether a text begins with another, in any case of letters.
pub(crate) fn begins_with(text: &[u8], with: &str) -> bool {
    text.get(..with.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(with.as_bytes()))
}

/// The bytes at `at`, which the caller knows to be inside.
pub(crate) fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[at..at + N]);
    out
}

/// Little-endian numbers at a place that the caller knows to be inside.
macro_rules! numbers {
    ($($name:ident: $number:ty),+) => {
        $(pub(crate) fn $name(bytes: &[u8], at: usize) -> $number {
            <$number>::from_le_bytes(bytes_at(bytes, at))
        })+
    };
}
numbers!(i16_at: i16, u16_at: u16, i32_at: i32, u32_at: u32);

/// A little-endian number; `None` if it is not inside.
pub(crate) fn number_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|&number| u32::from_le_bytes(number))
}
