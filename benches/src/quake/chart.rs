//! Time against over-estimation, a panel for each map: the same numbers give the same bytes.

use super::job::{ClusterMethod, METHODS};
use super::rows::{Row, known, maps, of_map};
use sightlines::report::chart::{PAPER, Paint, RULE, Scale, Svg, Words, power_of_ten};

/// Panels in a row, and their size.
const ACROSS: usize = 4;
const PANEL: [f64; 2] = [250.0, 200.0];
/// Left, top, right and bottom of the axes in a panel.
const FRAME: [f64; 4] = [14.0, 26.0, 240.0, 176.0];
/// Left of the first panels, above and below all of them.
const MARGIN: [f64; 3] = [42.0, 66.0, 34.0];
/// Where the axis of over-estimation, linear about zero, becomes logarithmic.
const BEND: f64 = 0.0002;
/// Marks of that axis, as shares of the known pairs.
const SHARES: [(f64, &str); 6] =
    [(-0.05, "−5%"), (0.0, "0"), (0.001, "0.1%"), (0.01, "1%"), (0.1, "10%"), (1.0, "100%")];
/// The ends of that axis.
const ENDS: [f64; 2] = [-0.7, 8.0];

fn colour(method: ClusterMethod) -> &'static str {
    match method {
        ClusterMethod::Base => "#7b8794",
        ClusterMethod::Sampling => "#3a9150",
        ClusterMethod::Separators => "#e07a1f",
        ClusterMethod::Symmetric => "#8a5cd6",
        ClusterMethod::Exact => "#1f6fb4",
    }
}

/// A mark; hollow for what was stopped before its end.
fn mark(svg: &mut Svg, method: ClusterMethod, [x, y]: [f64; 2], is_done: bool) {
    let colour = colour(method);
    let paint = Paint { fill: Some(if is_done { colour } else { PAPER }), stroke: Some((colour, 1.5)) };
    let mut polygon = |corners: &[[f64; 2]]| {
        let corners: Vec<[f64; 2]> = corners.iter().map(|[a, b]| [x + a, y + b]).collect();
        svg.polygon(&corners, paint);
    };
    match method {
        ClusterMethod::Base => polygon(&[[-5.0, 4.0], [5.0, 4.0], [0.0, -5.0]]),
        ClusterMethod::Sampling => polygon(&[[-5.0, -4.0], [5.0, -4.0], [0.0, 5.0]]),
        ClusterMethod::Separators => polygon(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]),
        ClusterMethod::Symmetric => polygon(&[[-5.5, 0.0], [0.0, -5.5], [5.5, 0.0], [0.0, 5.5]]),
        ClusterMethod::Exact => svg.circle([x, y], 4.5, paint),
    }
    if !is_done {
        let tip = [x, y - 17.0];
        svg.line([x, y - 5.0], tip, colour, 1.5);
        svg.polyline(&[[x - 3.0, y - 13.0], tip, [x + 3.0, y - 13.0]], colour, 1.5);
    }
}

/// Where a surplus is on its axis. What is missing has less room: it is there or it is not.
fn bent(share: f64) -> f64 {
    (share / BEND).asinh() * if share < 0.0 { 0.35 } else { 1.0 }
}

/// The chart of all maps of which it is known what is visible.
pub fn svg(rows: &[Row]) -> String {
    let maps: Vec<&str> = maps(rows).into_iter().filter(|map| known(&of_map(rows, map)).is_some()).collect();
    let n_down = maps.len().div_ceil(ACROSS);
    let width = MARGIN[0] + PANEL[0] * ACROSS.min(maps.len().max(2)) as f64;
    let height = MARGIN[1] + PANEL[1] * n_down as f64 + MARGIN[2];
    let mut svg = Svg::new([width, height], "Quake maps: time against over-estimation", 11.0);
    let above =
        "Processor time on one thread, seconds, against reported pairs beyond those that are proven to be visible";
    svg.text([MARGIN[0] + FRAME[0], 20.0], Words::START, above);
    for (k, method) in METHODS.into_iter().enumerate() {
        let at = [MARGIN[0] + FRAME[0] + 6.0 + (if maps.len() < 3 { 100.0 } else { 170.0 }) * k as f64, 42.0];
        mark(&mut svg, method, at, true);
        svg.text([at[0] + 11.0, at[1] + 4.0], Words::START, method.title());
    }
    let times = || rows.iter().map(|row| row.measured.cpu).filter(|s| s.is_finite() && *s > 0.0);
    let low = times().fold(1.0, f64::min);
    let high = times().fold(low, f64::max);
    for (k, map) in maps.iter().enumerate() {
        let at = [MARGIN[0] + PANEL[0] * (k % ACROSS) as f64, MARGIN[1] + PANEL[1] * (k / ACROSS) as f64];
        let named = Named { is_left: k % ACROSS == 0, is_lowest: k + ACROSS >= maps.len() };
        panel(&mut svg, at, (map, &of_map(rows, map)), [low, high], named);
    }
    let below = "shaded: fewer pairs than are proven · −n: n proven pairs are missing · hollow, with an arrow: stopped at its time limit";
    svg.text([MARGIN[0] + FRAME[0], height - 8.0], Words::START, below);
    svg.end()
}

/// Which axes of a panel have their numbers written.
struct Named {
    is_left: bool,
    is_lowest: bool,
}

fn panel(svg: &mut Svg, at: [f64; 2], (map, rows): (&str, &[&Row]), times: [f64; 2], named: Named) {
    let [x0, y0, x1, y1] = [at[0] + FRAME[0], at[1] + FRAME[1], at[0] + FRAME[2], at[1] + FRAME[3]];
    let [left, right] = ENDS.map(bent);
    let across = |share: f64| x0 + (bent(share.clamp(ENDS[0], ENDS[1])) - left) / (right - left) * (x1 - x0);
    let up = Scale::decades(times, [y1, y0]);
    svg.rect([x0, y0], [across(0.0) - x0, y1 - y0], Paint::fill("#f6e7e4"));
    svg.text([x0, y0 - 8.0], Words::START, &heading(map, rows));
    for (share, label) in SHARES {
        let x = across(share);
        svg.line([x, y0], [x, y1], RULE, 1.0);
        if named.is_lowest {
            svg.text([x, y1 + 14.0], Words::MIDDLE, label);
        }
    }
    for seconds in up.powers().map(power_of_ten) {
        let y = up.place(seconds);
        svg.line([x0, y], [x1, y], RULE, 1.0);
        if named.is_left {
            svg.text([x0 - 6.0, y + 4.0], Words::END, &seconds.to_string());
        }
    }
    let known = known(rows).unwrap_or(1).max(1) as f64;
    for row in rows.iter().filter(|row| row.measured.cpu.is_finite() && row.measured.cpu > 0.0) {
        let at = [across(row.pairs as f64 / known - 1.0), up.place(row.measured.cpu)];
        mark(svg, row.method, at, row.measured.done == 1.0);
        // A surplus elsewhere may make up for what is missing. Sampling misses most by design.
        let missing = row.proven.map_or(0, |[_, missing]| missing);
        if missing > 0 && row.method != ClusterMethod::Sampling {
            let (words, aside) =
                if row.method == ClusterMethod::Symmetric { (Words::END, -8.0) } else { (Words::START, 7.0) };
            let words = words.sized(9.0).coloured(colour(row.method));
            svg.text([at[0] + aside, at[1] + 3.0], words, &format!("−{missing}"));
        }
    }
}

/// What is written above a panel.
fn heading(map: &str, rows: &[&Row]) -> String {
    let portals = rows.first().map_or(0, |row| row.portals);
    let sampled = if rows.iter().all(|row| row.proven.is_none()) { "; beyond those witnessed" } else { "" };
    format!("{map}, {portals} portals{sampled}")
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::example;
    use super::*;

    #[test]
    fn every_method_of_every_map_is_drawn() {
        let maps = ["a", "b < c", "d", "e", "f"];
        let mut rows: Vec<Row> = maps.iter().flat_map(|map| METHODS.map(|m| example(map, m, 44))).collect();
        rows[2].measured.done = 0.5;
        rows[3].measured.cpu = f64::NAN;
        rows[7].proven = Some([40, 3]);
        let drawn = svg(&rows);
        assert_eq!(drawn, svg(&rows));
        // One of each in the legend.
        assert_eq!(drawn.matches("<circle").count(), 1 + maps.len());
        assert_eq!(drawn.matches("<polygon").count(), 4 + 4 * maps.len() - 1);
        assert_eq!(drawn.matches("<polyline").count(), 1, "what was stopped has an arrow");
        assert_eq!(drawn.matches(">−3</text>").count(), 1);
        assert!(
            drawn.contains("b &lt; c, 12 portals<")
                && drawn.contains("a, 12 portals;")
                && !drawn.contains("NaN")
                && !drawn.contains("inf")
        );
        // Nothing is known of what is visible.
        rows.iter_mut().for_each(|row| (row.witnessed, row.proven) = (None, None));
        assert!(!svg(&rows).contains(" portals"));
    }
}
