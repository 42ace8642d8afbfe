//! Pictures of charts as SVG: panels with points, both axes logarithmic, the Pareto front marked. The same panels give
//! the same bytes.
//!
//! What is 0 has no logarithm and gets a place of its own below; ranges within a decade still have marks.

use crate::front::pareto_front;
use sightlines::report::chart::{INK, Paint, RULE, Scale, Svg, Words};

/// Width and height of a panel.
const PANEL: [f64; 2] = [620.0, 372.0];
/// Left, top, right and bottom of the frame of its points.
const FRAME: [f64; 4] = [66.0, 58.0, 392.0, 318.0];
/// What stands above all panels.
const HEAD: f64 = 34.0;
/// Height of the place for what is 0, below the others.
const ZERO: f64 = 26.0;
/// Size of words.
const WORDS: f64 = 11.0;
const COLOURS: [&str; 10] =
    ["#1f77b4", "#e06c14", "#2a9245", "#c9364f", "#865cc4", "#966a50", "#d062ac", "#7f8790", "#9c9a1e", "#169ca8"];

/// One point of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Across and up, not negative. What is 0 up has a place of its own.
    pub at: [f64; 2],
    /// Whether it is drawn as a cross, and is on no front: its method hides what is visible.
    pub is_unsafe: bool,
}

/// The points of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Which colour and shape; the same number looks the same in all panels.
    pub slot: usize,
    /// The points, in the order in which they are joined.
    pub points: Vec<Point>,
    /// Whether a line joins them.
    pub is_joined: bool,
}

impl Series {
    /// A line through points by ascending x; those that are not positive are left out.
    pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        let points = points.into_iter().filter(|at| at[1] > 0.0).map(|at| Point { at, is_unsafe: false }).collect();
        Self { name: name.into(), slot: 0, points, is_joined: true }
    }
}

/// One chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// What is to the right, and what is up.
    pub names: [String; 2],
    /// What it shows it of.
    pub series: Vec<Series>,
    /// Whether the Pareto front is marked; then less is better both ways.
    pub has_front: bool,
}

impl Panel {
    /// One of lines, each with a look of its own; its title says what is up, with the unit.
    pub fn of_lines(title: impl Into<String>, x_name: &str, lines: Vec<Series>) -> Self {
        let series = lines.into_iter().enumerate().map(|(slot, line)| Series { slot, ..line }).collect();
        Self { title: title.into(), names: [x_name.to_owned(), String::new()], series, has_front: false }
    }
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

/// Draws panels, two in a row, below a title.
pub fn svg(title: &str, panels: &[Panel]) -> String {
    let [n_columns, n_rows] = [panels.len().clamp(1, 2), panels.len().div_ceil(2).max(1)].map(|n| n as f64);
    let mut svg = Svg::new([n_columns * PANEL[0], n_rows * PANEL[1] + HEAD], title, WORDS).with_dark();
    svg.text([16.0, 25.0], Words::START.sized(17.0), title);
    for (k, panel) in panels.iter().enumerate() {
        one(&mut svg, panel, [(k % 2) as f64 * PANEL[0], (k / 2) as f64 * PANEL[1] + HEAD]);
    }
    svg.end()
}

/// A logarithmic axis.
struct Axis {
    /// None if there is nothing but 0.
    scale: Option<Scale>,
    /// Where it begins, and where what is 0 is put.
    start: f64,
    zero: Option<f64>,
}

impl Axis {
    /// Around values; those that are not above 0 only say whether there is a place for them.
    fn around(values: &[f64], pixels: [f64; 2], zero_at: f64) -> Option<Self> {
        let above = || values.iter().copied().filter(|v| *v > 0.0 && v.is_finite());
        let ends = above().fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(v), h.max(v)]);
        let scale = (ends[0] <= ends[1]).then(|| Scale::around(ends, pixels));
        let zero = values.contains(&0.0).then_some(zero_at);
        (scale.is_some() || zero.is_some()).then_some(Self { scale, start: pixels[0], zero })
    }

    fn place(&self, value: f64) -> f64 {
        match self.scale.filter(|_| value > 0.0) {
            Some(scale) => scale.place(value),
            None => self.zero.unwrap_or(self.start),
        }
    }

    /// Values to be marked, with their names.
    fn marks(&self) -> impl Iterator<Item = (f64, String)> {
        self.scale.iter().flat_map(Scale::marks).map(|v| (v, short(v)))
    }
}

/// A number as a mark's name: without the noise of rounding.
fn short(value: f64) -> String {
    let exponent = value.log10().floor() as i32;
    if (-3..=5).contains(&exponent) {
        let digits = usize::try_from(3 - exponent).unwrap_or(0);
        let text = format!("{value:.digits$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    } else {
        let mantissa = value / 10f64.powi(exponent);
        format!("{}e{exponent}", (mantissa * 1000.0).round() / 1000.0)
    }
}

fn one(svg: &mut Svg, panel: &Panel, at: [f64; 2]) {
    let [x0, y0, x1, y1] = [FRAME[0] + at[0], FRAME[1] + at[1], FRAME[2] + at[0], FRAME[3] + at[1]];
    svg.text([at[0] + 16.0, at[1] + 25.0], Words::START.sized(14.0), &panel.title);
    svg.text([at[0] + 16.0, at[1] + 45.0], Words::START, &panel.names[1]);
    svg.text([0.5 * (x0 + x1), y1 + 39.0], Words::MIDDLE, &panel.names[0]);
    let points = || panel.series.iter().flat_map(|s| &s.points).filter(|p| is_usable(p));
    let values = |k: usize| points().map(|p| p.at[k]).collect::<Vec<f64>>();
    let has_zero = points().any(|p| p.at[1] == 0.0);
    let across = Axis::around(&values(0), [x0, x1], x0);
    let up = Axis::around(&values(1), [if has_zero { y1 - ZERO } else { y1 }, y0], y1 - 0.5 * ZERO);
    let (Some(across), Some(up)) = (across, up) else {
        return svg.centred([0.5 * (x0 + x1), 0.5 * (y0 + y1)], Words::MIDDLE, 12.0, "nothing was measured");
    };
    for (value, name) in across.marks() {
        let x = across.place(value);
        svg.line([x, y0], [x, y1], RULE, 1.0);
        svg.text([x, y1 + 17.0], Words::MIDDLE, &name);
    }
    for (value, name) in up.marks() {
        let y = up.place(value);
        svg.line([x0, y], [x1, y], RULE, 1.0);
        svg.centred([x0 - 7.0, y], Words::END, WORDS, &name);
    }
    if let Some(y) = up.zero {
        svg.line([x0, y1 - ZERO], [x1, y1 - ZERO], INK, 1.0);
        svg.centred([x0 - 7.0, y], Words::END, WORDS, "0");
    }
    svg.polyline(&[[x0, y0], [x0, y1], [x1, y1]], INK, 1.0);
    let place = |p: &Point| [across.place(p.at[0]), up.place(p.at[1])];
    if panel.has_front {
        front(svg, panel, place);
    }
    for series in &panel.series {
        let usable: Vec<&Point> = series.points.iter().filter(|p| is_usable(p)).collect();
        if series.is_joined && usable.len() > 1 {
            let places: Vec<[f64; 2]> = usable.iter().map(|p| place(p)).collect();
            svg.polyline(&places, COLOURS[series.slot % COLOURS.len()], 2.0);
        }
        usable.into_iter().for_each(|p| mark(svg, series.slot, place(p), p.is_unsafe));
    }
    legend(svg, panel, [x1 + 16.0, y0 + 2.0]);
}

fn is_usable(point: &Point) -> bool {
    point.at.iter().all(|v| v.is_finite()) && point.at[0] > 0.0 && point.at[1] >= 0.0
}

/// A staircase below which nothing is, and a ring around each of its points.
fn front(svg: &mut Svg, panel: &Panel, place: impl Fn(&Point) -> [f64; 2]) {
    let safe: Vec<&Point> =
        panel.series.iter().flat_map(|s| &s.points).filter(|p| is_usable(p) && !p.is_unsafe).collect();
    let places: Vec<[f64; 2]> = safe.iter().map(|p| p.at).collect();
    let mut stairs: Vec<[f64; 2]> = Vec::new();
    for i in pareto_front(&places) {
        let [x, y] = place(safe[i]);
        svg.circle([x, y], 9.0, Paint::stroke(INK, 1.0));
        stairs.extend(stairs.last().map(|last| [x, last[1]]));
        stairs.push([x, y]);
    }
    if stairs.len() > 1 {
        svg.polyline(&stairs, INK, 1.0);
    }
}

/// A point: its shape and colour say whose it is; a cross is an unsafe one.
fn mark(svg: &mut Svg, slot: usize, [x, y]: [f64; 2], is_unsafe: bool) {
    let colour = COLOURS[slot % COLOURS.len()];
    if is_unsafe {
        return [-5.0, 5.0].iter().for_each(|s| svg.line([x - 5.0, y - s], [x + 5.0, y + s], colour, 2.0));
    }
    let mut shape = |corners: &[[f64; 2]]| {
        let corners: Vec<[f64; 2]> = corners.iter().map(|c| [x + c[0], y + c[1]]).collect();
        svg.polygon(&corners, Paint::fill(colour));
    };
    match slot % 4 {
        0 => svg.circle([x, y], 5.0, Paint::fill(colour)),
        1 => shape(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]),
        2 => shape(&[[0.0, -6.0], [6.0, 4.0], [-6.0, 4.0]]),
        _ => shape(&[[0.0, -6.0], [6.0, 0.0], [0.0, 6.0], [-6.0, 0.0]]),
    }
}

fn legend(svg: &mut Svg, panel: &Panel, [x, mut y]: [f64; 2]) {
    // Many names stand closer together.
    let step = (FRAME[3] - FRAME[1] + 40.0) / (panel.series.len() + 3).max(14) as f64;
    let name = |svg: &mut Svg, y: f64, what: &str| svg.centred([x + 13.0, y + 6.0], Words::START, WORDS, what);
    for series in &panel.series {
        let all_unsafe = !series.points.is_empty() && series.points.iter().all(|p| p.is_unsafe);
        mark(svg, series.slot, [x, y + 6.0], all_unsafe);
        name(svg, y, &series.name);
        y += step;
    }
    y += 5.0;
    if panel.has_front && !panel.series.is_empty() {
        svg.circle([x, y + 6.0], 7.0, Paint::stroke(INK, 1.0));
        name(svg, y, "on the Pareto front");
        y += step;
    }
    if panel.series.iter().flat_map(|s| &s.points).any(|p| p.is_unsafe) {
        svg.centred([x, y + 6.0], Words::MIDDLE, 13.0, "\u{d7}");
        name(svg, y, "hides what is visible");
    }
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
    fn lines_are_drawn_and_repeat() {
        let series = |name: &str, points: &[[f64; 2]]| Series::line(name, points.to_vec());
        let lines = vec![
            series("one", &[[1.0, 0.5], [2.0, 1.0], [4.0, 2.0]]),
            series("two", &[[1.0, 0.0], [4.0, f64::NAN], [4.0, 20.0]]),
        ];
        let panels = [Panel::of_lines("a < b", "floors", lines), Panel::of_lines("none", "", vec![])];
        let drawn = svg("t", &panels);
        assert_eq!(drawn, svg("t", &panels));
        // Circles and squares, with one of each in the legend.
        assert_eq!((drawn.matches("<circle").count(), drawn.matches("<polygon").count()), (4, 2));
        assert!(drawn.contains("a &lt; b") && drawn.contains(">1</text>") && drawn.contains(">10</text>"));
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    }

    fn panel() -> Panel {
        let point = |x: f64, y: f64| Point { at: [x, y], is_unsafe: false };
        let series = |name: &str, slot: usize, points: Vec<Point>| Series {
            name: name.to_owned(),
            slot,
            points,
            is_joined: slot == 0,
        };
        let bad = Point { is_unsafe: true, ..point(0.0001, 0.5) };
        Panel {
            title: "a < b".into(),
            names: ["time".into(), "too much".into()],
            series: vec![
                series("one", 0, vec![point(0.1, 3.0), point(0.01, 4.0)]),
                series("two", 1, vec![point(1.0, 1.0), bad]),
                series("none", 2, vec![point(f64::NAN, 1.0), point(1.0, f64::INFINITY), point(0.0, 1.0)]),
            ],
            has_front: true,
        }
    }

    #[test]
    fn the_same_panels_give_the_same_bytes() {
        let text = svg("title", &[panel(), panel(), panel()]);
        assert_eq!(text, svg("title", &[panel(), panel(), panel()]));
        assert_ne!(text, svg("title", &[panel(), panel()]));
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>") && text.contains("a &lt; b"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn fronts_leave_out_what_is_unsafe() {
        let rings = |panel: &Panel| svg("t", std::slice::from_ref(panel)).matches("r=\"9\"").count();
        assert_eq!(rings(&panel()), 3);
        // Were it safe, it would dominate all others.
        let mut spoilt = panel();
        spoilt.series[1].points[1].is_unsafe = false;
        assert_eq!(rings(&spoilt), 1);
        assert_eq!(rings(&Panel { has_front: false, ..panel() }), 0);
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        let empty = Panel { series: vec![], ..panel() };
        assert!(svg("t", &[empty]).contains("nothing was measured"));
        assert!(svg("t", &[]).ends_with("</svg>\n"));
    }

    #[test]
    fn axes_have_a_place_for_nothing() {
        assert!(Axis::around(&[], [0.0, 1.0], 0.0).is_none());
        let axis = Axis::around(&[0.0], [0.0, 1.0], 7.0).unwrap();
        assert_eq!((axis.place(0.0), axis.marks().count()), (7.0, 0));
        let axis = Axis::around(&[0.0, 0.001], [10.0, 300.0], 305.0).unwrap();
        assert!(axis.place(0.0) == 305.0 && (10.0..=300.0).contains(&axis.place(0.001)) && axis.marks().count() > 0);
        assert_eq!([0.1, 1.0, 1.05, 200.0, 1e-7, 3e6].map(short), ["0.1", "1", "1.05", "200", "1e-7", "3e6"]);
    }
}
