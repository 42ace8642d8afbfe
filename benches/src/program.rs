//! What the programs of the benches share: arguments, exit codes, files of rows.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

/// Arguments of every bench.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Common {
    /// Runs only if this bench's name contains it.
    pub filter: Option<String>,
    /// Checks the answers on small input.
    #[arg(long)]
    pub test: bool,
    /// Given by cargo.
    #[arg(long, hide = true)]
    pub bench: bool,
}

impl Common {
    /// Whether the bench of this name is to run.
    pub fn is_wanted(&self, name: &str) -> bool {
        self.filter.as_ref().is_none_or(|filter| name.contains(filter.as_str()))
    }
}

/// Success; or 2 for an error, which is printed.
pub fn exit(result: Result<(), Box<dyn Error>>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// The rows of a CSV text with this first line.
///
/// # Errors
/// The first line that is not as this bench writes it, from 1.
pub fn read_rows<R>(text: &str, head: &str, parse: impl Fn(&str) -> Option<R>) -> Result<Vec<R>, String> {
    let mut lines = text.lines().zip(1..);
    if lines.next().is_none_or(|(first, _)| first != head) {
        return Err("line 1: not what this bench writes".to_owned());
    }
    lines.map(|(line, number)| parse(line).ok_or_else(|| format!("line {number}: not a row of this bench"))).collect()
}

/// What `read` makes of a file.
///
/// # Errors
/// With the name of the file.
pub fn read_file<R>(path: &Path, read: impl Fn(&str) -> Result<R, String>) -> Result<R, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    read(&text).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_below_their_head() {
        let read = |text: &str| read_rows(text, "n", |line| line.parse::<u32>().ok());
        assert_eq!(read("n\n1\n2\n"), Ok(vec![1, 2]));
        assert_eq!(read("m\n1\n"), Err("line 1: not what this bench writes".to_owned()));
        assert_eq!(read("n\n1\nx\n"), Err("line 3: not a row of this bench".to_owned()));
    }

    #[test]
    fn benches_are_chosen_by_a_part_of_their_name() {
        let common = |filter: Option<&str>| Common { filter: filter.map(str::to_owned), ..Common::default() };
        assert!(common(None).is_wanted("tower") && common(Some("ow")).is_wanted("tower"));
        assert!(!common(Some("bake")).is_wanted("tower"));
    }
}
