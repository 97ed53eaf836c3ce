"""One vehicle's flight, by the flight model in the text of src/verify/mod.rs."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .earth import A, distance, ecef
from .shapes import Arc, Height, Line, Motion, Point

G = 9.80665
SAME_M = 0.025
RISE_M = 0.02  # two altitudes in whole centimetres
SLOW_M = 10.0
# Seconds early and late from the takeoff on.
FROM_TAKEOFF = {
    ("ardupilot", "copter"): (0.0, 12.0), ("px4", "copter"): (0.0, 14.0), ("ardupilot", "plane"): (15.0, 0.0),
    ("px4", "plane"): (15.0, 0.0), ("ardupilot", "vtol"): (4.0, 12.0), ("px4", "vtol"): (0.0, 30.0),
}
STOP_LATE, PX4_LEG_LATE, PX4_CLIMB_LATE, CORNER_LATE, COUNTS_AFTER = 4.5, 1.5, 12.0, 0.2, 600.0
JERK, PX4_TURNING = 1.0, 0.5
# Change of course, degrees, and the seconds more than overlapping profiles take.
MORE_DEG = [0, 20, 30, 45, 60, 75, 90, 105, 120, 135, 150, 180]
MORE_S = [0, 0, -0.4, -0.4, -0.1, 0, 0.1, 0.2, 0.3, 0.4, 0.55, 0.8]
# PX4 1.17.0, flown: the same, and the seconds that a corner took more than the legs through its waypoint with 3 m/s2, by speed.
LOST_DEG = [0, 5, 10, 15, 20, 30, 45, 60, 75, 90, 105, 120, 150, 180]
LOST_S = {
    5.0: [0, 0.5, 0.5, 0.9, 1.1, 1.6, 2.2, 3.0, 3.7, 5.0, 5.1, 6.3, 6.7, 6.7],
    8.0: [0, 0.9, 1.0, 2.0, 2.1, 2.9, 3.7, 4.8, 5.4, 5.9, 6.9, 7.5, 8.0, 8.2],
    10.0: [0, 1.2, 1.7, 2.5, 3.1, 4.0, 4.9, 5.6, 6.2, 7.1, 7.9, 8.7, 9.8, 10.5],
}
WAYPOINT, STAY, HOLD, RETURN, LAND, TAKEOFF, TO_ALT, DELAY, SPEED = 16, 17, 19, 20, 21, 22, 31, 93, 178


def read_radius(path, ardupilot):
    """The acceptance radius that the parameters beside a `.waypoints` file set, or the default."""
    name, unit, default = ("WPNAV_RADIUS", 100, 200.0) if ardupilot else ("NAV_ACC_RAD", 1, 2.0)
    return read_parameter(path, name, default) / unit


def read_parameter(path, name, default):
    """A parameter in the file beside a `.waypoints` file."""
    beside = Path(path).with_name(Path(path).name.split(".")[0] + ".params")
    for line in beside.read_text().splitlines() if beside.exists() else []:
        fields = line.replace(",", " ").split()
        if name in fields:
            return float(fields[fields.index(name) + 1])
    return default


class Profile:
    """From rest to rest with limited acceleration and jerk."""

    def __init__(self, accel):
        self.accel, self.bend = accel, accel / JERK

    def ramp(self, v):
        """Seconds from rest to a speed."""
        return v / self.accel + self.bend if v >= self.accel * self.bend else 2 * math.sqrt(v / JERK)

    def distance(self, t):
        jerked = min(t, self.bend)
        return JERK * jerked**3 / 6 + (t - jerked) * (JERK * jerked**2 / 2 + self.accel * (t - jerked) / 2)

    def within(self, length):
        """The speed whose ramps up and down take a whole leg."""
        low, high = 0.0, 1000.0
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (middle, high) if middle * self.ramp(middle) < length else (low, middle)
        return low

    def overlap(self, v, half, radius):
        """Half of the time for which two legs overlap, and whether that is all of the ramp."""
        full = self.ramp(v) / 2
        if 2 * self.distance(full) * math.sin(half) <= radius:
            return full, True
        low, high = 0.0, full
        for _ in range(100):
            middle = (low + high) / 2
            near = 2 * self.distance(middle) * math.sin(half) < radius
            low, high = (middle, high) if near else (low, middle)
        return low, False


def read_items(path):
    """The rows of a `.waypoints` file."""
    items = []
    for line in Path(path).read_text().splitlines()[1:]:
        field = line.split("\t")
        at = round(float(field[8]) * 1e7) / 1e7, round(float(field[9]) * 1e7) / 1e7
        items.append(
            {"frame": int(field[2]), "command": int(field[3]), "param1": float(np.float32(field[4])),
             "param2": float(np.float32(field[5])), "param3": float(np.float32(field[6])), "at": at, "z": float(field[10])}
        )
    return items


@dataclass
class Knot:
    at: tuple
    amsl: float
    agl: float = None
    speed: float = 0.0
    radius: float = 0.0


class Flight:
    """One vehicle's flight, from its `.waypoints` file and its part of the spec."""

    undecided = 0.0  # only wings are steered

    def __init__(self, vehicle, items, ground, radius):
        self.vehicle, self.ground, self.radius = vehicle, ground, radius
        self.profile = Profile(vehicle["accel_mps2"])
        self.ardupilot = vehicle["autopilot"] == "ardupilot"
        self.motions, self.judged, self.follows = [], [], False
        self.reaches = None
        self.slopes, self.grounded = [], []  # climb-outs and glides; what no height is asked of
        self.speed, self.t, self.knots, self.turned = vehicle["speed_mps"], 0.0, [], 0.0
        self.late = self.ahead = 0.0
        # How far the verdict's ways of the L1 law may be off, and the steepest leg of those.
        self.loose, self.steep = 0.0, 0.0
        home = items[0]["at"]
        self.home = Knot(home, float(ground.height(*home)))
        self.fly(items[1:])

    def fly(self, items):
        delay = None
        for item in items:
            command, p1 = item["command"], item["param1"]
            if command == SPEED:
                self.speed = item["param2"]
            elif command == DELAY and not self.knots:
                delay = (delay or 0.0) + p1
            elif command == DELAY:
                self.stop()
                self.hold(p1)
            elif command == TAKEOFF:
                self.t = delay if delay is not None else 0.0 if self.ardupilot else self.vehicle.get("depart_s", 0.0)
                self.takeoff(item)
            elif command == TO_ALT:
                self.stop()
                self.head(item)
                self.stop()
                self.hold(0.0)
            elif command in (WAYPOINT, HOLD, STAY):
                self.head(item)
                hold = math.inf if command == STAY else math.trunc(p1) if self.ardupilot and command == WAYPOINT else p1
                if hold > 0 or (self.ardupilot and command == HOLD):
                    self.stop()
                    self.hold(hold)
                if command == STAY:
                    return
            elif command == LAND:
                if self.ardupilot:
                    self.stop()
                last, agl = self.knots[-1], None
                if item["frame"] in (10, 11):
                    agl = last.amsl - float(self.ground.height(*last.at))
                amsl = last.amsl if agl is None else float(self.ground.height(*item["at"])) + agl
                self.append(Knot(item["at"], amsl, agl, self.speed))
                self.stop()
                return self.touch_down()
            elif command == RETURN:
                self.stop()
                if self.knots[-1].amsl < self.vehicle["return_amsl_m"]:
                    self.lift(self.vehicle["return_amsl_m"], judged=True)
                self.append(Knot(self.home.at, self.knots[-1].amsl, None, self.speed))
                self.stop()
                return self.touch_down()
            else:
                raise ValueError(f"command {command}")
        self.stop()
        self.hold(math.inf)

    def resolve(self, item, at):
        z = float(np.float32(item["z"]))
        if self.ardupilot:
            z = math.trunc(z * 100) / 100
        frame = item["frame"]
        if frame in (10, 11):
            return float(self.ground.height(*at)) + z, z
        return (z if frame in (0, 5) else z + self.home.amsl), None

    def takeoff(self, item):
        amsl, _ = self.resolve(item, self.home.at)
        self.knots = [self.home]
        self.late += self.slow_takeoff() + (0.0 if self.ardupilot else PX4_CLIMB_LATE)
        self.lift(amsl)
        if not self.ardupilot and distance(item["at"], self.home.at) > SAME_M:
            self.append(Knot(item["at"], amsl, None, self.speed))
            self.stop()

    def slow_takeoff(self):
        """The first 10 m of PX4 on rotors."""
        climb = self.vehicle["climb_mps"]
        return 0.0 if self.ardupilot else 10 / min(self.vehicle["takeoff_mps"], climb) - 10 / climb

    def head(self, item):
        amsl, agl = self.resolve(item, item["at"])
        if self.ardupilot and (agl is None) != (self.knots[-1].agl is None):
            self.stop()
        own = not self.ardupilot and item["command"] == WAYPOINT and item["param2"] > 0
        self.append(Knot(item["at"], amsl, agl, self.speed, item["param2"] if own else self.radius))

    def append(self, knot):
        last = self.knots[-1]
        if distance(knot.at, last.at) > SAME_M:
            self.knots.append(knot)
        elif abs(knot.amsl - last.amsl) > SAME_M:
            self.stop()
            self.lift(knot.amsl, judged=True)
        elif type(self) is Flight:
            # A copter stops at a waypoint that is there twice.
            self.stop()

    def lift(self, amsl, judged=False, rate=None):
        last = self.knots[-1]
        up = amsl > last.amsl
        rate = rate or self.vehicle["climb_mps" if up else "descent_mps"]
        shape = Point(last.at, Height(False, last.amsl, amsl))
        self.add(shape, (0, 1), (1, 1), abs(amsl - last.amsl) / rate, (0.0, rate))
        if judged:
            self.judged.append(shape)
        self.knots = [Knot(last.at, amsl)]

    def hold(self, lasts):
        last = self.knots[-1]
        shape = Point(last.at, Height(False, last.amsl, last.amsl))
        self.add(shape, (0, 0), (0, 0), lasts, (0.0, 0.0))
        self.judged.append(shape)

    def touch_down(self):
        ground = float(self.ground.height(*self.knots[-1].at))
        # It is slow from so high above home on where nothing on board knows the ground.
        fast, slow = self.vehicle["descent_mps"], min(self.vehicle["descent_mps"], 0.5 if self.ardupilot else 0.7)
        top = self.knots[-1].amsl
        from_home, from_ground = (max(min(amsl, top), ground) for amsl in (self.home.amsl + SLOW_M, ground + SLOW_M))
        later = (from_home - from_ground) * (1 / slow - 1 / fast)
        self.late, self.ahead = self.late + max(later, 0.0), self.ahead + max(-later, 0.0)
        if self.knots[-1].amsl > ground + SLOW_M:
            self.lift(ground + SLOW_M, rate=self.vehicle["descent_mps"])
        self.lift(ground, rate=slow)

    def add(self, shape, part, speed, lasts, fastest, wide=0.0):
        self.motions.append(Motion(shape, part, speed, self.t, self.t + lasts, fastest, self.late, wide, self.ahead))
        self.t += lasts

    def stop(self):
        """Flies the legs so far, to rest at the last knot."""
        knots, self.knots = self.knots, self.knots[-1:]
        if len(knots) < 2:
            return
        legs = []
        for a, b in zip(knots, knots[1:]):
            follows = b.agl is not None
            self.follows |= follows
            above = a.amsl - float(self.ground.height(*a.at)) if follows else a.amsl
            legs.append(Line(a.at, b.at, Height(follows, above, b.agl if follows else b.amsl)))
        self.judged += legs
        lengths = [leg.length for leg in legs]
        cruise = [knot.speed for knot in knots[1:]]
        if self.ardupilot and len(legs) > 1:
            cruise = [min(v, self.profile.within(length)) for v, length in zip(cruise, lengths)]
        cruise = [min(v, self.climbing(a, b, length)) for v, a, b, length in zip(cruise, knots, knots[1:], lengths)]
        half, taken = self.corners(knots, legs, cruise)
        corner = [0.0] + [
            self.corner_speed(half[i], taken[i], min(cruise[i - 1 : i + 1]), knots[i].radius)
            for i in range(1, len(legs))
        ] + [0.0]
        passing = self.passing(corner, lengths, taken)
        for i, leg in enumerate(legs):
            self.late += 0.0 if self.ardupilot else PX4_LEG_LATE
            first = len(self.motions)
            self.straight(leg, taken[i], lengths[i] - taken[i + 1], passing[i], passing[i + 1], cruise[i])
            if i + 1 < len(legs) and taken[i + 1] > 0:
                slower, radius = min(cruise[i : i + 2]), knots[i + 1].radius
                if not self.ardupilot:
                    self.late += self.corner_late(half[i + 1], taken[i + 1], slower)
                elif not self.profile.overlap(slower, half[i + 1], radius)[1]:
                    self.late += CORNER_LATE
                self.arc(knots[i : i + 3], legs[i : i + 2], half[i + 1], taken[i + 1], passing[i + 1])
            self.count_on_sphere(knots[i].at, knots[i + 1].at, self.motions[first:])
        # As it brakes for the stop already.
        self.motions[-1].late += STOP_LATE
        self.late += STOP_LATE

    def climbing(self, a, b, length):
        """The speed at which a leg is as steep as it climbs or descends."""
        steep = abs(b.amsl - a.amsl) - RISE_M
        if b.agl is not None or steep <= 0:
            return math.inf
        return self.vehicle["climb_mps" if b.amsl > a.amsl else "descent_mps"] * length / steep

    def count_on_sphere(self, a, b, motions):
        """What a leg makes it late or early by, as it counts its metres, from the beginning of the leg on: once it is ten minutes in the air."""
        radius = 6378100.0 if self.ardupilot else 6371000.0
        east = math.radians((b[1] - a[1] + 180) % 360 - 180) * math.cos(math.radians((a[0] + b[0]) / 2))
        counted = radius * math.hypot(math.radians(b[0] - a[0]), east)
        lasts = motions[-1].end - max(motions[0].start, self.motions[0].start + COUNTS_AFTER) if motions else 0.0
        late = max(lasts, 0.0) * (counted / distance(a, b) - 1)
        for motion in motions:
            motion.late, motion.early = motion.late + max(late, 0.0), motion.early + max(-late, 0.0)
        self.late, self.ahead = self.late + max(late, 0.0), self.ahead + max(-late, 0.0)

    def corners(self, knots, legs, cruise):
        """Half the change of course at each knot, and what its arc takes of both legs."""
        half, wanted = [0.0] * len(knots), [0.0] * len(knots)
        for i in range(1, len(knots) - 1):
            arc = Arc(knots[i].at, knots[i - 1].at, knots[i + 1].at, 1.0, 0.0, None)
            half[i] = min(abs(arc.sweep) / 2, math.radians(89.9))
            wanted[i] = self.takes(half[i], min(cruise[i - 1 : i + 1]), knots[i].radius)
        taken = list(wanted)
        for i, leg in enumerate(legs):
            both = wanted[i] + wanted[i + 1]
            if both > 0.99 * leg.length:
                for k in (i, i + 1):
                    taken[k] = min(taken[k], wanted[k] * 0.99 * leg.length / both)
        return half, taken

    def takes(self, half, v, radius):
        """What the arc of a corner takes of both legs where they are long."""
        if half < 1e-6:
            return 0.0
        if not self.ardupilot:
            return radius
        overlap, _ = self.profile.overlap(v, half, radius)
        return 2 * self.profile.distance(overlap) * math.sin(half) / math.tan(half / 2)

    def corner_speed(self, half, taken, v, radius):
        """The constant speed of an arc that takes so much of both legs."""
        if not self.ardupilot:
            return min(v, math.sqrt(PX4_TURNING * self.vehicle["accel_mps2"] * taken / math.tan(max(half, 1e-9))))
        overlap, full = self.profile.overlap(v, half, radius)
        if half < 1e-6:
            return v
        if full:
            return v * half / math.tan(half)
        more = float(np.interp(math.degrees(2 * half), MORE_DEG, MORE_S))
        lost = max(0.0, self.profile.ramp(v) - 2 * overlap + more)
        arc = taken / math.tan(half) * 2 * half
        low, high = 0.0, v
        for _ in range(100):
            c = (low + high) / 2
            loses = (v - c) ** 2 / (self.vehicle["accel_mps2"] * v) + arc / c - 2 * taken / v
            low, high = (c, high) if loses > lost else (low, c)
        return high

    def corner_late(self, half, taken, v):
        """What a corner of PX4 may take more than its arc, and more than each leg may."""
        accel, speeds = self.vehicle["accel_mps2"], sorted(LOST_S)
        at = [float(np.interp(math.degrees(2 * half), LOST_DEG, LOST_S[speed])) for speed in speeds]
        lost = float(np.interp(v, speeds, at)) + max(v - speeds[2], 0) * (at[2] - at[1]) / (speeds[2] - speeds[1])
        c = self.corner_speed(half, taken, v, None)
        arc = (v - c) ** 2 / (accel * v) + 2 * half * taken / math.tan(half) / c - 2 * taken / v
        return max(max(lost * max(3.0 / accel, 1.0) - arc, 0.0) - PX4_LEG_LATE, 0.0)

    def passing(self, corner, lengths, taken):
        """Speeds at the knots."""
        accel = self.vehicle["accel_mps2"]
        speeds = list(corner)
        room = [length - taken[i] - taken[i + 1] for i, length in enumerate(lengths)]
        for i in range(len(room)):
            speeds[i + 1] = min(speeds[i + 1], math.sqrt(speeds[i] ** 2 + 2 * accel * room[i]))
        for i in reversed(range(len(room))):
            speeds[i] = min(speeds[i], math.sqrt(speeds[i + 1] ** 2 + 2 * accel * room[i]))
        return speeds

    def straight(self, leg, start, end, a, b, cruise):
        accel, room = self.vehicle["accel_mps2"], end - start
        peak = max(a, b, min(cruise, math.sqrt(accel * room + (a * a + b * b) / 2)))
        up = min(start + (peak**2 - a**2) / (2 * accel), end)
        down = max(end - (peak**2 - b**2) / (2 * accel), up)
        for x, y, speeds in [(start, up, (a, peak)), (up, down, (peak, peak)), (down, end, (peak, b))]:
            if y - x > 1e-9:
                self.move(leg, (x / leg.length, y / leg.length), speeds, y - x)

    def arc(self, knots, legs, half, taken, speed):
        before, corner, after = (knot.at for knot in knots)
        leave, join = 1 - taken / legs[0].length, taken / legs[1].length
        ends = []
        both = legs[0].height.follows and legs[1].height.follows
        for leg, s in ((legs[0], leave), (legs[1], join)):
            value = leg.height.start + (leg.height.end - leg.height.start) * s
            if leg.height.follows and not both:
                value += float(self.ground.height(*leg.place(s)))
            ends.append(value)
        shape = Arc(corner, before, after, taken / math.tan(half), taken, Height(both, *ends))
        if shape.length > 1e-6:
            self.judged.append(shape)
            self.turned += shape.length
            self.move(shape, (0.0, 1.0), (speed, speed), shape.length, taken * math.tan(half / 2))

    def move(self, shape, part, speeds, length, wide=0.0):
        height = shape.height
        slope = abs(height.end - height.start) / shape.length + (self.ground.steepest if height.follows else 0)
        self.add(shape, part, speeds, 2 * length / sum(speeds), (max(speeds), max(speeds) * slope), wide)

    def where(self, t):
        """Feet in ECEF and altitudes at times."""
        starts = np.array([motion.start for motion in self.motions])
        index = np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(starts) - 1)
        feet, amsl = np.empty((len(t), 3)), np.empty(len(t))
        for i in np.unique(index):
            here = index == i
            motion = self.motions[i]
            s = motion.fraction(t[here])
            lat, lon = motion.shape.place(s)
            feet[here] = ecef(lat, lon)
            amsl[here] = motion.shape.height.amsl(self.ground, lat, lon, s)
        return feet, amsl

    def beside(self, origin):
        """How far the verdict's legs may lie beside these: straight lines of a plane that
        touches the earth at a distance d leave a chord of length L by at most d L^2 / 8 R^2."""
        return self.furthest(origin) * max((s.length for s in self.judged), default=0) ** 2 / (8 * A * A)

    def along(self, origin):
        """How far along its path the vehicle may be off: lengths of that plane are short by (d / R)^2 / 2."""
        return (self.furthest(origin) / A) ** 2 / 2 * sum(motion.shape.length for motion in self.motions)

    def furthest(self, origin):
        """How far from a place it comes."""
        if self.reaches is None:
            ends = np.array([0.0, 1.0])
            lines = [xyz for s in self.judged if isinstance(s, Line) for xyz in (s.start, s.end)]
            others = [xyz for s in self.judged if not isinstance(s, Line) for xyz in ecef(*s.place(ends))]
            self.reaches = float(np.linalg.norm(np.array(lines + others) - ecef(*origin), axis=-1).max())
        return self.reaches

    def late_at(self, t):
        """By how much the vehicle may be late at times, for the stops and legs before."""
        starts = np.array([motion.start for motion in self.motions])
        late = np.array([motion.late for motion in self.motions])
        return late[np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(starts) - 1)]

    def early_at(self, t):
        starts = np.array([motion.start for motion in self.motions])
        early = np.array([motion.early for motion in self.motions])
        return early[np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(starts) - 1)]

    def wide_at(self, t):
        """How far beside its way the vehicle may be at times."""
        starts = np.array([motion.start for motion in self.motions])
        wide = np.array([motion.wide for motion in self.motions])
        return wide[np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(starts) - 1)]

    def takeoff_late(self, other):
        """By how much this of two vehicles may be late against the other from their takeoffs on."""
        kind, its = ((flight.vehicle["autopilot"], flight.vehicle["airframe"]) for flight in (self, other))
        return 0.0 if kind == its else FROM_TAKEOFF[kind][1] + FROM_TAKEOFF[its][0]

    @property
    def kind(self):
        return f"{self.vehicle['airframe']}-{self.vehicle['autopilot']}"

    def everywhere(self):
        """What is judged against threats and the ceiling."""
        return self.judged + self.slopes + self.grounded + [m.shape for m in self.motions if isinstance(m.shape, Point)]

    def horizon(self):
        return max(m.end if math.isfinite(m.end) else m.start for m in self.motions)

    def stay_until(self, t):
        for motion in self.motions:
            if math.isinf(motion.end):
                motion.end = max(t, motion.start)
