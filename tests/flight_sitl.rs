//! The shipped simulator mission flown by real ArduPilot, for whoever has it:
//! `SORTIE_ARDUPILOT_SITL` names the `arducopter` binary of a built source tree, which has
//! the parameters that the simulator starts with. Without it nothing is done.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use assert_cmd::cargo::cargo_bin;

/// Simulators that end when this is dropped.
struct Copters(Vec<Child>);

impl Drop for Copters {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // Already gone is as good.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[allow(clippy::print_stdout)]
fn binary() -> Option<PathBuf> {
    let path = std::env::var_os("SORTIE_ARDUPILOT_SITL").map(PathBuf::from);
    if path.is_none() {
        println!("skipped: SORTIE_ARDUPILOT_SITL names no simulator");
    }
    path
}

/// What ArduPilot's own start script gives a copter; without it the simulator does not fly.
fn defaults(binary: &Path) -> PathBuf {
    let parameters = "Tools/autotest/default_params/copter.parm";
    let mut above = binary.ancestors().map(|folder| folder.join(parameters));
    let found = above.find(|path| path.is_file());
    found.unwrap_or_else(|| panic!("no {parameters} above {}", binary.display()))
}

fn sortie(folder: &Path, arguments: &[&str]) {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/sitl-ardupilot.yaml");
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

#[test]
fn three_ardupilot_copters_fly_their_missions_and_the_limits_hold() {
    let Some(binary) = binary() else { return };
    let binary = std::path::absolute(binary).expect("a path");
    let defaults = defaults(&binary);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let latitudes = ["-35.3633", "-35.3670", "-35.3707"];
    let copters = latitudes.iter().enumerate().map(|(n, latitude)| {
        let own = folder.path().join(n.to_string());
        std::fs::create_dir(&own).expect("a folder for each");
        let port = 14550 + 10 * n;
        Command::new(&binary)
            .current_dir(own)
            .args(["--model", "quad", "--speedup", "5", "-I", &n.to_string()])
            .arg("--defaults")
            .arg(&defaults)
            .args(["--sysid", &(n + 1).to_string()])
            .args(["--serial0", &format!("udpclient:127.0.0.1:{port}")])
            .args(["--home", &format!("{latitude},149.1600,584,0")])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the simulator starts")
    });
    let _copters = Copters(copters.collect());
    sortie(folder.path(), &["plan"]);
    sortie(
        folder.path(),
        &["fly", "--upload", "--set-params", "--speedup", "5"],
    );
}
