"""Other engines, set up as fairly as we know how, on the same scenes as contact.py's models.

Every engine is optional (`pip install -e '.[bench]'`); one that is missing is a row that says so.
The same for all: balls that cannot rotate, no friction, no sleeping, no threads, the scene's masses,
radii and restitution, gravity 9.81 m/s^2, and a floor along y = 0. What had to be chosen:

    mujoco        "default": solver and softness as shipped (solref 0.02 1). "stiff": solref
                  "2 dt, 5", the shortest time constant it accepts, overdamped so that its push out
                  of the floor is no rebound, and solimp 0.9999 (of three tried, the least error on
                  a tower). A ball is two slide joints. There is no restitution in it; see
                  `rebound_ratio`. CG instead of Newton for many balls: version 4.0.0's Newton fails
                  on sparse piles.
    pymunk        collision_slop 1e-5 r instead of 0.1 (made for pixels); collision_bias as shipped.
    box2d         version 2.3. The world is scaled x10, because its slop of 5 mm and its restitution
                  threshold of 1 m/s are compiled in; sleeping off body by body. 8 and 3 iterations.
    box2d3        x10 as well; restitution threshold 0, 4 substeps as its manual advises. "stiff":
                  contacts as hard as its step allows. float32, as is box2d.

A session is one world, ready to step. Its methods, in metres and seconds:

    advance(n)    n steps, nothing read: the bare cost of stepping
    trace(n)      n steps, every height read after each: the same work with what a user needs from it
    state()       (q, v), two arrays (2, N), in double precision
"""

import importlib.metadata
import importlib.util
import math
import warnings
from functools import partial
from typing import Callable, NamedTuple

import numpy as np

GRAVITY = 9.81       # m/s^2, downwards
SCALE = 10.0         # both Box2Ds see a world this much larger
FLOOR = 1000.0       # m, half the length of the floor, where an engine wants an end to it
MANY = 60            # balls: from here on MuJoCo gets CG and a sparse Jacobian


class Peer(NamedTuple):
    """One engine with one set of choices; build(scene, dt) -> a session."""
    name: str
    label: str
    package: str      # its name for pip, and for the version in the footer
    module: str
    build: Callable

    def version(self):
        """The installed version, or None when the engine is not there."""
        if importlib.util.find_spec(self.module) is None:
            return None
        return importlib.metadata.version(self.package)


class Session:
    """What the engines share. A subclass gives step() and heights(), and may have faster ways."""

    def advance(self, n):
        step = self.step
        for _ in range(n):
            step()

    def trace(self, n):
        step, heights = self.step, self.heights
        rows = [heights()]
        for _ in range(n):
            step()
            rows.append(heights())
        return rows


def rebound_ratio(restitution):
    """The damping ratio of a spring and damper that throws a ball back with `restitution` of its speed.

    e = exp(-z / s (pi - atan2(2 z s, 1 - 2 z^2))), s = sqrt(1 - z^2): the contact ends when its force
    would pull (Schwager and Poeschel 2007, linear dashpot model). Solved by bisection for 0 < e < 1.
    """
    low, high = 0.0, 0.999
    for _ in range(60):
        z = 0.5 * (low + high)
        s = math.sqrt(1.0 - z * z)
        rebound = math.exp(-z / s * (math.pi - math.atan2(2.0 * z * s, 1.0 - 2.0 * z * z)))
        low, high = (z, high) if rebound > restitution else (low, z)
    return high


class Mujoco(Session):
    """Spring and damper made implicit and convex: solref gives a time constant and a damping ratio."""

    def __init__(self, scene, dt, stiff):
        import mujoco
        from mujoco import rollout
        self.mujoco, self.rollout, self.scene = mujoco, rollout.rollout, scene
        mujoco.set_mju_user_warning(lambda text: None)      # its default writes a log file where it runs
        timeconst, ratio = (2.0 * dt, 5.0) if stiff else (0.02, 1.0)
        if scene.restitution > 0.0:
            ratio = rebound_ratio(scene.restitution)
            # the spring swings at 1 / (timeconst ratio) rad/s; 0.4 rad a step is the stiffest that works
            timeconst = dt / (0.4 * ratio) if stiff else 0.02
        solimp = ' solimp="0.9999 0.9999 0.001"' if stiff else ""
        many = len(scene.mass) >= MANY
        balls = "".join(
            f'<body pos="{x!r} 0 {y!r}">'
            '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
            f'<geom type="sphere" size="{r!r}" mass="{m!r}"/></body>'
            for x, y, r, m in zip(*scene.q0.tolist(), scene.radius.tolist(), scene.mass.tolist()))
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><size memory="{"4G" if many else "-1"}"/>'
            f'<option timestep="{dt!r}" gravity="0 0 -{GRAVITY}" solver="{"CG" if many else "Newton"}" '
            f'jacobian="{"sparse" if many else "auto"}"><flag autoreset="disable"/></option>'
            f'<default><geom condim="1" solref="{timeconst!r} {ratio!r}"{solimp}/></default>'
            f'<worldbody><geom type="plane" size="0 0 1"/>{balls}</worldbody></mujoco>')
        self.data = mujoco.MjData(self.model)
        self.full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.start = np.empty(mujoco.mj_stateSize(self.model, self.full))

    def advance(self, n):
        self.mujoco.mj_step(self.model, self.data, nstep=n)

    def trace(self, n):
        """MuJoCo's own rollout, a loop in C that keeps every state."""
        self.mujoco.mj_getState(self.model, self.data, self.start, self.full)
        states, _ = self.rollout(self.model, self.data, self.start, nstep=n)
        y0 = self.scene.q0[1]
        return np.vstack([y0, y0 + states[0, :, 2:1 + 2 * len(y0):2]])

    def state(self):
        return (self.scene.q0 + self.data.qpos.reshape(-1, 2).T, self.data.qvel.reshape(-1, 2).T.copy())


class Pymunk(Session):
    """Chipmunk: sequential impulses with cached sums, position error pushed out beside the velocity."""

    def __init__(self, scene, dt, iterations=10):
        import pymunk
        import pymunk.batch
        self.batch = pymunk.batch
        self.space = space = pymunk.Space()
        space.gravity, space.iterations, space.collision_slop = (0, -GRAVITY), iterations, 1e-6
        bounce = math.sqrt(scene.restitution)      # the engine multiplies the two bodies' values
        floor = pymunk.Segment(space.static_body, (-FLOOR, 0), (FLOOR, 0), 0)
        floor.elasticity, floor.friction = bounce, 0.0
        space.add(floor)
        if len(scene.mass) >= MANY:
            space.use_spatial_hash(2.0 * scene.radius.max(), 10 * len(scene.mass))
        self.bodies = []
        for x, y, m, r in zip(*scene.q0.tolist(), scene.mass.tolist(), scene.radius.tolist()):
            body = pymunk.Body(m, math.inf)
            body.position = x, y
            ball = pymunk.Circle(body, r)
            ball.elasticity, ball.friction = bounce, 0.0
            space.add(body, ball)
            self.bodies.append(body)
        self.step = lambda: space.step(dt)
        if len(self.bodies) == 1:
            body = self.bodies[0]
            self.heights = lambda: (body.position[1],)
        else:
            self.heights, self.buffer = self.many_heights, pymunk.batch.Buffer()

    def many_heights(self):
        """All at once, by the engine's own batch call; the floor comes last."""
        self.buffer.clear()
        self.batch.get_space_bodies(self.space, self.batch.BodyFields.POSITION, self.buffer)
        return np.frombuffer(self.buffer.float_buf())[1:-2:2].copy()

    def state(self):
        q, v = zip(*((body.position, body.velocity) for body in self.bodies))
        return np.array(q).T, np.array(v).T


class Box2d(Session):
    """Box2D 2.3: sequential impulses with warm starting, then position error removed on its own."""

    def __init__(self, scene, dt):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)     # of its binding's, on newer Pythons
            import Box2D
        self.world = world = Box2D.b2World(gravity=(0, -GRAVITY * SCALE), doSleep=False)
        floor = world.CreateStaticBody()
        floor.CreateEdgeFixture(vertices=[(-FLOOR * SCALE, 0), (FLOOR * SCALE, 0)], friction=0.0,
                                restitution=scene.restitution)
        self.bodies = []
        for x, y, m, r in zip(*scene.q0.tolist(), scene.mass.tolist(), (SCALE * scene.radius).tolist()):
            body = world.CreateDynamicBody(position=(x * SCALE, y * SCALE), fixedRotation=True,
                                           allowSleep=False)
            body.CreateCircleFixture(radius=r, density=m / (math.pi * r * r), friction=0.0,
                                     restitution=scene.restitution)
            self.bodies.append(body)
        self.step = lambda: world.Step(dt, 8, 3)
        self.heights = lambda: [body.position[1] / SCALE for body in self.bodies]

    def state(self):
        q = np.array([(b.position[0], b.position[1]) for b in self.bodies]).T / SCALE
        v = np.array([(b.linearVelocity[0], b.linearVelocity[1]) for b in self.bodies]).T / SCALE
        return q, v


class Box2d3(Session):
    """Box2D 3: soft contacts solved over small substeps, then relaxed."""

    def __init__(self, scene, dt, stiff, substeps=4):
        import pyb2d3
        self.world = world = pyb2d3.World(gravity=(0, -GRAVITY * SCALE), restitution_threshold=0.0,
                                          maximum_linear_speed=1e6)
        world.sleeping_enabled = False
        if stiff:                           # frequency [Hz], damping ratio, push-out speed
            world.set_contact_tuning(1e9, 10.0, 1e9)
        material = pyb2d3.surface_material(friction=0.0, restitution=scene.restitution)
        floor = world.create_static_body(position=(0, 0))
        floor.create_shape(pyb2d3.shape_def(material=material),
                           pyb2d3.segment((-FLOOR * SCALE, 0), (FLOOR * SCALE, 0)))
        self.bodies = pyb2d3.Bodies()
        for x, y, m, r in zip(*scene.q0.tolist(), scene.mass.tolist(), (SCALE * scene.radius).tolist()):
            body = world.create_dynamic_body(position=(x * SCALE, y * SCALE), fixed_rotation=True,
                                             enable_sleep=False)
            body.create_shape(pyb2d3.shape_def(density=m / (math.pi * r * r), material=material),
                              pyb2d3.circle(radius=r))
            self.bodies.append(body)
        self.step = lambda: world.step(dt, substeps)
        if len(scene.mass) == 1:
            self.heights = lambda: (body.position[1] / SCALE,)
        else:
            self.heights = lambda: self.bodies.get_positions()[:, 1] / SCALE

    def state(self):
        q = self.bodies.get_positions().astype(float).T / SCALE
        return q, self.bodies.get_linear_velocities().astype(float).T / SCALE


PEERS = (
    Peer("mujoco", "MuJoCo default", "mujoco", "mujoco", partial(Mujoco, stiff=False)),
    Peer("mujoco_stiff", "MuJoCo stiff", "mujoco", "mujoco", partial(Mujoco, stiff=True)),
    Peer("pymunk", "pymunk", "pymunk", "pymunk", Pymunk),
    Peer("box2d", "Box2D 2.3", "box2d", "Box2D", Box2d),
    Peer("box2d3", "Box2D 3", "pyb2d3", "pyb2d3", partial(Box2d3, stiff=False)),
    Peer("box2d3_stiff", "Box2D 3 stiff", "pyb2d3", "pyb2d3", partial(Box2d3, stiff=True)),
)
