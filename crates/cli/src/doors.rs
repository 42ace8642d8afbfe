//! Doors as arguments.

use crate::error::{Result, bail};
use crate::numbers::coordinates;
use crate::region::refuse_reversed;
use crate::view::lifted;
use sightlines::pvs::DoorBox;
use std::str::FromStr;

/// A door that is given as a box: `NAME=X0,Y0,Z0,X1,Y1,Z1`, in the plane `NAME=X0,Y0,X1,Y1`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DoorArg {
    /// With z = 0 in the plane.
    pub(crate) door: DoorBox,
    /// Number of coordinates of a corner.
    pub(crate) n_dimensions: usize,
}

impl FromStr for DoorArg {
    type Err = anyhow::Error;

    /// The name is all before the last `=`.
    fn from_str(text: &str) -> Result<Self> {
        let form = "a door is a name and a box, such as front=0,0,0,1,2,0.1";
        let Some((name, corners)) = text.rsplit_once('=') else { bail!("{form}") };
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            bail!("a door needs a name before the '='");
        }
        let mut min = coordinates(corners)?;
        if !matches!(min.len(), 4 | 6) {
            bail!("{form}");
        }
        let max = min.split_off(min.len() / 2);
        refuse_reversed(&min, &max)?;
        let door = DoorBox { name: name.to_owned(), min: lifted(&min), max: lifted(&max) };
        Ok(Self { door, n_dimensions: min.len() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doors_are_parsed() {
        let door = |text: &str| text.parse::<DoorArg>().map_err(|error| error.to_string());
        let front = door("front=0,0,0,1,2.5,0").unwrap();
        assert_eq!((front.door.name.as_str(), front.n_dimensions), ("front", 3));
        assert_eq!([front.door.min, front.door.max], [[0.0; 3], [1.0, 2.5, 0.0]]);
        assert_eq!(door("a=b=-1,2,3,4").map(|d| (d.door.name, d.door.min)), Ok(("a=b".into(), [-1.0, 2.0, 0.0])));
        let refused = |text: &str, error: &str| assert!(door(text).is_err_and(|e| e.starts_with(error)), "{text}");
        for bad in ["front", "front=1,2,3", "front=1,2,3,4,5"] {
            refused(bad, "a door is a name and a box");
        }
        for bad in ["=0,0,1,1", " =0,0,1,1", "a\nb=0,0,1,1"] {
            refused(bad, "a door needs a name");
        }
        refused("a=0,x,1,1", "'x' is not a number");
        refused("a=0,5,1,4", "the lower corner is above the upper one: 5 is more than 4");
        refused("a=0,NaN,1,4", "");
    }
}
