//! What is measured is written, read and drawn; the same rows give the same bytes.

use super::*;
use sightlines_benches::chart::Panel;

/// A family that takes no time.
struct Made;

impl Family for Made {
    fn name(&self) -> &'static str {
        "made"
    }

    fn title(&self) -> &'static str {
        "Made"
    }

    fn about(&self) -> &'static str {
        "Nothing."
    }

    fn measure(&self, settings: &Settings) -> Result<Vec<Row>, ChartError> {
        let row = |method: &str, seconds: f64, reported: u64| Row {
            seconds: Some(seconds),
            reported: Some(reported),
            truth: Some(10),
            missed: Some(0),
            ..settings.row("made", method, "scene, with a comma")
        };
        Ok(vec![row("quick", 0.1, 30), row("slow", 1.0, 10), row("bad", 2.0, 40)])
    }

    fn panels(&self, rows: &[Row]) -> Vec<Panel> {
        panels::time_against_over(rows, "ms", "over")
    }
}

#[test]
fn drawing_reads_rows_alone_and_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings::here(true, None);
    let rows = Made.measure(&settings).unwrap();
    std::fs::write(folder.path().join("made.csv"), row::write(&rows)).unwrap();
    let families: Vec<Box<dyn Family>> = vec![Box::new(Made)];
    let files = || ["made.svg", "index.html"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    draw(folder.path(), &families).unwrap();
    let first = files();
    draw(folder.path(), &families).unwrap();
    assert_eq!(files(), first);
    let svg = String::from_utf8(first[0].clone()).unwrap();
    assert_eq!(svg.matches("r=\"9\"").count(), 2, "two of three points are on the front");
    // Another row, another picture.
    std::fs::write(folder.path().join("made.csv"), row::write(&rows[1..])).unwrap();
    draw(folder.path(), &families).unwrap();
    assert_ne!(files(), first);
    std::fs::write(folder.path().join("made.csv"), "nonsense").unwrap();
    let error = draw(folder.path(), &families).unwrap_err().to_string();
    assert!(error.ends_with("made.csv: line 1: not the columns of a chart"), "{error}");
}

#[test]
fn families_have_names_of_their_own() {
    let families = families();
    let names: std::collections::BTreeSet<&str> = families.iter().map(|f| f.name()).collect();
    assert_eq!(names.len(), families.len());
    for family in &families {
        assert!(!family.about().is_empty() && !family.title().is_empty());
        // Without rows there is nothing to draw, and no panic.
        assert!(family.panels(&[]).iter().all(|p| p.series.iter().all(|s| s.points.is_empty())));
    }
    let folder = tempfile::tempdir().unwrap();
    let task = Task { out: folder.path().into(), draw_only: true, only: Some("nobody".into()) };
    let error = run(&task, &Settings::here(true, None)).unwrap_err();
    assert!(matches!(&error, ChartError::Family { name, .. } if name == "nobody"), "{error}");
}

#[test]
fn rows_say_where_they_are_from() {
    let settings = Settings { machine: "a, b".into(), ..Settings::here(true, Some("/data".into())) };
    assert_eq!(settings.data, None, "the quick form is the same everywhere");
    assert_eq!(settings.row("f", "m", "s").machine, "a; b");
    assert!(!settings.commit.is_empty());
    let (value, seconds, repeats) = settings.best_of(|| 7);
    assert!(value == 7 && seconds < 1.0 && repeats == 3);
}
