//! What is known of the surfaces of a scene under a light.

use crate::{Piece, State};
use sightlines_multifocal::{Guarantee, Volume};

/// Areas of pieces by state, in squared scene units, rounded. Both sides of a face count.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LightingAreas {
    /// Of what is wholly in umbra.
    pub umbra: f64,
    /// Of what is wholly lit.
    pub lit: f64,
    /// Of the rest.
    pub in_doubt: f64,
    /// Of the pieces in doubt that rays found to be neither wholly in umbra nor wholly lit: an estimate of what no method can decide at this
    /// size.
    pub mixed: f64,
}

impl LightingAreas {
    /// Of all pieces.
    pub fn total(&self) -> f64 {
        self.umbra + self.lit + self.in_doubt
    }

    pub(crate) fn add(&mut self, piece: &Piece, face_area: f64) {
        // A power of two: exact while it does not underflow.
        let area = face_area * 0.5f64.powi(i32::try_from(piece.depth).unwrap_or(i32::MAX));
        match piece.state {
            State::Umbra => self.umbra += area,
            State::Lit => self.lit += area,
            State::InDoubt => {
                self.in_doubt += area;
                self.mixed += if piece.is_mixed { area } else { 0.0 };
            }
        }
    }
}

/// The effort.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LightCounters {
    /// Sides of faces that face away from all of the light.
    pub n_facing_away: u64,
    /// Faces that were found hidden with the box of a group of faces.
    pub n_in_groups: u64,
    /// Queries of the from-region method: about boxes and about pieces.
    pub n_asked: u64,
    /// Hulls of light and piece that were searched for blockers.
    pub n_hulls: u64,
    /// Faces that were tested against hulls.
    pub n_tested: u64,
    /// Rays that were cast to save work.
    pub n_rays: u64,
}

/// What is known of the surfaces of a scene under a light.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    pub(crate) light: Volume,
    pub(crate) guarantee: Guarantee,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) areas: LightingAreas,
    pub(crate) counters: LightCounters,
}

impl Lighting {
    /// The light.
    pub fn light(&self) -> &Volume {
        &self.light
    }

    /// On which side the from-region method errs. What is classified as lit is proven in any case.
    pub fn guarantee(&self) -> Guarantee {
        self.guarantee
    }

    /// All pieces, in ascending order of faces, fronts before backs. Those of one side of a face cover it and do not overlap, but for
    /// the rounding of their corners.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The areas of the states.
    pub fn areas(&self) -> &LightingAreas {
        &self.areas
    }

    /// The effort.
    pub fn counters(&self) -> &LightCounters {
        &self.counters
    }
}
