#!/usr/bin/env python3
"""Other people's optimisers on the objective of `sortie evaluate`, at equal evaluations.

    python3 -m venv target/optimizers && target/optimizers/bin/pip install -r tools/optimizers.txt
    cargo build --release
    target/optimizers/bin/python tools/peers.py missions/jacksboro.yaml --seeds 10 > peers.md

For every spec and its first vehicle: CMA-ES with restarts (pycma, BIPOP), sade, de1220,
cmaes and pso_gen (pygmo), L-SHADE (below, after Tanabe and Fukunaga 2014), and our own
planner, each with the same number of evaluations and seed. What each found is judged
at 2001 samples. A library that is not installed is left out, and the table says so.
"""

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SORTIE = Path(__file__).resolve().parent.parent / "target/release/sortie"


class Objective:
    """One `sortie evaluate` process; batches in, costs out."""

    def __init__(self, spec, vehicle, samples=None):
        command = [SORTIE, "evaluate", spec, "--vehicle", vehicle]
        self.dimension = int(subprocess.check_output([*command, "--dimension"]))
        if samples:
            command += ["--samples", str(samples)]
        self.process = subprocess.Popen(
            [*command, "--binary"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def __call__(self, rows):
        rows = np.ascontiguousarray(np.clip(rows, 0.0, 1.0), dtype="<f8")
        costs = np.empty(len(rows))
        # No more at once than answers fit into a pipe, or both sides wait for ever.
        for first in range(0, len(rows), 1000):
            part = rows[first : first + 1000]
            self.process.stdin.write(part.tobytes())
            self.process.stdin.flush()
            costs[first : first + 1000] = np.frombuffer(self.process.stdout.read(8 * len(part)), dtype="<f8")
        return costs

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Spent(Exception):
    """The budget is used up."""


class Budget:
    """Counts evaluations and keeps the best; refuses those beyond the budget."""

    def __init__(self, objective, evaluations):
        self.objective, self.left = objective, evaluations
        self.best, self.place = np.inf, None
        self.dimension = objective.dimension

    def __call__(self, rows):
        rows = np.atleast_2d(rows)
        if self.left <= 0:
            raise Spent
        rows = rows[: self.left]
        self.left -= len(rows)
        costs = self.objective(rows)
        least = int(np.argmin(costs))
        if costs[least] < self.best:
            self.best, self.place = float(costs[least]), np.clip(rows[least], 0.0, 1.0)
        return costs


def pycma(budget, seed):
    import cma

    restart = 0
    rng = np.random.default_rng(seed)
    while True:
        options = {"seed": seed * 1000 + restart + 1, "bounds": [0, 1], "verbose": -9}
        # IPOP: the population doubles at every restart.
        options["popsize"] = 13 * 2 ** min(restart, 6)
        search = cma.CMAEvolutionStrategy(rng.random(budget.dimension), 0.25, options)
        while not search.stop():
            asked = search.ask()
            costs = budget(np.array(asked))
            if len(costs) < len(asked):
                raise Spent
            search.tell(asked, list(costs))
        restart += 1


class PygmoProblem:
    def __init__(self, budget):
        self.budget = budget

    def __deepcopy__(self, memo):
        return self

    def get_bounds(self):
        return [0.0] * self.budget.dimension, [1.0] * self.budget.dimension

    def fitness(self, place):
        if self.budget.left <= 0:
            return [1e300]
        return [float(self.budget(place)[0])]


def pygmo(name, population=50):
    def run(budget, seed):
        import pygmo as pg

        generations = budget.left // population
        make = {
            "sade": lambda: pg.sade(gen=generations, seed=seed),
            "de1220": lambda: pg.de1220(gen=generations, seed=seed),
            "cmaes": lambda: pg.cmaes(gen=generations, force_bounds=True, seed=seed),
            "pso_gen": lambda: pg.pso_gen(gen=generations, seed=seed),
        }[name]
        problem = pg.problem(PygmoProblem(budget))
        start = pg.population(problem, population, seed=seed)
        pg.algorithm(make()).evolve(start)

    return run


def lshade(budget, seed):
    """L-SHADE: success-history adaptation, linear reduction of the population."""
    rng = np.random.default_rng(seed)
    d, all_ = budget.dimension, budget.left
    most, least, memory = 18 * d, 4, 6
    m_f, m_cr, slot = np.full(memory, 0.5), np.full(memory, 0.5), 0
    people = rng.random((most, d))
    costs = budget(people)
    archive = np.empty((0, d))
    while True:
        n = len(people)
        order = np.argsort(costs)
        which = rng.integers(memory, size=n)
        cr = np.clip(rng.normal(m_cr[which], 0.1), 0.0, 1.0)
        cr[m_cr[which] < 0.0] = 0.0
        f = np.zeros(n)
        while (low := f <= 0.0).any():
            f[low] = m_f[which][low] + 0.1 * rng.standard_cauchy(low.sum())
        f = np.minimum(f, 1.0)[:, None]
        best = people[order[rng.integers(max(2, round(0.11 * n)), size=n)]]
        first = people[rng.integers(n, size=n)]
        pool = np.vstack([people, archive])
        second = pool[rng.integers(len(pool), size=n)]
        trial = people + f * (best - people) + f * (first - second)
        trial = np.where(trial < 0.0, people / 2.0, trial)
        trial = np.where(trial > 1.0, (people + 1.0) / 2.0, trial)
        cross = rng.random((n, d)) < cr[:, None]
        cross[np.arange(n), rng.integers(d, size=n)] = True
        trial = np.where(cross, trial, people)
        found = budget(trial)
        if len(found) < n:
            raise Spent
        better = found < costs
        if better.any():
            gain = costs[better] - found[better]
            weight = gain / gain.sum()
            s_f, s_cr = f[better, 0], cr[better]
            m_f[slot] = (weight * s_f**2).sum() / (weight * s_f).sum()
            top = (weight * s_cr).sum()
            m_cr[slot] = -1.0 if top <= 0.0 else (weight * s_cr**2).sum() / top
            slot = (slot + 1) % memory
            archive = np.vstack([archive, people[better]])
            people[better], costs[better] = trial[better], found[better]
        size = max(least, round(most + (least - most) * (1.0 - budget.left / all_)))
        keep = np.argsort(costs)[:size]
        people, costs = people[keep], costs[keep]
        room = int(1.4 * size)
        if len(archive) > room:
            archive = archive[rng.permutation(len(archive))[:room]]


METHODS = {
    "CMA-ES, restarts (pycma)": pycma,
    "sade (pygmo)": pygmo("sade"),
    "de1220 (pygmo)": pygmo("de1220"),
    "cmaes (pygmo)": pygmo("cmaes"),
    "pso_gen (pygmo)": pygmo("pso_gen"),
    "L-SHADE": lshade,
}


def first_vehicle(spec):
    """Its id: the first one under `vehicles:`."""
    text = Path(spec).read_text().split("\nvehicles:", 1)[1]
    return text.split("id:", 1)[1].split("\n", 1)[0].split(",")[0].split("#")[0].strip()


def ours(spec, evaluations, seed):
    """The planner alone: the cost of its first vehicle, judged at 2001 samples."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "in"
        shutil.copytree(Path(spec).parent, copy, ignore=shutil.ignore_patterns("*.png", "out"))
        text = Path(spec).read_text()
        lines = [line for line in text.splitlines() if not line.startswith("planner:")]
        lines.append(f"planner: {{evaluations: {evaluations}}}")
        (copy / Path(spec).name).write_text("\n".join(lines) + "\n")
        started = time.monotonic()
        done = subprocess.run(
            [SORTIE, "plan", copy / Path(spec).name, "--out", Path(folder) / "out", "--seed", str(seed), "--json"],
            capture_output=True,
            check=False,
        )
        took = time.monotonic() - started
        return json.loads(done.stdout)["vehicles"][0]["cost"]["total"], took


def one(spec, vehicle, method, evaluations, seed, judge):
    """The cost a method finds, judged finely, and the seconds it takes."""
    objective = Objective(spec, vehicle)
    budget = Budget(objective, evaluations)
    started = time.monotonic()
    try:
        method(budget, seed)
    except Spent:
        pass
    took = time.monotonic() - started
    objective.close()
    return float(judge(budget.place[None, :])[0]), took


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("specs", nargs="+")
    parser.add_argument("--evaluations", type=int, default=40_000)
    parser.add_argument("--seeds", type=int, default=40)
    arguments = parser.parse_args()
    print(f"{arguments.evaluations} evaluations, {arguments.seeds} seeds, judged at 2001 samples.\n")
    print("| spec | method | best | median | worst | seconds (median) |")
    print("|---|---|---:|---:|---:|---:|")
    for spec in arguments.specs:
        vehicle = first_vehicle(spec)
        judge = Objective(spec, vehicle, samples=2001)
        rows = [("sortie", lambda seed: ours(spec, arguments.evaluations, seed))]
        for name, method in METHODS.items():
            rows.append((name, lambda seed, method=method: one(spec, vehicle, method, arguments.evaluations, seed, judge)))
        for name, run in rows:
            try:
                results = [run(seed) for seed in range(1, arguments.seeds + 1)]
            except ImportError as error:
                print(f"| {Path(spec).name} | {name} | not run: {error} | | | |", flush=True)
                continue
            costs = [cost for cost, _ in results]
            seconds = statistics.median(took for _, took in results)
            numbers = f"{min(costs):.3f} | {statistics.median(costs):.3f} | {max(costs):.3f} | {seconds:.1f}"
            print(f"| {Path(spec).name} | {name} | {numbers} |", flush=True)
        judge.close()


if __name__ == "__main__":
    sys.exit(main())
