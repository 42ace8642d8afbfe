//! Maps of space: what inserts and extrusion directions do.

use crate::error::{Malformed, malformed};
use sightlines_geometry::sin_cos;

/// An insert of a block.
#[derive(Debug)]
pub(super) struct Insert {
    pub(super) block: String,
    pub(super) at: [f64; 3],
    pub(super) scale: [f64; 3],
    /// In degrees, counter-clockwise.
    pub(super) rotation: f64,
    /// Columns and rows.
    pub(super) counts: [u32; 2],
    pub(super) spacing: [f64; 2],
    /// The handle of its extension dictionary.
    pub(super) extension: Option<u64>,
}

/// A map of space: the images of the axes, and of the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Affine {
    pub(super) const IDENTITY: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    /// From three rows of four numbers, the last of each for the origin.
    pub(super) fn of_rows(rows: &[f64]) -> Self {
        let column = |k| [rows[k], rows[4 + k], rows[8 + k]];
        Self { axes: [0, 1, 2].map(column), origin: column(3) }
    }

    /// Whether what is above a point stays above it.
    pub(super) fn keeps_above(&self) -> bool {
        let [x, y, _] = self.axes[2];
        x == 0.0 && y == 0.0
    }

    pub(super) fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.axes;
        std::array::from_fn(|k| x[k] * v[0] + y[k] * v[1] + z[k] * v[2])
    }

    pub(super) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let v = self.direction(p);
        std::array::from_fn(|k| v[k] + self.origin[k])
    }

    /// First `inner`, then this.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.direction(axis)), origin: self.point(inner.origin) }
    }

    /// From the coordinates of an entity with an extrusion direction to those around it, by the rule of DXF: its x axis is at right
    /// angles to the world's y axis where the direction is within 1/64 of the world's z axis, else to the z axis.
    pub(super) fn of_extrusion(normal: [f64; 3]) -> Result<Self, Malformed> {
        let z = checked_unit(normal)?;
        let is_steep = z[0].abs() < 1.0 / 64.0 && z[1].abs() < 1.0 / 64.0;
        let across = cross(if is_steep { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] }, z);
        // The direction is not parallel to the axis that was chosen.
        let x = checked_unit(across)?;
        Ok(Self { axes: [x, cross(z, x), z], origin: [0.0; 3] })
    }

    /// From a block to the insert's own coordinates, for one of its columns and rows.
    pub(super) fn of_insert(insert: &Insert, base: [f64; 3], [column, row]: [u32; 2]) -> Self {
        let [sin, cos] = sin_cos(insert.rotation);
        let turn = Self { axes: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]], origin: insert.at };
        let [dx, dy] = insert.spacing;
        let shifted = Self { origin: [f64::from(column) * dx, f64::from(row) * dy, 0.0], ..Self::IDENTITY };
        let [x, y, z] = insert.scale;
        let scaled = Self { axes: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], origin: [0.0; 3] };
        let from_base = Self { origin: base.map(|x| -x), ..Self::IDENTITY };
        turn.after(&shifted.after(&scaled.after(&from_base)))
    }
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The direction with length 1; `None` for zero. Along an axis it is exact.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let scaled = v.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    (largest > 0.0 && length.is_finite()).then(|| scaled.map(|x| x / length))
}

/// The unit vector of an extrusion direction.
pub(super) fn checked_unit(normal: [f64; 3]) -> Result<[f64; 3], Malformed> {
    unit(normal).ok_or_else(|| malformed!("an extrusion direction is {}, which cannot be", normal[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrusion_directions_are_those_of_dxf() {
        let axes = |normal| Affine::of_extrusion(normal).unwrap().axes.map(|axis| axis.map(|x| x + 0.0));
        assert_eq!(axes([0.0, 0.0, 7.0]), Affine::IDENTITY.axes);
        assert_eq!(axes([0.0, 0.0, -1.0]), [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        assert_eq!(axes([0.0, -2.0, 0.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        assert_eq!(axes([1.0, 0.0, 0.0]), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        assert!(Affine::of_extrusion([0.0; 3]).is_err());
    }
}
