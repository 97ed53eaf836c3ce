"""Judges mission files of public repositories, and compares with tests/public_missions/outcomes.txt.

    python tools/public_missions.py CLONES [--sortie target/debug/sortie] [--write]

CLONES holds a clone of each repository as OWNER+NAME (work tree or bare, also one level below).
The files are not part of this repository: each line of the table names repository, commit and path.

    REPOSITORY | COMMIT | PATH | FLAGS | OUTCOME | REASON

OUTCOME is `pass` or `fail` (both judged to the end of what is flown), `unknown` (judged up to an item
whose motion is not known), or `refused` (not read). REASON is the first failure. Files without a mission
(fences, rally points) have `list`. --write makes the table anew from all mission files in CLONES.
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


def git(folder, *arguments):
    return subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True).stdout


def repositories(clones):
    for clone in sorted(clones.iterdir()):
        for folder in (clone, clone / "repo", clone / "repo" / ".git"):
            head = git(folder, "rev-parse", "HEAD").decode().strip() if folder.is_dir() else ""
            if head and git(folder, "rev-parse", "--show-cdup").strip() in (b"", b"."):
                yield clone.name.replace("+", "/", 1), folder, head
                break


def is_mission(path, content):
    if path.lower().endswith(".plan"):
        return b'"mission"' in content and b'"fileType"' in content
    return content.lstrip(b"\xef\xbb\xbf").startswith(b"QGC WPL")


def mission_files(clones):
    seen = set()
    for name, folder, head in repositories(clones):
        listed = git(folder, "-c", "core.quotepath=off", "ls-tree", "-r", "--name-only", head)
        for path in listed.decode("utf-8", "replace").splitlines():
            if not path.lower().endswith(ENDINGS):
                continue
            content = git(folder, "show", f"{head}:{path}")
            digest = hashlib.sha256(content.replace(b"\r", b"")).digest()
            if is_mission(path, content) and digest not in seen:
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


def judge(sortie, file, content, flags):
    code, failed, errors = review(sortie, file, flags)
    if code == 4 and "say --airframe" in errors:
        kind = "vtol" if any(word in errors for word in ("NAV_VTOL", "DO_VTOL")) else "plane"
        return judge(sortie, file, content, [*flags, "--airframe", kind])
    place = first_place(content)
    if any("home row holds no place" in margin.get("note", "") for margin in failed) and place and "--home" not in flags:
        return judge(sortie, file, content, [*flags, "--home", f"{place[0]:.5f},{place[1]:.5f},0"])
    text = lambda margin: f"{margin['what']}: {margin.get('note', '')}".strip(": ")
    if code == 3:
        return flags, "refused", errors.strip().splitlines()[-1].split(": ", 1)[-1]
    if code not in (0, 4):
        return flags, f"exit {code}", errors.strip().splitlines()[-1]
    if any("the mission is empty" in margin.get("note", "") for margin in failed):
        return flags, "list", "no mission in it"
    unknown = [margin for margin in failed if "cannot judge" in margin.get("note", "")]
    if unknown:
        return flags, "unknown", text(unknown[0])
    return flags, "pass" if code == 0 else "fail", text(failed[0]) if failed else ""


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("clones", type=pathlib.Path)
    arguments.add_argument("--sortie", default="target/debug/sortie")
    arguments.add_argument("--write", action="store_true")
    options = arguments.parse_args()
    known = {}
    if not options.write:
        rows = [line.split(" | ") for line in TABLE.read_text().splitlines() if not line.startswith("#")]
        known = {(row[0], row[2]): row for row in rows}
    lines, counts, wrong = [], collections.Counter(), 0
    with tempfile.TemporaryDirectory() as folder:
        for name, commit, path, content in mission_files(options.clones):
            row = known.get((name, path))
            if not options.write and row is None:
                continue
            file = pathlib.Path(folder) / ("m.plan" if path.lower().endswith(".plan") else "m.waypoints")
            file.write_bytes(content)
            flags, outcome, reason = judge(options.sortie, file, content, row[3].split() if row else [])
            reason = reason.replace("|", "/")[:160].strip()
            lines.append(" | ".join([name, commit, path, " ".join(flags), outcome, reason]))
            counts[outcome] += 1
            if row and row[4] != outcome:
                wrong += 1
                print(f"{name} {path}: {outcome} ({reason}), expected {row[4]}")
    if options.write:
        head = [line for line in __doc__.splitlines() if "REPOSITORY |" in line][0].strip()
        TABLE.parent.mkdir(exist_ok=True)
        TABLE.write_text(f"# {head}\n" + "".join(f"{line}\n" for line in lines))
    missions = sum(counts.values()) - counts["list"]
    read = missions - counts["refused"]
    judged = counts["pass"] + counts["fail"]
    print(dict(counts))
    print(f"{missions} missions, {read} read ({100 * read / max(missions, 1):.0f} %), "
          f"{judged} of these judged ({100 * judged / max(read, 1):.0f} %)")
    sys.exit(wrong > 0)


main()
