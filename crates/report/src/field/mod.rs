//! Values at points of a plan, such as the measures of a visibility graph: a square for each point, in one hue from light to dark.

use crate::buffer_chart::number;
use crate::canvas::{Canvas, parsed};
use crate::chart::Svg;
use crate::draw::{MAX_SIZE, MIN_SIZE};
use crate::frame::{Frame, Px};
use crate::png::{Pixels, encode_small};
use crate::{PngError, letters, theme};
use sightlines_geometry::{Aabb, Point2, Segment2};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Steps of the scale in the legend.
const STEPS: u32 = 128;

/// Values at points, and what is said of them.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// What the values are; letters, digits and signs of plain text.
    pub title: &'a str,
    /// The unit of the values; empty if they have none.
    pub unit: &'a str,
    /// The points.
    pub points: &'a [Point2],
    /// The side of the square around each point, in scene units.
    pub side: f64,
    /// A value for each point; nothing is drawn where there is none.
    pub values: &'a [Option<f64>],
    /// Lines that are drawn over the squares.
    pub walls: &'a [Segment2],
    /// Pixels of the longer side of the plan, from [`MIN_SIZE`] to [`MAX_SIZE`], to which it is brought.
    pub size: u32,
}

/// The colour of a place on the scale, from 0 (light) to 1 (dark): blues, each darker than those before. What is less or no number counts
/// as 0, what is more as 1.
///
/// People with any kind of colour blindness tell the places by their lightness, as they can in print without colours.
pub fn field_colour(place: f64) -> [u8; 3] {
    const STOPS: [[u8; 3]; 3] = [[226, 238, 250], [76, 142, 205], [10, 36, 96]];
    // What is no number becomes 0.
    let along = 2.0 * if place > 0.0 { place.min(1.0) } else { 0.0 };
    let k = (along as usize).min(1);
    let part = along - k as f64;
    let between = |i: usize| {
        let [from, to] = [STOPS[k][i], STOPS[k + 1][i]].map(f64::from);
        (from + (to - from) * part).round() as u8
    };
    std::array::from_fn(between)
}

/// Draws values as SVG. Outside the squares and the legend the picture is transparent.
///
/// # Panics
/// If there are not as many values as points.
///
/// # Cost
/// O(points + walls · log walls).
pub fn field_svg(field: &Field<'_>) -> String {
    let drawn = Layout::of(field);
    let [width, height] = drawn.size;
    let mut out = Svg::of_lines([width, height].map(f64::from), field.title);
    let [_, top, ..] = drawn.legend;
    let (top, below, paper) = (Px(top), Px(f64::from(height) - top), theme::PAPER);
    out.push(format_args!("<rect y=\"{top}\" width=\"{width}\" height=\"{below}\" fill=\"{paper}\"/>"));
    let mut paths: BTreeMap<[u8; 3], String> = BTreeMap::new();
    for ([left, top, right, bottom], colour) in drawn.squares.iter().chain(&drawn.scale) {
        let path = paths.entry(*colour).or_default();
        let _ = write!(path, "M{} {}H{}V{}H{}Z", Px(*left), Px(*top), Px(*right), Px(*bottom), Px(*left));
    }
    for ([r, g, b], path) in paths {
        out.push(format_args!("<path fill=\"#{r:02x}{g:02x}{b:02x}\" shape-rendering=\"crispEdges\" d=\"{path}\"/>"));
    }
    let mut lines = String::new();
    for [[ax, ay], [bx, by]] in &drawn.walls {
        let _ = write!(lines, "M{} {}L{} {}", Px(*ax), Px(*ay), Px(*bx), Px(*by));
    }
    for (colour, width) in drawn.strokes() {
        let width = Px(width);
        let paint = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"");
        out.push(format_args!("<path class=\"walls\" {paint} d=\"{lines}\"/>"));
    }
    for (text, at, size) in &drawn.texts {
        out.letters(*at, *size, text);
    }
    out.end()
}

/// Draws values as a PNG with transparency, like [`field_svg`].
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many values as points.
///
/// # Cost
/// O(points + pixels), and 4 bytes of memory for each pixel.
pub fn field_png(field: &Field<'_>) -> Result<Vec<u8>, PngError> {
    let drawn = Layout::of(field);
    let mut canvas = Canvas::new(drawn.size);
    let [width, height] = drawn.size.map(f64::from);
    let [_, top, ..] = drawn.legend;
    canvas.fill([0.0, top, width, height], parsed(theme::PAPER));
    drawn.squares.iter().chain(&drawn.scale).for_each(|&(square, colour)| canvas.fill(square, colour));
    for (colour, width) in drawn.strokes() {
        drawn.walls.iter().for_each(|&line| canvas.stroke(line, width, parsed(colour)));
    }
    for (text, at, size) in &drawn.texts {
        for line in letters::lines(text, *at, *size) {
            line.windows(2)
                .for_each(|ends| canvas.stroke([ends[0], ends[1]], letters::stroke(*size), parsed(theme::INK)));
        }
    }
    encode_small(drawn.size, canvas.bytes(), Pixels::Rgba)
}

/// Left, top, right and bottom, in pixels.
type Rectangle = [f64; 4];

/// Where everything lies in the picture, in pixels from the upper left corner.
struct Layout {
    size: [u32; 2],
    squares: Vec<(Rectangle, [u8; 3])>,
    walls: Vec<[[f64; 2]; 2]>,
    wall: f64,
    legend: Rectangle,
    scale: Vec<(Rectangle, [u8; 3])>,
    texts: Vec<(String, [f64; 2], f64)>,
}

impl Layout {
    fn of(field: &Field<'_>) -> Self {
        let Field { title, unit, points, side, values, walls, size } = *field;
        assert_eq!(points.len(), values.len(), "one value for each point");
        let half = 0.5 * side;
        let corners = points.iter().flat_map(|p| [[p.x - half, p.y - half], [p.x + half, p.y + half]]);
        let ends = walls.iter().flat_map(|wall| [wall.a, wall.b]).map(|p| [p.x, p.y]);
        let frame = Frame::around(Aabb::around(corners.chain(ends)), size.clamp(MIN_SIZE, MAX_SIZE));
        let known = || values.iter().flatten().copied().filter(|x| x.is_finite());
        let [low, high] = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
        // One value alone is in the middle of the scale.
        let place = |value: f64| if high > low { (value - low) / (high - low) } else { 0.5 };
        let mut squares = Vec::with_capacity(points.len());
        for (p, value) in points.iter().zip(values) {
            if let Some(value) = value.filter(|x| x.is_finite()) {
                let [left, top] = frame.place(Point2::new(p.x - half, p.y + half));
                let [right, bottom] = frame.place(Point2::new(p.x + half, p.y - half));
                squares.push(([left, top, right, bottom], field_colour(place(value))));
            }
        }
        let lines = walls.iter().map(|wall| [frame.place(wall.a), frame.place(wall.b)]).collect();
        let longer = f64::from(frame.width.max(frame.height));
        let text = (longer / 45.0).clamp(11.0, 26.0);
        let margin = text;
        let title = if unit.is_empty() { title.to_owned() } else { format!("{title}, in {unit}") };
        let n_without = values.len() - squares.len();
        let mut notes = vec![title];
        if n_without > 0 {
            notes.push(format!("{n_without} of {} points have no value", values.len()));
        }
        let [low, high] = if squares.is_empty() { [String::new(), String::new()] } else { [low, high].map(number) };
        let widest = notes.iter().map(|note| letters::width(note, text)).fold(0.0, f64::max);
        let bar = (0.45 * f64::from(frame.width))
            .clamp(9.0 * text, 30.0 * text)
            .max(letters::width(&low, text) + letters::width(&high, text) + 2.0 * text);
        let width = f64::from(frame.width).max(widest.max(bar) + 2.0 * margin).ceil();
        let top = f64::from(frame.height);
        let mut texts = Vec::new();
        let mut y = top + margin + text;
        for note in notes {
            texts.push((note, [margin, y], text));
            y += 1.5 * text;
        }
        let scale = if squares.is_empty() {
            Vec::new()
        } else {
            let step = |k: u32| {
                let at = |k: u32| margin + bar * f64::from(k) / f64::from(STEPS);
                let place = (f64::from(k) + 0.5) / f64::from(STEPS);
                ([at(k), y - 0.6 * text, at(k + 1), y + 0.6 * text], field_colour(place))
            };
            (0..STEPS).map(step).collect()
        };
        y += 2.0 * text;
        texts.push((low, [margin, y], text));
        let right = margin + bar - letters::width(&high, text);
        texts.push((high, [right, y], text));
        let height = (y + margin).ceil();
        Self {
            size: [width as u32, height as u32],
            squares,
            walls: lines,
            wall: (longer / 600.0).max(1.2),
            legend: [0.0, top, width, height],
            scale,
            texts,
        }
    }

    /// Colours and widths in which walls are drawn one after the other: dark, with light around that keeps them apart from dark squares.
    fn strokes(&self) -> [(&'static str, f64); 2] {
        [(theme::PAPER, 2.2 * self.wall), (theme::WALL, self.wall)]
    }
}

#[cfg(test)]
mod tests;
