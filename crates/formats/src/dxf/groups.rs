//! The groups of a drawing: pairs of a code and a value, a line each.

use crate::bytes::{line_end, without_mark};
use crate::error::{Malformed, malformed};
use std::str::FromStr;

const BINARY: &[u8] = b"AutoCAD Binary DXF";
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

    pub(super) fn expected(&self, what: &str) -> Malformed {
        malformed!("expected {what}").on_line(self.line)
    }

    pub(super) fn number(&self) -> Result<f64, Malformed> {
        self.parsed().filter(|x: &f64| x.is_finite()).ok_or_else(|| self.no_number())
    }

    pub(super) fn integer(&self) -> Result<i64, Malformed> {
        self.parsed().ok_or_else(|| self.no_number())
    }

    fn parsed<T: FromStr>(&self) -> Option<T> {
        parsed(self.value)
    }

    fn no_number(&self) -> Malformed {
        malformed!("this is no finite number").on_line(self.line)
    }
}

fn parsed<T: FromStr>(text: &[u8]) -> Option<T> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

/// Goes through the groups of a text. Comments are skipped.
#[derive(Debug)]
pub(super) struct Groups<'a> {
    rest: &'a [u8],
    line_end: u8,
    /// Lines before the rest.
    n_lines: usize,
    peeked: Option<Group<'a>>,
}

impl<'a> Groups<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: without_mark(text), line_end: line_end(text), n_lines: 0, peeked: None }
    }

    /// The next group; an error if there is none, as the drawing ends with `EOF`.
    pub(super) fn next(&mut self) -> Result<Group<'a>, Malformed> {
        match self.peeked.take() {
            Some(group) => Ok(group),
            None => self.read(),
        }
    }

    /// The next group, which stays the next.
    pub(super) fn peek(&mut self) -> Result<Group<'a>, Malformed> {
        let group = self.next()?;
        self.peeked = Some(group);
        Ok(group)
    }

    fn read(&mut self) -> Result<Group<'a>, Malformed> {
        loop {
            let before = self.n_lines.max(1);
            let what = "the drawing ends without EOF, so that a part of it may be missing";
            let truncated = || malformed!("{what}").on_line(before);
            let code = self.line().ok_or_else(truncated)?;
            if code.is_empty() && self.rest.trim_ascii().is_empty() {
                return Err(truncated());
            }
            let wrong = || malformed!("this is no group code, which is a whole number").on_line(self.n_lines);
            let code = parsed(code).ok_or_else(wrong)?;
            let value = self.line().ok_or_else(truncated)?;
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
        let end = self.rest.iter().position(|&byte| byte == self.line_end);
        let (line, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        (self.rest, self.n_lines) = (rest.get(1..).unwrap_or_default(), self.n_lines + 1);
        Some(line.trim_ascii())
    }
}

/// Reads the group that begins a record, and the groups of the record.
pub(super) fn next_record<'a>(groups: &mut Groups<'a>, fields: &mut Vec<Group<'a>>) -> Result<Group<'a>, Malformed> {
    fields.clear();
    let record = groups.next()?;
    if record.code != 0 {
        return Err(record.expected("a group with the code 0"));
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

pub(super) fn unended(end: &Group<'_>) -> Malformed {
    end.expected("the end of the section before EOF")
}

pub(super) fn refuse_binary(text: &[u8]) -> Result<(), Malformed> {
    let wrong = || Err(malformed!("this is binary DXF, which is not read: save it as text (ASCII)"));
    if text.starts_with(BINARY) { wrong() } else { Ok(()) }
}

/// Whether a file begins as a drawing: a section is opened, or it is the binary form.
pub(crate) fn is_dxf(head: &[u8]) -> bool {
    head.starts_with(BINARY) || Groups::new(head).next().is_ok_and(|group| group.is(0, "SECTION"))
}

pub(super) fn handle(group: &Group<'_>) -> Option<u64> {
    u64::from_str_radix(std::str::from_utf8(group.value).ok()?, 16).ok()
}

/// The handle of an entity's extension dictionary.
pub(super) fn extension(fields: &[Group<'_>]) -> Option<u64> {
    let begin = fields.iter().position(|group| group.is(102, "{ACAD_XDICTIONARY"))?;
    handle(fields.get(begin + 1)?)
}
