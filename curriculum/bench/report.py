"""What was measured, for a reader: one page, few figures, and the README's block.

The words stand in page.md and readme.md, the numbers come from the CSV files alone.
"""

import csv
from functools import partial
from pathlib import Path

from contact import MANY, MODELS, STEPPED
from contact import shown as number
from curriculum import stored
from curriculum.bench import measure, problems
from curriculum.bench.engines import ENGINES, LABELS
from curriculum.bench.events import PHASES
from curriculum.bench.measure import BUDGETS, DEPTHS, WORK
from curriculum.commands import write_whole
from curriculum.show import picture

HERE = Path(__file__).parent
RIVAL = "events"
PEERS = [name for name in ENGINES if name != RIVAL]
LEAST = 1e-16  # r: an error of exactly zero is drawn here
DRAWN = "slide", "bounce", "pile"  # the problems with a picture of their own
CONTESTS = {f"{work} substep{'s' * (work > 1)} in 2 ms": dict(work=work) for work in WORK}
CONTESTS |= {f"{us} µs a ball and 2 ms": dict(budget=us) for us in BUDGETS}


def cell(p, named=False):
    """Error and time of a point, for a reader, and whose it is."""
    if p is None:
        return "-"
    error = "reference" if p["error"] is None else f"{number(p['error'])} r"
    return f"{LABELS[p['engine']] + ' ' if named else ''}{error}, {number(p['ms'])} ms"


def resting(row):
    """Engine, setting as one types it, and time of a step of a pile at rest."""
    cut = f", {row['substeps']} x" if row and row["substeps"] > 1 else ""
    called = f"{LABELS[row['engine']]} {row['setting']}".strip() if row else ""
    return f"{called}{cut}: {number(row['resting'])} µs" if row else "-"


def contest(rows, **limit):
    """{problem: {engine: its best point}}; the reference stands in it, though it has no error."""
    found = measure.best_points(rows, **limit)
    for p in rows:
        if p["engine"] == "exact":
            found.setdefault(p["problem"], {}).setdefault("exact", p)
    return {name: found[name] for name in problems.BY_NAME if name in found}


def best_of(found, side, key=measure.rank):
    """The best row of these engines, of {engine: row}; None where there is none."""
    return min((row for name, row in found.items() if name in side), key=key, default=None)


def loses(one, other):
    """Whether an error is larger than another, in three digits; of two that are measured."""
    return bool(one and other) and measure.rank(one)[0] > measure.rank(other)[0]


def beaten(found, side, model="leapfrog"):
    """{problem: (the model's point, the better one of a side)} where the model is beaten."""
    pairs = {name: (each.get(model), best_of(each, side)) for name, each in found.items()}
    return {name: pair for name, pair in pairs.items() if loses(*pair)}


def races(rows):
    """(balls, depth, our fastest row, leapfrog's, the fastest other engine's) of piles at rest."""
    fast = partial(best_of, key=lambda row: row["resting"])
    for depth in DEPTHS:
        for count, found in measure.fastest(rows, depth).items():
            yield count, depth, fast(found, MODELS), found.get("leapfrog"), fast(found, ENGINES)


# claims


def claims(rows):
    """What leapfrog and exact are beside named opponents, at every limit; losses are named."""
    side = [name for name in PEERS if any(p["engine"] == name for p in rows)]
    *first, last = (LABELS[name] for name in side) if side else ("nobody",)
    where = []
    for words, limit in CONTESTS.items():
        found = contest(rows, **limit)
        fields, lost = sum("leapfrog" in each for each in found.values()), beaten(found, side)
        but = f" (not {', '.join(lost)})" if lost else ""
        where += [f"in {fields - len(lost)} of {fields} with at most {words}{but}"] * (fields > 0)
    yield (
        f"Beside {', '.join(first)} and {last}, each by its most accurate setting, leapfrog is as "
        f"accurate or more {', '.join(where)}."
    )
    yield from rivalry(contest(rows))


def rivalry(found):
    """The event-driven code beside leapfrog and exact, and beside every reference."""
    both = [each for each in found.values() if {"exact", RIVAL} <= set(each)]
    if not both:
        return
    ratios = sorted(each[RIVAL]["ms"] / each["exact"]["ms"] for each in both)
    lost = beaten(found, [RIVAL])
    most, worst = (max(each[RIVAL][key] for each in both) for key in ("error", "error_max"))
    yield (
        "A code that goes from event to event, scipy's solve_ivp over a loop of contacts, is more "
        f"accurate than leapfrog in {len(lost)} of {len(found)} ({', '.join(lost)}). It takes "
        f"{number(ratios[0])} to {number(ratios[-1])} times as long as exact, and agrees with "
        f"every reference, exact or a closed form, to {number(most)} r in the median start; in the "
        f"worst start it is off by {number(worst)} r (after {PHASES:,} events it gives up)."
    )


def pile_claims(rows):
    """How fast piles rest, beside the fastest other engine at equal depth."""
    for words, which in (("the fastest of our models", 2), ("leapfrog", 3)):
        ratios = {f"{race[0]:,} balls, {race[1]:g} r": race[which]["resting"] / race[4]["resting"]
                  for race in races(rows) if race[which] and race[4]}  # fmt: skip
        if ratios:
            most, least = max(ratios, key=ratios.get), number(min(ratios.values()))
            yield (
                f"At rest and at equal depth, a step of {words} takes {least} to "
                f"{number(ratios[most])} ({most}) of the fastest other engine's time."
            )


def steadiness(rows):
    """How far times differ between processes."""
    spans = sorted(100.0 * (p["ms_max"] / p["ms_min"] - 1.0) for p in rows if p["ms"]) or [0.0]
    usual, most = number(spans[len(spans) // 2]), number(spans[-1])
    return f"The greatest time of a point is {usual} % above its least (median; at most {most} %)."


def compiled(rows):
    """What the times of compiled models leave out."""
    taken = {row["process"]: row["seconds"] for row in rows}
    extra = taken.get("one compiled step", 0.0) - taken.get("import numpy", 0.0)
    return (
        f"numba costs {number(extra)} s the first time in a process, and "
        f"{number(taken.get('one compiled step, the first ever'))} s once on a machine. Where "
        f"steps times balls squared is below {MANY:,.0f}, run_model takes the plain loops, to the "
        "same bits."
    )


# tables


def take(points, piles):
    """Rows of the README's table: what one types, and gets, and would get elsewhere.

    A row that another one of the table beats in both error and time is not shown.
    """
    chosen, best = list(wanted((*points, *piles))), contest(points)
    for want, row in chosen:
        name, rivals = row.get("problem"), [other for _, other in chosen]
        if any(beats(other, row) for other in rivals if name and other.get("problem") == name):
            continue
        typed = "<br>".join(f"`{line}`" for line in want["type"].splitlines())
        if name:
            other = cell(best[name].get(RIVAL)), cell(best_of(best[name], PEERS), True)
            yield [want["wish"], typed, cell(row), *other]
            continue
        depth = min(d for d in DEPTHS if row["mean_depth"] <= d)
        other = next(r[4] for r in races(piles) if r[:2] == (row["bodies"], depth))
        mine = f"at most {depth:g} r deep, {number(row['resting'])} µs a step"
        yield [want["wish"], typed, mine, "-", resting(other)]


def wanted(rows):
    """(a line of take.csv, the row that was measured of it)"""
    keys = "engine", "setting", "substeps"
    with (HERE / "take.csv").open(encoding="utf-8", newline="") as file:
        for want in csv.DictReader(file):
            for row in rows:
                where = row.get("problem") or str(row.get("bodies"))
                same = where == want["problem"] and row.get("dt", measure.DT) == measure.DT
                if same and all(str(row[key]) == want[key] for key in keys):
                    yield want, row


def beats(one, other):
    """Whether a point is better than another in both error and time; the reference has no error."""
    return (one["error"] or 0.0) < (other["error"] or 0.0) and one["ms"] < other["ms"]


def winners(rows):
    """A row a problem: error and time of each; the winner of leapfrog and the best other bold."""
    for name, found in contest(rows).items():
        mine, other = found.get("leapfrog"), best_of(found, PEERS)
        cells = [cell(found.get(who)) for who in ("exact", RIVAL, "leapfrog", "lcp")]
        cells.append(cell(other, True))
        won = 4 if loses(mine, other) else 2
        cells[won] = f"**{cells[won]}**"
        yield [f"{name}: {problems.BY_NAME[name].title}", *cells]


def losses(rows):
    """A row for each limit: where leapfrog is beaten by another engine, and by the rival."""
    for words, limit in CONTESTS.items():
        found, texts = contest(rows, **limit), []
        fields = sum("leapfrog" in each for each in found.values())
        for side in (PEERS, [RIVAL]):
            lost = (f"{name} ({number(mine['error'])} r, {cell(peer, True)})"
                    for name, (mine, peer) in beaten(found, side).items())  # fmt: skip
            texts.append("; ".join(lost) or ("nowhere" if fields else "a step of it counts two"))
        yield [words, fields, *texts]


def falling(rows):
    """A row an engine: how long a step takes while a pile falls, by its fastest setting."""
    least = {}
    for row in rows:
        key = row["engine"], row["bodies"]
        least[key] = min(least.get(key, row["falling"]), row["falling"])
    for engine in dict.fromkeys(row["engine"] for row in rows):
        counts = (*measure.SIZES, measure.MANY)
        yield [LABELS[engine], *(number(least.get((engine, count))) for count in counts)]


def lines(rows):
    """The rows of a Markdown table."""
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def written(name, sections, made):
    """page.md or readme.md with everything filled in."""
    points, piles, processes = (sections.get(part, ()) for part in measure.PARTS)
    about = made.get("points", {"versions": {}})
    there = (f"{row[1]} {about['versions'].get(row[1], 'not there')}" for row in ENGINES.values())
    resters = ([f"{race[0]:,}", f"{race[1]:g}", *map(resting, race[2:])] for race in races(piles))
    taken = ([row["process"], *(number(row[f"seconds{k}"]) for k in ("", "_min", "_max"))]
             for row in processes)  # fmt: skip
    return (HERE / name).read_text("utf-8").format(
        work=WORK[-1],
        stepped=", ".join(STEPPED),
        compiled=compiled(processes),
        machine=f"{about.get('cores')} cores of {about.get('cpu')}, with {', '.join(there)}",
        claims=" ".join(claims(points)),
        piles=" ".join(pile_claims(piles)),
        steadiness=steadiness(points),
        take=lines(take(points, piles)),
        winners=lines(winners(points)),
        losses=lines(losses(points)),
        races=lines(resters),
        falling=lines(falling(piles)),
        processes=lines(taken),
        origins="\n".join(f"- {part}: {stored.footer(each)}"
                          for part, each in made.items()),
    )  # fmt: skip


# figures


def front(dots):
    """The dots that no other one beats in both x and y."""
    found = []
    for x, y in sorted(dots):
        if not found or y < found[-1][1]:
            found.append((x, y))
    return found


def error_figure(rows, problem, about):
    """Time against error: the front of all settings and steps of each engine."""
    figure, (axis,) = picture.figure(
        height=3.4, below=0.8, title=f"{problem.capitalize()}: {problems.BY_NAME[problem].title}",
        explained="Left and down is better. A line joins what no other setting or step of the same "
        "engine beats in both error and time.",
    )  # fmt: skip
    for engine in LABELS:
        dots = [(max(p["error"], LEAST), p["ms"]) for p in rows
                if (p["engine"], p["problem"], p["diverged"]) == (engine, problem, 0)
                and p["error"] is not None]  # fmt: skip
        if dots:
            picture.line(axis, *zip(*front(dots)), engine, LABELS[engine])
    axis.set(xscale="log", yscale="log", xlabel="worst position error [r]")
    axis.set_ylabel(f"time for {problems.BY_NAME[problem].duration:g} s of motion [ms]")
    axis.set_xlim(None, min(axis.get_xlim()[1], 30.0))
    picture.legend_below(axis, columns=4, down=0.2)
    return picture.svg(figure, {"measured": about})


def ratio_figure(rows, about):
    """Time over error of leapfrog and exact beside the best other engine's, a dot a problem."""
    figure, (axis,) = picture.figure(
        height=3.4, below=0.4, title="Beside the best other engine, at most 16 substeps in 2 ms",
        explained="A dot is a problem: error and time, as shares of the most accurate other "
        "engine's. Left and down of the cross both are smaller.",
    )  # fmt: skip
    for model in ("exact", "leapfrog"):
        dots = []
        for name, found in contest(rows).items():
            mine, other = found.get(model), best_of(found, PEERS)
            if mine and other and mine["error"] is not None:
                dots.append((max(mine["error"], LEAST) / other["error"], mine["ms"] / other["ms"]))
                axis.annotate(name, dots[-1], (4, 2), textcoords="offset points", fontsize=7)
        if dots:
            picture.line(axis, *zip(*dots), model, ls="")
    for line in (axis.axhline, axis.axvline):
        line(1.0, color=picture.PALE, lw=0.8)
    axis.set(xscale="log", yscale="log", xlabel="error / the best other's")
    axis.set_ylabel("time / the best other's")
    picture.legend_below(axis, columns=2, down=0.2)
    return picture.svg(figure, {"measured": about})


def write(folder, sections, made):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    files, rows = {"README.md": written("page.md", sections, made)}, sections.get("points", ())
    if rows:
        files["ratios.svg"] = ratio_figure(rows, made["points"])
    for name in [name for name in DRAWN if any(p["problem"] == name for p in rows)]:
        files[f"error-{name}.svg"] = error_figure(rows, name, made["points"])
    for name, content in files.items():
        write_whole(folder / name, content)
