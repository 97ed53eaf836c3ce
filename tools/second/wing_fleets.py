"""Random planes and VTOLs over the Jacksboro fault, some of them too low or near a threat."""

import json
import math

from .earth import A, distance
from .fleets import EAST, NORTH, SOUTH, WEST, write_items
from .flight import G, HOLD, LAND, RETURN, STAY, TAKEOFF, TO_ALT, WAYPOINT
from .l1 import air_ratio
from .wing import TURNS, VTOL_LAND, VTOL_TAKEOFF

CEILING_M, FOLLOWS_SHARE = 2000, 0.15
KINDS = [("plane", "px4"), ("plane", "ardupilot"), ("vtol", "px4"), ("vtol", "ardupilot")]
# Around the home of a VTOL, metres.
ROOM_M = {("vtol", "px4"): 400, ("vtol", "ardupilot"): 1500}


def moved(at, clockwise, far):
    north, east = far * math.cos(clockwise), far * math.sin(clockwise)
    lat, lon = at[0] + math.degrees(north / A), at[1] + math.degrees(east / A) / math.cos(math.radians(36.3))
    return round(min(max(lat, SOUTH), NORTH), 7), round(min(max(lon, WEST), EAST), 7)


def make_wing(rng, ground, folder, airframe, autopilot):
    """A spec, the `.waypoints` file of one wing and its parameters; returns the paths of the first two."""
    wind = round(rng.uniform(0.5, 6 if airframe == "plane" else 4), 1) if rng.random() < 0.4 else 0.0
    home = round(rng.uniform(36.26, 36.35), 6), round(rng.uniform(-84.29, -84.20), 6)
    vehicle, rows = wing(rng, ground, (airframe, autopilot), home, wind)
    return write(rng, folder, [(vehicle, rows)], wind)


def make_pair(rng, ground, folder):
    """A wing of PX4, and another, or a copter, that come to one place."""
    wind = round(rng.uniform(0.5, 4), 1) if rng.random() < 0.4 else 0.0
    heart = round(rng.uniform(36.28, 36.33), 6), round(rng.uniform(-84.27, -84.22), 6)
    fleet = []
    for index in range(2):
        kind = KINDS[rng.choice([0, 2])]
        home = moved(heart, rng.uniform(-3.1, 3.1), rng.uniform(800, 3000))
        vehicle, rows = wing(rng, ground, kind, home, wind, heart)
        goal = {"lat": 36.21, "lon": (-84.36, -84.14)[index], "amsl_m": 1400}
        fleet.append((vehicle | {"id": f"v{index}", "sysid": index + 1, "goal": goal}, rows))
    return write(rng, folder, fleet, wind)


def wing(rng, ground, kind, home, wind, heart=None):
    """A vehicle and its items; it only circles at its end if it comes to a place where it meets others."""
    (airframe, autopilot), heading = kind, round(rng.uniform(0, 359), 1)
    ardupilot = autopilot == "ardupilot"
    vehicle = {
        "id": "v0", "sysid": 1, "airframe": airframe, "link": "sim", "autopilot": autopilot,
        "speed_mps": round(rng.uniform(14, 22), 2), "max_load_factor": round(rng.uniform(1.15, 1.6), 3),
        "accel_mps2": round(rng.uniform(1, 4), 2), "climb_mps": 3.0, "descent_mps": 3.0,
        "max_climb_deg": 10.0, "max_descent_deg": 8.0, "home": {"lat": home[0], "lon": home[1]},
    }
    n, fastest = vehicle["max_load_factor"], vehicle["speed_mps"] * air_ratio(CEILING_M) + wind
    vehicle["loiter_radius_m"] = math.ceil(rng.uniform(1, 1.6) * fastest**2 / (G * math.sqrt(n * n - 1)))
    base = float(ground.height(*home))
    rows, at = begin(rng, vehicle, home, heading, base)
    course, z = math.radians(heading) + rng.uniform(-1, 1), rows[-1][6] + (base if ardupilot else 0)
    for index in range(rng.integers(2, 8)):
        # Short legs too: a lag of a descent is still there on the legs after.
        far = rng.choice([rng.uniform(25, 80), rng.uniform(150, 2500), rng.uniform(300, 1500)])
        at = heart if heart and index == 1 else moved(at, course, far)
        z = z if rng.random() < 0.4 else max(z + rng.uniform(-0.12, 0.15) * far, base + 25)
        rows.append(fly_to(rng, vehicle, at, z, base, heart is None, z - float(ground.height(*at))))
        course += rng.choice([rng.uniform(-0.5, 0.5), rng.uniform(-2.6, 2.6)])
    end(rng, vehicle, rows, at, course, ground)
    # The contract with the spec is not compared: somewhere.
    vehicle["start"] = {"lat": 36.21, "lon": -84.25, "amsl_m": 1400}
    vehicle["goal"] = {"lat": 36.21, "lon": -84.36, "amsl_m": 1400}
    return vehicle, rows


def write(rng, folder, fleet, wind):
    path, files, vehicles = folder / "spec.yaml", [], [vehicle for vehicle, _ in fleet]
    for vehicle, rows in fleet:
        files.append(folder / f"{vehicle['id']}.waypoints")
        write_items(files[-1], rows)
        write_params(rng, folder / f"{vehicle['id']}.params", vehicle)
    threats = obstacles(rng, fleet)
    separation = {"distance_m": 100, "time_slack_s": float(rng.choice([0, 5]))}
    if rng.random() < 0.3:
        separation["vertical_m"] = 30
    spec = {
        "sortie": 2, "name": "wing", "terrain": {"file": "jacksboro.tif"},
        "area": {"south_west": {"lat": 36.18, "lon": -84.40}, "north_east": {"lat": 36.43, "lon": -84.10},
                 "min_agl_m": 30, "max_amsl_m": CEILING_M},
        "threats": threats, "vehicles": vehicles, "separation": separation,
        "planner": {"algorithm": "msfoa", "seed": 1, "evaluations": 300}, "mission": {"altitude": "amsl", "tolerance_m": 5},
        "buffer_m": {kind: round(rng.uniform(0, 19), 1) for kind in ("all", "threats", "terrain", "ceiling")},
    }
    if rng.random() < 0.5:
        spec["origin"] = vehicles[0]["home"]
    if wind:
        spec["wind"] = {"from_deg": round(rng.uniform(0, 359), 1), "speed_mps": wind}
    path.write_text(json.dumps(spec, indent=1))
    return path, files


def obstacles(rng, fleet):
    """Threats anywhere, and masts next to the places of the missions, which show how far off its legs each is judged."""
    found = [(rng.uniform(SOUTH, NORTH), rng.uniform(WEST, EAST), rng.uniform(50, 1200)) for _ in range(rng.integers(2, 6))]
    for vehicle, rows in fleet:
        for row in rows[2:]:
            near = moved((row[4], row[5]), rng.uniform(-3.1, 3.1), rng.uniform(20, 300))
            found.append((*near, 2.0))
        if "takeoff_heading_deg" in vehicle:
            home, course = (vehicle["home"]["lat"], vehicle["home"]["lon"]), math.radians(vehicle["takeoff_heading_deg"])
            for far in rng.uniform(300, 1500, 2):
                found.append((*moved(moved(home, course, far), course + math.pi / 2, rng.uniform(-250, 250)), 2.0))
    threats = []
    for lat, lon, radius in found:
        # The spec is refused where a VTOL may be after its climb, and where a vehicle begins or ends.
        ends = [(vehicle["home"], ROOM_M.get((vehicle["airframe"], vehicle["autopilot"]), 60)) for vehicle, _ in fleet]
        ends += [(vehicle[key], 60) for vehicle, _ in fleet for key in ("start", "goal")]
        if all(distance((lat, lon), (end["lat"], end["lon"])) > radius + far for end, far in ends):
            name = f"threat-{len(threats)}"
            threats.append({"id": name, "lat": round(float(lat), 6), "lon": round(float(lon), 6), "radius_m": round(float(radius), 1)})
    return threats


def begin(rng, vehicle, home, heading, base):
    """The home row and the takeoff, and from where the way goes on."""
    rise = round(rng.uniform(60, 200), 1)
    rows = [(0, WAYPOINT, 0, 0, *home, round(base, 2))]
    ardupilot, at = vehicle["autopilot"] == "ardupilot", home
    z = rise if ardupilot else round(base + rise, 2)
    if vehicle["airframe"] == "plane":
        vehicle["takeoff_heading_deg"] = heading
        at = moved(home, math.radians(heading), rng.uniform(1200, 2500))
        rows.append((3 if ardupilot else 0, TAKEOFF, 0, 0, *(home if ardupilot else at), z))
    else:
        rows.append((3 if ardupilot else 0, VTOL_TAKEOFF, 0, 0, *home, z))
    return rows, at


def fly_to(rng, vehicle, at, z, base, circles, agl):
    """Mostly past a place, else around it."""
    ardupilot = vehicle["autopilot"] == "ardupilot"
    if ardupilot and rng.random() < FOLLOWS_SHARE:
        return (10, WAYPOINT, 0, 0, *at, round(max(agl, 20.0), 2))
    frame, z = (3, round(z - base, 2)) if ardupilot and rng.random() < 0.3 else (0, round(z, 2))
    radius = float(round(vehicle["loiter_radius_m"] * rng.uniform(0.8, 1.5))) * rng.choice([-1, 1])
    kind = rng.random() if circles else 0.0
    if kind < 0.85:
        return (frame, WAYPOINT, 0, 0, *at, z)
    if kind < 0.90:
        return (frame, TO_ALT, 0, radius, *at, z)
    if ardupilot and kind < 0.95:
        return (frame, TURNS, 2, 0, *at, z, radius)
    return (frame, HOLD, 30, 0, *at, z, radius)


def end(rng, vehicle, rows, at, course, ground):
    """A landing, a circle for ever, or nothing."""
    kind, plane, ardupilot = rng.random(), vehicle["airframe"] == "plane", vehicle["autopilot"] == "ardupilot"
    vehicle["finish"] = "loiter"  # the rest of the contract is not compared
    if kind < 0.5:
        down = moved(at, course, rng.uniform(500, 1500) if plane else 300)
        if plane:  # a glide begins above the ground where it ends
            high = max(float(ground.height(*at)), float(ground.height(*down))) + rng.uniform(35, 120)
            at = moved(at, course, 120)
            rows.append((0, WAYPOINT, 0, 0, *at, round(high, 2)))
        rows.append((0, LAND if plane else VTOL_LAND, 0, 0, *down, round(float(ground.height(*down)), 2)))
    elif kind < 0.75:
        radius = vehicle["loiter_radius_m"] * rng.choice([-1, 1])
        far = moved(at, course, rng.uniform(50, 800))
        rows.append((0, STAY, 0, 0, *far, round(float(ground.height(*far)) + rng.uniform(40, 200), 2), radius))
    elif ardupilot and kind < 0.9:
        rows.append((3, RETURN, 0, 0, 0, 0, 0))


def write_params(rng, path, vehicle):
    radius = vehicle["loiter_radius_m"]
    if vehicle["autopilot"] == "px4":
        some = {"NPFG_PERIOD": round(rng.uniform(8, 14), 1), "NPFG_DAMPING": round(rng.uniform(0.6, 0.9), 2),
                "NAV_ACC_RAD": float(rng.integers(2, 40)), "FW_R_LIM": float(rng.integers(30, 50))}
        rows = [f"1\t1\tNAV_LOITER_RAD\t{radius}\t9"]
        rows += [f"1\t1\t{name}\t{value:g}\t9" for name, value in some.items() if rng.random() < 0.5]
    else:
        some = {"NAVL1_PERIOD": round(rng.uniform(14, 22), 1), "NAVL1_DAMPING": round(rng.uniform(0.7, 0.85), 2),
                "WP_RADIUS": float(rng.integers(20, 100)), "ROLL_LIMIT_DEG": float(rng.integers(30, 50)),
                "ALT_SLOPE_MIN": float(rng.integers(0, 20)), "NAVL1_LIM_BANK": float(rng.integers(0, 45))}
        rows = [f"{name},{value:g}" for name, value in some.items() if rng.random() < 0.5]
        rows += [f"WP_LOITER_RAD,{radius}", f"RTL_ALTITUDE,{rng.integers(60, 200)}"]
    path.write_text("\n".join(rows) + "\n")
