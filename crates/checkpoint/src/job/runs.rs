//! Numbers of shards as texts.

use std::fmt;
use std::str::FromStr;

/// Shards that follow each other: as a text `3-9`, or `3` if it is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShardRun {
    /// The first.
    pub first: usize,
    /// The last, which is no less.
    pub last: usize,
}

/// A text that is no run of shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("not a number of a shard, or a run of them such as 3-9")]
pub struct ParseShardRunError;

impl FromStr for ShardRun {
    type Err = ParseShardRunError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten();
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first <= last => Ok(Self { first, last }),
            _ => Err(ParseShardRunError),
        }
    }
}

impl fmt::Display for ShardRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, last } = self;
        if first == last { write!(f, "{first}") } else { write!(f, "{first}-{last}") }
    }
}

impl ShardRun {
    /// Ascending numbers as runs, as few as there can be.
    pub fn all(shards: &[usize]) -> Vec<Self> {
        let follow = shards.chunk_by(|a, b| a + 1 == *b);
        follow.map(|run| Self { first: run[0], last: run[run.len() - 1] }).collect()
    }

    /// Ascending numbers as texts of runs.
    pub fn texts(shards: &[usize]) -> Vec<String> {
        Self::all(shards).iter().map(Self::to_string).collect()
    }
}

/// Ascending numbers of shards in words: `shards 0 to 3, 7`.
pub fn in_words(shards: &[usize]) -> String {
    let run = |text: String| text.replace('-', " to ");
    let noun = if shards.len() == 1 { "shard" } else { "shards" };
    format!("{noun} {}", ShardRun::texts(shards).into_iter().map(run).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_read_as_they_are_written() {
        assert_eq!(ShardRun::texts(&[0, 1, 2, 7, 9, 10]), ["0-2", "7", "9-10"]);
        assert!(ShardRun::all(&[]).is_empty());
        for run in ShardRun::all(&[0, 1, 2, 7]) {
            assert_eq!(run.to_string().parse(), Ok(run));
        }
        for wrong in ["", "-", "3-", "-3", "9-3", "1-2-3", "x", "+1", "99999999999999999999"] {
            assert!(wrong.parse::<ShardRun>().is_err(), "{wrong}");
        }
        let words = [&[3][..], &[0, 1, 2], &[0, 2, 3, 9]].map(in_words);
        assert_eq!(words, ["shard 3", "shards 0 to 2", "shards 0, 2 to 3, 9"]);
    }
}
