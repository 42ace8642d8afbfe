//! What all methods have in common: a scene and a camera in, fragments in order or a picture out.

use crate::camera::Camera;
use crate::chosen::Chosen;
use crate::counters::Counters;
use crate::faces::{Faces, NOTHING};
use crate::fragment::Fragment;
use crate::image::Image;

/// What is to be drawn: a scene, from an eye, of it those faces that culling has left.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// The scene.
    pub faces: &'a Faces,
    /// The eye and its picture.
    pub camera: &'a Camera,
    /// What may be drawn.
    pub chosen: &'a Chosen,
}

/// What a method answers.
#[derive(Debug, Clone)]
pub enum Seen {
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
    fn see(&self, shot: &Shot<'_>, counters: &mut Counters) -> Seen;

    /// The picture of what is seen, and what it took.
    fn picture(&self, shot: &Shot<'_>) -> (Image, Counters) {
        drawn(self, shot)
    }
}

/// The picture of what a method answers.
pub(crate) fn drawn<M: VisibleSurface + ?Sized>(method: &M, shot: &Shot<'_>) -> (Image, Counters) {
    let mut counters = Counters::default();
    let image = match method.see(shot, &mut counters) {
        Seen::Picture(image) => image,
        Seen::BackToFront(fragments) => back_to_front(shot, &fragments, &mut counters),
        Seen::FrontToBack(fragments) => {
            let mut canvas = Canvas::new(shot);
            let _ = fragments.iter().find(|fragment| canvas.draw(fragment, &mut counters) == 0);
            canvas.finish()
        }
    };
    counters.covered = image.n_covered();
    (image, counters)
}

/// Draws fragments one over the other.
fn back_to_front(shot: &Shot<'_>, fragments: &[Fragment], counters: &mut Counters) -> Image {
    let mut image = Image::new(shot.camera.size());
    for fragment in fragments {
        let mut written = 0;
        counters.exact += fragment.spans(shot.camera, shot.faces, |y, from, to| {
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
    shot: &'a Shot<'a>,
    image: Image,
    /// For each row how many pixels show nothing yet.
    open: Vec<u32>,
    n_open: u64,
}

impl<'a> Canvas<'a> {
    pub(crate) fn new(shot: &'a Shot<'a>) -> Self {
        let [width, height] = shot.camera.size();
        let n_open = u64::from(width) * u64::from(height);
        Self { shot, image: Image::new([width, height]), open: vec![width; height as usize], n_open }
    }

    /// Draws a fragment; how many pixels show nothing after it.
    pub(crate) fn draw(&mut self, fragment: &Fragment, counters: &mut Counters) -> u64 {
        let mut written = 0;
        let Self { shot, image, open, .. } = self;
        counters.exact += fragment.spans(shot.camera, shot.faces, |y, from, to| {
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
