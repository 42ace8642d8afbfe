//! From rows to panels: what most families draw.

use super::row::Row;
use sightlines_benches::chart::{Panel, Point, Series};

/// The method of a row without its setting: what stands before the first colon.
pub fn base_name(method: &str) -> &str {
    method.split_once(": ").map_or(method, |(base, _)| base)
}

/// What comes first, each once.
fn in_order<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

/// How a family's rows become points.
pub struct Layout<'a> {
    /// What is to the right, and what is up.
    pub names: [&'a str; 2],
    /// The coordinates of a row, if it has them.
    pub at: &'a dyn Fn(&Row) -> Option<[f64; 2]>,
    /// Whether the front is marked.
    pub has_front: bool,
}

/// A panel for each scene; in it, methods by name, joined where they were run with several settings. A method looks the
/// same in all panels.
pub fn by_scene(rows: &[Row], layout: &Layout<'_>) -> Vec<Panel> {
    let methods = in_order(rows.iter().map(|r| base_name(&r.method)));
    let panel = |scene: &str| {
        let own: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
        let series = methods.iter().enumerate().filter_map(|(slot, method)| {
            let of_method: Vec<&Row> = own.iter().copied().filter(|r| base_name(&r.method) == *method).collect();
            let point = |r: &&Row| Some(Point { at: (layout.at)(r)?, is_unsafe: r.is_unsafe() });
            let points: Vec<Point> = of_method.iter().filter_map(point).collect();
            let name = match of_method.first().filter(|_| points.is_empty()) {
                Some(row) => format!("{method} ({})", row.note),
                None => (*method).to_owned(),
            };
            let is_joined = points.len() > 1;
            (!of_method.is_empty()).then_some(Series { name, slot, points, is_joined })
        });
        let size = own.first().map_or_else(String::new, |r| format!(", {} {}", r.size, r.size_of));
        Panel {
            title: format!("{scene}{size}"),
            names: layout.names.map(str::to_owned),
            series: series.collect(),
            has_front: layout.has_front,
        }
    };
    in_order(rows.iter().map(|r| r.scene.as_str())).into_iter().map(panel).collect()
}

/// Time in milliseconds against over-estimation.
pub fn time_against_over(rows: &[Row], time: &str, over: &str) -> Vec<Panel> {
    let at = |r: &Row| Some([r.seconds? * 1e3, r.over_estimate()?]);
    by_scene(rows, &Layout { names: [time, over], at: &at, has_front: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_joined_and_methods_keep_their_look() {
        let row = |scene: &str, method: &str, seconds: Option<f64>, missed: u64| Row {
            scene: scene.into(),
            method: method.into(),
            seconds,
            reported: Some(3),
            truth: Some(2),
            missed: Some(missed),
            note: "left out".into(),
            ..Row::default()
        };
        let rows = [
            row("a", "rays: 10", Some(0.1), 1),
            row("a", "exact", Some(0.2), 0),
            row("b", "exact", None, 0),
            row("a", "rays: 100", Some(0.3), 0),
        ];
        let panels = time_against_over(&rows, "ms", "over");
        assert_eq!(panels.len(), 2);
        let [rays, exact] = &panels[0].series[..] else { panic!("two methods") };
        assert_eq!((rays.name.as_str(), rays.slot, rays.is_joined, rays.points.len()), ("rays", 0, true, 2));
        assert!(rays.points[0].is_unsafe && !rays.points[1].is_unsafe);
        assert_eq!((exact.slot, exact.is_joined, exact.points[0].at), (1, false, [200.0, 1.5]));
        let [other] = &panels[1].series[..] else { panic!("one method") };
        assert_eq!((other.slot, other.points.len(), other.name.as_str()), (1, 0, "exact (left out)"));
    }
}
