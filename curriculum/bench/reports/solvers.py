"""The complementarity problem alone: a table, the residual over time, and a performance profile."""

from curriculum import plotting, reporting
from curriculum.bench.solvers import TARGETS
from curriculum.reporting import Claim, listed, ms

FAMILIES = {  # name before the comma: how it is drawn
    "sweeps": dict(plotting.look("lcp"), label="lcp's sweeps, plain"),
    "compiled sweeps": dict(
        plotting.look("lcp"), ls=(0, (2, 2)), markerfacecolor="none", label="the same, compiled"
    ),
    "MuJoCo's dual": dict(plotting.look("mujoco"), label="MuJoCo's PGS"),
    "pivot of exact": dict(plotting.look("exact"), label="exact's pivot"),
    "quadprog": dict(plotting.look("pymunk"), label="quadprog"),
    "nnls": dict(plotting.look("soft"), label="nnls (scipy)"),
    "nnls on Cholesky": dict(plotting.look("penalty"), label="nnls on Cholesky"),
    "Lemke (Drake)": dict(plotting.look("drake"), label="Lemke (Drake)"),
}
LEAST = 1e-18  # m/s: a residual of exactly zero is drawn here


def family(solver):
    return solver.split(",")[0]


def reached(section, target):
    """{family: {case: least time [s] to a residual of at most target, None if it is not reached}}."""
    found = {}
    for row in section["rows"]:
        times = found.setdefault(family(row["solver"]), {case: None for case in section["cases"]})
        if row["residual"] is not None and row["residual"] <= target:
            old = times[row["case"]]
            times[row["case"]] = row["median"] if old is None else min(old, row["median"])
    return found


def goals(section):
    """None is asked for here."""
    return []


def claims(section):
    fine = reached(section, TARGETS[1])
    cases = list(section["cases"])
    for case in cases[-1:]:
        times = {name: found[case] for name, found in fine.items() if found[case] is not None}
        if times:
            best = min(times, key=times.get)
            yield Claim(
                True,
                f"To {TARGETS[1]:g} m/s on the {case}, {best} is the fastest, "
                f"{ms(times[best])} ms.",
            )
        late = [name for name, found in fine.items() if found[case] is None]
        yield Claim(bool(late), f"Not reached there: {listed(late)}.")
    short = [case for case in cases if fine.get("sweeps", {}).get(case) is None]
    yield Claim(
        bool(short),
        f"Ten thousand sweeps do not reach it on: {listed(short)}.",
        "Ten thousand sweeps reach it everywhere.",
    )


def page(section):
    """The whole page."""
    names = dict.fromkeys(family(row["solver"]) for row in section["rows"])
    tables = []
    for target in TARGETS:
        found = reached(section, target)
        rows = [[name, *(ms(found[name][case]) for case in section["cases"])] for name in names]
        tables += [
            f"Least time [ms] to a residual of {target:g} m/s, - where it is not reached:",
            reporting.table(["", *section["cases"]], rows),
        ]
    failed = sorted(
        {
            f"{family(row['solver'])} on the {row['case']}: {row['failed']}"
            for row in section["rows"]
            if row["failed"]
        }
    )
    about = [
        [case, told["balls"], told["contacts"], told["rank"]]
        for case, told in section["cases"].items()
    ]
    missing = sorted({f"{family(name)}: {what}" for name, what in section["missing"].items()})
    return reporting.page(
        "The complementarity problem alone",
        section,
        "`lam >= 0, w = W lam + b >= 0, lam w = 0`, of one step of 2 ms of balls at rest. The residual "
        "max |min(lam, w)| is computed by the benchmark from the impulses alone. Forming W or a model "
        "is not timed. MuJoCo's problem is softened by 1e-4 of the diagonal, so its residual has a "
        "floor of that origin.",
        "![Time against residual](solvers.svg)",
        reporting.sentences(claims(section)),
        reporting.table(["problem", "balls", "contacts", "rank of W"], about),
        *tables,
        f"Failed: {'; '.join(failed)}." if failed else "",
        f"Left out: {'; '.join(missing)}." if missing else "",
    )


def figures(section):
    """{file name: SVG text}."""
    cases = [
        max(
            (c for c in section["cases"] if c.startswith(kind)),
            key=lambda c: section["cases"][c]["contacts"],
        )
        for kind in ("tower", "pile")
    ]
    figure, axes = plotting.figure(
        rows=3,
        height=2.7,
        below=0.75,
        title="Time against residual, without the rest of the step",
        explained="Left and down is better. Lines: 1 to 10,000 sweeps. Below: the share of the "
        f"problems that each solves to {TARGETS[1]:g} m/s within a multiple of the best time.",
    )
    for axis, case in zip(axes, cases):
        for name, look in FAMILIES.items():
            rows = [
                row
                for row in section["rows"]
                if row["case"] == case
                and family(row["solver"]) == name
                and row["residual"] is not None
            ]
            if rows:
                axis.plot(
                    [max(row["residual"], LEAST) for row in rows],
                    [row["median"] * 1e3 for row in rows],
                    **look,
                )
        axis.set(
            xscale="log", yscale="log", title=case, xlabel="residual [m/s]", ylabel="time [ms]"
        )
    _profile(axes[2], section)
    plotting.legend_below(axes[2], columns=3, of=axes[0], down=0.25)
    return {"solvers.svg": plotting.svg(figure, section)}


def _profile(axis, section):
    """Dolan and More (2002): the share of problems solved within tau times the best time."""
    found, cases = reached(section, TARGETS[1]), list(section["cases"])
    best = {
        case: min((times[case] for times in found.values() if times[case]), default=None)
        for case in cases
    }
    for name, times in found.items():
        ratios = sorted(times[case] / best[case] for case in cases if times[case])
        if ratios:
            x, y = [1.0], [0.0]
            for k, ratio in enumerate(ratios, 1):
                x, y = [*x, ratio, ratio], [*y, y[-1], k / len(cases)]
            look = {key: value for key, value in FAMILIES[name].items() if key != "label"}
            axis.plot([*x, 1e4], [*y, y[-1]], **{**look, "marker": ""})
    axis.set(
        xscale="log",
        xlim=(1.0, 1e4),
        ylim=(0.0, 1.03),
        ylabel="share of problems",
        xlabel="time, as a multiple of the fastest",
        title="Performance profile",
    )
