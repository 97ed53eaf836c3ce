//! Links of vehicles: from the command line, a running `fly`, or the spec.

use std::collections::BTreeMap;

use super::print::failure::Failure;
use crate::flight::{FlightPlan, Notice};
use crate::spec::{Link, SpecFile};

/// Links from the command line, by the index of their vehicle.
pub(super) fn given(file: &SpecFile, arguments: &[String]) -> Result<Vec<(usize, Link)>, Failure> {
    let usage = |message: String| Failure::new(Failure::USAGE, message);
    arguments
        .iter()
        .map(|argument| {
            let (id, address) = argument
                .split_once('=')
                .ok_or_else(|| usage(format!("--link {argument}: not of the form ID=ADDR")))?;
            let vehicle = file
                .spec
                .vehicles
                .iter()
                .position(|vehicle| vehicle.id == id);
            let vehicle = vehicle
                .ok_or_else(|| usage(format!("--link {argument}: no vehicle {id} in the spec")))?;
            let link = Link::parse(address).ok_or_else(|| {
                usage(format!(
                    "--link {argument}: no such link (allowed: {})",
                    Link::ALLOWED
                ))
            })?;
            Ok((vehicle, link))
        })
        .collect()
}

/// The addresses of vehicles in flight: from the command line, else from the running `fly`, else
/// from the spec.
pub(super) fn under_way(
    plan: &FlightPlan,
    arguments: &[String],
    notice: &Notice,
) -> Result<Vec<(usize, Link)>, Failure> {
    let given = given(&plan.file, arguments)?;
    let mut found = Vec::new();
    for (index, _) in &plan.missions {
        let id = &plan.vehicle(*index).id;
        let announced = notice.links.get(id).and_then(|link| Link::parse(link));
        let is_given = given.iter().any(|(of, _)| of == index);
        let link = match announced {
            Some(link) if !is_given => link,
            _ => link_of(&plan.file, *index, &given).clone(),
        };
        if link == Link::Sim {
            let message = format!(
                "{id}: its simulated vehicle does not run (`sortie fly` starts it, or `sortie vehicles` with --link)"
            );
            return Err(Failure::new(Failure::TRANSFER, message));
        }
        found.push((*index, link));
    }
    Ok(found)
}

/// The link of a vehicle: the last that the command line gives, or that of the spec.
pub(super) fn link_of<'a>(
    file: &'a SpecFile,
    vehicle: usize,
    links: &'a [(usize, Link)],
) -> &'a Link {
    let given = links.iter().rev().find(|(of, _)| *of == vehicle);
    given.map_or(&file.spec.vehicles[vehicle].link, |(_, link)| link)
}

/// Refuses two vehicles with one system id on one link.
pub(super) fn refuse_shared(
    file: &SpecFile,
    vehicles: impl Iterator<Item = usize>,
    links: &[(usize, Link)],
) -> Result<(), Failure> {
    let mut seen = BTreeMap::new();
    for vehicle in vehicles {
        let this = &file.spec.vehicles[vehicle];
        let link = link_of(file, vehicle, links);
        // Every simulated vehicle has a link of its own.
        if *link == Link::Sim {
            continue;
        }
        if let Some(other) = seen.insert((link.to_string(), this.sysid), &this.id) {
            let message = format!(
                "{other} and {} have one system id, {}, on one link, {link}; nothing was sent",
                this.id, this.sysid
            );
            return Err(Failure::new(Failure::INPUT, message));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const LARGE: &str = "\
sortie: 1
name: large
area:
  south_west: {lat: 36.20, lon: -84.40}
  north_east: {lat: 36.40, lon: -84.10}
  min_agl_m: 60
  max_amsl_m: 1500
terrain: {flat: {amsl_m: 300}}
fleet:
  id: d{n}
  start_grid: {south_west: {lat: 36.21, lon: -84.39}, rows: 5, columns: 50, spacing_m: 150}
  goal_grid: {south_west: {lat: 36.30, lon: -84.39}, rows: 5, columns: 50, spacing_m: 150}
  defaults: {autopilot: px4, link: sim, start: {agl_m: 80}, goal: {agl_m: 80}, finish: land, speed_mps: 12}
";

    #[test]
    fn one_system_id_on_one_link_is_one_vehicle_too_many() {
        let file = SpecFile::parse(Path::new("large.yaml"), LARGE.to_owned()).unwrap();
        let sysid = |index: usize| file.spec.vehicles[index].sysid;
        assert_eq!(
            (file.spec.vehicles.len(), sysid(0), sysid(240)),
            (250, 1, 1)
        );
        let all = || 0..file.spec.vehicles.len();
        assert!(refuse_shared(&file, all(), &[]).is_ok(), "each has its own");
        let to = |index: usize, port: u16| (index, Link::UdpOut(format!("127.0.0.1:{port}")));
        assert!(refuse_shared(&file, all(), &[to(0, 14550), to(240, 14551)]).is_ok());
        assert!(refuse_shared(&file, all(), &[to(0, 14550), to(239, 14550)]).is_ok());
        let refused = refuse_shared(&file, all(), &[to(0, 14550), to(240, 14550)]);
        let message = refused.unwrap_err().message;
        assert!(
            message.contains("d1 and d241 have one system id, 1"),
            "{message}"
        );
        let refused = crate::flight::refuse_shared_sysids(&file.spec);
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("d1 and d241"), "{message}");
    }
}
