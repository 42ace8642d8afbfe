//! What `bevy_replicon` sends.

use crate::server::{PvsBody, PvsServer, PvsServerPlugin, PvsServerSystems, PvsTold};
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_replicon::prelude::*;
use bevy_replicon::server::visibility::client_visibility::ClientVisibility;
use bevy_replicon::server::visibility::filters_mask::FilterBit;
use bevy_replicon::server::visibility::registry::FilterRegistry;
use bevy_replicon::shared::replication::registry::ReplicationRegistry;

/// On the entity of a client of `bevy_replicon`: the body that the client's player sees from. Clients without it are told of everybody.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
pub struct PvsClient(pub Entity);

/// Keeps back entities with a [`PvsBody`] from clients that cannot come to see them in time, with all their components. Needs the plugins of
/// `bevy_replicon` before it; adds the [`PvsServerPlugin`].
#[derive(Debug, Clone, Copy, Default)]
pub struct PvsRepliconPlugin;

/// The filter of `bevy_replicon` that is ours.
#[derive(Resource, Debug)]
struct Bit(FilterBit);

impl Plugin for PvsRepliconPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<PvsServerPlugin>() {
            app.add_plugins(PvsServerPlugin);
        }
        let systems = (release, hide).chain().run_if(resource_exists::<PvsServer>);
        app.add_systems(PostUpdate, systems.after(PvsServerSystems).before(ServerSystems::Send));
    }

    fn finish(&self, app: &mut App) {
        let world = app.world_mut();
        if !world.contains_resource::<FilterRegistry>() {
            tracing::error!("add the plugins of bevy_replicon before PvsRepliconPlugin: nothing is kept back");
            return;
        }
        let bit = world.resource_scope(|world, mut filters: Mut<'_, FilterRegistry>| {
            world.resource_scope(|world, mut registry: Mut<'_, ReplicationRegistry>| {
                filters.register_scope::<Entity>(world, &mut registry, ScopeLifetime::WhileVisible)
            })
        });
        world.insert_resource(Bit(bit));
    }
}

/// Bodies that are none any more are shown to all, and so are all to clients whose body is gone: nothing is known of what these see.
fn release(
    bit: Option<Res<Bit>>,
    mut bodies: RemovedComponents<PvsBody>,
    mut freed: RemovedComponents<PvsClient>,
    alive: Query<Entity, With<PvsBody>>,
    mut clients: Query<(Option<&PvsClient>, &mut ClientVisibility)>,
) {
    let Some(bit) = bit else { return };
    for entity in bodies.read().filter(|&entity| !alive.contains(entity)) {
        for (body, mut visibility) in &mut clients {
            visibility.set(entity, bit.0, true);
            if body.is_some_and(|body| body.0 == entity) {
                alive.iter().for_each(|of| visibility.set(of, bit.0, true));
            }
        }
    }
    for client in freed.read() {
        if let Ok((None, mut visibility)) = clients.get_mut(client) {
            alive.iter().for_each(|of| visibility.set(of, bit.0, true));
        }
    }
}

fn hide(
    bit: Option<Res<Bit>>,
    server: Res<PvsServer>,
    mut told: MessageReader<PvsTold>,
    bodies: Query<Entity, With<PvsBody>>,
    mut clients: Query<(Entity, Ref<PvsClient>, &mut ClientVisibility)>,
) {
    let Some(bit) = bit else { return };
    let mut clients_of: EntityHashMap<Vec<Entity>> = EntityHashMap::default();
    for (client, body, mut visibility) in &mut clients {
        clients_of.entry(body.0).or_default().push(client);
        // A client that comes, or takes another body.
        if body.is_changed() {
            bodies.iter().for_each(|of| visibility.set(of, bit.0, server.is_shown(body.0, of)));
        }
    }
    for change in told.read() {
        for &client in clients_of.get(&change.to).into_iter().flatten() {
            if let Ok((_, _, mut visibility)) = clients.get_mut(client) {
                visibility.set(change.of, bit.0, change.shown);
            }
        }
    }
}
