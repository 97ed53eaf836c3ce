//! The places of tasks over the ground.

use super::Check;
use crate::geodesy::{Agl, Amsl};
use crate::numeric::digits;
use crate::spec::{AltitudeLimits, SweepShape, Task};

impl Check<'_> {
    /// Every place of a task must be one that some vehicle may fly at.
    pub(super) fn tasks(&mut self) {
        let spec = &self.file.spec;
        let copters = || spec.vehicles.iter().filter(|one| !one.airframe.has_wing());
        let Some(widest) = copters().map(|one| one.altitudes).reduce(wider) else {
            return;
        };
        for (index, task) in spec.tasks.iter().enumerate() {
            self.lines((index, task), widest);
            let keys: &[&str] = match task.stops.len() {
                0 => &[],
                1 => &["visit"],
                _ => &["deliver.from", "deliver.to"],
            };
            for (key, stop) in keys.iter().zip(&task.stops) {
                let path = format!("tasks[{index}].{key}");
                self.airborne((&path, "task"), stop.end, (widest, false));
            }
        }
    }

    /// Lines over the ground must be no higher than some vehicle may fly.
    fn lines(&mut self, (index, task): (usize, &Task), widest: AltitudeLimits) {
        let Some((sweep, most)) = task.sweep.as_ref().zip(widest.max_agl) else {
            return;
        };
        let max_m = most.0 - self.file.spec.buffers.ceiling_m;
        if sweep.agl.0 > max_m {
            let of_datum = match sweep.shape {
                SweepShape::Search(_) => ".at",
                _ => "",
            };
            let allowed = format!(
                "at most {} m: max_agl_m less buffer_m.ceiling",
                digits::plain(max_m)
            );
            let path = format!("tasks[{index}].{}{of_datum}.agl_m", sweep.shape.key());
            self.report(&path, digits::plain(sweep.agl.0), allowed);
        }
    }
}

/// What one of two keeps.
fn wider(one: AltitudeLimits, other: AltitudeLimits) -> AltitudeLimits {
    let agl = one.max_agl.zip(other.max_agl);
    let amsl = one.min_amsl.zip(other.min_amsl);
    AltitudeLimits {
        max_agl: agl.map(|(one, other)| Agl(one.0.max(other.0))),
        min_amsl: amsl.map(|(one, other)| Amsl(one.0.min(other.0))),
    }
}
