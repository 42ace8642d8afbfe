//! What the programs of the benches share: arguments, exit codes, files of rows.

use sightlines::formats::files::atomic_write;
use std::error::Error;
use std::path::{Path, PathBuf};
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

/// Arguments of benches that measure and draw in two steps.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Files {
    /// Writes what was measured.
    #[arg(long)]
    pub csv: Option<PathBuf>,
    /// Measures nothing, and draws the rows of this file.
    #[arg(long, value_name = "CSV", requires = "svg")]
    pub draw: Option<PathBuf>,
    /// The chart to write.
    #[arg(long)]
    pub svg: Option<PathBuf>,
}

impl Files {
    /// The rows of the file to draw, or those that `measure` returns.
    ///
    /// # Errors
    /// Those of the file or of `measure`.
    pub fn rows<R>(
        &self,
        read: impl Fn(&str) -> Result<Vec<R>, String>,
        measure: impl FnOnce() -> Result<Vec<R>, Box<dyn Error>>,
    ) -> Result<Vec<R>, Box<dyn Error>> {
        match &self.draw {
            Some(file) => Ok(read_file(file, read)?),
            None => measure(),
        }
    }

    /// Writes the rows, if a file for them was named.
    ///
    /// # Errors
    /// With the name of the file.
    pub fn save_rows(&self, text: impl FnOnce() -> String) -> Result<(), String> {
        save(self.csv.as_deref(), text)
    }

    /// Writes the chart, if a file for it was named.
    ///
    /// # Errors
    /// With the name of the file.
    pub fn save_chart(&self, chart: impl FnOnce() -> String) -> Result<(), String> {
        save(self.svg.as_deref(), chart)
    }
}

/// Writes a file as a whole, if one was named.
///
/// # Errors
/// With the name of the file.
pub fn save(path: Option<&Path>, text: impl FnOnce() -> String) -> Result<(), String> {
    match path {
        Some(path) => atomic_write(path, text().as_bytes()).map_err(|error| error.to_string()),
        None => Ok(()),
    }
}

/// A row of a CSV file with one column for each field, as [`csv_row`](crate::csv_row) defines it.
pub trait CsvRow: Sized {
    /// The first line of the file: the names of the fields.
    fn head() -> String;

    /// The row as a line, without its end.
    fn line(&self) -> String;

    /// The row of a line; `None` for a line of another form.
    fn parse(line: &str) -> Option<Self>;
}

/// Defines the struct of a row: all fields are written with [`Display`](std::fmt::Display) and read with
/// [`FromStr`](std::str::FromStr), and no text contains a comma.
#[macro_export]
macro_rules! csv_row {
    (
        $(#[$about:meta])*
        $visibility:vis struct $name:ident { $($(#[$of_field:meta])* $of:vis $field:ident: $type:ty,)* }
    ) => {
        $(#[$about])*
        $visibility struct $name { $($(#[$of_field])* $of $field: $type,)* }

        impl $crate::program::CsvRow for $name {
            fn head() -> String {
                [$(stringify!($field)),*].join(",")
            }

            fn line(&self) -> String {
                [$(self.$field.to_string()),*].join(",")
            }

            fn parse(line: &str) -> Option<Self> {
                let mut fields = line.split(',');
                let row = Self { $($field: fields.next()?.parse().ok()?,)* };
                if fields.next().is_none() { Some(row) } else { None }
            }
        }
    };
}

/// Rows as the text of a file.
pub fn write_csv<R: CsvRow>(rows: &[R]) -> String {
    std::iter::once(R::head()).chain(rows.iter().map(R::line)).map(|line| line + "\n").collect()
}

/// The rows of the text of a file.
///
/// # Errors
/// As [`read_rows`].
pub fn read_csv<R: CsvRow>(text: &str) -> Result<Vec<R>, String> {
    read_rows(text, &R::head(), R::parse)
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

    csv_row! {
        #[derive(Debug, PartialEq)]
        struct Example {
            name: String,
            share: f64,
        }
    }

    #[test]
    fn rows_are_written_and_read_back() {
        let rows = [0.1, 1.0].map(|share| Example { name: "a b".to_owned(), share });
        let text = write_csv(&rows);
        assert_eq!(text, "name,share\na b,0.1\na b,1\n");
        assert_eq!(read_csv::<Example>(&text).unwrap(), rows);
        for broken in ["name\na\n", "name,share\na\n", "name,share\na,b\n", "name,share\na,1,2\n"] {
            assert!(read_csv::<Example>(broken).is_err(), "{broken}");
        }
    }

    #[test]
    fn benches_are_chosen_by_a_part_of_their_name() {
        let common = |filter: Option<&str>| Common { filter: filter.map(str::to_owned), ..Common::default() };
        assert!(common(None).is_wanted("tower") && common(Some("ow")).is_wanted("tower"));
        assert!(!common(Some("bake")).is_wanted("tower"));
    }
}
