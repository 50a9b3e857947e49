"""Tables, README.md and the figure, from the results of the jobs."""

from pathlib import Path

import numpy as np

from curriculum import stored
from curriculum.commands import write_atomic, write_json
from curriculum.show import picture
from curriculum.stress import heaps, jobs, maps, properties

FOLDER = stored.FOLDERS["stress"]
RESULTS, QUICK = stored.ROOT / FOLDER, stored.ROOT / "outputs" / "stress-quick"
PAGE = Path(__file__).with_name("page.md")
COLOURS = ("#fde9c9", "#ec9c5a", "#9c4058", "#2b1741")  # light to dark, as an outcome gets worse
LINE = "#111111"  # over coloured cells, which stay as they are in the dark
MARKS = (0.3, 1, 3, 10, 30, 100, 300)  # ms
STATED = vars(properties) | vars(maps) | vars(heaps)  # by their names


def tables_of(found):
    """Return {table: rows} of what the jobs of each section found."""
    judged, notes = [], {}
    for each in found.values():
        rows, noted = jobs.added_up(each)
        judged, notes = judged + rows, notes | noted
    energies, penalty = (list(notes.pop(what).values()) for what in ("energy", "penalty"))
    return {
        "judged": judged,
        "limits": [{"what": what, "scenes": len(each)} for what, each in sorted(notes.items())],
        "energy": list(heaps.energy_rows(energies)),
        "penalty": penalty,
    }


def write(found, origin, folder):
    """Write what the jobs of each section found. Returns how many violations there are."""
    for name, rows in tables_of(found).items():
        stored.save(folder / f"{name}.csv", rows or [{"what": None}])
    write_json(folder / "made.json", {"all": origin})
    return draw(folder)


def draw(folder):
    """Write page and figure of a folder's tables, and the README's block where they are kept."""
    tables, made = stored.load(folder)
    write_atomic(folder / "README.md", page(tables, made))
    write_atomic(folder / "penalty-map.svg", penalty_map(tables["penalty"], made["all"]))
    if folder == RESULTS:
        stored.write_block("stress", readme(tables))
    print(f"report: {folder / 'README.md'}")
    wrong = [row for row in tables["judged"] if row["violations"]]
    for row in wrong:
        print(failed(row))
    return len(wrong)


def summary(tables):
    """Return how much was checked, and how many checks failed, in one sentence."""
    total, wrong = (sum(row[name] for row in tables["judged"]) for name in ("judged", "violations"))
    scenes = tables["judged"][0]["judged"]  # the first property is one of every scene
    beyond = [row["scenes"] for row in tables["limits"] if row["what"].startswith("exact")]
    runs = sum(row["runs"] for row in tables["energy"])
    return (
        f"Every model on {scenes:,} random scenes, `exact` on the {scenes - sum(beyond):,} within "
        f"its limits; {runs:,} runs of heaps, narrow gaps, ceilings and columns; `penalty` over "
        f"step and stiffness. Of {total:,} checks {wrong or 'none'} failed."
    )


def readme(tables):
    """Return the stress block of the project's README: one figure and one sentence."""
    figure = f"![What penalty does over step and stiffness]({FOLDER}/penalty-map.svg)"
    link = f"[All properties and limits]({FOLDER}/README.md)."
    return f"{figure}\n\n{summary(tables)} {link}"


def page(tables, made):
    """Return README.md of the results."""
    wrong = [f"**{failed(row)}**" for row in tables["judged"] if row["violations"]]
    return PAGE.read_text("utf-8").format(
        summary="\n\n".join([summary(tables), *wrong]),
        energy=stored.lines(row.values() for row in tables["energy"]),
        limits=stored.lines([row["what"], f"{row['scenes']:,}"] for row in tables["limits"]),
        judged=stored.lines(map(cells, tables["judged"])),
        footer=stored.footer(made["all"]),
    )


def failed(row):
    """Return what a property says, how often it failed, and the first time: scene, error, bound."""
    sentence = stated(row["property"]).partition(". ")[0].rstrip(".")
    return f'Failed: "{sentence}", {row["violations"]:,} x. First: {row["first"]}'


def stated(name):
    """Return what a property says: the first paragraph of its docstring."""
    return " ".join(STATED[name].__doc__.split("\n\n")[0].split())


def cells(row):
    """Return what a property says, and how often it was checked."""
    counts = (f"{row[name]:,}" for name in ("judged", "comparisons"))
    return [stated(row["property"]), *counts, f"{row['share'] or 0:.1g}"]


def penalty_map(rows, made):
    """Draw the outcomes over dt and stiffness, a panel for each damper, with the theory: SVG."""
    from matplotlib.patches import Patch

    figure, axes = picture.figure(
        rows=2,
        title="penalty: what a ball dropped 1 m does",
        below=0.6,
        explained="Left of the line, the critical step, a ball that stays in contact is stable. "
        "The speckle is luck: where in a step the ball meets the table.",
    )
    for axis, damping in zip(axes, (0.0, 80.0)):
        draw_panel(axis, [row for row in rows if row["damping"] == damping])
        axis.set_title(f"c = {damping:g} N s/m; line: k dt² + 2 c dt = 4 m")
    axis.set_xlabel("time step dt [ms]", loc="right")
    patches = [Patch(color=colour, label=text) for colour, text in zip(COLOURS, maps.WORDS)]
    axis.legend(handles=patches, loc="upper left", bbox_to_anchor=(-0.1, -0.17), ncols=2)
    return picture.svg(figure, made)


def draw_panel(axis, rows):
    """Draw the outcomes at one damping, and the critical dt."""
    from matplotlib.colors import ListedColormap

    stiffness, critical = ([row[name] for row in rows] for name in ("stiffness", "critical"))
    dt = maps.steps_of(len(rows[0]["outcomes"]))
    classes = np.array([[maps.OUTCOMES.index(each) for each in row["outcomes"]] for row in rows])
    look = dict(cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5, shading="nearest")
    axis.pcolormesh(dt, stiffness, classes, rasterized=True, **look)
    axis.grid(False)
    for look in (dict(color="white", lw=4), dict(color=LINE, lw=1.8)):
        axis.plot(critical, stiffness, **look)
    axis.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]), ylim=(stiffness[0], stiffness[-1]))
    axis.set_ylabel("stiffness k [N/m]")
    axis.set_xticks([1e-3 * mark for mark in MARKS], MARKS)
    axis.minorticks_off()
