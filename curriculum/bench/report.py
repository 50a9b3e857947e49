"""What was measured, for a reader: one page, few figures, and the README's block.

All of it is made from the CSV files alone, so that the same results give the same text.
"""

import csv
from functools import partial
from pathlib import Path

from contact import MANY, MODELS, STEPPED
from contact import shown as number
from curriculum.bench import measure, problems
from curriculum.bench.engines import ENGINES, LABELS
from curriculum.bench.measure import BUDGETS, DEPTHS, WORK
from curriculum.commands import write_whole
from curriculum.measured import results
from curriculum.show import picture

RIVAL = "events"
PEERS = [name for name in ENGINES if name != RIVAL]
LEAST = 1e-16  # r: an error of exactly zero is drawn here
DRAWN = "slide", "bounce", "pile"  # the problems with a picture of their own
CONTESTS = {f"{work} substep{'s' * (work > 1)} in 2 ms": dict(work=work) for work in WORK}
CONTESTS |= {f"{us} µs a ball and 2 ms": dict(budget=us) for us in BUDGETS}
ENDS = "", "_min", "_max"
HOW = Path(__file__).with_name("how.md")  # how it was measured, and what was tried
TAKE = Path(__file__).with_name("take.csv")  # who wants what, and types which command


def called(row):
    """Engine and setting of a row, for a reader: the options as they are typed."""
    cut = f", {row['substeps']} x" if row["substeps"] > 1 else ""
    return f"{LABELS[row['engine']]} {row['setting']}".strip() + cut


def cell(p, named=False):
    """Error and time of a point, for a reader, and whose it is."""
    if p is None:
        return "-"
    error = "reference" if p["error"] is None else f"{number(p['error'])} r"
    return f"{LABELS[p['engine']] + ' ' if named else ''}{error}, {number(p['ms'])} ms"


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


def beaten(found, model, side):
    """{problem: (the model's point, the better one of a side)} where the model is beaten."""
    pairs = {name: (each.get(model), best_of(each, side)) for name, each in found.items()}
    return {name: pair for name, pair in pairs.items() if loses(*pair)}


# claims


def names(side):
    *first, last = (LABELS[name] for name in side)
    return f"{', '.join(first)} and {last}" if first else last


def losses(rows, model="leapfrog"):
    """A row for each limit: where a model is beaten by another engine, and by the rival."""
    for words, limit in CONTESTS.items():
        found, texts = contest(rows, **limit), []
        took_part = sum(model in each for each in found.values())
        for who in (PEERS, [RIVAL]):
            lost = (f"{name} ({number(mine['error'])} r, {cell(peer, True)})"
                    for name, (mine, peer) in beaten(found, model, who).items())  # fmt: skip
            texts.append("; ".join(lost) or ("nowhere" if took_part else "a step of it counts two"))
        yield [words, took_part, *texts]


def claim(rows):
    """What is claimed of leapfrog and exact, with opponents, limits and losses."""
    side = [name for name in PEERS if any(p["engine"] == name for p in rows)]
    where = []
    for words, limit in CONTESTS.items():
        found = contest(rows, **limit)
        fields, lost = (
            sum("leapfrog" in each for each in found.values()),
            beaten(found, "leapfrog", side),
        )
        if fields:
            but = f" (not {', '.join(lost)})" if lost else ""
            where.append(f"in {fields - len(lost)} of {fields} with at most {words}{but}")
    yield (
        f"Beside {names(side)}, each by its most accurate setting, leapfrog is as accurate or more "
        f"{', '.join(where)}."
    )
    yield from rivalry(contest(rows))


def rivalry(found):
    """Two sentences on the event-driven code, beside leapfrog and exact."""
    pairs = [
        (each["exact"], each[RIVAL]) for each in found.values() if {"exact", RIVAL} <= set(each)
    ]
    if not pairs:
        return
    ratios = [rival["ms"] / exact["ms"] for exact, rival in pairs]
    median, worst = (max(rival[key] for _, rival in pairs) for key in ("error", "error_max"))
    lost = beaten(found, "leapfrog", [RIVAL])
    yield (
        "A code that goes from event to event, scipy's solve_ivp over a loop of contacts, is more "
        f"accurate than leapfrog in {len(lost)} of {len(found)} ({', '.join(lost)}). It takes "
        f"{number(min(ratios))} to {number(max(ratios))} times as long as exact, and agrees with "
        f"every reference, exact or a closed form, to {number(median)} r (the worst start: "
        f"{number(worst)} r)."
    )


def steadiness(rows):
    """How far times differ between processes."""
    spans = sorted(p["ms_max"] / p["ms_min"] - 1.0 for p in rows)
    usual, most = (number(100.0 * span) for span in (spans[len(spans) // 2], spans[-1]))
    return f"The greatest time of a point is {usual} % above its least (median; at most {most} %)."


def races(rows):
    """(balls, depth, our fastest row, leapfrog's, the fastest other engine's) of piles at rest."""
    fast = partial(best_of, key=lambda row: row["resting"])
    for depth in DEPTHS:
        for count, found in measure.fastest(rows, depth).items():
            yield count, depth, fast(found, MODELS), found.get("leapfrog"), fast(found, ENGINES)


def resting(row):
    return f"{called(row)}: {number(row['resting'])} µs" if row else "-"


# pages


def take(sections):
    """Rows of the README's table: what one types, and gets, and would get elsewhere."""
    rows, rest = sections["accuracy"], sections.get("piles", ())
    with TAKE.open(encoding="utf-8", newline="") as file:
        for want in csv.DictReader(file):
            typed = "<br>".join(f"`{line}`" for line in want["type"].splitlines())
            key = want["engine"], want["setting"], int(want["substeps"])
            if want["problem"].isdecimal():
                yield from pile_row(rest, int(want["problem"]), key, want["wish"], typed)
                continue
            found = contest(rows).get(want["problem"], {})
            for p in rows:
                this = (p["engine"], p["setting"], p["substeps"]) == key and p["dt"] == measure.DT
                if this and p["problem"] == want["problem"]:
                    peers = cell(found.get(RIVAL)), cell(best_of(found, PEERS), True)
                    yield [want["wish"], typed, cell(p), *peers]


def pile_row(rows, count, key, wish, typed):
    """The row on a pile at rest: as deep as ours, the fastest other engine."""
    for row in rows:
        if row["bodies"] == count and (row["engine"], row["setting"], row["substeps"]) == key:
            depth = min([d for d in DEPTHS if row["mean_depth"] <= d], default=DEPTHS[0])
            other = best_of(measure.fastest(rows, depth).get(count, {}), PEERS,
                            lambda row: row["resting"])  # fmt: skip
            mine = f"at most {depth:g} r deep, {number(row['resting'])} µs a step"
            yield [wish, typed, mine, "-", resting(other)]


def readme(sections, made):
    """The block of the project's README: what to take, how it was measured, what is lost."""
    parts = ["![Run time against error: slide](curriculum/bench/results/error-slide.svg)"]
    if "accuracy" in sections:
        head = ["you want", "type", "you get", "the event-driven code", "the best other engine"]
        about = made["accuracy"]
        versions = (f"{row[1]} {about['versions'].get(row[1], 'not there')}"
                    for row in ENGINES.values())  # fmt: skip
        parts += [
            results.table(head, take(sections)),
            "An error is the worst distance of a ball from where it should be, in radii, with the "
            "CPU time of the run; both are medians. Others may be any of their settings with up to "
            f"{WORK[-1]} substeps in 2 ms, Drake's and the event-driven code's steps as they chose "
            f"them. {compiled(sections)} Nothing here has friction or rotation, which the engines "
            f"are made for. On {about['cores']} cores of {about['cpu']}, with "
            f"{', '.join(versions)}.",
            " ".join((*claim(sections["accuracy"]), *pile_claim(sections.get("piles", ())))),
        ]
    end = "Everything, with losses at every limit: [results](curriculum/bench/results/README.md)."
    return "\n\n".join((*parts, end))


def compiled(sections):
    """The line on what the times of leapfrog and lcp leave out."""
    taken = {row["process"]: row["seconds"] for row in sections.get("processes", ())}
    extra = taken.get("one compiled step", 0.0) - taken.get("import numpy", 0.0)
    return (
        f"{', '.join(STEPPED)} are compiled by numba, which costs {number(extra)} s the first "
        f"time in a process; where steps times balls squared is below {MANY:,.0f}, run_model "
        "takes the plain loops, to the same bits."
    )


def pile_claim(rows):
    """Sentences on how fast piles rest, beside the fastest other engine at equal depth."""
    for words, which in (("the fastest of our models", 2), ("leapfrog", 3)):
        ratios = {f"{race[0]:,} balls, {race[1]:g} r": race[which]["resting"] / race[4]["resting"]
                  for race in races(rows) if race[which] and race[4]}  # fmt: skip
        if ratios:
            most, least = max(ratios, key=ratios.get), number(min(ratios.values()))
            yield (
                f"At rest and at equal depth, a step of {words} takes {least} to "
                f"{number(ratios[most])} ({most}) of the fastest other engine's time."
            )


def page(sections, made):
    """README.md of the results folder: who wins, where not, and how it was measured."""
    parts = ["# Run time against error", "Written by `python -m curriculum.bench`; do not edit."]
    if rows := sections.get("accuracy"):
        parts += [
            "Worst error and time, of each its most accurate setting with at most "
            f"{WORK[-1]} substeps in 2 ms; the better of leapfrog and the best other in bold.",
            results.table(
                ["problem", "exact", "event-driven", "leapfrog", "lcp", "best other"], winners(rows)
            ),  # fmt: skip
            " ".join((*claim(rows), steadiness(rows))),
            "![Error and time beside the best other engine](ratios.svg)",
            "## Where leapfrog is beaten",
            results.table(
                ["at most", "problems", "by another engine", "by the event-driven code"],
                losses(rows),
            ),  # fmt: skip
            "## Work and precision",
            *(f"![Run time against error: {name}](error-{name}.svg)" for name in DRAWN),
            "\n".join(f"- {p.name}: {p.title}; {p.stresses}." for p in problems.PROBLEMS),
        ]
    if rows := sections.get("piles"):
        head = ["balls", "mean depth [r]", "our fastest", "leapfrog", "the fastest other engine"]
        table = [[f"{c:,}", f"{d:g}", *map(resting, each)] for c, d, *each in races(rows)]
        parts += ["## Piles at rest, a step of 2 ms", results.table(head, table)]
        parts += [" ".join(pile_claim(rows)), "![Time a step against depth](settled.svg)"]
        parts += [falling(rows)]
    if rows := sections.get("processes"):
        table = [[row["process"], *(number(row[f"seconds{k}"]) for k in ENDS)] for row in rows]
        parts += ["## Whole processes", results.table(["", "seconds", "least", "greatest"], table)]
    how = HOW.read_text("utf-8").strip()
    notes = (f"- {name}: {results.footer({'measured': about})}" for name, about in made.items())
    return "\n\n".join((*parts, "## How it was measured", how + "\n" + "\n".join(notes))) + "\n"


def winners(rows):
    """A row a problem: error and time of each; the winner of leapfrog and the best other bold."""
    for name, found in contest(rows).items():
        mine, other = found.get("leapfrog"), best_of(found, PEERS)
        won = loses(mine, other)
        cells = [cell(found.get(who)) for who in ("exact", RIVAL, "leapfrog", "lcp")]
        cells.append(cell(other, True))
        if mine and other:
            cells[4 if won else 2] = f"**{cells[4 if won else 2]}**"
        yield [name, *cells]


def falling(rows):
    """How long a step takes while a pile falls, of each engine at its fastest."""
    counts = list(dict.fromkeys(row["bodies"] for row in rows))
    engines = list(dict.fromkeys(row["engine"] for row in rows))
    table = []
    for engine in engines:
        least = [min((row["falling"] for row in rows
                      if (row["engine"], row["bodies"]) == (engine, count)), default=None)
                 for count in counts]  # fmt: skip
        table.append([LABELS[engine], *map(number, least)])
    return results.table(["falling, fastest [µs a step]", *(f"{c:,}" for c in counts)], table)


# figures


def front(dots):
    """The dots that no other one beats in both x and y."""
    found = []
    for x, y in sorted(dots):
        if not found or y < found[-1][1]:
            found.append((x, y))
    return found


def draw(axis, engine, dots, label):
    x, y = zip(*front(dots))
    picture.line(axis, x, y, engine, label)


def error_figure(rows, problem, about):
    """Time against error: the front of all settings and steps of each engine."""
    title = problems.BY_NAME[problem].title
    figure, (axis,) = picture.figure(
        height=3.4, below=0.8, title=title,
        explained="Left and down is better. A line joins what no other setting or step of the same "
        "engine beats in both error and time.",
    )  # fmt: skip
    for engine in LABELS:
        found = [(max(p["error"], LEAST), p["ms"]) for p in rows
                 if p["engine"] == engine and p["problem"] == problem
                 and not p["diverged"] and p["error"] is not None]  # fmt: skip
        if found:
            draw(axis, engine, found, LABELS[engine])
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
    axis.axhline(1.0, color=picture.PALE, lw=0.8)
    axis.axvline(1.0, color=picture.PALE, lw=0.8)
    axis.set(xscale="log", yscale="log", xlabel="error / the best other's")
    axis.set_ylabel("time / the best other's")
    picture.legend_below(axis, columns=2, down=0.2)
    return picture.svg(figure, {"measured": about})


def pile_figure(rows, about):
    """Time a step against depth, a panel for each size, of what rests."""
    counts = list(dict.fromkeys(row["bodies"] for row in rows))
    figure, axes = picture.figure(
        rows=len(counts), height=2.0, below=0.65, title="Piles at rest: time a step against depth",
        explained="Left and down is better. A line joins what no other setting of the same engine "
        "beats in both.",
    )  # fmt: skip
    still = [row for row in rows if row["at_rest"] and row["mean_depth"]]
    for axis, count in zip(axes, counts):
        for engine in LABELS:
            found = [(max(row["mean_depth"], 1e-9), row["resting"]) for row in still
                     if (row["bodies"], row["engine"]) == (count, engine)]  # fmt: skip
            if found:
                draw(axis, engine, found, LABELS[engine])
        axis.set(xscale="log", yscale="log", title=f"{count:,} balls", ylabel="time a step [µs]")
    axes[-1].set_xlabel("mean depth of the overlapping contacts [r]")
    picture.legend_below(axes[0], columns=4, down=0.24) if len(counts) == 1 else axes[-1].legend(
        *axes[0].get_legend_handles_labels(), loc="upper left", ncols=4, bbox_to_anchor=(-0.1, -0.3)
    )
    return picture.svg(figure, {"measured": about})


def write(folder, sections, made):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    files = {"README.md": page(sections, made)}
    if rows := sections.get("accuracy"):
        files["ratios.svg"] = ratio_figure(rows, made["accuracy"])
        for name in {p["problem"] for p in rows} & set(DRAWN):
            files[f"error-{name}.svg"] = error_figure(rows, name, made["accuracy"])
    if rows := sections.get("piles"):
        files["settled.svg"] = pile_figure(rows, made["piles"])
    for name, content in files.items():
        write_whole(folder / name, content)
