"""results/exact.md, made from the section `exact` of results.json alone."""

from statistics import median

from curriculum import measured
from curriculum.reporting import Claim, Goal, goal_table, number, page, sentences, table

OVERLAP, RISE, TOWER = 1e-10, 1e-12, 1e-9  # r, of the start's energy, r
SOON = 10.0  # s of CPU time for a second of the tall tower


def whole_page(section):
    """The page exact.md."""
    return page(
        "exact in piles and towers",
        section,
        _about(section),
        goal_table(goals(section)),
        _summary(section),
        "## Piles",
        _piles(section),
        "## When a run parts from the same run in 80 bits",
        _parting(section),
        "## Cost beside the first edition",
        _cost(section),
        "## Towers",
        _towers(section),
        "## Two hundred balls",
        _wide(section),
    )


def goals(section):
    """What was asked for, and what came out."""
    piles, wide = section["exact-pile"], section["exact-wide"]
    worst = [max(row[name] for row in piles) for name in ("overlap", "rise")]
    same = sum(row["same_bits"] for row in piles)
    errors = [row["error"] for row in section["exact-towers"]]
    good = sum(error <= TOWER for error in errors)
    tall = max(row["seconds"] for row in section["exact-tall"])
    steps = min(row["steps"] for row in wide)
    return [
        Goal("every pile ends", f"{len(piles)} did", not section["died"]),
        Goal(
            f"no overlap above {OVERLAP:g} r at a sample", f"{worst[0]:.1e} r", worst[0] <= OVERLAP
        ),
        Goal(
            f"the energy never rises by {RISE:g} of the start's",
            f"{worst[1]:.1e}",
            worst[1] <= RISE,
        ),
        Goal(
            "the same states sampled every 8 ms and every 1 ms",
            f"the same bits in {same} of {len(piles)}",
            same == len(piles),
        ),
        Goal(
            f"towers of unequal masses within {TOWER:g} r of 120 digits",
            f"{good} of {len(errors)}",
            good == len(errors),
        ),
        Goal(f"a second of a tall tower within {SOON:g} s", f"{number(tall)} s", tall <= SOON),
        Goal(
            "pile of 200: 300 steps of 2 ms in a minute",
            f"{steps} steps in {number(wide[0]['spent'])} s",
            steps >= 300,
        ),
    ]


def readme_block(section):
    """One paragraph for the README."""
    link = "[curriculum/stress/results/exact.md](curriculum/stress/results/exact.md)"
    return f"{_summary(section)} Piles, towers and their cost: {link}."


def _summary(section):
    """The piles in two sentences."""
    piles, (parted, judged) = section["exact-pile"], _parted(section)
    overlap, rise = (max(row[name] for row in piles) for name in ("overlap", "rise"))
    most = max(row["count"] for row in piles)
    short = len(_not_followed([row for row in piles if "parts" in row]))
    whole = judged - len(parted) - short
    return sentences(
        [
            f"In {len(piles)} piles of 3 to {most} balls over 4 s exact overlaps by {overlap:.1e} r "
            f"and gains {rise:.1e} of the energy at most.",
            Claim(
                judged > 0,
                f"{judged} of them were run in 80 bits as well: {whole} stay within 1e-8 r of that to "
                f"the end, {short} as far as 80 bits were followed, and {len(parted)} part "
                f"({_earliest(parted)}).",
            ),
        ]
    )


def _not_followed(rows):
    """The runs in 80 bits that had too many events, and had not parted until then."""
    return [row for row in rows if row["parts"] is None and row["precise_until"] < 4.0]


def _about(section):
    """What the page is about, and what was left out."""
    seeds = len({row["seed"] for row in section["exact-pile"]})
    return sentences(
        [
            f'build_scene("pile") with {seeds} seeds for every number of balls and restitution e, '
            "4 s of motion; seconds are of CPU time, with two processes at work.",
            Claim(not section["no_80_bits"], "", section["no_80_bits"] + "."),
            Claim(not section["died"], "", f"Did not end: {measured.listed(section['died'])}."),
        ]
    )


def _groups(rows, *names):
    """{values of these names: rows}, in the order of their values."""
    keys = sorted({tuple(row[name] for name in names) for row in rows})
    return {key: [row for row in rows if tuple(row[n] for n in names) == key] for key in keys}


def _parted(section):
    """The piles that 80 bits part from the doubles in, and how many were judged."""
    judged = [row for row in section["exact-pile"] if "parts" in row]
    return [row for row in judged if row["parts"] is not None], len(judged)


def _earliest(parted):
    if not parted:
        return "none parts"
    return f"the first parts at {number(min(row['parts'] for row in parted))} s"


def _range(values):
    """Median (least to greatest), to two digits."""
    middle, low, high = (number(f(values), 2) for f in (median, min, max))
    return f"{middle} ({low} to {high})"


def _whole(values):
    """Median (least to greatest) of counts."""
    return f"{median(values):,.0f} ({min(values):,} to {max(values):,})"


def _piles(section):
    """The table of piles."""
    head = ["balls", "e", "events", "CPU / s", "overlap / r", "rise of the energy", "same bits"]
    rows = []
    for (count, e), found in _groups(section["exact-pile"], "count", "restitution").items():
        rows.append(
            [
                count,
                e,
                _whole([row["events"] for row in found]),
                _range([row["seconds"] for row in found]),
                f"{max(row['overlap'] for row in found):.1e}",
                f"{max(row['rise'] for row in found):.1e}",
                f"{sum(row['same_bits'] for row in found)} of {len(found)}",
            ]
        )
    said = (
        "Events and seconds: median (least to greatest) over the seeds; overlap and rise of the "
        "energy, as a share of the start's: the greatest at any sample. Same bits: sampling every "
        "8 ms gives the bits of every eighth sample of 1 ms."
    )
    return f"{table(head, rows)}\n{said}"


def _parting(section):
    """The table of distances from the run in 80 bits, and when each run parts."""
    judged = [row for row in section["exact-pile"] if "parts" in row]
    if not judged:
        return section["no_80_bits"] or "Not measured."
    head = [
        "balls",
        "e",
        "within 1e-8 r",
        "these at the end / r",
        "the others part at / s",
        "CPU / s",
    ]
    rows = []
    for (count, e), found in _groups(judged, "count", "restitution").items():
        near = [row for row in found if row["parts"] is None]
        times = sorted(row["parts"] for row in found if row["parts"] is not None)
        rows.append(
            [
                count,
                e,
                f"{len(near)} of {len(found)}",
                f"{max(row['apart'] for row in near):.1e}" if near else "-",
                ", ".join(number(time) for time in times) or "-",
                _range([row["precise_seconds"] for row in found]),
            ]
        )
    return f"{table(head, rows)}\n{_notes(judged)}{_parted_table(section)}"


def _notes(judged):
    """What the run in 80 bits is, how far it went, and whether the clock had a part in it."""
    short = _not_followed(judged)
    waits = [row for row in judged if row["parts"] is not None and row["waits"] is not None]
    early = [row for row in waits if row["waits"] <= row["parts"]]
    return sentences(
        [
            "The same source with 80 bit numbers (64 bits of mantissa) and tolerances 2^-11 times "
            "as large (`curriculum/stress/precise_exact.py`): what a run in doubles is off by from "
            "it is rounding, and what tolerances let go, grown by each impact.",
            Claim(
                not short,
                "",
                f"Not followed to 4 s in 80 bits: {len(short)} runs of too many events, the "
                f"shortest to {number(min((r['precise_until'] for r in short), default=0))} s.",
            ),
            Claim(
                not early,
                "In none of the runs that part had exact's clock made events wait by then.",
                f"In {len(early)} of the runs that part exact's clock may have made events wait by "
                "then, which moves the balls too.",
            ),
            "In 80 bits the energy rises by "
            f"{max(row['precise_rise'] for row in judged):.1e} of the start's at most.",
        ]
    )


def _parted_table(section):
    """One row for each run that parts, and what a jump means."""
    parted = [
        [row["count"], row["restitution"], row["seed"], number(row["parts"])]
        + [f"{row[name]:.1e}" for name in ("before", "apart")]
        for row in _parted(section)[0]
    ]
    head = ["balls", "e", "seed", "parts at / s", "1 ms before: apart / r", "then / r"]
    note = (
        "Where the distance jumps within 1 ms, an order of impacts has changed. Where it grows from "
        "sample to sample, it is chaos, or a small difference of speeds from before, which a "
        "tolerance can decide: a contact that parts so slowly that its bounce would rise less than "
        "LAST stays closed in doubles, and opens for some microseconds in 80 bits."
    )
    return f"\n\n{table(head, parted)}\n{note}" if parted else ""


def _cost(section):
    """Seconds of CPU beside the first edition's code."""
    first = [row for row in section.get("exact-first", []) if "seconds" in row]
    if not first:
        return f"Not measured: commit {section['first_edition']} is not at hand."
    rows = []
    for (count, e), old in _groups(first, "count", "restitution").items():
        seeds = {row["seed"] for row in old}
        new = [
            row
            for row in section["exact-pile"]
            if (row["count"], row["restitution"]) == (count, e) and row["seed"] in seeds
        ]
        seconds = [sum(row["seconds"] for row in side) / len(side) for side in (new, old)]
        events = [sum(row["events"] for row in side) / len(side) for side in (new, old)]
        rows.append(
            [
                count,
                e,
                f"{events[0]:,.0f}",
                number(seconds[0]),
                number(1e3 * seconds[0] / events[0]),
                f"{events[1]:,.0f}",
                number(seconds[1]),
                number(seconds[0] / seconds[1], 2),
            ]
        )
    head = ["balls", "e", "events", "CPU / s", "ms an event"]
    head += ["first edition: events", "CPU / s", "CPU, new / old"]
    said = (
        f"Means over {len({row['seed'] for row in first})} seeds. The first edition, commit "
        f"{section['first_edition']}, ran at dt 2 ms; where balls slide it held each force for a "
        "sample. Its events are of all balls at once, today's of the balls that touch one another."
    )
    return f"{table(head, rows)}\n{said}"


def _towers(section):
    """Unequal masses, and tall towers."""
    rows = []
    for (spread,), found in _groups(section["exact-towers"], "spread").items():
        good = [row["error"] for row in found if row["error"] <= TOWER]
        others = [_missed(row) for row in found if row["error"] > TOWER]
        rows.append(
            [
                f"10^-{spread:g} to 10^{spread:g}",
                f"{len(good)} of {len(found)}",
                f"{max(good, default=0.0):.1e}",
                ", ".join(others) or "-",
            ]
        )
    head = ["masses", f"within {TOWER:g} r", "these / r", "the others: seed"]
    tall = [
        [row["count"], row["restitution"], f"{row['events']:,}", number(row["seconds"])]
        for row in section["exact-tall"]
    ]
    said = (
        "Towers of 2 to 10 balls with and without gaps: the worst height error over a second, "
        "against a simulation in 120 digits (`curriculum/stress/precise_tower.py`). Where balls "
        "part at speeds that a double cannot keep beside 1 m/s, it takes an impact for simultaneous "
        "that strikes them one after the other: how much hangs on that is said beside it. Below: "
        "one second of a tower of equal balls with gaps of 0.1 r."
    )
    return (
        f"{table(head, rows)}\n{said}\n\n{table(['balls', 'e', 'events in 1 s', 'CPU / s'], tall)}"
    )


def _missed(row):
    """A tower that doubles miss, and how far 80 bits come."""
    precise = row.get("precise_error")
    also = "" if precise is None else f", in 80 bits {precise:.1e} r"
    hangs = row.get("hangs_on")
    also += "" if hangs is None else f"; {hangs:.1e} r hang on speeds below 1e-12 m/s"
    return f"{row['seed']} ({row['error']:.1e} r{also})"


def _wide(section):
    """How far a pile of 200 comes."""
    said = []
    for row in section["exact-wide"]:
        said.append(
            f"A pile of 200 balls has done {row['steps']} of 300 steps of 2 ms after "
            f"{number(row['spent'])} s of CPU time and {row['events']:,} events."
        )
    return sentences(said)
