"""The README's generated blocks, made from results.json, and what contact.py prints.

A block stands between `<!-- generated: NAME by COMMAND -->` and `<!-- end -->`. COMMAND is ours or a
call of contact.py; other blocks are left alone. A block of ours that results.json can't fill yet says so, and is filled by
the command that it names.
"""

import json
import re
import subprocess
import sys
import tempfile

from curriculum.bench import accuracy_page, piles_page, report, skips_page, store
from curriculum.common.files import write_whole

README = store.ROOT / "README.md"
COMMAND = "python -m curriculum.bench readme"
BLOCK = re.compile(r"(<!-- generated: (?P<name>[\w-]+) by (?P<command>[^>]*?) -->\n).*?(?=<!-- end -->)",
                   re.DOTALL)
HEADLINE = ("exact", "lcp", "penalty", "box2d", "box2d3", "pymunk", "mujoco_stiff", "mujoco")


def headline(sections):
    """Error and time at dt 0.002 s, drop and bounce: the rows that matter most."""
    section = sections["error"]
    data, rows = accuracy_page.Points(section), []
    for name in filter(section["methods"].get, HEADLINE):
        method = section["methods"][name]
        if name not in data.present:
            rows.append([method["label"], method["missing"], "", "", ""])
            continue
        cells = []
        for problem in ("drop", "bounce"):
            point = data.by_key[problem, name, 0.002]
            error = point["height_error"]["median"]
            cells += ["diverged" if point["diverged"] else report.number(error),
                      report.ms(point["times"]["read"]["min"])]
        rows.append([method["label"], *cells])
    return report.table(["", "drop: error / r", "drop: ms", "bounce: error / r", "bounce: ms"], rows)


def bounce(sections):
    """The bounce figure with its checked sentences."""
    where = (store.RESULTS / "error-bounce.svg").relative_to(store.ROOT).as_posix()
    said = report.sentences(accuracy_page.claims(sections["error"], "bounce"))
    return f"![Bounce: run time against error]({where})\n\n{said}\n"


def machine(sections):
    """The footer of the error section."""
    return store.footer(sections["error"]) + "\n"


def stress(sections):
    """What the stress report counts, and its most telling numbers."""
    found, place, count = (sections["stress"][name] for name in ("facts", "machine", "counts"))
    at = "dt {dt:.3g} s, beta {baumgarte:g}, e {restitution:g}".format
    deepest, wrong = found["lcp_depth"], found["lcp_height_error"]
    scenes = found["finite_unless_reported"]["scenes"]
    rows = [[f"{count['cells']:,} cells, {count['judgements']:,} judgements: violations",
             f"{count['violations'] + count['died']:,}"],
            ["known limits, each with its number in the report", f"{count['limits']:,}"],
            ["penalty: measured critical dt against theory, worst of the map",
             f"{100 * found['penalty_boundary_worst_error']:.2f} %"],
            ["lcp: deepest penetration of the map", f"{deepest['value']:.3g} r, at {at(**deepest)}"],
            ["lcp: worst height error of the map", f"{wrong['value']:.3g} r, at {at(**wrong)}"],
            ["exact: worst height error of the map", f"{found['exact_height_error']:.2g} r"],
            ["random scenes in which lcp without Baumgarte's push gains energy",
             f"{found['lcp_without_push_never_gains_energy']['limits']} of {scenes:,}"],
            ["exact: deepest overlap it leaves where balls slide, over those scenes",
             f"{found['exact_never_penetrates']['worst']:.2g} r"]]
    return report.table(["", "measured"], rows) + (
        f"\nMeasured on {place['date']} at commit {place['commit']}, {place['cores']} cores of "
        f"{place['processor']}, Python {place['python']}, numpy {place['packages']['numpy']}.\n")


def goals(page, name):
    """A maker of the table of goals of one section."""
    return name, lambda sections: report.goal_table(page.goals(sections[name]))


STRESS = store.ROOT / "curriculum" / "stress" / "results" / "results.json"
MEASURE = {"error": accuracy_page.COMMAND, "skip": skips_page.COMMAND, "pile": piles_page.COMMAND,
           "stress": "python -m curriculum.stress"}
BLOCKS = {"bench-headline": ("error", headline), "bench-bounce": ("error", bounce),
          "bench-goals": goals(accuracy_page, "error"), "bench-skip": goals(skips_page, "skip"),
          "bench-pile": goals(piles_page, "pile"), "bench-machine": ("error", machine),
          "stress": ("stress", stress)}


def printed(flags):
    """What contact.py prints for `flags`, fenced; without the banner and the lines that name files."""
    with tempfile.TemporaryDirectory() as out:
        run = subprocess.run([sys.executable, "contact.py", *flags, "--no-rerun", "--out", out],
                             cwd=store.ROOT, capture_output=True, text=True, check=True)
    lines = [line for line in run.stdout.splitlines()
             if not line.startswith(("[", "metrics:", "config_hash:", "next:"))]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def fill(text, sections):
    """The README's text with our blocks made anew. Raises ValueError for a name that is none of ours."""
    def made(match):
        if match["command"].startswith("python contact.py"):
            return match[1] + printed(match["command"].split()[2:])
        if "curriculum.bench" not in match["command"]:
            return match[0]
        if match["name"] not in BLOCKS:
            line = text.count("\n", 0, match.start()) + 1
            raise ValueError(f"README.md:{line}: no generated block {match['name']!r}; "
                             f"there are: {', '.join(BLOCKS)}")
        section, maker = BLOCKS[match["name"]]
        if section in sections:
            return match[1] + maker(sections)
        return f"{match[1]}Not measured yet: `{MEASURE[section]}`.\n"
    return BLOCK.sub(made, text)


def main(folder, check):
    """Write the README's blocks, or with `check` only compare them. Returns the exit status."""
    if not README.exists():
        print("README.md is missing", file=sys.stderr)
        return 1
    text = README.read_text(encoding="utf-8")
    sections = store.load(folder)
    if STRESS.exists():
        sections["stress"] = json.loads(STRESS.read_text(encoding="utf-8"))
    try:
        new = fill(text, sections)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    if check and new != text:
        old, now = text.splitlines(), new.splitlines()
        line = next((k for k, (a, b) in enumerate(zip(old, now)) if a != b), min(len(old), len(now)))
        print(f"README.md:{line + 1}: a generated block is out of date; to repair: {COMMAND}",
              file=sys.stderr)
        return 1
    if not check and new != text:
        write_whole(str(README), new)
    ours = sum(1 for match in BLOCK.finditer(text) if match["command"] == COMMAND
               or match["command"].startswith("python contact.py"))
    print(f"README.md: {ours} generated blocks {'are up to date' if check else 'written'}")
    return 0
