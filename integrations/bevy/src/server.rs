//! Who is to be told of whom: a server's side of a table.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use sightlines_geometry::Aabb;
use sightlines_pvs::{DecodeError, Table};
use sightlines_relevance::{
    Body, Player, PlayerRole, ReachError, ReachFileError, ReachOptions, Reaches, Relevance, RelevanceOptions,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A body that others may see: a player, a projectile, whatever a server may keep back. Its boxes are offsets from the entity's
/// translation, along the axes of the world, and do not turn with it: make them wide enough for every turn.
#[derive(Component, Debug, Clone, Copy, PartialEq)]
pub struct PvsBody {
    /// Where the eyes can be: lower and upper corner.
    pub eyes: [Vec3; 2],
    /// All of the body that can be seen, with what it carries.
    pub seen: [Vec3; 2],
    /// Its top speed, in units of the world a second.
    pub speed: f32,
    /// How far a camera that follows the body may be from the eyes; 0 for eyes in the head.
    pub arm: f32,
    /// Its team, and whether it is told of others.
    pub role: PlayerRole,
}

impl PvsBody {
    /// Somebody on foot, whose entity is at the feet: with eyes from half the height up, and arms' length around.
    ///
    /// * `height`: in units of the world, with the y axis up
    /// * `speed`: units a second
    pub fn on_foot(height: f32, speed: f32) -> Self {
        let wide = height * 0.5;
        Self {
            eyes: [Vec3::new(0.0, height * 0.5, 0.0), Vec3::new(0.0, height, 0.0)],
            seen: [Vec3::new(-wide, 0.0, -wide), Vec3::new(wide, height, wide)],
            speed,
            arm: 0.0,
            role: PlayerRole::ALONE,
        }
    }

    fn player(&self, at: Vec3, latency: f64) -> Player {
        let at = at.as_dvec3();
        let around = |[min, max]: [Vec3; 2]| Aabb {
            min: (at + min.as_dvec3()).to_array(),
            max: (at + max.as_dvec3()).to_array(),
        };
        let body = Body::new(around(self.eyes), around(self.seen)).moving(f64::from(self.speed), latency);
        Player { body: body.with_arm(f64::from(self.arm)), role: self.role }
    }
}

/// Somebody is told of a body from now on, or no longer. Of bodies and viewers that are new every pair is listed.
#[derive(Message, Debug, Clone, Copy, PartialEq, Eq)]
pub struct PvsTold {
    /// The body of who is told.
    pub to: Entity,
    /// Of whom.
    pub of: Entity,
    /// Whether from now on, or no longer.
    pub shown: bool,
}

/// Why a server has no answers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PvsServerError {
    /// A file cannot be read.
    #[error("{path}: cannot be read", path = .path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is no plain table.
    #[error("{path}: no visibility table", path = .path.display())]
    Table {
        /// Which.
        path: PathBuf,
        /// Why.
        source: DecodeError,
    },
    /// A file has no reaches of the table.
    #[error("{path}: no reaches of the table", path = .path.display())]
    Reaches {
        /// Which.
        path: PathBuf,
        /// Why.
        source: ReachFileError,
    },
    /// The table has no reaches.
    #[error("{path}: no reaches can be found", path = .path.display())]
    Find {
        /// Which.
        path: PathBuf,
        /// Why.
        source: ReachError,
    },
}

/// Who is told of whom, for all entities with a [`PvsBody`]: a resource of a server with the [`PvsServerPlugin`].
///
/// The level stands in the world as in its file: not moved, and without `convert_coordinates`.
#[derive(Resource, Debug)]
pub struct PvsServer {
    relevance: Relevance,
    latency: f64,
    /// Entities by their places in the list of players.
    places: Vec<Option<Entity>>,
    place_of: EntityHashMap<u32>,
    players: Vec<Player>,
    /// Whose places are new.
    joined: Vec<u32>,
}

/// Nobody: takes a place that is free.
const NOBODY: Player = Player {
    body: Body::new(Aabb { min: [0.0; 3], max: [0.0; 3] }, Aabb { min: [0.0; 3], max: [0.0; 3] }),
    role: PlayerRole { team: 0, sees_always: 0, views: false, is_seen: false },
};

impl PvsServer {
    /// Of a table and its reaches.
    ///
    /// * `latency`: the longest time in seconds until what is sent is drawn: round trip, interpolation and a tick, of the slowest client
    pub fn new(table: Arc<Table>, reaches: Reaches, latency: f32) -> Self {
        let options = RelevanceOptions::of(&table);
        Self {
            relevance: Relevance::new(table, reaches, options),
            latency: f64::from(latency),
            places: Vec::new(),
            place_of: EntityHashMap::default(),
            players: Vec::new(),
            joined: Vec::new(),
        }
    }

    /// Of files: a `.pvs`, and the `.rel` that `sightlines relevance` made of it. Without that, the usual reaches are found now, which takes seconds for
    /// thousands of cells.
    ///
    /// # Errors
    /// [`PvsServerError`].
    pub fn load(table: &Path, reaches: Option<&Path>, latency: f32) -> Result<Self, PvsServerError> {
        let read =
            |path: &Path| std::fs::read(path).map_err(|source| PvsServerError::Read { path: path.to_owned(), source });
        let path = table.to_owned();
        let table =
            Table::from_bytes(&read(table)?).map_err(|source| PvsServerError::Table { path: path.clone(), source })?;
        let reaches = match reaches {
            Some(from) => Reaches::from_bytes(&read(from)?, &table)
                .map_err(|source| PvsServerError::Reaches { path: from.to_owned(), source })?,
            None => Reaches::of(&table, &ReachOptions::default())
                .map_err(|source| PvsServerError::Find { path: path.clone(), source })?,
        };
        Ok(Self::new(Arc::new(table), reaches, latency))
    }

    /// What answers: for `may_see_within`, `time_to_sight`, deadlines and exposure.
    pub const fn relevance_mut(&mut self) -> &mut Relevance {
        &mut self.relevance
    }

    /// Whether somebody was to be told of a body in the last frame. Of entities without a [`PvsBody`] nothing is known: so it is of them.
    pub fn is_shown(&self, to: Entity, of: Entity) -> bool {
        match (self.place_of.get(&to), self.place_of.get(&of)) {
            (Some(to), Some(of)) => to == of || self.relevance.is_shown(*to, *of),
            _ => true,
        }
    }

    fn leave(&mut self, entity: Entity) {
        if let Some(place) = self.place_of.remove(&entity) {
            (self.places[place as usize], self.players[place as usize]) = (None, NOBODY);
        }
    }

    fn set(&mut self, entity: Entity, player: Player) {
        if let Some(&place) = self.place_of.get(&entity) {
            self.players[place as usize] = player;
            return;
        }
        let free = self.places.iter().position(Option::is_none);
        let place = free.unwrap_or(self.places.len());
        if place == self.places.len() {
            self.places.push(None);
            self.players.push(NOBODY);
        }
        (self.places[place], self.players[place]) = (Some(entity), player);
        self.place_of.insert(entity, place as u32);
        self.joined.push(place as u32);
    }

    /// Tells what changed.
    fn update(&mut self, now: f64, mut tell: impl FnMut(PvsTold)) {
        self.relevance.update(now, &self.players);
        let changes = self.relevance.changes();
        for (pairs, shown) in [(&changes.gained, true), (&changes.lost, false)] {
            for pair in pairs {
                // A place may be free again, or somebody else's: they are told of below.
                let is_new = pair.iter().any(|place| self.joined.contains(place));
                if let [Some(to), Some(of)] = pair.map(|place| self.places[place as usize])
                    && !is_new
                {
                    tell(PvsTold { to, of, shown });
                }
            }
        }
        for &place in &self.joined {
            let Some(joined) = self.places[place as usize] else { continue };
            for other in self.places.iter().flatten().filter(|&&other| other != joined) {
                for (to, of) in [(joined, *other), (*other, joined)] {
                    tell(PvsTold { to, of, shown: self.is_shown(to, of) });
                }
            }
        }
        self.joined.clear();
    }
}

/// Finds in every frame who is to be told of whom, and sends [`PvsTold`]. Needs the resource [`PvsServer`], from when it is there on.
#[derive(Debug, Clone, Copy, Default)]
pub struct PvsServerPlugin;

/// The system of [`PvsServerPlugin`], in `PostUpdate`, after transforms were propagated.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PvsServerSystems;

impl Plugin for PvsServerPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<PvsTold>().add_systems(
            PostUpdate,
            tell.run_if(resource_exists::<PvsServer>).in_set(PvsServerSystems).after(TransformSystems::Propagate),
        );
    }
}

fn tell(
    mut server: ResMut<PvsServer>,
    time: Res<Time>,
    bodies: Query<(Entity, &PvsBody, &GlobalTransform)>,
    mut gone: RemovedComponents<PvsBody>,
    mut told: MessageWriter<PvsTold>,
) {
    gone.read().filter(|&entity| !bodies.contains(entity)).for_each(|entity| server.leave(entity));
    let latency = server.latency;
    for (entity, body, at) in &bodies {
        server.set(entity, body.player(at.translation(), latency));
    }
    server.update(time.elapsed_secs_f64(), |change| {
        told.write(change);
    });
}
