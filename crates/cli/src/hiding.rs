//! What is hidden from whole volumes, by which method, as arguments.

use crate::measure::MeasureArg;
use sightlines::cells::Scene;
use sightlines::from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines::geometry::Point3;
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, Sheets, patches};
use sightlines::multifocal::{
    BackendError, Buffer, Chosen, FromRegion, Job, Layout, Measure, Multifocal, MultifocalBackend, Together,
};
use sightlines::multifocal_cpu::{Fast, Reference};
use sightlines::multifocal_gpu::{Gpu, GpuBackend, Way, WithFallback};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A method that says what is hidden from a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hiding {
    /// Multifocal buffers, and sheets.
    Buffers,
    /// One flat piece that cuts the whole shaft.
    Shafts,
    /// Voxels inside of closed surfaces.
    Voxels,
}

/// How multifocal buffers and sheets are made.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Multifocal buffers")]
pub(crate) struct BufferArgs {
    /// multifocal: what buffers compare
    #[arg(long, value_name = "WHAT", default_value = "height")]
    measure: MeasureArg,
    /// multifocal: planes on each side of a cell; 0 for none
    #[arg(long, value_name = "N", default_value_t = Layout::default().n_levels, value_parser = clap::value_parser!(u32).range(0..=256))]
    pub(crate) planes: u32,
    /// multifocal: texels along the longer side of a plane
    #[arg(long, value_name = "N", default_value_t = Layout::default().texels, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub(crate) texels: u32,
    /// multifocal: the most surfaces that are drawn on each side of a cell; those that seem to hide most
    #[arg(long, value_name = "N", default_value_t = 500)]
    occluders: u32,
    /// multifocal: do not carry over to a plane what is known on the one before
    #[arg(long)]
    no_carry: bool,
    /// multifocal: how many sides of triangles are looked at to find a surface between a cell and an object; 0 for none
    #[arg(long, value_name = "N", default_value_t = SheetMethod::DEFAULT_LIMIT as u32)]
    pub(crate) sheets: u32,
    /// multifocal: who draws the buffers
    #[arg(long, value_name = "WHO", default_value = "cpu")]
    backend: Backend,
}

/// Why multifocal buffers are not made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BuffersError {
    /// Buffers too large to be kept.
    #[error("{}: {planes} planes on each side with {texels} texels along a side take up to {bytes} bytes for each thread; {most} are allowed", path.display())]
    Buffers { path: PathBuf, planes: u32, texels: u32, bytes: u64, most: u64 },
}

/// The most bytes of the buffers around one cell.
const MOST_BYTES: u64 = 1 << 31;

/// Who draws, as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Backend {
    /// In whole numbers, in threads
    Cpu,
    /// In exact arithmetic, very slow
    Reference,
    /// As cpu, bit for bit, on a graphics card; the CPU takes over where there is none
    Gpu,
}

impl BufferArgs {
    /// Refuses buffers that would not fit into the memory of most machines.
    pub(crate) fn check_memory(&self, path: &Path) -> Result<(), BuffersError> {
        let bytes = 6 * u64::from(self.planes) * u64::from(self.texels).pow(2) * size_of::<u32>() as u64;
        if bytes <= MOST_BYTES {
            return Ok(());
        }
        let (planes, texels) = (self.planes, self.texels);
        Err(BuffersError::Buffers { path: path.to_owned(), planes, texels, bytes, most: MOST_BYTES })
    }

    fn layout(&self) -> Layout {
        let measure = self.measure.measure();
        let reproject = !self.no_carry && measure.is_height();
        Layout { n_levels: self.planes, texels: self.texels, measure, reproject, ..Layout::default() }
    }
}

/// The triangles of all objects.
fn triangles(scene: &Scene) -> Vec<[Point3; 3]> {
    scene.objects().iter().flat_map(|o| o.corners()).collect()
}

/// What the methods of all threads are made from.
pub(crate) enum Maker {
    Buffers(Buffers),
    Shafts(ViewShafts),
    Voxels(Box<Voxels>),
}

impl Maker {
    /// Makes ready what a method asks of a scene.
    pub(crate) fn new(hiding: Hiding, scene: &Scene, args: &BufferArgs) -> Self {
        match hiding {
            Hiding::Buffers => Self::Buffers(Buffers::new(scene, args)),
            Hiding::Shafts => Self::Shafts(ViewShafts::new(patches(&triangles(scene), &PatchOptions::default()))),
            Hiding::Voxels => {
                let voxels = Voxels::new(scene, VoxelOptions::default());
                Self::Voxels(Box::new(voxels.expect("the number of voxels is within limits")))
            }
        }
    }

    /// The method, for one thread.
    pub(crate) fn make(&self) -> Box<dyn FromRegion + Send> {
        match self {
            Self::Buffers(buffers) => buffers.make(),
            Self::Shafts(shafts) => Box::new(shafts.clone()),
            Self::Voxels(voxels) => voxels.clone(),
        }
    }
}

/// What multifocal methods share.
pub(crate) struct Buffers {
    chosen: Arc<Chosen>,
    sheets: Option<(Arc<Sheets>, usize)>,
    scene: sightlines::geometry::Aabb<3>,
    layout: Layout,
    backend: Backend,
    gpu: Option<Gpu>,
}

impl Buffers {
    fn new(scene: &Scene, region: &BufferArgs) -> Self {
        let triangles = triangles(scene);
        let layout = region.layout();
        let patches = if region.planes > 0 { patches(&triangles, &PatchOptions::default()) } else { Vec::new() };
        let sheets = (region.sheets > 0).then(|| (Arc::new(Sheets::new(&triangles)), region.sheets as usize));
        let gpu = if region.backend == Backend::Gpu { open() } else { None };
        Self {
            chosen: Arc::new(Chosen::new(patches, region.occluders as usize)),
            sheets,
            scene: scene.bounds(),
            layout,
            backend: region.backend,
            gpu,
        }
    }

    fn make(&self) -> Box<dyn FromRegion + Send> {
        let mut methods: Vec<Box<dyn FromRegion + Send>> = Vec::new();
        if self.layout.n_levels > 0 {
            methods.push(match (self.backend, &self.gpu) {
                (Backend::Reference, _) => self.buffers(Reference),
                (Backend::Gpu, Some(gpu)) => {
                    let gpu = GpuBackend::new(gpu.clone(), Way::Compute);
                    self.buffers(Telling(WithFallback::new(gpu, WithFallback::new(Fast::new(), Reference))))
                }
                _ => self.buffers(WithFallback::new(Fast::new(), Reference)),
            });
        }
        if let Some((sheets, limit)) = &self.sheets {
            methods.push(Box::new(SheetMethod::shared(Arc::clone(sheets)).with_limit(*limit)));
        }
        Box::new(Together::new(methods))
    }

    fn buffers(&self, backend: impl MultifocalBackend + 'static) -> Box<dyn FromRegion + Send> {
        Box::new(Multifocal::new(backend, Arc::clone(&self.chosen), self.scene, self.layout))
    }
}

/// The graphics card, if there is one.
fn open() -> Option<Gpu> {
    match Gpu::open() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            tracing::warn!("{error}; the CPU takes over");
            None
        }
    }
}

/// A backend with one that takes over, which says so.
#[derive(Debug)]
struct Telling<A, B>(WithFallback<A, B>);

impl<A: MultifocalBackend, B: MultifocalBackend> MultifocalBackend for Telling<A, B> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn supports(&self, measure: Measure) -> bool {
        self.0.supports(measure)
    }

    fn render(&mut self, job: &Job<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        let before = self.0.took_over().cloned();
        let done = self.0.render(job, out);
        if let Some(error) = self.0.took_over().filter(|error| before.as_ref() != Some(error)) {
            tracing::warn!("{error}; the CPU takes over");
        }
        done
    }
}
