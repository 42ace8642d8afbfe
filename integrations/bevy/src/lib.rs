#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: tables as assets, the tie between meshes of a glTF scene and objects of a table, culling per camera, doors,
//!   movers, who is told of whom on a server, pictures of the cells for whoever develops a level.
//! - **Out of scope**: making tables (the program `sightlines`), what is seen in mirrors.
//! - **Invariants**: where anything is not known, everything is drawn; only lists of cameras with [`PvsCamera`] get shorter,
//!   and their order stays.

#![forbid(unsafe_code)]

mod asset;
mod camera;
mod cull;
mod diagnostics;
mod doors;
mod follow;
#[cfg(feature = "gizmos")]
mod gizmos;
mod gltf;
mod level;
mod movers;
#[cfg(feature = "overlay")]
mod overlay;
mod parts;
#[cfg(feature = "replicon")]
mod replicon;
#[cfg(feature = "server")]
mod server;
mod space;
mod tie;

#[cfg(feature = "packed")]
pub use asset::{PackedPvsLoader, PackedPvsSettings};
pub use asset::{PvsLoadError, PvsLoader, PvsTable};
pub use camera::{PvsCamera, PvsChanged, PvsLock, PvsMethod, PvsProblem, PvsProblemKind, PvsState, PvsView};
pub use diagnostics::{CULLED, DRAWN, QUERY_US};
pub use doors::{PvsDoor, PvsDoorway};
#[cfg(feature = "gizmos")]
pub use gizmos::PvsGizmos;
pub use gltf::{PvsObject, PvsScene, PvsSource};
pub use movers::PvsMover;
#[cfg(feature = "overlay")]
pub use overlay::{PvsOverlay, PvsOverlayPlugin};
pub use parts::PvsParts;
#[cfg(feature = "replicon")]
pub use replicon::{PvsClient, PvsRepliconPlugin};
#[cfg(feature = "server")]
pub use server::{PvsBody, PvsServer, PvsServerError, PvsServerPlugin, PvsServerSystems, PvsTold};
pub use sightlines_pvs as pvs;
#[cfg(feature = "server")]
pub use sightlines_relevance as relevance;
pub use tie::PvsMisfit;

use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::gltf::extensions::GltfExtensionHandlers;
use bevy::prelude::*;

/// Culls what cannot be seen, for every camera with a [`PvsCamera`].
///
/// Added after Bevy's own plugins, as it needs those of assets.
#[derive(Debug, Clone, Copy, Default)]
pub struct SightlinesPlugin;

/// The systems of the plugin, in `PostUpdate`, after [`VisibilitySystems::CheckVisibility`].
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SightlinesSystems;

impl Plugin for SightlinesPlugin {
    fn build(&self, app: &mut App) {
        let handlers = &app.init_resource::<GltfExtensionHandlers>().world().resource::<GltfExtensionHandlers>().0;
        match handlers.try_write() {
            Some(mut handlers) => handlers.push(Box::new(gltf::Notes::default())),
            None => tracing::error!("glTF files are being loaded already: levels will not be found"),
        }
        app.init_asset::<PvsTable>()
            .preregister_asset_loader::<PvsLoader>(&["pvs"])
            .register_type::<PvsCamera>()
            .register_type::<PvsView>()
            .register_type::<PvsLock>()
            .register_type::<PvsScene>()
            .register_type::<PvsObject>()
            .register_type::<PvsMover>()
            .register_type::<PvsParts>()
            .register_type::<PvsDoor>()
            .register_type::<gltf::Rest>()
            .add_message::<PvsChanged>()
            .add_message::<PvsProblem>()
            .init_resource::<level::Slots>()
            .init_resource::<cull::Versions>()
            .init_resource::<doors::DoorVersion>()
            .add_observer(level::exempt)
            .add_observer(level::readmit)
            .add_systems(
                PostUpdate,
                (
                    level::note,
                    level::note_boxes,
                    parts::note_parts,
                    level::note_movers,
                    doors::note_doors,
                    cull::note_tables,
                    cull::cull,
                    diagnostics::measure,
                )
                    .chain()
                    .in_set(SightlinesSystems),
            )
            .configure_sets(
                PostUpdate,
                SightlinesSystems.after(VisibilitySystems::CheckVisibility).after(AssetEventSystems),
            );
        diagnostics::register(app);
        #[cfg(feature = "gizmos")]
        gizmos::build(app);
    }

    fn finish(&self, app: &mut App) {
        app.register_asset_loader(PvsLoader);
        #[cfg(feature = "packed")]
        app.register_asset_loader(PackedPvsLoader);
    }
}
