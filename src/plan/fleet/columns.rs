//! Takeoffs and landings are fixed by the spec, so no search can move them out of an
//! earlier flight's way: they are looked at here, for the caller to report.

use crate::numeric::approach::{Approach, Segment, closest_approach, closest_horizontal};
use crate::path::Flight;
use crate::plan::FleetPlan;
use crate::spec::{MissionSpec, Separation};
use crate::world::World;

/// A takeoff or landing that comes too near to an earlier flight. Another path of that
/// vehicle does not help: another departure time, home or goal does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnConflict {
    /// Index of the vehicle that takes off or lands.
    pub vehicle: usize,
    /// Index of the earlier vehicle in its way.
    pub other: usize,
    /// Least distance, metres: horizontal, if the spec has a vertical separation.
    pub distance_m: f64,
    /// When, seconds after T0.
    pub t_s: f64,
}

impl FleetPlan {
    /// Every takeoff and landing that breaks the separation from an earlier flight, at
    /// the worst allowed shift of departures.
    #[must_use]
    pub fn column_conflicts(&self, spec: &MissionSpec, world: &World) -> Vec<ColumnConflict> {
        let flights = self.flights(spec, world);
        let separation = spec.buffered_separation();
        let mut conflicts = Vec::new();
        for (vehicle, own) in flights.iter().enumerate() {
            let arrival_s = self.vehicles[vehicle]
                .routes
                .last()
                .and_then(|route| route.path.last())
                .map_or(f64::INFINITY, |last| last.t_s);
            let departure_s = own.route_starts_s.first().copied().unwrap_or(0.0);
            let columns: Vec<Segment> = own
                .segments()
                .filter(|segment| segment.t1_s <= departure_s || segment.t0_s >= arrival_s)
                .collect();
            for (other, flight) in flights[..vehicle].iter().enumerate() {
                if let Some(worst) = worst(&columns, flight, &separation) {
                    conflicts.push(ColumnConflict {
                        vehicle,
                        other,
                        distance_m: worst.value,
                        t_s: worst.t_s,
                    });
                }
            }
        }
        conflicts
    }
}

/// The nearest approach of some motions to a flight, if it breaks the separation.
fn worst(columns: &[Segment], flight: &Flight, separation: &Separation) -> Option<Approach> {
    columns
        .iter()
        .flat_map(|own| flight.segments().map(move |other| (own, other)))
        .filter_map(|(own, other)| match separation.vertical_m {
            None => closest_approach(own, &other, separation.time_slack_s),
            Some(vertical_m) => {
                closest_horizontal(own, &other, separation.time_slack_s, vertical_m)
            }
        })
        .filter(|approach| approach.value < separation.distance_m)
        .min_by(|a, b| a.value.total_cmp(&b.value))
}
