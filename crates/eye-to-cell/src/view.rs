//! Where the viewer is, and which directions the picture covers.

use crate::front::Front;
use crate::side::{MOST_SIDES, Reach, Side, Vector, cross, dot, norm, radius, sub};
use sightlines_geometry::Aabb;
use sightlines_geometry::coordinate::MIN_MAGNITUDE;
use sightlines_geometry::vector::unit_of_any_size;
use sightlines_pvs::Frame;
use std::f64::consts::{PI, TAU};

/// An eye and the cone of directions that it looks at, in the plane or in space.
///
/// The cone is a convex one, or two side by side where it is wider than half of all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    pub(crate) eye: Vector,
    /// Bound on the error of each coordinate of the eye; 0 but for eyes seen in mirrors and with tiny coordinates.
    pub(crate) slack: f64,
    /// One convex cone, or two.
    parts: [ViewPart; 2],
    n_parts: usize,
    /// Whether all this is along the axes of a table's frame already.
    framed: bool,
}

/// A convex cone: the directions within all sides. Takes no memory of its own but for what a mirror frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ViewPart {
    few: [Side; 4],
    n_few: usize,
    /// The other sides of a cone that came out of a mirror; at most [`MOST_SIDES`].
    more: Vec<Side>,
}

/// Why numbers are no view.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// NaN or an infinity in the eye's place.
    #[error("the eye is at no finite place")]
    Eye,
    /// NaN, an infinity, or no direction at all.
    #[error("the direction of view is not finite, or has no length")]
    Direction,
    /// Not above 0, or more than a full turn.
    #[error("a field of view of {0} is not above 0 and at most a full turn")]
    Fov(f64),
    /// Not above 0, or half a turn or more: no picture is as high.
    #[error("a vertical field of view of {0} is not above 0 and below half a turn")]
    VerticalFov(f64),
    /// A matrix that is no perspective projection.
    #[error("the matrix is not finite, or not one of a perspective")]
    Projection,
    /// A matrix of a camera that is not where the eye is.
    #[error("the matrix is that of a camera elsewhere than the eye, or is given by rows instead of columns")]
    OtherEye,
    /// Not above 0, or not finite.
    #[error("an aspect of {0} is not a finite number above 0")]
    Aspect(f64),
}

impl View {
    /// All directions from `eye` (scene units; z is 0 in a plane).
    ///
    /// Coordinates of a smaller magnitude than those of tables have (2^-140) count as 0 and as known to within that, so that no product underflows.
    ///
    /// # Errors
    /// [`ViewError::Eye`].
    pub fn all_round(eye: [f64; 3]) -> Result<Self, ViewError> {
        if !eye.iter().all(|x| x.is_finite()) {
            return Err(ViewError::Eye);
        }
        let is_tiny = |x: f64| x != 0.0 && x.abs() < MIN_MAGNITUDE;
        let slack = if eye.iter().any(|x| is_tiny(*x)) { MIN_MAGNITUDE } else { 0.0 };
        let eye = eye.map(|x| if is_tiny(x) { 0.0 } else { x });
        Ok(Self { eye, slack, parts: Default::default(), n_parts: 1, framed: false })
    }

    /// In the plane: the directions within `fov / 2` on both sides of `dir`. `fov` in radians, above 0 and at most
    /// a full turn; `dir` need not have unit length.
    ///
    /// # Errors
    /// [`ViewError`] for numbers out of range.
    pub fn planar(eye: [f64; 2], dir: [f64; 2], fov: f64) -> Result<Self, ViewError> {
        let d = unit_of_any_size([dir[0], dir[1], 0.0]).ok_or(ViewError::Direction)?;
        check_fov(fov)?;
        let mut view = Self::all_round([eye[0], eye[1], 0.0])?;
        view.cut_by_wedge(d, [d[1], -d[0], 0.0], fov);
        Ok(view)
    }

    /// In space: what a picture shows whose *width* takes the angle `fov` (radians) and whose width is `aspect` times its height.
    /// Engines give the angle of the height as a rule: see [`View::perspective_vertical`].
    ///
    /// `up` says what is up in the picture; it need not be at a right angle to `dir`, and if it is parallel to it,
    /// or zero, some direction is chosen. No picture takes half a turn or more; then the directions are meant whose
    /// angle to `dir` around `up` is at most `fov / 2`, however steep, which is what the picture tends to.
    ///
    /// # Errors
    /// [`ViewError`] for numbers out of range.
    pub fn perspective_horizontal(
        eye: [f64; 3],
        dir: [f64; 3],
        up: [f64; 3],
        fov: f64,
        aspect: f64,
    ) -> Result<Self, ViewError> {
        let forward = unit_of_any_size(dir).ok_or(ViewError::Direction)?;
        check_fov(fov)?;
        if !(aspect.is_finite() && aspect > 0.0) {
            return Err(ViewError::Aspect(aspect));
        }
        let right = right_of(forward, up);
        let mut view = Self::all_round(eye)?;
        view.cut_by_wedge(forward, right, fov);
        if fov < PI {
            let up = cross(right, forward);
            // Half the height is tan(fov / 2) / aspect.
            let (sin, cos) = (0.5 * fov).sin_cos();
            for up_or_down in [1.0, -1.0] {
                let normal = std::array::from_fn(|k| sin * forward[k] + up_or_down * aspect * cos * up[k]);
                view.add_side(normal)?;
            }
        }
        Ok(view)
    }

    /// In space: what a picture shows whose *height* takes the angle `fov` (radians, below half a turn) and whose width is `aspect` times
    /// its height: the angle of view of Bevy, wgpu, Godot, Unity and OpenGL. `dir` and `up` as for [`View::perspective_horizontal`].
    ///
    /// # Errors
    /// [`ViewError`] for numbers out of range.
    pub fn perspective_vertical(
        eye: [f64; 3],
        dir: [f64; 3],
        up: [f64; 3],
        fov: f64,
        aspect: f64,
    ) -> Result<Self, ViewError> {
        if !(fov > 0.0 && fov < PI) {
            return Err(ViewError::VerticalFov(fov));
        }
        if !(aspect.is_finite() && aspect > 0.0) {
            return Err(ViewError::Aspect(aspect));
        }
        let forward = unit_of_any_size(dir).ok_or(ViewError::Direction)?;
        let right = right_of(forward, up);
        let up = cross(right, forward);
        let mut view = Self::all_round(eye)?;
        let (sin, cos) = (0.5 * fov).sin_cos();
        // Half the height is tan(fov / 2), half the width aspect times that.
        for (across, ahead, aside) in [(right, aspect * sin, cos), (up, sin, cos)] {
            for sign in [1.0, -1.0] {
                view.add_side(std::array::from_fn(|k| ahead * forward[k] + sign * aside * across[k]))?;
            }
        }
        Ok(view)
    }

    /// In space: what an engine's picture shows. `view_projection` is the matrix from the scene to clip space, projection times view,
    /// by columns (`to_cols_array_2d` of glam): a point `p` is in the picture if `|x| <= w` and `|y| <= w` in `view_projection * (p, 1)`. Lenses
    /// may be shifted, and either hand and any range of depth is right, reversed and infinite ones, too: only the four sides
    /// are taken, so what is nearer than the near plane or beyond the far one counts as in the picture.
    ///
    /// `eye` is where the camera is, which the engine knows better than its matrix: the sides go through it. They are as exact as the
    /// matrix, which may have been computed in single precision.
    ///
    /// # Errors
    /// [`ViewError::Eye`]; [`ViewError::Projection`] for a matrix that is not finite or not one of a perspective; [`ViewError::OtherEye`] for a
    /// matrix of a camera elsewhere, such as that of the frame before, and for most matrices that are given by rows.
    pub fn from_view_projection(eye: [f64; 3], view_projection: [[f64; 4]; 4]) -> Result<Self, ViewError> {
        let row = |r: usize| [0, 1, 2].map(|column| view_projection[column][r]);
        let (x, y, w) = (row(0), row(1), row(3));
        // A parallel projection has no eye: its w does not depend on the place.
        let volume = dot(cross(x, y), w);
        if !view_projection.as_flattened().iter().all(|x| x.is_finite()) || !volume.is_finite() || volume == 0.0 {
            return Err(ViewError::Projection);
        }
        let mut view = Self::all_round(eye)?;
        // At the eye x, y and w are 0. In single precision the view's last column, products and sums err by some twenty units of 2^-24 of
        // the magnitudes, and turning the camera's axes by some more: 64 units.
        for r in [0, 1, 3] {
            let (v, last) = (row(r), view_projection[3][r]);
            if (dot(v, eye) + last).abs() > 64.0 / f64::from(1u32 << 24) * (norm(v) * dot(eye, eye).sqrt() + last.abs())
            {
                return Err(ViewError::OtherEye);
            }
        }
        for (across, sign) in [(x, 1.0), (x, -1.0), (y, 1.0), (y, -1.0)] {
            let side = std::array::from_fn(|k| w[k] + sign * across[k]);
            view.add_side(side).map_err(|_| ViewError::Projection)?;
        }
        Ok(view)
    }

    /// Cuts the only part of the view: directions with `normal . v < 0` are out.
    fn add_side(&mut self, normal: Vector) -> Result<(), ViewError> {
        self.parts[0].add(Side::given(unit_of_any_size(normal).ok_or(ViewError::Direction)?));
        Ok(())
    }

    /// The eye, in scene units; of what is looked at in a mirror of a table with a frame, along the axes of the frame.
    pub fn eye(&self) -> [f64; 3] {
        self.eye
    }

    /// Whether the cone may meet a box (scene units; z is 0 in a plane): what is not cut off by one of its sides alone.
    ///
    /// Errs towards `true`, near the edges of the cone by more than rounding. A box around the eye is met. O(sides).
    pub fn may_meet(&self, bounds: &Aabb<3>) -> bool {
        let reach = self.reach(radius(bounds, self.eye));
        self.parts().iter().any(|part| !part.sides(reach).any(|side| side.excludes_box(bounds, self.eye)))
    }

    /// The view along the axes of a frame; the same if it is along them already.
    ///
    /// Eye and portals are known to within the gap, and the eye to within the rounding of the turn, which is its slack. A normal
    /// is turned like a vector, which is right for axes at right angles: with u = 2^-53, products of the axes that are off by 32 u move the
    /// value of a side by at most 96 u of its size, rounding by 4 u, and a size is at most √3 times that of the turned normal: 174 u
    /// together, for which the tolerance of sides has room ([`side`](crate::side)).
    pub(crate) fn in_frame(&self, frame: &Frame) -> Self {
        if self.framed {
            return self.clone();
        }
        let rounding = frame.rounding(self.eye).iter().fold(0.0f64, |m, x| m.max(*x));
        let mut framed = self.clone();
        framed.eye = frame.to_frame(self.eye);
        // The product and the two sums are rounded.
        framed.slack = self.slack + frame.gap() * (1.0 + 4.0 * f64::EPSILON) + rounding;
        framed.parts.iter_mut().for_each(|part| part.turn(frame));
        framed.framed = true;
        framed
    }

    /// What is looked at in a mirror: the eye behind it, and the cone with these sides as the mirror shows it.
    pub(crate) fn mirrored(&self, mirror: &Front, cone: &[Side]) -> Self {
        let (point, across) = mirror.plane();
        let v = sub(self.eye, point);
        let along = 2.0 * dot(v, across);
        let eye: Vector = std::array::from_fn(|k| self.eye[k] - along * across[k]);
        // Along an axis only the last subtraction of each of the two steps rounds. Any other unit normal is off by a few
        // units in the last place, and so is the sum. Both are below 16 u of the sizes.
        let size = norm(v) + norm(self.eye) + norm(eye);
        let exact = across.iter().filter(|x| **x != 0.0).count() == 1 && {
            let k = across.iter().position(|x| *x != 0.0).unwrap_or(0);
            midway(self.eye[k], eye[k], point[k])
        };
        let rounding = if exact { 0.0 } else { size * 2.0 * f64::EPSILON * 4.0 };
        let mut part = ViewPart::default();
        cone.iter().take(MOST_SIDES).for_each(|side| part.add(side.mirrored(across)));
        Self { eye, slack: self.slack + rounding, parts: [part, ViewPart::default()], n_parts: 1, framed: self.framed }
    }

    /// Keeps the directions whose angle to `forward`, towards `right` or away from it, is at most `fov / 2`.
    fn cut_by_wedge(&mut self, forward: Vector, right: Vector, fov: f64) {
        let (sin, cos) = (0.5 * fov).sin_cos();
        // At the angle a to the right of forward its value is sin(fov / 2 - a).
        let end = |right: f64, v: Vector| Side::given(std::array::from_fn(|k| sin * forward[k] - right * cos * v[k]));
        let half = |right_or_left: f64, v: Vector| [Side::given(v.map(|x| right_or_left * x)), end(right_or_left, v)];
        let parts =
            if fov < PI { [[end(1.0, right), end(-1.0, right)]; 2] } else { [half(1.0, right), half(-1.0, right)] };
        if fov < TAU {
            self.n_parts = if fov < PI { 1 } else { 2 };
            for (part, sides) in self.parts.iter_mut().zip(parts).take(self.n_parts) {
                sides.into_iter().for_each(|side| part.add(side));
            }
        }
    }

    /// The convex cones that the view is made of.
    pub(crate) fn parts(&self) -> &[ViewPart] {
        &self.parts[..self.n_parts]
    }

    /// What rounding does to vectors that are at most `radius` long.
    pub(crate) fn reach(&self, radius: f64) -> Reach {
        Reach { radius, slack: self.slack }
    }
}

impl ViewPart {
    fn turn(&mut self, frame: &Frame) {
        let given = self.few[..self.n_few].iter_mut().chain(&mut self.more);
        given.for_each(|side| *side = Side::given(frame.to_frame(side.normal())));
    }

    fn add(&mut self, side: Side) {
        if self.n_few < self.few.len() {
            self.few[self.n_few] = side;
            self.n_few += 1;
        } else {
            self.more.push(side);
        }
    }

    /// The sides, for vectors within reach.
    pub(crate) fn sides(&self, reach: Reach) -> impl Iterator<Item = Side> + '_ {
        self.few[..self.n_few].iter().chain(&self.more).map(move |side| side.within(reach))
    }
}

/// Whether `m` is exactly in the middle of `a` and `b`: the two differences are made without rounding, and are equal.
fn midway(a: f64, b: f64, m: f64) -> bool {
    let exact = |x: f64, y: f64| {
        let d = x - y;
        // Knuth's two-sum: what the subtraction lost.
        let back = d - x;
        (d, (x - (d - back)) + (-y - back))
    };
    let ((left, lost), (right, gone)) = (exact(m, a), exact(b, m));
    lost == 0.0 && gone == 0.0 && left == right
}

fn check_fov(fov: f64) -> Result<(), ViewError> {
    if fov > 0.0 && fov <= TAU { Ok(()) } else { Err(ViewError::Fov(fov)) }
}

/// The unit vector to the right of who looks along the unit vector `forward` with `up` above.
fn right_of(forward: Vector, up: Vector) -> Vector {
    let flat = forward.map(f64::abs);
    let least = (0..3).min_by(|&a, &b| flat[a].total_cmp(&flat[b])).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    // Nearly parallel: the cross product would be mostly rounding.
    let across = unit_of_any_size(up).map(|up| cross(forward, up)).filter(|r| dot(*r, *r) > 1e-12);
    unit_of_any_size(across.unwrap_or_else(|| cross(forward, other))).unwrap_or([1.0, 0.0, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front::Facing;

    fn contains(view: &View, v: Vector) -> bool {
        let reach = view.reach(10.0);
        view.parts().iter().any(|part| part.sides(reach).all(|side| !side.lets_go(side.value(v))))
    }

    fn at(degrees: f64) -> Vector {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [cos, sin, 0.0]
    }

    #[test]
    fn planar_fields_of_view_of_all_widths() {
        for fov in [0.5, 1.0, 60.0, 179.0, 180.0, 181.0, 270.0, 359.5, 360.0f64] {
            for turn in [0.0, 33.0, 90.0, 200.0] {
                let d = at(turn);
                let view = View::planar([1.0, 2.0], [7.0 * d[0], 7.0 * d[1]], fov.to_radians()).unwrap();
                for k in -3599..3600 {
                    let angle = f64::from(k) * 0.05;
                    // On the border either is right.
                    if (angle.abs() - 0.5 * fov).abs() > 0.01 {
                        assert_eq!(contains(&view, at(turn + angle)), angle.abs() < 0.5 * fov, "{fov} {turn} {angle}");
                    }
                }
            }
        }
    }

    #[test]
    fn pictures_have_their_width_and_height() {
        let view = View::perspective_horizontal([0.0; 3], [0.0, 2.0, 0.0], [0.0, 0.5, 9.0], PI / 2.0, 2.0).unwrap();
        // Forward is y, right is x, up is z: half a width of 1 and half a height of 0.5 at distance 1.
        for (v, inside) in [
            ([0.99, 1.0, 0.0], true),
            ([1.01, 1.0, 0.0], false),
            ([-0.99, 1.0, 0.49], true),
            ([0.0, 1.0, 0.51], false),
            ([0.0, 1.0, -0.49], true),
            ([0.0, -1.0, 0.0], false),
        ] {
            assert_eq!(contains(&view, v), inside, "{v:?}");
        }
        let wide = View::perspective_horizontal([0.0; 3], [0.0, 2.0, 0.0], [0.0, 0.0, 9.0], 1.5 * PI, 2.0).unwrap();
        assert!(contains(&wide, [0.0, 0.1, 9.0]) && contains(&wide, [1.0, -0.9, 0.0]));
        assert!(!contains(&wide, [0.9, -1.0, 0.0]));
        // Straight up, with up along it: some picture.
        let up = View::perspective_horizontal([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 1.0, 1.0).unwrap();
        assert!(contains(&up, [0.0, 0.0, 1.0]) && !contains(&up, [0.0, 0.0, -1.0]));
    }

    /// Row-major product.
    fn times(a: [[f64; 4]; 4], b: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    }

    /// By columns.
    fn columns(m: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
        std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
    }

    /// A camera that looks along -z of its own axes, or along z, at `eye`, towards `dir` with `up` above.
    fn look(eye: Vector, dir: Vector, up: Vector, left_handed: bool) -> [[f64; 4]; 4] {
        let forward = unit_of_any_size(dir).unwrap();
        let right = right_of(forward, up);
        let up = cross(right, forward);
        let back = forward.map(|x| if left_handed { x } else { -x });
        let row = |v: Vector| [v[0], v[1], v[2], -dot(v, eye)];
        [row(right), row(up), row(back), [0.0, 0.0, 0.0, 1.0]]
    }

    /// The angle of the height is taken for that of the width by nobody: both say the same of the same picture, and so does the matrix of an engine,
    /// whatever its conventions of depth and hand.
    #[test]
    fn pictures_of_engines() {
        let (eye, dir, up) = ([3.0, -2.0, 5.5], [0.3, -0.2, 1.0], [0.1, 1.0, 0.2]);
        let (vertical, aspect) = (60f64.to_radians(), 16.0 / 9.0);
        let horizontal = 2.0 * (aspect * (0.5 * vertical).tan()).atan();
        let by_height = View::perspective_vertical(eye, dir, up, vertical, aspect).unwrap();
        let by_width = View::perspective_horizontal(eye, dir, up, horizontal, aspect).unwrap();
        // What takes one for the other: the picture is too low.
        let confused = View::perspective_horizontal(eye, dir, up, vertical, aspect).unwrap();
        let f = 1.0 / (0.5 * vertical).tan();
        let (near, far) = (0.1, 1000.0);
        let depths = [
            // OpenGL; wgpu and Direct3D; reversed; reversed and infinite, as in Bevy.
            [(far + near) / (near - far), 2.0 * far * near / (near - far)],
            [far / (near - far), far * near / (near - far)],
            [near / (far - near), far * near / (far - near)],
            [0.0, near],
        ];
        let mut views = vec![by_width];
        for left_handed in [false, true] {
            for [a, b] in depths {
                let sign = if left_handed { 1.0 } else { -1.0 };
                let (a, w) = (if left_handed { -a } else { a }, [0.0, 0.0, sign, 0.0]);
                let projection = [[f / aspect, 0.0, 0.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, a, b], w];
                let matrix = columns(times(projection, look(eye, dir, up, left_handed)));
                views.push(View::from_view_projection(eye, matrix).unwrap());
            }
        }
        let (mut n_inside, mut n_confused) = (0, 0);
        for k in 0..20_000u32 {
            let share = |prime: u32| f64::from(k * prime % 20_011) / 10_005.5 - 1.0;
            let v = [share(7), share(131), share(2027)];
            // Not where rounding decides.
            let reach = by_height.reach(10.0);
            let nearest =
                by_height.parts()[0].sides(reach).map(|side| side.value(v)).fold(f64::INFINITY, |m, x| m.min(x.abs()));
            if nearest < 1e-9 {
                continue;
            }
            let inside = contains(&by_height, v);
            n_inside += usize::from(inside);
            views.iter().enumerate().for_each(|(i, view)| assert_eq!(contains(view, v), inside, "{i} {v:?}"));
            n_confused += usize::from(contains(&confused, v) != inside);
        }
        assert!(n_inside > 500 && n_confused > 100, "{n_inside} {n_confused}");
        // A lens that is shifted by half a picture to the right: the left half of it is out.
        let mut shifted = times(
            [[f / aspect, 0.0, 1.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, 0.0, near], [0.0, 0.0, -1.0, 0.0]],
            look(eye, dir, up, false),
        );
        let view = View::from_view_projection(eye, columns(shifted)).unwrap();
        let (forward, right) = (unit_of_any_size(dir).unwrap(), right_of(unit_of_any_size(dir).unwrap(), up));
        let aside = |x: f64| [0, 1, 2].map(|k| forward[k] + x * right[k]);
        assert_eq!([-0.1, 0.1, 1.9, 2.2].map(|x| contains(&view, aside(x))), [false, true, true, false]);
        // Parallel, and broken.
        shifted[3] = [0.0, 0.0, 0.0, 1.0];
        assert_eq!(View::from_view_projection(eye, columns(shifted)), Err(ViewError::Projection));
        // What one camera's matrix has at fault: any number that is none, a row of zeros, rows for columns, another eye.
        let good = columns(times(
            [[f / aspect, 0.0, 0.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, 0.0, near], [0.0, 0.0, -1.0, 0.0]],
            look(eye, dir, up, false),
        ));
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let mut bad = good;
            bad[i][j] = f64::NAN;
            assert_eq!(View::from_view_projection(eye, bad), Err(ViewError::Projection));
        }
        let mut flat = good;
        flat.iter_mut().for_each(|column| column[1] = 0.0);
        assert_eq!(View::from_view_projection(eye, flat), Err(ViewError::Projection));
        assert_eq!(View::from_view_projection(eye, columns(good)), Err(ViewError::OtherEye));
        for k in 0..3 {
            let mut moved = eye;
            moved[k] += 0.01;
            assert_eq!(View::from_view_projection(moved, good), Err(ViewError::OtherEye));
        }
        // In single precision it is still that of the eye, near the origin and far from it.
        for far in [0.0, 1.0, 1e5] {
            let eye = eye.map(|x| x * far);
            let single = |m: [[f64; 4]; 4]| m.map(|row| row.map(|x| f64::from(x as f32)));
            let view = single(look(eye.map(|x| f64::from(x as f32)), dir, up, false));
            let lens = [[f / aspect, 0.0, 0.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, 0.0, near], [0.0, 0.0, -1.0, 0.0]];
            let matrix = columns(single(times(single(lens), view)));
            assert!(View::from_view_projection(eye.map(|x| f64::from(x as f32)), matrix).is_ok(), "{far}");
        }
        for fov in [0.0, -1.0, PI, f64::NAN] {
            assert!(matches!(View::perspective_vertical(eye, dir, up, fov, 1.0), Err(ViewError::VerticalFov(_))));
        }
        assert_eq!(View::perspective_vertical(eye, dir, up, 1.0, 0.0), Err(ViewError::Aspect(0.0)));
        assert_eq!(View::perspective_vertical(eye, [0.0; 3], up, 1.0, 1.0), Err(ViewError::Direction));
    }

    #[test]
    fn boxes_are_met() {
        let view = View::planar([1.0, 2.0], [1.0, 0.0], 1.0).unwrap();
        let at = |x: f64, y: f64| Aabb { min: [x, y, 0.0], max: [x + 1.0, y + 1.0, 0.0] };
        assert!(view.may_meet(&at(5.0, 2.0)) && view.may_meet(&at(0.5, 1.5)) && view.may_meet(&at(5.0, 3.5)));
        assert!(!view.may_meet(&at(-3.0, 2.0)) && !view.may_meet(&at(2.0, 5.0)));
        assert!(View::all_round([1.0, 2.0, 0.0]).unwrap().may_meet(&at(-3.0, 2.0)));
        let wide = View::planar([1.0, 2.0], [1.0, 0.0], 6.0).unwrap();
        assert!(wide.may_meet(&at(1.0, 5.0)) && !wide.may_meet(&at(-9.0, 1.5)));
    }

    /// The product of 5e-324 with 0.4 rounds to 0, so such an eye seemed to be behind a door that it is before.
    #[test]
    fn eyes_next_to_a_corner_are_not_behind_it() {
        let right = [0.3, 0.4, 0.0];
        let door = Front::of(&[[0.0; 3], right], true);
        assert_eq!(door.facing(&[], [5e-324, 0.0, 0.0], 0.0), Facing::Behind, "the impostor: as it was");
        let view = View::planar([5e-324, 0.0], [1.0, 0.0], 1.0).unwrap();
        assert_eq!(door.facing(&[], view.eye, view.slack), Facing::Level);
        // No more than that is in doubt: what is clearly before or behind stays so, and eyes elsewhere are what they were.
        assert_eq!(door.facing(&[], [1e-9, 0.0, 0.0], view.slack), Facing::Before);
        assert_eq!(door.facing(&[], [-1e-9, 0.0, 0.0], view.slack), Facing::Behind);
        let view = View::all_round([1e-30, 0.0, -5.0]).unwrap();
        assert_eq!((view.eye, view.slack), ([1e-30, 0.0, -5.0], 0.0));
    }

    #[test]
    fn nonsense_is_refused() {
        let nan = f64::NAN;
        assert_eq!(View::planar([nan, 0.0], [1.0, 0.0], 1.0), Err(ViewError::Eye));
        assert_eq!(View::planar([0.0, 0.0], [0.0, 0.0], 1.0), Err(ViewError::Direction));
        assert_eq!(View::planar([0.0, 0.0], [nan, 1.0], 1.0), Err(ViewError::Direction));
        assert!(matches!(View::planar([0.0, 0.0], [1.0, 0.0], nan), Err(ViewError::Fov(_))));
        for fov in [0.0, -1.0, 6.3] {
            assert_eq!(View::planar([0.0, 0.0], [1.0, 0.0], fov), Err(ViewError::Fov(fov)));
        }
        assert_eq!(
            View::perspective_horizontal([0.0; 3], [1.0, 0.0, 0.0], [0.0; 3], 1.0, 0.0),
            Err(ViewError::Aspect(0.0))
        );
        assert_eq!(
            View::planar([0.0, 0.0], [1.0, 0.0], 0.0).unwrap_err().to_string(),
            "a field of view of 0 is not above 0 and at most a full turn"
        );
    }
}
