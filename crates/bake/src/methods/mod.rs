//! From-region methods by name: which there are, and how each is prepared for a scene.
//!
//! A new method is a module here with an `Entry`, one variant of [`OcclusionMethod`] and one line in its table. A new
//! backend of multifocal buffers is one variant of [`Backend`] and one line in the table of the module `backend`.
//! Either is also named in `ALL`.

mod backend;
mod buffers;
mod line_space;
mod shafts;

pub use backend::{Backend, NotBuiltIn, OpenBackend, ParseBackendError};
pub use buffers::{BufferOptions, BuffersTooLarge};

use sightlines_cells::Scene;
use sightlines_geometry::Point3;
use sightlines_line_space::Surface;
use sightlines_multifocal::FromRegion;
use sightlines_multifocal::mesh::Mesh;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// A method that finds what is hidden from a whole volume of viewpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OcclusionMethod {
    /// Multifocal buffers around the volume, and sheets of the scene's mesh.
    Multifocal,
    /// One flat piece that cuts the whole shaft between the volume and a target.
    Shafts,
    /// Line space subdivided, and chains of triangles in any direction.
    LineSpace,
}

/// Prepares a method for a scene.
type Prepare = fn(&Scene, &BufferOptions) -> Result<Box<dyn Prepared>, MethodError>;

/// An entry of the table of methods.
struct Entry {
    name: &'static str,
    about: &'static str,
    prepare: Prepare,
}

/// What the instances of a method share.
trait Prepared: Send + Sync {
    /// An instance for one thread.
    fn instance(&self) -> Box<dyn FromRegion + Send>;

    /// The surface that line space alone searches.
    fn surface(&self) -> Option<Arc<Surface>> {
        None
    }
}

impl OcclusionMethod {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Multifocal, Self::LineSpace, Self::Shafts];

    const fn entry(self) -> Entry {
        match self {
            Self::Multifocal => buffers::ENTRY,
            Self::LineSpace => line_space::ENTRY,
            Self::Shafts => shafts::ENTRY,
        }
    }

    /// Lower-case name for options: what [`Display`](fmt::Display) writes and [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// What it does, as one line of help.
    pub const fn about(self) -> &'static str {
        self.entry().about
    }
}

impl fmt::Display for OcclusionMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Not the name of a from-region method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no from-region method")]
pub struct ParseOcclusionMethodError(pub String);

impl FromStr for OcclusionMethod {
    type Err = ParseOcclusionMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|method| method.name() == text);
        found.ok_or_else(|| ParseOcclusionMethodError(text.to_owned()))
    }
}

/// Why a method cannot be prepared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MethodError {
    /// The buffers around one cell would take too much memory.
    #[error(transparent)]
    Buffers(#[from] BuffersTooLarge),
    /// The backend is not part of this build.
    #[error(transparent)]
    NotBuiltIn(#[from] NotBuiltIn),
}

/// A method prepared for a scene; it makes one instance for each thread.
///
/// What instances share (occluders, sheets, an open device) is computed once, here.
pub struct OcclusionMethodFactory {
    method: OcclusionMethod,
    prepared: Box<dyn Prepared>,
}

impl fmt::Debug for OcclusionMethodFactory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OcclusionMethodFactory").field("method", &self.method).finish_non_exhaustive()
    }
}

impl OcclusionMethodFactory {
    /// Prepares `method` for `scene`. Methods without buffers ignore `options`.
    ///
    /// Cost: that of the method; linear in triangles for sheets, and quadratic at worst for merging patches.
    ///
    /// # Errors
    /// [`MethodError`] for buffers beyond [`BufferOptions::MOST_BYTES`], whatever the method, and for a backend that is not
    /// built in.
    pub fn new(method: OcclusionMethod, scene: &Scene, options: &BufferOptions) -> Result<Self, MethodError> {
        options.check()?;
        Ok(Self { method, prepared: (method.entry().prepare)(scene, options)? })
    }

    /// The method.
    pub const fn method(&self) -> OcclusionMethod {
        self.method
    }

    /// An instance for one thread.
    pub fn instance(&self) -> Box<dyn FromRegion + Send> {
        self.prepared.instance()
    }

    /// What shadows are propagated by: the surface of [`OcclusionMethod::LineSpace`], and nothing of other methods.
    pub fn surface(&self) -> Option<Arc<Surface>> {
        self.prepared.surface()
    }
}

/// The triangles of all objects that hide, with the sides that they hide from.
fn welded(scene: &Scene) -> Mesh {
    let [both_sides, fronts]: [Vec<[Point3; 3]>; 2] =
        [scene.occluding_triangles().collect(), scene.front_occluding_triangles().collect()];
    Mesh::weld_with_fronts(&both_sides, &fronts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for method in OcclusionMethod::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
            assert!(!method.about().is_empty());
        }
        assert_eq!("view".parse::<OcclusionMethod>(), Err(ParseOcclusionMethodError("view".to_owned())));
        for backend in Backend::ALL {
            assert_eq!(backend.to_string().parse(), Ok(backend));
            assert!(!backend.about().is_empty());
        }
        assert_eq!("tpu".parse::<Backend>(), Err(ParseBackendError("tpu".to_owned())));
    }

    #[test]
    fn buffers_that_fit_no_machine_are_refused() {
        let options = |planes| BufferOptions { planes, texels: 8192, ..BufferOptions::default() };
        assert_eq!(options(1).check(), Ok(()));
        let error = options(2).check().expect_err("too large");
        assert_eq!(
            error.to_string(),
            "2 planes on each side with 8192 texels along a side take up to 3221225472 bytes for each thread; 2147483648 are allowed"
        );
    }
}
