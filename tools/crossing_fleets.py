#!/usr/bin/env python3
"""Fleets that all cross one point: what they cost above the proven bound, and how long planning takes.

    tools/crossing_fleets.py SORTIE ['NAME;NAME...'] [--seeds N] [--keep DIR]
    tools/crossing_fleets.py SORTIE NAME --orders N [--evaluations N]

Copters on a circle, each with its goal opposite of its start, over flat ground. Prints a row a
problem, of several seeds the worst of each column; processor time and memory are those of
`sortie plan`. The exit code is 1 if a fleet breaks a limit, or if one with a freedom (departures,
speeds, heights) costs more than the same fleet without it.

With `--orders` a problem is planned with its vehicles in N random orders of priority, the first as
given, and the cost of each is printed.
"""

import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

LAT, LON, RADIUS_M = -35.36, 149.165, 2500.0
WINDOW = "depart_window_s: {from: 0, to: 120}"
SPEEDS = "speed_range_mps: {min: 12, max: 18}"
# Name: vehicles, separation m, vertical separation m, freedoms of a vehicle, how they lie.
PROBLEMS = {
    "10": (10, 300, None, [], "circle"),
    "10, windows": (10, 300, None, [WINDOW], "circle"),
    "10, speeds": (10, 300, None, [SPEEDS], "circle"),
    "10, layers": (10, 300, 50, [], "circle"),
    "10, all three": (10, 300, 50, [WINDOW, SPEEDS], "circle"),
    "10 uneven": (10, 100, None, [], "uneven"),
    "10 uneven, windows": (10, 100, None, [WINDOW], "uneven"),
    "10 uneven, speeds": (10, 100, None, [SPEEDS], "uneven"),
    "10 uneven, layers": (10, 100, 50, [], "uneven"),
    "14": (14, 50, None, [], "circle"),
    "14 half circle": (14, 50, None, [], "half"),
    "20": (20, 100, None, [], "circle"),
    "40": (40, 100, None, [], "circle"),
    "40, windows": (40, 100, None, [WINDOW], "circle"),
}


def place(angle):
    north = RADIUS_M / 110950.0 * math.sin(angle)
    east = RADIUS_M / (111320.0 * math.cos(math.radians(LAT))) * math.cos(angle)
    return f"{{lat: {LAT + north:.6f}, lon: {LON + east:.6f}, agl_m: 60}}"


def spec(count, separation_m, vertical_m, freedoms, shape, evaluations=4000, order=0):
    vertical = f", vertical_m: {vertical_m}" if vertical_m else ""
    lines = [
        "sortie: 2", "name: crossing", "area:",
        "  south_west: {lat: -35.389, lon: 149.130}", "  north_east: {lat: -35.331, lon: 149.200}",
        "  min_agl_m: 40", "  max_amsl_m: 904", "terrain: {flat: {amsl_m: 584}}",
        f"separation: {{distance_m: {separation_m}, time_slack_s: 5{vertical}}}",
        f"planner: {{seed: 1, evaluations: {evaluations}}}", "mission: {fence: false}", "vehicles:",
    ]
    numbers = list(range(count))
    if order:
        random.Random(order).shuffle(numbers)
    for n in numbers:
        angle = (math.pi if shape == "half" else math.tau) * n / count
        goal = angle + math.pi + (0.15 * math.sin(5 * n) if shape == "uneven" else 0)
        open_keys = "".join(f", {key}" for key in freedoms)
        lines.append(
            f"  - {{id: v{n:02}, sysid: {n + 1}, autopilot: ardupilot, link: sim, finish: land, "
            f"start: {place(angle)}, goal: {place(goal)}, "
            f"speed_mps: 15, max_airspeed_mps: 20{open_keys}}}"
        )
    return "\n".join(lines) + "\n"


def plan(sortie, path, seed, out):
    """Cost, bound, violations, processor seconds and MiB of one plan."""
    command = [sortie, "plan", path, "--seed", seed, "--out", out]
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read().decode()
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 4):
        sys.exit(said)
    fleet = json.loads((out / "plan.json").read_text())["fleet"]
    margins = json.loads((out / "review.json").read_text())["margins"]
    broken = sum(not margin["ok"] for margin in margins)
    return fleet["cost"], fleet["bound"], broken, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def in_orders(sortie, name, orders, evaluations):
    """Plans a problem with its vehicles in some orders."""
    with tempfile.TemporaryDirectory() as temporary:
        path = pathlib.Path(temporary) / "crossing.yaml"
        costs = []
        for order in range(orders):
            path.write_text(spec(*PROBLEMS[name], evaluations, order))
            cost, _, broken, cpu_s, _ = plan(sortie, path, 1, path.parent / "plan")
            costs.append(math.inf if broken else cost)
            print(f"order {order}: {cost:.4f}, {broken} violations, {cpu_s:.1f} s", flush=True)
    print(f"least {min(costs):.4f}, as given {100 * (costs[0] / min(costs) - 1):.3f} % above it")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sortie", help="the program")
    parser.add_argument("names", nargs="?", default=";".join(PROBLEMS), help="problems, with semicolons between them")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, help="keep specs and plans in this folder")
    parser.add_argument("--orders", type=int, help="random orders of priority in which one problem is planned")
    parser.add_argument("--evaluations", type=int, default=40_000, help="of each vehicle in each order")
    options = parser.parse_args()
    if options.orders:
        in_orders(options.sortie, options.names, options.orders, options.evaluations)
        return
    costs, bad = {}, False
    print("| problem | seeds | cost | bound | gap | violations | processor, s | memory, MiB |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in options.names.split(";"):
            file = "-".join(name.replace(",", "").split())
            path = folder / f"{file}.yaml"
            path.write_text(spec(*PROBLEMS[name]))
            seeds = range(1, options.seeds + 1)
            runs = [plan(options.sortie, path, seed, folder / f"{file}-{seed}") for seed in seeds]
            cost, bound, broken, cpu_s, memory_mib = map(max, zip(*runs))
            broken = sum(run[2] for run in runs)
            print(f"| {name} | {options.seeds} | {cost:.3f} | {bound:.3f} | {100 * (cost / bound - 1):.2f} % "
                  f"| {broken} | {cpu_s:.1f} | {memory_mib:.0f} |", flush=True)
            costs[name] = [run[0] for run in runs]
            bad |= broken > 0
    for name, found in costs.items():
        without = costs.get(name.split(",")[0], found)
        if any(own > other for own, other in zip(found, without)):
            print(f"{name}: dearer than without: {found}, {without}")
            bad = True
    sys.exit(bad)


if __name__ == "__main__":
    main()
