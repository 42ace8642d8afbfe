//! Errors of the options of generators.

/// Why a scene cannot be generated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// A count is outside the range of the generator.
    #[error("{option} is {value}, but must be from {min} to {max}")]
    OutOfRange {
        /// Name of the option.
        option: &'static str,
        /// The requested value.
        value: u32,
        /// The smallest valid value.
        min: u32,
        /// The largest valid value.
        max: u32,
    },
    /// A wall thickness that would leave the grid of eighths, or close the doors.
    #[error("wall thickness {0} is not one of 0, 0.25 and 0.5")]
    WallThickness(f64),
}

/// Accepts `value` from `min` to `max`.
pub(crate) fn check_range(option: &'static str, value: u32, min: u32, max: u32) -> Result<u32, GenerateError> {
    if (min..=max).contains(&value) { Ok(value) } else { Err(GenerateError::OutOfRange { option, value, min, max }) }
}
