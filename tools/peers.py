#!/usr/bin/env python3
"""Other people's optimisers on the objective of `sortie evaluate`, at equal evaluations.

    python3 -m venv target/optimizers && target/optimizers/bin/python -m pip install -r tools/optimizers.txt
    cargo build --release
    target/optimizers/bin/python tools/peers.py --generated 101-120 missions/*.yaml > peers.md

For every spec and its first vehicle, alone: CMA-ES with restarts (pycma, IPOP), sade,
de1220, cmaes and pso_gen (pygmo), L-SHADE (below, after Tanabe and Fukunaga 2014), and our
own planner, each with the same number of evaluations and the same seeds. What each found is
judged at 2001 samples. The time to within 1 % of the best known cost is the processor time to
expect if a run that misses it is followed by another: all time spent, over the runs that
reach it. Of the others it is the time of the optimiser and of `sortie evaluate` together,
until the best so far, judged, is there; of ours that of whole `sortie plan`s, with the budget
that is best for it.

Runs of a few seeds go in step, so that what they ask for is answered as one batch: answers
are the same, and the pipe is no longer what takes the time. Processor time is shared evenly.

Every run is kept as a line under --records, and a run that is there is not made again; so a
comparison can be broken off and taken up. Records belong to one objective: begin anew when
the objective or the specs changed.
"""

import argparse
import itertools
import json
import multiprocessing
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

# Before numpy reads it: on matrices of this size its threads spend time and save none.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import yaml

ROOT = Path(__file__).resolve().parent.parent
SORTIE = Path(os.environ.get("SORTIE", ROOT / "target/release/sortie"))

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


# Seeds of one job; they go in step.
GROUP = 8


class InStep:
    """An objective for several threads: each waits until all that still run have asked."""

    def __init__(self, objective, threads):
        self.objective, self.dimension = objective, objective.dimension
        self.lock, self.running, self.asked = threading.Lock(), threads, []

    def __call__(self, rows):
        question = Question(rows)
        with self.lock:
            self.asked.append(question)
            batch = self.whole()
        self.answer(batch)
        question.gate.acquire()
        if question.costs is None:
            raise BrokenPipeError("`sortie evaluate` has ended")
        return question.costs

    def leave(self):
        with self.lock:
            self.running -= 1
            batch = self.whole()
        self.answer(batch)

    def whole(self):
        """What was asked, if by all; nothing else."""
        if len(self.asked) < self.running:
            return []
        batch, self.asked = self.asked, []
        return batch

    def answer(self, batch):
        if not batch:
            return
        try:
            costs = self.objective(np.concatenate([question.rows for question in batch]))
            first = 0
            for question in batch:
                question.costs = costs[first : first + len(question.rows)]
                first += len(question.rows)
        finally:
            for question in batch:
                question.gate.release()


class Question:
    def __init__(self, rows):
        self.rows, self.costs = rows, None
        self.gate = threading.Lock()
        self.gate.acquire()


# Gains that are judged for the time to within 1 %.
TOLD = 5e-4


class Spent(Exception):
    """The budget is used up."""


class Budget:
    """Counts evaluations and keeps the best; refuses those beyond the budget."""

    def __init__(self, objective, evaluations):
        self.objective, self.left = objective, evaluations
        self.best, self.place = np.inf, None
        self.dimension = objective.dimension
        self.improvements = []

    def __call__(self, rows):
        if self.left <= 0:
            raise Spent
        rows = rows[: self.left]
        self.left -= len(rows)
        costs = self.objective(rows)
        least = int(np.argmin(costs))
        if costs[least] < self.best:
            told = self.improvements[-1][1] if self.improvements else np.inf
            self.best, self.place = float(costs[least]), np.clip(rows[least], 0.0, 1.0)
            if self.best < told * (1.0 - TOLD):
                self.improvements.append((time.process_time(), self.best, self.place))
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


class Spending:
    """What pygmo copies as it likes, and what all copies spend."""

    def __init__(self, budget):
        self.budget = budget

    def __deepcopy__(self, memo):
        return self


class PygmoProblem(Spending):
    def get_bounds(self):
        return [0.0] * self.budget.dimension, [1.0] * self.budget.dimension

    def fitness(self, place):
        if self.budget.left <= 0:
            return [1e300]
        return [float(self.budget(place[None, :])[0])]


class Generations(Spending):
    """A generation as one batch, for those of pygmo that can."""

    def __call__(self, problem, places):
        count = len(places) // self.budget.dimension
        costs = np.full(count, 1e300)
        if self.budget.left > 0:
            found = self.budget(places.reshape(count, -1))
            costs[: len(found)] = found
        return costs


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
        algorithm = make()
        if hasattr(algorithm, "set_bfe"):
            algorithm.set_bfe(pg.bfe(Generations(budget)))
        pg.algorithm(algorithm).evolve(start)

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
OURS = "sortie"
# Budgets of ours for the time to within 1 %, besides the one that is compared.
SMALLER = [10_000, 20_000]
# It seeds numpy's one generator, which threads would share; most of its time is its own.
ALONE = {"CMA-ES, restarts (pycma)"}


def alone(spec, folder):
    """A copy of the spec in which its first vehicle is alone; its path and that vehicle's id."""
    document = yaml.safe_load(Path(spec).read_text())
    document["vehicles"] = document["vehicles"][:1]
    copy = folder / Path(spec).name
    copy.write_text(yaml.safe_dump(document, sort_keys=False))
    terrain = document["terrain"]
    if document.get("frame") != "local" and "file" in terrain:
        there = folder / terrain["file"]
        there.parent.mkdir(parents=True, exist_ok=True)
        if not there.exists():
            there.symlink_to((Path(spec).parent / terrain["file"]).resolve())
    return copy, document["vehicles"][0]["id"]


def generate(seed, folder):
    """A generated scenario that no planner was tuned on; difficulties in turn."""
    difficulty = 1 + (seed - 1) % 10
    spec = folder / f"scenario-{seed}-{difficulty}.yaml"
    command = [SORTIE, "study", "scenario", "--seed", str(seed), "--difficulty", str(difficulty)]
    subprocess.run([*command, "-o", spec], check=True, stdout=subprocess.DEVNULL)
    return spec


def children_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_ours(spec, evaluations, seed):
    """The vehicle's cost judged at 2001 samples, and processor time: of the whole of `sortie
    plan`; of a map with `frame: local`, which cannot be flown, of `sortie study planner`."""
    with tempfile.TemporaryDirectory() as folder:
        copy, _ = alone(spec, Path(folder))
        out = Path(folder) / "out"
        document = yaml.safe_load(copy.read_text())
        if document.get("frame") == "local":
            command = ["study", "planner", copy, "--out", out, "--seeds", 1, "--seed", seed]
            command += ["--evaluations", evaluations, "--best-known", out / "none"]
        else:
            document.setdefault("planner", {})["evaluations"] = evaluations
            copy.write_text(yaml.safe_dump(document, sort_keys=False))
            command = ["plan", copy, "--out", out, "--seed", seed, "--json"]
        before = children_s()
        done = subprocess.run([SORTIE, *map(str, command)], capture_output=True, check=False)
        took = children_s() - before
        if document.get("frame") == "local":
            (line,) = (out / "runs.jsonl").read_text().splitlines()
            run = json.loads(line)
            return {"cost": run["vehicles"][0], "clean": run["clean"], "cpu_s": took}
        cost = json.loads(done.stdout)["vehicles"][0]["cost"]
        limits = ["threat", "terrain", "turn", "climb", "collision"]
        clean = all(cost[term] == 0.0 for term in limits)
        return {"cost": cost["total"], "clean": clean, "cpu_s": took}


def run_peers(spec, method, evaluations, seeds):
    """What a method finds from each seed, judged finely, and how its best cost fell with
    processor time, of which each of these runs has the same part."""
    with tempfile.TemporaryDirectory() as folder:
        copy, vehicle = alone(spec, Path(folder))
        before = children_s()
        objective = Objective(copy, vehicle)
        shared = InStep(objective, len(seeds))
        budgets = [Budget(shared, evaluations) for _ in seeds]

        def run(budget, seed):
            try:
                METHODS[method](budget, seed)
            except Spent:
                pass
            finally:
                shared.leave()

        started = time.process_time()
        with ThreadPoolExecutor(len(seeds)) as threads:
            list(threads.map(run, budgets, seeds))
        own = time.process_time() - started
        objective.close()
        took = own + children_s() - before
        judge = Objective(copy, vehicle, samples=2001)
        places = [[place for _, _, place in one.improvements] + [one.place] for one in budgets]
        judged = [judge(np.array(of_one)) for of_one in places]
        judge.close()
    # The other process spends its time as evenly as the evaluations come.
    share = took / max(own, 1e-9) / len(seeds)
    found = []
    for budget, costs in zip(budgets, judged):
        trace = [
            [round((at - started) * share, 4), round(float(cost), 6)]
            for (at, _, _), cost in zip(budget.improvements, costs)
        ]
        found.append({"cost": float(costs[-1]), "cpu_s": took / len(seeds), "trace": trace})
    return found


def make_runs(job):
    spec, method, evaluations, seeds = job
    if method == OURS:
        return job, [run_ours(spec, evaluations, seed) for seed in seeds]
    try:
        return job, run_peers(spec, method, evaluations, seeds)
    except ImportError as error:
        print(f"\n{method}: {error}", file=sys.stderr)
        return job, []


def keep_to_one_core(workers):
    """Threads that take turns lose most of their time where each wakes the next on another."""
    if hasattr(os, "sched_setaffinity"):
        with workers.get_lock():
            number = workers.value
            workers.value += 1
        cores = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {cores[number % len(cores)]})


class Records:
    """Runs by scenario, method, evaluations and seed, as lines of a file."""

    def __init__(self, path):
        self.path, self.runs = Path(path), {}
        if self.path.exists():
            for line in self.path.read_text().splitlines():
                entry = json.loads(line)
                self.runs[tuple(entry["job"])] = entry["found"]
        self.path.parent.mkdir(parents=True, exist_ok=True)

    @staticmethod
    def key(job):
        spec, method, evaluations, seed = job
        return Path(spec).stem, method, evaluations, seed

    def make(self, jobs, seeds, workers):
        """Makes the runs that are missing; seeds outermost, so that a part is balanced."""
        wanted = []
        for first in range(0, len(seeds), GROUP):
            for job in jobs:
                some = seeds[first : first + GROUP]
                missing = [seed for seed in some if self.key((*job, seed)) not in self.runs]
                size = 1 if job[1] in ALONE else GROUP
                wanted += [(*job, missing[i : i + size]) for i in range(0, len(missing), size)]
        pinned = (multiprocessing.Value("i", 0),)
        pool = ProcessPoolExecutor(workers, initializer=keep_to_one_core, initargs=pinned)
        with pool, self.path.open("a") as out:
            for count, (job, found) in enumerate(pool.map(make_runs, wanted), 1):
                for seed, run in zip(job[3], found):
                    key = self.key((*job[:3], seed))
                    self.runs[key] = run
                    out.write(json.dumps({"job": key, "found": run}) + "\n")
                out.flush()
                print(f"\r{count} of {len(wanted)}", end="", file=sys.stderr, flush=True)

    def of(self, scenario, method, evaluations, seeds):
        keys = ((scenario, method, evaluations, seed) for seed in seeds)
        return [self.runs[key] for key in keys if key in self.runs]


def time_to(records, scenario, method, evaluations, seeds, goal):
    """Expected processor time to within the goal: all that was spent until runs reached it or
    ended, over how many did; of ours that of the best budget. None where no run ever does."""
    budgets = {*SMALLER, evaluations} if method == OURS else {evaluations}
    expected = []
    for budget in budgets:
        runs = records.of(scenario, method, budget, seeds)
        times = [reached_s(run, goal) for run in runs]
        reached = sum(time is not None for time in times)
        spent = sum(run["cpu_s"] if time is None else time for run, time in zip(runs, times))
        if reached:
            expected.append(spent / reached)
    return min(expected, default=None)


def reached_s(run, goal):
    """Processor time when a run was within the goal, if it ever was: ours are known at their
    end, and count if they keep every limit."""
    if "trace" not in run:
        return run["cpu_s"] if run["clean"] and run["cost"] <= goal else None
    return next((at for at, cost in run["trace"] if cost <= goal), None)


def table(records, scenarios, best_known, evaluations, seeds):
    """Markdown: one row a scenario and method, costs above the best known."""
    print("| scenario | method | runs | best known | median above | worst above | processor s | to within 1 %, s |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    for scenario in filter(best_known.get, scenarios):
        known = best_known[scenario]
        for method in [OURS, *METHODS]:
            runs = records.of(scenario, method, evaluations, seeds)
            if not runs:
                print(f"| {scenario} | {method} | 0 | | | | | not run |")
                continue
            median, worst = above(runs, known)
            reached = time_to(records, scenario, method, evaluations, seeds, 1.01 * known)
            print(
                f"| {scenario} | {method} | {len(runs)} | {known:.3f} | {median:.2f} % "
                f"| {worst:.2f} % | {statistics.median(run['cpu_s'] for run in runs):.2f} "
                f"| {'never' if reached is None else f'{reached:.2f}'} |"
            )


def above(runs, known):
    """Median and worst above the best known cost, percent."""
    over = [100.0 * (run["cost"] / known - 1.0) for run in runs]
    return statistics.median(over), max(over)


def brief(records, scenarios, best_known, evaluations, seeds):
    """Markdown: one row a scenario, ours against the best of the others in each respect."""
    print("| scenario | runs | best known | ours: median | worst | to 1 %, s | others: least median | least worst | first to 1 %, s |")
    print("|---|---:|---:|---:|---:|---:|---|---|---|")
    for scenario in filter(best_known.get, scenarios):
        known = best_known[scenario]
        found = {m: records.of(scenario, m, evaluations, seeds) for m in [OURS, *METHODS]}
        figures = {m: above(runs, known) for m, runs in found.items() if runs}
        goal = 1.01 * known
        times = {m: time_to(records, scenario, m, evaluations, seeds, goal) for m in figures}
        others = [m for m in figures if m != OURS]
        if OURS not in figures or not others:
            continue
        median = min(others, key=lambda m: figures[m][0])
        worst = min(others, key=lambda m: figures[m][1])
        first = min((m for m in others if times[m] is not None), key=times.get, default=None)
        seconds = "never" if times[OURS] is None else f"{times[OURS]:.2f}"
        print(
            f"| {scenario} | {len(found[OURS])}, {min(len(found[m]) for m in others)} | {known:.3f} "
            f"| {figures[OURS][0]:.2f} % | {figures[OURS][1]:.2f} % | {seconds} "
            f"| {figures[median][0]:.2f} % {median} | {figures[worst][1]:.2f} % {worst} "
            f"| {'never' if first is None else f'{times[first]:.2f} {first}'} |"
        )


def lowest(records, scenarios, kept):
    """The least cost of each scenario's first vehicle in any run, or what was kept."""
    found = dict(kept)
    for (scenario, *_), run in records.runs.items():
        if not run.get("clean", True):
            continue
        found[scenario] = min(found.get(scenario, np.inf), run["cost"])
    return {scenario: found[scenario] for scenario in scenarios if scenario in found}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("specs", nargs="*")
    parser.add_argument("--generated", metavar="FROM-TO", help="seeds of generated scenarios besides")
    parser.add_argument("--evaluations", type=int, default=40_000)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--methods", nargs="*", help="only these", choices=[OURS, *METHODS])
    parser.add_argument("--records", default=ROOT / "target/optimizers/runs.jsonl")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--as-is", action="store_true", help="no further runs, the table alone")
    parser.add_argument("--brief", action="store_true", help="one row a scenario")
    arguments = parser.parse_args()
    seeds = list(range(1, arguments.seeds + 1))
    methods = arguments.methods or [OURS, *METHODS]
    records = Records(arguments.records)
    with tempfile.TemporaryDirectory() as folder:
        specs = [Path(spec).resolve() for spec in arguments.specs]
        if arguments.generated:
            first, last = map(int, arguments.generated.split("-"))
            specs += [generate(seed, Path(folder)) for seed in range(first, last + 1)]
        jobs = list(itertools.product(specs, methods, [arguments.evaluations]))
        if OURS in methods:
            jobs += itertools.product(specs, [OURS], SMALLER)
        if not arguments.as_is:
            records.make(jobs, seeds, arguments.jobs)
    scenarios = [spec.stem for spec in specs]
    print(f"{arguments.evaluations} evaluations, {arguments.seeds} seeds, judged at 2001 samples.\n")
    show = brief if arguments.brief else table
    show(records, scenarios, lowest(records, scenarios, {}), arguments.evaluations, seeds)


if __name__ == "__main__":
    sys.exit(main())
