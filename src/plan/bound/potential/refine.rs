//! A search on a finer mesh goes on where that on a coarser one ended.

use super::mesh::{Mesh, count};
use super::solve::{Flow, Solver};

/// What one mesh gives to the next.
pub(super) struct Coarse {
    pub(super) mesh: Mesh,
    pub(super) floor_m: Option<Vec<f64>>,
    pub(super) levels_km: Vec<f64>,
    pub(super) potential: Vec<f64>,
    pub(super) flows: Vec<Flow>,
    /// The prism of each triangle and level; none where it is closed.
    pub(super) rank: Vec<Option<usize>>,
}

/// Begins with the potential and the flows of a coarser mesh.
pub(super) fn refined<'a>(mut solver: Solver<'a>, coarse: &Coarse) -> Solver<'a> {
    let mesh = solver.mesh();
    let nodes = coarse.mesh.nodes.len();
    let positions: Vec<(f64, f64)> = (0..mesh.nodes.len())
        .map(|node| mesh.place_in(&coarse.mesh, node))
        .collect();
    let mut potential = Vec::with_capacity(mesh.nodes.len() * solver.levels());
    for level in 0..solver.levels() {
        let values = &coarse.potential[level * nodes..][..nodes];
        potential.extend(
            positions
                .iter()
                .map(|&place| coarse.mesh.bilinear(values, place)),
        );
    }
    let triangles = coarse.mesh.triangles.len();
    let own = mesh.triangles.len();
    let over: Vec<usize> = (0..own)
        .map(|triangle| {
            let (row, column) = mesh.middle_in(&coarse.mesh, triangle);
            coarse.mesh.triangle_at(row, column)
        })
        .collect();
    let share = count(coarse.mesh.cells()) / count(mesh.cells());
    let prisms = solver.prisms.clone();
    for (flow, (triangle, level)) in solver.flows.iter_mut().zip(prisms) {
        if let Some(rank) = coarse.rank[level * triangles + over[triangle]] {
            *flow = coarse.flows[rank].map(|value| value * share * share);
        }
    }
    solver.start_at(potential);
    solver
}
