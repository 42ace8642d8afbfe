//! Lines for whoever develops a level: cells, portals, where the eye is. Feature `gizmos`.

use crate::asset::PvsTable;
use crate::camera::{PvsCamera, PvsView};
use crate::space::{Point, corners};
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::GizmoPlugin;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::gizmos::Gizmos;
use bevy::prelude::*;
use sightlines_pvs::{CellId, Frame};

/// What is drawn, for cameras with [`PvsCamera`]; all off at first.
///
/// As any group of gizmos: `config_store.config_mut::<PvsGizmos>()`.
#[derive(Debug, Clone, Copy, Reflect, GizmoConfigGroup)]
#[reflect(Default)]
pub struct PvsGizmos {
    /// The boxes of the cells that are seen.
    pub cells: bool,
    /// The cells of the eye.
    pub at: bool,
    /// All portals.
    pub portals: bool,
    /// The color of the cells that are seen.
    pub cell_color: Color,
    /// The color of the cells of the eye.
    pub at_color: Color,
    /// The color of the portals.
    pub portal_color: Color,
}

impl Default for PvsGizmos {
    fn default() -> Self {
        Self {
            cells: false,
            at: false,
            portals: false,
            cell_color: Color::srgb(0.3, 0.6, 1.0),
            at_color: Color::srgb(1.0, 0.6, 0.1),
            portal_color: Color::srgb(0.3, 1.0, 0.4),
        }
    }
}

/// Adds the gizmos, to apps that draw some.
pub(crate) fn build(app: &mut App) {
    if !app.is_plugin_added::<GizmoPlugin>() {
        return;
    }
    app.init_gizmo_group::<PvsGizmos>().add_systems(PostUpdate, draw.after(crate::SightlinesSystems));
}

/// The edges of a box, as pairs of its corners.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

fn draw(
    mut gizmos: Gizmos<'_, '_, PvsGizmos>,
    store: Res<GizmoConfigStore>,
    cameras: Query<(&PvsCamera, &PvsView)>,
    tables: Res<Assets<PvsTable>>,
    places: Query<&GlobalTransform>,
) {
    let (_, config) = store.config::<PvsGizmos>();
    if !(config.cells || config.at || config.portals) {
        return;
    }
    for (camera, view) in &cameras {
        let Some(table) = tables.get(&camera.table) else { continue };
        let Some(place) = view.level.and_then(|level| places.get(level).ok()) else { continue };
        let frame = table.frame().copied();
        let mut draw_cells = |cells: &[CellId], color: Color| {
            for (min, max) in cells.iter().filter_map(|cell| table.cell_box(*cell)) {
                let corners = corners(min, max).map(|corner| shown(corner, frame.as_ref(), place));
                EDGES.iter().for_each(|edge| gizmos.line(corners[edge[0]], corners[edge[1]], color));
            }
        };
        if config.cells {
            draw_cells(view.cells(), config.cell_color);
        }
        if config.at {
            draw_cells(view.at(), config.at_color);
        }
        if config.portals {
            // What cannot be read is not drawn.
            let _ = table.for_each_portal(|_, corners| {
                gizmos
                    .lineloop(corners.iter().map(|corner| shown(*corner, frame.as_ref(), place)), config.portal_color);
            });
        }
    }
}

/// A point of a table in the world.
fn shown(point: Point, frame: Option<&Frame>, place: &GlobalTransform) -> Vec3 {
    let point = frame.map_or(point, |frame| frame.to_scene(point));
    place.transform_point(Vec3::from_array(point.map(|x| x as f32)))
}
