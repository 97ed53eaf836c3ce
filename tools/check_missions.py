"""Judges missions a second time and holds `sortie review` against it.

    python tools/check_missions.py [--fleets 50] [--seed 1] [--sortie target/debug/sortie] [--keep DIR]
    python tools/check_missions.py --spec SPEC FILES...

Random fleets over the Jacksboro fault, bad ones on purpose and some planned in a hurry, go
through `sortie review`; then the clearance over ground, the distances to threats and the
separations are measured again from the files alone. The flight model is that of the text in
src/verify/mod.rs, and nothing else is shared: legs are chords through the earth between
geodetic places and never see a local frame, and minima are found by sampling (tools/second).

About half of the fleets have buffers, and each limit must be that of the spec with its buffer.
A margin agrees when sampling finds nothing worse than was reported, and nothing better by
more than its own error and what the text allows the verdict to be short by (its chords):

    found + rounding >= reported >= found - error - chords - rounding

`found` is the value at a sample, so it is attained. `error` bounds how far the true minimum
lies below it: every cell between samples was halved until the greatest slope or speed in
it proved that it holds nothing lower than found - 1 cm (of a separation, 0.1 per mille more).
Both sides also get what the two models of the earth differ in: a straight line of the
verdict's plane and a chord through the earth are centimetres apart, and so are their lengths.
With --wings so many VTOLs of PX4 in still air are compared besides: clearance and threats, with corners, lag and
early altitudes, takeoff and landing on rotors. Not compared: planes, ArduPlane (swings, regions),
circles and glides, wind, ceilings, and the separation of wings.
Spec files are read as JSON, which is YAML.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from second.earth import A, Ground
from second.fleets import make_fleet, make_wing
from second.flight import Flight, read_items, read_radius
from second.minima import clearance, separation, to_threat
from second.wing import WingFlight

ROOT = Path(__file__).resolve().parent.parent
CHORD_M = 0.02  # the verdict's chords of arcs and ramps
FOLLOW_M = 0.12  # its chords over ground that is followed, and a chord of those
ROUNDING_M = 0.002  # of printed margins and float32 altitudes
PLANNED = 10  # every tenth fleet is also planned


@dataclass
class Finding:
    kind: str
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


def compare(spec_path, files, margins):
    """Every margin of clearance, threats and separation that was reported, measured again."""
    spec = json.loads(spec_path.read_text())
    ground = Ground(spec_path.parent / spec["terrain"]["file"])
    by_name = {path.name.split(".")[0]: path for path in files}
    flights = {
        v["id"]: WingFlight(v, read_items(by_name[v["id"]]), ground, spec["mission"]["tolerance_m"])
        if v["airframe"] == "vtol" else Flight(
            v, read_items(by_name[v["id"]]), ground, spec["mission"]["tolerance_m"],
            read_radius(by_name[v["id"]], v["autopilot"] == "ardupilot"),
        )
        for v in spec["vehicles"]
    }
    corners = spec["area"]["south_west"], spec["area"]["north_east"]
    middle = {key: sum(corner[key] for corner in corners) / 2 for key in ("lat", "lon")}
    touches = spec.get("origin", middle)
    origin = touches["lat"], touches["lon"]
    slack, vertical = spec["separation"]["time_slack_s"], spec["separation"].get("vertical_m")
    fleet = list(flights.values())
    late = max(flight.late for flight in fleet) + max(one.takeoff_late(other) for one in fleet for other in fleet)
    horizon = max(flight.horizon() for flight in fleet) + slack + late + 1
    for flight in flights.values():
        flight.stay_until(horizon)
    threats = {f"threat {threat['id']}": threat for threat in spec.get("threats", [])}
    buffers = spec.get("buffer_m", {})
    buffer = lambda kind: buffers.get(kind, buffers.get("all", 0))
    for margin in margins:
        flight, what = flights[margin["vehicle"]], margin["what"]
        value = math.nan if margin["value"] is None else margin["value"]
        name = f"{margin['vehicle']} {what}"
        if what == "terrain clearance":
            slope = ground.steepest
            found, error = clearance(flight)
            model = max(CHORD_M * slope, FOLLOW_M if flight.follows else 0)
            yield Finding("clearance", not margin["ok"], name, value, found, error, model, flight.beside(origin) * slope,
                          margin["limit"], spec["area"]["min_agl_m"] + buffer("terrain"))
        elif what in threats:
            found, error = to_threat(flight, threats[what])
            # A plane that touches the earth at the axis makes a distance r short by r (r / R)^2 / 6, a chord by 1/24.
            away = found + threats[what]["radius_m"]
            short = away * (away / A) ** 2 / 7
            yield Finding("threat", not margin["ok"], name, value, found, error, CHORD_M + short, flight.beside(origin),
                          margin["limit"], buffer("threats"))
        elif what == "separation":
            other = flights[margin["other"]]
            follow = (flight.follows + other.follows) * FOLLOW_M
            level = None if vertical is None else vertical + margin.get("buffer", 0)
            measure, found, error, chords = separation(flight, other, slack, level, 2 * CHORD_M + follow)
            reported = "gap" if margin["unit"] == "s" else "m" if margin["limit"] != level else "vertical"
            if measure != reported:
                found = math.nan
            plane = sum(f.along(origin) + f.beside(origin) for f in (flight, other))
            short = found * (flight.furthest(origin) + other.furthest(origin) + found) ** 2 / (2 * A * A)
            yield Finding("separation", not margin["ok"], f"{name} {margin['other']}", value, found, error, chords + short, plane,
                          margin["limit"], spec["separation"]["distance_m"] + buffer("separation") if reported == "m" else math.nan)


def plan(spec, sortie):
    """The same spec planned, in a hurry: what fails is as good to judge as what passes."""
    folder = spec.parent / "planned"
    sortie_runs(sortie, "plan", spec, "--out", folder)
    return folder / spec.name, sorted(folder.glob("*.waypoints"))


def table(findings):
    """One line for each kind: how many, how many of them violated, and the largest differences."""
    print("             compared  violated  above a sample  below a sample  sampling error  disagree")
    for kind in ("clearance", "threat", "separation"):
        of = [finding for finding in findings if finding.kind == kind]
        above = max((f.reported - f.found for f in of), default=0)
        below = max((f.found - f.reported for f in of), default=0)
        error = max((f.error for f in of), default=0)
        violated, wrong = sum(f.violated for f in of), sum(not f.agrees for f in of)
        print(f"{kind:12} {len(of):8}  {violated:8}  {above:12.4f} m  {below:12.4f} m  {error:12.4f} m  {wrong:8}")


def main():
    parser = argparse.ArgumentParser(description="Holds `sortie review` against a second implementation.")
    parser.add_argument("--fleets", type=int, default=50, help="how many, at random over the Jacksboro fault")
    parser.add_argument("--seed", type=int, default=1, help="of the first of them; each has its own")
    parser.add_argument("--wings", type=int, default=0, help="so many VTOLs of PX4 besides")
    parser.add_argument("--sortie", type=Path, default=ROOT / "target/debug/sortie")
    parser.add_argument("--keep", type=Path, help="leave the fleets in this folder")
    parser.add_argument("--verbose", action="store_true", help="print every margin")
    parser.add_argument("--spec", type=Path, help="instead: one spec, as JSON, and its .waypoints files")
    parser.add_argument("files", type=Path, nargs="*")
    options = parser.parse_args()
    findings = []

    def judge(name, spec, files):
        margins = json.loads(sortie_runs(options.sortie, "review", spec, *files, "--json"))["margins"]
        for finding in compare(spec, files, margins):
            findings.append(finding)
            if options.verbose or not finding.agrees:
                print(f"{name}: {finding}: worse by {finding.worse:.4f}, better by {finding.better:.4f}")

    if options.spec:
        judge(options.spec, options.spec, options.files)
    else:
        terrain = ROOT / "missions/terrain/jacksboro.tif"
        ground = Ground(terrain)
        with tempfile.TemporaryDirectory() as scratch:
            for number in range(options.seed, options.seed + options.fleets):
                folder = (options.keep or Path(scratch)) / str(number)
                folder.mkdir(parents=True, exist_ok=True)
                (folder / terrain.name).write_bytes(terrain.read_bytes())
                spec, files = make_fleet(np.random.default_rng(number), ground, folder)
                judge(f"fleet {number}", spec, files)
                if number % PLANNED == 0:
                    judge(f"fleet {number} planned", *plan(spec, options.sortie))
            copters = len(findings)
            for number in range(options.seed, options.seed + options.wings):
                folder = (options.keep or Path(scratch)) / f"wing-{number}"
                folder.mkdir(parents=True, exist_ok=True)
                (folder / terrain.name).write_bytes(terrain.read_bytes())
                judge(f"wing {number}", *make_wing(np.random.default_rng([number, 2]), ground, folder))
        print(f"compared of copters: {copters}, of VTOLs of PX4: {len(findings) - copters}; planes and ArduPlane are not")
    table(findings)
    sys.exit(not findings or not all(finding.agrees for finding in findings))


if __name__ == "__main__":
    main()
