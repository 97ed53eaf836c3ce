"""Corrupts a certificate in a hundred ways that change what it says, and lets the checker judge.

Arguments: spec, folder of the certificate, an empty folder. Prints which corruptions were accepted.
"""

import copy
import hashlib
import json
import random
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_certificate as checker

spec_path, folder, scratch = map(Path, sys.argv[1:])
good = json.loads((folder / "certificate.json").read_text())
text = spec_path.read_text()


def route(document):
    return document["vehicles"][0]["routes"][0]


def claim(document, by):
    """Bounds that are higher by a share."""
    for vehicle in document["vehicles"]:
        vehicle["bound"] *= 1 + by
        for one in vehicle["routes"]:
            one["bound"] *= 1 + by


def other_spec(document, pattern, change):
    found = re.sub(pattern, lambda match: match[1] + repr(change(float(match[2]))), text, count=1)
    assert found != text
    document["spec_sha256"] = hashlib.sha256(found.encode()).hexdigest()
    return found


def obstacle_grown(document, by):
    return other_spec(document, r"(radius_m: )([\d.]+)(?=})(?![^\n]*height_m)", lambda radius: radius * (1 - 5 * by))


def cost_raised(document, by):
    return other_spec(document, r"(weights: {length: )([\d.]+)", lambda weight: weight * (1 - by))


def steepened(document, by):
    one = route(document)
    one["potential_km"] = [value * (1 + by) for value in one["potential_km"]]
    claim(document, by)


def goal_raised(document, by):
    one = route(document)
    nodes, goal = len(one["nodes"]), one["end_nodes"][1]
    for level in range(len(one["levels_m"])):
        one["potential_km"][level * nodes + goal] += by * one["bound"]
    claim(document, by)


def floor_raised(document, by):
    one = route(document)
    one["floor_m"] = [height + 1000 * by for height in one["floor_m"]]


def climb_flatter(document, by):
    route(document)["climb"] *= 1 - 5 * by


def descent_flatter(document, by):
    route(document)["descent"] *= 1 - 5 * by


def bound_raised(document, by):
    claim(document, by)


def start_nearer(document, by):
    one = route(document)
    node, other = one["end_nodes"][0], one["ends"][1]
    for axis in (0, 1):
        at = one["ends"][0][axis]
        one["ends"][0][axis] = one["nodes"][node][axis] = at + by * 0.1 * (at - other[axis])


def mesh_cut(document, by):
    """Paths that count are said to be shorter than they may be."""
    one = route(document)
    one["longest_m"] = one["bound"] * 1000 * (1 - by)


def turned_over(document, by):
    one = route(document)
    at = len(one["nodes"]) // 2 + int(200 * by)
    one["nodes"][at], one["nodes"][at + 1] = one["nodes"][at + 1], one["nodes"][at]


KINDS = [obstacle_grown, cost_raised, steepened, goal_raised, floor_raised, climb_flatter, descent_flatter,
         bound_raised, start_nearer, mesh_cut, turned_over]


def verdict(document, spec=text):
    path = scratch / spec_path.name
    path.write_text(spec)
    try:
        checker.check(path, document)
    except checker.Rejected:
        return "rejected"
    return "accepted"


draw = random.Random(7)
accepted = []
for index in range(110):
    kind = KINDS[index % len(KINDS)]
    document = copy.deepcopy(good)
    spec = kind(document, draw.uniform(0.003, 0.03)) or text
    if verdict(document, spec) == "accepted":
        accepted.append(f"{kind.__name__} {index}")
print(json.dumps({"good": verdict(good), "tried": 110, "accepted": accepted}))
