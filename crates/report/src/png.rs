//! SVG and pixels to PNG.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
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
    let image::DynamicImage::ImageRgb8(picture) =
        image::load_from_memory_with_format(png, image::ImageFormat::Png).ok()?
    else {
        return None;
    };
    let (width, height) = picture.dimensions();
    let mut paths: std::collections::BTreeMap<[u8; 3], String> = std::collections::BTreeMap::new();
    for (y, row) in picture.as_raw().chunks_exact(3 * width as usize).enumerate() {
        let (pixels, _) = row.as_chunks::<3>();
        let mut x = 0;
        for run in pixels.chunk_by(|a, b| a == b) {
            let _ = write!(paths.entry(run[0]).or_default(), "M{x} {y}h{0}v1h-{0}z", run.len());
            x += run.len();
        }
    }
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
    encode(size, pixels, kind, CompressionType::Fast)
}

/// The same in fewer bytes, and more slowly.
pub(crate) fn encode_small(size: [u32; 2], pixels: &[u8], kind: Pixels) -> Result<Vec<u8>, PngError> {
    encode(size, pixels, kind, CompressionType::Default)
}

fn encode(
    [width, height]: [u32; 2],
    pixels: &[u8],
    kind: Pixels,
    compression: CompressionType,
) -> Result<Vec<u8>, PngError> {
    if pixels.is_empty() {
        return Err(PngError::Size { width, height });
    }
    let colour = match kind {
        Pixels::Rgb => ExtendedColorType::Rgb8,
        Pixels::Rgba => ExtendedColorType::Rgba8,
        Pixels::Grey => ExtendedColorType::L8,
    };
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, compression, FilterType::Adaptive);
    let encoded = encoder.write_image(pixels, width, height, colour);
    encoded.map(|()| png).map_err(|error| PngError::Encode(error.into()))
}

/// Size and pixels of an RGB or grey picture, for tests.
#[cfg(test)]
pub(crate) fn decoded(png: &[u8]) -> ([u32; 2], Vec<[u8; 3]>) {
    let picture = image::load_from_memory_with_format(png, image::ImageFormat::Png).unwrap();
    assert!(matches!(picture, image::DynamicImage::ImageRgb8(_) | image::DynamicImage::ImageLuma8(_)), "{picture:?}");
    let pixels = picture.to_rgb8().pixels().map(|pixel| pixel.0).collect();
    ([picture.width(), picture.height()], pixels)
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
