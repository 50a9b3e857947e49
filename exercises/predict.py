"""What the exercises share: ask, wait for a choice, measure, compare. Nothing to fill in here."""

import os
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import contact  # noqa: E402
from curriculum.common import shell  # noqa: E402
from curriculum.common.arguments import Parser, number  # noqa: E402
from curriculum.common.stoppable import stoppable  # noqa: E402


def meta(name):
    """The facts of an exercise from meta.yaml: answer, hints, reasons, bands."""
    from curriculum.quoted import load_meta
    try:
        return load_meta()["exercises"][name]
    except ModuleNotFoundError as error:
        print(f"{error.name} is missing: {shell.install('PyYAML pytest')}", file=sys.stderr)
        raise SystemExit(2) from None


def quality(scene, dt, steps, models=("penalty", "lcp")):
    """{model: contact_quality} of each model's run of the scene."""
    return {model: contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)
            for model in models}


def unreadable(file, error):
    """One line on why an exercise's file cannot be read as Python."""
    line, trace = getattr(error, "lineno", None), error.__traceback__
    while line is None and trace is not None:
        if trace.tb_frame.f_code.co_filename.endswith(os.path.basename(file)):
            line = trace.tb_lineno
        trace = trace.tb_next
    name = getattr(error, "name", None)
    if isinstance(error, NameError) and name is not None and len(name) == 1:
        return f'{file}, line {line}: {name} needs quotes around it: "{name}"'
    return f"{file}, line {line}: {type(error).__name__}: {getattr(error, 'msg', error)}"


def one_line(kind, error, trace):
    """In place of a traceback, for a name that Python does not know in an exercise's file."""
    script = os.path.basename(sys.argv[0])
    if issubclass(kind, NameError) and script.startswith("ex"):
        print(unreadable(os.path.join("exercises", script), error), file=sys.stderr, flush=True)
        os._exit(2)
    sys.__excepthook__(kind, error, trace)


sys.excepthook = one_line


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    lines = [f"{corner:<16}" + "".join(f"{head:>14}" for head in heads)]
    lines += [f"{name:<16}" + "".join(f"{form.format(value):>14}" for value in values)
              for name, values in rows.items()]
    return "\n".join(lines)


def chosen(exercise):
    """The learner's letter, however it was typed; None before a choice."""
    given = exercise.PREDICTION
    return given.strip(" \t\n.)(").upper() if isinstance(given, str) else given


def missing(exercise):
    """What is still to be done before the run, or None."""
    file, choices = os.path.relpath(exercise.__file__), ", ".join(map(repr, exercise.CHOICES))
    if exercise.PREDICTION is None:
        return f"no prediction yet: in {file} set PREDICTION to one of {choices} and say WHY"
    if chosen(exercise) not in exercise.CHOICES:
        return f"PREDICTION in {file}: given {exercise.PREDICTION!r}, allowed: {choices}"
    if not str(exercise.WHY).strip():
        return f"no reason yet: set WHY in {file}. {exercise.WHY_PROMPT}"
    return None


def asked(exercise):
    """The question and the choices, as text."""
    lines = [textwrap.fill(exercise.QUESTION, 96), ""]
    for letter, choice in exercise.CHOICES.items():
        lines.append(textwrap.fill(f"  {letter}  {choice}", 96, subsequent_indent="     "))
    return "\n".join(lines)


def verdict(name, exercise, runs):
    """What the learner reads after the run: the prediction first, then every other choice."""
    from curriculum.quoted import Numbers
    facts, numbers, choices = meta(name), Numbers(runs=runs), exercise.CHOICES
    answer, mine = facts["answer"], chosen(exercise)
    right = "That is what happens."
    if mine != answer:
        right = textwrap.fill(f"What happens is {answer}: {choices[answer]}", 96)
    lines = [textwrap.fill(f"You predicted {mine}: {choices[mine]}", 96),
             textwrap.fill(f"Because: {str(exercise.WHY).strip()}", 96), "", right]
    for choice in [answer] + [each for each in choices if each != answer]:
        reason = numbers.render(facts["reveal"][choice])
        word = "Why" if choice == answer else "Why not"
        lines += ["", textwrap.fill(f"{word} {choice}: {reason}", 96)]
    return "\n".join(lines)


def parse(name, argv=None, **switches):
    """The command line of an exercise, with more switches {name: help}. A hint is printed here."""
    hints = meta(name)["hints"]
    parser = Parser(description=f"Exercise {name}.")
    parser.add_argument("--hint", type=number(int, low=1, high=len(hints)), metavar="N",
                        help=f"print hint N, 1 to {len(hints)}, and do nothing else")
    for switch, said in switches.items():
        parser.add_argument(f"--{switch}", action="store_true", help=said)
    args = parser.parse_args(argv)
    if args.hint:
        print(f"hint {args.hint} of {len(hints)}: {hints[args.hint - 1]}")
    return args


@stoppable
def play(name, exercise, argv=None):
    """Ask; refuse before a choice; then measure, show, explain. Returns the exit status."""
    if parse(name, argv).hint:
        return 0
    todo = missing(exercise)
    if todo:
        print(asked(exercise), flush=True)
        print(f"\n{todo}", file=sys.stderr)
        return 2
    runs = exercise.measure()
    print(exercise.table(runs), verdict(name, exercise, runs), sep="\n\n")
    print(f"\nnext: {follow_up(name)}")
    return 0


def follow_up(name):
    """The command of the exercise after this one."""
    files = sorted(Path(__file__).parent.glob("ex[0-9]_*.py"))
    later = [file for file in files if file.name[:3] > name]
    return shell.python(str(later[0] if later else ROOT / "checks.py"), extra="learn")
