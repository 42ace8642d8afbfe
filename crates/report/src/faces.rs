//! Pictures of which face is seen in each pixel.
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
}
