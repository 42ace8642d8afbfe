//! What charts are made of: shapes and words of an SVG, and logarithmic scales. The same calls give the same bytes.
//!
//! Words are in whatever font the viewer has: charts are for people, as SVG.

use crate::frame::Px;
use crate::{letters, theme};
use std::fmt::{self, Display, Write};

/// What words and lines are drawn in.
pub const INK: &str = theme::INK;
/// What lies behind everything.
pub const PAPER: &str = theme::PAPER;
/// Lines of marks behind what is drawn.
pub const RULE: &str = "#d5dae0";

/// A chart that is being drawn. Places and lengths are pixels from the upper left corner, y downwards.
#[derive(Debug, Clone)]
pub struct Svg(String);

/// How a shape is painted: its inside, and its outline with a width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint<'a> {
    /// The colour inside.
    pub fill: Option<&'a str>,
    /// The colour of the outline, and its width.
    pub stroke: Option<(&'a str, f64)>,
}

impl<'a> Paint<'a> {
    /// Its inside alone.
    pub const fn fill(colour: &'a str) -> Self {
        Self { fill: Some(colour), stroke: None }
    }

    /// Its outline alone.
    pub const fn stroke(colour: &'a str, width: f64) -> Self {
        Self { fill: None, stroke: Some((colour, width)) }
    }
}

impl Display for Paint<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, " fill=\"{}\"", self.fill.unwrap_or("none"))?;
        self.stroke.map_or(Ok(()), |stroke| Stroke(stroke).fmt(f))
    }
}

/// A line of a width. One pixel is what SVG has of itself.
struct Stroke<'a>((&'a str, f64));

impl Display for Stroke<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self((colour, width)) = self;
        write!(f, " stroke=\"{colour}\"")?;
        if *width == 1.0 { Ok(()) } else { write!(f, " stroke-width=\"{}\"", Px(*width)) }
    }
}

/// How words are written: where they stand beside their place, how large and in what colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Words<'a> {
    anchor: &'static str,
    size: Option<f64>,
    fill: Option<&'a str>,
}

impl<'a> Words<'a> {
    /// They begin at their place.
    pub const START: Self = Self { anchor: "start", size: None, fill: None };
    /// Their middle is at their place.
    pub const MIDDLE: Self = Self { anchor: "middle", ..Self::START };
    /// They end at their place.
    pub const END: Self = Self { anchor: "end", ..Self::START };

    /// Of another size than those of the chart.
    #[must_use]
    pub const fn sized(self, size: f64) -> Self {
        Self { size: Some(size), ..self }
    }

    /// Of another colour.
    #[must_use]
    pub const fn coloured(self, fill: &'a str) -> Self {
        Self { fill: Some(fill), ..self }
    }
}

impl Svg {
    /// An empty chart of a width and a height, with a title that is not drawn, and the size of its words.
    pub fn new(size: [f64; 2], title: &str, words: f64) -> Self {
        let attributes = format!("font-family=\"sans-serif\" font-size=\"{}\" fill=\"{INK}\"", Px(words));
        Self::clear(size, title, &attributes).on_paper()
    }

    /// One without fonts, in which lines have round ends, with nothing behind.
    pub(crate) fn of_lines(size: [f64; 2], title: &str) -> Self {
        Self::clear(size, title, "stroke-linecap=\"round\" stroke-linejoin=\"round\"")
    }

    /// The same with paper behind all that is drawn later.
    pub(crate) fn on_paper(mut self) -> Self {
        self.push(format_args!("<rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>"));
        self
    }

    fn clear([width, height]: [f64; 2], title: &str, attributes: &str) -> Self {
        let [w, h] = [width, height].map(Px);
        let mut out = Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" {attributes}>\n"
        ));
        out.push(format_args!("<title>{}</title>", escaped(title)));
        out
    }

    /// The same in other colours where the reader's surroundings are dark: of words and lines in [`INK`], of [`RULE`] and of [`PAPER`].
    #[must_use]
    pub fn with_dark(mut self) -> Self {
        self.push(format_args!(
            "<style>@media (prefers-color-scheme: dark) {{ [fill=\"{INK}\"] {{ fill: #e4e9ee; }} [stroke=\"{INK}\"] {{ stroke: #e4e9ee; }} \
             [stroke=\"{RULE}\"] {{ stroke: #3a444e; }} [fill=\"{PAPER}\"] {{ fill: #161b21; }} }}</style>"
        ));
        self
    }

    /// Appends an element as it is.
    pub fn push(&mut self, element: impl Display) {
        let _ = writeln!(self.0, "{element}");
    }

    /// A rectangle by its upper left corner, width and height.
    pub fn rect(&mut self, at: [f64; 2], size: [f64; 2], paint: Paint<'_>) {
        let ([x, y], [w, h]) = (at.map(Px), size.map(|length| Px(length.max(0.0))));
        self.push(format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"{paint}/>"));
    }

    /// A line.
    pub fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: &str, width: f64) {
        let ([x0, y0], [x1, y1], stroke) = (a.map(Px), b.map(Px), Stroke((colour, width)));
        self.push(format_args!("<line x1=\"{x0}\" y1=\"{y0}\" x2=\"{x1}\" y2=\"{y1}\"{stroke}/>"));
    }

    /// A line through several points.
    pub fn polyline(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        self.push(format_args!("<polyline points=\"{}\"{}/>", Points(points), Paint::stroke(colour, width)));
    }

    /// A polygon.
    pub fn polygon(&mut self, corners: &[[f64; 2]], paint: Paint<'_>) {
        self.push(format_args!("<polygon points=\"{}\"{paint}/>", Points(corners)));
    }

    /// A circle.
    pub fn circle(&mut self, at: [f64; 2], radius: f64, paint: Paint<'_>) {
        let ([x, y], r) = (at.map(Px), Px(radius));
        self.push(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{paint}/>"));
    }

    /// Words around the height of a place, of a size.
    pub fn centred(&mut self, [x, y]: [f64; 2], words: Words<'_>, size: f64, what: &str) {
        // Half of the height of a capital letter.
        self.text([x, y + 0.35 * size], words.sized(size), what);
    }

    /// Words on the line through a place.
    pub fn text(&mut self, at: [f64; 2], words: Words<'_>, what: &str) {
        let ([x, y], anchor) = (at.map(Px), words.anchor);
        let size = words.size.map_or_else(String::new, |size| format!(" font-size=\"{}\"", Px(size)));
        let fill = words.fill.map_or_else(String::new, |fill| format!(" fill=\"{fill}\""));
        self.push(format_args!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"{size}{fill}>{}</text>",
            escaped(what)
        ));
    }

    /// Words as lines, which need no fonts, of a height.
    pub(crate) fn letters(&mut self, at: [f64; 2], height: f64, what: &str) {
        let (path, width) = (letters::path(what, at, height), Px(letters::stroke(height)));
        self.push(format_args!(
            "<g><title>{}</title>\n<path d=\"{path}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{width}\"/></g>",
            escaped(what)
        ));
    }

    /// The whole file.
    pub fn end(mut self) -> String {
        self.push("</svg>");
        self.0
    }
}

struct Points<'a>(&'a [[f64; 2]]);

impl Display for Points<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().enumerate().try_for_each(|(k, point)| {
            let [x, y] = point.map(Px);
            write!(f, "{}{x},{y}", if k == 0 { "" } else { " " })
        })
    }
}

/// Text as XML has it; what no XML can hold is left out.
fn escaped(text: &str) -> String {
    let text: String = text.chars().filter(|c| !c.is_control()).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A power of ten, as its digits have it.
pub fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// A logarithmic scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Logarithms to the base of 10 at both ends.
    ends: [f64; 2],
    /// Pixels at both ends.
    pixels: [f64; 2],
}

impl Scale {
    /// From one number to another; both are positive, and the second is larger.
    pub fn new(numbers: [f64; 2], pixels: [f64; 2]) -> Self {
        Self { ends: numbers.map(f64::log10), pixels }
    }

    /// Over whole decades around two positive numbers, from 1e-12 to 1e12.
    pub fn decades([least, most]: [f64; 2], pixels: [f64; 2]) -> Self {
        // Rounding can only add a decade; then the axis is longer than it has to be.
        let from = least.log10().floor().clamp(-12.0, 12.0);
        Self { ends: [from, most.log10().ceil().clamp(-12.0, 12.0).max(from + 1.0)], pixels }
    }

    /// Around two positive numbers, with some room on both sides, and never nothing: what is nearly the same looks nearly the same.
    pub fn around(numbers: [f64; 2], pixels: [f64; 2]) -> Self {
        let [low, high] = numbers.map(f64::log10);
        let room = ((high - low) * 0.06).max((0.1 - 0.5 * (high - low)).max(0.01));
        Self { ends: [low - room, high + room], pixels }
    }

    /// Where a number is; what the scale does not have is at its end.
    pub fn place(&self, x: f64) -> f64 {
        let [low, high] = self.ends;
        let at = (x.max(f64::MIN_POSITIVE).log10() - low) / (high - low);
        self.pixels[0] + (self.pixels[1] - self.pixels[0]) * at.clamp(0.0, 1.0)
    }

    /// The exponents of the powers of ten that it has.
    pub fn powers(&self) -> std::ops::RangeInclusive<i32> {
        self.ends[0].ceil() as i32..=self.ends[1].floor() as i32
    }

    /// Numbers to be marked, ascending: powers of ten over wide ranges, else steps within a decade.
    pub fn marks(&self) -> Vec<f64> {
        let [low, high] = self.ends;
        let decades = high - low;
        let values: Vec<f64> = if decades > 2.2 {
            let every = (decades / 7.0).ceil().max(1.0) as i32;
            self.powers().filter(|k| k.rem_euclid(every) == 0).map(power_of_ten).collect()
        } else if decades > 0.8 {
            let range = low.floor() as i32..=high.ceil() as i32;
            range.flat_map(|k| [1.0, 2.0, 5.0].map(|m| m * power_of_ten(k))).collect()
        } else {
            let [from, to] = self.ends.map(|e| 10f64.powf(e));
            let raw = (to - from) / 5.0;
            let scale = power_of_ten(raw.log10().floor() as i32);
            let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * scale).find(|s| *s >= raw).unwrap_or(raw);
            let first = (from / step).ceil() as i64;
            (first..=(to / step).floor() as i64).map(|k| k as f64 * step).collect()
        };
        values.into_iter().filter(|v| *v > 0.0 && (low..=high).contains(&v.log10())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_what_svg_has() {
        let mut svg = Svg::new([20.0, 10.5], "a < b", 11.0);
        svg.rect([1.0, 2.0], [3.0, -1.0], Paint::stroke(INK, 1.0));
        svg.polyline(&[[0.0, 1.0], [2.125, 3.0]], RULE, 2.0);
        svg.circle([4.0, 5.0], 3.0, Paint { stroke: Some((INK, 1.5)), ..Paint::fill(PAPER) });
        svg.text([1.0, 9.0], Words::END.sized(9.0).coloured(RULE), "\u{1}&");
        let drawn = svg.end();
        for element in [
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10.5\" viewBox=\"0 0 20 10.5\" ",
            "\n<title>a &lt; b</title>\n",
            "<rect x=\"1\" y=\"2\" width=\"3\" height=\"0\" fill=\"none\" stroke=\"#1c2733\"/>\n",
            "<polyline points=\"0,1 2.13,3\" fill=\"none\" stroke=\"#d5dae0\" stroke-width=\"2\"/>\n",
            "<circle cx=\"4\" cy=\"5\" r=\"3\" fill=\"#ffffff\" stroke=\"#1c2733\" stroke-width=\"1.5\"/>\n",
            "<text x=\"1\" y=\"9\" text-anchor=\"end\" font-size=\"9\" fill=\"#d5dae0\">&amp;</text>\n</svg>\n",
        ] {
            assert!(drawn.contains(element), "{element}: {drawn}");
        }
    }

    #[test]
    fn marks_are_within_their_scale() {
        for numbers in [[1.0, 1.2], [0.9, 30.0], [1e-7, 10.0], [5.0, 5.0], [0.001, 0.001], [1.0, 1e9]] {
            for scale in [Scale::around(numbers, [10.0, 300.0]), Scale::decades(numbers, [10.0, 300.0])] {
                let marks = scale.marks();
                assert!(!marks.is_empty() && marks.len() <= 12, "{numbers:?}: {marks:?}");
                assert!(marks.is_sorted_by(|a, b| a < b));
                assert!(marks.iter().all(|v| (10.0..=300.0).contains(&scale.place(*v))), "{numbers:?}: {marks:?}");
            }
        }
        let scale = Scale::decades([0.02, 30.0], [0.0, 40.0]);
        assert_eq!((scale.powers(), [0.0, 0.1, 100.0, 1e9].map(|x| scale.place(x))), (-2..=2, [0.0, 10.0, 40.0, 40.0]));
        assert_eq!([power_of_ten(-3), power_of_ten(2)], [0.001, 100.0]);
    }
}
