#!/usr/bin/env python3
"""Accepts or rejects the certificate of a bound: tools/check_certificate.py SPEC DIR

Reads the spec, the terrain and DIR/certificate.json by itself; no code is shared with the program.
What is checked, for each route:

- start, goal, slopes, weights and buffers are those of the spec;
- the mesh is a triangulation of a polygon that holds every path up to `longest_m`;
- the floor is nowhere above the lowest altitude that the spec allows;
- where a path may be, the potential rises by no more than the least cost, along no slope that the
  vehicle can fly; it may do so in triangles that are closed: beyond `longest_m`, inside of a threat
  or a zone, outside of the area, above the ceiling;
- the bound is no more than the potential rises from start to goal, over the most that it is too
  steep by, or no more than start and goal prove: the straight line, and over flat ground the cheapest
  way down from their heights and up to them (a route that is null has this bound).

Exit code: 0 accepted, 1 rejected, 2 not a certificate that can be checked.
"""

import argparse
import hashlib
import json
import math
import sys
from pathlib import Path

import numpy as np
import shapely
import yaml

from second.earth import Ground, axes, ecef, geodetic

DEFAULT_BUFFER_M, WING_BUFFER_M = 10.0, 15.0
EDGE_PIECE_M = 5000.0
TOLERANCE_SHARE, TOLERANCE_KM = 1e-6, 1e-4
CLIMB = (-1.5377e-10, -2.6997e-5, 0.4211)
DESCENT = (-2.5063e-9, 6.3014e-6, 0.3257)
POLYNOMIAL_TOP_M = 12_000.0
LEAST_RETURN_M = 10.0


class Rejected(Exception):
    """Why a certificate proves nothing."""


class Unknown(Exception):
    """What this checker cannot judge."""


def demand(holds, why):
    if not holds:
        raise Rejected(why)


class Earth:
    """Planning coordinates: east and north of the tangent plane at the origin."""

    def __init__(self, spec):
        area = spec["area"]
        corners = area["south_west"], area["north_east"]
        middle = {key: (corners[0][key] + corners[1][key]) / 2 for key in ("lat", "lon")}
        origin = spec.get("origin", middle)
        self.origin = origin["lat"], origin["lon"]
        self.east, self.north = axes(*self.origin)
        self.foot = ecef(*self.origin)

    def plan(self, lat, lon):
        away = ecef(np.asarray(lat, float), np.asarray(lon, float)) - self.foot
        return np.stack([away @ self.east, away @ self.north], axis=-1)

    def places(self, plan):
        """Latitude and longitude of points of the plane."""
        up = np.cross(self.east, self.north)
        out = plan[..., :1] * self.east + plan[..., 1:] * self.north + self.foot
        lift = np.zeros(plan.shape[:-1])
        for _ in range(5):
            found = geodetic(out + lift[..., None] * up)
            error = plan - self.plan(*found)
            out = out + error[..., :1] * self.east + error[..., 1:] * self.north
        return geodetic(out + lift[..., None] * up)

    def ring(self, corners):
        """A ring whose edges are straight in latitude and longitude."""
        points = []
        for (lat, lon), (to_lat, to_lon) in zip(corners, corners[1:] + corners[:1]):
            length = float(np.linalg.norm(ecef(lat, lon) - ecef(to_lat, to_lon)))
            pieces = max(1, math.ceil(length / EDGE_PIECE_M))
            for piece in range(pieces):
                share = piece / pieces
                points.append(self.plan(lat + (to_lat - lat) * share, lon + (to_lon - lon) * share))
        return shapely.Polygon(points)


class World:
    """What the spec allows."""

    def __init__(self, path):
        self.spec = spec = yaml.safe_load(path.read_text())
        for key in ("airspace", "obstacles"):
            if spec.get(key):
                raise Unknown(f"`{key}` is not known to this checker")
        self.earth = Earth(spec)
        self.buffers = self.read_buffers(spec)
        area = spec["area"]
        self.top_m = area["max_amsl_m"] - self.buffers["ceiling"]
        self.over_m = area["min_agl_m"] + self.buffers["terrain"]
        south, west = area["south_west"]["lat"], area["south_west"]["lon"]
        north, east = area["north_east"]["lat"], area["north_east"]["lon"]
        outline = self.earth.ring([(south, west), (south, east), (north, east), (north, west)])
        self.area = outline.buffer(-self.buffers["area"], join_style="mitre")
        self.discs = [
            (self.earth.plan(one["lat"], one["lon"]), one["radius_m"] + self.buffers["threats"])
            for one in spec.get("threats") or []
        ]
        self.polygons, self.lids = [], []
        for zone in spec.get("no_fly") or []:
            ring = self.earth.ring([tuple(corner) for corner in zone["polygon"]]).buffer(self.buffers["zones"])
            if "below_amsl_m" in zone:
                self.lids.append((ring, zone["below_amsl_m"] + self.buffers["zones"]))
            else:
                self.polygons.append(ring)
        for zone in spec.get("zones") or []:
            self.read_zone(zone)
        weights = (spec.get("planner") or {}).get("weights") or {}
        self.weights = weights.get("length", 1.0), weights.get("altitude", 1.0)
        self.terrain = self.read_terrain(path.parent, spec["terrain"])

    def read_zone(self, zone):
        """Zones that are closed at all times from the ground up; others close nothing for certain."""
        if zone.get("keep_in") or zone.get("active") or zone.get("holes") or "floor" in zone:
            return
        buffer_m = self.buffers["zones"]
        ceiling = zone.get("ceiling")
        if ceiling is not None and "amsl_m" not in ceiling:
            return
        if "circle" in zone:
            circle = zone["circle"]
            if ceiling is None:
                self.discs.append((self.earth.plan(circle["lat"], circle["lon"]), circle["radius_m"] + buffer_m))
            return
        ring = self.earth.ring([tuple(corner) for corner in zone["polygon"]]).buffer(buffer_m)
        if ceiling is None:
            self.polygons.append(ring)
        else:
            self.lids.append((ring, ceiling["amsl_m"] + buffer_m))

    @staticmethod
    def read_buffers(spec):
        if spec["sortie"] == 1:
            default, given = 0.0, {}
        else:
            given = spec.get("buffer_m") or {}
            wings = any(one.get("airframe", "copter") != "copter" for one in spec["vehicles"])
            default = given.get("all", WING_BUFFER_M if wings else DEFAULT_BUFFER_M)
        return {key: given.get(key, default) for key in ("threats", "zones", "area", "terrain", "ceiling")}

    def read_terrain(self, folder, source):
        if "flat" in source:
            return Flat(source["flat"]["amsl_m"])
        if "analytic" in source:
            return Hills(self.earth, source["analytic"])
        return Grid(self.earth, folder / source["file"])

    def height_m(self, lat, lon):
        return self.terrain.height_m(lat, lon)


class Flat:
    is_flat = True

    def __init__(self, amsl_m):
        self.amsl_m = amsl_m

    def height_m(self, lat, lon):
        return self.amsl_m


class Hills:
    """Gaussian hills; between points of a lattice they bend by a known amount."""

    is_flat = False
    METRES_PER_DEGREE = 111_195.08
    PIECES = 8

    def __init__(self, earth, source):
        self.earth, self.base = earth, source["base_amsl_m"]
        self.hills = source.get("hills") or []

    def height_m(self, lat, lon):
        total = np.full(np.shape(lat), float(self.base))
        for hill in self.hills:
            north = (lat - hill["lat"]) * self.METRES_PER_DEGREE
            east = (lon - hill["lon"]) * self.METRES_PER_DEGREE * math.cos(math.radians(hill["lat"]))
            total = total + hill["height_m"] * np.exp(-(north**2 + east**2) / hill["radius_m"] ** 2)
        return total

    def differences(self, corners, planes):
        """Least and greatest of ground less plane over triangles, shape (n, 3, 2) and (n, 3)."""
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max(axis=1)
        bend = np.zeros(len(corners))
        for hill in self.hills:
            away = np.linalg.norm(corners[:, 0] - self.earth.plan(hill["lat"], hill["lon"]), axis=-1) - sides
            share = (np.maximum(away, 0) / (1.05 * hill["radius_m"])) ** 2
            narrow = hill["radius_m"] / 1.05
            bend += 2 * abs(hill["height_m"]) / narrow**2 * np.minimum(1, (1 + 2 * share) * np.exp(-share))
        slack = (sides / self.PIECES) ** 2 / 6 * bend + 0.01
        low, high = np.full(len(corners), np.inf), np.full(len(corners), -np.inf)
        for first in range(self.PIECES + 1):
            for second in range(self.PIECES + 1 - first):
                shares = np.array([first, second, self.PIECES - first - second]) / self.PIECES
                at = np.einsum("c,ncx->nx", shares, corners)
                over = self.height_m(*self.earth.places(at)) - planes @ shares
                low, high = np.minimum(low, over), np.maximum(high, over)
        return low - slack, high + slack


class Grid:
    """A grid of latitude and longitude, bilinear between its nodes."""

    is_flat = False

    def __init__(self, earth, path):
        self.earth, self.ground = earth, Ground(path)
        rows, columns = self.ground.heights.shape
        lat = self.ground.north - np.arange(rows) * self.ground.step[1]
        lon = self.ground.west + np.arange(columns) * self.ground.step[0]
        self.places = earth.plan(*np.meshgrid(lat, lon, indexing="ij"))

    def height_m(self, lat, lon):
        return self.ground.height(lat, lon)

    def differences(self, corners, planes):
        """Least and greatest of ground less plane over triangles, by the corners of every cell that
        touches them: bilinear less linear is greatest at a corner of a cell."""
        lat, lon = self.earth.places(corners)
        row = (self.ground.north - lat) / self.ground.step[1]
        column = (lon - self.ground.west) / self.ground.step[0]
        rows, columns = self.ground.heights.shape
        demand((row.min() >= 0) & (row.max() <= rows - 1), "an open triangle reaches beyond the terrain")
        demand((column.min() >= 0) & (column.max() <= columns - 1), "an open triangle reaches beyond the terrain")
        top, bottom = np.floor(row.min(1) - 0.01), np.ceil(row.max(1) + 0.01)
        left, right = np.floor(column.min(1) - 0.01), np.ceil(column.max(1) + 0.01)
        low, high = np.full(len(corners), np.inf), np.full(len(corners), -np.inf)
        box = np.stack([top, bottom, left, right], axis=1).astype(int).clip(0)
        for index, (r0, r1, c0, c1) in enumerate(box):
            low[index], high[index] = self.of_triangle(corners[index], planes[index], r0, r1, c0, c1)
        return low - 0.01, high + 0.01

    def of_triangle(self, corners, plane, r0, r1, c0, c1):
        at = self.places[r0 : r1 + 1, c0 : c1 + 1]
        over = self.ground.heights[r0 : r1 + 1, c0 : c1 + 1] - plane_at(corners, plane, at)
        # Cells that a triangle touches: not all nodes on one outer side of it.
        outside = np.zeros((over.shape[0] - 1, over.shape[1] - 1), bool)
        for share in barycentric(corners, at):
            beyond = share < -1e-6
            outside |= beyond[:-1, :-1] & beyond[1:, :-1] & beyond[:-1, 1:] & beyond[1:, 1:]
        cells = ~outside
        stacked = np.stack([over[:-1, :-1], over[1:, :-1], over[:-1, 1:], over[1:, 1:]])[:, cells]
        return stacked.min(), stacked.max()


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def barycentric(corners, at):
    a, b, c = corners
    whole = cross(b - a, c - a)
    first, second = cross(b - at, c - at) / whole, cross(c - at, a - at) / whole
    return first, second, 1 - first - second


def plane_at(corners, plane, at):
    return sum(share * value for share, value in zip(barycentric(corners, at), plane))


def slope(vehicle, key, polynomial, top_m):
    """The steepest slope that the vehicle may have at any altitude."""
    if key in vehicle:
        return math.tan(math.radians(vehicle[key]))
    z = np.linspace(0, min(max(top_m, 0), POLYNOMIAL_TOP_M), 2001)
    return float(np.maximum(0, (polynomial[0] * z + polynomial[1]) * z + polynomial[2]).max())


def stops_of_tasks(spec, plan):
    """The stops that a plan gives each vehicle for its tasks, those at places of the spec held against it."""
    known = {}
    for task in spec["tasks"]:
        if "visit" in task:
            known[task["id"]] = task["visit"]
        for key in ("from", "to"):
            if "deliver" in task:
                known[f"{task['id']}.{key}"] = task["deliver"][key]
    for vehicle in spec["vehicles"]:
        known.update({stop["id"]: stop for stop in vehicle.get("stops") or []})
    stops, visited = {}, []
    for vehicle in plan["vehicles"]:
        stops[vehicle["id"]] = [
            {"id": stop["id"], "lat": stop["lat_deg"], "lon": stop["lon_deg"], "amsl_m": stop["amsl_m"]}
            for stop in vehicle.get("stops") or []
        ]
        for stop in stops[vehicle["id"]]:
            for name in stop["id"].split(" + "):
                if name in known:
                    visited.append(name)
                    off = max(abs(stop[key] - known[name][key]) for key in ("lat", "lon"))
                    demand(off < 1e-7, f"{vehicle['id']}: stop {name} is not where the spec has it")
    demand(len(visited) == len(set(visited)), "a place of the spec is visited twice")
    return stops


def ends_of(world, vehicle):
    """Start and goal of each route: east, north, altitude."""
    if vehicle.get("airframe", "copter") != "copter" and vehicle.get("finish", "land") == "land":
        raise Unknown(f"{vehicle['id']}: approaches to landings are not known to this checker")
    if vehicle.get("order", "fixed") != "fixed":
        raise Unknown(f"{vehicle['id']}: a free order of stops is not known to this checker")

    def end(place):
        at = world.earth.plan(place["lat"], place["lon"])
        if "amsl_m" in place:
            return np.array([*at, place["amsl_m"]])
        return np.array([*at, place["agl_m"] + float(world.height_m(place["lat"], place["lon"]))])

    points = [end(vehicle["start"])] + [end(stop) for stop in vehicle.get("stops") or []]
    goal = vehicle.get("goal", vehicle["start"])
    points.append(end(goal))
    # Over a goal below the least height, a drop, the route ends above it.
    least = float(world.height_m(goal["lat"], goal["lon"])) + world.over_m
    points[-1][2] = max(points[-1][2], least)
    if vehicle.get("finish", "land") == "return":
        home = vehicle.get("home", vehicle["start"])
        at = world.earth.plan(home["lat"], home["lon"])
        # After stops, a goal over home is the end.
        if not vehicle.get("stops") or np.linalg.norm(at - points[-1][:2]) >= LEAST_RETURN_M:
            # A copter comes home as high as it started; where a wing begins to come down is not known here.
            is_copter = vehicle.get("airframe", "copter") == "copter"
            points.append(np.array([*at, points[0][2]]) if is_copter else at)
    return list(zip(points, points[1:]))


def check_mesh(route, nodes, triangles):
    """A triangulation of a simple polygon, the whole grid of rows and columns."""
    corners = nodes[triangles]
    turned = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    demand((turned > 0).all(), "a triangle of the mesh is turned over")
    grid = np.arange(len(nodes)).reshape(route["rows"], route["columns"])
    border = np.concatenate([grid[0, :-1], grid[:-1, -1], grid[-1, :0:-1], grid[:0:-1, 0]])
    polygon = shapely.Polygon(nodes[border])
    demand(polygon.is_valid and polygon.exterior.is_ccw, "the border of the mesh crosses itself")
    return np.isin(triangles, border).sum(axis=1) >= 2


def triangles_of(rows, columns):
    row, column = (one.ravel() for one in np.mgrid[: rows - 1, : columns - 1])
    a = row * columns + column
    b, c, d = a + 1, a + columns + 1, a + columns
    even = ((row + column) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    second = np.where(even, np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    return np.stack([first, second], axis=1).reshape(-1, 3)


def closed_in_plane(world, corners, ends, longest_m):
    """Which triangles are closed at every altitude, and which lie beyond every path that counts."""
    middle = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=-1).max(axis=1)
    start, goal = ends
    by_it = np.linalg.norm(middle - start, axis=-1) + np.linalg.norm(middle - goal, axis=-1) - 2 * reach
    beyond = by_it >= longest_m
    closed = beyond.copy()
    for center, radius_m in world.discs:
        closed |= (np.linalg.norm(corners - center, axis=-1) <= radius_m).all(axis=1)
    shapes = shapely.polygons(np.concatenate([corners, corners[:, :1]], axis=1))
    closed |= ~shapely.intersects(world.area, shapes)
    for ring in world.polygons:
        shapely.prepare(ring)
        closed |= shapely.contains(ring, shapes)
    lid = np.full(len(corners), -np.inf)
    for ring, top_m in world.lids:
        lid = np.where(shapely.contains(ring, shapes), np.maximum(lid, top_m), lid)
    return closed, beyond, lid


def rate(along, up, climb, descent):
    """How much a potential rises at most per km of a path."""
    with np.errstate(divide="ignore", invalid="ignore"):
        free = np.where(along > 0, up / along, np.where(up > 0, np.inf, -np.inf))
    best = np.clip(free, -descent, climb)
    return np.where((along <= 0) & (up == 0), 0, (along + up * best) / np.sqrt(1 + best**2))


def steepness(world, route, km, triangles, closed, lid):
    """The most by which the potential is too steep, as a share of the price."""
    levels = np.array(route["levels_m"]) / 1000
    demand(levels[0] == 0 and (np.diff(levels) > 0).all(), "levels do not ascend from 0")
    u = np.array(route["potential_km"]).reshape(len(levels), -1)
    demand(np.isfinite(u).all(), "a potential is not a number")
    corners = km[triangles]
    whole = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edges = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    gradients = np.stack([-edges[..., 1], edges[..., 0]], axis=-1) / whole[:, None, None]
    floor, below = floor_of(world, route, corners * 1000, triangles, closed)
    tilt = np.einsum("ncx,nc->nx", gradients, floor)
    length, altitude = world.weights
    most = 0.0
    for level, bottom in enumerate(levels):
        is_last = level + 1 == len(levels)
        top = bottom if is_last else levels[level + 1]
        low, high = u[level][triangles], u[level if is_last else level + 1][triangles]
        up = np.zeros_like(low) if is_last else (high - low) / (top - bottom)
        is_open = ~closed & (floor.min(1) * 1000 <= world.top_m)
        if not is_last:
            is_open &= (floor.min(1) + bottom) * 1000 <= world.top_m
            is_open &= (floor.max(1) + top) * 1000 >= lid
        for values, height in ((low, bottom), (high, top)):
            flat = np.einsum("ncx,nc->nx", gradients, values)
            price = np.where(bottom < below, length, length + altitude * (height - below))
            for corner in range(3):
                slopes = flat - up[:, corner, None] * tilt
                over = rate(np.linalg.norm(slopes, axis=1), up[:, corner], route["climb"], route["descent"]) / price
                most = max(most, float(over[is_open].max(initial=0)))
    return most, u, levels


def floor_of(world, route, corners, triangles, closed):
    """The floor at the corners, and how far the lowest altitude may lie above it, km."""
    if not route["floor_m"]:
        demand(len(route["levels_m"]) == 1, "levels without a floor")
        return np.full(triangles.shape, -1e6), np.zeros(len(triangles))
    floor = np.array(route["floor_m"])[triangles]
    demand(not world.terrain.is_flat, "flat ground has no floor")
    below = np.zeros(len(triangles))
    low, high = world.terrain.differences(corners[~closed], floor[~closed] - world.over_m)
    demand((low >= -1e-6).all(), f"the floor is {-low.min():.3f} m above the lowest altitude")
    below[~closed] = np.maximum(high, 0) / 1000
    return floor / 1000, below


def value_at(u, levels, node, height):
    return float(np.interp(height, levels, u[:, node]))


def arc(sine):
    sine = min(1.0, max(-1.0, sine))
    return (sine * math.sqrt(1 - sine * sine) + math.asin(sine)) / 2


def over_level_ground(way, start, goal, dearer):
    """Least cost between two heights over the lowest altitude, km, if a km costs 1 + dearer * height.

    S(x) + g(x) z with S' = sqrt(1 - g^2), |g| <= 1, g' <= dearer, is a potential: g is the sine of a
    slope that rises from some first to some last value, and is 0 between where there is way enough.
    """
    if dearer <= 0 or way <= 0:
        return 0.0
    cosine = [max(0.0, 1 - dearer * height) for height in (start, goal)]
    down, up = (math.sqrt(1 - one * one) for one in cosine)
    turn = dearer * way
    if down + up <= turn:
        return way + down * start + up * goal - (down - arc(down) + up - arc(up)) / dearer
    if turn > 2:
        return way

    def rise(first):
        return (arc(first + turn) - arc(first)) / dearer + (first + turn) * goal - first * start

    # The slope of the rise falls: it is greatest where that is 0.
    low, high = -1.0, 1.0 - turn
    for _ in range(100):
        first = (low + high) / 2
        last = first + turn
        grows = math.sqrt(max(0.0, 1 - last * last)) - math.sqrt(1 - first * first) + dearer * (goal - start)
        low, high = (first, high) if grows > 0 else (low, first)
    return rise((low + high) / 2)


def by_ends(world, ends, least_km=0.0):
    """What start and goal prove of a path that is no shorter than this in the plane."""
    start, goal = (np.asarray(end, float) for end in ends)
    way = max(least_km, float(np.linalg.norm((goal - start)[:2])) / 1000)
    length, altitude = world.weights
    if len(goal) < 3:
        return length * way
    most = math.hypot(way, (goal[2] - start[2]) / 1000)
    if world.terrain.is_flat and length > 0:
        heights = [max(0.0, end[2] - world.terrain.amsl_m - world.over_m) / 1000 for end in (start, goal)]
        most = max(most, over_level_ground(way, *heights, altitude / length) * (1 - TOLERANCE_SHARE))
    return length * most


def check_ends(route_ends, ends):
    demand(np.abs(route_ends[0] - ends[0]).max() < 0.01, "the start is not that of the spec")
    demand(np.abs(route_ends[1][: len(ends[1])] - ends[1]).max() < 0.01, "the goal is not that of the spec")


def check_route(world, vehicle, route, ends):
    given = np.array(route["ends"])
    check_ends(given, ends)
    for key, name, polynomial in (("max_climb_deg", "climb", CLIMB), ("max_descent_deg", "descent", DESCENT)):
        steepest = slope(vehicle, key, polynomial, world.top_m)
        demand(route[name] >= steepest - 1e-9, f"the {name} is steeper in the spec")
    nodes = np.array(route["nodes"])
    demand(np.isfinite(nodes).all() and len(nodes) == route["rows"] * route["columns"], "nodes are missing")
    triangles = triangles_of(route["rows"], route["columns"])
    start, goal = route["end_nodes"]
    demand(np.abs(nodes[[start, goal]] - given[:, :2]).max() < 1e-6, "start and goal are not nodes")
    border = check_mesh(route, nodes, triangles)
    corners = nodes[triangles]
    closed, beyond, lid = closed_in_plane(world, corners, given[:, :2], route["longest_m"])
    demand(beyond[border].all(), "a path that counts may leave the mesh")
    most, u, levels = steepness(world, route, nodes / 1000, triangles, closed, lid)
    demand(most > 0, "the potential is the same everywhere")
    floor = np.array(route["floor_m"]) if route["floor_m"] else given[:, 2].min() * np.ones(len(nodes))
    height = [max(0.0, (point[2] - floor[node]) / 1000) for point, node in zip(given, (start, goal))]
    rise = value_at(u, levels, goal, height[1]) - value_at(u, levels, start, height[0])
    length = world.weights[0]
    proven = min(rise / most, length * route["longest_m"] / 1000)
    proven = max(0.0, proven * (1 - TOLERANCE_SHARE) - length * TOLERANCE_KM)
    # Without levels it is a length in the plane.
    way = proven / length if len(levels) == 1 and length > 0 else 0.0
    proven = max(proven, by_ends(world, given, way))
    demand(route["bound"] <= proven + 1e-6, f"it proves {proven:.6f}, not {route['bound']:.6f}")


def check(spec_path, document, folder=None):
    world = World(spec_path)
    digest = hashlib.sha256(spec_path.read_bytes()).hexdigest()
    demand(document["spec_sha256"] == digest, "it is of another spec")
    demand(np.abs(np.array(document["origin"]) - world.earth.origin).max() < 1e-9, "the origin is another one")
    vehicles = {vehicle["id"]: vehicle for vehicle in world.spec["vehicles"]}
    if world.spec.get("tasks"):
        plan = json.loads((folder / "plan.json").read_text())
        demand(plan["spec_sha256"] == digest, "the plan is of another spec")
        for name, stops in stops_of_tasks(world.spec, plan).items():
            vehicles[name] = {**vehicles[name], "stops": stops}
    for certified in document["vehicles"]:
        name = certified["id"]
        demand(name in vehicles, f"no vehicle {name} in the spec")
        ends = ends_of(world, vehicles[name])
        demand(len(ends) == len(certified["routes"]), f"{name}: {len(ends)} routes in the spec")
        total = 0.0
        for index, (route, points) in enumerate(zip(certified["routes"], ends)):
            if route is None:
                total += by_ends(world, points)
                continue
            try:
                check_route(world, vehicles[name], route, points)
            except Rejected as why:
                raise Rejected(f"{name}, route {index + 1}: {why}") from None
            total += route["bound"]
        demand(certified["bound"] <= total + 1e-9, f"{name}: the bound is not the sum of its routes")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("spec", type=Path)
    parser.add_argument("folder", type=Path, help="with certificate.json in it")
    arguments = parser.parse_args()
    try:
        document = json.loads((arguments.folder / "certificate.json").read_text())
        check(arguments.spec, document, arguments.folder)
    except Rejected as why:
        print(f"rejected: {why}")
        return 1
    except (Unknown, OSError, ValueError, KeyError, TypeError, IndexError) as why:
        print(f"cannot be checked: {why!r}" if not isinstance(why, Unknown) else f"cannot be checked: {why}")
        return 2
    for vehicle in document["vehicles"]:
        print(f"accepted: {vehicle['id']}: no path that keeps the limits costs less than {vehicle['bound']:.6f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
