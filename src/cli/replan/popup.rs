//! The threat that was not there, and those that came up before it.

use crate::cli::fly::Sorties;
use crate::cli::print::failure::Failure;
use crate::geodesy::LatLon;
use crate::spec::{Area, MissionSpec, THREAT_RADIUS_M, Threat};
use crate::world::Disc;

/// `LAT,LON,RADIUS` as a threat with a name of its own.
pub(super) fn threat(
    spec: &MissionSpec,
    earlier: &[Threat],
    text: &str,
) -> Result<Threat, Failure> {
    let usage = |why: String| Failure::new(Failure::USAGE, format!("--threat {text}: {why}"));
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [lat, lon, radius] = parts[..] else {
        return Err(usage("not of the form LAT,LON,RADIUS_M".to_owned()));
    };
    let number = |name: &str, text: &str, least: f64, most: f64| {
        let found = text.parse().ok();
        let found = found.filter(|n: &f64| (least..=most).contains(n));
        found.ok_or_else(|| usage(format!("{name} {text:?} (allowed: {least} to {most})")))
    };
    let place = LatLon {
        lat_deg: number("latitude", lat, -90.0, 90.0)?,
        lon_deg: number("longitude", lon, -180.0, 180.0)?,
    };
    let (least, most) = (*THREAT_RADIUS_M.start(), *THREAT_RADIUS_M.end());
    let radius_m = number("radius in metres", radius, least, most)?;
    if !touches(&spec.area, place, radius_m) {
        let (from, to) = (spec.area.south_west, spec.area.north_east);
        return Err(usage(format!(
            "lies outside of the area of the mission (latitude {} to {}, longitude {} to {}); nothing was sent",
            from.lat_deg, to.lat_deg, from.lon_deg, to.lon_deg
        )));
    }
    let taken = |id: &str| spec.threats.iter().chain(earlier).any(|t| t.id == id);
    let id = (1..).map(|n| format!("popup-{n}")).find(|id| !taken(id));
    Ok(Threat {
        id: id.unwrap_or_default(),
        kind: "popup".to_owned(),
        place,
        radius_m,
    })
}

/// Whether a circle lies in the area at least in part. Nobody flies where it does not: two numbers
/// were mistaken for each other.
fn touches(area: &Area, place: LatLon, radius_m: f64) -> bool {
    let (from, to) = (area.south_west, area.north_east);
    let nearest = LatLon {
        lat_deg: place.lat_deg.clamp(from.lat_deg, to.lat_deg),
        lon_deg: place.lon_deg.clamp(from.lon_deg, to.lon_deg),
    };
    place.chord_m(nearest) < radius_m
}

/// Whatever came up is there for all that is planned and judged from now on.
pub(super) fn add(sorties: &mut Sorties, popups: &[Threat]) {
    for threat in popups {
        let center = sorties.world.frame.to_plan(threat.place);
        sorties.world.threats.push(Disc {
            center,
            radius_m: threat.radius_m,
        });
        sorties.file.spec.threats.push(threat.clone());
    }
}
