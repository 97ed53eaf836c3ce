"""Whether any way to share tasks among vehicles costs less than a known one by more than 2 %: CP-SAT of ortools.

    python assign_exactly.py FILE SECONDS

FILE is a JSON list of cases: `times`, a square matrix of the ways between places, first the tasks, then start and goal of
each vehicle; `vehicles`; `budget`, the most that one vehicle may fly; `known`, the cost of a sharing of all tasks. Prints a
list with `better`: true where one costs less than `known / 1.02`, false where it is proven that none does, null where that
is not known after the seconds. One worker, so that every run is the same.
"""

import json
import sys

from ortools.sat.python import cp_model


def better(case, seconds):
    times, vehicles, budget = case["times"], case["vehicles"], case["budget"]
    tasks = len(times) - 2 * vehicles
    model = cp_model.CpModel()
    visits = [[model.new_bool_var("") for _ in range(tasks)] for _ in range(vehicles)]
    for task in range(tasks):
        model.add_exactly_one(of[task] for of in visits)
    total = []
    for vehicle in range(vehicles):
        start, goal = tasks + 2 * vehicle, tasks + 2 * vehicle + 1
        # Node 0 is start and goal in one.
        arcs, spent = [], []

        def arc(a, b, time):
            literal = model.new_bool_var("")
            arcs.append((a, b, literal))
            spent.append(time * literal)

        for task in range(tasks):
            arc(0, task + 1, times[start][task])
            arc(task + 1, 0, times[task][goal])
            arcs.append((task + 1, task + 1, visits[vehicle][task].negated()))
            for other in range(tasks):
                if other != task:
                    arc(task + 1, other + 1, times[task][other])
        arc(0, 0, times[start][goal])
        model.add_circuit(arcs)
        model.add(sum(spent) <= budget)
        total.extend(spent)
    least = model.new_int_var(0, int(case["known"] / 1.02 - 1e-6), "")
    model.add(least == sum(total))
    model.minimize(least)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.linearization_level = 2
    solver.parameters.stop_after_first_solution = True
    solver.parameters.max_time_in_seconds = seconds
    status = solver.solve(model)
    known = {cp_model.INFEASIBLE: False, cp_model.OPTIMAL: True, cp_model.FEASIBLE: True}
    return {"better": known.get(status), "bound": solver.best_objective_bound, "seconds": solver.wall_time}


def main():
    cases = json.load(open(sys.argv[1]))
    print(json.dumps([better(case, float(sys.argv[2])) for case in cases]))


if __name__ == "__main__":
    main()
