"""What was measured, for a reader: one page, few figures, and the README's block.

The words stand in page.md, readme.md and claims.md, the numbers come from the CSV files alone.
"""

from operator import itemgetter

from contact import MODELS, STEPPED, format_number
from curriculum import stored
from curriculum.bench import measure, problems
from curriculum.bench.engines import ENGINES, HERE, LABELS
from curriculum.bench.events import PHASES
from curriculum.bench.measure import BUDGETS, DEPTHS, DT, WORK, contest
from curriculum.commands import write_atomic
from curriculum.show import picture

REFERENCE = "events"  # the event-driven code, which takes nothing from contact.py
PEERS = [name for name in ENGINES if name != REFERENCE]
DRAWN = "slide", "bounce", "pile"  # the problems with a picture of their own
SHOWN = "exact", REFERENCE, "leapfrog", "lcp"  # each with a column of its own
CONTESTS = {f"{work} substeps in 2 ms": dict(work=work) for work in WORK}
CONTESTS |= {f"{us} µs of CPU a ball in 2 ms": dict(budget=us) for us in BUDGETS}


def called(row):
    """Return how a row's setting is called, with its engine."""
    return f"{row['engine']} {row['setting'] or ''}".strip()


def told(p):
    """Return engine, error [r] and time [ms] of a point: three cells."""
    if p is None:
        return ["-"] * 3
    error = "reference" if p["error"] is None else format_number(p["error"])
    return [LABELS[p["engine"]], error, format_number(p["ms"])]


def step_of(row):
    """Return engine and setting as typed, and the time of a step of a pile: two cells."""
    if row is None:
        return ["-", "-"]
    cut = f", {row['substeps']} substeps" if row["substeps"] > 1 else ""
    return [called(row | {"engine": LABELS[row["engine"]]}) + cut, format_number(row["us"])]


def loses(one, other):
    """Return whether an error is larger than another, in three digits; of two that are measured."""
    return bool(one and other) and measure.rank(one)[0] > measure.rank(other)[0]


def limits(points):
    """Yield (limit, number of problems, {problem where an engine beats leapfrog: both points})."""
    for words, limit in CONTESTS.items():
        mine, others = (contest(points, side, **limit) for side in (["leapfrog"], PEERS))
        beaten = [name for name in mine if loses(mine[name], others.get(name))]
        yield words, len(mine), {name: (mine[name], others[name]) for name in beaten}


def races(rows, depths):
    """Yield (balls, depth, our fastest row, leapfrog's, the fastest other engine's) of piles."""
    for depth in depths:
        sides = [measure.fastest(rows, depth, w) for w in (MODELS, ["leapfrog"], ENGINES)]
        for count in sorted(set().union(*sides)):
            yield count, depth, *(side.get(count) for side in sides)


def claims(points, piles):
    """Return the numbers of claims.md and page.md: leapfrog and exact beside other engines, losses
    too; piles at rest; how far times differ between processes."""
    there = {p["engine"] for p in points}
    *others, last = [LABELS[name] for name in PEERS if name in there] or ["nobody"]
    exact, rival, leapfrog = (contest(points, [name]) for name in ("exact", REFERENCE, "leapfrog"))
    both = [(exact[name], rival[name]) for name in exact if name in rival]
    lost = [name for name, p in rival.items() if loses(leapfrog.get(name), p)]
    longer = [p["ms"] / mine["ms"] for mine, p in both]
    errors = ([p[key] for _, p in both] for key in ("error", "error_max"))
    usual, worst = (format_number(max(each, default=None)) for each in errors)
    spans = sorted(100.0 * (p["ms_max"] / p["ms_min"] - 1.0) for p in points if p["ms"]) or [0.0]
    return dict(
        peers=f"{', '.join(others)} and {last}",
        where=where(points),
        rival=f"{len(lost)} of {len(leapfrog)} ({', '.join(lost)})",
        longer=" to ".join(format_number(pick(longer, default=None)) for pick in (min, max)),
        usual_error=usual,
        worst_error=worst,
        phases=PHASES,
        our_piles=ratios(piles, 2),
        leapfrog_piles=ratios(piles, 3),
        usual_span=format_number(spans[len(spans) // 2]),
        widest_span=format_number(spans[-1]),
    )


def where(points):
    """Return in how many problems leapfrog is at least as accurate as each engine, by limit."""
    found = {}
    for words, fields, lost in limits(points):
        but = f" (not {', '.join(lost)})" * bool(lost)
        found.setdefault(f"in {fields - len(lost)} of {fields} problems{but}", []).append(words)
    return "; ".join(f"{result} with at most {', '.join(each)}" for result, each in found.items())


def ratios(piles, which):
    """Return how many times as long as ours the fastest other engine takes, for piles at rest, and
    where that is least."""
    found = {race[4]["us"] / race[which]["us"]: f"{race[0]:,} balls, {race[1]:g} r"
             for race in races(piles, DEPTHS) if race[which] and race[4]}  # fmt: skip
    least, most = min(found, default=None), max(found, default=None)
    low = f"1/{format_number(1.0 / least)}" if least and least < 1.0 else format_number(least)
    return f"{low} to {format_number(most)} times (least: {found.get(least)})"


def take(points, piles):
    """Yield rows of the README's table: which model, how one types it, its error and time, and
    those of the best other engine."""
    peers, same = contest(points, PEERS), itemgetter("engine", "setting", "substeps")
    rows = {(p["problem"], *same(p)): p for p in points if p["dt"] == DT}
    rows |= {(row["bodies"], *same(row)): row for row in piles}
    for want in stored.load(HERE)[0]["take"]:
        row = rows.get((want["problem"], *same(want)))
        cells = [want["wish"], f"`{called(want)}`", f"`{typed(want)}`"]
        if row in points:
            yield [*cells, *told(row)[1:], *told(peers.get(row["problem"]))]
        elif row:
            depth = min(d for d in DEPTHS if row["mean_depth"] <= d)
            other = measure.fastest(piles, depth, ENGINES).get(row["bodies"])
            rival, time = step_of(other)
            mine = f"{depth:g}, mean depth", f"{format_number(row['us'])} µs a step"
            yield [*cells, *mine, rival, f"{depth:g}", f"{time} µs a step"]


def typed(want):
    """Return the command that measures a row of the README's table again."""
    more = f" --substeps {want['substeps']}" if want["substeps"] > 1 else ""
    setting = f'"{called(want)}"' if want["setting"] else want["engine"]
    return f"python -m curriculum.bench try {want['problem']} {setting}{more}"


def winners(rows, which):
    """Yield a row a problem: error (1) or time (2) of each of SHOWN, the best engine and its."""
    best = [contest(rows, side) for side in (*([name] for name in SHOWN), PEERS)]
    for name in best[0]:
        *ours, other = (told(each.get(name)) for each in best)
        title = f"{name}: {problems.BY_NAME[name].title}"
        yield [title, *(cells[which] for cells in ours), other[0], other[which]]


def losses(rows):
    """Yield a row for each limit and problem where an engine beats leapfrog."""
    for words, _, lost in limits(rows):
        for name, (mine, other) in lost.items():
            yield [words, name, *told(mine)[1:], *told(other)]


def written(name, sections, made):
    """Return page.md or readme.md with everything filled in."""
    points, piles, heap, processes = (sections.get(part, ()) for part in measure.PARTS)
    about = made.get("points", {"versions": {}})
    there = (f"{row[1]} {about['versions'].get(row[1], 'not there')}" for row in ENGINES.values())
    facts = claims(points, piles)
    template, words = ((HERE / file).read_text("utf-8") for file in (name, "claims.md"))
    facts |= zip(("claims", "piles"), words.format(**facts).strip().split("\n\n"))
    spent = map(dict.values, processes)
    return template.format(
        **facts,
        work=WORK[-1],
        stepped=", ".join(m for m in STEPPED if any(p["engine"] == m for p in points)),
        machine=f"{about.get('cores')} cores of {about.get('cpu')}, with {', '.join(there)}",
        take=stored.lines(take(points, piles)),
        errors=stored.lines(winners(points, 1)),
        times=stored.lines(winners(points, 2)),
        losses=stored.lines(losses(points)),
        races=stored.lines(raced(piles, DEPTHS)),
        heap=stored.lines(raced(heap, (1e-2, *DEPTHS))),
        processes=stored.lines([name, *map(format_number, each)] for name, *each in spent),
        origins="\n".join(f"- {part}: {stored.footer(each)}" for part, each in made.items()),
    )


def raced(rows, depths):
    """Yield rows of a table of races: setting and time of each side."""
    for count, depth, *each in races(rows, depths):
        yield [f"{count:,}", f"{depth:g}", *(cell for row in each for cell in step_of(row))]


def front(dots):
    """Return the dots that no other one beats in both x and y."""
    dots = sorted(dots)
    return [dot for k, dot in enumerate(dots) if all(dot[1] < y for _, y in dots[:k])]


def error_figure(rows, problem):
    """Draw time against error: the front of all settings and steps of each engine."""
    figure, (axis,) = picture.figure(
        title=f"{problem.capitalize()}: {problems.BY_NAME[problem].title}",
        explained="Left and down is better. A line joins what no other setting or step of the same "
        "engine beats in both error and time.",
        below=0.9,
    )
    for engine, label in LABELS.items():
        dots = front((p["error"], p["ms"]) for p in rows
                     if (p["engine"], p["problem"]) == (engine, problem)
                     and p["error"] is not None)  # fmt: skip
        if dots:
            picture.line(axis, *zip(*dots), engine, label)
    time = f"time for {problems.BY_NAME[problem].duration:g} s of motion [ms]"
    axis.set(xscale="log", yscale="log", xlabel="worst position error [r]", ylabel=time)
    picture.legend_below(axis, columns=5, down=0.2)
    axis.set_xlim(None, min(axis.get_xlim()[1], 30.0))
    return figure


def write(folder, sections, made):
    """Write README.md and figures into a folder. Raises ImportError without matplotlib."""
    files, rows = {"README.md": written("page.md", sections, made)}, sections.get("points", ())
    for name in {p["problem"] for p in rows} & {*DRAWN}:
        files[f"error-{name}.svg"] = picture.svg(error_figure(rows, name), made.get("points"))
    for name, content in files.items():
        write_atomic(folder / name, content)
