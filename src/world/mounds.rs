//! Hills narrower than the grid of the search: drawn too wide, so that none is missed.

use super::{Ground, Terrain};
use crate::geodesy::{EastNorth, LocalFrame};
use crate::spec::Hill;

/// Radius, in spacings, of a narrow hill as drawn: a smaller one may lie between the nodes.
const SPACINGS: f64 = 2.0;
/// Factor on its height, so that it reaches that height between four nodes: `exp(1/8)`.
const BETWEEN_NODES: f64 = 1.134;
/// Reach of a mound, in radii: further away it is below about a millimetre.
const REACH: f64 = 4.0;

/// Analytic ground with hills too narrow for a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mounds {
    /// The ground without them.
    pub(super) wide: Terrain,
    /// Where each of them is, and how much higher its top is than that ground, metres.
    tops: Vec<(EastNorth, f64)>,
}

impl Mounds {
    /// None where the grid shows the ground as it is.
    pub(super) fn new(terrain: &Terrain, frame: &LocalFrame, spacing_m: f64) -> Option<Self> {
        let Terrain::Analytic { base, hills } = terrain else {
            return None;
        };
        let is_wide = |hill: &Hill| hill.radius_m >= SPACINGS * spacing_m;
        let (wide, narrow): (Vec<Hill>, Vec<Hill>) = hills.iter().copied().partition(is_wide);
        if narrow.is_empty() {
            return None;
        }
        let (base, hills) = (*base, wide);
        let wide = Terrain::Analytic { base, hills };
        // The whole ground on each top, not a sum of what is widened: a ridge of many
        // narrow hills is no higher than it is.
        let top = |hill: &Hill| {
            let (top, under) = (
                terrain.height(hill.place).ok()?,
                wide.height(hill.place).ok()?,
            );
            // Pits are omitted: the ground around them counts.
            (top.0 > under.0).then(|| (frame.to_plan(hill.place), top.0 - under.0))
        };
        let tops = narrow.iter().filter_map(top).collect();
        Some(Self { wide, tops })
    }

    /// Raises the nodes around every top, on a grid of the ground without them.
    pub(super) fn raise(&self, ground: &mut Ground) {
        let under = ground.heights_m.clone();
        let radius_m = SPACINGS * ground.spacing_m;
        for (at, height_m) in &self.tops {
            let from = ground.south_west;
            let rows = near(at.north_m - from.north_m, ground.spacing_m, ground.rows);
            for row in rows {
                let columns = near(at.east_m - from.east_m, ground.spacing_m, ground.columns);
                for column in columns {
                    let node = ground.node(row, column);
                    let radii = node.distance_m(*at) / radius_m;
                    let mound_m = BETWEEN_NODES * height_m * (-radii * radii).exp();
                    let index = row * ground.columns + column;
                    #[expect(clippy::cast_possible_truncation, reason = "as the nodes are")]
                    let raised_m = under[index] + mound_m as f32;
                    ground.heights_m[index] = ground.heights_m[index].max(raised_m);
                }
            }
        }
    }
}

/// Rows or columns within reach of a mound, by its distance from the first one.
fn near(at_m: f64, spacing_m: f64, nodes: usize) -> std::ops::Range<usize> {
    let reach = REACH * SPACINGS;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "negative numbers become 0, and large ones the last"
    )]
    let index = |at: f64| (at as usize).min(nodes);
    let at = at_m / spacing_m;
    index((at - reach).ceil())..index((at + reach).floor() + 1.0)
}

#[cfg(test)]
mod tests {
    use geo::{LineString, Polygon};

    use crate::geodesy::{Amsl, LatLon, LocalFrame};
    use crate::spec::Hill;
    use crate::world::{Ground, Terrain};

    const ORIGIN: LatLon = LatLon {
        lat_deg: 46.5,
        lon_deg: 8.0,
    };

    /// A square of 20 km: nodes are 20 m apart.
    fn sampled(hills: Vec<Hill>) -> Ground {
        let frame = LocalFrame::new(ORIGIN);
        let corners = vec![(-1e4, -1e4), (1e4, -1e4), (1e4, 1e4), (-1e4, 1e4)];
        let area = Polygon::new(LineString::from(corners), vec![]);
        let base = Amsl(300.0);
        let terrain = Terrain::Analytic { base, hills };
        Ground::sample(&terrain, &frame, &area)
    }

    #[test]
    fn a_pit_narrower_than_the_grid_is_left_out() {
        let pit = Hill {
            place: ORIGIN,
            height_m: -100.0,
            radius_m: 1.0,
        };
        let ground = sampled(vec![pit]);
        assert!(
            ground
                .heights_m
                .iter()
                .all(|height_m| (height_m - 300.0).abs() < 1e-3)
        );
    }
}
