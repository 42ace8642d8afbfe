//! What all methods have in common: a scene and a camera in, fragments in order or a picture out.

use crate::camera::Camera;
use crate::counters::Counters;
use crate::face_mask::FaceMask;
use crate::faces::{Faces, NOTHING};
use crate::fragment::Fragment;
use crate::image::Image;

/// What is to be drawn: a scene, from an eye, of it those faces that culling has left.
#[derive(Debug, Clone, Copy)]
pub struct RenderInput<'a> {
    /// The scene.
    pub faces: &'a Faces,
    /// The eye and its picture.
    pub camera: &'a Camera,
    /// What may be drawn.
    pub mask: &'a FaceMask,
}

/// What a method answers.
#[derive(Debug, Clone)]
pub enum RenderOutput {
    /// Fragments of which later ones hide earlier ones.
    BackToFront(Vec<Fragment>),
    /// Fragments of which earlier ones hide later ones.
    FrontToBack(Vec<Fragment>),
    /// What each pixel shows.
    Picture(Image),
}

/// A method of visible-surface determination.
pub trait VisibleSurface: std::fmt::Debug {
    /// What it is called.
    fn name(&self) -> &'static str;

    /// What is seen. Faces that are seen edge-on show nothing. Where two faces are at one depth, the one with the
    /// lower id is seen; if they lie in different planes, either may be.
    fn see(&self, input: &RenderInput<'_>, counters: &mut Counters) -> RenderOutput;

    /// The picture of what is seen, and what it took.
    fn picture(&self, input: &RenderInput<'_>) -> (Image, Counters) {
        drawn(self, input)
    }
}

/// The picture of what a method answers.
pub(crate) fn drawn<M: VisibleSurface + ?Sized>(method: &M, input: &RenderInput<'_>) -> (Image, Counters) {
    let mut counters = Counters::default();
    let image = match method.see(input, &mut counters) {
        RenderOutput::Picture(image) => image,
        RenderOutput::BackToFront(fragments) => back_to_front(input, &fragments, &mut counters),
        RenderOutput::FrontToBack(fragments) => {
            let mut canvas = Canvas::new(input);
            let _ = fragments.iter().find(|fragment| canvas.draw(fragment, &mut counters) == 0);
            canvas.finish()
        }
    };
    counters.covered = image.n_covered();
    (image, counters)
}

/// Draws fragments one over the other.
fn back_to_front(input: &RenderInput<'_>, fragments: &[Fragment], counters: &mut Counters) -> Image {
    let mut image = Image::new(input.camera.size());
    for fragment in fragments {
        let mut written = 0;
        counters.exact += fragment.spans(input.camera, input.faces, |y, from, to| {
            image.span_mut(y, from, to).fill(fragment.face());
            written += u64::from(to - from);
        });
        counters.written += written;
        counters.fragments += 1;
    }
    image
}

/// A picture into which fragments are drawn where nothing is yet.
#[derive(Debug)]
pub(crate) struct Canvas<'a> {
    input: &'a RenderInput<'a>,
    image: Image,
    /// For each row how many pixels show nothing yet.
    open: Vec<u32>,
    n_open: u64,
}

impl<'a> Canvas<'a> {
    pub(crate) fn new(input: &'a RenderInput<'a>) -> Self {
        let [width, height] = input.camera.size();
        let n_open = u64::from(width) * u64::from(height);
        Self { input, image: Image::new([width, height]), open: vec![width; height as usize], n_open }
    }

    /// Draws a fragment; how many pixels show nothing after it.
    pub(crate) fn draw(&mut self, fragment: &Fragment, counters: &mut Counters) -> u64 {
        let mut written = 0;
        let Self { input, image, open, .. } = self;
        counters.exact += fragment.spans(input.camera, input.faces, |y, from, to| {
            if open[y as usize] == 0 {
                return;
            }
            let mut new = 0;
            for pixel in image.span_mut(y, from, to).iter_mut().filter(|p| **p == NOTHING) {
                *pixel = fragment.face();
                new += 1;
            }
            open[y as usize] -= new;
            written += u64::from(new);
        });
        self.n_open -= written;
        counters.written += written;
        counters.fragments += 1;
        self.n_open
    }

    pub(crate) fn finish(self) -> Image {
        self.image
    }
}
