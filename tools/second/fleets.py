"""Random fleets over the Jacksboro fault, most of them bad."""

import json
import math

import numpy as np

from .earth import A, distance
from .flight import DELAY, HOLD, LAND, RETURN, SPEED, STAY, TAKEOFF, TO_ALT, WAYPOINT

SOUTH, NORTH, WEST, EAST = 36.19, 36.42, -84.38, -84.11


def make_fleet(rng, ground, folder):
    """A spec and one `.waypoints` file for each vehicle; returns their paths."""
    def place():
        return round(rng.uniform(SOUTH, NORTH), 6), round(rng.uniform(WEST, EAST), 6)

    threats = [
        {"id": f"threat-{i}", "lat": lat, "lon": lon, "radius_m": round(rng.uniform(100, 2500), 1)}
        for i, (lat, lon) in enumerate(place() for _ in range(rng.integers(0, 7)))
    ]

    def clear(at):
        return all(distance(at, (t["lat"], t["lon"])) > t["radius_m"] + 20 for t in threats)

    def clear_place():
        return next(at for at in iter(place, None) if clear(at))

    vehicles, files = [], []
    heart = place()
    for index in range(rng.integers(1, 4)):
        vehicle = {
            "id": f"v{index}", "sysid": index + 1, "airframe": "copter", "link": "sim",
            "autopilot": str(rng.choice(["ardupilot", "px4"])),
            "finish": str(rng.choice(["land", "loiter", "return"])),
            "speed_mps": round(rng.uniform(4, 22), 2), "max_load_factor": round(rng.uniform(1.05, 1.6), 3),
            "accel_mps2": round(rng.uniform(1, 5), 2), "climb_mps": round(rng.uniform(1, 6), 2),
            "descent_mps": round(rng.uniform(0.4, 5), 2), "depart_s": float(rng.integers(0, 4) * 60),
        }
        if rng.random() < 0.5:
            vehicle["return_amsl_m"] = round(rng.uniform(600, 1300), 1)
        (home_lat, home_lon), (goal_lat, goal_lon) = clear_place(), clear_place()
        vehicle["home"] = {"lat": home_lat, "lon": home_lon}
        vehicle["start"] = {"lat": home_lat, "lon": home_lon, "agl_m": 80}
        vehicle["goal"] = {"lat": goal_lat, "lon": goal_lon, "agl_m": 80}
        vehicles.append(vehicle)
        files.append(folder / f"v{index}.waypoints")
        write_items(files[-1], zigzag(rng, ground, vehicle, heart))
    separation = {"distance_m": 100, "time_slack_s": float(rng.choice([0, 0, 1, 5, 20]))}
    if rng.random() < 0.3:
        separation["vertical_m"] = 30
    spec = {
        "sortie": 1, "name": "random", "terrain": {"file": "jacksboro.tif"},
        "area": {"south_west": {"lat": 36.18, "lon": -84.40}, "north_east": {"lat": 36.43, "lon": -84.10},
                 "min_agl_m": 30, "max_amsl_m": 1500},
        "threats": threats, "vehicles": vehicles, "separation": separation,
        "planner": {"algorithm": "msfoa", "seed": 1, "evaluations": 300},
        "mission": {"altitude": altitude_reference(rng, vehicles), "tolerance_m": 5},
    }
    if rng.random() < 0.5:
        kinds = ("all", "threats", "terrain", "separation")
        for vehicle in vehicles:
            vehicle["max_airspeed_mps"] = 30.0
        spec |= {"sortie": 2, "buffer_m": {kind: round(rng.uniform(0, 19), 1) for kind in kinds}}
    path = folder / "spec.yaml"
    path.write_text(json.dumps(spec, indent=1))
    return path, files


def altitude_reference(rng, vehicles):
    everywhere = ["amsl", "relative"]
    can_follow = all(vehicle["autopilot"] == "ardupilot" for vehicle in vehicles)
    return str(rng.choice([*everywhere, "terrain"] if can_follow else everywhere))


def zigzag(rng, ground, vehicle, heart):
    """Items that go through a common heart of the map, so that vehicles meet."""
    ardupilot = vehicle["autopilot"] == "ardupilot"
    home = vehicle["home"]["lat"], vehicle["home"]["lon"]
    base = float(ground.height(*home))
    frames = [0, 0, 3, 5, 6, 10, 11] if ardupilot else [0, 0, 3, 5, 6]

    def item(command, at, agl, p1=0.0):
        """At a height above the ground there, in a random frame."""
        amsl, frame = float(ground.height(*at)) + agl, int(rng.choice(frames))
        z = amsl if frame in (0, 5) else max(amsl - base, 1.0) if frame in (3, 6) else agl
        return (frame, command, p1, 0, *at, round(z, int(rng.integers(0, 4))))

    def speed():
        return (2, SPEED, 1, round(rng.uniform(3, 20), 1), 0, 0, 0)

    rows = [(0, WAYPOINT, 0, 0, *home, round(base, 2))]
    if vehicle["depart_s"] > 0 and rng.random() < 0.7:
        rows.append((2, DELAY, vehicle["depart_s"], -1, 0, 0, 0))
    beside = (home[0] + rng.uniform(-1, 1) * 1e-3, home[1]) if rng.random() < 0.3 else home
    rows.append((3, TAKEOFF, 0, 0, *beside, round(rng.uniform(20, 120), 1)))
    if ardupilot or rng.random() < 0.2:
        rows.append((2, SPEED, 1, vehicle["speed_mps"], 0, 0, 0))
    at = home
    course = math.atan2((heart[1] - at[1]) * math.cos(math.radians(36.3)), heart[0] - at[0])
    for index in range(rng.integers(2, 9)):
        if index == 1:
            at = heart
        else:
            course += rng.choice([rng.uniform(-0.5, 0.5), rng.uniform(-3.1, 3.1)])
            far = math.degrees(math.exp(rng.uniform(math.log(30), math.log(7000))) / A)
            at = at[0] + far * math.cos(course), at[1] + far * math.sin(course) / math.cos(math.radians(36.3))
        at = min(max(at[0], SOUTH), NORTH), min(max(at[1], WEST), EAST)
        at = round(at[0], 7), round(at[1], 7)
        agl = rng.choice([rng.uniform(20, 250), rng.uniform(60, 120), rng.uniform(1, 40)])
        hold = round(rng.uniform(0.5, 30), 1) if rng.random() < 0.15 else 0.0
        # Without a draw of its own, so that fleets stay what they were.
        to_altitude = ardupilot and hold == 0.0 and int(agl * 1000) % 6 == 0
        rows.append(item(TO_ALT if to_altitude else WAYPOINT, at, agl, hold))
        if rng.random() < 0.1:
            rows.append(item(WAYPOINT, at, agl + rng.uniform(-20, 60)))
        if rng.random() < 0.05:
            rows.append(item(HOLD, at, agl, round(rng.uniform(0.5, 30), 1)))
        if rng.random() < 0.15:
            rows.append(speed())
    end = rng.random()
    if end < 0.5:
        aside = at if rng.random() < 0.5 else (round(at[0] + 0.002, 7), round(at[1] - 0.003, 7))
        rows.append((3, LAND, 0, 0, *aside, 0))
    elif end < 0.7:
        rows.append(item(STAY, at, agl))
    elif end < 0.9 and "return_amsl_m" in vehicle:
        rows.append((2, RETURN, 0, 0, 0, 0, 0))
    return rows


def write_items(path, items):
    rows = ["QGC WPL 110"]
    for seq, (frame, command, p1, p2, lat, lon, z, *more) in enumerate(items):
        p3 = more[0] if more else 0
        row = [seq, int(seq == 0), frame, command, f"{p1:g}", f"{p2:g}", f"{p3:g}", 0, f"{lat:.7f}", f"{lon:.7f}", f"{z:g}", 1]
        rows.append("\t".join(map(str, row)))
    path.write_text("\n".join(rows) + "\n")
