//! What a table was made of, in short.

/// Digests of the geometry that a table was made of: they tell a scene that was changed since, however little.
///
/// Each is a hash of 128 bits. The digests of equal geometry are equal; of others they differ but by a chance of 2^-128. Where they
/// differ, nothing is known of how much the geometry does. What is hashed is documented where the scenes are (`Scene::digest` and
/// `Plan::digest` of the crate `sightlines-cells`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct GeometryDigest {
    /// Of what hides: the opaque lines, the triangles of what is not see-through, or the portals.
    pub hiding: u128,
    /// Of what is seen: objects with their boxes, sides and mirrors.
    pub seen: u128,
}

/// Bytes of digests in a file.
pub const DIGEST_LEN: usize = 32;

impl GeometryDigest {
    /// The digests as the bytes of their section: what hides, then what is seen, little-endian.
    pub fn to_bytes(&self) -> [u8; DIGEST_LEN] {
        let mut out = [0; DIGEST_LEN];
        out[..16].copy_from_slice(&self.hiding.to_le_bytes());
        out[16..].copy_from_slice(&self.seen.to_le_bytes());
        out
    }

    /// Reads what [`GeometryDigest::to_bytes`] writes.
    pub fn from_bytes(bytes: &[u8; DIGEST_LEN]) -> Self {
        let number = |at: usize| u128::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        Self { hiding: number(0), seen: number(16) }
    }
}
