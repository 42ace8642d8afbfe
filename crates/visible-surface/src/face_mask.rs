//! Which faces a method is given: what culling has left.

use crate::faces::Faces;

/// A set of faces. Culling takes faces away; methods draw what is left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaceMask {
    keep: Vec<bool>,
}

impl FaceMask {
    /// All faces that have an area.
    pub fn all(faces: &Faces) -> Self {
        Self { keep: faces.ids().map(|f| faces.has_area(f)).collect() }
    }

    /// Whether a face is in the set.
    #[inline]
    pub fn has(&self, face: u32) -> bool {
        self.keep[face as usize]
    }

    /// Keeps those of the faces for which `keep` says so; how many went.
    pub fn retain(&mut self, mut keep: impl FnMut(u32) -> bool) -> u64 {
        let mut gone = 0;
        for (face, kept) in (0..).zip(&mut self.keep) {
            if *kept && !keep(face) {
                *kept = false;
                gone += 1;
            }
        }
        gone
    }

    /// The faces, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        (0..).zip(&self.keep).filter(|(_, k)| **k).map(|(f, _)| f)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.keep.iter().filter(|k| **k).count()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        !self.keep.contains(&true)
    }
}
