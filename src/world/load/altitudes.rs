//! Start and goal against the greatest height above ground and the least altitude.

use super::Check;
use crate::geodesy::{Agl, Amsl};
use crate::numeric::digits;
use crate::spec::{AltitudeLimits, BufferedLimit};

impl Check<'_> {
    /// Reports a point at an altitude over ground that is outside of the limits of its vehicle.
    pub(super) fn within(
        &mut self,
        (path, what): (&str, &str),
        limits: AltitudeLimits,
        (amsl, ground): (Amsl, Amsl),
    ) {
        let buffers = self.file.spec.buffers;
        let agl_m = amsl.above_ground(ground).0;
        if let Some(Agl(max_m)) = limits.max_agl {
            let limit = BufferedLimit {
                key: "ceiling",
                of: "max_agl_m",
                limit_m: max_m,
                buffered_m: max_m - buffers.ceiling_m,
            };
            let over = format!("above ground at {:.1} m", ground.0);
            if agl_m > max_m {
                let above_m = digits::distinct_from(agl_m, max_m, 1);
                let found = format!("{what} is {above_m} m {over}");
                let allowed = format!("at most {} m (max_agl_m)", digits::plain(max_m));
                self.report(path, found, allowed);
            } else if agl_m > limit.buffered_m {
                let above_m = digits::distinct_from(agl_m, limit.buffered_m, 1);
                let found = format!("{what} is {above_m} m {over}");
                self.report(path, found, limit.allowed(agl_m));
            }
        }
        if let Some(Amsl(min_m)) = limits.min_amsl {
            let limit = BufferedLimit::beyond(("terrain", "min_amsl_m"), min_m, buffers.terrain_m);
            if amsl.0 < min_m {
                let at_m = digits::distinct_from(amsl.0, min_m, 1);
                let found = format!("{what} is at {at_m} m");
                let allowed = format!("at least {} m (min_amsl_m)", digits::plain(min_m));
                self.report(path, found, allowed);
            } else if amsl.0 < limit.buffered_m {
                let at_m = digits::distinct_from(amsl.0, limit.buffered_m, 1);
                let found = format!("{what} is at {at_m} m");
                self.report(path, found, limit.allowed(amsl.0));
            }
        }
    }
}
