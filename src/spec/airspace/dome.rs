//! Domes: threats that reach less high the further away they are.
//!
//! A dome is a stack of zones, each the disc at its lower end, closed up to its upper end. It is so a
//! little larger than the half sphere, nowhere smaller. Heights count from the ground at its centre.

use crate::geodesy::{Agl, LocalFrame};
use crate::spec::{Buffers, Placement, Threat, Zone};

/// Discs of a dome, at even steps of elevation: the widest step is a tenth of its radius.
const LAYERS: u32 = 15;

/// Between the id of a dome and the height up to which a layer of it is closed.
const BELOW: &str = " below ";

/// The id of the dome that a zone is a layer of.
pub(crate) fn dome_of(zone: &Zone) -> Option<&str> {
    let (id, _) = zone.circle.and(zone.id.rsplit_once(BELOW))?;
    (!zone.bases.is_empty()).then_some(id)
}

/// The distance that a plan keeps from a zone, metres: its file may ask for more than the spec, and a dome has the
/// buffer of threats alone.
pub(crate) fn zone_buffer_m(buffers: &Buffers, zone: &Zone) -> f64 {
    match dome_of(zone) {
        Some(_) => zone.buffer_m,
        None => buffers.zones_m.max(zone.buffer_m),
    }
}

/// The key below `buffer_m` that a zone has its buffer from.
pub(crate) fn zone_buffer_key(zone: &Zone) -> &'static str {
    match dome_of(zone) {
        Some(_) => "threats",
        None => "zones",
    }
}

/// The zones of a dome. They keep the buffer of threats.
pub(crate) fn dome_layers(threat: &Threat, buffers: &Buffers) -> Vec<Zone> {
    let frame = LocalFrame::new(threat.place);
    let elevation_rad =
        |layer: u32| std::f64::consts::FRAC_PI_2 * f64::from(layer) / f64::from(LAYERS);
    let layer = |layer: u32| {
        let radius_m = threat.radius_m * elevation_rad(layer).cos();
        // Upwards to decimetres: no longer figure is printed.
        let top_m = (10.0 * threat.radius_m * elevation_rad(layer + 1).sin()).ceil() / 10.0;
        // Each disc is closed from the ground up: a wider one lies below it.
        Zone {
            circle: Some((threat.place, radius_m)),
            ceiling: Some(Placement::Agl(Agl(top_m))),
            bases: vec![threat.place],
            buffer_m: buffers.threats_m,
            ..Zone::closed(
                format!("{}{BELOW}{top_m:.0} m", threat.id),
                frame.circumscribed(radius_m),
            )
        }
    };
    (0..LAYERS).map(layer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::LatLon;

    #[test]
    fn a_dome_holds_the_half_sphere_and_little_more() {
        let threat = Threat {
            id: "radar".to_owned(),
            kind: "radar".to_owned(),
            place: LatLon {
                lat_deg: 47.0,
                lon_deg: 8.0,
            },
            radius_m: 1000.0,
        };
        let layers = dome_layers(&threat, &Buffers::NONE);
        let is_in = |away_m: f64, up_m: f64| {
            layers.iter().any(|zone| {
                let (_, radius_m) = zone.circle.expect("a circle");
                let Some(Placement::Agl(Agl(top_m))) = zone.ceiling else {
                    panic!("{zone:?}")
                };
                away_m <= radius_m && up_m < top_m
            })
        };
        for step in 0..900 {
            let (sin, cos) = (f64::from(step) / 10.0).to_radians().sin_cos();
            assert!(is_in(999.9 * cos, 999.9 * sin), "{step}");
            assert!(!is_in(1101.0 * cos, 1101.0 * sin), "{step}");
        }
    }
}
