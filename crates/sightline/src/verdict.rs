//! The answer of every solver of this crate: visible with a line, hidden with a proof, or undecided.

use std::convert::Infallible;

/// Whether an open set of lines exists, with the evidence.
///
/// * `Line`: the evidence that one does, such as [`PlanarWitness`](crate::PlanarWitness).
/// * `Proof`: the evidence that none does, such as [`PlanarCertificate`](crate::PlanarCertificate); `()` where the
///   proof is left to a second call ([`Shaft::certify`](crate::Shaft::certify)).
/// * `Doubt`: why neither was found. Exact solvers have [`Infallible`] here, so a `match` on their verdict needs two
///   arms only.
///
/// A conservative caller treats [`Verdict::Undecided`] as visible: [`Verdict::may_be_visible`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict<Line, Proof, Doubt = Infallible> {
    /// An open set of lines exists; here is one of them.
    Visible(Line),
    /// No open set of lines exists; here is why.
    Hidden(Proof),
    /// Neither a line nor a proof was found.
    Undecided(Doubt),
}

/// Neither a line nor a proof was found within the limits: those of the caller on effort, or those of doubles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, thiserror::Error)]
#[error("neither a line nor a proof was found within the limits")]
pub struct LimitReached;

impl<Line, Proof, Doubt> Verdict<Line, Proof, Doubt> {
    /// Whether a line was found.
    #[inline]
    pub const fn is_visible(&self) -> bool {
        matches!(self, Self::Visible(_))
    }

    /// Whether it is proven that no open set of lines exists.
    #[inline]
    pub const fn is_hidden(&self) -> bool {
        matches!(self, Self::Hidden(_))
    }

    /// Everything but hidden: the conservative reading.
    #[inline]
    pub const fn may_be_visible(&self) -> bool {
        !self.is_hidden()
    }

    /// The line, if one was found.
    pub fn line(self) -> Option<Line> {
        match self {
            Self::Visible(line) => Some(line),
            Self::Hidden(_) | Self::Undecided(_) => None,
        }
    }

    /// The proof, if one was found.
    pub fn proof(self) -> Option<Proof> {
        match self {
            Self::Hidden(proof) => Some(proof),
            Self::Visible(_) | Self::Undecided(_) => None,
        }
    }
}
