//! Letters made of strokes, so that pictures need no fonts and look the same everywhere.

use crate::frame::Px;
use std::fmt::Write;

/// Grid units from the lowest descender to the top of a capital: the height of a line of text.
pub(crate) const HEIGHT: f64 = 8.0;
/// Grid units from the bottom of the grid to the line that letters stand on.
const BASE: f64 = 2.0;
/// Grid units between two letters.
const GAP: f64 = 2.0;
/// The width of a stroke, in grid units.
const STROKE: f64 = 0.85;

/// For each character its width and its strokes: lines through points of a grid, each given by two digits, to the right and up. Lines are
/// separated by `;`.
#[rustfmt::skip]
const GLYPHS: [(char, u8, &str); 82] = [
    ('a', 3, "35 26 16 05 03 12 22 33;36 32"), ('b', 3, "08 02;05 16 26 35 33 22 12 03"), ('c', 3, "35 26 16 05 03 12 22 33"),
    ('d', 3, "38 32;35 26 16 05 03 12 22 33"), ('e', 3, "04 34 35 26 16 05 03 12 22 33"), ('f', 2, "28 17 12;06 26"),
    ('g', 3, "36 31 20 10 01;35 26 16 05 03 12 22 33"), ('h', 3, "08 02;05 16 26 35 32"), ('i', 0, "06 02;08 08"),
    ('j', 1, "16 11 00;18 18"), ('k', 3, "08 02;36 04;14 32"), ('l', 1, "08 03 12"), ('m', 4, "06 02;05 16 25 22;25 36 45 42"),
    ('n', 3, "06 02;05 16 26 35 32"), ('o', 3, "16 05 03 12 22 33 35 26 16"), ('p', 3, "06 00;05 16 26 35 33 22 12 03"),
    ('q', 3, "36 30;35 26 16 05 03 12 22 33"), ('r', 2, "06 02;05 16 26"), ('s', 3, "35 26 16 05 14 24 33 22 12 03"),
    ('t', 2, "18 13 22;06 26"), ('u', 3, "06 03 12 22 33;36 32"), ('v', 4, "06 22 46"), ('w', 4, "06 12 25 32 46"),
    ('x', 3, "06 32;02 36"), ('y', 4, "06 22;46 22 10 00"), ('z', 3, "06 36 02 32"),
    ('A', 4, "02 28 42;14 34"), ('B', 3, "02 08 28 37 36 25 05;25 34 33 22 02"), ('C', 4, "47 38 18 07 03 12 32 43"),
    ('D', 4, "02 08 28 46 44 22 02"), ('E', 3, "38 08 02 32;05 25"), ('F', 3, "38 08 02;05 25"), ('G', 4, "47 38 18 07 03 12 32 43 45 25"),
    ('H', 4, "08 02;48 42;05 45"), ('I', 0, "08 02"), ('J', 3, "38 33 22 12 03"), ('K', 4, "08 02;48 04;15 42"), ('L', 3, "08 02 32"),
    ('M', 4, "02 08 25 48 42"), ('N', 4, "02 08 42 48"), ('O', 4, "18 07 03 12 32 43 47 38 18"), ('P', 3, "02 08 28 37 36 25 05"),
    ('Q', 4, "18 07 03 12 32 43 47 38 18;24 42"), ('R', 3, "02 08 28 37 36 25 05;25 32"), ('S', 3, "37 28 18 07 06 15 25 34 33 22 12 03"),
    ('T', 4, "08 48;28 22"), ('U', 4, "08 03 12 32 43 48"), ('V', 4, "08 22 48"), ('W', 4, "08 12 26 32 48"), ('X', 4, "08 42;02 48"),
    ('Y', 4, "08 25 48;25 22"), ('Z', 4, "08 48 02 42"),
    ('0', 3, "18 07 03 12 22 33 37 28 18"), ('1', 2, "07 18 12;02 22"), ('2', 3, "07 18 28 37 36 02 32"),
    ('3', 3, "07 18 28 37 36 25 15;25 34 33 22 12 03"), ('4', 3, "22 28 04 34"), ('5', 3, "38 08 05 25 34 33 22 02"),
    ('6', 3, "37 28 18 07 03 12 22 33 34 25 05"), ('7', 3, "08 38 12"), ('8', 3, "15 06 07 18 28 37 36 25 15 04 03 12 22 33 34 25"),
    ('9', 3, "03 12 22 33 37 28 18 07 06 15 35"),
    (' ', 1, ""), ('.', 0, "02 02"), (',', 0, "02 01"), (':', 0, "05 05;02 02"), (';', 0, "05 05;02 01"), ('-', 2, "05 25"),
    ('(', 1, "18 06 04 12"), (')', 1, "08 16 14 02"), ('/', 3, "02 38"), ('%', 4, "02 48;07 17 18 08 07;33 43 42 32 33"),
    ('=', 3, "04 34;06 36"), ('+', 4, "05 45;27 23"), ('\'', 0, "08 07"), ('<', 3, "37 05 33"), ('>', 3, "07 35 03"), ('_', 3, "01 31"),
    ('[', 1, "18 08 02 12"), (']', 1, "08 18 12 02"), ('^', 2, "06 18 26"),
    ('!', 0, "08 04;02 02"),
];

/// What stands for a character without strokes: a box.
const UNKNOWN: (char, u8, &str) = ('\0', 3, "02 08 38 32 02");

fn glyph(letter: char) -> (f64, &'static str) {
    let (_, width, strokes) = GLYPHS.iter().find(|(c, _, _)| *c == letter).copied().unwrap_or(UNKNOWN);
    (f64::from(width), strokes)
}

/// How wide a text is, of which a line is `size` high, in the unit of `size`.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let units: f64 = text.chars().map(|letter| glyph(letter).0 + GAP).sum();
    (units - GAP).max(0.0) * size / HEIGHT
}

/// How wide strokes are in a text of this size.
pub(crate) fn stroke(size: f64) -> f64 {
    STROKE * size / HEIGHT
}

/// The strokes of a text as lines: `at` is the left end of the line that it stands on; y grows downwards.
pub(crate) fn lines(text: &str, [x, y]: [f64; 2], size: f64) -> Vec<Vec<[f64; 2]>> {
    let unit = size / HEIGHT;
    let mut left = x;
    let mut lines = Vec::new();
    for letter in text.chars() {
        let (width, strokes) = glyph(letter);
        for stroke in strokes.split(';').filter(|stroke| !stroke.is_empty()) {
            let point = |digits: &str| {
                let digit = |k: usize| f64::from(digits.as_bytes()[k] - b'0');
                [left + digit(0) * unit, y - (digit(1) - BASE) * unit]
            };
            let mut line: Vec<[f64; 2]> = stroke.split(' ').map(point).collect();
            if let [a, b] = line[..]
                && a == b
            {
                // A dot is a very short line, which all renderers draw.
                line[1][0] += 0.1 * unit;
            }
            lines.push(line);
        }
        left += (width + GAP) * unit;
    }
    lines
}

/// The strokes of a text as the data of a path; as for [`lines`].
pub(crate) fn path(text: &str, at: [f64; 2], size: f64) -> String {
    let mut path = String::new();
    for line in lines(text, at, size) {
        for (i, [x, y]) in line.into_iter().enumerate() {
            let _ = write!(path, "{}{} {}", if i == 0 { 'M' } else { 'L' }, Px(x), Px(y));
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn letters_differ_and_stay_within_their_grid() {
        let shapes: BTreeSet<&str> = GLYPHS.iter().map(|(_, _, strokes)| *strokes).collect();
        assert_eq!(shapes.len(), GLYPHS.len(), "no two look alike");
        for (letter, width, strokes) in GLYPHS.into_iter().chain([UNKNOWN]) {
            for point in strokes.split([';', ' ']).filter(|point| !point.is_empty()) {
                let [x, y] = point.as_bytes() else { panic!("{letter}: {point}") };
                assert!((b'0'..=b'0' + width).contains(x) && (b'0'..=b'8').contains(y), "{letter}: {point}");
            }
        }
    }

    #[test]
    fn texts_are_as_wide_as_their_lines() {
        assert_eq!([width("", 8.0), width("l", 8.0), width("ll", 8.0), width("aa", 16.0)], [0.0, 1.0, 4.0, 16.0]);
        let text = "Cells seen by the viewer (0.5)";
        let lines = lines(text, [3.0, 20.0], 16.0);
        let xs = || lines.iter().flatten().map(|p| p[0]);
        let ys = || lines.iter().flatten().map(|p| p[1]);
        let (low, high) = (xs().fold(f64::INFINITY, f64::min), xs().fold(0.0, f64::max));
        assert_eq!((low, high), (3.0, 3.0 + width(text, 16.0)));
        assert!(ys().all(|y| (8.0..=24.0).contains(&y)));
        assert!(path("i.", [0.0, 0.0], 8.0).contains("L0.1 -6"), "dots have a length");
    }
}
