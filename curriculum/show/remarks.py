"""What a run's table does not say: flags without effect, what exact did, soft's contact as MuJoCo
writes it, what to do next; what went wrong, and a change of flags that cures it, once it was run.
"""

import math
import os
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import contact
from curriculum.commands import ROOT, command
from curriculum.show.picture import contact_impulses
from exercises.kit.script import practise


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
        print(landing(runs["exact"], scene))
    if list(runs) == ["soft"]:
        knobs = contact.soft_defaults(scene.restitution, dt, settings.solref, settings.solimp)
        solref, solimp = (" ".join(map(repr, values)) for values in knobs)
        print(f'in MJCF: <option timestep="{dt!r}"/>, <geom solref="{solref}" solimp="{solimp}"/>')
    faults = {model: find_fault(model, job, runs, quality) for model in runs}
    tried = {model: {"contact": model} for model in runs if not faults[model][0]}
    for model, (kind, text) in faults.items():
        notes[model] = [f"because: {text}"] if text else []
        for changes in cures(kind, model, *job) if kind else ():
            key = changes.get("contact") or (model, *changes.items())
            if key not in tried:  # several models may share a cure
                tried[key] = cured(changes, model, kind, job)
            if tried[key]:
                notes[model].append(f"try: {typed(args, model, kind, tried[key])}")
                break


def landing(run: contact.Run, scene: contact.Scene) -> str:
    """Return a line on the lowest ball's landing; until then all fall alike."""
    k, g = int(scene.q0[1].argmin()), contact.GRAVITY
    gap, vy = float(run.q[0, 1, k] - scene.radius[k]), float(run.v[0, 1, k])
    who = "the ball" if len(scene.mass) == 1 else "the lowest ball"
    after = contact.time_to_impact(gap, vy, g)
    if after > run.t[-1]:
        return f"exact: {who} does not land within these steps"
    return f"exact: {who} lands after {after:.6g} s, at {-(vy + after * g):.6g} m/s"


def print_next(args, argv: list[str]) -> None:
    """Print the last lines of a run: flags that the chosen model does not use, how to read on, to
    see it, the next exercise.

    args: the flags as contact.parse_flags gives them; argv: the words they were read from.
    """
    default = contact.Settings()._asdict() | {"damping": None, "restitution": None}
    for knob in default:
        owners = [name for name, row in contact.MODELS.items() if knob in row.knobs + row.also]
        if owners and getattr(args, knob) != default[knob] and args.contact not in ("all", *owners):
            print(f"--{knob} is for {' and '.join(owners)}, and has no effect here")
    if Path.cwd() == ROOT:  # from where python -m finds it
        page = command("-m", "curriculum.page", bring=("--extra", "page"))
        print(f"next, read the chapter: {page}")
    recording = os.path.join(args.out, "contact.rrd")
    if args.rerun and os.path.exists(recording):
        print(f"next, watch it: {command('-m', 'rerun', recording)}")
    elif not args.plot and find_spec("matplotlib"):
        print(f"next, see it: {command(ROOT / 'contact.py', *argv, '--plot')}")
    print(practise())


def find_fault(model, job, runs, quality) -> tuple[str, str]:
    """Return what contact.find_cause does, and of a run without a fault: a sag, sink, flicker."""
    (scene, dt, _, _, settings), row, law = job, quality[model], ""
    kind, text = contact.find_cause(model, runs[model], scene, dt, settings, row)
    lies = not kind and (row["rests"] or "settles" in text)
    overlap = row["rest_penetration_frac"] if lies else 0.0
    if overlap > 1e-3 and model in ("lcp", "leapfrog"):
        if model == "lcp":
            law = ": a stack sags by (M / m) g dt^2 / (beta iters)"
            if settings.baumgarte == 0.0:
                return "sweeps", "beta = 0: no share of an overlap is opened"
        return "sweeps", f"{settings.iters} sweeps do not converge{law}"
    if overlap > 0.05:
        return "sink", f"a spring carries a weight only where it is compressed, {overlap:.3g} r"
    unsteady = model == "soft" and not kind and (row["force_error"] or 0.0) > 0.01
    if unsteady and flickers(runs["soft"], runs["exact"], scene):
        d0 = (settings.solimp or contact.SOLIMP)[0]
        return "flicker", f"the force comes and goes: a contact begins with impedance d0 = {d0:g}"
    return kind, text


def flickers(run: contact.Run, exact: contact.Run, scene: contact.Scene) -> bool:
    """Return whether a ball's force is often 0 in the last quarter while exact's lasts."""
    late, weight = slice(3 * len(run.v) // 4, None), -contact.GRAVITY * scene.mass * run.t[1]
    pushes = (contact_impulses(each, scene)[late] for each in (run, exact))
    push, right = (np.hypot(*each.swapaxes(0, 1)) for each in pushes)
    lasts = right > 0.1 * weight
    once = np.diff(lasts, axis=0).sum(0) <= 1  # it does not bounce
    return bool((once & ((lasts & (push < 1e-7 * weight)).sum(0) > 2)).any())


def cures(kind, model, scene, dt, steps, models, settings) -> Iterator[dict]:
    """Yield changes {flag: value} that may cure a kind of fault, the best first."""
    if kind == "critical":
        limit = min(contact.critical_steps(model, scene, dt, settings).values())
        yield from ({"dt": float(f"{share * limit:.1e}")} for share in (0.8, 0.4, 0.1))
    elif kind == "flicker":
        yield {"solimp": (0.0, *(settings.solimp or contact.SOLIMP)[1:])}
    elif kind == "sweeps" and settings.baumgarte == 0.0:
        yield {"baumgarte": contact.Settings().baumgarte}
    elif kind == "sweeps":
        yield from ({"iters": settings.iters * more} for more in (4, 16, 64))
    elif kind == "damper" and model == "soft":
        yield {"solref": contact.SOLREF}
    elif kind == "damper" and scene.restitution == 0.0:
        yield {"damping": float(f"{math.sqrt(settings.stiffness * scene.mass.min()):.1e}")}
    elif kind == "landing" and model == "penalty":
        yield from ({"dt": float(f"{dt / share:.1e}")} for share in (4, 16))
    if model == "penalty":
        yield {"contact": "lcp"}
    yield {"contact": "leapfrog"}
    yield {"contact": "exact"}


def cured(changes, model, kind, job):
    """Run a job with changes for as long. Returns them, if nothing is wrong then, or None."""
    scene, dt, steps, _, settings = job
    name, step = changes.get("contact", model), changes.get("dt", dt)
    count = math.ceil(steps * dt / step)
    if count > steps and count * len(scene.mass) ** 2 > contact.COMPILE_FROM:
        return None  # it would take too long to see
    knobs = {knob: value for knob, value in changes.items() if knob in contact.Settings._fields}
    scene = scene._replace(damping=changes.get("damping", scene.damping))
    names = [name, "exact"] if kind == "flicker" else [name]
    changed = scene, step, count, names, settings._replace(**knobs)
    runs, _, quality = contact.run_models(*changed)
    if name not in runs or find_fault(name, changed, runs, quality)[0]:
        return None
    return changes | ({"steps": count} if count != steps else {})


def typed(args, model, kind, changes) -> str:
    """Return the changes as a command, or as arguments where no command line asked."""
    if args is None:
        names = {"contact": "models"}
        return ", ".join(f"{names.get(key, key)}={value!r}" for key, value in changes.items())
    default, words = vars(contact.parse_flags([])), []
    wanted = vars(args) | ({} if kind == "flicker" else {"contact": model}) | changes
    for name, value in wanted.items():
        if isinstance(value, bool):
            words += [f"--no-{name}"] if name in ("skip", "rerun") and not value else []
        elif value != default[name]:
            several = map(str, value) if isinstance(value, tuple) else [str(value)]
            words += [f"--{name}", *several]
    return command(ROOT / "contact.py", *words)
