"""The gate: a small project in order passes; every way to drift fails with a line and a repair."""

import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from curriculum import check_prose_code_drift as gate
from curriculum import quoted, regions
from curriculum.common import wallclock

ROOT = Path(__file__).resolve().parents[2]
CHAPTER = gate.CHAPTER

CONTACT = '''"""A stand-in for the chapter's script."""
# --- region: setup ---
import json
import sys
# --- endregion ---


# --- region: report ---
def main(flags):
    out = flags[flags.index("--out") + 1]
    metrics = {"dt": 0.002, "steps": 2000, "quality": {"lcp": {"depth": 0.056743, "step": None},
               "penalty": {"depth": 0.9 if "--deep" in flags else 0.251329}}}
    with open(out + "/metrics.json", "w") as file:
        json.dump(metrics, file)
    print("config_hash:", "c0ffee")


main(sys.argv[1:])
# --- endregion ---
'''
TEXT = """# 3.5: Contact

The script sets up like this.

```
[include-by-region: contact.py#setup]
```

## What it measures

```
[include-by-region: contact.py#report]
```

The spring lets in {{quality.penalty.depth|.3f}} r, {{deep:quality.penalty.depth|.1f}} r if soft,
{{quality.penalty.depth / quality.lcp.depth|.1f}} times lcp's. Laptop: {{wallclock.cpu-laptop}}.
<!-- holds: quality.penalty.depth > 4 * quality.lcp.depth -->
Run `python contact.py --dt 0.03`, see ex2, chapter 3.3, [the source](https://example.org/3.1/a12).

## What comes next

Friction is for chapter 3.6.
"""
META = """runs:
  first: []
  deep: [--deep]

reference_run:
  provenance: none yet
  values:
    dt: 0.002

exercises:
  ex1:
    answer: C
    bands:
      quality.penalty.depth: [0.25, 0.26]
    holds:
      - deep:quality.penalty.depth > quality.penalty.depth
    hints:
      - Why?
    reveal:
      C: It goes in {{quality.penalty.depth|.3f}} r.

scope:
  section: What comes next
  words: [chapter 3.6, next chapter]

region_hashes:
"""
LEDGER = (
    f"{','.join(wallclock.COLUMNS)}\n"
    f"{wallclock.CHAPTER},cpu-vm,0.004,c0ffee,1234567,2026-01-02,MEASURED\n"
    f"{wallclock.CHAPTER},cpu-laptop,,,,,PENDING\n"
)


@pytest.fixture
def project(tmp_path, capsys):
    """A project in order: two regions, both accepted and shown."""
    for file, text in (
        ("contact.py", CONTACT),
        (CHAPTER, TEXT),
        ("meta.yaml", META),
        ("wallclock.csv", LEDGER),
    ):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    for name in ("setup", "report"):
        gate.accept(tmp_path, name)
    quoted.record(tmp_path)
    capsys.readouterr()
    return tmp_path


def edit(project, file, old, new, count=1):
    data = (project / file).read_bytes()
    old, new = (text if isinstance(text, bytes) else text.encode() for text in (old, new))
    assert data.count(old) >= 1, (file, old)
    (project / file).write_bytes(data.replace(old, new, count))


def snapshot(folder):
    return {
        path: (path.stat().st_mtime_ns, path.read_bytes())
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_a_project_in_order_passes_and_the_check_writes_nothing(project, capsys):
    before = snapshot(project)
    assert gate.main(["--root", str(project)]) == 0
    assert capsys.readouterr().out == "chapter, code, numbers and ledger agree\n"
    assert snapshot(project) == before


HASH = "region_hashes:\n  setup: "
DRIFT = {
    "an edited region": (
        ("contact.py", "import sys", "import sys  # changed"),
        r"contact.py:2: region setup has changed since .*--accept setup",
    ),
    "a removed hash": (
        ("meta.yaml", "  report:", "  # report:"),
        r"contact.py:8: region report has no hash in meta.yaml; repair: .*--accept report",
    ),
    "a hash without a region": (
        ("meta.yaml", HASH, "region_hashes:\n  old: abc\n  setup: "),
        r"meta.yaml:\d+: a hash of old, and contact.py has no such region",
    ),
    "an unknown include": (
        (CHAPTER, "contact.py#setup", "contact.py#setpu"),
        rf"{CHAPTER}:6: includes setpu, and contact.py has no such region; repair: name one ",
    ),
    "a region never shown": (
        (CHAPTER, "```\n[include-by-region: contact.py#setup]\n```", ""),
        rf"{CHAPTER}:1: region setup is never shown",
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
        rf"{CHAPTER}:6: an include that",
    ),
    "an include twice": (
        (CHAPTER, "contact.py#report", "contact.py#setup"),
        rf"{CHAPTER}:12: includes setup a second",
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
        r"contact.py:8: region report is never closed",
    ),
    "a duplicate marker": (
        ("contact.py", "region: report", "region: setup"),
        r"contact.py:8: a second region setup",
    ),
    "CRLF": (("contact.py", "import sys\n", "import sys\r\n"), r"contact.py:4: a carriage return"),
    "CRLF in the chapter": (
        (CHAPTER, "like this.\n", "like this.\r\n"),
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
        ("contact.py", "\n\n# --- region: report", "\nx = 1\n# --- region: report"),
        r"contact.py:7: code outside any region",
    ),
    "a false number in the prose": (
        (CHAPTER, "{{quality.penalty.depth|.3f}} r,", "0.251 r,"),
        rf"{CHAPTER}:15: a typed number, 0.251; repair: write",
    ),
    "a typed number in a code span": (
        (CHAPTER, "--dt 0.03`", "--dt 0.03` and `0.2513`"),
        rf"{CHAPTER}:18: a typed number",
    ),
    "a typed table in a fence": (
        (CHAPTER, "## What comes", "```\npenalty 0.25\n```\n\n## What comes"),
        rf"{CHAPTER}:21: a typed number, 0.25",
    ),
    "a typed number without a reason": (
        (CHAPTER, "{{wallclock.cpu-laptop}}", "{{= 3 |}}"),
        rf"{CHAPTER}:16: .*needs a reason",
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
    "a benchmark not run yet": (
        (CHAPTER, "{{wallclock.cpu-laptop}}", "{{bench.drop|.2f}}"),
        rf"{CHAPTER}:16: .*curriculum/bench has no results.json: python -m curriculum.bench",
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
        ("meta.yaml", "    quality.penalty.depth:", "    # "),
        r"quality.penalty.depth is missing",
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
        ("meta.yaml", "[0.25, 0.26]", "[0.26, 0.27]"),
        r"meta.yaml:\d+: ex1, .* outside 0.26 to 0.27",
    ),
    "an answer that is not true": (
        ("meta.yaml", "- deep:quality.penalty.depth >", "- deep:quality.penalty.depth <"),
        r"meta.yaml:\d+: ex1, .*does not hold",
    ),
    "a stale ledger claim": (
        ("wallclock.csv", "c0ffee", "badcab"),
        r"wallclock.csv:2: cpu-vm was measured at config badcab, the "
        r"default run is now c0ffee; repair: python -m curriculum.common.wallclock --measure",
    ),
    "a broken ledger": (
        ("wallclock.csv", "MEASURED", "GUESSED"),
        r"wallclock.csv:2: status 'GUESSED'; allowed",
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
    "meta.yaml that is not YAML": (("meta.yaml", "runs:", "runs: ]"), r"meta.yaml:1: not YAML"),
    "no runs": (("meta.yaml", "runs:\n", "walks:\n"), r"meta.yaml:1: no `runs`"),
}


@pytest.mark.parametrize("change, message", DRIFT.values(), ids=DRIFT)
def test_drift_fails_with_file_line_and_repair(project, capsys, change, message):
    edit(project, *change)
    before = snapshot(project)
    assert gate.main(["--root", str(project)]) == 1
    problems = capsys.readouterr().err.splitlines()
    assert [
        line for line in problems if re.match(message, line) or re.search(message, line)
    ], "\n".join(problems)
    assert all(re.match(r"[\w./]+:\d+: .+; repair: .+", line) for line in problems), "\n".join(
        problems
    )
    assert snapshot(project) == before


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


def test_accepting_shows_the_change_and_the_section_that_quotes_it_and_records_one_hash(
    project, capsys
):
    for command in (
        ["init", "-q"],
        ["add", "."],
        ["-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "x"],
    ):
        subprocess.run(["git", *command], cwd=project, check=True)
    edit(project, "contact.py", "import sys", "import sys  # changed")
    edit(project, "contact.py", "def main(flags):", "def main(flags):  # also")
    before = quoted.load_meta(project)["region_hashes"]
    assert gate.main(["--root", str(project), "--accept", "setup"]) == 0
    out = capsys.readouterr().out
    assert "-import sys\n+import sys  # changed\n" in out and "# also" not in out
    assert (
        f"{CHAPTER}:6 shows it; the section, lines 1 to 8, says:" in out
        and "The script sets up like this." in out
    )
    after = quoted.load_meta(project)["region_hashes"]
    assert after["setup"] == regions.find(project / "contact.py")["setup"].sha256 != before["setup"]
    assert after["report"] == before["report"]
    assert [line for line in gate.check(project) if "setup" in line] == []
    assert any("region report has changed" in line for line in gate.check(project))


def test_without_git_accepting_says_so_and_shows_the_whole_region(project, capsys, monkeypatch):
    edit(project, "contact.py", "import sys", "import sys  # changed")
    monkeypatch.setenv("PATH", "")
    gate.accept(project, "setup")
    out = capsys.readouterr().out
    assert (
        "no git history here, so the whole region is shown" in out
        and "+import json\n+import sys  # changed" in out
    )


def test_accepting_a_region_that_is_gone_removes_its_hash_and_keeps_the_rest_of_the_file(
    project, capsys
):
    edit(project, "meta.yaml", HASH, "region_hashes:\n  old: abc\n  setup: ")
    text = (project / "meta.yaml").read_text()
    gate.accept(project, "old")
    assert (project / "meta.yaml").read_text() == text.replace("  old: abc\n", "")


def test_accepting_what_is_in_order_or_unknown_or_malformed_changes_nothing(project, capsys):
    before = snapshot(project)
    assert gate.main(["--root", str(project), "--accept", "setup"]) == 0
    assert "nothing to accept" in capsys.readouterr().out
    assert gate.main(["--root", str(project), "--accept", "nonsense"]) == 2
    assert "given 'nonsense', allowed: setup, report" in capsys.readouterr().err
    assert snapshot(project) == before
    edit(project, "contact.py", "region: report", "region: setup")
    before = snapshot(project)
    assert gate.main(["--root", str(project), "--accept", "setup"]) == 2
    assert snapshot(project) == before


def test_recording_the_reference_run_twice_changes_nothing_and_keeps_the_rest_of_meta(project):
    before = (project / "meta.yaml").read_text()
    assert quoted.record(project) == []
    assert (
        before.replace(before[before.index("reference_run:") : before.index("exercises:")], "")
        == META.replace(META[META.index("reference_run:") : META.index("exercises:")], "")
        + before[before.index("region_hashes:\n") + len("region_hashes:\n") :]
    )


def test_a_text_is_rendered_with_generated_numbers(project):
    shown = quoted.Numbers(project).render(
        (project / CHAPTER).read_text() + "{{= 1972 | year}} {{steps}}"
    )
    assert "lets in 0.251 r, 0.9 r if soft,\n4.4 times" in shown
    assert "Laptop: not yet measured." in shown and shown.endswith("1972 2000")


def test_keys_that_hold_dots_and_list_places_are_found(project):
    made = quoted.Numbers(project, runs={"first": {"a": {"0.002": [{"b": 7}]}}})
    assert made.value("a.0.002.0.b") == 7 and made.text("a.0.002.0.b") == "7"


# The real chapter

REAL = pytest.mark.skipif(not (ROOT / CHAPTER).exists(), reason=f"{CHAPTER} is not written yet")


@pytest.fixture
def copy(tmp_path):
    """What the gate reads of the real project."""
    for file in ("contact.py", "meta.yaml", CHAPTER):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / file, tmp_path / file)
    return tmp_path


def region_problems(folder):
    project = gate.Project(folder)
    gate.check_regions(project)
    return project.problems


@REAL
def test_the_real_project_is_in_order():
    assert gate.check(ROOT) == []


@REAL
@pytest.mark.parametrize(
    "name", ["setup", "scenes", "contacts", "penalty", "lcp", "exact", "simulate", "report"]
)
def test_one_character_changed_in_a_region_of_the_real_script_is_caught(copy, name):
    text, region = (copy / "contact.py").read_text(), regions.find(copy / "contact.py")[name]
    start = text.index(region.text)
    place = start + random.Random(name).choice(
        [k for k, c in enumerate(region.text) if c.isalnum()]
    )
    (copy / "contact.py").write_text(
        text[:place] + ("b" if text[place] != "b" else "d") + text[place + 1 :]
    )
    caught = [line for line in region_problems(copy) if f"region {name} has changed" in line]
    assert caught and caught[0].startswith(f"contact.py:{region.first - 1}: ")
    (copy / "contact.py").write_text(text)
    assert region_problems(copy) == []
