"""What was measured, for a reader: one page, few figures, and the README's block.

The words stand in page.md, readme.md and claims.md, the numbers come from the CSV files alone.
"""

from operator import itemgetter

from contact import COMPILE_FROM, MODELS, STEPPED, format_number
from curriculum import stored
from curriculum.bench import measure, problems
from curriculum.bench.engines import ENGINES, HERE, LABELS
from curriculum.bench.events import PHASES
from curriculum.bench.measure import BUDGETS, DEPTHS, DT, WORK, contest
from curriculum.commands import write_atomic
from curriculum.show import picture

RIVAL = "events"
PEERS = [name for name in ENGINES if name != RIVAL]
LEAST = 1e-16  # r: an error of exactly zero is drawn here
DRAWN = "slide", "bounce", "pile"  # the problems with a picture of their own
CONTESTS = {f"{work} substeps in 2 ms": dict(work=work) for work in WORK}
CONTESTS |= {f"{us} µs a ball and 2 ms": dict(budget=us) for us in BUDGETS}


def cell(p, named=False):
    """Error and time of a point, for a reader, and whose it is."""
    if p is None:
        return "-"
    error = "reference" if p["error"] is None else f"{format_number(p['error'])} r"
    return f"{LABELS[p['engine']] + ' ' if named else ''}{error}, {format_number(p['ms'])} ms"


def resting(row):
    """Engine, setting as one types it, and time of a step of a pile at rest."""
    if row is None:
        return "-"
    cut = f", {row['substeps']} x" if row["substeps"] > 1 else ""
    called = f"{LABELS[row['engine']]} {row['setting'] or ''}".strip()
    return f"{called}{cut}: {format_number(row['resting'])} µs"


def loses(one, other):
    """Whether an error is larger than another, in three digits; of two that are measured."""
    return bool(one and other) and measure.rank(one)[0] > measure.rank(other)[0]


def limits(points):
    """(limit, number of problems, where leapfrog is beaten by an engine, and by the rival)

    Where it is beaten: {problem: (leapfrog's point, the better one)}.
    """
    for words, limit in CONTESTS.items():
        sides = ["leapfrog"], PEERS, [RIVAL]
        mine, *others = (contest(points, side, **limit) for side in sides)
        yield words, len(mine), *({name: (mine[name], other) for name, other in each.items()
                                   if loses(mine.get(name), other)} for each in others)  # fmt: skip


def races(rows):
    """(balls, depth, our fastest row, leapfrog's, the fastest other engine's) of piles at rest."""
    for depth in DEPTHS:
        sides = [measure.fastest(rows, depth, who) for who in (MODELS, ["leapfrog"], ENGINES)]
        for count in sorted(set().union(*sides)):
            yield count, depth, *(side.get(count) for side in sides)


def claims(points, piles, processes):
    """The numbers of claims.md and page.md: leapfrog and exact beside named opponents, losses too;
    piles at rest; what compiled loops cost at first; how far times differ between processes."""
    there = {p["engine"] for p in points}
    *others, last = [LABELS[name] for name in PEERS if name in there] or ["nobody"]
    where = [f"in {fields - len(lost)} of {fields} with at most {words}"
             + f" (not {', '.join(lost)})" * bool(lost)
             for words, fields, lost, _ in limits(points)]  # fmt: skip
    exact, rival, leapfrog = (contest(points, [name]) for name in ("exact", RIVAL, "leapfrog"))
    both = [(exact[name], rival[name]) for name in exact if name in rival]
    lost = [name for name, p in rival.items() if loses(leapfrog.get(name), p)]
    errors = ([p[key] for _, p in both] for key in ("error", "error_max"))
    usual, worst = (format_number(max(each, default=None)) for each in errors)
    spans = sorted(100.0 * (p["ms_max"] / p["ms_min"] - 1.0) for p in points if p["ms"]) or [0.0]
    taken = {row["process"]: row["seconds"] for row in processes}
    first = {row["process"]: row["first"] for row in processes}
    return dict(
        peers=f"{', '.join(others)} and {last}",
        where=", ".join(where),
        rival=f"{len(lost)} of {len(leapfrog)} ({', '.join(lost)})",
        longer=reach([p["ms"] / mine["ms"] for mine, p in both]),
        usual_error=usual,
        worst_error=worst,
        phases=PHASES,
        our_piles=shares(piles, 2),
        leapfrog_piles=shares(piles, 3),
        numba=format_number(taken.get("one compiled step", 0.0) - taken.get("import numpy", 0.0)),
        first=format_number(first.get("one compiled step")),
        many=COMPILE_FROM,
        usual_span=format_number(spans[len(spans) // 2]),
        widest_span=format_number(spans[-1]),
    )


def reach(values):
    """From the least to the greatest, as text."""
    return (
        f"{format_number(min(values, default=None))} to {format_number(max(values, default=None))}"
    )


def shares(piles, which):
    """Times of a pile at rest over those of the fastest other engine, and where it is greatest."""
    ratios = {race[which]["resting"] / race[4]["resting"]: f"{race[0]:,} balls, {race[1]:g} r"
              for race in races(piles) if race[which] and race[4]}  # fmt: skip
    return f"{reach(ratios)} ({ratios.get(max(ratios, default=None))})"


def take(points, piles):
    """Rows of the README's table: what one types, and gets, and would get elsewhere."""
    rival, peers = contest(points, [RIVAL]), contest(points, PEERS)
    same = itemgetter("engine", "setting", "substeps")
    rows = {(p["problem"], *same(p)): p for p in points if p["dt"] == DT}
    rows |= {(row["bodies"], *same(row)): row for row in piles}
    for want in stored.load(HERE)[0]["take"]:
        typed = "<br>".join(f"`{line}`" for line in want["type"].splitlines())
        row = rows.get((want["problem"], *same(want)))
        if row in points:
            others = cell(rival.get(row["problem"])), cell(peers.get(row["problem"]), True)
            yield [want["wish"], typed, cell(row), *others]
        elif row:
            depth = min(d for d in DEPTHS if row["mean_depth"] <= d)
            other = measure.fastest(piles, depth, ENGINES).get(row["bodies"])
            mine = f"at most {depth:g} r deep, {format_number(row['resting'])} µs a step"
            yield [want["wish"], typed, mine, "-", resting(other)]


def winners(rows):
    """A row a problem: error and time of each; the winner of leapfrog and the best other bold."""
    sides = ["exact"], [RIVAL], ["leapfrog"], ["lcp"], PEERS
    best = [contest(rows, side) for side in sides]
    for name, problem in problems.BY_NAME.items():
        found = [each.get(name) for each in best]
        cells = [cell(p, p is found[-1]) for p in found]
        won = 4 if loses(found[2], found[4]) else 2
        cells[won] = f"**{cells[won]}**"
        if any(found):
            yield [f"{name}: {problem.title}", *cells]


def losses(rows):
    """A row for each limit: where leapfrog is beaten by another engine, and by the rival."""
    for words, fields, *sides in limits(rows):
        texts = ["; ".join(f"{name} ({format_number(mine['error'])} r, {cell(peer, True)})"
                           for name, (mine, peer) in lost.items()) for lost in sides]  # fmt: skip
        yield [words, fields, *(text or "nowhere" for text in texts)]


def falling(rows):
    """A row an engine: how long a step takes while a pile falls, by its fastest setting."""
    for engine in dict.fromkeys(row["engine"] for row in rows):
        mine = (row for row in rows if row["engine"] == engine)
        found = measure.best(mine, "bodies", itemgetter("falling"))
        counts = *measure.SIZES, measure.MANY
        yield [
            LABELS[engine],
            *(format_number(found.get(count, {}).get("falling")) for count in counts),
        ]


def written(name, sections, made):
    """page.md or readme.md with everything filled in."""
    points, piles, processes = (sections.get(part, ()) for part in measure.PARTS)
    about = made.get("points", {"versions": {}})
    there = (f"{row[1]} {about['versions'].get(row[1], 'not there')}" for row in ENGINES.values())
    facts = claims(points, piles, processes)
    template, words = ((HERE / file).read_text("utf-8") for file in (name, "claims.md"))
    facts |= zip(("claims", "piles", "compiled"), words.format(**facts).strip().split("\n\n"))
    spent = map(dict.values, processes)
    raced = ([f"{n:,}", f"{depth:g}", *map(resting, each)] for n, depth, *each in races(piles))
    return template.format(
        **facts,
        work=WORK[-1],
        stepped=", ".join(STEPPED),
        machine=f"{about.get('cores')} cores of {about.get('cpu')}, with {', '.join(there)}",
        take=stored.lines(take(points, piles)),
        winners=stored.lines(winners(points)),
        losses=stored.lines(losses(points)),
        races=stored.lines(raced),
        falling=stored.lines(falling(piles)),
        processes=stored.lines([name, *map(format_number, each)] for name, *each in spent),
        origins="\n".join(f"- {part}: {stored.footer(each)}" for part, each in made.items()),
    )


def front(dots):
    """The dots that no other one beats in both x and y."""
    dots = sorted(dots)
    return [dot for k, dot in enumerate(dots) if all(dot[1] < y for _, y in dots[:k])]


def error_figure(rows, problem):
    """Time against error: the front of all settings and steps of each engine."""
    figure, (axis,) = picture.figure(
        title=f"{problem.capitalize()}: {problems.BY_NAME[problem].title}",
        explained="Left and down is better. A line joins what no other setting or step of the same "
        "engine beats in both error and time.",
        below=0.8,
    )
    for engine, label in LABELS.items():
        dots = front((max(p["error"], LEAST), p["ms"]) for p in rows
                     if (p["engine"], p["problem"], p["diverged"]) == (engine, problem, 0)
                     and p["error"] is not None)  # fmt: skip
        if dots:
            picture.line(axis, *zip(*dots), engine, label)
    time = f"time for {problems.BY_NAME[problem].duration:g} s of motion [ms]"
    axis.set(xscale="log", yscale="log", xlabel="worst position error [r]", ylabel=time)
    picture.legend_below(axis, columns=4, down=0.2)
    axis.set_xlim(None, min(axis.get_xlim()[1], 30.0))
    return figure


def write(folder, sections, made):
    """README.md and the figures into the results folder. Raises ImportError without matplotlib."""
    files, rows = {"README.md": written("page.md", sections, made)}, sections.get("points", ())
    about = {"measured": made.get("points")}
    for name in {p["problem"] for p in rows} & {*DRAWN}:
        files[f"error-{name}.svg"] = picture.svg(error_figure(rows, name), about)
    for name, content in files.items():
        write_atomic(folder / name, content)
