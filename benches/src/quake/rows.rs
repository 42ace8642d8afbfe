//! What was measured, as a file that grows map by map and as a table for people.

use super::job::{ClusterMethod, Measured};
use crate::program::read_rows;
use sightlines::pvs::BitMatrix;
use std::fmt::Write;

/// One method on one map.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The map's name.
    pub map: String,
    /// Clusters of the map.
    pub clusters: u64,
    /// Portals of the map, but those without area.
    pub portals: u64,
    /// Ordered pairs of different clusters that are known to see each other; `None` where nothing is known.
    pub witnessed: Option<u64>,
    /// The method.
    pub method: ClusterMethod,
    /// What it took on one thread.
    pub measured: Measured,
    /// Seconds by the clock with two threads; only of the exact search.
    pub wall_two: Option<f64>,
    /// Ordered pairs of different clusters that it shows.
    pub pairs: u64,
    /// Ordered pairs of those witnessed that it hides.
    pub missing: Option<u64>,
    /// Ordered pairs that the exact search shows without a line; of its own row.
    pub undecided: u64,
    /// Ordered pairs that the exact search has a line for each, if it came to its end, and those of them that this
    /// method hides.
    pub proven: Option<[u64; 2]>,
}

/// The columns of the file.
const COLUMNS: [&str; 17] = [
    "map",
    "clusters",
    "portals",
    "witnessed",
    "method",
    "cpu_s",
    "wall_s",
    "wall_two_threads_s",
    "peak_bytes",
    "pairs",
    "missing",
    "undecided",
    "proven",
    "missing_proven",
    "done",
    "over",
    "counters",
];

/// Ordered pairs of different clusters that a table shows.
pub fn n_pairs(table: &BitMatrix) -> u64 {
    let diagonal = (0..table.n_rows()).filter(|&k| table.get(k, k)).count();
    table.count_ones() - diagonal as u64
}

/// Ordered pairs that `witness` has and `table` has not.
pub fn n_missing(witness: &BitMatrix, table: &BitMatrix) -> u64 {
    let words = |row: usize| witness.row(row).iter().zip(table.row(row));
    (0..witness.n_rows()).flat_map(words).map(|(seen, shown)| u64::from((seen & !shown).count_ones())).sum()
}

/// The pairs of a table that are in it both ways. O(clusters²).
pub fn both_ways(table: &BitMatrix) -> BitMatrix {
    let mut result = BitMatrix::new(table.n_rows(), table.n_cols());
    for a in 0..table.n_rows() {
        table.iter_ones(a).filter(|&b| table.get(b, a)).for_each(|b| result.set(a, b, true));
    }
    result
}

/// The rows of one map, of all that were measured.
pub fn of_map<'r>(rows: &'r [Row], map: &str) -> Vec<&'r Row> {
    rows.iter().filter(|row| row.map == map).collect()
}

/// The maps that rows are of, by portals and name.
pub fn maps(rows: &[Row]) -> Vec<&str> {
    let mut maps: Vec<(u64, &str)> = rows.iter().map(|row| (row.portals, row.map.as_str())).collect();
    maps.sort_unstable();
    maps.dedup();
    maps.into_iter().map(|(_, map)| map).collect()
}

/// How many pairs of a map are known to be visible: those proven, or else those witnessed.
pub fn known(rows: &[&Row]) -> Option<u64> {
    let proven = rows.iter().find_map(|row| row.proven).map(|[proven, _]| proven);
    proven.or_else(|| rows.first().and_then(|row| row.witnessed))
}

/// Puts a row in, in place of one of the same map and method.
pub fn put(rows: &mut Vec<Row>, row: Row) {
    rows.retain(|other| other.map != row.map || other.method != row.method);
    rows.push(row);
    rows.sort_by(|a, b| (a.portals, &a.map, a.method).cmp(&(b.portals, &b.map, b.method)));
}

/// The file. It says more than it needs: the ratio `over` is not read back.
pub fn csv(rows: &[Row]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for row in rows {
        let m = &row.measured;
        let over = known(&of_map(rows, &row.map)).map(|known| format!("{:.6}", row.pairs as f64 / known as f64));
        let fields = [
            row.map.clone(),
            row.clusters.to_string(),
            row.portals.to_string(),
            row.witnessed.map_or_else(String::new, |n| n.to_string()),
            row.method.to_string(),
            format!("{:.6}", m.cpu),
            format!("{:.6}", m.wall),
            row.wall_two.map_or_else(String::new, |s| format!("{s:.6}")),
            m.peak.to_string(),
            row.pairs.to_string(),
            row.missing.map_or_else(String::new, |n| n.to_string()),
            row.undecided.to_string(),
            row.proven.map_or_else(String::new, |[n, _]| n.to_string()),
            row.proven.map_or_else(String::new, |[_, n]| n.to_string()),
            format!("{:.6}", m.done),
            over.unwrap_or_default(),
            m.counters.clone(),
        ];
        text += &(fields.join(",") + "\n");
    }
    text
}

/// Reads the file back.
///
/// # Errors
/// The first line that is not one of it.
pub fn read(text: &str) -> Result<Vec<Row>, String> {
    read_rows(text, &COLUMNS.join(","), row)
}

/// A number, or none for nothing; an error for anything else.
fn optional<T: std::str::FromStr>(text: &str) -> Result<Option<T>, T::Err> {
    if text.is_empty() { Ok(None) } else { text.parse().map(Some) }
}

fn row(line: &str) -> Option<Row> {
    let fields: Vec<&str> = line.split(',').collect();
    let &[
        map,
        clusters,
        portals,
        witnessed,
        method,
        cpu,
        wall,
        two,
        peak,
        pairs,
        missing,
        undecided,
        proven,
        hidden,
        done,
        _,
        counters,
    ] = &fields[..]
    else {
        return None;
    };
    let [cpu, wall, done] = [cpu, wall, done].map(|x| x.parse::<f64>().ok().filter(|x| x.is_finite()));
    let measured =
        Measured { cpu: cpu?, wall: wall?, peak: peak.parse().ok()?, done: done?, counters: counters.to_owned() };
    Some(Row {
        map: map.to_owned(),
        clusters: clusters.parse().ok()?,
        portals: portals.parse().ok()?,
        witnessed: optional(witnessed).ok()?,
        method: method.parse().ok()?,
        measured,
        wall_two: optional(two).ok()?,
        pairs: pairs.parse().ok()?,
        missing: optional(missing).ok()?,
        undecided: undecided.parse().ok()?,
        proven: optional(proven).ok()?.zip(optional(hidden).ok()?).map(|(proven, hidden)| [proven, hidden]),
    })
}

/// Seconds with as many digits as they are worth.
pub fn seconds(s: f64) -> String {
    match s {
        0.0..0.0995 => format!("{s:.3}"),
        0.0..9.95 => format!("{s:.2}"),
        _ => format!("{s:.1}"),
    }
}

/// Tables for people.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = "| map | clusters | portals | method | CPU, s | times exact | pairs | over witnessed | over proven \
         | missing, witnessed | missing, proven | undecided |\n\
         | --- | --: | --: | --- | --: | --: | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    for map in maps(rows) {
        let own = of_map(rows, map);
        let exact =
            own.iter().find(|r| r.method == ClusterMethod::Exact && r.measured.done == 1.0).map(|r| r.measured.cpu);
        for (row, is_first) in own.iter().zip(std::iter::once(true).chain(std::iter::repeat(false))) {
            let head =
                if is_first { format!("{map} | {} | {}", row.clusters, row.portals) } else { " | | ".to_owned() };
            let _ = writeln!(text, "| {head} | {} |", fields(row, exact).join(" | "));
        }
    }
    text += "\nThe exact search:\n\n\
         | map | peak, MiB | one thread, wall s | two threads, wall s | ratio | counted |\n\
         | --- | --: | --: | --: | --: | --- |\n";
    for map in maps(rows) {
        for row in of_map(rows, map).into_iter().filter(|row| row.method == ClusterMethod::Exact) {
            let m = &row.measured;
            let [two, ratio] =
                row.wall_two.map_or([const { String::new() }; 2], |two| [seconds(two), format!("{:.2}", m.wall / two)]);
            let counted = m.counters.replace(' ', ", ").replace('=', " ");
            let peak = m.peak as f64 / f64::from(1 << 20);
            let _ = writeln!(text, "| {map} | {peak:.1} | {} | {two} | {ratio} | {counted} |", seconds(m.wall));
        }
    }
    text
}

/// The columns of a method on a map, given the time of the exact search.
fn fields(row: &Row, exact: Option<f64>) -> [String; 9] {
    let m = &row.measured;
    let mut method = row.method.title().to_owned();
    if m.done < 1.0 {
        let _ = write!(method, ", not finished in {:.0} s ({:.1} % done)", m.cpu, 100.0 * m.done);
    }
    let more = if m.done < 1.0 { "> " } else { "" };
    let text = |n: Option<u64>| n.map_or_else(String::new, |n| n.to_string());
    let over = |n: Option<u64>| n.map_or_else(String::new, |n| format!("{:.4}", row.pairs as f64 / n as f64));
    [
        method,
        format!("{more}{}", seconds(m.cpu)),
        exact.map_or_else(String::new, |exact| format!("{more}{:.2}", m.cpu / exact)),
        row.pairs.to_string(),
        over(row.witnessed),
        over(row.proven.map(|[n, _]| n)),
        text(row.missing),
        text(row.proven.map(|[_, n]| n)),
        text((row.method == ClusterMethod::Exact).then_some(row.undecided)),
    ]
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn example(map: &str, method: ClusterMethod, pairs: u64) -> Row {
        let measured =
            Measured { cpu: 0.5, wall: 0.75, peak: 3 << 20, counters: "clips=7 lines=9".into(), ..Measured::default() };
        Row {
            map: map.into(),
            clusters: 10,
            portals: 12,
            witnessed: Some(40),
            method,
            measured: Measured { done: 1.0, ..measured },
            wall_two: (method == ClusterMethod::Exact).then_some(0.5),
            pairs,
            missing: Some(0),
            undecided: 2,
            proven: None,
        }
    }

    #[test]
    fn files_are_read_back_and_rows_replaced() {
        let mut rows = Vec::new();
        for (map, method, pairs) in [
            ("b", ClusterMethod::Exact, 44),
            ("a", ClusterMethod::Exact, 50),
            ("b", ClusterMethod::Base, 60),
            ("b", ClusterMethod::Exact, 42),
        ] {
            put(&mut rows, example(map, method, pairs));
        }
        rows[0].witnessed = None;
        assert_eq!(
            rows.iter().map(|r| (r.map.as_str(), r.pairs)).collect::<Vec<_>>(),
            [("a", 50), ("b", 60), ("b", 42)]
        );
        let text = csv(&rows);
        assert_eq!(read(&text).unwrap(), rows);
        assert!(text.contains(",1.050000,clips=7 lines=9\n"), "{text}");
        for broken in [text.replace("map,", "m,"), text.replace(",exact,", ",guess,"), text.replace(",44\n", ",")] {
            assert!(broken == text || read(&broken).unwrap_err().starts_with("line "), "{broken}");
        }
        assert!(read(&text.replacen(",0.750000,", ",nan,", 1)).unwrap_err().starts_with("line 2"));
    }

    #[test]
    fn tables_say_what_is_known() {
        let mut rows = vec![example("a", ClusterMethod::Separators, 41), example("a", ClusterMethod::Exact, 40)];
        rows[0].measured.done = 0.25;
        let says = |rows: &[Row], what: &str| assert!(markdown(rows).contains(what), "{}", markdown(rows));
        let stopped = "| separators only, not finished in 0 s (25.0 % done) | > 0.50 | > 1.00 | 41 |";
        says(&rows, &format!("| a | 10 | 12 {stopped} 1.0250 |  | 0 |  |  |"));
        says(&rows, "|  | |  | exact | 0.50 | 1.00 | 40 | 1.0000 |  | 0 |  | 2 |");
        says(&rows, "| a | 3.0 | 0.75 | 0.50 | 1.50 | clips 7, lines 9 |");
        rows.iter_mut().for_each(|row| (row.witnessed, row.missing, row.proven) = (None, None, Some([38, 5])));
        says(&rows, &format!("{stopped}  | 1.0789 |  | 5 |  |"));
        assert_eq!(known(&[]), None);
        assert_eq!(known(&of_map(&rows, "a")), Some(38));
    }

    #[test]
    fn what_is_missing_is_counted() {
        let mut witness = BitMatrix::identity(70);
        witness.set(3, 69, true);
        let mut table = BitMatrix::identity(70);
        assert_eq!((n_missing(&witness, &table), n_pairs(&table)), (1, 0));
        table.set(3, 69, true);
        assert_eq!((n_missing(&witness, &table), n_pairs(&table)), (0, 1));
        assert_eq!(n_pairs(&both_ways(&table)), 0);
        table.set(69, 3, true);
        assert_eq!(both_ways(&table), table);
    }
}
