"""results.json, README.md and the figure, from the results of the jobs."""

from curriculum.commands import write_whole
from curriculum.measured import results
from curriculum.show import picture
from curriculum.stress import heaps, jobs, maps, mujoco_match, properties

FOLDER = results.FOLDERS["stress"]
RESULTS, QUICK = results.ROOT / FOLDER, results.ROOT / "outputs" / "stress-quick"
TITLES = {
    "scenes": "Random scenes of up to 30 balls, and small ones of up to four",
    "maps": "A map of penalty: one ball dropped a metre",
    "mujoco": "soft against MuJoCo: single steps and whole runs",
    "heaps": "Heaps whose sweeps are done: the energy and the order of leapfrog",
}
COLOURS = ("#fde9c9", "#ec9c5a", "#9c4058", "#2b1741")  # light to dark, as an outcome gets worse
LINE = "#111111"  # over coloured cells, which stay as they are in the dark
MARKS = (0.3, 1, 3, 10, 30, 100, 300)  # ms
STATED = vars(properties) | vars(maps) | vars(mujoco_match) | vars(heaps)  # by their names
HEAD = """# Stress: what must hold on any scene, and where each model breaks

{}

A judgement is one property on one scene, row of a map or match, counted only where \
it could have failed: without a contact nothing is said of contacts. What was done is read from \
the states before and after each step, and held against the chapter's formulas. U is 2^-53, the \
largest rounding error of one operation; e is the restitution, v_n a speed along a normal."""
UNFINISHED = """Unfinished sweeps of `lcp` took {above_start:,} scenes above their start's energy, \
at worst {place}, from {start:.4g} J to {most:.4g} J; {sweeps_most:,.0f} sweeps a step ended every \
rise."""


def write(found, origins, folder):
    """Write what the jobs of each section found. Returns the violations [place, name, words]."""
    sections = {name: jobs.added_up(each) for name, each in found.items()}
    scenes = sections["scenes"]
    scenes |= {"scenes": len(found["scenes"]), "unfinished": jobs.unfinished(scenes)}
    scenes |= {"ran": jobs.ran(scenes)}
    rows = list(sections["maps"]["notes"].pop("penalty").values())
    sections["maps"]["penalty"] = rows
    notes = sections["heaps"]["notes"]
    sections["heaps"]["gains"] = heaps.table_of(notes.pop("gains").values())
    sections["heaps"]["thrown"] = heaps.thrown(notes.pop("thrown").values())
    for name, section in sections.items():
        section["violations"] += jobs.idle({"ran": {}} | section)
        section["notes"] = {what: len(places) for what, places in sorted(section["notes"].items())}
        sections[name] = results.save(folder, name, section, origins[name])
    draw(folder, sections)
    print(f"report: {folder / 'README.md'}")
    return [violation for section in sections.values() for violation in section["violations"]]


def draw(folder, sections):
    """Write page and figure, and the README's block where the results are kept."""
    write_whole(folder / "README.md", page(sections))
    try:
        write_whole(folder / "penalty-map.svg", penalty_map(sections["maps"]))
    except ImportError as error:
        print(f"no figure: {error}")
    if folder == RESULTS:
        results.write_block("stress", readme(sections))


def summary(sections):
    """How much was judged, and how many violations there are, in one sentence."""
    total = sum(section["judgements"] for section in sections.values())
    wrong = sum(len(section["violations"]) for section in sections.values())
    scenes, ran = sections["scenes"]["scenes"], sections["scenes"]["ran"]
    fewer = [f", `{model}` in the {n:,} that it promises" for model, n in ran.items() if n < scenes]
    heaps_run = max(row[0] for row in sections["heaps"]["properties"].values())
    return (
        f"{scenes:,} random scenes by every model{''.join(fewer)}; {heaps_run:,} heaps; `penalty` "
        f"over step and stiffness; `soft` beside MuJoCo: {total:,} "
        f"judgements, {wrong or 'no'} violation{'s' * (wrong != 1)}."
    )


def readme(sections):
    """The stress block of the project's README: one figure and one sentence."""
    figure = f"![What penalty does over step and stiffness]({FOLDER}/penalty-map.svg)"
    link = f"[Every property, map and limit]({FOLDER}/README.md)."
    return f"{figure}\n\n{summary(sections)} {link}"


def page(sections):
    """README.md of the results."""
    parts, unfinished = [HEAD.format(summary(sections))], sections["scenes"]["unfinished"]
    if unfinished["rises"]:
        parts.append(UNFINISHED.format(**unfinished, **unfinished["worst"]))
    for name, section in sections.items():
        head = ["property", "judged", "comparisons", "off, as a share of the bound"]
        parts += [f"## {TITLES[name]}", results.table(head, rows_of(section["properties"]))]
        parts += [f"- **{': '.join(words)}**" for words in section["violations"]]
        notes = [f"- {what}: {count:,}" for what, count in section["notes"].items()]
        if name == "heaps":
            head = ["dt", "heaps", "model", "gained energy", "most, as a share of the start's"]
            parts += [heaps.LIMITS, section["thrown"], results.table(head, section["gains"])]
        if notes:
            parts += ["Not judged, or limits that were met, in scenes:", "\n".join(notes)]
    parts += ["![](penalty-map.svg)", results.footer(sections["scenes"])]
    return "\n\n".join(parts) + "\n"


def rows_of(judgements):
    """What each property says, and how much of it was judged."""
    for name, (judged, count, share) in judgements.items():
        words = " ".join(STATED[name].__doc__.split("\n\n")[0].split())
        yield [words, f"{judged:,}", f"{count:,}", f"{share or 0:.1g}"]


def penalty_map(section):
    """What the drop does over dt and stiffness, a panel for each damper, with the theory: SVG."""
    figure, axes = picture.figure(
        rows=2,
        title="penalty: what a ball dropped 1 m does",
        below=0.6,
        explained="Left of the line, the critical step, a ball that stays in contact is stable. "
        "The speckle is luck: where in a step the ball meets the table.",
    )
    for axis, damping in zip(axes, (0.0, 80.0)):
        rows = [row for row in section["penalty"] if row["damping"] == damping]
        draw_panel(axis, rows, f"c = {damping:g} N s/m; line: k dt² + 2 c dt = 4 m")
    axes[0].get_legend().remove()
    axes[0].set_xlabel("")
    return picture.svg(figure, section)


def draw_panel(axis, rows, title):
    """The outcomes at one damping, and the critical dt."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    dt, stiffness = rows[0]["dt"], [row["stiffness"] for row in rows]
    classes = [[maps.OUTCOMES.index(letter) for letter in row["outcomes"]] for row in rows]
    look = dict(cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5, shading="nearest")
    axis.pcolormesh(dt, stiffness, classes, rasterized=True, **look)
    axis.grid(False)
    for look in (dict(color="white", lw=4), dict(color=LINE, lw=1.8)):
        axis.plot([row["critical"] for row in rows], stiffness, **look)
    patches = [Patch(color=colour, label=text) for colour, text in zip(COLOURS, maps.WORDS)]
    axis.legend(handles=patches, loc="upper left", bbox_to_anchor=(-0.1, -0.17), ncols=2)
    axis.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]), ylim=(stiffness[0], stiffness[-1]))
    axis.set(ylabel="stiffness k [N/m]", title=title)
    axis.set_xticks([1e-3 * mark for mark in MARKS], MARKS)
    axis.minorticks_off()
    axis.set_xlabel("time step dt [ms]", loc="right")
