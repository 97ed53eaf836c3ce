//! Whether a measured value is past its limit, as positions are off: deep at once, shallow once it
//! lasts.
//!
//! Both levels are past the limit itself, which the verdict on the flight judges. So an alarm
//! never rings in a flight that keeps its limits, and what is past one for longer than
//! [`SHALLOW_S`] is never hidden.

use std::collections::BTreeMap;

use super::Key;

/// A limit that is broken by less than what positions are off must stay broken for so long,
/// seconds of flight.
const SHALLOW_S: f64 = 1.0;
/// Between two measurements further apart nothing is known, seconds.
const MAX_STEP_S: f64 = 1.0;
/// What positions may be off: three standard deviations of 2.5 m, and never more than this share
/// of the limit.
pub(super) const ERROR_M: f64 = 7.5;
const ERROR_SHARE: f64 = 0.25;

/// How far a value is past its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Depth {
    /// Not at all.
    Within,
    /// By no more than what positions are off.
    Shallow,
    /// By more.
    Deep,
}

impl Depth {
    /// Of two tests: of the limit, and of the limit less what positions are off.
    pub(super) fn of(is_past: bool, is_far_past: bool) -> Self {
        match (is_past, is_far_past) {
            (_, true) => Self::Deep,
            (true, false) => Self::Shallow,
            (false, false) => Self::Within,
        }
    }
}

/// How long each limit has been broken.
#[derive(Debug, Default)]
pub(super) struct Breaches {
    /// When it was last measured, and for how long it has been broken, less the time in between
    /// in which it was kept.
    since: BTreeMap<Key, (f64, f64)>,
}

impl Breaches {
    /// Takes in a measurement at a time; whether it is an alarm.
    pub(super) fn take(&mut self, t_s: f64, key: Key, depth: Depth) -> bool {
        let before = self.since.get(&key).copied();
        let step_s = before.map_or(0.0, |(at_s, _)| (t_s - at_s).clamp(0.0, MAX_STEP_S));
        let broken_s = before.map_or(0.0, |(_, broken_s)| broken_s);
        let broken_s = match depth {
            Depth::Deep => SHALLOW_S,
            Depth::Shallow => (broken_s + step_s).min(SHALLOW_S),
            Depth::Within => broken_s - step_s,
        };
        if depth == Depth::Within && broken_s <= 0.0 {
            self.since.remove(&key);
            return false;
        }
        self.since.insert(key, (t_s, broken_s));
        depth != Depth::Within && broken_s >= SHALLOW_S - 1e-6
    }
}

/// What a measured distance may be off, metres.
pub(super) fn error_m(limit_m: f64) -> f64 {
    ERROR_M.min(ERROR_SHARE * limit_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::AlarmKind;

    /// When the first alarm rings, of measurements five times a second.
    fn rings_s(depth_at: impl Fn(f64) -> Depth) -> Option<f64> {
        let mut breaches = Breaches::default();
        let key = (AlarmKind::Clearance, 0, None, "");
        let times = (0..100).map(|step| 0.2 * f64::from(step));
        let mut rings = times.filter(|t_s| breaches.take(*t_s, key, depth_at(*t_s)));
        rings.next()
    }

    #[test]
    fn what_is_far_past_its_limit_rings_at_once_and_what_is_little_past_it_within_two_seconds() {
        let from = |depth: Depth| move |t_s: f64| if t_s < 10.0 { Depth::Within } else { depth };
        assert_eq!(rings_s(from(Depth::Deep)), Some(10.0));
        assert!(rings_s(from(Depth::Shallow)).is_some_and(|t_s| (10.9..=11.3).contains(&t_s)));
        // Every fourth measurement is on the other side of the limit by chance.
        let jitters = |t_s: f64| match (t_s < 10.0, (t_s / 0.2).round() % 4.0 < 0.5) {
            (false, false) => Depth::Shallow,
            _ => Depth::Within,
        };
        assert!(
            rings_s(jitters).is_some_and(|t_s| t_s <= 12.0),
            "{:?}",
            rings_s(jitters)
        );
    }

    #[test]
    fn what_is_little_past_its_limit_for_a_moment_does_not_ring() {
        let at_times = |t_s: f64| match t_s % 4.0 < 0.7 {
            true => Depth::Shallow,
            false => Depth::Within,
        };
        assert_eq!(rings_s(at_times), None);
    }
}
