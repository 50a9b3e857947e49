"""README's table of symptoms: commands show and cure what they say; MuJoCo's settings do, too.

That MuJoCo's force flickers follows: soft's does, and soft is MuJoCo (test_models.py).
"""

import re
import shlex

import pytest

import contact
from curriculum.tests.helpers import ROOT

README = (ROOT / "README.md").read_text("utf-8")
TABLE = README.partition("\n## Symptoms\n")[2].partition("\n## ")[0]
ROWS = [row.split(" | ") for row in re.findall(r"^\| (.+) \|$", TABLE, re.M)[2:]]
SHOWN = re.compile(r"`python contact\.py (.+?)`: (?:(\w+) )?(\S+/\S+) (-?[\d.]+)")  # a column
ENDED = re.compile(r"`python contact\.py (.+?)`: ()((?:EXPLODED|rests|through).*)()")  # or how
CELLS = [(row[0], cell) for row in ROWS for cell in row[2:4]]
BALL, BOX = 'type="sphere" size="0.1"', 'type="box" size="0.1 0.1 0.1"'


def test_nine_symptoms_have_a_cause_two_commands_and_a_setting_each():
    assert len(ROWS) == 9 and all(len(row) == 5 for row in ROWS)
    assert all(read(cell) for _, cell in CELLS), "a command, then a column and its value"


def read(cell):
    """(flags, model, column, value) of a cell; or (flags, "", how the run ended, "")."""
    found = SHOWN.fullmatch(cell) or ENDED.fullmatch(cell)
    return found and found.groups()


@pytest.mark.parametrize("symptom, cell", CELLS, ids=lambda each: each[:20])
def test_a_command_prints_what_the_row_says(symptom, cell, tmp_path, capsys):
    flags, model, column, value = read(cell)
    argv = [*shlex.split(flags), "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(argv) == 0
    printed = capsys.readouterr().out
    model = model or contact.parse_flags(argv).contact
    if not value:
        assert re.search(rf"^state: {column}.*: {model}$", printed, re.M)
        return
    titles, *rows = (line.split() for line in printed.splitlines() if line.strip())
    titles = next((line for line in rows if column in line), [])
    row = next((line[1:] for line in rows if line[0] == model), [])
    found = float(row[titles.index(column)]) if column in titles else 0.0  # of zeros is left out
    assert found == pytest.approx(float(value), rel=0.05, abs=1e-9)


def mujoco_model(shape=BALL, dt=0.002, solref="0.02 1", solimp="0.9 0.95 0.001", **more):
    """MuJoCo's model of one ball or box of 1 kg over the floor, and its data. z: its height [m]."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: the extra `bench`")
    z, mass, flag = more.pop("z", 1.0), more.pop("mass", 1.0), more.pop("flag", "")
    options = "".join(f' {name}="{text}"' for name, text in more.items())
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{dt}"{options}>{flag}</option><default><geom condim="1" '
        f'solref="{solref}" solimp="{solimp}"/></default><worldbody>'
        f'<geom type="plane" size="0 0 1"/><body pos="0 0 {z}"><freejoint/>'
        f'<geom {shape} mass="{mass}"/></body></worldbody></mujoco>'
    )
    return mujoco, model, mujoco.MjData(model)


def heights(count, **how):
    """The ball's height [m] after each of so many steps of MuJoCo; its model."""
    mujoco, model, data = mujoco_model(**how)
    found = []
    for _ in range(count):
        mujoco.mj_step(model, data)
        found.append(data.qpos[2])
    return found, model


@pytest.mark.parametrize("e", (0.3, 0.5, 0.7, 0.9, 1.0))
@pytest.mark.parametrize("integrator", ("Euler", "implicitfast"))
@pytest.mark.parametrize("shape", (BALL, BOX))
def test_mujoco_bounces_with_the_restitution_that_the_setting_names(shape, integrator, e):
    for dt in (0.002, 0.0005):
        solimp = re.search(r'solref="0 -\(1\+e\)/dt" solimp="([^"]+)"', README)[1]
        how = dict(solref=f"0 {-(1.0 + e) / dt!r}", solimp=solimp, integrator=integrator, dt=dt)
        mujoco, model, data = mujoco_model(shape, **how)
        before = 0.0
        while data.qvel[2] <= 0.0:
            before = data.qvel[2]
            mujoco.mj_step(model, data)
        assert data.qvel[2] / -before == pytest.approx(e, abs=2e-4)


def test_what_restitution_costs_in_mujoco_is_a_slow_sinking():
    how = dict(solref=f"0 {-1.7 / 0.002}", solimp="0.9999 0.9999 0.001", z=0.1)
    found, _ = heights(30_000, **how)  # a minute
    assert 0.1 - found[-1] == pytest.approx(1e-4, rel=0.2)


@pytest.mark.parametrize("mass", (1.0, 100.0))
def test_mujocos_depth_at_rest_depends_on_its_settings_and_not_on_the_mass(mass):
    for how in ({}, {"solref": "0.01 1"}, {"solimp": "0.99 0.99 0.001"}):
        assert all(f'{name}="{text}"' in README for name, text in how.items())
        found, model = heights(3000, mass=mass, z=0.1, **how)
        depth, solref, solimp = 0.1 - found[-1], model.geom_solref[0], model.geom_solimp[0]
        d = contact.impedance(depth, tuple(solimp))
        K = 1.0 / (solimp[1] * solref[0] * solref[1]) ** 2
        assert (1.0 - d) * 9.81 == pytest.approx(d * d * K * depth, rel=1e-4)
        assert depth == pytest.approx(3.67e-4, rel=0.01) if not how else depth < 1.2e-4


def test_a_damping_ratio_above_1_keeps_mujoco_from_throwing_an_overlapping_ball():
    pairs = re.findall(r'solref="(0\.004 \d)"', README)
    thrown, kept = (max(heights(1000, solref=solref, z=0.07)[0]) for solref in pairs)
    assert (thrown - 0.1) / 0.1 == pytest.approx(7.0, abs=0.2) and kept < 0.1


def test_mujoco_finds_a_fast_contact_by_the_flag_speculative():
    flag = re.search(r"`(<flag speculative=.+?/>)`", README)[1]
    late, found = (min(heights(60, dt=0.064, flag=each)[0]) for each in ("", flag))
    assert late < 0.0 < 0.08 < found, "its centre comes below the floor, or not"
