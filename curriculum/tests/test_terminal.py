"""What curriculum/terminal.py says, piece by piece: the help, the limits, the lines of a report."""

import argparse
import re
from types import SimpleNamespace

import pytest

import contact
from curriculum import terminal
from curriculum.common import memory, results

SHORT = ("--steps", "50", "--no-rerun")
EXAMPLE = contact.build_scene("drop")


def lines_of(capsys):
    return capsys.readouterr().out.splitlines()


# Flags


def test_what_the_help_says_in_parentheses_is_what_a_flag_is_when_it_is_not_given():
    parser = argparse.ArgumentParser()
    for add in (terminal.add_run_flags, terminal.add_model_flags, terminal.add_output_flags):
        add(parser)
    said = {}
    for action in parser._actions:
        found = re.search(r"\(([\w.-]+)\)$", action.help)
        if found and action.default is not None:
            said[action.dest] = found[1], action.default
    words = {"yes": True, "no": False}
    for name, (text, default) in said.items():
        assert words.get(text, text) == default or float(text) == default, name
    assert {"seed", "dt", "steps", "stiffness", "baumgarte", "iters", "skip", "rerun"} <= set(said)


@pytest.mark.parametrize("flag, value", [
    ("--mass", "0.5"), ("--stiffness", "0"), ("--damping", "0"), ("--steps", "0"), ("--seed", "0"),
    ("--restitution", "0"), ("--restitution", "1"), ("--baumgarte", "0"), ("--baumgarte", "1"),
    ("--iters", "1"), ("--dt", "0.5"), ("--bodies", "1"),
])  # fmt: skip
def test_a_value_at_the_end_of_what_is_allowed_is_taken(flag, value):
    args = terminal.parse_flags(["--scene", "stack", flag, value])
    assert getattr(args, flag[2:]) == float(value)


@pytest.mark.parametrize("given", [("0.02", "1"), ("-5000", "-100"), ("0", "-30")])
def test_both_of_mujocos_forms_of_solref_are_taken(given):
    """A time constant and a damping ratio, or minus a stiffness, which may be 0, and a damping."""
    args = terminal.parse_flags(["--solref", *given])
    assert args.solref == [float(text) for text in given]


@pytest.mark.parametrize("power, taken", [("1", True), ("100", True), ("0.99", False),
                                          ("1.05", True), ("105", False)])  # fmt: skip
def test_the_power_of_the_impedance_is_1_to_100(power, taken, capsys):
    flags = ["--solimp", "0.9", "0.95", "0.001", "0.5", power]
    if taken:
        assert terminal.parse_flags(flags).solimp[4] == float(power)
        return
    with pytest.raises(SystemExit):
        terminal.parse_flags(flags)
    assert "allowed: 1 to 100" in capsys.readouterr().err


def test_smoke_is_800_steps_whatever_steps_says():
    assert terminal.parse_flags(["--smoke", "--steps", "7"]).steps == 800


@pytest.mark.parametrize("name", contact.SCENES)
def test_memory_is_asked_for_the_balls_of_the_scene_and_every_state_of_the_run(name, monkeypatch):
    """A run of n steps has n + 1 states."""
    asked = []
    monkeypatch.setattr(memory, "need", lambda parser, size, what: asked.append((size, what)))
    for steps in (0, 9):
        args = terminal.parse_flags(["--scene", name, "--steps", str(steps)])
        scene = terminal.chosen_scene(args, 0)
        size, what = asked[-1]
        assert what == f"--steps {steps} of {len(scene.mass)} balls"
        assert size == (steps + 1) * asked[0][0], "as much for every state"
        held = len(contact.MODELS) * (scene.q0.nbytes + scene.v0.nbytes)
        assert size >= (steps + 1) * held, "what the runs hold"


def test_the_fingerprint_counts_a_flag_at_zero_and_mass_and_seeds_only_where_they_are_given():
    usual = terminal.knobs(terminal.parse_flags([]))
    assert usual["seed"] == 0 and {"bodies", "solref"} <= set(usual)
    assert not {"mass", "seeds", "out", "rerun", "skip", "plot", "usual"} & set(usual)
    given = terminal.knobs(terminal.parse_flags(["--mass", "2", "--seeds", "0:2"]))
    assert given == usual | {"mass": 2.0, "seeds": (0, 2)}


# Which models run


def chosen(count, capsys, *flags):
    """(models, what stdout says, what stderr says) for so many balls."""
    models = terminal.choose_models(terminal.parse_flags(flags), count)
    return models, *capsys.readouterr()


def test_exact_is_left_out_of_more_than_24_balls_unless_it_is_asked_for(monkeypatch, capsys):
    monkeypatch.setattr(contact, "compiled_piles", lambda: SimpleNamespace())
    assert chosen(24, capsys) == (list(contact.MODELS), "", "")
    models, out, _ = chosen(25, capsys)
    assert models == ["penalty", "lcp", "soft"] and "--contact exact" in out
    assert chosen(25, capsys, "--contact", "exact") == (["exact"], "", "")


def test_without_numba_many_balls_are_said_to_take_longer_and_soft_is_left_out(monkeypatch, capsys):
    """Up to FEW balls, and with --no-skip, the compiled twin is not used in any case."""
    monkeypatch.setattr(contact, "compiled_piles", lambda: None)
    assert chosen(contact.FEW, capsys) == (list(contact.MODELS), "", "")
    models, _, err = chosen(24, capsys)
    assert models == list(contact.MODELS) and "pip install numba" in err
    models, _, err = chosen(25, capsys)
    assert models == ["penalty", "lcp"] and "soft is left out" in err
    assert chosen(25, capsys, "--contact", "soft")[0] == ["soft"]
    models, _, err = chosen(25, capsys, "--no-skip")
    assert models == ["penalty", "lcp", "soft"] and err == ""


def test_with_numba_nothing_is_said_to_be_missing(monkeypatch, capsys):
    monkeypatch.setattr(contact, "compiled_piles", lambda: SimpleNamespace())
    assert chosen(20, capsys)[2] == ""


# Lines of a report


def test_a_run_says_its_scene_its_legend_its_files_its_fingerprint_and_what_to_do_next(
    tmp_path, capsys, monkeypatch
):
    """Every line that a reader looks for, in its order. Given no arguments, main takes sys.argv's."""
    flags = [*SHORT, "--dt", "0.01", "--seed", "3", "--out", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["contact.py", *flags])
    assert terminal.main() == 0
    printed = lines_of(capsys)
    args = terminal.parse_flags(flags)
    wanted = (
        "[ch3.5-contact] device: cpu",
        "scene drop, seed 3: 50 steps of 0.01 s",
        "  * and !        nearest to exact",
        "verdict: ",
        "stability: tried at 1, 2, 4, 8, 16, 32 times --dt",
        "critical dt of penalty, one ball: 0.01354 s; without the damper, 2 sqrt(m/k), 0.02 s",
        f"metrics: {tmp_path / 'metrics.json'}",
        f"config_hash: {results.fingerprint(terminal.knobs(args))}",
        "next, see it: ",
    )
    found = [[k for k, line in enumerate(printed) if start in line] for start in wanted]
    assert all(len(at) == 1 for at in found), dict(zip(wanted, found))
    assert found == sorted(found)
    (see,) = [line for line in printed if "see it" in line]
    assert f"contact.py --steps 50 --no-rerun --dt 0.01 --seed 3 --out {tmp_path} --plot" in see


def test_with_one_model_there_are_no_marks_and_no_words_on_them(tmp_path, capsys):
    assert terminal.main([*SHORT, "--contact", "lcp", "--out", str(tmp_path)]) == 0
    assert not [line for line in lines_of(capsys) if "* and !" in line]


def test_the_critical_step_of_penalty_stands_beside_no_other_models_explosion(capsys):
    run = contact.run_model("penalty", EXAMPLE, 0.03, 200)
    row = contact.contact_quality(run, EXAMPLE, 0.03)
    rows = {"penalty": row, "lcp": dict(row)}
    args = SimpleNamespace(scene="drop", seed=0, steps=200, dt=0.03)
    terminal.print_report(args, rows, {}, (0.0135, "one ball"))
    spring, solve = [line for line in lines_of(capsys) if "EXPLODED" in line]
    assert spring.startswith("penalty") and "critical dt of one ball: 0.0135 s" in spring
    assert solve.startswith("lcp") and solve.endswith(f"EXPLODED at step {row['blew_up_step']}")


def depths(worst, rest, exploded=False):
    return {
        "max_penetration_frac": worst, "rest_penetration_frac": rest, "blew_up": exploded,
    }  # fmt: skip


@pytest.mark.parametrize("spring, solve, said", [
    (depths(0.2, 0.05), depths(0.1, 0.01), "yes"),
    (depths(0.2, 0.01), depths(0.1, 0.05), "no"),
    (depths(0.2, 0.05), depths(0.1, 0.05), "no"),
    (depths(0.1, 0.05), depths(0.1, 0.01), "no"),
    (depths(0.0, 0.0), depths(0.0, 0.0), "neither overlaps at any step"),
    (depths(0.2, 0.05, True), depths(0.1, 0.01), "a run exploded"),
    (depths(0.2, 0.05), depths(0.1, 0.01, True), "a run exploded"),
])  # fmt: skip
def test_deeper_is_deeper_at_worst_and_at_rest_and_is_said_of_runs_that_end(
    spring, solve, said, capsys
):
    terminal.print_verdict(spring, solve)
    (line,) = lines_of(capsys)
    assert line.endswith(f": {said}")


def test_a_package_that_is_missing_costs_its_file_and_says_how_to_install_it(capsys):
    def refuse(path):
        raise ImportError("No module named 'rerun'")

    assert terminal.written("recording", "a.rrd", refuse, needs="rerun-sdk") == 0
    (line,) = lines_of(capsys)
    assert line.startswith("no recording: rerun-sdk is not installed") and "install" in line


@pytest.mark.parametrize("recorded, status, flags, said", [
    (True, 0, [], "next, watch it: "), (False, 0, [], "next, see it: "),
    (True, 0, ["--no-rerun"], "next, see it: "), (True, 0, ["--no-rerun", "--plot"], None),
    (True, 2, [], None), (True, 2, ["--no-rerun"], None),
])  # fmt: skip
def test_what_is_there_to_be_seen_is_what_the_next_line_offers(
    recorded, status, flags, said, tmp_path, capsys
):
    recording = tmp_path / "contact.rrd"
    if recorded:
        recording.touch()
    flags = [*flags, "--out", str(tmp_path)]
    terminal.print_next(terminal.parse_flags(flags), flags, status)
    *first, bet = lines_of(capsys)
    assert "make a bet" in bet
    assert [line[: len(said or "")] for line in first] == ([said] if said else [])
    assert not said or "watch" not in said or first[0].endswith(str(recording))


def test_seeds_say_how_many_of_them_exploded_and_what_the_columns_mean(tmp_path, capsys):
    flags = ["--seeds", "4:6", "--dt", "0.03", "--steps", "200", "--out", str(tmp_path)]
    assert terminal.run_seeds(terminal.parse_flags(flags), ["penalty", "lcp"]) == 0
    printed = lines_of(capsys)
    assert "scene drop, seeds 4 to 5: 200 steps of 0.03 s" in printed
    assert any("the deepest overlap of two surfaces" in line for line in printed)
    rows = [line for line in printed if line.startswith(("penalty", "lcp"))]
    ends = {line.split()[0]: line.endswith(" ok") for line in rows}
    assert ends == {"penalty": False, "lcp": True} and len(rows) == 6
    assert sum(line.endswith("2 of 2 EXPLODED") for line in rows) == 3


def test_seeds_end_with_the_fingerprint_of_all_of_them(tmp_path, capsys):
    flags = [*SHORT, "--contact", "lcp", "--seeds", "0:2", "--out", str(tmp_path)]
    assert terminal.main(flags) == 0
    *_, last = lines_of(capsys)
    assert (
        last == f"config_hash: {results.fingerprint(terminal.knobs(terminal.parse_flags(flags)))}"
    )
