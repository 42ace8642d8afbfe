//! Boxes in space as arguments.

use crate::error::{Result, bail};
use crate::numbers::coordinates;
use sightlines::geometry::Aabb;
use std::str::FromStr;

/// A box in space: its lower corner, then its upper one, as six comma-separated numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Region(pub(crate) Aabb<3>);

impl FromStr for Region {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.split(',').count() != 6 {
            bail!("a box is six comma-separated numbers: the lower corner, then the upper one");
        }
        let numbers = coordinates(text)?;
        let corner = |first: usize| [numbers[first], numbers[first + 1], numbers[first + 2]];
        let region = Aabb { min: corner(0), max: corner(3) };
        refuse_reversed(&region.min, &region.max)?;
        Ok(Self(region))
    }
}

/// Refuses a box whose corners are the wrong way round.
pub(crate) fn refuse_reversed(min: &[f64], max: &[f64]) -> Result<()> {
    if let Some((low, high)) = min.iter().zip(max).find(|(low, high)| low > high) {
        bail!("the lower corner is above the upper one: {low} is more than {high}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_parsed() {
        let region = |text: &str| text.parse::<Region>().map(|r| (r.0.min, r.0.max)).map_err(|error| error.to_string());
        assert_eq!(region("-1,0, 2,3,4.5,1e1"), Ok(([-1.0, 0.0, 2.0], [3.0, 4.5, 10.0])));
        assert_eq!(region("1,1,1,1,1,1"), Ok(([1.0; 3], [1.0; 3])));
        for bad in ["1,2,3,4,5", "a,b", ""] {
            assert!(region(bad).is_err_and(|error| error.starts_with("a box is six")), "{bad}");
        }
        assert_eq!(region("1,2,3,4,5,x"), Err("'x' is not a number".into()));
        assert_eq!(region("0,5,0,1,4,1"), Err("the lower corner is above the upper one: 5 is more than 4".into()));
        for bad in ["NaN,0,0,1,1,1", "0,0,0,1,inf,1", "0,0,0,1,1,1e300"] {
            assert!(region(bad).is_err(), "{bad}");
        }
    }
}
