//! Triangles of a mesh that no path that counts may enter.

use geo::{Contains, Intersects, LineString, Polygon};

use super::mesh::Mesh;
use crate::numeric::geometry::{Point, distance};
use crate::plan::bound::closed::{is_always_closed_from_below, smaller};
use crate::spec::{MissionSpec, Placement};
use crate::world::{Disc, World};

/// What is closed in the plane, from inside, and in space.
pub(super) struct Closures<'a> {
    world: &'a World,
    discs: Vec<Disc>,
    /// Closed at every altitude that a path may have there.
    polygons: Vec<&'a Polygon<f64>>,
    /// Closed below an altitude, metres above the sea.
    lids: Vec<(&'a Polygon<f64>, f64)>,
}

impl<'a> Closures<'a> {
    pub(super) fn new(spec: &MissionSpec, world: &'a World) -> Self {
        let mut discs: Vec<Disc> = world.threats.iter().map(smaller).collect();
        let (mut polygons, mut lids) = (Vec::new(), Vec::new());
        for (zone, given) in world.zones.iter().zip(&spec.no_fly) {
            if !is_always_closed_from_below(zone, world) {
                continue;
            }
            match (given.circle, zone.ceiling) {
                (Some((center, radius_m)), None) => {
                    let center = world.frame.to_plan(center);
                    discs.push(smaller(&Disc { center, radius_m }));
                }
                (None, None) => polygons.push(&zone.outline),
                (None, Some(Placement::Amsl(top))) => lids.push((&zone.outline, top.0)),
                _ => {}
            }
        }
        Self {
            world,
            discs,
            polygons,
            lids,
        }
    }

    /// The discs, whose rims a mesh follows.
    pub(super) fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// Which triangles a path may enter that is shorter than a length from start to goal.
    pub(super) fn open(&self, mesh: &Mesh, longest_m: f64) -> Vec<bool> {
        let ends = mesh.ends.map(|node| mesh.nodes[node]);
        let is_open = |corners: &[usize; 3]| {
            let corners = corners.map(|node| mesh.nodes[node]);
            let middle = [0, 1].map(|axis| corners.iter().map(|at| at[axis]).sum::<f64>() / 3.0);
            let reach_m = corners
                .map(|at| distance(at, middle))
                .into_iter()
                .fold(0.0, f64::max);
            let by_it_m = distance(ends[0], middle) + distance(middle, ends[1]);
            by_it_m - 2.0 * reach_m < longest_m && !self.is_closed(corners)
        };
        mesh.triangles.iter().map(is_open).collect()
    }

    fn is_closed(&self, corners: [Point; 3]) -> bool {
        let is_in = |disc: &Disc| {
            let center = [disc.center.east_m, disc.center.north_m];
            corners
                .iter()
                .all(|at| distance(*at, center) <= disc.radius_m)
        };
        if self.discs.iter().any(is_in) {
            return true;
        }
        let triangle = polygon(corners);
        self.polygons
            .iter()
            .any(|closed| closed.contains(&triangle))
            || !self.world.area.intersects(&triangle)
    }

    /// Up to which altitude a triangle is closed below, metres above the sea.
    pub(super) fn lid_m(&self, corners: [Point; 3]) -> f64 {
        let over = self
            .lids
            .iter()
            .filter(|(outline, _)| outline.contains(&polygon(corners)));
        over.map(|(_, top_m)| *top_m)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

fn polygon(corners: [Point; 3]) -> Polygon<f64> {
    let ring = corners.map(|[east_m, north_m]| (east_m, north_m));
    Polygon::new(LineString::from(ring.to_vec()), Vec::new())
}
