"""The README's generated blocks: measured results, and what contact.py prints.

    python -m curriculum.readme            write them
    python -m curriculum.readme --check    only compare; exit status 1 and the line if one differs

A block stands between `<!-- generated: NAME by COMMAND -->` and `<!-- end -->`. COMMAND is ours or a
call of contact.py; other blocks are left alone. A block whose results are older than the code it
measured begins with "Stale" and the command that measures again; one without results says so.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from importlib import import_module

from curriculum import measured, reporting
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable

README = measured.ROOT / "README.md"
COMMAND = "python -m curriculum.readme"
BENCH, STRESS = (measured.ROOT / folder for folder in measured.FOLDERS)
BLOCK = re.compile(
    r"(<!-- generated: (?P<name>[\w-]+) by (?P<command>[^>]*?) -->\n).*?(?=<!-- end -->)", re.DOTALL
)


# the blocks of the benchmark


def headline(section):
    """Error and time at dt 0.002 s on drop, bounce and stack: the best setting of each."""
    from curriculum.bench.contestants import LABELS

    found = section["headline"]
    chosen = [problem for problem in ("drop", "bounce", "stack") if problem in found]
    rows, settings = [], []
    for family, label in LABELS.items():
        if any(family in found[problem] for problem in chosen):
            cells = []
            words = [found[problem].get(family, {}).get("words") for problem in chosen]
            named = " / ".join(dict.fromkeys(filter(None, words)))
            settings.append(f"{label}: {named}")
            for problem in chosen:
                best = found[problem].get(family) or {}
                cells += [
                    reporting.number(best.get("error"), 2),
                    reporting.number(best.get("ms"), 2),
                ]
            rows.append([label, *cells])
    head = [f"{problem}: {what}" for problem in chosen for what in ("error / r", "ms")]
    return f"{reporting.table(['', *head], rows)}\nSettings. {'; '.join(settings)}.\n"


def figure(name, report, *arguments):
    """A maker of a figure with its checked sentences."""

    def made(section):
        where = (BENCH / f"{name}.svg").relative_to(measured.ROOT).as_posix()
        said = reporting.sentences(report_on(report).claims(section, *arguments))
        return f"![{name}]({where})\n\n{said}\n"

    return made


def goals(report):
    """A maker of the table of goals of one section."""
    return lambda section: reporting.goal_table(report_on(report).goals(section))


def report_on(name):
    return import_module(f"curriculum.bench.reports.{name}")


def machine(section):
    """Where and on what the accuracy section was measured."""
    return measured.footer(section) + "\n"


BLOCKS = {  # name: section of the benchmark's results, what makes the block from it
    "bench-headline": ("accuracy", headline),
    "bench-bounce": ("accuracy", figure("error-bounce", "accuracy", "bounce")),
    "bench-goals": ("accuracy", goals("accuracy")),
    "bench-machine": ("accuracy", machine),
    "bench-solvers": ("solvers", figure("solvers", "solvers")),
    "bench-soft": ("soft", figure("soft", "soft")),
    "bench-skip": ("skip", goals("skips")),
    "bench-pile": ("pile", goals("piles")),
}


def block(name):
    """The text of one block of ours, from the results that are there."""
    if name in OTHERS:
        return OTHERS[name]()
    section_name, made = BLOCKS[name]
    section = measured.load(BENCH).get(section_name)
    if section is None or "measured" not in section:
        return f"Not measured yet: `python -m curriculum.bench {section_name}`.\n"
    note = measured.stale_note(section)
    return (f"{note}\n\n" if note else "") + made(section)


def stress():
    """The stress report's own block."""
    report = import_module("curriculum.stress.report")
    sections = measured.load(STRESS)
    if "counts" not in sections or not hasattr(report, "readme_block"):
        return "Not measured yet: `python -m curriculum.stress`.\n"
    return report.readme_block(sections)


def exact():
    """What the sweep of exact over piles and towers found, and where it stands."""
    report = import_module("curriculum.stress.exact_report")
    section = measured.load(STRESS).get("exact")
    if section is None:
        return "Not measured yet: `python -m curriculum.stress.exact_sweep`.\n"
    note = measured.stale_note(section)
    return (f"{note}\n\n" if note else "") + report.readme_block(section) + "\n"


OTHERS = {"stress": stress, "exact": exact}


# filling them in


def printed(flags):
    """What contact.py prints for `flags`, fenced; without the banner and the lines that name files."""
    with tempfile.TemporaryDirectory() as out:
        run = subprocess.run(
            [sys.executable, "contact.py", *flags, "--no-rerun", "--out", out],
            cwd=measured.ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
    lines = [
        line
        for line in run.stdout.splitlines()
        if not line.startswith(("[", "metrics:", "config_hash:", "next, "))
    ]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def fill(text):
    """The README's text with our blocks made anew. Raises ValueError for a name that is none of ours."""

    def made(match):
        if match["command"].startswith("python contact.py"):
            return match[1] + printed(match["command"].split()[2:])
        if match["command"] != COMMAND:
            return match[0]
        if match["name"] not in (*BLOCKS, *OTHERS):
            line = text.count("\n", 0, match.start()) + 1
            raise ValueError(
                f"README.md:{line}: no generated block {match['name']!r}; "
                f"there are: {', '.join((*BLOCKS, *OTHERS))}"
            )
        return match[1] + block(match["name"])

    return BLOCK.sub(made, text)


@stoppable
def main(argv=None):
    """Write the README's blocks, or with --check only compare them. Returns the exit status."""
    parser = argparse.ArgumentParser(prog=COMMAND, description="The README's generated blocks.")
    parser.add_argument("--check", action="store_true", help="only compare, exit 1 if one differs")
    args = parser.parse_args(argv)
    text = README.read_text(encoding="utf-8")
    try:
        new = fill(text)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    if args.check and new != text:
        old, now = text.splitlines(), new.splitlines()
        line = next(
            (k for k, (a, b) in enumerate(zip(old, now)) if a != b), min(len(old), len(now))
        )
        print(
            f"README.md:{line + 1}: a generated block is out of date; to repair: {COMMAND}",
            file=sys.stderr,
        )
        return 1
    if new != text:
        write_whole(str(README), new)
    count = sum(
        match["command"] == COMMAND or match["command"].startswith("python contact.py")
        for match in BLOCK.finditer(text)
    )
    print(f"README.md: {count} generated blocks {'are up to date' if args.check else 'written'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
