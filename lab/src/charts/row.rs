//! What is measured: rows of one schema for all families, as CSV.
//!
//! A number that a family does not measure is left empty. Text has no commas, so nothing is quoted.

/// The columns, in order.
pub const HEAD: &str = "family,method,scene,size,size_of,threads,repeats,time_seconds,reported,true_or_seen,truth_by,\
                        over_estimate,missed,error,bytes,note,machine,commit";

/// One method on one scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// The family of charts.
    pub family: String,
    /// The method, with its settings if it was run with several.
    pub method: String,
    /// The scene.
    pub scene: String,
    /// How large the scene is.
    pub size: u64,
    /// Of what there are so many: cells, triangles, floors.
    pub size_of: String,
    /// Threads that worked.
    pub threads: u32,
    /// Of so many runs the quickest counts.
    pub repeats: u32,
    /// Seconds of the quickest run; what a family takes the time of, its explanation says.
    pub seconds: Option<f64>,
    /// What the method calls visible, or leaves: pairs, cells, objects, triangles.
    pub reported: Option<u64>,
    /// What is visible.
    pub truth: Option<u64>,
    /// Who says so: an exact method, or rays, which may miss something.
    pub truth_by: String,
    /// What of the truth the method calls hidden: the unsafe kind of error.
    pub missed: Option<u64>,
    /// A share that is wrong: of pixels, of directions.
    pub error: Option<f64>,
    /// Memory or size of a file, in bytes.
    pub bytes: Option<u64>,
    /// What else is to be known.
    pub note: String,
    /// Model and number of processors.
    pub machine: String,
    /// The state of the program that measured.
    pub commit: String,
}

/// A line that is no row.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct RowError {
    /// Its number, from 1.
    pub line: usize,
    /// What is wrong with it.
    pub what: String,
}

impl Row {
    /// `reported` over `truth`, if both are known and something is visible. 1 is exact, more is too much; less than 1 can
    /// only be where something is missed.
    pub fn over_estimate(&self) -> Option<f64> {
        Some(self.reported? as f64 / self.truth.filter(|&truth| truth > 0)? as f64)
    }

    /// Whether the method is known to have called something hidden that is visible.
    pub fn is_unsafe(&self) -> bool {
        self.missed.is_some_and(|missed| missed > 0)
    }

    fn line(&self) -> String {
        let fields = [
            clean(&self.family),
            clean(&self.method),
            clean(&self.scene),
            self.size.to_string(),
            clean(&self.size_of),
            self.threads.to_string(),
            self.repeats.to_string(),
            or_empty(self.seconds),
            or_empty(self.reported),
            or_empty(self.truth),
            clean(&self.truth_by),
            or_empty(self.over_estimate()),
            or_empty(self.missed),
            or_empty(self.error),
            or_empty(self.bytes),
            clean(&self.note),
            clean(&self.machine),
            clean(&self.commit),
        ];
        fields.join(",")
    }

    fn parse(line: &str) -> Result<Self, String> {
        let fields: Vec<&str> = line.split(',').collect();
        let n_columns = HEAD.split(',').count();
        if fields.len() != n_columns {
            return Err(format!("{} fields instead of {n_columns}", fields.len()));
        }
        let text = |k: usize| fields[k].to_owned();
        Ok(Self {
            family: text(0),
            method: text(1),
            scene: text(2),
            size: number(fields[3])?,
            size_of: text(4),
            threads: number(fields[5])?,
            repeats: number(fields[6])?,
            seconds: maybe(fields[7])?,
            reported: maybe(fields[8])?,
            truth: maybe(fields[9])?,
            truth_by: text(10),
            // The over-estimate follows from two others.
            missed: maybe(fields[12])?,
            error: maybe(fields[13])?,
            bytes: maybe(fields[14])?,
            note: text(15),
            machine: text(16),
            commit: text(17),
        })
    }
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("'{text}' is no number of its column"))
}

fn maybe<T: std::str::FromStr>(text: &str) -> Result<Option<T>, String> {
    if text.is_empty() { Ok(None) } else { number(text).map(Some) }
}

fn or_empty<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Text without what would end a field or a line.
pub(crate) fn clean(text: &str) -> String {
    text.replace(',', ";").replace(['\n', '\r'], " ")
}

/// All rows, with the columns' names first.
pub fn write(rows: &[Row]) -> String {
    let lines: String = rows.iter().map(|row| row.line() + "\n").collect();
    format!("{HEAD}\n{lines}")
}

/// The rows of what [`write()`] wrote.
///
/// # Errors
/// [`RowError`] for the first line that is none of it.
pub fn read(text: &str) -> Result<Vec<Row>, RowError> {
    let mut lines = text.lines().zip(1..);
    if lines.next().is_none_or(|(head, _)| head != HEAD) {
        return Err(RowError { line: 1, what: "not the columns of a chart".to_owned() });
    }
    lines.map(|(line, number)| Row::parse(line).map_err(|what| RowError { line: number, what })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_row() -> impl Strategy<Value = Row> {
        let text = "[a-z0-9 .:()]{0,12}";
        let numbers = (any::<u64>(), 0u32..9, 1u32..9, proptest::option::of(1e-9f64..1e9));
        let counts = proptest::array::uniform4(proptest::option::of(any::<u64>()));
        (proptest::array::uniform8(text), numbers, counts, proptest::option::of(0.0f64..1.0)).prop_map(
            |(texts, (size, threads, repeats, seconds), [reported, truth, missed, bytes], error)| {
                let [family, method, scene, size_of, truth_by, note, machine, commit] = texts;
                Row {
                    family,
                    method,
                    scene,
                    size,
                    size_of,
                    threads,
                    repeats,
                    seconds,
                    reported,
                    truth,
                    truth_by,
                    missed,
                    error,
                    bytes,
                    note,
                    machine,
                    commit,
                }
            },
        )
    }

    proptest! {
        #[test]
        fn rows_are_read_back(rows in proptest::collection::vec(any_row(), 0..5)) {
            prop_assert_eq!(read(&write(&rows)).unwrap(), rows, "rows_are_read_back");
        }
    }

    #[test]
    fn broken_lines_are_named() {
        let row = Row { scene: "a, b\nc".into(), threads: 1, ..Row::default() };
        let text = write(&[row.clone(), row]);
        assert_eq!(read(&text).unwrap()[0].scene, "a; b c");
        assert_eq!(read(&text.replacen("family", "f", 1)).unwrap_err().line, 1);
        let error = read(&(text.clone() + "x,y\n")).unwrap_err();
        assert_eq!(error.to_string(), "line 4: 2 fields instead of 18");
        assert_eq!(read(&text.replacen(",0,,1,", ",zero,,1,", 1)).unwrap_err().line, 2);
    }

    #[test]
    fn over_estimates_follow_from_counts() {
        let row = Row { reported: Some(30), truth: Some(20), ..Row::default() };
        assert_eq!((row.over_estimate(), row.is_unsafe()), (Some(1.5), false));
        let none = Row { truth: Some(0), missed: Some(1), ..row };
        assert_eq!((none.over_estimate(), none.is_unsafe()), (None, true));
    }
}
