"""What was measured, for a reader: goals met and missed, tables, figures, the README's block.

All of it is made from results.json alone, so that the same results give the same text.
"""

import math

import numpy as np

from contact import MODELS
from contact import shown as number
from curriculum.bench import accuracy, piles, problems, skips, solvers
from curriculum.bench.accuracy import BUDGET, LABELS, WORK
from curriculum.measured import results
from curriculum.measured.results import table
from curriculum.run import plotting

EVERYTHING = "Everything, with settings and spread: [results](curriculum/bench/results/README.md)."
TINY = 1e-10  # r, what exact has to stay within
SHARE = 0.2  # of the fastest peer's time
LEAST = 1e-17  # r: an error of exactly zero is drawn here
EQUAL = {  # the two contests: key of the section, words
    "headline": f"at equal work, at most {WORK} substeps in 2 ms",
    "in_time": f"in equal time, {BUDGET} µs a ball and 2 ms",
}


def ranged(about, way=""):
    """A median with its spread: of a dict with median, min, max, perhaps of one way of several."""
    median, least, most = (number(about[way + which]) for which in ("median", "min", "max"))
    return f"{median} ({least} to {most})"


def called(row):
    """Family and setting of a point, for a reader."""
    return f"{LABELS[row['family']]}: {row['words']}"


def points_of(section, problem):
    return [p for p in accuracy.unpacked(section["points"]) if p["problem"] == problem]


def best_peer(found):
    """The most accurate other engine of {family: about}, with its family; or None."""
    peers = [dict(about, family=name) for name, about in found.items() if name not in MODELS]
    return min(peers, key=lambda about: about["error"], default=None)


def beats(one, other):
    """Whether an error is no larger than another, in three digits; of two that are measured."""
    return bool(one and other) and accuracy.rank(one)[0] <= accuracy.rank(other)[0]


# goals


def goals(sections):
    """(what was wanted, of what, what was measured, whether that is enough), one by one."""
    for name in filter(sections.__contains__, GOALS):
        yield from GOALS[name](sections[name])


def accuracy_goals(section):
    for problem in section["problems"]:
        points = [p for p in points_of(section, problem) if not p["diverged"]]
        peers = [p for p in points if p["family"] not in MODELS]
        fast = min(peers, key=lambda p: p["awake_median"], default=None)
        for p in points:
            if p["family"] == "exact" and p["error"] is not None:
                wanted = f"exact: at most {TINY:g} r off"
                yield wanted, problem, f"{number(p['error'])} r", p["error"] <= TINY
            if p["family"] == "exact" and fast:
                ratio = p["awake_median"] / fast["awake_median"]
                wanted = "exact: no slower than the fastest other engine, awake, at any step"
                found = f"{number(ratio)} times {LABELS[fast['family']]}"
                yield wanted, problem, found, ratio <= 1.0
    for contest, words in EQUAL.items():
        for problem, found in section[contest].items():
            if (mine := found.get("lcp")) and (peer := best_peer(found)):
                wanted = f"lcp {words}: no less accurate than any other engine"
                against = f"{LABELS[peer['family']]} {number(peer['error'])} r"
                yield wanted, problem, f"{number(mine['error'])} r, {against}", beats(mine, peer)


def pile_goals(section):
    wanted = f"lcp, compiled, piles at rest: at most {SHARE} of the fastest other engine's time"
    for count, depths in sorted(section["best"].items(), key=lambda each: int(each[0])):
        for depth, found in depths.items():
            case = f"{int(count):,} balls, {depth} r"
            if found["ratio"] is None:
                absent = "no other engine" if "lcp" in found["engines"] else "lcp does not"
                yield wanted, case, f"{absent} gets there at rest", "lcp" in found["engines"]
            else:
                yield wanted, case, number(found["ratio"]), found["ratio"] <= SHARE


def skip_goals(section):
    bits = section["same_bits"]
    found = f"{len(bits['differing'])} of {bits['runs']} runs differ"
    yield "the same bits with and without skips", "all scenes", found, not bits["differing"]
    for name, limit in skips.LIMITS.items():
        if about := section["processes"].get(name):
            wanted = f"whole process: at most {limit} times `import {about['base']}`"
            yield wanted, name, number(about["ratio"]), about["ratio"] <= limit
    for name, about in section.get("in_process", {}).items():
        limit = skips.IN_PROCESS[name]
        wanted = (
            f"lcp's readable loops, skips and all: at most {limit} times pymunk, in one process"
        )
        yield wanted, name, ranged(about), about["median"] <= limit


GOALS = {"accuracy": accuracy_goals, "pile": pile_goals, "skip": skip_goals}


# pages


def readme(sections):
    """The block of the project's README: a figure, tables, what lcp is good for, what is missed."""
    parts = ["![Run time against error: bounce](curriculum/bench/results/error-bounce.svg)"]
    if section := sections.get("accuracy"):
        about = section["measured"]
        modules = [engine[1] for engine in accuracy.engines.ENGINES.values()]
        versions = [f"{name} {about['versions'].get(name, '-')}" for name in modules]
        whos = ["lcp, equal work", "best other, equal work"]
        whos += ["lcp, equal time", "best other, equal time"]
        parts += [
            table(["", "exact", *whos], contest_rows(section)),
            "Worst error in radii, time awake (and as a user gets it, with sleep and skips). Equal "
            f"work: at most {WORK} substeps in 2 ms; equal time: {BUDGET} µs a ball for 2 ms, "
            f"awake. Loops are compiled, settings stand in the results. {good_for(section)} On "
            f"{about['cores']} cores of {about['cpu']}, with {', '.join(versions)}.",
        ]
    if "pile" in sections:
        head = ["1,000 balls at rest", "lcp, compiled", "fastest other engine", "ratio"]
        parts.append(table(head, rest_rows(sections["pile"])))
    return "\n\n".join((*parts, missed(sections), EVERYTHING))


def missed(sections):
    """One paragraph: what is missed, goal by goal."""
    found = {}
    for wanted, case, about, met in goals(sections):
        if not met:
            found.setdefault(wanted, []).append(f"{case} ({about})")
    lines = [f"*{wanted}* in {'; '.join(cases)}" for wanted, cases in found.items()]
    return f"Missed: {'. '.join(lines)}." if lines else "No goal is missed."


def contest_rows(section):
    """For each problem the worst error [r] and time [ms] of exact, lcp and the best peer; twice."""

    def cell(about, won=False):
        if not about:
            return "-"
        who = f"{LABELS[about['family']]} " if "family" in about else ""
        error = "reference" if about["error"] is None else f"{number(about['error'])} r"
        text = f"{who}{error}, {number(about['ms'])} ms"
        if about.get("user_ms", math.inf) < 0.9 * about["ms"]:
            text += f" ({number(about['user_ms'])})"
        return f"**{text}**" if won else text

    for problem in section["problems"]:
        p = next((p for p in points_of(section, problem) if p["family"] == "exact"), None)
        row = [problem, cell(p and dict(error=p["error"], ms=p["awake_median"]))]
        for contest in EQUAL:
            found = section[contest].get(problem, {})
            mine, peer = found.get("lcp"), best_peer(found)
            row += [cell(mine, beats(mine, peer)), cell(peer, beats(peer, mine))]
        yield row


def good_for(section):
    """One sentence on what lcp is still good for, from the numbers."""
    parts, ratios = [], []
    for contest, words in EQUAL.items():
        found, (when, _) = section[contest], words.split(", ")
        names = [name for name, f in found.items() if beats(f.get("lcp"), best_peer(f))]
        parts.append(f"{when} in {len(names)} of {len(found)} ({', '.join(names) or 'none'})")
    for problem in section["problems"]:
        step = [p for p in points_of(section, problem) if p["work"] == 1 and p["dt"] == 0.002]
        mine = [p["awake_median"] for p in step if p["family"] == "lcp"]
        peers = [p["awake_median"] for p in step if p["family"] not in MODELS]
        ratios += [min(mine) / min(peers)] if mine and peers else []
    words = f"lcp is the most accurate {' and '.join(parts)}"
    if ratios and max(ratios) < 1.0:
        words += (
            f"; what it is still good for is many small steps, since its step costs "
            f"{number(min(ratios), 2)} to {number(max(ratios), 2)} of the cheapest other engine's"
        )
    return words + "."


def rest_rows(section):
    """Microseconds a step at 1,000 balls, or at the most that were measured, at each depth."""
    count = "1000" if "1000" in section["best"] else list(section["best"])[-1]
    for depth, found in section["best"][count].items():
        us = {name: about["us"] for name, about in found["engines"].items()}
        mine, fast = us.pop("lcp", None), min(us, key=us.get, default=None)
        yield [
            f"at most {depth} r deep",
            f"{number(mine)} µs" if mine else "-",
            f"{piles.LABELS[fast]}: {number(us[fast])} µs" if fast else "-",
            number(found["ratio"]),
        ]


def page(sections):
    """README.md of the results folder: goals, and every table."""
    verdict = {True: "met", False: "**missed**"}
    parts = [
        "# Run time against error",
        "Written by `python -m curriculum.bench`; do not edit.",
        table(
            ["goal", "case", "measured", ""],
            [[*row, verdict[met]] for *row, met in goals(sections)],
        ),
    ]
    for name, section in sections.items():
        parts += [*PARTS[name](section), results.footer(section)]
    return "\n\n".join(parts) + "\n"


def accuracy_part(section):
    yield (
        "An error is the median over several starts, a time the median over fresh processes "
        "(CPU time, one thread; least to greatest). Everyone is looked at alike: every height, "
        "every 2 ms; `16 x` are sixteen steps between two looks. Awake, everyone takes every "
        "step. As a user gets it, balls may sleep where an engine has that, and contact.py skips "
        "what it knows; Drake has neither. lcp, penalty and soft are compiled but where the words "
        "say Python; compiling is not counted (see the piles). Pymunk, Box2D and Drake have no "
        "loop of their own and are called from Python: pymunk awake by its engine's function, and "
        "as a user gets it by its own step, 0.7 µs more. Drake under error control takes as many "
        "steps as it needs, whose mean counts at equal work; of its discrete solver, which is "
        "slow, there is one start and one process. Engines in float32 are right to about 1e-6 r, "
        "the closed forms to 1e-12 r; of the pile `exact` is the reference. Left out: "
        "PyBullet, whose restitution depends on the step; Box2D 2.3, which version 3 replaces; "
        "Siconos and Rapier, which have no package here. A better setting? Add a line to SETTINGS "
        "in [engines.py](../engines.py) and send it."
    )
    yield from (f"Not everywhere: {label}, {why}." for label, why in section["left_out"].items())
    for name, about in section["problems"].items():
        yield f"## {about['title']}\n\nHard on: {about['stresses']}."
        yield f"![Run time against error: {name}](error-{name}.svg)"
        points = points_of(section, name)
        yield contests(points, name)
        head = ["at 2 ms", "worst error / r", "asleep", "at the end", "energy / E0", "deepest / r"]
        yield table([*head, "awake [ms]", "user [ms]"], list(rows_at(points)))


def contests(points, problem):
    """The best of each family with ever more work, and in ever more time."""
    columns = {f"{work} substeps": dict(work=work) for work in problems.SUBSTEPS}
    columns |= {f"{us} µs": dict(budget=us) for us in accuracy.BUDGETS}
    found = [accuracy.headline(points, **given).get(problem, {}) for given in columns.values()]

    def cell(about):
        return f"{number(about['error'])} ({about['words']}, {1e3 * about['dt']:g} ms)"

    families = [f for f in LABELS if any(f in each for each in found) and f != "exact"]
    return table(
        ["least error / r within", *columns],
        [[LABELS[f], *(cell(each[f]) if f in each else "-" for each in found)] for f in families],
    )


def rows_at(points):
    """One row a contestant and number of substeps, at 2 ms."""
    for p in points:
        if p["dt"] == problems.REFERENCE_DT:
            error = dict(median=p["error"], min=p["least"], max=p["greatest"])
            itself = "reference" if p["error"] is None else ranged(error)
            yield [
                called(p),
                f"diverged in {p['diverged']} starts" if p["diverged"] else itself,
                number(p["user_error"]) if p["user_error"] != p["error"] else "same",
                *(number(p[key]) for key in ("final_error", "energy_error", "depth")),
                *(ranged(p, f"{way}_") for way in accuracy.WAYS),
            ]


def pile_part(section):
    fresh, again = (number(section["compile"].get(name)) for name in ("fresh", "again"))
    yield "## Piles between walls of fixed balls"
    yield (
        "The same walls in every engine, steps of 2 ms. A pile counts as settled only where no "
        f"ball was faster than {piles.AT_REST:g} m/s over the last {piles.WATCHED} steps; depth "
        "is the mean of the overlapping contacts. Times are CPU time, median over fresh "
        "processes (least to greatest). A process that takes one step by the twin needs "
        f"{fresh} s where it must be compiled, and {again} s later on; neither is in the table. "
        "Ten thousand balls begin as ten settled copies of each engine's own thousand, since a "
        "lattice of so many does not come to rest in reach; only the winners at a thousand run "
        "there. An engine that does not come to rest there has a row, and counts in no goal."
    )
    yield "![Time a step against depth](settled.svg)"
    head = ["at rest", "fastest ball [m/s]", "mean depth / r", "worst"]
    for count in dict.fromkeys(row["bodies"] for row in section["rows"]):
        yield table(
            [f"{count:,} balls", *head, "settled [µs a step]", "falling [µs a step]"],
            [
                [
                    f"{piles.LABELS[row['engine']]}: {row['words']}",
                    "yes" if row["at_rest"] else "**no**",
                    *(number(row[key]) for key in ("speed", "mean_depth", "worst_depth")),
                    *(ranged(row[phase]) for phase in ("resting", "falling")),
                ]
                for row in section["rows"]
                if row["bodies"] == count
            ],
        )


def solved(section):
    """({row: its judged problems}, the problems), of the section "solvers"."""
    rows = {row: section[row] for row in solvers.SOLVERS}
    return rows, [name for name in solvers.PROBLEMS if name in rows["lcp"]]


def solvers_part(section):
    yield "## Twenty contact solves, spent in many ways"
    yield (
        "Steps of 1/64 s; each solver may solve every contact twenty times a step, whether in one "
        "go, in substeps or for positions. `exact` judges: worst distance of a ball's height from "
        "where it should be, in radii. A direct solve is counted as one per guess."
    )
    yield "![Worst error, and overlap at rest beside its law](solvers.svg)"
    rows, names = solved(section)

    def error(about):
        gained = f", +{number(about['energy'])} E" if about["energy"] > 1e-3 else ""
        return number(about["error"]) + gained

    def rest(about):
        law = f" ({number(about['law'])})" if about["law"] else ""
        return "moves" if about["rest"] is None else number(about["rest"]) + law

    def listed(names, cell):
        return [[about["words"], *(cell(about[name]) for name in names)] for about in rows.values()]

    most = [[number(max(about[name]["solves"] for name in names))] for about in rows.values()]
    titles = {name: solvers.PROBLEMS[name][0] for name in names}
    yield table(
        ["worst error / r; + energy gained", *titles.values(), "solves"],
        [row + last for row, last in zip(listed(names, error), most)],
    )
    towers = [name for name in names if rows["lcp"][name]["law"]]
    yield table(
        ["overlap at rest / r; (law)", *(titles[name] for name in towers)], listed(towers, rest)
    )


def skip_part(section):
    yield "## What a whole process takes"
    yield table(
        ["whole process", "seconds", "times its import", "by the least times"],
        [
            [name, ranged(about), number(about.get("ratio")), number(about.get("least"))]
            for name, about in section["processes"].items()
        ],
    )


PARTS = {"accuracy": accuracy_part, "pile": pile_part, "solvers": solvers_part, "skip": skip_part}


# figures


def figures(sections):
    """{file name: SVG text}."""
    made, section = {}, sections.get("accuracy", {"problems": ()})
    for name in section["problems"]:
        made[f"error-{name}.svg"] = error_figure(section, name)
    if "pile" in sections:
        made["settled.svg"] = pile_figure(sections["pile"])
    if "solvers" in sections:
        made["solvers.svg"] = solvers_figure(sections["solvers"])
    return made


def draw_front(axis, points, across, up, name, label):
    """A line through the points that no other beats in both at once."""
    found = []
    for point in sorted(points, key=lambda p: (p[across], p[up])):
        if not found or point[up] < found[-1][up]:
            found.append(point)
    plotting.line(axis, [p[across] for p in found], [p[up] for p in found], name, label)


def error_figure(section, problem):
    """Time against error: every setting a faint dot, the best of each family a line."""
    about, families = section["problems"][problem], {}
    for p in points_of(section, problem):
        if not p["diverged"] and (p["error"] is not None or p["family"] == "exact"):
            families.setdefault(p["family"], []).append(dict(p, error=max(p["error"] or 0, LEAST)))
    figure, (left, axis) = plotting.figure(
        share=(1, 6),
        height=3.7,
        below=1.5,
        title=about["title"],
        explained="Left and down is better. A faint dot is one setting at one step, every step "
        "taken; a line joins the best of a family, whose best at equal work is named. 16 x: "
        "sixteen steps from look to look.",
    )
    for family, points in families.items():
        panel = left if family == "exact" else axis
        x, y = ([p[key] for p in points] for key in ("error", "awake_median"))
        panel.scatter(x, y, s=7, color=plotting.look(family)["color"], alpha=0.35, linewidths=0)
        best = section["headline"].get(problem, {}).get(family)
        label = called(dict(best, family=family)) if best else LABELS[family]
        draw_front(panel, points, "error", "awake_median", family, label)
    everything = [p["awake_median"] for points in families.values() for p in points]
    for panel in (left, axis):
        panel.set(xscale="log", yscale="log", ylim=(min(everything) / 1.6, max(everything) * 1.6))
    ylabel = f"time for {about['duration']:g} s of motion [ms]"
    left.set(xlim=(1e-18, 1e-9), xticks=[1e-14], ylabel=ylabel)
    left.minorticks_off()
    axis.set(xlabel="worst position error [r]", xlim=(None, min(axis.get_xlim()[1], 30.0)))
    axis.tick_params(labelleft=False)
    handles = [h for panel in (left, axis) for h in zip(*panel.get_legend_handles_labels())]
    below = dict(loc="lower left", bbox_to_anchor=(0.0, 0.22 / figure.get_figheight()))
    figure.legend(*zip(*handles), **below, borderaxespad=0, handlelength=3.2, fontsize=9)
    return plotting.svg(figure, section)


def pile_figure(section):
    """Time a step against depth, a panel for each size; a setting that does not rest is hollow."""
    counts = list(dict.fromkeys(row["bodies"] for row in section["rows"]))
    figure, axes = plotting.figure(
        rows=len(counts),
        height=2.6,
        below=0.5,
        title="Piles at rest: time a step against depth",
        explained="Left and down is better. A dot is a setting, hollow where balls are still "
        "moving; a line joins the best of an engine at rest.",
    )
    every = [
        dict(row, x=max(row["mean_depth"], 1e-9), y=row["resting"]["median"])
        for row in section["rows"]
        if piles.ASLEEP not in row["words"] and row["mean_depth"]
    ]
    for axis, count in zip(axes, counts):
        for engine, label in piles.LABELS.items():
            rows = [r for r in every if (r["bodies"], r["engine"]) == (count, engine)]
            for row in rows:
                look = dict(plotting.look(engine), ls="", alpha=0.6)
                axis.plot(row["x"], row["y"], **look, **({} if row["at_rest"] else {"mfc": "none"}))
            draw_front(axis, [row for row in rows if row["at_rest"]], "x", "y", engine, label)
        axis.set(xscale="log", yscale="log", title=f"{count:,} balls", ylabel="time a step [µs]")
        axis.set_xlim(min(r["x"] for r in every) / 1.5, max(r["x"] for r in every) * 1.5)
    axes[-1].set_xlabel("mean depth of the overlapping contacts [r]")
    plotting.legend_below(axes[-1], columns=4, down=0.24)
    return plotting.svg(figure, section)


HUES = [plotting.LOOKS[name][:2] for name in ("lcp", "pymunk", "penalty", "box2d3")]
SHOWN = ("stack_30", "heavy_100", "heavy_1000", "pile_8")
LAWFUL = ("lcp", "ahead", "xpbd", "small_steps")


def solvers_figure(section):
    """Above the worst errors, a line a solver; below the overlaps at rest, and their law."""
    rows, names = solved(section)
    figure, (upper, lower) = plotting.figure(
        rows=2,
        height=3.4,
        below=0.5,
        title="Twenty contact solves a step, spent in many ways",
        explained="Above: left is better. Below: the overlap under the lowest ball, measured "
        "(dots), and what the law of unfinished sweeps gives (lines), with nothing fitted.",
    )
    (_, low), (_, high) = upper.get_position().get_points()
    upper.set_position([0.36, low - 0.02, 0.62, high - low])
    order = list(reversed(rows))
    for (color, marker), name in zip(HUES, SHOWN):
        x = [min(rows[row].get(name, {}).get("error", math.nan), 30.0) for row in order]
        label = solvers.PROBLEMS[name][0]
        upper.plot(x, range(len(order)), color=color, marker=marker, ls="", ms=5.5, label=label)
    upper.set(xscale="log", yticks=range(len(order)), xlabel="worst error [r]")
    upper.set_yticklabels([rows[row]["words"] for row in order], fontsize=8.5)
    above = dict(loc="lower left", bbox_to_anchor=(-0.02, 1.0), borderaxespad=0.2)
    upper.legend(**above, ncols=4, columnspacing=0.8, handletextpad=0.1, fontsize=8.5)
    for (color, marker), row in zip(HUES, LAWFUL):
        one = solvers.sag(solvers.SOLVERS[row], np.ones(2))  # as much on top as below
        found = [rows[row][name] for name in names]
        dots = [(about["law"] / one, about["rest"]) for about in found if about["law"]]
        look = dict(color=color, marker=marker, ls="", ms=5.5, label=rows[row]["words"])
        lower.plot(*zip(*((x, y) for x, y in dots if y)), **look)
        lower.plot((2, 1000), (2 * one, 1000 * one), color=color, lw=1.0)
    lower.set(xscale="log", yscale="log", ylim=(3e-5, 10.0), ylabel="overlap at rest [r]")
    lower.set_xlabel("mass on top of the lowest ball / its own mass")
    plotting.legend_below(lower, columns=2, down=0.17)
    return plotting.svg(figure, section)


def write(folder, sections):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    for name, text in {"README.md": page(sections), **figures(sections)}.items():
        results.write_page(folder, name, text)
