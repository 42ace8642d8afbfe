//! Small scenes made of bytes, and what has to hold for whoever says what an eye sees of them.

use sightlines::geometry::Point3;
use sightlines::visible_surface::{
    Bsp, BspOptions, Camera, Chosen, DepthFormat, Faces, Newell, Painter, RayCaster, Schumacker, SchumackerOptions,
    Shot, VisibleSurface, ZBuffer, compare, cull,
};

/// Triangles and an eye.
#[derive(Debug)]
pub struct SmallShot {
    faces: Faces,
    camera: Camera,
}

/// Numbers of a byte string, one after the other; zeros at its end.
struct Numbers<'a>(std::slice::Iter<'a, u8>);

impl Numbers<'_> {
    fn one(&mut self) -> u8 {
        *self.0.next().unwrap_or(&0)
    }

    /// Mostly eighths between -1 and 1; else the same beside it, scaled, or any double.
    fn coordinate(&mut self) -> f64 {
        let small = |byte: u8| f64::from(i32::from(byte) % 17 - 8) / 8.0;
        let kind = self.one();
        let x = small(self.one());
        match kind {
            0..=219 => x,
            220..=233 => f64::from_bits(x.to_bits() ^ 1),
            234..=247 => x * 2f64.powi(i32::from(self.one()) - 128),
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.one()))),
        }
    }

    fn point(&mut self) -> Point3 {
        std::array::from_fn(|_| self.coordinate())
    }
}

impl SmallShot {
    /// The scene that bytes stand for; none if their numbers are refused.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut numbers = Numbers(bytes.iter());
        let (eye, at) = (numbers.point(), numbers.point());
        let angle = f64::from(numbers.one() % 180);
        let [w, h] = [numbers.one() % 16, numbers.one() % 16].map(u32::from);
        let mut camera = Camera::look_at(eye, at, [0.0, 1.0, 0.0], angle, [w, h]).ok()?;
        let depths = [numbers.coordinate(), numbers.coordinate()];
        if let Ok(limited) = camera.with_depths(depths[0], depths[1]) {
            camera = limited;
        }
        let mut corners = Vec::new();
        while numbers.0.len() > 0 && corners.len() < 12 {
            corners.push(std::array::from_fn(|_| numbers.point()));
        }
        Some(Self { faces: Faces::new(corners).ok()?, camera })
    }

    /// Exact methods show the same, culling changes nothing, and whatever else there is does not panic.
    ///
    /// # Panics
    /// If that does not hold.
    pub fn check(&self) {
        let Self { faces, camera } = self;
        let all = Chosen::all(faces);
        let shot = Shot { faces, camera, chosen: &all };
        let caster = RayCaster::build(faces);
        let reference = caster.picture(&shot).0;
        let bsp = Bsp::build(faces, &BspOptions::default());
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
        let shot = Shot { chosen: &left, ..shot };
        assert_eq!(caster.picture(&shot).0, reference, "what is outside the view is not seen in {self:?}");
    }
}
