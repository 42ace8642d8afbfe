//! Numbers of shards in arguments.

/// Shards that follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) last: usize,
}

impl Run {
    /// A number, or two with a hyphen between them, the lower one first.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten();
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first <= last => Ok(Self { first, last }),
            _ => Err("not a number of a shard, or a run of them such as 3-9".to_owned()),
        }
    }

    /// Ascending numbers as runs.
    pub(super) fn all(shards: &[usize]) -> Vec<Self> {
        let mut runs: Vec<Self> = Vec::new();
        for &shard in shards {
            match runs.last_mut() {
                Some(run) if run.last + 1 == shard => run.last = shard,
                _ => runs.push(Self { first: shard, last: shard }),
            }
        }
        runs
    }

    /// As an argument.
    pub(super) fn text(self) -> String {
        let Self { first, last } = self;
        if first == last { format!("{first}") } else { format!("{first}-{last}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_read_as_they_are_written() {
        let texts = |shards: &[usize]| Run::all(shards).into_iter().map(Run::text).collect::<Vec<_>>();
        assert_eq!(texts(&[0, 1, 2, 7, 9, 10]), ["0-2", "7", "9-10"]);
        assert!(texts(&[]).is_empty());
        for run in Run::all(&[0, 1, 2, 7]) {
            assert_eq!(Run::parse(&run.text()), Ok(run));
        }
        for wrong in ["", "-", "3-", "-3", "9-3", "1-2-3", "x", "+1", "99999999999999999999"] {
            assert!(Run::parse(wrong).is_err(), "{wrong}");
        }
    }
}
