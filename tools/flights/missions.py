"""Random missions: a spec of one vehicle, from its kind and a seed."""

import json
import math
import random

# Where the ground of the simulators is flat at the height of home.
LAT, LON, HOME_AMSL_M = -35.3633, 149.1600, 584.0
KINDS = {
    "copter": ("ardupilot", "copter"),
    # Corners of 15 to 140 degrees, written over the planned items.
    "zigzag": ("ardupilot", "copter"),
    "plane": ("ardupilot", "plane"),
    # Lands on a course that is found for it.
    "plane-land": ("ardupilot", "plane"),
    # Turns off its takeoff course at the end of its climb.
    "plane-turn": ("ardupilot", "plane"),
    "quadplane": ("ardupilot", "vtol"),
    "px4-copter": ("px4", "copter"),
    "px4-plane": ("px4", "plane"),
    "px4-vtol": ("px4", "vtol"),
}
WINDS_MPS = [0, 2, 4, 5, 6, 8]
# `check` fails these in more wind.
MOST_WIND_MPS = {"vtol": 4, "plane": 6}
# The greatest speed through the air that `check` allows a copter, less a little.
COPTER_AIRSPEED_MPS = {"ardupilot": 13.0, "px4": 10.2}

# PX4's own simulated wings fly 14 m/s (plane) and 12 m/s (VTOL) at full thrust, stall at 7 to 8.
WING_SPEEDS_MPS = {
    ("ardupilot", "plane"): [16, 18, 20], ("ardupilot", "vtol"): [16, 18, 20], ("px4", "plane"): [11, 12, 13],
    ("px4", "vtol"): [9, 10, 11],
}


def place(east_m, north_m):
    """Latitude and longitude of a place around the middle."""
    return {
        "lat": round(LAT + north_m / 110_950.0, 7),
        "lon": round(LON + east_m / (111_320.0 * math.cos(math.radians(LAT))), 7),
    }


def polar(distance_m, course_deg):
    course = math.radians(course_deg)
    return distance_m * math.sin(course), distance_m * math.cos(course)


def between(start, goal, share, aside_m):
    """A place at a share of the way from one to another, moved sideways."""
    along = goal[0] - start[0], goal[1] - start[1]
    length = math.hypot(*along)
    return (
        start[0] + share * along[0] - aside_m * along[1] / length,
        start[1] + share * along[1] + aside_m * along[0] / length,
    )


def make(kind, seed):
    """The spec and the wind.

    Every figure is drawn in one order, so that a seed means the same mission for ever.
    """
    rng = random.Random(f"{kind} {seed}")
    autopilot, airframe = KINDS[kind]
    wind = {"from_deg": rng.randrange(0, 360, 5), "speed_mps": rng.choice(WINDS_MPS)}
    if kind == "plane-land":
        # Without wind there is no such course.
        wind["speed_mps"] = max(wind["speed_mps"], 2)
    wind["speed_mps"] = min(wind["speed_mps"], MOST_WIND_MPS.get(airframe, wind["speed_mps"]))
    # PX4's simulated plane stands with its nose to the north, and takes off that way.
    course_deg = rng.uniform(0, 360) * (kind != "px4-plane")
    draw = corners if kind == "zigzag" else copter if airframe == "copter" else wing
    vehicle, start, goal = draw(rng, autopilot, airframe, course_deg, wind["speed_mps"])
    if kind == "plane-land":
        vehicle["finish"], vehicle["landing"] = "land", {"glide_deg": rng.choice([4, 5, 6])}
    if kind == "plane-turn":
        turn_off(rng, vehicle, start, goal)
    if kind == "zigzag":
        return with_area(kind, seed, vehicle, [], [], wind, ("relative", 5)), wind
    ways = [between(start, goal, rng.uniform(0.3, 0.7), rng.uniform(-60, 60)) for _ in range(rng.randint(0, 2))]
    radius_m = (20, 60) if airframe == "copter" else (100, 200)
    threats = [
        {"id": f"mast-{n}", "kind": "mast", **place(*at), "radius_m": round(rng.uniform(*radius_m))}
        for n, at in enumerate(ways)
    ]
    hills = [
        {**place(*between(start, goal, rng.uniform(0.25, 0.75), rng.uniform(-150, 150))),
         "height_m": round(rng.uniform(8, 30) if airframe == "copter" else rng.uniform(10, 60)),
         "radius_m": round(rng.uniform(200, 300))}
        for _ in range(rng.randint(0, 2))
    ]
    # Where it lands the simulator has its ground.
    hills = [] if vehicle["finish"] == "land" and airframe == "copter" or "stops" in vehicle else hills
    mission = rng.choice(["amsl", "relative"]), rng.choice([2, 5])
    return with_area(kind, seed, vehicle, threats, hills, wind, mission), wind


def nose_deg(kind, seed, vehicle):
    """Where the nose points on the ground: a plane's along its takeoff, any other's anywhere."""
    return vehicle.get("takeoff_heading_deg", random.Random(f"nose {kind} {seed}").randrange(0, 360, 5))


def with_area(kind, seed, vehicle, threats, hills, wind, mission):
    half_m = 1500 if vehicle["airframe"] == "copter" else 6000 if kind == "plane-land" else 3500
    spec = {
        "sortie": 2,
        "name": f"{kind}-{seed}",
        "area": {"south_west": place(-half_m, -half_m), "north_east": place(half_m, half_m), "min_agl_m": 25,
                 "max_amsl_m": HOME_AMSL_M + 300},
        "terrain": {"analytic": {"base_amsl_m": HOME_AMSL_M, "hills": hills}},
        "threats": threats,
        "vehicles": [vehicle],
        "planner": {"seed": seed, "evaluations": 4000},
        "mission": {"altitude": mission[0], "tolerance_m": mission[1], "fence": False},
    }
    return {**spec, "wind": wind} if wind["speed_mps"] else spec


def copter(rng, autopilot, airframe, course_deg, wind_mps):
    length_m = rng.uniform(450, 900)
    start, goal = polar(30, course_deg), polar(length_m, course_deg)
    fastest = COPTER_AIRSPEED_MPS[autopilot] - wind_mps
    vehicle = {
        "id": "v", "sysid": 1, "autopilot": autopilot, "airframe": airframe, "link": "sim",
        "home": place(*start),
        "start": {**place(*start), "agl_m": rng.randint(45, 60)},
        "goal": {**place(*goal), "agl_m": rng.randint(45, 70)},
        "finish": rng.choice(["land", "land", "return", "loiter"]),
        "speed_mps": round(rng.uniform(4, min(10, fastest)), 1),
        "max_climb_deg": rng.randint(12, 25), "max_descent_deg": rng.randint(10, 20),
        "climb_mps": round(rng.uniform(2, 4), 1), "descent_mps": round(rng.uniform(1.5, 3), 1),
        "accel_mps2": rng.choice([1.5, 2.5, 2.5]),
    }
    stops = [
        {"id": f"s{n}", **place(*between(start, goal, (n + 1) / 3, rng.uniform(-150, 150))),
         "agl_m": rng.randint(50, 65), "hold_s": rng.choice([0, 0, 5])}
        for n in range(rng.randint(0, 2))
    ]
    if stops:
        vehicle["stops"] = stops
    return vehicle, start, goal


def corners(rng, autopilot, airframe, course_deg, wind_mps):
    """A walk of legs with corners between them; `zigzag` holds its places."""
    fastest = COPTER_AIRSPEED_MPS[autopilot] - wind_mps
    speed_mps, accel_mps2 = round(rng.uniform(3, min(10, fastest)), 1), rng.choice([1.5, 2.5, 2.5])
    angles = [rng.uniform(15, 140) for _ in range(rng.randint(7, 10))]
    # What the turns take of each leg must be there.
    taken_m = [0.0] + [speed_mps**2 / accel_mps2 * math.tan(math.radians(a) / 2) for a in angles] + [0.0]
    at, walk, side = (0.0, 0.0), [(0.0, 0.0, 50)], 1
    for n in range(len(angles) + 1):
        length_m = max(rng.uniform(50, 130), 1.05 * (taken_m[n] + taken_m[n + 1]))
        step = polar(length_m, course_deg)
        at = at[0] + step[0], at[1] + step[1]
        walk.append((*at, 50 + rng.choice([0, 0, rng.uniform(-0.05, 0.05) * length_m])))
        # Mostly from side to side, so that it stays in the area.
        side = -side if rng.random() < 0.8 else side
        course_deg += side * angles[n] if n < len(angles) else 0.0
    middle = [sum(p[k] for p in walk) / len(walk) for k in (0, 1)]
    walk = [(p[0] - middle[0], p[1] - middle[1], p[2]) for p in walk]
    start, goal = walk[0][:2], walk[-1][:2]
    vehicle = {
        "id": "v", "sysid": 1, "autopilot": autopilot, "airframe": airframe, "link": "sim",
        "home": place(*start), "start": {**place(*start), "agl_m": walk[0][2]},
        "goal": {**place(*goal), "agl_m": round(walk[-1][2], 2)}, "finish": rng.choice(["land", "loiter"]),
        "speed_mps": speed_mps, "max_climb_deg": 20, "max_descent_deg": 15,
        "climb_mps": 3, "descent_mps": 2.5, "accel_mps2": accel_mps2,
    }
    vehicle["zigzag"] = walk
    return vehicle, start, goal


def zigzag(rows, walk):
    """The rows of a `.waypoints` file with the places of a walk in place of the planned ones."""
    fields = [row.split("\t") for row in rows]
    first = next(n for n, row in enumerate(fields) if n and row[3] == "16")
    last = max(n for n, row in enumerate(fields) if row[3] in ("16", "17"))
    written = []
    for east_m, north_m, up_m in walk[1:-1]:
        at = place(east_m, north_m)
        written.append([*fields[first][:8], f"{at['lat']:.7f}", f"{at['lon']:.7f}", f"{up_m:.2f}", "1"])
    # The item at the start itself stays, if there is one.
    here = place(*walk[0][:2])
    is_start = abs(float(fields[first][8]) - here["lat"]) + abs(float(fields[first][9]) - here["lon"]) < 1e-6
    made = fields[: first + is_start] + written + fields[last:]
    return ["\t".join([str(n), *row[1:]]) for n, row in enumerate(made)]


def wing(rng, autopilot, airframe, course_deg, wind_mps):
    length_m = rng.uniform(1400, 2400)
    start, goal = polar(400, course_deg), polar(400 + length_m, course_deg + rng.uniform(-25, 25))
    is_plane = airframe == "plane"
    speed_mps = rng.choice(WING_SPEEDS_MPS[autopilot, airframe])
    # No tighter than it turns with the wind behind it, through thinner air.
    turn_m = (1.06 * speed_mps + wind_mps) ** 2 / (9.80665 * math.sqrt(1.2**2 - 1))
    vehicle = {
        "id": "v", "sysid": 1, "autopilot": autopilot, "airframe": airframe, "link": "sim",
        "start": {**place(*start), "agl_m": 80},
        "goal": {**place(*goal), "agl_m": rng.randint(80, 120)},
        "finish": "loiter" if is_plane else rng.choice(["land", "land", "loiter"]),
        "loiter_radius_m": max(80, 5 * math.ceil(turn_m / 5)), "speed_mps": speed_mps, "max_load_factor": 1.2,
        "max_climb_deg": rng.randint(5, 10), "max_descent_deg": rng.randint(4, 8),
        "climb_mps": round(rng.uniform(2.5, 4), 1), "descent_mps": round(rng.uniform(2, 3), 1),
    }
    if is_plane:
        # It climbs straight to its start.
        home = polar(400 - 560, course_deg)
        vehicle["home"] = place(*home)
        vehicle["takeoff_heading_deg"] = round(course_deg, 1)
    return vehicle, start, goal


def turn_off(rng, vehicle, start, goal):
    """Has a plane take off on another course than that of its first leg, which is the way from start to goal about."""
    course_deg = math.degrees(math.atan2(goal[0] - start[0], goal[1] - start[1]))
    leg, takeoff_deg = polar(rng.uniform(250, 700), course_deg), course_deg + rng.choice([-1, 1]) * rng.uniform(20, 130)
    off = polar(560, takeoff_deg)
    vehicle["home"] = place(start[0] - leg[0] - off[0], start[1] - leg[1] - off[1])
    vehicle["takeoff_heading_deg"] = round(takeoff_deg % 360, 1)


def text(spec):
    """As YAML, of which JSON is a part."""
    vehicles = [{key: value for key, value in of.items() if key != "zigzag"} for of in spec["vehicles"]]
    return json.dumps({**spec, "vehicles": vehicles}, indent=1)
