//! A chart of a walk: what each method leaves to draw, and what it costs.

use crate::chart::{Paint, Scale, Svg, Words, power_of_ten};
use crate::theme;

/// What a method leaves to draw, and costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkBar<'a> {
    /// What it is called.
    pub name: &'a str,
    /// The shares of all cells, objects and polygons that are left, from 0 to 1.
    pub shares: [f64; 3],
    /// The median time of a frame in microseconds.
    pub median_us: f64,
    /// The time that 99 of 100 frames do not exceed, in microseconds.
    pub p99_us: f64,
}

/// What the three bars of a method are.
const KINDS: [(&str, &str); 3] = [("cells", theme::SEEN), ("objects", theme::FROM), ("polygons", theme::OBJECT)];
/// Where bars begin, and how wide the two parts of the chart are, in pixels.
const LEFT: f64 = 150.0;
const WIDTH: f64 = 330.0;
const GAP: f64 = 70.0;
const TOP: f64 = 64.0;
/// The height of a method.
const ROW: f64 = 46.0;
/// The smallest share that has a bar.
const LEAST_SHARE: f64 = 1e-4;

/// Draws shares as bars and times as lines from the median to the 99th percentile, both on logarithmic scales, as
/// shares and times of methods differ by orders of magnitude. Numbers that are not finite count as 0.
///
/// Unlike the other pictures it has text, in whatever font the viewer has: it is for people, as SVG.
pub fn walk_svg(title: &str, bars: &[WalkBar<'_>]) -> String {
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    let least_share = bars.iter().flat_map(|bar| bar.shares).map(finite).filter(|x| *x > 0.0).fold(1.0, f64::min);
    let shares = Scale::decades([least_share.clamp(LEAST_SHARE, 1.0), 1.0], [LEFT, LEFT + WIDTH]);
    let times = || bars.iter().flat_map(|bar| [bar.median_us, bar.p99_us]).map(finite).filter(|x| *x > 0.0);
    let (least, most) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    // Without any times there is still an axis.
    let range = if least <= most { [least, most] } else { [1.0, 10.0] };
    let left = LEFT + WIDTH + GAP;
    let times = Scale::decades(range, [left, left + WIDTH]);

    let bottom = TOP + ROW * bars.len() as f64;
    let [width, height] = [LEFT + 2.0 * WIDTH + GAP + 30.0, bottom + 34.0];
    let mut svg = Svg::new([width, height], title, 11.0);
    svg.text([10.0, 20.0], Words::START, title);
    svg.text([LEFT, TOP - 10.0], Words::START, "left to draw, share of all:");
    for (k, (kind, colour)) in KINDS.iter().enumerate() {
        let x = LEFT + 145.0 + 60.0 * k as f64;
        svg.rect([x, TOP - 18.0], [9.0, 9.0], Paint::fill(colour));
        svg.text([x + 13.0, TOP - 10.0], Words::START, kind);
    }
    svg.text([left, TOP - 10.0], Words::START, "microseconds a frame: median, 99th percentile");
    axis(&mut svg, &shares, bottom, |x| format!("{} %", 100.0 * x));
    axis(&mut svg, &times, bottom, |x| x.to_string());
    for (k, bar) in bars.iter().enumerate() {
        let y = TOP + ROW * k as f64;
        svg.text([LEFT - 8.0, y + 0.5 * ROW + 4.0], Words::END, bar.name);
        for (i, (share, (_, colour))) in bar.shares.into_iter().zip(KINDS).enumerate() {
            let end = shares.place(finite(share));
            svg.rect([LEFT, y + 5.0 + 12.0 * i as f64], [end - LEFT, 10.0], Paint::fill(colour));
        }
        let [median, late] = [bar.median_us, bar.p99_us].map(|x| times.place(finite(x)));
        let middle = y + 0.5 * ROW;
        svg.line([median, middle], [late, middle], theme::FROM, 2.0);
        svg.line([late, middle - 6.0], [late, middle + 6.0], theme::FROM, 2.0);
        svg.circle([median, middle], 4.0, Paint::fill(theme::FROM));
    }
    svg.end()
}

fn axis(svg: &mut Svg, scale: &Scale, bottom: f64, name: impl Fn(f64) -> String) {
    for value in scale.powers().map(power_of_ten) {
        let x = scale.place(value);
        svg.line([x, TOP], [x, bottom], theme::CELL, 2.0);
        svg.text([x, bottom + 16.0], Words::MIDDLE, &name(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(shares: [f64; 3], median_us: f64) -> WalkBar<'static> {
        WalkBar { name: "exact", shares, median_us, p99_us: 10.0 * median_us }
    }

    /// The widths of bars, in the order in which they are drawn.
    fn widths(svg: &str) -> Vec<f64> {
        let bars = svg.lines().filter(|line| line.starts_with("<rect x=") && line.contains("height=\"10\""));
        bars.map(|line| line.split('"').nth(5).unwrap().parse().unwrap()).collect()
    }

    #[test]
    fn bars_are_as_long_as_shares_say() {
        let svg = walk_svg("a < b", &[bar([1.0, 0.1, 0.01], 3.0), bar([0.0, 0.01, 0.1], 30.0)]);
        assert_eq!(widths(&svg), [WIDTH, WIDTH / 2.0, 0.0, 0.0, 0.0, WIDTH / 2.0]);
        assert!(
            svg.contains("<title>a &lt; b</title>") && svg.contains(">1 %</text>") && svg.contains(">100 %</text>")
        );
        assert!(svg.contains(">1000</text>"), "300 microseconds are within the axis");
    }

    #[test]
    fn strange_numbers_have_a_chart() {
        let nan = f64::NAN;
        for bars in [vec![], vec![bar([nan; 3], nan)], vec![bar([0.0; 3], 0.0)], vec![bar([1e300; 3], f64::INFINITY)]] {
            let svg = walk_svg("\u{1}", &bars);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
