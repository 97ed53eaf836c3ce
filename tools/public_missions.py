"""Judges mission files of public repositories, and compares with tests/public_missions/outcomes.txt.

    python tools/public_missions.py CLONES [--sortie target/debug/sortie] [--write]

CLONES holds a clone of each repository as OWNER+NAME (work tree or bare, also one level below).
The files are not part of this repository: each line of the table names repository, commit and path.

    REPOSITORY | COMMIT | PATH | FLAGS | OUTCOME | REASON | SOURCE

OUTCOME is `pass` or `fail` (both judged to the end of what is flown), `unknown` (judged up to an item
whose motion is not known), or `refused` (not read). REASON is the first failure. SOURCE is the file and the
function of the autopilot that confirms a failure: of any failure of an `unknown` one. Files without a
mission (fences, rally points) have `list`. --write makes the table anew from all mission files in CLONES,
and keeps the rows of repositories that have no clone there; --count only counts.
"""

import argparse
import collections
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

TABLE = pathlib.Path(__file__).parent.parent / "tests/public_missions/outcomes.txt"
ENDINGS = (".waypoints", ".plan", ".mission", ".txt")
# What a failure says, for which airframes, and where the autopilot does so.
ANY = ("copter", "plane", "vtol")
SOURCES = [
    ("takeoff first: ArduPilot", ("copter",), "ArduCopter/mode_auto.cpp ModeAuto::init"),
    ("takeoff first: ArduPilot", ("plane",), "ArduPlane/servos.cpp Plane::suppress_throttle"),
    ("takeoff first: ArduPilot", ("vtol",), "ArduPlane/mode_auto.cpp ModeAuto::_pre_arm_checks"),
    ("before any takeoff (allowed: command 22, 84", ("copter",), "ArduCopter/mode_auto.cpp ModeAuto::init"),
    ("before any takeoff (allowed: command 22 (", ("plane",), "ArduPlane/servos.cpp Plane::suppress_throttle"),
    ("before any takeoff (allowed: command 84 (", ("vtol",), "ArduPlane/mode_auto.cpp ModeAuto::_pre_arm_checks"),
    ("item 1 on: no takeoff", ("copter",), "ArduCopter/mode_auto.cpp ModeAuto::init"),
    ("home row: command", ANY, "AP_Mission/AP_Mission.cpp AP_Mission::write_home_to_storage"),
    (": airspeed: ", ("plane", "vtol"), "ArduPlane/commands_logic.cpp Plane::do_change_speed"),
    ("the vehicle repeats the mission", ANY, "AP_Mission/AP_Mission.cpp AP_Mission::get_next_cmd"),
    ("the vehicle stays at item", ("copter",), "ArduCopter/mode_auto.cpp ModeAuto::verify_loiter_unlimited"),
    ("the vehicle stays at item", ("plane", "vtol"), "ArduPlane/commands_logic.cpp Plane::verify_loiter_unlim"),
    ("DO_PARACHUTE releases", ("copter",), "ArduCopter/mode_auto.cpp ModeAuto::do_parachute"),
    ("DO_PARACHUTE releases", ("plane", "vtol"), "ArduPlane/parachute.cpp Plane::do_parachute"),
    ("known command: command", ANY, "AP_Mission/AP_Mission.cpp AP_Mission::mavlink_int_to_mission_cmd"),
    ("item count:", ANY, "AP_Mission/AP_Mission.cpp AP_Mission::num_commands_max"),
    ("jump target", ANY, "AP_Mission/AP_Mission.cpp AP_Mission::sanity_check_params"),
]


def git(folder, *arguments):
    return subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True).stdout


def repositories(clones):
    for clone in sorted(clones.iterdir()):
        for folder in (clone, clone / "repo", clone / "repo" / ".git"):
            head = git(folder, "rev-parse", "HEAD").decode().strip() if folder.is_dir() else ""
            if head and git(folder, "rev-parse", "--show-cdup").strip() in (b"", b"."):
                yield clone.name.replace("+", "/", 1), folder, head
                break


def is_json(path, content):
    return path.lower().endswith(".plan") or path.lower().endswith(".mission") and content.lstrip()[:1] == b"{"


def is_mission(path, content):
    if is_json(path, content):
        parts = (b'"items"', b'"plannedHomePosition"') if path.lower().endswith(".mission") else (b'"mission"', b'"fileType"')
        return all(part in content for part in parts)
    return content.lstrip(b"\xef\xbb\xbf").startswith(b"QGC WPL")


def mission_files(clones, known=()):
    """Those of the table first: a copy of one in another repository does not take its place."""
    seen = set()
    for in_table in (True, False):
        for name, folder, head in repositories(clones):
            listed = git(folder, "-c", "core.quotepath=off", "ls-tree", "-r", "--name-only", head)
            for path in listed.decode("utf-8", "replace").splitlines():
                if not path.lower().endswith(ENDINGS) or ((name, path) in known) != in_table:
                    continue
                content = git(folder, "show", f"{head}:{path}")
                digest = hashlib.sha256(content.replace(b"\r", b"")).digest()
                if is_mission(path, content) and (in_table or digest not in seen):
                    seen.add(digest)
                    yield name, head, path, content


def review(sortie, file, flags):
    command = [sortie, "review", "--json", "--no-terrain", str(file), *flags]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300)
    margins = json.loads(run.stdout)["margins"] if run.stdout.strip() else []
    return run.returncode, [margin for margin in margins if not margin["ok"]], run.stderr


def first_place(content):
    """Latitude and longitude of the first row that has some, for files whose home row is blank."""
    for line in content.decode("utf-8", "replace").splitlines()[1:]:
        fields = line.split()
        try:
            place = float(fields[8]), float(fields[9])
        except (IndexError, ValueError):
            continue
        if all(abs(value) > 1e-6 for value in place):
            return place
    return None


def holds_vtol(content):
    """Whether a file has a takeoff, landing or transition of a VTOL besides items of all wings."""
    rows = (line.split() for line in content.decode("utf-8", "replace").splitlines())
    return any(len(row) > 3 and row[3] in ("84", "85", "3000") for row in rows)


def judge(sortie, file, content, flags):
    code, failed, errors = review(sortie, file, flags)
    if code == 4 and "say --airframe" in errors:
        kind = "vtol" if any(word in errors for word in ("NAV_VTOL", "DO_VTOL")) or holds_vtol(content) else "plane"
        return judge(sortie, file, content, [*flags, "--airframe", kind])
    place = first_place(content)
    if any("home row holds no place" in margin.get("note", "") for margin in failed) and place and "--home" not in flags:
        return judge(sortie, file, content, [*flags, "--home", f"{place[0]:.5f},{place[1]:.5f},0"])
    text = lambda margin: f"{margin['what']}: {margin.get('note', '')}".strip(": ")
    if code == 3:
        return flags, "refused", errors.strip().splitlines()[-1].split(": ", 1)[-1], ""
    if code not in (0, 4):
        return flags, f"exit {code}", errors.strip().splitlines()[-1], ""
    if any("the mission is empty" in margin.get("note", "") for margin in failed):
        return flags, "list", "no mission in it", ""
    unknown = [margin for margin in failed if "cannot judge" in margin.get("note", "")]
    source = source_of([text(margin) for margin in unknown + failed], flags)
    if unknown:
        return flags, "unknown", text(unknown[0]), source
    return flags, "pass" if code == 0 else "fail", text(failed[0]) if failed else "", source


def source_of(failures, flags):
    """Where the autopilot does what the first failure says that has a source."""
    airframe = flags[flags.index("--airframe") + 1] if "--airframe" in flags else "copter"
    for failure in failures:
        for says, airframes, source in SOURCES:
            if says in failure and airframe in airframes and "PX4" not in failure:
                return source
    return ""


def print_counts(rows):
    counts = collections.Counter(row[4] for row in rows)
    missions = [row for row in rows if row[4] != "list"]
    read = [row for row in missions if row[4] != "refused"]
    judged = [row for row in read if row[4] in ("pass", "fail")]
    confirmed = [row for row in read if row[4] == "unknown" and row[6]]
    share = lambda part, whole: f"{len(part)} ({100 * len(part) / max(len(whole), 1):.0f} %)"
    print(dict(counts))
    print(f"{len(missions)} missions of {len({row[0] for row in missions})} repositories; "
          f"read: {share(read, missions)}; of these judged to the end: {share(judged, read)}; or failed for a "
          f"reason that the autopilot's source confirms: {share(judged + confirmed, read)}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("clones", type=pathlib.Path, nargs="?")
    arguments.add_argument("--sortie", default="target/debug/sortie")
    arguments.add_argument("--write", action="store_true")
    arguments.add_argument("--count", action="store_true")
    options = arguments.parse_args()
    lines = [line for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    rows = [(line.split(" | ") + [""])[:7] for line in lines]
    if options.count:
        return print_counts(rows)
    known = {(row[0], row[2]): row for row in rows}
    found, wrong = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for name, commit, path, content in mission_files(options.clones, known):
            row = known.get((name, path))
            if not options.write and row is None:
                continue
            file = pathlib.Path(folder) / ("m.plan" if is_json(path, content) else "m.waypoints")
            file.write_bytes(content)
            flags = row[3].split() if row and not options.write else []
            flags, outcome, reason, source = judge(options.sortie, file, content, flags)
            reason = reason.replace("|", "/")[:160].strip()
            found.append([name, commit, path, " ".join(flags), outcome, reason, source])
            if row and row[4] != outcome:
                wrong += not options.write
                print(f"{name} {path}: {outcome} ({reason}), was {row[4]}")
    if options.write:
        names = {row[0] for row in found}
        found += [row for row in rows if row[0] not in names]
        found.sort(key=lambda row: (row[0].lower(), row[2]))
        head = [line for line in __doc__.splitlines() if "REPOSITORY |" in line][0].strip()
        TABLE.parent.mkdir(exist_ok=True)
        TABLE.write_text(f"# {head}\n" + "".join(" | ".join(row).strip() + "\n" for row in found))
    print_counts(found)
    sys.exit(wrong > 0)


main()
