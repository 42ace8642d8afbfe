//! SVG and pixels to PNG.

use png::{BitDepth, ColorType, Compression, Encoder, Filter};
#[cfg(feature = "png")]
use resvg::{tiny_skia, usvg};

/// Why a picture could not be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The text is not SVG.
    #[error("the picture is not valid SVG")]
    Svg(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// The picture has no area, or more than fits into memory.
    #[error("a picture of {width} by {height} pixels cannot be rendered")]
    Size {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
    /// The encoder failed.
    #[error("the picture cannot be encoded as PNG")]
    Encode(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// Renders a picture in its own size. Text is left out: no fonts are loaded.
///
/// Four bytes of memory for each pixel.
///
/// # Errors
/// [`PngError`].
#[cfg(feature = "png")]
pub fn svg_to_png(svg: &str) -> Result<Vec<u8>, PngError> {
    let mut options = usvg::Options::default();
    options.image_href_resolver.resolve_data = Box::new(|_, data, _| embedded(&data));
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| PngError::Svg(e.into()))?;
    let size = tree.size().to_int_size();
    let (width, height) = (size.width(), size.height());
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(PngError::Size { width, height })?;
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| PngError::Encode(e.into()))
}

/// A picture in PNG of three bytes a pixel within one in SVG, as rectangles, since the renderer decodes no pixels: each as wide as a
/// colour stays the same.
#[cfg(feature = "png")]
fn embedded(png: &[u8]) -> Option<usvg::ImageKind> {
    use std::fmt::Write;
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().ok()?;
    let mut bytes = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut bytes).ok()?;
    if info.color_type != ColorType::Rgb || info.bit_depth != BitDepth::Eight {
        return None;
    }
    let mut paths: std::collections::BTreeMap<[u8; 3], String> = std::collections::BTreeMap::new();
    for (y, row) in bytes.chunks_exact(3 * info.width as usize).enumerate() {
        let (pixels, _) = row.as_chunks::<3>();
        let mut x = 0;
        for run in pixels.chunk_by(|a, b| a == b) {
            let _ = write!(paths.entry(run[0]).or_default(), "M{x} {y}h{0}v1h-{0}z", run.len());
            x += run.len();
        }
    }
    let (width, height) = (info.width, info.height);
    let mut svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\">");
    for ([r, g, b], path) in paths {
        let _ = write!(svg, "<path shape-rendering=\"crispEdges\" fill=\"#{r:02x}{g:02x}{b:02x}\" d=\"{path}\"/>");
    }
    svg.push_str("</svg>");
    usvg::Tree::from_str(&svg, &usvg::Options::default()).ok().map(usvg::ImageKind::SVG)
}

/// The pixels that are encoded: eight bits for each channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pixels {
    Rgb,
    /// With the share that is covered, of colours that are not multiplied by it.
    Rgba,
    Grey,
}

/// Encodes pixels, row by row from the upper left corner.
pub(crate) fn encode_pixels(size: [u32; 2], pixels: &[u8], kind: Pixels) -> Result<Vec<u8>, PngError> {
    encode(size, pixels, kind, Compression::Fast)
}

/// The same in fewer bytes, and more slowly.
pub(crate) fn encode_small(size: [u32; 2], pixels: &[u8], kind: Pixels) -> Result<Vec<u8>, PngError> {
    encode(size, pixels, kind, Compression::Balanced)
}

fn encode(
    [width, height]: [u32; 2],
    pixels: &[u8],
    kind: Pixels,
    compression: Compression,
) -> Result<Vec<u8>, PngError> {
    if pixels.is_empty() {
        return Err(PngError::Size { width, height });
    }
    let mut png = Vec::new();
    let mut encoder = Encoder::new(&mut png, width, height);
    encoder.set_color(match kind {
        Pixels::Rgb => ColorType::Rgb,
        Pixels::Rgba => ColorType::Rgba,
        Pixels::Grey => ColorType::Grayscale,
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.set_filter(Filter::Adaptive);
    let encoded = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    encoded.map(|()| png).map_err(|error| PngError::Encode(error.into()))
}

/// Size and pixels of an RGB or grey picture, for tests.
#[cfg(test)]
pub(crate) fn decoded(png: &[u8]) -> ([u32; 2], Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.bit_depth, BitDepth::Eight);
    let pixels = match info.color_type {
        ColorType::Rgb => bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(),
        ColorType::Grayscale => bytes.iter().map(|&grey| [grey; 3]).collect(),
        other => panic!("{other:?}"),
    };
    ([info.width, info.height], pixels)
}

#[cfg(all(test, feature = "png"))]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_rendered_in_their_size() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="7" height="5"><rect width="7" height="5" fill="#ff0000"/></svg>"##;
        let png = svg_to_png(svg).unwrap();
        let pixels = tiny_skia::Pixmap::decode_png(&png).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (7, 5));
        let red = |p: &tiny_skia::PremultipliedColorU8| (p.red(), p.green(), p.blue()) == (255, 0, 0);
        assert!(pixels.pixels().iter().all(red));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert!(matches!(svg_to_png("hello"), Err(PngError::Svg(_))));
    }
}
