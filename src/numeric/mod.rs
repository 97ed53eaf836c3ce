//! Numbers that know nothing of drones: seeds, speed profiles, splines, geometry.

pub mod angle;
pub mod approach;
pub mod bspline;
pub mod cells;
pub mod chains;
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
