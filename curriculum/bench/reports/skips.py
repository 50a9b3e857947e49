"""Skipping: goals, one sentence, tables and a figure."""

import statistics

from curriculum import plotting, reporting
from curriculum.bench import skips
from curriculum.reporting import Claim, Goal, listed, ms, number


def goals(section):
    """Same bytes, whole processes, memory, one step at rest, and lcp in the process against pymunk."""
    ratios = section["processes"]["ratios"]
    return [
        _bytes_goal(section["same_bytes"]),
        *(_process_goal(ratios, name) for name in skips.LIMITS),
        _memory_goal(ratios),
        _rest_goal(section["resting"]),
        _pymunk_goal(section["in_process"]),
    ]


def _bytes_goal(same):
    differing = same["differing"]
    told = (
        f"{len(differing)} of {same['runs']} pairs of runs and {same['command_lines']} pairs of "
        "command lines differ" + (f": {listed(differing[:5])}" if differing else "")
    )
    return Goal("the same bytes with and without skips", told, not differing)


def _process_goal(ratios, name):
    limit, base = skips.LIMITS[name], "rerun" if name == skips.RECORDED else "numpy"
    wanted = f"whole process, {name}: at most {limit:g} x importing {base}"
    if name not in ratios:
        return Goal(wanted, f"{base} is not installed", None)
    ratio = ratios[name]["time"]
    return Goal(
        wanted, f"{number(ratio)} x (published script: {skips.PUBLISHED[name]:g} x)", ratio <= limit
    )


def _memory_goal(ratios):
    memory = {name: ratio["memory"] for name, ratio in ratios.items() if ratio["base"] == "numpy"}
    worst = max(memory, key=memory.get)
    return Goal(
        f"peak memory: at most {skips.MEMORY_LIMIT:g} x importing numpy",
        f"{number(memory[worst])} x at most ({worst})",
        memory[worst] <= skips.MEMORY_LIMIT,
    )


def _rest_goal(resting):
    time = resting["lcp"]["median"]
    return Goal(
        f"one resting ball, lcp, every step taken: at most {1e6 * skips.REST_LIMIT:g} us a step",
        f"{number(1e6 * time)} us",
        time <= skips.REST_LIMIT,
    )


def _pymunk_goal(inside):
    wanted = "2000 steps of the drop: lcp, all recorded, no slower than pymunk, nothing read"
    if inside["missing"]:
        return Goal(wanted, inside["missing"], None)
    ours, theirs = (inside["times"][name]["median"] for name in ("lcp", skips.BARE_PEER))
    return Goal(
        wanted, f"{number(ours / theirs)} x: {ms(ours)} ms against {ms(theirs)} ms", ours <= theirs
    )


def claims(section):
    """The sentence under the figure."""
    rows = section["speed_up"]
    best, least = (
        f"{row['scene']} with {row['model']}, {row['ratio']:.2f} x"
        for row in (pick(rows, key=lambda row: row["ratio"]) for pick in (max, min))
    )
    costs = min(row["ratio"] for row in rows)
    return [
        Claim(
            costs >= 1.0,
            f"Skipping pays in every case; most on {best}, least on {least}.",
            f"Skipping pays most on {best}; where no state comes back and nothing flies, looking "
            f"for it costs time: {least}.",
        )
    ]


def page(section):
    """The whole page."""
    speed = [
        [
            row["scene"],
            row["bodies"],
            row["model"],
            row["steps"],
            ms(row["skip"]["median"]),
            ms(row["no_skip"]["median"]),
            f"{row['ratio']:.2f}",
        ]
        for row in section["speed_up"]
    ]
    processes = [
        [
            name,
            ms(statistics.median(parts["seconds"])),
            ms(min(parts["seconds"])),
            ms(max(parts["seconds"])),
            number(statistics.median(parts["memory"]) / 2**20),
        ]
        for name, parts in section["processes"]["measured"].items()
    ]
    inside = [
        [name, ms(times["median"]), ms(times["min"]), ms(times["max"])]
        for name, times in section["in_process"]["times"].items()
    ]
    resting = [
        [name, *(number(1e6 * times[key]) for key in ("median", "min", "max"))]
        for name, times in section["resting"].items()
    ]
    spread = ["median [ms]", "least [ms]", "greatest [ms]"]
    return reporting.page(
        "Skipping what a scene does not need",
        section,
        "Everything is measured in rounds of random order; ratios are ratios of medians.",
        "## Goals",
        reporting.goal_table(goals(section)),
        "![Skipping: cost and saving](skip.svg)",
        reporting.sentences(claims(section)),
        "## One run in the process, with and without skips",
        reporting.table(
            ["scene", "balls", "model", "steps", "skip [ms]", "no-skip [ms]", "speed-up"], speed
        ),
        "Of a pile the run with skips is that of the compiled twin, where numba is installed.",
        "## Whole processes",
        "Started after a first run, so Python has kept what it compiled of the imported modules, "
        "numpy's as well as the course's. contact.py itself is compiled each time, as any script.",
        reporting.table(["process", *spread, "peak memory [MiB]"], processes),
        "## One step of a ball at rest",
        reporting.table(["", "median [us]", "least [us]", "greatest [us]"], resting),
        "## 2000 steps of the drop in the process",
        reporting.table(["", *spread], inside),
    )


def figures(section):
    """{file name: SVG text}: whole processes against their limits, and what skipping saves."""
    figure, (upper, lower) = plotting.figure(
        rows=2,
        height=2.5,
        below=0.12,
        left=0.22,
        title="Skipping: what a run costs, and what it saves",
        explained="Above: shorter is better, and a bar should end before its mark. Below: longer is "
        "better.",
    )
    _processes(upper, section["processes"]["ratios"])
    _savings(lower, section["speed_up"][::-1])
    for axis in (upper, lower):
        axis.grid(axis="y", visible=False)
    return {"skip.svg": plotting.svg(figure, section)}


def _processes(axis, ratios):
    color = plotting.look("lcp")["color"]
    names = [name for name in skips.LIMITS if name in ratios][::-1]
    for row, name in enumerate(names):
        ratio, limit = ratios[name]["time"], skips.LIMITS[name]
        axis.barh(row, ratio, height=0.5, color=color)
        axis.plot([limit] * 2, [row - 0.34, row + 0.34], color=plotting.INK, lw=2.2)
        axis.text(0.05, row, f"{ratio:.2f}", color="white", va="center", fontweight="bold")
    axis.set_yticks(range(len(names)), [f"{name}" for name in names])
    axis.set(xlabel="time of a whole run / time of importing numpy (recorded: rerun)")


def _savings(axis, rows):
    for row, case in enumerate(rows):
        color = plotting.look(case["model"])["color"]
        axis.barh(
            row,
            case["ratio"],
            height=0.6,
            color=color,
        )
        axis.annotate(
            f"{case['ratio']:.1f}",
            (case["ratio"], row),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
        )
    axis.set_yticks(range(len(rows)), [f"{case['scene']}, {case['model']}" for case in rows])
    axis.margins(x=0.12)
    axis.set(xlabel="time without skips / time with skips")
