//! Pictures that say for each pixel which face is seen.

use crate::faces::NOTHING;

/// For each pixel the face that is seen there, or [`NOTHING`]: row by row, from the upper left corner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    size: [u32; 2],
    faces: Vec<u32>,
}

impl Image {
    /// A picture in which nothing is seen.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, faces: vec![NOTHING; size[0] as usize * size[1] as usize] }
    }

    /// Pixels to the right and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The faces, row by row.
    pub fn faces(&self) -> &[u32] {
        &self.faces
    }

    /// The faces, row by row, to be changed.
    pub fn faces_mut(&mut self) -> &mut [u32] {
        &mut self.faces
    }

    /// The face at a pixel.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn at(&self, x: u32, y: u32) -> u32 {
        assert!(x < self.size[0], "a picture is {} pixels wide", self.size[0]);
        self.faces[y as usize * self.size[0] as usize + x as usize]
    }

    /// The pixels of a row from one to before another.
    pub(crate) fn span_mut(&mut self, y: u32, from: u32, to: u32) -> &mut [u32] {
        let row = y as usize * self.size[0] as usize;
        &mut self.faces[row + from as usize..row + to as usize]
    }

    /// Number of pixels that show a face.
    pub fn n_covered(&self) -> u64 {
        self.faces.iter().filter(|&&f| f != NOTHING).count() as u64
    }

    /// The pixels, as x and y, in which two pictures of one size differ.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn differing<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = [u32; 2]> + 'a {
        assert_eq!(self.size, other.size, "only pictures of one size are compared");
        let width = self.size[0];
        let unlike = self.faces.iter().zip(&other.faces).zip(0u32..).filter(|((a, b), _)| a != b);
        unlike.map(move |(_, i)| [i % width, i / width])
    }
}
