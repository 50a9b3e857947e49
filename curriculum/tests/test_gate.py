"""The gate on a small project: the real code, a short chapter, one figure and one exercise."""

import contextlib
import glob
import hashlib
import json
import re
import shlex
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest

from curriculum import source, stored
from curriculum.prose import ratios, references
from curriculum.tests.helpers import FIGURE, clone, edit, gate, python, review, shorten, stopped

CHAPTER, CLAMP = "curriculum/prose/chapter.md", "curriculum/page/figures/clamp.js"
EXERCISE, MADE = "exercises/ex1_bet.py", "curriculum/bench/results/made.json"
CAPTION = "figures/clamp"
READ = ["A sponge", "A sweep", "Code", "ex1", "contact.py", "exact.py", CAPTION]


@pytest.fixture(scope="module")
def accepted(tmp_path_factory):
    """A project that is in order; its runs are cached."""
    project = clone(tmp_path_factory.mktemp("project"), "results")
    for path in (*project.glob("exercises/ex*.py"), *project.glob("curriculum/page/figures/*")):
        path.unlink()
    (project / EXERCISE).write_text('"""How often does `solve_contacts` sweep?"""\n', "utf-8")
    (project / CLAMP).write_text(FIGURE, "utf-8")
    shorten(
        project, "<!-- figure: clamp -->\n<!-- figure: clamp?dt=0.01 -->\n<!-- exercise: ex1 -->\n"
    )
    asked = [re.search(r": read '?(.*?)'? again: ", line)[1] for line in review(project)]
    assert asked == READ
    return project


@pytest.fixture
def project(accepted, tmp_path):
    """A copy of it for one test."""
    return shutil.copytree(accepted, tmp_path / "project", symlinks=True)


def test_project_that_was_read_passes_and_nothing_is_written(project):
    edit(project / CLAMP, "x = 1", "x = 2")  # which no reader sees
    before = {path: path.read_bytes() for path in project.rglob("*.[!p]*") if path.is_file()}
    done = gate(project)
    assert (done.returncode, done.stdout) == (0, "text, code, numbers and results agree\n")
    assert before == {path: path.read_bytes() for path in before}
    edit(project / "wallclock.csv", "PENDING\n", "PENDING\n" + LEDGER)  # made by other code
    assert [gate(project, *words).returncode for words in ((), ("--release",))] == [0, 1]


OLD = {"command": "python -m curriculum.bench piles", "code": {"contact.py#sweep": "0" * 12}}
READING = "reading: {names: [solPGS], files: {}}\nruns:\n"
LEDGER = "ch3.5-contact,cpu,0.01,0123456789ab,1234567,2026-01-02,MEASURED\n"
ERRORS = [  # file, what stands there, what takes its place, the problems that it makes
    (CHAPTER, "rest_penetration_frac|.5f", "depth|.5f", ["{}:5: 'quality.penalty.depth' is not"]),
    (CHAPTER, "[drops]", "[drops ½ r]", ["{}:6: a typed number, ½"]),
    (CHAPTER, "frac > quality.lcp", "frac < quality.lcp",
     ["{}:7: '? quality.penalty.rest_penetration_frac < quality.lcp.rest_penetration_frac' d"]),
    (CHAPTER, "It stays there.", "It falls {{dt * 2|.3f}} s, twice as\nlong as `solPGS`.",
     ["{}:7: no claim of its sentence holds 'twice'; repair: add {{? LOW < FORMULA < HIGH"]),
    (CHAPTER, "--iters 1", "--iter 1", ["{}:14: `--iter` is in no code"]),
    (CHAPTER, "One sweep", "A `swept` sweep", ["{}:14: `swept` is in no code; repair: na"]),
    (CHAPTER, "figure: clamp -->", "figure: clamps -->", ["{}:15: there is no figure clamps"]),
    (CHAPTER, "clamp?dt=0.01", "clamp?dt=0.01&model=lcpp",
     ["{}:16: the figure clamp: model=lcpp; allowed: penalty, lcp, soft, leapfrog, exact; repair"]),
    (CHAPTER, "exercise: ex1", "exercise ex1",
     ["{}:17: no include or slot that is well formed",
      f"{EXERCISE}:1: exercise ex1 has no place in {CHAPTER}"]),
    (CHAPTER, "contact.py#flight]", "contact.py#fligt]",
     ["{}:#: there is no region contact.py#fligt", "contact.py:#: region contact.py#flight ha"]),
    (CHAPTER, "contact.py#quality]", "contact.py#quality] and more",
     ["{}:#: no include or slot", "contact.py:#: region contact.py#quality "]),
    (CHAPTER, "contact.py#measure]", "contact.py#sweep]",
     ["{}:#: a second region contact.py#sweep", "contact.py:#: region contact.py#measur"]),
    (CHAPTER, "# Chapter\n", "# A sweep\n", ["{}:12: a second heading A sweep"]),
    (CLAMP, "It pushes by", "It pulls 3 times by",
     ["{}:1: a typed number in a caption, 3; repair: compute it: `${...}`",
      "{}:1: read 'figures/clamp' again: its words was "]),
    ("CONTRIBUTING.md", "# Contributing\n", "`shoves(balls)`\n", ["{}:1: `shoves` is in no "]),
    ("contact.py", "n . (v_a - v_b)", "n . (v_b - v_a)", ["{}:1: read 'contact.py' again: its wo"]),
    ("contact.py", "CONTACT_MARGIN = 1e-3", "CONTACT_MARGIN = 2e-3",
     [f"{CHAPTER}:3: read 'A sponge' again: contact.CONTACT_MARGIN * 1000|.0f was 1 and is 2, dt * "
      "2|.3f was never read and is 0.004, quality.penalty.rest_penetration_frac|.5f was 0.00981 "
      "and is gone; repair: python -m curriculum.gate --read 'A sponge'",
      f"{CHAPTER}:#: read 'Code' again: contact.py#contacts was "]),
    ("curriculum/exact.py", "# --- endregion ---\n\n\nclass", "class",
     ["{}:#: region slide-series is never closed", f"{CHAPTER}:12: read 'A sweep' again: {{}}#",
      f"{EXERCISE}:1: read 'ex1' again: {{}}#slide"]),
    ("contact.py", "# --- region: setup ---", "lost = 1\n# --- region: setup ---",
     ["{}:#: code outside any region: 'lost = 1'"]),
    ("meta.yaml", "runs:\n", READING, []),
    ("wallclock.csv", "PENDING\n", "PENDING\n" + LEDGER,
     [f"{MADE}:1: measured on other code; since then these changed: contact.py#sweep; repair: the "
      "maintainer runs python -m curriculum.bench piles", "{}:1: measured on other code; since "]),
]  # fmt: skip


def test_each_error_of_a_text_is_named_in_a_line_with_its_place_and_nothing_else(project):
    """All of them at once: what the code is called, what numbers are, what readers last saw."""
    expected = []
    for file, old, new, problems in ERRORS:
        edit(project / file, old, new)
        expected += [problem.replace("{}", file) for problem in problems]
    (project / MADE).parent.mkdir(parents=True)
    (project / MADE).write_text(json.dumps({"piles": OLD}))
    done = gate(project)
    lines = [line for line in done.stdout.splitlines() if "; repair: " in line]
    for problem in expected:
        pattern = re.escape(problem).replace(r":\#:", r":\d+:")
        hits = [line for line in lines if re.match(pattern, line)]
        assert len(hits) == 1, (problem, done.stdout + done.stderr)
        lines.remove(hits[0])
    assert (done.returncode, lines) == (1, [])
    refused = gate(project, "--read", "Code")
    assert refused.returncode == 2 and "outside any region" in refused.stderr


RATIOS = {  # a text, and the ratios that no claim of its sentence holds
    "It dives a quarter {{? 0.24 < a.b < 0.26}} in.": [],
    "It dives a third. {{? 0.24 < a.b < 0.26}} {{? a.b == 4}} And half of that.": ["a third"],
    "It is a Hundred times {{? a.b == 100 * c.d}} as large as {{c.d|.2f}}.": [],
    "Four\ntimes {{c.d|.2f}} m. Half the step: {{c.d}} m": ["Four\ntimes", "Half"],
    "Half {{? a.b == 2 * c.d}} the step. | half the step | {{c.d|.2f}} |": [],
    "Asked twice, half the error, in theory.": [],
    "As `half`, $half$ or {{half:c.d}} says, two thirds {{? a.b < 2 / 3}}.": [],
}


@pytest.mark.parametrize("text", RATIOS)
def test_a_ratio_in_words_is_held_by_a_claim_of_its_sentence(text):
    assert [match[0] for match, _ in ratios.loose_ratios(text)] == RATIOS[text]


def test_a_passage_that_there_is_not_and_what_is_no_yaml_are_said(capsys, monkeypatch):
    from curriculum.gate import main  # above it would end the tests where yaml is missing

    assert main(["--read", "nowhere"]) == 2
    assert "given nowhere; allowed: " in capsys.readouterr().err
    references.load_meta.cache_clear()
    monkeypatch.setattr(references, "read_text", lambda file: "- [")
    assert main([]) == 2 and capsys.readouterr().err.startswith("meta.yaml is not YAML: ")


def test_a_changed_region_names_each_passage_that_shows_or_names_it_until_it_is_read(project):
    """A word is for who shows it; the syntax for who names it, too."""
    text = (project / "contact.py").read_text("utf-8").partition("# --- region: sweep ---\n")[2]
    code = text.partition("# --- region: ")[0].rstrip("\n") + "\n"
    edit(project / "contact.py", code, code + "# a better word\n")
    says = r".*: read {!r} again: contact.py#sweep was \w+ and is \w+; repair: .* --read {}"
    (line,) = gate(project).stdout.splitlines()
    assert re.fullmatch(says.format("Code", "Code"), line)
    edit(project / "contact.py", "# a better word\n", "more = 1\n")
    lines, speak = gate(project).stdout.splitlines(), ["A sweep", "Code", "ex1", CAPTION]
    for line, name in zip(lines, speak):
        assert re.fullmatch(says.format(name, re.escape(shlex.quote(name))), line)
    every = f"when all of them are read: python -m curriculum.gate --read {shlex.join(speak)}"
    assert lines[4:] == ["", every]
    assert gate(project, "--read", "A sweep", "ex1", CAPTION).returncode == 0
    (line,) = gate(project).stdout.splitlines()
    assert re.fullmatch(says.format("Code", "Code"), line)
    assert gate(project, "--read", "Code").returncode == 0
    sha = hashlib.sha256(f"{code}more = 1\n".encode()).hexdigest()
    assert f"\n  sweep: {sha}\n" in (project / "meta.yaml").read_text("utf-8")


ROD, DEEP = "friction:ahead", "quality.penalty.rest_penetration_frac"
KEPT = ".cache/friction.json"
LATER = [  # what is changed, one after the other, and what is quoted then
    (KEPT, '"ahead": 4.0', '"ahead": 5.0', ROD, "5.0000"),  # only who reads it knows
    (KEPT, f'"{np.__version__}"', '"1.0"', ROD, "4.0000"),
    ("curriculum/prose/facts.py", "ahead = 0.4, 4.0", "ahead = 0.4, 6.0", ROD, "6.0000"),
    ("contact.py", "GRAVITY = -9.81", "GRAVITY = -4.905", DEEP, "0.0049"),
]


def test_what_is_quoted_is_kept_until_its_code_changes(project):
    shown = "from curriculum.prose.references import shown; print(shown('{}|.4f'))"
    for file, old, new, reference, quoted in LATER:
        edit(project / file, old, new)
        assert python("-c", shown.format(reference), cwd=project).stdout.strip() == quoted


def has_started_another(process):
    """Whether this process has a child, of whichever of its threads."""
    with contextlib.suppress(OSError):  # a thread that has just ended
        listed = glob.glob(f"/proc/{process.pid}/task/*/children")
        return any(Path(file).read_text() for file in listed)


@pytest.mark.skipif(not glob.glob("/proc/self/task/*/children"), reason="no list of children here")
def test_a_gate_that_is_stopped_leaves_no_run_behind(project):
    edit(project / "meta.yaml", "drop: []", "drop: [--no-skip, --steps, 10000000]")
    gates = "-m", "curriculum.gate"
    done = stopped(signal.SIGTERM, gates, has_started_another, cwd=project)
    assert done == (143, "", "stopped\n")


BENCH, STRESS = "curriculum/bench/measure.py", "curriculum/stress/jobs.py"
CODE = r"(?m)^(import \w+)$", r"\1\n\nchanged = 1"
CHANGES = [  # file, what stands there, another thing; whose results are stale then
    ("curriculum/exact.py", '"""', '"""Another word. ', []),
    ("curriculum/exact.py", *CODE, [BENCH, STRESS]),
    ("curriculum/bench/problems.py", *CODE, [BENCH]),
    ("contact.py", r"3 \* len\(depth\) // 4", "2 * len(depth) // 4", [STRESS]),  # a measure
    ("contact.py", r"lam = max\(0.0, c.lam", "lam = max(0.1, c.lam", [BENCH, STRESS]),
    ("contact.py", "lcp: share of an overlap", "lcp: part of an overlap", []),  # help
]


def test_results_are_stale_when_what_made_them_changed_and_not_for_words(monkeypatch):
    kept = {room: stored.stamp(*stored.made_by(room)) for room in (BENCH, STRESS)}
    for file, old, new, stale in CHANGES:
        now = {file: re.sub(old, new, source.read_text(file), count=1)}
        assert now[file] != source.read_text(file)
        monkeypatch.setattr(
            stored, "read_text", lambda f, now=now: now.get(f) or source.read_text(f)
        )
        assert [room for room in kept if stored.changed(kept[room])] == stale, (file, old)


def test_a_row_of_the_ledger_has_the_time_and_code_of_a_run(monkeypatch, tmp_path):
    before = stored.ledger()
    monkeypatch.setattr(stored, "LEDGER", tmp_path / "wallclock.csv")
    stored.save(stored.LEDGER, before)
    stored.enter("cpu", {"commit": "1234567", "date": "today"}, 18.0)
    *others, row = stored.ledger()
    assert others == before and row["tier"] == "cpu"
    assert row["wallclock_min"] == "0.3" and stored.taken(row) == "18 s" and not stored.stale(row)


MADE_OF = {  # reference: what a reader sees, or what is said where it cannot be made
    "(1 - contact.RADIUS) / 1e-2|.2f": "90.00",
    "0 - contact.RADIUS / 1000|.1e": "−1.0\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}10⁻⁴",
    "= 1972 | year of the paper": "1972",
    "= 1972": "needs a reason: {{= NUMBER | REASON}}",
    "contact.RADIUS": "is a fraction and needs a format",
    "contact.SOLREF.1|.2q": "cannot be made of (1.0): Unknown format code 'q'",
    "quality.lcp.rest|.2f": "no 'quality.lcp.rest'; known there: quality.lcp.rests, ",
    "steps + scene": "cannot be made of (2000) + ('drop'): unsupported",
    "slides:key": "'slides' is not there: no 'slides'; known there: slide, ",
    "? 2e3 <= steps <\n1 + steps": "",
    "? 1 < steps < 2e3": "does not hold: 1 < (2000) < 2e3",
}


@pytest.mark.parametrize("reference", MADE_OF)
def test_a_reference_becomes_a_number_or_an_error_that_says_what_is_known(reference):
    asked, right = f"{{{{{reference}}}}}", MADE_OF[reference]
    try:
        assert references.fill(f"so {asked} it is") == f"so {right} it is".replace("  ", " ")
    except references.TextError as error:
        assert right and right in str(error) and "\n" not in str(error)
