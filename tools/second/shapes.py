"""Shapes of a flight: straight lines and arcs over the earth, and motions along them."""

import math
from dataclasses import dataclass

import numpy as np

from .earth import A, axes, ecef, geodetic


@dataclass
class Height:
    """Altitude along a shape: linear above the sea, or above the ground, and level where that is above a top or below a bottom."""

    follows: bool
    start: float
    end: float
    top: float = math.inf
    bottom: float = -math.inf

    def parts(self, start=0.0, end=1.0):
        """From one share to another in straight pieces: the shares of the way at their ends, and the altitudes there."""
        here, there = (self.start + (self.end - self.start) * s for s in (start, end))
        level = self.top if math.isinf(self.bottom) else self.bottom
        at = (level - here) / (there - here) if there != here else -1.0
        low, high = (max(min(end, self.top), self.bottom) for end in (here, there))
        ends = [(0.0, low), *([(at, level)] if 0 < at < 1 else []), (1.0, high)]
        return zip(ends, ends[1:])

    def amsl(self, ground, lat, lon, s):
        value = self.start + (self.end - self.start) * s
        return value + ground.height(lat, lon) if self.follows else value


class Line:
    """From one place to another: the chord through the earth, seen from above."""

    def __init__(self, start, end, height, slope_from=None):
        self.start, self.end, self.height, self.slope_from = ecef(*start), ecef(*end), height, slope_from
        chord = float(np.linalg.norm(self.end - self.start))
        self.length = 2 * A * math.asin(chord / (2 * A))

    def xyz(self, s):
        return self.start + (self.end - self.start) * np.asarray(s)[..., None]

    def place(self, s):
        return geodetic(self.xyz(s))


class Arc:
    """Part of a circle in the plane that touches the earth at a corner."""

    slope_from = None

    def __init__(self, corner, before, after, radius, taken, height):
        self.corner, self.height = ecef(*corner), height
        self.east, self.north = axes(*corner)
        into, out = (self.flat(self.corner - ecef(*before)), self.flat(ecef(*after) - self.corner))
        into, out = into / np.hypot(*into), out / np.hypot(*out)
        self.sweep = math.atan2(into[0] * out[1] - into[1] * out[0], into @ out)
        side = math.copysign(1, self.sweep)
        self.radius, self.length = radius, radius * abs(self.sweep)
        self.center = -taken * into + side * radius * np.array([-into[1], into[0]])
        self.angle = math.atan2(*(-taken * into - self.center)[::-1])

    def flat(self, xyz):
        return np.array([xyz @ self.east, xyz @ self.north])

    def place(self, s):
        angle = self.angle + self.sweep * np.asarray(s)
        east = self.center[0] + self.radius * np.cos(angle)
        north = self.center[1] + self.radius * np.sin(angle)
        return geodetic(self.corner + east[..., None] * self.east + north[..., None] * self.north)


class Point:
    """One place; `height` may change."""

    length, slope_from = 0.0, None

    def __init__(self, at, height):
        self.at, self.height = at, height

    def place(self, s):
        return tuple(np.full(np.shape(s), value) for value in self.at)


@dataclass
class Motion:
    """A part of a shape flown with constant acceleration along it."""

    shape: object
    part: tuple  # fractions of the shape at the ends
    speed: tuple  # at the ends, along the shape
    start: float
    end: float
    fastest: tuple  # greatest speeds across and up
    late: float = 0.0  # by how much it may be late, for the stops and legs before it
    wide: float = 0.0  # how far beside it the vehicle may be, for the separation
    early: float = 0.0  # by how much it may be early, for the legs before it

    def fraction(self, t):
        if self.end <= self.start or math.isinf(self.end):
            return np.full(np.shape(t), self.part[0])
        tau = np.clip((t - self.start) / (self.end - self.start), 0, 1)
        a, b = self.speed
        covered = tau * (2 * a + (b - a) * tau) / (a + b) if a + b > 0 else tau
        return self.part[0] + (self.part[1] - self.part[0]) * covered
