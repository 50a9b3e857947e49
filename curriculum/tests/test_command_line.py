"""The command line: bad input, equal bytes, strict JSON, rerun wanted, unwanted and missing."""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

import contact

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
    with pytest.raises(KeyboardInterrupt):
        contact.main([*SHORT, "--out", str(tmp_path / "new")])
    assert list(tmp_path.iterdir()) == []
