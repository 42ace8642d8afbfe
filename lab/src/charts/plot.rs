//! Pictures of charts as SVG: panels with points, both axes logarithmic, the Pareto front marked. The same panels give
//! the same bytes.
//!
//! Drawn with `plotters` in whole pixels. Axes are our own: what is 0 has no logarithm and gets a place of its own
//! below, ranges within a decade still have marks, and nothing depends on fonts that a machine has.

use super::front::pareto_front;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width and height of a panel.
const PANEL: [i32; 2] = [620, 372];
/// Left, top, right and bottom of the frame of its points.
const FRAME: [i32; 4] = [66, 58, 392, 318];
/// Height of the place for what is 0, below the others.
const ZERO: i32 = 26;
const COLOURS: [RGBColor; 10] = [
    RGBColor(0x1f, 0x77, 0xb4),
    RGBColor(0xe0, 0x6c, 0x14),
    RGBColor(0x2a, 0x92, 0x45),
    RGBColor(0xc9, 0x36, 0x4f),
    RGBColor(0x86, 0x5c, 0xc4),
    RGBColor(0x96, 0x6a, 0x50),
    RGBColor(0xd0, 0x62, 0xac),
    RGBColor(0x7f, 0x87, 0x90),
    RGBColor(0x9c, 0x9a, 0x1e),
    RGBColor(0x16, 0x9c, 0xa8),
];
const INK: RGBColor = RGBColor(0x1c, 0x27, 0x33);
const RULE: RGBColor = RGBColor(0xd5, 0xda, 0xe0);
const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// The same where the reader's surroundings are dark.
const DARK: &str = "<style>@media (prefers-color-scheme: dark) { svg [fill=\"#1C2733\"] { fill: #e4e9ee; } \
                    svg [stroke=\"#1C2733\"] { stroke: #e4e9ee; } svg [stroke=\"#D5DAE0\"] { stroke: #3a444e; } \
                    svg [fill=\"#FFFFFF\"] { fill: #161b21; } }</style>\n";

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

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the picture of {title} cannot be drawn: {what}")]
pub struct PlotError {
    /// Its title.
    pub title: String,
    /// What the drawing library says.
    pub what: String,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Draws panels, two in a row, below a title.
///
/// # Errors
/// [`PlotError`] with what the drawing library says.
pub fn svg(title: &str, panels: &[Panel]) -> Result<String, PlotError> {
    let n_rows = panels.len().div_ceil(2).max(1) as i32;
    let n_columns = panels.len().clamp(1, 2) as i32;
    let size = [n_columns * PANEL[0], n_rows * PANEL[1] + 34];
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (size[0] as u32, size[1] as u32)).into_drawing_area();
        draw(&area, title, panels).map_err(|e| PlotError { title: title.to_owned(), what: e.to_string() })?;
    }
    Ok(match text.find(">\n") {
        Some(end) => format!("{}{DARK}{}", &text[..end + 2], &text[end + 2..]),
        None => text,
    })
}

fn draw(area: &Area<'_>, title: &str, panels: &[Panel]) -> Drawn {
    area.fill(&PAPER)?;
    write(area, title, [16, 12], (HPos::Left, VPos::Top), 21)?;
    for (k, panel) in (0i32..).zip(panels) {
        one(area, panel, [(k % 2) * PANEL[0], (k / 2) * PANEL[1] + 34])?;
    }
    area.present()?;
    Ok(())
}

fn write(area: &Area<'_>, what: &str, at: [i32; 2], anchor: (HPos, VPos), size: i32) -> Drawn {
    let style = ("sans-serif", size).into_font().color(&INK).pos(Pos::new(anchor.0, anchor.1));
    area.draw(&Text::new(what.to_owned(), (at[0], at[1]), style))?;
    Ok(())
}

fn line(area: &Area<'_>, points: Vec<[i32; 2]>, style: impl Into<ShapeStyle>) -> Drawn {
    let points: Vec<(i32, i32)> = points.into_iter().map(|p| (p[0], p[1])).collect();
    area.draw(&PathElement::new(points, style))?;
    Ok(())
}

/// A logarithmic axis.
struct Axis {
    /// Logarithms to the base of 10 at both ends.
    ends: [f64; 2],
    /// Pixels at both ends.
    pixels: [i32; 2],
    /// Where what is 0 is put.
    zero: Option<i32>,
    /// Whether there is nothing but 0.
    is_empty: bool,
}

impl Axis {
    /// Around values; those that are not above 0 only say whether there is a place for them.
    fn around(values: &[f64], pixels: [i32; 2], zero_at: i32) -> Option<Self> {
        let above: Vec<f64> = values.iter().copied().filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10).collect();
        let zero = values.contains(&0.0).then_some(zero_at);
        if above.is_empty() && zero.is_none() {
            return None;
        }
        let [low, high] = above.iter().fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(*v), h.max(*v)]);
        let [low, high] = if above.is_empty() { [0.0, 1.0] } else { [low, high] };
        // Some room on both sides, and never nothing: what is nearly the same looks nearly the same.
        let room = ((high - low) * 0.06).max((0.1 - 0.5 * (high - low)).max(0.01));
        Some(Self { ends: [low - room, high + room], pixels, zero, is_empty: above.is_empty() })
    }

    fn place(&self, value: f64) -> i32 {
        if value <= 0.0 {
            return self.zero.unwrap_or(self.pixels[0]);
        }
        let share = (value.log10() - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.pixels[0] + (share * f64::from(self.pixels[1] - self.pixels[0])).round() as i32
    }

    /// Values to be marked, with their names: powers of 10 over wide ranges, steps within a decade else.
    fn marks(&self) -> Vec<(f64, String)> {
        if self.is_empty {
            return Vec::new();
        }
        let [low, high] = self.ends;
        let decades = high - low;
        let power = |k: i32| 10f64.powi(k);
        let range = low.floor() as i32..=high.ceil() as i32;
        let values: Vec<f64> = if decades > 2.2 {
            let every = (decades / 7.0).ceil().max(1.0) as i32;
            range.filter(|k| k.rem_euclid(every) == 0).map(power).collect()
        } else if decades > 0.8 {
            range.flat_map(|k| [1.0, 2.0, 5.0].map(|m| m * power(k))).collect()
        } else {
            let [from, to] = self.ends.map(|e| 10f64.powf(e));
            let raw = (to - from) / 5.0;
            let scale = power(raw.log10().floor() as i32);
            let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * scale).find(|s| *s >= raw).unwrap_or(raw);
            let first = (from / step).ceil() as i64;
            (first..=(to / step).floor() as i64).map(|k| k as f64 * step).collect()
        };
        let within = |v: &f64| *v > 0.0 && (low..=high).contains(&v.log10());
        values.into_iter().filter(within).map(|v| (v, short(v))).collect()
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

fn one(area: &Area<'_>, panel: &Panel, at: [i32; 2]) -> Drawn {
    let [x0, y0, x1, y1] = [FRAME[0] + at[0], FRAME[1] + at[1], FRAME[2] + at[0], FRAME[3] + at[1]];
    write(area, &panel.title, [at[0] + 16, at[1] + 14], (HPos::Left, VPos::Top), 17)?;
    write(area, &panel.names[1], [at[0] + 16, at[1] + 36], (HPos::Left, VPos::Top), 14)?;
    write(area, &panel.names[0], [(x0 + x1) / 2, y1 + 30], (HPos::Center, VPos::Top), 14)?;
    let points = || panel.series.iter().flat_map(|s| &s.points).filter(|p| is_usable(p));
    let [across, up] = [0, 1].map(|k| points().map(|p| p.at[k]).collect::<Vec<f64>>());
    let floor = if up.contains(&0.0) { y1 - ZERO } else { y1 };
    let axes = (Axis::around(&across, [x0, x1], x0), Axis::around(&up, [floor, y0], y1 - ZERO / 3));
    let (Some(across), Some(up)) = axes else {
        return write(area, "nothing was measured", [(x0 + x1) / 2, (y0 + y1) / 2], (HPos::Center, VPos::Center), 15);
    };
    for (value, name) in across.marks() {
        let x = across.place(value);
        line(area, vec![[x, y0], [x, y1]], RULE)?;
        write(area, &name, [x, y1 + 8], (HPos::Center, VPos::Top), 14)?;
    }
    for (value, name) in up.marks() {
        let y = up.place(value);
        line(area, vec![[x0, y], [x1, y]], RULE)?;
        write(area, &name, [x0 - 7, y], (HPos::Right, VPos::Center), 14)?;
    }
    if let Some(y) = up.zero {
        line(area, vec![[x0, y1 - ZERO], [x1, y1 - ZERO]], INK.stroke_width(1))?;
        write(area, "0", [x0 - 7, y], (HPos::Right, VPos::Center), 14)?;
    }
    line(area, vec![[x0, y0], [x0, y1], [x1, y1]], INK.stroke_width(1))?;
    let place = |p: &Point| [across.place(p.at[0]), up.place(p.at[1])];
    if panel.has_front {
        front(area, panel, place)?;
    }
    for series in &panel.series {
        let style = COLOURS[series.slot % COLOURS.len()];
        let usable: Vec<&Point> = series.points.iter().filter(|p| is_usable(p)).collect();
        if series.is_joined && usable.len() > 1 {
            line(area, usable.iter().map(|p| place(p)).collect(), style.stroke_width(2))?;
        }
        usable.into_iter().try_for_each(|p| mark(area, series.slot, place(p), p.is_unsafe))?;
    }
    legend(area, panel, [x1 + 16, y0 + 2])
}

fn is_usable(point: &Point) -> bool {
    point.at.iter().all(|v| v.is_finite()) && point.at[0] > 0.0 && point.at[1] >= 0.0
}

/// A staircase below which nothing is, and a ring around each of its points.
fn front(area: &Area<'_>, panel: &Panel, place: impl Fn(&Point) -> [i32; 2]) -> Drawn {
    let safe: Vec<&Point> =
        panel.series.iter().flat_map(|s| &s.points).filter(|p| is_usable(p) && !p.is_unsafe).collect();
    let places: Vec<[f64; 2]> = safe.iter().map(|p| p.at).collect();
    let mut stairs: Vec<[i32; 2]> = Vec::new();
    for i in pareto_front(&places) {
        let [x, y] = place(safe[i]);
        area.draw(&Circle::new((x, y), 9, INK.stroke_width(1)))?;
        stairs.extend(stairs.last().map(|last| [x, last[1]]));
        stairs.push([x, y]);
    }
    if stairs.len() > 1 { line(area, stairs, INK.stroke_width(1)) } else { Ok(()) }
}

/// A point: its shape and colour say whose it is; a cross is an unsafe one.
fn mark(area: &Area<'_>, slot: usize, [x, y]: [i32; 2], is_unsafe: bool) -> Drawn {
    let colour = COLOURS[slot % COLOURS.len()];
    if is_unsafe {
        for s in [-1, 1] {
            line(area, vec![[x - 5, y - 5 * s], [x + 5, y + 5 * s]], colour.stroke_width(2))?;
        }
        return Ok(());
    }
    let shape = |corners: &[[i32; 2]]| {
        let corners: Vec<(i32, i32)> = corners.iter().map(|c| (x + c[0], y + c[1])).collect();
        area.draw(&Polygon::new(corners, colour.filled()))
    };
    match slot % 4 {
        0 => area.draw(&Circle::new((x, y), 5, colour.filled()))?,
        1 => shape(&[[-4, -4], [4, -4], [4, 4], [-4, 4]])?,
        2 => shape(&[[0, -6], [6, 4], [-6, 4]])?,
        _ => shape(&[[0, -6], [6, 0], [0, 6], [-6, 0]])?,
    }
    Ok(())
}

fn legend(area: &Area<'_>, panel: &Panel, [x, mut y]: [i32; 2]) -> Drawn {
    // Many names stand closer together.
    let step = (FRAME[3] - FRAME[1] + 40) / (panel.series.len() as i32 + 3).max(14);
    for series in &panel.series {
        let all_unsafe = !series.points.is_empty() && series.points.iter().all(|p| p.is_unsafe);
        mark(area, series.slot, [x, y + 6], all_unsafe)?;
        write(area, &series.name, [x + 13, y + 6], (HPos::Left, VPos::Center), 14)?;
        y += step;
    }
    y += 5;
    if panel.has_front && !panel.series.is_empty() {
        area.draw(&Circle::new((x, y + 6), 7, INK.stroke_width(1)))?;
        write(area, "on the Pareto front", [x + 13, y + 6], (HPos::Left, VPos::Center), 14)?;
        y += step;
    }
    if panel.series.iter().flat_map(|s| &s.points).any(|p| p.is_unsafe) {
        write(area, "\u{d7}", [x - 4, y + 6], (HPos::Left, VPos::Center), 16)?;
        write(area, "hides what is visible", [x + 13, y + 6], (HPos::Left, VPos::Center), 14)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let text = svg("title", &[panel(), panel(), panel()]).unwrap();
        assert_eq!(text, svg("title", &[panel(), panel(), panel()]).unwrap());
        assert_ne!(text, svg("title", &[panel(), panel()]).unwrap());
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>") && text.contains("a &lt; b"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn fronts_leave_out_what_is_unsafe() {
        let rings = |panel: &Panel| svg("t", std::slice::from_ref(panel)).unwrap().matches("r=\"9\"").count();
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
        assert!(svg("t", &[empty]).unwrap().contains("nothing was measured"));
        assert!(svg("t", &[]).unwrap().ends_with("</svg>\n"));
    }

    #[test]
    fn marks_are_within_their_axis() {
        for values in [vec![1.0, 1.2], vec![0.9, 30.0], vec![1e-7, 10.0], vec![5.0], vec![0.0, 0.001], vec![1.0, 1e9]] {
            let axis = Axis::around(&values, [10, 300], 305).unwrap();
            let marks = axis.marks();
            assert!(!marks.is_empty() && marks.len() <= 12, "{values:?}: {marks:?}");
            assert!(marks.iter().all(|(v, _)| (10..=300).contains(&axis.place(*v))), "{values:?}: {marks:?}");
            assert!(marks.is_sorted_by(|a, b| a.0 < b.0));
        }
        assert!(Axis::around(&[], [0, 1], 0).is_none());
        assert_eq!(Axis::around(&[0.0], [0, 1], 7).unwrap().place(0.0), 7);
        assert_eq!([0.1, 1.0, 1.05, 200.0, 1e-7, 3e6].map(short), ["0.1", "1", "1.05", "200", "1e-7", "3e6"]);
    }
}
