"""What can be worked out on its own, in any process: jobs, and the counts they give.

A job: (place, subject, properties). A place is how its violations are said, such as "scene 17".
"""

import contact
from curriculum.stress import heaps, maps, mujoco_match, properties, scenes
from curriculum.stress.properties import judge
from curriculum.stress.trial import Trial


def all_jobs(quick):
    """{section: its jobs}; quick: about a hundredth of them."""
    large, small, many = (60, 100, 20) if quick else (10_000, 1_000, 10_000)
    return {
        "scenes": scene_jobs(range(large)) + scene_jobs(range(small), small=True),
        "maps": list(maps.map_jobs(quick)),
        "mujoco": list(mujoco_match.match_jobs(quick)),
        "heaps": heaps.heap_jobs(many),
    }


def scene_jobs(numbers, small=False):
    """Jobs for the random scenes with these numbers."""
    return [(f"{'small ' * small}scene {number}", (number, small), ()) for number in numbers]


def run(job):
    """(place, what judge says, what was noted) of a job."""
    place, subject, stated = job
    if not stated:
        subject = Trial(scenes.numbered_spec(*subject))
    found = judge(subject, *(stated or properties.PROPERTIES.values()))
    if not stated:
        subject.note("ran", **{model: 1 for model in subject.ran()})
    return place, found, getattr(subject, "noted", {})


def added_up(found):
    """What the results of several jobs come to.

    properties: {name: [jobs judged, comparisons, off as a share of what is allowed at worst]};
    violations: [[place, property, words]]; notes: {what was noted: {place: its numbers}}.
    """
    totals, violations, notes = {}, [], {}
    for place, judged, noted in found:
        for name, (count, share, words) in judged.items():
            total = totals.setdefault(name, [0, 0, 0.0])
            total[:] = total[0] + (count > 0), total[1] + count, max(total[2], share)
            if words:
                violations.append([place, name, words])
        for what, numbers in noted.items():
            notes.setdefault(what, {})[place] = numbers
    found = {"properties": totals, "violations": violations, "notes": notes}
    return found | {"judgements": sum(judged for judged, _, _ in totals.values())}


def ran(section):
    """{model: in how many scenes it ran}."""
    cases = section["notes"].pop("ran").values()
    return {model: sum(model in case for case in cases) for model in contact.MODELS}


def idle(section):
    """A violation [place, name, words] for each model that ran in no scene, and each property that
    judged none: what looks at nothing finds nothing.
    """
    counts = section["ran"] | {name: row[0] for name, row in section["properties"].items()}
    return [["all scenes", name, "judged 0 times"] for name, count in counts.items() if not count]


def unfinished(section):
    """Energy that unfinished sweeps of lcp add: in how many scenes, and the worst of them."""
    judged = section["properties"]["lcp_gains_energy_by_unfinished_sweeps_alone"][0]
    cases = section["notes"].get(properties.UNFINISHED, {})
    grown = {place: case["most"] / case["start"] for place, case in cases.items()}
    worst = max(grown, key=grown.get, default=None)
    return {
        "scenes": judged,
        "rises": len(cases),
        "above_start": sum(factor > 1.0 + 1e-9 for factor in grown.values()),
        "sweeps_most": max((case["sweeps"] for case in cases.values()), default=0),
        "worst": {"place": worst} | cases.get(worst, {}),
    }
