"""soft has the numbers of the engine that it rebuilds."""

import numpy as np
import pytest

import contact
from curriculum.stress import mujoco_match as match

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: pip install mujoco")


@pytest.mark.parametrize(
    "case", [pytest.param(case, id=f"{case.what}, dt {case.dt:g}") for case in match.cases()]
)
def test_soft_is_mujoco_in_each_step_and_in_a_whole_run(case):
    row = match.compare(case._replace(steps=min(case.steps, 2000 if case.dt == 0.002 else 600)))
    assert row["step_q"] <= match.STEP_LIMIT[0] and row["step_v"] <= match.STEP_LIMIT[1], row
    assert row["free_q"] <= match.FREE_LIMIT, row


def test_balls_in_touch_agree_in_each_step_though_not_in_a_whole_run():
    """Every force is right; which contact begins first is decided by the last bit of a gap."""
    case = match.Case("in touch", match.lifted("stack", 3), 0.008, 400)
    row = match.compare(case)
    assert row["step_q"] <= match.STEP_LIMIT[0] and row["step_v"] <= match.STEP_LIMIT[1], row
    assert row["free_q"] > match.FREE_LIMIT, "the limit of the match is no limit any more: say so"


def test_the_comparison_would_see_another_spring():
    """A time constant longer by a millionth: the run is apart by more than the limit."""
    case = match.Case("drop", match.lifted("drop"), 0.002, 600)
    q, v = match.engine_run(case)
    run = contact.run_model("soft", case.scene, 0.002, 600, solref=(0.02 * (1.0 + 1e-6), 1.0))
    assert np.abs(run.q - q).max() > 100.0 * match.FREE_LIMIT


def test_the_page_has_every_row_and_names_the_engine():
    row = match.compare(match.Case("a drop", match.lifted("drop"), 0.002, 300))
    about = {"command": match.COMMAND, **match.measured.provenance(packages=("mujoco",))}
    page = match.page({"measured": about, "options": match.OPTIONS, "match": [row], "touch": [row]})
    assert page.count("| a drop |") == 2 and f"mujoco {mujoco.__version__}" in page
    assert 'tolerance="0"' in page and "missed" not in page
    assert "missed" in match.page(
        {"measured": about, "options": "", "touch": [], "match": [row | {"free_q": 1e-10}]}
    )


def test_the_page_that_is_kept_is_that_of_the_kept_numbers():
    kept = match.measured.load(match.FOLDER)["mujoco_match"]
    assert (match.FOLDER / "mujoco_match.md").read_text("utf-8") == match.page(kept)
