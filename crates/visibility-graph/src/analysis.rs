//! All measures by name.

use crate::{
    AngularMeasures, GlobalMeasures, LocalMeasures, MetricMeasures, Points, Turns, VisibilityGraph, WorkOptions,
};
use sightlines_progress::Halt;

/// Measures that are computed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// [`LocalMeasures`]
    Local,
    /// [`GlobalMeasures`]
    Global,
    /// [`MetricMeasures`]
    Metric,
    /// [`AngularMeasures`]
    Angular,
}

impl Group {
    /// All groups, the cheapest first.
    pub const ALL: [Self; 4] = [Self::Local, Self::Global, Self::Metric, Self::Angular];

    /// Its name: `local`, `global`, `metric`, `angular`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Global => "global",
            Self::Metric => "metric",
            Self::Angular => "angular",
        }
    }
}

/// Makes [`Measure`] of rows: variant, group, name, title, unit.
macro_rules! measures {
    ($($variant:ident, $group:ident, $name:literal, $title:literal, $unit:expr;)*) => {
        /// A measure of points.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Measure {
            $(#[doc = concat!("`", $title, "` (`", $name, "`).")] $variant,)*
        }

        impl Measure {
            /// All measures, group by group.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// The group that it is computed with.
            pub const fn group(self) -> Group {
                match self { $(Self::$variant => Group::$group,)* }
            }

            /// Its name in files and on command lines.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What people call it; depthmapX's name where it has one.
            pub const fn title(self) -> &'static str {
                match self { $(Self::$variant => $title,)* }
            }

            /// Its unit, in which a scene unit is `u`.
            pub const fn unit(self) -> &'static str {
                match self { $(Self::$variant => $unit,)* }
            }
        }
    };
}

measures! {
    Connectivity, Local, "connectivity", "Connectivity", "points";
    FirstMoment, Local, "first-moment", "Point First Moment", "u";
    SecondMoment, Local, "second-moment", "Point Second Moment", "u^2";
    Clustering, Local, "clustering", "Visual Clustering Coefficient", "";
    Control, Local, "control", "Visual Control", "";
    Controllability, Local, "controllability", "Visual Controllability", "";
    NodeCount, Global, "node-count", "Visual Node Count", "points";
    MeanDepth, Global, "mean-depth", "Visual Mean Depth", "steps";
    IntegrationHh, Global, "integration-hh", "Visual Integration [HH]", "";
    IntegrationTekl, Global, "integration-tekl", "Visual Integration [Tekl]", "";
    IntegrationP, Global, "integration-p", "Visual Integration [P-value]", "";
    Entropy, Global, "entropy", "Visual Entropy", "bits";
    RelativisedEntropy, Global, "relativised-entropy", "Visual Relativised Entropy", "bits";
    MetricNodeCount, Metric, "metric-node-count", "Metric Node Count", "points";
    MetricLength, Metric, "metric-length", "Metric Mean Shortest-Path Distance", "u";
    MetricAngle, Metric, "metric-angle", "Metric Mean Shortest-Path Angle", "right angles";
    StraightDistance, Metric, "straight-distance", "Metric Mean Straight-Line Distance", "u";
    AngularNodeCount, Angular, "angular-node-count", "Angular Node Count", "points";
    AngularDepth, Angular, "angular-depth", "Angular Mean Depth", "right angles";
    AngularTotal, Angular, "angular-total", "Angular Total Depth", "right angles";
}

/// Some of the measures, by one name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasureSet {
    /// All of them.
    All,
    /// Those of a group.
    Group(Group),
    /// One.
    One(Measure),
}

impl MeasureSet {
    /// Everything that has a name: all measures, each group, each measure.
    pub fn all() -> Vec<Self> {
        let groups = Group::ALL.into_iter().map(Self::Group);
        std::iter::once(Self::All).chain(groups).chain(Measure::ALL.into_iter().map(Self::One)).collect()
    }

    /// Its name: `all`, or that of the group or measure.
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Group(group) => group.name(),
            Self::One(measure) => measure.name(),
        }
    }

    /// Whether a measure is among them.
    pub fn has(self, measure: Measure) -> bool {
        match self {
            Self::All => true,
            Self::Group(group) => measure.group() == group,
            Self::One(one) => measure == one,
        }
    }
}

/// Which measures are computed, and how.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AnalysisOptions {
    /// The most steps that count in global measures.
    pub radius: Option<u32>,
    /// The longest paths that count in metric measures, in scene units.
    pub metric_radius: Option<f64>,
    /// The largest depth that counts in angular measures, in right angles.
    pub angular_radius: Option<f64>,
    /// Where paths may turn.
    pub turns: Turns,
}

/// Measures that were computed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Analysis {
    /// Local ones.
    pub local: Option<LocalMeasures>,
    /// Global ones.
    pub global: Option<GlobalMeasures>,
    /// Metric ones.
    pub metric: Option<MetricMeasures>,
    /// Angular ones.
    pub angular: Option<AngularMeasures>,
}

impl Analysis {
    /// Computes the groups of some measures.
    ///
    /// # Errors
    /// [`Halt`] by the observer, or by the store of units.
    ///
    /// # Panics
    /// If the points are not as many as those of the graph.
    pub fn of(
        graph: &VisibilityGraph,
        points: &Points,
        measures: &[Measure],
        options: &AnalysisOptions,
        effort: &WorkOptions<'_>,
    ) -> Result<Self, Halt> {
        let AnalysisOptions { radius, metric_radius, angular_radius, turns } = *options;
        let is_wanted = |group: Group| measures.iter().any(|measure| measure.group() == group);
        let mut all = Self::default();
        if is_wanted(Group::Local) {
            all.local = Some(LocalMeasures::of(graph, points, effort)?);
        }
        if is_wanted(Group::Global) {
            all.global = Some(GlobalMeasures::of(graph, radius, effort)?);
        }
        if is_wanted(Group::Metric) {
            all.metric = Some(MetricMeasures::of(graph, points, turns, metric_radius, effort)?);
        }
        if is_wanted(Group::Angular) {
            all.angular = Some(AngularMeasures::of(graph, points, turns, angular_radius, effort)?);
        }
        Ok(all)
    }

    /// The values of a measure, one for each point, [`UNDEFINED`](crate::UNDEFINED) where it has none. `None` if its group was not
    /// computed.
    pub fn values(&self, measure: Measure) -> Option<Vec<f64>> {
        let Self { local, global, metric, angular } = self;
        let whole = |numbers: &[u32]| numbers.iter().map(|&n| f64::from(n)).collect();
        let (local, global, metric, angular) = (local.as_ref(), global.as_ref(), metric.as_ref(), angular.as_ref());
        match measure {
            Measure::Connectivity => local.map(|m| whole(&m.connectivity)),
            Measure::FirstMoment => local.map(|m| m.first_moment.clone()),
            Measure::SecondMoment => local.map(|m| m.second_moment.clone()),
            Measure::Clustering => local.map(|m| m.clustering.clone()),
            Measure::Control => local.map(|m| m.control.clone()),
            Measure::Controllability => local.map(|m| m.controllability.clone()),
            Measure::NodeCount => global.map(|m| whole(&m.node_count)),
            Measure::MeanDepth => global.map(|m| m.mean_depth.clone()),
            Measure::IntegrationHh => global.map(|m| m.integration_hh.clone()),
            Measure::IntegrationTekl => global.map(|m| m.integration_tekl.clone()),
            Measure::IntegrationP => global.map(|m| m.integration_p.clone()),
            Measure::Entropy => global.map(|m| m.entropy.clone()),
            Measure::RelativisedEntropy => global.map(|m| m.relativised_entropy.clone()),
            Measure::MetricNodeCount => metric.map(|m| whole(&m.node_count)),
            Measure::MetricLength => metric.map(|m| m.mean_path_length.clone()),
            Measure::MetricAngle => metric.map(|m| m.mean_path_angle.clone()),
            Measure::StraightDistance => metric.map(|m| m.mean_straight_distance.clone()),
            Measure::AngularNodeCount => angular.map(|m| whole(&m.node_count)),
            Measure::AngularDepth => angular.map(|m| m.mean_depth.clone()),
            Measure::AngularTotal => angular.map(|m| m.total_depth.clone()),
        }
    }
}
