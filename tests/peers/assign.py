"""Who visits which place, by an exact solver: CP-SAT of OR-Tools, one worker.

    python assign.py CASES

CASES is JSON: for each case `ways`, the time from the place of the row to that of the column, `visits`, the places of which
each is visited once, and `vehicles`, the places where each starts and ends. The sum of the times of all ways is least.
Prints for each case the least sum found and the bound that is proven.
"""

import json
import sys
from pathlib import Path

from ortools.sat.python import cp_model

# Many times what a case takes.
SECONDS = 30.0


def solved(case):
    ways, visits, vehicles = case["ways"], case["visits"], case["vehicles"]
    model = cp_model.CpModel()
    # One tour through all: start of a vehicle, what it visits, its goal, start of the next one. The nodes:
    # the visits, then start and goal of each vehicle.
    starts = [len(visits) + 2 * vehicle for vehicle in range(len(vehicles))]
    places = visits + [place for ends in vehicles for place in ends]
    arcs, costs = [], []

    def leg(tail, head):
        used = model.new_bool_var("")
        arcs.append((tail, head, used))
        costs.append(ways[places[tail]][places[head]] * used)

    for one in range(len(visits)):
        for other in range(len(visits)):
            if one != other:
                leg(one, other)
        for start in starts:
            leg(start, one)
            leg(one, start + 1)
    for number, start in enumerate(starts):
        leg(start, start + 1)
        arcs.append((start + 1, starts[(number + 1) % len(starts)], model.new_constant(1)))
    # Whose way each node is on: no vehicle ends at the goal of another one.
    who = [model.new_int_var(0, len(vehicles) - 1, "") for _ in places]
    for number, start in enumerate(starts):
        model.add(who[start] == number)
        model.add(who[start + 1] == number)
    for tail, head, used in arcs:
        if not (tail >= len(visits) and head in starts):
            model.add(who[head] == who[tail]).only_enforce_if(used)
    model.add_circuit(arcs)
    model.minimize(sum(costs))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_time_in_seconds = SECONDS
    solver.parameters.random_seed = 1
    solver.parameters.linearization_level = 2
    status = solver.solve(model)
    is_solved = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    return {
        "found": solver.objective_value if is_solved else None,
        "bound": solver.best_objective_bound,
        "seconds": round(solver.wall_time, 2),
    }


print(json.dumps([solved(case) for case in json.loads(Path(sys.argv[1]).read_text())]))
