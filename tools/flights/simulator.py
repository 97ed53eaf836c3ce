"""Real simulators of autopilots, each a process of its own on loopback."""

import math
import os
import pathlib
import re
import shutil
import subprocess
import time

from . import dataflash, ulog

# Model, the parameters in ArduPilot's tree that the simulator starts with.
ARDUPILOT = {
    "copter": ("quad", "default_params/copter.parm"),
    "zigzag": ("quad", "default_params/copter.parm"),
    "plane": ("plane", "models/plane.parm"),
    "plane-land": ("plane", "models/plane.parm"),
    "plane-turn": ("plane", "models/plane.parm"),
    "quadplane": ("quadplane", "default_params/quadplane.parm"),
}
# The numbers of PX4's airframes for its own simulator (SIH).
PX4 = {"px4-copter": 10040, "px4-plane": 10041, "px4-vtol": 10043}
# One link in place of many: none of them may reach the port of another flight.
PX4_LINK = "mavlink start -x -u {own} -o {port} -r 4000000 -f\nmavlink stream -r 10 -s GLOBAL_POSITION_INT -u {own}\n"
# The whole wind from 10 m on, none on the ground, as below trees. One estimator instead of two: the same flight in less time.
# A log of attitude, items and servos alone: at a great speed-up the whole one loses up to a third of the truth.
OWN = """SIM_WIND_SPD {speed_mps}
SIM_WIND_DIR {from_deg}
SIM_WIND_TURB {turbulence}
SIM_WIND_T 0
SIM_WIND_T_ALT 10
EK3_IMU_MASK 1
LOG_FILE_DSRMROT 0
LOG_BITMASK 1282
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


def px4(binary, kind, folder, instance, at, wind, speedup, sysid=1):
    """Starts one, in lockstep; it speaks to UDP port 14550 + 10 * instance. Its wind needs SIH_WIND_N and SIH_WIND_E."""
    folder.mkdir(parents=True, exist_ok=True)
    binary = pathlib.Path(binary).resolve()
    # Without write permission of its own the copy could not be changed.
    shutil.copytree(binary.parent.parent / "etc", folder / "etc", copy_function=shutil.copyfile)
    port = 14550 + 10 * instance
    lat, lon, amsl_m, _ = at
    # Both parameters are of the wind from there: `_v_apparent_N = _v_N + _v_wind_N`.
    from_rad, speed_mps = math.radians(wind["from_deg"]), wind["speed_mps"]
    own = {"PX4_SYS_AUTOSTART": PX4[kind], "PX4_SIMULATOR": "sihsim", "PX4_SIM_SPEED_FACTOR": speedup, "PX4_HOME_LAT": f"{lat:.7f}",
           "PX4_HOME_LON": f"{lon:.7f}", "PX4_HOME_ALT": amsl_m, "PX4_PARAM_MAV_SYS_ID": sysid}
    parameters = {}
    if kind != "px4-copter":
        # Or it refuses a mission that ends in a circle.
        parameters["MIS_TKO_LAND_REQ"] = 0
    if speed_mps:
        parameters |= {"SIH_WIND_N": round(speed_mps * math.cos(from_rad), 3), "SIH_WIND_E": round(speed_mps * math.sin(from_rad), 3)}
    # In a script: 1.17 has defaults of the airframe after it has read the environment. (Its system id is instance + 1.)
    script = "".join(f"param set {name} {value}\n" for name, value in parameters.items())
    (folder / "etc/init.d-posix/px4-rc.mavlink").write_text(script + PX4_LINK.format(own=18570 + instance, port=port))
    command = [str(binary), "-d", "-i", str(instance), "-w", str(folder.resolve()), "-s", "etc/init.d-posix/rcS", str(folder.resolve() / "etc")]
    with open(folder / "simulator.txt", "w") as log:
        child = subprocess.Popen(command, cwd=folder, env={**os.environ, **{k: str(v) for k, v in own.items()}},
                                 stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)
    # It speaks when its script has ended, on a busy machine long after.
    until = time.monotonic() + 60
    while "Startup script returned" not in (folder / "simulator.txt").read_text(errors="replace") and time.monotonic() < until:
        time.sleep(0.2)
    if "SIH_WIND_N not found" in (folder / "simulator.txt").read_text(errors="replace"):
        end(child)
        raise ValueError("this PX4 simulates no wind (1.18 and later do)")
    return child, f"udpin:127.0.0.1:{port}"


def start(options, kind, *given, **more):
    """One of any kind, of the binaries that the command names."""
    if kind in PX4:
        return px4(options.px4, kind, *given, **more)
    return ardupilot(options.copter if kind in ("copter", "zigzag") else options.plane, kind, *given, **more)


def truth(folder):
    """The truth in the newest log of a simulator."""
    if logs := sorted(folder.glob("logs/*.BIN")):
        return dataflash.Truth(logs[-1])
    return ulog.Truth(sorted(folder.glob("log/*/*.ulg"))[-1])


def end(child):
    child.kill()
    child.wait()


def version(messages):
    """The firmware that a log names, such as `ArduCopter V4.7.0-dev` or `PX4 1.18.0`."""
    for message in messages:
        found = re.search(r"Ardu\w+ V\S+|^PX4 \d\S+", message)
        if found:
            return found.group(0)
    return "unknown"
