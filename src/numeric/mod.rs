//! Numbers that know nothing of drones: seeds, speed profiles, splines, geometry.

mod seed;
mod speed;

pub use seed::Seed;
pub use speed::SpeedProfile;
