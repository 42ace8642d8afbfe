//! Pictures of soft shadows.
//!
//! Pixels count row by row from the upper left corner.

use crate::PngError;
use crate::faces::NOWHERE;
use crate::png::{Pixels, encode_pixels};

/// The colour of what is wholly in umbra.
pub const UMBRA: [u8; 3] = [28, 36, 96];
/// The colour of what is wholly lit.
pub const LIT: [u8; 3] = [255, 244, 196];
/// The colours of what is in doubt, where no light arrives and where all does: reds, which no other pixel has.
const DOUBT: [[u8; 3]; 2] = [[96, 0, 16], [255, 128, 112]];

/// How a pixel is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightPixel {
    /// Nothing is seen there.
    Nothing,
    /// Wholly in umbra, for certain.
    Umbra,
    /// Wholly lit, for certain.
    Lit,
    /// In doubt: the share of the light that arrives, from 0 to 1, as it was estimated. What is below or no number counts as 0, what is
    /// above as 1.
    Doubt(f64),
}

impl LightPixel {
    /// The colour of the proven state: [`UMBRA`], [`LIT`], reds in doubt, [`NOWHERE`].
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::Nothing => NOWHERE,
            Self::Umbra => UMBRA,
            Self::Lit => LIT,
            Self::Doubt(share) => {
                let [none, all] = DOUBT;
                std::array::from_fn(|k| between(none[k], all[k], share))
            }
        }
    }

    /// The grey that the light makes: black in umbra, white where lit; [`NOWHERE`] where nothing is seen.
    pub fn grey(self) -> [u8; 3] {
        match self {
            Self::Nothing => NOWHERE,
            Self::Umbra => [0; 3],
            Self::Lit => [255; 3],
            Self::Doubt(share) => [between(0, 255, share); 3],
        }
    }
}

/// From one value to another, which is not less, as `share` is from 0 to 1.
fn between(from: u8, to: u8, share: f64) -> u8 {
    // What is no number becomes 0.
    let part = f64::from(to.abs_diff(from)) * share.clamp(0.0, 1.0);
    from.saturating_add(part.round() as u8)
}

/// How each pixel is lit, as an RGB picture.
///
/// * `size`: pixels to the right and down
/// * `pixels`: row by row from the upper left corner
/// * `is_grey`: the light alone, by [`LightPixel::grey`]; else what is certain, by [`LightPixel::colour`]
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many pixels as the size says.
pub fn light_png(size: [u32; 2], pixels: &[LightPixel], is_grey: bool) -> Result<Vec<u8>, PngError> {
    assert_eq!(pixels.len(), size[0] as usize * size[1] as usize, "one value for each pixel");
    let colour = |pixel: &LightPixel| if is_grey { pixel.grey() } else { pixel.colour() };
    let colours: Vec<u8> = pixels.iter().flat_map(colour).collect();
    encode_pixels(size, &colours, Pixels::Rgb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::decoded;
    use LightPixel::{Doubt, Lit, Nothing, Umbra};

    #[test]
    fn pixels_have_the_colours_of_their_light() {
        let pixels = [Umbra, Lit, Nothing, Doubt(0.0), Doubt(0.5), Doubt(1.0)];
        let (size, colours) = decoded(&light_png([3, 2], &pixels, false).unwrap());
        assert_eq!((size, &colours[..4]), ([3, 2], &[UMBRA, LIT, NOWHERE, [96, 0, 16]][..]));
        assert_eq!(colours[4..], [[176, 64, 64], [255, 128, 112]]);
        let (_, greys) = decoded(&light_png([3, 2], &pixels, true).unwrap());
        assert_eq!(greys, [[0; 3], [255; 3], NOWHERE, [0; 3], [128; 3], [255; 3]]);
    }

    #[test]
    fn shares_of_any_kind_have_a_colour() {
        let grey = |share: f64| Doubt(share).grey()[0];
        assert_eq!([grey(f64::NAN), grey(-3.0), grey(7.0), grey(f64::INFINITY)], [0, 0, 255, 255]);
        let error = light_png([0, 3], &[], false).unwrap_err().to_string();
        assert_eq!(error, "a picture of 0 by 3 pixels cannot be rendered");
    }
}
