"""What was measured, for a reader: goals met and missed, tables, figures, the README's block.

All of it is made from results.json alone, so that the same results give the same text.
"""

import math

from contact import MODELS
from contact import shown as number
from curriculum.bench import accuracy, piles, problems, skips
from curriculum.bench.accuracy import BUDGET, LABELS, WORK
from curriculum.measured import results
from curriculum.measured.results import table
from curriculum.run import plotting

TRIED = (  # as the author of each engine would
    "Tried as their authors would: MuJoCo with its own soft contact, stiff by a time constant, and "
    "direct for restitution, with and without a push, speculative; pymunk with 10 to 100 "
    "iterations and pushes of 0.2 and 1 in 2 ms; Box2D at 30, 240 and 480 Hz and hardest, with 1 "
    "to 64 substeps, in worlds 1, 10, 100 and 1,000 times as large; Drake's discrete solver, CENIC "
    "at accuracies of 1e-3 to 1e-9, stiffness 1e8 and 1e10, dissipation 100 and 1,000, read by its "
    "dense output and cut at each look, and RK3."
)
EVERYTHING = "Everything, with settings and spread: [results](curriculum/bench/results/README.md)."
OURS = "leapfrog"  # the model that the contest is about
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
        for p in points_of(section, problem):
            if p["family"] == "exact" and p["error"] is not None and not p["diverged"]:
                wanted = f"exact: at most {TINY:g} r off"
                yield wanted, problem, f"{number(p['error'])} r", p["error"] <= TINY
    for contest, words in EQUAL.items():
        for problem, found in section[contest].items():
            if (mine := found.get(OURS)) and (peer := best_peer(found)):
                wanted = f"{OURS} {words}: no less accurate than any other engine"
                yield wanted, problem, against(mine, peer), beats(mine, peer)


def against(mine, peer):
    """Two errors, for a reader."""
    return f"{number(mine['error'])} r, {LABELS[peer['family']]} {number(peer['error'])} r"


def pile_goals(section):
    wanted = f"piles at rest, compiled: at most {SHARE} of the fastest other engine's time"
    for count, depths in sorted(section["best"].items(), key=lambda each: int(each[0])):
        for depth, found in depths.items():
            case = f"{int(count):,} balls, {depth} r"
            if found["ratio"] is None:
                ours = any(name in MODELS for name in found["engines"])
                yield wanted, case, f"{'no other' if ours else 'other'} engines get there", ours
            else:
                yield wanted, case, number(found["ratio"]), found["ratio"] <= SHARE


def skip_goals(section):
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
    """The block of the project's README: what to take, how it was measured, what is lost."""
    parts = ["![Run time against error: slide](curriculum/bench/results/error-slide.svg)"]
    if section := sections.get("accuracy"):
        about = section["measured"]
        modules = [engine[1] for engine in accuracy.engines.ENGINES.values()]
        versions = [f"{name} {about['versions'].get(name, '-')}" for name in modules]
        head = ["you want", "take", "you get", "the best other engine"]
        parts += [
            table(head, [*choices(section), *rest_rows(sections.get("pile"))]),
            "An error is the worst distance of a ball from where it should be, in radii, with its "
            "CPU time for the whole run; both are medians. The other engines may be any of their "
            f"settings with up to {WORK} substeps in 2 ms, Drake's steps as it chose them, every "
            "ball awake; ours are compiled. leapfrog solves twice a step. Most problems are "
            "parabolas between contacts, where it has no error by construction: slide, spread and "
            "glance show its order. Nothing here has friction or rotation, which the other engines "
            f"are made for. On {about['cores']} cores of {about['cpu']}, with "
            f"{', '.join(versions)}.",
            losses(section),
        ]
    return "\n\n".join((*parts, EVERYTHING))


WISHES = (  # what somebody wants, problems that ask for it, model, words of its setting
    ("a fall, a landing, bounces", ("drop", "bounce", "elastic"), "leapfrog", "20 sweeps"),
    ("balls that slide over one another", ("slide", "spread", "glance"), "leapfrog", "20 sweeps"),
    ("stacks and towers, at once", ("stack", "tower"), "leapfrog", "20 sweeps"),
    ("heavy on light, towers, to the end", ("heavy_100", "heavy_1000", "tower"), "leapfrog",
     "solved, at most 1000 sweeps"),
    ("piles that fall", ("pile", "pile_bounce"), "leapfrog", "20 sweeps, 16 x"),
    ("the answer itself", ("bounce", "slide", "tower"), "exact", "event to event"),
)  # fmt: skip


def choices(section):
    """Rows of the README's table: the worst of these problems, with one setting in all of them."""
    for wish, names, family, setting in WISHES:
        found = [
            (p, best_peer(section["headline"].get(name, {})))
            for name in names
            for p in points_of(section, name)
            if (p["family"], p["words"], p["dt"]) == (family, setting, problems.REFERENCE_DT)
            and p["error"] is not None
        ]
        if found:
            p, peer = max(found, key=lambda each: each[0]["error"])
            got = f"{number(p['error'])} r, {number(p['awake_median'])} ms ({p['problem']})"
            who = "-"
            if peer:
                who = f"{LABELS[peer['family']]} {number(peer['error'])} r, {number(peer['ms'])} ms"
            yield [wish, f"{family}, {setting}", got, who]


def losses(section):
    """One sentence for each contest: where another engine is more accurate."""
    lines = []
    for contest, words in EQUAL.items():
        found = section[contest]
        lost = {name: (f[OURS], best_peer(f)) for name, f in found.items() if OURS in f}
        lost = {name: pair for name, pair in lost.items() if pair[1] and not beats(*pair)}
        cells = "; ".join(f"{name} ({against(*pair)})" for name, pair in lost.items())
        where = f"is beaten in {len(lost)} of {len(found)}: {cells}" if lost else "is never beaten"
        lines.append(f"{words[0].upper()}{words[1:]}, {OURS} {where}.")
    return " ".join(lines)


def contest_rows(section):
    """For each problem the worst error [r] and time [ms] of exact, our model and the best peer."""

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
            mine, peer = found.get(OURS), best_peer(found)
            row += [cell(found.get("lcp")), cell(mine, beats(mine, peer))]
            row += [cell(peer, beats(peer, mine))]
        yield row


def rest_rows(section):
    """The README's row on piles: 1,000 balls at rest, at the smaller depth that was asked for."""
    found = ((section or {}).get("best") or {}).get("1000", {}).get(f"{min(piles.DEPTHS):g}")
    if found:
        us = {name: about["us"] for name, about in found["engines"].items()}
        mine = min((name for name in us if name in MODELS), key=us.get, default=None)
        fast = min((name for name in us if name not in MODELS), key=us.get, default=None)
        if mine:
            words = f"{mine}, {found['engines'][mine]['words']}"
            deep = f"at most {min(piles.DEPTHS):g} r deep"
            other = f"{piles.LABELS[fast]} {number(us[fast])} µs" if fast else "-"
            wish = "1,000 balls at rest, fast"
            yield [wish, words, f"{deep}, {number(us[mine])} µs a step", other]


def page(sections):
    """README.md of the results folder: goals, and every table."""
    verdict = {True: "met", False: "**missed**"}
    head = ["goal", "case", "measured", ""]
    rows = [[*row, verdict[met]] for *row, met in goals(sections)]
    parts = ["# Run time against error", "Written by `python -m curriculum.bench`; do not edit."]
    if section := sections.get("accuracy"):
        whos = [f"{who}, {when}" for when in ("equal work", "equal time")
                for who in ("lcp", OURS, "best other")]  # fmt: skip
        parts.append(table(["", "exact", *whos], contest_rows(section)))
    parts.append(table(head, rows))
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
        "the closed forms to 1e-12 r; of piles, spread and glance `exact` is the reference. "
        f"{TRIED} Left out: "
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


def skip_part(section):
    yield "## What a whole process takes"
    yield table(
        ["whole process", "seconds", "times its import", "by the least times"],
        [
            [name, ranged(about), number(about.get("ratio")), number(about.get("least"))]
            for name, about in section["processes"].items()
        ],
    )


PARTS = {"accuracy": accuracy_part, "pile": pile_part, "skip": skip_part}


# figures


def figures(sections):
    """{file name: SVG text}."""
    made, section = {}, sections.get("accuracy", {"problems": ()})
    for name in section["problems"]:
        made[f"error-{name}.svg"] = error_figure(section, name)
    if "pile" in sections:
        made["settled.svg"] = pile_figure(sections["pile"])
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


def write(folder, sections):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    for name, text in {"README.md": page(sections), **figures(sections)}.items():
        results.write_page(folder, name, text)
