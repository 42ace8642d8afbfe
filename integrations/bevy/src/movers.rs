//! Things that move.

use bevy::prelude::*;

/// Something that moves: it and all below it are drawn where their boxes (`Aabb`) meet a cell that is seen, wherever they are at the moment.
///
/// Not needed for nodes of a level that move away from where their file puts them: that is noticed, and they are judged in the same
/// way. Entities that are in no table and have no such component are left to Bevy.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct PvsMover;
