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
        let Ok([x0, y0, z0, x1, y1, z1]) = <[f64; 6]>::try_from(coordinates(text)?) else {
            bail!("a box is six comma-separated numbers: the lower corner, then the upper one");
        };
        let region = Aabb { min: [x0, y0, z0], max: [x1, y1, z1] };
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
