//! Where nodes put their meshes: affine maps, composed in double precision.
//!
//! Nothing here depends on a machine's mathematical library: sums and products in a fixed order, and one
//! quotient per entry of a rotation.

use super::json::Node;
use crate::error::{Malformed, malformed};
use sightlines_cells::Point3;
use sightlines_geometry::range::Range;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    /// Rows of the matrix; the last column is the translation.
    rows: [[f64; 4]; 3],
    /// The sign of its determinant: -1 if it makes right hands of left hands, 0 if it flattens space.
    hand: i8,
    /// Whether engines agree on the fronts of what is placed, as far as its determinant is not 0.
    is_certain: bool,
}

impl Transform {
    pub(super) const IDENTITY: Self =
        Self { rows: [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]], hand: 1, is_certain: true };

    pub(super) fn of_node(node: &Node) -> Result<Self, Malformed> {
        let decomposed = node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
        match &node.matrix {
            Some(_) if decomposed => Err(malformed!("both a matrix and a translation, rotation or scale")),
            Some(matrix) => Self::from_columns(matrix),
            None => {
                let translation = node.translation.as_deref().copied().unwrap_or_default();
                let rotation = node.rotation.as_deref().copied().unwrap_or([0., 0., 0., 1.]);
                let scale = node.scale.as_deref().copied().unwrap_or([1.; 3]);
                Self::from_parts(translation, rotation, scale)
            }
        }
    }

    /// The rows, as ranges that hold nothing else.
    pub(super) fn ranges(&self) -> [[Range; 4]; 3] {
        self.rows.map(|row| row.map(Range::of))
    }

    /// The map with these columns, if it is affine.
    pub(super) fn from_columns(m: &[f64; 16]) -> Result<Self, Malformed> {
        if [m[3], m[7], m[11], m[15]] != [0., 0., 0., 1.] {
            return Err(malformed!("its matrix is not affine"));
        }
        let rows = [0, 1, 2].map(|r| [m[r], m[4 + r], m[8 + r], m[12 + r]]);
        // Rounding can mistake the sign only of a map that flattens space by fifteen digits, where fronts
        // and backs are the same to the eye.
        Ok(Self { rows, hand: sign(determinant(&rows)), is_certain: true })
    }

    /// First the scale, then the rotation, then the translation.
    pub(super) fn from_parts(translation: Point3, rotation: [f64; 4], scale: Point3) -> Result<Self, Malformed> {
        let rotation = rotation_rows(rotation).ok_or_else(|| malformed!("its rotation is the zero quaternion"))?;
        let row = |r: usize| {
            let [x, y, z]: Point3 = rotation[r];
            [x * scale[0], y * scale[1], z * scale[2], translation[r]]
        };
        let hand = scale.iter().map(|&s| sign(s)).product();
        Ok(Self { rows: [row(0), row(1), row(2)], hand, is_certain: true })
    }

    /// Whether it is certain which sides of triangles are their fronts, and it does not mirror.
    pub(super) fn keeps_sides(&self) -> bool {
        self.hand > 0 && self.has_fronts()
    }

    /// Whether it is certain which sides of triangles are their fronts: not if it places an instance that is itself mirrored, or flattens. glTF
    /// says which they are where a node mirrors.
    ///
    /// Entries that a program rounded to single precision are wrong by 2^-24 of themselves, so each product of three by 3 × 2^-24 and a
    /// bit; the six products of the determinant have magnitudes of at most the product of the rows' sums together, and a row's sum is
    /// at most √3 of its length. So the determinant is wrong by less than 16 × 2^-24 of the product of the lengths.
    pub(super) fn has_fronts(&self) -> bool {
        let det = determinant(&self.rows);
        let size: f64 = self.rows.iter().map(|r| r[..3].iter().map(|x| x * x).sum::<f64>().sqrt()).product();
        self.is_certain && det * f64::from(self.hand) > size * 8.0 * f64::from(f32::EPSILON)
    }

    /// Whether fronts become backs.
    pub(super) fn mirrors(&self) -> bool {
        self.hand < 0
    }

    /// First the transform of an instance, then this. Engines turn the fronts of all instances of a node the same way, or look at each: which sides
    /// are fronts is certain only where an instance itself does not mirror.
    pub(super) fn of_instance(&self, own: &Self) -> Self {
        let both = self.after(own);
        Self { is_certain: both.is_certain && own.hand > 0, ..both }
    }

    pub(super) fn after(&self, inner: &Self) -> Self {
        let entry = |row: &[f64; 4], c: usize| {
            row[0] * inner.rows[0][c] + row[1] * inner.rows[1][c] + row[2] * inner.rows[2][c]
        };
        let row = |row: &[f64; 4]| [entry(row, 0), entry(row, 1), entry(row, 2), entry(row, 3) + row[3]];
        Self {
            rows: [row(&self.rows[0]), row(&self.rows[1]), row(&self.rows[2])],
            hand: self.hand * inner.hand,
            is_certain: self.is_certain && inner.is_certain,
        }
    }

    pub(super) fn apply(&self, p: Point3) -> Point3 {
        self.rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }

    /// How large the coordinates of `p` are where it is put, but for the translation: the magnitudes of the products.
    pub(super) fn reach(&self, p: Point3) -> Point3 {
        self.rows.map(|row| (row[0] * p[0]).abs() + (row[1] * p[1]).abs() + (row[2] * p[2]).abs())
    }
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

fn determinant(rows: &[[f64; 4]; 3]) -> f64 {
    let [a, b, c] = rows;
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The rotation of a quaternion (x, y, z, w) of any length but zero.
///
/// Files hold unit quaternions rounded to single precision. Dividing by the squared length at the end gives
/// a rotation all the same, and exact zeros and ones for turns by right angles about an axis: there, equal
/// squares cancel, or the same number stands above and below the line.
fn rotation_rows([x, y, z, w]: [f64; 4]) -> Option<[Point3; 3]> {
    let (xx, yy, zz, ww) = (x * x, y * y, z * z, w * w);
    let squared_length = (xx + yy) + (zz + ww);
    if squared_length == 0.0 {
        return None;
    }
    let off = |a: f64, b: f64| (a + b) * 2.0 / squared_length;
    let diagonal = |plus: f64, a: f64, b: f64| ((ww + plus) - (a + b)) / squared_length;
    Some([
        [diagonal(xx, yy, zz), off(x * y, -(w * z)), off(x * z, w * y)],
        [off(x * y, w * z), diagonal(yy, xx, zz), off(y * z, -(w * x))],
        [off(x * z, -(w * y)), off(y * z, w * x), diagonal(zz, xx, yy)],
    ])
}
