//! Who sees, and who is seen.

use sightlines_geometry::Aabb;

/// Somebody who sees and is seen, and how far they may move until the answer counts.
///
/// All lengths are in scene units; in a plan the third coordinate does not count. A box with a NaN or without points, and a reach or an arm that is NaN or
/// negative, is somebody of whom nothing is known: everybody sees them, and they see everybody.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Where their eyes can be: where the engine may put its camera now, but for [`Body::arm`].
    pub eyes: Aabb<3>,
    /// All of them that can be seen: with what they carry and wear.
    pub seen: Aabb<3>,
    /// How far any part of them may get: speed × (round trip + interpolation + tick).
    pub reach: f64,
    /// How far the camera may be from the eyes, for cameras that follow a body; 0 for eyes in the head.
    pub arm: f64,
}

impl Body {
    /// Somebody who stands still.
    pub const fn new(eyes: Aabb<3>, seen: Aabb<3>) -> Self {
        Self { eyes, seen, reach: 0.0, arm: 0.0 }
    }

    /// The same who may move at a speed (scene units a second) for some seconds.
    #[must_use]
    pub const fn moving(mut self, speed: f64, seconds: f64) -> Self {
        self.reach = speed * seconds;
        self
    }

    /// The same with a camera at the end of an arm (scene units).
    #[must_use]
    pub const fn with_arm(mut self, arm: f64) -> Self {
        self.arm = arm;
        self
    }

    /// Whether the reach and the arm are lengths.
    pub(crate) fn has_lengths(&self) -> bool {
        self.reach >= 0.0 && self.arm >= 0.0
    }

    /// How far the camera may get.
    pub(crate) fn eye_reach(&self) -> f64 {
        self.reach + self.arm
    }
}

/// What somebody is in the game.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlayerRole {
    /// Their team, 1 to 63; 0 for none.
    pub team: u8,
    /// The teams that they are shown wherever these are, as bits: bit `t` for team `t`, bit 0 for those without one. All bits for spectators who see everything.
    pub sees_always: u64,
    /// Whether they are told of others.
    pub views: bool,
    /// Whether others are told of them; not so for spectators, who have no body.
    pub is_seen: bool,
}

impl PlayerRole {
    /// A player of a team, who is always told of their own team.
    ///
    /// # Panics
    /// If the team is 0, or above 63.
    pub const fn of_team(team: u8) -> Self {
        assert!(0 < team && team < 64, "teams are numbered from 1 to 63");
        Self { team, sees_always: 1 << team, views: true, is_seen: true }
    }

    /// A player on their own: told of nobody but of whom they may see.
    pub const ALONE: Self = Self { team: 0, sees_always: 0, views: true, is_seen: true };

    /// Somebody who is told of everybody, and of whom nobody is told.
    pub const SPECTATOR: Self = Self { team: 0, sees_always: u64::MAX, views: true, is_seen: false };

    /// A thing that others may see, such as a door or a projectile; it sees nobody.
    pub const THING: Self = Self { team: 0, sees_always: 0, views: false, is_seen: true };

    /// Whether somebody with this role is told of the other wherever that is.
    pub(crate) const fn always_sees(&self, other: &Self) -> bool {
        other.team < 64 && self.sees_always >> other.team & 1 == 1
    }
}

/// A body with its role.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Player {
    /// Where it is.
    pub body: Body,
    /// What it is.
    pub role: PlayerRole,
}
