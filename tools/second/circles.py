"""Circles of wings and the regions around them, by the text of src/verify/execute/wing/mod.rs."""

import math
from dataclasses import dataclass

import numpy as np

from .flight import G, HOLD, RETURN, SAME_M, TO_ALT
from .l1 import STEP_S, WAY_M, air_ratio
from .shapes import Height, Line, Point

ORBIT_PIECES = 100  # of half an orbit in wind
APART_M = 15.0  # lines that stand for a region
BETWEEN_M = 30.0  # ways onto a circle end no further apart
INSIDE_SHARE, ALIGNED_REACH = 0.2, 1.2
WIDE_SHARE, LEVEL_M = {"ardupilot": 0.75, "plane-px4": 0.25}, {"ardupilot": 6.0, "plane-px4": 3.0}
TRANSITION_M = {"ardupilot": 80.0, "px4": 45.0}
DRIFT_S, DRIFT_SHARE, SIDES, LANDING_DRIFT_S, LANDING_OVERSHOOT_M = 21.0, 0.8, 12, 20.0, 18.0
ARRIVAL_DEG, ARRIVAL_LEGS = 10.0, 3


def parts(length, least=2):
    return max(least, math.ceil(length / APART_M - 1e-9))


def direction(clockwise):
    return np.array([math.sin(clockwise), math.cos(clockwise)])


@dataclass
class Hull:
    """The disc around a place that a wing leaves somewhere, and goes on from."""

    middle: object
    amsl: float
    reach: float
    any_course: bool = False

    def rim(self, to):
        """Places whose lines to another place cover the hull of the disc and that place."""
        off = to - self.middle
        away = math.hypot(*off)
        toward = math.atan2(*off)
        tangent = math.acos(min(self.reach / max(away, 1e-9), 1.0))
        arc = 2 * math.pi - 2 * tangent
        count = parts(arc * self.reach)
        return [self.middle + self.reach * direction(toward + tangent + arc * k / count) for k in range(count + 1)]


class Circles:
    @property
    def level(self):
        return LEVEL_M.get(self.kind, LEVEL_M["ardupilot"] if self.ardupilot else 0.0)

    @property
    def wide(self):
        return WIDE_SHARE.get(self.kind, WIDE_SHARE["ardupilot"] if self.ardupilot else 0.0) * self.turn_radius

    def enter(self, at, amsl, radius):
        """To the rim along the tangent, or somewhere between that and the line to the middle."""
        middle, last, rim = self.plane.flat(at), self.knots[-1], abs(radius)
        start = self.flat(last)
        off = middle - start
        away = math.hypot(*off)
        inside = away <= rim
        if inside:
            edge = middle + rim * direction(math.atan2(*(start - middle)) if away > SAME_M else 0.0)
        else:
            toward = math.atan2(*off) - math.copysign(math.asin(rim / away), radius)
            edge = start + math.sqrt(away * away - rim * rim) * direction(toward)
        first, turned = len(self.motions), self.turned_off(middle)
        self.append(type(last)(self.plane.place(edge), amsl, None, self.speed))
        self.onto_circle = True
        self.legs(self.speed)
        self.onto_circle = False
        for out in [last, *(self.knot_off(last, at, middle, amsl) for at in turned)]:
            self.lay(self.flat(out), middle, out.amsl, amsl)
            for height in self.arrival:
                self.lay_at(self.flat(out), middle, height, (self.gone(last, self.flat(out), middle), 1.0))
            if self.level > 0:
                off = self.level + abs(self.left_of_climb(out, middle, amsl, 0.0))
                for up in (-off, off):
                    self.lay(self.flat(out), middle, out.amsl + up, amsl + up)
        count = math.ceil(rim / BETWEEN_M)
        for k in range(1, min(count, 20) if not inside else 0):
            to = edge + (middle - edge) * k / min(count, 20)
            self.lay(self.flat(last), to, last.amsl, amsl)
            for height in self.arrival:
                self.lay_at(self.flat(last), to, height, (0.0, 1.0))
        if inside:
            for motion in self.motions[first:]:
                motion.wide = max(motion.wide, rim + 2 * self.turn_radius)
            ends = [max(min(end, height.top), height.bottom) for height in self.arrival for end in (height.start, height.end)]
            for height in (last.amsl, amsl, *ends):
                self.disc(middle, rim + 2 * self.turn_radius, height)
        return last, middle, edge

    def turned_off(self, to):
        """Places beside the leg to a place from which ArduPlane, once it has turned, flies straight there; PX4 may."""
        last = self.knots[-1]
        if self.law is None or len(self.knots) < 2 or math.hypot(*(to - self.flat(last))) <= SAME_M:
            return []
        knots = [*self.knots, type(last)(self.plane.place(to), last.amsl, None, last.speed)]
        flat = [self.flat(knot) for knot in knots]
        cruise = [self.over_ground(b.speed, (a.amsl + b.amsl) / 2, math.atan2(*(q - p)))
                  for a, b, p, q in zip(knots, knots[1:], flat, flat[1:])]
        found = []
        for way in self.law.both(lambda law: law.follow(flat, [knot.amsl for knot in knots], cruise, self.wind, 2 * STEP_S)):
            onto = [(a, b) for a, b, leg, aside in way if leg == len(knots) - 2 and aside > WAY_M]
            found += [a for a, _ in onto[:1]] + [b for _, b in onto]
        if found:
            self.loose = max(self.loose, (2 + self.short) * STEP_S * self.fastest)
        return found

    def knot_off(self, last, at, middle, amsl):
        """A knot at a place beside the way from the last one, as high as that way is there."""
        share = self.gone(last, at, middle)
        return type(last)(self.plane.place(at), last.amsl + (amsl - last.amsl) * share, None, last.speed)

    def off_at_rim(self, last, middle, amsl, rim):
        """How far below and above its altitude it is there."""
        late = self.left_of_climb(last, middle, amsl, rim)
        return self.level + max(late, 0.0, self.still[0]), self.level + max(-late, 0.0, self.still[1])

    def gone(self, last, at, middle):
        start = self.flat(last)
        return float(np.clip((at - start) @ (middle - start) / ((middle - start) @ (middle - start)), 0, 1))

    def left_of_climb(self, last, middle, amsl, rim):
        """What of a climb to the middle is left at the rim, with its lag; negative of a descent."""
        rise = amsl - last.amsl
        away = max(math.hypot(*(middle - self.flat(last))), 1.0)
        lasts = max(away / self.vehicle["speed_mps"], 1.0)
        lag = self.lag * min(abs(rise) / lasts, self.vehicle["climb_mps"])
        return math.copysign(lag, rise) + rise * min(rim / away, 1.0)

    def orbit(self, middle, edge, radius, amsl):
        """Once around, as two half circles."""
        pieces = ORBIT_PIECES if self.wind else 1
        for sign in (1, -1):
            arm = sign * (edge - middle)
            side = math.copysign(1, radius) * np.array([arm[1], -arm[0]])  # the way it flies there
            shape = Circle(self.plane, middle, arm, side, amsl)
            self.judged.append(shape)
            for k in range(pieces):
                angle = math.pi * (k + 0.5) / pieces
                clockwise = math.atan2(*(side * math.cos(angle) - arm * math.sin(angle)))
                speed = self.over_ground(self.speed, amsl, clockwise)
                self.move(shape, (k / pieces, (k + 1) / pieces), (speed, speed), shape.length / pieces)

    def widened(self, radius, amsl):
        """ArduPlane flies circles wider the higher, unless its bank at sea level has a limit that they keep."""
        if not self.ardupilot:
            return radius
        dense = air_ratio(max(amsl, self.knots[-1].amsl)) ** 2
        tangent = math.tan(math.radians(min(max(self.params.get("NAVL1_LIM_BANK", 0.0), 0.0), 89.0)))
        if tangent == 0 or self.speed**2 / (G * tangent) > abs(radius):
            return radius * dense
        return math.copysign(max(abs(radius), dense * self.speed**2 / (G * tangent)), radius)

    def stay(self, at, amsl, radius):
        radius = self.widened(radius, amsl)
        last, middle, edge = self.enter(at, amsl, radius)
        self.orbit(middle, edge, radius, amsl)
        rim = abs(radius)
        if self.wide > 0:
            self.rings(middle, amsl, rim, self.wide, self.off_at_rim(last, middle, amsl, rim))
        point = Point(self.plane.place(middle), Height(False, amsl, amsl))
        self.judged.append(point)
        self.add(point, (0, 0), (0, 0), math.inf, (0.0, 0.0), rim + self.wide)

    def circle_a_while(self, item, onto):
        amsl, _ = self.resolve(item, item["at"])
        radius = self.widened(self.radius_of(item), amsl)
        last, middle, edge = self.enter(item["at"], amsl, radius)
        self.orbit(middle, edge, radius, amsl)
        rim = abs(radius)
        elsewhere = onto is not None and onto["command"] != RETURN and (
            math.hypot(*(self.plane.flat(onto["at"]) - middle)) > rim)
        aligned = self.ardupilot and elsewhere
        reach = max(ALIGNED_REACH * rim, rim + self.wide) if aligned else rim + 2 * self.turn_radius
        self.judged.append(Point(self.plane.place(middle), Height(False, amsl, amsl)))
        if item["command"] == TO_ALT:
            count = parts(2 * math.pi * reach)
            for k in range(count):
                at = self.plane.place(middle + reach * direction(2 * math.pi * k / count))
                self.judged.append(Point(at, Height(False, last.amsl, amsl)))
            self.disc(middle, reach, last.amsl)
        if aligned:
            self.rings(middle, amsl, rim, reach - rim, self.off_at_rim(last, middle, amsl, rim))
        else:
            self.disc(middle, reach, amsl)
        self.knots = [type(last)(self.plane.place(middle), amsl, None, self.speed)]
        self.moving, self.hull = self.speed, Hull(middle, amsl, reach)

    def radius_of(self, item):
        """That of the item in whole metres, or of the parameters; ArduPlane keeps none of a loiter by time."""
        command = item["command"]
        own = item["param2"] if command == TO_ALT else item["param3"]
        if self.ardupilot:
            own = math.trunc(own)
        if abs(own) <= 1 or (self.ardupilot and command == HOLD):
            given = self.params["WP_LOITER_RAD" if self.ardupilot else "NAV_LOITER_RAD"]
            return -abs(given) if math.copysign(1, own) < 0 else given
        return own

    def disc(self, middle, radius, amsl):
        """Lines from west to east."""
        count = parts(2 * radius)
        for k in range(count + 1):
            north = radius * (2 * k / count - 1)
            east = math.sqrt(max(radius**2 - north**2, 0.0))
            self.lay(middle + [-east, north], middle + [east, north], amsl, amsl)

    def rings(self, middle, amsl, rim, wide, off):
        inner = max(rim - INSIDE_SHARE * self.turn_radius, 0.0)
        across = rim + wide - inner
        count = parts(across)
        for up in (0.0, -off[0], off[1]):
            for ring in range(count + 1):
                radius = inner + across * ring / count
                sides = parts(2 * math.pi * radius, 12)
                corners = [middle + radius * direction(2 * math.pi * k / sides) for k in range(sides + 1)]
                for a, b in zip(corners, corners[1:]):
                    self.lay(a, b, amsl + up, amsl + up)

    def region(self, amsl):
        """Where a VTOL may be after its climb; a QuadPlane is driven off by the wind besides."""
        middle = self.flat(self.home)
        wind = self.wind["speed_mps"] if self.wind else 0.0
        turns = TRANSITION_M[self.vehicle["autopilot"]] + 2 * self.turn_radius
        self.late += turns / max(self.vehicle["speed_mps"] - wind, 1.0)
        if not self.ardupilot:
            wind = 0.0
        drift = DRIFT_SHARE * wind * (amsl - self.home.amsl) / self.vehicle["climb_mps"]
        if drift > 0:
            for side in range(SIDES):
                at = self.plane.place(middle + drift * direction(2 * math.pi * side / SIDES))
                self.grounded.append(Line(self.home.at, at, Height(False, self.home.amsl, amsl)))
        self.hull = Hull(middle, amsl, turns + drift + DRIFT_S * wind, True)

    def overshoot_landing(self, middle, top, first):
        """How a QuadPlane comes to rest over the place that it lands at."""
        self.disc(middle, LANDING_OVERSHOOT_M, top)
        for motion in self.motions[first:]:
            motion.wide = max(motion.wide, LANDING_OVERSHOOT_M)

    def driven(self, middle, ground, top):
        """Where a QuadPlane may come down that the wind has from behind."""
        drift = LANDING_DRIFT_S * self.wind["speed_mps"]
        judged, self.judged = self.judged, []
        self.disc(middle, drift, top)
        self.grounded += self.judged
        self.judged = judged
        rings = parts(drift)
        for ring in range(1, rings + 1):
            radius = drift * ring / rings
            count = parts(2 * math.pi * radius)
            for k in range(count):
                at = self.plane.place(middle + radius * direction(2 * math.pi * k / count))
                self.grounded.append(Point(at, Height(False, ground, top)))

    def leave_hull(self, flat, knots, heights, cruise, firsts):
        if self.hull is None:
            return
        hull, self.hull, last = self.hull, None, 0
        for leg, (p, q) in enumerate(zip(flat, flat[1:])):
            if leg > 0 and math.hypot(*(p - hull.middle)) >= hull.reach:
                break
            last = leg
            for motion in self.motions[firsts[leg] : firsts[leg + 1]]:
                motion.wide = max(motion.wide, hull.reach)
            for at in hull.rim(q):
                self.lay(at, q, hull.amsl, knots[leg + 1].amsl)
                high = hull.amsl + self.level
                if knots[leg + 1].amsl < high:
                    self.lay(at, q, high, high)
                for height in heights[leg]:
                    self.along_leg(at, p, q, height)
        if hull.any_course and self.law is not None:
            for leg in range(min(last + 1, len(knots) - 2)):
                self.arrivals(hull, leg, flat, knots, heights, cruise)

    def along_leg(self, at, p, q, height):
        """From a place of the rim to the end of a leg, at the altitudes of the leg."""
        gone = float((at - p) @ (q - p) / ((q - p) @ (q - p)))
        if gone >= 0:
            self.lay_at(at, q, height, (min(gone, 1.0), 1.0))
        else:
            abeam = at + (q - at) * -gone / (1 - gone)
            self.lay_at(at, abeam, height, (0.0, 0.0))
            self.lay_at(abeam, q, height, (0.0, 1.0))

    def arrivals(self, hull, leg, flat, knots, heights, cruise):
        """The ways of the law that come to the end of the leg from either side of the hull."""
        place, on = flat[leg + 1], leg + 1
        off = place - hull.middle
        away, toward = max(math.hypot(*off), 1.0), math.atan2(*off)
        most = math.asin(min(hull.reach / math.hypot(*off), 1.0))
        count = min(max(math.ceil(most / math.radians(ARRIVAL_DEG) - 1e-9), 1), 9)
        end = min(on + ARRIVAL_LEGS, len(knots) - 1)
        for k in range(-count, count + 1):
            start = place + away * direction(toward + math.pi + most * k / count)
            amsl = [knot.amsl for knot in knots[on : end + 1]]
            for way in self.law.both(lambda law: law.arrive(start, flat[leg], flat[on : end + 1], amsl, cruise[on:end], self.wind)):
                self.lay_way(flat[on : end + 1], knots[on : end + 1], heights[on:end], way)


class Circle:
    """Half of a circle at one altitude."""

    slope_from = None

    def __init__(self, plane, middle, arm, side, amsl):
        self.plane, self.middle, self.arm, self.side = plane, middle, arm, side
        self.height = Height(False, amsl, amsl)
        self.length = math.pi * math.hypot(*arm)

    def place(self, s):
        angle = math.pi * np.asarray(s)[..., None]
        flat = self.middle + self.arm * np.cos(angle) + self.side * np.sin(angle)
        return self.plane.places(flat)
