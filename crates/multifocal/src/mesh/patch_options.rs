//! Options for patches.

/// Options for patches. None of them can make a patch hide anything visible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatchOptions {
    /// The most patches: the largest ones are kept.
    pub limit: usize,
    /// The least area, in square scene units.
    pub min_area: f64,
    /// The least cosine between the normal of a joining triangle and that of its patch.
    pub least_cosine: f64,
    /// The most corners of an outline.
    pub max_corners: usize,
    /// The most planes.
    pub max_facets: usize,
    /// The most triangles of a patch that grows over edges.
    pub max_triangles: usize,
    /// A patch is finished after this many triangles without improvement.
    pub patience: usize,
    /// The sine of a turn to the right that still counts as none when the next triangle is chosen; not negative.
    pub notch: f64,
}

impl Default for PatchOptions {
    /// No limit of number and size; nearly flat patches of up to 32 corners.
    fn default() -> Self {
        Self {
            limit: usize::MAX,
            min_area: 0.0,
            least_cosine: 0.98,
            max_corners: 32,
            max_facets: 32,
            max_triangles: 512,
            patience: 8,
            notch: 1e-3,
        }
    }
}
