//! Line charts as SVG, side by side: the same numbers give the same bytes.

use std::fmt::Write;

const PANEL: [f64; 2] = [360.0, 300.0];
/// Left, top, right and bottom of the lines in a panel.
const FRAME: [f64; 4] = [62.0, 40.0, 340.0, 250.0];
const COLOURS: [&str; 6] = ["#1f6fb4", "#e07a1f", "#3a9150", "#8a5cd6", "#c2385a", "#6b7480"];

/// A line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Positive coordinates, by ascending x.
    pub points: Vec<[f64; 2]>,
}

/// One chart: both axes are logarithmic, x doubles from mark to mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it shows, with the unit.
    pub title: String,
    /// What is to the right.
    pub x_name: String,
    /// Its lines, at most six.
    pub series: Vec<Series>,
}

/// The exponent `b` for which `y = a * x^b` fits best, by least squares of logarithms; none for fewer than
/// two different x.
pub fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let n = logs.len() as f64;
    let [x, y] = [0, 1].map(|k| logs.iter().map(|p| p[k]).sum::<f64>() / n);
    let across: f64 = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let along: f64 = logs.iter().map(|p| (p[0] - x).powi(2)).sum();
    (along > 0.0).then(|| across / along)
}

/// Draws panels side by side. Lines and points that are not positive and finite are left out.
pub fn svg(title: &str, panels: &[Panel]) -> String {
    let [width, height] = [PANEL[0] * panels.len() as f64, PANEL[1]];
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\" fill=\"#1c2733\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        escaped(title)
    );
    for (k, panel) in panels.iter().enumerate() {
        let _ = writeln!(out, "<g transform=\"translate({},0)\">", k as f64 * PANEL[0]);
        draw(&mut out, panel);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

fn draw(out: &mut String, panel: &Panel) {
    let usable = |p: &&[f64; 2]| p.iter().all(|x| x.is_finite() && *x > 0.0);
    let points = || panel.series.iter().flat_map(|s| &s.points).filter(usable);
    let [x0, y0, x1, y1] = FRAME;
    text(out, [x0, 20.0], "start", &panel.title);
    text(out, [(x0 + x1) / 2.0, y1 + 34.0], "middle", &panel.x_name);
    let range = |k: usize| points().fold([f64::MAX, 0.0f64], |[l, h], p| [l.min(p[k]), h.max(p[k])]);
    let (xs, ys) = (range(0), range(1));
    if points().next().is_none() {
        return;
    }
    let [left, right] = [xs[0].log2().floor(), xs[1].log2().ceil().max(xs[0].log2().floor() + 1.0)];
    let [low, high] = [ys[0].log10().floor(), ys[1].log10().ceil().max(ys[0].log10().floor() + 1.0)];
    let place = |p: &[f64; 2]| {
        let across = (p[0].log2() - left) / (right - left);
        let up = (p[1].log10() - low) / (high - low);
        [x0 + across * (x1 - x0), y1 - up * (y1 - y0)]
    };
    // Wide ranges have names at some marks only, so that names do not run into each other.
    let every = if right - left > 8.0 { 4 } else { 1 };
    for k in 0..=(right - left) as i32 {
        let value = 2f64.powi(left as i32 + k);
        let [x, _] = place(&[value, ys[0]]);
        rule(out, [x, y0], [x, y1]);
        if k % every == 0 {
            text(out, [x, y1 + 16.0], "middle", &value.to_string());
        }
    }
    for k in 0..=(high - low) as i32 {
        let power = low as i32 + k;
        let [_, y] = place(&[xs[0], 10f64.powi(power)]);
        rule(out, [x0, y], [x1, y]);
        let label =
            if (-4..=5).contains(&power) { format!("{}", Short(10f64.powi(power))) } else { format!("1e{power}") };
        text(out, [x0 - 6.0, y + 4.0], "end", &label);
    }
    for (k, series) in panel.series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let placed: Vec<[f64; 2]> = series.points.iter().filter(usable).map(place).collect();
        let path: Vec<String> = placed.iter().map(|[x, y]| format!("{:.2},{:.2}", x, y)).collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
            path.join(" ")
        );
        for [x, y] in &placed {
            let _ = writeln!(out, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"3\" fill=\"{colour}\"/>");
        }
        let y = y0 + 14.0 + 15.0 * k as f64;
        let _ =
            writeln!(out, "<rect x=\"{}\" y=\"{}\" width=\"10\" height=\"10\" fill=\"{colour}\"/>", x0 + 8.0, y - 9.0);
        text(out, [x0 + 23.0, y], "start", &series.name);
    }
}

/// A power of ten without the noise of rounding.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 >= 1.0 { write!(f, "{:.0}", self.0) } else { write!(f, "{}", (self.0 * 1e4).round() / 1e4) }
    }
}

pub(crate) fn rule(out: &mut String, a: [f64; 2], b: [f64; 2]) {
    let _ = writeln!(
        out,
        "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"#d5dae0\"/>",
        a[0], a[1], b[0], b[1]
    );
}

pub(crate) fn text(out: &mut String, at: [f64; 2], anchor: &str, what: &str) {
    let _ =
        writeln!(out, "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\">{}</text>", at[0], at[1], escaped(what));
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_found() {
        let power = |b: f64| exponent(&[1.0, 2.0, 8.0, 64.0].map(|x: f64| [x, 3.0 * x.powf(b)]));
        assert!((power(1.5).unwrap() - 1.5).abs() < 1e-12 && power(0.0).unwrap().abs() < 1e-12);
        assert_eq!((exponent(&[]), exponent(&[[2.0, 1.0]])), (None, None));
    }

    #[test]
    fn charts_are_drawn_and_repeat() {
        let series = |name: &str, points: &[[f64; 2]]| Series { name: name.into(), points: points.to_vec() };
        let panel = Panel {
            title: "a < b".into(),
            x_name: "floors".into(),
            series: vec![
                series("one", &[[1.0, 0.5], [2.0, 1.0], [4.0, 2.0]]),
                series("two", &[[1.0, 0.0], [4.0, f64::NAN], [4.0, 20.0]]),
            ],
        };
        let empty = Panel { title: "none".into(), x_name: String::new(), series: vec![] };
        let drawn = svg("t", &[panel.clone(), empty.clone()]);
        assert_eq!(drawn, svg("t", &[panel, empty]));
        assert_eq!(drawn.matches("<circle").count(), 4);
        assert!(drawn.contains("a &lt; b") && drawn.contains(">0.1</text>") && drawn.contains(">100</text>"));
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    }
}
