"""Least clearances and distances of flights, by sampling: finer wherever it can matter."""

import math

import numpy as np

from .earth import ecef, geodetic
from .shapes import Line

EPS_M = 0.01
POSTS_M = 100.0  # between those of the terrain that ArduPilot follows (TERRAIN_SPACING)


class Lines:
    """Straight lines with altitudes above the sea, or all above the ground, judged all at once."""

    def __init__(self, lines, follows):
        self.follows = follows
        self.start, self.end = (np.array([getattr(line, end) for line in lines]) for end in ("start", "end"))
        self.length = np.array([line.length for line in lines])
        self.values_m = np.array([(line.height.start, line.height.end) for line in lines])
        self.floor = np.array([math.nan if line.slope_from is None else line.slope_from for line in lines])
        self.climb = np.abs(np.diff(self.values_m)[:, 0]) / np.maximum(self.length, 1e-9)

    def place(self, index, s):
        return geodetic(self.start[index] + (self.end - self.start)[index] * s[:, None])

    def value(self, index, s):
        start, end = self.values_m[index].T
        return start + (end - start) * s

    def amsl(self, ground, index, s):
        value = self.value(index, s)
        return value + ground.height(*self.place(index, s)) if self.follows else value


class One:
    """Any other shape alone."""

    def __init__(self, shape):
        self.shape, self.length = shape, np.array([shape.length])
        self.floor = np.array([math.nan if shape.slope_from is None else shape.slope_from])
        height = shape.height
        self.climb = np.array([abs(height.end - height.start) / shape.length if shape.length else 0.0])
        self.follows = height.follows

    def value(self, index, s):
        return self.shape.height.start + (self.shape.height.end - self.shape.height.start) * s

    def place(self, index, s):
        return self.shape.place(s)

    def amsl(self, ground, index, s):
        lat, lon = self.shape.place(s)
        return self.shape.height.amsl(ground, lat, lon, s)


def bundles(shapes):
    lines = {follows: [s for s in shapes if isinstance(s, Line) and s.height.follows == follows] for follows in (False, True)}
    return [Lines(some, follows) for follows, some in lines.items() if some] + [One(s) for s in shapes if not isinstance(s, Line)]


def along(all_shapes, value, slope, cell_m=4):
    """The least value along shapes and how far below it the true one may be; the first cells are no longer than stated."""
    best, low = math.inf, math.inf
    for shapes in all_shapes:
        index = np.arange(len(shapes.length))
        for s in (0.0, 1.0):
            best = min(best, float(value(shapes, index, np.full(len(index), s)).min()))
    for shapes in all_shapes:
        steep = slope(shapes)
        count = np.where(shapes.length > 0, np.maximum(np.ceil(shapes.length / cell_m), 1), 0).astype(int)
        index = np.repeat(np.arange(len(count)), count)
        s = (np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[index]
        half = 0.5 / count[index]
        while len(index):
            values = value(shapes, index, s)
            best = min(best, float(values.min()))
            reach = steep[index] * half * shapes.length[index]
            keep = values - reach < best - EPS_M
            done = keep & (half * shapes.length[index] < 0.002)
            low = min(low, float((values - reach)[done].min(initial=math.inf)))
            keep &= ~done
            index, half = np.repeat(index[keep], 4), np.repeat(half[keep] / 4, 4)
            s = (s[keep][:, None] + half.reshape(-1, 4) * np.array([-3, -1, 1, 3])).ravel()
    return best, best - min(low, best - EPS_M)


def clearance(flight):
    return over_ground(flight, flight.judged, 0.0)


def slope_clearance(flight):
    """Over what a climb-out or a glide asks for: half of the height above the ground where it begins or ends."""
    return over_ground(flight, flight.slopes, 0.5)


def over_ground(flight, judged, share):
    ground = flight.ground

    def value(shapes, index, s):
        if shapes.follows:
            return shapes.value(index, s) - ground.followed_apart(*shapes.place(index, s), tuple(flight.home.at), POSTS_M)[0]
        amsl = shapes.amsl(ground, index, s)
        over = amsl - ground.height(*shapes.place(index, s))
        return over - share * (amsl - shapes.floor[index]) if share else over

    def slope(shapes):
        return shapes.climb + (2 if shapes.follows else 1) * ground.steepest

    return along(bundles(judged), value, slope)


def posts_off(flight):
    """How far the altitudes of what follows the terrain may be off, at most."""
    worst = 0.0
    if not flight.follows:
        return worst
    for shapes in bundles(flight.everywhere()):
        if shapes.follows:
            for index, length in enumerate(shapes.length):
                s = np.linspace(0, 1, max(2, math.ceil(length / 4)))
                places = shapes.place(np.full(len(s), index), s)
                worst = max(worst, max(float(off.max()) for off in flight.ground.followed_apart(*places, tuple(flight.home.at), POSTS_M)))
    return worst


def ceiling(flight):
    """The greatest altitude, negative, so that it is a least value."""

    def value(shapes, index, s):
        off = np.maximum(*flight.ground.followed_apart(*shapes.place(index, s), tuple(flight.home.at), POSTS_M)) if shapes.follows else 0.0
        return -shapes.amsl(flight.ground, index, s) - off

    def slope(shapes):
        return shapes.climb + (3 * flight.ground.steepest if shapes.follows else 0.0)

    return along(bundles(flight.everywhere()), value, slope)


def to_threat(flight, threat):
    axis = ecef(threat["lat"], threat["lon"])

    def value(shapes, index, s):
        return np.linalg.norm(ecef(*shapes.place(index, s)) - axis, axis=-1) - threat["radius_m"]

    return along(bundles(flight.everywhere()), value, lambda shapes: np.ones(len(shapes.length)), cell_m=400)


class Fastest:
    """The greatest speeds across and up, and the greatest width, in any interval of time."""

    def __init__(self, flight):
        self.starts = np.array([motion.start for motion in flight.motions])
        self.levels = [np.array([(*motion.fastest, motion.wide) for motion in flight.motions])]
        while 2 ** len(self.levels) <= len(self.starts):
            last, step = self.levels[-1], 2 ** (len(self.levels) - 1)
            self.levels.append(np.maximum(last[:-step], last[step:]))

    def within(self, start, end):
        last = len(self.starts) - 1
        i = np.clip(np.searchsorted(self.starts, start, side="right") - 1, 0, last)
        j = np.clip(np.searchsorted(self.starts, end, side="right") - 1, 0, last)
        depth = np.log2(j - i + 1).astype(int)
        found = np.empty((len(i), 3))
        for d in np.unique(depth):
            here, level = depth == d, self.levels[d]
            found[here] = np.maximum(level[i[here]], level[j[here] - (1 << d) + 1])
        return found


def separation(a, b, slack, vertical, loose):
    """What is measured, the least distance of two flights, how far below the true one may be, and how far
    below that the verdict may see it; or the seconds between them. With `vertical` the distance is horizontal
    where the altitudes differ by less (for the verdict, by less than `loose` more), else vertical. Each is
    less by how far beside their ways the two may be."""
    spans = [(f.motions[0].start, f.motions[-1].end) for f in (a, b)]
    (a0, a1), (b0, b1) = spans
    gap = max(a0 - b1 - b.late - a.ahead - b.takeoff_late(a), b0 - a1 - a.late - b.ahead - a.takeoff_late(b))
    if gap > slack:
        return "gap", gap, 0.0, 0.0
    if vertical is None:
        return "m", *search(a, b, slack, spans, "space"), loose
    best, _ = search(a, b, slack, spans, "horizontal", vertical)
    if math.isfinite(best):
        wide, error = search(a, b, slack, spans, "horizontal", vertical + loose)
        return "m", best, error, best - wide + loose
    return "vertical", *search(a, b, slack, spans, "vertical"), loose


class Pair:
    """The distance of one vehicle at `t` and another at `t + s`."""

    def __init__(self, a, b, slack, spans, kind, level):
        self.a, self.b, self.kind, self.level = a, b, kind, level
        self.slack_a, self.slack_b = slack + a.takeoff_late(b), slack + b.takeoff_late(a)
        (self.a0, self.a1), (self.b0, self.b1) = spans
        self.widest = max(self.slack_a + a.late + b.ahead, self.slack_b + b.late + a.ahead)
        self.fast_a, self.fast_b = Fastest(a), Fastest(b)

    def values(self, t, s):
        """The distance, the difference in altitude, and whether both count there."""
        t, u = np.clip(t, self.a0, self.a1), np.clip(t + s, self.b0, self.b1)
        (p, p_amsl), (q, q_amsl) = self.a.where(t), self.b.where(u)
        across, up = np.linalg.norm(p - q, axis=-1), np.abs(p_amsl - q_amsl)
        wide = self.a.wide_at(t) + self.b.wide_at(u)
        counts = (u - t <= self.later(t, u) + 1e-9) & (t - u <= self.sooner(t, u) + 1e-9)
        if self.kind == "horizontal":
            return np.maximum(across - wide, 0), up - wide, counts & (up - wide < self.level)
        apart = np.hypot(across, up) if self.kind == "space" else up
        return np.maximum(apart - wide, 0), up - wide, counts

    def reach(self, t, s, ht, hs):
        """By how much the distance and the difference in altitude can change in cells of these half widths."""
        u = np.clip(t + s, self.b0, self.b1)
        a, b = self.fast_a.within(t - ht, t + ht), self.fast_b.within(u - ht - hs, u + ht + hs)
        change = a * ht + b * (ht + hs)
        across, up = change[:, 0], change[:, 1]
        wider = np.maximum(a[:, 2] + b[:, 2] - self.a.wide_at(t) - self.b.wide_at(u), 0)
        reach = {"space": np.hypot(across, up), "horizontal": across, "vertical": up}[self.kind]
        return reach + wider, up + wider

    def allowed(self, t, s):
        """The nearest shifts that count, or nearly: before its stops a vehicle is less late."""
        return np.clip(s, -self.sooner(t, t), self.later(t, t))

    def may_count(self, t, s, ht, hs):
        """Whether cells of these half widths hold a shift that counts: stops make late, and never less so later."""
        most = t + ht, t + s + ht + hs
        return (s - hs <= self.later(*most)) & (-s - hs <= self.sooner(*most))

    def later(self, t, u):
        """By how much the time of the second may be after that of the first, and before it."""
        return self.slack_a + self.a.late_at(t) + self.b.early_at(u)

    def sooner(self, t, u):
        return self.slack_b + self.b.late_at(u) + self.a.early_at(t)

    def descend(self, t, s, step):
        """A low value near some places: the compass, with smaller and smaller steps."""
        east, north = (x.ravel() for x in np.meshgrid([-1, 0, 1], [-1, 0, 1] if self.widest > 0 else [0]))
        best = math.inf
        while step > 1e-5 and len(t):
            grid_t, grid_s = t[:, None] + step * east, s[:, None] + step * north
            grid_s = self.allowed(grid_t, grid_s)
            values, _, counts = (x.reshape(grid_t.shape) for x in self.values(grid_t.ravel(), grid_s.ravel()))
            values = np.where(counts, values, math.inf)
            pick, rows = values.argmin(axis=1), np.arange(len(t))
            t, s, low = grid_t[rows, pick], grid_s[rows, pick], values[rows, pick]
            best, step = min(best, float(low.min())), step * 0.7
        return best


def search(a, b, slack, spans, kind, level=0.0):
    """Cells of time and shift, halved wherever they may hold something lower than the best sample."""
    pair = Pair(a, b, slack, spans, kind, level)
    slack = pair.widest
    start, end = max(pair.a0, pair.b0 - slack), min(pair.a1, pair.b1 + slack)
    n, m = max(1, math.ceil((end - start) / 2)), max(1, math.ceil(slack))
    ht, hs = (end - start) / n / 2, slack / m
    t = start + (2 * np.arange(n) + 1) * ht
    s = -slack + (2 * np.arange(m) + 1) * hs
    t, s = (grid.ravel() for grid in np.meshgrid(t, s, indexing="ij"))
    best, low = math.inf, math.inf
    while len(t):
        near = np.abs(t + s - np.clip(t + s, pair.b0, pair.b1)) <= ht + hs
        near &= pair.may_count(t, s, ht, hs)
        t, s = t[near], s[near]
        values, up, _ = pair.values(t, s)
        sampled, _, counts = pair.values(t, pair.allowed(t, s))
        best = min(best, float(sampled[counts].min(initial=math.inf)))
        lowest = np.argsort(np.where(counts, sampled, math.inf))[:30]
        best = min(best, pair.descend(t[lowest], s[lowest], max(ht, hs)))
        reach, reach_up = pair.reach(t, s, ht, hs)
        keep = values - reach < best - slip(best)
        if kind == "horizontal":
            keep &= up - reach_up < level
        if max(ht, hs) < 1e-4 or keep.sum() > 300_000:
            low = float((values - reach)[keep].min(initial=math.inf))
            break
        ht /= 2
        t, s = t[keep], s[keep]
        t, s = np.concatenate([t - ht, t + ht]), np.concatenate([s, s])
        if slack > 0:
            hs /= 2
            t, s = np.concatenate([t, t]), np.concatenate([s - hs, s + hs])
    return best, best - min(low, best - slip(best)) if math.isfinite(best) else 0.0


def slip(best):
    """Cells that cannot hold anything lower than this below the best are let go."""
    return EPS_M + 1e-4 * best if math.isfinite(best) else 0.0
