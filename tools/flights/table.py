"""The table of a campaign."""

import numpy as np

FIGURES = {
    "across_m": "cross-track, m", "below_m": "below, m", "above_m": "above, m", "start_late_s": "late at start, s",
    "late_s": "late, s", "late_growth_s": "later since start, s", "corner_closest_m": "waypoint passed at, m",
    "corner_slower_mps": "slower at corners, m/s", "drift_up_m": "drift in takeoff, m",
    "drift_down_m": "drift in landing, m", "touchdown_m": "touchdown off, m",
}
WINDS = ((0, 0), (1, 4), (5, 8))


def line(result):
    """One flight on a line."""
    what = result.get("not_flown") or f"{result['verdict']}, {len(result['escapes'])} escapes"
    worst = "".join(f"; {e['what']} {e['value']} (limit {e['limit']}) at item {e['row']}" for e in result.get("escapes", []))
    failed = "".join(f"; {text}" for text in result.get("failed", []) + result.get("alarms", []))
    seconds = f"{result.get('flown_s', 0):.0f} s in {result.get('took_s', 0):.0f} s"
    return f"{result['kind']} {result['seed']}: wind {result['wind_mps']} m/s, {seconds}: {what}{worst}{failed}"


def groups(results):
    """Flights by kind, version and wind, in a fixed order."""
    kinds = sorted({(r["kind"], r["version"]) for r in results if "version" in r})
    for kind, version in kinds:
        for least, most in WINDS:
            chosen = [r for r in results if (r["kind"], r.get("version")) == (kind, version)
                      and least <= r["wind_mps"] <= most]
            if chosen:
                yield kind, version, (least, most), chosen


def spread(chosen, name):
    """50, 95, 99 % and the greatest of a figure; None without one."""
    values = np.array([v for r in chosen for v in r["figures"].get(name, [])])
    if not len(values):
        return None
    of = [float(np.percentile(values, share)) for share in (50, 95, 99)] + [float(values.max())]
    return [round(v, 2) for v in of]


def halves(chosen):
    """Flights and flights with escapes: for fitting (even seeds), for the report (odd ones)."""
    found = []
    for odd in (0, 1):
        half = [r for r in chosen if r["seed"] % 2 == odd]
        found.append((len(half), sum(bool(r["escapes"]) for r in half)))
    return found


def at_most(flights, escaped):
    """The share of flights that escapes at most, with 95 % confidence (Clopper and Pearson)."""
    if not flights or escaped >= flights:
        return 1.0
    low, high = escaped / flights, 1.0
    for _ in range(60):
        p = (low + high) / 2
        tail, term = 0.0, (1 - p) ** flights
        for k in range(escaped + 1):
            tail += term
            term *= (flights - k) / (k + 1) * p / (1 - p)
        low, high = (p, high) if tail > 0.05 else (low, p)
    return high


def document(results):
    """Everything of the table for other programs."""
    rows = []
    for kind, version, (least, most), chosen in groups(results):
        (fit, fit_escaped), (report, escaped) = halves(chosen)
        rows.append({
            "kind": kind, "version": version, "wind_mps": [least, most], "flights": len(chosen),
            "minutes": round(sum(r["flown_s"] for r in chosen) / 60, 1),
            "fitted": {"flights": fit, "escaped": fit_escaped},
            "reported": {"flights": report, "escaped": escaped, "at_most_share": round(at_most(report, escaped), 3)},
            "failed": sum(r["verdict"] != "pass" for r in chosen),
            "figures": {name: of for name in FIGURES if (of := spread(chosen, name))},
            "fitted_figures": {name: of for name in FIGURES
                               if (of := spread([r for r in chosen if r["seed"] % 2 == 0], name))},
        })
    not_flown = [line(r) for r in results if "not_flown" in r]
    return {"rows": rows, "not_flown": not_flown}


def text(results):
    """As Markdown: 50 / 95 / 99 % of each figure."""
    made = document(results)
    lines = ["| kind | version | wind, m/s | flights | minutes | escapes fit, report | at most | " + " | ".join(FIGURES.values()) + " |",
             "|---|---|--:|--:|--:|--:|--:|" + "--:|" * len(FIGURES)]
    for row in made["rows"]:
        (least, most), fitted, reported = row["wind_mps"], row["fitted"], row["reported"]
        wind = f"{least}" if least == most else f"{least} to {most}"
        figures = [" / ".join(f"{v:.1f}" for v in row["figures"][name][:3]) if name in row["figures"] else ""
                   for name in FIGURES]
        lines.append(
            f"| {row['kind']} | {row['version']} | {wind} | {row['flights']} | {row['minutes']:.0f} "
            f"| {fitted['escaped']} of {fitted['flights']}, {reported['escaped']} of {reported['flights']} "
            f"| {100 * reported['at_most_share']:.1f} % | " + " | ".join(figures) + " |")
    return "\n".join(lines + [""] + [f"not flown: {of}" for of in made["not_flown"]])
