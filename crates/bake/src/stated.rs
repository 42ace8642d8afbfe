//! What a table states of the methods that hid its pairs, and of how its scene was read.

use sightlines_formats::scene::SceneReadOptions;
use sightlines_pvs::{Table, TableKind};

/// The key under which a table states the names of its methods.
pub(crate) const METHOD: &str = "method";
/// The key under which a table states what was not decided in time.
pub(crate) const TIME_LIMIT: &str = "time-limit";
/// The key under which a table states the size below which objects were detail.
pub(crate) const DETAIL_BELOW: &str = "detail-below";

/// The key under which a table states how many rectangles hid from one side only from its sightlines, if there were any. Portals do not tell of them.
pub(crate) const ONE_SIDED: &str = "one-sided-walls";

/// The key under which the table of a plan states its gap.
pub(crate) const GAP: &str = "gap";

/// The [gap](sightlines_cells::Plan::gap) that the table of a plan states: ends of walls were joined to others within it. 0 if it states none.
pub fn stated_gap(table: &Table) -> f64 {
    let stated = table.info_value(GAP).and_then(|text| text.parse().ok());
    stated.filter(|_| table.dimension() == 2).unwrap_or(0.0)
}

/// The methods that hid pairs of a scene's table.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedMethods {
    /// Whether sightlines took part.
    pub sightlines: bool,
    /// The from-region method that took part, by the name that the table has for it, which may state its settings too; `a from-region method`
    /// if it has none.
    pub from_region: Option<String>,
    /// The size below which objects were detail for sightlines; `None` if that was chosen by the scene.
    pub detail_below: Option<f64>,
    /// Whether sightlines give the same again: they were finished in time, and that size can be read.
    pub is_repeatable: bool,
    /// Whether walls that hide from one side only took part in the sightlines through portals, which lie in these walls too.
    pub has_one_sided_walls: bool,
}

/// What a table of a scene in space states of its methods; `None` for other tables.
///
/// Whether a method took part is part of the table's [kind](TableKind). Its name, the limit of time, the size of detail and walls of one side are only
/// in the [free texts](Table::info) of a table, and this is where they are read: an unknown text changes a name and no decision about a pair.
pub fn stated_methods(table: &Table) -> Option<StatedMethods> {
    let (TableKind::SceneGivenCells { hidden_by } | TableKind::SceneKdTree { hidden_by }) = table.kind() else {
        return None;
    };
    let from_region = hidden_by.from_region.then(|| {
        let all = table.info_value(METHOD).unwrap_or_default();
        let name = all.strip_prefix("sightlines+").unwrap_or(all);
        if name.is_empty() { "a from-region method" } else { name }.to_owned()
    });
    let detail_below = table.info_value(DETAIL_BELOW).map(str::parse).transpose();
    let is_repeatable = detail_below.is_ok() && table.info_value(TIME_LIMIT).is_none();
    let detail_below = detail_below.unwrap_or_default();
    let has_one_sided_walls = table.info_value(ONE_SIDED).is_some();
    Some(StatedMethods {
        sightlines: hidden_by.sightlines,
        from_region,
        detail_below,
        is_repeatable,
        has_one_sided_walls,
    })
}

/// How the file of a table's scene was read, by the [free texts](Table::info) of the table: whoever looks at the scene again reads it likewise.
/// What is not stated, or cannot be read, is as by default.
pub fn stated_reading(info: &[(String, String)]) -> SceneReadOptions {
    let value = |key: &str| info.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
    let patterns = |key: &str| value(key).unwrap_or_default().lines().filter_map(|line| line.parse().ok()).collect();
    SceneReadOptions {
        opaque: patterns("opaque"),
        see_through: patterns("see-through"),
        still: patterns("still"),
        backs: value("backs").and_then(|name| name.parse().ok()).unwrap_or_default(),
        scene: value("scene").map(str::to_owned),
    }
}
