"""The gate on a small project of its own: the real contact.py, a short chapter."""

import hashlib
import json
import re
import shlex
import shutil

import numpy as np
import pytest

from curriculum import source, stored
from curriculum.prose import references
from curriculum.tests.helpers import ROOT, python

CHAPTER, CLAMP = "curriculum/prose/chapter.md", "curriculum/page/figures/clamp.js"
EXERCISE, MADE = "exercises/ex1_bet.py", "curriculum/bench/results/made.json"
ROOM = "commands.py gate.py predict.py prose __init__.py source.py stored.py variants.py".split()
PENDING = "chapter,tier,wallclock_min,config_hash,commit,date,status\n"
PENDING += "ch3.5-contact,t4,,,,,PENDING\n"
FILES = {
    CHAPTER: """# Chapter

## A sponge

The ball rests {{quality.penalty.rest_penetration_frac|.5f}} r deep, seen from a margin of
{{contact.CONTACT_MARGIN * 1000|.0f}} mm, and [drops](#x) by {{jump:before|.4f}} m/s.
{{? quality.penalty.rest_penetration_frac > quality.lcp.rest_penetration_frac}}
<!-- no 9 is
typed here -->

## A sweep

One sweep of `solve_contacts` pushes, as with `--iters 1`. Python 3.10 and $k = 10$ are not typed.
<!-- figure: clamp -->
<!-- exercise: ex1 -->

```
# 7, no heading
```

## Code
""",
    "meta.yaml": "runs:\n  drop: []\n",
    "wallclock.csv": PENDING,
    EXERCISE: '"""How often does `solve_contacts` sweep?"""\n',
    CLAMP: 'const x = 1;\nexport const figure = { caption: "It pushes by `push`." };\n',
}
READ = ["A sponge", "A sweep", "Code", "ex1", "contact.py", "figures/clamp"]


def run_gate(project, *flags):
    """`python -m curriculum.gate FLAGS` in a project."""
    return python("-m", "curriculum.gate", *flags, cwd=project)


def edit(path, old, new):
    """Replace a text that stands once in a file."""
    text = path.read_text("utf-8")
    assert text.count(old) == 1, (path, old, text.count(old))
    path.write_text(text.replace(old, new), "utf-8")


@pytest.fixture(scope="module")
def accepted(tmp_path_factory):
    """A project that is in order; its runs are cached."""
    project = tmp_path_factory.mktemp("project")
    for path in (ROOT / "contact.py", *(ROOT / "curriculum" / each for each in ROOM)):
        copy = shutil.copytree if path.is_dir() else shutil.copy
        (project / path.relative_to(ROOT)).parent.mkdir(exist_ok=True)
        copy(path, project / path.relative_to(ROOT))
    shown = "".join(
        f"\n```\n[include-by-region: {region.source}]\n```\n"
        for region in source.read_all().values()
        if (project / region.file).exists()
    )
    for file, text in FILES.items():
        (project / file).parent.mkdir(parents=True, exist_ok=True)
        (project / file).write_text(text + shown * (file == CHAPTER), "utf-8")
    assert run_gate(project).stdout.endswith(f" --read {shlex.join(READ)}\n")
    assert run_gate(project, "--read", *READ).returncode == 0
    return project


@pytest.fixture
def project(accepted, tmp_path):
    """A copy of it for one test."""
    return shutil.copytree(accepted, tmp_path / "project")


def test_project_that_was_read_passes_and_nothing_is_written(project):
    edit(project / CLAMP, "x = 1", "x = 2")  # which no reader sees
    before = {path: path.read_bytes() for path in project.rglob("*.[!p]*") if path.is_file()}
    done = run_gate(project)
    assert (done.returncode, done.stdout) == (0, "text, code, numbers and results agree\n")
    assert before == {path: path.read_bytes() for path in before}
    edit(project / "meta.yaml", "\n  sweep:", "\n  swept:")
    wrong = "meta.yaml:1: its region_hashes keeps what is gone, or other, of swept, sweep; repair: "
    assert run_gate(project).stdout.startswith(wrong)


OLD = {"command": "python -m curriculum.bench piles", "code": {"contact.py#sweep": "0" * 12}}
ERRORS = [  # file, what stands there, what takes its place, the problems that it makes
    (CHAPTER, "rest_penetration_frac|.5f", "depth|.5f", ["{}:5: 'quality.penalty.depth' is not"]),
    (CHAPTER, "[drops]", "[drops ½ r]", ["{}:6: a typed number, ½"]),
    (CHAPTER, "frac > quality.lcp", "frac < quality.lcp",
     ["{}:7: '? quality.penalty.rest_penetration_frac < quality.lcp.rest_penetration_frac' d"]),
    (CHAPTER, "--iters 1", "--iter 1", ["{}:13: `--iter` is in no code"]),
    (CHAPTER, "figure: clamp", "figure: clamps?dt=1",
     ["{}:14: there is no figure clamps", f"{CLAMP}:1: figure clamp has no place in {CHAPTER}"]),
    (CHAPTER, "exercise: ex1", "exercise ex1",
     ["{}:15: no include or slot that is well formed",
      f"{EXERCISE}:1: exercise ex1 has no place in {CHAPTER}"]),
    (CHAPTER, "are not typed", "<b>are</b> not typed", ["{}:13: raw HTML, '<b>are</b> not"]),
    (CHAPTER, "contact.py#flight]", "contact.py#fligt]",
     ["{}:#: there is no region contact.py#fligt", "contact.py:#: region contact.py#flight ha"]),
    (CHAPTER, "contact.py#quality]", "contact.py#quality] and more",
     ["{}:#: no include or slot", "contact.py:#: region contact.py#quality "]),
    (CHAPTER, "contact.py#measure]", "contact.py#sweep]",
     ["{}:#: a second region contact.py#sweep", "contact.py:#: region contact.py#measur"]),
    (CHAPTER, "# Chapter\n", "# A sweep\n", ["{}:11: a second heading A sweep"]),
    (CLAMP, "It pushes by `push`", "It pulls by `pulls_by`",
     ["{}:1: `pulls_by` is in no code", "{}:1: read 'figures/clamp' again: its words was "]),
    ("contact.py", "n . (v_a - v_b)", "n . (v_b - v_a)", ["{}:1: read 'contact.py' again: its wo"]),
    ("contact.py", "CONTACT_MARGIN = 1e-3", "CONTACT_MARGIN = 2e-3",
     [f"{CHAPTER}:3: read 'A sponge' again: stiffness|.0f was never read and is 10000, contact.CON"
      "TACT_MARGIN * 1000|.0f was 1 and is 2; repair: python -m curriculum.gate --read 'A sponge'",
      f"{CHAPTER}:#: read 'Code' again: contact.py#contacts was ",
      "meta.yaml:1: its region_hashes keeps what is gone, or other, of contacts, scenes; re"]),
    (CHAPTER, "seen from a margin", "of {{stiffness|.0f}} N/m, seen from a margin", []),
    ("contact.py", "RADIUS = 0.1  # m", "# --- region lost ---\nRADIUS = 0.1  # m",
     ["{}:#: '# --- region lost ---' does not belong there"]),
    ("contact.py", "# --- region: setup ---", "lost = 1\n# --- region: setup ---",
     ["{}:#: code outside any region: 'lost = 1'"]),
    ("meta.yaml", "  drop: []", "  drop: []\n  long: [--steps, 3]", ["{}:1: run long is quoted "]),
    ("wallclock.csv", PENDING, PENDING
     + "ch3.5-contact,cpu,0.01,0123456789ab,1234567,2026-01-02,MEASURED\n",
     [f"{MADE}:1: measured on other code; since then these changed: contact.py#sweep, contact.py, "
      "curriculum/show/picture.py, curriculum/show/recording.py; repair: whoever merges types "
      "python -m curriculum.bench piles; python -m curriculum.bench processes --tier cpu",
      "meta.yaml:1: its read keeps what is gone, or other, of A sponge, Code, figures/clamp; rep"]),
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
    for text, why in ("- [", " is not YAML: "), ("", ":1: it names no runs; repair: "):
        (project / "meta.yaml").write_text(text)
        assert run_gate(project).stderr.startswith(f"meta.yaml{why}")


def test_a_changed_region_names_each_passage_that_speaks_of_it_until_it_is_read(project):
    text = (project / "contact.py").read_text("utf-8").partition("# --- region: sweep ---\n")[2]
    code = text.partition("# --- region: ")[0].rstrip("\n") + "\n"
    edit(project / "contact.py", code, code + "# a better word\n")
    lines, speak = run_gate(project).stdout.splitlines(), ["A sweep", "Code", "ex1"]
    for line, name in zip(lines, speak):
        says = rf".*: read {name!r} again: contact.py#sweep was \w+ and is \w+; repair: .* --read "
        assert re.fullmatch(says + re.escape(shlex.quote(name)), line)
    every = f"when all of them are read: python -m curriculum.gate --read {shlex.join(speak)}"
    assert "other, of sweep; repair: " in lines[3] and lines[4:] == ["", every]
    refused = run_gate(project, "--read", "nowhere")
    assert refused.returncode == 2
    assert refused.stderr.startswith("given nowhere; allowed: Chapter, A ")
    sha = hashlib.sha256(f"{code}# a better word\n".encode()).hexdigest()
    for names, waits in ((["A sweep", "ex1"], 1), (["Code"], 0)):
        assert run_gate(project, "--read", *names).returncode == 0
        assert run_gate(project).returncode == waits
        assert f"\n  sweep: {sha}\n" in (project / "meta.yaml").read_text("utf-8")


JUMP, DEEP = "jump:before", "quality.penalty.rest_penetration_frac"
KEPT = ".cache/jump.json"
LATER = [  # what is changed, one after the other, and what is quoted then
    (KEPT, '"before": -0.0196', '"before": -0.0296', JUMP, "−0.0296"),  # only who reads it knows
    (KEPT, f'"{np.__version__}"', '"1.0"', JUMP, "−0.0196"),
    ("curriculum/prose/facts.py", "[1, 1, 0] + 1.0", "[1, 1, 0] + 2.0", JUMP, "0.9804"),
    ("contact.py", "GRAVITY = -9.81", "GRAVITY = -4.905", DEEP, "0.0049"),
]


def test_what_is_quoted_is_kept_until_its_code_changes(project):
    shown = "from curriculum.prose.references import shown; print(shown('{}|.4f'))"
    for file, old, new, reference, quoted in LATER:
        edit(project / file, old, new)
        assert python("-c", shown.format(reference), cwd=project).stdout.strip() == quoted


BENCH, STRESS = "curriculum/bench/measure.py", "curriculum/stress/jobs.py"
CODE = r"(?m)^(import \w+)$", r"\1\n\nchanged = 1"
CHANGES = [  # file, what stands there, another thing; whose results are stale then
    ("curriculum/exact.py", '"""', '"""Another word. ', []),
    ("curriculum/exact.py", r"(?m)^(def \w+\(.*:)$", r"\1  # a word", []),
    ("curriculum/exact.py", *CODE, [BENCH, STRESS]),
    ("curriculum/bench/problems.py", *CODE, [BENCH]),
    ("curriculum/stress/heaps.py", *CODE, [STRESS]),
    ("contact.py", r"3 \* len\(depth\) // 4", "2 * len(depth) // 4", [STRESS]),  # a measure
    ("contact.py", r"lam = max\(0.0, c.lam", "lam = max(0.1, c.lam", [BENCH, STRESS]),
    ("contact.py", "lcp: share of an overlap", "lcp: part of an overlap", []),  # help
]


@pytest.mark.parametrize("file, old, new, stale", CHANGES)
def test_results_are_stale_when_what_made_them_changed_and_not_for_words(
    file, old, new, stale, monkeypatch
):
    kept = {room: stored.stamp(*stored.made_by(room)) for room in (BENCH, STRESS)}
    text = re.sub(old, new, source.read_text(file), count=1)
    assert text != source.read_text(file)
    monkeypatch.setattr(stored, "read_text", lambda f: text if f == file else source.read_text(f))
    assert [room for room in kept if stored.changed(kept[room])] == stale


def test_a_row_of_the_ledger_has_the_time_and_code_of_a_run(monkeypatch, tmp_path):
    before = stored.ledger()
    monkeypatch.setattr(stored, "LEDGER", tmp_path / "wallclock.csv")
    stored.save(stored.LEDGER, before)
    stored.enter("cpu", {"commit": "1234567", "date": "today"}, 18.0)
    *others, row = stored.ledger()
    assert others == before and row.keys() == before[0].keys() and row["tier"] == "cpu"
    assert row["wallclock_min"] == "0.3" and stored.taken(row) == "18 s" and not stored.stale(row)
    assert stored.taken(row | {"wallclock_min": "1.5"}) == "1.5 min", "the unit that reads best"


MADE_OF = {  # reference: what a reader sees, or what is said where it cannot be made
    "scene": "drop",
    "drop-dt-0.03:dt|.3f": "0.030",
    "(1 - contact.RADIUS) / 1e-2|.2f": "90.00",
    "0 - contact.RADIUS / 1000|.1e": "−1.0\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}10⁻⁴",
    "= 1972 | year of the paper": "1972",
    "= 1972": "needs a reason: {{= NUMBER | REASON}}",
    "contact.RADIUS": "is a fraction and needs a format",
    "contact.SOLREF.1|.2q": "cannot be made of (1.0): Unknown format code 'q'",
    "quality.lcp.rest|.2f": "no 'quality.lcp.rest'; known there: quality.lcp.rests, ",
    "quality.lcp.rests": "is True, no number",
    "steps / 0|.1f": "division by zero",
    "steps + scene": "cannot be made of (2000) + ('drop'): unsupported",
    "steps +": "invalid syntax",
    "steps .real_|.1f": "has no attribute",
    "jumps:key": "'jumps' is not there: no 'jumps'; known there: jump, ",
    "? 2e3 <= steps <\n1 + steps": "",
    "? 1 < steps < 2e3": "does not hold: 1 < (2000) < 2e3",
    "? contact.RADIUS": "does not hold: (0.1)",
}


@pytest.mark.parametrize("reference", MADE_OF)
def test_a_reference_becomes_a_number_or_an_error_that_says_what_is_known(reference):
    asked, right = f"{{{{{reference}}}}}", MADE_OF[reference]
    try:
        assert references.fill(f"so {asked} it is") == f"so {right} it is".replace("  ", " ")
    except references.TextError as error:
        assert right and right in str(error) and "\n" not in str(error)
