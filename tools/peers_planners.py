#!/usr/bin/env python3
"""Other people's path planners on the specs of Sortie: OMPL and Drake, under the same limits.

    python3 -m venv target/planners && target/planners/bin/python -m pip install -r tools/planners.txt
    cargo build --release
    target/planners/bin/python tools/peers_planners.py target/release/sortie > planners.md

Needs a C compiler (`cc`), with which the check of an edge is built: a Python check would slow the
planners of OMPL down, not their search.

For every spec its first vehicle, alone, from start to goal, with `finish: land`. The objective is
the length in 3-D: the spec gets `planner: {weights: {altitude: 0}}`, so Sortie minimises the length
alone. Sortie gets the evaluations whose plan is the best of those that stay within 1 s of processor
time; reading the spec (`sortie check`) counts apart. Each peer has 60 s of processor time, start of
Python and reading of the spec apart:

- BIT* and AORRTC (OMPL) search the plane, with their defaults, and end with OMPL's own path simplifier.
  With --space half of the time goes to a search of space (east, north, altitude), where a zone or the
  ground can be flown over.
- GCS (Drake, GcsTrajectoryOptimization) gets exact decompositions of the free plane into
  trapezoids in three directions, around threats as polygons of 32 sides (12 where there are more than 20);
  the shortest of what it finds is simplified by OMPL.

In the plane closed is what is closed up to the ceiling, and what cannot be climbed over on a
straight line from start or goal. A path in the plane gets the altitudes of least length, exactly:
the least concave function above the ground and the zones under it.

Each path is written as a mission whose waypoints are its corners, and judged by `sortie review`. If
a corner that is cut breaks a limit, the vehicle stops at every corner for 1 s. Lengths of all,
Sortie's too, are those of the legs between the encoded items from start to goal.

Runs are kept as lines of --records, and are not made again. A run with --margin needs --records of its
own. A second table has the costs with the weights of a spec by default: the plane path of each peer at low
altitudes, judged anew, against what Sortie finds with these weights.
"""

import argparse
import ctypes
import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import yaml

ROOT = Path(__file__).resolve().parent.parent
FAMILIES = ["walls", "maze", "city", "gaps", "far", "canyon", "plateau", "rough", "overflight"]
PEERS = ["AORRTC", "BIT*", "GCS"]
SORTIE_S, PEER_S = 1.0, 60.0
# Evaluations of Sortie that are tried, least first.
EVALUATIONS = [250, 500, 1000, 2000, 4000, 8000, 16000, 40000, 80000, 160000]
# Distance beyond each limit that makes up for 1e-7 degrees and the bend of edges, metres.
EDGE_M = 0.05
# Climb and descent of copters where the spec does not say.
RATES_MPS = {"ardupilot": (2.5, 1.5), "px4": (3.0, 1.5)}
# Limits that the parameters next to a mission decide, which no `.waypoints` file holds.
BY_PARAMETERS = ["airspeed"]
CHECK = r"""
#include <math.h>
#include <stdint.h>
/* Discs: x y r. Rings: edges x0 y0 x1 y1 with a box each; floor: lowest altitudes on a grid. */
static int discs, edges, columns, rows;
static const double *disc, *edge; static const float *lowest;
static double west, south, spacing, ceiling, buffer, up, down;
int64_t checks = 0;
void world(int n, const double *d, int m, const double *e, double r, int c, int w, const float *f,
           double x, double y, double s, double z, double u, double v) {
  discs = n; disc = d; edges = m; edge = e; buffer = r; columns = c; rows = w; lowest = f;
  west = x; south = y; spacing = s; ceiling = z; up = u; down = v;
}
static double lowest_at(double x, double y) {
  double a = (x - west) / spacing, b = (y - south) / spacing;
  int i = (int)a, j = (int)b;
  if (a < 0 || b < 0 || i >= columns - 1 || j >= rows - 1) return 1e9;
  const float *p = lowest + (int64_t)j * columns + i;
  a -= i; b -= j;
  return (1 - b) * ((1 - a) * p[0] + a * p[1]) + b * ((1 - a) * p[columns] + a * p[columns + 1]);
}
static double to_piece_sq(double px, double py, double x, double y, double dx, double dy) {
  double l = dx * dx + dy * dy, t = l > 0 ? ((px - x) * dx + (py - y) * dy) / l : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  double ex = x + t * dx - px, ey = y + t * dy - py;
  return ex * ex + ey * ey;
}
/* Whether a vehicle may fly the straight piece; with flat != 0 the altitudes do not count. */
int may_fly(double x0, double y0, double z0, double x1, double y1, double z1, int flat) {
  checks++;
  double dx = x1 - x0, dy = y1 - y0, run = sqrt(dx * dx + dy * dy);
  if (!flat) {
    double rise = z1 - z0;
    if (rise > up * run + 1e-9 || -rise > down * run + 1e-9) return 0;
    if (z0 > ceiling || z1 > ceiling) return 0;
  }
  double lx = fmin(x0, x1), hx = fmax(x0, x1), ly = fmin(y0, y1), hy = fmax(y0, y1);
  for (int k = 0; k < discs; k++) {
    const double *d = disc + 3 * k; double r = d[2];
    if (d[0] + r < lx || d[0] - r > hx || d[1] + r < ly || d[1] - r > hy) continue;
    if (to_piece_sq(d[0], d[1], x0, y0, dx, dy) < r * r) return 0;
  }
  for (int k = 0; k < edges; k++) {
    const double *e = edge + 4 * k, b = buffer;
    if (fmax(e[0], e[2]) + b < lx || fmin(e[0], e[2]) - b > hx || fmax(e[1], e[3]) + b < ly ||
        fmin(e[1], e[3]) - b > hy) continue;
    double fx = e[2] - e[0], fy = e[3] - e[1];
    double s0 = fx * (y0 - e[1]) - fy * (x0 - e[0]), s1 = fx * (y1 - e[1]) - fy * (x1 - e[0]);
    double t0 = dx * (e[1] - y0) - dy * (e[0] - x0), t1 = dx * (e[3] - y0) - dy * (e[2] - x0);
    if (((s0 > 0) != (s1 > 0)) && ((t0 > 0) != (t1 > 0))) return 0;
    if (to_piece_sq(x0, y0, e[0], e[1], fx, fy) < b * b || to_piece_sq(x1, y1, e[0], e[1], fx, fy) < b * b ||
        to_piece_sq(e[0], e[1], x0, y0, dx, dy) < b * b || to_piece_sq(e[2], e[3], x0, y0, dx, dy) < b * b)
      return 0;
  }
  if (lowest) {
    int n = (int)(run / spacing * 1.5) + 1;
    for (int k = 0; k <= n; k++) {
      double t = (double)k / n, f = lowest_at(x0 + t * dx, y0 + t * dy);
      if (f > (flat ? ceiling : z0 + t * (z1 - z0))) return 0;
    }
  }
  return 1;
}
"""


class Frame:
    """East and north of the tangent plane at the origin, of places at height 0."""

    A, E2 = 6_378_137.0, (2.0 - 1.0 / 298.257_223_563) / 298.257_223_563

    def __init__(self, lat, lon):
        la, lo = math.radians(lat), math.radians(lon)
        self.lat, self.lon = lat, lon
        self.axes = np.array(
            [
                [-math.sin(lo), math.cos(lo), 0.0],
                [-math.sin(la) * math.cos(lo), -math.sin(la) * math.sin(lo), math.cos(la)],
            ]
        )
        self.origin = self.ecef(np.array([lat]), np.array([lon]))[:, 0]

    def ecef(self, lat, lon):
        la, lo = np.radians(lat), np.radians(lon)
        n = self.A / np.sqrt(1.0 - self.E2 * np.sin(la) ** 2)
        return np.array(
            [n * np.cos(la) * np.cos(lo), n * np.cos(la) * np.sin(lo), n * (1.0 - self.E2) * np.sin(la)]
        )

    def plan(self, lat, lon):
        """Of arrays of degrees: an array of [east, north]."""
        lat, lon = np.atleast_1d(np.asarray(lat, float)), np.atleast_1d(np.asarray(lon, float))
        shape = lat.shape
        ecef = self.ecef(lat.ravel(), lon.ravel()) - self.origin[:, None]
        return (self.axes @ ecef).T.reshape(*shape, 2)

    def degrees(self, places):
        """Of an array of [east, north]: latitudes and longitudes, by Newton's method."""
        places = np.asarray(places, float)
        lat, lon = np.full(len(places), self.lat), np.full(len(places), self.lon)
        for _ in range(8):
            here, step = self.plan(lat, lon), 1e-6
            by_lat, by_lon = (self.plan(lat + step, lon) - here) / step, (
                self.plan(lat, lon + step) - here
            ) / step
            miss = places - here
            det = by_lat[:, 0] * by_lon[:, 1] - by_lat[:, 1] * by_lon[:, 0]
            lat = lat + (miss[:, 0] * by_lon[:, 1] - miss[:, 1] * by_lon[:, 0]) / det
            lon = lon + (by_lat[:, 0] * miss[:, 1] - by_lat[:, 1] * miss[:, 0]) / det
        return lat, lon


class World:
    """What the limits of a spec close, in planning coordinates."""

    def __init__(self, path, margin_m=0.0):
        self.path, self.spec = Path(path), yaml.safe_load(Path(path).read_text())
        spec, self.vehicle = self.spec, self.spec["vehicles"][0]
        area = spec["area"]
        low, high = area["south_west"], area["north_east"]
        origin = spec.get("origin") or {k: (low[k] + high[k]) / 2.0 for k in ("lat", "lon")}
        self.frame = Frame(origin["lat"], origin["lon"])
        buffers = spec.get("buffer_m", {"all": 10.0 if spec["sortie"] == 2 else 0.0})
        buffers = buffers if isinstance(buffers, dict) else {"all": buffers}
        self.buffer = lambda kind: buffers.get(kind, buffers.get("all", 10.0))
        # A thousandth of a degree or so of slope, and 2 cm of altitude, for rounding.
        self.ceiling = area["max_amsl_m"] - self.buffer("ceiling") - 0.02
        self.over_ground = area["min_agl_m"] + self.buffer("terrain")
        climb_mps, descent_mps = RATES_MPS[self.vehicle["autopilot"]]
        rates = self.vehicle.get("climb_mps", climb_mps), self.vehicle.get("descent_mps", descent_mps)
        self.up, self.down = (
            0.999 * min(math.tan(math.radians(self.vehicle[key])), rate / self.vehicle["speed_mps"])
            for key, rate in zip(("max_climb_deg", "max_descent_deg"), rates)
        )
        n = 60
        lats, lons = np.linspace(low["lat"], high["lat"], n), np.linspace(low["lon"], high["lon"], n)
        ring_lat = np.r_[np.full(n, low["lat"]), lats, np.full(n, high["lat"]), lats[::-1]]
        ring_lon = np.r_[lons, np.full(n, high["lon"]), lons[::-1], np.full(n, low["lon"])]
        self.area = self.frame.plan(ring_lat, ring_lon)
        self.margin_m = margin_m
        self.zone_buffer = self.buffer("zones") + EDGE_M + margin_m
        self.discs = [
            [
                *self.frame.plan(t["lat"], t["lon"])[0],
                t["radius_m"] + self.buffer("threats") + EDGE_M + margin_m,
            ]
            for t in spec.get("threats") or []
        ]
        self.closed, self.tops = [], []
        for zone in spec.get("no_fly") or []:
            ring = self.frame.plan(*np.array(zone["polygon"]).T)
            top = zone.get("below_amsl_m", math.inf) + self.buffer("zones") + 0.02
            if top > self.ceiling:
                self.closed.append(ring)
            else:
                self.tops.append((ring, top))
        self.start, self.goal = (self.place(self.vehicle[k]) for k in ("start", "goal"))
        self.raster()

    def place(self, of):
        at = self.frame.plan(of["lat"], of["lon"])[0]
        z = (
            of["amsl_m"]
            if "amsl_m" in of
            else of["agl_m"] + self.ground(np.array([of["lat"]]), np.array([of["lon"]]))[0]
        )
        return np.array([*at, z])

    def ground(self, lat, lon):
        """Heights of the ground at arrays of degrees."""
        terrain = self.spec["terrain"]
        if "flat" in terrain:
            return np.full(lat.shape, float(terrain["flat"]["amsl_m"]))
        if "analytic" in terrain:
            total = np.full(lat.shape, float(terrain["analytic"]["base_amsl_m"]))
            for hill in terrain["analytic"]["hills"] or []:
                y = (lat - hill["lat"]) * 111_195.08
                x = (lon - hill["lon"]) * 111_195.08 * math.cos(math.radians(hill["lat"]))
                total += hill["height_m"] * np.exp(-(x * x + y * y) / hill["radius_m"] ** 2)
            return total
        from PIL import Image

        image = Image.open(self.path.parent / terrain["file"])
        step, tie = image.tag_v2[33550], image.tag_v2[33922]
        heights = np.asarray(image, float)
        row, column = (tie[4] - lat) / step[1], (lon - tie[3]) / step[0]
        i, j = np.clip(row.astype(int), 0, heights.shape[0] - 2), np.clip(
            column.astype(int), 0, heights.shape[1] - 2
        )
        a, b = row - i, column - j
        return (1 - a) * ((1 - b) * heights[i, j] + b * heights[i, j + 1]) + a * (
            (1 - b) * heights[i + 1, j] + b * heights[i + 1, j + 1]
        )

    def ground_at(self, places):
        return self.ground(*self.frame.degrees(places))

    def is_flat(self):
        terrain = self.spec["terrain"]
        return "flat" in terrain or ("analytic" in terrain and not terrain["analytic"]["hills"])

    def raster(self):
        """The lowest altitudes allowed, on a grid; none over flat ground without zones that have a top."""
        self.lowest, self.reachable = None, None
        low, high = self.area.min(0), self.area.max(0)
        self.spacing = max(10.0, (high - low).max() / 1500.0)
        self.low = low
        if self.is_flat() and not self.tops:
            return
        columns, rows = (np.ceil((high - low) / self.spacing).astype(int) + 2).tolist()
        x, y = low[0] + self.spacing * np.arange(columns), low[1] + self.spacing * np.arange(rows)
        if self.is_flat():
            lowest = np.full((rows, columns), self.ground(np.zeros(1), np.zeros(1))[0])
        else:
            lat, lon = self.degrees_on_grid(x, y)
            lowest = self.ground(lat, lon)
            # Between nodes the ground may bulge.
            bend = np.abs(np.diff(lowest, 2, axis=0)).max() + np.abs(np.diff(lowest, 2, axis=1)).max()
            lowest += min(bend / 8.0, 2.0) + 0.05
        lowest += self.over_ground
        import shapely

        for ring, top in self.tops:
            wide = shapely.Polygon(ring).buffer(self.zone_buffer + 1.0 * self.spacing, join_style="mitre")
            x0, y0, x1, y1 = wide.bounds
            i, j = np.searchsorted(x, [x0, x1]), np.searchsorted(y, [y0, y1])
            gx, gy = np.meshgrid(x[i[0] : i[1]], y[j[0] : j[1]])
            inside = shapely.contains_xy(wide, gx, gy)
            part = lowest[j[0] : j[1], i[0] : i[1]]
            part[inside] = np.maximum(part[inside], top)
        self.lowest = np.ascontiguousarray(lowest, np.float32)
        gx, gy = np.meshgrid(x, y)
        climb = self.start[2] + self.up * np.hypot(gx - self.start[0], gy - self.start[1])
        sink = self.goal[2] + self.down * np.hypot(gx - self.goal[0], gy - self.goal[1])
        slack = 1e-3 + 1.5 * self.spacing * (
            np.hypot(gx - self.start[0], gy - self.start[1]) < 2 * self.spacing
        )
        slack += 1.5 * self.spacing * (np.hypot(gx - self.goal[0], gy - self.goal[1]) < 2 * self.spacing)
        most = np.minimum(self.ceiling, np.minimum(climb, sink) + slack)
        self.reachable = np.where(lowest > most, 2e4, 0.0).astype(np.float32)

    def degrees_on_grid(self, x, y):
        """Degrees at all nodes, interpolated in a coarser grid: they bend little."""
        cx, cy = np.linspace(x[0], x[-1], 40), np.linspace(y[0], y[-1], 40)
        gx, gy = np.meshgrid(cx, cy)
        found = self.frame.degrees(np.c_[gx.ravel(), gy.ravel()])

        def fine(coarse):
            across = np.array([spline(cx, row, x) for row in coarse.reshape(40, 40)])
            return np.array([spline(cy, column, y) for column in across.T]).T

        return fine(found[0]), fine(found[1])

    def checker(self, flat):
        """The compiled check of an edge, and the library that holds it."""
        source = Path(tempfile.gettempdir()) / f"sortie-edge-{os.getpid()}.c"
        library = source.with_suffix(".so")
        source.write_text(CHECK)
        subprocess.run(
            ["cc", "-O3", "-march=native", "-shared", "-fPIC", "-o", library, source, "-lm"], check=True
        )
        code = ctypes.CDLL(str(library))
        source.unlink()
        library.unlink()
        rings = [self.area, *self.closed]
        edges = np.concatenate([np.c_[ring, np.roll(ring, -1, 0)] for ring in rings])
        # The edge of the area has a buffer of its own, of the same size on these maps.
        discs = np.array(self.discs, float).reshape(-1, 3)
        grid = self.reachable if flat else self.lowest
        self.held = np.ascontiguousarray(discs), np.ascontiguousarray(edges), grid
        pointer = lambda array, kind: None if array is None else array.ctypes.data_as(ctypes.POINTER(kind))
        double = ctypes.c_double
        code.world.argtypes = [
            ctypes.c_int,
            ctypes.POINTER(double),
            ctypes.c_int,
            ctypes.POINTER(double),
            double,
        ]
        code.world.argtypes += [ctypes.c_int, ctypes.c_int, ctypes.POINTER(ctypes.c_float)] + [double] * 6
        rows, columns = (0, 0) if grid is None else grid.shape
        code.world(
            len(discs),
            pointer(self.held[0], double),
            len(edges),
            pointer(self.held[1], double),
            self.zone_buffer,
            columns,
            rows,
            pointer(grid, ctypes.c_float),
            *self.low,
            self.spacing,
            # In the plane a node is open (0) or closed (20000); no part of an edge may be closed.
            1.0 if flat else self.ceiling,
            self.up,
            self.down,
        )
        code.may_fly.argtypes = [double] * 6 + [ctypes.c_int]
        self.code = code
        return code.may_fly

    def checks(self):
        """Edges that were checked."""
        return ctypes.c_int64.in_dll(self.code, "checks").value

    def floor_along(self, plane, more_m):
        """Distances along a path in the plane, and the lowest altitudes allowed there."""
        import shapely

        lengths = np.hypot(*np.diff(plane, axis=0).T)
        at = np.r_[0.0, np.cumsum(lengths)]
        step = min(self.spacing, 15.0)
        s = np.unique(np.r_[at, np.linspace(0.0, at[-1], int(at[-1] / step) + 2)])
        xy = np.c_[np.interp(s, at, plane[:, 0]), np.interp(s, at, plane[:, 1])]
        floor = (
            self.ground_at(xy)
            if not self.is_flat()
            else np.full(len(s), self.ground(np.zeros(1), np.zeros(1))[0])
        )
        floor = floor + self.over_ground + more_m
        points = [np.c_[s, floor]]
        for ring, top in self.tops:
            wide = shapely.Polygon(ring).buffer(self.zone_buffer, join_style="mitre")
            for leg, (a, b) in enumerate(zip(plane[:-1], plane[1:])):
                inside = shapely.LineString([a, b]).intersection(wide)
                for part in getattr(inside, "geoms", [inside]):
                    if part.length > 0.0:
                        ends = [at[leg] + math.dist(a, place) for place in part.coords]
                        points[0][(s >= min(ends)) & (s <= max(ends)), 1] = np.maximum(
                            points[0][(s >= min(ends)) & (s <= max(ends)), 1], top + more_m
                        )
                        points.append(np.c_[ends, np.full(len(ends), top + more_m)])
        points = np.concatenate(points)
        return at, points[np.argsort(points[:, 0], kind="stable")]

    def shortest_altitudes(self, plane, more_m=0.1):
        """A path in the plane with the altitudes of least length; None where slopes or ceiling allow none."""
        plane = np.asarray(plane)
        at, points = self.floor_along(plane, more_m)
        points = np.concatenate(
            [
                [[0.0, self.start[2]]],
                points[(points[:, 0] > 1e-6) & (points[:, 0] < at[-1] - 1e-6)],
                [[at[-1], self.goal[2]]],
            ]
        )
        hull = []
        for point in points:
            while len(hull) > 1 and (hull[-1][1] - hull[-2][1]) * (point[0] - hull[-2][0]) <= (
                point[1] - hull[-2][1]
            ) * (hull[-1][0] - hull[-2][0]):
                hull.pop()
            if not hull or point[0] > hull[-1][0] + 1e-6:
                hull.append(point)
            elif point[1] > hull[-1][1]:
                hull[-1] = point
        hull = np.array(hull)
        slopes = np.diff(hull[:, 1]) / np.diff(hull[:, 0])
        if slopes.max() > self.up or -slopes.min() > self.down or hull[:, 1].max() > self.ceiling:
            return None
        s = np.unique(np.r_[at, hull[:, 0]])
        s = s[np.r_[True, np.diff(s) > 0.05]]
        s[-1] = at[-1]
        return np.c_[np.interp(s, at, plane[:, 0]), np.interp(s, at, plane[:, 1]), np.interp(s, *hull.T)]

    def cheap_altitudes(self, plane, more_m=1.0):
        """A path in the plane with low altitudes: the least above the ground, by slopes of several limits,
        whichever costs least; None where slopes or ceiling allow none."""
        plane = np.asarray(plane)
        at, points = self.floor_along(plane, more_m)
        points = np.concatenate(
            [
                [[0.0, self.start[2]]],
                points[(points[:, 0] > 1e-6) & (points[:, 0] < at[-1] - 1e-6)],
                [[at[-1], self.goal[2]]],
            ]
        )
        s, floor = points.T
        best, least = None, math.inf
        for share in (1.0, 0.7, 0.5, 0.35, 0.2, 0.1):
            low = floor.copy()
            for k in range(1, len(low)):
                low[k] = max(low[k], low[k - 1] - share * self.down * (s[k] - s[k - 1]))
            for k in range(len(low) - 2, -1, -1):
                low[k] = max(low[k], low[k + 1] - share * self.up * (s[k + 1] - s[k]))
            if low[0] > self.start[2] + 1e-6 or low[-1] > self.goal[2] + 1e-6 or low.max() > self.ceiling:
                continue
            keep, first = [0], 0
            while first < len(s) - 1:
                last, steepest, flattest = first + 1, -math.inf, math.inf
                for k in range(first + 1, len(s)):
                    run = s[k] - s[first]
                    if run < 1e-6:
                        last = k
                        continue
                    slope = (low[k] - low[first]) / run
                    if steepest <= slope <= flattest:
                        last = k
                    steepest, flattest = max(steepest, slope - 0.9 / run), min(flattest, slope + 1.5 / run)
                    if steepest > flattest:
                        break
                keep.append(last)
                first = last
            z_at, z = s[keep], low[keep]
            # Two levels at one place: the vehicle climbs 1 m before it.
            all_s = np.unique(np.r_[at, z_at])
            all_s = all_s[np.r_[True, np.diff(all_s) > 0.3]]
            all_s[-1] = at[-1]
            path = np.c_[
                np.interp(all_s, at, plane[:, 0]),
                np.interp(all_s, at, plane[:, 1]),
                np.interp(all_s, z_at, z),
            ]
            cost = self.cost(path)
            if cost < least:
                best, least = path, cost
        return best

    def cost(self, places):
        """The cost of a path with the weights that a spec has by default: km, and km times km of altitude."""
        total = 0.0
        for a, b in zip(places[:-1], places[1:]):
            n = max(2, int(np.linalg.norm(b - a) / 20.0) + 1)
            t = (np.arange(n) + 0.5) / n
            middle = a + t[:, None] * (b - a)
            over = (
                self.ground_at(middle[:, :2]) if not self.is_flat() else self.ground(np.zeros(n), np.zeros(n))
            )
            high = np.maximum(middle[:, 2] - over - self.over_ground, 0.0)
            total += np.linalg.norm(b - a) * 1e-3 * (1.0 + high.mean() * 1e-3)
        return float(total)


def spline(x, y, at):
    """Cubic interpolation in an even grid."""
    t = (at - x[0]) / (x[1] - x[0])
    i = np.clip(t.astype(int), 1, len(x) - 3)
    t = t - i
    a, b, c, d = y[i - 1], y[i], y[i + 1], y[i + 2]
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))


# The peers, each in a process of its own.


def with_ompl(world, name, seconds, flat, until, given=None):
    """A path by a planner of OMPL, or a `given` one, simplified: places, and what happened."""
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_ERROR)
    check, dimensions = world.checker(flat), 2 if flat else 3
    # AORRTC has absolute tolerances that fit numbers of about 1 (issue 1420 of OMPL).
    scale = float((world.area.max(0) - world.area.min(0)).max())

    def may_fly(x0, y0, z0, x1, y1, z1, flat):
        return check(x0 * scale, y0 * scale, z0 * scale, x1 * scale, y1 * scale, z1 * scale, flat)

    space = base.RealVectorStateSpace(dimensions)
    bounds = base.RealVectorBounds(dimensions)
    low, high = [*world.area.min(0)], [*world.area.max(0)]
    if not flat:
        floor = (
            world.lowest.min()
            if world.lowest is not None
            else world.ground(np.zeros(1), np.zeros(1))[0] + world.over_ground
        )
        low, high = [*low, float(floor)], [*high, world.ceiling]
    for axis in range(dimensions):
        bounds.setLow(axis, float(low[axis]) / scale)
        bounds.setHigh(axis, float(high[axis]) / scale)
    space.setBounds(bounds)
    information = base.SpaceInformation(space)

    class Valid(base.StateValidityChecker):
        def isValid(self, state):
            x, y, z = state[0], state[1], 0.0 if flat else state[2]
            return bool(may_fly(x, y, z, x, y, z, flat))

    class Motion(base.MotionValidator):
        def checkMotion(self, a, b, *_):
            if flat:
                return bool(may_fly(a[0], a[1], 0.0, b[0], b[1], 0.0, 1))
            return bool(may_fly(a[0], a[1], a[2], b[0], b[1], b[2], 0))

    information.setStateValidityChecker(Valid(information))
    information.setMotionValidator(Motion(information))
    information.setup()
    objective = base.PathLengthOptimizationObjective(information)

    def state(place):
        made = space.allocState()
        for axis in range(dimensions):
            made[axis] = float(place[axis]) / scale
        return made

    problem = base.ProblemDefinition(information)
    problem.setStartAndGoalStates(state(world.start), state(world.goal), 0.01)
    problem.setOptimizationObjective(objective)
    began = time.process_time()
    notes = {}
    if given is None and may_fly(
        *(np.r_[world.start[:dimensions], np.zeros(3 - dimensions)] / scale),
        *(np.r_[world.goal[:dimensions], np.zeros(3 - dimensions)] / scale),
        int(flat),
    ):
        # Issue 1420 of OMPL: AORRTC returns a path of no length where the straight line is free.
        given = [world.start[:dimensions], world.goal[:dimensions]]
    if given is None:
        planner = {"BIT*": geometric.BITstar, "AORRTC": geometric.AORRTC}[name](information)
        planner.setProblemDefinition(problem)
        planner.setup()
        ends = began + 0.9 * seconds
        planner.solve(base.PlannerTerminationCondition(lambda: time.process_time() > ends))
        if not problem.hasExactSolution():
            return None, {"checks": world.checks()}
        path = problem.getSolutionPath()
    else:
        path = geometric.PathGeometric(information)
        for place in given:
            path.append(state(place))
    notes["before simplifying, m"] = path.length() * scale
    best = as_array(path, dimensions) * scale
    report(best, {**notes, "cpu_s": time.process_time() - began})
    simplifier = geometric.PathSimplifier(information)
    ends, round_ = began + seconds, 0
    while time.process_time() < ends:
        before, round_ = path.length(), round_ + 1
        # Finer steps each round: a rope of n pieces costs n^2 checks.
        piece_m = before / (50.0 * 2.0 ** min(round_, 3))
        for step in (
            lambda: simplifier.reduceVertices(path),
            lambda: simplifier.ropeShortcutPath(path, piece_m),
            lambda: simplifier.partialShortcutPath(path),
            lambda: simplifier.perturbPath(path, piece_m / 4.0, 50, 50),
            lambda: simplifier.reduceVertices(path),
            lambda: simplifier.collapseCloseVertices(path),
        ):
            if time.process_time() < ends:
                step()
        found = as_array(path, dimensions) * scale
        if length_m(found) < length_m(best) and all(
            motion(check, a, b, flat) for a, b in zip(found, found[1:])
        ):
            best = found
            report(best, {**notes, "cpu_s": time.process_time() - began})
        if round_ > 5 and path.length() > before * (1.0 - 1e-7):
            break
    notes["checks"] = world.checks()
    if flat:
        most = world.spec.get("mission", {}).get("max_items", 200) // 3
        best = with_fewer_corners(best, most, lambda a, b: motion(check, a, b, True))
    return best, notes


def with_fewer_corners(places, most, is_free):
    """Corners left out where the straight piece is free; then short pieces replaced by the point where
    their neighbours meet, those first that add the least length, while there are more than `most`."""
    places = list(np.asarray(places))
    index = 1
    while index < len(places) - 1:
        if is_free(places[index - 1], places[index + 1]):
            del places[index]
            index = max(1, index - 1)
        else:
            index += 1
    while len(places) - 2 > most:
        found = []
        for k in range(1, len(places) - 2):
            a, b, c, d = places[k - 1 : k + 3]
            along, back = b - a, c - d
            cross = along[0] * back[1] - along[1] * back[0]
            if abs(cross) < 1e-9:
                continue
            t = ((c - b)[0] * back[1] - (c - b)[1] * back[0]) / cross
            meet = b + t * along
            if t > 0.0 and (meet - c) @ back > 0.0:
                found.append((math.dist(b, meet) + math.dist(meet, c) - math.dist(b, c), k, meet))
        for _, k, meet in sorted(found, key=lambda one: one[0]):
            if is_free(places[k - 1], meet) and is_free(meet, places[k + 2]):
                places[k : k + 2] = [meet]
                break
        else:
            break
    return np.array(places)


def motion(may_fly, a, b, flat):
    z = [0.0, 0.0] if flat else [a[2], b[2]]
    return may_fly(a[0], a[1], z[0], b[0], b[1], z[1], int(flat))


def as_array(path, dimensions):
    return np.array([[state[axis] for axis in range(dimensions)] for state in path.getStates()])


def length_m(places):
    return float(np.linalg.norm(np.diff(np.asarray(places), axis=0), axis=1).sum())


def trapezoids(world, turned_rad):
    """The free plane as convex pieces, strips of one direction, and which of them touch."""
    import shapely

    closed, sides = [], 32 if len(world.discs) <= 20 else 12
    for x, y, r in world.discs:
        turn = np.arange(sides) * (2.0 * math.pi / sides)
        wide = r / math.cos(math.pi / sides)
        closed.append(shapely.Polygon(np.c_[x + wide * np.cos(turn), y + wide * np.sin(turn)]))
    for ring in world.closed:
        closed.append(shapely.Polygon(ring).buffer(world.zone_buffer, join_style="mitre"))
    if world.reachable is not None and world.reachable.any():
        # Closed nodes as squares that reach to the next node, then their outline with fewer corners.
        shut = world.reachable > 1.0
        boxes, step = [], world.spacing
        for row in range(shut.shape[0]):
            change = np.flatnonzero(np.diff(np.r_[0, shut[row].astype(int), 0]))
            y = world.low[1] + row * step
            for first, last in zip(change[::2], change[1::2]):
                boxes.append(
                    shapely.box(
                        world.low[0] + (first - 1) * step, y - step, world.low[0] + last * step, y + step
                    )
                )
        hull = shapely.union_all(boxes)
        closed.append(hull.buffer(1.5 * step, join_style="mitre").simplify(1.5 * step))
    area = shapely.Polygon(world.area).buffer(-world.zone_buffer, join_style="mitre").simplify(0.5)
    free = area.difference(shapely.union_all(closed)) if closed else area
    at = shapely.Point(world.start[:2])
    parts = [part for part in getattr(free, "geoms", [free]) if part.distance(at) < 1.0]
    if not parts:
        return [], []
    # On a grid of half a metre no piece is thinner than that, which the solver would not stand.
    turn = np.array(
        [[math.cos(turned_rad), math.sin(turned_rad)], [-math.sin(turned_rad), math.cos(turned_rad)]]
    )
    free = shapely.transform(parts[0], lambda places: places @ turn)
    free = shapely.set_precision(free.buffer(-0.36, join_style="mitre"), 0.5)
    at = shapely.Point(world.start[:2] @ turn)
    parts = [part for part in getattr(free, "geoms", [free]) if part.distance(at) < 2.0]
    if not parts:
        return [], []
    free = parts[0]
    rings = [np.array(ring.coords)[:-1] for ring in [free.exterior, *free.interiors]]
    edges = np.concatenate([np.c_[ring, np.roll(ring, -1, 0)] for ring in rings])
    edges = np.where((edges[:, 0] > edges[:, 2])[:, None], edges[:, [2, 3, 0, 1]], edges)
    xs = np.unique(np.round(edges[:, [0, 2]].ravel(), 3))
    xs = xs[np.r_[True, np.diff(xs) > 0.25]]
    height = lambda edge, x: edge[1] + (edge[3] - edge[1]) * (x - edge[0]) / (edge[2] - edge[0])
    opened, cells, last = {}, [], {}
    links = []
    for x0, x1 in zip(xs, xs[1:]):
        middle = 0.5 * (x0 + x1)
        crossing = [k for k in np.flatnonzero((edges[:, 0] < middle) & (edges[:, 2] > middle))]
        crossing.sort(key=lambda k: height(edges[k], middle))
        now = {}
        for lower, upper in zip(crossing[::2], crossing[1::2]):
            key = (lower, upper)
            if key in last:
                now[key] = last[key]
                cells[now[key]][1] = x1
            else:
                now[key] = len(cells)
                cells.append([x0, x1, lower, upper])
        for key, cell in now.items():
            if cells[cell][0] != x0:
                continue
            for other_key, other in last.items():
                if cells[other][1] != x0:
                    continue
                low = max(height(edges[key[0]], x0), height(edges[other_key[0]], x0))
                high = min(height(edges[key[1]], x0), height(edges[other_key[1]], x0))
                if high - low > 0.01:
                    links.append((other, cell))
        last = now
    corners = []
    for x0, x1, lower, upper in cells:
        corners.append(
            np.array(
                [
                    [x0, height(edges[lower], x0)],
                    [x1, height(edges[lower], x1)],
                    [x1, height(edges[upper], x1)],
                    [x0, height(edges[upper], x0)],
                ]
            )
        )
    return [ring @ turn.T for ring in corners], links


def with_gcs(world, seconds, turned_rad):
    """A path in the plane by Drake's graph of convex sets, through strips of one direction."""
    from pydrake.geometry.optimization import GraphOfConvexSetsOptions, HPolyhedron, Point
    from pydrake.planning import GcsTrajectoryOptimization
    from pydrake.solvers import ClarabelSolver

    corners, links = trapezoids(world, turned_rad)
    notes = {"regions": len(corners)}
    if not corners:
        return None, notes
    scale = 1000.0
    regions = []
    for ring in corners:
        ring = ring / scale
        rows, limits = [], []
        for a, b in zip(ring, np.roll(ring, -1, 0)):
            out = np.array([b[1] - a[1], a[0] - b[0]])
            size = np.linalg.norm(out)
            if size > 1e-9:
                rows.append(out / size)
                limits.append(out @ a / size)
        regions.append(HPolyhedron(np.array(rows), np.array(limits)))
    optimization = GcsTrajectoryOptimization(2)
    both = links + [(b, a) for a, b in links]
    free = optimization.AddRegions(
        regions=regions, edges_between_regions=both, order=1, h_min=1e-6, h_max=1000.0, name="free"
    )
    start = optimization.AddRegions([Point(world.start[:2] / scale)], order=0, name="start")
    goal = optimization.AddRegions([Point(world.goal[:2] / scale)], order=0, name="goal")
    optimization.AddEdges(start, free)
    optimization.AddEdges(free, goal)
    optimization.AddPathLengthCost()
    options = GraphOfConvexSetsOptions()
    options.convex_relaxation, options.preprocessing = True, True
    options.max_rounded_paths, options.max_rounding_trials = 100, 1000
    options.solver = ClarabelSolver()
    trajectory, result = optimization.SolvePath(start, goal, options)
    if not result.is_success():
        return None, notes
    places = [trajectory.segment(0).control_points()[:, 0]]
    for index in range(trajectory.get_number_of_segments()):
        places += [*trajectory.segment(index).control_points().T]
    places = scale * np.array(places)
    keep = np.r_[True, np.linalg.norm(np.diff(places, axis=0), axis=1) > 1e-3]
    places = places[keep]
    places[0], places[-1] = world.start[:2], world.goal[:2]
    notes["before simplifying, m"] = length_m(places)
    return places, notes


def report(places, notes):
    print(
        json.dumps({"places": None if places is None else np.asarray(places).tolist(), **notes}), flush=True
    )


def work(spec, name, flat, seconds, margin_m):
    """One run of a peer: prints its path as JSON."""
    world = World(spec, margin_m)
    # Compiled, loaded and read before the time begins.
    if name == "GCS":
        import pydrake.planning
        import pydrake.solvers
    import ompl.geometric
    import shapely

    world.checker(flat)
    began = time.process_time()
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(began + seconds), math.ceil(began + seconds) + 1))
    if name == "GCS":
        best, notes = None, {}
        for turned_rad in (0.5 * math.pi, 0.0, 0.25 * math.pi):
            left = seconds - (time.process_time() - began)
            if notes and left < 1.5 * max(notes["each_s"]) + 5.0:
                break
            from_s = time.process_time()
            found, more = with_gcs(world, seconds, turned_rad)
            notes.setdefault("regions", []).append(more["regions"])
            notes.setdefault("lengths_m", []).append(None if found is None else length_m(found))
            notes.setdefault("each_s", []).append(time.process_time() - from_s)
            if found is not None and (best is None or length_m(found) < length_m(best)):
                best = found
            report(best, {**notes, "cpu_s": time.process_time() - began})
        places, rest = best, min(6.0, seconds - 1.0 - (time.process_time() - began))
        if places is not None and rest > 0.5:
            places, more = with_ompl(world, name, rest, True, None, places)
            notes = {**more, **notes}
    else:
        places, notes = with_ompl(world, name, seconds - 1.0, flat, None)
    report(places, {**notes, "cpu_s": time.process_time() - began})


# The judge.


def alone(spec, folder, altitude_weight):
    """A copy of the spec with its first vehicle alone, which lands at its goal."""
    document = yaml.safe_load(Path(spec).read_text())
    vehicle, folder = document["vehicles"][0], Path(folder)
    vehicle.update(finish="land")
    vehicle.pop("depart_s", None)
    document["vehicles"] = [vehicle]
    document.setdefault("planner", {})["weights"] = {"altitude": altitude_weight}
    copy = folder / Path(spec).name
    copy.write_text(yaml.safe_dump(document, sort_keys=False))
    if "file" in document["terrain"]:
        there = folder / document["terrain"]["file"]
        there.parent.mkdir(parents=True, exist_ok=True)
        if not there.exists():
            there.symlink_to((Path(spec).parent / document["terrain"]["file"]).resolve())
    return copy


def mission(world, places, hold_s):
    """The mission that flies a path, as QGC WPL 110."""
    lat, lon = world.frame.degrees(places[:, :2])
    home = world.vehicle.get("home") or world.vehicle["start"]
    ground = world.ground(np.array([home["lat"]]), np.array([home["lon"]]))[0]
    begin = world.vehicle["start"]
    rows = [
        [16, 0, 0, 0, 0, home["lat"], home["lon"], ground],
        [22, 0, 0, 0, 0, begin["lat"], begin["lon"], places[0, 2]],
    ]
    rows.append([178, 1, world.vehicle["speed_mps"], -1, 0, 0, 0, 0])
    # The takeoff ends at the start, which is the first corner.
    for index, (a, o, place) in enumerate(zip(lat, lon, places)):
        rows.append([16, hold_s if 0 < index < len(places) - 1 else 0, 0, 0, 0, a, o, place[2]])
    end = world.vehicle["goal"]
    floor = world.ground(np.array([end["lat"]]), np.array([end["lon"]]))[0]
    rows.append([21, 0, 0, 0, 0, end["lat"], end["lon"], floor])
    lines = ["QGC WPL 110"]
    for index, (command, *parameters) in enumerate(rows):
        frame = 2 if command == 178 else 0
        numbers = (
            [f"{value:.9g}" for value in parameters[:4]]
            + [f"{value:.7f}" for value in parameters[4:6]]
            + [f"{parameters[6]:.3f}"]
        )
        lines.append("\t".join([str(index), str(int(index == 0)), str(frame), str(command), *numbers, "1"]))
    return "\n".join(lines) + "\n"


def legs(world, file):
    """The places of the encoded items from start to goal."""
    rows = [line.split("\t") for line in Path(file).read_text().splitlines()[1:]]
    rows = [row for row in rows[1:] if row[3] in ("16", "17", "82")]
    degrees = np.array([[float(row[8]), float(row[9])] for row in rows])
    places = np.c_[world.frame.plan(*degrees.T), [float(row[10]) for row in rows]]
    return (
        np.concatenate([[world.start], places, [world.goal]])
        if len(places)
        else np.array([world.start, world.goal])
    )


def review(sortie, spec, file):
    """What `sortie review` says of a mission: the limits it breaks, and when it reaches its goal."""
    vehicle = yaml.safe_load(Path(spec).read_text())["vehicles"][0]["id"]
    done = subprocess.run(
        [sortie, "review", spec, "--vehicle", f"{vehicle}={file}", "--json"],
        capture_output=True,
        check=False,
        text=True,
    )
    try:
        found = json.loads(done.stdout)
    except json.JSONDecodeError:
        return [done.stderr.strip()[:300]], None
    broken = [m for m in found["margins"] if not m["ok"] and m["what"] not in BY_PARAMETERS]
    goal = next((m["at"]["t_s"] for m in found["margins"] if m["what"] == "goal" and m["at"]), None)
    return [f"{m['what']}: {m['value']:.2f} {m['unit']} (limit {m['limit']:g})" for m in broken], goal


def judge(sortie, world, places, flat, file):
    """Writes the mission of a path, as it passes the review if it does; returns its figures."""
    best = None
    for more_m in [0.1, 1.0, 3.0] if flat else [0.0]:
        path = world.shortest_altitudes(places, more_m) if flat else np.asarray(places)
        if path is None:
            best = best or {"passes": False, "broken": ["no altitudes within slopes and ceiling"]}
            continue
        for hold_s in (0,) if world.margin_m else (0, 1):
            file.write_text(mission(world, path, hold_s))
            broken, goal_s = review(sortie, world.path, file)
            found = {
                "passes": not broken,
                "broken": broken,
                "hold_s": hold_s,
                "corners": len(path) - 2,
                "goal_s": goal_s,
            }
            found["length_m"] = length_m(legs(world, file))
            if not broken:
                return found
            best = found
    return best


def children_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_sortie(sortie, spec, world, folder, limit_s, figure="length_m"):
    """The best plan of Sortie within the processor time, reading the spec apart."""
    times = []
    for _ in range(3):
        before = children_s()
        subprocess.run([sortie, "check", spec], capture_output=True, check=False)
        times.append(children_s() - before)
    read_s, best = min(times), None
    for evaluations in EVALUATIONS:
        out = folder / f"out-{evaluations}"
        before = children_s()
        done = subprocess.run(
            [sortie, "plan", spec, "--evaluations", str(evaluations), "--out", out, "--json"],
            capture_output=True,
            check=False,
            text=True,
        )
        took = children_s() - before - read_s
        # Where even the least plan takes longer, so may others, if not by more than a tenth.
        limit_s = max(limit_s, 1.1 * took) if best is None else limit_s
        if took > limit_s:
            break
        plan = json.loads(done.stdout)
        found = {
            "evaluations": evaluations,
            "cpu_s": took,
            "read_s": read_s,
            "passes": plan["verdict"] == "pass",
        }
        file = next(out.glob("*.waypoints"), None)
        if file:
            vehicle = plan["vehicles"][0]
            found["length_m"] = length_m(legs(world, file))
            found["cost_length_m"], found["cost"], found["bound"] = (
                vehicle["cost"]["length"] * 1e3,
                vehicle["cost"]["total"],
                vehicle["bound"],
            )
            found["broken"], found["goal_s"] = review(sortie, spec, file)
            found["mission"] = file.read_text()
        is_better = not best or (found["passes"], -found.get(figure, 1e99)) > (
            best["passes"],
            -best.get(figure, 1e99),
        )
        best = found if is_better else best
    return best


def run_peer(sortie, spec, world, name, seconds, folder, in_space):
    """The best path of a peer: in the plane, and also in space if asked for and altitudes matter."""
    settings = [(True, seconds)]
    if in_space and name != "GCS" and world.lowest is not None:
        settings = [(True, seconds / 2.0), (False, seconds / 2.0)]
    best, tried = None, []
    for flat, share_s in settings:
        command = [
            sys.executable,
            __file__,
            "--work",
            spec,
            name,
            str(int(flat)),
            str(share_s),
            str(world.margin_m),
        ]
        done = subprocess.run(command, capture_output=True, check=False, text=True)
        lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        ran = lines[-1] if lines else {"places": None}
        found = {
            "state": "plane" if flat else "space",
            "cpu_s": ran.get("cpu_s"),
            "notes": {k: v for k, v in ran.items() if k != "places"},
        }
        if not lines or (done.returncode and ran["places"] is None):
            last = done.stderr.strip().splitlines()[-1:] or [""]
            found["error"] = "time is up" if done.returncode in (-24, -9) else last[0][:200]
        if ran["places"] is not None:
            file = folder / f"{name.replace('*', 'star')}-{found['state']}.waypoints"
            found.update(judge(sortie, world, ran["places"], flat, file))
            if file.exists():
                found["mission"] = file.read_text()
        found.setdefault("passes", False)
        tried.append(
            {k: found.get(k) for k in ("state", "length_m", "passes", "broken", "notes", "error", "cpu_s")}
        )
        better = best is None or (found["passes"], "length_m" in found, -found.get("length_m", 1e99)) > (
            best["passes"],
            "length_m" in best,
            -best.get("length_m", 1e99),
        )
        best = found if better else best
    return {**best, "tried": tried}


def price(sortie, world, run, folder):
    """The cost, with the weights of a spec by default, of the plane path of a peer at low altitudes, and
    whether it passes the review."""
    file = folder / "priced.waypoints"
    file.write_text(run["mission"])
    plane = legs(world, file)[:, :2]
    plane = plane[np.r_[True, np.linalg.norm(np.diff(plane, axis=0), axis=1) > 0.01]]
    best = {"passes": False}
    for more_m in (1.0, 3.0):
        path = world.cheap_altitudes(plane, more_m)
        if path is None:
            continue
        for hold_s in (0,) if world.margin_m else (0, 1):
            file.write_text(mission(world, path, hold_s))
            broken, goal_s = review(sortie, world.path, file)
            best = {
                "passes": not broken,
                "broken": broken,
                "cost": world.cost(legs(world, file)),
                "hold_s": hold_s,
                "goal_s": goal_s,
            }
            best["mission"] = file.read_text()
            if not broken:
                return best
    return best


def table(runs, maps, figure, scale):
    """Markdown: one row a map, a figure of all, in km."""
    ours_name, suffix = ("sortie", "") if figure == "length_m" else ("sortie, cost", ", cost")
    what = "length" if figure == "length_m" else "cost"
    print(
        f"| map, {what} in km | proven bound | Sortie | evaluations, s | "
        + " | ".join(PEERS)
        + " | best peer against Sortie |"
    )
    print("|---|--:|--:|--:|" + "--:|" * len(PEERS) + "--:|")
    for name in maps:
        ours = runs.get((name, ours_name))
        if not ours or figure not in ours:
            continue
        cells, peers = [], []
        for peer in PEERS:
            run = runs.get((name, peer + suffix))
            if run is None:
                found = runs.get((name, peer))
                cells.append("not run" if found is None else "not priced" if "length_m" in found else "none")
            elif figure not in run:
                cells.append("none")
            elif not run["passes"]:
                cells.append(f"{scale * run[figure]:.3f}, fails")
            else:
                cells.append(f"{scale * run[figure]:.3f}")
                peers.append(run[figure])
        against = f"{100.0 * (min(peers) / ours[figure] - 1.0):+.2f} %" if peers else ""
        own = f"{scale * ours[figure]:.3f}" + ("" if ours["passes"] else ", fails")
        print(
            f"| {name} | {ours['bound']:.3f} | {own} | {ours['evaluations']}, {ours['cpu_s']:.2f} | "
            + " | ".join(cells)
            + f" | {against} |"
        )


def generated_or_shipped(sortie, name, how, folder):
    """The spec of a map, in a folder of its own, with one vehicle."""
    its = folder / name
    its.mkdir()
    spec = its / f"{name}.yaml"
    if isinstance(how, list):
        subprocess.run([sortie, "study", "scenario", *how, "-o", spec], check=True, stdout=subprocess.DEVNULL)
    else:
        document = yaml.safe_load(how[0].read_text())
        document["vehicles"] = [document["vehicles"][how[1]]]
        spec.write_text(yaml.safe_dump(document, sort_keys=False))
        if "file" in document["terrain"]:
            terrain = its / document["terrain"]["file"]
            terrain.parent.mkdir(parents=True, exist_ok=True)
            terrain.symlink_to((how[0].parent / document["terrain"]["file"]).resolve())
    alone_in = its / "alone"
    alone_in.mkdir()
    return alone(spec, alone_in, 0)


def main():
    if sys.argv[1:2] == ["--work"]:
        return work(sys.argv[2], sys.argv[3], bool(int(sys.argv[4])), float(sys.argv[5]), float(sys.argv[6]))
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sortie", type=Path, help="the program")
    parser.add_argument("specs", nargs="*", help="besides the generated and shipped ones")
    parser.add_argument("--seeds", type=int, default=1, help="of each family")
    parser.add_argument("--only", help="maps whose name matches")
    parser.add_argument("--seconds", type=float, default=PEER_S)
    parser.add_argument("--records", type=Path, default=ROOT / "target/planners/runs.jsonl")
    parser.add_argument("--peers", nargs="*", default=PEERS, choices=PEERS, help="only these")
    parser.add_argument(
        "--margin",
        type=float,
        default=0.0,
        metavar="M",
        help="metres that peers keep besides from threats and zones, and then never stop at corners",
    )
    parser.add_argument("--space", action="store_true", help="half of the time of BIT* and AORRTC in space")
    parser.add_argument("--as-is", action="store_true", help="no further runs, the table alone")
    arguments = parser.parse_args()
    sortie = arguments.sortie.resolve()
    arguments.records.parent.mkdir(parents=True, exist_ok=True)
    runs = {}
    if arguments.records.exists():
        for line in arguments.records.read_text().splitlines():
            run = json.loads(line)
            runs[run["map"], run["planner"]] = run
    with tempfile.TemporaryDirectory() as folder, arguments.records.open("a") as records:
        folder, specs = Path(folder), {}
        for seed in range(1, arguments.seeds + 1):
            for family in FAMILIES:
                specs[f"{family}-{seed}"] = ["--family", family, "--seed", str(seed)]
        for difficulty in (1, 5, 10):
            specs[f"generated-{difficulty}"] = ["--difficulty", str(difficulty), "--seed", "1"]
        missions = ROOT / "missions"
        specs["first"] = (missions / "first.yaml", 0)
        for index, vehicle in enumerate(["alpha", "bravo", "charlie"]):
            specs[f"jacksboro-{vehicle}"] = (missions / "jacksboro.yaml", index)
        for spec in map(Path, arguments.specs):
            specs[spec.stem] = (spec, 0)
        specs = {name: how for name, how in specs.items() if re.search(arguments.only or "", name)}
        copies = (
            {}
            if arguments.as_is
            else {name: generated_or_shipped(sortie, name, how, folder) for name, how in specs.items()}
        )
        for planner in ["sortie", *(peer for peer in reversed(PEERS) if peer in arguments.peers)]:
            for name, copy in copies.items():
                if (name, planner) in runs:
                    continue
                world = World(copy, arguments.margin)
                if planner == "sortie":
                    run = run_sortie(sortie, copy, world, copy.parent, SORTIE_S)
                else:
                    run = run_peer(
                        sortie, copy, world, planner, arguments.seconds, copy.parent, arguments.space
                    )
                run = {"map": name, "planner": planner, "spec": copy.read_text(), **run}
                runs[name, planner] = run
                records.write(json.dumps(run) + "\n")
                records.flush()
                shown = {
                    k: run[k]
                    for k in (
                        "length_m",
                        "passes",
                        "cpu_s",
                        "error",
                        "broken",
                        "hold_s",
                        "evaluations",
                        "bound",
                    )
                    if run.get(k) is not None
                }
                print(name, planner, shown, file=sys.stderr, flush=True)
        for name, copy in copies.items():
            world = None
            for planner in ["sortie", *PEERS]:
                run = runs.get((name, planner), {})
                if "mission" not in run or (name, f"{planner}, cost") in runs:
                    continue
                world = world or World(copy, arguments.margin)
                if planner == "sortie":
                    by_cost = copy.parent / "cost"
                    by_cost.mkdir()
                    spec = alone(copy, by_cost, 1)
                    found = run_sortie(sortie, spec, world, by_cost, SORTIE_S, "cost")
                else:
                    found = price(sortie, world, run, copy.parent)
                found = {"map": name, "planner": f"{planner}, cost", **found}
                runs[name, found["planner"]] = found
                records.write(json.dumps(found) + "\n")
                records.flush()
                print(
                    name,
                    found["planner"],
                    found.get("cost"),
                    found["passes"],
                    found.get("broken"),
                    file=sys.stderr,
                    flush=True,
                )
        table(runs, specs, "length_m", 1e-3)
        print()
        table(runs, specs, "cost", 1.0)


if __name__ == "__main__":
    sys.exit(main())
