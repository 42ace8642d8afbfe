//! The sounds that parts of a Quake map make.

use sightlines::formats::quake::bsp::{AmbientTexture, AmbientTextures};

/// A sound that can be turned off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sound {
    /// Wind, from the sky
    Sky,
    /// Water
    Water,
    /// Slime, which sounds like water
    Slime,
    /// Lava
    Lava,
}

impl Sound {
    pub(crate) const ALL: [Self; 4] = [Self::Sky, Self::Water, Self::Slime, Self::Lava];

    fn texture(self) -> AmbientTexture {
        match self {
            Self::Sky => AmbientTexture::Sky,
            Self::Water => AmbientTexture::Water,
            Self::Slime => AmbientTexture::Slime,
            Self::Lava => AmbientTexture::Lava,
        }
    }
}

/// The textures that make sounds if those in the list are turned off.
pub(super) fn all_but(off: &[Sound]) -> AmbientTextures {
    off.iter().fold(AmbientTextures::ALL, |textures, sound| textures.without(sound.texture()))
}
