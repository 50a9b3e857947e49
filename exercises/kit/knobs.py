"""Exercise 9: five troubles against four knobs, measured, and the sag of a tower."""

import math
import statistics
import textwrap
from functools import cache

import contact
from curriculum.commands import near

from . import FACTS, columns
from .predict import quality

USUAL = contact.Settings()
KNOBS = {  # head: (what dt is divided by, settings)
    "k x 4": (1, USUAL._replace(stiffness=4 * USUAL.stiffness)),
    "dt / 4": (4, USUAL),
    "sweeps x 4": (1, USUAL._replace(iters=4 * USUAL.iters)),
    "beta x 4": (1, USUAL._replace(baumgarte=4 * USUAL.baumgarte)),
}
TROUBLES = {  # model, scene, balls, dt [s], steps, measure, seeds
    "sink": ("penalty", "drop", 1, 0.002, 2000, "rest_penetration_frac", 1),
    "dive": ("lcp", "drop", 1, 0.002, 600, "max_penetration_frac", 9),
    "hop": ("lcp", "drop", 1, 0.002, 600, "rebound_frac", 9),
    "sag": ("lcp", "stack", 10, 0.002, 1000, "rest_penetration_frac", 1),
    "trembling": ("penalty", "stack", 3, 0.006, 2000, "rest_jitter", 1),
}
TOWER = {"bodies": 7, "dt": 0.001, "beta": 0.5, "r": 0.1}  # one sweep a step


@cache
def measure():
    """{trouble: what it is as it is}, and {trouble: [what each knob makes of it, as a share]}."""
    usual, shares = {}, {}
    for trouble, (model, scene, bodies, dt, steps, key, seeds) in TROUBLES.items():
        scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
        usual[trouble], *turned = (
            statistics.fmean(quality(model, of, dt / by, by * steps, knobs)[key] for of in scenes)
            for by, knobs in ((1, USUAL), *KNOBS.values())
        )
        shares[trouble] = [number / usual[trouble] for number in turned]
    return usual, shares


def mark(share):
    """-, = or +: what became of a trouble, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


@cache
def measure_sag():
    """The sag of the tower [r]."""
    tower = contact.build_scene("stack", 0, TOWER["bodies"])
    settings = USUAL._replace(iters=1, baumgarte=TOWER["beta"])
    return quality("lcp", tower, TOWER["dt"], 2000, settings)["rest_penetration_frac"]


def numbers():
    """What the reasons quote."""
    usual, shares = measure()
    quoted = {
        f"{trouble}_{knob.split()[0]}": share
        for trouble, row in shares.items()
        for knob, share in zip(KNOBS, row)
    }
    step, damping = TROUBLES["trembling"][3], contact.build_scene("stack").damping
    limit = contact.critical_dt(1.0, USUAL.stiffness, damping, 3)
    return usual | quoted | {"step": step, "limit": limit}


def bets(exercise):
    """{trouble: [the learner's marks]}, and what is wrong with the first row that is not whole."""
    lines = getattr(exercise, "BETS", "").replace("\N{MINUS SIGN}", "-").splitlines()
    rows = {words[0]: words[1:] for line in lines if (words := line.split())}
    for trouble in TROUBLES:
        given = rows.get(trouble, ["nothing"])
        if len(given) != len(KNOBS) or set(given) - set("-=+"):
            row = f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}"
            return rows, f"{row}, allowed: four marks, each - (less), = or + (more)"
    return rows, ""


def state(exercise):
    """("blank", "wrong" or "right", why in words) of BETS and SAG."""
    _, wrong = bets(exercise)
    if wrong:
        return "blank", wrong
    try:
        given = abs(float(exercise.SAG))  # the column rest gap/r says it with a minus
    except (TypeError, ValueError):
        said = "no SAG yet" if exercise.SAG is None else f"SAG: given {exercise.SAG!r}"
        return "blank", f"{said}; write a number in {near(exercise.__file__)}, in r, from paper"
    if math.isclose(given, measure_sag(), rel_tol=0.02):
        return "right", f"The tower sags by {measure_sag():.4g} r, as you worked out."
    for text, meaning in FACTS["ex9"]["slips"].items():
        if math.isclose(given, eval(text, {}, TOWER), rel_tol=0.02):
            return "wrong", f"SAG: given {given:g} r; likely: {meaning}"
    return "wrong", f"SAG: given {given:g} r, and the tower sags otherwise; --hint 5 asks how"


def judged(name, exercise):
    """The state of the exercise, and [what, state, words, shown]: all that was measured."""
    what, words = state(exercise)
    mine, wrong = bets(exercise)
    if wrong:
        return what, [[name, what, words, ""]]
    rows, hits, shares = {}, 0, measure()[1]
    for trouble, row in shares.items():
        pairs = [(mark(share), guess) for share, guess in zip(row, mine[trouble])]
        hits += sum(true == guess for true, guess in pairs)
        rows[trouble] = [
            f"{share:.3g} {true}" + ("" if true == guess else f" ({guess})")
            for share, (true, guess) in zip(row, pairs)
        ]
    shown = columns("times as much", KNOBS, rows, "{}")
    shown += f"\nYour bet holds in {hits} of 20; where it was another, it stands in brackets.\n"
    for trouble, reason in FACTS[name]["reasons"].items():
        shown += "\n" + textwrap.fill(f"{trouble}: {reason.format(**numbers())}", 96) + "\n"
    return what, [[name, what, words, shown]]
