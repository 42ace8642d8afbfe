//! The section with the kind of table, and how older files express it.

use crate::{Axis, SceneMethods, TableKind};

/// Length of the section in bytes.
pub const KIND_LEN: usize = 12;

const SIGHTLINES: u32 = 1;
const FROM_REGION: u32 = 2;
const ONLY_IN_AIR: u32 = 4;

/// The content of the section `KIND`, which `.pvs` files and packed tables share.
pub fn kind_to_bytes(kind: TableKind, up: Option<Axis>) -> [u8; KIND_LEN] {
    let bits = |by: SceneMethods| {
        let flags = [(by.sightlines, SIGHTLINES), (by.from_region, FROM_REGION), (by.only_in_air, ONLY_IN_AIR)];
        flags.into_iter().filter(|(is_set, _)| *is_set).map(|(_, flag)| flag).sum()
    };
    let (number, methods) = match kind {
        TableKind::Unspecified => (0, 0),
        TableKind::PlanKdTree => (1, 0),
        TableKind::PlanTriangulation => (2, 0),
        TableKind::SceneKdTree { hidden_by } => (3, bits(hidden_by)),
        TableKind::SceneGivenCells { hidden_by } => (4, bits(hidden_by)),
        TableKind::QuakePortalFile => (5, 0),
        TableKind::QuakeMap => (6, 0),
    };
    let up = up.map_or(0, |axis| axis.idx() as u32 + 1);
    let mut out = [0; KIND_LEN];
    for (place, field) in out.chunks_exact_mut(4).zip([number, methods, up]) {
        place.copy_from_slice(&u32::to_le_bytes(field));
    }
    out
}

/// Decodes the content of the section `KIND`.
///
/// # Errors
/// The field with a value that is unknown to this version.
pub fn kind_from_bytes(bytes: [u8; KIND_LEN]) -> Result<(TableKind, Option<Axis>), u32> {
    let field = |k: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[4 * k + i]));
    let [number, methods, up] = [0, 1, 2].map(field);
    let has = |flag: u32| methods & flag != 0;
    let hidden_by =
        SceneMethods { sightlines: has(SIGHTLINES), from_region: has(FROM_REGION), only_in_air: has(ONLY_IN_AIR) };
    let kind = match number {
        0 => TableKind::Unspecified,
        1 => TableKind::PlanKdTree,
        2 => TableKind::PlanTriangulation,
        3 => TableKind::SceneKdTree { hidden_by },
        4 => TableKind::SceneGivenCells { hidden_by },
        5 => TableKind::QuakePortalFile,
        6 => TableKind::QuakeMap,
        _ => return Err(number),
    };
    let up = match up {
        0 => None,
        1..=3 => Some(Axis::ALL[up as usize - 1]),
        _ => return Err(up),
    };
    // The encoding is unique: unused bits are refused.
    if kind_to_bytes(kind, up) == bytes { Ok((kind, up)) } else { Err(methods) }
}

/// The kind according to the free texts of files without the section `KIND`, which are older than it or of an
/// unspecified kind.
///
/// This is the only place that derives a decision from a free text. Unknown texts, and those that do not fit the
/// dimension, mean [`TableKind::Unspecified`].
pub fn kind_from_info(dimension: u8, info: &[(String, String)]) -> (TableKind, Option<Axis>) {
    let value = |key: &str| info.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
    let source = value("source").unwrap_or_default();
    let hidden_by = match value("method") {
        None => SceneMethods { sightlines: true, ..SceneMethods::default() },
        Some(method) => {
            let rest = method.strip_prefix("sightlines");
            SceneMethods {
                sightlines: rest.is_some(),
                from_region: rest.map_or(!method.is_empty(), |r| !r.is_empty()),
                only_in_air: ["voxels", "shafts"].iter().any(|m| method.contains(m)),
            }
        }
    };
    let kind = if source.starts_with("portal file") {
        TableKind::QuakePortalFile
    } else if source.starts_with("Quake map") {
        TableKind::QuakeMap
    } else {
        match (value("subdivide"), dimension) {
            (Some("kd"), 2) => TableKind::PlanKdTree,
            (Some("triangulation"), 2) => TableKind::PlanTriangulation,
            (Some("kd"), 3) => TableKind::SceneKdTree { hidden_by },
            (Some("boxes"), 3) => TableKind::SceneGivenCells { hidden_by },
            _ => TableKind::Unspecified,
        }
    };
    let kind = if kind.dimension().is_none_or(|d| d == dimension) { kind } else { TableKind::Unspecified };
    let up = match value("up") {
        Some("x") => Some(Axis::X),
        Some("y") => Some(Axis::Y),
        Some("z") => Some(Axis::Z),
        _ => None,
    };
    (kind, up)
}

/// The content of `KIND`, or `None` if readers conclude the same without it: files of tables of an unspecified kind
/// stay unchanged.
pub fn kind_section(
    dimension: u8,
    kind: TableKind,
    up: Option<Axis>,
    info: &[(String, String)],
) -> Option<[u8; KIND_LEN]> {
    let unspecified = (TableKind::Unspecified, None);
    let implied = (kind, up) == unspecified && kind_from_info(dimension, info) == unspecified;
    (!implied).then(|| kind_to_bytes(kind, up))
}
