//! The shipped simulator missions against real autopilots, for whoever has them:
//! `SORTIE_ARDUPILOT_SITL` names an `arducopter` binary, `SORTIE_PX4_SITL` the `px4`
//! of a build folder (`build/px4_sitl_default/bin/px4`). Without them nothing is done.

use crate::support::{lossy_proxy, ports, transfers};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use lossy_proxy::{LossyProxy, Radio};
use sortie::link::{Job, Verdict, download, upload_fleet};
use sortie::mission::VehicleMission;
use sortie::spec::{Autopilot, Link};
use tempfile::TempDir;
use transfers::{corner, rally, waypoint};

/// Three instances; they end when this is dropped.
struct Simulators {
    children: Vec<Child>,
    /// Where they keep their files; removed after them.
    _folder: TempDir,
}

impl Drop for Simulators {
    fn drop(&mut self) {
        for child in &mut self.children {
            // Already gone is as good.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The binary that a variable names, or a line that says why nothing is done.
#[allow(clippy::print_stdout)]
fn binary(variable: &str) -> Option<PathBuf> {
    let path = std::env::var_os(variable).map(PathBuf::from);
    if path.is_none() {
        println!("skipped: {variable} names no simulator");
    }
    path
}

fn start(instances: impl Fn(usize, &Path) -> Command) -> Simulators {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let children = (0..3).map(|n| {
        let own = folder.path().join(n.to_string());
        std::fs::create_dir(&own).expect("a folder for each");
        instances(n, &own)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the simulator starts")
    });
    Simulators {
        children: children.collect(),
        _folder: folder,
    }
}

fn plan_and_upload(mission: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("missions")
        .join(mission);
    let output = Command::new(cargo_bin("sortie"))
        .current_dir(&folder)
        .arg("plan")
        .arg(spec)
        .arg("--upload")
        .output()
        .expect("sortie runs");
    let told = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}{errors}");
}

/// One simulated copter that speaks over UDP to a port of this machine.
/// Its system id is one more than the last digit of its instance.
fn arducopter(binary: &Path, instance: usize, own: &Path, port: u16, home: &str) -> Command {
    let mut command = Command::new(binary);
    command
        .current_dir(own)
        .args(["--model", "quad", "-I", &instance.to_string()])
        .args(["--sysid", &(instance % 10 + 1).to_string()])
        .args(["--serial0", &format!("udpclient:127.0.0.1:{port}")])
        .args(["--home", home]);
    command
}

#[test]
fn three_ardupilot_copters_hold_their_missions() {
    let Some(binary) = binary("SORTIE_ARDUPILOT_SITL") else {
        return;
    };
    let _copters = start(|n, own| {
        let port = [14550, 14560, 14570][n];
        let latitude = ["-35.3633", "-35.3670", "-35.3707"][n];
        arducopter(&binary, n, own, port, &format!("{latitude},149.1600,584,0"))
    });
    plan_and_upload("sitl-ardupilot.yaml");
}

/// Items, a fence and rally points, different for each of three.
fn loads() -> Vec<VehicleMission> {
    let missions = (0..3).map(|n| VehicleMission {
        fence: [0, 5000, -3000].map(|k| corner(k + n, 3)).to_vec(),
        rally: vec![rally(n)],
        ..transfers::mission(
            Autopilot::ArduPilot,
            (1..=60).map(|k| waypoint(k + 1000 * n)).collect(),
        )
    });
    missions.collect()
}

/// Instances from `first` on: their TCP ports must differ from those of other tests.
#[allow(clippy::print_stdout)]
fn loaded_through_a_radio_that_loses(percent: u32, first: usize) {
    let Some(binary) = binary("SORTIE_ARDUPILOT_SITL") else {
        return;
    };
    let grounds: Vec<SocketAddr> = (0..3).map(|_| ports::unshared()).collect();
    let radios: Vec<LossyProxy> = (1..)
        .zip(&grounds)
        .map(|(seed, ground)| LossyProxy::to(*ground, Radio::losing(percent, seed)))
        .collect();
    let _copters = start(|n, own| {
        let port = radios[n].near.port();
        arducopter(&binary, first + n, own, port, "36.3,-84.25,400,0")
    });
    let links: Vec<Link> = grounds.iter().map(|g| Link::UdpIn(g.to_string())).collect();
    let missions = loads();
    let jobs: Vec<Job<'_>> = (1..=3)
        .zip(missions.iter().zip(&links))
        .map(|(sysid, (mission, link))| Job {
            vehicle: "one of three",
            sysid,
            link,
            mission,
            force: false,
        })
        .collect();
    let reports = upload_fleet(&jobs, &|_, _| {});
    for ((n, report), mission) in (0..).zip(&reports).zip(&missions) {
        println!(
            "{percent} % system {}: {:?}, {:.1} s, {} starts, {} repeats",
            n + 1,
            report.verdict,
            report.seconds,
            report.attempts,
            report.retries
        );
        assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
        // Once more, on a line of its own that loses nothing.
        let line = Link::Tcp(format!("127.0.0.1:{}", 5762 + 10 * (first + n)));
        let held = download(&line, Some(report.sysid), &|_, _| {}).expect("it is there");
        let places = |items: &[sortie::mission::Item]| -> Vec<(i32, i32)> {
            items.iter().map(|item| (item.x, item.y)).collect()
        };
        assert_eq!(places(&held.mission), places(&mission.items));
        assert_eq!(places(&held.fence), places(&mission.fence));
        assert_eq!(places(&held.rally), places(&mission.rally));
    }
}

#[test]
fn three_ardupilot_copters_hold_60_items_at_15_percent_loss_each_way() {
    loaded_through_a_radio_that_loses(15, 10);
}

#[test]
fn three_ardupilot_copters_hold_60_items_at_25_percent_loss_each_way() {
    loaded_through_a_radio_that_loses(25, 20);
}

#[test]
fn three_px4_quadrotors_hold_their_missions() {
    let Some(binary) = binary("SORTIE_PX4_SITL") else {
        return;
    };
    let build = binary
        .parent()
        .and_then(Path::parent)
        .expect("a build folder");
    let _quadrotors = start(|n, own| {
        let mut command = Command::new(&binary);
        command
            .current_dir(own)
            .arg("-i")
            .arg(n.to_string())
            .arg("-d")
            .arg(build.join("etc"))
            .env("PX4_SIM_MODEL", "sihsim_quadx")
            .env("PX4_HOME_LAT", ["47.3977", "47.3940", "47.3903"][n])
            .env("PX4_HOME_LON", "8.5450")
            .env("PX4_HOME_ALT", "488");
        command
    });
    plan_and_upload("sitl-px4.yaml");
}
