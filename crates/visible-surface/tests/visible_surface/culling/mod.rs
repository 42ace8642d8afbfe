//! Culling against oracles in whole numbers.

mod conservative;
mod frustum;
mod nasty;
mod oracle;
mod sampled;
mod scenes;
mod transform;
