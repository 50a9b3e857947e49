"""What went wrong in a run, and a change of flags that cures it: it is named once it was run."""

import math
from collections.abc import Iterator

import numpy as np

import contact
from curriculum.commands import ROOT, command

KNOBS = {knob for row in contact.MODELS.values() for knob in row.knobs} - {"restitution"}


def add_cures(notes: dict, job: tuple, runs: dict, quality: dict, args=None) -> None:
    """Add to {model: lines on its state} what else is wrong, and a cure that was tried.

    job: scene, dt, steps, models, settings; args: the command line that asked for them.
    """
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


def find_fault(model, job, runs, quality) -> tuple[str, str]:
    """Return what contact.find_cause does, and of a run without a fault: a sag, sink, flicker."""
    (scene, dt, _, _, settings), row, law = job, quality[model], ""
    kind, text = contact.find_cause(model, runs[model], scene, dt, settings, row)
    lies = not kind and (row["rests"] or "settles" in text)
    overlap = row["rest_penetration_frac"] if lies else 0.0
    if overlap > 1e-3 and model in ("lcp", "leapfrog"):
        if model == "lcp":
            law = ": a stack sags by (M / m) g dt^2 / (beta K)"
            if settings.baumgarte == 0.0:
                return "sweeps", "beta = 0: no share of an overlap is opened"
        return "sweeps", f"{settings.iters} sweeps do not converge{law}"
    if overlap > 0.05:
        return "sink", f"a spring carries a weight only where it is compressed, {overlap:.3g} r"
    unsteady = model == "soft" and not kind and (row["force_error"] or 0.0) > 0.01
    if unsteady and flickers(runs["soft"], runs["exact"]):
        d0 = (settings.solimp or contact.SOLIMP)[0]
        return "flicker", f"the force comes and goes: a contact begins with impedance d0 = {d0:g}"
    return kind, text


def flickers(run: contact.Run, exact: contact.Run) -> bool:
    """Return whether a ball's force is often 0 in the last quarter while exact's lasts."""
    late, gravity = slice(3 * len(run.v) // 4, None), np.array([[0.0], [contact.GRAVITY]])
    force, right = (
        np.hypot(*(np.diff(each.v[late], axis=0) / run.t[1] - gravity).swapaxes(0, 1))
        for each in (run, exact)
    )
    lasts = right > 0.1 * -contact.GRAVITY
    once = np.diff(lasts, axis=0).sum(0) <= 1  # it does not bounce
    return bool((once & ((lasts & (force < 1e-6)).sum(0) > 2)).any())


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
    row = contact.MODELS.get(wanted["contact"])  # flags without effect on it are left out
    for name, value in wanted.items():
        idle = row and name in KNOBS and name not in row.knobs + row.also
        if isinstance(value, bool):
            words += [f"--no-{name}"] if name in ("skip", "rerun") and not value else []
        elif value != default[name] and not idle:
            several = map(str, value) if isinstance(value, tuple) else [str(value)]
            words += [f"--{name}", *several]
    return command(ROOT / "contact.py", *words)
