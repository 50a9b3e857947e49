"""The shared helpers: whole files, one-line errors, the ledger, the banner, progress."""

import io
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from curriculum.common import arguments, device, files, progress, stoppable, wallclock, workers

ROOT = Path(__file__).resolve().parents[2]


# files


def test_a_file_is_replaced_whole_and_nothing_else_is_left(tmp_path):
    path = tmp_path / "new folder" / "a.txt"
    files.write_whole(path, "old")
    files.write_whole(path, "é\n")
    assert path.read_bytes() == "é\n".encode() and os.listdir(path.parent) == ["a.txt"]


@pytest.mark.parametrize("trouble", [RuntimeError, KeyboardInterrupt])
def test_a_failure_while_writing_keeps_the_old_file_and_removes_the_new(tmp_path, trouble):
    path = tmp_path / "a.txt"
    files.write_whole(path, "old")
    with pytest.raises(trouble), files.whole(path) as temporary:
        Path(temporary).write_text("half")
        raise trouble
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.txt"]


def test_kill_9_in_mid_write_leaves_the_old_file_intact(tmp_path):
    path = tmp_path / "a.txt"
    files.write_whole(path, "old")
    writer = (
        "import sys, time; from curriculum.common import files\n"
        "with files.whole(sys.argv[1]) as temporary, open(temporary, 'w') as file:\n"
        "    file.write('half' * 100000); file.flush(); print('writing', flush=True)\n"
        "    time.sleep(60)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", writer, str(path)], cwd=ROOT, stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b"writing\n"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert path.read_text() == "old"
    files.write_whole(path, "new")
    assert path.read_text() == "new"


def test_a_folder_that_cannot_be_written_gives_an_oserror_naming_the_file(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OSError, match="file/a.txt"):
        files.write_whole(tmp_path / "file" / "a.txt", "x")
    assert (
        files.why_unwritable(tmp_path / "file" / "deeper") == f"{tmp_path / 'file'} is not a folder"
    )
    assert files.why_unwritable(tmp_path / "not" / "there" / "yet") is None
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.skipif(os.name != "posix", reason="permissions are tested where there are users")
def test_without_permission_the_error_names_the_file_and_nothing_is_written():
    code = (
        "import os, sys\nfrom curriculum.common import files\nfolder = sys.argv[1]\n"
        "if os.getuid() == 0: os.setuid(65534)\n"
        "print(files.why_unwritable(folder))\n"
        "try: files.write_whole(folder + '/a.txt', 'x')\n"
        "except PermissionError as error: print(error)"
    )
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o555)
        run = subprocess.run(
            [sys.executable, "-c", code, folder], cwd=ROOT, capture_output=True, text=True
        )
        assert os.listdir(folder) == []
    assert run.stdout.splitlines()[0] == f"no permission to write in {folder}", run.stderr
    assert f"'{folder}/a.txt'" in run.stdout.splitlines()[1]


# arguments


def parser():
    made = arguments.Parser(prog="try.py")
    made.add_argument("--dt", type=arguments.number(float, above=0))
    made.add_argument("--e", type=arguments.number(float, low=0, high=1))
    made.add_argument("--steps", type=arguments.number(int, low=0))
    made.add_argument("--scene", choices=["drop", "stack"])
    made.add_argument("--out", type=arguments.writable_folder)
    return made


BAD = {
    "--dt 0": "given '0', allowed: a number > 0",
    "--dt nan": "given 'nan', allowed: a number > 0",
    "--dt inf": "given 'inf', allowed",
    "--dt -1e-3": "given '-1e-3', allowed",
    "--dt -inf": "given '-inf', allowed",
    "--dt x": "given 'x', allowed",
    "--e 1.01": "given '1.01', allowed: a number >= 0 and <= 1",
    "--steps -1": "given '-1', allowed: a whole number >= 0",
    "--steps 1.5": "given '1.5', allowed: a whole number >= 0",
    "--steps " + "9" * 5000: "999...', allowed",
    "--scene pool": "'pool' (choose from",
    "--sc drop": "unrecognized arguments: --sc drop; allowed: -h --help --dt",
    "--out /dev/null/x": "given '/dev/null/x', but /dev/null is not a folder; allowed: a folder",
}


@pytest.mark.parametrize("line", BAD, ids=lambda line: line[:20])
def test_bad_input_is_one_line_saying_what_was_given_and_what_is_allowed(line, capsys):
    with pytest.raises(SystemExit) as caught:
        parser().parse_args(line.split())
    out, err = capsys.readouterr()
    assert caught.value.code == 2 and out == "" and err.count("\n") == 1
    assert err.startswith("try.py: error: ") and BAD[line] in err and len(err) < 250


def test_good_input_comes_through_and_minus_zero_becomes_zero():
    args = parser().parse_args(["--dt", "2e-3", "--e", "-0.0", "--steps", "0", "--scene", "drop"])
    assert (args.dt, str(args.e), args.steps, args.scene) == (0.002, "0.0", 0, "drop")


# the ledger and the banner

HEADER = ",".join(wallclock.COLUMNS)
ROW = "ch3.5-contact,cpu-vm,0.0041,abc123,1234567,2026-01-02,MEASURED"


def ledger(tmp_path, *rows, header=HEADER):
    path = tmp_path / "wallclock.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_measured_row_is_shown_in_minutes_and_seconds(tmp_path):
    path = ledger(tmp_path, ROW)
    assert wallclock.lookup("ch3.5-contact", "cpu-vm", path) == 0.0041
    assert (
        wallclock.render_line("ch3.5-contact", "cpu-vm", path)
        == "expected wall-clock on cpu-vm: 0.0041 min (0.25 s), measured"
    )


def test_a_pending_an_absent_row_and_no_ledger_are_all_not_yet_measured(tmp_path):
    path = ledger(tmp_path, "ch3.5-contact,t4,,,,,PENDING")
    for chapter, tier, where in (
        ("ch3.5-contact", "t4", path),
        ("ch3.5-contact", "mps", path),
        ("ch0.1", "t4", path),
        ("ch3.5-contact", "t4", tmp_path / "none.csv"),
    ):
        assert (
            wallclock.render_line(chapter, tier, where) == f"wall-clock on {tier}: not yet measured"
        )


@pytest.mark.parametrize(
    "row, what",
    [
        ("ch3.5-contact,t4,0.1,,,,PENDING", "claims a measurement"),
        ("a,b,c", "3 columns, not 7"),
        (ROW.replace("MEASURED", "GUESSED"), "status 'GUESSED'"),
        (ROW.replace("abc123", ""), "needs wallclock_min"),
        (ROW.replace("0.0041", "fast"), "is not a number"),
        (ROW.replace("0.0041", "-1"), "must be > 0"),
        (ROW + "\n" + ROW, "a second row"),
    ],
)
def test_a_broken_row_is_refused_with_its_line(tmp_path, row, what):
    with pytest.raises(ValueError, match=rf"wallclock.csv:[23]: .*{what}"):
        wallclock.read(ledger(tmp_path, row))


def test_a_wrong_header_is_refused(tmp_path):
    with pytest.raises(ValueError, match="wallclock.csv:1: the header must be chapter,tier"):
        wallclock.read(ledger(tmp_path, ROW, header="tier,chapter"))


def test_writing_a_row_replaces_its_own_adds_pending_tiers_and_keeps_the_rest(tmp_path):
    path = ledger(tmp_path, ROW, "ch0.1-sim-loop,t4,0.1,aa,bb,2026-01-01,MEASURED")
    wallclock.write_row("cpu-vm", [0.3, 0.307407, 0.4], "ffff", "7654321", "2026-02-03", path)
    rows = {(r["chapter"], r["tier"]): r for r in wallclock.read(path)}
    assert rows["ch3.5-contact", "cpu-vm"]["wallclock_min"] == "0.00512"
    assert rows["ch0.1-sim-loop", "t4"]["config_hash"] == "aa"
    assert [
        tier for tier in wallclock.SHOWN if rows["ch3.5-contact", tier]["status"] == "PENDING"
    ] == list(wallclock.SHOWN)


def test_the_banner_is_two_lines_and_names_the_device(capsys):
    device.banner("ch3.5-contact", "cpu")
    first, second = capsys.readouterr().out.splitlines()
    assert first == f"[ch3.5-contact] device: cpu | tier: {device.cpu_tier()}"
    assert second.startswith("[ch3.5-contact] ") and ("measured" in second)


def test_a_machine_is_called_a_laptop_only_with_a_battery_and_no_hypervisor(monkeypatch):
    def machine(flags, supplies):
        monkeypatch.setattr(device.sys, "platform", "linux")
        monkeypatch.setattr("builtins.open", lambda *_: io.BytesIO(flags))
        monkeypatch.setattr(device.os.path, "exists", lambda _: False)
        monkeypatch.setattr(device.os, "listdir", lambda _: supplies)
        return device.cpu_tier()

    assert machine(b"flags: fpu hypervisor", ["BAT0"]) == "cpu-vm"
    assert machine(b"flags: fpu", ["AC", "BAT0"]) == "cpu-laptop"
    assert machine(b"flags: fpu", ["AC"]) == "cpu-desktop"
    monkeypatch.setattr(device.sys, "platform", "darwin")
    assert device.cpu_tier() == "cpu"


def test_the_shared_helpers_import_only_the_standard_library_and_stay_light():
    code = (
        "import sys, argparse, contextlib, re, math; before = set(sys.modules)\n"
        "from curriculum.common import arguments, device, files, progress, wallclock\n"
        "print(*sorted(m for m in set(sys.modules) - before if not m.startswith('curriculum')))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == []


# progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_is_silent_when_piped_and_for_short_runs(monkeypatch):
    for stream in (io.StringIO(), Terminal()):
        monkeypatch.setattr(sys, "stderr", stream)
        assert list(progress.steps(5, "pile")) == [0, 1, 2, 3, 4]
        assert stream.getvalue() == ""


def test_progress_on_a_terminal_shows_time_left_and_wipes_itself(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    monkeypatch.setattr(sys, "stderr", Terminal())
    tick = progress.steps(10, "pile")
    for done in range(1, 11):
        tick(done)
    shown = sys.stderr.getvalue()
    assert "\rpile: 2 of 10 steps, 8 s left" in shown and shown.endswith("\r\x1b[K")


def test_progress_wipes_itself_when_the_loop_is_interrupted(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    monkeypatch.setattr(sys, "stderr", Terminal())
    with pytest.raises(KeyboardInterrupt):
        for k in progress.steps(10, "pile"):
            if k == 5:
                raise KeyboardInterrupt
    assert sys.stderr.getvalue().endswith("\r\x1b[K")


# stoppable


def test_a_stopped_command_says_so_in_one_line_and_returns_a_shells_status(capsys):
    @stoppable.stoppable(said="stopped; go on later")
    def main(argv=None):
        """Its docstring."""
        raise argv

    assert main(KeyboardInterrupt()) == 130 == 128 + signal.SIGINT
    assert capsys.readouterr().err == "stopped; go on later\n"
    assert main.__doc__ == "Its docstring."
    with pytest.raises(ValueError, match="a mistake of ours"):
        main(ValueError("a mistake of ours"))
    with pytest.raises(OSError, match="/full/a.txt"):
        main(OSError(28, "No space left on device", "/full/a.txt"))


def test_a_worker_process_is_ended_by_ctrl_c_without_a_traceback_of_its_own(monkeypatch):
    """Python's own handler would print one in each of them; their parent says what is to be said."""
    monkeypatch.setattr(workers.os, "cpu_count", lambda: 2)
    found = workers.spread(signal.getsignal, [(signal.SIGINT,)] * 2, "handlers")
    assert found == [signal.SIG_DFL] * 2 and signal.getsignal(signal.SIGINT) != signal.SIG_DFL


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no full disk to play")
def test_output_to_a_full_disk_is_one_line():
    code = (
        "from curriculum.common.stoppable import stoppable\n"
        "print('said')\n"
        "raise SystemExit(stoppable(lambda: 0)())"
    )
    with open("/dev/full", "w") as full:
        run = subprocess.run(
            [sys.executable, "-c", code], cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True,
            env=os.environ | {"PYTHONUNBUFFERED": ""},
        )  # fmt: skip
    assert run.returncode == 2
    assert run.stderr == "error: cannot print the rest: No space left on device\n"
