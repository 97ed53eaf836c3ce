//! What `replan` writes for the record of a flight.

use super::Operator;
use crate::flight::event::Event;
use crate::flight::record::lines::Line;
use crate::flight::session::Fleet;
use crate::link::Time;

/// The lines of the record for a line of `replan`. A threat counts from now on at the latest,
/// whatever time it was given.
pub(super) fn replan_lines(
    line: String,
    fleet: &mut Fleet<'_>,
    now: Time,
    operator: &mut dyn Operator,
) -> Vec<String> {
    let t_s = fleet.t_s(now);
    let (line, vehicle, text) = match serde_json::from_str(&line) {
        Ok(Line::Threat {
            t_s: given_s,
            threat,
        }) => {
            let t_s = t_s.map_or(given_s, |now_s| given_s.min(now_s));
            let text = format!("replan reports a threat, {}", threat.words());
            fleet.heed_threat(threat.clone(), t_s);
            (Line::Threat { t_s, threat }.text(), None, text)
        }
        Ok(Line::Plan {
            t_s: given_s,
            vehicle,
            plan,
        }) => {
            fleet.heed_plan(now, &vehicle, (given_s, plan));
            let text = "is sent another plan by replan".to_owned();
            (line, Some(vehicle), text)
        }
        Ok(Line::Event { vehicle, event, .. }) => {
            let event = Event::new(t_s, vehicle, event);
            let _ = operator.event(&event);
            return vec![Line::of_event(&event).text()];
        }
        _ => return vec![line],
    };
    let event = Event {
        t_s,
        vehicle,
        text,
        alarm: None,
    };
    // A screen that takes nothing is reported with the next event.
    let _ = operator.event(&event);
    vec![line, Line::of_event(&event).text()]
}
