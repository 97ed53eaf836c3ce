//! The plane between closed polygons, and exact any-angle shortest paths in it.
//!
//! [`FreeSpace`] is a constrained Delaunay triangulation of what no polygon covers.
//! [`Sights::shortest`] searches it by intervals of sight (Cui, Harabor, Grastien 2017,
//! "Compromise-free pathfinding on a navigation mesh"). Cones of sight are bounded by corners
//! alone and tested by exact predicates, so rounding enters only the sum of the lengths.

mod intervals;
mod mesh;
mod search;
#[cfg(test)]
mod tests;

pub use mesh::{FreeSpace, NONE};
pub use search::{Shortest, Sights};
