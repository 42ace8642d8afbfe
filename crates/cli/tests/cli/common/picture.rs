//! Pictures that the program wrote.

use image::{DynamicImage, ImageFormat};

/// How the names of pictures of tables end, in the richest kind that this build of the program writes.
pub(crate) const DRAWN: &str = if cfg!(feature = "png") { "png" } else { "svg" };

/// How a picture of a table begins in that kind.
pub(crate) fn is_drawn(bytes: &[u8]) -> bool {
    bytes.starts_with(if cfg!(feature = "png") { b"\x89PNG" } else { b"<svg" })
}

/// A decoded PNG: its size, and its pixels from the upper left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    pub(crate) size: [u32; 2],
    pub(crate) pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// The picture in an RGB, RGBA or grey PNG of eight bits.
    pub(crate) fn decode(png: &[u8]) -> Self {
        let picture = image::load_from_memory_with_format(png, ImageFormat::Png).expect("a PNG");
        assert!(
            matches!(picture, DynamicImage::ImageRgb8(_) | DynamicImage::ImageRgba8(_) | DynamicImage::ImageLuma8(_)),
            "{:?}",
            picture.color()
        );
        let size = [picture.width(), picture.height()];
        Self { size, pixels: picture.to_rgb8().pixels().map(|pixel| pixel.0).collect() }
    }

    /// How many pixels differ from those of another picture; all, if the size does.
    pub(crate) fn differs(&self, other: &Self) -> usize {
        let differ = self.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
        if self.size == other.size { differ } else { self.pixels.len() }
    }

    /// How many pixels have a colour.
    pub(crate) fn count(&self, colour: [u8; 3]) -> usize {
        self.pixels.iter().filter(|p| **p == colour).count()
    }
}
