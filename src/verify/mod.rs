//! The verdict on encoded missions, in continuous time.
//!
//! ```text
//! items -> decode (what the autopilot reads) -> flight (legs, fillets, ramps, holds: segments of constant velocity)
//!       -> space (ground, ceiling, threats, zones, area, fence), contract (the rest of the spec), separation (pairs)
//! ```
//!
//! It judges missions of any source, knows nothing of the search that may have made them, and
//! reads the ground from its source. A limit that it cannot judge fails.
//!
//! # The flight model
//!
//! Complete, so that it can be written a second time from this text (of wings with that of
//! `src/verify/execute/wing/mod.rs`) and the spec alone: `tools/check_missions.py` is that second one, and the two are
//! held against each other: copters, planes and VTOLs of both autopilots in space, wings in still air and in wind;
//! the separations of copters, and those of wings of PX4 that circle at their ends alone.
//!
//! **Items.** Latitude and longitude are 1e-7 degrees, altitudes float32. ArduPilot keeps
//! whole centimetres (cut off toward zero) and whole seconds of a waypoint's hold. Frames
//! 0 and 5 are above the sea, 3 and 6 above the ground at the place of the home row, 10
//! and 11 above the ground below. A delay before the takeoff is the departure; without
//! one ArduPilot leaves at 0 and PX4 at the vehicle's `depart_s`, at 0 if that has a window.
//!
//! **Lines.** A leg is straight between its two places in the tangent plane at the origin
//! (at most `d L^2 / 8 R^2` from the geodesic, `d` from the origin: 2 cm for 20 km, 15 km from there). Where that and
//! what the map of the autopilot bends a leg by (`L^2 tan(lat) / 8 R` of ArduPilot at the latitude of the leg, two
//! thirds of the former around its takeoff of PX4) are more than 10 m together, it is judged wider by so much.
//! Lengths and distances are those of the places on the ellipsoid: what is flown at a
//! height is longer by its share of the earth's radius, 0.016 % at 1000 m. Altitude is
//! linear in distance; to an item above ground, the height above ground is, from whatever
//! it was at the beginning of the leg. The ground is bilinear between the heights of its
//! source.
//!
//! **Ground that is followed.** ArduPilot follows a surface that is bilinear between posts of its own, `TERRAIN_SPACING`
//! apart (100 m), with the heights of the same source, and moves all of it so that it is on the ground at home, by 30 m at
//! most. Where the posts lie is its affair: at each place that surface may be as far below and above the ground as the worst of
//! 16 ways has it, the place lying 0 to 3 quarters of a cell east and north of a post. Heights above ground, and altitudes for
//! ceilings and zones, are judged with that and with what it is above and below at home; distances of vehicles with the greater.
//!
//! **From stop to stop.** The vehicle rests after the takeoff, at a waypoint with a hold,
//! at `NAV_LOITER_TIME` and `NAV_LOITER_UNLIM`, before the descent of a landing, before a return,
//! where the table below says so, and
//! where two items in a row are at one place (within 0.025 m): at different altitudes a copter goes
//! straight up there with `climb_mps` or down with `descent_mps`. Of a wing such items are not judged, nor is a spline
//! after them. In between:
//!
//! - A leg's cruise speed is that of the last `DO_CHANGE_SPEED` before the item that it
//!   leads to, else that of the parameters, else the spec's.
//!   A copter is slower on a leg between altitudes that it would else climb or descend faster than `climb_mps` or
//!   `descent_mps`, 0.02 m of its rise aside: so fast that it does not.
//! - A corner with a change of course `phi` is flown as an arc that touches both legs. On a wing its
//!   radius is `R = v^2 / (g sqrt(n^2 - 1))`, `v` the faster of the two legs'
//!   speeds, `n` the load factor; it takes `R tan(phi / 2)` of each leg (`phi / 2` at
//!   most 89.9 degrees). Where the two ends of a leg want more than 99 % of it, both are
//!   scaled down to that; a corner takes what the tighter of its two legs leaves it.
//!   Altitude along an arc is linear between its ends (above ground if both legs follow
//!   the ground).
//! - Speed along an arc is constant: the slower of its two legs' speeds, on a copter as below, or
//!   less where the straight parts on either side, flown with `accel_mps2` from or to rest at a
//!   stop, do not allow it. On the straight parts the vehicle speeds up, cruises and
//!   slows down with `accel_mps2`.
//! - Turn fit is judged on every airframe with `R tan(phi / 2)` of both ends of a leg, `R` on a copter at
//!   least `v^2 / accel_mps2`: what a spec allows, also where an autopilot slows down for more.
//!
//! **Parameters.** Those of the mission hold, whatever the spec says: of copters `climb_mps`, `descent_mps` and
//! `accel_mps2` are `WPNAV_SPEED_UP`, `WPNAV_SPEED_DN` and `WPNAV_ACCEL`, or `MPC_Z_V_AUTO_UP`, `MPC_Z_V_AUTO_DN` and
//! `MPC_ACC_HOR`; of those of PX4 no more than `MPC_Z_VEL_MAX_UP` and `MPC_Z_VEL_MAX_DN`, and of all speeds than `MPC_XY_VEL_MAX`. Of wings `TECS_CLMB_MAX` and `TECS_SINK_MAX`, or `FW_T_CLMB_R_SP` and `FW_T_SINK_R_SP` (`FW_T_CLMB_MAX` and `FW_T_SINK_MAX` where they are less), and the load factor of
//! `ROLL_LIMIT_DEG` or `FW_R_LIM`, where they are less; on the rotors of a VTOL `Q_WP_SPEED_UP` and `Q_WP_SPEED_DN`, or
//! those of copters.
//!
//! **Corners of copters.** `r` is the acceptance radius: on ArduPilot `WPNAV_RADIUS`, on PX4 that of the
//! waypoint (`param2`) or else `NAV_ACC_RAD`; of the parameters of the mission, else 2 m on both. `v` is the
//! slower speed of the two legs, `a` is `accel_mps2`, `h = phi / 2`, again at most 89.9 degrees.
//!
//! - Where `h` is below 1e-6 there is no arc.
//! - PX4 (by its sources): an arc takes `r` of each leg, `T` after scaling, at the speed
//!   `sqrt(0.5 a T / tan h)`, at most `v`.
//! - ArduCopter gives each leg a profile from rest to rest with the acceleration `a` and the
//!   jerk `j` (`WPNAV_JERK` of the parameters, else 1 m/s^3). A ramp to `v` lasts `p(v) = v / a + a / j`, or `2 sqrt(v / j)` where `v < a^2 / j`. After
//!   a time `t` up to half of it the vehicle has come `d(t) = j t^3 / 6`, from `b = a / j` on
//!   `j b^3 / 6 + (t - b) (j b^2 / 2 + a (t - b) / 2)`. A leg between stops that has a corner is flown no
//!   faster than the `v` with `v p(v)` its length.
//! - The end of one leg overlaps with the begin of the next for `2 t`: `t = p(v) / 2` if then `2 d(t) sin h
//!   <= r`, else the `t` with `2 d(t) sin h = r`. The arc takes `2 d(t) sin h / tan(h / 2)` of each leg.
//! - `WPNAV_ACCEL_C` of the parameters, absent or 0 for `2 a`, is `c`: where `2 min(a, sqrt(j v)) sin h >= c` the
//!   legs overlap for no more than `c / (j sin h)`, and not all of the ramp overlaps.
//! - Where all of the ramp overlaps, the arc is flown at `v h / tan h`: it takes as long as the way over the
//!   waypoint. Else the corner costs `q = p(v) - 2 t + m`
//!   seconds, at least 0; `m` is linear between 0 s at 0 and 20 degrees of `phi`, -0.4 at 30 and 45, -0.1 at 60, 0 at
//!   75, 0.1 at 90, 0.2 at 105, 0.3 at 120, 0.4 at 135, 0.55 at 150, 0.8 at 180. The speed of the arc is the `c`, at most
//!   `v`, with `(v - c)^2 / (a v) + 2 h T / (c tan h) - 2 T / v = q`, `T` what the arc takes after scaling (`2 h` is
//!   `phi` here).
//! - For the separation a copter is up to `T tan(h / 2)` beside its arcs: it may cut the corner or
//!   pass through the waypoint. In space the legs are judged as far as the corner besides the arc.
//!
//! **Stops by airframe.** A wing never stops but at its takeoff and landing on rotors.
//!
//! | item after the waypoint | ArduCopter | PX4 copter | plane, vtol |
//! |---|---|---|---|
//! | waypoint, hold there 0 s | passes | passes | passes |
//! | the same, one altitude above terrain and the other not | stops | passes (no such frame) | passes |
//! | waypoint with a hold (of the waypoint itself) | stops | stops | passes: ignores holds |
//! | `NAV_LOITER_TIME` | stops there, also for 0 s | stops there, passes with 0 s | circles, goes on |
//! | `NAV_LOITER_UNLIM` | passes, stays there | passes, stays there | circles there |
//! | `NAV_DELAY` | stops | stops | not judged, ArduPilot: ignores it |
//! | `NAV_LAND` at another place | stops, then flies there | passes, stops there | glides, descends there |
//! | `NAV_RETURN_TO_LAUNCH` | stops | stops | not judged |
//! | `NAV_LOITER_TO_ALT` | stops, and stops there | not judged | circles, goes on |
//! | `NAV_LOITER_TURNS` | stops | no such command | ArduPilot: circles, goes on |
//! | `NAV_SPLINE_WAYPOINT` | passes, on the curve below | no such command | not judged |
//! | `NAV_PAYLOAD_PLACE` | passes, stops there; with an altitude more than `WPNAV_RADIUS` from that of the waypoint not judged | no such command | not judged |
//! | conditions, commands without motion | passes | passes | passes |
//!
//! **Splines** (ArduCopter, by its sources). The curve is the Hermite polynomial in place and altitude (above ground
//! where both ends are) from the place before to that of the item. At its begin its tangent is the vector of
//! the leg before, or the tangent at the end of the spline before, and zero at rest. At its end it is the vector from the
//! place before to the next one where the next item is a spline, else that from its own place to the next one; zero
//! with a hold, before a return and at the end of the mission. Where both tangents together are longer than four times
//! the distance, both are shortened to that. Before other items the end is not judged. Speed is at most that of the leg, what
//! `climb_mps` and `descent_mps` allow, and `sqrt(0.5 a r)` in bends of radius `r`; it changes with `0.5 a`.
//!
//! **Circles on rotors** (ArduCopter `NAV_LOITER_TURNS`, by its sources). From rest straight to the edge of the circle,
//! at the altitude of the item: on the line to the middle, `r` times the horizontal over the spatial distance from it, since
//! 4.7 `r` from it. Without a known version the first, and in space straight to the second as well. Rest there. The turns with the slower of the speed, `sqrt(0.5 a r)` and `CIRCLE_RATE` (20 degrees a second), then
//! along the tangent to rest within `a / 2 + v^2 / 2a`, or `v` times a second where `v < a`. Without a radius that of
//! the circle before, or `CIRCLE_RADIUS` (10 m). Not judged from within 3 m of the middle.
//!
//! **Circles that a wing leaves.** In space the orbit, and the hull of circle and next place: of ArduPlane, which leaves
//! towards the next place (`Plane::verify_loiter_heading`), a circle of 1.2 radii (or 0.75 turn radii further out than
//! its own, if that is more), else one wider by two turn radii, as
//! for who begins inside of its circle. To an altitude, all altitudes on the circle. In time the vehicle is on the
//! circle for its turns or time, and as late as 1.25 orbits more take. A circle with a radius below that of a corner at its
//! altitude and speed fails.
//!
//! **Payload.** Down from the altitude that it has, with a speed between `descent_mps` and that of a landing, to the ground
//! or by param1 at most, for `PLDP_DELAY` seconds there, and up again with `climb_mps`.
//!
//! **Where a wing turns.** A waypoint of ArduPlane with 1 m or more in `param2` is not judged: it turns that far before it. So is one of
//! a PX4 wing where `param2` is more than the radius of its turns.
//!
//! Items after `NAV_LOITER_UNLIM` are never flown, and fail the count of judged items unless
//! the spec says loiter. So do items after a landing, but for further returns and landings, and items after a
//! `DO_JUMP` that ArduPilot repeats for ever. Of such a mission one repetition more is judged; from then on, for
//! the separation, the vehicle may be anywhere around that repetition.
//!
//! **What an autopilot takes from where it is.** To ArduCopter an altitude of 0 is the altitude before, and latitude
//! and longitude 0 the place before (`ModeAuto::loc_from_cmd`). `NAV_LOITER_TO_ALT` is a stop at its place and
//! altitude. To the place of a landing or payload it flies at the altitude that it has: above the ground
//! where the item is in a frame above terrain (`ModeAuto::shift_alt_to_current_alt`), else above the sea.
//! A PX4 copter whose mission has no takeoff first climbs over its home, to the altitude of the first item.
//!
//! **Air.** On a wing commanded speeds are indicated airspeeds. At an altitude `z` its speed through
//! the air `a` is greater by `(1 - 2.25577e-5 z)^-2.12794` (the standard atmosphere): on a leg at that
//! of its middle, for the radius of a corner at that of the corner.
//!
//! **Wind.** A copter holds its ground speed in any wind, and fails where its lean angle does not let it: on legs and
//! circles with their speed less the wind, at rest with all of the wind. A wing with the airspeed `a` on a
//! course that the wind `w` crosses at an angle `e` off its origin it makes `sqrt(a^2 - (w sin
//! e)^2) - w cos e` over the ground, and what cannot make 1 m/s is not judged from there on. `R`
//! is that of `a + w`. Along an arc the ground speed changes evenly from one leg's to the other's.
//!
//! **Small climbs.** ArduPlane spreads a change of altitude along the leg only from `ALT_SLOPE_MIN`
//! on (before 4.7 `GLIDE_SLOPE_MIN`; of the parameters, else 15 m; 0: never). Where the change is
//! smaller, the leg is judged at the altitude of its end as well.
//!
//! **Lag.** ArduPlane is 3.3 s of its climb below a slope upwards and as much above one downwards,
//! and still on the leg after, of a descent on the legs of the next 6.6 s: legs are judged there as well, in space, by the
//! greatest of their own climb and those of the legs behind; by no more than their own and those of that time leave together,
//! each its 3.3 s or all of its climb if that is less. Not where the ground is followed, nor where a climb-out or glide is
//! judged by half of its height. The legs that are judged from the last place to the rim of a circle and to its middle are
//! judged there likewise (from within the circle, its discs at the ends of these lines), and its rings by what is still left at the rim.
//! A QuadPlane that descends from its climb has not come down yet while it accelerates: it is 17 s of its descent above those
//! legs, and still on the legs of the next 34 s, until one of that length does not descend. No higher than the ends of these legs
//! and 3.3 s of their greatest descent: where the line above a leg is higher, it is level there.
//! A wing of PX4 is judged likewise with 3.5 s, and with the altitude of a waypoint a loiter radius
//! before it, by its sources. On a leg to a circle it also climbs with `climb_mps` or descends with `descent_mps` from the beginning of
//! the leg to the altitude of the circle, is level from there, and is anywhere between that and its slope, at lines up to 20 m
//! apart; so on all ways to the circle that are judged.
//!
//! **Swings.** ArduPlane follows its legs by the L1 law: the way that it gives is judged in space besides the legs, and
//! for the separation the vehicle is anywhere within what that way is beside the legs 2 s before and after, and late by
//! what it takes longer. Its climb-out is judged steeper and higher too, and in wind further downwind, and a plane that has its height
//! early turns off towards its next place from there, by that law, and is as much earlier; on the circle
//! of its end it is up to 0.75 turn radii further out than the radius.
//!
//! **Rotors of a QuadPlane.** As long as it climbs it leans little, and the wind drives it to any side with 0.8 of its
//! speed: the climb is judged there as well. From the top it flies on where its nose points, which nobody knows: it is
//! judged anywhere within 80 m, two turn radii and 21 s of the wind more, in the hull of that disc and the first place (and
//! the next, from a place within the disc), on the ways of its L1 law that come to that place on any course through the hull,
//! and as late as 80 m and two turn radii take against the wind. It overshoots the place that it lands at before it descends: a disc
//! of 18 m there. A descent to which it comes with the wind from behind is judged anywhere within 20 s of that wind. In more
//! than 4 m/s of wind the verdict fails, on a plane in more than 6 m/s.
//!
//! **In the air.** A vehicle that departs in the air is at its position at that time, and begins its
//! first leg with as much of its speed as points along it. On a wing that is inside of its circle
//! it flies straight to the rim.
//!
//! **Ends.** A takeoff rises straight up with `climb_mps` from the ground at the home
//! row, by 1 m at least on ArduCopter and by `MIS_TAKEOFF_ALT` on the rotors of PX4 (2.5 m); in the air it is a climb of ArduCopter where it is,
//! if it leads up, and is not judged elsewhere. PX4 then goes on to the item's place, and rests. A landing flies to its place at the altitude that the vehicle has, as above, rests,
//! and descends with `descent_mps`, from 10 m above the ground on with no more than 0.5
//! m/s (ArduPilot) or 0.7 m/s (PX4). A return climbs to `return_amsl_m` unless it is
//! above, flies straight to home, and lands. Without `return_amsl_m` it returns by the parameters of the mission, if they
//! are there, and whatever the spec says: ArduCopter at `RTL_ALT` above home, or `RTL_CLIMB_MIN` above its own altitude if that is
//! more, near home no higher than `RTL_CONE_SLOPE` times the distance, nor above the altitude fence less its margin, with `RTL_SPEED`,
//! to the ground or to `RTL_ALT_FINAL`; PX4 at `RTL_RETURN_ALT`, within `RTL_MIN_DIST` of home in the cone of
//! `RTL_CONE_ANG`. ArduPlane returns so, and when its mission ends in the air, to a circle of `RTL_RADIUS`, or else `WP_LOITER_RAD`, at
//! `RTL_ALTITUDE` over home. Parameters that lead a return elsewhere end the judgement there. A wing of PX4 whose mission ends in the air circles around its last place with
//! `NAV_LOITER_RAD`. A vehicle that loiters, or whose mission
//! ends in the air, stays for ever.
//!
//! **Lateness.** Real vehicles are late, and not all alike. From its takeoff on a copter or vtol of ArduPilot may be up to
//! 12 s late (that vtol also 4 s early), of PX4 a copter 14 s and a vtol 30 s, and a plane up to 15 s early; two of one
//! autopilot and airframe are so alike. A copter of PX4 may lose 12 s more in its climb, each on its own. A wing of
//! ArduPlane gains up to 0.05 of the time since its takeoff besides, each on its own.
//! Every stop at the end of legs adds up to 4.5 s to what a vehicle is late by, from where it brakes for it on, to each
//! on its own; every leg of a PX4 copter up to 1.5 s, from its beginning on, and from 1.18 on up to 0.1 of its time besides; every corner of
//! ArduCopter where not all of the ramp overlaps up to 0.2 s, from its end on. A copter counts its metres on a sphere, of
//! 6378100 m (ArduPilot) or 6371000 m: from 600 s after its takeoff on, every leg that is longer there adds the same share
//! of its time to what it is late by, from its beginning on, every other to what it is early by. On such a sphere a leg is as
//! long as the root of two squares: the difference of latitude, and that of longitude times the cosine of the middle latitude.
//! `src/path/lateness.rs` says what was measured.
//!
//! **Buffers.** A spec of version 2 has a buffer to each limit in space. The verdict adds it: to the
//! distance from threats, zones (over one with a height as much altitude) and the edge of the area,
//! to the least height above ground, to the separation, and takes it off the ceiling. Takeoff and
//! landing have no buffer to the ground, and the fence of the mission none besides that of what it
//! encloses. Where vehicles keep a buffer, no copter may cut corners further (`WPNAV_RADIUS`,
//! `NAV_ACC_RAD`) than the margin of its fence, `FENCE_MARGIN` or else the buffer.
//!
//! **Margins.** Clearance is taken along whole legs as far as their corners, and along
//! the arcs, the columns of takeoff and landing aside; threats everywhere, as the
//! horizontal distance to the axis less the radius. Separation is the distance, by
//! horizontal distance and difference of altitude, of one vehicle at `t` and the other at
//! `u`, both in the air, for every `u - t` between `-time_slack_s` and `time_slack_s`, each
//! widened by what the two may be late or early against each other. Curved and accelerated
//! motion is judged in segments within 0.02 m, ground that is followed within 0.1 m:
//! clearance over arcs and separation come out short by that, distances from arcs to threats, zones and edges by
//! up to twice as much, never long.

mod execute;
mod judge;
mod limit;
mod limits;
mod measure;
mod review;
mod verified;

pub use judge::{Executed, Judge};
pub use limit::{Basis, Flown, Limit, Repair, Topic};
pub use limits::distant::{distant_from_area, distant_from_home};
pub use limits::parked::{Landed, landings, landings_on_parked};
pub use review::{Reviewer, review};
pub use verified::{VerifiedSegment, VerifiedTrajectory, verified_trajectories};

use std::collections::BTreeSet;

use crate::geodesy::{Amsl, LatLon};
use crate::spec::Span;

/// The verdict on the missions of a fleet.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Review {
    /// Every limit with its worst value, violated or not.
    pub margins: Vec<Margin>,
    /// Where each vehicle is over time, in the order of the missions given.
    pub tracks: Vec<Track>,
    /// What the flight model assumes and was not measured on an autopilot.
    pub assumptions: Vec<String>,
}

/// The worst value of one limit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Margin {
    /// Id of the vehicle.
    pub vehicle: String,
    /// Id of the other vehicle, for separation.
    pub other: Option<String>,
    /// Which limit.
    pub limit: Limit,
    /// The worst value; NaN where it cannot be known, and then `ok` is false and `note` says why.
    pub value: f64,
    /// What the value must be at least or at most; NaN where the limit has no such value.
    pub bound: f64,
    /// What of `bound` is the buffer of the spec, in the same unit; 0 where the limit has none.
    pub buffer: f64,
    /// Which side of the limit is good.
    pub sense: Sense,
    /// Unit of both, such as `m`, `deg`, `items`.
    pub unit: &'static str,
    /// Where and when it is worst, if that is anywhere.
    pub at: Option<Moment>,
    /// Of a separation that has a worst moment: how the two vehicles are shifted there.
    pub shift: Option<Shift>,
    /// Whether the limit holds.
    pub ok: bool,
    /// A remark for the reader; usually empty.
    pub note: String,
}

/// By how much the times of the second of two vehicles are shifted against the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Where the separation is worst, seconds.
    pub worst_s: f64,
    /// What the two may be shifted by there, seconds: departures, and what autopilots are late.
    pub allowed_s: Span,
}

impl Shift {
    /// The most that is allowed to the side on which the separation is worst, seconds.
    #[must_use]
    pub fn max_s(&self) -> f64 {
        if self.worst_s < 0.0 {
            -self.allowed_s.least
        } else {
            self.allowed_s.most
        }
    }
}

/// Which side of a limit is good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// The value must be at least the limit.
    AtLeast,
    /// The value must be at most the limit.
    AtMost,
}

/// A place and time of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Where.
    pub place: LatLon,
    /// How high.
    pub amsl: Amsl,
    /// Seconds after T0.
    pub t_s: f64,
    /// Row of the `.waypoints` file: home is 0, the first item 1.
    pub item: usize,
}

/// Where one vehicle is over time, from takeoff to touchdown: straight motions at constant
/// velocity between the moments.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Id of the vehicle.
    pub vehicle: String,
    /// In order of time.
    pub moments: Vec<Moment>,
    /// By how much the vehicle may be later than at each moment, seconds: what stops, corners and legs add to the
    /// lateness of its takeoff. Empty where no verdict says.
    pub late_s: Vec<f64>,
}

/// A limit with the bound that its value is compared with.
#[derive(Clone, Debug)]
pub(crate) struct Requirement {
    pub(crate) limit: Limit,
    pub(crate) bound: f64,
    pub(crate) sense: Sense,
    pub(crate) unit: &'static str,
}

impl Requirement {
    /// The value must be at least `bound`.
    pub(crate) fn at_least(limit: Limit, bound: f64, unit: &'static str) -> Self {
        let sense = Sense::AtLeast;
        Self {
            limit,
            bound,
            sense,
            unit,
        }
    }

    /// The value must be at most `bound`.
    pub(crate) fn at_most(limit: Limit, bound: f64, unit: &'static str) -> Self {
        Self {
            sense: Sense::AtMost,
            ..Self::at_least(limit, bound, unit)
        }
    }

    /// The margin of a value; NaN violates the limit.
    pub(crate) fn margin(self, vehicle: &str, value: f64, at: Option<Moment>) -> Margin {
        let mut margin = Margin {
            vehicle: vehicle.to_owned(),
            other: None,
            limit: self.limit,
            value,
            bound: self.bound,
            buffer: 0.0,
            sense: self.sense,
            unit: self.unit,
            at,
            shift: None,
            ok: false,
            note: String::new(),
        };
        margin.ok = match margin.sense {
            Sense::AtLeast => value >= margin.bound,
            Sense::AtMost => value <= margin.bound,
        };
        margin
    }
}

impl Margin {
    /// A limit that fails because it cannot be judged.
    #[must_use]
    pub fn unjudged(vehicle: &str, limit: Limit, note: impl Into<String>) -> Self {
        Self {
            note: note.into(),
            ..Requirement::at_least(limit, f64::NAN, "").margin(vehicle, f64::NAN, None)
        }
    }

    /// Whether the limit is one of this vehicle, alone or with another.
    #[must_use]
    pub fn concerns(&self, vehicle: &str) -> bool {
        self.vehicle == vehicle || self.other.as_deref() == Some(vehicle)
    }

    /// The vehicles that the limit concerns.
    fn ids(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.vehicle)
            .chain(&self.other)
            .map(String::as_str)
    }

    /// How far the value is on the good side of its limit; negative on the other;
    /// NaN where it cannot be judged.
    #[must_use]
    pub fn slack(&self) -> f64 {
        match self.sense {
            Sense::AtLeast => self.value - self.bound,
            Sense::AtMost => self.bound - self.value,
        }
    }
}

impl Review {
    /// Whether every limit that concerns this vehicle holds.
    #[must_use]
    pub fn accepts(&self, vehicle: &str) -> bool {
        let mut concerned = self
            .margins
            .iter()
            .filter(|margin| margin.concerns(vehicle))
            .peekable();
        concerned.peek().is_some() && concerned.all(|margin| margin.ok)
    }

    /// The vehicles that [`Self::accepts`] accepts.
    #[must_use]
    pub fn accepted(&self) -> BTreeSet<&str> {
        let mut accepted: BTreeSet<&str> = self.margins.iter().flat_map(Margin::ids).collect();
        for margin in self.margins.iter().filter(|margin| !margin.ok) {
            for id in margin.ids() {
                accepted.remove(id);
            }
        }
        accepted
    }

    /// Whether every limit holds. A review without any margin has judged nothing and fails.
    #[must_use]
    pub fn passes(&self) -> bool {
        !self.margins.is_empty() && self.margins.iter().all(|margin| margin.ok)
    }
}
