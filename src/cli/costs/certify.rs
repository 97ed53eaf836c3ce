//! `sortie certify`: a bound in altitude too, with a proof.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use crate::cli::args;
use crate::cli::folder::{self, replace};
use crate::cli::print::console::{note, out_json};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::cli::print::table::Rows;
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::plan::{CertifyBudget, certify};
use crate::report::{CertificateDocument, certificate_document};
use crate::spec::{EndPoint, MissionSpec, Order, Placement, SpecFile, Stop, Vehicle};
use crate::world::{self, World};

pub(in crate::cli) fn run(arguments: &args::Certify) -> Result<(), Failure> {
    let file = SpecFile::read_known(&arguments.spec).map_err(world::with_ground)?;
    let world = world::load(&file)?;
    let chosen = chosen(arguments, &file.spec)?;
    let hash = folder::sha256(&file.text);
    let plan = planned(&arguments.folder, &hash)?;
    let (mut planned_spec, mut world) = (file.spec.clone(), world);
    if !file.spec.tasks.is_empty() {
        stops_of_tasks(plan.as_ref(), &mut planned_spec, &mut world)?;
        note("the stops of the plan, in its order, stand for the tasks");
    }
    let spec = &planned_spec;
    #[expect(
        clippy::disallowed_methods,
        reason = "the operator asks for a time; every bound is proven"
    )]
    let (progress, begun) = (Progress::start(), Instant::now());
    // Time that a vehicle does not use is left to the next ones.
    let time_per_vehicle_s = arguments.within.unwrap_or(f64::INFINITY) / count(chosen.len());
    let vehicles = chosen.iter().enumerate().map(|(number, &index)| {
        let id = &spec.vehicles[index].id;
        let say = |share: f64| progress.say(&format!("{id}: {:.0} %", 100.0 * share));
        say(0.0);
        let is_over = |share: f64| {
            begun.elapsed().as_secs_f64() > time_per_vehicle_s * (count(number) + share)
        };
        let budget = CertifyBudget {
            cells: arguments.cells,
            progress: &say,
            is_over: &is_over,
        };
        (index, certify(spec, &world, index, &budget))
    });
    let document = certificate_document((spec, &world), &hash, vehicles.collect());
    drop(progress);
    let path = arguments.folder.join("certificate.json");
    fs::create_dir_all(&arguments.folder).map_err(|error| {
        Failure::new(
            Failure::OUTPUT,
            format!("{}: {error}", arguments.folder.display()),
        )
    })?;
    let text = serde_json::to_vec(&document)
        .map_err(|error| Failure::new(Failure::OUTPUT, error.to_string()))?;
    replace::write_file(&path, &text)?;
    print(&document, plan.as_ref(), arguments.json)?;
    note(&format!("certificate in {}", path.display()));
    Ok(())
}

#[expect(clippy::cast_precision_loss, reason = "few vehicles")]
fn count(vehicles: usize) -> f64 {
    vehicles as f64
}

/// The vehicles that are asked for, whose routes are in a fixed order.
fn chosen(arguments: &args::Certify, spec: &MissionSpec) -> Result<Vec<usize>, Failure> {
    let is_asked = |vehicle: &Vehicle| {
        let asked = arguments.vehicle.as_ref();
        asked.is_none_or(|id| *id == vehicle.id)
    };
    let fleet = spec.vehicles.iter().enumerate();
    let chosen: Vec<(usize, &Vehicle)> = fleet.filter(|(_, one)| is_asked(one)).collect();
    if chosen.is_empty() {
        let known: Vec<&str> = spec.vehicles.iter().map(|one| one.id.as_str()).collect();
        let id = arguments.vehicle.as_deref().unwrap_or_default();
        let text = format!("no vehicle {id} (there are: {})", known.join(", "));
        return Err(Failure::new(Failure::USAGE, text));
    }
    let mut free = chosen.iter().filter(|(_, one)| one.order == Order::Free);
    if let Some((_, vehicle)) = free.next() {
        let text = format!(
            "{}: `order: free`: only routes in a fixed order are certified",
            vehicle.id
        );
        return Err(Failure::new(Failure::INPUT, text));
    }
    Ok(chosen.into_iter().map(|(index, _)| index).collect())
}

/// Gives each vehicle the stops that the plan has for its tasks, where and in the order in which they are
/// in it.
fn stops_of_tasks(
    plan: Option<&Value>,
    spec: &mut MissionSpec,
    world: &mut World,
) -> Result<(), Failure> {
    let input = |text: &str| Failure::new(Failure::INPUT, text.to_owned());
    let plan = plan.ok_or_else(|| {
        input("`tasks`: the folder has no plan of this spec, which says who does them: run sortie plan")
    })?;
    for (index, vehicle) in spec.vehicles.iter_mut().enumerate() {
        let mut planned = plan["vehicles"].as_array().into_iter().flatten();
        let own = planned.find(|own| own["id"] == vehicle.id.as_str());
        let stops = own.and_then(|own| own["stops"].as_array());
        let (mut made, mut points) = (Vec::new(), Vec::new());
        for stop in stops.into_iter().flatten() {
            let number = |key: &str| stop[key].as_f64();
            let place = number("lat_deg").zip(number("lon_deg"));
            let place = place.and_then(|(lat, lon)| LatLon::new(lat, lon).ok());
            let (Some(place), Some(amsl_m)) = (place, number("amsl_m")) else {
                return Err(input("plan.json: a stop without its place: plan again"));
            };
            let id = stop["id"].as_str().unwrap_or_default();
            let altitude = Placement::Amsl(Amsl(amsl_m));
            made.push(Stop::passing(id, EndPoint { place, altitude }));
            let (at, amsl) = (world.frame.to_plan(place), Amsl(amsl_m));
            points.push(PlanPoint { at, amsl });
        }
        vehicle.stops = made;
        world.sites[index].stops = points;
    }
    Ok(())
}

/// The plan in a folder, if it is one of this spec.
fn planned(folder: &Path, hash: &str) -> Result<Option<Value>, Failure> {
    let path = folder.join("plan.json");
    let Ok(text) = fs::read(&path) else {
        return Ok(None);
    };
    let plan: Value = serde_json::from_slice(&text)
        .map_err(|error| Failure::new(Failure::INPUT, format!("{}: {error}", path.display())))?;
    if plan["spec_sha256"] == hash {
        return Ok(Some(plan));
    }
    note(&format!(
        "{}: of another spec; gaps are not shown",
        path.display()
    ));
    Ok(None)
}

fn print(
    document: &CertificateDocument,
    plan: Option<&Value>,
    as_json: bool,
) -> Result<(), Failure> {
    let of_plan = |id: &str, key: &str| -> Option<f64> {
        let vehicles = plan?["vehicles"].as_array()?;
        let vehicle = vehicles.iter().find(|vehicle| vehicle["id"] == id)?;
        match key {
            "cost" => vehicle["cost"]["total"].as_f64(),
            _ => vehicle[key].as_f64(),
        }
    };
    let gap = |id: &str, bound: f64| of_plan(id, "cost").map(|cost| (cost - bound) / bound);
    if as_json {
        let vehicles = document.vehicles.iter().map(|vehicle| {
            json!({"id": vehicle.id, "bound": vehicle.bound, "gap": gap(&vehicle.id, vehicle.bound)})
        });
        let vehicles: Vec<Value> = vehicles.collect();
        return out_json(&json!({"spec_sha256": document.spec_sha256, "vehicles": vehicles}));
    }
    let mut rows = Rows::new(&["vehicle", "cost", "bound of the plan", "certified", "gap"]);
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    for vehicle in &document.vehicles {
        let gap = gap(&vehicle.id, vehicle.bound);
        rows.add([
            vehicle.id.clone(),
            number(of_plan(&vehicle.id, "cost")),
            number(of_plan(&vehicle.id, "bound")),
            number(Some(vehicle.bound)),
            gap.map_or("-".to_owned(), |gap| format!("{:.2} %", 100.0 * gap)),
        ]);
    }
    rows.print()
}
