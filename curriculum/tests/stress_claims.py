"""Plant faults into the copy of the code in this folder, and see which claims name them.

Arguments: faults of SEEN in faults/stress.py. Prints a line of JSON each: [fault, the claims that
did not name it].
"""

import importlib
import json
import re
import sys
from pathlib import Path

from curriculum.tests.faults.stress import SEEN

OWN_CODE = "an_impact_alone_returns_e_of_the_speed"  # judges each model by lines of its own


def loaded(texts, old, new):
    """The module of jobs, over {file: text} in which `new` stands in place of `old`."""
    if sum(text.count(old) for text in texts.values()) != 1:
        raise LookupError(f"not once in the code: {old!r}")
    for file, text in texts.items():
        file.write_text(text.replace(old, new), "utf-8")
    for name in [name for name in sys.modules if name.split(".")[0] in ("contact", "curriculum")]:
        del sys.modules[name]
    return importlib.import_module("curriculum.stress.jobs")


def judged(jobs, count, wanted):
    """(property, subject) of small scenes, the map, matches and a heap; `wanted` alone, if any."""
    laws = jobs.properties.PROPERTIES
    if wanted is None or wanted in laws:
        for _, spec, _ in jobs.scene_jobs(range(count), small=True):
            subject = jobs.Trial(jobs.scenes.numbered_spec(*spec))
            yield from ((law, subject) for name, law in laws.items() if wanted in (None, name))
    if wanted not in laws:
        todo = [*jobs.maps.map_jobs(True), *jobs.mujoco_match.match_jobs(True)]
        todo.append(("heap 0", jobs.heaps.Heap(0), [jobs.heaps.leapfrog_is_of_second_order]))
        for _, subject, stated in todo:
            yield from ((law, subject) for law in stated if wanted in (None, law.__name__))


def claimed(jobs, count, wanted=None):
    """(claim without its numbers, whether it holds)."""
    for law, subject in judged(jobs, count, wanted):
        with jobs.properties.np.errstate(all="ignore"):
            for words, *claim in law(subject):
                kind = re.sub(r"(?<= )[0-9]\S*", "#", words)
                if law.__name__ != OWN_CODE:
                    kind = re.sub("penalty|lcp|leapfrog|soft", "a model", kind)
                row = [0, 0.0, None]
                jobs.properties.compare(row, "", *claim)
                yield f"{law.__name__}: {kind}", row[2] is None


def unnamed(texts, old, new, wanted, *kinds):
    """Those of the kinds of claims that do not name the fault."""
    try:
        jobs = loaded(texts, old, new)
    except LookupError as error:
        return [str(error)]
    missing = {f"{wanted}: {kind}" for kind in kinds}
    for kind, holds in claimed(jobs, 300, wanted):
        missing -= {kind} if not holds else set()
        if not missing:
            break
    return sorted(missing)


if __name__ == "__main__":
    files = Path("contact.py").resolve(), Path("curriculum/exact.py").resolve()
    sound = {file: file.read_text("utf-8") for file in files}
    for fault in sys.argv[1:]:
        print(json.dumps([fault, unnamed(sound, *SEEN[fault])]), flush=True)
