//! Missions flown by real ArduPilot, for whoever has it: `SORTIE_ARDUPILOT_SITL` names the
//! `arducopter` binary of a built source tree, `SORTIE_ARDUPLANE_SITL` the `arduplane` one; the
//! tree has the parameters that the simulator starts with. Without them nothing is done.

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
    let folder = tempfile::tempdir().expect("a temporary folder");
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
    let spec = folder.path().join("wings.yaml");
    std::fs::write(&spec, WINGS).expect("a spec");
    sortie(folder.path(), &spec, &["plan"]);
    sortie(folder.path(), &spec, &FLY);
}
