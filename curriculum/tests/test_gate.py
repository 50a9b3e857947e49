"""The gate on a small project of its own: the real contact.py, a short chapter and README."""

import compileall
import hashlib
import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from curriculum import stored
from curriculum.gate import chapter, references
from curriculum.lesson import regions
from curriculum.tests.helpers import ROOT, python

yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")
CHAPTER, CLAMP = "curriculum/prose/chapter.md", "curriculum/page/figures/clamp.js"
EXERCISE, MADE = "exercises/ex1_bet.py", "curriculum/bench/results/made.json"
OPENINGS = ["contact.py", "figures/clamp"]
PENDING = "chapter,tier,wallclock_min,config_hash,commit,date,status\n"
PENDING += "ch3.5-contact,t4,,,,,PENDING\n"
FILES = {
    CHAPTER: """# Chapter

## A sponge

The ball rests {{quality.penalty.rest_penetration_frac|.5f}} r deep, seen from a margin of
{{contact.CONTACT_MARGIN * 1000|.0f}} mm, and [drops](#x) by {{fact:jump.before|.4f}} m/s.
{{? quality.penalty.rest_penetration_frac > quality.lcp.rest_penetration_frac}}

## A sweep

One sweep of `solve_contacts` pushes, as with `--iters 1`. Python 3.10 and $k = 10$ are not typed.
<!-- figure: clamp -->
<!-- exercise: ex1 -->

## Code
""",
    "README.md": """# Project

## Run

It has {{contact.Settings.iters}} sweeps.

<!-- generated: bench by python -m curriculum.bench draw -->
<!-- end -->
""",
    "meta.yaml": "runs:\n  drop: []\n",
    "wallclock.csv": PENDING,
    EXERCISE: '"""How often does `solve_contacts` sweep?"""\n',
    CLAMP: 'const x = 1;\nexport const figure = { caption: "It pushes by `push`." };\n',
}
WRITE = "from curriculum import stored; stored.write_block('bench', '| 1 |')"


def run_gate(project, *flags):
    """`python -m curriculum.gate FLAGS` in a project."""
    return python("-B", "-m", "curriculum.gate", *flags, cwd=project)


def edit(path, old, new):
    """Replace a text that stands once in a file."""
    text = path.read_text("utf-8")
    assert text.count(old) == 1, (path, old, text.count(old))
    path.write_text(text.replace(old, new), "utf-8")


def line_of(path, text):
    """The number of the line on which a text stands first."""
    return path.read_text("utf-8").partition(text)[0].count("\n") + 1


@pytest.fixture(scope="module")
def accepted(tmp_path_factory):
    """A project that is in order; its runs are cached."""
    project = tmp_path_factory.mktemp("project")
    for room in ("curriculum/gate", "curriculum/lesson"):
        shutil.copytree(ROOT / room, project / room)
    for name in ("__init__", "commands", "core", "implicit", "stored"):
        shutil.copy(ROOT / f"curriculum/{name}.py", project / "curriculum")
    for file in (".gitignore", "contact.py"):
        shutil.copy(ROOT / file, project)
    shown = "".join(
        f"\n```\n[include-by-region: {region.file}#{name}]\n```\n"
        for name, region in regions.read_all().items()
        if region.file in ("contact.py", "curriculum/implicit.py", "curriculum/core.py")
    )
    for file, text in FILES.items():
        (project / file).parent.mkdir(parents=True, exist_ok=True)
        (project / file).write_text(text + shown * (file == CHAPTER), "utf-8")
    assert python("-B", "-c", WRITE, cwd=project).returncode == 0
    names = shlex.split(run_gate(project).stdout.splitlines()[-1].split(" --read ")[1])
    assert names == ["A sponge", "A sweep", "Code", "README.md: Run", "ex1"] + OPENINGS
    assert run_gate(project, "--read", *names).returncode == 0
    compileall.compile_dir(project, quiet=1)  # once for all its copies
    return project


@pytest.fixture
def project(accepted, tmp_path):
    """A copy of it for one test."""
    return shutil.copytree(accepted, tmp_path / "project")


def test_project_that_was_read_passes_and_nothing_is_written(project):
    edit(project / CLAMP, "x = 1", "x = 2")  # which no reader sees
    newer = WRITE.replace("| 1 |", "| 2 |")  # which a command wrote, so it needs no reader
    assert python("-B", "-c", newer, cwd=project).returncode == 0
    before = {path: path.read_bytes() for path in project.rglob("*") if path.is_file()}
    done = run_gate(project)
    assert (done.returncode, done.stdout) == (0, "text, code, numbers and results agree\n")
    assert before == {path: path.read_bytes() for path in project.rglob("*") if path.is_file()}


OLD = {"command": "python -m curriculum.bench piles", "code": {"contact.py#sweep": "0" * 12}}
ERRORS = [  # file, what stands there, what takes its place, the problems that it makes
    (CHAPTER, "r deep,", "r deep, 0.25 r,", ["{}:5: a typed number, 0.25"]),
    (CHAPTER, "seen from", "{{= 3}} seen from", ["{}:5: '= 3': a typed number needs a reason: "]),
    (CHAPTER, "rest_penetration_frac|.5f", "depth|.5f", ["{}:5: 'quality.penalty.depth|"]),
    (CHAPTER, "[drops]", "[drops ½ r]", ["{}:6: a typed number, ½"]),
    (CHAPTER, "frac > quality.lcp", "frac < quality.lcp",
     ["{}:7: 'quality.penalty.rest_penetration_frac < quality.lcp.rest_penetration_frac' doe"]),
    (CHAPTER, "`solve_contacts`", "`solve_contact`", ["{}:11: `solve_contact` is in no code"]),
    (CHAPTER, "--iters 1", "--iter 1", ["{}:11: `--iter` is in no code"]),
    (CHAPTER, "not typed.", "not typed, {{no,\n0.5}}", ["{}:12: a typed number, 0.5"]),
    (CHAPTER, "figure: clamp", "figure: clamps?dt=1",
     ["{}:13: there is no figure clamps", f"{CLAMP}:1: figure clamp has no place in {CHAPTER}"]),
    (CHAPTER, "exercise: ex1", "exercise ex1",
     ["{}:14: an include not alone in its fence, or a slot that is not well formed",
      f"{EXERCISE}:1: exercise ex1 has no place in {CHAPTER}"]),
    (CHAPTER, "are not typed", "<b>are</b> not typed", ["{}:11: raw HTML, '<b>are</b> not"]),
    (CHAPTER, "## Code", "<!-- tells: ex1 -->\n\n## Code", ["{}:16: an include not alone in its"]),
    (CHAPTER, "contact.py#flight]", "contact.py#fligt]",
     ["{}:#: there is no region contact.py#fligt", "contact.py:#: region contact.py#flight ha"]),
    (CHAPTER, "contact.py#quality]", "contact.py#quality] and more",
     ["{}:#: an include not alone", "contact.py:#: region contact.py#quality "]),
    (CHAPTER, "contact.py#measure]", "contact.py#sweep]",
     ["{}:#: region contact.py#sweep stands here again", "contact.py:#: region contact.py#measur"]),
    ("README.md", "# Project\n", "# Run\n", ["{}:3: a second heading README.md: Run"]),
    ("README.md", "Settings.iters", "Settings.sweeps", ["{}:5: 'contact.Settings.sweeps': "]),
    (CLAMP, "It pushes by", "It pulls by", ["{}:1: read 'figures/clamp' again: its words changed"]),
    (CLAMP, "`push`", "`pulls_by`", ["{}:1: `pulls_by` is in no code"]),
    ("contact.py", "n . (v_a - v_b)", "n . (v_b - v_a)", ["{}:1: read 'contact.py' again: its w"]),
    ("contact.py", "CONTACT_MARGIN = 1e-3", "CONTACT_MARGIN = 2e-3",
     [f"{CHAPTER}:3: read 'A sponge' again: nobody has read stiffness|.0f there, contact.CONTACT_"
      "MARGIN * 1000|.0f was 1 and is 2; repair: python -m curriculum.gate --read 'A sponge'",
      f"{CHAPTER}:#: read 'Code' again: contact.py#contacts changed, contact.py#scenes changed; "]),
    (CHAPTER, "seen from a margin", "of {{stiffness|.0f}} N/m, seen from a margin", []),
    ("contact.py", "RADIUS = 0.1  # m", "# --- region lost ---\nRADIUS = 0.1  # m",
     ["{}:#: '# --- region lost ---' does not belong there"]),
    ("contact.py", "# --- region: setup ---", "lost = 1\n# --- region: setup ---",
     ["{}:#: code outside any region: 'lost = 1'"]),
    ("meta.yaml", "  drop: []", "  drop: []\n  long: [--steps, 3]", ["{}:1: run long is quoted "]),
    ("meta.yaml", '\n  sweep:', '\n  swept:',
     ["{}:1: it keeps what is gone, or other, of swept; repair: "]),
    ("wallclock.csv", PENDING, PENDING
     + "ch3.5-contact,cpu,0.01,0123456789ab,1234567,2026-01-02,MEASURED\n",
     [f"{MADE}:1: contact.py#sweep changed since these were measured: bench piles, the wall-clock "
      "of cpu; repair: whoever merges types python -m curriculum.bench piles; python -m curricul"]),
]  # fmt: skip


def test_each_error_of_a_text_is_named_in_a_line_with_its_place_and_nothing_else(project):
    """All of them at once: what the code is called, what numbers are, what readers last saw."""
    expected = []
    for file, old, new, problems in ERRORS:
        edit(project / file, old, new)
        expected += [problem.replace("{}", file) for problem in problems]
    (project / MADE).parent.mkdir(parents=True)
    (project / MADE).write_text(json.dumps({"piles": OLD}))
    done = run_gate(project)
    lines = [line for line in done.stdout.splitlines() if "; repair: " in line]
    for problem in expected:
        pattern = re.escape(problem).replace(r":\#:", r":\d+:")
        hits = [line for line in lines if re.match(pattern, line)]
        assert len(hits) == 1, (problem, done.stdout + done.stderr)
        lines.remove(hits[0])
    assert (done.returncode, lines) == (1, [])
    refused = run_gate(project, "--read", "Code")
    assert refused.returncode == 2 and "does not belong there" in refused.stderr


def test_a_changed_region_names_each_passage_that_speaks_of_it_until_it_is_read(project):
    text = (project / "contact.py").read_text("utf-8").partition("# --- region: sweep ---\n")[2]
    code = text.partition("# --- region: ")[0].rstrip("\n") + "\n"
    edit(project / "contact.py", code, code + "# a better word\n")
    where = {"A sweep": f"{CHAPTER}:9", "ex1": f"{EXERCISE}:1"}
    where["Code"] = f"{CHAPTER}:{line_of(project / CHAPTER, '## Code')}"
    lines = {
        f"{place}: read {name!r} again: contact.py#sweep changed; "
        f"repair: python -m curriculum.gate --read {shlex.quote(name)}"
        for name, place in where.items()
    }
    failed, all_read = run_gate(project).stdout.splitlines(), "--read 'A sweep' Code ex1"
    assert set(failed[:3]) == lines
    assert failed[3:] == ["", f"when all of them are read: python -m curriculum.gate {all_read}"]
    refused = run_gate(project, "--read", "nowhere")
    assert refused.returncode == 2
    assert refused.stderr.startswith("given nowhere; allowed: Chapter, A ")

    def kept():
        return yaml.safe_load((project / "meta.yaml").read_text("utf-8"))["region_hashes"]["sweep"]

    was = kept()
    assert run_gate(project, "--read", "A sweep", "ex1").returncode == 0
    assert kept() == was and run_gate(project).stdout.count("\n") == 1
    assert run_gate(project, "--read", "Code").returncode == 0 == run_gate(project).returncode
    assert kept() == hashlib.sha256(f"{code}# a better word\n".encode()).hexdigest()


def test_what_is_quoted_is_kept_until_its_code_changes(project):
    shown = "from curriculum.gate.references import Numbers; print(Numbers().text('{}'), end='')"

    def quoted(reference):
        return python("-B", "-c", shown.format(reference), cwd=project).stdout

    first = quoted("fact:jump.before|.4f")
    assert first == "−0.0196"
    kept = project / ".cache/fact-jump.json"
    edit(kept, '"before": -0.0196', '"before": -0.0296')  # which only who reads it can know
    assert quoted("fact:jump.before|.4f") == "−0.0296"
    edit(project / "curriculum/gate/facts.py", "ball.vy + 1.0", "ball.vy + 2.0")
    assert quoted("fact:jump.before|.4f") == "0.9804"
    edit(kept, '"before": 0.98', '"before": 0.88')
    edit(kept, f'"{np.__version__}"', '"1.0"')
    assert quoted("fact:jump.before|.4f") == "0.9804"
    edit(project / "contact.py", "GRAVITY = -9.81", "GRAVITY = -4.905")
    assert quoted("quality.penalty.rest_penetration_frac|.4f") == "0.0049"


CHANGES = [  # of a file: whether results are stale then
    (r"\Z", "# a word\n", False),
    (r'"""', '"""Another word. ', False),
    (r"(?m)^(def \w+\(.*:)$", r"\1  # a word", False),
    (r"(?m)^(import \w+)$", r"\1\n\nchanged = 1", True),
]


def stale_after(changes, made, monkeypatch):
    """What of a stamp has changed where texts of files are others."""
    monkeypatch.setattr(stored, "read_text", lambda f: changes.get(f) or regions.read_text(f))
    return stored.changed(made)


@pytest.mark.parametrize("file, room", [
    ("curriculum/stress/properties.py", "stress/jobs"), ("contact.py", "bench/measure"),
    ("curriculum/stress/heaps.py", "stress/jobs"), ("curriculum/exact.py", "bench/measure"),
    ("curriculum/fast.py", "bench/measure"), ("curriculum/bench/problems.py", "bench/measure"),
])  # fmt: skip
def test_results_are_stale_when_what_made_them_changed_and_not_for_words(file, room, monkeypatch):
    made = stored.stamp(*stored.made_by(f"curriculum/{room}.py"))
    for old, new, counts in CHANGES:
        text = re.sub(old, new, regions.read_text(file), count=1)
        assert text != regions.read_text(file), (file, old)
        assert bool(stale_after({file: text}, made, monkeypatch)) == counts, (old, new)


REGIONS = [  # of contact.py: what stands there, and another thing; whose results that makes stale
    ("3 * len(depth) // 4", "2 * len(depth) // 4", {"stress"}),  # a measure
    ("lam = max(0.0, c.lam", "lam = max(0.1, c.lam", {"bench", "stress"}),  # the sweep
    ("share of an overlap", "part of an overlap", set()),  # help
    ("has 800 steps: leave", "has 900 steps: leave", set()),  # an error of the command line
]


@pytest.mark.parametrize("old, new, rooms", REGIONS)
def test_only_the_regions_that_a_room_uses_make_its_results_stale(old, new, rooms, monkeypatch):
    text = regions.read_text("contact.py")
    assert old in text
    for room, file in (("bench", "bench/measure"), ("stress", "stress/jobs")):
        made = stored.stamp(*stored.made_by(f"curriculum/{file}.py"))
        stale = stale_after({"contact.py": text.replace(old, new)}, made, monkeypatch)
        assert bool(stale) == (room in rooms), (room, stale)
        monkeypatch.undo()


def test_measuring_writes_a_whole_row_of_todays_code(monkeypatch, tmp_path, capsys):
    from curriculum.bench import timing

    times = iter([900.0, *[30.0, 12.0, 18.0] * 3])
    monkeypatch.setattr(stored, "LEDGER", tmp_path / "wallclock.csv")
    monkeypatch.setattr(stored, "dirty", lambda: "")
    stored.LEDGER.write_text(PENDING)

    def taken(command, folder):
        (Path(folder) / "contact.rrd").touch()
        return next(times)

    monkeypatch.setattr(timing, "whole_process", taken)
    assert stored.main(["cpu"]) == 0 and capsys.readouterr().out == "cpu: 18 s\n"
    assert stored.LEDGER.read_text().startswith(PENDING)
    row = stored.ledger()[1]
    assert row["wallclock_min"] == "0.3" and None not in row.values() and not stored.stale(row)
    assert stored.taken(row | {"wallclock_min": "1.5"}) == "1.5 min", "the unit that reads best"


READ = """# A ball

It falls.
<!-- a note
on two lines -->
<!-- figure: falls?dt=0.004 -->
<!-- puzzle -->

```
# a comment, no heading
```

```
[include-by-region: contact.py#ball]
```

## The end <!-- not here -->
"""


def test_the_parts_of_a_text_are_all_of_it_each_with_its_line():
    parts = chapter.split(READ)
    assert "".join(part.text for part in parts) == READ
    assert [part[:3] for part in parts if part.text.strip()] == [
        ("heading", "A ball", 1),
        ("text", "", 3),
        ("comment", "a note\non two lines", 4),
        ("figure", "falls?dt=0.004", 6),
        ("puzzle", "", 7),
        ("code", "# a comment, no heading\n", 9),
        ("region", "contact.py#ball", 13),
        ("heading", "The end <!-- not here -->", 17),
    ]
    with pytest.raises(ValueError, match=r"chapter.md:17: raw HTML, '<!-- not here -->'; repair"):
        chapter.read(READ)


# numbers by reference, on runs given by hand


@pytest.fixture
def numbers():
    drop = {"lcp": {"depth": 0.0567, "state": "ok"}, "soft": {"depth": 0.17}}
    runs = {"drop": {"steps": 2000, "quality": drop}}
    return references.Numbers(runs | {"drop-dt-0.03": {"quality": {"lcp": {"depth": 1.3}}}})


MADE_OF = {  # reference: what a reader sees, or what is said where it cannot be made
    "steps": "2000",
    "quality.lcp.depth|.2f": "0.06",
    "drop-dt-0.03:quality.lcp.depth|.1f": "1.3",
    "1 + quality.lcp.depth * 2|.4f": "1.1134",
    "(1 - quality.lcp.depth) / 1e-2|.2f": "94.33",
    "0 - quality.lcp.depth|.1e": "−5.7\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}10⁻²",
    "quality.lcp.state": "ok",
    "= 1972 | year of the paper": "1972",
    "contact.RADIUS|.1f": "0.1",
    "contact.Settings.iters": "20",
    "contact.SOLREF.1|.0f": "1",
    "quality.lcp.depth": "is a fraction and needs a format",
    "quality.lcp.depth|.2q": "'.2q' is no format of 'quality.lcp.depth'",
    "quality.lcp.deep|.2f": "no 'deep'; known there: depth, state",
    "nowhere:steps": "no run 'nowhere' in meta.yaml; known there: drop, finger",
    "contact.NOTHING": "no 'NOTHING'; known there: GRAVITY, ",
    "quality.lcp|.2f": "is no number; known there: depth, state",
    "steps / 0|.1f": "division by zero",
    "steps + quality.lcp.state": "'quality.lcp.state' is 'ok', no number",
    "steps + [1]": "has other signs than",
    "steps +": "cannot be reckoned",
    "fact:nothing.key": "'fact:nothing' is not there: no 'nothing'; known there: implicit",
}


@pytest.mark.parametrize("reference", MADE_OF)
def test_a_reference_becomes_a_number_or_an_error_that_says_what_is_known(numbers, reference):
    try:
        assert numbers.fill(f"so {{{{{reference}}}}} it is") == f"so {MADE_OF[reference]} it is"
    except references.TextError as error:
        assert MADE_OF[reference] in str(error) and "\n" not in str(error)


def test_sentence_in_words_is_held_to_the_numbers(numbers):
    assert numbers.broken("quality.soft.depth > 2 * quality.lcp.depth") == ""
    assert numbers.broken("quality.soft.depth <= quality.lcp.depth") == "(0.17) <= (0.0567)"
    signs = "<", "<=", ">", ">=", "=="
    assert [bool(numbers.broken(f"steps {s} 2e3")) for s in signs] == [1, 0, 1, 0, 0]
    assert numbers.broken("2e3 <= steps < 1 + steps") == ""
    assert numbers.broken("1 < steps < 2e3") == "1 < (2000) < 2e3"
    assert numbers.fill("so it is\n{{? steps ==\n1}}.") == "so it is."
    with pytest.raises(references.TextError, match="is not 'FORMULA < FORMULA'"):
        numbers.broken("quality.soft.depth")
    with pytest.raises(references.TextError, match="'quality.lcp.state' is 'ok', no number"):
        numbers.broken("quality.lcp.state > 0")
