"""results.json, README.md and the figures, from the results of the jobs."""

import json

from contact import write_whole
from curriculum.stress import jobs
from curriculum.stress.claims import PROPERTIES
from curriculum.text import results

RESULTS = results.ROOT / "curriculum" / "stress" / "results"
QUICK = results.ROOT / "outputs" / "stress-quick"
OTHERS = {
    "maps": "Maps: one ball dropped a metre",
    "extremes": "Every flag of contact.py at its ends",
    "mujoco": "soft against MuJoCo: single steps and whole runs",
}


def write(found, command, folder):
    """Write what the jobs of each section found. Returns the violations [place, name, words]."""
    sections = {name: jobs.added_up(found[name]) for name in ("scenes", "small")}
    sections |= {name: judged(found[name]) for name in OTHERS}
    for row in found["maps"]:
        sections["maps"].setdefault(row["map"], []).append(row)
    errors = [abs(row["measured"] / row["theory"] - 1) for row in sections["maps"]["penalty"]]
    sections["maps"]["boundary_worst_error"] = max(errors)
    (folder / results.NAME).unlink(missing_ok=True)  # no section of an older run may stay
    for name, values in sections.items():
        results.save("stress", name, values, command, folder=folder)
    draw(folder)
    print(f"report: {folder / 'README.md'}")
    return [violation for values in sections.values() for violation in values["violations"]]


def judged(found):
    """The count of the judgements of a section, and its violations."""
    rows = [row for each in found for row in each.pop("rows")]
    wrong = [row for row in rows if not row["ok"]]
    listed = [[row["what"], f"expected {row['expected']}", f"got {row['got']}"] for row in wrong]
    return {"judgements": len(rows), "violations": listed}


def draw(folder=RESULTS):
    """README.md and the figures again, from results.json. Returns the exit status."""
    saved = json.loads((folder / results.NAME).read_text("utf-8"))
    write_whole(folder / "README.md", page(saved))
    try:
        from curriculum.stress import figures
    except ImportError as error:  # matplotlib
        print(f"no figures: {error}")
        return 0
    for name, svg in figures.draw(saved["maps"]).items():
        write_whole(folder / name, svg)
    return 0


def summary(saved):
    """How much was judged, and how many violations there are, in one sentence."""
    total = sum(section["judgements"] for section in saved.values())
    wrong = sum(len(section["violations"]) for section in saved.values())
    scenes = saved["scenes"]["scenes"] + saved["small"]["scenes"]
    return (
        f"On {scenes:,} random scenes for each of the four models, over the maps and at the ends of "
        f"every flag, {total:,} judgements found {wrong or 'no'} violation{'s' * (wrong > 1)}; the "
        "critical step of `penalty` is measured within "
        f"{saved['maps']['boundary_worst_error']:.2%} of theory."
    )


def readme():
    """The stress block of the project's README: one figure and one sentence."""
    saved = results.load("stress")
    if not saved:
        return "Not measured yet: `python -m curriculum.stress`."
    figure = (
        "![What penalty does over step and stiffness](curriculum/stress/results/penalty-map.svg)"
    )
    link = "[Every property, map and limit](curriculum/stress/results/README.md)."
    return f"{figure}\n\n{summary(saved)} {link}"


def page(saved):
    """README.md of the results."""
    parts = [
        "# Stress: what must hold on any scene, and where each model breaks",
        summary(saved),
        "A judgement of the scenes is one property on one scene, counted only where it could have "
        "failed: without a contact nothing is said of contacts. What was done is read from the states "
        "before and after each step, and held against the chapter's formulas.",
        "\n".join(
            f"- **{': '.join(each)}**" for name in saved for each in saved[name]["violations"]
        ),
        "## Properties on random scenes",
        table(
            "property | scenes judged | comparisons | off, as a share of the bound", stated(saved)
        ),
        table("not judged, or a limit that was met | scenes", notes(saved).items()),
        unfinished(saved["scenes"]["unfinished"]),
        *(other(saved[name], title) for name, title in OTHERS.items()),
        "![](penalty-map.svg)\n\n![](lcp-depth.svg)\n\n![](soft-map.svg)",
        results.footer(saved["scenes"]),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def table(head, rows):
    """A Markdown table; numbers with separators."""
    lines = [f"| {head} |", f"| --- {'| --: ' * head.count('|')}|"]
    for row in rows:
        cells = [f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def stated(saved):
    """A row for every property, over large and small scenes."""
    for name, function in PROPERTIES.items():
        large, small = (saved[section]["properties"][name] for section in ("scenes", "small"))
        words = " ".join(function.__doc__.split("\n\n")[0].split())
        share = max(large[2] or 0.0, small[2] or 0.0)
        yield words, large[0] + small[0], large[1] + small[1], f"{share:.1g}"


def notes(saved):
    """{what was not judged, or met: in how many scenes}, over large and small scenes."""
    met = dict(saved["scenes"]["notes"])
    for what, count in saved["small"]["notes"].items():
        met[what] = met.get(what, 0) + count
    return {what: met[what] for what in sorted(met) if what != "unfinished"}


def unfinished(counts):
    """What unfinished sweeps of lcp add, in words."""
    text = (
        f"Unfinished sweeps of lcp, without any push of Baumgarte's, add energy in {counts['rises']:,} "
        f"of {counts['scenes']:,} scenes, in {counts['above_start']:,} of them above the start."
    )
    if not counts["rises"]:
        return text
    worst = counts["worst"]
    return (
        f"{text} The worst is scene {worst['scene']}, from {worst['start']:.4g} J to "
        f"{worst['most']:.4g} J. {counts['sweeps_most']:,.0f} sweeps ended every rise."
    )


def other(section, title):
    """A section of maps, flags or runs beside the engine."""
    counts = f"{section['judgements']:,} judgements, {len(section['violations'])} violations."
    return f"## {title}\n\n{counts}" if section["judgements"] else f"## {title}\n\nNot run."
