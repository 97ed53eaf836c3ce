//! What the planner may choose: departures and speeds.

use std::ops::RangeInclusive;

use super::Checker;
use super::fleet::{LATEST_S, SPEED_MPS};
use crate::spec::raw;
use crate::spec::{Retiming, Span};

impl Checker<'_> {
    /// Only what a mission file can carry is left open: judged again, a file says what was chosen.
    pub(super) fn retiming(&mut self, path: &str, raw: &raw::Vehicle) -> Retiming {
        let is_copter = !raw.airframe.has_wing();
        let window = raw.depart_window_s.and_then(|window| {
            let path = format!("{path}.depart_window_s");
            if !is_copter {
                let found = "a window, on a wing: no file of a plane or vtol has its departure";
                self.report(&path, found, "depart_s");
            }
            let ends = [("from", window.from), ("to", window.to)];
            self.span(&path, ends, LATEST_S, ("depart_s", raw.depart_s))
        });
        let range = raw.speed_range_mps.and_then(|range| {
            let path = format!("{path}.speed_range_mps");
            if !is_copter {
                let found =
                    "a range of speeds, on a wing: its turns and circles depend on speed_mps";
                self.report(&path, found, "speed_mps");
            } else if !raw.autopilot.conventions().speed_in_mission {
                let found =
                    "a range of speeds, on px4: its speed is a parameter, in no mission file";
                self.report(&path, found, "speed_mps");
            }
            let ends = [("min", range.min), ("max", range.max)];
            self.span(&path, ends, SPEED_MPS, ("speed_mps", Some(raw.speed_mps)))
        });
        Retiming {
            depart_s: window,
            speed_mps: range,
        }
    }

    /// Two ends in order, with the wanted value between them.
    fn span(
        &mut self,
        path: &str,
        [(low, least), (high, most)]: [(&str, f64); 2],
        range: RangeInclusive<f64>,
        (key, wanted): (&str, Option<f64>),
    ) -> Option<Span> {
        let before = self.issues.len();
        self.number(&format!("{path}.{low}"), least, range.clone());
        self.number(&format!("{path}.{high}"), most, range);
        if least > most {
            let found = format!("{low} {least} after {high} {most}");
            self.report(path, found, format!("{low} at most {high}"));
        }
        if self.issues.len() > before {
            return None;
        }
        let span = Span { least, most };
        if let Some(wanted) = wanted.filter(|wanted| !wanted.is_nan() && span.miss(*wanted) > 0.0) {
            let found = format!("{least} to {most}, without {key} {wanted}");
            self.report(path, found, format!("{key} within it"));
        }
        Some(span)
    }
}
