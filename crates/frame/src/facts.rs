//! What a frame means, as fields for programs and in words for people.

use sightlines_pvs::Frame;
use std::fmt;

/// Frame of a table: the axes of its own that it has. Its cells, portals and objects are along these; points that queries take are not.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FrameFacts {
    /// Each axis as a unit vector of the scene.
    pub axes: [[f64; 3]; 3],
    /// Openings narrower than this may count as closed, and things that are thinner as hidden; along a diagonal up to √3 times this.
    pub gap: f64,
}

impl From<&Frame> for FrameFacts {
    fn from(frame: &Frame) -> Self {
        Self { axes: frame.axes(), gap: frame.gap() }
    }
}

/// How it is turned, and what its gap means; the same words wherever a frame is reported.
impl fmt::Display for FrameFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match degrees(&self.axes) {
            Some(degrees) => write!(f, "turned by {degrees:.6} degrees")?,
            None => f.write_str(ALONG_THE_FILE)?,
        }
        write!(f, ", openings and things narrower than {:.2e} units may count as closed or hidden", self.gap)
    }
}

/// How a scene stands that has no frame, or one that is not turned.
pub const ALONG_THE_FILE: &str = "along the axes of the file";

/// By how much axes are turned; none if they are those of the file.
fn degrees(axes: &[[f64; 3]; 3]) -> Option<f64> {
    if (0..3).all(|k| axes[k][k] == 1.0) {
        return None;
    }
    // The angle of a turn from its trace.
    let cosine = (axes[0][0] + axes[1][1] + axes[2][2] - 1.0) / 2.0;
    // Near 1 the cosine tells nothing; the sine is in the differences across the diagonal.
    let [x, y, z] = [axes[1][2] - axes[2][1], axes[2][0] - axes[0][2], axes[0][1] - axes[1][0]];
    let sine = (x * x + y * y + z * z).sqrt() / 2.0;
    Some(sine.atan2(cosine).to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_told_in_the_same_words() {
        let text = |axes: [[f64; 3]; 3]| FrameFacts { axes, gap: 0.00025 }.to_string();
        let (plain, gap) =
            ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "openings and things narrower than 2.50e-4 units");
        assert_eq!(text(plain), format!("along the axes of the file, {gap} may count as closed or hidden"));
        let turned = text([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(turned, format!("turned by 90.000000 degrees, {gap} may count as closed or hidden"));
    }
}
