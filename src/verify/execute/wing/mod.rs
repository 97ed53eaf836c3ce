//! How planes and VTOLs fly mission items.
//!
//! # The flight model of wings
//!
//! The text of [`crate::verify`] in full where it concerns wings, so that it can be written a second time. A
//! QuadPlane is a vtol of ArduPlane. Directions are those of the tangent plane at the origin. The loiter radius of
//! a wing of PX4 is `loiter_radius_m`, or `NAV_LOITER_RAD` if that is more. `R` without a corner is that of
//! `speed_mps` at the ceiling of the area (`max_amsl_m`; where no spec and no flag states one, at the highest place of
//! the mission), in wind with the wind's speed.
//!
//! **Climb-out.** A plane runs from home for `v^2 / 2a`, `v` its speed over the ground on its course at the
//! altitude of the item, `a` its `accel_mps2` (in time at `v / 2`), and leaves the ground. From there it climbs
//! straight on to that
//! altitude, by `max_climb_deg` or `climb_mps` over the speed of `R`, whichever is less: a leg that begins with its
//! speed and ends at a corner. The course leads to the place of the item (PX4), or is `takeoff_heading_deg`
//! (ArduPlane). As long as its height above the ground of the lift-off is less than twice `min_agl_m` with its
//! buffer, or than `min_agl_m` and 20 m if that is more, half of that height must be clear; from there on it is a leg as any other.
//!
//! A plane of PX4 is up to 36 s late from there on. Each is judged besides: level 14 m higher from 0.2 of that climb to its end, straight from the lift-off to
//! the altitude at 0.2, and straight to the next place from there, from 0.46 of the climb and from two places between,
//! equally far apart. In wind each of these points is anywhere up to as far downwind as the wind goes in 0.32 (PX4: 0.1) of the
//! time that `climb_mps` takes.
//!
//! A plane of ArduPlane is judged as well on its ways by the L1 law from each of these points: with the heading of its
//! takeoff there, to the next place with the distance from the leg taken as 0 and the angle as that to the place from wherever it
//! is (`Plane::verify_takeoff`), and along up to three legs from there, as under the L1 law; to the next place at the altitudes of
//! the straight line there, and level at that of the place where the change is small. It may be earlier, from the leg to
//! the next place on, by what the straight way there from 0.2 of the climb takes less than the planned one from there.
//!
//! **Glide.** Straight from the place before to the ground at the place of the item, which must be within 10 m of
//! its altitude. Its last part is judged as the first of a climb-out.
//!
//! **Onto a circle.** Along the tangent, clockwise where the radius `r` is positive, with the altitude of the
//! circle at its end; in space as well to places between that end and the middle, up to 30 m apart, and straight to the middle, also 6 m (a plane of PX4: 3 m, its VTOL no such lines), and what is left of the
//! climb, above and below the two ends of that line. Of a climb of `c` to a middle at a distance `d` is left `c r /
//! d`, on the line 0, and the lag of `c` in the time that `speed_mps` takes for `d`, of `climb_mps` at most.
//! ArduPlane does not follow a leg to a circle, and PX4 may swing off it: the same lines lead to the middle from each place of its way that is more than
//! 0.5 m beside that leg, at the altitude of the leg abeam; and of a return that climbs level ones at both altitudes. From
//! within the circle it flies straight out to the rim, from the middle north, and is anywhere within `r + 2 R` at
//! the altitudes before and after.
//!
//! **The radius of a circle** of ArduPlane is the stated one times the square of the true over the indicated
//! airspeed at its altitude, or where it comes from if that is higher. With a bank `b` of `NAVL1_LIM_BANK` and
//! `r0 = v^2 / g tan b` at the indicated airspeed no wider than stated, it is the stated one, or `r0` times that square if
//! that is more (`AP_L1_Control::loiter_radius`).
//!
//! **On a circle.** The orbit. Rings from `r - 0.2 R` to `r + 0.75 R` (a plane of PX4: `r + 0.25 R`, its VTOL none), or `1.2 r` of one that
//! ArduPlane leaves if that is more: at the altitude of the circle, 6 m (PX4: 3 m) and what is left of a climb or
//! of the lag of the legs before it lower, as much and what is left of a descent or of that lag higher. A circle to an altitude: columns around it, and a disc at the altitude before. A
//! circle that is not left towards a place further away than `r`, and any of PX4 that is left: a disc of `r + 2 R`.
//!
//! **Off a circle or a climb on rotors.** From the rim of the region straight to the next place, from the altitude
//! there; level, 6 m higher (a plane of PX4: 3 m, its VTOL 0), where the place is lower; and at the altitudes of the leg from the
//! middle, at each place by how far along it that is. So on legs after it that begin in the region.
//!
//! **The L1 law** (`AP_L1_Control::update_waypoint`, `Plane::verify_nav_wp`). With the period `T` (`NAVL1_PERIOD`,
//! 17 s), the damping `z` (`NAVL1_DAMPING`, 0.75) and the speed over the ground `v`, `L = z T v / pi`. The angle
//! `n1` has the sine of the distance to the right of the leg over `L`, at most 45 degrees. Where it is below 5
//! degrees, an integral grows by 0.02 of it a second, up to 0.1. `n2` is the course to the right of that of the
//! leg. With `n` the sum of the three, at most 90 degrees, the law demands `4 z^2 v^2 sin(n) / L` to the left, by
//! the bank whose tangent is that over `g`, at most `ROLL_LIMIT_DEG` or else that of the load factor. The bank
//! follows within 0.5 s (an error of it falls to `1/e`), and 0.7 of what it gives turns the wing. The speed through
//! the air is that of the leg; a second way is judged with 1.08 of that (a plane was 1.08 times as fast behind its climb-out).
//! Where `n2` is more than 170 degrees it may turn to either side, and both ways are judged.
//!
//! It begins at the first place on the course of the first leg, and takes the next leg abeam of the end of one, or
//! where that end is nearer than `WP_RADIUS` (90 m) times the square of the true over the indicated airspeed, or
//! `L` of the speed of the leg if that is less, times the change of course as a share of 90 degrees, 1 at most.
//! Steps are 0.05 s. Each half second in which it is 0.5 m off its leg and the one before is judged as a straight
//! line, at the altitudes of the leg at its end, by how far along that it is.
//!
//! **The law of a wing of PX4** (`DirectionalGuidance::guideToPath`, `AirspeedDirectionController`). With `t = NPFG_PERIOD *
//! NPFG_DAMPING` (10 s, 0.7) and `v` over the ground, 1 m/s at least, `b = t v`. At a distance `e` from the line of the
//! leg, with `s = min(e / b, 1)`, the course is turned from the leg towards it by 90 degrees less `90 (1 - s)^2`. Before
//! the beginning of the leg, and further than `NPFG_SW_DST_MLT b` (0.32) from it, it is that to the beginning. The
//! heading that makes this course in the wind at the speed through the air `a` is turned to by `0.8885 a sin(error)`, an
//! error of 90 degrees at most (of more than 150 degrees to either side: one way to the left and one to the right is judged), by a bank of `FW_R_LIM` at most, or else that of the load factor. The bank follows within
//! 0.5 s, and 0.95 of what it gives turns the wing. It takes the next leg abeam of the end of one, or within
//! `NAV_ACC_RAD` (10 m) of that; from version 1.18 on, and where the version is not known, a second way is judged that takes it within `NPFG_SW_DST_MLT b` of the
//! speed of the leg, if that is more. In wind further
//! ways are judged with 0.9 of the speed through the air. The rest is as under the L1 law, without an integral.
//!
//! **Arrivals.** After the climb of a VTOL without a place ahead these are judged as well for the three legs after each that
//! begins in the region, for a wing that comes to their first place straight through the region, on courses up to
//! 10 degrees apart from tangent to tangent.
//!
//! **Regions** are judged along lines up to 15 m apart, 2 parts at least: discs from west to east, rings along
//! polygons of 12 sides at least, hulls and columns from places on the rim, the wind's by parts of its way.

pub(crate) mod altitude_lag;
pub(crate) mod altitude_offsets;
pub(crate) mod circle_radius;
pub(crate) mod drift;
pub(crate) mod guidance;
pub(crate) mod items;
mod l1;
pub(crate) mod line;
pub(crate) mod loiter;
pub(crate) mod maneuvers;
mod npfg;
pub(crate) mod overshoot;

/// Step of the integration and between the places of a way, seconds.
pub(crate) const STEP_S: f64 = 0.05;
