//! The promised motion of a mover, and the box that it does not leave until a given time.

use sightlines_geometry::Aabb;

/// The promised motion of a mover: a top speed, a region that it stays in, or both.
///
/// Without either it may be anywhere at any time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    speed: Option<f64>,
    region: Option<Aabb<3>>,
}

/// Why a motion or a box is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// The speed is NaN, infinite or negative.
    #[error("a top speed of {0} is not a finite number from 0")]
    Speed(f64),
    /// The region is empty or has a corner that is not finite.
    #[error("the region of a mover is empty or not finite")]
    Region,
}

impl Motion {
    /// No promise.
    pub const ANY: Self = Self { speed: None, region: None };

    /// No point of the mover moves by more than `speed` scene units along any axis in a unit of time, including
    /// rotation and growth. The ordinary Euclidean speed is an upper bound for this.
    ///
    /// # Errors
    /// [`MotionError::Speed`].
    pub fn speed(speed: f64) -> Result<Self, MotionError> {
        Self::ANY.and_speed(speed)
    }

    /// The mover never leaves `region` (scene units; z is ignored in the plane).
    ///
    /// # Errors
    /// [`MotionError::Region`].
    pub fn within(region: Aabb<3>) -> Result<Self, MotionError> {
        Self::ANY.and_within(region)
    }

    /// Adds the promise of [`Motion::speed`].
    ///
    /// # Errors
    /// [`MotionError::Speed`].
    pub fn and_speed(self, speed: f64) -> Result<Self, MotionError> {
        match speed.is_finite() && speed >= 0.0 {
            true => Ok(Self { speed: Some(speed), ..self }),
            false => Err(MotionError::Speed(speed)),
        }
    }

    /// Adds the promise of [`Motion::within`].
    ///
    /// # Errors
    /// [`MotionError::Region`].
    pub fn and_within(self, region: Aabb<3>) -> Result<Self, MotionError> {
        match is_box(&region) {
            true => Ok(Self { region: Some(region), ..self }),
            false => Err(MotionError::Region),
        }
    }

    /// The top speed, if one is promised.
    pub fn top_speed(&self) -> Option<f64> {
        self.speed
    }

    /// The region, if one is promised.
    pub fn region(&self) -> Option<&Aabb<3>> {
        self.region.as_ref()
    }

    /// The same promise without a region.
    pub(super) fn anywhere(self) -> Self {
        Self { region: None, ..self }
    }

    /// The same promise in a table of `dimension` coordinates.
    pub(super) fn flat(self, dimension: u8) -> Self {
        Self { region: self.region.map(|region| flat(region, dimension)), ..self }
    }

    /// The temporal bounding volume: the box that a mover in `bounds` at the time `from` does not leave until the time
    /// `until`; `None` if there is no bound. Rounded outwards.
    ///
    /// With u the rounding of a double: the span `until - from` and its product with the speed are each rounded to the
    /// nearest and then up to the next double, so the distance is no less than the true one; adding and subtracting it
    /// is rounded to the nearest and then to the next double outwards. An overflow gives an infinite distance.
    pub(super) fn volume(&self, bounds: &Aabb<3>, from: f64, until: f64, dimension: u8) -> Option<Aabb<3>> {
        let grown = self.speed.map(|speed| {
            let span = (until - from).max(0.0);
            // Without motion or time, no margin for rounding is needed.
            let way = if span == 0.0 || speed == 0.0 { 0.0 } else { (span.next_up() * speed).next_up() };
            let (mut min, mut max) = (bounds.min, bounds.max);
            if way > 0.0 {
                for k in 0..usize::from(dimension) {
                    (min[k], max[k]) = ((min[k] - way).next_down(), (max[k] + way).next_up());
                }
            }
            Aabb { min, max }
        });
        match (grown, self.region) {
            (Some(grown), Some(region)) => Some(Aabb {
                min: std::array::from_fn(|k| grown.min[k].max(region.min[k])),
                max: std::array::from_fn(|k| grown.max[k].min(region.max[k])),
            }),
            (one, other) => one.or(other),
        }
    }
}

/// Whether this is a box with finite corners and at least one point.
pub(super) fn is_box(bounds: &Aabb<3>) -> bool {
    bounds.min.iter().chain(&bounds.max).all(|x| x.is_finite()) && !bounds.is_empty()
}

/// Whether `inner` is in `outer`, borders included.
pub(super) fn is_within(inner: &Aabb<3>, outer: &Aabb<3>) -> bool {
    (0..3).all(|k| outer.min[k] <= inner.min[k] && inner.max[k] <= outer.max[k])
}

/// The box with the coordinates beyond `dimension` set to 0.
pub(super) fn flat(mut bounds: Aabb<3>, dimension: u8) -> Aabb<3> {
    for k in usize::from(dimension)..3 {
        (bounds.min[k], bounds.max[k]) = (0.0, 0.0);
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit() -> Aabb<3> {
        Aabb { min: [0.0; 3], max: [1.0; 3] }
    }

    #[test]
    fn promises_are_checked() {
        assert_eq!(Motion::speed(-1.0), Err(MotionError::Speed(-1.0)));
        assert_eq!(Motion::speed(f64::INFINITY), Err(MotionError::Speed(f64::INFINITY)));
        assert_eq!(Motion::within(Aabb::EMPTY), Err(MotionError::Region));
        assert_eq!(
            Motion::speed(f64::NAN).unwrap_err().to_string(),
            "a top speed of NaN is not a finite number from 0"
        );
        assert_eq!(MotionError::Region.to_string(), "the region of a mover is empty or not finite");
    }

    #[test]
    fn volumes_grow_and_stay_in_their_region() {
        assert_eq!(Motion::ANY.volume(&unit(), 0.0, 1.0, 3), None);
        let still = Motion::speed(0.0).unwrap();
        assert_eq!(still.volume(&unit(), 0.0, 100.0, 3), Some(unit()));
        let both = Motion::speed(2.0).unwrap().and_within(Aabb { min: [-1.0; 3], max: [9.0; 3] }).unwrap();
        let volume = both.volume(&unit(), 1.0, 2.0, 3).unwrap();
        assert_eq!(volume.min, [-1.0; 3]);
        assert!(volume.max.iter().all(|&x| x > 3.0 && x < 3.0 + 1e-14));
        let planar = both.volume(&unit(), 1.0, 2.0, 2).unwrap();
        assert_eq!((planar.min[2], planar.max[2]), (0.0, 1.0));
        assert_eq!(both.volume(&unit(), 0.0, f64::INFINITY, 3), both.region().copied());
    }

    proptest! {
        /// Invariant: the volume contains the true box, compared in integers of 2^-80, and hardly more.
        #[test]
        fn volumes_round_outwards(at in -(1i64 << 52)..(1i64 << 52), speed in 1i64 << 20..1 << 45, from in 0i64..1 << 20, span in 1i64..1 << 20) {
            let scaled = |x: i64, bits: i32| x as f64 * 2.0f64.powi(-bits);
            let corner = scaled(at, 20);
            let motion = Motion::speed(scaled(speed, 30)).unwrap();
            let bounds = Aabb { min: [corner; 3], max: [corner; 3] };
            let volume = motion.volume(&bounds, scaled(from, 10), scaled(from + span, 10), 3).unwrap();
            let whole = |x: f64| (x * 2.0f64.powi(80)) as i128;
            let (middle, way) = (i128::from(at) << 60, (i128::from(speed) * i128::from(span)) << 40);
            let (most, least) = (whole(volume.max[0]), whole(volume.min[0]));
            prop_assert!(most >= middle + way && least <= middle - way);
            // Within 2^-50 of the sizes, and the scale's own unit.
            let spare = 1 + ((middle.abs() + way) >> 50);
            prop_assert!(most <= middle + way + spare && least >= middle - way - spare);
        }
    }
}
