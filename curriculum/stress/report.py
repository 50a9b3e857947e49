"""results.json, report.md and the figures, from the results of the jobs.

Everything but `machine` depends on the jobs alone: one process, many or a cluster give the same.
"""

import json
import platform
from collections import Counter
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from curriculum import measured
from curriculum.common.files import write_whole
from curriculum.stress import extremes, figures, invariants, jobs, maps

BAD = (jobs.VIOLATION, jobs.DIED)
OUTCOME_ORDER = maps.SETTLES + maps.RESTLESS + maps.GAINS + maps.EXPLODES
DEPTH_BOUNDS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)  # r
ERROR_BOUNDS = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # r
ENERGY_BOUNDS = (1e-9, 1e-3, 1e-2, 0.1, 1.0, 10.0)  # of the start energy
EXACT_BOUNDS = (1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10)  # r


def summary(results):
    """Counts over all jobs."""
    statuses = Counter(row["status"] for _, result in results for row in result["rows"])
    return {
        "jobs": len(results),
        "cells": sum(result["cells"] for _, result in results),
        "judgements": sum(statuses.values()) + sum(applied(results).values()),
        "limits": statuses[jobs.LIMIT] + sum(limits(results).values()),
        "violations": statuses[jobs.VIOLATION],
        "died": statuses[jobs.DIED],
    }


def merged(results):
    """The invariants' data of all batches as one: {check: {applied, limits, worst, words, scene}}."""
    total = {}
    for job, result in results:
        if job["kind"] != "scenes":
            continue
        for name, entry in result.get("data", {}).items():
            mine = total.setdefault(
                name, {"applied": 0, "limits": 0, "worst": 0.0, "words": "", "scene": None}
            )
            mine["applied"] += entry["applied"]
            mine["limits"] += entry["limits"]
            if entry["worst"] > mine["worst"]:
                mine.update({key: entry[key] for key in ("worst", "words", "scene")})
    return total


def applied(results):
    return {name: entry["applied"] for name, entry in merged(results).items()}


def limits(results):
    return {name: entry["limits"] for name, entry in merged(results).items()}


def failed(results):
    """[(job, row)] of every row that makes the exit status 1."""
    return [(job, row) for job, result in results for row in result["rows"] if row["status"] in BAD]


def case_files(results, folder):
    """Write a case file for every failed row; {id(row): the command that runs it again}."""
    commands = {}
    for number, (job, row) in enumerate(failed(results)):
        case = row.get("case", job)
        path = Path(folder) / f"case-{number:03d}.json"
        write_whole(str(path), json.dumps(case, indent=1) + "\n")
        commands[id(row)] = f"python -m curriculum.stress --case {shown(path)}"
    return commands


def shown(path):
    """The path as a reader at the project's root would type it."""
    try:
        return str(Path(path).resolve().relative_to(measured.ROOT))
    except ValueError:
        return str(path)


def machine(command):
    """Where, with what and how it was run."""
    packages = {}
    for package in ("numpy", "distributed"):
        try:
            packages[package] = version(package)
        except PackageNotFoundError:
            packages[package] = None
    place = measured.provenance()
    return {
        "command": command,
        "date": date.today().isoformat(),
        "python": platform.python_version(),
        "packages": packages,
        **{
            key: place[key]
            for key in ("processor", "cores", "system", "architecture", "commit", "changed")
        },
    }


def footer(place):
    versions = ", ".join(f"{name} {number}" for name, number in place["packages"].items() if number)
    commit = f"commit {place['commit']}" if place["commit"] else "no commit known"
    changed = " with uncommitted changes" if place["changed"] else ""
    return (
        f"{place['date']}, {commit}{changed}, {place['cores']} cores of {place['processor']} ({place['system']}, "
        f"{place['architecture']}), Python {place['python']}, {versions}."
    )


def write(results, folder, command, cases):
    """Write results.json, report.md and the figures into `folder`; case files into `cases`."""
    place, folder = machine(command), Path(folder)
    commands = case_files(results, cases)
    pictures = draw(results, footer(place))
    for name, svg in pictures.items():
        write_whole(str(folder / name), svg)
    write_whole(str(folder / "results.json"), results_json(results, place))
    write_whole(str(folder / "report.md"), page(results, place, commands, pictures))


def results_json(results, place):
    """Strict JSON: machine, counts, facts that texts may quote, then one line a job."""

    def line(value):
        return json.dumps(shortened(value), sort_keys=True, allow_nan=False)

    head = {"machine": place, "counts": summary(results), "facts": facts(results)}
    lines = ",\n".join(line({**job, "result": result}) for job, result in results)
    return (
        "{\n"
        + "".join(f"{json.dumps(key)}: {line(value)},\n" for key, value in head.items())
        + f'"jobs": [\n{lines}\n]\n}}\n'
    )


def facts(results):
    """Headline numbers {name: value}, for quoting; those of maps that were not run are left out."""
    out = {}
    penalty, lcp, exact = (kind(results, f"{model}-map") for model in ("penalty", "lcp", "exact"))
    if penalty:
        out["penalty_boundary_worst_error"] = max(
            abs(result["measured"] / result["theory"] - 1.0)
            if isinstance(result["measured"], float)
            else 1.0
            for _, result in penalty
        )
        out["penalty_map_cells"] = sum(params["dt"][2] for params, _ in penalty)
    for name in ("depth", "height_error", "contact_energy", "energy_excess") if lcp else ():
        value, dt, params = most(lcp, name)
        out[f"lcp_{name}"] = {
            "value": value,
            "dt": dt,
            "baumgarte": params["baumgarte"],
            "restitution": params["restitution"],
        }
    for name in ("height_error", "depth", "energy_excess") if exact else ():
        out[f"exact_{name}"] = most(exact, name)[0]
    for name, entry in merged(results).items():
        out[name] = {"scenes": entry["applied"], "limits": entry["limits"], "worst": entry["worst"]}
    return out


def most(rows, name):
    """(largest value, dt, params) of a column over all rows of a map."""
    return max(
        (
            (value, steps_of(params)[k], params)
            for params, result in rows
            for k, value in enumerate(result[name])
            if isinstance(value, float)
        ),
        key=lambda found: found[0],
    )


def shortened(value):
    """Floats to six digits, but in params, which must name the job exactly."""
    if isinstance(value, dict):
        return {
            key: item if key in ("params", "case") else shortened(item)
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [shortened(item) for item in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


# --- page -------------------------------------------------------------------------------------


def page(results, place, commands, pictures):
    """report.md."""
    parts = [
        "# Stress report: where each contact model breaks, and proof that nothing else does",
        "",
        f"Generated by `{place['command']}`; do not edit. {footer(place)}",
        "",
        *headline(results),
        "",
    ]
    parts += [
        *violation_section(results, commands),
        *map_sections(results, pictures),
        *extreme_section(results),
        *invariant_section(results),
        *plain_table(
            results,
            "seeds",
            "## Ordering over the seeds",
            "Penalty deeper than lcp, lcp no less deep than exact, on the way and at rest, nothing explodes.",
        ),
        *plain_table(
            results,
            "bytes",
            "## Same bytes",
            "`--smoke` of each scene in a process of its own; stdout and metrics.json compared byte for byte with hash seed 0 and one thread.",
        ),
    ]
    return "\n".join(parts) + "\n"


def headline(results):
    count = summary(results)
    verdict = (
        "No violation."
        if not count["violations"] + count["died"]
        else f"**{count['violations']} violations, {count['died']} jobs died.**"
    )
    return [
        f"{count['cells']:,} cells run in {count['jobs']:,} jobs, {count['judgements']:,} judgements: {verdict} "
        f"{count['limits']:,} are limits: known, bounded, each with its number below."
    ]


def table(header, rows):
    """Markdown lines of a table."""

    def cell(value):
        return str(value).replace("|", "\\|").replace("\n", " ")

    return [
        "| " + " | ".join(header) + " |",
        "| " + " | ".join("---" for _ in header) + " |",
        *("| " + " | ".join(map(cell, row)) + " |" for row in rows),
        "",
    ]


def violation_section(results, commands):
    rows = [
        (job["name"], row["at"], row["expected"], row["got"], f"`{commands[id(row)]}`")
        for job, row in failed(results)
    ]
    if not rows:
        return []
    left = [f"and {len(rows) - 50} more, in results.json", ""] if len(rows) > 50 else []
    return [
        "## Violations",
        "",
        *table(("job", "where", "expected", "got", "run it again"), rows[:50]),
        *left,
    ]


def kind(results, name):
    return [
        (job["params"], result)
        for job, result in results
        if job["kind"] == name
        and "data" not in result
        and any(row["status"] != jobs.DIED for row in result["rows"])
    ]


def map_sections(results, pictures):
    """The three maps: what the figures show, in sentences made from the data."""
    out = ["## Stability maps", "", "One ball dropped 1 m (scene drop, seed 0)."]
    penalty, lcp, exact = (kind(results, f"{model}-map") for model in ("penalty", "lcp", "exact"))
    if penalty:
        out += [
            "",
            "### penalty: time step, stiffness, damping",
            "",
            "![Outcome of the drop](penalty-map.svg)",
            "",
            "The line is `critical_dt`: k dt² + 2 c dt = 4 m. A ball **kept in contact** (started half a percent off its rest "
            "depth, so that no clamp acts) loses its place at the circles, found by bisection. The **drop** itself only obeys "
            "that line once it has stopped bouncing; the table says what it does on both sides of it.",
            "",
            *penalty_table(penalty),
            *penalty_reading(penalty),
        ]
    if lcp:
        out += [
            "### lcp: time step, Baumgarte gain, restitution",
            "",
            "![How deep](lcp-depth.svg)",
            "",
            "![Height error](lcp-error.svg)",
            "",
            "![Energy put in by contact](lcp-energy.svg)",
            "",
            *lcp_reading(lcp),
        ]
    if exact:
        worst = {name: most(exact, name)[0] for name in ("height_error", "depth", "energy_excess")}
        cells = sum(result["cells"] for _, result in exact)
        out += [
            "### exact: time step, restitution",
            "",
            "![Height error of exact](exact-error.svg)",
            "",
            f"Over {cells} cells the height is off by at most {worst['height_error']:.1e} r from the closed form, the ball is at most "
            f"{worst['depth']:.1e} r deep, and energy rises by at most {worst['energy_excess']:.1e} of the start.",
            "",
        ]
    return out


def steps_of(params):
    """The time steps [s] of a row of a map."""
    return maps.log_grid(*params["dt"])


def penalty_table(rows):
    lines = []
    for c in sorted({params["damping"] for params, _ in rows}):
        mine = [(params, result) for params, result in rows if params["damping"] == c]
        error = max(
            abs(result["measured"] / result["theory"] - 1.0)
            for _, result in mine
            if isinstance(result["measured"], float)
        )
        counts = {True: Counter(), False: Counter()}
        for params, result in mine:
            for dt, outcome in zip(steps_of(params), result["outcomes"]):
                counts[dt < result["theory"]][outcome] += 1

        def shares(counter):
            total = sum(counter.values()) or 1
            return ", ".join(f"{100 * counter[o] / total:.0f} %" for o in OUTCOME_ORDER)

        lines.append(
            (f"{c:g}", f"{100 * error:.2f} %", shares(counts[True]), shares(counts[False]))
        )
    return table(
        (
            "damping [N s/m]",
            "boundary against theory, worst",
            "drop, dt below critical: settles, moves on, gains, explodes",
            "drop, dt above critical",
        ),
        lines,
    )


def penalty_reading(rows):
    """Sentences on where the drop departs from the line."""
    out = []
    for c in sorted({params["damping"] for params, _ in rows}):
        first = {}
        for params, result in rows:
            if params["damping"] != c:
                continue
            for outcome in (maps.GAINS, maps.EXPLODES):
                at = result["outcomes"].find(outcome)
                if at >= 0:
                    first.setdefault(outcome, []).append(steps_of(params)[at] / result["theory"])
        words = [
            f"{what} from {min(first[o]):.2g} times the critical dt on (earliest stiffness; median {sorted(first[o])[len(first[o]) // 2]:.2g})"
            for o, what in ((maps.GAINS, "gains energy"), (maps.EXPLODES, "explodes"))
            if o in first
        ]
        if words:
            out.append(f"- c = {c:g}: the drop {', '.join(words)}.")
    return [*out, ""]


def lcp_reading(rows):
    out = []
    for label, name, unit in (
        ("deepest", "depth", "r"),
        ("worst height error", "height_error", "r"),
        ("most energy put in by contact", "contact_energy", "of the start energy"),
        ("highest energy above the start", "energy_excess", "of the start energy"),
    ):
        value, dt, params = most(rows, name)
        out.append(
            f"- {label}: {value:.3g} {unit}, at dt {dt:.4g} s, beta {params['baumgarte']:g}, e {params['restitution']:g}"
        )
    centre = min(
        (
            dt
            for params, result in rows
            for dt, depth in zip(steps_of(params), result["depth"])
            if depth > 1.0
        ),
        default=None,
    )
    if centre:
        out.append(
            f"- from dt {centre:.4g} s on the ball's centre can get under the table in the landing step; "
            f"impact speed times dt is r at {maps.RADIUS / maps.IMPACT_SPEED:.4g} s"
        )
    pops = [
        value
        for params, result in rows
        if params["restitution"] == 0.0 and params["baumgarte"] == 0.2
        for value in result["height_error"]
    ]
    if pops:
        out.append(
            f"- e = 0 and the default beta = 0.2: height error up to {max(pops):.3g} r, the push that pops the ball off the table "
            "and the landing step's depth"
        )
    return [*out, ""]


def extreme_section(results):
    out = [
        "## Extremes",
        "",
        "Each expectation was written before the run. `limit`: missed, with a weaker statement that holds.",
        "",
    ]
    for job, result in results:
        if job["kind"] != "extreme":
            continue
        out += [
            f"### {job['name'].replace('_', ' ')}",
            "",
            clean(extremes.CASES[job["params"]["name"]].__doc__),
            "",
            *table(
                ("case", "expected", "got", ""),
                [(row["at"], row["expected"], row["got"], row["status"]) for row in result["rows"]],
            ),
        ]
    return out if len(out) > 4 else []


def clean(docstring):
    """A docstring as paragraphs of Markdown."""
    lines = [line.strip() for line in docstring.strip().splitlines()]
    return "\n".join(lines).replace("|", "\\|").replace("*", "\\*")


def invariant_section(results):
    data = merged(results)
    if not data:
        return []
    scenes = sum(result["cells"] for job, result in results if job["kind"] == "scenes")
    bad = Counter(row["at"].split(",")[0] for _, row in failed(results))
    rows = [
        (
            name.replace("_", " "),
            invariants.CHECKS[name].__doc__.splitlines()[0],
            f"{entry['applied']:,}",
            f"{entry['limits']:,}"
            + (f" (worst, scene {entry['scene']}: {entry['words']})" if entry["limits"] else ""),
            bad[name],
        )
        for name, entry in data.items()
    ]
    return [
        "## Invariants over random scenes",
        "",
        f"{scenes:,} scenes of 1 to 30 balls, numbered 0 to {scenes - 1}: scattered, touching, in towers, overlapping; equal and unequal "
        "masses and radii; all knobs. `python -m curriculum.stress --case scene:NUMBER` runs one again.",
        "",
        *table(("invariant", "statement", "scenes", "limits", "violations"), rows),
    ]


def plain_table(results, of_kind, title, words):
    rows = [
        (row["at"], row["expected"], row["got"], row["status"])
        for job, result in results
        if job["kind"] == of_kind
        for row in result["rows"]
    ]
    return [title, "", words, "", *table(("cell", "expected", "got", ""), rows)] if rows else []


# --- figures ----------------------------------------------------------------------------------


def draw(results, note):
    """{file name: SVG text} of the maps that were run."""
    out = {}
    penalty, lcp, exact = (kind(results, f"{model}-map") for model in ("penalty", "lcp", "exact"))
    if penalty:
        out["penalty-map.svg"] = penalty_figure(penalty, note)
    if lcp:
        for name, *look in LCP_FIGURES:
            out[name] = lcp_figure(lcp, *look, note)
    if exact:
        out["exact-error.svg"] = exact_figure(exact, note)
    return out


def penalty_figure(rows, note):
    dts, stiffness = steps_of(rows[0][0]), sorted({params["stiffness"] for params, _ in rows})
    found = {(params["damping"], params["stiffness"]): result for params, result in rows}
    panels = []
    for c in sorted({damping for damping, _ in found}):
        cells = [
            [OUTCOME_ORDER.index(o) for o in found[c, k]["outcomes"]]
            if (c, k) in found
            else [None] * len(dts)
            for k in stiffness
        ]
        fine = maps.log_grid(stiffness[0] / 2, stiffness[-1] * 2, 200)
        lines = [
            figures.Line([(maps.critical_dt(k, c), k) for k in fine], "theory"),
            figures.Line(
                [
                    (found[c, k]["measured"], k)
                    for k in stiffness[2 :: max(1, len(stiffness) // 12)]
                    if (c, k) in found and isinstance(found[c, k]["measured"], float)
                ],
                "measured",
            ),
        ]
        if c:
            lines.insert(
                1,
                figures.Line([(2.0 / c, stiffness[0] / 2), (2.0 / c, stiffness[-1] * 2)], "other"),
            )
        panels.append(figures.Panel(f"damping c = {c:g} N s/m", cells, lines))
    return figures.heat_map(
        "penalty: what a ball dropped 1 m does",
        "Left of the line a ball that stays in contact is stable. Stiffening moves the line left; so does damping. The speckle is luck: where in a step the table is met.",
        panels,
        figures.Axis("time step dt [s]", dts),
        figures.Axis("stiffness k [N/m]", stiffness),
        [maps.OUTCOMES[o] for o in OUTCOME_ORDER],
        figures.CLASSES,
        {
            "theory": "theory: k dt² + 2 c dt = 4 m",
            "other": "c dt = 2 m",
            "measured": "measured, ball kept in contact",
        },
        note,
    )


LCP_FIGURES = (
    (
        "lcp-depth.svg",
        "depth",
        DEPTH_BOUNDS,
        "lcp: how deep the ball gets",
        "Deepest penetration over 4 s, worst of {heights} start heights. The landing step decides it: up to impact speed times dt.",
        {
            "theory": "impact speed times dt = r",
            "measured": "first dt of the grid that gets deeper than r",
        },
    ),
    (
        "lcp-error.svg",
        "height_error",
        ERROR_BOUNDS,
        "lcp: how wrong the height gets",
        "Worst distance from the closed form over 4 s and {heights} start heights. With e = 0 it grows with beta: the push pops the ball.",
        {"theory": "e = 0: the highest pop, beta² times the drop height, is r"},
    ),
    (
        "lcp-energy.svg",
        "contact_energy",
        ENERGY_BOUNDS,
        "lcp: energy that contact puts into the ball",
        "Sum over 4 s as a share of the start energy, beyond what the restitution allows; worst of {heights} start heights.",
        {"theory": "beta = e: above it the push can be faster than the bounce"},
    ),
)
UNITS = {"depth": " r", "height_error": " r", "contact_energy": ""}


def lcp_figure(rows, column, bounds, title, words, line_names, note):
    dts, gains = steps_of(rows[0][0]), sorted({params["baumgarte"] for params, _ in rows})
    found = {(params["restitution"], params["baumgarte"]): result for params, result in rows}
    panels = []
    for e in sorted({restitution for restitution, _ in found}):
        cells = [
            [figures.levels(value, bounds) for value in found[e, b][column]]
            if (e, b) in found
            else [None] * len(dts)
            for b in gains
        ]
        panels.append(
            figures.Panel(f"restitution e = {e:g}", cells, lcp_lines(column, e, dts, gains, found))
        )
    return figures.heat_map(
        title,
        words.format(heights=rows[0][0]["heights"]),
        panels,
        figures.Axis("time step dt [s]", dts),
        figures.Axis("Baumgarte gain beta", gains, log=False),
        interval_words(bounds, UNITS[column]),
        figures.RAMP,
        line_names,
        note,
    )


def lcp_lines(column, e, dts, gains, found):
    """The boundary over one panel of an lcp figure; its closed form is what the legend says."""
    across = dts[0] / 2, dts[-1] * 2
    if column == "depth":
        at = maps.RADIUS / maps.IMPACT_SPEED
        crossing = [
            (next((dt for dt, value in zip(dts, found[e, b][column]) if value > 1.0), None), b)
            for b in gains[:: max(1, len(gains) // 8)]
            if (e, b) in found
        ]
        return [
            figures.Line([(at, -1.0), (at, 2.0)], "theory"),
            figures.Line([p for p in crossing if p[0]], "measured"),
        ]
    if column == "contact_energy":
        return [figures.Line([(dt, e) for dt in across], "theory")]
    pop = (maps.RADIUS / maps.GAP) ** 0.5
    return [figures.Line([(dt, pop) for dt in across], "theory")] if e == 0.0 else []


def interval_words(bounds, unit):
    return [
        f"< {bounds[0]:g}{unit}",
        *(f"{a:g} to {b:g}" for a, b in zip(bounds, bounds[1:])),
        f"> {bounds[-1]:g}{unit}",
    ]


def exact_figure(rows, note):
    dts, gains = steps_of(rows[0][0]), sorted({params["restitution"] for params, _ in rows})
    found = {params["restitution"]: result for params, result in rows}
    panels = [
        figures.Panel(
            title,
            [[figures.levels(value, EXACT_BOUNDS) for value in found[e][column]] for e in gains],
        )
        for title, column in (("height error", "height_error"), ("deepest penetration", "depth"))
    ]
    return figures.heat_map(
        "exact: no step error",
        "Worst distance from the closed form, and deepest penetration, over 4 s.",
        panels,
        figures.Axis("time step dt [s]", dts),
        figures.Axis(
            "restitution e", list(range(len(gains))), False, tuple(f"{e:g}" for e in gains)
        ),
        interval_words(EXACT_BOUNDS, " r"),
        figures.RAMP,
        None,
        note,
    )
