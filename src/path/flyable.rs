//! What a copter needs to fly its speed: a lean angle, and how that is known.

use crate::autopilot::{COPTER_LEAN, PX4_LEAN, name_in};
use crate::spec::{Airframe, Autopilot, MissionSpec, Vehicle};

/// What an operator must know of a copter that flies faster through the air than a stock one of its
/// autopilot reached ([`crate::autopilot::Behaviour::lean_speed_mps`]), in words; none where it is
/// slower, no figure is known, or the spec states what it was flown at. In specs of version 2 the
/// parameters allow it to lean further, and the verdict judges each leg; those of version 1 keep
/// their parameters, and it may be late.
#[must_use]
pub fn lean_note(spec: &MissionSpec, vehicle: &Vehicle, ground_mps: f64) -> Option<String> {
    if vehicle.airframe != Airframe::Copter || vehicle.max_airspeed_mps.is_some() {
        return None;
    }
    let facts = vehicle.facts();
    let behaviour = &facts.behaviour;
    let reached = behaviour.lean_speed_mps.of(vehicle.autopilot_version)?;
    let lean = match vehicle.autopilot {
        Autopilot::ArduPilot => name_in(COPTER_LEAN[1], vehicle.autopilot_version),
        Autopilot::Px4 => PX4_LEAN,
    };
    let (id, firmware, version) = (&vehicle.id, facts.firmware, reached.version);
    let air_mps = ground_mps + spec.wind.map_or(0.0, |wind| wind.speed_mps);
    if air_mps <= reached.value {
        return None;
    }
    let wind = match spec.wind {
        Some(_) => " (against the wind)",
        None => "",
    };
    let air = format!("{id}: {air_mps:.1} m/s through the air{wind}");
    if spec.version < 2 {
        return Some(format!(
            "{air} is faster than the {reached} that a stock {firmware} {version} reached at its lean limit: it may be \
             later than the verdict assumes; raise {lean} as far as its thrust allows, or lower speed_mps"
        ));
    }
    let stock_deg = behaviour.lean_deg;
    let lean_deg = vehicle.lean_for_speed_deg(air_mps)?;
    let max_mps = vehicle.flyable_mps(Some(lean_deg))?;
    let suffices = if max_mps < air_mps {
        format!(", enough for {max_mps:.1} m/s: no leg may need more")
    } else {
        String::new()
    };
    Some(format!(
        "{air}: the parameters allow {lean_deg:.0} degrees of lean ({lean}) instead of {stock_deg:.0}{suffices}; a stock \
         {firmware} {version} reached {reached} at {stock_deg:.0}, and drag is taken to grow with the square of the speed"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::SpecFile;

    #[test]
    fn the_note_names_the_lean_parameter_as_the_version_of_the_spec_does() {
        let note = |version: &str| {
            let text = format!(
                "
sortie: 2
name: lean
area: {{south_west: {{lat: 36.28, lon: -84.30}}, north_east: {{lat: 36.32, lon: -84.22}}, min_agl_m: 30, max_amsl_m: 900}}
terrain: {{flat: {{amsl_m: 400}}}}
vehicles:
  - {{id: alpha, sysid: 1, autopilot: ardupilot, {version}link: sim, speed_mps: 12, finish: land,
     start: {{lat: 36.30, lon: -84.28, agl_m: 80}}, goal: {{lat: 36.30, lon: -84.23, agl_m: 80}}}}
"
            );
            let file = SpecFile::parse(std::path::Path::new("lean.yaml"), text);
            let spec = file.expect("a spec").spec;
            lean_note(&spec, &spec.vehicles[0], 20.0).expect("it is fast")
        };
        for (version, name) in [
            ("autopilot_version: \"4.7\", ", "(ATC_ANGLE_MAX)"),
            ("autopilot_version: \"4.6\", ", "(ANGLE_MAX)"),
            ("", "(ANGLE_MAX)"),
        ] {
            let note = note(version);
            assert!(note.contains(name), "{note}");
        }
    }
}
