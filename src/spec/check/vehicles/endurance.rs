//! How long or how far a vehicle flies.

use crate::autopilot::Airframe;
use crate::numeric::digits;
use crate::spec::check::Checker;
use crate::spec::{Capacity, Endurance, Energy, keys};

/// Share that is left at touchdown where a spec does not say.
const DEFAULT_RESERVE: f64 = 0.2;

impl Checker {
    /// The endurance of a vehicle that climbs at `climb_mps`; none if it has none, or a broken one.
    pub(super) fn endurance(
        &mut self,
        path: &str,
        keys: Option<&keys::Endurance>,
        (airframe, climb_mps): (Airframe, f64),
    ) -> Option<Endurance> {
        let keys = keys?;
        let path = format!("{path}.endurance");
        let capacity = match (keys.time_s, keys.range_m, &keys.energy) {
            (Some(time_s), None, None) => Some(Capacity::Time(time_s)),
            (None, Some(range_m), None) => Some(Capacity::Range(range_m)),
            (None, None, Some(energy)) => self
                .energy(&format!("{path}.energy"), energy, (airframe, climb_mps))
                .map(Capacity::Energy),
            (None, None, None) => {
                self.report(&path, "none", "one of time_s, range_m and energy");
                None
            }
            _ => {
                let found = "more than one of them";
                self.report(&path, found, "one of time_s, range_m and energy");
                None
            }
        };
        Some(Endurance {
            capacity: capacity?,
            reserve: keys.reserve.unwrap_or(DEFAULT_RESERVE),
        })
    }

    fn energy(
        &mut self,
        path: &str,
        keys: &keys::Energy,
        (airframe, climb_mps): (Airframe, f64),
    ) -> Option<Energy> {
        let before = self.issues.len();
        let wh = self.required(path, "wh", keys.wh);
        let mut level = Vec::new();
        match (keys.hover_w, airframe) {
            (Some(hover_w), _) => level.push((0.0, hover_w)),
            (None, Airframe::Plane) => {}
            (None, Airframe::Copter | Airframe::Vtol) => {
                self.required::<f64>(path, "hover_w", None);
            }
        }
        if keys.cruise.is_empty() && airframe != Airframe::Copter {
            self.report(&format!("{path}.cruise"), "none", "at least one pair");
        }
        for (index, &[speed_mps, power_w]) in keys.cruise.iter().enumerate() {
            let at = format!("{path}.cruise[{index}]");
            let min_mps = level.last().map_or(0.0, |last: &(f64, f64)| last.0);
            let is_good = speed_mps > min_mps && speed_mps <= 200.0;
            if !is_good {
                let allowed = format!("a speed above {} m/s, at most 200", digits::plain(min_mps));
                self.report(&at, digits::plain(speed_mps), allowed);
            }
            if !(0.0..=1_000_000.0).contains(&power_w) {
                self.report(&at, digits::plain(power_w), "0 to 1000000 W");
            }
            level.push((speed_mps, power_w));
        }
        let powers = keys.cruise.iter().map(|pair| pair[1]).chain(keys.hover_w);
        if powers.clone().any(|power_w| power_w == 0.0) && self.issues.len() == before {
            let allowed = "more than 0 W at every speed: without a use of energy it flies for ever";
            self.report(path, "a power of 0 W", allowed);
        }
        if self.issues.len() > before {
            return None;
        }
        let base_w = level.first().map_or(0.0, |first| first.1);
        Some(Energy {
            wh: wh?,
            climbing_w: (keys.climb_w.unwrap_or(base_w) - base_w).max(0.0),
            climb_mps,
            level,
        })
    }
}
