"""The command line: bad input, equal bytes, strict JSON, rerun wanted, unwanted and missing."""

import ast
import io
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import contact
import curriculum
from curriculum import terminal
from curriculum.common import picture, results, shell, wallclock, workers
from curriculum.tests import test_bets

ROOT = Path(__file__).resolve().parents[2]
SHORT = ("--steps", "50", "--no-rerun")


def no_constant(text):
    raise ValueError(f"{text} is not JSON")


def strict_json(path):
    text = Path(path).read_text()
    assert text.endswith("}\n")
    return json.loads(text, parse_constant=no_constant)


# Bad input

BAD = {
    "--seed": ("-1", "1.5", "x"),
    "--seeds": ("3", "4:4", "5:2", "-1:3", "0:1.5", "a:b", "0:1000000"),
    "--solref": ("soft",),
    "--solimp": ("-0.1",),
    "--scene": ("pool", ""),
    "--contact": ("mujoco",),
    "--stiffness": ("-1", "nan", "inf", "stiff"),
    "--damping": ("-0.1", "nan", "inf"),
    "--restitution": ("-0.01", "1.01", "nan"),
    "--baumgarte": ("-0.01", "1.01", "nan"),
    "--iters": ("0", "-3", "1.5"),
    "--dt": ("0", "-0.002", "nan", "inf", "-inf", "fast"),
    "--steps": ("-1", "2.5", "nan", "1000000000000"),
    "--bodies": ("0", "-2", "many"),
    "--mass": ("0", "-1", "nan", "heavy"),
    "--device": ("cuda",),
    "--step": ("3",),
}


@pytest.mark.parametrize("flag, value", [(flag, value) for flag in BAD for value in BAD[flag]])
def test_bad_input_is_one_line_that_names_flag_and_value_and_nothing_is_written(
    flag, value, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    scene = ["--scene", "stack"] if flag == "--bodies" else []
    with pytest.raises(SystemExit) as caught:
        contact.main([*scene, flag, *[value] * {"--solref": 2, "--solimp": 5}.get(flag, 1)])
    out, err = capsys.readouterr()
    print(err)
    assert caught.value.code == 2 and out == ""
    assert err.count("\n") == 1 and err.endswith("\n") and len(err) < 300
    assert flag in err and value in err and ("allowed" in err or "choose from" in err)
    assert list(tmp_path.iterdir()) == []


def test_every_flag_is_among_those_tried_with_bad_input_or_takes_no_value(capsys):
    with pytest.raises(SystemExit):
        contact.main(["--help"])
    flags = set(re.findall(r"(?<=[\s\[])--[a-z-]+", capsys.readouterr().out))
    assert flags - set(BAD) == {
        "--help", "--smoke", "--out", "--rerun", "--no-rerun", "--skip", "--no-skip", "--plot",
    }  # fmt: skip


@pytest.mark.parametrize("scene", ["drop", "bounce"])
def test_bodies_are_refused_where_the_scene_has_one_ball(scene, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as caught:
        contact.main(["--scene", scene, "--bodies", "4"])
    err = capsys.readouterr().err
    assert caught.value.code == 2 and err.count("\n") == 1
    assert "4" in err and "stack and pile" in err and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given, allowed", [
    (["--solref", "0.02", "0"], "> 0"), (["--solref", "-5000", "3"], "> 0"),
    (["--solimp", "0.9", "0.95", "0.001", "0.5", "0.5"], "1 to 100"),
    (["--solimp", "0.9", "0.95", "0.001", "0.5", "2000"], "1 to 100"),
])  # fmt: skip
def test_settings_of_soft_that_divide_by_zero_are_refused(given, allowed, tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        contact.main([*given, "--out", str(tmp_path / "new")])
    err = capsys.readouterr().err
    assert caught.value.code == 2 and err.count("\n") == 1
    assert given[0] in err and allowed in err and list(tmp_path.iterdir()) == []


def test_a_pile_that_does_not_fit_in_memory_is_refused_before_it_is_built(tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        contact.main(["--scene", "pile", "--bodies", str(10**10), "--out", str(tmp_path / "new")])
    err = capsys.readouterr().err
    assert caught.value.code == 2 and err.count("\n") == 1 and "GB" in err
    assert list(tmp_path.iterdir()) == []


def test_out_at_a_file_or_below_one_is_refused_and_the_file_is_left_alone(tmp_path, capsys):
    (tmp_path / "file").write_text("mine")
    for out in (tmp_path / "file", tmp_path / "file" / "deeper"):
        with pytest.raises(SystemExit) as caught:
            contact.main([*SHORT, "--out", str(out)])
        err = capsys.readouterr().err
        assert caught.value.code == 2 and err.count("\n") == 1 and "not a folder" in err
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.skipif(os.name != "posix", reason="permissions are tested where there are users")
def test_an_unwritable_folder_is_refused_in_one_line():
    code = (
        "import os, sys, contact\n"
        "from curriculum import terminal\n"
        "terminal.parse_flags([])\n"  # loads what other users may not be allowed to read
        "from curriculum.common import device, progress, results\n"
        "if os.getuid() == 0: os.setuid(65534)\n"
        "contact.main(sys.argv[1:])"
    )
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o555)
        run = subprocess.run(
            [sys.executable, "-B", "-c", code, *SHORT, "--out", folder + "/new"],
            cwd=ROOT, capture_output=True, text=True,
        )  # fmt: skip
        assert run.returncode == 2 and run.stdout == "", run.stderr
        assert run.stderr.count("\n") == 1 and f"no permission to write in {folder}" in run.stderr
        assert os.listdir(folder) == []


# The same bytes


def test_smoke_writes_the_same_bytes_whatever_hash_seed_folder_and_threads(run_script, tmp_path):
    """A relative --out in another folder, so that stdout, which names it, can be compared too.

    PYTHONOPTIMIZE 2 is python -OO: no docstrings, no assertions.
    """
    seen = []
    for name, seed, threads, optimize in (
        ("a", "0", "1", ""),
        ("b", "4242", "2", ""),
        ("b", "random", "7", "2"),
    ):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        run = run_script(
            *("--smoke", "--no-rerun", "--out", "out"),
            cwd=folder,
            PYTHONHASHSEED=seed,
            PYTHONOPTIMIZE=optimize,
            OMP_NUM_THREADS=threads,
            OPENBLAS_NUM_THREADS=threads,
            MKL_NUM_THREADS=threads,
        )
        assert run.returncode == 0 and run.stderr == b"", run.stderr
        seen.append((run.stdout, (folder / "out" / "metrics.json").read_bytes()))
    assert seen[0] == seen[1] == seen[2]
    assert str(tmp_path).encode() not in b"".join(seen[0])


@pytest.mark.parametrize("scene", ["bounce", "stack", "pile"])
def test_a_second_run_in_one_process_repeats_the_first(scene, tmp_path, capsys):
    seen = []
    bodies = ["--bodies", "15"] if scene == "pile" else []
    for _ in range(2):
        flags = ["--scene", scene, *bodies, *SHORT, "--out", str(tmp_path)]
        assert contact.main(flags) == 0
        seen.append((capsys.readouterr().out, (tmp_path / "metrics.json").read_bytes()))
    assert seen[0] == seen[1]


@pytest.mark.parametrize("scene, model", [("bounce", "all"), ("stack", "lcp"), ("pile", "penalty")])
def test_no_skip_prints_and_writes_the_same_bytes(scene, model, tmp_path, capsys):
    seen = []
    bodies = ["--bodies", "14"] if scene == "pile" else []
    for skip in ("--skip", "--no-skip"):
        flags = ["--scene", scene, "--contact", model, *bodies, "--steps", "300", "--no-rerun"]
        assert contact.main([*flags, skip, "--out", str(tmp_path)]) == 0
        seen.append((capsys.readouterr().out, (tmp_path / "metrics.json").read_bytes()))
    assert seen[0] == seen[1]


# What is printed and written


def test_metrics_keep_the_published_keys_sorted_and_hold_no_path_and_no_time(tmp_path, capsys):
    assert contact.main([*SHORT, "--out", str(tmp_path)]) == 0
    metrics = strict_json(tmp_path / "metrics.json")
    text = (tmp_path / "metrics.json").read_text()
    assert text == json.dumps(metrics, indent=2, sort_keys=True) + "\n"
    assert str(tmp_path) not in text
    top = {"scene", "contact", "dt", "steps", "seed", "stiffness", "restitution"}
    assert set(metrics) == top | {"quality", "stability"}
    kept = {
        "max_penetration_frac",
        "rest_penetration_frac",
        "energy_excess",
        "rest_jitter",
        "blew_up",
    }
    new = {"contact_energy", "height_error_frac", "blew_up_step", "rest_gap_frac"}
    new |= {"rebound_frac", "flight_error_frac", "contact_error_frac"}
    for model in contact.MODELS:
        assert set(metrics["quality"][model]) == kept | new
    assert {"penalty", "lcp", "dt_crit_penalty", "dt_crit_damped"} <= set(metrics["stability"])
    assert not re.search(r"\.\d{13,}", text), "more than 12 decimals"
    assert os.listdir(tmp_path) == ["metrics.json"]


@pytest.mark.parametrize("flags", [
    ["--contact", "penalty", "--dt", "10", "--steps", "200"],
    ["--contact", "penalty", "--stiffness", "1e300"],
    ["--scene", "stack", "--contact", "penalty", "--stiffness", "1e308", "--damping", "1e308"],
    ["--contact", "all", "--dt", "1e160", "--steps", "40"],
])  # fmt: skip
def test_an_overflow_is_exploded_at_a_step_and_null_in_strict_json(flags, run_script, tmp_path):
    run = run_script(*flags, "--no-rerun", "--out", tmp_path)
    assert run.returncode == 0 and run.stderr == b"", run.stderr.decode()
    row = strict_json(tmp_path / "metrics.json")["quality"]["penalty"]
    assert row["blew_up"] is True
    printed = re.search(r"^penalty .* EXPLODED at step (\d+),", run.stdout.decode(), re.M)
    assert int(printed[1]) == row["blew_up_step"]
    assert b"nan" not in run.stdout and b"inf" not in run.stdout
    if "10" not in flags:
        assert row["energy_excess"] is None


def test_the_step_of_the_explosion_is_the_first_with_ten_times_the_energy(tmp_path, capsys):
    assert contact.main(["--dt", "0.03", "--no-rerun", "--out", str(tmp_path)]) == 0
    row = strict_json(tmp_path / "metrics.json")["quality"]["penalty"]
    scene = contact.build_scene("drop")
    run = contact.run_model("penalty", scene, 0.03, 2000)
    total = 0.5 * (run.v[:, 1, 0] ** 2 + run.v[:, 0, 0] ** 2) + 9.81 * run.q[:, 1, 0]
    step = row["blew_up_step"]
    assert (total[:step] < 11 * total[0]).all() and total[step] >= 11 * total[0]


def test_asking_for_one_model_runs_no_other(tmp_path, monkeypatch, capsys):
    ran = []
    run_model = contact.run_model

    def counted(model, *rest):
        ran.append(model)
        return run_model(model, *rest)

    monkeypatch.setattr(contact, "run_model", counted)
    assert contact.main([*SHORT, "--contact", "lcp", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert ran == ["lcp"]
    assert "\npenalty" not in out and "\nexact" not in out and "stability:" not in out
    metrics = strict_json(tmp_path / "metrics.json")
    assert set(metrics["quality"]) == {"lcp"} and not metrics["stability"]
    ran.clear()
    assert contact.main([*SHORT, "--out", str(tmp_path)]) == 0
    counts = {model: ran.count(model) for model in contact.MODELS}
    most = {"penalty": len(contact.DT_GRID), "lcp": len(contact.DT_GRID), "soft": 6, "exact": 1}
    assert all(1 <= counts[model] <= most[model] for model in counts), "dt x 1 is the main run"


@pytest.mark.parametrize("scene", contact.SCENES)
@pytest.mark.parametrize("steps", [0, 1, 2])
def test_no_step_one_step_and_two_steps_work(scene, steps, tmp_path, capsys):
    bodies = ["--bodies", "14"] if scene == "pile" else []
    flags = ["--scene", scene, *bodies, "--steps", str(steps), "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    assert strict_json(tmp_path / "metrics.json")["steps"] == steps


def test_a_knob_that_matters_changes_the_config_hash_and_out_does_not(tmp_path, capsys):
    def fingerprint(*flags):
        assert contact.main([*SHORT, *flags]) == 0
        return re.search(r"^config_hash: \w+$", capsys.readouterr().out, re.MULTILINE)[0]

    same = {fingerprint("--out", str(tmp_path / name)) for name in "ab"}
    others = [("--seed", "1"), ("--dt", "0.001"), ("--stiffness", "9e3"), ("--iters", "19")]
    hashes = {fingerprint(*flags, "--out", str(tmp_path / "a")) for flags in others}
    assert len(same) == 1 and len(hashes | same) == 5


# rerun, and imports

WATCH = (
    "import sys\n"
    "class Watch:\n"
    "    def find_spec(self, name, path=None, target=None):\n"
    "        if name.split('.')[0] in ('rerun', 'rerun_bindings'):\n"
    "            {action}\n"
    "sys.meta_path.insert(0, Watch())\n"
)
REFUSE = WATCH.format(action="raise ImportError(f'No module named {name!r}')")
TELL = WATCH.format(action="print('RERUN IMPORTED')")


def python(code, *argv, cwd=ROOT):
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, argv)],
        cwd=cwd, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip


def test_no_rerun_never_imports_rerun(tmp_path):
    code = TELL + "import contact; sys.exit(contact.main(sys.argv[1:]))"
    run = python(code, *SHORT, "--out", tmp_path)
    assert run.returncode == 0 and "RERUN" not in run.stdout, run.stderr
    assert os.listdir(tmp_path) == ["metrics.json"]


def test_importing_contact_runs_nothing_parses_nothing_and_imports_no_rerun(tmp_path):
    code = TELL + (
        "import contact, numpy\n"
        "names = {name.split('.')[0] for name in sys.modules}\n"
        "print(sorted(names & {'rerun', 'pyarrow', 'matplotlib', 'yaml', 'torch', 'mujoco'}))"
    )
    run = python(code, "--steps", "bad", "--no-such-flag", cwd=tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (0, "[]\n", "")
    assert os.listdir(tmp_path) == []


def test_importing_contact_loads_neither_the_page_nor_the_benchmark():
    code = "import contact, sys; print(*[m for m in sys.modules if m.startswith('curriculum.')])"
    loaded = python(code).stdout.split()
    assert loaded == [], "contact.py alone needs numpy alone"


def test_run_as_a_script_contact_is_the_module_that_the_command_line_works_with(monkeypatch):
    """A second copy would be made of it, and what one of them is given the other would not have."""
    seen = []
    stand_in = SimpleNamespace(main=lambda argv: seen.append(sys.modules["contact"]) or 7)
    monkeypatch.setattr(curriculum, "terminal", stand_in)
    monkeypatch.delitem(sys.modules, "contact")
    monkeypatch.setitem(sys.modules, "__main__", contact)
    monkeypatch.setattr(contact, "__name__", "__main__")
    assert contact.main([]) == 7 and seen == [contact]


def test_alone_contact_says_in_one_line_what_its_command_line_needs(monkeypatch, capsys):
    monkeypatch.delattr(curriculum, "terminal")
    monkeypatch.setitem(sys.modules, "curriculum.terminal", None)  # as if it were not there
    assert contact.main([]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and "needs the course's folder beside it" in err


def test_without_rerun_one_line_says_how_to_install_it_and_metrics_are_written(tmp_path):
    code = REFUSE + "import contact; sys.exit(contact.main(sys.argv[1:]))"
    run = python(code, "--steps", "50", "--out", tmp_path)
    assert run.returncode == 0 and run.stderr == "", run.stderr
    lines = [line for line in run.stdout.splitlines() if "recording" in line]
    assert len(lines) == 1 and "pip install rerun-sdk" in lines[0]
    assert strict_json(tmp_path / "metrics.json")["steps"] == 50
    assert os.listdir(tmp_path) == ["metrics.json"]


def test_the_names_that_the_next_chapter_imports_are_there():
    names = (
        "build_scene detect_contacts penalty_force semi_implicit_step solve_contacts lcp_step "
        "energy max_penetration simulate contact_quality log_rerun main"
    )
    for name in names.split():
        assert callable(getattr(contact, name)) and getattr(contact, name).__doc__, name


# Killed, interrupted


def test_killed_while_writing_metrics_the_old_ones_are_intact(tmp_path):
    """The process is stopped in os.fsync: the new file is written but has no name yet."""
    assert contact.main([*SHORT, "--out", str(tmp_path)]) == 0
    old = (tmp_path / "metrics.json").read_bytes()
    code = (
        "import os, sys, time, contact\n"
        "os.fsync = lambda file: (print('writing', file=sys.stderr, flush=True), time.sleep(60))\n"
        "contact.main(sys.argv[1:])"
    )
    command = [sys.executable, "-c", code, *SHORT, "--seed", "1", "--out", str(tmp_path)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    with process.stderr:
        assert process.stderr.readline() == b"writing\n"
        process.send_signal(signal.SIGKILL if os.name == "posix" else signal.SIGTERM)
        process.wait()
    assert (tmp_path / "metrics.json").read_bytes() == old
    assert contact.main([*SHORT, "--seed", "1", "--out", str(tmp_path)]) == 0
    assert strict_json(tmp_path / "metrics.json")["seed"] == 1


def test_ctrl_c_in_a_long_run_leaves_no_file(tmp_path, monkeypatch, capsys):
    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr(contact, "measure_stability", interrupted)
    assert contact.main([*SHORT, "--out", str(tmp_path / "new")]) == 130
    assert capsys.readouterr().err == "stopped\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="a terminal's Ctrl-C is tested where groups are")
@pytest.mark.parametrize("flags", [
    ["--scene", "pile", "--contact", "soft", "--no-skip", "--steps", "100000"],
    ["--scene", "stack", "--seeds", "0:2000"],
])  # fmt: skip
def test_ctrl_c_ends_run_and_worker_processes_with_one_line_and_leaves_no_file(flags, tmp_path):
    """Ctrl-C reaches every process of the group, each of which had a traceback of its own."""
    process = subprocess.Popen(
        [sys.executable, "-u", str(ROOT / "contact.py"), *flags, "--out", str(tmp_path / "new")],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    assert b"device" in process.stdout.readline()
    time.sleep(0.5)  # the runs have begun
    os.killpg(process.pid, signal.SIGINT)
    err = process.communicate(timeout=30)[1].decode()
    lines = [line for line in err.splitlines() if "fast" not in line]
    assert (process.returncode, lines) == (130, ["stopped"])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="a pipe that nobody reads is posix's")
@pytest.mark.parametrize("command", [
    ["contact.py", *SHORT], ["contact.py", "--help"], ["exercises/ex1_predict_contact.py"],
    ["-m", "curriculum.measured"], ["-m", "curriculum.regions"],
    ["-m", "curriculum.check_prose_code_drift", "--accept", "lcp"],
])  # fmt: skip
@pytest.mark.parametrize("buffered", ["", "1"])
def test_a_pipe_that_nobody_reads_any_more_ends_a_command_without_a_word(
    command, buffered, tmp_path
):
    out = ["--out", str(tmp_path)] if SHORT[0] in command else []
    reader, writer = os.pipe()
    os.close(reader)
    run = subprocess.run(
        [sys.executable, *command, *out], cwd=ROOT, stdout=writer, stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONUNBUFFERED": buffered},
    )  # fmt: skip
    os.close(writer)
    allowed = (0, 141) if "--help" in command else (141,)  # argparse keeps such an error to itself
    assert run.returncode in allowed and run.stderr == b""
    assert not [name for name in os.listdir(tmp_path) if name.endswith(".tmp")]


def decorated(path):
    """The functions of a file that are decorated with stoppable."""
    body = ast.parse(path.read_text("utf-8")).body
    functions = [node for node in body if isinstance(node, ast.FunctionDef)]
    return {
        function.name
        for function in functions
        if any("stoppable" in ast.unparse(made) for made in function.decorator_list)
    }


def test_every_command_of_the_project_can_be_stopped_without_a_traceback():
    """One decorator for all. contact.py and the exercises call a main that has it."""
    passed_on = {"contact.py": "terminal.main(argv)"}
    for path in (ROOT / "exercises").glob("ex?_*.py"):
        passed_on[f"exercises/{path.name}"] = ".play("
    files = [ROOT / "contact.py", ROOT / "checks.py", *ROOT.glob("exercises/*.py")]
    files += [path for path in ROOT.glob("curriculum/**/*.py") if "tests" not in path.parts]
    commands = [
        path for path in files if '\nif __name__ == "__main__":\n' in path.read_text("utf-8")
    ]
    assert len(commands) > 15
    lacking = [path for path in commands if "main" not in decorated(path)]
    assert {path.relative_to(ROOT).as_posix() for path in lacking} == set(passed_on)
    assert "main" in decorated(ROOT / "curriculum" / "terminal.py")
    for name in ("predict", "trials"):
        assert "play" in decorated(ROOT / "exercises" / f"{name}.py")
    for name, call in passed_on.items():
        assert call in (ROOT / name).read_text("utf-8")


# The first command


def first_commands():
    """The commands of README's first block of code, from contact.py on."""
    text = (ROOT / "README.md").read_text("utf-8")
    block = re.search(r"```sh\n(.*?)```", text.split("## Set up and run")[1], re.DOTALL)[1]
    assert len(block.splitlines()) == 2, "two commands"
    (line,) = [line for line in block.splitlines() if "contact.py" in line]
    return line.split("contact.py")[1].split()


def test_the_first_command_of_the_readme_and_the_help_tell_no_answer_of_a_bet(run_script, tmp_path):
    run = run_script(*first_commands(), "--no-rerun", "--out", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    printed = run.stdout.decode()
    shown = printed + run_script("--help").stdout.decode()
    for name in test_bets.ANSWERS:
        assert test_bets.told(shown, name) == []
    rows = [line.split()[0] for line in printed.splitlines() if re.match(r"\w+ +[\d-]", line)]
    assert rows == ["exact"], "no row of a model that is bet on"
    assert "exercises/ex1_predict_contact.py" in printed.splitlines()[-1]


# The report


def test_no_headings_collide_and_every_figure_stands_under_its_own(tmp_path, capsys):
    assert contact.main([*SHORT, "--dt", "0.01", "--out", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    (place,) = [k for k, line in enumerate(lines) if line.startswith("contact ")]
    above, below = lines[place - 1], lines[place]
    ends = [match.end() for match in re.finditer(r"\S+", below)][1:-1]
    assert len(ends) == len(terminal.COLUMNS)
    for title, end in zip(terminal.COLUMNS, ends):
        *upper, lower = title.split()
        assert below[:end].endswith(" " + lower)
        assert not upper or above[:end].endswith(" " + " ".join(upper))
    metrics = strict_json(tmp_path / "metrics.json")["quality"]
    for line, model in zip(lines[place + 1 :], contact.MODELS):
        for key, end in zip(terminal.COLUMNS.values(), ends):
            cell = line[:end].split()[-1].replace(",", "")
            value = metrics[model][key]
            assert abs(float(cell) - value) <= 5e-3 * abs(value), (model, key)


def test_every_column_has_a_line_in_the_legend(tmp_path, capsys):
    assert contact.main([*SHORT, "--contact", "lcp", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert all(f"\n  {title} " in out for title in terminal.COLUMNS)
    assert set(terminal.LEGEND) == set(terminal.COLUMNS)


@pytest.mark.parametrize("value, text", [
    (None, "-"), (0.0, "0"), (0.251329183485, "0.251"), (-0.00981, "-0.00981"), (1409.4, "1,409"),
    (4.1611e-06, "4.2e-06"), (0.0002, "0.0002"), (1e202, "1.0e+202"), (float("nan"), "-"),
])  # fmt: skip
def test_a_figure_is_written_as_a_person_reads_it(value, text):
    assert results.figure(value) == text


def test_the_nearest_to_exact_and_the_farthest_are_marked_and_exploded_rows_are_never_best():
    row = {"blew_up": False}
    rows = {
        "penalty": row | {"a": 1.5, "b": 0.0, "c": 1.0},
        "lcp": row | {"a": 0.9, "b": 0.0, "c": 2.0},
        "soft": row | {"a": 0.0, "b": 0.0, "c": None},
        "exact": row | {"a": 1.0, "b": 0.0, "c": 0.0},
    }
    marks = results.best_and_worst(rows, "abc", "exact", unknown="a")
    assert marks == {
        ("lcp", "a"): "*",
        ("soft", "a"): "!",
        ("penalty", "c"): "*",
        ("soft", "c"): "!",
    }
    del rows["exact"]
    rows["lcp"]["blew_up"] = True
    marks = results.best_and_worst(rows, "abc", "exact", unknown="a")
    assert {key: mark for key, mark in marks.items() if key[0] == "lcp"} == {
        ("lcp", "b"): "!", ("lcp", "c"): "!"}  # fmt: skip


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_colour_is_for_a_terminal_that_wants_it_and_adds_nothing_else(monkeypatch, tmp_path):
    printed = {}
    monkeypatch.delenv("NO_COLOR", raising=False)
    for name, stream in (("pipe", io.StringIO()), ("terminal", Terminal()), ("plain", Terminal())):
        if name == "plain":
            monkeypatch.setenv("NO_COLOR", "1")
        monkeypatch.setattr(sys, "stdout", stream)
        assert contact.main([*SHORT, "--dt", "0.01", "--out", str(tmp_path)]) == 0
        printed[name] = stream.getvalue()
    assert "\x1b" not in printed["pipe"] and printed["plain"] == printed["pipe"]
    assert "\x1b[32m" in printed["terminal"] and "\x1b[31m" in printed["terminal"]
    assert re.sub(r"\x1b\[\d+m", "", printed["terminal"]) == printed["pipe"]


def test_the_critical_step_stands_beside_an_explosion_also_when_penalty_runs_alone(
    tmp_path, capsys
):
    flags = ["--contact", "penalty", "--dt", "0.03", "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    out = capsys.readouterr().out
    limit = contact.critical_dt(1.0, 1e4, 80.0)
    (line,) = [line for line in out.splitlines() if "EXPLODED" in line]
    assert line.startswith("penalty") and f"critical dt of one ball: {limit:.4g} s" in line


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_the_critical_step_of_a_stack_is_where_its_rest_begins_to_shake(count, tmp_path):
    """A stack that exploded below the critical dt of one ball, 0.0135 s, left a learner puzzled."""
    args = terminal.parse_flags(
        ["--scene", "stack", "--bodies", str(count), "--out", str(tmp_path)]
    )
    scene = terminal.chosen_scene(args, 0)
    limit, of = terminal.critical_step(args, scene)
    assert of == ("one ball" if count == 1 else f"a stack of {count}")
    below, above = (
        contact.contact_quality(
            contact.run_model("penalty", scene, share * limit, 6000), scene, share * limit
        )["rest_jitter"]
        for share in (0.998, 1.002)
    )
    assert below < 1e-9 < 1e-4 < above


def test_a_stack_that_explodes_says_its_own_critical_step(tmp_path, capsys):
    flags = ["--scene", "stack", "--dt", "0.01", "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    lines = capsys.readouterr().out.splitlines()
    (line,) = [line for line in lines if "EXPLODED" in line]
    assert line.endswith("critical dt of a stack of 3: 0.005682 s")
    assert "critical dt of penalty, a stack of 3: 0.005682 s" in lines


def test_a_time_is_expected_only_of_the_run_that_was_measured(tmp_path, capsys, monkeypatch):
    """A pile takes longer than the drop whose time the ledger knows."""
    monkeypatch.setattr(wallclock, "lookup", lambda *_: 0.0087)
    said = {}
    for flags in (
        [],
        ["--scene", "drop"],
        ["--scene", "pile", "--bodies", "14"],
        ["--dt", "0.001"],
    ):
        known = flags if flags and flags[0] != "--dt" else flags
        args = terminal.parse_flags([*known, "--out", str(tmp_path)])
        said[" ".join(flags)] = args.usual
    assert said == {"": True, "--scene drop": True, "--scene pile --bodies 14": False,
                    "--dt 0.001": False}  # fmt: skip
    assert "expected wall-clock on x: 0.0087 min" in wallclock.render_line("ch", "x")
    other = wallclock.render_line("ch", "x", usual=False)
    assert "expected" not in other and "not measured for these flags" in other


@pytest.mark.parametrize("dt", ["1e-300", "1e-14", "1e100", "1e300"])
def test_absurd_steps_give_no_warning_and_no_false_claim(dt, tmp_path, capsys):
    """Steps too short to reach the table try nothing; metrics.json keeps their digits."""
    assert contact.main([*SHORT, "--dt", dt, "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    metrics = strict_json(tmp_path / "metrics.json")
    assert metrics["dt"] == float(dt)
    rows = metrics["quality"]
    if float(dt) < 1.0:
        assert metrics["stability"]["penalty"] is metrics["stability"]["lcp"] is None
        assert out.count("comes to no contact") == 2 and "explode" not in out
        assert "neither overlaps" in out
    else:
        assert rows["penalty"]["blew_up"] and "at every dt tried" in out
        for row in rows.values():
            assert row["blew_up"] or None not in [
                row[key] for key in ("rest_jitter", "rest_gap_frac")
            ]


def test_a_run_beyond_what_a_recording_can_hold_is_recorded_without_a_warning(run_script, tmp_path):
    """rerun keeps positions in 32 bits."""
    pytest.importorskip("rerun", reason="rerun is not installed")
    run = run_script("--dt", "1e100", "--steps", "50", "--out", tmp_path)
    assert (run.returncode, run.stderr) == (0, b"") and (tmp_path / "contact.rrd").exists()


def test_what_to_do_next_stands_in_lines_that_hold_one_command_each(tmp_path, capsys):
    assert contact.main([*SHORT, "--contact", "exact", "--out", str(tmp_path)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("next")]
    see, bet = lines
    assert see.startswith("next, see it: ") and see.endswith("--plot") and "contact.py" in see
    assert bet.startswith("next, make a bet: ") and bet.endswith("ex1_predict_contact.py")


def test_a_pile_runs_no_stability_grid(tmp_path, capsys):
    flags = ["--scene", "pile", "--bodies", "8", *SHORT, "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    assert "stability:" not in capsys.readouterr().out
    assert strict_json(tmp_path / "metrics.json")["stability"] == {}


def test_a_folder_that_turns_out_unwritable_costs_the_files_and_not_the_report(capsys, monkeypatch):
    """A folder under /proc looks writable and is not."""

    def refuse(path):
        raise OSError(28, "No space left on device", path)

    monkeypatch.setattr(results, "write_whole", lambda path, data: refuse(path))
    assert contact.main([*SHORT, "--plot", "--out", "/tmp/full"]) == 2
    out, err = capsys.readouterr()
    assert "verdict:" in out and "metrics:" not in out and "picture" not in out
    assert "watch it" not in out and "see it" not in out, "no advice that would fail again"
    assert err.count("\n") == 1 and "/tmp/full/metrics.json: No space left on device" in err


# --seeds and --plot


def test_seeds_print_median_and_range_and_leave_the_single_seed_alone(tmp_path, capsys):
    flags = [*SHORT, "--dt", "0.01", "--contact", "lcp", "--out", str(tmp_path)]
    singles = []
    for seed in range(3):
        assert contact.main([*flags, "--seed", str(seed)]) == 0
        singles.append(strict_json(tmp_path / "metrics.json")["quality"]["lcp"])
    before = (tmp_path / "metrics.json").read_bytes()
    capsys.readouterr()
    assert contact.main([*flags, "--seeds", "0:3"]) == 0
    out = capsys.readouterr().out
    assert (tmp_path / "metrics.json").read_bytes() == before
    rows = strict_json(tmp_path / "seeds.json")["rows"]
    for key in ("max_penetration_frac", "rebound_frac", "contact_energy"):
        low, middle, high = sorted(single[key] for single in singles)
        assert rows["lcp lowest"][key] == low
        assert rows["lcp median"][key] == middle
        assert rows["lcp highest"][key] == high
    assert [line.split()[:2] for line in out.splitlines() if line.startswith("lcp ")] == [
        ["lcp", "median"], ["lcp", "lowest"], ["lcp", "highest"]]  # fmt: skip


def test_seeds_do_not_depend_on_the_number_of_cores(tmp_path, capsys, monkeypatch):
    seen = []
    for cores in (1, 2):
        monkeypatch.setattr(workers.os, "cpu_count", lambda: cores)  # noqa: B023
        flags = [*SHORT, "--seeds", "0:3", "--contact", "penalty", "--out", str(tmp_path)]
        assert contact.main(flags) == 0
        seen.append((capsys.readouterr().out, (tmp_path / "seeds.json").read_bytes()))
    assert seen[0] == seen[1]


def test_a_picture_is_the_same_bytes_twice_and_shows_every_curve_and_model(tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    seen = []
    for _ in range(2):
        assert contact.main(["--steps", "400", "--no-rerun", "--plot", "--out", str(tmp_path)]) == 0
        seen.append((tmp_path / "contact.svg").read_bytes())
    assert seen[0] == seen[1]
    text = seen[0].decode()
    scene = contact.build_scene("drop")
    runs = {model: contact.run_model(model, scene, 0.002, 3) for model in contact.MODELS}
    for word in (*contact.curves(runs, scene), *contact.MODELS):
        assert f">{word}</text>" in text, word
    for color in contact.COLORS.values():
        assert color in text


def test_a_picture_says_what_exploded(tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    flags = ["--dt", "0.03", "--steps", "200", "--no-rerun", "--plot", "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    step = strict_json(tmp_path / "metrics.json")["quality"]["penalty"]["blew_up_step"]
    text = (tmp_path / "contact.svg").read_text()
    assert f"penalty EXPLODED at step {step}</text>" in text and text.count("EXPLODED") == 1


@pytest.mark.parametrize("name", ["bounce", "stack"])
def test_no_label_of_a_picture_lies_on_a_curve_and_no_panel_is_squashed_by_its_zero(
    name, tmp_path, monkeypatch
):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from matplotlib import figure

    drawn = []
    monkeypatch.setattr(
        figure.Figure,
        "savefig",
        lambda self, path, **_: (drawn.append(self), open(path, "w").close()),
    )
    scene = contact.build_scene(name)
    runs = {model: contact.run_model(model, scene, 0.002, 600) for model in contact.MODELS}
    picture.write(tmp_path / "a.svg", name, runs, contact.curves(runs, scene), contact.COLORS)
    (made,) = drawn
    made.draw_without_rendering()
    (legend,) = made.legends
    highest = legend.get_window_extent().y1
    assert made.axes[-1].xaxis.label.get_window_extent().y0 > highest, "the legend is below all"
    for axis in made.axes:
        values = np.concatenate(
            [line.get_ydata() for line in axis.lines if len(line.get_ydata()) > 2]
        )
        low, high = axis.get_ylim()
        assert high - low < 1.5 * np.ptp(values) + 1e-12 or np.ptp(values) == 0.0


def test_without_matplotlib_one_line_says_how_to_install_it(tmp_path):
    code = "import sys; sys.modules['matplotlib'] = None\nimport contact\n"
    run = python(code + "sys.exit(contact.main(sys.argv[1:]))", *SHORT, "--plot", "--out", tmp_path)
    assert run.returncode == 0 and run.stderr == "", run.stderr
    (line,) = [line for line in run.stdout.splitlines() if "picture" in line]
    assert "pip install matplotlib" in line
    assert os.listdir(tmp_path) == ["metrics.json"]


def test_matplotlib_and_processes_are_loaded_only_when_asked_for(tmp_path):
    code = (
        "import sys, contact; contact.main(sys.argv[1:])\n"
        "heavy = {'matplotlib', 'multiprocessing', 'concurrent', 'yaml', 'rerun', 'subprocess'}\n"
        "print('LOADED', sorted(heavy & set(sys.modules)))"
    )
    assert "LOADED []" in python(code, *SHORT, "--out", tmp_path).stdout


# Commands as printed


def test_commands_work_as_printed_beside_an_environment_in_an_active_one_and_under_uv(
    monkeypatch, tmp_path
):
    venv = tmp_path / ".venv" / "bin"
    venv.mkdir(parents=True)
    for name in ("python", "rerun"):
        (venv / name).touch()
    script = str(tmp_path / "exercises" / "ex1.py")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "executable", str(venv / "python"))
    for variable in ("UV", "UV_RUN_RECURSION_DEPTH"):
        monkeypatch.delenv(variable, raising=False)
    assert shell.python(script) == ".venv/bin/python exercises/ex1.py"
    assert shell.tool("rerun") == ".venv/bin/rerun"
    assert shell.install("matplotlib") == ".venv/bin/python -m pip install matplotlib"
    monkeypatch.setenv("PATH", f"{venv}{os.pathsep}{os.environ['PATH']}")
    assert shell.python(script) == "python exercises/ex1.py" and shell.tool("rerun") == "rerun"
    monkeypatch.setenv("UV", "/usr/bin/uv")
    assert shell.python(script, extra="learn") == "uv run --extra learn python exercises/ex1.py"
    assert shell.tool("rerun") == "uv run rerun"
    assert shell.install("matplotlib") == "uv pip install matplotlib"


# Arrays that do not fit


@pytest.mark.parametrize("name, array, said", [
    ("q0", np.zeros((1, 2)), "q0: given an array of shape (1, 2); allowed for 1 balls: (2, 1)"),
    ("v0", np.zeros(2), "v0: given an array of shape (2,); allowed"),
    ("radius", np.zeros((1, 1)), "radius: given an array of shape (1, 1); allowed"),
    ("mass", np.ones((1, 1)), "mass: given an array of shape (1, 1); allowed"),
    ("mass", np.ones(0), "the scene has no ball; allowed: one or more"),
])  # fmt: skip
def test_a_scene_whose_arrays_do_not_fit_is_refused_in_one_line(name, array, said):
    """Rows taken for columns gave no contacts, without a word."""
    scene = contact.build_scene("drop")
    run = contact.run_model("lcp", scene, 0.002, 3)
    wrong = scene._replace(**{name: array})
    for call in (
        lambda: contact.run_model("lcp", wrong, 0.002, 3),
        lambda: contact.run_model("exact", wrong, 0.002, 3),
        lambda: contact.contact_quality(run, wrong, 0.002),
        lambda: contact.simulate(lambda balls: None, wrong, 0.002, 3),
    ):
        with pytest.raises(ValueError) as caught:
            call()
        assert said in str(caught.value) and "\n" not in str(caught.value)


def test_a_run_that_does_not_fit_its_scene_or_its_reference_is_refused():
    scene = contact.build_scene("drop")
    run = contact.run_model("lcp", scene, 0.002, 3)
    longer = contact.run_model("exact", scene, 0.002, 4)
    with pytest.raises(ValueError, match=r"q of a run: given an array of shape \(5, 2, 1\)"):
        contact.contact_quality(run, scene, 0.002, longer)
    with pytest.raises(ValueError, match=r"v of a run: .*allowed for 1 balls: \(4, 2, 1\)"):
        contact.contact_quality(run._replace(v=run.v[:, :, 0]), scene, 0.002)
