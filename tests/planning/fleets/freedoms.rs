//! Laws of freedoms: departures, speeds and heights that a spec leaves open never make a fleet
//! dearer.

use sortie::dispatch::dispatch;
use sortie::spec::{MissionSpec, Span};
use sortie::world::World;

use super::conflicts::read;
use crate::support::{copter, empty_spec, place, world};

/// Evaluations of each plan.
const EVALUATIONS: usize = 600;
/// What gives a fleet a freedom.
type Freedom = fn(&mut MissionSpec);
/// Largest fleet that gets several freedoms at once: a crowd is planned for long.
const SMALL: usize = 8;

/// Copters on a circle, each with its goal opposite of its start, and none of them even.
fn circle(count: u8) -> MissionSpec {
    let vehicles = (0..count).map(|number| {
        let angle = std::f64::consts::TAU * f64::from(number) / f64::from(count);
        let at = |angle: f64| place(36.30 + 0.018 * angle.sin(), -84.25 + 0.022 * angle.cos());
        let opposite = angle + std::f64::consts::PI + 0.1 * f64::from(number % 3);
        copter(&format!("v{number}"), number + 1, at(angle), at(opposite))
    });
    empty_spec(vehicles.collect())
}

/// Violated limits and the cost of a fleet.
fn planned(spec: &MissionSpec, world: &World) -> (usize, f64) {
    let found = dispatch(spec, world, 3, &|_| ());
    let broken = found.review.margins.iter().filter(|margin| !margin.ok);
    (broken.count(), found.plan.cost())
}

#[test]
fn a_freedom_never_makes_a_fleet_dearer() {
    let freedoms: [(&str, Freedom); 3] = [
        ("departures", |spec| {
            for vehicle in &mut spec.vehicles {
                let (least, most) = (vehicle.depart_s, vehicle.depart_s + 45.0);
                vehicle.retiming.depart_s = Some(Span { least, most });
            }
        }),
        ("speeds", |spec| {
            for vehicle in &mut spec.vehicles {
                let (least, most) = (0.8 * vehicle.speed_mps, 1.2 * vehicle.speed_mps);
                vehicle.retiming.speed_mps = Some(Span { least, most });
            }
        }),
        ("heights", |spec| spec.separation.vertical_m = Some(25.0)),
    ];
    let shipped = ["crossing", "head-on"];
    let mut problems: Vec<(String, MissionSpec)> = (shipped.iter())
        .map(|name| ((*name).to_owned(), read(name).spec))
        .collect();
    problems.push(("circle of 4".to_owned(), circle(4)));
    problems.push(("circle of 9".to_owned(), circle(9)));
    for (name, mut spec) in problems {
        spec.planner.evaluations = EVALUATIONS;
        let world = world(&spec);
        // With none, then with one more each time.
        let mut before = planned(&spec, &world);
        for (freedom, give) in freedoms {
            let mut alone = spec.clone();
            give(&mut alone);
            let now = planned(&alone, &world);
            assert!(
                now <= before,
                "{name}, {freedom}: {now:?}, before {before:?}"
            );
            if spec.vehicles.len() > SMALL {
                continue;
            }
            give(&mut spec);
            let now = planned(&spec, &world);
            assert!(
                now <= before,
                "{name}, with {freedom}: {now:?}, before {before:?}"
            );
            before = now;
        }
    }
}
