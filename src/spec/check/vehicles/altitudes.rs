//! Limits of altitude that leave a layer to fly in.

use crate::geodesy::{Agl, Amsl};
use crate::numeric::digits;
use crate::spec::check::Checker;
use crate::spec::check::map::Map;
use crate::spec::{AltitudeLimits, Area, Buffers, keys};

impl Checker {
    /// The limits of altitude of a vehicle, those of the area included.
    pub(super) fn altitudes(
        &mut self,
        path: &str,
        keys: &keys::Vehicle,
        map: Option<&Map>,
    ) -> AltitudeLimits {
        let own = AltitudeLimits {
            max_agl: keys.max_agl_m.map(Agl),
            min_amsl: keys.min_amsl_m.map(Amsl),
        };
        let Some(map) = map else { return own };
        self.altitude_layer(path, own, &map.area, &map.buffers);
        own.tighter(map.area.altitudes)
    }

    /// Reports limits below `path` that leave no height between them and their opposites.
    pub(in crate::spec::check) fn altitude_layer(
        &mut self,
        path: &str,
        limits: AltitudeLimits,
        area: &Area,
        buffers: &Buffers,
    ) {
        let plain = digits::plain;
        let both_m = buffers.terrain_m + buffers.ceiling_m;
        let with_buffers = match both_m > 0.0 {
            true => format!(
                " and buffer_m.terrain {} m and buffer_m.ceiling {} m",
                plain(buffers.terrain_m),
                plain(buffers.ceiling_m)
            ),
            false => String::new(),
        };
        if let Some(Agl(max_m)) = limits.max_agl {
            let min_m = area.min_agl.0 + both_m;
            if max_m <= min_m {
                let allowed = format!(
                    "more than {} m: area.min_agl_m {} m{with_buffers}",
                    plain(min_m),
                    plain(area.min_agl.0)
                );
                self.report(&format!("{path}.max_agl_m"), plain(max_m), allowed);
            }
        }
        if let Some(Amsl(min_m)) = limits.min_amsl {
            let max_m = area.max_amsl.0 - both_m;
            if min_m >= max_m {
                let less = with_buffers.replacen(" and", " less", 1);
                let allowed = format!(
                    "less than {} m: area.max_amsl_m {} m{less}",
                    plain(max_m),
                    plain(area.max_amsl.0)
                );
                self.report(&format!("{path}.min_amsl_m"), plain(min_m), allowed);
            }
        }
    }
}
