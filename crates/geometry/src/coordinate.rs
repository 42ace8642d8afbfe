//! Which numbers may be coordinates.

/// Smallest magnitude, besides zero, that a coordinate may have: 2^-140.
pub const MIN_MAGNITUDE: f64 = f64::from_bits((1023 - 140) << 52);
/// Largest magnitude that a coordinate may have: 2^200.
pub const MAX_MAGNITUDE: f64 = f64::from_bits((1023 + 200) << 52);

/// Why a number cannot be a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoordinateError {
    /// NaN or an infinity.
    #[error("coordinate {0} is not a finite number")]
    NotFinite(f64),
    /// Finite, but of a magnitude for which exact predicates would under- or overflow.
    #[error("coordinate {0:e} is neither 0 nor between 2^-140 and 2^200 in magnitude")]
    OutOfRange(f64),
}

/// Accepts the numbers for which the predicates of this crate are exact, and returns them with
/// negative zero made positive, so that equal coordinates have equal bits.
///
/// The range has a reason. The predicates multiply two differences of coordinates and expand the
/// product into doubles without error. A difference of two accepted coordinates is 0 or at least one
/// unit in the last place of the smaller, 2^-192, so a product is at least 2^-384 and its error term
/// at least 2^-437, far above the smallest normal double 2^-1022; and a product is at most 2^402.
/// That leaves room for predicates of twice the degree. The triangulation that cuts plans (`spade`)
/// accepts the range from 2^-142 to 2^201, which is where the exact numbers come from.
///
/// # Errors
/// [`CoordinateError`] for anything else.
pub fn check_coordinate(x: f64) -> Result<f64, CoordinateError> {
    if !x.is_finite() {
        return Err(CoordinateError::NotFinite(x));
    }
    let magnitude = x.abs();
    if magnitude != 0.0 && !(MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&magnitude) {
        return Err(CoordinateError::OutOfRange(x));
    }
    Ok(x + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_checked() {
        assert_eq!(check_coordinate(1.5), Ok(1.5));
        assert_eq!(check_coordinate(-0.0).map(f64::to_bits), Ok(0));
        assert_eq!(check_coordinate(MAX_MAGNITUDE), Ok(MAX_MAGNITUDE));
        assert_eq!(check_coordinate(-MIN_MAGNITUDE), Ok(-MIN_MAGNITUDE));
        assert!(matches!(check_coordinate(f64::NAN), Err(CoordinateError::NotFinite(_))));
        assert!(matches!(check_coordinate(f64::INFINITY), Err(CoordinateError::NotFinite(_))));
        assert!(matches!(check_coordinate(1e-300), Err(CoordinateError::OutOfRange(_))));
        assert!(matches!(check_coordinate(-1e300), Err(CoordinateError::OutOfRange(_))));
    }
}
