//! Pictures that the program wrote.

use png::{BitDepth, ColorType, Decoder};

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
        let mut reader = Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a picture that fits into memory")];
        let info = reader.next_frame(&mut bytes).expect("a picture");
        assert_eq!(info.bit_depth, BitDepth::Eight);
        let pixels = match info.color_type {
            ColorType::Rgb => bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(),
            ColorType::Rgba => bytes.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(),
            ColorType::Grayscale => bytes.iter().map(|&grey| [grey; 3]).collect(),
            other => panic!("{other:?}"),
        };
        Self { size: [info.width, info.height], pixels }
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
