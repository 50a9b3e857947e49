"""soft against the real engine: how far contact.py and MuJoCo are apart.

MuJoCo's balls slide along x and z without turning, all contacts have condim 1, Euler's integrator.
By default its solver stops early, up to 7e-4 m from its own answer; here its tolerance is 0.
"""

from typing import NamedTuple

import numpy as np

import contact
from curriculum.stress.jobs import row

OPTIONS = 'tolerance="0" iterations="1000" ls_iterations="200"'
DTS = (0.0005, 0.002, 0.008, 0.016)
GAP = 0.005  # m between the balls of a stack
CURVES = (0.0, 0.95, 0.001, 0.5, 2.0), (0.9, 0.95, 0.0, 0.5, 2.0), (0.2, 0.9, 0.005, 0.4, 2.5)
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


def engine_run(case):
    """q and v (steps + 1, 2, N) of MuJoCo."""
    import mujoco

    solref, solimp = (" ".join(map(repr, values)) for values in case.knobs())
    places = zip(*case.scene.q0.tolist(), case.scene.radius.tolist(), case.scene.mass.tolist())
    balls = "".join(
        f'<body pos="{x!r} 0 {y!r}"><joint type="slide" axis="1 0 0"/>'
        f'<joint type="slide" axis="0 0 1"/><geom type="sphere" size="{r!r}" mass="{m!r}"/></body>'
        for x, y, r, m in places
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{case.dt!r}" gravity="0 0 {contact.GRAVITY}" {OPTIONS}/>'
        f'<default><geom condim="1" solref="{solref}" solimp="{solimp}"/></default>'
        f'<worldbody><geom type="plane" size="0 0 1"/>{balls}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    q, v = np.empty((2, case.steps + 1, *case.scene.q0.shape))
    for k in range(case.steps + 1):
        q[k] = case.scene.q0 + data.qpos.reshape(-1, 2).T
        v[k] = data.qvel.reshape(-1, 2).T
        mujoco.mj_step(model, data)
    return q, v


def apart_in_a_step(case, q, v):
    """The farthest [m, m/s] that one step of soft ends from MuJoCo's, both from its own states."""
    off = np.zeros(2)
    for k in range(0, case.steps, STRIDE):
        balls = contact.make_balls(case.scene._replace(q0=q[k], v0=v[k]))
        contact.soft_step(balls, case.dt, *case.knobs())
        ends = np.reshape(contact.state_of(balls), (-1, 4)).T
        apart = np.abs(ends - np.concatenate((q[k + 1], v[k + 1])))
        off = np.maximum(off, (apart[:2].max(), apart[2:].max()))
    return off.tolist()


def compare(case):
    """How far both are apart: in one step [m, m/s], and in a run of their own [m]."""
    q, v = engine_run(case)
    settings = contact.Settings(solref=case.solref, solimp=case.solimp)
    run = contact.run_model("soft", case.scene, case.dt, case.steps, settings)
    return *apart_in_a_step(case, q, v), float(np.abs(run.q - q).max())


def cases():
    """What has to match: every kind of scene, step, mass and setting.

    Balls that start exactly in touch are left out: they fall as one, the last bit of a gap decides
    whether there is a contact, and with d0 > 0 a contact begins with a jump of its force.
    """
    drop, bounce, stack = map(contact.build_scene, ("drop", "bounce", "stack"))
    pile = contact.build_scene("pile", bodies=8)
    stack.q0[1] += GAP * np.arange(3)
    for dt in DTS:
        yield Case("drop", drop, dt)
        yield Case("bounce, direct solref", bounce, dt)
        yield Case("stack of 3, 5 mm apart", stack, dt)
        yield Case("pile of 8", pile, dt, 300)
    for mass, steps in (((10.0, 1.0, 0.1), 2000), ((0.1, 1.0, 10.0), 300)):
        scene = stack._replace(mass=np.array(mass))
        yield Case(f"stack of {mass} kg", scene, 0.002, steps)
    for solref in ((-5000.0, -100.0), (0.05, 0.5)):
        yield Case(f"stack, solref {solref}", stack, 0.002, solref=solref)
    for solimp in CURVES:
        yield Case(f"stack, solimp {solimp}", stack, 0.002, solimp=solimp)


def match_jobs(quick):
    """A job for every case; quick: every fourth. None where MuJoCo is not installed."""
    try:
        import mujoco  # noqa: F401
    except ImportError:
        return []
    return [("mujoco_match:run", k) for k in range(0, len(list(cases())), 4 if quick else 1)]


def run(number):
    """The judgement of one case."""
    case = list(cases())[number]
    step_q, step_v, free_q = compare(case)
    ok = step_q <= STEP_LIMIT[0] and step_v <= STEP_LIMIT[1] and free_q <= FREE_LIMIT
    expected = f"a step within {STEP_LIMIT} m, m/s; a run within {FREE_LIMIT} m"
    got = f"{step_q:.1e} m, {step_v:.1e} m/s; {free_q:.1e} m"
    return {"rows": [row(f"{case.what}, dt {case.dt:g}, {case.steps} steps", expected, got, ok)]}
