//! Pictures of soft shadows: what is decided is drawn as it is, and rays are cast for the rest.

use crate::{Lighting, Piece, Shadows, Side, State};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{cross, dot, sub};
use sightlines_multifocal::Volume;
use sightlines_visible_surface::{
    Camera, DepthFormat, FaceMask, Faces, Image, NOTHING, RenderInput, VisibleSurface, ZBuffer,
};

/// How a pixel is lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shade {
    /// Nothing is seen there.
    Nothing,
    /// Wholly in umbra.
    Umbra,
    /// Wholly lit.
    Lit,
    /// In doubt: the share of the light that arrives, from 0 to 1, by rays.
    Traced(f64),
}

impl Shade {
    /// The share of the light that arrives, from 0 to 1; none where nothing is seen.
    pub fn share(self) -> Option<f64> {
        match self {
            Self::Nothing => None,
            Self::Umbra => Some(0.0),
            Self::Lit => Some(1.0),
            Self::Traced(share) => Some(share),
        }
    }
}

/// How each pixel is lit, row by row from the upper left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPicture {
    /// Pixels to the right and down.
    pub size: [u32; 2],
    /// One for each pixel.
    pub shades: Vec<Shade>,
    /// Rays that were cast from the light.
    pub n_rays: u64,
    /// Rays that a picture without a classification would take.
    pub n_rays_else: u64,
}

impl LightPicture {
    /// How many pixels are in umbra, lit, and traced.
    pub fn counts(&self) -> [u64; 3] {
        self.shades.iter().fold([0; 3], |[umbra, lit, traced], shade| match shade {
            Shade::Nothing => [umbra, lit, traced],
            Shade::Umbra => [umbra + 1, lit, traced],
            Shade::Lit => [umbra, lit + 1, traced],
            Shade::Traced(_) => [umbra, lit, traced + 1],
        })
    }
}

/// The faces that a picture shows: only these have to be classified for it.
pub fn shown(faces: &Faces, image: &Image) -> FaceMask {
    let mut is_shown = vec![false; faces.len()];
    image.faces().iter().filter(|&&face| face != NOTHING).for_each(|&face| is_shown[face as usize] = true);
    let mut chosen = FaceMask::all(faces);
    chosen.retain(|face| is_shown[face as usize]);
    chosen
}

impl Shadows<'_> {
    /// How each pixel is lit. The pieces of what is seen are drawn by a z-buffer without rounding; where the piece of a pixel is in doubt, or no
    /// piece of the face is met that the pixel shows, rays are cast to the point that the pixel shows.
    ///
    /// * `image`: the face in each pixel, by any method
    /// * `lighting`: of this scene, with the sides that the eye sees. Faces that were not classified are in doubt.
    /// * `n_rays`: for each pixel in doubt
    ///
    /// # Panics
    /// If the picture is not of the camera's size, or shows a face that the scene does not have.
    pub fn picture(&self, lighting: &Lighting, camera: &Camera, image: &Image, n_rays: u32) -> LightPicture {
        let eye = camera.eye();
        let seen = shown(self.faces, image);
        let is_seen = |p: &&Piece| seen.has(p.face) && Side::towards(*self.faces.of(p.face), eye) == Some(p.side);
        let pieces: Vec<&Piece> = lighting.pieces().iter().filter(is_seen).collect();
        // Corners of pieces have been checked, so this is about their number only.
        let drawn = Faces::new(pieces.iter().map(|p| p.corners).collect()).ok().map(|of_pieces| {
            let shot = RenderInput { faces: &of_pieces, camera, mask: &FaceMask::all(&of_pieces) };
            ZBuffer::new(DepthFormat::Exact).picture(&shot).0
        });
        self.shaded(lighting.light(), camera, image, n_rays, |i, face| {
            let piece = drawn.as_ref().map_or(NOTHING, |drawn| drawn.faces()[i]);
            let piece = pieces.get(piece as usize).filter(|p| p.face == face);
            piece.map_or(State::InDoubt, |p| p.state)
        })
    }

    /// The same by rays alone.
    ///
    /// # Panics
    /// As [`Self::picture`].
    pub fn traced(&self, light: &Volume, camera: &Camera, image: &Image, n_rays: u32) -> LightPicture {
        self.shaded(light, camera, image, n_rays, |_, _| State::InDoubt)
    }

    fn shaded(
        &self,
        light: &Volume,
        camera: &Camera,
        image: &Image,
        n_rays: u32,
        state: impl Fn(usize, u32) -> State,
    ) -> LightPicture {
        assert_eq!(camera.size(), image.size(), "the picture is the camera's");
        let n_rays = n_rays.max(1);
        let width = image.size()[0] as usize;
        let mut n_traced = 0;
        let shade = |(i, &face): (usize, &u32)| {
            if face == NOTHING {
                return Shade::Nothing;
            }
            match state(i, face) {
                State::Umbra => Shade::Umbra,
                State::Lit => Shade::Lit,
                State::InDoubt => {
                    n_traced += 1;
                    let corners = self.faces.of(face);
                    let side = Side::towards(*corners, camera.eye());
                    let p = met(camera, corners, [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5]);
                    let share = |side| self.share(light, p, face, side, n_rays, i as u64);
                    Shade::Traced(side.map_or(0.0, share))
                }
            }
        };
        let shades: Vec<Shade> = image.faces().iter().enumerate().map(shade).collect();
        let n_rays_else = image.n_covered() * u64::from(n_rays);
        LightPicture { size: image.size(), shades, n_rays: n_traced * u64::from(n_rays), n_rays_else }
    }
}

/// Where the ray through a place of the picture meets a face's plane; rounded.
fn met(camera: &Camera, &[a, b, c]: &[Point3; 3], [x, y]: [f64; 2]) -> Point3 {
    let (eye, way) = (camera.eye(), camera.ray(x, y));
    let normal = cross(sub(b, a), sub(c, a));
    let depth = dot(normal, sub(a, eye)) / dot(normal, way);
    std::array::from_fn(|k| eye[k] + depth * way[k])
}
