"""Counts what the pictures of a plan show, apart from everything that planned it.

    python tools/check_coverage.py SPEC DIR [--every 5]

Reads the survey of a spec and the `.waypoints` of a plan, and the elevation file. Each picture is placed by the
items alone: one where DO_SET_CAM_TRIGG_DIST switches on, one at each multiple of its distance from there, and a last one where it
switches off. On a grid of places over the real ground each picture is a rectangle of its camera, by the height above
that place. A place is seen where enough lines show it in enough pictures: 1 / (1 - overlap), rounded down. Pictures from
more than 1.5 times the height of the spec do not count.

Prints JSON: the share of places that are seen, the length of lines, turns and ferries in metres, and the least that
parallel tracks over this area can have.
"""

import argparse
import json
import math
from pathlib import Path

import numpy as np
import yaml

from second.earth import Ground, axes, ecef

ABOVE = 1.5


def times(overlap):
    return max(1, math.floor(1 / (1 - overlap) + 1e-9))


def rows(path):
    """Command, parameters, latitude, longitude, altitude of each row after home."""
    for line in Path(path).read_text().splitlines()[2:]:
        parts = line.split("\t")
        yield int(parts[3]), [float(part) for part in parts[4:8]], *map(float, parts[8:11])


class Plane:
    """East and north of a place, metres, by projection onto the plane there."""

    def __init__(self, lat, lon):
        self.middle = ecef(lat, lon)
        self.axes = np.stack(axes(lat, lon))

    def __call__(self, lat, lon):
        return (ecef(np.asarray(lat), np.asarray(lon)) - self.middle) @ self.axes.T


def lines_of(path, plane):
    """For each time that pictures are taken: distance, corners (east, north, altitude); and the moves between."""
    lines, moves = [], []
    at, on = None, None
    for command, params, lat, lon, altitude in rows(path):
        if command in (16, 22, 21):
            east, north = plane(lat, lon)
            point = np.array([east, north, altitude])
            if at is not None:
                if on:
                    on[1].append(point)
                else:
                    moves.append((len(lines), math.hypot(*(point - at)[:2])))
            at = point
        elif command == 206:
            if on:
                lines.append((*on, params[2] == 1))
                on = None
            if params[0] > 0:
                on = (params[0], [at], params[2] == 1)
    return [(d, np.array(points), first, last) for d, points, first, last in lines], moves


def pictures(distance, points, first, last):
    """Places, altitudes and courses of the pictures of one line."""
    found, due = [], 0.0 if first else distance
    done = 0.0
    for a, b in zip(points[:-1], points[1:]):
        length = math.hypot(*(b - a)[:2])
        if length < 1e-6:
            continue
        course = (b - a)[:2] / length
        while due <= done + length:
            found.append((a + (b - a) * (due - done) / length, course))
            due += distance
        done += length
        end = (b, course)
    if last:
        found.append(end)
    return found


def inside(east, north, ring):
    result = np.zeros(east.shape, bool)
    for (x0, y0), (x1, y1) in zip(ring, np.roll(ring, -1, axis=0)):
        crosses = (y0 > north) != (y1 > north)
        with np.errstate(divide="ignore", invalid="ignore"):
            result ^= crosses & (east < (x1 - x0) * (north - y0) / (y1 - y0) + x0)
    return result


def area(ring):
    x, y = np.asarray(ring).T
    return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("spec", type=Path)
    parser.add_argument("dir", type=Path)
    parser.add_argument("--every", type=float, default=5.0, help="distance of places, metres")
    given = parser.parse_args()
    spec = yaml.safe_load(given.spec.read_text())
    ground = Ground(given.spec.parent / spec["terrain"]["file"])
    survey = next(task["survey"] for task in spec["tasks"] if "survey" in task)
    corners = np.array(survey["polygon"])
    low, high = corners.min(axis=0), corners.max(axis=0)
    plane = Plane(*(low + high) / 2)
    ring = plane(corners[:, 0], corners[:, 1])
    holes = [plane(*np.array(hole).T) for hole in survey.get("holes", [])]
    across, along = (math.tan(math.radians(deg) / 2) for deg in survey["camera"]["fov_deg"])
    needed_lines, needed_pictures = times(survey["side_overlap"]), times(survey["front_overlap"])
    # The grid: latitude and longitude even, places in the plane.
    per_degree = np.linalg.norm(plane(low[0] + 1e-3, low[1]) - plane(*low)) * 1e3
    per_degree_east = np.linalg.norm(plane(low[0], low[1] + 1e-3) - plane(*low)) * 1e3
    lat = np.arange(low[0], high[0], given.every / per_degree)
    lon = np.arange(low[1], high[1], given.every / per_degree_east)
    lat, lon = (grid.ravel() for grid in np.meshgrid(lat, lon))
    places = plane(lat, lon)
    keep = inside(places[:, 0], places[:, 1], ring)
    for hole in holes:
        keep &= ~inside(places[:, 0], places[:, 1], hole)
    lat, lon, places = lat[keep], lon[keep], places[keep]
    heights = ground.height(lat, lon)
    seen = np.zeros(len(places), int)
    line_m = turn_m = ferry_m = 0.0
    count, used = 0, 0
    spacing = 2 * across * survey["agl_m"] * (1 - survey["side_overlap"])
    for path in sorted(given.dir.glob("*.waypoints")):
        lines, moves = lines_of(path, plane)
        used += bool(lines)
        for line in lines:
            shown = np.zeros(len(places), int)
            for point, course in pictures(*line):
                count += 1
                off = places - point[:2]
                above = point[2] - heights
                ahead, aside = off @ course, off @ np.array([course[1], -course[0]])
                shown += (
                    (np.abs(aside) <= across * above) & (np.abs(ahead) <= along * above) & (above <= ABOVE * survey["agl_m"])
                )
            seen += shown >= needed_pictures
            line_m += sum(math.hypot(*step) for step in np.diff(line[1][:, :2], axis=0))
        for after in range(len(lines) + 1):
            moved = sum(length for at, length in moves if at == after)
            if 0 < after < len(lines) and moved <= 2 * spacing:
                turn_m += moved
            else:
                ferry_m += moved
    size = area(ring) - sum(area(hole) for hole in holes)
    turned = [ring @ np.array([math.cos(a), math.sin(a)]) for a in np.radians(np.arange(180))]
    width = min(np.ptp(turn) for turn in turned)
    bound = size / spacing + max(0.0, width - used * spacing)
    print(
        json.dumps(
            {
                "share": float((seen >= needed_lines).mean()),
                "area_m2": float(size),
                "pictures": count,
                "lines_m": line_m,
                "turns_m": turn_m,
                "ferries_m": ferry_m,
                "bound_m": float(bound),
                "ratio": float((line_m + turn_m) / bound),
                "vehicles": used,
            }
        )
    )


if __name__ == "__main__":
    main()
