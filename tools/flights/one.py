"""One flight: a mission is planned, flown by `sortie fly` on a real simulator, and compared."""

import json
import pathlib
import shutil
import subprocess
import time

from . import missions, simulator
from .tube import Tube, compare

BUFFER_M = {"copter": 10.0, "zigzag": 10.0, "px4-copter": 10.0, "plane": 15.0, "plane-land": 15.0, "plane-turn": 15.0, "quadplane": 15.0,
            "px4-plane": 15.0, "px4-vtol": 15.0}


def run(*command, timeout=900):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=timeout)


def plan(sortie, spec, folder):
    """The folder of the plan and the verified trajectories; a sentence instead of them if there is none."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "spec.yaml").write_text(spec if isinstance(spec, str) else missions.text(spec))
    out = folder / "plan"
    done = run(sortie, "plan", folder / "spec.yaml", "--out", out)
    if done.returncode != 0:
        return None, (done.stderr.strip().splitlines() or ["not planned"])[-1]
    walk = None if isinstance(spec, str) else spec["vehicles"][0].get("zigzag")
    if walk:
        items = out / "v.waypoints"
        head, *rows = items.read_text().splitlines()
        items.write_text("\n".join([head, *missions.zigzag(rows, walk), ""]))
        (out / "v.plan").unlink()
        done = run(sortie, "convert", items, out / "v.plan")
        if done.returncode != 0:
            return None, done.stderr.strip()
    done = run(sortie, "review", out, "--trajectories", folder / "trajectories.json")
    if done.returncode != 0:
        return None, next((text for text in done.stdout.splitlines() if "FAIL" in text), done.stderr.strip())
    return out, json.loads((folder / "trajectories.json").read_text())


def home(out, vehicle):
    """Where a plan has a vehicle stand: latitude, longitude, metres above the sea."""
    fields = (out / f"{vehicle}.waypoints").read_text().splitlines()[1].split("\t")
    return float(fields[8]), float(fields[9]), float(fields[10])


def fly(options, kind, seed, slot):
    """The summary of one flight, kept as a file: a campaign that is started again goes on."""
    folder = pathlib.Path(options.out) / kind / str(seed)
    summary = folder.with_suffix(".json")
    if summary.exists() and not (options.again and (folder / "sim").exists()):
        return json.loads(summary.read_text())
    if summary.exists():
        result = json.loads(summary.read_text())
        result.update(measured(kind, folder))
        summary.write_text(json.dumps(result))
        return result
    shutil.rmtree(folder, ignore_errors=True)
    spec, wind = missions.make(kind, seed)
    result = {"kind": kind, "seed": seed, "wind_mps": wind["speed_mps"], "speed_mps": spec["vehicles"][0]["speed_mps"]}
    out, trajectories = plan(options.sortie, spec, folder)
    if out is None:
        result["not_flown"] = f"not planned: {trajectories}"
    else:
        try:
            result.update(fly_plan(options, (kind, seed, slot), (folder, out), (wind, spec)))
        except (OSError, ValueError, KeyError, subprocess.TimeoutExpired) as error:
            result["not_flown"] = f"{type(error).__name__}: {error}"
    summary.write_text(json.dumps(result))
    if not options.keep:
        shutil.rmtree(folder, ignore_errors=True)
    return result


def fly_plan(options, flight, folders, given):
    (kind, seed, slot), (folder, out), (wind, spec) = flight, folders, given
    heading = missions.nose_deg(kind, seed, spec["vehicles"][0])
    place = (*home(out, "v"), heading)
    child, link = simulator.start(options, kind, folder / "sim", slot, place, wind, options.speedup)
    began = time.monotonic()
    try:
        time.sleep(1)
        done = run(options.sortie, "fly", out / "spec.yaml", "--dir", out, "--link", f"v={link}", "--upload", "--set-params",
                   "--speedup", options.speedup, "--json", timeout=options.timeout)
        # The last of the log.
        time.sleep(1)
    finally:
        simulator.end(child)
    try:
        flight = json.loads(done.stdout)
    except ValueError:
        return {"not_flown": (done.stderr.strip().splitlines() or ["no flight"])[-1]}
    return {
        **measured(kind, folder), "verdict": flight["verdict"],
        "failed": [f"{m['what']} {m['value']} (limit {m['limit']}) {m.get('note') or ''}" for m in flight["margins"] if not m["ok"]],
        "alarms": [f"{a['alarm']}: {a['text']}" for a in flight["alarms"]],
        "took_s": round(time.monotonic() - began, 1),
    }


def measured(kind, folder):
    """The truth of a flight that is over against its verified trajectory."""
    truth = simulator.truth(folder / "sim")
    trajectories = json.loads((folder / "trajectories.json").read_text())
    figures, escapes = compare(Tube(trajectories["vehicles"][0]), truth, BUFFER_M[kind], missions.KINDS[kind][1] == "plane")
    return {
        "version": simulator.version(truth.texts), "flown_s": round(float(truth.t[-1] - truth.t0_s), 1),
        "escapes": escapes, "figures": figures,
    }
