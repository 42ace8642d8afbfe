//! What a bake did, for each kind of input. Times and counts of searches vary from run to run.

use crate::doors::DoorPortals;
use crate::eye_level::EyeLevelSummary;
use crate::limit::LimitReport;
use crate::places::PlaceSummary;
use crate::subdivide::Subdivide;
use sightlines_kdtree::SceneSummary;
use sightlines_multifocal::WorkDone;
use sightlines_sightline::ShaftCounters;
use sightlines_stabtree::ConvexVisibility;
use std::collections::BTreeMap;
use std::time::Duration;

/// What a bake did, whatever was baked.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Report {
    /// Of a plan.
    Plan(PlanReport),
    /// Of a scene, by sightlines through the portals of a k-d tree.
    Scene(Box<SceneReport>),
    /// Of a scene, by a from-region method or for given cells.
    Regions(RegionReport),
    /// Of a portal file.
    Clusters(ClusterVisibility),
    /// Of a Quake map with its portal file.
    Map(MapReport),
}

impl From<PlanReport> for Report {
    fn from(report: PlanReport) -> Self {
        Self::Plan(report)
    }
}

impl From<SceneReport> for Report {
    fn from(report: SceneReport) -> Self {
        Self::Scene(Box::new(report))
    }
}

impl From<RegionReport> for Report {
    fn from(report: RegionReport) -> Self {
        Self::Regions(report)
    }
}

impl From<ClusterVisibility> for Report {
    fn from(report: ClusterVisibility) -> Self {
        Self::Clusters(report)
    }
}

impl From<MapReport> for Report {
    fn from(report: MapReport) -> Self {
        Self::Map(report)
    }
}

/// What baking a plan did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlanReport {
    /// The subdivision that was used; never [`Subdivide::Auto`].
    pub subdivide: Subdivide,
    /// Cells.
    pub n_cells: usize,
    /// Portals.
    pub n_portals: usize,
    /// Unordered pairs of different cells that see each other.
    pub n_visible_pairs: u64,
    /// Joints that close openings no wider than the gap of the plan.
    pub n_joints: usize,
    /// Ends of walls that miss others by little, and yet by more than the gap: see [`Plan::near_misses`](sightlines_cells::Plan::near_misses).
    pub n_near_misses: usize,
    /// Walls that do not block because the k-d tree cannot follow them.
    pub n_ignored_walls: usize,
    /// Crossings whose point had to be rounded.
    pub n_rounded_crossings: usize,
    /// Pieces of walls that were given up, towards visible.
    pub n_dropped_pieces: usize,
    /// Cells in regions whose lines disagree about the group.
    pub n_disputed_cells: usize,
    /// Parts of mirrors on borders of cells.
    pub n_mirror_parts: usize,
    /// Mirrors of which a part is on no border of a cell, and does not reflect.
    pub n_lost_mirrors: usize,
    /// Time to cut the plan.
    pub cut_time: Duration,
    /// Time to decide which cells see each other.
    pub see_time: Duration,
    /// Portals pushed by the search.
    pub n_pushes: u64,
    /// Cells entered by the search.
    pub n_visits: u64,
}

/// What baking a scene by sightlines did.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneReport {
    /// What was cut.
    pub cut: SceneSummary,
    /// Unordered pairs of different cells that see each other.
    pub n_visible_pairs: u64,
    /// Pairs of a cell and an object that it sees.
    pub n_objects_seen: u64,
    /// Time to cut the scene.
    pub cut_time: Duration,
    /// Time to decide which cells and objects each cell sees.
    pub see_time: Duration,
    /// Parts of mirrors in cells.
    pub n_mirror_parts: usize,
    /// Rectangles of mirrors of which a part is in no cell on either side, and does not reflect.
    pub n_lost_mirrors: usize,
    /// Triangles of mirrors that are not perpendicular to an axis, and do not reflect.
    pub n_other_mirror_triangles: usize,
    /// Mirrors that move, and do not reflect.
    pub n_moving_mirrors: usize,
    /// The doors of the scene, by object, and the portals that they close.
    pub doors: Vec<DoorPortals>,
    /// Rectangles that the walls between the cells were merged into.
    pub n_blockers: usize,
    /// Pairs of a cell and a cell or object that count as visible because deciding them took too much effort, or more
    /// digits than two doubles have. Varies a little with threads.
    pub n_assumed: u64,
    /// How pairs were decided. Varies from run to run with several threads.
    pub counters: ShaftCounters,
    /// What was not decided because the budget was spent; none if everything was.
    pub limit: Option<LimitReport>,
}

/// What baking a scene by a from-region method, or for given cells, did.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionReport {
    /// What was cut, if cells are places.
    pub places: Option<PlaceSummary>,
    /// What was cut, if cells are at the height of eyes.
    pub eye_level: Option<EyeLevelSummary>,
    /// Pairs that count as visible because deciding them by sightlines took too much effort.
    pub n_assumed: u64,
    /// Name of the from-region method, if there was one.
    pub method: Option<String>,
    /// What the method did.
    pub effort: WorkDone,
    /// The doors of the scene, by object, and the portals that they close; none for cells without portals.
    pub doors: Vec<DoorPortals>,
    /// Unordered pairs of different cells that may see each other.
    pub n_visible_pairs: u64,
    /// Pairs of a cell and an object that it may see.
    pub n_objects_seen: u64,
    /// What was not decided because the budget was spent; none if everything was.
    pub limit: Option<LimitReport>,
    /// Time to cut cells.
    pub cut_time: Duration,
    /// Time for everything.
    pub time: Duration,
}

/// Which clusters of a Quake map see which.
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterVisibility {
    /// The answer of the search, and what it did.
    pub seen: ConvexVisibility,
    /// Portals that the search went through: all of the file but those without area.
    pub n_portals: usize,
    /// Time of the search, of this run.
    pub see_time: Duration,
}

impl ClusterVisibility {
    /// Number of clusters.
    pub fn n_clusters(&self) -> usize {
        self.seen.cells.n_rows()
    }

    /// Unordered pairs of different clusters that see each other.
    pub fn n_visible_pairs(&self) -> u64 {
        (self.seen.cells.count_ones() - self.n_clusters() as u64) / 2
    }

    /// Unordered pairs of different clusters.
    pub fn n_pairs(&self) -> u64 {
        let n = self.n_clusters() as u64;
        n * n.saturating_sub(1) / 2
    }
}

/// What was found about clusters.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct ClusterSummary {
    /// Clusters.
    pub n_clusters: usize,
    /// Portals that have an area.
    pub n_portals: usize,
    /// Unordered pairs of different clusters that may see each other.
    pub n_visible_pairs: u64,
    /// `n_visible_pairs` as a share of all unordered pairs of different clusters.
    pub visible_share: f64,
    /// Pairs of clusters that count as visible though no line was found, the lower number first.
    pub undecided: Vec<[u32; 2]>,
    /// Counts of elementary operations by name; those of an earlier run included if it was resumed.
    pub counters: BTreeMap<&'static str, u64>,
    /// Seconds of the search for visible pairs, in this run.
    pub see_seconds: f64,
    /// Unordered pairs of different clusters.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub n_pairs: u64,
}

impl From<&ClusterVisibility> for ClusterSummary {
    fn from(found: &ClusterVisibility) -> Self {
        let (n_visible_pairs, n_pairs) = (found.n_visible_pairs(), found.n_pairs());
        Self {
            n_clusters: found.n_clusters(),
            n_portals: found.n_portals,
            n_visible_pairs,
            visible_share: n_visible_pairs as f64 / n_pairs.max(1) as f64,
            undecided: found.seen.undecided.clone(),
            counters: found.seen.counters.named().into_iter().collect(),
            see_seconds: found.see_time.as_secs_f64(),
            n_pairs,
        }
    }
}

/// What baking a Quake map with its portal file did.
#[derive(Debug, Clone, PartialEq)]
pub struct MapReport {
    /// Which clusters see which.
    pub clusters: ClusterVisibility,
    /// What the map added.
    pub world: WorldSummary,
}

/// What a map adds to its portals.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WorldSummary {
    /// Faces of the world.
    pub n_faces: usize,
    /// Faces that no leaf lists; engines never draw them.
    pub n_unlisted_faces: usize,
    /// Pairs of a cluster and a face that a leaf of the cluster lists.
    pub n_listed: usize,
    /// Pairs of a cluster and a face that reaches into it, though none of its leafs lists the face.
    pub n_reaching: usize,
    /// Planes of the tree that divide clusters from each other or from what is solid.
    pub n_planes: usize,
    /// How near to a plane a viewer counts to both sides, in map units.
    pub slack: f64,
}
