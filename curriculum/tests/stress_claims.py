"""Plant faults into the copy of the code in this folder, and see which claims name them.

Standard input: {fault: [old, new, property, claims that must name it]}, as JSON. Prints a line of
JSON each: [fault, the claims that did not name it].
"""

import importlib
import itertools
import json
import re
import sys
from pathlib import Path

OWN_CODE = "an_impact_alone_returns_e_of_the_speed"  # judges lcp and soft by lines of their own


def loaded(texts, old, new):
    """The modules of the stress test, over {file: text} in which `new` stands in place of `old`."""
    if sum(text.count(old) for text in texts.values()) != 1:
        raise LookupError(f"not once in the code: {old!r}")
    for file, text in texts.items():
        file.write_text(text.replace(old, new), "utf-8")
    for name in [name for name in sys.modules if name.split(".")[0] in ("contact", "curriculum")]:
        del sys.modules[name]
    names = "properties", "jobs", "maps", "mujoco_match", "heaps"
    return [importlib.import_module(f"curriculum.stress.{name}") for name in names]


def judged(modules, count, wanted):
    """(property, subject) of small scenes, maps, matches and a heap; `wanted` alone, if any."""
    properties, jobs, maps, match, heaps = modules
    order = ("heap 0", heaps.Heap(0), [heaps.leapfrog_is_of_second_order])
    others = itertools.chain(maps.map_jobs(True), match.match_jobs(True), [order])
    scenes = jobs.scene_jobs(range(count), small=True)
    for _, subject, stated in itertools.chain(
        scenes, () if wanted in properties.PROPERTIES else others
    ):
        if not stated:
            subject = jobs.Trial(jobs.scenes.numbered_spec(*subject))
        for each in stated or properties.PROPERTIES.values():
            if wanted in (None, each.__name__):
                yield each, subject


def claimed(modules, count, wanted=None):
    """(claim without its numbers, whether it holds)."""
    properties = modules[0]
    for each, subject in judged(modules, count, wanted):
        with properties.np.errstate(all="ignore"):
            for words, *claim in each(subject):
                kind = re.sub(r"(?<= )[0-9]\S*", "#", words)
                if each.__name__ != OWN_CODE:
                    kind = re.sub("penalty|lcp|leapfrog|soft", "a model", kind)
                row = [0, 0.0, None]
                properties.compare(row, "", *claim)
                yield f"{each.__name__}: {kind}", row[2] is None


def unnamed(texts, old, new, wanted, *kinds):
    """Those of the kinds of claims that do not name the fault."""
    try:
        modules = loaded(texts, old, new)
    except LookupError as error:
        return [str(error)]
    missing = {f"{wanted}: {kind}" for kind in kinds}
    for kind, holds in claimed(modules, 300 if wanted in modules[0].PROPERTIES else 0, wanted):
        missing -= {kind} if not holds else set()
        if not missing:
            break
    return sorted(missing)


if __name__ == "__main__":
    sys.path[0] = str(Path.cwd())
    files = Path("contact.py").resolve(), Path("curriculum/exact.py").resolve()
    sound = {file: file.read_text("utf-8") for file in files}
    for fault, planted in json.load(sys.stdin).items():
        print(json.dumps([fault, unnamed(sound, *planted)]), flush=True)
