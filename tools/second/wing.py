"""The flight of a plane or VTOL judged in space, by the texts of src/verify/mod.rs and src/verify/execute/wing/mod.rs."""

import math
from dataclasses import dataclass, replace

import numpy as np

from .circles import Circles
from .climb_out import ClimbOut, WingKnot, course
from .earth import A, E2, axes, distance, ecef, geodetic
from .flight import DELAY, G, HOLD, LAND, RETURN, SAME_M, SPEED, STAY, STOP_LATE, TAKEOFF, TO_ALT, WAYPOINT, Flight, Knot
from .l1 import STEP_S, WAY_M, Law, Px4Law, air_ratio
from .shapes import Arc, Height, Line

TURNS, VTOL_TAKEOFF, VTOL_LAND = 18, 84, 85
# From so far on PX4 turns the nose of a VTOL to the place of its takeoff, metres.
LEAST_AHEAD = 20.0
ARDUPILOT_LAG_S, PX4_LAG_S = 3.3, 3.5
# Above legs that come down from a climb on rotors (ArduPilot).
TRANSITION_LAG_S = 17.0
# Between a leg and the line off it.
BETWEEN_M = 20.0
OFF_M = 0.01  # less than this is no offset
SMALL_CLIMB_M = 15.0


def read_params(path):
    """The parameters beside a `.waypoints` file, of either autopilot."""
    beside = path.with_name(path.name.split(".")[0] + ".params")
    rows = [line.replace(",", " ").split() for line in beside.read_text().splitlines()] if beside.exists() else []
    named = [row[2:4] if row[0].isdigit() else row[:2] for row in rows if row and row[0] != "#"]
    return {name: float(value) for name, value in named}


@dataclass
class Behind:
    """Of a leg behind: its rate (none of a climb-out), the lag that it leaves, its highest altitude, and how long ago it ended."""

    rate: float
    left: float
    high: float
    ago: float = 0.0


class Plane:
    """East and north in the plane that touches the earth at a place; each is the other way of the other."""

    def __init__(self, at):
        self.touches, (self.east, self.north) = ecef(*at), axes(*at)
        self.up = np.cross(self.east, self.north)

    def flat(self, at):
        off = ecef(*at) - self.touches
        return np.array([off @ self.east, off @ self.north])

    def places(self, flat):
        """Latitudes and longitudes of what is straight below points of the plane on the ellipsoid, not of their feet on
        it: at a distance `d` these are `d^3 / 2 R^2` further in, 4 cm at 15 km."""
        x = self.touches + flat[..., :1] * self.east + flat[..., 1:] * self.north
        scale = np.array([A, A, A * math.sqrt(1 - E2)])
        p, d = x / scale, self.up / scale
        half, rest = p @ d, (p * p).sum(axis=-1) - 1
        down = (np.sqrt(half**2 - d @ d * rest) - half) / (d @ d)
        return geodetic(x + down[..., None] * self.up)

    def place(self, flat):
        lat, lon = self.places(np.asarray(flat))
        return float(lat), float(lon)


class WingFlight(ClimbOut, Circles, Flight):
    def __init__(self, vehicle, items, ground, spec, params, origin):
        self.plane, self.params = Plane(origin), params
        self.wind = spec.get("wind")
        buffers = spec.get("buffer_m", {})
        self.min_agl = spec["area"]["min_agl_m"] + buffers.get("terrain", buffers.get("all", 0))
        # A bank below the planned one makes wider turns.
        bank = math.radians(params.get("ROLL_LIMIT_DEG", params.get("FW_R_LIM", 89.0)))
        n = min(vehicle["max_load_factor"], 1 / math.cos(bank))
        self.lateral = G * math.sqrt(n * n - 1)
        self.fastest = self.most(vehicle["speed_mps"], spec["area"]["max_amsl_m"])
        self.turn_radius = self.fastest**2 / self.lateral
        ardupilot = vehicle["autopilot"] == "ardupilot"
        self.lag = ARDUPILOT_LAG_S if ardupilot else PX4_LAG_S
        small = params.get("ALT_SLOPE_MIN", params.get("GLIDE_SLOPE_MIN", SMALL_CLIMB_M))
        self.small = 0.0 if not ardupilot else math.trunc(small) or math.inf
        self.law = Law(params, n) if ardupilot else Px4Law(params, n, self.wind is not None)
        self.moving, self.early_top, self.hull, self.short, self.bent = 0.0, None, None, 0, 0.0
        self.onto_circle = False
        self.down = self.lag
        super().__init__(vehicle, items, ground, 0.0)

    def most(self, speed, amsl):
        return speed * air_ratio(amsl) + (self.wind["speed_mps"] if self.wind else 0.0)

    def over_ground(self, speed, amsl, clockwise):
        air = speed * air_ratio(amsl)
        if not self.wind:
            return air
        off = clockwise - math.radians(self.wind["from_deg"])
        return math.sqrt(air**2 - (self.wind["speed_mps"] * math.sin(off)) ** 2) - self.wind["speed_mps"] * math.cos(off)

    def flat(self, knot):
        return self.plane.flat(knot.at)

    def lay(self, a, b, low, high, slope_from=None, follows=False):
        """A straight line to be judged in space, between places of the plane."""
        line = Line(self.plane.place(a), self.plane.place(b), Height(follows, low, high), slope_from)
        (self.judged if slope_from is None else self.slopes).append(line)

    def lay_at(self, a, b, height, shares, slope_from=None):
        """The same at the altitudes of a part of a leg."""
        for (s, low), (t, high) in height.parts(*shares):
            self.lay(a + (b - a) * s, b if t == 1 else a + (b - a) * t, low, high, slope_from, height.follows)

    def fly(self, items):
        vtol = self.vehicle["airframe"] == "vtol"
        for i, item in enumerate(items):
            command = item["command"]
            if command == SPEED:
                self.speed = item["param2"]
            elif command == DELAY:
                pass
            elif command == TAKEOFF and not vtol:
                self.climb_out(item)
            elif command == VTOL_TAKEOFF and vtol:
                self.rise(item)
            elif command == WAYPOINT:
                self.pass_by(item)
            elif command == STAY:
                return self.stay(item["at"], self.resolve(item, item["at"])[0], item["param3"])
            elif command in (TURNS, HOLD, TO_ALT):
                self.circle_a_while(item, items[i + 1] if i + 1 < len(items) else None)
            elif command == LAND and not vtol:
                return self.glide(item)
            elif command == VTOL_LAND and vtol:
                self.append(WingKnot(item["at"], self.knots[-1].amsl, None, self.speed))
                return self.descend()
            elif command == RETURN:
                return self.go_home()
            else:
                raise ValueError(f"command {command}")
        if self.ardupilot:
            return self.go_home()
        last = self.knots[-1]
        self.legs(last.speed)
        self.stay(last.at, last.amsl, self.params["NAV_LOITER_RAD"])

    def pass_by(self, item):
        self.append(WingKnot(item["at"], *self.resolve(item, item["at"]), self.speed))

    def go_home(self):
        """ArduPlane: a circle over home."""
        last, amsl = self.knots[-1], self.home.amsl + self.params["RTL_ALTITUDE"]
        home = self.flat(self.home)
        if last.amsl < amsl:
            for at in [self.flat(last), *self.turned_off(home)]:
                for level in (last.amsl, amsl):
                    self.lay(at, home, level, level)
        self.stay(self.home.at, amsl, self.params["WP_LOITER_RAD"])

    def glide(self, item):
        ground = float(self.ground.height(*item["at"]))
        last = self.knots[-1]
        down = WingKnot(item["at"], ground, None, self.speed, slope_from=ground)
        parts = self.in_two(replace(down, slope_from=None), replace(last, slope_from=None), ground)
        if len(parts) == 2:
            self.append(replace(parts[0], speed=self.speed, slope_from=None, takeoff=False))
        self.append(down)
        self.legs(self.speed)

    def rise(self, item):
        """On rotors, straight up: ArduPlane by the altitude of the item, whatever its frame."""
        z = float(np.float32(item["z"]))
        amsl = self.home.amsl + math.trunc(z * 100) / 100 if self.ardupilot else self.resolve(item, self.home.at)[0]
        self.knots = [WingKnot(self.home.at, self.home.amsl)]
        self.lift(amsl)
        self.late += self.slow_takeoff()
        self.knots, self.moving = [WingKnot(self.home.at, amsl)], 0.0
        if self.ardupilot:
            self.down = TRANSITION_LAG_S
        ahead = 0.0 if self.ardupilot else distance(item["at"], self.home.at)
        if ahead < LEAST_AHEAD:
            self.region(amsl)
        else:
            self.append(WingKnot(item["at"], amsl, None, self.speed))

    def descend(self):
        """On rotors; a QuadPlane that comes with the wind from behind is driven off."""
        far = [(a, b) for a, b in zip(self.knots, self.knots[1:]) if distance(a.at, b.at) > 1.0]
        self.legs(0.0)
        top, first = self.knots[-1].amsl, len(self.motions)
        self.touch_down()
        if self.ardupilot:
            self.overshoot_landing(self.flat(self.knots[-1]), top, first)
        if far and self.wind and self.ardupilot:
            clockwise = course(*(self.flat(knot) for knot in far[-1]))
            if math.cos(clockwise - math.radians(self.wind["from_deg"])) < 0:
                self.driven(self.flat(self.knots[-1]), self.knots[-1].amsl, top)

    @property
    def undecided(self):
        """Half a turn radius, metres, where a VTOL turns back: other steps of the integration bring the verdict nearer."""
        return self.turn_radius / 2 if self.law.turns_back and self.vehicle["airframe"] == "vtol" else 0.0

    def append(self, knot):
        if distance(knot.at, self.knots[-1].at) > 0.025:
            self.knots.append(knot)
        else:
            assert abs(knot.amsl - self.knots[-1].amsl) < 0.025, "a climb on the spot, on a wing"

    def legs(self, last_speed):
        """Flies the legs so far, and has a speed at the last knot."""
        knots, self.knots, first_speed = self.knots, self.knots[-1:], self.moving
        self.arrival, self.still = [], (0.0, 0.0)
        if len(knots) < 2:
            return
        self.moving = last_speed
        flat = [self.flat(knot) for knot in knots]
        legs = [Line(a.at, b.at, self.height(a, b), b.slope_from) for a, b in zip(knots, knots[1:])]
        for leg in legs:
            (self.judged if leg.slope_from is None else self.slopes).append(leg)
        lengths = [leg.length for leg in legs]
        cruise = [self.over_ground(b.speed, (a.amsl + b.amsl) / 2, course(p, q))
                  for a, b, p, q in zip(knots, knots[1:], flat, flat[1:])]
        if self.law and len(knots) > 2:
            self.steep = max([self.steep] + [abs(leg.height.end - leg.height.start) / leg.length for leg in legs])
            self.note_short([leg.length < self.law.ahead(v) for leg, v in zip(legs, cruise)])
        half, taken = self.corners(knots, legs)
        first, last = first_speed * cruise[0] / knots[1].speed, last_speed * cruise[-1] / knots[-1].speed
        passing = self.passing_wing(cruise, lengths, taken, (first, last))
        times, firsts = [], []
        for i, leg in enumerate(legs):
            begin = self.t
            firsts.append(len(self.motions))
            self.straight(leg, taken[i], lengths[i] - taken[i + 1], passing[i][1], passing[i + 1][0], cruise[i])
            if i + 1 < len(legs) and taken[i + 1] > 0:
                self.round(knots[i : i + 3], legs[i : i + 2], half[i + 1], taken[i + 1], passing[i + 1])
            times.append(self.t - begin)
        if last_speed <= 0:
            self.motions[-1].late += STOP_LATE
        heights = self.offsets(knots, legs, times)
        self.down = self.lag
        for leg, others in zip(legs, heights):
            for height in others[1:]:
                self.judged += lines_along(leg, height)
        if not self.ardupilot:
            self.early(knots, legs)
        if self.law:
            self.leave_early(flat, knots, heights, cruise)
        if self.law and len(knots) > 2:
            for fixes in self.law.both(lambda law: law.follow(flat, [knot.amsl for knot in knots], cruise, self.wind)):
                self.lay_way(flat, knots, heights, fixes)
        self.leave_hull(flat, knots, heights, cruise, [*firsts, len(self.motions)])
        self.late += 0.0 if last_speed > 0 else STOP_LATE

    def along(self, origin):
        """Arcs of near reversals are long, and longer by much for an angle that the verdict's plane has different."""
        return super().along(origin) + 2 * (self.furthest(origin) / A) ** 2 * self.bent

    def note_short(self, are_short):
        """The most legs in a row on which it is still in the turn before, so that a step of that counts again."""
        row = 0
        for is_short in are_short:
            row = row + 1 if is_short else 0
            self.short = max(self.short, row)

    def height(self, a, b):
        if b.agl is None:
            return Height(False, a.amsl, b.amsl)
        self.follows = True
        return Height(True, a.amsl - float(self.ground.height(*a.at)), b.agl)

    def corners(self, knots, legs):
        half, needed = [0.0] * len(knots), [0.0] * len(knots)
        for i in range(1, len(knots) - 1):
            sweep = Arc(knots[i].at, knots[i - 1].at, knots[i + 1].at, 1.0, 0.0, None).sweep
            half[i] = min(abs(sweep) / 2, math.radians(89.9))
            v = self.most(max(knots[i].speed, knots[i + 1].speed), knots[i].amsl)
            needed[i] = v * v / self.lateral * math.tan(half[i])
            self.bent += v * v / self.lateral / (2 * math.cos(half[i]) ** 2)
        taken = list(needed)
        for i, leg in enumerate(legs):
            both = needed[i] + needed[i + 1]
            if both > 0.99 * leg.length:
                for k in (i, i + 1):
                    taken[k] = min(taken[k], needed[k] * 0.99 * leg.length / both)
        return half, taken

    def passing_wing(self, cruise, lengths, taken, ends):
        """Speeds into each knot and out of it: the wind carries a wing from one leg's to the other's."""
        pairs = list(zip(cruise, cruise[1:]))
        inner = pairs if self.wind else [(min(pair), min(pair)) for pair in pairs]
        speeds = [(ends[0], ends[0]), *inner, (ends[1], ends[1])]
        free = [length - a - b for length, a, b in zip(lengths, taken, taken[1:])]
        reach = lambda v, i: math.sqrt(v * v + 2 * self.vehicle["accel_mps2"] * free[i])
        for i in range(len(free)):
            most = reach(speeds[i][1], i)
            if speeds[i + 1][0] > most:
                speeds[i + 1] = most, min(speeds[i + 1][1], most)
        for i in reversed(range(len(free))):
            most = reach(speeds[i + 1][0], i)
            if speeds[i][1] > most:
                speeds[i] = min(speeds[i][0], most), most
        return speeds

    def round(self, knots, legs, half, taken, speeds):
        both = all(leg.height.follows for leg in legs)
        ends = []
        for leg, s in ((legs[0], 1 - taken / legs[0].length), (legs[1], taken / legs[1].length)):
            value = leg.height.start + (leg.height.end - leg.height.start) * s
            ends.append(value + float(self.ground.height(*leg.place(s))) if leg.height.follows and not both else value)
        before, corner, after = (knot.at for knot in knots)
        shape = Arc(corner, before, after, taken / math.tan(half), taken, Height(both, *ends))
        shape.slope_from = legs[0].slope_from
        if half > 1e-6 and shape.length > 1e-9:
            (self.judged if shape.slope_from is None else self.slopes).append(shape)
            self.move(shape, (0.0, 1.0), speeds, shape.length)

    def offsets(self, knots, legs, times):
        """For each leg its own altitudes, those of its end where it climbs little, and those of the lag."""
        behind, found = [], []
        for a, b, leg, lasts in zip(knots, knots[1:], legs, times):
            heights, rise, follows = [leg.height], leg.height.end - leg.height.start, leg.height.follows
            found.append(heights)
            if b.slope_from is None and abs(rise) < self.small:
                heights.append(Height(follows, leg.height.end, leg.height.end))
            rate = rise / max(lasts, 1e-9)
            # Of what it climbs over followed ground nothing is known.
            lag = self.down if rise < 0 else self.lag
            left = math.inf if follows else math.copysign(min(abs(rise), lag * abs(rate)), rise)
            high = math.inf if follows else max(a.amsl, b.amsl)
            if b.slope_from is not None or follows:
                rate, behind = None, [replace(of, rate=None) for of in behind]
            else:
                below, above, top = self.lagging(behind, rate, left, high)
                for off in (-below, above):
                    steps = math.ceil(abs(off) / BETWEEN_M) if abs(off) > OFF_M else 0
                    heights += [Height(False, leg.height.start + off * n / steps, leg.height.end + off * n / steps, top)
                                for n in range(1, steps + 1)]
            if self.onto_circle and not self.ardupilot and b is knots[-1] and not follows:
                heights += self.at_once(leg.height, lasts)
            behind = [replace(of, ago=of.ago + lasts) for of in behind] + [Behind(rate, left, high)]
            if rise >= 0 and lasts > 2 * self.down:
                self.down = self.lag
        below, above, top = self.lagging(behind, 0.0, 0.0, knots[-1].amsl)
        self.arrival, self.still = found[-1][1:], (below, min(above, top - knots[-1].amsl))
        return found

    def at_once(self, height, lasts):
        """PX4 follows no slope to a circle: it climbs or descends as fast as it does, and those between that and the slope."""
        rise = height.end - height.start
        share = abs(rise) / self.vehicle["climb_mps" if rise > 0 else "descent_mps"] / max(lasts, 1e-9)
        if abs(rise) < OFF_M or share >= 1:
            return []
        steps = min(max(math.ceil((1 - share) * abs(rise) / BETWEEN_M), 1), 20)
        ends = {"top": height.end} if rise > 0 else {"bottom": height.end}
        return [Height(False, height.start, height.start + rise / (1 - n / steps * (1 - share)), **ends)
                for n in range(1, steps + 1)]

    def lagging(self, behind, rate, left, high):
        """How far below and above its altitudes it is on a leg, and how high at most."""
        up, down = ([of for of in behind if of.ago < 2 * lag] for lag in (self.lag, self.down))
        last = [of.rate for of in behind[-1:] if of.rate is not None]
        steepest = -min([rate, 0.0] + [of.rate for of in down if of.rate is not None])
        lefts = [[left] + [of.left for of in ones] for ones in (up, down)]
        below = min(self.lag * max([rate, 0.0] + last), math.inf if math.inf in lefts[0] else sum(m for m in lefts[0] if m > 0))
        above = min(self.down * steepest, math.inf if math.inf in lefts[1] else -sum(m for m in lefts[1] if m < 0))
        return below, above, max([high] + [of.high for of in down]) + self.lag * steepest

    def early(self, knots, legs):
        """PX4: at the altitude of a place a loiter radius before it."""
        radius = max(self.vehicle["loiter_radius_m"], self.params.get("NAV_LOITER_RAD", 0.0))
        for a, b, leg in zip(knots, knots[1:], legs):
            if b.slope_from is not None:
                continue
            share = max(0.0, 1 - radius / leg.length)
            there = tuple(map(float, leg.place(share)))
            if share > 0 and distance(a.at, there) > OFF_M:
                self.judged.append(Line(a.at, there, Height(False, a.amsl, b.amsl)))
            self.judged.append(Line(there, b.at, Height(False, b.amsl, b.amsl)))

    def lay_way(self, flat, knots, heights, way):
        """The way of the law, each half second of it at the altitudes of the leg that it follows at its end."""
        for (a, b, leg, aside) in way:
            if aside < WAY_M:
                continue
            self.loose = max(self.loose, (2 + self.short) * STEP_S * self.fastest)
            p, q = flat[leg], flat[leg + 1]
            shares = [float(np.clip((x - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)) for x in (a, b)]
            for height in heights[leg]:
                self.lay_at(a, b, height, shares, knots[leg + 1].slope_from)


def lines_along(leg, height):
    for (s, low), (t, high) in height.parts():
        line = Line.__new__(Line)
        (line.start, line.end), line.length = (leg.xyz(u) for u in (s, t)), leg.length * (t - s)
        line.height, line.slope_from = Height(height.follows, low, high), None
        yield line
