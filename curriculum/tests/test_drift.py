"""The gate: a small project in order passes; every way to drift fails with a line and a repair."""

import json
import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from curriculum import check_prose_code_drift as gate
from curriculum import measured, quoted, regions
from curriculum.common import wallclock
from curriculum.drift import fuzz, names, passages

ROOT = Path(__file__).resolve().parents[2]
CHAPTER = gate.CHAPTER

CONTACT = '''"""A stand-in for the chapter's script."""
# --- region: setup ---
import json
import sys

MARGIN = 1e-3
# --- endregion ---


# --- region: report-it ---
def main(flags, sweeps=20):
    if "--help" in flags:
        print("--help --out OUT --no-rerun --deep --dt DT --scene {drop,stack}")
        sys.exit(0)
    out = flags[flags.index("--out") + 1]
    metrics = {"dt": 0.002, "steps": 2000, "quality": {"lcp": {"depth": 0.056743, "step": None},
               "penalty": {"depth": 0.9 if "--deep" in flags else 0.251329}}}
    with open(out + "/metrics.json", "w") as file:
        json.dump(metrics, file)
    print("config_hash:", "c0ffee")


main(sys.argv[1:])
# --- endregion ---
'''
EXACT = '''"""A second literate file."""
# --- region: events ---
def next_event():
    return 0.0
# --- endregion ---


# --- region: helpers ---
def root_of():
    return 1.0
# --- endregion ---
'''
SCRIPT = '''"""Exercise 1. Bet, then run

    python exercises/ex1_bet.py --hint
"""
CHOICES = {"A": "It rests on the table.", "B": "It goes in."}
PREDICTION = None
if __name__ == "__main__":
    print("--hint --help")
'''
TEXT = """# 3.5: Contact

The script sets up like this, and `main` comes last. ![A ball](ball.svg)

```
[include-by-region: contact.py#setup]
```

## What it measures

```
[include-by-region: contact.py#report-it]
```

The spring lets in {{quality.penalty.depth|.3f}} r, {{deep:quality.penalty.depth|.1f}} r if soft,
{{quality.penalty.depth / quality.lcp.depth|.1f}} times lcp's. Laptop: {{wallclock.cpu-laptop}}.
<!-- holds: quality.penalty.depth > 4 * quality.lcp.depth -->
Run `python contact.py --dt 0.03`, see ex2, chapter 3.3, [the source](https://example.org/3.1/a12).
The margin is {{contact.MARGIN|.3f}} m; {{contact.main.sweeps}} sweeps. A stack of three sinks twice.

<!-- exercise: ex1 -->

<!-- figure: corner -->

The limit is $k dt^2 + 2 c dt < 4 m$, and [a long step](try:scene=drop&dt=0.03) shows it.

```
[include-by-region: curriculum/exact.py#events]
```

## What comes next

Friction is for chapter 3.6. `mj_solver` has it.
"""
META = """objectives:
  - See it.

reading:
  repo: example.org

runs:
  first: []
  deep: [--deep]

reference_run:
  provenance: none yet
  values:
    dt: 0.002

exercises:
  ex1:
    answer: B
    bands:
      quality.penalty.depth: [0.2513, 0.2514]
    holds:
      - deep:quality.penalty.depth > quality.penalty.depth
    true_if:
      A: [quality.penalty.depth <= 0]
      B: [quality.penalty.depth > 0.1]
    hints:
      - Why?
    reveal:
      A: It does not.
      B: It goes in {{quality.penalty.depth|.3f}} r.

scope:
  section: What comes next
  words: [chapter 3.6, next chapter]

not_shown: [helpers]
foreign_names: [mj_solver]
stale: []

region_hashes:

passage_hashes:
"""
LEDGER = f"{','.join(wallclock.COLUMNS)}\n{wallclock.CHAPTER},cpu-laptop,,,,,PENDING\n"
NAMES = (
    "contact-docstring setup report-it exact-docstring events helpers outline claims formulas "
    "number-words turning-words typed-numbers readme-words ex1 promises"
).split()
GIT = ("-c", "user.name=a", "-c", "user.email=a@b")


@pytest.fixture(scope="session")
def whole_project(tmp_path_factory, measured_row):
    """A project in order: two literate files, everything accepted; made once, and committed."""
    folder = tmp_path_factory.mktemp("project")
    for file, text in (
        ("contact.py", CONTACT),
        ("curriculum/exact.py", EXACT),
        ("exercises/ex1_bet.py", SCRIPT),
        (CHAPTER, TEXT),
        ("curriculum/prose/ball.svg", "<svg/>"),
        ("README.md", "# A ball\n\n```sh\npython contact.py --scene drop\n```\n"),
        ("meta.yaml", META),
        ("wallclock.csv", LEDGER),
    ):
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text)
    measured_row(folder, [0.24, 0.25, 0.23])
    for name in NAMES:
        gate.accept(folder, name)
    quoted.record(folder)
    for words in (["init", "-q"], ["add", "."], [*GIT, "commit", "-qm", "x"]):
        subprocess.run(["git", *words], cwd=folder, check=True)
    return folder


@pytest.fixture
def project(whole_project, tmp_path, capsys):
    """A copy of it, to be changed."""
    shutil.copytree(whole_project, tmp_path / "project")
    capsys.readouterr()
    return tmp_path / "project"


@pytest.fixture(scope="session")
def made_runs(whole_project):
    """The two runs of the project, for checks in which no code has changed."""
    numbers = quoted.Numbers(whole_project)
    numbers.run_all()
    return numbers.runs, numbers.config_hash


def runs_of(project, made_runs):
    """Numbers with those runs, unless the code or the runs of meta.yaml are others by now."""
    files = [*sorted(project.glob("*.py")), project / "meta.yaml"]
    texts = "".join(file.read_text("utf-8", "replace") for file in files)
    if CONTACT not in texts or "runs:\n  first: []\n  deep: [--deep]" not in texts:
        return None
    numbers = quoted.Numbers(project, runs=made_runs[0])
    numbers.config_hash = dict(made_runs[1])
    return numbers


def edit(project, file, old, new, count=1):
    data = (project / file).read_bytes()
    old, new = (text if isinstance(text, bytes) else text.encode() for text in (old, new))
    assert data.count(old) >= 1, (file, old)
    (project / file).write_bytes(data.replace(old, new, count))


def snapshot(folder):
    return {
        path: (path.stat().st_mtime_ns, path.read_bytes())
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".git" not in path.parts
    }


def test_a_project_in_order_passes_and_the_check_writes_nothing(project, capsys):
    before = snapshot(project)
    assert gate.main(["--root", str(project)]) == 0
    assert capsys.readouterr().out == "chapter, code, numbers and ledger agree\n"
    assert snapshot(project) == before


FIRST = "  contact.py:\n"
DRIFT = {
    "an edited region": (
        ("contact.py", "import sys", "import sys  # changed"),
        r"contact.py:2: region setup has changed since .*--accept setup",
    ),
    "an edited region of another file": (
        ("curriculum/exact.py", "return 0.0", "return 0.1"),
        r"curriculum/exact.py:2: region events has changed since .*--accept events",
    ),
    "an edited region that is not shown": (
        ("curriculum/exact.py", "return 1.0", "return 1.1"),
        r"curriculum/exact.py:8: region helpers has changed",
    ),
    "an edited docstring": (
        ("contact.py", "A stand-in", "No stand-in"),
        r"contact.py:1: region contact-docstring has changed since .*--accept contact-docstring",
    ),
    "a removed hash": (
        ("meta.yaml", "    report-it:", "    # report-it:"),
        r"contact.py:10: region report-it has no hash in meta.yaml; repair: .*--accept report-it",
    ),
    "a hash without a region": (
        ("meta.yaml", FIRST, FIRST + "    old: abc\n"),
        r"meta.yaml:\d+: a hash of old, and contact.py has no such region",
    ),
    "regions in another order": (
        (
            "curriculum/exact.py",
            EXACT[EXACT.index("# ---") :],
            EXACT[EXACT.index("\n\n# ---") + 2 :]
            + "\n\n"
            + EXACT[EXACT.index("# ---") : EXACT.index("\n\n# ---")],
        ),
        r"meta.yaml:\d+: the regions of curriculum/exact.py are no longer in the order",
    ),
    "one name in two files": (
        ("curriculum/exact.py", "region: helpers", "region: setup"),
        r"curriculum/exact.py:8: a second region setup; the other is in contact.py",
    ),
    "an unknown include": (
        (CHAPTER, "contact.py#setup", "contact.py#setpu"),
        rf"{CHAPTER}:6: includes setpu, and contact.py has no such region; repair: name one ",
    ),
    "an include from the wrong file": (
        (CHAPTER, "curriculum/exact.py#events", "contact.py#events"),
        rf"{CHAPTER}:28: includes events, and contact.py has no such region",
    ),
    "a region never shown": (
        (CHAPTER, "```\n[include-by-region: contact.py#setup]\n```", ""),
        rf"{CHAPTER}:1: region setup is never shown",
    ),
    "a region that should not be shown": (
        (CHAPTER, "curriculum/exact.py#events", "curriculum/exact.py#helpers"),
        r"meta.yaml:\d+: not_shown names helpers, which is shown",
    ),
    "a hidden region that is gone": (
        ("meta.yaml", "not_shown: [helpers]", "not_shown: [helpers, help]"),
        r"meta.yaml:\d+: not_shown names help, which is no region",
    ),
    "an include outside a fence": (
        (
            CHAPTER,
            "```\n[include-by-region: contact.py#setup]\n```",
            "[include-by-region: contact.py#setup]",
        ),
        rf"{CHAPTER}:5: an include that is not alone",
    ),
    "an include of another file": (
        (CHAPTER, "contact.py#setup", "other.py#setup"),
        rf"{CHAPTER}:6: includes setup, and other.py has no such region",
    ),
    "an include twice": (
        (CHAPTER, "contact.py#report-it", "contact.py#setup"),
        rf"{CHAPTER}:12: includes setup a second",
    ),
    "includes swapped": (
        (
            CHAPTER,
            TEXT[TEXT.index("[include") : TEXT.index("it]")],
            TEXT[TEXT.index("[include") : TEXT.index("it]")]
            .replace("#setup", "#tmp")
            .replace("#report-", "#setup]")
            .replace("#tmp", "#report-it"),
        ),
        rf"{CHAPTER}:1: passage outline has changed since it was last read; .*--accept outline",
    ),
    "a slot left out": (
        (CHAPTER, "<!-- exercise: ex1 -->", ""),
        rf"meta.yaml:\d+: ex1: {CHAPTER} has 0 slots <!-- exercise: ex1 -->, not one",
    ),
    "a figure left out": (
        (CHAPTER, "<!-- figure: corner -->", ""),
        rf"{CHAPTER}:1: passage outline has changed",
    ),
    "a slot of no exercise": (
        (CHAPTER, "exercise: ex1", "exercise: ex7"),
        rf"{CHAPTER}:1: a slot of ex7, and meta.yaml has no such exercise",
    ),
    "a region renamed": (
        ("contact.py", "region: setup", "region: start"),
        r"contact.py:2: region start has no hash",
    ),
    "a nested marker": (
        ("contact.py", "import sys\n", "import sys\n# --- region: x ---\n"),
        r"contact.py:5: region x begins inside region setup",
    ),
    "an unclosed marker": (
        ("contact.py", "main(sys.argv[1:])\n# --- endregion ---\n", "main(sys.argv[1:])\n"),
        r"contact.py:10: region report-it is never closed",
    ),
    "a duplicate marker": (
        ("contact.py", "region: report-it", "region: setup"),
        r"contact.py:10: a second region setup",
    ),
    "CRLF": (("contact.py", "import sys\n", "import sys\r\n"), r"contact.py:4: a carriage return"),
    "CRLF in the chapter": (
        (CHAPTER, "comes last.", "comes last.\r"),
        rf"{CHAPTER}:3: a carriage return",
    ),
    "a chapter that is not UTF-8": (
        (CHAPTER, "like this", b"like \xff"),
        rf"{CHAPTER}:3: a byte that is not UTF-8",
    ),
    "bytes that are not UTF-8": (
        ("contact.py", "stand-in", b"stand-\xff"),
        r"contact.py:1: byte 0xff is not UTF-8",
    ),
    "code outside a region": (
        ("contact.py", "\n\n# --- region: report-it", "\nx = 1\n# --- region: report-it"),
        r"contact.py:9: code outside any region",
    ),
    "a false number in the prose": (
        (CHAPTER, "{{quality.penalty.depth|.3f}} r,", "0.251 r,"),
        rf"{CHAPTER}:15: a typed number, 0.251; repair: write",
    ),
    "a number in words changed": (
        (CHAPTER, "A stack of three", "A stack of four"),
        rf"{CHAPTER}:1: passage number-words has changed .*--accept number-words",
    ),
    "a word turned round": (
        (CHAPTER, "and `main` comes last.", "and `main` never comes last."),
        rf"{CHAPTER}:1: passage turning-words has changed .*--accept turning-words",
    ),
    "a word of the README turned round": (
        ("README.md", "# A ball\n", "# A ball\n\nIt is not deep.\n"),
        r"README.md:1: passage readme-words has changed .*--accept readme-words",
    ),
    "a formula changed": (
        (CHAPTER, "2 c dt", "4 c dt"),
        rf"{CHAPTER}:1: passage formulas has changed .*--accept formulas",
    ),
    "a reference to another number": (
        (CHAPTER, "{{deep:quality.penalty.depth|.1f}}", "{{quality.penalty.depth|.1f}}"),
        rf"{CHAPTER}:1: passage claims has changed",
    ),
    "a claim left out": (
        (CHAPTER, "<!-- holds: quality.penalty.depth > 4 * quality.lcp.depth -->", ""),
        rf"{CHAPTER}:1: passage claims has changed",
    ),
    "a claim loosened": ((CHAPTER, "> 4 *", "> 3 *"), rf"{CHAPTER}:1: passage claims has changed"),
    "a typed number in a code span": (
        (CHAPTER, "--dt 0.03`", "--dt 0.03` and `0.2513`"),
        rf"{CHAPTER}:18: a typed number",
    ),
    "a typed table in a fence": (
        (CHAPTER, "## What comes", "```\npenalty 0.25\n```\n\n## What comes"),
        rf"{CHAPTER}:32: a typed number, 0.25",
    ),
    "a typed number without a reason": (
        (CHAPTER, "{{wallclock.cpu-laptop}}", "{{= 3 |}}"),
        rf"{CHAPTER}:16: .*needs a reason",
    ),
    "a typed number with a reason, not accepted": (
        (CHAPTER, "{{wallclock.cpu-laptop}}", "{{= 9.99 | I say so}}"),
        rf"{CHAPTER}:1: passage typed-numbers has changed",
    ),
    "a typed number in an exercise": (
        ("meta.yaml", "It goes in", "It goes in 12 and"),
        r"meta.yaml:\d+: a typed number, 12",
    ),
    "a reference to nothing": (
        (CHAPTER, "{{quality.penalty.depth|", "{{quality.penalty.width|"),
        rf"{CHAPTER}:15: .*no 'width'; known there: depth",
    ),
    "a reference to an unknown run": (
        (CHAPTER, "{{deep:", "{{deeper:"),
        rf"{CHAPTER}:15: .*no run 'deeper'",
    ),
    "a reference to a null": (
        (CHAPTER, "{{quality.penalty.depth|.3f}}", "{{quality.lcp.step|.3f}}"),
        rf"{CHAPTER}:15: .*no number",
    ),
    "a fraction without format": (
        (CHAPTER, "{{quality.penalty.depth|.3f}}", "{{quality.penalty.depth}}"),
        rf"{CHAPTER}:15: .*needs a format",
    ),
    "a constant that is gone": (
        (CHAPTER, "contact.MARGIN", "contact.MARGINS"),
        rf"{CHAPTER}:19: .*no 'MARGINS'; known there: MARGIN, main",
    ),
    "a benchmark not run yet": (
        (CHAPTER, "{{wallclock.cpu-laptop}}", "{{bench:drop|.2f}}"),
        rf"{CHAPTER}:16: .*curriculum/bench has no results yet: python -m curriculum.bench",
    ),
    "a claim that does not hold": ((CHAPTER, "> 4 *", "> 5 *"), rf"{CHAPTER}:17: .*does not hold"),
    "a claim that cannot be read": (
        (CHAPTER, "> 4 *", "is more than 4 *"),
        rf"{CHAPTER}:17: .*is not 'EXPRESSION",
    ),
    "numbers that moved": (
        ("contact.py", "0.251329", "0.251330"),
        r"meta.yaml:\d+: reference_run says quality.penalty.depth is "
        r"0.251329, a fresh run gives 0.25133; repair: python -m curriculum.quoted --record",
    ),
    "a reference number removed": (
        ("meta.yaml", "    quality.penalty.depth: 0", "    # 0"),
        r"meta.yaml:\d+: reference_run says quality.penalty.depth is missing",
    ),
    "a false reference number": (
        ("meta.yaml", "    steps: 2000", "    steps: 2001"),
        r"meta.yaml:\d+: .*steps is 2001, a fresh run gives 2000",
    ),
    "another default run": (
        ("contact.py", "c0ffee", "decaff"),
        r"meta.yaml:\d+: reference_run says config_hash is c0ffee, a fresh run gives decaff",
    ),
    "an answer out of its band": (
        ("meta.yaml", "[0.2513, 0.2514]", "[0.2514, 0.2515]"),
        r"meta.yaml:\d+: ex1, .* outside 0.2514 to 0.2515",
    ),
    "a band opened": (
        ("meta.yaml", "[0.2513, 0.2514]", "[0, 99999]"),
        r"meta.yaml:\d+: ex1: the band \[0, 99999\] of quality.penalty.depth is wider than 1%",
    ),
    "an answer that is not true": (
        ("meta.yaml", "- deep:quality.penalty.depth >", "- deep:quality.penalty.depth <"),
        r"meta.yaml:\d+: ex1, .*does not hold",
    ),
    "another letter": (
        ("meta.yaml", "answer: B", "answer: A"),
        r"meta.yaml:\d+: ex1, .*choice B is true, and the answer is said to be A",
    ),
    "a letter of no choice": (
        ("meta.yaml", "answer: B", "answer: D"),
        r"meta.yaml:\d+: ex1: the answer 'D' is none of the choices \['A', 'B'\]",
    ),
    "a choice without its claims": (
        ("meta.yaml", "      A: [quality.penalty.depth <= 0]\n", ""),
        r"meta.yaml:\d+: ex1: true_if has \['B'\], the choices are \['A', 'B'\]",
    ),
    "a choice reworded": (
        ("exercises/ex1_bet.py", "It rests on", "It rests under"),
        r"meta.yaml:\d+: passage ex1 has changed since it was last read; .*--accept ex1",
    ),
    "an objective changed": (
        ("meta.yaml", "- See it.", "- Hear it."),
        r"meta.yaml:\d+: passage promises has changed",
    ),
    "a stale ledger claim": (
        ("curriculum/exact.py", "return 1.0", "return 1.5"),
        r"meta.yaml:\d+: wallclock:cpu-vm was measured on other code than today's; "
        r"repair: python -m curriculum.common.wallclock --measure",
    ),
    "stale by name, and is not": (
        ("meta.yaml", "stale: []", "stale: [wallclock:cpu-vm]"),
        r"meta.yaml:\d+: stale names wallclock:cpu-vm, which is not",
    ),
    "a broken ledger": (
        ("wallclock.csv", "MEASURED", "GUESSED"),
        r"wallclock.csv:6: status 'GUESSED'; allowed",
    ),
    "a function that is not there": (
        (CHAPTER, "and `main` comes", "and `mian` comes"),
        rf"{CHAPTER}:3: `mian` names mian, which no code here defines",
    ),
    "a flag that is not there": (
        (CHAPTER, "see ex2,", "or `--sharp`, see ex2,"),
        rf"{CHAPTER}:18: no command here has a flag --sharp",
    ),
    "a command with a wrong flag": (
        (CHAPTER, "python contact.py --dt", "python contact.py --td"),
        rf"{CHAPTER}:18: the command `python contact.py --td 0.03`: contact.py has no --td",
    ),
    "a command with a wrong choice": (
        ("README.md", "--scene drop", "--scene dorp"),
        r"README.md:4: the command .*: contact.py --scene takes drop,stack, not 'dorp'",
    ),
    "a command of no file": (
        ("README.md", "python contact.py", "python contcat.py"),
        r"README.md:4: .*there is no contcat.py",
    ),
    "a docstring's command": (
        ("exercises/ex1_bet.py", "ex1_bet.py --hint", "ex1_bet.py --hints"),
        r"exercises/ex1_bet.py:3: the command .* has no --hints",
    ),
    "a live link to a flag that is not there": (
        (CHAPTER, "scene=drop&dt", "scene=drop&td"),
        rf"{CHAPTER}:25: a try: link to scene=drop&td=0.03: contact.py has no --td",
    ),
    "a missing image": (
        (CHAPTER, "ball.svg", "bowl.svg"),
        rf"{CHAPTER}:3: a link to bowl.svg, and there is no such file",
    ),
    "a source not named": (
        ("meta.yaml", "repo: example.org", "repo: example.com"),
        r"meta.yaml:\d+: reading promises example.com, and .* does not name it",
    ),
    "scope said in the script": (
        ("contact.py", "A stand-in", "Friction comes in the next chapter. A stand-in"),
        r"contact.py:1: 'next chapter' is said outside",
    ),
    "scope said twice in the chapter": (
        (CHAPTER, "The script sets", "In chapter 3.6 we push. The script sets"),
        rf"{CHAPTER}:3: 'chapter 3.6' is said outside",
    ),
    "no section for the scope": (
        (CHAPTER, "## What comes next", "## The end"),
        r"meta.yaml:\d+: scope.section 'What comes next' is no heading",
    ),
    "a script that fails": (
        ("contact.py", "    out =", "    raise SystemExit('broken')\n    out ="),
        r"contact.py:1: contact.py.* fails: broken",
    ),
    "meta.yaml that is not YAML": (("meta.yaml", "runs:", "runs: ]"), r"meta.yaml:\d+: not YAML"),
    "no runs": (("meta.yaml", "runs:\n", "walks:\n"), r"meta.yaml:1: no `runs`"),
}


@pytest.mark.parametrize("change, message", DRIFT.values(), ids=DRIFT)
def test_drift_fails_with_file_line_and_repair(project, made_runs, change, message):
    edit(project, *change)
    before = snapshot(project)
    problems = gate.check(project, runs_of(project, made_runs))
    assert [line for line in problems if re.match(message, line)], "\n".join(problems)
    assert all(re.match(r"[\w./]+:\d+: .+; repair: .+", line) for line in problems), "\n".join(
        problems
    )
    assert snapshot(project) == before


def test_the_command_lists_the_problems_and_fails(project, capsys):
    edit(project, CHAPTER, "2 c dt", "4 c dt")
    assert gate.main(["--root", str(project)]) == 1
    assert "--accept formulas" in capsys.readouterr().err


def test_what_is_stale_says_so_in_the_text_and_passes_once_it_is_named(project, made_runs):
    edit(project, "curriculum/exact.py", "return 1.0", "return 1.5")
    edit(project, "meta.yaml", "stale: []", "stale: [wallclock:cpu-vm]")
    gate.accept(project, "helpers")
    numbers = runs_of(project, made_runs)
    assert gate.check(project, numbers) == []
    assert numbers.text("wallclock.cpu-vm") == (
        "0.004 min (0.24 s) (stale: `python -m curriculum.common.wallclock --measure`)"
    )


def test_results_measured_on_other_code_say_so_and_fail(project, made_runs):
    folder = project / "curriculum/bench/results"
    folder.mkdir(parents=True)
    about = {"command": "python -m curriculum.bench drop", "code": {"contact.py": "0" * 12}}
    (folder / "results.json").write_text(json.dumps({"drop": {"measured": about, "ms": 3}}))
    numbers = runs_of(project, made_runs)
    assert numbers.text("bench:drop.ms") == "3 (stale: `python -m curriculum.bench drop`)"
    assert any(
        "bench:drop was measured on other code than today's; repair: python -m curriculum.bench drop"
        in line
        for line in gate.check(project, numbers)
    )
    about["code"]["contact.py"] = measured.code_hash("contact.py", project)
    (folder / "results.json").write_text(json.dumps({"drop": {"measured": about, "ms": 3}}))
    numbers = runs_of(project, made_runs)
    assert numbers.text("bench:drop.ms") == "3" and gate.check(project, numbers) == []


@pytest.mark.parametrize("file", ["contact.py", "meta.yaml", CHAPTER])
def test_a_missing_file_fails(project, file):
    (project / file).unlink()
    assert gate.check(project) == [f"{file}:1: missing; repair: git checkout {file}"]


TYPED = {
    "The ball rests 0.00981 r deep.": ["0.00981"],
    "About 1,409 times.": ["1,409"],
    "By 25 % or -3.": ["25", "3"],
    "About ¼ r.": ["¼"],
    "| penalty | 0.25 |": ["0.25"],
    "2x": ["2x"],
    "`0.25`": ["0.25"],
    "`dt = 0.03`": ["0.03"],
    "$x = 0.25$": ["0.25"],
    "```\nr = 17\n```": ["17"],
    "Python code: 3.11": ["3.11"],
    "a [0.3](x)": ["0.3"],
    "exercise ex2, v0, H2O": [],
    "chapter 3.3 and 3.4, Python 3.11, version 2": [],
    "release 3.10.0": [],
    "`--dt 0.03 --steps=400`": [],
    "`v[0]`, `2 sqrt(m / k)`": [],
    "$4 m$": [],
    "[a](http://x.org/12) https://x.org/3.4": [],
    "## 3.5: Contact\n1. one\n2. two": [],
    '<!-- 12 --> <img width="40">': [],
    "{{a.b|.3f}} {{= 1972 | year}}": [],
    "commit `28009f9105cd`": [],
    "[1]: http://x": [],
}


@pytest.mark.parametrize("text, found", TYPED.items())
def test_the_rule_for_typed_numbers(text, found):
    assert [token for _, token in gate.typed_numbers(text)] == found


def test_accepting_shows_the_change_and_every_passage_that_names_it_and_records_one_hash(
    project, capsys
):
    edit(project, "contact.py", 'print("config_hash:"', 'print("config_hash: "')
    edit(project, "curriculum/exact.py", "return 1.0", "return 1.5")
    edit(project, "README.md", "# A ball\n", "# A ball\n\nAll begins with main().\n")
    edit(project, CHAPTER, "is for chapter 3.6.", "is for chapter 3.6, with `main` again.")
    before = passages.recorded(quoted.load_meta(project))
    assert gate.main(["--root", str(project), "--accept", "report-it"]) == 0
    out = capsys.readouterr().out
    assert '-    print("config_hash:", "c0ffee")\n+    print("config_hash: ", "c0ffee")\n' in out
    assert "1.5" not in out
    assert f"{CHAPTER}:12 shows it; the section, lines 9 to 30, says:" in out
    assert "The spring lets in" in out
    assert f"{CHAPTER}:3 names what it defines:\n\n       The script sets up like this" in out
    assert f"{CHAPTER}:33 names what it defines:\n\n       Friction is for" in out
    assert "README.md:3 names what it defines:\n\n       All begins with main()." in out
    after = passages.recorded(quoted.load_meta(project))
    assert f"(before: {before['report-it']})" in out
    assert after["report-it"] == regions.find(project / "contact.py")["report-it"].sha256
    assert {name for name in after if after[name] != before[name]} == {"report-it"}
    problems = gate.check(project)
    assert not any("report-it" in line for line in problems)
    assert any("region helpers has changed" in line for line in problems)


def test_accepting_a_passage_shows_what_changed_in_it(project, capsys):
    edit(project, CHAPTER, "2 c dt", "4 c dt")
    edit(project, "meta.yaml", "answer: B", "answer: A")
    assert gate.main(["--root", str(project), "--accept", "formulas", "ex1"]) == 0
    out = capsys.readouterr().out
    assert "-k dt^2 + 2 c dt < 4 m\n+k dt^2 + 4 c dt < 4 m\n" in out
    assert '-  "answer": "B",' in out and '+  "answer": "A",' in out
    before = snapshot(project)
    assert gate.main(["--root", str(project), "--accept", "formulas"]) == 0
    assert "nothing to accept" in capsys.readouterr().out and snapshot(project) == before


def test_without_git_accepting_says_so_and_shows_the_whole_region(project, capsys, monkeypatch):
    edit(project, "contact.py", "import sys", "import sys  # changed")
    monkeypatch.setenv("PATH", "")
    gate.accept(project, "setup")
    out = capsys.readouterr().out
    assert (
        "no git history here, so the whole passage is shown" in out
        and "+import json\n+import sys  # changed" in out
    )


def test_accepting_a_region_that_is_gone_removes_its_hash_and_keeps_the_rest_of_the_file(
    project, capsys
):
    text = (project / "meta.yaml").read_text()
    edit(project, "meta.yaml", FIRST, FIRST + "    old: abc\n")
    gate.accept(project, "old")
    assert (project / "meta.yaml").read_text() == text


def test_accepting_what_is_unknown_or_malformed_changes_nothing(project, capsys):
    before = snapshot(project)
    assert gate.main(["--root", str(project), "--accept", "nonsense"]) == 2
    assert "given 'nonsense', allowed: contact-docstring, setup" in capsys.readouterr().err
    assert snapshot(project) == before
    edit(project, "contact.py", "region: report-it", "region: setup")
    before = snapshot(project)
    assert gate.main(["--root", str(project), "--accept", "setup"]) == 2
    assert snapshot(project) == before


def test_recording_the_reference_run_twice_changes_nothing_and_keeps_the_rest_of_meta(project):
    before = (project / "meta.yaml").read_text()
    assert quoted.record(project) == []
    edit(project, "meta.yaml", "    steps: 2000\n", "    steps: 1\n    gone: 2\n")
    assert any("gone" in line for line in quoted.record(project))
    assert (project / "meta.yaml").read_text() == before


def test_a_text_is_rendered_with_generated_numbers(project, made_runs):
    shown = runs_of(project, made_runs).render(
        (project / CHAPTER).read_text() + "{{= 1972 | year}} {{steps}}"
    )
    assert "lets in 0.251 r, 0.9 r if soft,\n4.4 times" in shown
    assert "Laptop: not yet measured." in shown and shown.endswith("1972 2000")
    assert "The margin is 0.001 m; 20 sweeps." in shown


def test_keys_that_hold_dots_and_list_places_are_found(project):
    made = quoted.Numbers(project, runs={"first": {"a": {"0.002": [{"b": 7}]}}})
    assert made.value("a.0.002.0.b") == 7 and made.text("a.0.002.0.b") == "7"


@pytest.mark.parametrize(
    "value, form, shown",
    [(3.04, "words", "three"), (2, "times", "twice"), (2.97, "times", "three times")],
)
def test_a_number_can_be_put_into_words(project, value, form, shown):
    assert quoted.Numbers(project, runs={"first": {"a": value}}).text(f"a|{form}") == shown


@pytest.mark.parametrize("value", [2.5, 13, -1, 0.3])
def test_what_is_no_whole_number_is_not_put_into_words(project, value):
    with pytest.raises(ValueError, match="no whole number from 0 to 12"):
        quoted.Numbers(project, runs={"first": {"a": value}}).text("a|words")


def test_constants_are_read_without_running_the_file():
    found = quoted.constants(
        "A = 1e-3\nB: int = 2\nC = A\nD = print()\n"
        "def f(x, y=3, z=A, w=len('')): pass\nraise SystemExit\n"
    )
    assert found == {"A": 1e-3, "B": 2, "C": 1e-3, "f": {"y": 3, "z": 1e-3}}


COMMANDS = {
    "python contact.py --scene stack --dt=0.1": None,
    ".venv/bin/python contact.py --out /tmp": None,
    "python3 -m venv .venv && .venv/bin/python contact.py --dt 1": None,
    "python3 -m venv .venv && .venv/bin/python contact.py --td 1": "contact.py has no --td",
    "uv run contact.py --scene drop": None,
    "uv run contact.py --scene dorp": "takes drop,stack, not 'dorp'",
    "python -m curriculum.none": "there is no curriculum.none",
    "python -m curriculum.quoted --record": "there is no curriculum.quoted",
    "python contact.py --scene SCENE": None,
    "pip install -e '.[tset]'": "no extra 'tset'",
    "pytest checks.py -k ex2": "there is no checks.py",
    "python -m pytest -n 2 --dist loadfile": None,
    "python -m pytest -n 2 --dit loadfile": "pytest: --dit is none of the flags",
    "uv run --extra learn pytest": "no extra 'learn'",
    "uv run --exrta learn pytest": "uv run: --exrta is none of the flags",
    "uv run --with numpy contact.py --dt 1": None,
    "python contact.py 'unclosed": "cannot be read",
}


@pytest.mark.parametrize("command, said", COMMANDS.items(), ids=COMMANDS)
def test_commands_are_held_to_files_modules_flags_and_choices(project, command, said):
    found = names.command_problem(project, command)
    assert found is None if said is None else said in found


# The real chapter


def test_the_real_project_is_in_order(real_numbers):
    assert gate.check(ROOT, real_numbers) == []


def test_one_character_changed_in_any_region_of_the_real_scripts_changes_its_hash_alone():
    read = passages.reader(ROOT)[0]
    found, problems = regions.scan_all(ROOT)
    assert len(found) > 40 and problems == []
    for region in found.values():
        before = read(region.file)
        start = before.index(region.text) if region.text in before else 0
        line = next(line for line in region.text.splitlines() if re.search(r"\w{3}", line))
        letters = [k for k, letter in enumerate(line) if letter.isalnum()]
        at = before.index(line, start) + random.Random(region.name).choice(letters)
        wrong = before[:at] + ("b" if before[at] != "b" else "d") + before[at + 1 :]
        scan = regions.Scan(wrong.encode(), region.file)
        changed = {
            each.name
            for each in (scan.docstring, *scan.regions.values())
            if each.sha256 != found[each.name].sha256
        }
        assert changed == {region.name}


# Random changes


def test_the_fuzzer_changes_what_it_says_catches_it_and_lists_what_passes(project, capsys):
    plain = (
        "Whoever wonders about gravel, teapots, lanterns, violins, harbours and gardens reads on."
    )
    edit(
        project, CHAPTER, "The script sets up", f"It never sinks deeper. {plain} The script sets up"
    )
    gate.accept(project, "turning-words")
    capsys.readouterr()
    assert gate.main(["--root", str(project), "--fuzz", "70"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^an answer +[1-9]\d* +[1-9]", out, re.M)
    print(out)
    assert re.search(r"^a word turned round +[1-9]\d* +[1-9]", out, re.M)
    assert re.search(rf"^passed \(open\): {CHAPTER}:\d+: any word of the text: ", out, re.M)
    assert "70 changes, seed 0: " in out and out.endswith(
        "0 of them of a kind that the gate must catch\n"
    )


def test_the_fuzzer_makes_the_same_changes_again_and_leaves_the_project_as_it_is(project):
    before = snapshot(project)
    first, second = (fuzz.run(project, 25, seed=3) for _ in range(2))
    assert first == second and sum(first[0].values()) == 25
    assert snapshot(project) == before


def test_a_hole_in_the_gate_is_found_and_fails(project, capsys, monkeypatch):
    """Without the check of passages, changes of formulas and of numbers in words would pass."""
    monkeypatch.setattr(
        gate, "STATIC", tuple(part for part in gate.STATIC if part is not gate.check_passages)
    )
    assert gate.main(["--root", str(project), "--fuzz", "60"]) == 1
    out = capsys.readouterr().out
    assert re.search(rf"^passed: {CHAPTER}:25: a formula: ", out, re.M)
    assert re.search(rf"^passed: {CHAPTER}:19: a number in words: ", out, re.M)


def test_a_project_that_is_not_in_order_is_not_fuzzed(project, capsys):
    edit(project, CHAPTER, "2 c dt", "4 c dt")
    assert gate.main(["--root", str(project), "--fuzz", "5"]) == 1
    assert "not in order before any change:" in capsys.readouterr().err
