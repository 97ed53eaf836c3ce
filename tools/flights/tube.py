"""What was flown, by the simulator's truth, against the verified trajectory."""

import numpy as np

from second.earth import axes, ecef

# A plan of which less is known of its time than this is no place to take lateness at, m/s.
MOVES_MPS = 1.0
# Corners of less than this are none, degrees; those nearer to each other than this are one, metres.
CORNER_DEG, CORNER_M = 15.0, 15.0
# Segments this much farther than the nearest lie at the same place, for the height, metres.
NEAR_M = 10.0


class Tube:
    """The segments of a verified trajectory in metres east, north and up."""

    def __init__(self, document):
        segments = document["segments"]
        ends = [[(p["lat_deg"], p["lon_deg"], p["amsl_m"]) for p in (s["from"], s["to"])] for s in segments]
        ends = np.array(ends, float)
        self.origin = ends[0, 0, :2]
        self.early_s, self.late_s = document["takeoff_early_s"], document["takeoff_late_s"]
        self.start, self.end = self.metres(*ends[:, 0].T), self.metres(*ends[:, 1].T)
        self.from_s = np.array([s["from"]["t_s"] for s in segments], float)
        self.to_s = np.array([s["to"]["t_s"] if s["to"]["t_s"] is not None else np.inf for s in segments], float)
        self.row = np.array([s["to"]["item"] for s in segments])
        self.flown = np.array([s["flown"] for s in segments])
        names = ("error_m", "wide_m", "late_s", "early_s")
        self.error, self.wide, self.late, self.early = (np.array([s.get(k, 0.0) for s in segments], float) for k in names)
        along = np.linalg.norm(self.end - self.start, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            self.speed = np.where(self.to_s > self.from_s, along / (self.to_s - self.from_s), 0.0)

    def metres(self, lat, lon, amsl):
        """East, north and up of places, shape (n, 3)."""
        east, north = axes(*self.origin)
        flat = ecef(lat, lon) - ecef(*self.origin)
        return np.stack([flat @ east, flat @ north, np.asarray(amsl, float)], axis=-1)

    def feet(self, points, which):
        """The nearest point of these segments for each point: distance sideways, height above, segment, share."""
        start, along = self.start[which], (self.end - self.start)[which]
        squares = np.maximum((along**2).sum(axis=1), 1e-9)
        gone = points[:, None, :] - start[None]
        share = np.clip((gone * along[None]).sum(axis=2) / squares[None], 0, 1)
        off = gone - share[..., None] * along[None]
        # A circle that is flown for ever stands as its middle with its radius as the error.
        nearest = np.argmin(np.maximum(np.sqrt((off**2).sum(axis=2)) - self.error[which], 0), axis=1)
        here = np.arange(len(points))
        off = off[here, nearest]
        return np.hypot(off[:, 0], off[:, 1]), off[:, 2], np.asarray(which)[nearest], share[here, nearest]


    def outside(self, points, which):
        """How far points are from all that is judged: sideways, above the highest of the segments there and
        below the lowest. Metres, beyond what the segments allow themselves; negative inside."""
        start, along = self.start[which], (self.end - self.start)[which]
        squares = (along[:, :2] ** 2).sum(axis=1)
        gone = points[:, None, :2] - start[None, :, :2]
        share = np.clip((gone * along[None, :, :2]).sum(axis=2) / np.maximum(squares, 1e-9)[None], 0, 1)
        beside = np.linalg.norm(gone - share[..., None] * along[None, :, :2], axis=2) - self.error[which][None]
        # A column, and a circle (its middle with its radius as the error), have all their heights at one place.
        foot = start[None, :, 2] + share * along[None, :, 2]
        is_point = (squares < 1e-6)[None]
        low = np.where(is_point, np.minimum(start[:, 2], start[:, 2] + along[:, 2])[None], foot)
        high = np.where(is_point, np.maximum(start[:, 2], start[:, 2] + along[:, 2])[None], foot)
        nearest = beside.min(axis=1)
        here = beside <= np.maximum(nearest, 0)[:, None] + NEAR_M
        lowest = np.where(here, low, np.inf).min(axis=1)
        highest = np.where(here, high, -np.inf).max(axis=1)
        return nearest, points[:, 2] - highest, lowest - points[:, 2]


def compare(tube, truth, buffer_m, is_plane=False):
    """The figures of one flight: lists by name, and its escapes in words."""
    t = truth.t - truth.t0_s
    points = tube.metres(truth.lat, truth.lon, truth.amsl)
    ground_m = tube.start[0, 2]
    # Rows in the order of the trajectory: items without a motion have none.
    order = np.unique(tube.row)
    # After its landing a vehicle may name its first item again.
    rank = np.searchsorted(order, np.maximum.accumulate(truth.row))
    tube_rank = np.searchsorted(order, tube.row)
    last = len(order) - 1
    lands = bool(np.isfinite(tube.to_s[tube.flown]).all())
    found = {name: [] for name in ("across_m", "below_m", "above_m", "late_s", "late_growth_s", "drift_up_m",
                                   "drift_down_m", "touchdown_m")}
    escapes = []
    up = points[:, 2] - ground_m > 2.0
    # One that stands says nothing of its time, only where it stands.
    goes = np.hypot(*np.gradient(points[:, :2], axis=0).T) > MOVES_MPS * np.maximum(np.gradient(t), 1e-3)
    # A plane may be at the height of its start at once: judged by the ceiling.
    climb_out = 1 if is_plane else -1
    first_late = None
    for row in range(len(order)):
        here = np.flatnonzero((rank == row) & (truth.row > 0) & up & (t > 0))
        here = here[::2]
        near = np.flatnonzero(np.abs(tube_rank - row) <= 1)
        if not len(here) or not len(near):
            continue
        flown = near[tube.flown[near]]
        across, above, below = tube.outside(points[here], near)
        to_flown, flown_above, segment, at = tube.feet(points[here], flown)
        is_column = row == 0 or lands and row == last
        # Not where it stays for ever: on its circle.
        way = np.isfinite(tube.to_s[segment])
        if row == 0:
            found["drift_up_m"].append(to_flown.max())
        elif lands and row == last:
            found["drift_down_m"].append(to_flown.max())
        else:
            found["across_m"] += to_flown[way].tolist()
            found["below_m"] += np.maximum(-flown_above[way], 0).tolist()
            found["above_m"] += np.maximum(flown_above[way], 0).tolist()
        for what, value in (("beside", across), ("above", above), ("below", below)):
            if is_column and what != "beside" or what == "above" and row <= climb_out:
                continue
            worst = int(np.argmax(value))
            if value[worst] > buffer_m:
                escapes.append({"what": what, "row": int(order[row]), "t_s": round(float(t[here][worst]), 1),
                                "value": round(float(value[worst]), 2), "limit": buffer_m})
        # In time only along its own row: a way back on the way out is as near in space, and seconds later.
        own = flown[tube_rank[flown] == row]
        if is_column or not len(own) or not lands and row == last:
            continue
        _, _, segment, at = tube.feet(points[here], own)
        moves = goes[here] & (tube.speed[segment] > MOVES_MPS) & (at > 0) & (at < 1) & np.isfinite(tube.to_s[segment])
        if not moves.any():
            continue
        planned = tube.from_s[segment] + at * (tube.to_s - tube.from_s)[segment]
        late, allowed_late = (t[here] - planned)[moves], tube.late[segment][moves]
        allowed_early = tube.early[segment][moves]
        middle = len(late) // 2
        first_late = late[0] if first_late is None else first_late
        found["late_s"].append(late[middle])
        found["late_growth_s"].append(late[middle] - first_late)
        # Late, and by how much more than a vehicle of its kind that was as late at its start.
        for what, value, limit in (("late", late, tube.late_s + allowed_late), ("early", -late, tube.early_s + allowed_early)):
            worst = int(np.argmax(value - limit))
            if value[worst] > limit[worst]:
                escapes.append({"what": what, "row": int(order[row]), "t_s": round(float(t[here][moves][worst]), 1),
                                "value": round(float(value[worst]), 2), "limit": round(float(limit[worst]), 2)})
    found["start_late_s"] = [] if first_late is None else [first_late]
    found.update(corners(tube, truth, points, t))
    if lands:
        found["touchdown_m"] = [float(np.hypot(*(points[-1] - tube.end[tube.flown][-1])[:2]))]
    return {name: [round(float(v), 3) for v in values] for name, values in found.items()}, escapes


def corners(tube, truth, points, t):
    """At each waypoint with a change of course: how near it was passed, and how slowly against the verdict."""
    flown = np.flatnonzero(tube.flown)
    speed = np.hypot(*np.gradient(points[:, :2], axis=0).T) / np.maximum(np.gradient(t), 1e-3)
    found = {"corner_closest_m": [], "corner_slower_mps": []}
    # The last segment of each row that moves, and the first of the next.
    for row in np.unique(tube.row[flown])[1:]:
        into = flown[(tube.row[flown] == row) & (tube.speed[flown] > MOVES_MPS)]
        out = flown[(tube.row[flown] > row) & (tube.speed[flown] > MOVES_MPS)]
        if not len(into) or not len(out):
            continue
        a, b = into[0], out[-1] if len(out) == 1 else out[out > into[-1]][0]
        rest = flown[(flown > into[-1]) & (flown < b)]
        headings = [np.arctan2(*(tube.end - tube.start)[k, :2]) for k in (a, b)]
        turn = abs((np.degrees(headings[1] - headings[0]) + 180) % 360 - 180)
        if turn < CORNER_DEG or len(rest):
            continue
        at = tube.end[into[-1]]
        around = np.flatnonzero((truth.row >= row) & (truth.row <= row + 1) & (np.hypot(*(points - at)[:, :2].T) < CORNER_M))
        near = flown[np.hypot(*(tube.start[flown] - at)[:, :2].T) < CORNER_M]
        if len(around) < 3 or not len(near):
            continue
        found["corner_closest_m"].append(float(np.hypot(*(points[around] - at)[:, :2].T).min()))
        found["corner_slower_mps"].append(float(tube.speed[near].min() - speed[around].min()))
    return found
