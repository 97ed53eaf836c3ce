//! Whether what was flown can have been flown: no vehicle holds a pace that it cannot fly, and none
//! gets further than its reported speed takes it.

use super::limits::moment;
use super::proof::{CROSS_TRACK_M, at_most};
use super::takeoff::at_its_fastest;
use super::{FlownTrack, GAP_S};
use crate::flight::record::Fix;
use crate::spec::{Airframe, Vehicle};
use crate::verify::{Flown, Margin};

/// Least duration of a pace: seconds, and multiples of the error of clocks.
const HELD_S: f64 = 10.0;
const CLOCKS: f64 = 4.0;
/// What the clock of a record may be off: a message waits so long on a busy machine, on the wall's
/// clock, seconds. Never more than is not known anyway.
const WAITS_S: f64 = 0.25;
/// A copter holds this share of its planned speed, climb and descent at most (real `ArduCopter`s: 1.01
/// over the ground and upright).
const COPTER: f64 = 1.2;
/// The same of a wing over the ground, winds besides that of the spec included, and upright: real
/// ArduPlanes climbed out with full throttle, 1.42 and 1.8 times as fast as planned for 13 s.
const WING: f64 = 1.6;
const WING_UPRIGHT: f64 = 2.5;
/// Its own speed may be off by this share. Real ones got at most 3 m further than that took them.
const OWN: f64 = 1.1;
/// Altitudes are off by so much, metres.
const UP_M: f64 = 10.0;

/// A part of a flight that is long enough to tell its pace.
struct Stretch<'f> {
    /// Its last position.
    fix: &'f Fix,
    /// How long it took, seconds.
    took_s: f64,
    /// Straight from its first position to its last: across and up, metres.
    across_m: f64,
    up_m: f64,
    /// How far its own speed takes it meanwhile, and the greatest of that speed, metres and m/s.
    own_m: f64,
    fastest_mps: f64,
}

/// What the clock of a record may be off, seconds; `speedup` is how much faster than the wall's clock
/// the time of its vehicles went.
pub(super) fn clock_off_s(speedup: f64) -> f64 {
    // A number that is none is the least.
    (WAITS_S * speedup.max(1.0)).min(GAP_S)
}

impl FlownTrack<'_> {
    /// The paces that it held; `off_s` is what clocks may be off.
    pub(crate) fn paces(&self, off_s: f64) -> Vec<Margin> {
        let Some(vehicle) = self.vehicle else {
            return Vec::new();
        };
        let stretches = self.stretches(HELD_S + CLOCKS * off_s);
        let (across, upright) = match vehicle.airframe {
            Airframe::Copter => (COPTER, COPTER),
            Airframe::Plane | Airframe::Vtol => (WING, WING_UPRIGHT),
        };
        let fastest_mps = across * at_its_fastest(vehicle).fastest_mps();
        let by = |speed_mps: f64, of: &Stretch<'_>| speed_mps * (of.took_s + off_s);
        let climbs = |climb_mps: f64, of: &Stretch<'_>| upright * by(climb_mps, of) + UP_M;
        let Vehicle {
            climb_mps,
            descent_mps,
            ..
        } = *vehicle;
        let paces = [
            self.pace(Flown::GroundSpeed, &stretches, |of| {
                (of.across_m, by(fastest_mps, of) + CROSS_TRACK_M)
            }),
            self.pace(Flown::ReportedSpeed, &stretches, |of| {
                let own_m = of.own_m + of.fastest_mps * off_s;
                (of.across_m, OWN * own_m + CROSS_TRACK_M)
            }),
            self.pace(Flown::ClimbRate, &stretches, |of| {
                (of.up_m, climbs(climb_mps, of))
            }),
            self.pace(Flown::DescentRate, &stretches, |of| {
                (-of.up_m, climbs(descent_mps, of))
            }),
        ];
        paces.into_iter().flatten().collect()
    }

    /// From each position to the first that is so much later; the whole flight, if it is shorter.
    fn stretches(&self, min_s: f64) -> Vec<Stretch<'_>> {
        let fixes = self.fixes();
        let mut own_m = vec![0.0; fixes.len()];
        for index in 1..fixes.len() {
            let (from, to) = (&fixes[index - 1], &fixes[index]);
            let mean_mps = 0.5 * (from.speed_mps + to.speed_mps);
            own_m[index] = own_m[index - 1] + mean_mps * (to.t_s - from.t_s);
        }
        let mut stretches = Vec::new();
        let mut to = 0;
        for from in 0..fixes.len() {
            let is_short = |to: usize| fixes[to].t_s - fixes[from].t_s < min_s;
            while to + 1 < fixes.len() && is_short(to) {
                to += 1;
            }
            if from > 0 && is_short(to) || from == to {
                break;
            }
            let (a, b) = (&self.points[from], &self.points[to]);
            let speeds = fixes[from..=to].iter().map(|fix| fix.speed_mps);
            stretches.push(Stretch {
                fix: &fixes[to],
                took_s: fixes[to].t_s - fixes[from].t_s,
                across_m: a.at.distance_m(b.at),
                up_m: b.amsl.0 - a.amsl.0,
                own_m: own_m[to] - own_m[from],
                fastest_mps: speeds.fold(0.0, f64::max),
            });
        }
        stretches
    }

    /// The worst of how far it got, against how far it can have got; as speeds.
    fn pace(
        &self,
        limit: Flown,
        stretches: &[Stretch<'_>],
        far: impl Fn(&Stretch<'_>) -> (f64, f64),
    ) -> Option<Margin> {
        let over_m = |of: &&Stretch<'_>| {
            let (got_m, limit_m) = far(of);
            got_m - limit_m
        };
        let worst = stretches.iter();
        let worst = worst.max_by(|a, b| over_m(a).total_cmp(&over_m(b)))?;
        let (got_m, limit_m) = far(worst);
        let required = at_most(limit, limit_m / worst.took_s, "m/s");
        Some(Margin {
            // Not `>`: what is no number is none that it can have flown.
            ok: got_m <= limit_m,
            note: format!("over {:.0} s", worst.took_s),
            ..required.margin(self.id(), got_m / worst.took_s, Some(moment(worst.fix)))
        })
    }
}
