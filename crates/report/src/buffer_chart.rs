//! A multifocal buffer as people look at it: upright, enlarged, with a title, its window and a scale of its values.

use crate::chart::{Paint, Svg};
use crate::frame::Px;
use crate::letters;
use crate::multifocal::{OPEN, grey};
use crate::png::{Pixels, encode_small};
use crate::{PngError, theme};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// The longer side of the buffer in the picture, in pixels, at least.
const SIZE: f64 = 720.0;
/// The height of a line of text.
const TEXT: f64 = 17.0;
const MARGIN: f64 = 20.0;
/// Steps of the scale.
const STEPS: u32 = 64;

/// A buffer and what is said of it.
#[derive(Debug, Clone, Copy)]
pub struct BufferChart<'a> {
    /// What stands above; letters, digits and signs of plain text.
    pub title: &'a str,
    /// What the values are, such as \"height above the plane\".
    pub values_are: &'a str,
    /// Texels along the two axes of the window.
    pub texels: [u32; 2],
    /// Row by row, the first axis first: 0 where nothing blocks, else 1 more than the height or distance in units.
    pub values: &'a [u32],
    /// The height or distance in units that is drawn white.
    pub white: u32,
    /// Scene units in one unit.
    pub unit: f64,
    /// The names of the axes of the window, such as `x` and `y`.
    pub axes: [char; 2],
    /// The window's lower and upper corner along these axes, in scene units.
    pub window: [[f64; 2]; 2],
    /// Whether the first axis points up in the picture, and not the second.
    pub is_first_up: bool,
    /// Whether the other axis points to the left, as for a viewer who looks at the plane.
    pub is_mirrored: bool,
}

/// Draws a buffer as SVG, with its pixels as PNG within.
///
/// # Errors
/// [`PngError`]
///
/// # Panics
/// If there are not as many values as texels.
pub fn buffer_chart_svg(chart: &BufferChart<'_>) -> Result<String, PngError> {
    let BufferChart { title, values_are, texels, values, white, unit, axes, window, is_first_up, is_mirrored } = *chart;
    assert_eq!(values.len(), texels[0] as usize * texels[1] as usize, "one value for each texel");
    let colour = |value: u32| match value.checked_sub(1) {
        None => OPEN,
        Some(value) => [grey(f64::from(value), f64::from(white)); 3],
    };
    // The axis to the side, and the one that points up.
    let [side, up] = if is_first_up { [1, 0] } else { [0, 1] };
    let (wide, high) = (texels[side], texels[up]);
    let value = |x: u32, y: u32| {
        let mut place = [0; 2];
        place[side] = if is_mirrored { wide - 1 - x } else { x };
        place[up] = high - 1 - y;
        values[(place[1] * texels[0] + place[0]) as usize]
    };
    let pixels: Vec<u8> =
        (0..high).flat_map(|y| (0..wide).map(move |x| (x, y))).flat_map(|(x, y)| colour(value(x, y))).collect();
    let png = encode_small([wide, high], &pixels, Pixels::Rgb)?;
    // As wide and high as the window is, in whole pixels.
    let extent = |k: usize| window[1][k] - window[0][k];
    let scale = SIZE / extent(side).max(extent(up));
    let [w, h] = [side, up].map(|k| (extent(k) * scale).round().max(1.0));
    let [left, top] = [MARGIN + 5.0 * TEXT, MARGIN + 2.5 * TEXT];
    let whole = (left + w).max(480.0) + MARGIN;
    let total = top + h + 7.5 * TEXT;
    let mut out = Svg::of_lines([whole.ceil(), total.ceil()], title).on_paper();
    let most = whole - 2.0 * MARGIN;
    let large = (1.2 * TEXT).min(1.2 * TEXT * most / letters::width(title, 1.2 * TEXT).max(1.0));
    out.letters([MARGIN, MARGIN + TEXT], large, title);
    out.push(format_args!(
        "<image x=\"{}\" y=\"{}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" image-rendering=\"pixelated\" \
         href=\"data:image/png;base64,{}\"/>",
        Px(left),
        Px(top),
        STANDARD.encode(png)
    ));
    let outline = Paint::stroke(theme::INK, 1.0);
    out.rect([left, top], [w, h], outline);
    // The window: the ends of both axes.
    let [low, high] = [side, up].map(|k| window.map(|corner| corner[k])).map(|ends| ends.map(number));
    let (first, last) = if is_mirrored { (&low[1], &low[0]) } else { (&low[0], &low[1]) };
    let below = top + h + 1.3 * TEXT;
    out.letters([left, below], TEXT, first);
    out.letters([left + w - letters::width(last, TEXT), below], TEXT, last);
    let name = axes[side].to_string();
    out.letters([left + 0.5 * w, below], TEXT, &name);
    for (text, y) in [(&high[1], top + TEXT), (&high[0], top + h), (&axes[up].to_string(), top + 0.5 * h)] {
        out.letters([left - 0.5 * TEXT - letters::width(text, TEXT), y], TEXT, text);
    }
    // The scale of values, and what nothing blocks.
    let (y, bar) = (below + 1.2 * TEXT, 0.45 * w.max(300.0));
    for step in 0..STEPS {
        let shade = grey(f64::from(step), f64::from(STEPS - 1));
        // Each reaches to the end of the scale, below the next one, so that no seams show.
        let along = bar * f64::from(step) / f64::from(STEPS);
        let (x, step_wide) = (left + along, bar - along);
        out.push(format_args!(
            "<rect class=\"scale\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{TEXT}\" fill=\"#{shade:02x}{shade:02x}{shade:02x}\"/>",
            Px(x),
            Px(y),
            Px(step_wide)
        ));
    }
    out.rect([left, y], [bar, TEXT], outline);
    let end = number(f64::from(white) * unit);
    out.letters([left, y + 2.3 * TEXT], TEXT, "0");
    out.letters([left + bar - 0.5 * letters::width(&end, TEXT), y + 2.3 * TEXT], TEXT, &end);
    out.letters([left + 1.5 * TEXT, y + 2.3 * TEXT], fitting(values_are, bar - 4.0 * TEXT), values_are);
    let [r, g, b] = OPEN;
    let legend = y + 3.2 * TEXT;
    out.rect([left, legend], [TEXT; 2], Paint::fill(&format!("#{r:02x}{g:02x}{b:02x}")));
    out.letters([left + 1.6 * TEXT, legend + 0.85 * TEXT], TEXT, "nothing is known to block");
    Ok(out.end())
}

/// The height of a text that is at most so wide.
fn fitting(text: &str, most: f64) -> f64 {
    TEXT.min(TEXT * most / letters::width(text, TEXT).max(1.0))
}

/// A number of four digits.
pub(crate) fn number(x: f64) -> String {
    format!("{x:.3e}").parse().map_or_else(|_| x.to_string(), |rounded: f64| rounded.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(values: &[u32]) -> BufferChart<'_> {
        BufferChart {
            title: "A buffer",
            values_are: "height",
            texels: [3, 2],
            values,
            white: 100,
            unit: 0.5,
            axes: ['x', 'y'],
            window: [[-3.0, 0.0], [3.0, 4.0]],
            is_first_up: false,
            is_mirrored: false,
        }
    }

    /// The pixels within, from the upper left corner.
    fn pixels(svg: &str) -> ([u32; 2], Vec<[u8; 3]>) {
        let data = svg.split("base64,").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
        crate::png::decoded(&STANDARD.decode(data).unwrap())
    }

    #[test]
    fn axes_point_up_as_asked() {
        let values = [0, 1, 51, 101, 101, 0];
        let svg = |chart: &BufferChart<'_>| buffer_chart_svg(chart).unwrap();
        let [open, black, middle, white] = [OPEN, [0; 3], [128; 3], [255; 3]];
        let upright = chart(&values);
        assert_eq!(pixels(&svg(&upright)), ([3, 2], vec![white, white, open, open, black, middle]));
        let mirrored = BufferChart { is_mirrored: true, ..upright };
        assert_eq!(pixels(&svg(&mirrored)), ([3, 2], vec![open, white, white, middle, black, open]));
        let turned = BufferChart { is_first_up: true, ..upright };
        assert_eq!(pixels(&svg(&turned)), ([2, 3], vec![middle, open, black, white, open, white]));
    }

    #[test]
    fn the_scale_has_its_numbers_and_all_is_within_the_frame() {
        let svg = buffer_chart_svg(&chart(&[0, 1, 51, 101, 101, 0])).unwrap();
        let titles: Vec<&str> = svg.split("<title>").skip(1).filter_map(|text| text.split("</title>").next()).collect();
        for text in ["A buffer", "-3", "3", "0", "4", "x", "y", "50", "height", "nothing is known to block"] {
            assert!(titles.contains(&text), "{text}: {titles:?}");
        }
        assert_eq!(svg.matches("class=\"scale\"").count(), STEPS as usize);
        let number =
            |attribute: &str| svg.split(attribute).nth(1).and_then(|rest| rest.split('"').next()?.parse::<f64>().ok());
        let (wide, high) = (number(" width=\"").unwrap(), number(" height=\"").unwrap());
        let mut n = 0;
        for path in svg.split("<path d=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            for point in path.split(['M', 'L']).skip(1) {
                let (x, y) = point.split_once(' ').unwrap();
                let [x, y]: [f64; 2] = [x, y].map(|x| x.parse().unwrap());
                assert!((0.0..=wide).contains(&x) && (0.0..=high).contains(&y), "{point}");
                n += 1;
            }
        }
        assert!(n > 100, "{n}");
    }
}
