"""Missions of other planners, each with one item of interest: what `sortie review FILE` says of their times and places
against what a real vehicle flies."""

import json
import shutil
import time

import numpy as np

from . import missions, one, raw, simulator
from .tube import Tube, compare

UP_M = 50
SPEED = {"copter": 6, "plane": 18}


def at(east_m, north_m):
    return missions.place(east_m, north_m)


def copter_cases():
    way = (16, [], at(150, 0), UP_M)
    last = (16, [], at(300, 0), UP_M)
    land = (21, [], at(300, 0), 0)
    home = (20, [], None, 0)
    return {
        "loiter-turns": [way, (18, [2, 0, 30, 0], at(200, 60), UP_M), last, land],
        "loiter-time": [way, (19, [20, 0, 0, 0], at(200, 60), UP_M), last, land],
        "loiter-to-alt": [way, (31, [0, 0, 0, 0], at(200, 60), UP_M + 30), (16, [], at(300, 0), UP_M + 30), land],
        "loiter-to-alt-down": [way, (31, [0, 0, 0, 0], at(200, 60), UP_M - 25), last, land],
        "spline": [way, (82, [], at(200, 80), UP_M), (82, [], at(300, 0), UP_M + 10), (82, [], at(400, 90), UP_M), (16, [], at(500, 90), UP_M),
                   (21, [], at(500, 90), 0)],
        "spline-back": [(82, [], at(120, 0), UP_M), (82, [3], at(120, 120), UP_M), (82, [], at(0, 120), UP_M), home],
        "payload-place": [way, (94, [5, 0, 0, 0], at(200, 60), 20), last, land],
        "payload-to-ground": [way, (94, [0, 0, 0, 0], at(200, 60), 20), last, land],
        # Above the terrain: over a hill.
        "payload-over-hill": [(16, [], at(100, 30), 40, 10), (94, [8, 0, 0, 0], at(200, 60), 25, 10), (16, [], at(300, 60), 40, 10), home],
        "return": [way, last, home],
        "return-low": [(16, [], at(150, 0), 10), (16, [], at(200, 0), 10), home],
        "land-aside": [way, last, (21, [], at(300, 40), 0)],
        "land-3-aside": [way, last, (21, [], at(303, 0), 0)],
        "land-without-place": [way, last, (21, [], None, 0)],
        "jump-endless": [way, (16, [], at(150, 100), UP_M), (16, [], at(0, 100), UP_M), (177, [2, -1], None, 0)],
        "jump-twice": [way, (16, [], at(150, 100), UP_M), (16, [], at(0, 100), UP_M), (177, [3, 2], None, 0), home],
        "after-land": [way, (21, [], at(150, 0), 0), (22, [], None, 30), last, land],
        "delay": [way, (93, [15, -1, -1, -1], None, 0), last, land],
    }


def plane_cases():
    way = (16, [], at(800, 0), UP_M)
    far = (16, [], at(1600, 200), UP_M)
    stay = (17, [0, 0, 100, 0], at(2600, 200), UP_M)
    home = (20, [], None, 0)
    return {
        "loiter-turns": [way, (18, [2, 0, 90, 0], at(1600, 200), UP_M), stay],
        "loiter-turns-left": [way, (18, [1, 0, -120, 0], at(1600, 200), UP_M), (16, [], at(1500, 1200), UP_M), (17, [0, 0, 100, 0], at(800, 1800), UP_M)],
        "loiter-time": [way, (19, [60, 0, 0, 0], at(1600, 200), UP_M), stay],
        "loiter-to-alt": [way, (31, [1, 100, 0, 0], at(1600, 200), UP_M + 60), (17, [0, 0, 100, 0], at(2600, 200), UP_M + 60)],
        "return": [way, far, home],
        "jump-endless": [way, far, (16, [], at(800, 900), UP_M), (177, [2, -1], None, 0)],
    }


CASES = {"copter": copter_cases, "plane": plane_cases}


def rows_of(kind, items):
    """The rows of a file: home, takeoff, speed, the items (jumps count from the first of these as 3)."""
    speed = [0 if kind == "plane" else 1, SPEED[kind], -1, 0]
    takeoff = (22, [12 if kind == "plane" else 0], at(0, 300) if kind == "plane" else at(0, 0), UP_M)
    head = [(16, [], at(0, 0), missions.HOME_AMSL_M), takeoff, (178, speed, None, 0)]
    rows = []
    for n, (command, params, place, z, *frame) in enumerate([*head, *items]):
        if command == 177:
            params = [params[0] + 1, params[1]]
        frame = frame[0] if frame else 0 if n == 0 else 2 if place is None and command in (177, 178, 93) else 3
        place = place or {"lat": 0.0, "lon": 0.0}
        params = [*params, *[0] * (4 - len(params))]
        rows.append("\t".join(str(x) for x in [n, int(n == 0), frame, command, *params, f"{place['lat']:.7f}", f"{place['lon']:.7f}", z, 1]))
    return rows


def hilly(kind):
    """A spec for missions above the terrain: a hill of 30 m under the item of interest."""
    start = {**at(0, 0), "agl_m": UP_M}
    vehicle = {"id": "v", "sysid": 1, "autopilot": "ardupilot", "airframe": kind, "link": "sim", "home": at(0, 0), "start": start,
               "goal": {**at(300, 60), "agl_m": 40}, "finish": "return", "speed_mps": SPEED[kind], "max_climb_deg": 30,
               "max_descent_deg": 30, "climb_mps": 2.5, "descent_mps": 1.5, "accel_mps2": 2.5}
    hill = {**at(200, 60), "height_m": 30, "radius_m": 150}
    return missions.with_area("copter", 1, vehicle, [], [hill], {"speed_mps": 0, "from_deg": 0}, ("terrain", 2))


def flags(kind):
    some = ["--no-terrain", "--autopilot", "ardupilot", "--airframe", kind]
    return [*some, "--takeoff-heading", "0", "--climb", "3", "--descent", "3", "--max-climb", "12", "--max-descent", "12"] if kind == "plane" else some


def one_case(options, folder, kind, name, most_s=300):
    """What the file is judged as, and how the flight was against that."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    rows = rows_of(kind, CASES[kind]()[name])
    file = folder / f"{name}.waypoints"
    file.write_text("\n".join(["QGC WPL 110", *rows, ""]))
    given, more = flags(kind), ""
    if any(len(item) > 4 for item in CASES[kind]()[name]):
        spec, terrain = folder / "spec.yaml", folder / "dat"
        spec.write_text(json.dumps(hilly(kind)))
        one.run(options.sortie, "terrain", "export", spec, "--out", terrain)
        shutil.copytree(terrain, folder / "sim/terrain")
        given, more = [spec, "--vehicle", f"v={file}"], "TERRAIN_ENABLE 1\nSIM_TERRAIN 1\n"
    paths = [*given, *([] if more else [file])]
    done = one.run(options.sortie, "review", *paths, "--json", "--trajectories", folder / "trajectories.json")
    review = json.loads(done.stdout) if done.stdout.strip().startswith("{") else {}
    made = {"exit": done.returncode, "said": done.stderr.strip()[-600:],
            "failed": [f"{m['what']} {m['value']} {m.get('note') or ''}" for m in review.get("margins", []) if not m["ok"]],
            "notes": review.get("notes")}
    place = (missions.LAT, missions.LON, missions.HOME_AMSL_M, 0)
    child, link = simulator.ardupilot(getattr(options, kind), kind, folder / "sim", options.instance, place,
                                      {"speed_mps": 0, "from_deg": 0}, options.speedup, more=more)
    try:
        time.sleep(1)
        raw.fly(kind, link.replace("udpin://", "udpin:"), rows, {}, most_s)
        time.sleep(1)
    finally:
        simulator.end(child)
    return {**made, **against(kind, folder)}


def against(kind, folder):
    """The flight in its log against the verified trajectory."""
    truth = simulator.truth(folder / "sim")
    trajectories = json.loads((folder / "trajectories.json").read_text())["vehicles"]
    if not trajectories:
        return {"last_item": int(truth.row.max())}
    tube = Tube(trajectories[0])
    figures, escapes = compare(tube, truth, 10.0 if kind == "copter" else 15.0, kind == "plane")
    points = tube.metres(truth.lat, truth.lon, truth.amsl)
    begun = {int(row): round(float((truth.t - truth.t0_s)[truth.row == row][0]), 1) for row in np.unique(truth.row) if row > 0}
    said = {int(row): [round(float(t), 1) for t in (tube.from_s[tube.row == row].min(), tube.to_s[tube.row == row].max())]
            for row in np.unique(tube.row)}
    return {
        "escapes": escapes, "begun_s": begun, "judged_s": said, "late_s": [round(x, 1) for x in figures["late_s"]],
        "across_m": max(figures["across_m"], default=None), "lasted_s": round(float(truth.t[-1] - truth.t0_s), 1),
        "end_m": [round(float(x), 1) for x in points[-1] - tube.start[0]], "texts": truth.texts[-4:],
    }


def all_of(kind):
    def flown(options, folder):
        return {name: one_case(options, folder / name, kind, name) for name in CASES[kind]()}
    return flown
