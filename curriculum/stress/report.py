"""results.json, report.md and the figures, from the results of the jobs.

Everything but "measured" depends on the jobs alone: one process, many or a cluster give the same.
The page and the figures are made from the sections of results.json alone.
"""

import json
import math
import sys
from collections import Counter
from pathlib import Path

from curriculum import measured, reporting
from curriculum.common.files import write_whole
from curriculum.reporting import Claim, number, table
from curriculum.stress import extremes, figures, invariants, jobs, maps

BAD = (jobs.VIOLATION, jobs.DIED)
UNFINISHED = "energy_rises_by_unfinished_sweeps_alone"
RISES = "exact_never_gains_energy"


# --- the sections of results.json ---------------------------------------------------------------


def summary(results):
    """Counts over all jobs."""
    statuses = Counter(row["status"] for _, result in results for row in result["rows"])
    checked = sum(sum(result.get("applied", {}).values()) for _, result in results)
    return {
        "jobs": len(results),
        "cells": sum(result["cells"] for _, result in results),
        "judgements": sum(statuses.values()) + checked,
        "limits": statuses[jobs.LIMIT],
        "violations": statuses[jobs.VIOLATION],
        "died": statuses[jobs.DIED],
    }


def of_kind(results, kind):
    """(params, result) of the finished jobs of one kind."""
    return [
        (job["params"], result)
        for job, result in results
        if job["kind"] == kind and not any(row["status"] == jobs.DIED for row in result["rows"])
    ]


def sections(results):
    """{name: section} of everything that was run."""
    made = {"counts": summary(results) | {"limits_by_kind": limits(results)}}
    made["maps"] = {name: section for name, section in map_sections(results).items() if section}
    made["scenes"], made["boards"] = scene_section(results), board_section(results)
    made["extremes"] = {
        job["params"]["name"]: rows_of(result)
        for job, result in results
        if job["kind"] == "extreme"
    }
    for kind in ("seeds", "bytes"):
        made[kind] = {
            "rows": [
                row for job, result in results if job["kind"] == kind for row in rows_of(result)
            ]
        }
    return {name: section for name, section in made.items() if section}


def rows_of(result):
    """Judgements as lists: where, expected, got, status."""
    return [[row[key] for key in ("at", "expected", "got", "status")] for row in result["rows"]]


def limits(results):
    """{name of the limit: how often}; what comes before a colon names it."""
    found = Counter(
        row["limit"].split(":")[0]
        for _, result in results
        for row in result["rows"]
        if row["status"] == jobs.LIMIT
    )
    return dict(sorted(found.items()))


def map_sections(results):
    """The data of every map and curve that was run."""
    penalty, lcp, depth, converges, soft, exact = (
        of_kind(results, kind)
        for kind in (
            "penalty-map",
            "lcp-map",
            "lcp-depth",
            "lcp-converges",
            "soft-map",
            "exact-map",
        )
    )
    return {
        "penalty": penalty and penalty_section(penalty),
        "lcp": lcp
        and {
            "dt": maps.log_grid(*lcp[0][0]["dt"]),
            "baumgarte": sorted({params["baumgarte"] for params, _ in lcp}),
            **{
                name: grid(lcp, name)
                for name in ("height_error", "contact_energy", "energy_excess")
            },
            "most": {
                name: most(lcp, name)
                for name in ("height_error", "contact_energy", "energy_excess")
            },
        },
        "depth": depth
        and {
            "dt": maps.log_grid(*depth[0][0]["dt"]),
            "rows": {
                f"e={p['restitution']:g} beta={p['baumgarte']:g}": r["depth"] for p, r in depth
            },
        },
        "converges": converges
        and {
            "dt": [params["dt"] for params, _ in converges],
            **{
                name: [result[name] for _, result in converges]
                for name in ("height_error", "rest_gap")
            },
        },
        "soft": soft
        and {
            "dt": maps.log_grid(*soft[0][0]["dt"]),
            "timeconst": [params["timeconst"] for params, _ in soft],
            **{name: [result[name] for _, result in soft] for name in ("depth", "energy_excess")},
        },
        "exact": exact
        and {
            name: max(max(result[name]) for _, result in exact)
            for name in ("height_error", "depth", "energy_excess")
        },
    }


def penalty_section(rows):
    """Outcomes and boundaries by damping, rows of rising stiffness."""
    rows = sorted(rows, key=lambda row: (row[0]["damping"], row[0]["stiffness"]))
    by = {
        f"{c:g}": [result for params, result in rows if params["damping"] == c]
        for c in sorted({params["damping"] for params, _ in rows})
    }
    errors = [
        abs(result["measured"] / result["theory"] - 1) if result["measured"] != "nan" else None
        for _, result in rows
    ]
    return {
        "dt": maps.log_grid(*rows[0][0]["dt"]),
        "stiffness": sorted({params["stiffness"] for params, _ in rows}),
        "outcomes": {c: [result["outcomes"] for result in found] for c, found in by.items()},
        "measured": {c: [result["measured"] for result in found] for c, found in by.items()},
        "boundaries": len(errors),
        "boundary_worst_error": None if None in errors else max(errors),
    }


def grid(rows, name):
    """{e: [[value over dt] for each beta]}."""
    found = {}
    for params, result in sorted(
        rows, key=lambda row: (row[0]["restitution"], row[0]["baumgarte"])
    ):
        found.setdefault(f"{params['restitution']:g}", []).append(result[name])
    return found


def most(rows, name):
    """The largest value of a column over a map, and where."""
    value, dt, params = max(
        (
            (value, step, params)
            for params, result in rows
            for value, step in zip(result[name], maps.log_grid(*params["dt"]))
        ),
        key=lambda found: found[0],
    )
    return {
        "value": value,
        "dt": dt,
        "baumgarte": params["baumgarte"],
        "restitution": params["restitution"],
    }


def scene_section(results):
    """What the checks said over the random scenes, and what they counted."""
    made, told = checked(results, "scenes")
    if not made:
        return {}
    applied = made["checks"][UNFINISHED]["scenes"]
    rises = [(what["rise"], number) for number, what in told.get(RISES, [])]
    return made | {
        "unfinished": unfinished_section(told.get(UNFINISHED, []), applied),
        "exact_rise": max(rises, default=None),  # and the scene's number
    }


def board_section(results):
    """What the checks said over the boards, and by how much E rose among pegs."""
    made, told = checked(results, "boards")
    rises = [what["rise"] for _, what in told.get("exact_rises_among_pegs", [])]
    return made and made | {"rise": max(rises, default=0.0)}


def checked(results, kind):
    """(what the checks said over the scenes of a kind, {check: what it counted}); ({}, {}) of none."""
    batches = of_kind(results, kind)
    if not batches:
        return {}, {}
    applied, told = Counter(), {}
    for _, result in batches:
        applied.update(result["applied"])
        for name, items in result["counted"].items():
            told.setdefault(name, []).extend(items)
    bad = Counter(
        row["at"].split(",")[0]
        for _, result in batches
        for row in result["rows"]
        if row["status"] in BAD
    )
    cut = told.get("exact_ends", [])
    return {
        "count": sum(params["stop"] - params["start"] for params, _ in batches),
        "checks": {
            name: {"scenes": applied[name], "violations": bad[name]}
            for name in invariants.CHECKS
            if name in applied
        },
        "exact_cut": len(cut),
        "exact_run": applied["exact_ends"],
        "exact_cut_to": sorted(round(1.0 - what["cut"], 3) for _, what in cut),
    }, told


def unfinished_section(told, applied):
    """Energy that unfinished sweeps add: how many scenes, how much, how many sweeps end it."""
    if not told:
        return {"scenes": applied, "rises": 0}
    worst, above = (max(told, key=lambda item: item[1][key]) for key in ("rise", "above_start"))
    sweeps = sorted(what["sweeps"] for _, what in told)
    return {
        "scenes": applied,
        "rises": len(told),
        "notable": sum(what["rise"] > invariants.NOTABLE for _, what in told),
        "above_start": sum(what["above_start"] > invariants.NOTABLE for _, what in told),
        "worst_rise": worst[1]["rise"],
        "worst_rise_scene": worst[0],
        "worst_above_start": above[1]["above_start"],
        "worst_above_start_scene": above[0],
        "sweeps_median": sweeps[len(sweeps) // 2],
        "sweeps_most": sweeps[-1],
        "ended_by": {
            f"{count}": sum(s <= count for s in sweeps)
            for count in (10, 100, 1000, 10_000, 100_000, 1_000_000)
        },
    }


# --- writing ------------------------------------------------------------------------------------


def write(results, folder, command, cases):
    """Write results.json, report.md and the figures into `folder`; case files into `cases`."""
    commands, folder = case_files(results, cases), Path(folder)
    made = sections(results)
    failures = [
        [job["name"], row["at"], row["expected"], row["got"], commands[id(row)]]
        for job, row in failed(results)
    ]
    made["counts"]["failed"] = failures[:50]
    saved = {
        name: measured.save(folder, name, section, command, packages=("numba",))
        for name, section in made.items()
    }
    redraw(saved, folder)


def redraw(saved, folder):
    """report.md and the figures, from the sections of results.json. Says so without matplotlib."""
    pictures = {}
    try:
        pictures = figures.draw(saved["maps"]) if "maps" in saved else {}
    except ImportError as error:
        print(f"no figures: {error}", file=sys.stderr)
    for name, svg in pictures.items():
        write_whole(str(Path(folder) / name), svg)
    write_whole(str(Path(folder) / "report.md"), page(saved))


def failed(results):
    """[(job, row)] of every row that makes the exit status 1."""
    return [(job, row) for job, result in results for row in result["rows"] if row["status"] in BAD]


def case_files(results, folder):
    """Write a case file for every failed row; {id(row): the command that runs it again}."""
    commands = {}
    for count, (job, row) in enumerate(failed(results)):
        path = Path(folder) / f"case-{count:03d}.json"
        write_whole(str(path), json.dumps(row.get("case", job), indent=1) + "\n")
        commands[id(row)] = f"python -m curriculum.stress --case {shown(path)}"
    return commands


def shown(path):
    """The path as a reader at the project's root would type it."""
    try:
        return str(Path(path).resolve().relative_to(measured.ROOT))
    except ValueError:
        return str(path)


# --- the page -----------------------------------------------------------------------------------


def page(saved):
    """report.md."""
    return reporting.page(
        "Stress report: where each contact model breaks, and what else was tried",
        saved["counts"],
        headline(saved["counts"]),
        violation_part(saved["counts"]),
        map_part(saved.get("maps")),
        scene_part(saved.get("scenes")),
        board_part(saved.get("boards")),
        extreme_part(saved.get("extremes")),
        rows_part(
            saved.get("seeds"),
            "## Ordering over the seeds",
            "The scenes drop and stack at the length of `--smoke`.",
        ),
        rows_part(
            saved.get("bytes"),
            "## Same bytes",
            "`--smoke` of each scene in a process of its own; stdout and metrics.json "
            "compared byte for byte with hash seed 0 and one thread.",
        ),
        "## soft and MuJoCo\n\nHow far soft is from the engine that it rebuilds stands in "
        "`mujoco_match.md`, beside the full report; `python -m curriculum.stress.mujoco_match` "
        "writes it.",
    )


def readme_block(saved):
    """What the README shows: what was judged, and the most telling numbers."""
    count, scenes, found = (saved.get(name, {}) for name in ("counts", "scenes", "maps"))
    rows = [
        [
            f"{count['cells']:,} runs, {count['judgements']:,} judgements: violations",
            f"{count['violations'] + count['died']:,}",
        ],
        ["limits of a model, each named in its row of the report", f"{count['limits']:,}"],
    ]
    if "penalty" in found:
        error = found["penalty"]["boundary_worst_error"]
        rows.append(
            [
                "penalty: measured critical dt against theory, worst of "
                f"{found['penalty']['boundaries']} boundaries",
                f"{number(None if error is None else 100 * error, 2)} %",
            ]
        )
    if "converges" in found:
        at = found["converges"]
        rows += [
            [
                f"lcp: height error of the bounce at {1e3 * at['dt'][k]:g} ms",
                f"{number(at['height_error'][k])} r",
            ]
            for k in (0, -1)
        ]
    if "exact" in found:
        rows.append(
            [
                "exact: worst height error of the drop, any dt and e",
                f"{found['exact']['height_error']:.1e} r",
            ]
        )
    if scenes:
        unfinished = scenes["unfinished"]
        rows += [
            ["random scenes for each model", f"{scenes['count']:,}"],
            [
                "random scenes in which unfinished sweeps of lcp add energy (above the start)",
                f"{unfinished['rises']:,} ({unfinished.get('above_start', 0):,})",
            ],
            [
                "runs of exact that were cut short by their limit of time",
                f"{scenes['exact_cut']:,} of {scenes['exact_run']:,}",
            ],
            [
                "boards of fixed balls, on which exact is watched for three seconds",
                f"{saved.get('boards', {}).get('count', 0):,}",
            ],
        ]
    note = measured.stale_note(saved["counts"])
    return (f"{note}\n\n" if note else "") + table(["", "measured"], rows)


def headline(count):
    """The verdict in a paragraph."""
    clean = not count["violations"] + count["died"]
    verdict = Claim(
        clean, "No violation.", f"**{count['violations']} violations, {count['died']} jobs died.**"
    )
    named = "; ".join(f"{name}: {times}" for name, times in count["limits_by_kind"].items())
    return (
        f"{count['cells']:,} runs in {count['jobs']:,} jobs, {count['judgements']:,} "
        f"judgements: {verdict} {count['limits']:,} of them are limits of a model, each named, "
        f"with what bounds it, in its row below" + (f" ({named})." if named else ".")
    )


def violation_part(count):
    """The failed judgements with the commands that run them again."""
    if not count["failed"]:
        return ""
    return "## Violations\n\n" + table(
        ["job", "where", "expected", "got", "run it again"],
        [[*row[:4], f"`{row[4]}`"] for row in count["failed"]],
    )


def map_part(found):
    """The figures, with what they show in sentences made from the data."""
    if not found:
        return ""
    parts = ["## Maps\n\nOne ball dropped 1 m (scene drop)."]
    for name, said in (
        ("penalty", penalty_words),
        ("depth", depth_words),
        ("converges", converges_words),
        ("lcp", lcp_words),
        ("soft", soft_words),
        ("exact", exact_words),
    ):
        if name in found:
            parts.append(said(found[name]))
    return "\n\n".join(parts)


def penalty_words(found):
    """The stability map of penalty."""
    rows = []
    for c, outcomes in found["outcomes"].items():
        inside, outside = Counter(), Counter()
        for k, letters in zip(found["stiffness"], outcomes):
            theory = figures.contact.critical_dt(1.0, k, float(c))
            for dt, letter in zip(found["dt"], letters):
                (inside if dt < theory else outside)[letter] += 1
        rows.append(
            [
                c,
                *(
                    ", ".join(
                        f"{100 * counts[o] / (sum(counts.values()) or 1):.0f} %"
                        for o in figures.ORDER
                    )
                    for counts in (inside, outside)
                ),
            ]
        )
    error = found["boundary_worst_error"]
    return (
        "### penalty: time step, stiffness, damping\n\n![Outcome of the drop](penalty-map.svg)\n\n"
        "The line is `critical_dt`: k dt² + 2 c dt = 4 m. A ball kept in contact, started half a "
        "percent off its rest depth so that no clamp acts, leaves its place at the circles, found "
        f"by bisection: {found['boundaries']} boundaries, off by at most "
        f"{number(None if error is None else 100 * error, 2)} %. The drop itself only obeys the "
        "line once it has stopped bouncing: each impact that the steps cut short can add energy.\n\n"
        + table(
            [
                "damping [N s/m]",
                "below the critical dt: settles, moves on, gains, explodes",
                "above it",
            ],
            rows,
        )
    )


def depth_words(found):
    """The depth of lcp."""
    still = [row for name, row in found["rows"].items() if name.startswith("e=0 ")]
    same = Claim(
        all(row == still[0] for row in still),
        "No Baumgarte gain changes it (the same numbers at beta 0, 0.2 and 1).",
        "It changes with the Baumgarte gain.",
    )
    return (
        "### lcp: how deep\n\n![How deep](lcp-depth.svg)\n\nThe landing step decides it: the ball "
        "goes in by at most the impact speed times dt, and is r deep from "
        f"dt = {maps.RADIUS / maps.IMPACT_SPEED:.3g} s on. {same} A ball that bounces lands again and "
        "again, once of them late in a step."
    )


def converges_words(found):
    """The error of the bounce."""
    error, dt = found["height_error"], found["dt"]
    falling = all(a > b for a, b in zip(error, error[1:]))
    listed = reporting.listed(f"{number(e)} r at {1e3 * step:g} ms" for e, step in zip(error, dt))
    order = math.log(error[0] / error[-1]) / math.log(dt[0] / dt[-1])
    said = Claim(
        falling,
        f"The error falls at every halving: {listed}.",
        f"The error does not fall at every halving (where in a step a bounce falls is luck): {listed}.",
    )
    overall = f"From the first to the last it falls with the power {order:.2f} of dt."
    return (
        "### lcp: the bounce converges\n\n![Error of the bounce](lcp-converges.svg)\n\n"
        f"{said} {overall} At rest the gap is 0 within {max(found['rest_gap']):.1e} r."
    )


def lcp_words(found):
    """The map of lcp's height errors."""
    lines = []
    for name, label in (
        ("height_error", "worst height error, in r"),
        ("contact_energy", "most energy in (all rises, step by step), as a share of the start's"),
        ("energy_excess", "most energy above the start, as a share of it"),
    ):
        at = found["most"][name]
        lines.append(
            f"- {label}: {number(at['value'])}, at dt {at['dt']:.3g} s, "
            f"beta {at['baumgarte']:g}, e {at['restitution']:g}"
        )
    return (
        "### lcp: time step, Baumgarte gain, restitution\n\n![Height error](lcp-error.svg)\n\n"
        + "\n".join(lines)
    )


def soft_words(found):
    """The map of soft."""
    worst = max(max(row) for row in found["energy_excess"])
    return (
        "### soft: time step and time constant\n\n![Depth of soft](soft-map.svg)\n\n"
        f"The energy rises above the start by at most {number(worst, 2)} of it."
    )


def exact_words(found):
    """The numbers of exact."""
    return (
        "### exact\n\nOver all dt and restitutions the height is off by at most "
        f"{found['height_error']:.1e} r from the closed form, the ball is at most "
        f"{found['depth']:.1e} r deep, and the energy is at most {found['energy_excess']:.1e} "
        "of the start's above it."
    )


def scene_part(found):
    """The invariants over random scenes, each with how its bound follows."""
    if not found:
        return ""
    bounds = "\n".join(
        f"- **{name.replace('_', ' ')}.** {reason(name)}"
        for name in invariants.CHECKS
        if reason(name)
    )
    return "\n\n".join(
        [
            "## Invariants over random scenes",
            f"{found['count']:,} scenes of 1 to 30 balls for each model, numbered from 0: scattered, "
            "scattered among pegs (fixed balls), touching, in towers, overlapping; equal and unequal "
            "masses and radii; all knobs. "
            "`python -m curriculum.stress --case scene:NUMBER` runs one again.",
            check_table(found),
            "How each bound follows (U = 2⁻⁵³, the largest relative rounding error of one "
            "operation):",
            bounds,
            unfinished_words(found["unfinished"]),
            rise_words(found),
            cut_words(found),
        ]
    )


def board_part(found):
    """The invariants of exact on boards of pegs."""
    if not found:
        return ""
    return "\n\n".join(
        [
            "### exact on boards of pegs",
            f"{found['count']:,} boards: up to 30 balls, each fixed with a chance of a tenth to a half, "
            "for three seconds, so that balls come to rest beside others that slide, and more fall on "
            "them. `python -m curriculum.stress --case board:NUMBER` runs one again.",
            check_table(found),
            f"Where balls are fixed E rises in a step by at most {found['rise']:.1e} of the start's. No "
            "bound is derived there, since a narrow wedge has no greatest force.",
            cut_words(found),
        ]
    )


def check_table(found):
    """The checks, what they state, in how many scenes, and how often it was not so."""
    rows = [
        [name.replace("_", " "), statement(name), f"{entry['scenes']:,}", entry["violations"]]
        for name, entry in found["checks"].items()
        if name not in invariants.COUNTS
    ]
    return table(["invariant", "statement", "scenes", "violations"], rows)


def statement(name):
    """The first line of a check's docstring."""
    return invariants.CHECKS[name].__doc__.splitlines()[0]


def reason(name):
    """The rest of a check's docstring as one paragraph."""
    return " ".join(" ".join(invariants.CHECKS[name].__doc__.splitlines()[1:]).split())


def unfinished_words(found):
    """How often and by how much unfinished sweeps add energy."""
    title = "### Energy that unfinished sweeps add\n\n"
    if not found["rises"]:
        return title + f"In none of {found['scenes']:,} scenes."
    ended = [
        [f"{int(count):,}", f"{times:,} of {found['rises']:,}"]
        for count, times in found["ended_by"].items()
    ]
    return title + (
        f"Without bias velocity F rises in {found['rises']:,} of {found['scenes']:,} scenes, in "
        f"{found['notable']:,} of them by more than {invariants.NOTABLE:g} of the energies there "
        f"are; in {found['above_start']:,} the energy rises above the start. Every rise is lam.w "
        "of contacts whose sweeps had not finished, to rounding: when a contact is solved last, "
        "its neighbours are left with an impulse that pushes apart bodies that already part. The "
        f"largest rise in a step is {number(found['worst_rise'])} of the energies (scene "
        f"{found['worst_rise_scene']}); the most above the start is "
        f"{number(found['worst_above_start'])} (scene {found['worst_above_start_scene']}). The "
        f"median scene needs {found['sweeps_median']:,} sweeps to end it, the slowest "
        f"{found['sweeps_most']:,}:\n\n" + table(["sweeps a step", "rises that are over"], ended)
    )


def rise_words(found):
    """By how much E rises in a run of exact, beside what is allowed."""
    if not found.get("exact_rise"):
        return ""
    share, number = found["exact_rise"]
    judged = found["checks"][RISES]["scenes"]
    return (
        f"In none of the {judged:,} runs of exact without overlaps at the start and without fixed "
        f"balls E rises in a step by more than {share:.1e} of the energies there are (scene {number})."
    )


def cut_words(found):
    """How many runs of exact were cut short."""
    if not found["exact_cut"]:
        return f"Every run of exact ended within {limit_seconds():g} s of CPU time."
    middle = found["exact_cut_to"][len(found["exact_cut_to"]) // 2]
    return (
        f"{found['exact_cut']:,} of {found['exact_run']:,} runs of exact take longer than "
        f"{limit_seconds():g} s of CPU time and are judged up to there (the median of them for "
        f"{100 * middle:.0f} % of its steps). That is a limit of time, not of accuracy; but what "
        "rattles most is judged for the shortest time."
    )


def limit_seconds():
    """How much CPU time a run of exact may take here [s]."""
    from curriculum.stress.trial import SECONDS

    return SECONDS


def extreme_part(found):
    """Every case with its docstring and its rows."""
    if not found:
        return ""
    parts = [
        "## Extremes\n\nEach expectation was written before the run. `limit`: missed, by no "
        "more than the limit named in the case allows."
    ]
    for name, rows in found.items():
        if name == "measured":
            continue
        words = " ".join(extremes.CASES[name].__doc__.split()).replace("*", "\\*")
        parts.append(
            f"### {name.replace('_', ' ')}\n\n{words}\n\n"
            + table(["case", "expected", "got", ""], rows)
        )
    return "\n\n".join(parts)


def rows_part(section, title, words):
    """A plain table of judgements."""
    if not section or not section["rows"]:
        return ""
    return f"{title}\n\n{words}\n\n" + table(["cell", "expected", "got", ""], section["rows"])
