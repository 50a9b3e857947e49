"""What was measured, for a reader: goals met and missed, tables, figures, the README's block.

All of it is made from results.json alone, so that the same results give the same text.
"""

import math

import numpy as np

from contact import MODELS
from contact import shown as number
from curriculum.bench import accuracy, piles, problems, skips, solvers
from curriculum.files import write_whole
from curriculum.measured import results
from curriculum.measured.results import table
from curriculum.run import plotting

TINY = 1e-10  # r, what exact has to stay within
PILE_LIMIT = 0.6  # of the fastest peer's time
LEAST = 1e-17  # r: an error of exactly zero is drawn here


def ranged(about):
    """A median with its spread: of a dict with median, min, max."""
    return f"{number(about['median'])} ({number(about['min'])} to {number(about['max'])})"


def called(row):
    """Family and setting of a point, for a reader."""
    return f"{accuracy.LABELS[row['family']]}: {row['words']}"


def whole(section, problem):
    """The points of a problem that did not diverge."""
    return [
        p
        for p in accuracy.unpacked(section["points"])
        if p["problem"] == problem and not p["diverged"] and p["error"] is not None
    ]


# goals


def goals(sections):
    """(what was wanted, what was measured, whether that is enough), one by one."""
    if "accuracy" in sections:
        yield from exact_goals(sections["accuracy"])
        yield from stack_goals(sections["accuracy"])
    if "pile" in sections:
        yield from pile_goals(sections["pile"])
    if "skip" in sections:
        yield from skip_goals(sections["skip"])


def exact_goals(section):
    for problem in section["problems"]:
        points = whole(section, problem)
        exact = [p for p in points if p["family"] == "exact"]
        if exact:
            error, ms = exact[0]["error"], exact[0]["read_median"]
            yield f"exact, {problem}: at most {TINY:g} r off", f"{number(error)} r", error <= TINY
        peers = [p for p in points if p["family"] not in MODELS]
        if exact and peers and problem in ("drop", "bounce"):
            fast = min(peers, key=lambda p: p["read_median"])
            ratio = ms / fast["read_median"]
            yield (
                f"exact, {problem}: no slower than the fastest peer, every height read",
                f"{number(ratio)} times {called(fast)}",
                ratio <= 1.0,
            )


def stack_goals(section):
    """Whether lcp, compiled, has something better for every setting of Box2D 3."""
    for problem in section["problems"]:
        lcp = [p for p in whole(section, problem) if p["words"].startswith("compiled")]
        rivals = [p for p in whole(section, problem) if p["family"] == "box2d3"]
        beaten = [
            p
            for p in rivals
            if any(
                mine["read_median"] <= p["read_median"] and mine["error"] <= p["error"]
                for mine in lcp
            )
        ]
        if rivals:
            yield (
                f"lcp, compiled, {problem}: for every point of Box2D 3 one that is neither "
                "slower nor less accurate",
                f"for {len(beaten)} of {len(rivals)}",
                len(beaten) == len(rivals),
            )


def pile_goals(section):
    for count, depths in sorted(section["best"].items(), key=lambda each: int(each[0])):
        for depth, found in depths.items():
            wanted = (
                f"{int(count):,} balls at rest, {depth} r deep at most: lcp, compiled, in "
                f"{PILE_LIMIT} of the fastest peer's time"
            )
            if found["ratio"] is None:
                absent = "no peer" if "lcp" in found["engines"] else "lcp does not"
                yield wanted, f"{absent} gets there at rest", "lcp" in found["engines"]
            else:
                yield wanted, number(found["ratio"]), found["ratio"] <= PILE_LIMIT


def skip_goals(section):
    bits = section["same_bits"]
    yield (
        "the same bits with and without skips",
        f"{len(bits['differing'])} of {bits['runs']} runs differ",
        not bits["differing"],
    )
    for name, limit in skips.LIMITS.items():
        if found := section["processes"].get(name):
            yield (
                f"whole process, {name}: at most {limit} times `import {found['base']}`",
                number(found["ratio"]),
                found["ratio"] <= limit,
            )
    for name, found in section["against_pymunk"].items():
        limit = skips.LCP_LIMITS[name]
        yield (
            f"lcp, {name}, in process: at most {limit} times pymunk, 10 iterations, unread",
            number(found["ratio"]),
            found["ratio"] <= limit,
        )


# pages


def readme(sections):
    """The block of the project's README: a figure, a table, and what is missed."""
    missed = [f"{wanted} ({found})" for wanted, found, met in goals(sections) if not met]
    parts = [
        "![Run time against error: bounce](curriculum/bench/results/error-bounce.svg)",
        table(
            ["", "exact", "lcp, best at 2 ms", "best other engine at 2 ms"],
            error_rows(sections["accuracy"]),
        )
        if "accuracy" in sections
        else "",
        table(
            ["1,000 balls at rest", "lcp, compiled", "fastest other engine", "ratio"],
            rest_rows(sections["pile"]),
        )
        if "pile" in sections
        else "",
        f"Missed: {'; '.join(missed)}." if missed else "No goal is missed.",
        "Everything, with settings and spread: [results](curriculum/bench/results/README.md).",
    ]
    return "\n\n".join(filter(None, parts))


def error_rows(section):
    """For each problem the worst error [r] and the time [ms] of exact, lcp and the best peer."""

    def cell(found):
        return f"{number(found['error'])} r, {number(found['ms'])} ms" if found else "-"

    for problem, found in section["headline"].items():
        peers = [dict(about, family=name) for name, about in found.items() if name not in MODELS]
        best = min(peers, key=lambda about: about["error"], default=None)
        yield [
            problem,
            cell(found.get("exact")),
            cell(found.get("lcp")),
            f"{called(best)}: {cell(best)}" if best else "-",
        ]


def rest_rows(section):
    """Microseconds a step at 1,000 balls, or at the most that were measured, at each depth."""
    count = "1000" if "1000" in section["best"] else list(section["best"])[-1]
    for depth, found in section["best"][count].items():
        mine = found["engines"].get("lcp")
        peers = {name: about for name, about in found["engines"].items() if name != "lcp"}
        fast = min(peers, key=lambda name: peers[name]["us"], default=None)
        yield [
            f"at most {depth} r deep",
            f"{number(mine['us'])} µs" if mine else "-",
            f"{piles.LABELS[fast]}: {number(peers[fast]['us'])} µs" if fast else "-",
            number(found["ratio"]),
        ]


def page(sections):
    """README.md of the results folder: goals, and every table."""
    verdict = {True: "met", False: "**missed**"}
    parts = [
        "# Run time against error",
        "Written by `python -m curriculum.bench`; do not edit.",
        table(
            ["goal", "measured", ""],
            [[wanted, found, verdict[met]] for wanted, found, met in goals(sections)],
        ),
    ]
    makers = {
        "accuracy": accuracy_part,
        "pile": pile_part,
        "solvers": solvers_part,
        "skip": skip_part,
    }
    for name, section in sections.items():
        parts += [*makers[name](section), results.footer(section)]
    return "\n\n".join(parts) + "\n"


def accuracy_part(section):
    yield (
        "An error is the median over several starts, a time the median over fresh processes "
        "(CPU time, one thread; least to greatest). In all alike every height is read after "
        "every step; bare is an engine's stepping alone. contact.py copies a state of rest, as "
        "engines do in the rows that may sleep; compiling is not counted. Engines in float32 "
        "are right to about 1e-6 r, the closed forms to 1e-12 r; of the pile `exact` is the "
        "reference. A better setting? Add a line to SETTINGS in [engines.py](../engines.py) and "
        "send it."
    )
    yield from (f"Not everywhere: {label}, {why}." for label, why in section["left_out"].items())
    for name, about in section["problems"].items():
        yield f"## {about['title']}\n\nHard on: {about['stresses']}."
        yield f"![Run time against error: {name}](error-{name}.svg)"
        points = [p for p in accuracy.unpacked(section["points"]) if p["problem"] == name]
        yield table(
            [
                "at 2 ms",
                "worst error / r",
                "at the end",
                "energy / E0",
                "deepest / r",
                "time [ms]",
                "bare [ms]",
            ],
            list(rows_at(points, problems.REFERENCE_DT)),
        )
        dts = sorted({p["dt"] for p in points})
        yield table(
            ["worst error / r at dt [ms]", *(f"{1e3 * dt:g}" for dt in dts)],
            list(rows_by_dt(points, dts)),
        )


def rows_at(points, dt):
    """One row a contestant, at one step."""
    for p in points:
        if p["dt"] == dt:
            error = ranged(dict(median=p["error"], min=p["least"], max=p["greatest"]))
            time = ranged({which: p[f"read_{which}"] for which in ("median", "min", "max")})
            yield [
                called(p),
                f"diverged in {p['diverged']} starts" if p["diverged"] else error,
                *(number(p[key]) for key in ("final_error", "energy_error", "depth")),
                time,
                number(p["bare_median"]),
            ]


def rows_by_dt(points, dts):
    """One row a contestant, its error at every step."""
    for name in dict.fromkeys(map(called, points)):
        found = {
            p["dt"]: "diverged" if p["diverged"] else number(p["error"])
            for p in points
            if called(p) == name
        }
        yield [name, *(found.get(dt, "-") for dt in dts)]


def pile_part(section):
    yield "## Piles between walls of fixed balls"
    yield (
        "The same walls in every engine, steps of 2 ms. A pile counts as settled only where no "
        f"ball was faster than {piles.AT_REST:g} m/s over the last {piles.WATCHED} steps; depth "
        "is the mean of the overlapping contacts. Times are CPU time, median over fresh "
        "processes (least to greatest). A process that takes one step by the twin needs "
        f"{number(section['compile'].get('fresh'))} s where it must be compiled, and "
        f"{number(section['compile'].get('again'))} s later on; neither is in the table."
    )
    yield (
        "Ten thousand balls begin as ten settled copies of each engine's own thousand, since a "
        "lattice of so many does not come to rest in reach; only the winners at a thousand run "
        "there. An engine that does not come to rest there has a row, and counts in no goal."
    )
    yield "![Time a step against depth](settled.svg)"
    for count in dict.fromkeys(row["bodies"] for row in section["rows"]):
        rows = [
            [
                f"{piles.LABELS[row['engine']]}: {row['words']}",
                "yes" if row["at_rest"] else "**no**",
                number(row["speed"]),
                number(row["mean_depth"]),
                number(row["worst_depth"]),
                ranged(row["resting"]),
                ranged(row["falling"]),
            ]
            for row in section["rows"]
            if row["bodies"] == count
        ]
        yield table(
            [
                f"{count:,} balls",
                "at rest",
                "fastest ball [m/s]",
                "mean depth / r",
                "worst",
                "settled [µs a step]",
                "falling [µs a step]",
            ],
            rows,
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
    titles = [solvers.PROBLEMS[name][0] for name in names]

    def error(about):
        gained = f", +{number(about['energy'])} E" if about["energy"] > 1e-3 else ""
        return number(about["error"]) + gained

    yield table(
        ["worst error / r; + energy gained", *titles, "solves"],
        [
            [
                about["words"],
                *(error(about[name]) for name in names),
                number(max(about[name]["solves"] for name in names)),
            ]
            for about in rows.values()
        ],
    )
    names = [name for name in names if rows["lcp"][name]["law"]]
    yield table(
        ["overlap at rest / r; (law)", *(solvers.PROBLEMS[name][0] for name in names)],
        [[about["words"], *(rested(about[name]) for name in names)] for about in rows.values()],
    )


def rested(about):
    law = f" ({number(about['law'])})" if about["law"] else ""
    return "moves" if about["rest"] is None else number(about["rest"]) + law


def skip_part(section):
    yield "## What skipping saves"
    yield table(
        ["whole process", "seconds", "times its import", "by the least times"],
        [
            [name, ranged(about), number(about.get("ratio")), number(about.get("least"))]
            for name, about in section["processes"].items()
        ],
    )
    yield table(
        ["2,000 steps", "all taken [ms]", "with skips [ms]", "ratio"],
        [
            [
                f"{row['scene']}, {row['model']}",
                number(row["taken"]),
                number(row["skipped"]),
                number(row["ratio"]),
            ]
            for row in section["speed_up"]
        ],
    )


# figures


def figures(sections):
    """{file name: SVG text}."""
    made = {}
    if "accuracy" in sections:
        made |= {
            f"error-{name}.svg": error_figure(sections["accuracy"], name)
            for name in sections["accuracy"]["problems"]
        }
    if "pile" in sections:
        made["settled.svg"] = pile_figure(sections["pile"])
    if "solvers" in sections:
        made["solvers.svg"] = solvers_figure(sections["solvers"])
    return made


def draw_front(axis, points, across, up, name, label):
    """A line through the points that no other beats in both at once; these points."""
    best, found = math.inf, []
    for point in sorted(points, key=lambda p: (p[across], p[up])):
        if point[up] < best:
            best = point[up]
            found.append(point)
    plotting.line(axis, [p[across] for p in found], [p[up] for p in found], name, label)
    return found


def error_figure(section, problem):
    """Time against error: every setting a faint dot, the best of each family a line."""
    about, families = section["problems"][problem], {}
    for p in whole(section, problem):
        families.setdefault(p["family"], []).append(dict(p, error=max(p["error"], LEAST)))
    figure, (left, axis) = plotting.figure(
        share=(1, 6),
        height=3.6,
        below=1.7,
        title=about["title"],
        explained="Left and down is better. A faint dot is one setting at one step; a line joins "
        "the best of a family, whose best setting at 2 ms is named. Numbers: lcp's dt in ms. "
        "Compiling lcp is not counted.",
    )
    for family, points in families.items():
        draw_family(left if family == "exact" else axis, section, family, points)
    everything = [p["read_median"] for points in families.values() for p in points]
    for panel in (left, axis):
        panel.set(xscale="log", yscale="log", ylim=(min(everything) / 1.6, max(everything) * 1.6))
    left.set(
        xlim=(1e-17, 1e-9),
        xticks=[1e-16, 1e-10],
        ylabel=f"time for {about['duration']:g} s of motion [ms]",
    )
    left.minorticks_off()
    axis.set(xlabel="worst position error [r]", xlim=(None, min(axis.get_xlim()[1], 30.0)))
    axis.tick_params(labelleft=False)
    handles = [h for panel in (left, axis) for h in zip(*panel.get_legend_handles_labels())]
    figure.legend(
        *zip(*handles),
        loc="lower left",
        handlelength=3.2,
        borderaxespad=0,
        bbox_to_anchor=(0.0, 0.22 / figure.get_figheight()),
        fontsize=8.5,
    )
    return plotting.svg(figure, section)


def draw_family(axis, section, family, points):
    """The points of one family on one panel."""
    color = plotting.look(family)["color"]
    axis.scatter(
        [p["error"] for p in points],
        [p["read_median"] for p in points],
        s=7,
        color=color,
        alpha=0.35,
        linewidths=0,
    )
    best = section["headline"].get(points[0]["problem"], {}).get(family)
    label = called(dict(best, family=family)) if best else accuracy.LABELS[family]
    line = draw_front(axis, points, "error", "read_median", family, label)
    for p in line if family == "lcp" else ():
        axis.annotate(
            f"{1e3 * p['dt']:g}",
            (p["error"], p["read_median"]),
            (-3, -4),
            ha="right",
            va="top",
            textcoords="offset points",
            fontsize=7.5,
            color=color,
        )


def pile_figure(section):
    """Time a step against depth, a panel for each size; a setting that does not rest is hollow."""
    counts = list(dict.fromkeys(row["bodies"] for row in section["rows"]))
    figure, axes = plotting.figure(
        rows=len(counts),
        height=2.6,
        below=0.7,
        title="Piles at rest: time a step against depth",
        explained="Left and down is better. A dot is a setting, hollow where balls are still "
        "moving; a line joins the best of an engine at rest.",
    )
    for axis, count in zip(axes, counts):
        for engine, label in piles.LABELS.items():
            rows = [
                dict(row, x=max(row["mean_depth"], 1e-9), y=row["resting"]["median"])
                for row in section["rows"]
                if (row["bodies"], row["engine"]) == (count, engine)
                and piles.ASLEEP not in row["words"]
                and row["mean_depth"]
            ]
            for row in rows:
                look = dict(plotting.look(engine), ls="", alpha=0.6)
                face = {} if row["at_rest"] else {"mfc": "none"}
                axis.plot(row["x"], row["y"], **look, **face)
            draw_front(axis, [row for row in rows if row["at_rest"]], "x", "y", engine, label)
        axis.set(xscale="log", yscale="log", title=f"{count:,} balls", ylabel="time a step [µs]")
    axes[-1].set_xlabel("mean depth of the overlapping contacts [r]")
    plotting.legend_below(axes[-1], columns=3, down=0.24)
    return plotting.svg(figure, section)


SHOWN = {  # problem: colour, marker
    "stack_30": (plotting.LOOKS["lcp"][0], "o"),
    "heavy_100": (plotting.LOOKS["pymunk"][0], "D"),
    "heavy_1000": (plotting.LOOKS["penalty"][0], "s"),
    "pile_8": (plotting.INK, "x"),
}
LAWFUL = {  # row: colour, marker
    "lcp": (plotting.LOOKS["lcp"][0], "o"),
    "ahead": (plotting.LOOKS["pymunk"][0], "D"),
    "small_steps": (plotting.LOOKS["box2d3"][0], "^"),
    "xpbd": (plotting.LOOKS["penalty"][0], "s"),
}


def solvers_figure(section):
    """Above the worst errors, a line a solver; below the overlaps at rest, and their law."""
    rows, names = solved(section)
    figure, (upper, lower) = plotting.figure(
        rows=2,
        height=3.6,
        below=0.55,
        title="Twenty contact solves a step, spent in many ways",
        explained="Left is better. Below: overlap under the lowest ball at rest, as measured "
        "(dots), and by the law of unfinished sweeps (lines), which takes nothing from the dots.",
    )
    box = upper.get_position()
    upper.set_position([0.36, box.y0 + 0.01, 0.62, box.height])
    order = list(reversed(rows))
    for name in filter(names.__contains__, SHOWN):
        color, marker = SHOWN[name]
        x = [min(rows[row][name]["error"], 30.0) for row in order]
        upper.plot(x, range(len(order)), color=color, marker=marker, ls="", ms=5.5, label=name)
    upper.set(xscale="log", yticks=range(len(order)), xlabel="worst error [r]")
    upper.set_yticklabels([rows[row]["words"] for row in order], fontsize=8.5)
    upper.legend(
        [solvers.PROBLEMS[name][0] for name in SHOWN if name in names],
        loc="lower left",
        bbox_to_anchor=(-0.02, 1.0),
        ncols=4,
        columnspacing=0.8,
        handletextpad=0.1,
        fontsize=8.5,
        borderaxespad=0.2,
    )
    for row, (color, marker) in LAWFUL.items():
        dots = sorted(
            (about["law"] / solvers.sag(solvers.SOLVERS[row], np.ones(2)), about["rest"])
            for name, about in rows[row].items()
            if name in names and about["law"] and about["rest"]
        )
        x, y = zip(*dots)
        lower.plot(x, y, color=color, marker=marker, ls="", ms=5.5, label=rows[row]["words"])
        law = [solvers.sag(solvers.SOLVERS[row], np.array([1.0, share])) for share in (2, 1000)]
        lower.plot((2, 1000), law, color=color, lw=1.0)
    lower.set(xscale="log", yscale="log", ylim=(5e-5, 5.0), ylabel="overlap at rest [r]")
    lower.set_xlabel("mass on top of the lowest ball / its own mass")
    plotting.legend_below(lower, columns=2, down=0.2)
    return plotting.svg(figure, section)


def write(folder, sections):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    write_whole(folder / "README.md", page(sections))
    for name, text in figures(sections).items():
        write_whole(folder / name, text)
