//! Who is told of whom, and what `bevy_replicon` sends.

use crate::app::{assets, table};
use bevy::prelude::*;
use bevy::state::app::StatesPlugin;
use bevy_replicon::prelude::*;
use bevy_replicon::test_app::{ServerTestAppExt, TestClientEntity};
use bevy_sightlines::pvs::{CellId, Table};
use bevy_sightlines::relevance::{ReachOptions, Reaches};
use bevy_sightlines::{PvsBody, PvsClient, PvsRepliconPlugin, PvsServer, PvsServerError};
use std::sync::Arc;

const LATENCY: f32 = 0.2;

fn body() -> PvsBody {
    PvsBody { seen: [Vec3::splat(-0.01), Vec3::splat(0.01)], eyes: [Vec3::ZERO; 2], ..PvsBody::on_foot(1.8, 5.0) }
}

fn networked() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        StatesPlugin,
        RepliconPlugins.set(ServerPlugin::new(PostUpdate)),
    ));
    app
}

/// Middles of cells: two that see each other, and one that the first does not see within the reach of both.
fn places(table: &Table, reaches: &Reaches) -> [Vec3; 3] {
    let middle = |cell: CellId| {
        let c = &table.cells()[cell.idx()];
        Vec3::from_array(std::array::from_fn(|k| ((c.min[k] + c.max[k]) / 2.0) as f32))
    };
    let n = table.n_cells() as u32;
    let wide =
        |cell: &CellId| (0..3).all(|k| table.cells()[cell.idx()].max[k] - table.cells()[cell.idx()].min[k] > 0.5);
    let wide_ones = || (0..n).map(CellId).filter(wide);
    for a in wide_ones() {
        // Both have 1 m, and the cells of either are taken whole.
        let hidden = wide_ones().find(|&b| reaches.rung(a, b) >= 4);
        let seen = wide_ones().find(|&b| b != a && reaches.rung(a, b) == 0);
        if let (Some(b), Some(c)) = (hidden, seen) {
            return [a, c, b].map(middle);
        }
    }
    panic!("the tower has such cells");
}

/// How many bodies a client knows.
fn known(client: &mut App) -> usize {
    client.world_mut().query::<&Remote>().iter(client.world()).len()
}

#[test]
fn what_cannot_be_seen_in_time_is_not_sent() {
    let table = Arc::new(table("tower.pvs"));
    let reaches = Reaches::of(&table, &ReachOptions::default()).expect("a table with places");
    let [a, near, far] = places(&table, &reaches);
    let (mut server, mut client) = (networked(), networked());
    server.add_plugins(PvsRepliconPlugin);
    server.insert_resource(PvsServer::new(table, reaches, LATENCY));
    server.finish();
    client.finish();
    server.connect_client(&mut client);
    let spawn = |server: &mut App, at: Vec3| {
        server.world_mut().spawn((Replicated, body(), Transform::from_translation(at))).id()
    };
    let [own, seen, hidden] = [a, near, far].map(|at| spawn(&mut server, at));
    let connection = **client.world().resource::<TestClientEntity>();
    server.world_mut().entity_mut(connection).insert(PvsClient(own));
    let exchange = |server: &mut App, client: &mut App| {
        for _ in 0..3 {
            server.update();
            server.exchange_with_client(client);
            client.update();
        }
    };
    exchange(&mut server, &mut client);
    let told = |server: &App, of| server.world().resource::<PvsServer>().is_shown(own, of);
    assert_eq!((known(&mut client), told(&server, seen), told(&server, hidden)), (2, true, false));

    // Somebody who comes into sight is sent, and so is who joins in sight; who joins out of sight is not.
    server.world_mut().entity_mut(hidden).insert(Transform::from_translation(near));
    exchange(&mut server, &mut client);
    assert_eq!((known(&mut client), told(&server, hidden)), (3, true));
    let late = spawn(&mut server, far);
    exchange(&mut server, &mut client);
    assert_eq!((known(&mut client), told(&server, late)), (3, false));
    server.world_mut().entity_mut(seen).despawn();
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 2);
    spawn(&mut server, near);
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 3);

    // What is no body any more is sent, and so is everything to a client without one.
    server.world_mut().entity_mut(late).remove::<PvsBody>();
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 4);
    spawn(&mut server, far);
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 4);
    server.world_mut().entity_mut(connection).remove::<PvsClient>();
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 5);

    // With the body again; and when it dies, nothing is known of what the client sees.
    server.world_mut().entity_mut(connection).insert(PvsClient(own));
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 4);
    server.world_mut().entity_mut(own).despawn();
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 4);
    let next = spawn(&mut server, a);
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 5);
    server.world_mut().entity_mut(connection).insert(PvsClient(next));
    exchange(&mut server, &mut client);
    assert_eq!(known(&mut client), 4);
}

#[test]
fn without_the_plugin_everything_is_sent() {
    let reaches = Reaches::of(&table("tower.pvs"), &ReachOptions::default()).expect("a table with places");
    let [a, near, far] = places(&table("tower.pvs"), &reaches);
    let (mut server, mut client) = (networked(), networked());
    server.finish();
    client.finish();
    server.connect_client(&mut client);
    for at in [a, near, far] {
        server.world_mut().spawn((Replicated, body(), Transform::from_translation(at)));
    }
    server.update();
    server.exchange_with_client(&mut client);
    client.update();
    assert_eq!(known(&mut client), 3);
}

#[test]
fn files_are_read_and_misfits_refused() {
    let folder = std::env::temp_dir().join(format!("sightlines-server-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (small, tower) = (assets().join("small.pvs"), assets().join("tower.pvs"));
    let reaches = Reaches::of(&table("small.pvs"), &ReachOptions::default()).expect("a table with places");
    let rel = folder.join("small.rel");
    std::fs::write(&rel, reaches.to_bytes()).expect("a file is written");
    assert!(PvsServer::load(&small, Some(&rel), LATENCY).is_ok() && PvsServer::load(&small, None, LATENCY).is_ok());
    let other = PvsServer::load(&tower, Some(&rel), LATENCY);
    assert!(matches!(other, Err(PvsServerError::Reaches { .. })), "{other:?}");
    assert!(matches!(PvsServer::load(&rel, None, LATENCY), Err(PvsServerError::Table { .. })));
    assert!(matches!(PvsServer::load(&folder.join("none"), None, LATENCY), Err(PvsServerError::Read { .. })));
    std::fs::remove_dir_all(&folder).expect("it is ours");
}
