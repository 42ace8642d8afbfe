//! The page about all sweeps, and the sums of each method.

use super::method::Kind;
use super::table::Row;
use std::fmt::Write;

/// The sums of a method over all rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sum {
    /// Its name.
    pub method: String,
    /// What is expected of it.
    pub kind: Kind,
    /// Cases, open ones, unsafe and loose failures, errors.
    pub counts: [u64; 5],
}

/// The sums, by kind, then in the order of the rows.
pub fn sums(rows: &[Row]) -> Vec<Sum> {
    let mut sums: Vec<Sum> = Vec::new();
    for row in rows {
        let counts = [row.cases, row.open, row.n_unsafe, row.loose, row.errors];
        match sums.iter_mut().find(|s| s.method == row.method && s.kind == row.kind) {
            Some(sum) => sum.counts.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n),
            None => sums.push(Sum { method: row.method.clone(), kind: row.kind, counts }),
        }
    }
    sums.sort_by_key(|s| s.kind);
    sums
}

/// A table of sums for a terminal or a page, in Markdown.
pub fn summary(rows: &[Row]) -> String {
    let sums = sums(rows);
    let wide = sums.iter().map(|s| s.method.len()).max().unwrap_or(0).max(6);
    let mut text = format!(
        "| {:wide$} | {:9} | {:>8} | {:>8} | {:>8} | {:>8} | {:>8} |\n| {} | --------- | -------: | -------: | -------: | -------: | -------: |\n",
        "method",
        "kind",
        "cases",
        "open",
        "unsafe",
        "loose",
        "errors",
        "-".repeat(wide)
    );
    for Sum { method, kind, counts: [cases, open, n_unsafe, loose, errors] } in sums {
        let kind = kind.name();
        let _ = writeln!(
            text,
            "| {method:wide$} | {kind:9} | {cases:8} | {open:8} | {n_unsafe:8} | {loose:8} | {errors:8} |"
        );
    }
    text
}

/// What the page says of a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// Name of its files.
    pub name: &'a str,
    /// What is swept.
    pub about: &'a str,
    /// The parameter.
    pub parameter: &'a str,
    /// What was counted.
    pub rows: &'a [Row],
}

const INTRODUCTION: &str = "\
# Where methods fail

Made by `cargo xtask stability` from the CSV files in [stability/](stability/); same input, same bytes. Each sweep has a
parameter that makes questions harder for rounded numbers. For each case the truth is known exactly, by a method
that shares no code with those under test.

* *unsafe*: something that an open set of lines sees is reported hidden. Shipped methods have none.
* *loose*: something hidden is reported visible, or is undecided, which counts as visible.
* *errors*: no answer: a panic, an error, or not a number.

Shipped methods are what users get. References are kept for comparison and decide nothing. Solvers are packages of others,
used plainly. Naive methods are the warning examples: the same questions in plain floating point.

Numbers are rounded like this: a case is rounded to doubles first, and its truth is that of the rounded case. A method
in single precision rounds its input, as its user would; the truth remains that of the doubles.

## Methods along sequences of portals

* `funnel`, `axial`, `convex`: the shipped stabbers, pushed portal by portal as a search does; `… proven` is the question
  about one sequence, whose witness or certificate is checked. What `convex` leaves undecided counts as visible.
* `lp good_lp` is the program of the literature given to good_lp with its feature `minilp`, which is microlp 0.6;
  `lp minilp` to minilp 0.2.2, `lp microlp` to microlp 0.7. With `unit` the portals are first moved and scaled into the
  unit box. A margin above 1e-9 is taken for a line, none for a proof that there is none. `axial lp` are those of the
  octants of directions. `lp checked` is how this project uses them, and hides nothing visible.
* `funnel f64`, `f32`: the shipped algorithm with sides computed from differences of coordinates in plain numbers;
  `coefficients` computes the line first; so do `strict 1e-9`, which treats anything nearer than that to the limit as
  blocked, and `lenient 1e-9`, which treats it as open. `… of stored f32` is the shipped, exact method given coordinates that were stored in single
  precision.
* `axial clipping`: slownesses clipped by all that doors ask of them, right in exact numbers, here in plain ones.
* `separators`: separating planes along the sequence, as Quake's programs clip, with their tolerance 0.1, a smaller one,
  and none in double and single precision.
* `edges`: all lines through four edges in Plücker coordinates, in plain numbers.

";

/// The page, in Markdown.
pub fn page(parts: &[Part<'_>]) -> String {
    let all: Vec<Row> = parts.iter().flat_map(|p| p.rows.iter().cloned()).collect();
    let mut text = format!("{INTRODUCTION}## All sweeps\n\n{}", summary(&all));
    for Part { name, about, parameter, rows } in parts {
        let _ = write!(
            text,
            "\n## {name}\n\n{about}\n\nParameter: {parameter}. [Numbers](stability/{name}.csv).\n\n![{name}](stability/{name}.svg)\n\n{}",
            summary(rows)
        );
    }
    text
}
