//! The groups of a drawing: pairs of a code and a value, a line each.

use super::error::{DxfError, DxfErrorKind};

/// How binary DXF begins.
const BINARY: &[u8] = b"AutoCAD Binary DXF";
/// The three bytes that some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";
/// The code of a comment.
const COMMENT: i32 = 999;

/// A code and its value, without blanks around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Group<'a> {
    pub(super) code: i32,
    pub(super) value: &'a [u8],
    /// Line of the value, from 1.
    pub(super) line: usize,
}

impl<'a> Group<'a> {
    pub(super) fn is(&self, code: i32, value: &str) -> bool {
        self.code == code && self.value == value.as_bytes()
    }

    /// The value as a finite number.
    pub(super) fn number(&self) -> Result<f64, DxfError> {
        let number = std::str::from_utf8(self.value).ok().and_then(|text| text.parse::<f64>().ok());
        let finite = number.filter(|x| x.is_finite());
        finite.ok_or(DxfError::at(self.line, DxfErrorKind::Number))
    }

    /// The value as a whole number.
    pub(super) fn integer(&self) -> Result<i64, DxfError> {
        let number = std::str::from_utf8(self.value).ok().and_then(|text| text.parse::<i64>().ok());
        number.ok_or(DxfError::at(self.line, DxfErrorKind::Number))
    }
}

/// Goes through the groups of a text. Comments are skipped.
#[derive(Debug)]
pub(super) struct Groups<'a> {
    rest: &'a [u8],
    /// Lines before the rest.
    n_lines: usize,
    peeked: Option<Group<'a>>,
}

impl<'a> Groups<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text), n_lines: 0, peeked: None }
    }

    /// The next group; an error if there is none, as the drawing ends with `EOF`.
    pub(super) fn next(&mut self) -> Result<Group<'a>, DxfError> {
        match self.peeked.take() {
            Some(group) => Ok(group),
            None => self.read(),
        }
    }

    /// The next group, which stays the next.
    pub(super) fn peek(&mut self) -> Result<Group<'a>, DxfError> {
        let group = self.next()?;
        self.peeked = Some(group);
        Ok(group)
    }

    fn read(&mut self) -> Result<Group<'a>, DxfError> {
        loop {
            let truncated = DxfError::at(self.n_lines.max(1), DxfErrorKind::Truncated);
            let Some(code) = self.line() else { return Err(truncated) };
            if code.is_empty() && self.rest.trim_ascii().is_empty() {
                return Err(truncated);
            }
            let number = std::str::from_utf8(code).ok().and_then(|text| text.parse().ok());
            let code = number.ok_or(DxfError::at(self.n_lines, DxfErrorKind::Code))?;
            let Some(value) = self.line() else { return Err(truncated) };
            if code != COMMENT {
                return Ok(Group { code, value, line: self.n_lines });
            }
        }
    }

    /// The next line without its end and blanks around it.
    fn line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n');
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &self.rest[self.rest.len()..]),
        };
        (self.rest, self.n_lines) = (rest, self.n_lines + 1);
        Some(line.trim_ascii())
    }
}

/// Reads the group that begins a record, and the groups of the record.
pub(super) fn next_record<'a>(groups: &mut Groups<'a>, fields: &mut Vec<Group<'a>>) -> Result<Group<'a>, DxfError> {
    fields.clear();
    let record = groups.next()?;
    if record.code != 0 {
        return Err(DxfError::at(record.line, DxfErrorKind::Expected("a group with the code 0")));
    }
    if record.value == b"EOF" {
        return Err(unended(&record));
    }
    // The end of a section has no groups, and what follows it is not looked at.
    if record.value != b"ENDSEC" {
        while groups.peek()?.code != 0 {
            fields.push(groups.next()?);
        }
    }
    Ok(record)
}

/// The error of an end mark within a section.
pub(super) fn unended(end: &Group<'_>) -> DxfError {
    DxfError::at(end.line, DxfErrorKind::Expected("the end of the section before EOF"))
}

/// Refuses the binary form.
pub(super) fn refuse_binary(text: &[u8]) -> Result<(), DxfError> {
    if text.starts_with(BINARY) { Err(DxfError::whole(DxfErrorKind::Binary)) } else { Ok(()) }
}

/// Whether a file begins as a drawing: a section is opened, or it is the binary form.
pub(crate) fn is_dxf(head: &[u8]) -> bool {
    head.starts_with(BINARY) || Groups::new(head).next().is_ok_and(|group| group.is(0, "SECTION"))
}
