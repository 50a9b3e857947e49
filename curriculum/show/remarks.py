"""What a run's table does not say: flags without effect, what exact did, soft's contact as MuJoCo
writes it, and what to do next."""

import os
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import contact
from curriculum.commands import ROOT, command, quoted
from curriculum.show.cures import add_cures
from exercises.kit.script import practise

APEXES = 5  # heights of bounces that are printed


def print_unused(args) -> None:
    """Print a line on each flag that has no effect on the model that was chosen.

    args: the flags as contact.parse_flags gives them.
    """
    default = contact.Settings()._asdict() | {"damping": None, "restitution": None}
    for knob in default:
        owners = [name for name, row in contact.MODELS.items() if knob in row.knobs + row.also]
        if owners and getattr(args, knob) != default[knob] and args.contact not in ("all", *owners):
            print(f"--{knob} is for {' and '.join(owners)}, and has no effect here")


def add_remarks(notes: dict, job: tuple, runs: dict, quality: dict, args=None) -> None:
    """Print what exact or soft did, where no table says it; add to notes what else is wrong.

    job: scene, dt, steps, models, settings; args: the command line that asked for it, if one did.
    Of runs {model: Run}, notes are {model: [line]} and quality is {model: contact_quality}.
    """
    scene, dt, _, _, settings = job
    if "exact" in runs:
        moved = np.abs(runs["exact"].q[0] - scene.q0).max() / scene.radius.min()
        if moved > 1e-9:
            print(f"exact: balls overlap at the start, and were moved apart by up to {moved:.3g} r")
    if list(runs) == ["exact"] and np.isfinite(scene.mass).all():
        print(*landing(runs["exact"], scene), sep="\n")
    if list(runs) == ["soft"]:
        knobs = contact.soft_defaults(scene.restitution, dt, settings.solref, settings.solimp)
        solref, solimp = (" ".join(map(repr, values)) for values in knobs)
        print(f'in MJCF: <option timestep="{dt!r}"/>, <geom solref="{solref}" solimp="{solimp}"/>')
    add_cures(notes, job, runs, quality, args)


def landing(run: contact.Run, scene: contact.Scene) -> Iterator[str]:
    """Lines on the lowest ball's landing and bounces, from the parabolas between two states."""
    k, g = int(scene.q0[1].argmin()), contact.GRAVITY
    gap, vy = run.q[:, 1, k] - scene.radius[k], run.v[:, 1, k]
    who = "the ball" if len(scene.mass) == 1 else "the lowest ball"
    after = contact.time_to_impact(float(gap[0]), float(vy[0]), g)  # until then all fall alike
    if after > run.t[-1]:
        yield f"exact: {who} does not land within these steps"
        return
    yield f"exact: {who} lands after {after:.6g} s, at {-(vy[0] + after * g):.6g} m/s"
    turns = np.flatnonzero((vy[:-1] > 0.0) & (vy[1:] <= 0.0))
    if len(turns):
        tops = gap[turns] - vy[turns] ** 2 / (2 * g)
        heights = ", ".join(f"{top:.4g}" for top in tops[:APEXES])
        yield f"exact: its bounces rise to {heights} m" + (" ..." if len(tops) > APEXES else "")
    else:
        yield "exact: it does not bounce"


def print_next(args, argv: list[str]) -> None:
    """Print the last lines of a run: unused flags, how to read on, to see it, the next exercise.

    args: the flags as contact.parse_flags gives them; argv: the words they were read from.
    """
    print_unused(args)
    if Path.cwd() == ROOT:  # from where python -m finds it
        page = command("-m", "curriculum.page", bring=("--extra", "page"))
        print(f"next, read the chapter: {page}")
    recording = os.path.join(args.out, "contact.rrd")
    if args.rerun and os.path.exists(recording):
        viewer = Path(sys.executable).with_name("rerun.exe" if os.name == "nt" else "rerun")
        by = ("uv", "run", "rerun") if "UV" in os.environ else (viewer,)
        there = quoted(*by, recording) if by[0] == "uv" or viewer.exists() else None
        print(f"next, watch it: {there or command('-m', 'rerun', recording)}")
    elif not args.plot and find_spec("matplotlib"):
        print(f"next, see it: {command(ROOT / 'contact.py', *argv, '--plot')}")
    print(practise())
