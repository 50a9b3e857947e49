"""What a user sees of contact.py's command line: flags, errors, files, and how it ends."""

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import contact
from curriculum.tests.helpers import CONTACT, NO_PLUGINS, ROOT, python, stopped

# How the lines of a report begin that the folder beside contact.py adds or changes.
FOLDER_ONLY = "recording:", "next,", "no recording:", "exact: ", "  try: ", "  because: ", "state: "


def main(capsys, *flags):
    """(exit status, stdout, stderr) of the command line, in this process."""
    try:
        status = contact.main(list(map(str, flags)))
    except SystemExit as end:
        status = end.code
    return status, *capsys.readouterr()


def strict_json(path):
    return json.loads(path.read_text("utf-8"), parse_constant=pytest.fail)


def refused(outcome):
    """The one line that bad input gets."""
    status, out, err = outcome
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith("contact.py: error: ") and len(err) < 300
    return err


BAD = [
    "--scene pool", "--contact mujoco", "--device cuda", "--smoke --steps 100", "--out=--",
    "--scene=--", "--seed -1",
    "--seed 1.5", "--seed x", "--dt 0",
    "--dt -0.002", "--dt fast", "--steps 2.5", "--steps 1000000000000", "--bodies 2",
    "--bodies 0 --scene stack", "--bodies many", "--mass 0", "--mass 1e-320", "--mass 1e+308",
    "--stiffness -1", "--stiffness inf", "--damping -10000", "--damping nan", "--restitution 1.01",
    "--restitution -0.5", "--baumgarte -0.01", "--warm 1.1", "--iters 0",
    "--iters 99999999999999999999", "--solref soft 1", "--solref nan nan", "--solref 0.02 0",
    "--solref -1 1", "--solref 0.02 1e-162", "--solimp -0.1 0 0 0 0", "--stiff 3", "drop bounce",
    "--steps 10000000 --bodies 10000 --scene pile",
]  # fmt: skip
WORDS = "allowed: |choose from|no value|leave out|is for|unrecognized arguments: "


def test_bad_input_is_one_line_that_says_what_is_wrong(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    taken = {each.option_strings[0] for each in contact.make_parser()._actions if each.nargs != 0}
    assert taken - {"--skip", "--rerun", "--out"} <= {flags.split()[0] for flags in BAD}
    for flags in BAD:
        err = refused(main(capsys, *flags.split()))
        assert re.search(WORDS, err) and re.split("[ =]", flags)[0] in err, flags
    assert not any(tmp_path.iterdir())


KNOBS = (
    "--dt 0.004 --mass 2 --restitution 0.5 --damping 20 --stiffness 5e3 --baumgarte 0.4 --iters 3 "
    "--warm 0.5 --solref 0.03 0.8 --solimp 0.5 0.9 0.002 0.4 3 --no-rerun"
)


@pytest.mark.parametrize("flags", [
    "--scene drop", f"--smoke --scene stack --bodies 4 {KNOBS}", "--help", "--scene pool",
])  # fmt: skip
def test_alone_in_an_empty_folder_it_prints_and_writes_the_same_bytes(
    flags, numpy_alone, tmp_path, monkeypatch, capsys
):
    """With numpy and nothing else; but for what the folder beside it adds."""
    (tmp_path / "beside").mkdir()
    monkeypatch.chdir(tmp_path / "beside")
    status, out, err = main(capsys, *flags.split())
    shutil.copy(CONTACT, tmp_path)
    how = {"PYTHONPATH": numpy_alone, "PYTHONHASHSEED": "97"}
    alone = python("-S", "contact.py", *flags.split(), cwd=tmp_path, **how)
    lines = (each.splitlines() for each in (alone.stdout, out))
    mine, full = ([line for line in some if not line.startswith(FOLDER_ONLY)] for some in lines)
    assert sorted(mine) == sorted(full)
    for model in contact.MODELS if "\nstate: " in out else ():
        assert ended(alone.stdout, model)[0] == ended(out, model)[0]
    causes, more = (re.findall("because: (?!nothing).*", each) for each in (alone.stdout, out))
    assert {*causes} <= {*more}
    assert (alone.returncode, alone.stderr) == (status, err)
    written = [path.read_bytes() for path in tmp_path.rglob("metrics.json")]
    assert len(written) == 2 * (status == 0 and flags != "--help") and len({*written}) <= 1


# What is in the way, the words, the exit status, what output and errors say.
WAYS = [
    ("", "CONTACT --steps 1e1 --no-rerun --out é", 0, ": 10 steps(?s:.*)xe9", ""),  # in ASCII
    ("contact.py", "contact.py --plot --steps 5", 0, "no picture", ""),
    ("rerun.py", "CONTACT --steps 5", 0, "metrics: .*\nno recording: .*install it: ", ""),
    ("matplotlib.py", "CONTACT --steps 5 --plot --no-rerun", 0, "no picture: .*install it", ""),
    ("out/contact.rrd/", "CONTACT --steps 5 --out out", 2, "metrics: out", ".*cannot write .*"),
    ("outputs", "CONTACT --smoke --no-rerun", 2, "stability: pen", ".*report is complete.*"),
]


@pytest.mark.parametrize("put, words, status, says, complains", WAYS)
def test_whatever_is_in_the_way_it_says_so_in_a_line_and_gives_what_it_can(
    put, words, status, says, complains, tmp_path
):
    (tmp_path / put).parent.mkdir(exist_ok=True)
    if put == "contact.py":
        shutil.copy(CONTACT, tmp_path)
    elif put.endswith("/"):
        (tmp_path / put).mkdir()
    elif put:
        (tmp_path / put).write_text("raise ImportError('not installed')")
    typed = words.replace("CONTACT", str(CONTACT)).split()
    done = python(*typed, cwd=tmp_path, PYTHONPATH=str(tmp_path), PYTHONIOENCODING="ascii")
    assert done.returncode == status and re.search(says, done.stdout), done.stdout
    assert re.fullmatch(complains, done.stderr.removesuffix("\n")), done.stderr


def test_the_report_measures_the_run_that_the_flags_ask_for(tmp_path, capsys):
    words = f"--scene stack --bodies 4 --seed 5 --steps 150 {KNOBS} --out {tmp_path}"
    assert main(capsys, *words.split())[0] == 0
    scene = contact.build_scene("stack", 5, 4, 0.5, 20.0, 2.0)
    settings = contact.Settings(5e3, 0.4, 3, 0.5, (0.03, 0.8), (0.5, 0.9, 0.002, 0.4, 3.0))
    runs = {m: contact.run_model(m, scene, 0.004, 150, settings) for m in contact.MODELS}
    quality = strict_json(tmp_path / "metrics.json")["quality"]
    for model, run in runs.items():
        expected = contact.contact_quality(run, scene, 0.004, runs["exact"])
        assert quality[model] == pytest.approx(expected, abs=1e-11)


ODD = (
    "--steps 0", "--steps 1", "--bodies 1", "--stiffness 0 --damping 0", "--solref 0.02 1e6",
    "--solref 1e6 1", "--solref 1e-6 1e-6", "--solref -1e12 -50", "--solref -1e12 0",
    "--solref 0 0", "--solimp 0 0 0 0 1", "--solimp 0.9 0.95 1e-320 0.5 2",
    "--dt 0.03 --stiffness 1e9 --mass 1e-9", "--mass 1e9 --stiffness 1e-9 --dt 1",
    "--restitution 1 --baumgarte 1 --dt 1 --iters 1", "--scene pile --steps 0",
)  # fmt: skip


NAMES = "dt mass stiffness damping baumgarte restitution warm iters seed".split()
ENDS = [f"--{name} {end}" for name in NAMES for end in contact.LIMITS[name][1:3]]


def test_flags_inside_and_at_the_ends_of_their_ranges_give_a_right_report_or_one_line(
    tmp_path, capsys
):
    """A warning is an error in these tests. Few steps, down to none, are recorded, too."""
    for flags in (*ODD, *ENDS):
        few = () if "--steps" in flags else ("--steps", 60, "--no-rerun")
        words = "--scene", "stack", *flags.split(), *few, "--out", tmp_path
        status, out, err = main(capsys, *words)
        if status:
            refused((status, out, err))
            continue
        assert err == "", flags
        for model, row in strict_json(tmp_path / "metrics.json")["quality"].items():
            (line,) = re.findall(rf"state: .*\b{model}\b.*", out)
            through = row["through"] is not None and not row["blew_up"]
            assert ("EXPLODED" in line, "through" in line) == (row["blew_up"], through), flags


def test_no_rerun_never_imports_rerun_nor_anything_else_that_is_slow(tmp_path):
    code = (
        "import sys, contact; contact.main(['--no-rerun', '--out', sys.argv[1]]); "
        "print(sorted({'rerun', 'matplotlib', 'numba', 'tqdm', 'dask'} & set(sys.modules)))"
    )
    done = python("-c", code, tmp_path)
    assert done.stdout.splitlines()[-1] == "[]", done.stderr


COMMANDS = (
    "contact.py", "checks.py", "exercises/ex1_predict_contact.py",
    *(f"-m curriculum.{name}" for name in "seeds gate page notebook bench stress".split()),
)  # fmt: skip


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
@pytest.mark.parametrize("command", COMMANDS)
def test_ctrl_c_and_sigterm_while_a_command_imports_are_one_word(command, tmp_path):
    ends = [("SIGINT", 130), ("SIGTERM", 143)]  # others have the same two handlers
    for name, status in ends if "seeds" in command else ends[:1]:
        stop = f"import os, signal\nos.kill(os.getpid(), signal.{name})\n"
        (tmp_path / "numpy.py").write_text(stop)
        done = python(*command.split(), PYTHONPATH=str(tmp_path))
        assert (done.returncode, done.stdout, done.stderr) == (status, "", "stopped\n"), name


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
def test_ctrl_c_ends_a_run_with_one_word_and_leaves_no_file(tmp_path):
    start = "import runpy; print('ready', flush=True); runpy.run_path('contact.py', {}, '__main__')"

    def in_its_steps(process):
        return process.stdout.readline() and not time.sleep(1.0)

    words = "-c", start, *f"--no-skip --steps 1000000 --out {tmp_path}/o".split()
    done = stopped(signal.SIGINT, words, in_its_steps, terminal=True)
    assert done == (130, "", "stopped\n") and not any(tmp_path.iterdir())


@pytest.mark.parametrize("words", [
    "contact.py --steps 5 --no-rerun --out OUT", "-m curriculum.seeds -h", "checks.py -k ex2",
    "exercises/ex1_predict_contact.py --hint 1",
])  # fmt: skip
def test_a_pipe_that_nobody_reads_ends_it_without_a_word_and_a_full_disk_with_a_line(
    words, tmp_path
):
    environment = os.environ | NO_PLUGINS | {"PYTHONUNBUFFERED": ""}
    how = {"cwd": ROOT, "env": environment, "stderr": subprocess.PIPE, "text": True}
    typed = [sys.executable, *words.replace("OUT", str(tmp_path)).split()]
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(typed, stdout=writer, **how)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")
    if os.path.exists("/dev/full"):  # not every system has it
        with open("/dev/full", "w") as full:
            done = subprocess.run(typed, stdout=full, **how)
        who = "contact.py: error: cannot print the rest" if words[:7] == "contact" else "error"
        assert (done.returncode, done.stderr) == (2, f"{who}: No space left on device\n")


# flags, how the run of their model ended, and why; where something is wrong a cure is printed
CAUSES = [
    ("--contact penalty --dt 0.0135", "rests after a gain of 329 % energy", "a step late"),
    ("--contact penalty --stiffness 60", "through the floor", "the spring is too weak"),
    ("--contact penalty --stiffness 1e3", "rests", "only where it is compressed, 0.0981 r"),
    ("--scene stack --contact penalty --dt 0.006", "moves", "the fastest swing, 0.005682 s"),
    ("--scene bounce --contact penalty", "moves after a hop of 9.07 r", "the damper is weak"),
    ("--contact lcp --dt 0.064", "through the floor", "once a step, in which a ball moves 2.81 r"),
    ("--contact lcp --baumgarte 1", "rests after a hop of 4.07 r", "beta depth / dt, is kept"),
    ("--contact lcp --baumgarte 0", "rests", "beta = 0: no share of an overlap is opened"),
    ("--contact soft --solref 0.02 0.1", "moves after a hop of 4.38 r", "the damper is weak"),
    ("--contact soft --solref -1e6 -100", "moves after a gain", "of this solref, 0.001902 s"),
    ("--scene slide --contact leapfrog", "moves", "nothing is wrong: it still slides at 4 s"),
    ("--smoke --scene bounce --contact lcp", "moves", "nothing is wrong: it still bounces"),
    ("--contact exact --steps 5", "moves", "nothing is wrong: it still falls at 0.01 s"),
    # with flags of every kind, which the cure has to keep
    ("--scene pile --bodies 5 --seed 3 --contact penalty --dt 0.05 --stiffness 2e5 --damping 3 "
     "--mass 0.02 --restitution 0.4 --steps 300 --no-skip", "EXPLODED", "critical step of a ball"),
    ("--scene slide --seed 7 --solimp 0.6 0.97 0.002 0.5 2 --mass 30", "moves", "d0 = 0.6"),
    ("--scene stack --contact lcp --dt 0.1 --baumgarte 0.8 --iters 7 --warm 0.5", "rests",
     "7 sweeps do not converge"),
]  # fmt: skip


def ended(out, model):
    """How the run of a model ended, and the lines on why and what to try, "" without one."""
    lines = [*out.splitlines(), "", ""]
    (k,) = (k for k, line in enumerate(lines) if re.match(rf"state: .*\b{model}\b", line))
    why = lines[k + 1].partition("because: ")[2]
    return lines[k][7:].rpartition(":")[0], why, lines[k + 2].partition("try: ")[2] if why else ""


@pytest.mark.parametrize("flags, state, why", CAUSES)
def test_a_verdict_names_its_cause_and_a_command_that_cures_it(flags, state, why, tmp_path, capsys):
    """The command ends without a fault, typed as it stands."""
    _, out, _ = main(capsys, *flags.split(), "--no-rerun", "--out", tmp_path)
    model = re.search("--contact (\\w+)|$", flags)[1] or "soft"
    *found, cure = ended(out, model)
    assert re.match(state, found[0]) and why in found[1], found
    if "nothing is wrong" in why:
        assert not cure
        return
    _, script, *typed = shlex.split(cure)
    assert Path(script).resolve() == CONTACT
    named = typed[typed.index("--contact") + 1] if "--contact" in typed else model
    ends, because, _ = ended(main(capsys, *typed)[1], named)
    assert ends in ("rests", "moves") and "nothing is wrong" in (because or "nothing is wrong")


IN_IPYTHON = """
import os, signal, sys, threading, time, traceback
from IPython.core.interactiveshell import InteractiveShell
shell, threads = InteractiveShell.instance(), "OPENBLAS_NUM_THREADS"
os.environ.pop(threads, None)
there = lambda: ("contact" in sys.modules, threads in os.environ)
state = lambda: (*map(signal.getsignal, (2, 15)), sys.excepthook, *there())
run, before = f"contact.py --no-skip --no-rerun --out {sys.argv[1]} --steps ", state()
shell.run_line_magic("run", run + "5")
def interrupt(main=threading.get_ident()):  # once it takes steps
    while "simulate" not in str(traceback.format_stack(sys._current_frames()[main])):
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
shell.run_line_magic("run", run + "100000000")
shell.run_cell("1 / 0")
shell.run_cell("import contact; print(contact.__name__, contact.RADIUS)")
del sys.modules["contact"]
print("kept" if state() == before else f"changed: {before} {state()}")
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
def test_ipython_runs_it_goes_on_after_an_interrupt_and_keeps_its_own_handlers(tmp_path):
    pytest.importorskip("IPython", reason="IPython is not installed: the extra `notebook`")
    done = python("-c", IN_IPYTHON, tmp_path / "out", IPYTHONDIR=str(tmp_path))
    assert done.stdout.endswith("contact 0.1\nkept\n"), done.stdout + done.stderr
    assert "stopped\n" in done.stderr and "ZeroDivisionError" in done.stdout + done.stderr
    assert "AttributeError" not in done.stdout + done.stderr


# fmt: off
LINES = [
    ("--contact soft --iters 5", "--iters is for lcp.* leapfrog.*, and has no effect here"),
    ("--dt 0.064", "stability: lcp .*, through the floor"),
    ("--scene stack --contact soft --dt 0.1", "state: through a ball: soft"),
    ("--stiffness 1e15 --steps 300", "stability: penalty none of those that touch"),
    ("--dt 1e-6 --steps 3", "stability: lcp reaches no contact"),
]
# fmt: on


@pytest.mark.parametrize("flags, line", LINES)
def test_the_report_says_what_a_reader_would_ask(flags, line, tmp_path, capsys):
    _, out, _ = main(capsys, *flags.split(), "--no-rerun", "--out", tmp_path)
    assert any(re.fullmatch(line, each) for each in out.splitlines()), out
