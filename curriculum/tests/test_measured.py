"""Measured results know the code they measured; figures and pages come out the same every time."""

import json
import math
import re

import numpy as np
import pytest

from curriculum import measured, plotting, reporting

CODE = 'G = 9.81  # m/s^2\n\n\ndef fall(t):\n    """How far [m]."""\n    return "# no comment", G * t\n'


@pytest.fixture
def section(tmp_path):
    """A section measured on a contact.py of its own, which tests may change."""
    (tmp_path / "contact.py").write_text(CODE)
    code = {"contact.py": measured.code_hash("contact.py", tmp_path)}
    about = {"command": "python -m curriculum.bench", **measured.provenance()} | {"code": code}
    return {"measured": about, "error": 0.25}


# results and the code they measured


def test_a_changed_constant_makes_results_stale_and_the_note_says_how_to_repair(section, tmp_path):
    assert not measured.is_stale(section, tmp_path)
    assert measured.stale_note(section, tmp_path) == ""
    (tmp_path / "contact.py").write_text(CODE.replace("9.81", "9.82"))
    assert measured.stale_files(section, tmp_path) == ["contact.py"]
    said = measured.stale_note(section, tmp_path)
    assert "Stale" in said and "contact.py" in said and "`python -m curriculum.bench`" in said


def test_a_string_that_looks_like_a_comment_counts_as_code(section, tmp_path):
    (tmp_path / "contact.py").write_text(CODE.replace("# no comment", "# other"))
    assert measured.is_stale(section, tmp_path)


def test_comments_docstrings_and_blank_lines_do_not_make_results_stale(section, tmp_path):
    other = CODE.replace("m/s^2", "metres").replace("How far", "The way").replace("\n\n\n", "\n\n")
    assert other != CODE
    (tmp_path / "contact.py").write_text(other)
    assert not measured.is_stale(section, tmp_path)


def test_results_that_do_not_say_what_they_measured_are_stale():
    assert measured.stale_files({"error": 1}) == ["unknown"]
    assert "Stale" in measured.stale_note({"error": 1})


def test_a_file_that_vanished_makes_results_stale(section, tmp_path):
    (tmp_path / "contact.py").unlink()
    assert measured.stale_files(section, tmp_path) == ["contact.py"]


def test_saving_one_section_keeps_the_others_and_is_strict_json(tmp_path):
    measured.save(tmp_path, "one", {"x": [1.23456789, math.nan, np.float64(2)]}, "a command")
    two = measured.save(tmp_path, "two", {"y": math.inf}, "another")
    read = json.loads((tmp_path / measured.NAME).read_text(), parse_constant=pytest.fail)
    assert read["one"]["x"] == [1.23457, None, 2.0]
    assert read["two"] == two and two["y"] is None
    assert read["one"]["measured"]["code"]["contact.py"] == measured.code_hash("contact.py")
    assert not measured.is_stale(two)


def test_footer_names_machine_versions_commit_and_hashes(section):
    said = measured.footer(section)
    assert f"numpy {np.__version__}" in said and "cores of" in said and "commit" in said
    assert section["measured"]["code"]["contact.py"] in said


def test_cells_of_a_stopped_run_are_found_again_and_a_torn_end_is_left_out(tmp_path):
    cells = measured.Cells(tmp_path / "cells.jsonl")
    cells["a"], cells["b"] = 1, {"x": [2.5]}
    again = measured.Cells(tmp_path / "cells.jsonl")
    assert "a" in again and again["b"] == {"x": [2.5]}
    whole = (tmp_path / "cells.jsonl").read_bytes()
    (tmp_path / "cells.jsonl").write_bytes(whole[:-5])
    assert len(measured.Cells(tmp_path / "cells.jsonl")) == 1


def test_cells_of_other_code_or_settings_are_not_used(tmp_path):
    measured.Cells(tmp_path / "cells.jsonl", about={"seeds": 3})["a"] = 1
    assert "a" in measured.Cells(tmp_path / "cells.jsonl", about={"seeds": 3})
    assert "a" not in measured.Cells(tmp_path / "cells.jsonl", about={"seeds": 9})
    (tmp_path / "cells.jsonl").write_text(
        '{"code": {"contact.py": "0"}, "about": null}\n["a", 1]\n'
    )
    assert "a" not in measured.Cells(tmp_path / "cells.jsonl")


def test_the_list_of_results_names_what_is_stale_and_fails_the_check(monkeypatch, capsys):
    monkeypatch.setattr(measured, "all_sections", lambda: [("results.json", "pile", {"rows": []})])
    assert measured.main([]) == 0
    assert measured.main(["--check"]) == 1
    assert "pile" in (said := capsys.readouterr().out) and "stale" in said


# pages


def test_a_claim_whose_condition_fails_is_not_printed_as_true():
    claims = [reporting.Claim(False, "all is well", "it is not"), reporting.Claim(True, "so.")]
    assert reporting.sentences(claims) == "it is not so."


def test_a_goal_that_is_missed_says_missed():
    assert reporting.Goal("x at most 1", "2", False).verdict() == "**missed**"
    assert reporting.Goal("x at most 1", "1", True).verdict() == "met"
    assert reporting.Goal("x at most 1", "no peer", None).verdict() == "not measured"


def test_numbers_keep_three_digits_and_no_clumsy_exponents():
    shown = {
        0.25: "0.250",
        1.5: "1.50",
        123.4: "123",
        9.996: "10.0",
        4.44e-15: "4.44e-15",
        0: "0",
        None: "-",
        1409.4: "1409",
        2.5e7: "2.50e7",
        math.inf: "inf",
    }
    assert {value: reporting.number(value) for value in shown} == shown


def test_a_bar_in_a_cell_does_not_break_the_table():
    assert reporting.table(["a"], [["|x|"]]).splitlines()[-1] == r"| \|x\| |"


# figures


def drawn(section):
    figure, (upper, lower) = plotting.figure(rows=2, title="Title", explained="0.9999 " * 30)
    for k, name in enumerate(plotting.LOOKS):
        plotting.line(upper, [1, 2], [k, k], name)
    plotting.heat(lower, [1, 2], [1, 2], [[1, 2], [None, 9]], [1.5, 4.0], "depth / r")
    return plotting.svg(figure, section)


def test_figures_are_the_same_bytes_small_with_text_as_text_and_a_style_for_the_dark(section):
    pytest.importorskip("matplotlib", reason="figures need matplotlib: pip install -e '.[bench]'")
    made = drawn(section)
    assert made == drawn(section)
    assert len(made) < plotting.LARGEST and "<dc:date>" not in made
    assert re.search(r"<text[^>]*>Title</text>", made)
    assert "prefers-color-scheme: dark" in made
    assert re.search(r">0.9999 ", made), "numbers in words keep their digits"
    assert not re.search(r"<(path|use)[^>]*\d\.\d{3}", made)


def test_a_figure_that_is_too_large_is_refused(section, monkeypatch):
    pytest.importorskip("matplotlib", reason="figures need matplotlib: pip install -e '.[bench]'")
    monkeypatch.setattr(plotting, "LARGEST", 1000)
    with pytest.raises(ValueError, match=r"Title: .* bytes; a figure may have 1,000"):
        drawn(section)


def test_methods_are_told_apart_without_colour():
    looks = [(marker, str(dash)) for _, marker, dash in plotting.LOOKS.values()]
    assert len({marker for marker, _ in looks}) == len(looks)
    assert len({color for color, _, _ in plotting.LOOKS.values()}) == len(looks)
