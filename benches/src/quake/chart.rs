//! Time against over-estimation, a panel for each map: the same numbers give the same bytes.

use super::job::{METHODS, Method};
use super::rows::{Row, known, maps, of_map};
use crate::chart::{rule, text};
use std::fmt::Write;

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

fn colour(method: Method) -> &'static str {
    match method {
        Method::Base => "#7b8794",
        Method::Sampling => "#3a9150",
        Method::Separators => "#e07a1f",
        Method::Symmetric => "#8a5cd6",
        Method::Exact => "#1f6fb4",
    }
}

/// A mark; hollow for what was stopped before its end.
fn mark(out: &mut String, method: Method, [x, y]: [f64; 2], is_done: bool) {
    let colour = colour(method);
    let fill = if is_done { colour } else { "#ffffff" };
    let style = format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"");
    let polygon = |points: &[[f64; 2]]| {
        let points: Vec<String> = points.iter().map(|[a, b]| format!("{:.2},{:.2}", x + a, y + b)).collect();
        format!("<polygon points=\"{}\" {style}/>\n", points.join(" "))
    };
    *out += &match method {
        Method::Base => polygon(&[[-5.0, 4.0], [5.0, 4.0], [0.0, -5.0]]),
        Method::Sampling => polygon(&[[-5.0, -4.0], [5.0, -4.0], [0.0, 5.0]]),
        Method::Separators => polygon(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]),
        Method::Symmetric => polygon(&[[-5.5, 0.0], [0.0, -5.5], [5.5, 0.0], [0.0, 5.5]]),
        Method::Exact => format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"4.5\" {style}/>\n"),
    };
    if !is_done {
        let _ = writeln!(
            out,
            "<path d=\"M{x:.2} {:.2}v-12m-3 4l3 -4l3 4\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
            y - 5.0
        );
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
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#1c2733\">\n\
         <title>Quake maps: time against over-estimation</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    text(
        &mut out,
        [MARGIN[0] + FRAME[0], 20.0],
        "start",
        "Processor time on one thread, seconds, against reported pairs beyond those that are proven to be visible",
    );
    for (k, method) in METHODS.into_iter().enumerate() {
        let at = [MARGIN[0] + FRAME[0] + 6.0 + (if maps.len() < 3 { 100.0 } else { 170.0 }) * k as f64, 42.0];
        mark(&mut out, method, at, true);
        text(&mut out, [at[0] + 11.0, at[1] + 4.0], "start", method.title());
    }
    let times = || rows.iter().map(|row| row.measured.cpu).filter(|s| s.is_finite() && *s > 0.0);
    let low = times().fold(1.0, f64::min).log10().floor();
    let high = times().fold(10f64.powf(low), f64::max).log10().ceil().max(low + 1.0);
    for (k, map) in maps.iter().enumerate() {
        let at = [MARGIN[0] + PANEL[0] * (k % ACROSS) as f64, MARGIN[1] + PANEL[1] * (k / ACROSS) as f64];
        let _ = writeln!(out, "<g transform=\"translate({},{})\">", at[0], at[1]);
        let named = Named { is_left: k % ACROSS == 0, is_lowest: k + ACROSS >= maps.len() };
        panel(&mut out, map, &of_map(rows, map), [low, high], named);
        out.push_str("</g>\n");
    }
    text(
        &mut out,
        [MARGIN[0] + FRAME[0], height - 8.0],
        "start",
        "shaded: fewer pairs than are proven · −n: n proven pairs are missing · hollow, with an arrow: stopped at its time limit",
    );
    out.push_str("</svg>\n");
    out
}

/// Which axes of a panel have their numbers written.
struct Named {
    is_left: bool,
    is_lowest: bool,
}

fn panel(out: &mut String, map: &str, rows: &[&Row], [low, high]: [f64; 2], named: Named) {
    let [x0, y0, x1, y1] = FRAME;
    let [left, right] = ENDS.map(bent);
    let across = |share: f64| x0 + (bent(share.clamp(ENDS[0], ENDS[1])) - left) / (right - left) * (x1 - x0);
    let up = |seconds: f64| y1 - (seconds.log10().clamp(low, high) - low) / (high - low) * (y1 - y0);
    let zero = across(0.0);
    let _ = writeln!(
        out,
        "<rect x=\"{x0:.2}\" y=\"{y0:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"#f6e7e4\"/>",
        zero - x0,
        y1 - y0
    );
    text(out, [x0, y0 - 8.0], "start", &heading(map, rows));
    for (share, label) in SHARES {
        let x = across(share);
        rule(out, [x, y0], [x, y1]);
        if named.is_lowest {
            text(out, [x, y1 + 14.0], "middle", label);
        }
    }
    for power in low as i32..=high as i32 {
        let y = up(10f64.powi(power));
        rule(out, [x0, y], [x1, y]);
        if named.is_left {
            let label = if power < 0 {
                format!("{:.*}", -power as usize, 10f64.powi(power))
            } else {
                format!("{}", 10f64.powi(power))
            };
            text(out, [x0 - 6.0, y + 4.0], "end", &label);
        }
    }
    let known = known(rows).unwrap_or(1).max(1) as f64;
    for row in rows.iter().filter(|row| row.measured.cpu.is_finite() && row.measured.cpu > 0.0) {
        let at = [across(row.pairs as f64 / known - 1.0), up(row.measured.cpu)];
        mark(out, row.method, at, row.measured.done == 1.0);
        // A surplus elsewhere may make up for what is missing. Sampling misses most by design.
        let missing = row.proven.map_or(0, |[_, missing]| missing);
        if missing > 0 && row.method != Method::Sampling {
            let (anchor, aside) = if row.method == Method::Symmetric { ("end", -8.0) } else { ("start", 7.0) };
            let _ = writeln!(
                out,
                "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\" font-size=\"9\" fill=\"{}\">−{missing}</text>",
                at[0] + aside,
                at[1] + 3.0,
                colour(row.method)
            );
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
        assert_eq!(drawn.matches("<path").count(), 1, "what was stopped has an arrow");
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
