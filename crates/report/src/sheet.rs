//! Pictures of which face is seen in each pixel, side by side, each with its title.
//!
//! Pixels count row by row from the upper left corner.

use crate::png::{Pixels, encode_pixels};
use crate::{MARK, PngError, face_colour, letters};

/// What is around the pictures of a sheet.
const MARGIN: u32 = 8;
const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [28, 39, 51];
/// The least and the largest height of a line of text, in pixels.
const TEXT: [u32; 2] = [10, 28];
/// The longest name of a method takes so many times the height of a line.
const LONGEST: u32 = 12;
/// What the legend says of marked pixels.
const LEGEND: &str = "around pixels with another face than the reference";

/// One of the pictures of a sheet.
#[derive(Debug, Clone, Copy)]
pub struct SheetPicture<'a> {
    /// The line above it.
    pub title: &'a str,
    /// The line below that.
    pub note: &'a str,
    /// Row by row from the upper left corner; [`NO_FACE`](crate::NO_FACE) where nothing is seen.
    pub faces: &'a [u32],
    /// The pixels that are pointed out, to the right and down.
    pub marked: &'a [[u32; 2]],
}

/// Pictures of one size side by side, row by row in about a square, each with its title and note above, and a legend below them all.
/// Faces have half of the light of their colours, but where pixels are marked: these have all of it, and those at the rim of a group of
/// them the colour [`MARK`], so that one sees what is marked.
///
/// * `size`: pixels to the right and down of each picture
///
/// # Errors
/// [`PngError`]; of the size of the sheet if it cannot be counted in 32 bits, or there are no pictures
///
/// # Panics
/// If a picture does not have as many faces as pixels, or marks a pixel that it does not have.
pub fn sheet_png(size: [u32; 2], pictures: &[SheetPicture<'_>]) -> Result<Vec<u8>, PngError> {
    let [width, height] = size;
    let whole = sheet_size(size, pictures.len()).ok_or(PngError::Size { width, height })?;
    let mut sheet = Sheet { size: whole, pixels: PAPER.repeat(whole[0] as usize * whole[1] as usize) };
    let [tile_width, tile_height] = tile(size);
    let text = text_of(width);
    let n_across = across(pictures.len()) as usize;
    let line = f64::from(line_of(text));
    for (k, picture) in pictures.iter().enumerate() {
        let x = MARGIN + (k % n_across) as u32 * tile_width;
        let y = MARGIN + (k / n_across) as u32 * tile_height;
        for (row, words) in [1.0, 2.0].into_iter().zip([picture.title, picture.note]) {
            let base = f64::from(y) + row * line - 0.4 * f64::from(text);
            sheet.words(words, [f64::from(x), base], f64::from(text), f64::from(tile_width - MARGIN));
        }
        sheet.picture(size, picture, [x, y + head(text)]);
    }
    let below = whole[1] - MARGIN - line_of(text);
    for [x, y] in (0..text).flat_map(|y| (0..text).map(move |x| [x, y])) {
        sheet.set([MARGIN + x, below + y], MARK);
    }
    let at = [f64::from(MARGIN) + 1.6 * f64::from(text), f64::from(below) + 0.8 * f64::from(text)];
    sheet.words(LEGEND, at, f64::from(text), f64::from(whole[0]) - at[0] - f64::from(MARGIN));
    encode_pixels(whole, &sheet.pixels, Pixels::Rgb)
}

/// Pixels to the right and down of a sheet of `n` pictures; `None` if there are too many pixels to be counted in 32 bits, or none.
pub fn sheet_size(size: [u32; 2], n: usize) -> Option<[u32; 2]> {
    let n_32 = u32::try_from(n).ok().filter(|_| n > 0 && !size.contains(&0))?;
    let fits = |x: u32| x < u32::MAX / 4;
    if !size.into_iter().all(fits) || !fits(n_32) {
        return None;
    }
    let across = across(n);
    let [width, height] = tile(size);
    let whole = [width.checked_mul(across)?.checked_add(MARGIN)?, height.checked_mul(n_32.div_ceil(across))?];
    let below = 2 * MARGIN + line_of(text_of(size[0]));
    let whole = [whole[0], whole[1].checked_add(below)?];
    whole[0].checked_mul(whole[1]).map(|_| whole)
}

/// How many pictures are side by side.
fn across(n: usize) -> u32 {
    (1u32..).find(|&k| k as usize * k as usize >= n).expect("a number has a root")
}

/// The height of the text above a picture of this width.
fn text_of(width: u32) -> u32 {
    (width / LONGEST).clamp(TEXT[0], TEXT[1])
}

/// The height of a line of text with the space below.
fn line_of(text: u32) -> u32 {
    text + text / 3
}

/// What is above a picture.
fn head(text: u32) -> u32 {
    2 * line_of(text)
}

/// Pixels that a picture takes with its two lines, which may be wider, and a margin.
fn tile([width, height]: [u32; 2]) -> [u32; 2] {
    let text = text_of(width);
    [width.max(LONGEST * text) + MARGIN, height + head(text) + MARGIN]
}

struct Sheet {
    size: [u32; 2],
    pixels: Vec<u8>,
}

impl Sheet {
    fn set(&mut self, [x, y]: [u32; 2], colour: [u8; 3]) {
        let at = (y as usize * self.size[0] as usize + x as usize) * 3;
        self.pixels[at..at + 3].copy_from_slice(&colour);
    }

    fn picture(&mut self, [width, height]: [u32; 2], picture: &SheetPicture<'_>, [x0, y0]: [u32; 2]) {
        assert_eq!(picture.faces.len(), width as usize * height as usize, "one face for each pixel");
        let mut is_marked = vec![false; picture.faces.len()];
        for &[x, y] in picture.marked {
            assert!(x < width && y < height, "a picture of {width} by {height} pixels marks ({x}, {y})");
            is_marked[(y * width + x) as usize] = true;
        }
        let marked = |x: Option<u32>, y: Option<u32>| {
            let at = x.zip(y).filter(|(x, y)| *x < width && *y < height);
            at.is_some_and(|(x, y)| is_marked[(y * width + x) as usize])
        };
        for (k, &face) in (0u32..).zip(picture.faces) {
            let (x, y) = (k % width, k / width);
            let beside = [
                (x.checked_sub(1), Some(y)),
                (Some(x + 1), Some(y)),
                (Some(x), y.checked_sub(1)),
                (Some(x), Some(y + 1)),
            ];
            let colour = match marked(Some(x), Some(y)) {
                false => face_colour(face).map(|part| part / 2),
                true if beside.into_iter().all(|(x, y)| marked(x, y)) => face_colour(face),
                true => MARK,
            };
            self.set([x0 + x, y0 + y], colour);
        }
    }

    /// Draws words from `at` on, smaller if they are wider than `most`.
    fn words(&mut self, words: &str, at: [f64; 2], text: f64, most: f64) {
        let text = text * (most / letters::width(words, text).max(1.0)).min(1.0);
        let half = (0.5 * letters::stroke(text)).max(0.45);
        for line in letters::lines(words, at, text) {
            line.windows(2).for_each(|ends| self.stroke([ends[0], ends[1]], half));
        }
    }

    /// Draws a line in ink, `half` as far to each side, as dark as it covers pixels.
    fn stroke(&mut self, [a, b]: [[f64; 2]; 2], half: f64) {
        let reach = half + 1.0;
        let range = |k: usize| {
            let (low, high) = (a[k].min(b[k]) - reach, a[k].max(b[k]) + reach);
            let most = f64::from(self.size[k]);
            low.floor().clamp(0.0, most) as u32..high.ceil().clamp(0.0, most) as u32
        };
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let (columns, rows) = (range(0), range(1));
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let from = [f64::from(x) + 0.5 - a[0], f64::from(y) + 0.5 - a[1]];
            let t =
                if square > 0.0 { ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
            let aside = [from[0] - t * along[0], from[1] - t * along[1]];
            let distance = (aside[0] * aside[0] + aside[1] * aside[1]).sqrt();
            let cover = (half + 0.5 - distance).clamp(0.0, 1.0);
            let at = (y as usize * self.size[0] as usize + x as usize) * 3;
            for (part, ink) in self.pixels[at..at + 3].iter_mut().zip(INK) {
                let mixed = f64::from(255 - ink) * (1.0 - cover) + f64::from(ink);
                *part = (*part).min(mixed.round() as u8);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::decoded;

    fn sheet(size: [u32; 2], n: u32, marked: &[[u32; 2]]) -> ([u32; 2], Vec<[u8; 3]>) {
        let pictures: Vec<Vec<u32>> = (0..n).map(|k| vec![k; (size[0] * size[1]) as usize]).collect();
        let tile = |faces| SheetPicture { title: "zbuffer-f32-reversed", note: "7 wrong pixels", faces, marked };
        let tiles: Vec<SheetPicture<'_>> = pictures.iter().map(|faces| tile(faces.as_slice())).collect();
        decoded(&sheet_png(size, &tiles).unwrap())
    }

    #[test]
    fn sheets_show_every_picture_below_its_words() {
        let size = [130, 30];
        let (whole, pixels) = sheet(size, 11, &[]);
        assert_eq!(Some(whole), sheet_size(size, 11));
        let text = text_of(130);
        assert_eq!(whole, [4 * 138 + 8, 3 * (30 + head(text) + 8) + 16 + line_of(text)]);
        let count = |colour: [u8; 3]| pixels.iter().filter(|p| **p == colour).count();
        for k in 0..11 {
            assert_eq!(count(face_colour(k).map(|part| part / 2)), 130 * 30, "picture {k}");
        }
        // The legend's box is all that is marked; words are there, and do not touch pictures.
        assert_eq!(count(MARK), (text * text) as usize);
        let ink_in = |rows: std::ops::Range<u32>, columns: std::ops::Range<u32>| {
            let at = |x: u32, y: u32| pixels[(y * whole[0] + x) as usize];
            rows.flat_map(|y| columns.clone().map(move |x| (x, y))).filter(|&(x, y)| at(x, y)[0] < 128).count()
        };
        for k in 0..3u32 {
            let x = 8 + k * 138;
            assert!(ink_in(8..8 + line_of(text), x..x + 130) > 60, "title {k}");
            assert!(ink_in(8 + line_of(text)..8 + head(text), x..x + 130) > 40, "note {k}");
            assert_eq!(ink_in(8..8 + head(text), x + 131..x + 138), 0, "beside {k}");
        }
    }

    /// What is marked is seen within its rim.
    #[test]
    fn marks_do_not_hide_what_they_mark() {
        let block: Vec<[u32; 2]> = (5..15).flat_map(|y| (20..30).map(move |x| [x, y])).collect();
        let (_, pixels) = sheet([130, 30], 1, &[&block[..], &[[0, 0]]].concat());
        let count = |colour: [u8; 3]| pixels.iter().filter(|p| **p == colour).count();
        let legend = (text_of(130) * text_of(130)) as usize;
        assert_eq!(count(face_colour(0)), 64, "within the rim");
        assert_eq!(count(MARK) - legend, 36 + 1, "the rim, and a pixel alone");
        assert_eq!(count(face_colour(0).map(|part| part / 2)), 130 * 30 - 101);
    }

    #[test]
    fn sheets_that_cannot_be_counted_are_refused() {
        for (size, n) in [([0, 3], 2), ([3, 3], 0), ([u32::MAX, 1], 1), ([16_384, 16_384], 25), ([1, 1], usize::MAX)] {
            assert_eq!(sheet_size(size, n), None, "{size:?}, {n}");
        }
        assert!(sheet_size([1, 1], 1).is_some() && sheet_size([16_384, 16_384], 4).is_some());
        assert_eq!(sheet_png([4, 4], &[]).unwrap_err().to_string(), "a picture of 4 by 4 pixels cannot be rendered");
    }
}
