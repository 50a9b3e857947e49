"""Bets: what is measured, and a word on every choice."""

import re
import statistics
import textwrap
from functools import cache

import contact
from curriculum.commands import near

from . import FACTS, columns, task_of

USUAL, MODELS = contact.Settings(), ("penalty", "lcp")  # the models of which one bets
BETS = {  # exercise: corner of its table, how a number is written, {label: (head of its column,
    # key of contact_quality, ball [kg], height [m], dt [s])}; shown is README's first line
    "ex1": ("depth", "{:.5f} r", {
        "deepest": ("deepest", "max_penetration_frac", 4.0, 0.65, 0.002),
        "at_rest": ("at rest", "rest_penetration_frac", 4.0, 0.65, 0.002),
        "shown_deepest": ("", "max_penetration_frac", 1.0, 1.0, 0.002),
        "shown_at_rest": ("", "rest_penetration_frac", 1.0, 1.0, 0.002)}),
    "ex3": ("energy gained", "{:.4g}", {
        "light": ("0.1 kg", "energy_excess", 0.1, 0.65, 0.03),
        "heavy": ("10 kg", "energy_excess", 10.0, 0.65, 0.03),
        "light_depth": ("", "max_penetration_frac", 0.1, 0.65, 0.03),
        "shown": ("", "energy_excess", 1.0, 1.0, 0.03)}),
}  # fmt: skip


def quality(key, model, scene, dt, steps=2000, settings=USUAL):
    """A measure of a run."""
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt)[key]


@cache
def measure(name):
    """The numbers of a bet, {MODEL_LABEL: number}, and what its reasons quote beside them."""
    numbers = {
        f"{model}_{label}": quality(key, model, contact.scene_of(0.0, y, mass), dt)
        for label, (_, key, mass, y, dt) in BETS[name][2].items()
        for model in MODELS
    }
    also = {key: eval(text, vars(contact)) for key, text in FACTS[name]["also"].items()}
    return numbers | also


def table(name, numbers):
    """The measurement of a bet as text."""
    corner, form, parts = BETS[name]
    heads = {label: head for label, (head, *_) in parts.items() if head}
    rows = {model: [numbers[f"{model}_{label}"] for label in heads] for model in MODELS}
    return columns(corner, heads.values(), rows, form)


def answer(name, numbers):
    """The one letter whose claim holds for what was measured."""
    claims = FACTS[name]["key"].items()
    (right,) = [letter for letter, claim in claims if eval(claim, {"abs": abs}, numbers)]
    return right


def asked(text):
    """What the docstring of a bet says: {task, question, choices {letter: choice}, why}."""
    _title, *task, question, choices, why, _then, _commands = text.strip().split("\n\n")
    found = re.findall(r"^    ([A-Z])  (.*(?:\n     .*)*)", choices, re.MULTILINE)
    return {
        "task": "\n\n".join(task),
        "question": " ".join(question.split()),
        "choices": {letter: " ".join(words.split()) for letter, words in found},
        "why": " ".join(why.split()),  # what the sentence should say
    }


def judge_bet(name, exercise):
    """[what, state, words, shown] of a bet: its numbers, and a word on every choice."""
    bet, file = asked(task_of(exercise)), near(exercise.__file__)
    given, why = getattr(exercise, "PREDICTION", None), str(getattr(exercise, "WHY", ""))
    choices, mine = bet["choices"], str(given).strip(" \t\n.)(").upper()
    if mine not in choices:
        made = "no prediction yet" if given is None else f"PREDICTION is {given!r}"
        words = f"{made}; write one of {', '.join(map(repr, choices))} in {file}"
        return [name, "blank", words, ""]
    if len(why.split()) < 4:
        wanted = f"write a sentence of four words or more in {file}. {bet['why']}"
        return [name, "blank", f"no reason yet: WHY is {why!r}; {wanted}", ""]
    numbers = measure(name)
    right, facts = answer(name, numbers), FACTS[name]
    so = "That is what happens." if mine == right else f"What happens is {right}: {choices[right]}"
    lines = [f"You predicted {mine}: {choices[mine]}", f"Because: {why.strip()}", "", so]
    for choice in sorted(choices, key=lambda choice: choice != right):  # the right one first
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {facts['reasons'][choice].format(**numbers)}"]
    lines += ["", facts["shown"].format(**numbers)]
    verdict = "\n".join(textwrap.fill(line, 96) for line in lines)
    return [name, "right", verdict, f"{table(name, numbers)}\n"]


# Exercise 9: five troubles against four knobs


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


@cache
def measure_knobs():
    """{trouble: [what each knob makes of it, as a share]}, and what the reasons quote."""
    quoted, shares = {}, {}
    for trouble, (model, scene, bodies, dt, steps, key, seeds) in TROUBLES.items():
        scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
        quoted[trouble], *turned = (
            statistics.fmean(quality(key, model, of, dt / by, by * steps, knobs) for of in scenes)
            for by, knobs in ((1, USUAL), *KNOBS.values())
        )
        shares[trouble] = [number / quoted[trouble] for number in turned]
        quoted |= {f"{trouble}_{k.split()[0]}": x for k, x in zip(KNOBS, shares[trouble])}
    limit = contact.critical_dt(1.0, USUAL.stiffness, contact.build_scene("stack").damping, 3)
    return shares, quoted | {"step": TROUBLES["trembling"][3], "limit": limit}


def mark(share):
    """-, = or +: what became of a trouble, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


def judge_knobs(name, exercise):
    """[what, state, words, shown] of the twenty bets."""
    lines = str(getattr(exercise, "BETS", "")).replace("\N{MINUS SIGN}", "-").splitlines()
    mine = {words[0]: words[1:] for line in lines if (words := line.split())}
    for trouble in TROUBLES:
        given = mine.get(trouble, ["nothing"])
        if len(given) != len(KNOBS) or set(given) - set("-=+"):
            row = f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}"
            words = f"{row}, allowed: four marks, each - (less), = or + (more)"
            return [name, "blank", words, ""]
    rows, hits = {}, 0
    shares, quoted = measure_knobs()
    for trouble, row in shares.items():
        pairs = [(mark(share), guess) for share, guess in zip(row, mine[trouble])]
        hits += sum(true == guess for true, guess in pairs)
        rows[trouble] = [
            f"{share:.3g} {true}" + ("" if true == guess else f" ({guess})")
            for share, (true, guess) in zip(row, pairs)
        ]
    words = f"Your bet holds in {hits} of 20; where it was another, it stands in brackets.\n"
    for trouble, reason in FACTS[name]["reasons"].items():
        words += "\n" + textwrap.fill(f"{trouble}: {reason.format(**quoted)}", 96) + "\n"
    return [name, "right", words, columns("times as much", KNOBS, rows, "{}")]
