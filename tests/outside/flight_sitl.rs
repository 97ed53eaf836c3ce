//! Missions flown by real autopilots, for whoever has them: `SORTIE_ARDUPILOT_SITL` names the
//! `arducopter` binary of a built source tree, `SORTIE_ARDUPLANE_SITL` the `arduplane` one; the
//! tree has the parameters that the simulator starts with. `SORTIE_PX4_SITL` names the `px4` of a
//! build folder (`build/px4_sitl_default/bin/px4`). Without them nothing is done.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;

use assert_cmd::cargo::cargo_bin;

/// Whoever holds it has the ports of the simulators.
static PORTS: Mutex<()> = Mutex::new(());

/// Simulators that end when this is dropped.
struct Simulators(Vec<Child>);

impl Drop for Simulators {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // Already gone is as good.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[allow(clippy::print_stdout)]
fn binary(variable: &str) -> Option<PathBuf> {
    let path = std::env::var_os(variable).map(PathBuf::from);
    if path.is_none() {
        println!("skipped: {variable} names no simulator");
    }
    path.map(|path| std::path::absolute(path).expect("a path"))
}

/// What ArduPilot's own start script gives a vehicle; without it the simulator does not fly.
fn defaults(binary: &Path, parameters: &str) -> PathBuf {
    let parameters = &format!("Tools/autotest/{parameters}");
    let mut above = binary.ancestors().map(|folder| folder.join(parameters));
    let found = above.find(|path| path.is_file());
    found.unwrap_or_else(|| panic!("no {parameters} above {}", binary.display()))
}

/// A simulator of its own for each: its model, where it stands and how it points, its parameters.
fn start(folder: &Path, binary: &Path, vehicles: &[(&str, &str, &str)]) -> Simulators {
    let all = vehicles.iter().enumerate();
    let started = all.map(|(n, (model, home, parameters))| {
        let own = folder.join(n.to_string());
        std::fs::create_dir(&own).expect("a folder for each");
        let port = 14550 + 10 * n;
        Command::new(binary)
            .current_dir(own)
            .args(["--model", model, "--speedup", "5", "-I", &n.to_string()])
            .arg("--defaults")
            .arg(defaults(binary, parameters))
            .args(["--sysid", &(n + 1).to_string()])
            .args(["--serial0", &format!("udpclient:127.0.0.1:{port}")])
            .args(["--home", home])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the simulator starts")
    });
    Simulators(started.collect())
}

/// PX4's own simulator of a quadrotor for each place, three times as fast as the clock. Instance
/// `n` has system id `n + 1`, and all speak to UDP port 14550.
fn start_px4(folder: &Path, binary: &Path, places: &[[&str; 2]], amsl_m: &str) -> Simulators {
    let build = binary.ancestors().nth(2).expect("a build folder");
    let started = places.iter().enumerate().map(|(n, [latitude, longitude])| {
        let own = folder.join(n.to_string());
        std::fs::create_dir(&own).expect("a folder for each");
        Command::new(binary)
            .current_dir(own)
            .args(["-i", &n.to_string(), "-d"])
            .arg(build.join("etc"))
            .env("PX4_SIMULATOR", "sihsim")
            .env("PX4_SIM_MODEL", "sihsim_quadx")
            .env("PX4_SIM_SPEED_FACTOR", "3")
            .env("PX4_HOME_LAT", latitude)
            .env("PX4_HOME_LON", longitude)
            .env("PX4_HOME_ALT", amsl_m)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the simulator starts")
    });
    Simulators(started.collect())
}

fn sortie(folder: &Path, spec: &Path, arguments: &[&str]) {
    let (command, rest) = arguments.split_first().expect("a command");
    let output = Command::new(cargo_bin("sortie"))
        .current_dir(folder)
        .arg(command)
        .arg(spec)
        .args(rest)
        .output()
        .expect("sortie runs");
    let told = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}{errors}");
}

const FLY: [&str; 5] = ["fly", "--upload", "--set-params", "--speedup", "5"];

#[test]
fn three_ardupilot_copters_fly_their_missions_and_the_limits_hold() {
    let Some(binary) = binary("SORTIE_ARDUPILOT_SITL") else {
        return;
    };
    let _ports = PORTS.lock();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let parameters = "default_params/copter.parm";
    let copters = [
        ("quad", "-35.3633,149.1600,584,0", parameters),
        ("quad", "-35.3670,149.1600,584,0", parameters),
        ("quad", "-35.3707,149.1600,584,0", parameters),
    ];
    let _copters = start(folder.path(), &binary, &copters);
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/sitl-ardupilot.yaml");
    sortie(folder.path(), &spec, &["plan"]);
    sortie(folder.path(), &spec, &FLY);
}

/// Two planes, of which the second waits for its departure and circles in the end, and a
/// QuadPlane.
const WINGS: &str = "
sortie: 1
name: sitl-wings
area: {south_west: {lat: -35.390, lon: 149.130}, north_east: {lat: -35.330, lon: 149.215}, min_agl_m: 40, max_amsl_m: 784}
terrain: {flat: {amsl_m: 584}}
threats: [{id: mast, kind: mast, lat: -35.3668, lon: 149.1760, radius_m: 250}]
vehicles:
  - {id: heron, sysid: 1, autopilot: ardupilot, airframe: plane, link: 'udpin:127.0.0.1:14550', speed_mps: 18,
     home: {lat: -35.3633, lon: 149.1500}, takeoff_heading_deg: 90, loiter_radius_m: 80, climb_mps: 4, descent_mps: 3,
     start: {lat: -35.3633, lon: 149.1620, agl_m: 80}, goal: {lat: -35.3633, lon: 149.1950, agl_m: 80},
     landing: {heading_deg: 90, glide_deg: 6}, max_climb_deg: 10, max_descent_deg: 8, finish: land}
  - {id: egret, sysid: 2, autopilot: ardupilot, airframe: plane, link: 'udpin:127.0.0.1:14560', speed_mps: 18,
     home: {lat: -35.3700, lon: 149.1500}, takeoff_heading_deg: 90, loiter_radius_m: 80, climb_mps: 4, descent_mps: 3,
     start: {lat: -35.3700, lon: 149.1620, agl_m: 80}, goal: {lat: -35.3700, lon: 149.1900, agl_m: 80},
     max_climb_deg: 10, max_descent_deg: 8, finish: loiter, depart_s: 40}
  - {id: osprey, sysid: 3, autopilot: ardupilot, airframe: vtol, link: 'udpin:127.0.0.1:14570', speed_mps: 18,
     start: {lat: -35.3767, lon: 149.1600, agl_m: 80}, goal: {lat: -35.3767, lon: 149.1900, agl_m: 80},
     loiter_radius_m: 80, climb_mps: 3, descent_mps: 2.5, max_climb_deg: 10, max_descent_deg: 8, finish: land}
separation: {distance_m: 150, time_slack_s: 10}
";

#[test]
fn three_ardupilot_wings_fly_their_missions_and_the_limits_hold() {
    let Some(binary) = binary("SORTIE_ARDUPLANE_SITL") else {
        return;
    };
    let _ports = PORTS.lock();
    let (folder, spec) = planned("wings.yaml", WINGS);
    let plane = "models/plane.parm";
    let wings = [
        ("plane", "-35.3633,149.1500,584,90", plane),
        ("plane", "-35.3700,149.1500,584,90", plane),
        (
            "quadplane",
            "-35.3767,149.1600,584,0",
            "default_params/quadplane.parm",
        ),
    ];
    let _wings = start(folder.path(), &binary, &wings);
    sortie(folder.path(), &spec, &FLY);
}

/// A folder with a spec and its plan.
fn planned(name: &str, spec: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join(name);
    std::fs::write(&file, spec).expect("a spec");
    sortie(folder.path(), &file, &["plan"]);
    (folder, file)
}

/// Three PX4 quadrotors whose ways cross, of which one stays in the air, one waits on the ground
/// for its departure, and all fly no faster than the drag of their simulator lets them (9.8 m/s).
const PX4: &str = "
sortie: 1
name: sitl-px4-cross
area: {south_west: {lat: 47.385, lon: 8.535}, north_east: {lat: 47.405, lon: 8.560}, min_agl_m: 25, max_amsl_m: 608}
terrain: {flat: {amsl_m: 488}}
threats: [{id: mast, kind: mast, lat: 47.3958, lon: 8.5475, radius_m: 60}]
mission: {altitude: relative}
vehicles:
  - {id: east, sysid: 1, autopilot: px4, link: 'udpin:127.0.0.1:14550', speed_mps: 8, finish: land,
     start: {lat: 47.3940, lon: 8.5430, agl_m: 40}, goal: {lat: 47.3940, lon: 8.5520, agl_m: 40}}
  - {id: north, sysid: 2, autopilot: px4, link: 'udpin:127.0.0.1:14550', speed_mps: 8, finish: loiter,
     start: {lat: 47.3910, lon: 8.5475, agl_m: 40}, goal: {lat: 47.3970, lon: 8.5475, agl_m: 40}}
  - {id: south, sysid: 3, autopilot: px4, link: 'udpin:127.0.0.1:14550', speed_mps: 7, finish: land, depart_s: 15,
     start: {lat: 47.3965, lon: 8.5490, agl_m: 40}, goal: {lat: 47.3910, lon: 8.5450, agl_m: 50}}
separation: {distance_m: 50, time_slack_s: 6}
";

#[test]
fn three_px4_copters_fly_their_missions_and_the_limits_hold() {
    let Some(binary) = binary("SORTIE_PX4_SITL") else {
        return;
    };
    let _ports = PORTS.lock();
    let (folder, spec) = planned("cross.yaml", PX4);
    let places = [
        ["47.3940", "8.5430"],
        ["47.3910", "8.5475"],
        ["47.3965", "8.5490"],
    ];
    let _copters = start_px4(folder.path(), &binary, &places, "488");
    let fly = ["fly", "--upload", "--set-params", "--speedup", "3"];
    sortie(folder.path(), &spec, &fly);
    // The exit code has it already: said once more of what the test is named after.
    let told = folder.path().join("out/sitl-px4-cross.runs/flight.json");
    let told = std::fs::read_to_string(told).expect("a record of the flight");
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let margins = told["margins"].as_array().expect("margins");
    let apart = margins
        .iter()
        .filter(|margin| margin["what"] == "separation");
    let apart: Vec<f64> = apart
        .filter_map(|margin| margin["value"].as_f64())
        .collect();
    assert_eq!(apart.len(), 3);
    assert!(apart.iter().all(|apart_m| *apart_m >= 50.0), "{apart:?}");
}
