"""results.json, README.md and the figures, from the results of the jobs."""

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


def write(found, folder):
    """Write what the jobs of each section found. Returns the violations [place, name, words]."""
    sections = {name: jobs.added_up(found[name]) for name in ("scenes", "small")}
    sections |= {name: judged(found[name]) for name in OTHERS}
    for row in found["maps"]:
        sections["maps"].setdefault(row["map"], []).append(row)
    errors = [abs(row["measured"] / row["theory"] - 1) for row in sections["maps"]["penalty"]]
    sections["maps"]["boundary_worst_error"] = max(errors)
    (folder / results.NAME).unlink(missing_ok=True)  # no section of an older run may stay
    command = "python -m curriculum.stress" + " --quick" * (folder == QUICK)
    saved = {
        name: results.save("stress", name, values, command, folder=folder)
        for name, values in sections.items()
    }
    write_whole(folder / "README.md", page(saved))
    draw(saved["maps"], folder)
    print(f"report: {folder / 'README.md'}")
    return [violation for section in saved.values() for violation in section["violations"]]


def draw(section, folder):
    """The figures, where matplotlib is installed."""
    try:
        from curriculum.stress import figures
    except ImportError as error:
        print(f"no figures: {error}")
        return
    for name, svg in figures.draw(section).items():
        write_whole(folder / name, svg)


def judged(found):
    """The count of the judgements of a section, and its violations."""
    rows = [row for each in found for row in each.pop("rows")]
    wrong = [row for row in rows if not row["ok"]]
    listed = [[row["what"], f"expected {row['expected']}", f"got {row['got']}"] for row in wrong]
    return {"judgements": len(rows), "violations": listed}


def summary(saved):
    """How much was judged, and how many violations there are, in one sentence."""
    total = sum(section["judgements"] for section in saved.values())
    wrong = sum(len(section["violations"]) for section in saved.values())
    scenes = saved["scenes"]["scenes"] + saved["small"]["scenes"]
    return (
        f"On {scenes:,} random scenes for each of the four models, over the maps and at the ends "
        f"of every flag, {total:,} judgements found {wrong or 'no'} violation{'s' * (wrong > 1)}; "
        "the critical step of `penalty` is measured within "
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
    wrong = [": ".join(each) for section in saved.values() for each in section["violations"]]
    parts = [
        "# Stress: what must hold on any scene, and where each model breaks",
        summary(saved),
        "A judgement of the scenes is one property on one scene, counted only where it could have "
        "failed: without a contact nothing is said of contacts. What was done is read from the "
        "states before and after each step, and held against the chapter's formulas.",
        "\n".join(f"- **{words}**" for words in wrong),
        "## Properties on random scenes",
        *(scene_part(saved[name], title) for name, title in (("scenes", "30"), ("small", "four"))),
    ]
    for name, title in OTHERS.items():
        count, wrong = saved[name]["judgements"], len(saved[name]["violations"])
        parts += [f"## {title}", f"{count:,} judgements, {wrong} violations."]
    parts += ["![](penalty-map.svg)", "![](soft-map.svg)", results.footer(saved["scenes"])]
    return "\n\n".join(part for part in parts if part) + "\n"


def scene_part(section, most):
    """The properties on scenes of up to so many balls, and what was not judged, or met."""
    lines = [
        f"{section['scenes']:,} scenes of up to {most} balls:\n",
        "| property | scenes judged | comparisons | off, as a share of the bound |",
        "| --- | --: | --: | --: |",
    ]
    for name, (judged, count, share) in section["properties"].items():
        words = " ".join(PROPERTIES[name].__doc__.split("\n\n")[0].split())
        lines.append(f"| {words} | {judged:,} | {count:,} | {share or 0:.1g} |")
    lines += ["", "Not judged, or limits that were met, in scenes:\n"]
    lines += [f"- {what}: {count:,}" for what, count in section["notes"].items()]
    added = section["unfinished"]
    if "worst" in added:
        lines += [
            "",
            f"Unfinished sweeps took {added['above_start']:,} scenes above their start's energy, "
            "at worst scene {scene}, from {start:.4g} J to {most:.4g} J; ".format(**added["worst"])
            + f"{added['sweeps_most']:,.0f} sweeps a step ended every rise.",
        ]
    return "\n".join(lines)
