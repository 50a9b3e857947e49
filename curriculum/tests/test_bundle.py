"""The bundle for the course: the rules of the course's own gates, and the figures of contact.py.

The rules are those of zero2robot's continuous integration (infra/ci and grader of its repository):
a script of at most 450 lines, regions by exact text, includes in a fence, no framework, a ledger of
seven columns, checks named test_exN_.
"""

import ast
import csv
import hashlib
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import contact
from curriculum import bundle, regions
from curriculum.drift import texts
from curriculum.quoted import load_meta

yaml = pytest.importorskip("yaml")
ROOT = Path(__file__).resolve().parents[2]
MARKER = re.compile(r"^\s*#\s*---\s*region:\s*([A-Za-z0-9_.\-]+)\s*---\s*$")
CLOSING = re.compile(r"^\s*#\s*---\s*endregion\s*---\s*$")
INCLUDE = re.compile(r"```[a-zA-Z0-9]*\n\[include-by-region:\s*[\w.]+#(\w+)\]\n```")


@pytest.fixture(scope="module")
def made(real_numbers):
    """The bundle's files, {path: text}."""
    return bundle.files(ROOT, "nowhere", real_numbers.runs)


@pytest.fixture(scope="module")
def course(made, tmp_path_factory):
    """The chapter's folder, written below a folder that stands for the course's."""
    folder = tmp_path_factory.mktemp("course")
    for name, text in made.items():
        (folder / "curriculum" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "curriculum" / name).write_text(text)
    return folder / "curriculum" / bundle.CHAPTER


def run(course, *flags, **options):
    """The course's contact.py in a process; the banner is this repository's."""
    return subprocess.run(
        [sys.executable, str(course / "contact.py"), *flags],
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        **options,
    )


def read_regions(text):
    """{name: exact text}, read as the course reads them."""
    found, name, lines = {}, None, []
    for line in text.splitlines(keepends=True):
        opening = MARKER.match(line)
        if opening:
            assert name is None and opening[1] not in found
            name, lines = opening[1], []
        elif CLOSING.match(line):
            found[name], name = "".join(lines), None
        elif name:
            lines.append(line)
    assert name is None
    return found


def test_the_script_is_one_file_of_at_most_450_lines(made):
    lines = made[f"{bundle.CHAPTER}/contact.py"].splitlines()
    print(f"{len(lines)} lines")
    assert len(lines) <= 450 and max(map(len, lines)) <= 100


def test_every_region_hash_is_of_the_regions_exact_text(made):
    found = read_regions(made[f"{bundle.CHAPTER}/contact.py"])
    facts = yaml.safe_load(made[f"{bundle.CHAPTER}/meta.yaml"])
    assert facts["region_hashes"] == {
        name: hashlib.sha256(text.encode()).hexdigest() for name, text in found.items()
    }
    assert facts["artifact"] == "contact.py" and facts["id"] == "ch3.5-contact"


def test_the_text_includes_regions_of_the_script_alone_and_leaves_nothing_unresolved(made):
    text = made[f"{bundle.CHAPTER}/prose/chapter.md"]
    included = INCLUDE.findall(text)
    assert len(included) == text.count("include-by-region") and len(included) > 8
    assert set(included) <= set(read_regions(made[f"{bundle.CHAPTER}/contact.py"]))
    for left in ("{{", "<!--", "](try:", "](drag:", "[measured", "not publishable"):
        assert left not in text
    assert not re.search(r"\d\s*min\w*\s*\(measured", text)


def test_what_is_left_out_is_named_where_the_text_shows_it_and_is_not_in_the_script(made):
    text = made[f"{bundle.CHAPTER}/prose/chapter.md"]
    found = read_regions(made[f"{bundle.CHAPTER}/contact.py"])
    shown = list(texts.find_includes((ROOT / texts.CHAPTER).read_text("utf-8")))
    assert any(include.file == "curriculum/exact.py" for include in shown)
    note = " ".join(text[: text.index("\n## ")].replace("\n> ", " ").split())
    for name, why in bundle.LEFT_OUT.items():
        assert bundle.course_name(name) not in found
        assert f"`{name}`" in note and f"({why})" in note, "said at the top of the text"
        assert name.endswith(".py") or name in regions.find_all()
        if any(name in (include.name, include.file) for include in shown):
            assert why in text, name


def test_a_command_that_the_courses_script_does_not_take_says_where_it_runs(made):
    elsewhere = "# in the chapter's own repository"
    commands = re.findall(
        r"^python contact\.py.*", made[f"{bundle.CHAPTER}/prose/chapter.md"], re.MULTILINE
    )
    exact = [line for line in commands if "--contact exact" in line]
    spring = [line for line in commands if "--contact penalty" in line]
    assert exact and all(line.endswith(elsewhere) for line in exact)
    assert spring and not any(elsewhere in line for line in spring)


def test_no_module_is_imported_but_the_standard_ones_numpy_rerun_and_the_courses_banner(made):
    for name, text in made.items():
        if not name.endswith(".py"):
            continue
        for node in ast.walk(ast.parse(text)):
            names = (
                [each.name for each in node.names]
                if isinstance(node, ast.Import)
                else [node.module]
                if isinstance(node, ast.ImportFrom)
                else []
            )
            for each in names:
                top = each.split(".")[0]
                allowed = {"numpy", "rerun", "pytest", "yaml", "contact"}
                assert (
                    top in sys.stdlib_module_names | allowed
                    or top.startswith("ex")
                    or each == "curriculum.common.device"
                ), f"{name} imports {each}"


def test_smoke_twice_writes_the_same_bytes_and_the_figures_of_contact_py(course, tmp_path):
    for folder in ("a", "b"):
        done = run(course, "--smoke", "--seed", "0", "--no-rerun", "--out", str(tmp_path / folder))
        assert done.returncode == 0, done.stderr
    first, second = ((tmp_path / each / "metrics.json").read_bytes() for each in ("a", "b"))
    assert first == second
    metrics, scene = json.loads(first), contact.build_scene("drop")
    for model in ("penalty", "lcp"):
        here = contact.contact_quality(contact.run_model(model, scene, 0.002, 800), scene, 0.002)
        for key, value in metrics["quality"][model].items():
            assert value == (round(here[key], 12) if isinstance(value, float) else here[key]), key
    assert metrics["stability"]["penalty"] == 0.008 and metrics["stability"]["lcp"] == 0.064


@pytest.mark.parametrize("scene", ["bounce", "stack"])
def test_the_other_scenes_give_the_same_states_to_the_bit(course, scene):
    script = (
        f"import sys; sys.path.insert(0, {str(course)!r}); import contact, hashlib; "
        f"s = contact.build_scene({scene!r}, 3)\n"
        "for model in contact.MODELS:\n"
        "    run = contact.run_model(model, s, 0.002, 300)\n"
        "    print(hashlib.sha256(run.q.tobytes() + run.v.tobytes()).hexdigest())"
    )
    there = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=course
    ).stdout.split()
    start = contact.build_scene(scene, 3)
    runs = [contact.run_model(model, start, 0.002, 300) for model in ("penalty", "lcp")]
    assert there == [hashlib.sha256(r.q.tobytes() + r.v.tobytes()).hexdigest() for r in runs]


def test_an_explosion_is_strict_json(course, tmp_path):
    flags = ("--dt", "0.03", "--steps", "4000", "--stiffness", "1e200", "--contact", "penalty")
    done = run(course, *flags, "--no-rerun", "--out", str(tmp_path))
    assert done.returncode == 0 and "EXPLODED" in done.stdout, done.stderr
    text = (tmp_path / "metrics.json").read_text()
    assert "NaN" not in text and "Infinity" not in text and "null" in text


def outcomes(course, folder, **changes):
    """{test: outcome} of the checks, with texts replaced in copies of the exercises."""
    suggested = folder / bundle.CHAPTER / "exercises/suggested"
    subprocess.run(["cp", "-r", str(course.parents[1]), str(folder)], check=True)
    suggested = folder / "curriculum" / bundle.CHAPTER / "exercises/suggested"
    for name, (old, new) in changes.items():
        (path,) = suggested.glob(f"{name}_*.py")
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "no:cacheprovider",
            "-rA",
            "-q",
            "checks.py",
            "-c",
            "/dev/null",
        ],
        cwd=suggested,
        capture_output=True,
        text=True,
    )
    return dict(
        reversed(line.split(" ", 1))
        for line in re.findall(r"^((?:PASSED|FAILED) checks\.py::\w+)", done.stdout, re.M)
    ), done.stdout


def test_untouched_exercises_are_skipped_by_name_and_their_measurements_hold(course, tmp_path):
    found, said = outcomes(course, tmp_path)
    assert set(found.values()) == {"PASSED"} and len(found) == 2
    assert "ex1: no prediction yet" in said and "project_impulse is still a blank" in said
    names = re.findall(r"def (test_\w+)", (course / "exercises/suggested/checks.py").read_text())
    assert names and all(re.match(r"test_ex\d+_", name) for name in names)


def test_right_answers_pass_and_wrong_ones_fail(course, tmp_path):
    blank = [
        line.strip()
        for line in (course / "exercises/suggested/ex2_completion_contact.py")
        .read_text()
        .splitlines()
        if re.search(r"= \.\.\.", line)
    ]
    assert len(blank) == 2
    answer = load_meta()["exercises"]["ex1"]["answer"]
    found, said = outcomes(
        course,
        tmp_path,
        ex1=("PREDICTION = None", f"PREDICTION = {answer!r}"),
        ex2=(blank[1], "new_lam = max(0.0, lam + dlam)"),
        ex3=("PREDICTION = None", "PREDICTION = 'A'"),
    )
    assert found["checks.py::test_ex1_prediction"] == "PASSED"
    assert found["checks.py::test_ex2_project_impulse"] == "PASSED"
    assert found["checks.py::test_ex3_prediction"] == "FAILED"
    assert "you predicted A, what happens is B" in said


def test_the_ledger_gets_rows_that_claim_nothing_and_keeps_all_others(tmp_path):
    path = tmp_path / "wallclock.csv"
    path.write_text(
        "chapter,tier,wallclock_min,config_hash,commit,date,status\n"
        "ch3.4-x,t4,1.5,abc,def,2026-01-01,MEASURED\n"
        "ch3.5-contact,l40s,0.05,abc,def,2026-01-01,MEASURED\n"
    )
    rows = list(csv.reader(io.StringIO(bundle.ledger(path))))
    assert all(len(row) == 7 for row in rows) and rows[1][0] == "ch3.4-x" and rows[1][2] == "1.5"
    ours = {row[1]: row[2:] for row in rows if row[0] == "ch3.5-contact"}
    assert set(ours) == {"l40s", "cpu-laptop", "mps", "t4", "4090"}
    assert all(row == ["", "", "", "", "PENDING"] for row in ours.values())


def test_a_script_above_the_cap_is_not_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(bundle, "CAP", 100)
    assert bundle.main(["--out", str(tmp_path / "new")]) == 1
    assert re.search(r"has \d+ lines, allowed: 100; leave a region out", capsys.readouterr().err)
    assert not (tmp_path / "new").exists()


def test_an_edit_that_no_longer_fits_is_told_with_its_region(monkeypatch):
    monkeypatch.setattr(bundle, "EDITS", (("scenes", "no such line", ""),))
    with pytest.raises(ValueError, match=r"contact.py:\d+: region scenes no longer has the lines"):
        bundle.script(ROOT)


def test_a_name_that_no_kept_region_defines_is_told(monkeypatch):
    edits = tuple(edit for edit in bundle.EDITS if "possible_pairs" not in edit[1])
    monkeypatch.setattr(bundle, "EDITS", edits)
    with pytest.raises(ValueError, match="uses possible_pairs, which no region that it keeps"):
        bundle.script(ROOT)
