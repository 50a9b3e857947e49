"""Exercise 9: five troubles against five knobs, measured, and the sag of a tower."""

import textwrap

import numpy as np

from curriculum.commands import near

from .predict import FACTS, columns, contact, note, practise

USUAL = contact.Settings()
KNOBS = {  # head: (what dt is divided by, settings)
    "as it is": (1, USUAL),
    "k x 4": (1, USUAL._replace(stiffness=4 * USUAL.stiffness)),
    "dt / 4": (4, USUAL),
    "sweeps x 4": (1, USUAL._replace(iters=4 * USUAL.iters)),
    "beta x 4": (1, USUAL._replace(baumgarte=4 * USUAL.baumgarte)),
    "ahead": (1, USUAL._replace(ahead=True)),
}
TROUBLES = {  # model, scene, balls, dt [s], time [s], measure, seeds
    "sink": ("penalty", "drop", 1, 0.002, 4.0, "rest_penetration_frac", 1),
    "dive": ("lcp", "drop", 1, 0.002, 1.2, "max_penetration_frac", 9),
    "hop": ("lcp", "drop", 1, 0.002, 1.2, "rebound_frac", 9),
    "sag": ("lcp", "stack", 10, 0.002, 2.0, "rest_penetration_frac", 1),
    "trembling": ("penalty", "stack", 3, 0.006, 12.0, "rest_jitter", 1),
}
TOWER = {"bodies": 7, "dt": 0.001, "beta": 0.5, "r": 0.1}  # one sweep a step


def run(model, scene, dt, time, settings, key):
    """One number of a run's quality."""
    made = contact.run_model(model, scene, dt, round(time / dt), settings)
    return contact.contact_quality(made, scene, dt)[key]


def measure():
    """{trouble: {knob: number}}."""
    found = {}
    for trouble, (model, scene, bodies, dt, time, key, seeds) in TROUBLES.items():
        scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
        found[trouble] = {
            knob: float(np.mean([run(model, s, dt / by, time, settings, key) for s in scenes]))
            for knob, (by, settings) in KNOBS.items()
        }
    return found


def measure_sag():
    """The sag of the tower [r]."""
    tower = contact.build_scene("stack", 0, TOWER["bodies"])
    settings = USUAL._replace(iters=1, baumgarte=TOWER["beta"])
    return run("lcp", tower, TOWER["dt"], 2.0, settings, "rest_penetration_frac")


def numbers(found, shares):
    """What the reasons quote."""
    made = {trouble: values["as it is"] for trouble, values in found.items()}
    for trouble, row in shares.items():
        made |= {f"{trouble}_{knob.split()[0]}": share for knob, share in zip(list(KNOBS)[1:], row)}
    step, damping = TROUBLES["trembling"][3], contact.build_scene("stack").damping
    return made | {"step": step, "limit": contact.critical_dt(1.0, USUAL.stiffness, damping, 3)}


def mark(share):
    """-, = or +: what became of a trouble, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


def marks(found):
    """{trouble: [mark of each knob]}, and the shares that they stand for."""
    shares = {
        trouble: [values[knob] / values["as it is"] for knob in list(KNOBS)[1:]]
        for trouble, values in found.items()
    }
    return {trouble: list(map(mark, row)) for trouble, row in shares.items()}, shares


def bets(exercise):
    """{trouble: [the learner's marks]}. Raises ValueError, in words, where some are missing."""
    rows = {words[0]: words[1:] for line in exercise.BETS.splitlines() if (words := line.split())}
    for trouble in TROUBLES:
        given = rows.get(trouble, [])
        if len(given) != 5 or set(given) - set("-=+"):
            raise ValueError(
                f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}, "
                "allowed: five marks, each - (less), = or + (more)"
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
    if abs(given - sag) <= 0.01 * sag:
        return "right", ""
    for text, meaning in FACTS["ex9"]["slips"]["SAG"].items():
        if abs(given - eval(text, {}, TOWER)) <= 0.01 * abs(given):
            return "wrong", f"SAG: given {given:g} r; likely: {meaning}"
    return "wrong", f"SAG: given {given:g} r, and the tower sags otherwise; --hint 5 asks how"


def bet(exercise):
    """Ask, or measure and explain. Exit status: 0 done, 1 the sag is wrong, 2 marks are missing."""
    try:
        mine = bets(exercise)
    except ValueError as error:
        print(exercise.__doc__.split("\n    python")[0], f"\n{error}", sep="\n")
        return 2
    found = measure()
    right, shares = marks(found)
    rows = {
        trouble: [
            f"{true} {share:.3g}" + ("" if true == guess else f" ({guess})")
            for true, share, guess in zip(right[trouble], shares[trouble], mine[trouble])
        ]
        for trouble in right
    }
    print(columns("times as much", list(KNOBS)[1:], rows, "{}"))
    hits = sum(a == b for trouble in right for a, b in zip(right[trouble], mine[trouble]))
    print(f"Your bet holds in {hits} of 25; where it was another, it stands in brackets.")
    for trouble, reason in FACTS["ex9"]["reasons"].items():
        print(
            "", textwrap.fill(f"{trouble}: {reason.format(**numbers(found, shares))}", 96), sep="\n"
        )
    what, words = state(exercise)
    print("", words or f"The tower sags by {measure_sag():.4g} r, as you worked out.", sep="\n")
    note("ex9", "done" if what == "right" else None)
    if what == "right":
        print(f"\n{practise()}")
    return ("right", "wrong", "blank").index(what)
