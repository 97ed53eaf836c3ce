//! What the planner may choose: departures and speeds.

use super::Checker;
use crate::spec::keys;
use crate::spec::{Airframe, Autopilot, Retiming, Span};

impl Checker {
    /// Only what a mission file can carry is left open: a review of the file reads the choice.
    pub(super) fn retiming(
        &mut self,
        path: &str,
        keys: &keys::Vehicle,
        (autopilot, airframe): (Autopilot, Airframe),
    ) -> Retiming {
        let is_copter = !airframe.has_wing();
        let window = keys.depart_window_s.and_then(|window| {
            let path = format!("{path}.depart_window_s");
            if !is_copter {
                let found = "a window, on a wing: no file of a plane or vtol has its departure";
                self.report(&path, found, "depart_s");
            }
            let ends = [("from", window.from), ("to", window.to)];
            self.span(&path, ends, ("depart_s", keys.depart_s))
        });
        let range = keys.speed_range_mps.and_then(|range| {
            let path = format!("{path}.speed_range_mps");
            if !is_copter {
                let found =
                    "a range of speeds, on a wing: its turns and circles depend on speed_mps";
                self.report(&path, found, "speed_mps");
            } else if !autopilot.conventions().speed_in_mission {
                let found =
                    "a range of speeds, on px4: its speed is a parameter, in no mission file";
                self.report(&path, found, "speed_mps");
            }
            let ends = [("min", range.min), ("max", range.max)];
            self.span(&path, ends, ("speed_mps", keys.speed_mps))
        });
        Retiming {
            depart_s: window,
            speed_mps: range,
        }
    }

    /// Two ends in order, with the planned value between them.
    fn span(
        &mut self,
        path: &str,
        [(low, least), (high, most)]: [(&str, Option<f64>); 2],
        (key, planned): (&str, Option<f64>),
    ) -> Option<Span> {
        let least = self.required(path, low, least);
        let most = self.required(path, high, most);
        let (least, most) = (least?, most?);
        if least > most {
            let found = format!("{low} {least} after {high} {most}");
            self.report(path, found, format!("{low} at most {high}"));
            return None;
        }
        let span = Span { least, most };
        if let Some(planned) = planned.filter(|planned| span.miss(*planned) > 0.0) {
            let found = format!("{least} to {most}, without {key} {planned}");
            self.report(path, found, format!("{key} within it"));
        }
        Some(span)
    }
}
