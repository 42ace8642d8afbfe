//! What stands below a picture: what each colour means, and a scale bar.

use super::svg::{fill, stroke};
use crate::frame::Px;
use crate::{letters, theme};
use std::fmt::Write;

/// What stands before a label.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Swatch {
    /// A filled box.
    Area(&'static str),
    /// A line, with its width in pixels.
    Line(&'static str, f64),
    /// A dot.
    Dot(&'static str),
}

/// A colour and its meaning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    pub(super) swatch: Swatch,
    pub(super) label: &'static str,
}

impl Entry {
    pub(super) const fn area(colour: &'static str, label: &'static str) -> Self {
        Self { swatch: Swatch::Area(colour), label }
    }
}

/// Below this length of the longer side, in pixels, there is no room for words.
const LEAST_SIZE: u32 = 200;

/// The strip below a picture.
#[derive(Debug)]
pub(super) struct Legend<'a> {
    entries: &'a [Entry],
    /// The height of a line of text, in pixels.
    text: f64,
}

impl<'a> Legend<'a> {
    /// A legend for a picture whose longer side has `size` pixels; none where there is no room for words.
    pub(super) fn new(entries: &'a [Entry], size: u32) -> Option<Self> {
        (size >= LEAST_SIZE).then(|| Self::of_text(entries, text_size(size)))
    }

    /// A legend in words of this size.
    pub(super) fn of_text(entries: &'a [Entry], text: f64) -> Self {
        Self { entries, text }
    }

    /// Width of an entry, with its swatch and the space behind it.
    fn width_of(&self, entry: &Entry) -> f64 {
        self.text * 2.6 + letters::width(entry.label, self.text)
    }

    /// The least width of the strip, in pixels: that of its widest entry.
    pub(super) fn least_width(&self) -> f64 {
        self.entries.iter().map(|entry| self.width_of(entry)).fold(self.text * 10.0, f64::max) + self.text
    }

    /// For each entry its row and where it begins, and the number of rows. The scale bar comes first and takes [`Self::bar_room`].
    fn rows(&self, width: f64) -> (Vec<(usize, f64)>, usize) {
        let (mut row, mut x) = (0, self.text + self.bar_room(width));
        let mut places = Vec::with_capacity(self.entries.len());
        for entry in self.entries {
            let wide = self.width_of(entry);
            if x + wide > width && x > self.text {
                (row, x) = (row + 1, self.text);
            }
            places.push((row, x));
            x += wide;
        }
        (places, row + 1)
    }

    /// What the scale bar and its number take at most of a strip of this width.
    fn bar_room(&self, width: f64) -> f64 {
        0.2 * width + self.text * 4.0
    }

    /// How high the strip is for a picture of this width, in pixels.
    pub(super) fn height(&self, width: f64) -> f64 {
        (self.rows(width).1 as f64 + 0.4) * self.text * 1.6
    }

    /// Draws the strip from `top` down. `scale`: pixels for a scene unit.
    pub(super) fn draw(&self, out: &mut String, [width, top]: [f64; 2], scale: f64) {
        let line = self.text * 1.6;
        let base = |row: usize| top + line * (row as f64 + 1.0);
        out.push_str("<g>\n");
        if let Some((length, number)) = round_length(0.2 * width / scale) {
            let (x, y, wide) = (self.text, base(0), length * scale);
            let tick = 0.3 * self.text;
            let bar = format!(
                "M{} {}V{}M{} {}H{}M{} {}V{}",
                Px(x),
                Px(y - tick),
                Px(y + tick),
                Px(x),
                Px(y),
                Px(x + wide),
                Px(x + wide),
                Px(y - tick),
                Px(y + tick)
            );
            let _ = writeln!(out, "<g><title>scale: {number} scene units</title>");
            stroke(out, &bar, theme::INK, letters::stroke(self.text));
            self.words(out, &number, [x + wide + 0.7 * self.text, y]);
            out.push_str("</g>\n");
        }
        for (entry, (row, x)) in self.entries.iter().zip(self.rows(width).0) {
            let y = base(row);
            let (low, high) = (y + 0.05 * self.text, y - 0.75 * self.text);
            let _ = writeln!(out, "<g><title>{}</title>", entry.label);
            match entry.swatch {
                Swatch::Area(colour) => {
                    let path = format!("M{} {}H{}V{}H{}Z", Px(x), Px(low), Px(x + 1.2 * self.text), Px(high), Px(x));
                    fill(out, &path, colour);
                    stroke(out, &path, theme::INK, 0.04 * self.text);
                }
                Swatch::Line(colour, wide) => {
                    let path = format!("M{} {}H{}", Px(x), Px(0.5 * (low + high)), Px(x + 1.2 * self.text));
                    if colour == theme::PORTAL_FAINT {
                        let ground =
                            format!("M{} {}H{}V{}H{}Z", Px(x), Px(low), Px(x + 1.2 * self.text), Px(high), Px(x));
                        fill(out, &ground, theme::SEEN);
                    }
                    stroke(out, &path, colour, wide.max(1.0));
                }
                Swatch::Dot(colour) => {
                    super::svg::dot(out, [x + 0.6 * self.text, 0.5 * (low + high)], 0.3 * self.text, colour);
                }
            }
            self.words(out, entry.label, [x + 1.7 * self.text, y]);
            out.push_str("</g>\n");
        }
        out.push_str("</g>\n");
    }

    fn words(&self, out: &mut String, text: &str, at: [f64; 2]) {
        stroke(out, &letters::path(text, at, self.text), theme::INK, letters::stroke(self.text));
    }
}

/// The height of a line of text in a picture whose longer side has `size` pixels.
pub(super) fn text_size(size: u32) -> f64 {
    f64::from(size) / 80.0 + 7.0
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `most`, and its number in words; none if `most` is no length.
fn round_length(most: f64) -> Option<(f64, String)> {
    if !(most.is_finite() && most > 0.0) {
        return None;
    }
    // One power more and one less than the logarithm, which is rounded.
    let power = most.log10().floor() as i32;
    let lengths = (power - 1..=power + 1).rev().flat_map(|power| [5, 2, 1].map(|digit| (digit, power)));
    let read = |(digit, power): (u8, i32)| format!("{digit}e{power}").parse::<f64>().ok();
    let (length, (digit, power)) = lengths.filter_map(|l| Some((read(l)?, l))).find(|(length, _)| *length <= most)?;
    let number = if (-4..=6).contains(&power) { length.to_string() } else { format!("{digit}e{power}") };
    Some((length, number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        let round = |most| round_length(most).map(|(_, number)| number);
        for (most, number) in [
            (1.0, "1"),
            (1.99, "1"),
            (49.0, "20"),
            (50.0, "50"),
            (0.3, "0.2"),
            (1234.0, "1000"),
            (3e9, "2e9"),
            (7e-9, "5e-9"),
        ] {
            assert_eq!(round(most).as_deref(), Some(number), "{most}");
        }
        assert_eq!([round(0.0), round(f64::NAN), round(f64::INFINITY)], [None, None, None]);
        for power in -300..300 {
            let most = 10.0f64.powi(power) * 3.3;
            let (length, _) = round_length(most).unwrap();
            assert!(length <= most && 2.0 * length > 0.99 * most, "{most}");
        }
    }

    #[test]
    fn entries_stay_within_the_strip() {
        let entries = [Entry::area(theme::SEEN, "seen"), Entry::area(theme::HIDDEN, "not seen at all, by nobody")];
        let legend = Legend::new(&entries, 400).unwrap();
        assert!(Legend::new(&entries, 100).is_none());
        for width in [legend.least_width(), 300.0, 1000.0] {
            let (places, n_rows) = legend.rows(width);
            assert!(places.iter().zip(&entries).all(|((row, x), e)| *row < n_rows && x + legend.width_of(e) <= width));
        }
        assert!(legend.height(300.0) > legend.height(1000.0));
    }
}
