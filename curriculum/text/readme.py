"""The README's generated blocks: what contact.py prints, and what was measured.

A block stands between `<!-- generated: NAME by COMMAND -->` and `<!-- end -->`. COMMAND is a call
of contact.py, whose output is shown, or `python -m curriculum.text --write`, which asks the room
that measured for its Markdown (MAKERS). The gate fails where a block is
out of date.
"""

import re
from importlib import import_module

from curriculum.text.cache import cached
from curriculum.text.references import run_contact
from curriculum.text.regions import ROOT

README = ROOT / "README.md"
BLOCK = re.compile(
    r"(?P<head><!-- generated: (?P<name>[\w-]+) by (?P<command>[^>]*?) -->\n).*?(?=<!-- end -->)",
    re.DOTALL,
)
MAKERS = {"bench": "curriculum.bench.report", "stress": "curriculum.stress.report"}
PASSING = ("metrics:", "next", "estimated")  # lines that name files, or depend on what is there


def make(name: str, command: str) -> str:
    """The text of one block, made now. Raises ValueError where that cannot be."""
    if command.startswith("python contact.py"):
        flags = command.split()[2:]
        printed = cached(f"readme-{name}", flags, lambda: run_contact(flags))["stdout"]
        lines = [line for line in printed.splitlines() if not line.startswith(PASSING)]
        return "```text\n" + "\n".join(lines).strip("\n") + "\n```\n"
    if name not in MAKERS:
        raise ValueError(f"no generated block {name!r}; there are: {', '.join(MAKERS)}")
    try:
        return import_module(MAKERS[name]).readme().strip("\n") + "\n"
    except (KeyError, TypeError) as error:
        raise ValueError(f"{name}: results of another form ({error!r})") from None


def fill(text: str) -> str:
    """The text with all its blocks made anew."""
    return BLOCK.sub(lambda match: match["head"] + make(match["name"], match["command"]), text)
