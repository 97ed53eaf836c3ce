"""How long uploads to simulated vehicles on loopback take.

usage: upload_speed.py [--sortie SORTIE] [--items 700]
       upload_speed.py [--sortie SORTIE] [--items 200] --vehicles 100 [--loss 5]

Of one vehicle, a PX4: from MISSION_COUNT to MISSION_ACK, without read-back, for Sortie,
pymavlink and MAVSDK (run tools/test once before: it installs them). Sortie's time is
read from the capture of a whole `sortie upload`; the others are timed by their own
script, tests/peers/vehicle_ground_station.py.

Of several, ArduPilot and PX4 by turns: one whole `sortie upload`, from its start to its
end, verification before and read-back after included; LOSS is percent each way.
"""

import argparse
import contextlib
import json
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PYTHON = ROOT / "target/peers/bin/python"
PORT, ROUNDS = 21990, 7
MISSION_COUNT, MISSION_ACK, US = 44, 47, 245


def frames(capture):
    """Time in microseconds, sender, message id, payload of MAVLink 2 frames."""
    data, at = capture.read_bytes(), 0
    while at < len(data):
        (stamp,) = struct.unpack_from(">Q", data, at)
        length, sender = data[at + 9], data[at + 13]
        message = int.from_bytes(data[at + 15 : at + 18], "little")
        yield stamp, sender, message, data[at + 18 : at + 18 + length].ljust(9, b"\0")
        at += 8 + 12 + length


def mission_seconds(capture):
    """From our MISSION_COUNT of mission items to the vehicle's MISSION_ACK."""
    began = None
    for stamp, sender, message, payload in frames(capture):
        if (sender, message, payload[4]) == (US, MISSION_COUNT, 0):
            began = stamp
        if began and sender != US and message == MISSION_ACK and payload[3] == 0:
            return (stamp - began) / 1e6
    raise SystemExit("the capture holds no whole upload")


def run(folder, *command):
    return subprocess.run(command, cwd=folder, check=True, capture_output=True).stdout


@contextlib.contextmanager
def simulated(sortie, vehicles, items, *flags):
    """A folder with missions of so many items in `out`, while their vehicles run."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        autopilot = ["px4"] if vehicles == 1 else []
        spec = run(folder, sys.executable, ROOT / "tools/fleet_spec.py", str(vehicles), str(PORT), *autopilot)
        (folder / "fleet.yaml").write_bytes(spec)
        run(folder, sortie, "plan", "fleet.yaml", "--out", "out")
        run(folder, sys.executable, ROOT / "tools/fill_plans.py", "out", str(items))
        command = [sortie, "vehicles", "fleet.yaml", "--port", str(PORT), *flags]
        running = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE)
        try:
            while b"udpout" not in running.stdout.readline():
                pass
            yield folder
        finally:
            running.terminate()
            running.wait()


def peers(sortie, items):
    times = {"Sortie": [], "pymavlink": [], "MAVSDK": []}
    with simulated(sortie, 1, items) as folder:
        for _ in range(ROUNDS):
            run(folder, sortie, "upload", "out", "--tlog", "upload.tlog")
            times["Sortie"].append(mission_seconds(folder / "upload.tlog"))
            for tool in ("pymavlink", "MAVSDK"):
                script = ROOT / "tests/peers/vehicle_ground_station.py"
                line = run(folder, PYTHON, script, tool.lower(), str(PORT), str(items)).splitlines()[-1]
                times[tool].append(json.loads(line)["seconds"])
    print(f"{items} items to one simulated PX4 on loopback, {ROUNDS} rounds, seconds")
    print(f"{'':10} {'least':>8} {'median':>8} {'most':>8}")
    for tool, seconds in times.items():
        print(f"{tool:10} {min(seconds):8.3f} {statistics.median(seconds):8.3f} {max(seconds):8.3f}")


def fleet(sortie, vehicles, items, loss):
    with simulated(sortie, vehicles, items, "--loss", str(loss)) as folder:
        began = time.monotonic()
        ended = subprocess.run([sortie, "upload", "out", "--json"], cwd=folder, capture_output=True)
        seconds = time.monotonic() - began
    reports = json.loads(ended.stdout)["vehicles"]
    verified = sum(report["verdict"] == "verified" for report in reports)
    slowest = max(report["seconds"] for report in reports)
    print(f"{vehicles} vehicles, {items} items each, {loss} % loss each way:")
    print(f"{verified} verified, {seconds:.1f} s in all, the slowest transfer {slowest:.1f} s")
    if ended.returncode:
        raise SystemExit(ended.stderr.decode())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sortie", type=pathlib.Path, default=ROOT / "target/release/sortie")
    parser.add_argument("--items", type=int)
    parser.add_argument("--vehicles", type=int, default=1)
    parser.add_argument("--loss", type=float, default=5)
    told = parser.parse_args()
    sortie = told.sortie.resolve()
    if told.vehicles == 1:
        peers(sortie, told.items or 700)
    else:
        fleet(sortie, told.vehicles, told.items or 200, told.loss)


main()
