"""What can be worked out on its own, on any process or machine: jobs, and the counts they give."""

from importlib import import_module

import curriculum.stress.exact_properties  # noqa: F401 (registers what it states)
from curriculum.stress import properties, scenes
from curriculum.stress.claims import PROPERTIES, judge
from curriculum.stress.trial import Trial

BATCH = 25  # scenes to a job


def run(job):
    """The result of a job: ("module of curriculum.stress:function", its argument)."""
    module, name = job[0].split(":")
    return getattr(import_module(f"curriculum.stress.{module}"), name)(job[1])


def row(what, expected, got, ok):
    """A judgement of a map or an extreme, as plain values."""
    return {"what": what, "expected": expected, "got": got, "ok": bool(ok)}


def scene_jobs(count, small=False):
    """Jobs for the scenes numbered 0 to count - 1."""
    spans = [(start, min(start + BATCH, count), small) for start in range(0, count, BATCH)]
    return [("jobs:judge_span", span) for span in spans]


def judge_span(span):
    """What the properties say of the scenes numbered start to stop - 1, given (start, stop, small).

    properties: {name: [scenes judged, comparisons, off as a share of what is allowed at worst]};
    violations: [[scene, property, words]]; notes: {what was met: [[scene, its numbers]]}.
    """
    start, stop, small = span
    found = {"scenes": stop - start, "violations": [], "notes": {}}
    found["properties"] = {name: [0, 0, 0.0] for name in PROPERTIES}
    for number in range(start, stop):
        trial = Trial(scenes.numbered_spec(number, small))
        for name, (count, share, words) in judge(trial).items():
            total = found["properties"][name]
            total[:] = total[0] + (count > 0), total[1] + count, max(total[2], share)
            if words:
                found["violations"].append([f"{'small ' * small}scene {number}", name, words])
        for what, numbers in trial.noted.items():
            found["notes"].setdefault(what, []).append([number, numbers])
    return found


def added_up(found):
    """One result of several of judge_span."""
    totals = {name: [0, 0, 0.0] for name in PROPERTIES}
    for each in found:
        for name, (judged, count, share) in each["properties"].items():
            total = totals[name]
            total[:] = total[0] + judged, total[1] + count, max(total[2], share)
    notes = {}
    for each in found:
        for what, cases in each["notes"].items():
            notes.setdefault(what, []).extend(cases)
    return {
        "scenes": sum(each["scenes"] for each in found),
        "judgements": sum(judged for judged, _, _ in totals.values()),
        "properties": totals,
        "violations": [violation for each in found for violation in each["violations"]],
        "notes": {what: len(cases) for what, cases in sorted(notes.items())},
        "unfinished": unfinished(notes.get(properties.UNFINISHED, []), totals),
    }


def unfinished(cases, stated):
    """Energy that unfinished sweeps of lcp add: in how many scenes, and the worst of them."""
    name = "lcp_gains_energy_by_unfinished_sweeps_alone"
    counts = {"scenes": stated[name][0], "rises": len(cases)}
    counts["above_start"] = sum(case["gained"] > 1e-9 * case["start"] for _, case in cases)
    if cases:
        number, worst = max(cases, key=lambda case: case[1]["gained"] / case[1]["start"])
        most = worst["start"] + worst["gained"]
        counts["worst"] = {"scene": number, "start": worst["start"], "most": most}
        counts["sweeps_most"] = max(case["sweeps"] for _, case in cases)
    return counts
