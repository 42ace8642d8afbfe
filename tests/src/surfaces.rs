//! Small scenes made of bytes, and the properties that every method for one eye must have.

use crate::numbers::Numbers;
use sightlines::geometry::Point3;
use sightlines::visible_surface::{
    BspOptions, Camera, DepthFormat, FaceBsp, FaceMask, Faces, Newell, Painter, RayCaster, RenderInput, Schumacker,
    SchumackerOptions, VisibleSurface, ZBuffer, compare, cull,
};

/// Triangles and an eye.
#[derive(Debug)]
pub struct SmallShot {
    faces: Faces,
    camera: Camera,
}

/// Mostly eighths between -1 and 1; else the same beside it, scaled, or any double.
fn coordinate(numbers: &mut Numbers<'_>) -> f64 {
    let kind = numbers.byte();
    let x = f64::from(i32::from(numbers.byte()) % 17 - 8) / 8.0;
    match kind {
        0..=219 => x,
        220..=233 => f64::from_bits(x.to_bits() ^ 1),
        234..=247 => x * 2f64.powi(i32::from(numbers.byte()) - 128),
        _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| numbers.byte()))),
    }
}

/// A place with such coordinates.
pub(crate) fn point(numbers: &mut Numbers<'_>) -> Point3 {
    std::array::from_fn(|_| coordinate(numbers))
}

impl SmallShot {
    /// The scene that bytes stand for; none if their numbers are refused.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut numbers = Numbers::new(bytes);
        let (eye, at) = (point(&mut numbers), point(&mut numbers));
        let angle = f64::from(numbers.byte() % 180);
        let [w, h] = [numbers.byte() % 16, numbers.byte() % 16].map(u32::from);
        let mut camera = Camera::look_at(eye, at, [0.0, 1.0, 0.0], angle, [w, h]).ok()?;
        let depths = [coordinate(&mut numbers), coordinate(&mut numbers)];
        if let Ok(limited) = camera.with_depths(depths[0], depths[1]) {
            camera = limited;
        }
        let mut corners = Vec::new();
        while !numbers.is_empty() && corners.len() < 12 {
            corners.push(std::array::from_fn(|_| point(&mut numbers)));
        }
        Some(Self { faces: Faces::new(corners).ok()?, camera })
    }

    /// Exact methods show the same, culling changes nothing, and whatever else there is does not panic.
    ///
    /// # Panics
    /// If that does not hold.
    pub fn check(&self) {
        let Self { faces, camera } = self;
        let all = FaceMask::all(faces);
        let shot = RenderInput { faces, camera, mask: &all };
        let caster = RayCaster::build(faces);
        let reference = caster.picture(&shot).0;
        let bsp = FaceBsp::build(faces, &BspOptions::default());
        let exact: [Box<dyn VisibleSurface>; 5] = [
            Box::new(ZBuffer::new(DepthFormat::Exact)),
            Box::new(Newell),
            Box::new(bsp.clone()),
            Box::new(bsp.front_to_back()),
            Box::new(Schumacker::build(faces, &SchumackerOptions::default())),
        ];
        for method in &exact {
            let found = compare(&shot, &reference, &method.picture(&shot).0);
            assert!(found.wrong.is_empty(), "{} is wrong at {:?} of {self:?}", method.name(), found.wrong);
        }
        Painter.picture(&shot);
        DepthFormat::ALL.iter().for_each(|&format| drop(ZBuffer::new(format).picture(&shot)));
        let mut left = all.clone();
        cull::frustum(faces, camera, &mut left);
        let shot = RenderInput { mask: &left, ..shot };
        assert_eq!(caster.picture(&shot).0, reference, "what is outside the view is not seen in {self:?}");
    }
}
