//! Distances from a trajectory to ground, polygons, circles and other trajectories, in continuous time.

pub(super) mod hills;
pub(super) mod outline;
pub(super) mod patch;
pub(super) mod segment;
pub(super) mod surface;
pub(super) mod terrain_posts;
pub(super) mod timeline;
pub(super) mod worst;
