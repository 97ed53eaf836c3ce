"""The climb-out of a plane, and its ways on from where it may have its height, by the text of src/verify/execute/wing/mod.rs."""

import math
from dataclasses import dataclass, replace

import numpy as np

from .circles import ARRIVAL_LEGS, parts
from .flight import Knot
from .shapes import Height, Line

PX4_CLIMB_LATE_S = 36.0
CLIMB_OUT_SHARE, CLIMB_OUT_LAST_SHARE, OVERSHOOT_M = 0.2, 0.46, 14.0
LATER_SHARE = (CLIMB_OUT_LAST_SHARE - CLIMB_OUT_SHARE) / (1 - CLIMB_OUT_SHARE)
CARRIED_SHARE = {"ardupilot": 0.32, "px4": 0.1}


@dataclass
class WingKnot(Knot):
    slope_from: float = None  # the ground that the leg to here climbs from or glides to
    takeoff: bool = False


def course(a, b):
    """Clockwise from north."""
    return math.atan2(*(b - a))


def ahead(a, clockwise, far):
    return a + far * np.array([math.sin(clockwise), math.cos(clockwise)])


class ClimbOut:
    def climb_out(self, item):
        amsl, _ = self.resolve(item, self.home.at)
        start = self.flat(self.home)
        heading = self.vehicle["takeoff_heading_deg"]
        clockwise = math.radians(heading) if self.ardupilot else course(start, self.plane.flat(item["at"]))
        speed, accel = self.vehicle["speed_mps"], self.vehicle["accel_mps2"]
        v = self.over_ground(speed, amsl, clockwise)
        run = v * v / (2 * accel)
        off = ahead(start, clockwise, run)
        place = self.plane.place(off)
        ground = float(self.ground.height(*place))
        slope = min(math.tan(math.radians(self.vehicle["max_climb_deg"])), self.vehicle["climb_mps"] / self.fastest)
        top = ahead(off, clockwise, (amsl - ground) / slope)
        roll = Line(self.home.at, place, Height(False, self.home.amsl, ground))
        self.grounded.append(roll)
        self.add(roll, (0, 1), (v / 2, v / 2), 2 * run / v, (v, abs(ground - self.home.amsl) / run * v))
        self.knots, self.moving = [WingKnot(place, ground)], speed
        last = WingKnot(self.plane.place(top), amsl, None, speed, takeoff=True)
        self.knots += self.in_two(self.knots[0], last, ground)
        early = off + CLIMB_OUT_SHARE * (top - off)
        self.lay(early, top, amsl + OVERSHOOT_M, amsl + OVERSHOOT_M)
        carried = self.carried((amsl - ground) / self.vehicle["climb_mps"])
        for off in carried[1:]:
            there = self.plane.place(early + off)
            steep = [self.knots[0], *self.in_two(self.knots[0], replace(last, at=there), ground)]
            for a, b in zip(steep, steep[1:]):
                self.lay(self.flat(a), self.flat(b), a.amsl, b.amsl, b.slope_from)
        self.early_top = early, top, amsl, carried
        self.late += 0.0 if self.ardupilot else PX4_CLIMB_LATE_S

    def carried(self, lasts):
        """How far off the wind may carry a climb-out: it holds its heading."""
        if not self.wind:
            return [np.zeros(2)] * 2
        far = CARRIED_SHARE[self.vehicle["autopilot"]] * lasts * self.wind["speed_mps"]
        off = ahead(np.zeros(2), math.radians(self.wind["from_deg"]) + math.pi, far)
        count = parts(far)
        return [off * k / count for k in range(count + 1)]

    def in_two(self, low, high, ground):
        """From the ground up: as long as half of the height is asked for, and the rest."""
        split = ground + max(2 * self.min_agl, self.min_agl + 20)
        if split >= high.amsl:
            return [replace(high, slope_from=ground)]
        a, b = self.flat(low), self.flat(high)
        at = self.plane.place(a + (b - a) * (split - ground) / (high.amsl - ground))
        return [replace(high, at=at, amsl=split, slope_from=ground), high]

    def leave_early(self, flat, knots, heights, cruise):
        """From where it may have its height early on: straight to the next place, and as ArduPlane flies there and on."""
        if self.early_top is None:
            return
        (early, top, amsl, carried), self.early_top = self.early_top, None
        onto = next(i for i in range(1, len(knots)) if not knots[i].takeoff)
        last = min(onto + ARRIVAL_LEGS, len(knots) - 1)
        for share in (0, LATER_SHARE / 3, LATER_SHARE * 2 / 3, LATER_SHARE):
            for off in carried:
                at = early + share * (top - early) + off
                self.lay(at, flat[onto], amsl, knots[onto].amsl)
                if self.ardupilot:
                    begins = WingKnot(self.plane.place(at), amsl, None, knots[onto].speed)
                    self.turn_off([at, *flat[onto : last + 1]], [begins, *knots[onto : last + 1]], heights[onto:last], cruise[onto:last])

    def turn_off(self, flat, knots, heights, cruise):
        rise = knots[1].amsl - knots[0].amsl
        own = [Height(False, knots[0].amsl, knots[1].amsl)]
        own += [Height(False, knots[1].amsl, knots[1].amsl)] * (abs(rise) < self.small)
        halfway = (knots[0].amsl + knots[1].amsl) / 2
        speeds = [self.over_ground(knots[1].speed, halfway, course(flat[0], flat[1])), *cruise]
        heading = math.radians(self.vehicle["takeoff_heading_deg"])
        amsl = [knot.amsl for knot in knots]
        for fixes in self.law.both(lambda law: law.leave(heading, flat, amsl, speeds, self.wind)):
            self.lay_way(flat, knots, [own, *heights], fixes)
