"""Flights of which one thing each is of interest: what is measured is printed as JSON."""

import json
import math
import pathlib
import shutil
import subprocess
import threading
import time

import numpy as np
import yaml

from second.earth import Ground

from . import items, missions, one, raw, simulator, ulog
from .dataflash import read
from .tube import Tube, compare

AT = (missions.LAT, missions.LON, missions.HOME_AMSL_M, 0)
HEAD = "QGC WPL 110"
# The takeoffs of shipped missions over terrain go higher.
UP_AGL_M = 75.0


def row(number, frame, command, params, at, z):
    at = {"lat": 0.0, "lon": 0.0} if at is None else at
    params = [*params, *[0] * (4 - len(params))]
    return "\t".join(str(x) for x in [number, int(number == 0), frame, command, *params, f"{at['lat']:.7f}", f"{at['lon']:.7f}", z, 1])


def listed(items):
    """Rows of a mission: home at the middle, takeoff to 50 m, then (command, params, place, height)."""
    rows = [row(0, 0, 16, [], missions.place(0, 0), missions.HOME_AMSL_M), row(1, 3, 22, [], missions.place(0, 0), 50)]
    return rows + [row(n + 2, 3, command, params, at, z) for n, (command, params, at, z) in enumerate(items)]


def raw_flight(options, folder, rows, parameters, most_s, wind_mps=0):
    shutil.rmtree(folder, ignore_errors=True)
    wind = {"speed_mps": wind_mps, "from_deg": 270}
    child, link = simulator.ardupilot(options.copter, "copter", folder / "sim", options.instance, AT, wind, options.speedup)
    try:
        time.sleep(1)
        raw.fly_copter(link.replace("udpin://", "udpin:"), rows, parameters, most_s)
        time.sleep(1)
    finally:
        simulator.end(child)
    return simulator.truth(folder / "sim")


def metres(truth):
    east = (truth.lon - missions.LON) * 111_320.0 * math.cos(math.radians(missions.LAT))
    return np.stack([east, (truth.lat - missions.LAT) * 110_950.0, truth.amsl - missions.HOME_AMSL_M], axis=-1)


def speeds(truth, points):
    return np.hypot(*np.gradient(points[:, :2], axis=0).T) / np.maximum(np.gradient(truth.t), 1e-3)


def zigzag(options, folder):
    """Twelve legs of 100 m with right angles at 10 m/s: seconds a leg (the verdict: 12.6)."""
    places = [(100.0 * ((n + 1) // 2), 100.0 * (n // 2)) for n in range(13)]
    rows = listed([(178, [1, 10, -1], None, 0)] + [(16, [], missions.place(*at), 50) for at in places]
                  + [(21, [], missions.place(*places[-1]), 0)])
    truth = raw_flight(options, folder, rows, {"WPNAV_SPEED": 1000, "WPNAV_ACCEL": 250, "WPNAV_RADIUS": 200}, 300)
    points = metres(truth)
    passed = [truth.t[np.argmin(np.hypot(*(points[:, :2] - np.array(at)).T) + 1e3 * (points[:, 2] < 45))] for at in places]
    speed = speeds(truth, points)
    least = [float(speed[np.abs(truth.t - t) < 3].min()) for t in passed[1:-1]]
    return {"leg_s": [round(float(s), 2) for s in np.diff(passed)], "least_mps": [round(s, 2) for s in least]}


def land_aside(options, folder):
    """NAV_LAND 40 m beside the last waypoint: the least speed at that waypoint."""
    last, pad = (300, 0), (300, 40)
    rows = listed([(178, [1, 8, -1], None, 0), (16, [], missions.place(100, 0), 50), (16, [], missions.place(*last), 50),
                   (21, [], missions.place(*pad), 0)])
    truth = raw_flight(options, folder, rows, {"WPNAV_SPEED": 800}, 240)
    points = metres(truth)
    near = (np.hypot(*(points[:, :2] - np.array(last)).T) < 8) & (points[:, 2] > 40)
    return {"least_mps_at_last": round(float(speeds(truth, points)[near].min()), 3),
            "touchdown_from_pad_m": round(float(np.hypot(*(points[-1, :2] - np.array(pad)))), 2)}


def after_unlimited(options, folder):
    """Items after NAV_LOITER_UNLIM: the last item that was begun, and where the vehicle is after 180 s."""
    rows = listed([(16, [], missions.place(150, 0), 50), (17, [], missions.place(250, 0), 50),
                   (16, [], missions.place(400, 0), 50), (21, [], missions.place(400, 0), 0)])
    truth = raw_flight(options, folder, rows, {"WPNAV_SPEED": 800}, 180)
    points = metres(truth)
    return {"last_item": int(truth.row.max()), "of": len(rows) - 1,
            "from_loiter_m": round(float(np.hypot(*(points[-1, :2] - np.array([250, 0])))), 2),
            "height_m": round(float(points[-1, 2]), 1)}


def spline(options, folder):
    """NAV_SPLINE_WAYPOINT: the flown track, a place for each half second."""
    places = [(0, 120), (120, 160), (180, 40), (300, 80), (360, 200)]
    rows = listed([(178, [1, 6, -1], None, 0)] + [(82, [], missions.place(*at), 50) for at in places]
                  + [(21, [], missions.place(*places[-1]), 0)])
    truth = raw_flight(options, folder, rows, {"WPNAV_SPEED": 600, "WPNAV_ACCEL": 250, "WPNAV_RADIUS": 200}, 240)
    points = metres(truth)
    moving = (points[:, 2] > 45) & (truth.row >= 2)
    track, last = [], -1.0
    for t, p in zip(truth.t[moving], points[moving]):
        if t - last >= 0.5:
            last = t
            track.append([round(float(v), 2) for v in (t, *p)])
    return {"version": simulator.version(truth.texts), "rows": rows, "track_t_east_north_up": track}


def copter(identity, sysid, start, goal, **more):
    return {"id": identity, "sysid": sysid, "autopilot": "ardupilot", "airframe": "copter", "link": "sim",
            "start": {**missions.place(*start), "agl_m": 50}, "goal": {**missions.place(*goal), "agl_m": 50},
            "finish": "land", "speed_mps": 8, "max_climb_deg": 15, "max_descent_deg": 12, "climb_mps": 3,
            "descent_mps": 2, **more}


def spec_of(name, vehicles, wind_mps=0, **more):
    spec = missions.with_area(name, 1, vehicles[0], [], [], {"speed_mps": wind_mps, "from_deg": 270}, ("relative", 5))
    return {**spec, "name": name, "vehicles": vehicles, **more}


def kind_of(vehicle):
    """The simulator of a vehicle of a spec."""
    airframe = vehicle.get("airframe", "copter")
    return next(kind for kind, of in missions.KINDS.items() if of == (vehicle["autopilot"], airframe))


def fleet_flight(options, folder, spec, during=None, wind_mps=0, from_deg=270, terrain=None, timeout=900):
    """A fleet by `sortie fly`: the flight document and the truth of each vehicle."""
    vehicles = yaml.safe_load(spec)["vehicles"] if isinstance(spec, str) else spec["vehicles"]
    out, trajectories = one.plan(options.sortie, spec, folder)
    if out is None:
        raise ValueError(trajectories)
    children, links = [], []
    for n, vehicle in enumerate(vehicles):
        own, more = folder / f"sim{n}", {"sysid": vehicle["sysid"]}
        if terrain and vehicle["autopilot"] == "ardupilot":
            shutil.copytree(terrain, own / "terrain")
            more["more"] = "TERRAIN_ENABLE 1\nSIM_TERRAIN 1\n"
        place, wind = (*one.home(out, vehicle["id"]), 0), {"speed_mps": wind_mps, "from_deg": from_deg}
        child, link = simulator.start(options, kind_of(vehicle), own, options.instance + n, place, wind, options.speedup, **more)
        children.append(child)
        links += ["--link", f"{vehicle['id']}={link}"]
    if during:
        threading.Thread(target=during, daemon=True).start()
    try:
        time.sleep(2)
        done = subprocess.run([str(x) for x in [options.sortie, "fly", out / "spec.yaml", "--dir", out, *links, "--upload",
                                                "--set-params", "--speedup", options.speedup, "--json"]],
                              capture_output=True, text=True, timeout=timeout)
        time.sleep(1)
    finally:
        for child in children:
            simulator.end(child)
    try:
        flight = json.loads(done.stdout)
    except ValueError:
        raise ValueError(done.stderr[-2000:])
    truths, tubes = {}, {of["id"]: Tube(of) for of in trajectories["vehicles"]}
    for n, vehicle in enumerate(vehicles):
        truth = simulator.truth(folder / f"sim{n}")
        truth.figures, truth.escapes = compare(tubes[vehicle["id"]], truth, 10.0)
        # All from one origin.
        truth.points = tubes[vehicles[0]["id"]].metres(truth.lat, truth.lon, truth.amsl)
        truths[vehicle["id"]] = truth
    return flight, truths


def summary(flight, truths):
    """What a fleet did, by its own record and by the truth."""
    frames = {name: (truth.t - truth.t0_s, truth.points) for name, truth in truths.items()}
    nearest, names = None, list(frames)
    for n, a in enumerate(names):
        for b in names[n + 1:]:
            t = np.arange(1, min(frames[a][0][-1], frames[b][0][-1]), 0.1)
            p, q = (np.stack([np.interp(t, frames[k][0], frames[k][1][:, axis]) for axis in range(3)], axis=-1) for k in (a, b))
            up = (p[:, 2] > frames[a][1][0, 2] + 1) & (q[:, 2] > frames[b][1][0, 2] + 1)
            if up.any():
                least = float(np.linalg.norm(p - q, axis=1)[up].min())
                nearest = least if nearest is None else min(nearest, least)
    return {
        "verdict": flight["verdict"], "vehicles": len(truths), "nearest_m": None if nearest is None else round(nearest, 2),
        "failed": [f"{m['vehicle']} {m['what']} {m['value']} (limit {m['limit']}) {m.get('note') or ''}" for m in flight["margins"] if not m["ok"]],
        "alarms": [f"{a['vehicle']} {a['alarm']} T0+{a['t_s']}: {a['text']}" for a in flight["alarms"]],
        "escapes": {name: truth.escapes for name, truth in truths.items() if truth.escapes},
        "late_s": {name: max(truth.figures["late_s"], default=None) for name, truth in truths.items()},
        "separation": [m["value"] for m in flight["margins"] if m["what"] == "separation"],
    }


def servo(options, folder):
    """A stop with a hold and a servo: where the vehicle was and how fast when the servo moved."""
    stop = {"id": "s", **missions.place(200, 80), "agl_m": 50, "hold_s": 6, "actions": [{"servo": {"channel": 9, "pwm_us": 1900}}]}
    spec = spec_of("servo", [copter("v", 1, (0, 0), (400, 0), stops=[stop])])
    flight, truths = fleet_flight(options, folder, spec)
    truth = truths["v"]
    log = sorted((folder / "sim0" / "logs").glob("*.BIN"))[-1].read_bytes()
    found = read(log, ["MISE", "RCOU"])
    done = [t * 1e-6 for t, command in zip(found["MISE"]["TimeUS"], found["MISE"]["CId"]) if command == 183]
    moved = [t * 1e-6 for t, pwm in zip(found["RCOU"]["TimeUS"], found["RCOU"]["C9"]) if pwm == 1900][:1]
    points = metres(truth)
    at = int(np.argmin(np.abs(truth.t - (moved or done)[0])))
    return {**summary(flight, truths), "servo_item_s": done, "servo_moved_s": moved,
            "from_stop_m": round(float(np.hypot(*(points[at, :2] - np.array([200, 80])))), 2),
            "speed_mps": round(float(speeds(truth, points)[at]), 2)}


def payload(options, folder):
    """A load that is put down at a stop, with and without a hold there: what the flight did there."""
    found = {}
    for hold_s in (0, 3):
        stop = {"id": "s", **missions.place(200, 80), "agl_m": 50, "hold_s": hold_s, "actions": [{"payload_place": {"max_descent_m": 60}}]}
        flight, truths = fleet_flight(options, folder / f"hold-{hold_s}", spec_of("payload", [copter("v", 1, (0, 0), (400, 0), stops=[stop])]))
        truth = truths["v"]
        points, near = metres(truth), None
        near = np.hypot(*(points[:, :2] - np.array([200, 80])).T) < 15
        found[hold_s] = {**summary(flight, truths), "lowest_m": round(float(points[near, 2].min()), 2),
                         "from_stop_m": round(float(np.hypot(*(points[near][np.argmin(points[near, 2]), :2] - np.array([200, 80])))), 2),
                         "texts": [text for text in truth.texts if "ayload" in text]}
    return found


def drop(options, folder):
    """A stop 5 m above the ground, below the least height, of an ArduCopter and a PX4 copter: where and how low they were."""
    places = {"v": (200, 80), "p": (200, 480)}
    stops = {name: {"id": "yard", **missions.place(*at), "agl_m": 5, "hold_s": 4} for name, at in places.items()}
    spec = spec_of("drop", [copter("v", 1, (0, 0), (400, 0), stops=[stops["v"]]),
                            copter("p", 2, (0, 400), (400, 400), autopilot="px4", stops=[stops["p"]])])
    flight, truths = fleet_flight(options, folder, spec)
    found = summary(flight, truths)
    for name, at in places.items():
        points = metres(truths[name])
        away = np.hypot(*(points[:, :2] - np.array(at)).T)
        near = away < 15
        below = points[near, 2] < stops[name]["agl_m"] + 1.5
        found[name] = {"lowest_m": round(float(points[near, 2].min()), 2),
                       "from_stop_m": round(float(away[near][np.argmin(points[near, 2])]), 2),
                       "below_6.5_m_s": round(float(below.sum() * np.median(np.diff(truths[name].t))), 1)}
    return found


def fleet(options, folder, count=10):
    """So many copters that cross one airspace, from one command."""
    vehicles = []
    for n in range(count):
        angle = 2 * math.pi * n / count
        start, goal = (260 * math.cos(angle), 260 * math.sin(angle)), (-260 * math.cos(angle + 0.5), -260 * math.sin(angle + 0.5))
        made = copter(f"v{n}", n + 1, start, goal, speed_mps=7)
        vehicles.append({**made, "start": {**made["start"], "agl_m": 50 + 4 * n}})
    spec = spec_of("fleet", vehicles, separation={"distance_m": 30, "time_slack_s": 5})
    return summary(*fleet_flight(options, folder, spec, timeout=1500))


def disturbed(options, folder, name, parameters, after_s=60):
    """Parameters are set in the air over another link: when, and which alarms came."""
    spec = spec_of(name, [copter("v", 1, (0, 0), (700, 0))])
    noted = {}

    def during():
        time.sleep(3)
        link = raw.connect(f"tcp:127.0.0.1:{5762 + 10 * options.instance}")
        armed = None
        while True:
            link.mav.request_data_stream_send(link.target_system, 1, 6, 10, 1)
            message = link.recv_match(type=["HEARTBEAT", "GLOBAL_POSITION_INT"], blocking=True, timeout=5)
            if message is None:
                continue
            if message.get_type() == "GLOBAL_POSITION_INT" and message.relative_alt > 40_000:
                armed = armed or message.time_boot_ms
                if message.time_boot_ms - armed > 1000 * 15:
                    noted["set_s"] = message.time_boot_ms / 1000
                    break
        for key, value in parameters.items():
            raw.set_parameter(link, key, value)

    flight, truths = fleet_flight(options, folder, spec, during)
    t0_s = truths["v"].t0_s
    return {**summary(flight, truths), "set_after_t0_s": round(noted.get("set_s", math.nan) - t0_s, 2),
            "texts": [text for text in truths["v"].texts if "attery" in text or "ence" in text]}


def shipped(options, folder, name, wind=None, autopilot=None, speeds_mps={}):
    """A shipped mission over its terrain, in the wind that its spec then has, some vehicles at other speeds."""
    missions_of = pathlib.Path(__file__).resolve().parents[2] / "missions"
    spec = yaml.safe_load((missions_of / f"{name}.yaml").read_text())
    if wind is not None:
        spec["wind"] = wind
    for vehicle in spec["vehicles"]:
        vehicle["autopilot"] = autopilot or vehicle["autopilot"]
        vehicle["speed_mps"] = speeds_mps.get(vehicle["id"], vehicle["speed_mps"])
    terrain = None
    if file := spec["terrain"].get("file"):
        (folder / "terrain").mkdir(parents=True)
        shutil.copy(missions_of / file, folder / "terrain")
        (folder / "spec.yaml").write_text(json.dumps(spec))
        terrain = folder / "dat"
        done = one.run(options.sortie, "terrain", "export", folder / "spec.yaml", "--out", terrain)
        if done.returncode != 0:
            raise ValueError(done.stderr)
    wind = spec.get("wind", {"speed_mps": 0, "from_deg": 0})
    flight, truths = fleet_flight(options, folder, json.dumps(spec), wind_mps=wind["speed_mps"], from_deg=wind["from_deg"],
                                  terrain=terrain, timeout=2400)
    made = summary(flight, truths)
    if file and file.endswith("jacksboro.tif"):
        made["clearance_m"] = clearances(Ground(missions_of / file), truths)
    return made


def clearances(ground, truths):
    """The least height above the ground of each vehicle between its takeoff and its landing, by the truth."""
    found = {}
    for name, truth in truths.items():
        # After its landing a vehicle may name its first item again; its first may be a delay on the ground.
        begun = np.maximum.accumulate(truth.row)
        agl = truth.amsl - ground.height(truth.lat, truth.lon)
        way = (np.maximum.accumulate(agl) > UP_AGL_M) & (begun < begun.max())
        found[name] = round(float(agl[way].min()), 2)
    return found


def jacksboro(options, folder):
    """With ArduCopters alone."""
    return shipped(options, folder, "jacksboro", autopilot="ardupilot")


def jacksboro_in_wind(options, folder):
    """At its 9 m/s the verdict rejects alpha: against that wind it needs 13.9 m/s through the air."""
    return shipped(options, folder, "jacksboro", {"from_deg": 270, "speed_mps": 5}, "ardupilot", {"alpha": 8.7})


def harbour(options, folder):
    """With PX4 copters, in the wind of its spec."""
    return shipped(options, folder, "harbour")


def harbour_in_none(options, folder):
    return shipped(options, folder, "harbour", {"from_deg": 240, "speed_mps": 0})


def harbour_in_wind(options, folder):
    return shipped(options, folder, "harbour", {"from_deg": 240, "speed_mps": 5})


def inspection(options, folder):
    """Stops and actions, an ArduCopter and a PX4 copter: how far from each stop the vehicle was when its camera was told to."""
    made = shipped(options, folder, "inspection")
    log = sorted((folder / "sim1").glob("log/*/*.ulg"))[-1].read_bytes()
    of = ulog.read(log, ["vehicle_command"])[0]["vehicle_command"]
    commands = [(round(t * 1e-6, 1), number) for t, number in zip(of["timestamp"], of["command"]) if number >= 1000 or 180 < number < 210]
    item = read(sorted((folder / "sim0" / "logs").glob("*.BIN"))[-1].read_bytes(), ["MISE"])["MISE"]
    return {**made, "px4_commands": commands, "ardupilot_items": [(round(t * 1e-6, 1), n) for t, n in zip(item["TimeUS"], item["CId"])]}


def survey(options, folder):
    """Lines and pictures, two ArduCopters and two PX4 copters."""
    return shipped(options, folder, "survey")


def battery(options, folder):
    return disturbed(options, folder, "battery", {"BATT_LOW_VOLT": 10.5, "BATT_CRT_VOLT": 10.2, "SIM_BATT_VOLTAGE": 9.8})


def fence(options, folder):
    return disturbed(options, folder, "fence", {"FENCE_TYPE": 2, "FENCE_RADIUS": 60, "FENCE_ACTION": 0, "FENCE_ENABLE": 1})


SPECIAL = {"zigzag": zigzag, "land-aside": land_aside, "after-unlimited": after_unlimited, "spline": spline,
           "servo": servo, "payload": payload, "fleet": fleet, "battery": battery, "fence": fence, "jacksboro": jacksboro,
           "jacksboro-wind": jacksboro_in_wind, "harbour": harbour, "harbour-still": harbour_in_none,
           "harbour-wind": harbour_in_wind, "inspection": inspection, "survey": survey, "drop": drop,
           "items-copter": items.all_of("copter"), "items-plane": items.all_of("plane")}
