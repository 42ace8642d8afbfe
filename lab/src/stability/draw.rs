//! A sweep as a picture: the rate of each kind of failure against the parameter, a curve for each method.
//!
//! Made of the rows alone. Text names a generic family and is placed without looking at any font, so that the same
//! rows make the same bytes on every machine.

use super::method::Kind;
use super::table::{Row, number};
use sightlines::report::chart::{INK, Paint, RULE, Scale, Svg, Words, power_of_ten};

const WIDTH: f64 = 980.0;
const PANEL: f64 = 230.0;
const TOP: f64 = 40.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 690.0;
const GAP: f64 = 46.0;
/// Where the first and the last level are.
const ENDS: [f64; 2] = [LEFT + 14.0, RIGHT - 14.0];
/// Pixels of a panel below which zero is drawn.
const ZERO: f64 = 30.0;
/// Size of most words.
const WORDS: f64 = 10.0;

/// A kind of failure: its title, and its count in a row with the number of cases that could fail so.
type Panel = (&'static str, fn(&Row) -> (u64, u64));

const PANELS: [Panel; 3] = [
    ("unsafe: share of open cases that are hidden", |r| (r.n_unsafe, r.open)),
    ("loose: share of hidden cases that are shown", |r| (r.loose, r.cases - r.open)),
    ("errors: share of cases without an answer", |r| (r.errors, r.cases)),
];

/// The picture of one sweep as SVG; none of no rows. `rows`: all rows of one file.
pub fn svg(title: &str, parameter: &str, rows: &[Row]) -> Option<String> {
    let axes = Axes::of(rows)?;
    let panels: Vec<Panel> = PANELS
        .into_iter()
        .filter(|(title, count)| !title.starts_with("errors") || rows.iter().any(|r| count(r).0 > 0))
        .collect();
    let curves = curves(rows);
    let legend = 24.0 + 17.0 * curves.len() as f64;
    let height = (TOP + panels.len() as f64 * (PANEL + GAP) + 14.0).max(TOP + legend);
    let mut svg = Svg::new([WIDTH, height], title, WORDS);
    svg.centred([LEFT, 18.0], Words::START, 14.0, title);
    for (k, panel) in panels.iter().enumerate() {
        let top = TOP + 14.0 + k as f64 * (PANEL + GAP);
        let last = k + 1 == panels.len();
        draw_panel(&mut svg, panel, top, &axes, &curves, last.then_some(parameter));
    }
    draw_legend(&mut svg, &curves);
    Some(svg.end())
}

/// The rows of a method, in the order of levels.
struct Curve<'a> {
    method: &'a str,
    kind: Kind,
    rows: Vec<&'a Row>,
    colour: &'static str,
    /// Which mark its points have.
    mark: usize,
}

impl Curve<'_> {
    /// Of its line.
    fn width(&self) -> f64 {
        if self.kind == Kind::Shipped { 3.0 } else { 1.0 }
    }
}

/// In the order of kinds, then of the file.
fn curves(rows: &[Row]) -> Vec<Curve<'_>> {
    let mut curves: Vec<Curve<'_>> = Vec::new();
    for kind in Kind::ALL {
        let of_kind = rows.iter().filter(|r| r.kind == kind);
        let mut n_kind = 0;
        for row in of_kind {
            if let Some(curve) = curves.iter_mut().find(|c| c.method == row.method) {
                curve.rows.push(row);
                continue;
            }
            let colour = colour(kind, n_kind);
            curves.push(Curve { method: &row.method, kind, rows: vec![row], colour, mark: n_kind % 4 });
            n_kind += 1;
        }
    }
    curves
}

/// Shipped methods are green, references grey, solvers blue, naive ones red and brown.
fn colour(kind: Kind, k: usize) -> &'static str {
    let of: &[&str] = match kind {
        Kind::Shipped => &["#00823c", "#3cb44b", "#005a46", "#78a000"],
        Kind::Reference => &["#5a5a5a", "#969696"],
        Kind::Solver => &["#0046c8", "#0096dc", "#5a3cc8", "#4682b4", "#003c6e", "#8282ff"],
        Kind::Naive => &["#d7191e", "#f07800", "#96006e", "#8c5014", "#e63c96", "#6e0000"],
    };
    of[k % of.len()]
}

/// Where levels and rates are drawn.
struct Axes {
    levels: Vec<f64>,
    /// By their logarithms, if all are positive and far apart. Else one level is drawn beside the other, evenly.
    scale: Option<Scale>,
    /// Decades of rates below 1.
    decades: i32,
}

impl Axes {
    /// None of no rows.
    fn of(rows: &[Row]) -> Option<Self> {
        let mut levels: Vec<f64> = rows.iter().map(|r| r.parameter).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let [first, last] = [*levels.first()?, *levels.last()?];
        let is_wide = first > 0.0 && last >= 10.0 * first;
        let most = rows.iter().map(|r| r.cases).max().unwrap_or(1).max(1);
        let decades = (1..=9).find(|&d| 10u64.pow(d) >= most).unwrap_or(9) as i32;
        Some(Self { levels, scale: is_wide.then(|| Scale::new([first, last], ENDS)), decades })
    }

    fn x(&self, level: f64) -> f64 {
        if let Some(scale) = &self.scale {
            return scale.place(level);
        }
        let last = self.levels.len() - 1;
        let place = self.levels.iter().position(|&l| l == level).unwrap_or(0);
        let share = if last == 0 { 0.5 } else { place as f64 / last as f64 };
        ENDS[0] + share * (ENDS[1] - ENDS[0])
    }

    /// Pixels above the bottom of a panel.
    fn y(&self, (n, of): (u64, u64)) -> f64 {
        if n == 0 || of == 0 {
            return 0.5 * ZERO;
        }
        Scale::new([power_of_ten(-self.decades), 1.0], [ZERO, PANEL - 6.0]).place(n as f64 / of as f64)
    }
}

/// A level for people: a few digits.
fn short(level: f64) -> String {
    let exact = number(level);
    if exact.len() <= 6 { exact } else { format!("{level:.1e}") }
}

fn draw_panel(
    svg: &mut Svg,
    (title, count): &Panel,
    top: f64,
    axes: &Axes,
    curves: &[Curve<'_>],
    parameter: Option<&str>,
) {
    let bottom = top + PANEL;
    svg.centred([LEFT, top - 10.0], Words::START, 11.0, title);
    for decade in 0..=axes.decades {
        let y = bottom - axes.y((1, 10u64.pow(decade as u32)));
        svg.line([LEFT, y], [RIGHT, y], RULE, 1.0);
        let name = if decade == 0 { "1".to_owned() } else { format!("1e-{decade}") };
        svg.centred([LEFT - 8.0, y], Words::END, WORDS, &name);
    }
    svg.centred([LEFT - 8.0, bottom - axes.y((0, 1))], Words::END, WORDS, "none");
    let mut next_free = f64::MIN;
    for &level in &axes.levels {
        let x = axes.x(level);
        svg.line([x, bottom], [x, bottom + 4.0], INK, 1.0);
        if x >= next_free {
            let name = short(level);
            svg.centred([x, bottom + 12.0], Words::MIDDLE, WORDS, &name);
            next_free = x + 8.0 * name.len() as f64 + 6.0;
        }
    }
    if let Some(parameter) = parameter {
        svg.centred([0.5 * (LEFT + RIGHT), bottom + 30.0], Words::MIDDLE, 11.0, parameter);
    }
    // Shipped methods last, so that they lie on top.
    for curve in curves.iter().rev() {
        let rows = curve.rows.iter().filter(|row| count(row).1 > 0);
        let points: Vec<[f64; 2]> = rows.map(|row| [axes.x(row.parameter), bottom - axes.y(count(row))]).collect();
        if points.len() > 1 {
            svg.polyline(&points, curve.colour, curve.width());
        }
        points.iter().filter(|p| p[1] < bottom - 0.5 * ZERO).for_each(|&at| mark(svg, at, curve));
    }
    svg.rect([LEFT, top], [RIGHT - LEFT, PANEL], Paint::stroke(INK, 1.0));
}

/// The mark of a curve: a disc, a square, a ring or a triangle.
fn mark(svg: &mut Svg, [x, y]: [f64; 2], curve: &Curve<'_>) {
    let filled = Paint::fill(curve.colour);
    match curve.mark {
        0 => svg.circle([x, y], 3.0, filled),
        1 => svg.rect([x - 3.0, y - 3.0], [6.0, 6.0], filled),
        2 => svg.circle([x, y], 4.0, Paint::stroke(curve.colour, 1.0)),
        _ => svg.polygon(&[[x - 4.0, y + 3.0], [x + 4.0, y + 3.0], [x, y - 4.0]], filled),
    }
}

fn draw_legend(svg: &mut Svg, curves: &[Curve<'_>]) {
    let x = RIGHT + 16.0;
    svg.centred([x, TOP + 4.0], Words::START, WORDS, "method (unsafe / loose / errors)");
    for (k, curve) in curves.iter().enumerate() {
        let y = TOP + 22.0 + 17.0 * k as f64;
        svg.line([x, y], [x + 22.0, y], curve.colour, curve.width());
        mark(svg, [x + 11.0, y], curve);
        let sum = |count: fn(&Row) -> u64| curve.rows.iter().map(|r| count(r)).sum::<u64>();
        let [n_unsafe, loose, errors] = [sum(|r| r.n_unsafe), sum(|r| r.loose), sum(|r| r.errors)];
        let name = format!("{} ({n_unsafe} / {loose} / {errors})", curve.method);
        svg.centred([x + 28.0, y], Words::START.coloured(curve.colour), WORDS, &name);
    }
}
