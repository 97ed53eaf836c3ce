//! Numbers that know nothing of drones: seeds, speed profiles, splines, geometry.

pub mod angle;
pub mod approach;
pub mod barrier;
pub mod bspline;
pub mod cells;
pub mod digits;
pub mod free_space;
pub mod geometry;
pub mod order;
mod seed;
mod speed;
pub mod text;
pub mod tracks;

pub use bspline::Basis;
pub use seed::Seed;
pub use speed::SpeedProfile;

/// A number of things, to calculate with; exact up to 2^53.
#[must_use]
pub fn as_f64(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let count = count as f64;
    count
}
