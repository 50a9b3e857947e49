"""The gate on a small project of its own: the real contact.py, a short chapter and README."""

import compileall
import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from curriculum import regions
from curriculum.measured import stale
from curriculum.text import references

yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")
ROOT = Path(__file__).resolve().parents[2]
CHAPTER = "curriculum/prose/chapter.md"
OPENING = """# Chapter

## A sponge

The ball rests {{quality.penalty.rest_penetration_frac|.5f}} r deep, seen from a margin of
{{contact.CONTACT_MARGIN * 1000|.0f}} mm.
<!-- holds: quality.penalty.rest_penetration_frac > quality.lcp.rest_penetration_frac -->

## A sweep

One sweep of `solve_contacts` pushes. Python 3.10 and $k = 10$ are no typed numbers.

## Code
"""
README = """# Project

## Run

<!-- generated: bench by python -m curriculum.bench draw -->
<!-- end -->
"""
META = "runs:\n  drop: [--contact, all]\n"
CLAMP = "curriculum/page/figures/clamp.js"
OTHERS = {
    "exercises/ex1.py": '"""Your bet."""\n',
    CLAMP: 'const x = 1;\nexport default { caption: "It pushes." };\n',
}
WRITE = """from curriculum.measured import results
results.write_block('bench', '| 1 |')
folder = results.ROOT / results.FOLDERS['bench']
results.write_page(folder, 'a.svg', '<svg/>')
results.write_page(folder, 'README.md', '# Page')
"""
PENDING = (
    "chapter,tier,wallclock_min,config_hash,commit,date,status\nch3.5-contact,t4,,,,,PENDING\n"
)


def run_gate(project, *flags):
    """`python -m curriculum.text FLAGS` in a project: the finished process."""
    command = [sys.executable, "-B", "-m", "curriculum.text", *flags]
    return subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=120)


def commit(project):
    """Commit all that there is."""
    for words in ("init", "add .", "-c user.name=x -c user.email=x@x commit --message x"):
        subprocess.run(["git", *words.split()], cwd=project, check=True, capture_output=True)


def edit(path, old, new):
    """Replace a text that stands once in a file."""
    text = path.read_text("utf-8")
    assert text.count(old) == 1, (path, old, text.count(old))
    path.write_text(text.replace(old, new), "utf-8")


@pytest.fixture(scope="module")
def accepted(tmp_path_factory):
    """A project that is in order and in git; its runs are cached."""
    project = tmp_path_factory.mktemp("project")
    for room in ("curriculum/text", "curriculum/measured"):
        shutil.copytree(ROOT / room, project / room)
    for name in ("__init__", "commands", "regions", "implicit"):
        shutil.copy(ROOT / f"curriculum/{name}.py", project / "curriculum")
    for file in (".gitignore", "contact.py"):
        shutil.copy(ROOT / file, project)
    (project / "curriculum/prose").mkdir()
    files = ("contact.py", "curriculum/implicit.py")
    shown = "".join(
        f"\n```\n[include-by-region: {file}#{name}]\n```\n"
        for file in files
        for name, region in regions.read_all().items()
        if region.file == file
    )
    (project / CHAPTER).write_text(OPENING + shown, "utf-8")
    (project / "README.md").write_text(README, "utf-8")
    (project / "meta.yaml").write_text(META, "utf-8")
    (project / "wallclock.csv").write_text(PENDING, "utf-8")
    for file, text in OTHERS.items():
        (project / file).parent.mkdir(parents=True, exist_ok=True)
        (project / file).write_text(text, "utf-8")
    subprocess.run([sys.executable, "-B", "-c", WRITE], cwd=project, check=True)
    sections = (
        "chapter/chapter chapter/a-sponge chapter/a-sweep chapter/code README/project README/run "
        "contact/opening meta/runs exercises/ex1 figures/clamp"
    )
    for flags in (("--accept", *sections.split()), ()):
        run = run_gate(project, *flags)
        assert run.returncode == 0, run.stdout + run.stderr
    commit(project)
    compileall.compile_dir(project, quiet=1)  # once for all its copies
    return project


@pytest.fixture
def project(accepted, tmp_path):
    """A copy of it for one test."""
    return shutil.copytree(accepted, tmp_path / "project")


def test_project_that_was_read_passes_and_nothing_is_written(project):
    edit(project / CLAMP, "x = 1", "x = 2")  # which no reader sees
    before = {path: path.read_bytes() for path in project.rglob("*") if path.is_file()}
    run = run_gate(project)
    assert (run.returncode, run.stdout) == (0, "text, code, numbers and results agree\n"), (
        run.stderr
    )
    assert before == {path: path.read_bytes() for path in project.rglob("*") if path.is_file()}


def test_every_fault_of_the_chapter_is_named_with_its_line_and_repair(project):
    chapter = project / CHAPTER
    edit(chapter, "[include-by-region: contact.py#flight]", "[include-by-region: contact.py#fligt]")
    edit(chapter, "contact.py#quality]", "contact.py#quality] and more")
    edit(chapter, "contact.py#measure]", "contact.py#sweep]")
    edit(chapter, "r deep,", "r deep, 0.25 r, {{= 3}} {{quality.penalty.depth|.1f}},")
    edit(chapter, "frac > quality.lcp", "frac < quality.lcp")
    edit(chapter, "are no typed numbers.", "are no typed numbers, {{no reference,\n0.5}}")
    printed = run_gate(project).stdout
    false = "quality.penalty.rest_penetration_frac < quality.lcp.rest_penetration_frac"
    for line, what in (
        (5, "a typed number, 0.25; repair: write {{KEY|FORMAT}}"),
        (5, "'= 3': a typed number needs a reason: {{= NUMBER | REASON}}"),
        (5, "'quality.penalty.depth|.1f': 'quality.penalty.depth' is not there: no 'depth'"),
        (7, f"'{false}' does not hold: 0.00981 < "),
        (12, "a typed number, 0.5; repair: write {{KEY|FORMAT}}"),
    ):
        assert f"{CHAPTER}:{line}: {what}" in printed
    assert "includes fligt, and contact.py has no such region; repair: name one of" in printed
    assert "an include that is not alone in its fence, or not well formed" in printed
    assert "includes sweep a second time; repair: delete one of the two" in printed
    for name in ("flight", "quality", "measure"):
        assert f"region {name} is never shown" in printed


def test_markers_that_are_wrong_and_code_outside_of_regions_are_named(project):
    script = project / "contact.py"
    edit(script, "# --- region: flight ---", "# --- region flight ---")
    edit(script, "# --- region: setup ---", "lost = 1\n# --- region: setup ---")
    text = script.read_text("utf-8")
    line = text[: text.index("# --- region flight ---")].count("\n") + 1
    printed = run_gate(project).stdout
    wrong = "'# --- region flight ---' inside region skips, where it does not belong"
    assert f"contact.py:{line}: {wrong}" in printed
    line = text[: text.index("lost = 1")].count("\n") + 1
    assert f"contact.py:{line}: code outside any region: 'lost = 1'" in printed
    assert "includes flight, and contact.py has no such region" in printed


def test_changed_comment_costs_one_command_after_the_diff_was_read(project):
    first = regions.read_all()["sweep"]
    edit(project / "contact.py", first.code, first.code + "# a better word\n")
    failed = run_gate(project)
    assert failed.returncode == 1
    assert "+# a better word" in failed.stdout
    assert "section chapter/a-sweep speaks of sweep, which changed" in failed.stdout
    command = failed.stdout.splitlines()[-1].split(": python -m curriculum.text ")[1].split()
    assert command == ["--accept", "chapter/a-sweep", "chapter/code"]
    took = run_gate(project, *command)
    assert took.returncode == 0 and "+# a better word" in took.stdout
    assert run_gate(project).returncode == 0
    hashes = yaml.safe_load((project / "meta.yaml").read_text("utf-8"))["region_hashes"]
    assert (
        hashes["sweep"] == hashlib.sha256((first.code + "# a better word\n").encode()).hexdigest()
    )


def test_region_hash_moves_only_when_every_section_that_speaks_of_it_was_read(project):
    def hashes():
        return yaml.safe_load((project / "meta.yaml").read_text("utf-8"))["region_hashes"]

    before = hashes()
    edit(project / "contact.py", "# --- region: sweep ---\n", "# --- region: sweep ---\n# new\n")
    run_gate(project, "--accept", "chapter/code")
    assert hashes() == before
    run_gate(project, "--accept", "chapter/a-sweep")
    assert {name for name, sha in hashes().items() if sha != before[name]} == {"sweep"}


def test_edited_sentence_waits_for_a_reader_and_shows_what_changed(project):
    edit(project / CHAPTER, "pushes. Python", "pulls. Python")
    failed = run_gate(project)
    assert f"{CHAPTER}:9: section chapter/a-sweep changed; repair: read it" in failed.stdout
    assert "-One sweep of `solve_contacts` pushes." in failed.stdout
    assert "+One sweep of `solve_contacts` pulls." in failed.stdout
    assert failed.stdout.endswith("python -m curriculum.text --accept chapter/a-sweep\n")


def test_section_that_does_not_exist_cannot_be_accepted_and_gone_ones_are_taken_out(project):
    refused = run_gate(project, "--accept", "chapter/nowhere")
    assert refused.returncode == 2
    assert refused.stderr.startswith("given chapter/nowhere, allowed: chapter/chapter, chapter/a-")
    edit(project / CHAPTER, "## A sponge", "### A sponge in water")
    failed = run_gate(project)
    assert "section chapter/a-sponge-in-water was never read" in failed.stdout
    assert run_gate(project, "--accept", "chapter/a-sponge-in-water").returncode == 0
    assert "chapter/a-sponge:" not in (project / "meta.yaml").read_text("utf-8")
    edit(project / "meta.yaml", "  sweep:", "  swept:")
    assert "region_hashes that are not those of today: swe" in run_gate(project).stdout
    assert run_gate(project, "--accept").returncode == 0
    assert run_gate(project).returncode == 0


def test_results_and_ledger_of_other_code_are_stale_until_measured_again(project):
    measured = {"command": "python -m curriculum.bench skip", "code": {"contact.py": "0" * 12}}
    folder = project / "curriculum/bench/results"
    (folder / "results.json").write_text(json.dumps({"skip": {"measured": measured, "n": 3}}))
    row = "ch3.5-contact,cpu,0.01,0123456789ab,1234567,2026-01-02,MEASURED\n"
    (project / "wallclock.csv").write_text(PENDING + row)
    edit(project / CHAPTER, "pushes. Python", "pushes {{bench:skip.n}}. Python")
    printed = run_gate(project).stdout
    assert (
        "curriculum/bench/results/results.json:1: section skip was measured on other code "
        "(contact.py); repair: python -m curriculum.bench skip\n" in printed
    )
    assert "wallclock.csv:3: cpu was measured on other code; repair: python -m " in printed
    measured["code"] = stale.fingerprint("contact.py")
    (folder / "results.json").write_text(json.dumps({"skip": {"measured": measured, "n": 3}}))
    edit(project / "contact.py", "# --- region: sweep ---\n", "# --- region: sweep ---\n# a word\n")
    assert "section skip was measured" not in run_gate(project).stdout


MADE = {  # file: (what stands there, what takes its place, whether results are stale then)
    "contact.py": [
        ('help="', 'help="please, ', False),
        ("# m/s^2", "# metres", False),
        ("/ dt * c.depth", "  / (dt) * c.depth", False),
        ('"""One step [s]', '"""One single step [s]', False),
        ("def print_table(", "def print_tables(", False),  # of the report
        ("/ dt * c.depth", "/ dt / c.depth", True),
        ("EXPLODED = 10.0", "EXPLODED = 11.0", True),
    ],
    "curriculum/stress/properties.py": [
        ("PROMISE = 1e-12", "PROMISE = 1e-4", True),
        ("Bound: 8 U a push", "Bound: some", False),
    ],
    "curriculum/stress/jobs.py": [("FULL, QUICK = (10_000", "FULL, QUICK = (1_000", True)],
    "curriculum/stress/claims.py": [("off == 0.0", "off <= 1.0", True)],
    "curriculum/exact.py": [("ORDER = 14 ", "ORDER = 13 ", True)],
    "curriculum/bench/problems.py": [(", 4.0, built", ", 1.0, built", True)],
    "curriculum/bench/engines.py": [("hertz", "hurts", True)],
}


@pytest.mark.parametrize("file", MADE)
def test_results_are_stale_when_what_made_them_changed_and_not_for_words(file, monkeypatch):
    read = stale.read_text
    room = "stress/jobs" if "stress" in file else "bench/accuracy"
    made = stale.fingerprint(*stale.made_by(f"curriculum/{room}.py"))
    for old, new, counts in MADE[file]:
        assert old in read(file), (file, old)
        texts = {file: read(file).replace(old, new)}
        monkeypatch.setattr(stale, "read_text", lambda name, own=texts: own.get(name) or read(name))
        assert bool(stale.changed(made)) == counts, (old, new)


def test_a_change_of_the_command_line_is_one_of_the_whole_file_alone():
    text = stale.read_text("contact.py")
    other = text.replace("800 if", "900 if")
    assert stale.digits("contact.py", text) != stale.digits("contact.py", other)
    assert stale.digits(stale.LESSON, text) == stale.digits(stale.LESSON, other)
    assert set(stale.COMMAND_LINE) <= set(regions.read_all())
    with pytest.raises(SyntaxError) as error:
        stale.digits(stale.LESSON, "impor ast\n")
    assert error.value.filename == "contact.py"


def test_ledger_has_its_header_and_each_row_is_whole_or_pending(project):
    for text, wrong in (
        (PENDING + "ch3.5-contact,cpu,0.01,,,,PENDING\n", "3: neither a whole MEASURED row nor a"),
        (PENDING.replace("tier", "machine"), "1: the header must be chapter,tier,wallclock_min"),
    ):
        (project / "wallclock.csv").write_text(text)
        assert f"wallclock.csv:{wrong}" in run_gate(project).stdout


def test_measuring_writes_a_whole_row_of_todays_code(project):
    pytest.importorskip("rerun", reason="rerun is not installed, and the default run records")
    for pattern in ("checks.py", "curriculum/*.py", "curriculum/run/*.py", "exercises/**/*"):
        for path in filter(Path.is_file, ROOT.glob(pattern)):
            copied = project / path.relative_to(ROOT)
            copied.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copied)
    command = [sys.executable, "-B", "-m", "curriculum.measured.ledger", "cpu", "--runs", "1"]
    run = subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=120)
    assert run.returncode == 1 and "commit these first: ?? checks.py" in run.stderr
    commit(project)
    run = subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0 and re.search(r": [\d.]+ (s|min)$", run.stdout.strip()), run.stderr
    header, pending, row = (project / "wallclock.csv").read_text("utf-8").splitlines()
    assert f"{header}\n{pending}\n" == PENDING
    assert row.startswith("ch3.5-contact,cpu,") and row.endswith(",MEASURED")


def test_each_change_of_what_a_reader_sees_is_named_and_nothing_else(project):
    svg, page = "curriculum/bench/results/a.svg", "curriculum/bench/results/README.md"
    written = "is not what was written of today's results"
    changes = (
        ("contact.py", "n . (v_a - v_b)", "n . (v_b - v_a)", "section contact/opening changed"),
        ("meta.yaml", "drop: [--contact, all]", "drop: [--mass, 2]", "section meta/runs changed"),
        ("exercises/ex1.py", "Your bet.", "A bet.", "section exercises/ex1 changed"),
        (CLAMP, "It pushes.", "It pulls.", "section figures/clamp changed"),
        ("README.md", "| 1 |", "| 2 |", written),
        (svg, "<svg/>", "<svg></svg>", written),
        (page, "# Page", "# Pages", written),
    )
    for file, old, new, _ in changes:
        edit(project / file, old, new)
    named = re.findall(r"^(.+:1: .*?); repair: ", run_gate(project).stdout, re.MULTILINE)
    assert sorted(named) == sorted(f"{file}:1: {problem}" for file, *_, problem in changes)


def test_block_that_a_command_wrote_needs_no_reader(project):
    subprocess.run([sys.executable, "-B", "-c", WRITE.replace("1", "2")], cwd=project, check=True)
    assert "-->\n| 2 |\n<!-- sealed " in (project / "README.md").read_text("utf-8")
    assert run_gate(project).returncode == 0

    newer = '{"skip": {"measured": {"code": {}}}}'  # which nobody has drawn
    (project / "curriculum/bench/results/results.json").write_text(newer)
    assert (
        "a.svg:1: is not what was written of today's results; repair: " in run_gate(project).stdout
    )


def test_runs_are_kept_until_the_code_changes(project):
    kept = project / ".cache/run-drop.json"
    stamp = kept.stat().st_mtime_ns
    run_gate(project)
    assert kept.stat().st_mtime_ns == stamp
    edit(project / "contact.py", "EXPLODED = 10.0", "EXPLODED = 11.0")
    run_gate(project)
    assert kept.stat().st_mtime_ns != stamp


def test_missing_package_is_named_as_such(project):
    (project / "yaml.py").write_text("raise ModuleNotFoundError('No yaml', name='yaml')\n")
    run = run_gate(project)
    assert run.returncode == 2
    assert run.stderr.startswith("yaml is missing; install it: ") and run.stderr.count("\n") == 1


# numbers by reference, on runs given by hand


@pytest.fixture
def numbers():
    drop = {
        "steps": 2000,
        "quality": {"lcp": {"depth": 0.0567, "state": "ok"}, "soft": {"depth": 0.17}},
    }
    return references.Numbers({"drop": drop, "drop-dt-0.03": {"quality": {"lcp": {"depth": 1.3}}}})


@pytest.mark.parametrize(
    "reference, text",
    [
        ("steps", "2000"),
        ("quality.lcp.depth|.2f", "0.06"),
        ("drop-dt-0.03:quality.lcp.depth|.1f", "1.3"),
        ("1 + quality.lcp.depth * 2|.4f", "1.1134"),
        ("(1 - quality.lcp.depth) / 1e-2|.2f", "94.33"),
        ("0 - quality.lcp.depth|.1e", "−5.7\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}10⁻²"),
        ("quality.lcp.state", "ok"),
        ("= 1972 | year of the paper", "1972"),
        ("contact.RADIUS|.1f", "0.1"),
        ("contact.Settings.iters", "20"),
        ("contact.SCENES.0", "drop"),
    ],
)
def test_reference_becomes_a_number(numbers, reference, text):
    assert numbers.fill(f"so {{{{{reference}}}}} it is") == f"so {text} it is"


@pytest.mark.parametrize(
    "reference, error",
    [
        ("quality.lcp.depth", "is a fraction and needs a format"),
        ("quality.lcp.deep|.2f", "no 'deep'; known there: depth, state"),
        ("nowhere:steps", "no run 'nowhere' in meta.yaml; known there: drop, smoke"),
        ("contact.NOTHING", "no 'NOTHING'; known there: GRAVITY, RADIUS"),
        ("quality.lcp|.2f", "is no number; known there: depth, state"),
        ("steps / 0|.1f", "division by zero"),
        ("steps + quality.lcp.state", "'quality.lcp.state' is 'ok', no number"),
        ("steps + [1]", "has other signs than"),
        ("steps +", "cannot be reckoned"),
        ("fact:nothing.key", "'fact:nothing' is not there: no 'nothing'; known there: implicit"),
    ],
)
def test_reference_that_cannot_be_made_says_what_is_known(numbers, reference, error):
    with pytest.raises(ValueError, match=error.replace("(", r"\(")):
        numbers.fill(f"{{{{{reference}}}}}")


def test_sentence_in_words_is_held_to_the_numbers(numbers):
    assert numbers.broken("quality.soft.depth > 2 * quality.lcp.depth") == ""
    assert numbers.broken("quality.soft.depth <= quality.lcp.depth") == "0.17 <= 0.0567"
    with pytest.raises(ValueError, match="is not 'FORMULA < FORMULA'"):
        numbers.broken("quality.soft.depth")
    with pytest.raises(ValueError, match="'quality.lcp.state' is 'ok', no number"):
        numbers.broken("quality.lcp.state > 0")


def test_hash_of_a_region_is_that_of_the_text_between_its_markers():
    lines = (ROOT / "contact.py").read_bytes().split(b"\n")
    first = lines.index(b"# --- region: sweep ---")
    last = lines.index(b"# --- region: lcp ---", first)
    shown = b"".join(line + b"\n" for line in lines[first + 1 : last]).rstrip() + b"\n"
    sweep = regions.read_all()["sweep"]
    assert sweep.sha == hashlib.sha256(shown).hexdigest() and sweep.line == first + 2
    assert "solve_contacts" in sweep.defines
