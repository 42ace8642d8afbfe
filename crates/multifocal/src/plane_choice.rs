//! Planes, their windows and their texels as texts.

use crate::{BufferPlane, BufferPlaneError, MAX_TEXELS, Volume};
use sightlines_geometry::{Aabb, CoordinateError, check_coordinate};
use std::fmt;
use std::str::FromStr;

const AXES: [&str; 3] = ["x", "y", "z"];

/// A plane perpendicular to an axis, perhaps with a window, as people write it: `z=20`, or `z=20:-4,-4,4,4` with the lower and the upper corner
/// of the window along the two axes that follow (for y: z and x).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneChoice {
    axis: usize,
    at: f64,
    window: Option<Window>,
}

/// Lower and upper corner along the two axes that follow the plane's.
type Window = [[f64; 2]; 2];

/// Why a text is not a plane, or the plane not one for a view volume.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaneChoiceError {
    /// Neither an axis nor a place on it.
    #[error("a plane is an axis and a place on it, such as z=20 or z=20:-4,-4,4,4")]
    Shape,
    /// Not four numbers.
    #[error("a window is four comma-separated numbers: the lower corner, then the upper one")]
    Window,
    /// A part that is not a number.
    #[error("'{0}' is not a number")]
    Number(String),
    /// A number that no coordinate can be.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// The plane goes through the view volume.
    #[error("the plane goes through the view volume, which reaches from {axis}={low} to {axis}={high}")]
    Through {
        /// The axis, by its name.
        axis: &'static str,
        /// Where the volume begins along it.
        low: f64,
        /// Where it ends.
        high: f64,
    },
    /// The window or the texels are none.
    #[error(transparent)]
    Plane(#[from] BufferPlaneError),
}

impl FromStr for PlaneChoice {
    type Err = PlaneChoiceError;

    fn from_str(text: &str) -> Result<Self, PlaneChoiceError> {
        let number = |part: &str| -> Result<f64, PlaneChoiceError> {
            let x: f64 = part.trim().parse().map_err(|_| PlaneChoiceError::Number(part.trim().to_owned()))?;
            Ok(check_coordinate(x)?)
        };
        let (plane, window) = text.split_once(':').map_or((text, None), |(plane, window)| (plane, Some(window)));
        let (axis, at) = plane.split_once('=').ok_or(PlaneChoiceError::Shape)?;
        let axis =
            AXES.iter().position(|name| axis.trim().eq_ignore_ascii_case(name)).ok_or(PlaneChoiceError::Shape)?;
        let window = window.map(|window| -> Result<Window, PlaneChoiceError> {
            let parts: Vec<&str> = window.split(',').collect();
            let &[u0, v0, u1, v1] = &parts[..] else { return Err(PlaneChoiceError::Window) };
            Ok([[number(u0)?, number(v0)?], [number(u1)?, number(v1)?]])
        });
        Ok(Self { axis, at: number(at)?, window: window.transpose()? })
    }
}

impl fmt::Display for PlaneChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", AXES[self.axis], self.at)
    }
}

impl PlaneChoice {
    /// The plane with its window and texels. Without a window it has that around the shadow of the scene's box, or, where the box is beside the
    /// volume, around the box.
    ///
    /// # Errors
    /// [`PlaneChoiceError::Through`] and [`PlaneChoiceError::Plane`].
    pub fn plane(&self, volume: &Volume, scene: &Aabb<3>, texels: Texels) -> Result<BufferPlane, PlaneChoiceError> {
        let (low, high) = (volume.bounds().min[self.axis], volume.bounds().max[self.axis]);
        if low <= self.at && self.at <= high {
            return Err(PlaneChoiceError::Through { axis: AXES[self.axis], low, high });
        }
        let [min, max] = self.window.unwrap_or_else(|| self.shadow(volume.bounds(), scene));
        let texels = texels.of([0, 1].map(|k| max[k] - min[k]));
        Ok(BufferPlane::new(self.axis, self.at > high, self.at, min, max, texels)?)
    }

    /// The window around the shadow of a box: where lines from eyes through the part of it that is in front of the
    /// plane lead to. The box's own sides where it is not all on the plane's side of the volume, since its shadow
    /// has no end then, or all of it is behind the plane.
    fn shadow(&self, eyes: &Aabb<3>, scene: &Aabb<3>) -> Window {
        // Depths grow towards the plane.
        let sign = if self.at > eyes.max[self.axis] { 1.0 } else { -1.0 };
        let depths = |b: &Aabb<3>| {
            let (a, b) = (sign * b.min[self.axis], sign * b.max[self.axis]);
            [a.min(b), a.max(b)]
        };
        let (plane, of_eyes, of_scene) = (sign * self.at, depths(eyes), depths(scene));
        let of_scene = [of_scene[0], of_scene[1].min(plane)];
        let across = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        let own = [across.map(|k| scene.min[k]), across.map(|k| scene.max[k])];
        if !(of_eyes[1] < of_scene[0] && of_scene[0] <= of_scene[1]) {
            return own;
        }
        // A place on the plane is projective in each of these, so the extremes are at the ends.
        let mut window = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (i, &k) in across.iter().enumerate() {
            for bits in 0..16usize {
                let end = |bit: usize, ends: [f64; 2]| ends[bits >> bit & 1];
                let (v, e) = (end(0, [eyes.min[k], eyes.max[k]]), end(1, [scene.min[k], scene.max[k]]));
                let (from, by) = (end(2, of_eyes), end(3, of_scene));
                let place = v + (plane - from) / (by - from) * (e - v);
                (window[0][i], window[1][i]) = (window[0][i].min(place), window[1][i].max(place));
            }
        }
        window
    }
}

/// How many texels a window has, as people write it: `256`, or `64x48`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Texels {
    /// Along the longer side; they are nearly square.
    Longer(u32),
    /// Along both.
    Both([u32; 2]),
}

impl FromStr for Texels {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| match part.trim().parse::<u32>() {
            Ok(n) if (1..=MAX_TEXELS).contains(&n) => Ok(n),
            _ => Err(format!("'{}' is not a whole number from 1 to {MAX_TEXELS}", part.trim())),
        };
        match text.split_once(['x', 'X']) {
            Some((width, height)) => Ok(Self::Both([number(width)?, number(height)?])),
            None => Ok(Self::Longer(number(text)?)),
        }
    }
}

impl Texels {
    /// The numbers for a window of this size.
    fn of(self, size: [f64; 2]) -> [u32; 2] {
        match self {
            Self::Both(both) => both,
            Self::Longer(n) => {
                let longer = size[0].max(size[1]);
                // Windows without a size are refused afterwards; a quotient that is not a number becomes 1.
                size.map(|s| if s == longer { n } else { ((f64::from(n) * s / longer).round() as u32).clamp(1, n) })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_parsed() {
        let plane = |text: &str| text.parse::<PlaneChoice>();
        assert_eq!(plane("z=20"), Ok(PlaneChoice { axis: 2, at: 20.0, window: None }));
        let window = Some([[-4.0, -3.0], [4.0, 1.5]]);
        assert_eq!(plane("X=-1e1:-4,-3, 4,1.5"), Ok(PlaneChoice { axis: 0, at: -10.0, window }));
        assert_eq!([plane("20"), plane("w=2"), plane("")], [const { Err(PlaneChoiceError::Shape) }; 3]);
        assert_eq!(plane("z=1:2,3,4"), Err(PlaneChoiceError::Window));
        assert_eq!(plane("z=a"), Err(PlaneChoiceError::Number("a".into())));
        assert_eq!(plane("z=1:2,3,4,b"), Err(PlaneChoiceError::Number("b".into())));
        for bad in ["z=NaN", "z=inf", "y=1:0,0,1,1e300"] {
            assert!(matches!(plane(bad), Err(PlaneChoiceError::Coordinate(_))), "{bad}");
        }
    }

    #[test]
    fn texels_are_parsed_and_follow_the_window() {
        assert_eq!(("64".parse(), "3x8192".parse()), (Ok(Texels::Longer(64)), Ok(Texels::Both([3, 8192]))));
        let error = |text: &str| text.parse::<Texels>().unwrap_err();
        assert_eq!(error("0"), "'0' is not a whole number from 1 to 8192");
        assert_eq!(error("8x9999"), "'9999' is not a whole number from 1 to 8192");
        assert_eq!(error("8x"), "'' is not a whole number from 1 to 8192");
        assert_eq!(Texels::Longer(100).of([8.0, 2.0]), [100, 25]);
        assert_eq!(Texels::Longer(100).of([1e-9, 2.0]), [1, 100]);
        assert_eq!(Texels::Longer(100).of([0.0, 0.0]), [100, 100]);
        assert_eq!(Texels::Both([3, 4]).of([1.0, 2.0]), [3, 4]);
    }

    #[test]
    fn windows_are_shadows() {
        let plane = |axis: usize, at: f64| PlaneChoice { axis, at, window: None };
        let b = |min, max| Aabb { min, max };
        let eyes = b([-1.0; 3], [1.0; 3]);
        // From -1 by way of 1 at a distance of 2, in all 4: as far again. From above by way of below likewise.
        let scene = b([-1.0, 0.0, 3.0], [1.0, 0.0, 3.0]);
        assert_eq!(plane(2, 5.0).shadow(&eyes, &scene), [[-3.0, -1.0], [3.0, 1.0]]);
        // The same against the axis.
        let mirrored = b([-1.0, 0.0, -3.0], [1.0, 0.0, -3.0]);
        assert_eq!(plane(2, -5.0).shadow(&eyes, &mirrored), [[-3.0, -1.0], [3.0, 1.0]]);
        // Beside the volume, and behind the plane: its own sides.
        let beside = b([-9.0, -8.0, 0.0], [9.0, 8.0, 3.0]);
        assert_eq!(plane(2, 5.0).shadow(&eyes, &beside), [[-9.0, -8.0], [9.0, 8.0]]);
        let behind = b([-9.0, -8.0, 6.0], [9.0, 8.0, 7.0]);
        assert_eq!(plane(2, 5.0).shadow(&eyes, &behind), [[-9.0, -8.0], [9.0, 8.0]]);
        // The axes across y are z and x.
        assert_eq!(plane(1, 20.0).shadow(&eyes, &b([2.0, 0.0, 4.0], [3.0, 9.0, 5.0])), [[4.0, 2.0], [5.0, 3.0]]);
    }
}
