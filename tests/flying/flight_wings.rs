//! Planes and VTOL flown: the shipped missions as an operator flies them, and what is done with
//! wings in flight, in virtual time against simulated vehicles.

use crate::support;
use crate::support::sky;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;

use sky::{Planned, Sky, plan, plan_shipped, plan_spec};
use sortie::flight::*;
use sortie::spec::*;
use sortie::verify::{Flown, Limit, verified_trajectories};
use support::place;

fn missions() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions")
}

fn sortie(arguments: &[&str], spec: &Path, out: &Path) -> Child {
    let (command, rest) = arguments.split_first().expect("a command");
    Command::new(assert_cmd::cargo::cargo_bin("sortie"))
        .args([command, &"--json"])
        .args(rest)
        .arg(out)
        .arg(spec)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("sortie starts")
}

/// What a run that ended well printed.
fn well(child: Child, spec: &Path) -> Output {
    let output = child.wait_with_output().expect("sortie runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}: {told}{}",
        spec.display(),
        String::from_utf8_lossy(&output.stdout)
    );
    output
}

/// The shipped missions with a wing, and how they end.
const SHIPPED: [(&str, &str); 4] = [
    ("plane-ardupilot", "landed"),
    ("plane-px4", "landed"),
    ("vtol-ardupilot", "landed"),
    ("vtol-px4", "loiters"),
];

#[test]
fn every_shipped_wing_flies_its_mission_and_its_limits_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let shipped = SHIPPED.map(|(name, _)| missions().join(name).with_extension("yaml"));
    let out = |spec: &Path| folder.path().join(spec.file_stem().expect("a name"));
    for spec in &shipped {
        well(sortie(&["plan", "--out"], spec, &out(spec)), spec);
    }
    let fly = |spec: &Path| sortie(&["fly", "--speedup", "30", "--dir"], spec, &out(spec));
    let flying: Vec<Child> = shipped.iter().map(|spec| fly(spec)).collect();
    for ((child, spec), (_, end)) in flying.into_iter().zip(&shipped).zip(SHIPPED) {
        let flown = well(child, spec);
        let flown: Value = serde_json::from_slice(&flown.stdout).expect("flight.json");
        let vehicle = &flown["vehicles"][0];
        assert_eq!(flown["verdict"], "pass", "{flown}");
        assert_eq!(vehicle["end"], end, "{flown}");
        // Real ArduPlane was 32 m beside the first of these ways, and within 3 m on 95 % of it.
        let beside = &vehicle["cross_track_m"];
        assert!(beside["worst"].as_f64() < Some(40.0), "{vehicle}");
        assert!(beside["p95"].as_f64() < Some(5.0), "{vehicle}");
        assert!(vehicle["altitude_error_m"]["worst"].as_f64() < Some(15.0));
        let passed = vehicle["waypoints"].as_array().expect("waypoints");
        assert!(passed.len() > 10, "{vehicle}");
        // An approach is slower than the way before it.
        for passage in &passed[..passed.len() - 1] {
            let late_s = passage["late_s"].as_f64().expect("a time");
            assert!(late_s.abs() < 30.0, "{}: {passage}", spec.display());
        }
    }
}

#[test]
fn every_shipped_wing_flies_its_mission_in_wind_too() {
    for (name, end) in SHIPPED {
        let plan = plan_shipped(name, |spec| {
            let vehicle = &spec.vehicles[0];
            let most = vehicle.facts().behaviour.max_wind_mps.of(None);
            // With wider turns the QuadPlane would be over higher ground after its climb.
            let radius_m = match vehicle.airframe {
                Airframe::Vtol => 90.0,
                _ => 100.0,
            };
            spec.wind = Some(Wind {
                from_rad: 240_f64.to_radians(),
                // The verdict fails a QuadPlane in more than 4.
                speed_mps: most.map_or(5.0, |most| most.value.min(5.0)),
            });
            spec.vehicles[0].wind = spec.wind;
            let wing = spec.vehicles[0].wing.as_mut().expect("a wing");
            wing.loiter_radius_m = radius_m;
            // As in a file: a VTOL that lands does so into the wind.
            let into_wind = Landing {
                heading_rad: None,
                glide_rad: 0.0,
            };
            wing.landing = wing.landing.or(Some(into_wind));
        });
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let report = plan.judge(&sky);
        assert!(report.passes(), "{name}: {report:#?}");
        assert_eq!(report.vehicles[0].end, end);
        // What a ground station captured of it says the same.
        let (_, mission) = &plan.dispatched.missions[0];
        let capture = Capture {
            vehicle: plan.spec.vehicles[0].id.clone(),
            sysid: plan.spec.vehicles[0].sysid,
            autopilot: mission.autopilot,
            airframe: mission.airframe,
            plan: plan.record(&sky).flights[0].plans[0].clone(),
        };
        let captured = read_tlog(&sky.capture, &[capture]).expect("a capture");
        let again = judge(&plan.spec, &plan.world, &captured);
        assert!(again.passes(), "{name}: {again:#?}");
        assert_eq!(again.vehicles[0].end, end);
    }
}

#[test]
fn wings_circle_at_their_stops_for_their_time() {
    for (autopilot, airframe) in support::wings::KINDS {
        let mut spec = support::wings::wing_with_stops(autopilot, airframe);
        spec.vehicles[0].stops[1].hold_s = 40.0;
        spec.vehicles[0].stops[1].actions = vec![StopAction::Photo];
        let middle = spec.vehicles[0].stops[1].end.place;
        let plan = plan_spec(spec);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let report = plan.judge(&sky);
        assert!(report.passes(), "{autopilot} {airframe}: {report:#?}");
        assert!(sky.says("heron", "picture 2"), "{:?}", sky.events);
        let (_, flown) = sky.fleet.flown().next().expect("flown");
        let radius_m = plan.spec.vehicles[0].wing.expect("a wing").loiter_radius_m;
        let around = flown.fixes.iter();
        let around =
            around.filter(|fix| (fix.place.chord_m(middle) - radius_m).abs() < 0.3 * radius_m);
        let times: Vec<f64> = around.map(|fix| fix.t_s).collect();
        let stays_s = times[times.len() - 1] - times[0];
        assert!(
            (40.0..110.0).contains(&stays_s),
            "{autopilot} {airframe}: {stays_s}"
        );
    }
}

#[test]
fn wings_fly_past_their_stops() {
    for (autopilot, airframe) in support::wings::KINDS {
        let plan = plan_spec(support::wings::wing_with_stops(autopilot, airframe));
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let report = plan.judge(&sky);
        assert!(report.passes(), "{autopilot} {airframe}: {report:#?}");
        assert_eq!(report.vehicles[0].end, "landed");
        let (_, flown) = sky.fleet.flown().next().expect("flown");
        let mut since_s = 0.0;
        for (stop, point) in (plan.spec.vehicles[0].stops.iter()).zip(&plan.world.sites[0].stops) {
            let after = flown.fixes.iter().filter(|fix| fix.t_s > since_s);
            let away = |fix: &Fix| {
                fix.place
                    .chord_m(stop.end.place)
                    .hypot(fix.amsl.0 - point.amsl.0)
            };
            let nearest = after
                .min_by(|a, b| away(a).total_cmp(&away(b)))
                .expect("positions");
            // Positions come twice a second.
            assert!(
                away(nearest) < 25.0,
                "{autopilot} {airframe} {}: {}",
                stop.id,
                away(nearest)
            );
            since_s = nearest.t_s;
        }
        assert!(sky.says("heron", "picture 1 (stop t1)"), "{:?}", sky.events);
    }
}

#[test]
fn wings_take_a_picture_at_their_goal_before_they_land_or_circle() {
    for (autopilot, airframe) in support::wings::KINDS {
        for finish in [Finish::Land, Finish::Loiter] {
            let mut spec = support::wings::wing_with_stops(autopilot, airframe);
            let vehicle = &mut spec.vehicles[0];
            vehicle.finish = finish;
            vehicle.stops.truncate(1);
            // A circle is flown up to 6 m off its height.
            vehicle.goal.altitude = Placement::Agl(sortie::geodesy::Agl(100.0));
            vehicle.on_way.goal = vec![StopAction::Photo];
            let plan = plan_spec(spec);
            let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
            assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
            let report = plan.judge(&sky);
            assert!(
                report.passes(),
                "{autopilot} {airframe} {finish:?}: {report:#?}"
            );
            assert!(
                sky.says("heron", "picture 2"),
                "{autopilot} {airframe} {finish:?}: {:?}",
                sky.events
            );
        }
    }
}

/// Takes off eastward, flies 3 km east, and lands eastward or circles.
fn plane(id: &str, sysid: u8, autopilot: Autopilot, lat: f64) -> Vehicle {
    Vehicle {
        autopilot,
        home: place(lat, -84.30),
        ..support::plane(id, sysid, place(lat, -84.28), place(lat, -84.245))
    }
}

fn vtol(id: &str, sysid: u8, autopilot: Autopilot, lat: f64) -> Vehicle {
    support::vtol(plane(id, sysid, autopilot, lat))
}

/// Both airframes on both autopilots, a kilometre apart; the planes land, and so on.
fn four() -> Vec<Vehicle> {
    vec![
        plane("heron", 1, Autopilot::ArduPilot, 36.29),
        plane("gannet", 2, Autopilot::Px4, 36.30),
        vtol("osprey", 3, Autopilot::ArduPilot, 36.31),
        vtol("kestrel", 4, Autopilot::Px4, 36.32),
    ]
}

fn ends<'a>(plan: &Planned, sky: &Sky<'a>) -> Vec<String> {
    let report = plan.judge(sky);
    report.vehicles.iter().map(|v| v.end.clone()).collect()
}

/// A QuadPlane, planned alone in a wind from the west.
fn lone_quadplane(wind_mps: f64) -> Planned {
    let mut vehicle = vtol("osprey", 1, Autopilot::ArduPilot, 36.31);
    let wind = Some(Wind {
        from_rad: 1.5 * PI,
        speed_mps: wind_mps,
    });
    vehicle.wind = wind;
    let wing = vehicle.wing.as_mut().expect("a wing");
    wing.loiter_radius_m = 120.0;
    // Into the wind.
    wing.landing = Some(Landing {
        heading_rad: None,
        glide_rad: 0.0,
    });
    let mut spec = support::empty_spec(vec![vehicle]);
    (spec.wind, spec.planner.evaluations) = (wind, 1000);
    plan_spec(spec)
}

/// How far behind its takeoff the verdict judges a vehicle, metres.
fn judged_behind_m(plan: &Planned) -> f64 {
    let missions = plan.dispatched.missions.iter();
    let missions: Vec<_> = missions.map(|(index, of)| (*index, of)).collect();
    let judged = verified_trajectories(&plan.spec, &plan.world, &missions);
    let home = plan.world.frame.to_plan(plan.spec.vehicles[0].home);
    let ends = judged[0].segments.iter().flat_map(|of| [of.from, of.to]);
    ends.map(|end| home.east_m - plan.world.frame.to_plan(end.place).east_m)
        .fold(0.0, f64::max)
}

/// A QuadPlane on its first leg, as far behind its takeoff as given: alarms of its corridor, and
/// whether the verdict on its flight so far has it beside its way.
fn off_behind(plan: &Planned, behind_m: f64) -> (Vec<String>, bool) {
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    let last = |sky: &Sky<'_>| {
        let flown = sky.fleet.flown().next().expect("a vehicle").1;
        flown.fixes.last().copied()
    };
    sky.fly_to(1.0);
    while last(&sky).is_none_or(|fix| fix.item <= 1) {
        sky.step();
    }
    sky.vehicles[0].fail(sortie::simulator::Fault::Jump {
        east_m: -behind_m,
        north_m: 0.0,
    });
    let at_s = sky.fleet.t_s(sky.now).expect("it flies");
    sky.fly_to(at_s + 2.0);
    let is_it = |event: &&Event| {
        let alarm = event.alarm.as_ref();
        alarm.is_some_and(|alarm| alarm.is_raised && alarm.kind == AlarmKind::Corridor)
    };
    let alarms = sky.events.iter().filter(is_it);
    let alarms = alarms.map(|event| event.text.clone()).collect();
    let report = plan.judge(&sky);
    let mut beside = report.margins.iter();
    let beside = beside.find(|margin| margin.limit == Limit::Flown(Flown::CrossTrack));
    (alarms, !beside.expect("judged").ok)
}

#[test]
fn a_quadplane_is_on_its_way_wherever_the_verdict_has_it_after_its_climb() {
    for wind_mps in [0.0, 4.0] {
        let plan = lone_quadplane(wind_mps);
        let judged_m = judged_behind_m(&plan);
        assert!(judged_m > 150.0, "{judged_m}");
        let (alarms, is_beside) = off_behind(&plan, judged_m - 5.0);
        assert!(alarms.is_empty() && !is_beside, "{wind_mps}: {alarms:?}");
        // As far outside as nothing keeps away from it.
        let (alarms, is_beside) = off_behind(&plan, judged_m + 40.0);
        assert_eq!(alarms.len(), 1, "{wind_mps}: {alarms:?}");
        assert!(alarms[0].contains("m beside its path"), "{alarms:?}");
        assert!(is_beside, "{wind_mps}");
    }
}

#[test]
fn wings_circle_where_they_are_told_to_hold() {
    let plan = plan(four(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(120.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(ends(&plan, &sky), ["held"; 4]);
    for (_, flown) in sky.fleet.flown() {
        let last = flown.fixes.last().expect("positions");
        assert!(last.speed_mps > 10.0, "a wing does not stop: {last:?}");
        let begin = flown.fixes.iter().find(|fix| fix.t_s > 120.0);
        let begin = begin.expect("positions");
        let away_m = begin.place.chord_m(last.place);
        assert!(away_m < 300.0, "{away_m}");
        assert!((last.amsl.0 - begin.amsl.0).abs() < 15.0, "{last:?}");
    }
}

#[test]
fn planes_told_to_land_fly_on_to_their_landing_and_vtol_come_down_where_they_are() {
    let plan = plan(four(), OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(120.0);
    sky.fleet.intervene(sky.now, Intervention::Hold);
    sky.fly_to(125.0);
    sky.fleet.intervene(sky.now, Intervention::Land);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let wanted = ["landed", "landed", "landed early", "landed early"];
    assert_eq!(ends(&plan, &sky), wanted, "{:?}", sky.events);
    assert!(sky.says("heron", "lands as planned"));
}

#[test]
fn a_plane_without_a_landing_circles_when_it_is_told_to_land() {
    let mut fleet = vec![plane("heron", 1, Autopilot::ArduPilot, 36.30)];
    fleet[0].finish = Finish::Loiter;
    let plan = plan(fleet, OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(100.0);
    sky.fleet.intervene(sky.now, Intervention::Land);
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    assert_eq!(ends(&plan, &sky), ["held"]);
    assert!(sky.says("heron", "has no landing"), "{:?}", sky.events);
}

#[test]
fn a_plane_whose_link_is_lost_flies_on_and_the_others_circle() {
    let plan = plan(four(), OnLinkLoss::HoldAll);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(100.0);
    sky.cut.push(1);
    sky.fly_to(160.0);
    assert!(sky.says("heron", "link lost"), "{:?}", sky.events);
    sky.cut.clear();
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let ends = ends(&plan, &sky);
    assert_eq!(ends[1..], ["held"; 3], "{:?}", sky.events);
    assert!(!plan.judge(&sky).passes());
}

#[test]
fn a_wind_that_nobody_told_of_drives_a_wing_into_a_threat_and_the_verdict_says_so() {
    // A turn to the north, flown in a wind that pushes it on to the east.
    let mut fleet = vec![plane("heron", 1, Autopilot::ArduPilot, 36.30)];
    fleet[0].goal.place = place(36.33, -84.28);
    if let Some(wing) = &mut fleet[0].wing
        && let Some(landing) = &mut wing.landing
    {
        landing.heading_rad = Some(0.0);
    }
    let mut plan = plan(fleet, OnLinkLoss::Continue);
    let fly = |plan: &Planned, wind: Option<Wind>| {
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles_in(wind));
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        (plan.judge(&sky), plan.record(&sky))
    };
    let (report, record) = fly(&plan, None);
    assert!(report.passes(), "{report:#?}");
    // Beyond the easternmost place of the turn.
    let fixes = &record.flights[0].flown.fixes;
    let in_turn = fixes.iter().filter(|fix| fix.place.lat_deg < 36.315);
    let turn = in_turn.max_by(|a, b| a.place.lon_deg.total_cmp(&b.place.lon_deg));
    let turn = plan.world.frame.to_plan(turn.expect("positions").place);
    let radius_m = 300.0;
    let center = sortie::geodesy::EastNorth {
        east_m: turn.east_m + radius_m + 10.0,
        ..turn
    };
    plan.world
        .threats
        .push(sortie::world::Disc { center, radius_m });
    plan.spec.threats.push(Threat {
        id: "mast".to_owned(),
        kind: "mast".to_owned(),
        place: plan.world.frame.from_plan(center),
        radius_m,
    });
    assert!(fly(&plan, None).0.passes());
    let (report, _) = fly(
        &plan,
        Some(Wind {
            from_rad: 1.5 * PI,
            speed_mps: 6.0,
        }),
    );
    let broken: Vec<_> = report.margins.iter().filter(|m| !m.ok).collect();
    assert_eq!(broken.len(), 1, "{broken:#?}");
    assert_eq!(broken[0].limit, Limit::Threat("mast".to_owned()));
    assert!(broken[0].value < -5.0, "{broken:#?}");
    assert!(!report.passes());
}

#[test]
fn a_simulated_arduplane_climbs_out_as_fast_as_the_real_one_whatever_is_planned() {
    // ArduPlane 4.6.3, 24 flights with 2.5 to 4 m/s planned: 9.3 to 10.4 m/s.
    let mut heron = plane("heron", 1, Autopilot::ArduPilot, 36.30);
    heron.climb_mps = 3.0;
    heron.home = place(36.30, -84.295);
    let plan = plan(vec![heron], OnLinkLoss::Continue);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let (_, flown) = sky.fleet.flown().next().expect("flown");
    let (home, start) = (plan.world.sites[0].home, plan.world.sites[0].start);
    let when_s = |amsl_m: f64| {
        let mut fixes = flown.fixes.iter();
        let above = fixes.find(|fix| fix.amsl.0 >= amsl_m);
        above.map(|fix| (fix.t_s, fix.amsl.0)).expect("it climbs")
    };
    let (off, up) = (when_s(home.amsl.0 + 5.0), when_s(start.amsl.0 - 10.0));
    let climb_mps = (up.1 - off.1) / (up.0 - off.0);
    assert!((8.0..11.0).contains(&climb_mps), "{climb_mps}");
    assert!(plan.judge(&sky).passes());
}
