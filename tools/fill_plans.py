"""Brings the missions of a folder that `sortie plan` wrote to a number of items, for
measurements: waypoints are added on the straight way between two that follow each
other, so that what is flown stays the same. The `.waypoints` of the same missions are
removed: `sortie upload` takes no folder whose files disagree.

usage: fill_plans.py DIR ITEMS
"""

import json
import pathlib
import sys

WAYPOINT = 16


def fill(items, count):
    """`items` with waypoints added between the pair that is farthest apart."""

    def apart(n):
        a, b = items[n], items[n + 1]
        if (a["command"], b["command"]) != (WAYPOINT, WAYPOINT):
            return -1.0
        return abs(a["params"][4] - b["params"][4]) + abs(a["params"][5] - b["params"][5])

    n = max(range(len(items) - 1), key=apart)
    before, after = items[n], items[n + 1]
    more = count - len(items)
    new = []
    for k in range(1, more + 1):
        t = k / (more + 1)
        item = json.loads(json.dumps(after))
        for i in (4, 5, 6):
            a, b = before["params"][i], after["params"][i]
            item["params"][i] = round(a + t * (b - a), 7 if i < 6 else 2)
        item["Altitude"] = item["params"][6]
        new.append(item)
    items[n + 1 : n + 1] = new
    for number, item in enumerate(items, 1):
        item["doJumpId"] = number


for path in sorted(pathlib.Path(sys.argv[1]).glob("*.plan")):
    plan = json.loads(path.read_text())
    fill(plan["mission"]["items"], int(sys.argv[2]))
    path.write_text(json.dumps(plan, indent=2) + "\n")
    path.with_suffix(".waypoints").unlink(missing_ok=True)
