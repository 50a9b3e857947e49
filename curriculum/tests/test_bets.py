"""Nothing tells the answer of a bet before the reader has bet: text, README, objectives, docstring.

A reader meets the chapter from the top, the README, the objectives and contact.py's docstring first. In
what comes before the slot of an exercise no sentence may say what the words of ANSWERS say.
"""

import ast
import re

import pytest

from curriculum import regions
from curriculum.drift.texts import CHAPTER
from curriculum.quoted import load_meta

ROOT = regions.ROOT
SUNK = (
    r"\bsinks?\b|rests? (a little )?inside|m g ?/ ?k|\brings?\b|\bhops?\b|pops? up|"
    r"penalty.{0,60}\b(deeper|deepest)|\bsags?\b"
)
BLOWN = (
    r"\b(penalty|spring|step)\b.{0,80}(explod|blows? up)|critical (time )?step|critical dt|unstable|stays? bounded|"
    r"energy.{0,30}\b(many )?times (the|its)"
)
MASSLESS = (
    r"mass cancels|no mass in|\(1 - d\) \\?,? ?g|equally deep|whatever the mass|per unit of mass"
)
ANSWERS = {"ex1": SUNK, "ex3": BLOWN, "ex4": MASSLESS}
HOOK = r"jitter, sink into the floor or fly to pieces"  # of robots in general, no model is named


def told(text, name):
    """The sentences of a text that tell the answer of an exercise."""
    plain = re.sub(r"<!--.*?-->|\{\{.*?\}\}", " ", re.sub(HOOK, "", text), flags=re.DOTALL)
    sentences = re.split(r"(?<=[.!?:])\s+", " ".join(plain.split()))
    return [each for each in sentences if re.search(ANSWERS[name], each, re.IGNORECASE)]


def before(name):
    """The chapter up to the slot of an exercise, with the regions that it includes there."""
    text = (ROOT / CHAPTER).read_text("utf-8")
    slot = f"<!-- exercise: {name} -->"
    assert text.count(slot) == 1
    found = regions.find_all(ROOT)
    return re.sub(
        r"\[include-by-region: [\w./]+#([\w-]+)\]",
        lambda match: found[match[1]].text,
        text.split(slot)[0],
    )


@pytest.mark.parametrize("name", ANSWERS)
def test_the_chapter_tells_no_answer_before_the_bet(name):
    assert told(before(name), name) == []


@pytest.mark.parametrize("name", ANSWERS)
def test_what_a_reader_meets_first_tells_no_answer(name):
    """README without what is folded or generated, the objectives, the docstring of contact.py."""
    readme = (ROOT / "README.md").read_text("utf-8")
    open_part = re.sub(
        r"<details>.*?</details>|<!-- generated: .*?<!-- end -->", "", readme, flags=re.DOTALL
    )
    docstring = ast.get_docstring(ast.parse((ROOT / "contact.py").read_text("utf-8")))
    for text in (open_part, " ".join(load_meta(ROOT)["objectives"]), docstring):
        assert told(text, name) == []


@pytest.mark.parametrize(
    "name, sentence",
    [
        ("ex1", "The penalty ball sinks a little."),
        ("ex1", "It comes to rest at m g / k."),
        ("ex3", "Past a critical step it explodes."),
        ("ex4", "The mass cancels."),
    ],
)
def test_an_answer_is_noticed(name, sentence):
    """All sentences stand in the chapter behind the slot, too, so the words are those in use."""
    assert told(f"Look at this. {sentence} So it is.", name) == [sentence]


@pytest.mark.parametrize("name", ANSWERS)
def test_the_chapter_does_tell_the_answer_afterwards(name):
    text = (ROOT / CHAPTER).read_text("utf-8").split(f"<!-- exercise: {name} -->")[1]
    assert told(text, name)
