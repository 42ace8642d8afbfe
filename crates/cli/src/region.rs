//! Boxes in space as arguments.

use sightlines::geometry::{Aabb, CoordinateError, check_coordinate};
use std::str::FromStr;

/// A box in space: its lower corner, then its upper one, as six comma-separated numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Region(pub(crate) Aabb<3>);

/// Why a text is not a box.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum RegionError {
    #[error("a box is six comma-separated numbers: the lower corner, then the upper one")]
    Count,
    #[error("'{0}' is not a number")]
    Number(String),
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    #[error("the lower corner is above the upper one: {low} is more than {high}")]
    Reversed { low: f64, high: f64 },
}

impl FromStr for Region {
    type Err = RegionError;

    fn from_str(text: &str) -> Result<Self, RegionError> {
        let number = |part: &str| -> Result<f64, RegionError> {
            let x: f64 = part.trim().parse().map_err(|_| RegionError::Number(part.trim().to_owned()))?;
            Ok(check_coordinate(x)?)
        };
        let parts: Vec<&str> = text.split(',').collect();
        if parts.len() != 6 {
            return Err(RegionError::Count);
        }
        let numbers: Vec<f64> = parts.into_iter().map(number).collect::<Result<_, _>>()?;
        let corner = |first: usize| [numbers[first], numbers[first + 1], numbers[first + 2]];
        let region = Aabb { min: corner(0), max: corner(3) };
        match (0..3).find(|&k| region.min[k] > region.max[k]) {
            Some(k) => Err(RegionError::Reversed { low: region.min[k], high: region.max[k] }),
            None => Ok(Self(region)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_parsed() {
        let region = |text: &str| text.parse::<Region>().map(|r| (r.0.min, r.0.max));
        assert_eq!(region("-1,0, 2,3,4.5,1e1"), Ok(([-1.0, 0.0, 2.0], [3.0, 4.5, 10.0])));
        assert_eq!(region("1,1,1,1,1,1"), Ok(([1.0; 3], [1.0; 3])));
        assert_eq!(region("1,2,3,4,5"), Err(RegionError::Count));
        assert_eq!(region("1,2,3,4,5,x"), Err(RegionError::Number("x".into())));
        assert_eq!(region("0,5,0,1,4,1"), Err(RegionError::Reversed { low: 5.0, high: 4.0 }));
        for bad in ["NaN,0,0,1,1,1", "0,0,0,1,inf,1", "0,0,0,1,1,1e300"] {
            assert!(matches!(region(bad), Err(RegionError::Coordinate(_))), "{bad}");
        }
    }
}
