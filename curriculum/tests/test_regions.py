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


def test_every_line_of_contact_py_is_in_a_region_and_the_design_names_them():
    found = regions.find(ROOT / "contact.py")
    assert list(found) == [
        "setup",
        "scenes",
        "contacts",
        "penalty",
        "lcp",
        "exact",
        "simulate",
        "report",
    ]


def test_the_command_lists_prints_and_refuses(capsys):
    assert regions.main([]) == 0
    listed = capsys.readouterr().out
    assert regions.main(["penalty"]) == 0
    assert hashlib.sha256(capsys.readouterr().out.encode()).hexdigest() in listed
    assert regions.main(["nonsense"]) == 2
    assert "given 'nonsense', allowed: nothing or one of setup, scenes" in capsys.readouterr().err
