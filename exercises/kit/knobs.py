"""Exercise 9: five troubles against four knobs, measured, and the sag of a tower."""

import statistics
import textwrap

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


def marks(shares):
    """{trouble: [-, = or + of each knob]}: what became of a trouble, as a share of what it was."""
    return {
        trouble: ["-" if share <= 0.5 else "+" if share >= 2.0 else "=" for share in row]
        for trouble, row in shares.items()
    }


def measure_sag():
    """The sag of the tower [r]."""
    tower = contact.build_scene("stack", 0, TOWER["bodies"])
    settings = USUAL._replace(iters=1, baumgarte=TOWER["beta"])
    return quality("lcp", tower, TOWER["dt"], 2000, settings)["rest_penetration_frac"]


def numbers(usual, shares):
    """What the reasons quote."""
    quoted = {
        f"{trouble}_{knob.split()[0]}": share
        for trouble, row in shares.items()
        for knob, share in zip(KNOBS, row)
    }
    step, damping = TROUBLES["trembling"][3], contact.build_scene("stack").damping
    limit = contact.critical_dt(1.0, USUAL.stiffness, damping, 3)
    return usual | quoted | {"step": step, "limit": limit}


def bets(exercise):
    """{trouble: [the learner's marks]}. Raises ValueError, in words, where some are missing."""
    lines = exercise.BETS.replace("\N{MINUS SIGN}", "-").splitlines()
    rows = {words[0]: words[1:] for line in lines if (words := line.split())}
    for trouble in TROUBLES:
        given = rows.get(trouble, ["nothing"])
        if len(given) != len(KNOBS) or set(given) - set("-=+"):
            raise ValueError(
                f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}, "
                "allowed: four marks, each - (less), = or + (more)"
            )
    return {trouble: rows[trouble] for trouble in TROUBLES}


def state(exercise):
    """("blank", "wrong" or "right", why in words) of BETS and SAG."""
    try:
        bets(exercise)
        if exercise.SAG is None:
            raise ValueError(f"no SAG yet: work it out on paper, in {near(exercise.__file__)}")
        given = float(exercise.SAG)
    except (TypeError, ValueError) as error:
        return "blank", str(error)
    sag = measure_sag()
    if abs(abs(given) - sag) <= 0.02 * sag:  # the column rest gap/r says it with a minus
        return "right", ""
    for text, meaning in FACTS["ex9"]["slips"].items():
        if abs(abs(given) - eval(text, {}, TOWER)) <= 0.01 * abs(given):
            return "wrong", f"SAG: given {given:g} r; likely: {meaning}"
    return "wrong", f"SAG: given {given:g} r, and the tower sags otherwise; --hint 5 asks how"


def judged(name, exercise):
    """The state of the exercise, and [what, state, words, shown]: all that was measured."""
    try:
        mine = bets(exercise)
    except ValueError as error:
        return "blank", [[name, "blank", str(error), ""]]
    usual, shares = measure()
    right, quoted = marks(shares), numbers(usual, shares)
    pairs = [pair for trouble in right for pair in zip(right[trouble], mine[trouble])]
    hits = sum(true == guess for true, guess in pairs)
    rows = {
        trouble: [
            f"{true} {share:.3g}" + ("" if true == guess else f" ({guess})")
            for true, share, guess in zip(right[trouble], shares[trouble], mine[trouble])
        ]
        for trouble in right
    }
    bet = f"Your bet holds in {hits} of {len(pairs)}; where it was another, it stands in brackets."
    shown = [columns("times as much", KNOBS, rows, "{}") + f"\n{bet}"]
    for trouble, reason in FACTS[name]["reasons"].items():
        shown.append(textwrap.fill(f"{trouble}: {reason.format(**quoted)}", 96))
    what, words = state(exercise)
    words = words or f"The tower sags by {measure_sag():.4g} r, as you worked out."
    return what, [[name, what, words, "\n\n".join((*shown, ""))]]
