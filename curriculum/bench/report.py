"""What was measured, for a reader: tables, figures, the README's block.

All of it is made from results.json alone, so that the same results give the same text.
"""

from contact import MODELS
from contact import shown as number
from curriculum.bench import accuracy, piles, problems
from curriculum.bench.accuracy import BUDGET, WORK
from curriculum.bench.engines import ENGINES, LABELS
from curriculum.commands import write_whole
from curriculum.measured import results
from curriculum.show import picture

TRIED = (  # as the author of each engine would
    "Tried as their authors would: MuJoCo with its own soft contact, stiff by a time constant, and "
    "direct for restitution, with and without a push, speculative; pymunk with 10 to 100 "
    "iterations, pushes of 0.2 and 1 in 2 ms, a slop of 1e-6 to 1e-10 m; Box2D at 30 to 480 Hz and "
    "hardest, with 1 to 64 substeps, in worlds 1 to 1,000 times as large; all three begun half a "
    "step off, which makes their flight exact; Drake's discrete solver, CENIC at accuracies of "
    "1e-3 to 1e-9, stiffness 1e8 to 1e12, dissipation 100 and 1,000, read by its dense output and "
    "cut at each look, and RK3, to 1e14. Tried, and no better: MuJoCo's RK4, implicitfast and "
    "discrete integrators, other time constants. Drake's Radau integrators mostly took more than "
    "25 s a run; in slide one came to 4.8e-5 r in 380 ms."
)
OURS = "leapfrog"  # the model that the contest is about
NEVER = "never beaten"
LEAST = 1e-17  # r: an error of exactly zero is drawn here
CONTESTS = {  # words: limits of accuracy.allowed
    f"at equal work, at most {WORK} substeps in 2 ms": {},
    f"in equal time, {BUDGET} µs a ball and 2 ms": dict(budget=BUDGET),
}


def text(value):
    """A number, words, yes or no, or a median with its spread, for a reader."""
    if isinstance(value, dict):
        median, least, most = (number(value[which]) for which in ("median", "min", "max"))
        return f"{median} ({least} to {most})"
    if isinstance(value, bool):
        return "yes" if value else "**no**"
    return value if isinstance(value, str) else number(value)


def table(rows, **columns):
    """A Markdown table of dicts; columns: {head: what stands there}, a key or a function."""
    shown = [[text(of(r) if callable(of) else r.get(of)) for of in columns.values()] for r in rows]
    return results.table(list(columns), shown)


def called(row):
    """Family and setting of a row, for a reader."""
    return f"{LABELS[row['family']]}: {row['words']}"


def points_of(section, problem):
    return [p for p in accuracy.unpacked(section["points"]) if p["problem"] == problem]


def duel(found, ours=(OURS,), rank=accuracy.rank):
    """The best row of ours and of the other engines, of {family: row}; None where there is none."""
    peers = set(found).difference(MODELS)
    return [
        min((row for name, row in found.items() if name in side), key=rank, default=None)
        for side in (ours, peers)
    ]


def duels(section):
    """{words of a contest: {problem: (our best point, the best other engine's)}}."""
    points = accuracy.unpacked(section["points"])
    return {
        words: {name: duel(each) for name, each in accuracy.headline(points, **limit).items()}
        for words, limit in CONTESTS.items()
    }


def loses(one, other):
    """Whether an error is larger than another, in three digits; of two that are measured."""
    return bool(one and other) and accuracy.rank(one)[0] > accuracy.rank(other)[0]


def races(section):
    """(balls, depth, our fastest row, the fastest other engine's, leapfrog's) of piles at rest."""
    for depth in piles.DEPTHS:
        for count, found in piles.fastest(section["rows"], depth).items():
            ours, other = duel(found, MODELS, piles.time_at_rest)
            yield count, depth, ours, other, found.get(OURS)


def lost_in(found):
    """The problems in which another engine is more accurate, with the errors."""
    return [
        f"{name} ({number(mine['error'])} r, {LABELS[peer['family']]} {number(peer['error'])} r)"
        for name, (mine, peer) in found.items()
        if loses(mine, peer)
    ]


# pages


def readme(sections):
    """The block of the project's README: what to take, how it was measured, what is lost."""
    parts = ["![Run time against error: slide](curriculum/bench/results/error-slide.svg)"]
    if section := sections.get("accuracy"):
        about = section["measured"]
        modules = [engine[1] for engine in ENGINES.values()]
        versions = [f"{name} {about['versions'].get(name, '-')}" for name in modules]
        head = ["you want", "take", "you get", "the best other engine"]
        parts += [
            results.table(head, [*choices(section), *rest_rows(sections.get("pile"))]),
            "An error is the worst distance of a ball from where it should be, in radii, with its "
            "CPU time for the whole run; both are medians. The other engines may be any of their "
            f"settings with up to {WORK} substeps in 2 ms, Drake's steps as it chose them, every "
            "ball awake; ours are compiled. leapfrog solves twice a step, so its substeps count "
            "twice. Most problems are parabolas between contacts, where it has no error by "
            "construction: slide, spread and glance show its order. Nothing here has friction or "
            "rotation, which the other engines are made for. On "
            f"{about['cores']} cores of {about['cpu']}, with {', '.join(versions)}.",
            losses(sections),
        ]
    everything = (
        "Everything, with settings and spread: [results](curriculum/bench/results/README.md)."
    )
    return "\n\n".join((*parts, everything))


WISHES = (  # what somebody wants, problems that ask for it, model, words of its setting
    ("a fall, a landing, bounces", ("drop", "bounce", "elastic"), "leapfrog", "20 sweeps"),
    ("balls that slide over one another", ("slide", "spread", "glance"), "leapfrog", "20 sweeps"),
    ("stacks and towers, at once", ("stack", "tower"), "leapfrog", "20 sweeps"),
    ("heavy on light, towers, to the end", ("heavy_100", "heavy_1000", "tower"), "leapfrog",
     "solved, at most 1000 sweeps"),
    ("piles that fall", ("pile", "pile_bounce"), "leapfrog", "20 sweeps, 8 x"),
    ("the answer itself", ("bounce", "slide", "tower"), "exact", "event to event"),
)  # fmt: skip


def choices(section):
    """Rows of the README's table: the worst of these problems, with one setting in all of them."""
    found = next(iter(duels(section).values()))  # at equal work
    usual = [p for p in accuracy.unpacked(section["points"]) if p["dt"] == problems.REFERENCE_DT]
    for wish, names, *who in WISHES:
        wanted = [p for p in usual if [p["family"], p["words"]] == who and p["problem"] in names]
        if wanted:
            p = max(wanted, key=lambda p: p["error"])
            peer = found.get(p["problem"], (None, None))[1]
            yield [wish, ", ".join(who), f"{cell(p)} ({p['problem']})", cell(peer)]


def cell(p, won=False):
    """Error and time of a point, for a reader, and whose it is of other engines; bold if it won."""
    if p is None:
        return "-"
    who = f"{LABELS[p['family']]} " * (p["family"] not in MODELS)
    error = "reference" if p["error"] is None else f"{number(p['error'])} r"
    words = f"{who}{error}, {number(p['ms']['median'])} ms"
    return f"**{words}**" if won else words


def losses(sections):
    """Sentences that say where another engine is more accurate, and how fast piles rest."""
    lines = []
    for words, found in duels(sections["accuracy"]).items():
        lost = lost_in(found)
        where = f"beaten in {len(lost)} of {len(found)}: {'; '.join(lost)}" if lost else NEVER
        lines.append(f"{words[0].upper()}{words[1:]}, {OURS} is {where}.")
    shares = [[], []]
    for *_, ours, other, leapfrog in races(sections["pile"]) if "pile" in sections else ():
        for share, mine in zip(shares, (ours, leapfrog)):
            if mine and other:
                share.append(piles.time_at_rest(mine) / piles.time_at_rest(other))
    if all(shares):
        ours, leapfrog = (f"{number(min(each))} to {number(max(each))}" for each in shares)
        lines.append(
            f"Piles at rest, at equal depth, take our fastest model {ours} of the fastest other "
            f"engine's time, leapfrog {leapfrog}."
        )
    return " ".join(lines)


def contest_rows(section):
    """For each problem exact, and in each contest our model and the best peer; the winner bold."""
    contests = duels(section).values()
    for p in accuracy.unpacked(section["points"]):
        if p["family"] == "exact":
            row = [p["problem"], cell(p)]
            for found in contests:
                mine, peer = found.get(p["problem"], (None, None))
                row += [
                    bold(cell(mine), not loses(mine, peer)),
                    bold(cell(peer), loses(mine, peer)),
                ]
            yield row


def bold(words, yes):
    return f"**{words}**" if yes else words


def rest_rows(section):
    """The README's row on piles: 1,000 balls at rest, at the smaller depth that was asked for."""
    for count, depth, ours, other, _ in races(section) if section else ():
        if (count, depth) == (1000, min(piles.DEPTHS)) and ours and other:
            us, who = (number(piles.time_at_rest(row)) for row in (ours, other))
            words = f"{ours['family']}, {ours['words']}"
            got = f"at most {depth:g} r deep, {us} µs a step"
            yield ["1,000 balls at rest, fast", words, got, f"{LABELS[other['family']]} {who} µs"]


def page(sections):
    """README.md of the results folder: who wins, and every table."""
    parts = ["# Run time against error", "Written by `python -m curriculum.bench`; do not edit."]
    if section := sections.get("accuracy"):
        head = [f"{who}, {when}" for when in CONTESTS for who in (OURS, "best other")]
        parts.append(results.table(["", "exact", *head], contest_rows(section)))
    for name, section in sections.items():
        parts += [*PARTS[name](section), results.footer(section)]
    return "\n\n".join(parts) + "\n"


def accuracy_part(section):
    yield (
        "An error is the median over several starts, a time the median over fresh processes "
        "(CPU time, one thread; least to greatest). Everyone is looked at alike: every height, "
        "every 2 ms; `16 x` are sixteen steps between two looks. Everyone takes every step, and no "
        "ball sleeps. Our models are compiled but where the words say Python; compiling "
        "is not counted (see the piles). pymunk, Box2D and Drake have no loop of their own and are "
        "called from Python, which costs up to a microsecond a call. leapfrog solves twice a step, "
        "so a step of it counts as two substeps. Drake under error control takes as many steps as "
        "it needs, whose mean counts; of its discrete solver, which is slow, there is one start "
        "and one process. Engines in float32 are right to about 1e-6 r, the closed forms to 1e-12 "
        f"r; of piles, spread and glance `exact` is the reference. {TRIED} Left out: PyBullet, "
        "whose restitution depends on the step; Box2D 2.3, which version 3 replaces; Siconos and "
        "Rapier, which have no package here. A better setting? Add a line to SETTINGS in "
        "[settings.py](../settings.py) and send it."
    )
    yield from (f"Not everywhere: {label}, {why}." for label, why in section["left_out"].items())
    for name, about in section["problems"].items():
        yield f"## {about['title']}\n\nHard on: {about['stresses']}."
        yield f"![Run time against error: {name}](error-{name}.svg)"
        yield contests(points_of(section, name), name)


def contests(points, problem):
    """The best of each family with ever more work, and in ever more time."""
    limits = {f"{work} substeps": dict(work=work) for work in (1, 4, WORK)}
    limits |= {f"{us} µs": dict(budget=us) for us in accuracy.BUDGETS}
    found = {head: accuracy.headline(points, **each) for head, each in limits.items()}
    rows = {}
    for head, each in found.items():
        for family, p in each.get(problem, {}).items():
            best = f"{number(p['error'])} ({p['words']}, {1e3 * p['dt']:g} ms)"
            rows.setdefault(family, {"name": LABELS[family]})[head] = best
    heads = {head: head for head in limits}
    return table(rows.values(), **{"least error / r within": "name"}, **heads)


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
        "there. An engine that does not come to rest there has a row, and is compared with nobody."
    )
    yield "![Time a step against depth](settled.svg)"
    for count in dict.fromkeys(row["bodies"] for row in section["rows"]):
        yield table(
            [row for row in section["rows"] if row["bodies"] == count],
            **{f"{count:,} balls": called, "at rest": "at_rest", "fastest ball [m/s]": "speed"},
            **{"mean depth / r": "mean_depth", "worst": "worst_depth"},
            **{"settled [µs a step]": "resting", "falling [µs a step]": "falling"},
        )


def skip_part(section):
    yield "## What a whole process takes"
    yield table(
        [about | dict(name=name) for name, about in section["processes"].items()],
        **{"whole process": "name", "seconds": text, "times its import": "ratio"},
        **{"by the least times": "least"},
    )


PARTS = {"accuracy": accuracy_part, "pile": pile_part, "skip": skip_part}


# figures


def draw(axis, family, dots, label):
    """Dots (x, y, whether it counts), faint, hollow where not; a line through the best of them."""
    faint = dict(picture.look(family), marker="o", ls="", alpha=0.4, markersize=3.5)
    for counts, fill in ((True, faint["color"]), (False, "none")):
        axis.plot(
            *zip(*[dot[:2] for dot in dots if dot[2] == counts] or [((), ())]), **faint, mfc=fill
        )
    front = []
    for x, y, counts in sorted(dots):
        if counts and (not front or y < front[-1][1]):
            front.append((x, y))
    picture.line(axis, [x for x, _ in front], [y for _, y in front], family, label)


def error_figure(section, problem):
    """Time against error: every setting a faint dot, the best of each family a line."""
    about, families, points = section["problems"][problem], {}, points_of(section, problem)
    named = accuracy.headline(points).get(problem, {})
    for p in points:
        if not p["diverged"] and (p["error"] is not None or p["family"] == "exact"):
            dot = max(p["error"] or 0, LEAST), p["ms"]["median"], True
            families.setdefault(p["family"], []).append(dot)
    figure, (axis,) = picture.figure(
        height=3.7,
        below=1.5,
        title=about["title"],
        explained="Left and down is better. A faint dot is one setting at one step; "
        "a line joins the best of a family, whose best at equal work is named. "
        "16 x: sixteen steps from look to look.",
    )
    for family, dots in families.items():
        draw(axis, family, dots, called(named[family]) if family in named else LABELS[family])
    axis.set(xscale="log", yscale="log", xlabel="worst position error [r]")
    axis.set_ylabel(f"time for {about['duration']:g} s of motion [ms]")
    axis.set_xlim(None, min(axis.get_xlim()[1], 30.0))
    below = dict(loc="lower left", bbox_to_anchor=(0.0, 0.22 / figure.get_figheight()))
    figure.legend(**below, borderaxespad=0, handlelength=3.2, fontsize=9)
    return picture.svg(figure, section)


def pile_figure(section):
    """Time a step against depth, a panel for each size; a setting that does not rest is hollow."""
    counts = list(dict.fromkeys(row["bodies"] for row in section["rows"]))
    figure, axes = picture.figure(
        rows=len(counts),
        height=2.6,
        below=0.65,
        title="Piles at rest: time a step against depth",
        explained="Left and down is better. A dot is a setting, hollow where balls are still "
        "moving; a line joins the best of an engine at rest.",
    )
    every = [row for row in section["rows"] if row["mean_depth"]]
    deep = [max(row["mean_depth"], 1e-9) for row in every]
    for axis, count in zip(axes, counts):
        for engine in dict.fromkeys(row["family"] for row in every):
            dots = [
                (x, piles.time_at_rest(row), row["at_rest"])
                for x, row in zip(deep, every)
                if (row["bodies"], row["family"]) == (count, engine)
            ]
            draw(axis, engine, dots, LABELS[engine])
        axis.set(xscale="log", yscale="log", title=f"{count:,} balls", ylabel="time a step [µs]")
        axis.set_xlim(min(deep) / 1.5, max(deep) * 1.5)
    axes[-1].set_xlabel("mean depth of the overlapping contacts [r]")
    picture.legend_below(axes[-1], columns=4, down=0.24)
    return picture.svg(figure, section)


def write(folder, sections):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    made, section = {"README.md": page(sections)}, sections.get("accuracy", {"problems": ()})
    made |= {f"error-{name}.svg": error_figure(section, name) for name in section["problems"]}
    if "pile" in sections:
        made["settled.svg"] = pile_figure(sections["pile"])
    for name, content in made.items():
        write_whole(folder / name, content)
