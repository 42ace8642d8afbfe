//! A sweep as a picture: the rate of each kind of failure against the parameter, a curve for each method.
//!
//! Made of the rows alone. Text names a generic family and is placed without looking at any font, so that the same
//! rows make the same bytes on every machine.

use super::method::Kind;
use super::table::{Row, number};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const WIDTH: i32 = 980;
const PANEL: i32 = 230;
const TOP: i32 = 40;
const LEFT: i32 = 70;
const RIGHT: i32 = 690;
const GAP: i32 = 46;
/// Pixels of a panel below which zero is drawn.
const ZERO: i32 = 30;

/// What a picture could not be drawn for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// There is nothing to draw.
    #[error("there are no rows")]
    Empty,
    /// The drawing library refused.
    #[error("cannot be drawn: {0}")]
    Refused(String),
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawError>;

fn refused(error: impl std::fmt::Display) -> DrawError {
    DrawError::Refused(error.to_string())
}

/// A kind of failure: its title, and its count in a row with the number of cases that could fail so.
type Panel = (&'static str, fn(&Row) -> (u64, u64));

const PANELS: [Panel; 3] = [
    ("unsafe: share of open cases that are hidden", |r| (r.n_unsafe, r.open)),
    ("loose: share of hidden cases that are shown", |r| (r.loose, r.cases - r.open)),
    ("errors: share of cases without an answer", |r| (r.errors, r.cases)),
];

/// The picture of one sweep as SVG. `rows`: all rows of one file.
///
/// # Errors
/// [`DrawError`], for no rows above all.
pub fn svg(title: &str, parameter: &str, rows: &[Row]) -> Result<String, DrawError> {
    if rows.is_empty() {
        return Err(DrawError::Empty);
    }
    let panels: Vec<Panel> = PANELS
        .into_iter()
        .filter(|(title, count)| !title.starts_with("errors") || rows.iter().any(|r| count(r).0 > 0))
        .collect();
    let curves = curves(rows);
    let legend = 24 + 17 * curves.len() as i32;
    let height = (TOP + panels.len() as i32 * (PANEL + GAP) + 14).max(TOP + legend);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH as u32, height as u32)).into_drawing_area();
        area.fill(&WHITE).map_err(refused)?;
        label(&area, title, (LEFT, 18), 17.0, HPos::Left, BLACK)?;
        let scale = Scale::of(rows);
        for (k, panel) in panels.iter().enumerate() {
            let top = TOP + 14 + k as i32 * (PANEL + GAP);
            let last = k + 1 == panels.len();
            draw_panel(&area, panel, top, &scale, &curves, last.then_some(parameter))?;
        }
        draw_legend(&area, &curves)?;
        area.present().map_err(refused)?;
    }
    Ok(text)
}

/// The rows of a method, in the order of levels.
struct Curve<'a> {
    method: &'a str,
    kind: Kind,
    rows: Vec<&'a Row>,
    color: RGBColor,
    /// Which mark its points have.
    mark: usize,
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
            let color = color(kind, n_kind);
            curves.push(Curve { method: &row.method, kind, rows: vec![row], color, mark: n_kind % 4 });
            n_kind += 1;
        }
    }
    curves
}

/// Shipped methods are green, references grey, solvers blue, naive ones red and brown.
fn color(kind: Kind, k: usize) -> RGBColor {
    let of: &[[u8; 3]] = match kind {
        Kind::Shipped => &[[0, 130, 60], [60, 180, 75], [0, 90, 70], [120, 160, 0]],
        Kind::Reference => &[[90, 90, 90], [150, 150, 150]],
        Kind::Solver => &[[0, 70, 200], [0, 150, 220], [90, 60, 200], [70, 130, 180], [0, 60, 110], [130, 130, 255]],
        Kind::Naive => &[[215, 25, 30], [240, 120, 0], [150, 0, 110], [140, 80, 20], [230, 60, 150], [110, 0, 0]],
    };
    let [r, g, b] = of[k % of.len()];
    RGBColor(r, g, b)
}

/// Where levels and rates are drawn.
struct Scale {
    levels: Vec<f64>,
    /// Whether levels are drawn by their logarithm: all are positive. Else one is drawn beside the other, evenly.
    log: bool,
    /// Decades of rates below 1.
    decades: i32,
}

impl Scale {
    fn of(rows: &[Row]) -> Self {
        let mut levels: Vec<f64> = rows.iter().map(|r| r.parameter).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let log = levels[0] > 0.0 && levels[levels.len() - 1] >= 10.0 * levels[0];
        let most = rows.iter().map(|r| r.cases).max().unwrap_or(1).max(1);
        let decades = (1..=9).find(|&d| 10u64.pow(d) >= most).unwrap_or(9) as i32;
        Self { levels, log, decades }
    }

    fn x(&self, level: f64) -> i32 {
        let last = self.levels.len() - 1;
        let share = if last == 0 {
            0.5
        } else if self.log {
            (level / self.levels[0]).log10() / (self.levels[last] / self.levels[0]).log10()
        } else {
            self.levels.iter().position(|&l| l == level).unwrap_or(0) as f64 / last as f64
        };
        LEFT + 14 + (share * f64::from(RIGHT - LEFT - 28)).round() as i32
    }

    /// Pixels above the bottom of a panel.
    fn y(&self, (n, of): (u64, u64)) -> i32 {
        if n == 0 || of == 0 {
            return ZERO / 2;
        }
        let share = 1.0 + (n as f64 / of as f64).log10() / f64::from(self.decades);
        ZERO + (share.max(0.0) * f64::from(PANEL - ZERO - 6)).round() as i32
    }
}

fn label(area: &Area<'_>, text: &str, at: (i32, i32), size: f64, align: HPos, color: RGBColor) -> Drawn {
    let style = TextStyle::from(("sans-serif", size).into_font()).color(&color).pos(Pos::new(align, VPos::Center));
    area.draw_text(text, &style, at).map_err(refused)
}

fn line(area: &Area<'_>, points: Vec<(i32, i32)>, color: RGBColor, width: u32) -> Drawn {
    area.draw(&PathElement::new(points, color.stroke_width(width))).map_err(refused)
}

/// A level for people: a few digits.
fn short(level: f64) -> String {
    let exact = number(level);
    if exact.len() <= 6 { exact } else { format!("{level:.1e}") }
}

fn draw_panel(
    area: &Area<'_>,
    (title, count): &Panel,
    top: i32,
    scale: &Scale,
    curves: &[Curve<'_>],
    parameter: Option<&str>,
) -> Drawn {
    let bottom = top + PANEL;
    let grey = RGBColor(225, 225, 225);
    label(area, title, (LEFT, top - 10), 14.0, HPos::Left, BLACK)?;
    for decade in 0..=scale.decades {
        let y = bottom - scale.y((1, 10u64.pow(decade as u32)));
        line(area, vec![(LEFT, y), (RIGHT, y)], grey, 1)?;
        let name = if decade == 0 { "1".to_owned() } else { format!("1e-{decade}") };
        label(area, &name, (LEFT - 8, y), 12.0, HPos::Right, BLACK)?;
    }
    label(area, "none", (LEFT - 8, bottom - scale.y((0, 1))), 12.0, HPos::Right, BLACK)?;
    let mut next_free = i32::MIN;
    for &level in &scale.levels {
        let x = scale.x(level);
        line(area, vec![(x, bottom), (x, bottom + 4)], BLACK, 1)?;
        if x >= next_free {
            let name = short(level);
            label(area, &name, (x, bottom + 12), 12.0, HPos::Center, BLACK)?;
            next_free = x + 8 * name.len() as i32 + 6;
        }
    }
    if let Some(parameter) = parameter {
        label(area, parameter, ((LEFT + RIGHT) / 2, bottom + 30), 13.0, HPos::Center, BLACK)?;
    }
    // Shipped methods last, so that they lie on top.
    for curve in curves.iter().rev() {
        let points: Vec<(i32, i32)> = curve
            .rows
            .iter()
            .filter(|row| count(row).1 > 0)
            .map(|row| (scale.x(row.parameter), bottom - scale.y(count(row))))
            .collect();
        let failing = |p: &&(i32, i32)| p.1 < bottom - ZERO / 2;
        if points.len() > 1 {
            line(area, points.clone(), curve.color, if curve.kind == Kind::Shipped { 3 } else { 1 })?;
        }
        for &at in points.iter().filter(failing) {
            mark(area, at, curve)?;
        }
    }
    let frame = Rectangle::new([(LEFT, top), (RIGHT, bottom)], BLACK.stroke_width(1));
    area.draw(&frame).map_err(refused)
}

/// The mark of a curve: a disc, a square, a ring or a triangle.
fn mark(area: &Area<'_>, (x, y): (i32, i32), curve: &Curve<'_>) -> Drawn {
    let color = curve.color;
    match curve.mark {
        0 => area.draw(&Circle::new((x, y), 3, color.filled())),
        1 => area.draw(&Rectangle::new([(x - 3, y - 3), (x + 3, y + 3)], color.filled())),
        2 => area.draw(&Circle::new((x, y), 4, color.stroke_width(1))),
        _ => area.draw(&Polygon::new(vec![(x - 4, y + 3), (x + 4, y + 3), (x, y - 4)], color.filled())),
    }
    .map_err(refused)
}

fn draw_legend(area: &Area<'_>, curves: &[Curve<'_>]) -> Drawn {
    let x = RIGHT + 16;
    label(area, "method (unsafe / loose / errors)", (x, TOP + 4), 12.0, HPos::Left, BLACK)?;
    for (k, curve) in curves.iter().enumerate() {
        let y = TOP + 22 + 17 * k as i32;
        line(area, vec![(x, y), (x + 22, y)], curve.color, if curve.kind == Kind::Shipped { 3 } else { 1 })?;
        mark(area, (x + 11, y), curve)?;
        let sum = |count: fn(&Row) -> u64| curve.rows.iter().map(|r| count(r)).sum::<u64>();
        let [n_unsafe, loose, errors] = [sum(|r| r.n_unsafe), sum(|r| r.loose), sum(|r| r.errors)];
        let name = format!("{} ({n_unsafe} / {loose} / {errors})", curve.method);
        label(area, &name, (x + 28, y), 12.0, HPos::Left, curve.color)?;
    }
    Ok(())
}
