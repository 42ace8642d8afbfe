//! A chart of a walk: what each method leaves to draw, and what it costs.

use crate::frame::Px;
use crate::theme;
use std::fmt::Write;

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
    let shares = Scale::new(least_share.clamp(LEAST_SHARE, 1.0), 1.0, LEFT);
    let times = || bars.iter().flat_map(|bar| [bar.median_us, bar.p99_us]).map(finite).filter(|x| *x > 0.0);
    let (least, most) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    // Without any times there is still an axis.
    let range = if least <= most { (least, most) } else { (1.0, 10.0) };
    let times = Scale::new(range.0, range.1, LEFT + WIDTH + GAP);

    let bottom = TOP + ROW * bars.len() as f64;
    let [width, height] = [LEFT + 2.0 * WIDTH + GAP + 30.0, bottom + 34.0];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"sans-serif\" font-size=\"11\" fill=\"{}\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        theme::WALL,
        escaped(title),
        theme::PAPER,
        w = Px(width),
        h = Px(height),
    );
    text(&mut svg, [10.0, 20.0], "start", title);
    text(&mut svg, [LEFT, TOP - 10.0], "start", "left to draw, share of all:");
    for (k, (kind, colour)) in KINDS.iter().enumerate() {
        let x = LEFT + 145.0 + 60.0 * k as f64;
        rect(&mut svg, [x, TOP - 18.0], [9.0, 9.0], colour);
        text(&mut svg, [x + 13.0, TOP - 10.0], "start", kind);
    }
    text(&mut svg, [times.left, TOP - 10.0], "start", "microseconds a frame: median, 99th percentile");
    shares.draw(&mut svg, bottom, |x| format!("{} %", 100.0 * x));
    times.draw(&mut svg, bottom, |x| x.to_string());
    for (k, bar) in bars.iter().enumerate() {
        let y = TOP + ROW * k as f64;
        text(&mut svg, [LEFT - 8.0, y + 0.5 * ROW + 4.0], "end", bar.name);
        for (i, (share, (_, colour))) in bar.shares.into_iter().zip(KINDS).enumerate() {
            let end = shares.place(finite(share));
            rect(&mut svg, [LEFT, y + 5.0 + 12.0 * i as f64], [end - LEFT, 10.0], colour);
        }
        let [median, late] = [bar.median_us, bar.p99_us].map(|x| times.place(finite(x)));
        let middle = y + 0.5 * ROW;
        line(&mut svg, [median, middle], [late, middle], theme::FROM);
        line(&mut svg, [late, middle - 6.0], [late, middle + 6.0], theme::FROM);
        let _ = writeln!(svg, "<circle cx=\"{}\" cy=\"{}\" r=\"4\" fill=\"{}\"/>", Px(median), Px(middle), theme::FROM);
    }
    svg.push_str("</svg>\n");
    svg
}

/// A logarithmic scale over whole decades.
struct Scale {
    /// Powers of ten.
    from: i32,
    to: i32,
    /// Where it begins, in pixels.
    left: f64,
}

impl Scale {
    /// Around two positive numbers.
    fn new(least: f64, most: f64, left: f64) -> Self {
        // Rounding can only add a decade; then the axis is longer than it has to be.
        let from = least.log10().floor().clamp(-12.0, 12.0) as i32;
        let to = (most.log10().ceil().clamp(-12.0, 12.0) as i32).max(from + 1);
        Self { from, to, left }
    }

    /// Where a number is; what is less than the scale has is at its beginning.
    fn place(&self, x: f64) -> f64 {
        let decades = f64::from(self.to - self.from);
        let at = (x.max(f64::MIN_POSITIVE).log10() - f64::from(self.from)) / decades;
        self.left + WIDTH * at.clamp(0.0, 1.0)
    }

    fn draw(&self, svg: &mut String, bottom: f64, name: impl Fn(f64) -> String) {
        for decade in self.from..=self.to {
            let value: f64 = format!("1e{decade}").parse().unwrap_or(0.0);
            let x = self.place(value);
            line(svg, [x, TOP], [x, bottom], theme::CELL);
            text(svg, [x, bottom + 16.0], "middle", &name(value));
        }
    }
}

fn rect(svg: &mut String, [x, y]: [f64; 2], [w, h]: [f64; 2], colour: &str) {
    let _ = writeln!(
        svg,
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{colour}\"/>",
        Px(x),
        Px(y),
        Px(w.max(0.0)),
        Px(h)
    );
}

fn line(svg: &mut String, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], colour: &str) {
    let [x0, y0, x1, y1] = [x0, y0, x1, y1].map(Px);
    let _ =
        writeln!(svg, "<line x1=\"{x0}\" y1=\"{y0}\" x2=\"{x1}\" y2=\"{y1}\" stroke=\"{colour}\" stroke-width=\"2\"/>");
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, what: &str) {
    let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\">{}</text>", Px(x), Px(y), escaped(what));
}

/// Text as XML has it; what no XML can hold is left out.
fn escaped(text: &str) -> String {
    let text: String = text.chars().filter(|c| !c.is_control()).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
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
