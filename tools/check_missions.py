"""Judges missions a second time and holds `sortie review` against it.

    python tools/check_missions.py [--fleets 50] [--wings 0] [--pairs 0] [--seed 1] [--sortie target/debug/sortie] [--keep DIR]
    python tools/check_missions.py --spec SPEC FILES...

Random fleets over the Jacksboro fault, bad ones on purpose and some planned in a hurry, go
through `sortie review`; then the clearance over ground, the ceiling, the distances to threats and the
separations are measured again from the files alone. The flight model is that of the texts in
src/verify/mod.rs and src/verify/execute/wing/mod.rs, and nothing else is shared: legs are chords through the
earth between geodetic places, and minima are found by sampling (tools/second).

Compared are, in still air and in wind: of copters of both autopilots everything above; of planes and VTOLs of both
everything but the separation, with the climb-outs and glides of planes against their own limit (`slope`), swings by the L1
law and by that of PX4, circles and regions; of pairs of PX4's wings that the verdict has them no further apart than their legs
are. Not compared: the separation of wings of ArduPilot, and how much nearer PX4's come (how late and how far beside their legs they are) and of wings that leave a circle again, copters on splines and circles,
vehicles that depart in the air, zones, area and fence.

About half of the fleets have buffers, and each limit must be that of the spec with its buffer.
A margin agrees when sampling finds nothing worse than was reported, and nothing better by
more than its own error and what the text allows the verdict to be short by (its chords):

    found + rounding >= reported >= found - error - chords - rounding

`found` is the value at a sample, so it is attained. `error` bounds how far the true minimum
lies below it: every cell between samples was halved until the greatest slope or speed in
it proved that it holds nothing lower than found - 1 cm (of a separation, 0.1 per mille more).
Both sides also get what the two models of the earth differ in: a straight line of the
verdict's plane and a chord through the earth are centimetres apart, and so are their lengths;
and, where a wing swings, what it
flies in 0.1 s: both sides integrate the L1 law in steps of 0.05 s, this one by the midpoint, and may begin and
end a turn a step apart; a step more for each leg in a row that is too short to end the turn before.
Spec files are read as JSON, which is YAML.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from second.earth import A, Ground
from second.fleets import make_fleet
from second.flight import Flight, read_items, read_parameter, read_radius
from second.minima import ceiling, clearance, posts_off, separation, slope_clearance, to_threat
from second.wing import WingFlight, read_params
from second.wing_fleets import KINDS, make_pair, make_wing

ROOT = Path(__file__).resolve().parent.parent
CHORD_M = 0.02  # the verdict's chords of arcs and ramps
SAMPLED_M = 1.0  # what it follows is compared with the ground no further away than this
FOLLOW_M = 0.12  # its chords over ground that is followed, and a chord of those
ROUNDING_M = 0.002  # of printed margins and float32 altitudes
STEEP_M = 2000  # more than any line climbs
PLANNED = 10  # every tenth fleet is also planned
MEASURES = ("clearance", "slope", "ceiling", "threat", "separation")


@dataclass
class Finding:
    measure: str
    vehicles: tuple  # kinds of the vehicles, such as plane-px4
    violated: bool
    what: str
    reported: float
    found: float  # at a sample
    error: float  # the true minimum is no more than this below
    model: float  # what the text allows the verdict to be short by: its chords
    plane: float  # what the verdict's plane and the chords of this file differ in
    limit: float = math.nan  # what was compared with
    expected: float = math.nan  # the limit of the spec and its buffer, where there is one limit

    @property
    def worse(self):
        """How much lower a sample is than reported, beyond what planes differ in; above 0 the verdict is wrong."""
        return self.reported - self.found - self.plane

    @property
    def better(self):
        """The same the other way, beyond the errors of both; above 0 the verdict says less than it could."""
        return self.found - self.error - self.model - self.plane - self.reported

    @property
    def agrees(self):
        is_limit = math.isnan(self.expected) or abs(self.limit - self.expected) <= ROUNDING_M
        return is_limit and self.worse <= ROUNDING_M and self.better <= ROUNDING_M


def sortie_runs(sortie, *arguments):
    """Its standard output; missions that do not pass are no failure here."""
    run = subprocess.run([str(sortie), *map(str, arguments)], capture_output=True, text=True)
    if run.returncode not in (0, 4):
        raise RuntimeError(f"sortie {' '.join(map(str, arguments))}: exit {run.returncode}: {run.stderr}")
    return run.stdout


class Comparison:
    """The flights of a spec and its files, measured again."""

    def __init__(self, spec_path, files):
        self.spec = spec = json.loads(spec_path.read_text())
        self.ground = Ground(spec_path.parent / spec["terrain"]["file"])
        by_name = {path.name.split(".")[0]: path for path in files}
        corners = spec["area"]["south_west"], spec["area"]["north_east"]
        middle = {key: sum(corner[key] for corner in corners) / 2 for key in ("lat", "lon")}
        touches = spec.get("origin", middle)
        self.origin = touches["lat"], touches["lon"]
        self.flights = {vehicle["id"]: self.flight(vehicle, by_name[vehicle["id"]]) for vehicle in spec["vehicles"]}
        self.slack, self.vertical = spec["separation"]["time_slack_s"], spec["separation"].get("vertical_m")
        fleet = list(self.flights.values())
        late = max(flight.late for flight in fleet) + max(one.takeoff_late(other) for one in fleet for other in fleet)
        horizon = max(flight.horizon() for flight in fleet) + self.slack + late + 1
        for flight in fleet:
            flight.stay_until(horizon)
        self.threats = {f"threat {threat['id']}": threat for threat in spec.get("threats", [])}

    def flight(self, vehicle, path):
        vehicle["takeoff_mps"] = read_parameter(path, "MPC_TKO_SPEED", 1.5)
        if vehicle["airframe"] != "copter":
            return WingFlight(vehicle, read_items(path), self.ground, self.spec, read_params(path), self.origin)
        radius = read_radius(path, vehicle["autopilot"] == "ardupilot")
        return Flight(vehicle, read_items(path), self.ground, radius)

    def buffer(self, kind):
        buffers = self.spec.get("buffer_m", {})
        return buffers.get(kind, buffers.get("all", 0))

    def finding(self, margin):
        """A margin of what is compared, measured again; None of any other."""
        flight, what = self.flights[margin["vehicle"]], margin["what"]
        value = math.nan if margin["value"] is None else margin["value"]
        named = (flight.kind,), not margin["ok"], f"{margin['vehicle']} {what}"
        if what == "items judged" and isinstance(flight, WingFlight) and not margin["ok"]:
            raise RuntimeError(margin["note"])
        steepest, follow = self.ground.steepest, FOLLOW_M if flight.follows else 0
        posts = 2 * SAMPLED_M * steepest if flight.follows else 0
        # Altitudes along steep lines differ with the lengths, which the verdict's plane makes short.
        beside = flight.beside(self.origin) + STEEP_M * (flight.furthest(self.origin) / A) ** 2 / 2
        if what == "terrain clearance":
            return Finding("clearance", *named, value, *clearance(flight), max(CHORD_M * steepest, follow),
                           (beside + flight.loose) * steepest + posts, margin["limit"],
                           self.spec["area"]["min_agl_m"] + self.buffer("terrain"))
        if what == "takeoff and landing clearance":
            return Finding("slope", *named, value - margin["limit"], *slope_clearance(flight), CHORD_M * steepest,
                           (beside + flight.loose) * steepest)
        if what == "ceiling":
            slope = flight.steep + (steepest if flight.follows else 0)
            return Finding("ceiling", *named, -value, *ceiling(flight), follow + posts_off(flight),
                           beside * max(slope, 1.0) + flight.loose * slope + posts, -margin["limit"],
                           self.buffer("ceiling") - self.spec["area"]["max_amsl_m"])
        if what in self.threats:
            found, error = to_threat(flight, self.threats[what])
            # A plane that touches the earth at the axis makes a distance r short by r (r / R)^2 / 6, a chord by 1/24.
            away = found + self.threats[what]["radius_m"]
            # Chords of an arc are up to CHORD_M within it, and judged as far nearer again.
            chords = 2 * CHORD_M + flight.undecided
            return Finding("threat", *named, value, found, error, chords + away * (away / A) ** 2 / 7,
                           beside + flight.loose, margin["limit"], self.buffer("threats"))
        return self.apart(margin, value) if what == "separation" else None

    def apart(self, margin, value):
        a, b = (self.flights[margin[which]] for which in ("vehicle", "other"))
        off = posts_off(a) + posts_off(b)
        follow = (a.follows + b.follows) * FOLLOW_M + off
        level = None if self.vertical is None else self.vertical + margin.get("buffer", 0)
        measure, found, error, chords = separation(a, b, self.slack, level, 2 * CHORD_M + follow)
        reported = "gap" if margin["unit"] == "s" else "m" if margin["limit"] != level else "vertical"
        if isinstance(a, WingFlight) or isinstance(b, WingFlight):
            # What they swing off their legs, and lose there, only brings them nearer.
            if measure == "gap" and reported != "gap":
                return None
            chords = math.inf
        if measure != reported and off:
            return None
        if measure != reported:
            found = math.nan
        plane = sum(f.along(self.origin) + f.beside(self.origin) for f in (a, b))
        short = found * (a.furthest(self.origin) + b.furthest(self.origin) + found) ** 2 / (2 * A * A)
        limit = self.spec["separation"]["distance_m"] + self.buffer("separation")
        return Finding("separation", (a.kind, b.kind), not margin["ok"], f"{margin['vehicle']} separation {margin['other']}", value,
                       found, error, chords + short, plane, margin["limit"], limit if reported == "m" else math.nan)


def plan(spec, sortie):
    """The same spec planned, in a hurry: what fails is as good to judge as what passes."""
    folder = spec.parent / "planned"
    sortie_runs(sortie, "plan", spec, "--out", folder)
    return folder / spec.name, sorted(folder.glob("*.waypoints"))


def table(findings):
    """One line for each measure: how many, how many of them violated, and the largest differences; and one for each kind."""
    print("             compared  violated  above a sample  below a sample  sampling error  disagree")
    for measure in MEASURES:
        of = [finding for finding in findings if finding.measure == measure]
        above = max((f.reported - f.found for f in of), default=0)
        below = max((f.found - f.reported for f in of), default=0)
        error = max((f.error for f in of), default=0)
        violated, wrong = sum(f.violated for f in of), sum(not f.agrees for f in of)
        print(f"{measure:12} {len(of):8}  {violated:8}  {above:12.4f} m  {below:12.4f} m  {error:12.4f} m  {wrong:8}")
    for kind in sorted({kind for finding in findings for kind in finding.vehicles}):
        counts = Counter(finding.measure for finding in findings if kind in finding.vehicles)
        print(f"compared {kind}: " + ", ".join(f"{measure} {counts[measure]}" for measure in MEASURES if counts[measure]))


def fleets(options, ground, scratch):
    """Name, spec and files of every random fleet."""
    terrain = ROOT / "missions/terrain/jacksboro.tif"

    def folder(name):
        path = (options.keep or Path(scratch)) / name
        path.mkdir(parents=True, exist_ok=True)
        (path / terrain.name).write_bytes(terrain.read_bytes())
        return path

    for number in range(options.seed, options.seed + options.fleets):
        spec, files = make_fleet(np.random.default_rng(number), ground, folder(str(number)))
        yield f"fleet {number}", spec, files
        if number % PLANNED == 0:
            yield f"fleet {number} planned", *plan(spec, options.sortie)
    for number in range(options.seed, options.seed + options.wings):
        for index, kind in enumerate(KINDS):
            name = f"{kind[0]}-{kind[1]}-{number}"
            if options.only in (None, f"{kind[0]}-{kind[1]}"):
                yield name, *make_wing(np.random.default_rng([number, index]), ground, folder(name), *kind)
    for number in range(options.seed, options.seed + options.pairs):
        name = f"pair-{number}"
        yield name, *make_pair(np.random.default_rng([number, len(KINDS)]), ground, folder(name))


def main():
    parser = argparse.ArgumentParser(description="Holds `sortie review` against a second implementation.")
    parser.add_argument("--fleets", type=int, default=50, help="how many fleets of copters, at random over the Jacksboro fault")
    parser.add_argument("--seed", type=int, default=1, help="of the first of them; each has its own")
    parser.add_argument("--wings", type=int, default=0, help="how many wings of each kind besides")
    parser.add_argument("--only", help="only wings of this kind, such as plane-px4")
    parser.add_argument("--pairs", type=int, default=0, help="how many pairs of wings of PX4 besides")
    parser.add_argument("--sortie", type=Path, default=ROOT / "target/debug/sortie")
    parser.add_argument("--keep", type=Path, help="leave the fleets in this folder")
    parser.add_argument("--verbose", action="store_true", help="print every margin")
    parser.add_argument("--spec", type=Path, help="instead: one spec, as JSON, and its .waypoints files")
    parser.add_argument("files", type=Path, nargs="*")
    options = parser.parse_args()
    findings = []

    def judge(name, spec, files):
        margins = json.loads(sortie_runs(options.sortie, "review", spec, *files, "--json"))["margins"]
        comparison = Comparison(spec, files)
        for finding in filter(None, map(comparison.finding, margins)):
            findings.append(finding)
            if options.verbose or not finding.agrees:
                print(f"{name}: {finding}: worse by {finding.worse:.4f}, better by {finding.better:.4f}")

    if options.spec:
        judge(options.spec, options.spec, options.files)
    else:
        ground = Ground(ROOT / "missions/terrain/jacksboro.tif")
        with tempfile.TemporaryDirectory() as scratch:
            for name, spec, files in fleets(options, ground, scratch):
                judge(name, spec, files)
    table(findings)
    sys.exit(not findings or not all(finding.agrees for finding in findings))


if __name__ == "__main__":
    main()
