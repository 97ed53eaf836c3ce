//! The page of a flight: what was flown over what was planned.

use super::conformance::FlownTrack;
use super::conformance::report::FlightReport;
use super::record::{Flight, Record};
use crate::mission::VehicleMission;
use crate::report::{self, FlownError, FlownFacts, ReviewInput, ServedFacts};
use crate::spec::{Buffers, MissionSpec};
use crate::verify::{Flown, Limit, Margin, Moment, Review, Track};
use crate::world::{Disc, World};

/// The page of a flight that was judged by its record. Threats that came up on the way
/// are drawn with the others.
#[must_use]
pub fn flight_page(
    spec: &MissionSpec,
    world: &World,
    record: &Record,
    judged: &FlightReport,
    missions: &[(usize, &VehicleMission)],
) -> String {
    let (mut spec, mut world) = (spec.clone(), world.clone());
    for popup in &record.popups {
        let center = world.frame.to_plan(popup.threat.place);
        let radius_m = popup.threat.radius_m;
        world.threats.push(Disc { center, radius_m });
        spec.threats.push(popup.threat.clone());
    }
    // What was flown has no other departures, and is judged by the limits alone.
    spec.separation.time_slack_s = 0.0;
    spec.buffers = Buffers::NONE;
    let ended = judged.vehicles.iter().filter(|v| !v.ended_as_planned);
    let ended = ended.map(|v| {
        let limit = Limit::Flown(Flown::End);
        Margin {
            unit: report::IN_WORDS,
            ..Margin::unjudged(&v.vehicle, limit, v.end.clone())
        }
    });
    let review = Review {
        margins: judged.margins.iter().cloned().chain(ended).collect(),
        tracks: record.flights.iter().map(track).collect(),
        assumptions: Vec::new(),
    };
    let flown: Vec<FlownFacts> = record
        .flights
        .iter()
        .map(|flight| FlownFacts {
            served: served(judged, &flight.vehicle),
            ..facts(flight, &spec, &world)
        })
        .collect();
    let input = ReviewInput {
        spec: &spec,
        world: &world,
        plan: None,
        missions,
        review: &review,
        seed: None,
        spec_sha256: &record.spec_sha256,
        version: env!("CARGO_PKG_VERSION"),
    };
    report::flight_html(&input, &flown)
}

fn track(flight: &Flight) -> Track {
    let fixes = flight.flown.fixes.iter();
    let moments = fixes.map(|fix| Moment {
        place: fix.place,
        amsl: fix.amsl,
        t_s: fix.t_s,
        item: fix.item,
    });
    Track {
        vehicle: flight.vehicle.clone(),
        moments: moments.collect(),
        late_s: Vec::new(),
    }
}

fn facts(flight: &Flight, spec: &MissionSpec, world: &World) -> FlownFacts {
    let ways = flight.plans.iter().map(|plan| {
        let waypoints = plan.reference.waypoints.iter();
        waypoints.map(|waypoint| waypoint.point).collect()
    });
    let track = FlownTrack::new(flight, spec, world);
    let errors = track
        .deviations()
        .map(|(index, of)| FlownError {
            t_s: track.fixes()[index].t_s,
            cross_track_m: of.cross_track_m,
            above_m: of.above_m,
        })
        .collect();
    FlownFacts {
        vehicle: flight.vehicle.clone(),
        planned: ways.collect(),
        errors,
        served: Vec::new(),
    }
}

/// What was seen of the stops and tasks of a vehicle.
fn served(judged: &FlightReport, vehicle: &str) -> Vec<ServedFacts> {
    let own = judged.vehicles.iter().filter(|of| of.vehicle == vehicle);
    let seen = own.flat_map(|of| &of.served).map(|of| ServedFacts {
        label: of.label(),
        state: of.state.word(),
        from_s: of.from_s,
        until_s: of.until_s,
    });
    seen.collect()
}
