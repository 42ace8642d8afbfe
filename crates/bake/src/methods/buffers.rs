//! Multifocal buffers and sheets as a method by name.

use super::{Backend, Entry, OpenBackend, Prepared, welded};
use sightlines_cells::Scene;
use sightlines_geometry::Aabb;
use sightlines_multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches_of};
use sightlines_multifocal::{FromRegion, Layout, Measure, Multifocal, OccluderSelection, UnionMethod};
use std::sync::Arc;

pub(super) const ENTRY: Entry = Entry {
    name: "multifocal",
    about: "Any surfaces, axis-aligned or not, by buffers and sheets",
    prepare: |scene, options| Ok(Box::new(Buffers::new(scene, options)?)),
};

/// How multifocal buffers and sheets are made. The names are those of the program's options.
#[derive(Debug, Clone, Copy)]
pub struct BufferOptions {
    /// What buffers compare.
    pub measure: Measure,
    /// Planes on each side of a cell; 0 for no buffers.
    pub planes: u32,
    /// Texels along the longer side of a plane.
    pub texels: u32,
    /// The most occluders drawn on each side of a cell; those that seem to hide most.
    pub occluders: u32,
    /// Whether what is known on a plane is carried over to the next one; of heights only.
    pub carry: bool,
    /// The most edges of triangles visited to find a sheet between a cell and an object; 0 for no sheets.
    pub sheets: u32,
    /// Whether [line space](super::OcclusionMethod::LineSpace) is used as well.
    pub line_space: bool,
    /// What draws the buffers.
    pub backend: Backend,
    /// Called with one line when a backend takes over from another one.
    pub warn: fn(&str),
}

impl Default for BufferOptions {
    fn default() -> Self {
        let layout = Layout::default();
        Self {
            measure: layout.measure,
            planes: layout.planes,
            texels: layout.texels,
            occluders: 500,
            carry: layout.carry,
            sheets: SheetMethod::DEFAULT_LIMIT as u32,
            line_space: false,
            backend: Backend::Cpu,
            warn: |_| {},
        }
    }
}

/// Buffers that would not fit into the memory of most machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{planes} planes on each side with {texels} texels along a side take up to {bytes} bytes for each thread; {} are allowed",
    BufferOptions::MOST_BYTES
)]
pub struct BuffersTooLarge {
    /// Planes on each side.
    pub planes: u32,
    /// Texels along the longer side of a plane.
    pub texels: u32,
    /// Bytes of the buffers around one cell.
    pub bytes: u64,
}

impl BufferOptions {
    /// The most bytes of the buffers around one cell.
    pub const MOST_BYTES: u64 = 1 << 31;

    /// Checks that the buffers around one cell have at most [`Self::MOST_BYTES`].
    ///
    /// # Errors
    /// [`BuffersTooLarge`]
    pub fn check(&self) -> Result<(), BuffersTooLarge> {
        let Self { planes, texels, .. } = *self;
        let bytes = self.bytes_per_thread();
        if bytes <= Self::MOST_BYTES { Ok(()) } else { Err(BuffersTooLarge { planes, texels, bytes }) }
    }

    /// The bytes that the buffers of one thread take at most.
    pub fn bytes_per_thread(&self) -> u64 {
        6 * u64::from(self.planes) * u64::from(self.texels).pow(2) * size_of::<u32>() as u64
    }

    fn layout(&self) -> Layout {
        let carry = self.carry && self.measure.is_height();
        Layout { planes: self.planes, texels: self.texels, measure: self.measure, carry, ..Layout::default() }
    }
}

/// What the instances of all threads share.
struct Buffers {
    chosen: Arc<OccluderSelection>,
    sheets: Option<(Arc<Sheets>, usize)>,
    line_space: Option<Box<dyn Prepared>>,
    scene: Aabb<3>,
    layout: Layout,
    backend: OpenBackend,
}

impl Buffers {
    fn new(scene: &Scene, options: &BufferOptions) -> Result<Self, super::MethodError> {
        let backend = options.backend.open(options.warn)?;
        let mesh = welded(scene);
        let patches = if options.planes > 0 { patches_of(&mesh, &PatchOptions::default()) } else { Vec::new() };
        let sheets = (options.sheets > 0).then(|| (Arc::new(Sheets::of(mesh.clone())), options.sheets as usize));
        Ok(Self {
            chosen: Arc::new(OccluderSelection::new(patches, options.occluders as usize)),
            sheets,
            line_space: options.line_space.then(|| super::line_space::prepared(mesh)),
            scene: scene.bounds(),
            layout: options.layout(),
            backend,
        })
    }
}

impl Prepared for Buffers {
    fn instance(&self) -> Box<dyn FromRegion + Send> {
        // The first method is the one that decides about single triangles.
        let mut methods: Vec<_> = self.line_space.iter().map(|line_space| line_space.instance()).collect();
        if self.layout.planes > 0 {
            let chosen = Arc::clone(&self.chosen);
            methods.push(Box::new(Multifocal::new(self.backend.instance(), chosen, self.scene, self.layout)));
        }
        if let Some((sheets, limit)) = &self.sheets {
            methods.push(Box::new(SheetMethod::shared(Arc::clone(sheets)).with_limit(*limit)));
        }
        Box::new(UnionMethod::new(methods))
    }
}
