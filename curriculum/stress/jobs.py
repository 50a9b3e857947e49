"""What can be worked out on its own, in any process: jobs, and the counts they give.

A job: (place, subject, properties). A place is how its violations are said, such as "scene 17".
"""

from curriculum.stress import heaps, maps, properties, scenes
from curriculum.stress.trial import Trial


def all_jobs(quick):
    """Return {section: its jobs}; quick: about a hundredth of them."""
    large, small, many = (60, 100, 4) if quick else (8_000, 1_000, 1_000)
    return {
        "scenes": scene_jobs(range(large)) + scene_jobs(range(small), small=True),
        "heaps": heaps.heap_jobs(many),
        "maps": list(maps.map_jobs(quick)),
    }


def scene_jobs(numbers, small=False):
    """Return jobs for the random scenes with these numbers."""
    return [(f"{'small ' * small}scene {number}", (number, small), ()) for number in numbers]


def run(job):
    """Return (place, what judge says, what was noted) of a job."""
    place, subject, stated = job
    if not stated:
        subject, stated = Trial(scenes.numbered_spec(*subject)), properties.PROPERTIES.values()
    found = properties.judge(subject, *stated)
    return place, found, subject.noted


def added_up(found):
    """Return what the results of several jobs come to: (judged, notes).

    judged: a row for each property, with how many jobs it could judge, of how many numbers, how far
    off the worst was as a share of what is allowed, how many violations there are, and the first in
    words. What judged nothing is a violation. notes: {what was noted: {place: its numbers}}.
    """
    rows, notes = {}, {}
    for place, judged, noted in found:
        for name, (count, share, words) in judged.items():
            start = {"property": name, "judged": 0, "comparisons": 0, "share": 0.0}
            row = rows.setdefault(name, start | {"violations": 0, "first": None})
            row["judged"] += count > 0
            row["comparisons"] += count
            row["share"] = max(row["share"], share)
            row["violations"] += words is not None
            row["first"] = row["first"] or (words and f"{place}: {words}")
        for what, numbers in noted.items():
            notes.setdefault(what, {})[place] = numbers
    for row in rows.values():
        if not row["judged"]:
            row.update(violations=1, first="judged 0 times")
    return list(rows.values()), notes
