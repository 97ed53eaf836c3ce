//! What a review takes for granted: of every mission, and of those that a text is about.

use std::collections::BTreeSet;

use crate::autopilot::{Airframe, Autopilot, Version, facts, name_in, parameter};
use crate::mission::{Item, command};
use crate::spec::MissionSpec;
use crate::world::{Terrain, World};

use super::Sortie;
use crate::verify::execute::executor;
use crate::verify::execute::flight::End;
use crate::verify::execute::home;
use crate::verify::limits::{assumptions, separation};

/// How far from home the furthest rally point of a vehicle with ArduPilot lies, metres.
fn furthest_rally_m(sorties: &[Sortie<'_>]) -> f64 {
    sorties
        .iter()
        .filter(|s| s.mission.autopilot == Autopilot::ArduPilot)
        .flat_map(|s| {
            let home = s.home.unwrap_or(s.vehicle.home);
            let points = s.mission.rally.iter().filter_map(Item::place);
            points.map(move |place| place.chord_m(home))
        })
        .fold(0.0, f64::max)
}

/// What the flight model assumes of every mission.
const ASSUMED: [&str; 4] = [
    "legs are straight in the local frame, altitude linear with distance",
    "corners are flown as arcs, on a wing at unchanged speed with the turn radius; the legs are judged as far as the corner too",
    "vehicles speed up and slow down with accel_mps2, climb and descend vertically with climb_mps and descent_mps",
    "each vehicle stands on the ground at the place of its home row when its mission starts, and takes that for home",
];

/// What the flight model assumes of some missions: the condition, and the text with figures of
/// [`crate::autopilot`] as `{vehicle.figure}` or `{PARAMETER}`, and names as `{name PARAMETER}`.
type Assumption = (fn(&Sortie<'_>) -> bool, &'static str);

fn is_quadplane(sortie: &Sortie<'_>) -> bool {
    let (mission, vehicle) = (sortie.mission, sortie.vehicle);
    mission.autopilot == Autopilot::ArduPilot && vehicle.airframe == Airframe::Vtol
}

const ASSUMED_OF_SOME: &[Assumption] = &[
    (
        |s| s.vehicle.airframe != Airframe::Plane,
        "copters and vtol are late from their takeoff on by up to {copter.takeoff_late_s} (ArduPilot), {px4_copter.takeoff_late_s} (PX4 copters) or {px4_vtol.takeoff_late_s} (PX4 vtol), all of one autopilot and airframe alike, and up to {copter.stop_late_s} more \
         after every stop: separation holds for any lateness up to that (measured on five ArduCopters 4.7.0-dev, simulated: \
         over their homes 6 s late, on their way 6 to 8.5 s, over a ridge 8 to 12 s, after a stop 4.4 s more, at most 0.9 m beside the way \
         and 1 m over or under it; of others assumed): those of one kind differ by up to 5.5 s, which time_slack_s must cover",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe == Airframe::Copter,
        "ArduCopter slows down for corners as far as {name WPNAV_RADIUS} and a jerk of 1 m/s3 ask for, cuts them within that radius, and is up to \
         {copter.corner_late_s} later after each (measured on 4.6.3, simulated, still air: speeds within 0.2 m/s, legs within 0.3 s); \
         it stops before a landing at another place and where altitudes above terrain begin or end",
    ),
    (
        |s| s.vehicle.airframe == Airframe::Copter,
        "copters fly their speed in metres of a sphere (ArduPilot 6378.1 km, PX4 6371 km), so that at 36 degrees of latitude ArduCopter is up to 0.32 % of its time late \
         to the north or south and 0.13 % early to the east or west (measured on three ArduCopters 4.7.0-beta1, simulated, 22 to 25 km: 0.320 % and 0.129 %): \
         from ten minutes after takeoff on separation holds for any lateness and earliness up to that",
    ),
    (
        |s| {
            s.holds(command::NAV_SPLINE_WAYPOINT)
                || s.holds(command::NAV_LOITER_TURNS)
                || s.holds(command::NAV_PAYLOAD_PLACE)
        },
        "splines, turns and the placing of payloads are flown as the sources of ArduCopter 4.7 say ({name CIRCLE_RADIUS} {CIRCLE_RADIUS} m and CIRCLE_RATE {CIRCLE_RATE} degrees a second \
         where the .params file has none), and each may take {copter.stop_late_s} longer (4.7.0-beta1, simulated, still air: within 3.5 m on a circle, 0.9 m on splines)",
    ),
    (
        |s| {
            let circles = [
                command::NAV_LOITER_TURNS,
                command::NAV_LOITER_TIME,
                command::NAV_LOITER_TO_ALT,
            ];
            s.vehicle.airframe.has_wing() && circles.into_iter().any(|circle| s.holds(circle))
        },
        "a wing that leaves a circle is judged anywhere between that circle and its next place, and as late as 1.25 orbits more take: ArduPlane circles until it heads for the next place, \
         PX4 leaves on any course (ArduPlane 4.7.0-beta1, simulated, still air, did so in four flights; PX4 by its sources, not measured)",
    ),
    (
        |s| s.mission.facts().heights_at_once.is_some() && s.mission.autopilot_version.is_none(),
        "PX4 copters follow the slope of a leg, as up to 1.17: since 1.18 they are at the altitude of its end soon after its beginning and up to {px4_copter.late_share} of their time late, \
         which is judged of missions with autopilot_version 1.18 or later and in a review without a spec alone (fly refuses such a vehicle otherwise)",
    ),
    (
        |s| {
            s.mission
                .facts()
                .has_heights_at_once(s.mission.autopilot_version)
        },
        "PX4 copters since 1.18 are judged at the altitude of the end of each leg all along, too, and up to {px4_copter.late_share} of the time on their legs late (three of 1.18 beta, simulated, still air: up to 25 m over and 26 m under the line of \
         a leg, to and fro by up to 4 m around the altitude of a waypoint that another altitude follows, 72 to 115 s late after 15 to 27 minutes)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Copter,
        "PX4 copters fly corners as arcs within NAV_ACC_RAD, at the speed that half of accel_mps2 allows across (by its sources), and are as late after each as 1.17.0 was: at 5 m/s 2 s where the course changes by 45 degrees and 5 s at right angles, at 10 m/s 5 and 7 s \
         (measured in its simulator, still air, zigzags of 5 to 180 degrees)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Copter,
        "PX4 copters are up to {px4_copter.leg_late_s} later after every leg, and separation holds for any lateness up to that (measured on six PX4 1.16 alpha, simulated, still air: \
         6 to 10 s late over their homes, 1 to 1.7 s more after a corner or a change of slope, 20.7 s more after 23 legs, 4.6 s with a turn back, at most 2.1 m beside \
         the way and 2.2 m over or under it; three of 1.17.0 on 5 to 10 km: 15 to 25 s late in all); that the airframe can fly the speed of the spec, also in a descent, is assumed: one that could not was 44 s late after 7 minutes",
    ),
    (
        |s| {
            s.flight
                .cruises
                .iter()
                .any(|cruise| cruise.speed_mps.is_none())
                && s.mission.autopilot == Autopilot::Px4
        },
        "PX4 flies with the speed of the spec: MPC_XY_CRUISE (on a wing FW_AIRSPD_TRIM) as in its .params file",
    ),
    (
        |s| {
            let is_launched = executor::is_launched(s.vehicle, s.mission.autopilot);
            is_launched && s.flight.delay_s.is_none() && s.vehicle.depart_s > 0.0
        },
        "PX4 vehicles, planes and vtol are started depart_s after T0 by the station that launches them",
    ),
    (
        |s| s.holds(command::NAV_RETURN_TO_LAUNCH),
        "a return to launch climbs to return_amsl_m however near home it begins, flies straight home and lands at once: {name RTL_ALT}, RTL_CONE_SLOPE and RTL_LOIT_TIME (PX4: RTL_RETURN_ALT, RTL_CONE_ANG and RTL_LAND_DELAY) as in the .params file of the vehicle, and its speed {name RTL_SPEED}, or that of the cruise, without either speed_mps",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.holds(command::DO_CHANGE_SPEED),
        "PX4 obeys DO_CHANGE_SPEED: a copter was seen to stick or to drift off with it, leave it out and set MPC_XY_CRUISE",
    ),
    (
        |s| home::counts_from_home(s.mission),
        "altitudes above home count from the ground under the home row; a home that lies lower, or is measured too high, takes as much from every clearance",
    ),
    (
        |s| s.flight.follows_terrain,
        "vehicles that follow the terrain have the same elevation data and keep their height above it exactly",
    ),
    (
        |s| s.flight.takeoff_rad.is_some(),
        "a plane stands on the course of its takeoff, runs with accel_mps2 on the ground, and climbs straight at its planned speed with climb_mps, no steeper than max_climb_deg, to the height of the takeoff item",
    ),
    (
        |s| s.flight.takeoff_rad.is_some() && s.mission.autopilot == Autopilot::ArduPilot,
        "ArduPlane climbs out more steeply (4.6.3, simulated: 9.3 to 10.4 m/s where 2.5 to 4 were planned, the height reached after {plane.climb_out_share} of the planned climb, \
         {plane.climb_out_overshoot_m} over it for some seconds) and holds its heading, so that the wind carries it off for {plane.drift_share} of the planned climb: the ceiling is judged {plane.climb_out_overshoot_m} over that height and the way on from {plane.climb_out_share} of the climb, \
         also as far downwind, by its L1 law towards the next place and along the legs after it, separation counts with the height in between, and with up to {plane.takeoff_early_s} early and what that way is shorter",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "a wing of ArduPlane gains up to {plane.early_share} of the time since its takeoff (4.7.0-dev, simulated, up to 6 m/s of wind; airspeed sensors are off as much): separation holds for any earliness up to that",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.flight.circle.is_some(),
        "ArduPlane is up to {plane.circle_wide_share} of its turn radius further out than the radius of its circle (4.7.0-dev, simulated: 46 m at 20 m/s on a circle of 80 m)",
    ),
    (
        |s| s.flight.takeoff_rad.is_some() && s.mission.autopilot == Autopilot::Px4,
        "separation counts with a plane up to {plane.takeoff_early_s} early at its start, as ArduPlane was; that a PX4 plane climbs out more steeply than planned \
         (1.16 alpha, simulated: 36 m above the planned line) is not judged",
    ),
    (
        |s| s.vehicle.airframe.has_wing(),
        "a wing flies at its planned indicated airspeed all the way, faster through thinner air as the standard atmosphere has it, on a warm day \
         by 1 % more for every 6 degrees, and turns with max_load_factor; turns of more than a right angle follow waypoints on the way around",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "ArduPlane flies changes of altitude smaller than ALT_SLOPE_MIN (before 4.7 GLIDE_SLOPE_MIN; as in the .params file, else {ALT_SLOPE_MIN} m) at once, \
         and is {plane.altitude_lag_s} of its climb under a slope upwards and as much over one downwards (measured: 3 m at 1 m/s, 5 m at 1.6 m/s, 11 m at 2.9 m/s): \
         such legs are judged there too, but not the separation there, nor the lag over ground that is followed",
    ),
    (
        is_quadplane,
        "a QuadPlane that descends from its climb is {quadplane.transition_lag_s} of its descent above those legs until it has levelled, but no higher than the top of that climb plus the lag of any wing: \
         judged there too, but not the separation there",
    ),
    (
        |s| is_quadplane(s) && s.vehicle.wind.is_some(),
        "a QuadPlane may be driven off to any side as it climbs, with {quadplane.drift_share} of the wind and {quadplane.drift_s} of it more until it is on its first leg (4.6.3, simulated, up to 4 m/s): \
         climb and first leg are judged there too. In more than {quadplane.max_wind_mps} it was driven off by up to 267 m (4.7.0-dev, simulated), and the verdict fails",
    ),
    (
        |s| {
            let lands = matches!(s.flight.end, Some(End::Landed(_)));
            is_quadplane(s) && lands && s.vehicle.carried_by().is_some()
        },
        "a QuadPlane that comes to its landing with the wind from behind circles as it descends and touches down elsewhere (4.6.3, simulated: 64 m off in 4 m/s): its descent is judged anywhere within \
         {quadplane.landing_drift_s} of the wind; into the wind and across it touches down within 8 m of its place: landing.heading_deg in the spec has it come into the wind",
    ),
    (
        |s| is_quadplane(s) && matches!(s.flight.end, Some(End::Landed(_))),
        "a QuadPlane overshoots the place that it lands at before it descends, along its leg and beside it: it is judged anywhere within {quadplane.landing_overshoot_m} of that place, at the altitude of its approach",
    ),
    (
        |s| {
            s.mission.autopilot == Autopilot::Px4
                && s.vehicle.airframe == Airframe::Vtol
                && s.vehicle.carried_by().is_some()
        },
        "VTOLs of PX4 were flown in 2 and 4 m/s of wind alone: that they keep to the columns of takeoff and landing in it is assumed",
    ),
    (
        is_quadplane,
        "a QuadPlane goes on from its climb where its nose points, anywhere, and turns from there: it is judged anywhere within {quadplane.transition_m} and two turn radii of the end of its climb, and between there and its first place (4.7.0-dev, simulated, nose backwards: 180 m beside its first leg)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Vtol,
        "a VTOL of PX4 turns its nose to the place of its takeoff before its transition: where that is less than 20 m away it is judged anywhere within {px4_vtol.transition_m} and two turn radii of the end of its climb, and between there and its first place \
         (1.17.0 and 1.18 beta, simulated, still air: up to 38 m beside its first leg then, at most 4.2 m with the takeoff ahead on it). In 2 and 4 m/s of wind eight of eleven could not turn to a place at home and gave their missions up (1.17 of January 2026): plans have it 15 m upwind of home",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Copter,
        "a copter of PX4 may dwell at the end of its climb: it is up to {px4_copter.climb_late_s} more late from its takeoff on, each as much as it is \
         (1.17 of January 2026, simulated, 0 to 8 m/s of wind: 12 of 88 flights were 15.5 to 27.2 s late at their first places)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe.has_wing(),
        "PX4 on a wing is {px4_plane.altitude_lag_s} of its climb under a slope upwards and as much over one downwards, by its sources with FW_T_HRATE_FF 0.3 and FW_T_ALT_TC 5: \
         such legs are judged there too, and with the altitude of their end NAV_LOITER_RAD before it, by its sources as well (neither was measured). On a leg to a circle it climbs or descends at once, up to 17.9 m off the slope (1.17, simulated), and is judged there",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "ArduPlane swings out of corners: it is judged along the way of its L1 law too (also {plane.faster_share} faster than planned, and to either side where it turns back), with NAVL1_PERIOD and NAVL1_DAMPING (default {NAVL1_PERIOD} and {NAVL1_DAMPING}), WP_RADIUS and ROLL_LIMIT_DEG, \
         at {plane.turning_share} of a coordinated turn, and separation counts with what that way is beside the legs (measured on 4.7.0-dev, simulated, at 18 m/s with a bank of 34 degrees: \
         2 m at 5 degrees, 10 m at 30, 15 m at 60, 30 m at 90, 74 m at 120, which this law gives or up to 45 % more; in still air, the wind is added as the law has it)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe.has_wing(),
        "a wing of PX4 takes its next leg within NAV_ACC_RAD of a waypoint or abeam of it (1.17; since 1.18 within NPFG_SW_DST_MLT of its track error bound, judged as well), and swings out of corners: it is judged along the way of its NPFG law too (in wind also {px4_plane.slower_share} slower than planned), \
         with NPFG_PERIOD and NPFG_DAMPING (default {NPFG_PERIOD} and {NPFG_DAMPING}) and FW_R_LIM, at {px4_plane.turning_share} of a coordinated turn, and separation counts with what that way is beside the legs \
         (1.17 of January 2026, simulated, 11 to 13 m/s, 0 to 6 m/s of wind: within 12 m of that way where it was up to 44 m beside what was judged without it; of a VTOL by the sources)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Plane,
        "a plane of PX4 has its planned speed only some time after its climb-out and is up to {px4_plane.climb_late_s} late from there on, each as much as it is (1.17 of January 2026, simulated: 8.6 to 34.6 s)",
    ),
    (
        |s| s.flight.landing.is_some(),
        "a plane glides straight from the waypoint before its landing to the place of the landing: flare and roll are not judged; on a climb-out or glide the ground must stay half of the height above the runway below the vehicle, until that is min_agl_m",
    ),
    (
        |s| s.flight.circle.is_some(),
        "a circle is entered between its tangent and the straight way to its middle, and from then on the vehicle may be anywhere on it",
    ),
    (
        |s| s.vehicle.airframe == Airframe::Vtol,
        "a vtol climbs and lands vertically over its positions, with climb_mps and descent_mps, and speeds up and slows down on its way with accel_mps2",
    ),
    (
        |s| s.flight.end == Some(End::Repeats),
        "a mission that repeats for ever (DO_JUMP -1) is judged with one repetition more; from then on the vehicle may be anywhere along that repetition, for the separation; how long it lasts is not judged",
    ),
    (
        |s| matches!(s.flight.end, Some(End::Stays(_))) && s.flight.circle.is_none(),
        "a vehicle that loiters, or whose mission ends in the air, hovers there for ever",
    ),
];

/// Kinds of vehicles whose figures the texts name.
const KINDS: [(&str, Autopilot, Airframe); 6] = [
    ("copter", Autopilot::ArduPilot, Airframe::Copter),
    ("plane", Autopilot::ArduPilot, Airframe::Plane),
    ("quadplane", Autopilot::ArduPilot, Airframe::Vtol),
    ("px4_copter", Autopilot::Px4, Airframe::Copter),
    ("px4_plane", Autopilot::Px4, Airframe::Plane),
    ("px4_vtol", Autopilot::Px4, Airframe::Vtol),
];

/// A text of an assumption with its figures: `{plane.bank_lag_s}` is the figure of that name in
/// the table of a plane, `{NAVL1_PERIOD}` the default of a parameter in SI units, `{name RTL_ALT}` the
/// name of a parameter in these versions of ArduPilot.
fn with_figures(text: &str, versions: &[Option<Version>]) -> String {
    let (mut filled, mut rest) = (String::new(), text);
    while let Some((before, name, after)) = placeholder(rest) {
        filled += before;
        filled += &figure(name, versions).unwrap_or_else(|| name.to_owned());
        rest = after;
    }
    filled + rest
}

/// The first name in braces, with the text before and after it.
fn placeholder(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('{')?;
    let (name, after) = rest.split_once('}')?;
    Some((before, name, after))
}

fn figure(name: &str, versions: &[Option<Version>]) -> Option<String> {
    if let Some(name) = name.strip_prefix("name ") {
        let own = parameter(name)?.name;
        let names = versions.iter().map(|version| name_in(own, *version));
        let names: BTreeSet<&str> = names.collect();
        let names: Vec<&str> = names.into_iter().collect();
        return Some(match names.is_empty() {
            true => own.to_owned(),
            false => names.join(" or "),
        });
    }
    let Some((kind, name)) = name.split_once('.') else {
        // As it was written: 0.7 is not the nearest float32.
        return parameter(name).map(|row| ((1e6 * row.default_si()).round() / 1e6).to_string());
    };
    let (_, autopilot, airframe) = KINDS.into_iter().find(|(known, ..)| *known == kind)?;
    let figures = facts(autopilot, airframe).behaviour.figures();
    let found = figures.into_iter().find(|(known, _)| *known == name)?;
    Some(found.1.to_string())
}

/// The versions of vehicles with ArduPilot that an assumption is about; a version is `None` where it is open.
fn versions(sorties: &[Sortie<'_>], is_used: fn(&Sortie<'_>) -> bool) -> Vec<Option<Version>> {
    let of_ardupilot = sorties
        .iter()
        .filter(|s| s.mission.autopilot == Autopilot::ArduPilot && is_used(s));
    of_ardupilot.map(|s| s.mission.autopilot_version).collect()
}

/// What the flight model assumes and used.
pub(super) fn of_sorties(spec: &MissionSpec, world: &World, sorties: &[Sortie<'_>]) -> Vec<String> {
    let used = ASSUMED_OF_SOME
        .iter()
        .filter(|(is_used, _)| sorties.iter().any(is_used))
        .map(|(is_used, text)| with_figures(text, &versions(sorties, *is_used)));
    let unknown = (world.terrain == Terrain::Unknown)
        .then_some("the ground is not known: landings end at the altitude of home");
    let every = ASSUMED.into_iter().map(str::to_owned);
    let mut list: Vec<String> = every.chain(used).collect();
    list.extend(unknown.map(str::to_owned));
    let flown = || sorties.iter().map(|s| (s.vehicle, &s.flight));
    list.extend(assumptions::raised_ground(world.terrain.raised_m()));
    list.extend(assumptions::windy_copters(flown(), spec.wind));
    list.extend(assumptions::leaning_copters(flown(), spec));
    list.extend(assumptions::carried_wings(
        sorties.iter().map(|s| s.vehicle),
    ));
    list.extend(assumptions::bends(flown(), world));
    list.extend(assumptions::other_posts(sorties.iter().map(|s| &s.flight)));
    list.extend(assumptions::rally_limit(furthest_rally_m(sorties)));
    list.extend(separation::assumption(
        sorties.len(),
        &spec.buffered_separation(),
    ));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assumptions_state_the_figures_of_the_table() {
        let mut named = Vec::new();
        for (_, text) in ASSUMED_OF_SOME {
            let mut rest = *text;
            while let Some((_, name, after)) = placeholder(rest) {
                assert!(figure(name, &[]).is_some(), "{name}");
                named.push(name);
                rest = after;
            }
        }
        for (kind, autopilot, airframe) in KINDS {
            for (name, found) in facts(autopilot, airframe).behaviour.figures() {
                let is_named = named.contains(&format!("{kind}.{name}").as_str());
                let text = found.to_string();
                assert!(!is_named || text != "nothing", "{kind}.{name}");
            }
        }
        let texts: Vec<String> = ASSUMED_OF_SOME
            .iter()
            .map(|(_, t)| with_figures(t, &[]))
            .collect();
        for expected in [
            "by up to 12 s (ArduPilot), 14 s (PX4 copters) or 30 s (PX4 vtol), all",
            "up to 4.5 s more",
            "up to 1.5 s later",
            "after 0.2 of the planned climb, 14 m over it",
            "with up to 15 s early",
            "else 15 m) at once",
            "is 3.3 s of its climb",
            "with 0.8 of the wind and 21 s of it more",
            "is 3.5 s of its climb",
            "default 17 and 0.75",
            "default 10 and 0.7",
            "at 0.95 of a coordinated turn",
            "at 0.7 of a coordinated turn",
        ] {
            assert!(
                texts.iter().any(|text| text.contains(expected)),
                "{expected}"
            );
        }
    }

    #[test]
    fn assumptions_name_parameters_as_the_version_does() {
        let text = "as far as {name WPNAV_RADIUS}, {name CIRCLE_RADIUS} {CIRCLE_RADIUS} m";
        let in_version = |text: &str| with_figures(text, &["4.7".parse().ok()]);
        let expected = "as far as WP_RADIUS_M, CIRCLE_RADIUS_M 10 m";
        assert_eq!(in_version(text), expected);
        let expected = "as far as WPNAV_RADIUS, CIRCLE_RADIUS 10 m";
        for older in [vec![], vec![None], vec![None, "4.6".parse().ok()]] {
            assert_eq!(with_figures(text, &older), expected, "{older:?}");
        }
        let of_two = with_figures(text, &["4.7".parse().ok(), None]);
        assert!(
            of_two.starts_with("as far as WPNAV_RADIUS or WP_RADIUS_M, "),
            "{of_two}"
        );
        for (_, text) in ASSUMED_OF_SOME {
            let text = in_version(text);
            let mut words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let old = words.find(|word| {
                let version = "4.7".parse().ok();
                let row = parameter(word).filter(|row| name_in(row.name, version) != *word);
                row.is_some() && *word != "GLIDE_SLOPE_MIN"
            });
            assert_eq!(old, None, "{text}");
        }
    }
}
