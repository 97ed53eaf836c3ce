//! The shipped simulator missions against real autopilots, for whoever has them:
//! `SORTIE_ARDUPILOT_SITL` names an `arducopter` binary, `SORTIE_PX4_SITL` the `px4`
//! of a build folder (`build/px4_sitl_default/bin/px4`). Without them nothing is done.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use tempfile::TempDir;

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

#[test]
fn three_ardupilot_copters_hold_their_missions() {
    let Some(binary) = binary("SORTIE_ARDUPILOT_SITL") else {
        return;
    };
    let _copters = start(|n, own| {
        let mut command = Command::new(&binary);
        let latitude = ["-35.3633", "-35.3670", "-35.3707"][n];
        command
            .current_dir(own)
            .args(["--model", "quad", "-I", &n.to_string()])
            .args(["--sysid", &(n + 1).to_string()])
            .args([
                "--serial0",
                &format!("udpclient:127.0.0.1:{}", 14550 + 10 * n),
            ])
            .args(["--home", &format!("{latitude},149.1600,584,0")]);
        command
    });
    plan_and_upload("sitl-ardupilot.yaml");
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
