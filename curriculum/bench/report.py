"""What was measured, for a reader: one page, few figures, and the README's block.

The words stand in page.md, readme.md and claims.md, the numbers come from the CSV files alone.
"""

from operator import itemgetter

from contact import MANY, MODELS, STEPPED
from contact import shown as number
from curriculum import stored
from curriculum.bench import measure, problems
from curriculum.bench.engines import ENGINES, HERE, LABELS
from curriculum.bench.events import PHASES
from curriculum.bench.measure import BUDGETS, DEPTHS, DT, WORK, contest
from curriculum.commands import write_whole
from curriculum.show import picture

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
    if row is None:
        return "-"
    cut = f", {row['substeps']} x" if row["substeps"] > 1 else ""
    called = f"{LABELS[row['engine']]} {row['setting'] or ''}".strip()
    return f"{called}{cut}: {number(row['resting'])} µs"


def best_of(found, side, key=measure.rank):
    """The best row of these engines, of {engine: row}; None where there is none."""
    return min((row for name, row in found.items() if name in side), key=key, default=None)


def loses(one, other):
    """Whether an error is larger than another, in three digits; of two that are measured."""
    return bool(one and other) and measure.rank(one)[0] > measure.rank(other)[0]


def limits(points):
    """(limit, number of problems, where leapfrog is beaten by an engine, and by the rival)

    Where it is beaten: {problem: (leapfrog's point, the better one)}.
    """
    for words, limit in CONTESTS.items():
        found = contest(points, **limit)
        lost = [{name: (each.get("leapfrog"), best_of(each, side)) for name, each in found.items()}
                for side in (PEERS, [RIVAL])]  # fmt: skip
        lost = [{name: pair for name, pair in each.items() if loses(*pair)} for each in lost]
        yield words, sum("leapfrog" in each for each in found.values()), *lost


def races(rows):
    """(balls, depth, our fastest row, leapfrog's, the fastest other engine's) of piles at rest."""
    key = itemgetter("resting")
    for depth in DEPTHS:
        for count, found in measure.fastest(rows, depth).items():
            ours, other = (best_of(found, side, key) for side in (MODELS, ENGINES))
            yield count, depth, ours, found.get("leapfrog"), other


def claims(points, piles, processes):
    """The numbers of claims.md and page.md: leapfrog and exact beside named opponents, losses too;
    piles at rest; what compiled loops cost at first; how far times differ between processes."""
    there = {p["engine"] for p in points}
    *first, last = [LABELS[name] for name in PEERS if name in there] or ["nobody"]
    where = [f"in {fields - len(lost)} of {fields} with at most {words}"
             + f" (not {', '.join(lost)})" * bool(lost)
             for words, fields, lost, _ in limits(points) if fields]  # fmt: skip
    found = contest(points)
    both = [each for each in found.values() if {"exact", RIVAL} <= set(each)]
    ratios = [each[RIVAL]["ms"] / each["exact"]["ms"] for each in both]
    lost = [name for name, each in found.items() if loses(each.get("leapfrog"), each.get(RIVAL))]
    errors = ([each[RIVAL][key] for each in both] for key in ("error", "error_max"))
    usual, worst = (number(max(each, default=None)) for each in errors)
    spans = sorted(100.0 * (p["ms_max"] / p["ms_min"] - 1.0) for p in points if p["ms"]) or [0.0]
    taken = {row["process"]: row["seconds"] for row in processes}
    return dict(
        peers=f"{', '.join(first)} and {last}",
        where=", ".join(where),
        rival=f"{len(lost)} of {len(found)} ({', '.join(lost)})",
        longer=reach(ratios),
        usual_error=usual,
        worst_error=worst,
        phases=PHASES,
        our_piles=shares(piles, 2),
        leapfrog_piles=shares(piles, 3),
        numba=number(taken.get("one compiled step", 0.0) - taken.get("import numpy", 0.0)),
        first=number(taken.get("one compiled step, the first ever")),
        many=MANY,
        usual_span=number(spans[len(spans) // 2]),
        widest_span=number(spans[-1]),
    )


def reach(values):
    """From the least to the greatest, as text."""
    return f"{number(min(values, default=None))} to {number(max(values, default=None))}"


def shares(piles, which):
    """Times of a pile at rest over those of the fastest other engine, and where it is greatest."""
    ratios = {race[which]["resting"] / race[4]["resting"]: f"{race[0]:,} balls, {race[1]:g} r"
              for race in races(piles) if race[which] and race[4]}  # fmt: skip
    return f"{reach(ratios)} ({ratios.get(max(ratios, default=None))})"


def take(points, piles):
    """Rows of the README's table: what one types, and gets, and would get elsewhere.

    A row that another one of the table beats in both error and time is not shown.
    """
    chosen, best = list(wanted((*points, *piles))), contest(points)
    for want, row in chosen:
        typed = "<br>".join(f"`{line}`" for line in want["type"].splitlines())
        if "bodies" in row:
            depth = min(d for d in DEPTHS if row["mean_depth"] <= d)
            other = next(race[4] for race in races(piles) if race[:2] == (row["bodies"], depth))
            mine = f"at most {depth:g} r deep, {number(row['resting'])} µs a step"
            yield [want["wish"], typed, mine, "-", resting(other)]
        elif not any(beats(other, row) for _, other in chosen):
            found = best[row["problem"]]
            others = cell(found.get(RIVAL)), cell(best_of(found, PEERS), True)
            yield [want["wish"], typed, cell(row), *others]


def wanted(rows):
    """(a line of take.csv, the row that was measured of it)"""
    same = "engine", "setting", "substeps"
    for want in stored.load(HERE)[0]["take"]:
        for row in rows:
            if all(row[key] == want[key] for key in same) and row.get("dt", DT) == DT:
                if want["problem"] == row.get("problem", row.get("bodies")):
                    yield want, row


def beats(one, other):
    """Whether a point is better than another one of the same problem in both error and time."""
    better = (one.get("error") or 0.0) < (other["error"] or 0.0)  # the reference has no error
    return one.get("problem") == other["problem"] and better and one["ms"] < other["ms"]


def winners(rows):
    """A row a problem: error and time of each; the winner of leapfrog and the best other bold."""
    for name, found in contest(rows).items():
        other = best_of(found, PEERS)
        cells = [cell(found.get(who)) for who in ("exact", RIVAL, "leapfrog", "lcp")]
        cells.append(cell(other, True))
        won = 4 if loses(found.get("leapfrog"), other) else 2
        cells[won] = f"**{cells[won]}**"
        yield [f"{name}: {problems.BY_NAME[name].title}", *cells]


def losses(rows):
    """A row for each limit: where leapfrog is beaten by another engine, and by the rival."""
    for words, fields, *sides in limits(rows):
        texts = ["; ".join(f"{name} ({number(mine['error'])} r, {cell(peer, True)})"
                           for name, (mine, peer) in lost.items()) for lost in sides]  # fmt: skip
        none = "nowhere" if fields else "a step of it counts two"
        yield [words, fields, *(text or none for text in texts)]


def falling(rows):
    """A row an engine: how long a step takes while a pile falls, by its fastest setting."""
    for engine in dict.fromkeys(row["engine"] for row in rows):
        mine = [row for row in rows if row["engine"] == engine]
        times = ([row["falling"] for row in mine if row["bodies"] == count]
                 for count in (*measure.SIZES, measure.MANY))  # fmt: skip
        yield [LABELS[engine], *(number(min(each, default=None)) for each in times)]


def lines(rows):
    """The rows of a Markdown table."""
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def written(name, sections, made):
    """page.md or readme.md with everything filled in."""
    points, piles, processes = (sections.get(part, ()) for part in measure.PARTS)
    about = made.get("points", {"versions": {}})
    there = (f"{row[1]} {about['versions'].get(row[1], 'not there')}" for row in ENGINES.values())
    facts = claims(points, piles, processes)
    template, words = ((HERE / file).read_text("utf-8") for file in (name, "claims.md"))
    facts |= zip(("claims", "piles", "compiled"), words.format(**facts).strip().split("\n\n"))
    raced = ([f"{n:,}", f"{depth:g}", *map(resting, each)] for n, depth, *each in races(piles))
    return template.format(
        **facts,
        work=WORK[-1],
        stepped=", ".join(STEPPED),
        machine=f"{about.get('cores')} cores of {about.get('cpu')}, with {', '.join(there)}",
        take=lines(take(points, piles)),
        winners=lines(winners(points)),
        losses=lines(losses(points)),
        races=lines(raced),
        falling=lines(falling(piles)),
        processes=lines([name, *map(number, each)] for name, *each in map(dict.values, processes)),
        origins="\n".join(f"- {part}: {stored.footer(each)}" for part, each in made.items()),
    )


def front(dots):
    """The dots that no other one beats in both x and y."""
    dots = sorted(dots)
    return [dot for k, dot in enumerate(dots) if all(dot[1] < y for _, y in dots[:k])]


def figure_of(dots, columns, title, explained, x, y, cross=(), **look):
    """A figure of {engine: [(x, y)]} on logarithmic axes with these words; and its axis."""
    words = dict(title=title, explained=explained)
    figure, (axis,) = picture.figure(height=3.4, below=0.2 * columns, **words)
    for engine, each in dots.items():
        picture.line(axis, *zip(*each), engine, LABELS[engine], **look)
    for at in cross:
        axis.axhline(at, color=picture.PALE, lw=0.8)
        axis.axvline(at, color=picture.PALE, lw=0.8)
    axis.set(xscale="log", yscale="log", xlabel=x, ylabel=y)
    picture.legend_below(axis, columns=columns, down=0.2)
    return figure, axis


def error_figure(rows, problem):
    """Time against error: the front of all settings and steps of each engine."""
    dots = {engine: front((max(p["error"], LEAST), p["ms"]) for p in rows
                          if (p["engine"], p["problem"], p["diverged"]) == (engine, problem, 0)
                          and p["error"] is not None) for engine in LABELS}  # fmt: skip
    figure, axis = figure_of(
        {engine: each for engine, each in dots.items() if each}, 4,
        f"{problem.capitalize()}: {problems.BY_NAME[problem].title}",
        "Left and down is better. A line joins what no other setting or step of the same engine "
        "beats in both error and time.",
        "worst position error [r]",
        f"time for {problems.BY_NAME[problem].duration:g} s of motion [ms]",
    )  # fmt: skip
    axis.set_xlim(None, min(axis.get_xlim()[1], 30.0))
    return figure


def ratio_figure(rows):
    """Time over error of leapfrog and exact beside the best other engine's, a dot a problem."""
    dots = {}
    for model in ("exact", "leapfrog"):
        for name, found in contest(rows).items():
            mine, other = found.get(model), best_of(found, PEERS)
            if mine and other and mine["error"] is not None:
                error = max(mine["error"], LEAST) / other["error"]
                dots.setdefault(model, {})[error, mine["ms"] / other["ms"]] = name
    figure, axis = figure_of(
        dots, 2, "Beside the best other engine, at most 16 substeps in 2 ms",
        "A dot is a problem: error and time, as shares of the most accurate other engine's. Left "
        "and down of the cross both are smaller.",
        "error / the best other's", "time / the best other's", [1.0], ls="",
    )  # fmt: skip
    for dot, name in (item for each in dots.values() for item in each.items()):
        axis.annotate(name, dot, (4, 2), textcoords="offset points", fontsize=7)
    return figure


def write(folder, sections, made):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    files, rows = {"README.md": written("page.md", sections, made)}, sections.get("points", ())
    figures = {"ratios.svg": ratio_figure(rows)} if rows else {}
    figures |= {f"error-{name}.svg": error_figure(rows, name) for name in DRAWN
                if any(p["problem"] == name for p in rows)}  # fmt: skip
    about = {"measured": made.get("points")}
    files |= {name: picture.svg(figure, about) for name, figure in figures.items()}
    for name, content in files.items():
        write_whole(folder / name, content)
