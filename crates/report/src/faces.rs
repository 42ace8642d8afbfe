//! Pictures of which face is seen in each pixel, alone and side by side.
//!
//! Pixels count row by row from the upper left corner.

use crate::PngError;
use crate::png::{Pixels, encode_pixels};

/// What a pixel shows where nothing is seen: an id that no face has.
pub const NO_FACE: u32 = u32::MAX;
/// The colour of [`NO_FACE`]; no face has it.
pub const NOWHERE: [u8; 3] = [16, 18, 24];
/// The colour of marked pixels in a sheet; no face has it.
pub const MARK: [u8; 3] = [255, 0, 255];

/// Values of a part of a face's colour, from [`DARKEST`] up; what is darker is left for what is no face.
const LEVELS: u64 = 224;
const DARKEST: u8 = 32;
/// All colours of faces by the golden ratio, without a divisor in common with them, so that each is met once; those of ids near
/// each other differ most.
const STEP: u64 = 6_946_347;

/// What is around the pictures of a sheet.
const MARGIN: u32 = 8;
/// Pixels along a side of a dot of a digit, and its dots to the right and down.
const DOT: u32 = 3;
const DIGIT: [u32; 2] = [3, 5];
const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];
/// The dots of the digits, three bits a row, the upper left one highest.
const DIGITS: [u16; 10] = [
    0b111_101_101_101_111,
    0b010_110_010_010_111,
    0b111_001_111_100_111,
    0b111_001_111_001_111,
    0b101_101_111_001_001,
    0b111_100_111_001_111,
    0b111_100_111_101_111,
    0b111_001_001_001_001,
    0b111_101_111_101_111,
    0b111_101_111_001_111,
];

/// The colour of a face. Two faces have the same only if their ids differ by a multiple of 11,239,424.
pub fn face_colour(face: u32) -> [u8; 3] {
    if face == NO_FACE {
        return NOWHERE;
    }
    let n = u64::from(face) * STEP % (LEVELS * LEVELS * LEVELS);
    [n / (LEVELS * LEVELS), n / LEVELS % LEVELS, n % LEVELS]
        .map(|part| DARKEST + u8::try_from(part).expect("fewer levels than bytes"))
}

/// Which face is seen in each pixel, as an RGB picture in the colours of [`face_colour`].
///
/// * `size`: pixels to the right and down
/// * `faces`: row by row from the upper left corner; [`NO_FACE`] where nothing is seen
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many faces as pixels.
pub fn faces_png(size: [u32; 2], faces: &[u32]) -> Result<Vec<u8>, PngError> {
    assert_eq!(faces.len(), size[0] as usize * size[1] as usize, "one face for each pixel");
    let pixels: Vec<u8> = faces.iter().flat_map(|&face| face_colour(face)).collect();
    encode_pixels(size, &pixels, Pixels::Rgb)
}

/// One of the pictures of a sheet.
#[derive(Debug, Clone, Copy)]
pub struct SheetPicture<'a> {
    /// Row by row from the upper left corner; [`NO_FACE`] where nothing is seen.
    pub faces: &'a [u32],
    /// The pixels that are drawn in the colour [`MARK`], to the right and down.
    pub marked: &'a [[u32; 2]],
}

/// Pictures of one size side by side, with their numbers above them, from 1 on: row by row in about a square. Faces have half of
/// the light of their colours, so that what is marked is seen.
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
    let [tile_width, tile_height] = tile(size, pictures.len());
    let n_across = across(pictures.len()) as usize;
    for (k, picture) in pictures.iter().enumerate() {
        let x = MARGIN + (k % n_across) as u32 * tile_width;
        let y = MARGIN + (k / n_across) as u32 * tile_height;
        sheet.number(k + 1, [x, y]);
        sheet.picture(size, picture, [x, y + DIGIT[1] * DOT + MARGIN / 2]);
    }
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
    let [width, height] = tile(size, n);
    let whole = [width.checked_mul(across)?.checked_add(MARGIN)?, height.checked_mul(n_32.div_ceil(across))?];
    let whole = [whole[0], whole[1].checked_add(MARGIN)?];
    whole[0].checked_mul(whole[1]).map(|_| whole)
}

/// How many pictures are side by side.
fn across(n: usize) -> u32 {
    (1u32..).find(|&k| k as usize * k as usize >= n).expect("a number has a root")
}

/// Pixels that a picture takes with its number, which may be the wider one, and a margin.
fn tile([width, height]: [u32; 2], n: usize) -> [u32; 2] {
    let n_digits = n.to_string().len() as u32;
    [width.max(n_digits * (DIGIT[0] + 1) * DOT) + MARGIN, height + DIGIT[1] * DOT + MARGIN / 2 + MARGIN]
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
        for (y, row) in (y0..).zip(picture.faces.chunks_exact(width as usize)) {
            for (x, &face) in (x0..).zip(row) {
                self.set([x, y], face_colour(face).map(|part| part / 2));
            }
        }
        for &[x, y] in picture.marked {
            assert!(x < width && y < height, "a picture of {width} by {height} pixels marks ({x}, {y})");
            self.set([x0 + x, y0 + y], MARK);
        }
    }

    /// Draws a number, `at` its upper left corner.
    fn number(&mut self, n: usize, at: [u32; 2]) {
        for (k, letter) in (0u32..).zip(n.to_string().bytes()) {
            let dots = DIGITS[usize::from(letter - b'0')];
            let [width, height] = DIGIT;
            for i in (0..width * height).filter(|i| dots >> (width * height - 1 - i) & 1 == 1) {
                let x = at[0] + (k * (width + 1) + i % width) * DOT;
                let y = at[1] + i / width * DOT;
                (0..DOT * DOT).for_each(|j| self.set([x + j % DOT, y + j / DOT], INK));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::decoded;
    use std::collections::BTreeSet;

    #[test]
    fn faces_have_colours_of_their_own() {
        let n = 300_000;
        let colours: BTreeSet<[u8; 3]> = (0..n).map(face_colour).collect();
        assert_eq!(colours.len(), n as usize);
        assert!(colours.iter().flatten().all(|&part| part >= DARKEST));
        // The step has no divisor in common with the number of colours, 2^15 * 7^3; so they all come before one comes again.
        assert!(!STEP.is_multiple_of(2) && !STEP.is_multiple_of(7));
        let n_colours = (LEVELS * LEVELS * LEVELS) as u32;
        assert_eq!((n_colours, face_colour(n_colours + 5)), (11_239_424, face_colour(5)));
        let far = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap() >= 48;
        assert!((0..1000).all(|id| far(face_colour(id), face_colour(id + 1))));
        for other in [NOWHERE, MARK] {
            assert!(other.iter().any(|&part| part < DARKEST));
        }
    }

    #[test]
    fn pictures_begin_at_the_upper_left() {
        let faces = [0, 1, 2, NO_FACE, 4_000_000_000, 5];
        let (size, pixels) = decoded(&faces_png([3, 2], &faces).unwrap());
        assert_eq!((size, pixels), ([3, 2], faces.map(face_colour).to_vec()));
        let error = faces_png([0, 4], &[]).unwrap_err().to_string();
        assert_eq!(error, "a picture of 0 by 4 pixels cannot be rendered");
    }

    #[test]
    fn sheets_show_every_picture_with_its_number() {
        let size = [40, 30];
        let pictures: Vec<Vec<u32>> = (0..11).map(|k| vec![k; 1200]).collect();
        let marked = [[3, 4], [39, 29]];
        let tiles: Vec<SheetPicture<'_>> =
            pictures.iter().map(|faces| SheetPicture { faces, marked: &marked }).collect();
        let (whole, pixels) = decoded(&sheet_png(size, &tiles).unwrap());
        assert_eq!(whole, [4 * 48 + 8, 3 * 57 + 8]);
        assert_eq!(Some(whole), sheet_size(size, 11));
        let count = |colour: [u8; 3]| pixels.iter().filter(|p| **p == colour).count();
        for k in 0..11 {
            assert_eq!(count(face_colour(k).map(|part| part / 2)), 1198, "picture {k}");
        }
        assert_eq!(count(MARK), 22);
        // The ninth is the first of the third row; its number is above it.
        let at = |x: usize, y: usize| pixels[y * whole[0] as usize + x];
        let dots = |x: usize, y: usize| {
            (0..15).map(|i| at(x + i % 3 * 3 + 1, y + i / 3 * 3 + 1) == INK).fold(0, |n, d| n * 2 + u16::from(d))
        };
        assert_eq!(
            [dots(8, 8 + 2 * 57), dots(8 + 2 * 48, 8 + 2 * 57), dots(8 + 2 * 48 + 12, 8 + 2 * 57)],
            [DIGITS[9], DIGITS[1], DIGITS[1]]
        );
        assert_eq!(at(8 + 3, 8 + 2 * 57 + 19 + 4), MARK);
        assert_eq!(at(8 + 4, 8 + 2 * 57 + 19 + 4), face_colour(8).map(|part| part / 2));
    }

    #[test]
    fn sheets_that_cannot_be_counted_are_refused() {
        for (size, n) in [([0, 3], 2), ([3, 3], 0), ([u32::MAX, 1], 1), ([16_384, 16_384], 25), ([1, 1], usize::MAX)] {
            assert_eq!(sheet_size(size, n), None, "{size:?}, {n}");
        }
        assert!(sheet_size([1, 1], 1).is_some() && sheet_size([16_384, 16_384], 4).is_some());
        assert_eq!(sheet_png([4, 4], &[]).unwrap_err().to_string(), "a picture of 4 by 4 pixels cannot be rendered");
    }

    #[test]
    fn every_digit_is_another() {
        assert_eq!(DIGITS.iter().collect::<BTreeSet<_>>().len(), 10);
    }
}
