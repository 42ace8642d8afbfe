//! The paths on a GPU that fill buffers.

/// How buffers are filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum GpuPath {
    /// By a compute shader, in integers: the canonical one.
    #[default]
    Compute,
    /// By the hardware's rasteriser and depth test, which keeps the larger value; each fragment asks the same integers,
    /// so the bits are the same.
    Raster,
    /// By a compute shader in 32-bit floats with margins, to see what floats cost. Knows
    /// [`VertexHeight`](sightlines_multifocal::Measure::VertexHeight) alone; what it blocks is blocked, but it misses more, and what it misses depends on the
    /// device.
    Float,
}

impl GpuPath {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Compute, Self::Raster, Self::Float];

    /// Name of the backend of this path.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Compute => "gpu",
            Self::Raster => "gpu-raster",
            Self::Float => "gpu-float",
        }
    }
}
