//! Why there is no device to work with.

/// Why there is no device to work with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The system has no driver, or no driver has a device.
    #[error("there is no GPU adapter: {0}")]
    NoAdapter(String),
    /// An adapter that gives no device with the limits that every WebGPU device has.
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// A host's device that was made with less than the shaders need.
    #[error("the device offers {offered} as {limit}, and {needed} are needed")]
    Limit {
        /// Which limit.
        limit: &'static str,
        /// What the device has.
        offered: u64,
        /// What is needed.
        needed: u64,
    },
    /// The driver refuses a shader.
    #[error("the device does not take the shaders: {0}")]
    Shaders(String),
}
