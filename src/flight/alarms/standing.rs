//! Alarms that stand: raised once, and over when their cause is gone.

use super::onboard::STATES;
use super::{Alarm, Alarms, HEARTBEATS_S, LONG_STALL_S, STALL_WALL_S};
use crate::spec::AlarmKind;

/// The cause of an alarm must be gone for this long before it is over, seconds.
const OVER_S: f64 = 3.0;
/// One of a position estimate, which gets better and worse in turns, for this long.
const EKF_OVER_S: f64 = 10.0;

/// Which alarm: what, of whom, with whom, and why.
pub(super) type Key = (AlarmKind, usize, Option<usize>, &'static str);

/// An alarm that stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    pub(super) since_s: f64,
    /// When its cause was last seen.
    pub(super) seen_s: f64,
}

/// Stalls of this ground station, in which it neither listened nor looked: each began before it had caught up with the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stall {
    /// Seconds after T0.
    from_s: f64,
    until_s: f64,
    /// All of them together, seconds, and their number.
    lasted_s: f64,
    times: usize,
}

impl Stall {
    /// Whether a time is before it has caught up: after a stall, positions that waited are taken in, and simulated
    /// vehicles of the same machine catch up, for as long again.
    fn reaches(&self, t_s: f64) -> bool {
        t_s >= self.from_s && t_s <= self.until_s + self.lasted_s
    }

    /// What an alarm that is raised at a time says of them.
    fn named(&self, t_s: f64, speedup: f64) -> Option<String> {
        let (lasted_s, wall_s) = (self.lasted_s, self.lasted_s / speedup);
        let times = match self.times {
            1 => String::new(),
            times => format!(" {times} times,"),
        };
        self.reaches(t_s).then(|| {
            format!(
                "the ground station had stalled{times} for {wall_s:.1} s, {lasted_s:.0} s of flight"
            )
        })
    }
}

impl Alarms<'_> {
    /// Seconds since the last look. Between two looks there are some hundredths of a second: much more is a stall, which
    /// counts where flights are faster than the wall's clock.
    pub(super) fn note_stall(&mut self, t_s: f64) -> f64 {
        let from_s = self.looked_s.unwrap_or(t_s);
        if self.speedup > 1.0 && t_s - from_s > LONG_STALL_S.max(STALL_WALL_S * self.speedup) {
            let before = self.stall.filter(|stall| stall.reaches(from_s));
            self.stall = Some(Stall {
                from_s: before.map_or(from_s, |stall| stall.from_s),
                until_s: t_s,
                lasted_s: before.map_or(0.0, |stall| stall.lasted_s) + t_s - from_s,
                times: before.map_or(0, |stall| stall.times) + 1,
            });
        }
        t_s - from_s
    }

    /// Raises what a vehicle's own reports are the cause of.
    pub(super) fn look_at_health(&mut self, t_s: f64, index: usize) {
        let of = &mut self.vehicles[index];
        let (flies, is_up) = (of.duty.flies, of.duty.flies && of.duty.is_up);
        let is_ordered = of.duty.is_ordered;
        let health = &of.health;
        let battery = health.battery().filter(|_| flies);
        let estimate = health.estimate().filter(|_| is_up);
        let fence = health.fence().filter(|_| is_up);
        let gps = health.gps().filter(|_| is_up);
        // What does not come is not over because the flight is.
        let stands = |kind| self.standing.contains_key(&(kind, index, None, "reports"));
        let is_due = |kind, flies: bool| flies || stands(kind);
        let [battery_due, estimate_due, gps_due] = [
            is_due(AlarmKind::Battery, flies),
            is_due(AlarmKind::Ekf, is_up),
            is_due(AlarmKind::Position, is_up),
        ];
        let no_battery = health.battery_silence().filter(|_| battery_due);
        let no_estimate = health.estimate_silence().filter(|_| estimate_due);
        let no_gps = health.gps_silence().filter(|_| gps_due);
        let mission = of.onboard.mission(t_s).filter(|_| flies);
        let others = of.onboard.others(t_s).map(|text| text.filter(|_| flies));
        let [home, rally, lists] = others.map(|text| text.map(str::to_owned));
        let mode = of
            .onboard
            .mode(of.mission, t_s - of.starts_s() > HEARTBEATS_S);
        let mode = mode.filter(|_| is_up && !is_ordered);
        if of.mode_reports.is_news(t_s, mode.as_deref()) {
            // Another mode is another alarm.
            self.standing.remove(&(AlarmKind::Mode, index, None, ""));
        }
        let settings = of.onboard.settings().filter(|_| flies).map(str::to_owned);
        if of.settings_reports.is_news(t_s, settings.as_deref()) {
            self.standing
                .remove(&(AlarmKind::Mission, index, None, "parameters"));
        }
        for (kind, cause, text) in [
            (AlarmKind::Battery, "", battery),
            (AlarmKind::Ekf, "", estimate),
            (AlarmKind::Fence, "", fence),
            (AlarmKind::Position, "fix", gps),
            (AlarmKind::Battery, "reports", no_battery),
            (AlarmKind::Ekf, "reports", no_estimate),
            (AlarmKind::Position, "reports", no_gps),
            (AlarmKind::Mission, "", mission),
            (AlarmKind::Mission, "home", home),
            (AlarmKind::Mission, "rally", rally),
            (AlarmKind::Mission, "fence", lists),
            (AlarmKind::Mission, "parameters", settings),
            (AlarmKind::Mode, "", mode),
        ] {
            self.set(t_s, (kind, index, None, cause), text);
        }
        self.look_at_states(t_s, index, flies);
    }

    /// Raises what its heartbeats say of an emergency, and how often its mode and its parameters changed besides.
    fn look_at_states(&mut self, t_s: f64, index: usize, flies: bool) {
        for (state, name, words) in STATES {
            let says = flies && self.vehicles[index].onboard.is_in_state(state);
            let text = says.then(|| format!("its heartbeat says {name}: {words}"));
            self.set(t_s, (AlarmKind::Text, index, None, name), text);
        }
        let of = &mut self.vehicles[index];
        let counted = [
            (AlarmKind::Mode, "", of.mode_reports.poll(t_s)),
            (
                AlarmKind::Mission,
                "parameters",
                of.settings_reports.poll(t_s),
            ),
        ];
        for (kind, cause, text) in counted {
            if let Some(text) = text {
                self.push(t_s, (kind, index, None, cause), true, text);
            }
        }
    }

    /// Raises an alarm that has a cause, and ends one whose cause is gone.
    pub(super) fn set(&mut self, t_s: f64, key: Key, cause: Option<String>) {
        match (self.standing.get_mut(&key), cause) {
            (None, Some(text)) => {
                let seen = Standing {
                    since_s: t_s,
                    seen_s: t_s,
                };
                self.standing.insert(key, seen);
                self.push(t_s, key, true, text);
            }
            (Some(standing), Some(_)) => standing.seen_s = t_s,
            (Some(standing), None) if t_s - standing.seen_s >= over_s(key.0) => {
                let lasted_s = standing.seen_s - standing.since_s;
                self.standing.remove(&key);
                let is_off = [AlarmKind::Corridor, AlarmKind::Late].contains(&key.0)
                    && self.vehicles[key.1].duty.is_ordered;
                let text = match (is_off, key.3) {
                    (true, _) => "not looked for any more: it was ordered off its path".to_owned(),
                    (false, "") => format!("over after {lasted_s:.0} s"),
                    (false, cause) => format!("over after {lasted_s:.0} s ({cause})"),
                };
                self.push(t_s, key, false, text);
            }
            _ => {}
        }
    }

    pub(super) fn push(&mut self, t_s: f64, key: Key, is_raised: bool, mut text: String) {
        let (kind, vehicle, other, cause) = key;
        let stall = self.stall.filter(|_| is_raised);
        if let Some(stall) = stall.and_then(|stall| stall.named(t_s, self.speedup)) {
            text += &format!(" ({stall})");
        }
        self.out.push_back(Alarm {
            t_s,
            vehicle,
            other,
            kind,
            cause,
            is_raised,
            text,
        });
    }
}

/// For how long the cause of an alarm must be gone, seconds.
fn over_s(kind: AlarmKind) -> f64 {
    match kind {
        AlarmKind::Ekf => EKF_OVER_S,
        _ => OVER_S,
    }
}
