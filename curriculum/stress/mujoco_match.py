"""soft against the real engine: how far contact.py and MuJoCo are apart.

    python -m curriculum.stress.mujoco_match      needs mujoco; writes curriculum/stress/results

MuJoCo's balls slide along x and z without turning, and all contacts have condim 1. By default its
solver stops early, up to 7e-4 m from its own answer on a falling stack; here its tolerance is 0.
"""

import itertools
import sys
from typing import NamedTuple

import numpy as np

import contact
from curriculum import measured, reporting
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable

COMMAND = "python -m curriculum.stress.mujoco_match"
FOLDER = measured.ROOT / "curriculum" / "stress" / "results"
OPTIONS = 'tolerance="0" iterations="1000" ls_iterations="200"'
DTS = (0.0005, 0.002, 0.008, 0.016)
GAP = 0.005  # m between the balls of a stack
SOFT_START = (0.0, 0.95, 0.001, 0.5, 2.0)  # MuJoCo raises the first to 0.0001
STEP_LIMIT, FREE_LIMIT = (1e-14, 1e-12), 1e-11  # m and m/s of one step; m of a run
STRIDE = 20  # every so manieth state is stepped from


class Case(NamedTuple):
    """A run to be made by both. None stands for MuJoCo's defaults."""

    what: str
    scene: contact.Scene
    dt: float
    steps: int = 2000
    solref: tuple | None = None
    solimp: tuple | None = None

    def knobs(self):
        """solref and solimp as both get them."""
        return contact.soft_defaults(self.scene.restitution, self.dt, self.solref, self.solimp)


def engine_of(case):
    """MuJoCo's model and data of a case."""
    import mujoco

    solref, solimp = case.knobs()
    numbers = [" ".join(map(repr, values)) for values in (solref, solimp)]
    balls = "".join(
        f'<body pos="{x!r} 0 {y!r}"><joint type="slide" axis="1 0 0"/>'
        f'<joint type="slide" axis="0 0 1"/><geom type="sphere" size="{r!r}" mass="{m!r}"/></body>'
        for x, y, r, m in zip(
            *case.scene.q0.tolist(), case.scene.radius.tolist(), case.scene.mass.tolist()
        )
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{case.dt!r}" gravity="0 0 {contact.GRAVITY}" {OPTIONS}/>'
        f'<default><geom condim="1" solref="{numbers[0]}" solimp="{numbers[1]}"/></default>'
        f'<worldbody><geom type="plane" size="0 0 1"/>{balls}</worldbody></mujoco>'
    )
    return model, mujoco.MjData(model)


def engine_run(case):
    """q and v (steps + 1, 2, N) of MuJoCo."""
    import mujoco

    model, data = engine_of(case)
    data.qvel[:] = case.scene.v0.T.ravel()
    q = np.empty((case.steps + 1, *case.scene.q0.shape))
    v = np.empty(q.shape)
    for k in range(case.steps + 1):
        q[k] = case.scene.q0 + data.qpos.reshape(-1, 2).T
        v[k] = data.qvel.reshape(-1, 2).T
        mujoco.mj_step(model, data)
    return q, v


def apart_in_a_step(case, q, v):
    """The farthest [m, m/s] that one step of soft ends from MuJoCo's, both from its own states."""
    balls, knobs = contact.make_balls(case.scene), case.knobs()
    starts = range(0, case.steps, STRIDE)
    ends = []
    for k in starts:
        contact.set_state(balls, np.vstack((q[k], v[k])).T)
        contact.soft_step(balls, case.dt, *knobs)
        ends.append(contact.state_of(balls))
    ends = np.reshape(ends, (len(ends), -1, 4)).transpose(0, 2, 1)
    after = np.array(starts) + 1
    return (
        float(np.abs(ends[:, :2] - q[after]).max()),
        float(np.abs(ends[:, 2:] - v[after]).max()),
    )


def compare(case):
    """What a row of the table shows."""
    q, v = engine_run(case)
    run = contact.run_model(
        "soft", case.scene, case.dt, case.steps, solref=case.solref, solimp=case.solimp
    )
    step_q, step_v = apart_in_a_step(case, q, v)
    return {
        "what": case.what,
        "dt": case.dt,
        "steps": case.steps,
        "step_q": step_q,
        "step_v": step_v,
        "free_q": float(np.abs(run.q - q).max()),
    }


def lifted(name, bodies=None, gap=0.0, mass=None):
    """A scene of the chapter, its balls apart by `gap` [m]; masses repeat."""
    scene = contact.build_scene(name, bodies=bodies)
    count = len(scene.mass)
    scene.q0[1] += gap * np.arange(count)
    return scene._replace(mass=np.resize(np.array(mass or (1.0,)), count))


def cases():
    """What has to match: every kind of scene, step, mass and setting."""
    drop, bounce = lifted("drop"), lifted("bounce")
    stack, pile = lifted("stack", 3, GAP), lifted("pile", 8)
    for dt in DTS:
        yield Case("drop", drop, dt)
        yield Case("bounce, direct solref", bounce, dt)
        yield Case("stack of 3, 5 mm apart", stack, dt)
        yield Case("pile of 8", pile, dt, 300)
    for mass in (0.1, 10.0):
        yield Case(f"drop of {mass:g} kg", lifted("drop", mass=(mass,)), 0.002)
    yield Case("stack of 10, 1 and 0.1 kg", lifted("stack", 3, GAP, (10.0, 1.0, 0.1)), 0.002)
    yield Case("stack of 0.1, 1 and 10 kg", lifted("stack", 3, GAP, (0.1, 1.0, 10.0)), 0.002, 300)
    for solref in ((-5000.0, -100.0), (0.05, 0.5)):
        for name, scene in (("drop", drop), ("stack", stack)):
            yield Case(f"{name}, solref {words(solref)}", scene, 0.002, solref=solref)
    for solimp in (
        SOFT_START,
        (0.5, 0.99, 0.01, 0.3, 3.0),
        (0.9, 0.95, 0.0, 0.5, 2.0),
        (0.2, 0.9, 0.005, 0.7, 1.0),
        (0.2, 0.9, 0.005, 0.4, 2.5),
    ):
        for name, scene in (("drop", drop), ("stack", stack)):
            yield Case(f"{name}, solimp {words(solimp)}", scene, 0.002, solimp=solimp)


def touching_cases():
    """What does not match in a free run: stacks whose balls start exactly in touch."""
    for solimp, dt in itertools.product((None, SOFT_START), DTS):
        for bodies in (3, 10):
            d0 = contact.SOLIMP[0] if solimp is None else 0.0001
            yield Case(
                f"stack of {bodies} in touch, d0 {d0:g}", lifted("stack", bodies), dt, solimp=solimp
            )


def words(values):
    """Numbers as a model file has them."""
    return " ".join(f"{value:g}" for value in values)


def rows(found):
    """The table of some rows."""
    exponents = [[f"{row[key]:.1e}" for key in ("step_q", "step_v", "free_q")] for row in found]
    return reporting.table(
        ["run", "dt [s]", "steps", "one step [m]", "[m/s]", "free run [m]"],
        [
            [row["what"], f"{row['dt']:g}", row["steps"], *numbers]
            for row, numbers in zip(found, exponents)
        ],
    )


def page(section):
    """The report, from its results alone."""
    match, touch = section["match"], section["touch"]
    worst = {key: max(row[key] for row in match) for key in ("step_q", "step_v", "free_q")}
    goals = [
        reporting.Goal(
            "one step from the engine's own state: at most 1e-14 m and 1e-12 m/s",
            f"{worst['step_q']:.1e} m, {worst['step_v']:.1e} m/s",
            worst["step_q"] <= STEP_LIMIT[0] and worst["step_v"] <= STEP_LIMIT[1],
        ),
        reporting.Goal(
            "free runs: at most 1e-11 m", f"{worst['free_q']:.1e} m", worst["free_q"] <= FREE_LIMIT
        ),
    ]
    return reporting.page(
        "soft against MuJoCo",
        section,
        "`contact.py --contact soft` beside the engine that it rebuilds. Balls that slide along x "
        "and z, condim 1, Euler; options " + section["options"] + ". One step: every "
        f"{STRIDE}th of the engine's own states is stepped by both. Free run: both start alike, "
        "and the farthest that any ball is apart at any step. The default tolerance of the engine "
        "would stop its solver before its own answer is reached.",
        reporting.goal_table(goals),
        rows(match),
        "## The limit of the match",
        "Balls that start exactly in touch fall as one, their gaps stay at the last bit, and that "
        "bit decides whether there is a contact. With d0 above 0 the force of a contact jumps when "
        "it begins, so the last bit decides about a force, and two programs that round differently "
        "part, although every single step agrees. A d0 of 0 would remove the jump; the engine "
        "raises it to 0.0001, which makes the jump smaller. Balls that start 5 mm apart (above) "
        "match to the end.",
        rows(touch),
    )


@stoppable
def main():
    """Measure, write the results section and its page. Returns the exit status."""
    try:
        import mujoco
    except ImportError:
        print("mujoco is missing: pip install mujoco", file=sys.stderr)
        return 2
    section = {
        "options": OPTIONS,
        "engine": mujoco.__version__,
        "match": [compare(case) for case in cases()],
        "touch": [compare(case) for case in touching_cases()],
    }
    section = measured.save(FOLDER, "mujoco_match", section, COMMAND, ("contact.py",), ("mujoco",))
    write_whole(str(FOLDER / "mujoco_match.md"), page(section))
    print(FOLDER / "mujoco_match.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
