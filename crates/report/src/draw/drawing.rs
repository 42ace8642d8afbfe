//! A picture on its paper: alone, or beside others.

use super::legend::{Entry, Legend, text_size};
use super::svg;
use crate::frame::{Frame, Px};
use crate::{letters, theme};
use sightlines_geometry::Aabb;
use std::fmt::Write;

/// A picture that is drawn, with its legend: alone on its paper ([`Drawing::to_svg`]), or beside others ([`Drawing::side_by_side`]).
#[derive(Debug, Clone)]
pub struct Drawing {
    title: String,
    frame: Frame,
    /// The longer side that was asked for, in pixels.
    size: u32,
    /// SVG, from the upper left corner.
    body: String,
    entries: Vec<Entry>,
    legend: bool,
}

/// The height of a title above a picture whose longer side has `size` pixels.
fn head(size: u32) -> u32 {
    (2.0 * text_size(size)).ceil() as u32
}

impl Drawing {
    /// An empty picture of `bounds` whose longer side, with the title and the legend if there is one, has `size` pixels.
    pub(super) fn new(title: String, bounds: Aabb<2>, size: u32, entries: Vec<Entry>, legend: bool) -> Self {
        let mut frame = Frame::around(bounds, size);
        if let Some(strip) = Legend::new(&entries, size).filter(|_| legend) {
            let head = f64::from(head(size));
            // A narrower picture has more rows below it, which leave it less room: a few steps settle that.
            for _ in 0..8 {
                let height = head + strip.height(f64::from(frame.width).max(strip.least_width()));
                if f64::from(frame.height) + height <= f64::from(size) {
                    break;
                }
                frame = Frame::within(bounds, [f64::from(size), (f64::from(size) - height).floor()], size);
            }
        }
        Self { title, frame, size, body: String::new(), entries, legend }
    }

    pub(super) fn frame(&self) -> Frame {
        self.frame
    }

    pub(super) fn body(&mut self) -> &mut String {
        &mut self.body
    }

    /// The picture as SVG, with its title above and its legend below unless that was declined or there is no room for words.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let Frame { width, height, scale, .. } = self.frame;
        let strip = Legend::new(&self.entries, self.size).filter(|_| self.legend);
        // At most a few times the size of a picture, so the casts are exact.
        let wide = strip.as_ref().map_or(width, |strip| width.max(strip.least_width().ceil() as u32));
        let Some(strip) = strip else {
            return svg::open(&self.title, [wide, height]) + &self.body + svg::CLOSE;
        };
        let head = head(self.size);
        let high = head + height + strip.height(f64::from(wide)).ceil() as u32;
        let mut out = svg::open(&self.title, [wide, high]);
        self.heading(&mut out, f64::from(wide));
        let _ = writeln!(out, "<g transform=\"translate(0 {head})\">");
        out.push_str(&self.body);
        out.push_str("</g>\n");
        strip.draw(&mut out, [f64::from(wide), f64::from(head + height)], scale);
        out.push_str(svg::CLOSE);
        out
    }

    /// The title above a picture, in smaller letters if it is too long for it.
    fn heading(&self, out: &mut String, wide: f64) {
        let (text, margin) = (text_size(self.size), 0.5 * f64::from(self.size) / 25.0);
        let text = text.min(text * (wide - 2.0 * margin) / letters::width(&self.title, text).max(1.0));
        let path = letters::path(&self.title, [margin, 0.7 * f64::from(head(self.size))], text);
        let _ = writeln!(out, "<g><title>{}</title>", self.title);
        svg::stroke(out, &path, theme::INK, letters::stroke(text));
        out.push_str("</g>\n");
    }

    /// Several pictures in about a square, row by row, each with a heading, a title above and one legend below them all. Each keeps its own size; the
    /// scale bar is that of the first.
    #[must_use]
    pub fn side_by_side(title: &str, pictures: &[(String, Drawing)]) -> String {
        let n_across = (1..).find(|n| n * n >= pictures.len()).unwrap_or(1).max(1);
        let size = pictures.iter().map(|(_, drawing)| drawing.size).max().unwrap_or(1);
        let text = 1.4 * text_size(size);
        let heading_width = |heading: &str| (letters::width(heading, text) + 2.0 * text).ceil() as u32;
        let wide = pictures.iter().map(|(heading, d)| d.frame.width.max(heading_width(heading))).max().unwrap_or(1);
        let head = (2.0 * text).ceil() as u32;
        let high = head + pictures.iter().map(|(_, drawing)| drawing.frame.height).max().unwrap_or(1);
        let mut entries: Vec<Entry> = Vec::new();
        for entry in pictures.iter().flat_map(|(_, drawing)| &drawing.entries) {
            // Shades of one meaning have one entry.
            if entries.iter().all(|known| known.label != entry.label) {
                entries.push(*entry);
            }
        }
        let [whole, rows] = [wide * n_across as u32, high * pictures.len().div_ceil(n_across) as u32];
        let strip = Legend::of_text(&entries, text);
        let whole = whole.max(strip.least_width().ceil() as u32);
        let below = strip.height(f64::from(whole)).ceil() as u32;
        let top = head;
        let mut out = svg::open(title, [whole, top + rows + below]);
        let left = 0.5 * f64::from(size) / 25.0;
        let large =
            (1.2 * text).min(1.2 * text * (f64::from(whole) - 2.0 * left) / letters::width(title, 1.2 * text).max(1.0));
        let _ = writeln!(out, "<g><title>{title}</title>");
        svg::stroke(&mut out, &letters::path(title, [left, 1.4 * text], large), theme::INK, letters::stroke(large));
        out.push_str("</g>\n");
        for (k, (heading, drawing)) in pictures.iter().enumerate() {
            let [x, y] = [wide * (k % n_across) as u32, top + high * (k / n_across) as u32];
            let _ = writeln!(out, "<g transform=\"translate({x} {y})\"><title>{heading}</title>");
            let at = [0.5 * f64::from(size) / 25.0, 1.4 * text];
            svg::stroke(&mut out, &letters::path(heading, at, text), theme::INK, letters::stroke(text));
            let _ = writeln!(out, "<g transform=\"translate(0 {})\">", Px(f64::from(head)));
            out.push_str(&drawing.body);
            out.push_str("</g></g>\n");
        }
        if let Some((_, first)) = pictures.first() {
            strip.draw(&mut out, [f64::from(whole), f64::from(top + rows)], first.frame.scale);
        }
        out.push_str(svg::CLOSE);
        out
    }
}
