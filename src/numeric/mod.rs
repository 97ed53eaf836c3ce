//! Numbers that know nothing of drones: seeds, speed profiles, splines, geometry.

pub mod angle;
pub mod approach;
pub mod bspline;
pub mod geometry;
mod seed;
mod speed;

pub use bspline::Basis;
pub use seed::Seed;
pub use speed::SpeedProfile;
