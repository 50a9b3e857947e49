"""Skipping, as a page: goals, one checked sentence, tables."""

import statistics

from curriculum.bench import report, skips
from curriculum.bench.report import Claim, Goal, listed, ms, number

COMMAND = "python -m curriculum.bench skip"


def goals(section):
    """Same bytes, whole processes, memory, and lcp in the process against pymunk."""
    return [_bytes_goal(section["same_bytes"]),
            *(_process_goal(section["processes"]["ratios"], name) for name in skips.LIMITS),
            _memory_goal(section["processes"]["ratios"]), _pymunk_goal(section["in_process"])]


def _bytes_goal(same):
    differing = same["differing"]
    told = f"{len(differing)} of {same['runs']} pairs of runs and {same['command_lines']} pairs of " \
           f"command lines differ" + (f": {listed(differing[:5])}" if differing else "")
    return Goal("the same bytes with and without skips", told, not differing)


def _process_goal(ratios, name):
    limit, base = skips.LIMITS[name], "rerun" if name == skips.RECORDED else "numpy"
    wanted = f"whole process, {name}: at most {limit:g} x importing {base}"
    if name not in ratios:
        return Goal(wanted, f"{base} is not installed", None)
    ratio = ratios[name]["time"]
    return Goal(wanted, f"{number(ratio)} x (published script: {skips.PUBLISHED[name]:g} x)",
                ratio <= limit)


def _memory_goal(ratios):
    memory = {name: ratio["memory"] for name, ratio in ratios.items() if ratio["base"] == "numpy"}
    worst = max(memory, key=memory.get)
    return Goal(f"peak memory: at most {skips.MEMORY_LIMIT:g} x importing numpy",
                f"{number(memory[worst])} x at most ({worst})", memory[worst] <= skips.MEMORY_LIMIT)


def _pymunk_goal(inside):
    wanted = "2000 steps of the drop: lcp, all recorded, no slower than pymunk, nothing read"
    if inside["missing"]:
        return Goal(wanted, inside["missing"], None)
    ours, theirs = (inside["times"][name]["median"] for name in ("lcp", skips.BARE_PEER))
    return Goal(wanted, f"{number(ours / theirs)} x: {ms(ours)} ms against {ms(theirs)} ms",
                ours <= theirs)


def claims(section):
    """The sentence under the figure."""
    rows = section["speed_up"]
    best, least = (f"{row['scene']} with {row['model']}, {row['ratio']:.2f} x"
                   for row in (pick(rows, key=lambda row: row["ratio"]) for pick in (max, min)))
    costs = min(row["ratio"] for row in rows)
    return [Claim(costs >= 1.0, f"Skipping pays in every case; most on {best}, least on {least}.",
                  f"Skipping pays most on {best}; where no state comes back and nothing flies, looking "
                  f"for it costs time: {least}.")]


def page(section):
    """The whole page."""
    speed = [[row["scene"], row["bodies"], row["model"], row["steps"], ms(row["skip"]["median"]),
              ms(row["no_skip"]["median"]), f"{row['ratio']:.2f}"] for row in section["speed_up"]]
    processes = [[name, ms(statistics.median(parts["seconds"])), ms(min(parts["seconds"])),
                  ms(max(parts["seconds"])), number(statistics.median(parts["memory"]) / 2**20)]
                 for name, parts in section["processes"]["measured"].items()]
    inside = [[name, ms(times["median"]), ms(times["min"]), ms(times["max"])]
              for name, times in section["in_process"]["times"].items()]
    spread = ["median [ms]", "least [ms]", "greatest [ms]"]
    return report.page(
        "Skipping what a scene does not need", COMMAND, section,
        "Everything is interleaved in rounds of one run; ratios are ratios of medians.",
        "## Goals", report.goal_table(goals(section)), "![Skipping: cost and saving](skip.svg)",
        report.sentences(claims(section)), "## One run in the process, with and without skips",
        report.table(["scene", "balls", "model", "steps", "skip [ms]", "no-skip [ms]", "speed-up"], speed),
        "## Whole processes",
        report.table(["process", *spread, "peak memory [MiB]"], processes),
        "## 2000 steps of the drop in the process", report.table(["", *spread], inside))
