"""How long 700 items take to reach the same simulated PX4 on loopback, without
read-back: from MISSION_COUNT to MISSION_ACK, for Sortie, pymavlink and MAVSDK.

usage: upload_speed.py [SORTIE] [ITEMS]      (run tools/test once before: it installs the peers)

Sortie's time is read from the capture of a whole `sortie upload`; the others are
timed by their own script, tests/peers/vehicle_ground_station.py.
"""

import json
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile

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


def main():
    sortie = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/release/sortie").resolve()
    items = sys.argv[2] if len(sys.argv) > 2 else "700"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        run = lambda *command: subprocess.run(command, cwd=folder, check=True, capture_output=True).stdout
        spec = run(sys.executable, ROOT / "tools/fleet_spec.py", "1", str(PORT), "px4")
        (folder / "fleet.yaml").write_bytes(spec)
        run(sortie, "plan", "fleet.yaml", "--out", "out")
        run(sys.executable, ROOT / "tools/fill_plans.py", "out", items)
        vehicle = subprocess.Popen(
            [sortie, "vehicles", "fleet.yaml", "--port", str(PORT)], cwd=folder, stdout=subprocess.PIPE
        )
        try:
            while b"udpout" not in vehicle.stdout.readline():
                pass
            times = {"Sortie": [], "pymavlink": [], "MAVSDK": []}
            for _ in range(ROUNDS):
                run(sortie, "upload", "out", "--tlog", "upload.tlog")
                times["Sortie"].append(mission_seconds(folder / "upload.tlog"))
                for tool in ("pymavlink", "MAVSDK"):
                    script = ROOT / "tests/peers/vehicle_ground_station.py"
                    line = run(PYTHON, script, tool.lower(), str(PORT), items).splitlines()[-1]
                    times[tool].append(json.loads(line)["seconds"])
        finally:
            vehicle.terminate()
            vehicle.wait()
    print(f"{items} items to one simulated PX4 on loopback, {ROUNDS} rounds, seconds")
    print(f"{'':10} {'least':>8} {'median':>8} {'most':>8}")
    for tool, seconds in times.items():
        print(f"{tool:10} {min(seconds):8.3f} {statistics.median(seconds):8.3f} {max(seconds):8.3f}")


main()
