"""Real simulators of autopilots, each a process of its own on loopback."""

import pathlib
import re
import subprocess

# Model, the parameters in ArduPilot's tree that the simulator starts with.
ARDUPILOT = {
    "copter": ("quad", "default_params/copter.parm"),
    "zigzag": ("quad", "default_params/copter.parm"),
    "plane": ("plane", "models/plane.parm"),
    "plane-land": ("plane", "models/plane.parm"),
    "quadplane": ("quadplane", "default_params/quadplane.parm"),
}
# The whole wind from 10 m on, none on the ground, as below trees. One estimator instead of two: the same flight in less time.
OWN = """SIM_WIND_SPD {speed_mps}
SIM_WIND_DIR {from_deg}
SIM_WIND_TURB {turbulence}
SIM_WIND_T 0
SIM_WIND_T_ALT 10
EK3_IMU_MASK 1
LOG_FILE_DSRMROT 0
"""


def in_tree(binary, name):
    """A file of the source tree that a binary was built in."""
    for folder in pathlib.Path(binary).resolve().parents:
        if (folder / "Tools/autotest" / name).is_file():
            return folder / "Tools/autotest" / name
    raise FileNotFoundError(f"no Tools/autotest/{name} above {binary}")


def ardupilot(binary, kind, folder, instance, at, wind, speedup, sysid=1, more=""):
    """Starts one; it speaks to UDP port 14550 + 10 * instance."""
    folder.mkdir(parents=True, exist_ok=True)
    model, parameters = ARDUPILOT[kind]
    own = folder / "own.parm"
    own.write_text(OWN.format(**{"turbulence": 0, **wind}) + more)
    port = 14550 + 10 * instance
    lat, lon, amsl_m, heading_deg = at
    command = [
        pathlib.Path(binary).resolve(), "--model", model, "--speedup", speedup, "-I", instance, "--sysid", sysid,
        "--defaults", f"{in_tree(binary, parameters)},{own.resolve()}",
        "--serial0", f"udpclient:127.0.0.1:{port}", "--home", f"{lat:.7f},{lon:.7f},{amsl_m},{heading_deg}",
    ]
    with open(folder / "simulator.txt", "w") as log:
        child = subprocess.Popen([str(part) for part in command], cwd=folder, stdin=subprocess.DEVNULL, stdout=log,
                                 stderr=subprocess.STDOUT)
    return child, f"udpin:127.0.0.1:{port}"


def end(child):
    child.kill()
    child.wait()


def version(messages):
    """The firmware that a log names, such as `ArduCopter V4.7.0-dev`."""
    for message in messages:
        found = re.search(r"Ardu\w+ V\S+", message)
        if found:
            return found.group(0)
    return "unknown"
