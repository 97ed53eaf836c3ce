"""Shares tasks among vehicles at the least cost that can be proven, with CP-SAT of ortools and one worker.

    python assign_exactly.py FILE SECONDS

FILE is a JSON list of cases: `times`, a square matrix of the ways between places, first the tasks, then start and
goal of each vehicle; `vehicles`; and `budget`, the most that one vehicle may fly. All tasks must be done. Prints for each
case the least sum of the times and the bound that was proven within the seconds.
"""

import json
import sys

from ortools.sat.python import cp_model


def solve(case, seconds):
    """One tour over all tasks and vehicles: vehicle v is its start on the way out and the goal of v - 1 on the way in."""
    times, vehicles, budget = case["times"], case["vehicles"], case["budget"]
    tasks = len(times) - 2 * vehicles
    model = cp_model.CpModel()
    who = [model.new_int_var(0, vehicles - 1, "") for _ in range(tasks)]
    spent = [model.new_int_var(0, budget, "") for _ in range(tasks)]
    arcs, total = [], []

    def arc(a, b, time):
        literal = model.new_bool_var("")
        arcs.append((a, b, literal))
        total.append(time * literal)
        return literal

    for task in range(tasks):
        for other in range(tasks):
            if other != task:
                used = arc(task, other, times[task][other])
                model.add(who[other] == who[task]).only_enforce_if(used)
                model.add(spent[other] >= spent[task] + times[task][other]).only_enforce_if(used)
    for vehicle in range(vehicles):
        start, goal = tasks + 2 * vehicle, tasks + 2 * vehicle + 1
        here, next_one = tasks + vehicle, tasks + (vehicle + 1) % vehicles
        for task in range(tasks):
            used = arc(here, task, times[start][task])
            model.add(who[task] == vehicle).only_enforce_if(used)
            model.add(spent[task] >= times[start][task]).only_enforce_if(used)
            used = arc(task, next_one, times[task][goal])
            model.add(who[task] == vehicle).only_enforce_if(used)
            model.add(spent[task] + times[task][goal] <= budget).only_enforce_if(used)
        arc(here, next_one, times[start][goal])
    model.add_circuit(arcs)
    model.minimize(sum(total))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.linearization_level = 2
    status = solver.solve(model)
    found = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    return {
        "cost": solver.objective_value if found else None,
        "bound": solver.best_objective_bound,
        "optimal": status == cp_model.OPTIMAL,
        "seconds": solver.wall_time,
    }


def main():
    cases = json.load(open(sys.argv[1]))
    print(json.dumps([solve(case, float(sys.argv[2])) for case in cases]))


if __name__ == "__main__":
    main()
