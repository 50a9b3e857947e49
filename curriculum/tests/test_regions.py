"""Regions: what is found, what is hashed, and every way a marker can be wrong."""

import hashlib
from pathlib import Path

import pytest

from curriculum import regions

ROOT = Path(__file__).resolve().parents[2]
GOOD = '''"""Docstring,
two lines."""
# a comment may stand outside
# --- region: one ---
x = 1

y = "é"
# --- endregion ---

# --- region: two ---
z = x
# --- endregion ---
'''


def write(tmp_path, text):
    path = tmp_path / "contact.py"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return path


def test_regions_are_found_in_reading_order_with_the_lines_between_their_markers(tmp_path):
    found = regions.find(write(tmp_path, GOOD))
    assert [(r.name, r.first, r.last, r.text) for r in found.values()] == [
        ("one", 5, 7, 'x = 1\n\ny = "é"\n'),
        ("two", 11, 11, "z = x\n"),
    ]


def test_the_hash_is_of_the_utf8_text_a_reader_sees(tmp_path):
    assert (
        regions.find(write(tmp_path, GOOD))["one"].sha256
        == hashlib.sha256('x = 1\n\ny = "é"\n'.encode()).hexdigest()
    )


def test_a_hash_does_not_change_when_another_region_grows(tmp_path):
    before = regions.find(write(tmp_path, GOOD))["two"].sha256
    assert (
        regions.find(write(tmp_path, GOOD.replace("x = 1", "x = 1\nw = 2")))["two"].sha256 == before
    )


WRONG = {
    "nested": (
        GOOD.replace("z = x\n", "z = x\n# --- region: three ---\n"),
        "contact.py:12: region three begins inside region two, begun in line 10",
    ),
    "unclosed": (
        GOOD.removesuffix("# --- endregion ---\n"),
        "contact.py:10: region two is never closed",
    ),
    "duplicate": (
        GOOD.replace("region: two", "region: one"),
        "contact.py:10: a second region one; the other begins in line 4",
    ),
    "unopened": (GOOD + "# --- endregion ---\n", "contact.py:13: endregion, but no region is open"),
    "unknown": (
        GOOD.replace("# --- region: two ---", "# --- Region two ---"),
        "contact.py:10: unknown marker '# --- Region two ---'",
    ),
    "indented": (
        GOOD.replace("# --- region: two", "  # --- region: two"),
        "contact.py:10: unknown marker",
    ),
    "bare name": (
        GOOD.replace("# --- region: two ---", "#region two"),
        "contact.py:10: unknown marker",
    ),
    "empty": (GOOD.replace("z = x\n", "\n"), "contact.py:10: region two is empty"),
    "CRLF": (GOOD.replace("z = x\n", "z = x\r\n"), "contact.py:11: a carriage return"),
    "not UTF-8": (
        GOOD.encode().replace("é".encode(), b"\xe9"),
        "contact.py:7: byte 0xe9 is not UTF-8",
    ),
    "code outside": (
        GOOD.replace("\n\n# --- region: two", "\nw = 2\n# --- region: two"),
        "contact.py:9: code outside any region: 'w = 2'",
    ),
    "not Python": (GOOD.replace("z = x", "z = ="), "contact.py:11: not Python"),
}


@pytest.mark.parametrize("text, message", WRONG.values(), ids=WRONG)
def test_a_malformed_file_is_refused_with_line_and_repair(tmp_path, text, message):
    with pytest.raises(ValueError) as caught:
        regions.find(write(tmp_path, text))
    wrong = [line for line in str(caught.value).split("\n") if line.startswith(message)]
    assert wrong, str(caught.value)
    assert "; repair: " in wrong[0]


def test_a_comment_that_merely_talks_of_a_region_is_no_marker(tmp_path):
    regions.find(
        write(
            tmp_path, GOOD.replace("z = x", "z = x\n# the region of stability, and other regions")
        )
    )


def test_every_line_of_the_literate_files_is_in_a_region_and_no_two_share_a_name():
    found = regions.find_all()
    assert {"setup", "scenes", "contacts", "penalty", "lcp", "simulate", "report"} <= set(found)
    every, problems = regions.scan_all()
    assert problems == [] and "contact-docstring" in every and "contact-docstring" not in found
    assert "v_n" in every["contact-docstring"].text


def test_regions_of_several_files_are_found_in_order_and_share_no_name(tmp_path):
    (tmp_path / "curriculum").mkdir()
    write(tmp_path, GOOD)
    other = tmp_path / "curriculum/exact.py"
    other.write_text("# --- region: next-impact ---\nx = 1\n# --- endregion ---\n")
    assert list(regions.find_all(tmp_path)) == ["one", "two", "next-impact"]
    assert regions.find_all(tmp_path)["next-impact"].file == "curriculum/exact.py"
    other.write_text("# --- region: one ---\nx = 1\n# --- endregion ---\n")
    with pytest.raises(ValueError) as caught:
        regions.find_all(tmp_path)
    assert "curriculum/exact.py:1: a second region one; the other is in contact.py" in str(
        caught.value
    )


def test_what_stands_outside_is_hashed_and_blank_lines_do_not_count(tmp_path):
    (outside,) = [
        r
        for r in regions.scan_all(write(tmp_path, GOOD).parent)[0].values()
        if r.name == "contact-docstring"
    ]
    assert outside.text == '"""Docstring,\ntwo lines."""\n# a comment may stand outside\n'
    moved = regions.scan_all(write(tmp_path, GOOD.replace("\n\n# ---", "\n\n\n# ---")).parent)[0]
    assert moved["contact-docstring"].sha256 == outside.sha256


def test_a_file_without_markers_is_not_literate_yet(tmp_path):
    write(tmp_path, GOOD)
    (tmp_path / "curriculum").mkdir()
    (tmp_path / "curriculum/piles.py").write_text("x = 1\n")
    assert list(regions.find_all(tmp_path)) == ["one", "two"]


def test_the_command_lists_prints_and_refuses(capsys):
    assert regions.main([]) == 0
    listed = capsys.readouterr().out
    assert regions.main(["penalty"]) == 0
    assert hashlib.sha256(capsys.readouterr().out.encode()).hexdigest() in listed
    assert regions.main(["nonsense"]) == 2
    assert (
        "given 'nonsense', allowed: nothing or one of contact-docstring, setup"
        in capsys.readouterr().err
    )
