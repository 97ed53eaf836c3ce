//! `sortie certify`: a bound in altitude too, with a proof.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::cli::args;
use crate::cli::folder::{self, replace};
use crate::cli::print::console::{note, out_json};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::cli::print::table::Rows;
use crate::plan::certify;
use crate::report::{CertificateDocument, certificate_document};
use crate::spec::{Order, SpecFile};
use crate::world;

pub(in crate::cli) fn run(arguments: &args::Certify) -> Result<(), Failure> {
    let file = SpecFile::read(&arguments.spec)?;
    let world = world::load(&file)?;
    let spec = &file.spec;
    let chosen: Vec<usize> = (0..spec.vehicles.len())
        .filter(|&index| {
            let asked = arguments.vehicle.as_ref();
            asked.is_none_or(|id| *id == spec.vehicles[index].id)
        })
        .collect();
    if chosen.is_empty() {
        let known: Vec<&str> = spec.vehicles.iter().map(|one| one.id.as_str()).collect();
        let id = arguments.vehicle.as_deref().unwrap_or_default();
        let text = format!("no vehicle {id} (there are: {})", known.join(", "));
        return Err(Failure::new(Failure::USAGE, text));
    }
    let free = chosen.iter().map(|&index| &spec.vehicles[index]);
    if let Some(vehicle) = free
        .into_iter()
        .find(|vehicle| vehicle.order == Order::Free)
    {
        let text = format!(
            "{}: `order: free`: only routes in a fixed order are certified",
            vehicle.id
        );
        return Err(Failure::new(Failure::INPUT, text));
    }
    if !file.spec.tasks.is_empty() {
        let text = "`tasks`: only the routes of a spec without tasks are certified";
        return Err(Failure::new(Failure::INPUT, text.to_owned()));
    }
    let hash = folder::sha256(&file.text);
    let plan = planned(&arguments.folder, &hash)?;
    let progress = Progress::start();
    let vehicles = chosen.iter().map(|&index| {
        let id = &spec.vehicles[index].id;
        let say = |share: f64| progress.say(&format!("{id}: {:.0} %", 100.0 * share));
        say(0.0);
        (index, certify(spec, &world, index, arguments.cells, &say))
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
