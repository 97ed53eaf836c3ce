"""The flight of a VTOL of PX4 on its wing in still air, judged in space, by the text of src/verify/mod.rs."""

import math

from .earth import distance
from .flight import G, LAND, SPEED, TAKEOFF, WAYPOINT, Arc, Flight, Height, Knot, Line

VTOL_TAKEOFF, VTOL_LAND = 84, 85
LAG_S, LASTS_S = 3.5, 7.0
OFF_M = 0.01  # less than this is no offset


def air_ratio(amsl):
    return (1 - 2.25577e-5 * amsl) ** -2.12794


class WingFlight(Flight):
    """Takeoff and landing on rotors, legs, arcs, lag and early altitudes. Not for separation: no lateness."""

    def __init__(self, vehicle, items, ground, tolerance):
        to_rotors = {VTOL_TAKEOFF: TAKEOFF, VTOL_LAND: LAND}
        items = [item | {"command": to_rotors.get(item["command"], item["command"])} for item in items]
        assert all(item["command"] in (WAYPOINT, SPEED, TAKEOFF, LAND) for item in items)
        super().__init__(vehicle, items, ground, tolerance, 0.0)

    def stop(self):
        knots, self.knots = self.knots, self.knots[-1:]
        if len(knots) < 2:
            return
        legs = [Line(a.at, b.at, Height(False, a.amsl, b.amsl)) for a, b in zip(knots, knots[1:])]
        self.judged += legs
        lengths = [leg.length for leg in legs]
        cruise = [b.speed * air_ratio((a.amsl + b.amsl) / 2) for a, b in zip(knots, knots[1:])]
        half, taken = self.corners(knots, legs, cruise)
        speeds = [0.0, *(min(pair) for pair in zip(cruise, cruise[1:])), 0.0]
        passing = self.passing(speeds, lengths, taken)
        times = []
        for i, leg in enumerate(legs):
            begin = self.t
            self.straight(leg, taken[i], lengths[i] - taken[i + 1], passing[i], passing[i + 1], cruise[i])
            if i + 1 < len(legs) and taken[i + 1] > 0:
                self.arc(knots[i : i + 3], legs[i : i + 2], half[i + 1], taken[i + 1], passing[i + 1])
            times.append(self.t - begin)
        self.lags(knots, legs, times)
        self.early(knots, legs)

    def corners(self, knots, legs, cruise):
        n = self.vehicle["max_load_factor"]
        half, wanted = [0.0] * len(knots), [0.0] * len(knots)
        for i in range(1, len(knots) - 1):
            sweep = Arc(knots[i].at, knots[i - 1].at, knots[i + 1].at, 1.0, 0.0, None).sweep
            half[i] = min(abs(sweep) / 2, math.radians(89.9))
            v = max(knots[i].speed, knots[i + 1].speed) * air_ratio(knots[i].amsl)
            wanted[i] = v * v / (G * math.sqrt(n * n - 1)) * math.tan(half[i])
        taken = list(wanted)
        for i, leg in enumerate(legs):
            both = wanted[i] + wanted[i + 1]
            if both > 0.99 * leg.length:
                for k in (i, i + 1):
                    taken[k] = min(taken[k], wanted[k] * 0.99 * leg.length / both)
        return half, taken

    def lags(self, knots, legs, times):
        """Below a climb and above a descent, on the leg after too; of a descent for 7 s.
        What is above decides ceilings, which are not compared."""
        rates = [(b.amsl - a.amsl) / t for a, b, t in zip(knots, knots[1:], times)]
        for i, leg in enumerate(legs):
            most = max(rates[i], rates[i - 1] if i else 0.0, 0.0)
            least, ago = min(rates[i], rates[i - 1] if i else 0.0, 0.0), 0.0
            for k in reversed(range(i)):
                if ago < LASTS_S:
                    least = min(least, rates[k])
                ago += times[k]
            for rate in (most, least):
                if abs(LAG_S * rate) > OFF_M:
                    off = -LAG_S * rate
                    self.judged.append(Line(knots[i].at, knots[i + 1].at,
                                            Height(False, leg.height.start + off, leg.height.end + off)))

    def early(self, knots, legs):
        """At the altitude of a place a loiter radius before it."""
        for a, b, leg in zip(knots, knots[1:], legs):
            share = max(0.0, 1 - self.vehicle["loiter_radius_m"] / leg.length)
            lat, lon = leg.place(share)
            there = float(lat), float(lon)
            if share > 0 and distance(a.at, there) > OFF_M:
                self.judged.append(Line(a.at, there, Height(False, a.amsl, b.amsl)))
            self.judged.append(Line(there, b.at, Height(False, b.amsl, b.amsl)))
