//! Pictures of multifocal buffers and of the fields beside them, one pixel for each texel.
//!
//! The first axis of the window points to the right and the second up, so the first row of texels is the lowest of the
//! picture.

use crate::PngError;
use crate::png::{Pixels, encode_pixels};

/// The colour of texels that nothing is known to block: no grey, so that it is not mistaken for a value.
pub const OPEN: [u8; 3] = [24, 48, 160];

/// A multifocal buffer as an RGB picture: [`OPEN`] where nothing is known to block, else grey, from black for what is
/// blocked at the plane itself to white for `white`, a value that none exceeds.
///
/// * `texels`: how many along the two axes of the window
/// * `values`: row by row, 0 where nothing blocks, else 1 more than the height or distance in units
/// * `white`: the height or distance, in units, that is drawn white; all is black if it is 0
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many values as texels.
pub fn buffer_png(texels: [u32; 2], values: &[u32], white: u32) -> Result<Vec<u8>, PngError> {
    encode(texels, values, Pixels::Rgb, |&value| match value.checked_sub(1) {
        None => OPEN,
        Some(value) => [grey(f64::from(value), f64::from(white)); 3],
    })
}

/// A map of what is nearest as an RGB picture, in a colour for each id: dark for vertices, bright for edges, pale
/// for faces; black for nothing.
///
/// Colours of 24 bits can be alike by chance; those of ids that follow each other are not.
///
/// * `texels`: how many along the two axes of the window
/// * `features`: row by row, the id of the nearest feature
/// * `first_edge`, `first_face`: the lowest ids that are edges and faces; what is lower than both is a vertex
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many features as texels.
pub fn voronoi_png(
    texels: [u32; 2],
    features: &[Option<u32>],
    first_edge: u32,
    first_face: u32,
) -> Result<Vec<u8>, PngError> {
    encode(texels, features, Pixels::Rgb, |feature| match *feature {
        None => [0; 3],
        Some(id) if id >= first_face => colour(id, 150, 105),
        Some(id) if id >= first_edge => colour(id, 40, 180),
        Some(id) => colour(id, 0, 120),
    })
}

/// A field of distances as a grey picture: black for 0, white for `white` and more.
///
/// * `texels`: how many along the two axes of the window
/// * `distances`: row by row, in scene units, not negative
/// * `white`: in scene units; all is black if it is 0
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many distances as texels.
pub fn distance_png(texels: [u32; 2], distances: &[f64], white: f64) -> Result<Vec<u8>, PngError> {
    encode(texels, distances, Pixels::Grey, |&distance| [grey(distance, white)])
}

/// From 0 to 255, as `value` is from 0 to `white`.
pub(crate) fn grey(value: f64, white: f64) -> u8 {
    // What is no number becomes 0, and what is more than white is white.
    if white > 0.0 { (value / white * 255.0).round() as u8 } else { 0 }
}

/// A colour of an id: its hue goes round by the golden ratio, so that ids near each other differ most. `base` is the
/// least of each part, `span` what the hue adds to it.
fn colour(id: u32, base: u8, span: u8) -> [u8; 3] {
    let hue = id.wrapping_mul(0x9E37_79B9);
    // Six ramps of 2^29.4 steps each: the sixth, and the place on it from 0 to 255.
    let turn = u64::from(hue) * 6;
    let (sixth, along) = (turn >> 32, (turn >> 24) & 0xFF);
    let (up, down) = (along, 255 - along);
    let parts = match sixth {
        0 => [255, up, 0],
        1 => [down, 255, 0],
        2 => [0, 255, up],
        3 => [0, down, 255],
        4 => [up, 0, 255],
        _ => [255, 0, down],
    };
    parts.map(|part| base + u8::try_from(part * u64::from(span) / 255).expect("at most the span"))
}

/// Encodes pixels, the first row lowest.
fn encode<T, const N: usize>(
    [width, height]: [u32; 2],
    items: &[T],
    kind: Pixels,
    pixel: impl Fn(&T) -> [u8; N],
) -> Result<Vec<u8>, PngError> {
    assert_eq!(items.len(), width as usize * height as usize, "one item for each texel");
    // Without texels there are no rows, and the encoder says so.
    let rows = items.chunks_exact((width as usize).max(1)).rev();
    let pixels: Vec<u8> = rows.flatten().flat_map(pixel).collect();
    encode_pixels([width, height], &pixels, kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::decoded;
    use std::collections::BTreeSet;

    #[test]
    fn what_nothing_blocks_is_not_what_is_blocked_at_the_plane() {
        let png = buffer_png([3, 2], &[0, 1, 51, 101, 1000, 0], 100).unwrap();
        let (size, pixels) = decoded(&png);
        assert_eq!(size, [3, 2]);
        // The second row is the upper one.
        assert_eq!(pixels, [[255; 3], [255; 3], OPEN, OPEN, [0; 3], [128; 3]]);
        let (_, flat) = decoded(&buffer_png([2, 1], &[1, 0], 0).unwrap());
        assert_eq!(flat, [[0; 3], OPEN]);
    }

    #[test]
    fn distances_are_grey() {
        let (size, pixels) = decoded(&distance_png([1, 4], &[0.0, 1.0, 2.0, f64::NAN], 2.0).unwrap());
        assert_eq!((size, pixels), ([1, 4], vec![[0; 3], [255; 3], [128; 3], [0; 3]]));
        assert_eq!(decoded(&distance_png([1, 1], &[0.0], 0.0).unwrap()).1, [[0; 3]]);
    }

    #[test]
    fn features_have_colours_of_their_own() {
        let ids: Vec<Option<u32>> = (0..300).map(Some).collect();
        let (_, pixels) = decoded(&voronoi_png([300, 1], &ids, 100, 200).unwrap());
        assert_eq!(pixels.iter().collect::<BTreeSet<_>>().len(), 300);
        let far = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap() >= 24;
        assert!(pixels.windows(2).all(|pair| far(&pair[0], &pair[1])));
        let brightest = |range: std::ops::Range<usize>| pixels[range].iter().flatten().copied().max().unwrap();
        let darkest = |range: std::ops::Range<usize>| pixels[range].iter().flatten().copied().min().unwrap();
        assert!(brightest(0..100) <= 120 && darkest(100..200) >= 40 && darkest(200..300) >= 150);
        assert_eq!(decoded(&voronoi_png([1, 1], &[None], 0, 0).unwrap()).1, [[0; 3]]);
    }

    #[test]
    fn pictures_without_pixels_are_refused() {
        let error = buffer_png([0, 4], &[], 1).unwrap_err().to_string();
        assert_eq!(error, "a picture of 0 by 4 pixels cannot be rendered");
    }
}
