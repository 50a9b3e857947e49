"""Other engines, each as its own experts would set it up, on the scenes of contact.py's models.

**To send a better setting, add one line to SETTINGS below**: the benchmark runs every line, draws
the front of all settings of an engine, and names the best. Nothing else has to change.

Every engine is optional (`pip install -e '.[bench]'`); one that is missing is a row that says so.
The same for all: balls that cannot rotate, no friction, no sleeping, no threads, the scene's
masses, radii and restitution, gravity 9.81 m/s^2, and a floor along y = 0. A ball of infinite
mass is one that nothing moves. What had to be chosen:

    mujoco    solref: a time constant and a damping ratio, or, both negative, a stiffness and a
              damping given directly. "0 -(1+e)/dt" with solimp near 1 is Newton's impact law:
              the ball leaves with e times the speed it came with (its documentation shows the case
              e = 1). A stiffness of beta / dt^2 beside it pushes overlaps out, as Baumgarte does.
              A ball is two slide joints. CG instead of Newton for many balls: version 4.0.0's
              Newton fails on sparse piles.
    pymunk    iterations; bias, the share of an overlap that is left after a second. Its slop is
              1e-5 r instead of 0.1, which was made for pixels.
    box2d     version 2.3: velocity and position iterations. The world is scaled x10, since its slop
              of 5 mm and its restitution threshold of 1 m/s are compiled in; sleeping is off body
              by body. float32.
    box2d3    substeps, and the frequency [Hz] of its soft contacts (30 as shipped; it never gets
              stiffer than a quarter of the substep rate). x10 as well, threshold 0. float32.
    drake     point contact. "discrete": its convex solver at a fixed step; "CENIC": the same solver
              under error control; "RK3": an explicit integrator under error control on a stiff
              spring. It has no coefficient of restitution, so it runs where e is 0 (strong
              dissipation) or 1 (none), and says so elsewhere.

A session is one world, ready to step. Its methods, in metres and seconds:

    advance(n)    n steps, nothing read: the bare cost of stepping
    trace(n)      n steps, every height read after each: the same work with what a user needs from it
    states(n)     n steps, q and v after each, as arrays (n + 1, 2, N) in double precision
    state()       (q, v), two arrays (2, N)
"""

import importlib.metadata
import importlib.util
import math
import warnings
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

GRAVITY = 9.81  # m/s^2, downwards
SCALE = 10.0  # both Box2Ds see a world this much larger
FLOOR = 1000.0  # m, half the length of the floor, where an engine wants an end to it
MANY = 60  # balls: from here on MuJoCo gets CG and a sparse Jacobian


class Session:
    """What the engines share. A subclass gives step(), heights() and state()."""

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

    def states(self, n):
        rows = [self.state()]
        for _ in range(n):
            self.advance(1)
            rows.append(self.state())
        q, v = (np.array(part) for part in zip(*rows))
        return q, v


def balls_of(scene):
    """(x, y, vx, vy, mass, radius, fixed) of every ball, as plain floats."""
    rows = (*scene.q0.tolist(), *scene.v0.tolist(), scene.mass.tolist(), scene.radius.tolist())
    return [(*row, math.isinf(row[4])) for row in zip(*rows)]


def scaled_balls_of(scene):
    """(place, velocity, radius, density, fixed) of every ball in the world that a Box2D sees."""
    for x, y, vx, vy, mass, radius, fixed in balls_of(scene):
        r = radius * SCALE
        density = 1.0 if fixed else mass / (math.pi * r * r)
        yield (x * SCALE, y * SCALE), (vx * SCALE, vy * SCALE), r, density, fixed


# MuJoCo


def shipped(scene, dt):
    """solref and solimp as MuJoCo ships them: no restitution."""
    return "0.02 1", "0.9 0.95 0.001 0.5 2"


def standard(timeconst, ratio, d, scene, dt):
    """A time constant of so many steps and a damping ratio, at impedance d."""
    return f"{timeconst * dt!r} {ratio!r}", f"{d!r} {d!r} 0.001"


def direct(beta, d, scene, dt):
    """Stiffness beta / dt^2 and damping (1 + e) / dt, given directly, at impedance d.

    MuJoCo divides them by d^2 and d, so that the speed turns into exactly -e times itself.
    """
    return f"{-beta / dt**2!r} {-(1.0 + scene.restitution) / dt!r}", f"{d!r} {d!r} 0.001"


def first_edition(scene, dt):
    """How the first edition of this benchmark set MuJoCo up, not knowing of the direct form."""
    timeconst, ratio = 2.0 * dt, 5.0
    if scene.restitution > 0.0:
        ratio = rebound_ratio(scene.restitution)
        timeconst = dt / (0.4 * max(ratio, 1e-3))
    return f"{timeconst!r} {ratio!r}", "0.9999 0.9999 0.001"


def rebound_ratio(restitution):
    """Damping ratio of a spring and damper that throws a ball back with `restitution` of its speed.

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
    """Spring and damper made implicit and convex. `contact(scene, dt)` gives solref and solimp."""

    def __init__(
        self,
        scene,
        dt,
        contact,
        integrator="Euler",
        flags="",
        tolerance=1e-8,
        solver=None,
        iterations=100,
        margin=0.0,
    ):
        import mujoco
        from mujoco import rollout

        self.mujoco, self.rollout, self.scene = mujoco, rollout.rollout, scene
        mujoco.set_mju_user_warning(
            lambda text: None
        )  # its default writes a log file where it runs
        solref, solimp = contact(scene, dt)
        many = len(scene.mass) >= MANY
        solver = solver or ("CG" if many else "Newton")
        self.moving = [k for k, ball in enumerate(balls_of(scene)) if not ball[6]]
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><size memory="{"4G" if many else "-1"}"/>'
            f'<option timestep="{dt!r}" gravity="0 0 -{GRAVITY}" solver="{solver}" '
            f'jacobian="{"sparse" if many else "auto"}" integrator="{integrator}" '
            f'tolerance="{tolerance!r}" iterations="{iterations}"><flag autoreset="disable"{flags}/></option>'
            f'<default><geom condim="1" solref="{solref}" solimp="{solimp}" margin="{margin!r}"/>'
            f"</default>"
            f'<worldbody><geom type="plane" size="0 0 1"/>'
            f"{''.join(map(self.body, balls_of(scene)))}</worldbody></mujoco>"
        )
        self.data = mujoco.MjData(self.model)
        self.data.qvel[:] = scene.v0[:, self.moving].T.ravel()
        self.full = mujoco.mjtState.mjSTATE_FULLPHYSICS
        self.start = np.empty(mujoco.mj_stateSize(self.model, self.full))

    @staticmethod
    def body(ball):
        x, y, _, _, mass, radius, fixed = ball
        joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        return (
            f'<body pos="{x!r} 0 {y!r}">{"" if fixed else joints}'
            f'<geom type="sphere" size="{radius!r}" mass="{1.0 if fixed else mass!r}"/></body>'
        )

    def advance(self, n):
        self.mujoco.mj_step(self.model, self.data, nstep=n)

    def rolled(self, n):
        """MuJoCo's own rollout, a loop in C that keeps every state: time, positions, velocities."""
        self.mujoco.mj_getState(self.model, self.data, self.start, self.full)
        return self.rollout(self.model, self.data, self.start, nstep=n)[0][0]

    def trace(self, n):
        y0 = self.scene.q0[1, self.moving]
        return np.vstack([y0, y0 + self.rolled(n)[:, 2 : 1 + 2 * len(y0) : 2]])

    def states(self, n):
        count, start = len(self.moving), self.state()
        rows = self.rolled(n)
        q, v = (np.repeat(part[None], n + 1, axis=0) for part in start)
        moves, speeds = (rows[:, 1 + k * 2 * count : 1 + (k + 1) * 2 * count] for k in (0, 1))
        q[1:, :, self.moving] = self.scene.q0[:, self.moving] + moves.reshape(
            n, count, 2
        ).transpose(0, 2, 1)
        v[1:, :, self.moving] = speeds.reshape(n, count, 2).transpose(0, 2, 1)
        return q, v

    def state(self):
        q, v = self.scene.q0.copy(), self.scene.v0.copy()
        q[:, self.moving] += self.data.qpos.reshape(-1, 2).T
        v[:, self.moving] = self.data.qvel.reshape(-1, 2).T
        return q, v

    def forces(self):
        """{(upper, lower): normal force [N]}, balls by number, the floor as -1."""
        found, force = {}, np.zeros(6)
        for k in range(self.data.ncon):
            self.mujoco.mj_contactForce(self.model, self.data, k, force)
            a, b = (int(geom) - 1 for geom in self.data.contact[k].geom)
            found[max(a, b), min(a, b)] = float(force[0])
        return found


# pymunk


class Pymunk(Session):
    """Chipmunk: sequential impulses with cached sums, position error pushed out beside the velocity."""

    def __init__(self, scene, dt, iterations=10, bias=None):
        import pymunk
        import pymunk.batch

        self.batch, self.dt = pymunk.batch, dt
        self.space = space = pymunk.Space()
        space.gravity, space.iterations, space.collision_slop = (0, -GRAVITY), iterations, 1e-6
        if bias is not None:
            space.collision_bias = bias
        bounce = math.sqrt(scene.restitution)  # the engine multiplies the two bodies' values
        floor = pymunk.Segment(space.static_body, (-FLOOR, 0), (FLOOR, 0), 0)
        floor.elasticity, floor.friction = bounce, 0.0
        space.add(floor)
        if len(scene.mass) >= MANY:
            space.use_spatial_hash(2.0 * scene.radius.max(), 10 * len(scene.mass))
        self.bodies = []
        for x, y, vx, vy, mass, radius, fixed in balls_of(scene):
            body = (
                pymunk.Body(body_type=pymunk.Body.STATIC) if fixed else pymunk.Body(mass, math.inf)
            )
            body.position, body.velocity = (x, y), (vx, vy)
            ball = pymunk.Circle(body, radius)
            ball.elasticity, ball.friction = bounce, 0.0
            space.add(body, ball)
            self.bodies.append(body)
        self.step = partial(space.step, dt)
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

    def forces(self):
        """{(upper, lower): normal force [N]} of the last step."""
        number, found = {body: k for k, body in enumerate(self.bodies)}, {}

        def told(arbiter, mine):
            others = [number.get(shape.body, -1) for shape in arbiter.shapes]
            pair = sorted({mine, *others} if -1 in others else others, reverse=True)
            found[tuple(pair)] = arbiter.total_impulse.length / self.dt

        for k, body in enumerate(self.bodies):
            body.each_arbiter(told, k)
        return found


# Box2D


class Box2d(Session):
    """Box2D 2.3: sequential impulses with warm starting, then position error removed on its own."""

    def __init__(self, scene, dt, iterations=(8, 3)):
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", DeprecationWarning
            )  # of its binding's, on newer Pythons
            import Box2D
        self.dt = dt
        self.world = world = Box2D.b2World(gravity=(0, -GRAVITY * SCALE), doSleep=False)
        floor = world.CreateStaticBody()
        floor.CreateEdgeFixture(
            vertices=[(-FLOOR * SCALE, 0), (FLOOR * SCALE, 0)],
            friction=0.0,
            restitution=scene.restitution,
        )
        self.bodies = []
        for place, velocity, r, density, fixed in scaled_balls_of(scene):
            body = (
                world.CreateStaticBody(position=place)
                if fixed
                else world.CreateDynamicBody(
                    position=place, fixedRotation=True, allowSleep=False, linearVelocity=velocity
                )
            )
            body.CreateCircleFixture(
                radius=r, density=density, friction=0.0, restitution=scene.restitution
            )
            self.bodies.append(body)
        self.step = partial(world.Step, dt, *iterations)
        self.heights = lambda: [body.position[1] / SCALE for body in self.bodies]

    def state(self):
        q = np.array([(b.position[0], b.position[1]) for b in self.bodies]).T / SCALE
        v = np.array([(b.linearVelocity[0], b.linearVelocity[1]) for b in self.bodies]).T / SCALE
        return q, v

    def forces(self):
        """{(upper, lower): normal force [N]} of the last step."""
        number, found = {body: k for k, body in enumerate(self.bodies)}, {}
        for touch in self.world.contacts:
            if touch.touching:
                pair = (number.get(touch.fixtureA.body, -1), number.get(touch.fixtureB.body, -1))
                impulse = touch.manifold.points[0].normalImpulse
                found[max(pair), min(pair)] = impulse / self.dt / SCALE
        return found


class Box2d3(Session):
    """Box2D 3: soft contacts solved over small substeps, then relaxed."""

    def __init__(self, scene, dt, substeps, hertz):
        import pyb2d3

        self.world = world = pyb2d3.World(
            gravity=(0, -GRAVITY * SCALE), restitution_threshold=0.0, maximum_linear_speed=1e6
        )
        world.sleeping_enabled = False
        if hertz is not None:  # frequency [Hz], damping ratio, push-out speed
            world.set_contact_tuning(hertz, 10.0, 1e9)
        material = pyb2d3.surface_material(friction=0.0, restitution=scene.restitution)
        floor = world.create_static_body(position=(0, 0))
        floor.create_shape(
            pyb2d3.shape_def(material=material),
            pyb2d3.segment((-FLOOR * SCALE, 0), (FLOOR * SCALE, 0)),
        )
        self.bodies = pyb2d3.Bodies()
        for place, velocity, r, density, fixed in scaled_balls_of(scene):
            body = (
                world.create_static_body(position=place)
                if fixed
                else world.create_dynamic_body(
                    position=place,
                    fixed_rotation=True,
                    enable_sleep=False,
                    linear_velocity=velocity,
                )
            )
            body.create_shape(
                pyb2d3.shape_def(density=density, material=material), pyb2d3.circle(radius=r)
            )
            self.bodies.append(body)
        self.step = partial(world.step, dt, substeps)
        if len(scene.mass) == 1:
            self.heights = lambda: (body.position[1] / SCALE,)
        else:
            self.heights = lambda: self.bodies.get_positions()[:, 1] / SCALE

    def state(self):
        q = self.bodies.get_positions().astype(float).T / SCALE
        return q, self.bodies.get_linear_velocities().astype(float).T / SCALE


# Drake


class Drake(Session):
    """Compliant point contact. scheme None: its discrete solver; else an integrator and its accuracy."""

    def __init__(self, scene, dt, scheme=None, accuracy=1e-5, stiffness=1e8):
        import logging

        from pydrake.geometry import HalfSpace, Sphere
        from pydrake.math import RigidTransform
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.multibody.tree import PlanarJoint, SpatialInertia
        from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
        from pydrake.systems.framework import DiagramBuilder

        logging.getLogger("drake").setLevel(logging.ERROR)
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0 if scheme else dt)
        plant.mutable_gravity_field().set_gravity_vector([0.0, -GRAVITY, 0.0])
        skin = self.skin(scene, stiffness, scheme, dt)
        normal = RigidTransform(HalfSpace.MakePose([0.0, 1.0, 0.0], [0.0, 0.0, 0.0]))
        plant.RegisterCollisionGeometry(plant.world_body(), normal, HalfSpace(), "floor", skin)
        self.scene, self.dt, self.joints = scene, dt, []
        for k, (x, y, vx, vy, mass, radius, fixed) in enumerate(balls_of(scene)):
            if fixed:
                plant.RegisterCollisionGeometry(
                    plant.world_body(),
                    RigidTransform([x, y, 0.0]),
                    Sphere(radius),
                    f"ball {k}",
                    skin,
                )
                continue
            body = plant.AddRigidBody(f"ball {k}", SpatialInertia.SolidSphereWithMass(mass, radius))
            plant.RegisterCollisionGeometry(
                body, RigidTransform(), Sphere(radius), f"ball {k}", skin
            )
            joint = plant.AddJoint(
                PlanarJoint(f"joint {k}", plant.world_frame(), body.body_frame())
            )
            self.joints.append((k, joint, (x, y), (vx, vy)))
        plant.Finalize()
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for _, joint, place, speed in self.joints:
            joint.set_translation(self.context, place)
            joint.set_translational_velocity(self.context, speed)
        if scheme:
            ResetIntegratorFromFlags(self.simulator, scheme, 0.1)
            self.simulator.get_mutable_integrator().set_target_accuracy(accuracy)
        self.simulator.Initialize()
        self.time = 0

    @staticmethod
    def skin(scene, stiffness, scheme, dt):
        """Stiffness and dissipation of every surface: none for e = 1, strong for e = 0."""
        from pydrake.geometry import AddContactMaterial, ProximityProperties
        from pydrake.multibody.plant import CoulombFriction

        skin = ProximityProperties()
        AddContactMaterial(
            dissipation=0.0 if scene.restitution == 1.0 else 1e3,
            point_stiffness=2.0 * stiffness,  # two surfaces in series: half of it
            friction=CoulombFriction(0.0, 0.0),
            properties=skin,
        )
        if scheme is None or scheme == "cenic":
            skin.AddProperty("material", "relaxation_time", 0.0 if scene.restitution == 1.0 else dt)
        return skin

    def advance(self, n):
        self.time += n
        self.simulator.AdvanceTo(self.time * self.dt)

    def step(self):
        self.advance(1)

    def heights(self):
        return [joint.get_translation(self.context)[1] for _, joint, _, _ in self.joints]

    def state(self):
        q, v = self.scene.q0.copy(), self.scene.v0.copy()
        for k, joint, _, _ in self.joints:
            q[:, k] = joint.get_translation(self.context)
            v[:, k] = joint.get_translational_velocity(self.context)
        return q, v


def no_coefficient(scene):
    """Why Drake does not run a scene, or None."""
    if 0.0 < scene.restitution < 1.0:
        return "has no coefficient of restitution, only a dissipation"
    return None


def too_slow(scene):
    """Why Drake's explicit integrator does not run a scene, or None."""
    if scene.name == "stack":
        return "an explicit integrator takes seconds to minutes a run on stacked stiff springs"
    return no_coefficient(scene)


# what is measured


class Setting(NamedTuple):
    """One engine with one set of choices; build(scene, dt) -> a session."""

    engine: str  # a key of ENGINES
    words: str  # the setting, for a reader
    build: Callable
    adaptive: bool = False  # it chooses its own steps, so dt is only how often it is looked at
    refuses: Callable = lambda scene: None  # why it does not run a scene, or None
    substeps: int = 1  # of each step that is asked for


ENGINES = {  # label, package on PyPI, module
    "mujoco": ("MuJoCo", "mujoco", "mujoco"),
    "pymunk": ("pymunk", "pymunk", "pymunk"),
    "box2d": ("Box2D 2.3", "box2d", "Box2D"),
    "box2d3": ("Box2D 3", "pyb2d3", "pyb2d3"),
    "drake": ("Drake", "drake", "pydrake"),
}
SHIPPED_BIAS = 0.9**60  # pymunk's own


def in_substeps(words, substeps, hertz=None):
    """A setting of Box2D 3."""
    build = partial(Box2d3, substeps=substeps, hertz=hertz)
    return Setting("box2d3", words, build, substeps=substeps)


SETTINGS = (
    Setting("mujoco", "as shipped", partial(Mujoco, contact=shipped)),
    Setting(
        "mujoco",
        "first edition: 2 dt, ratio 5 or by rebound, d 0.9999",
        partial(Mujoco, contact=first_edition),
    ),
    Setting(
        "mujoco",
        "time constant 2 dt, ratio 1, d 0.9999",
        partial(Mujoco, contact=partial(standard, 2.0, 1.0, 0.9999)),
    ),
    Setting(
        "mujoco", "direct, no push, d 0.99", partial(Mujoco, contact=partial(direct, 0.0, 0.99))
    ),
    Setting(
        "mujoco", "direct, no push, d 0.9999", partial(Mujoco, contact=partial(direct, 0.0, 0.9999))
    ),
    Setting(
        "mujoco",
        "direct, push 0.2, d 0.9999",
        partial(Mujoco, contact=partial(direct, 0.2, 0.9999)),
    ),
    Setting(
        "mujoco",
        "direct, no push, d 0.9999, speculative",
        partial(Mujoco, contact=partial(direct, 0.0, 0.9999), flags=' speculative="enable"'),
    ),
    Setting(
        "mujoco",
        "direct, no push, d 0.9999, discrete",
        partial(Mujoco, contact=partial(direct, 0.0, 0.9999), integrator="discrete"),
    ),
    Setting("pymunk", "10 iterations", Pymunk),
    Setting("pymunk", "30 iterations", partial(Pymunk, iterations=30)),
    Setting("pymunk", "100 iterations", partial(Pymunk, iterations=100)),
    Setting(
        "pymunk",
        "10 iterations, bias 0.2 a step",
        lambda scene, dt: Pymunk(scene, dt, bias=0.8 ** (1.0 / dt)),
    ),
    Setting("box2d", "8 and 3 iterations", Box2d),
    Setting("box2d", "30 and 10 iterations", partial(Box2d, iterations=(30, 10))),
    in_substeps("1 substep", 1),
    in_substeps("4 substeps", 4),
    in_substeps("16 substeps", 16),
    in_substeps("4 substeps, hardest", 4, hertz=1e9),
    in_substeps("16 substeps, hardest", 16, hertz=1e9),
    in_substeps("16 substeps, 120 Hz", 16, hertz=120.0),
    Setting("drake", "discrete, k 1e8", Drake, refuses=no_coefficient),
    Setting(
        "drake",
        "CENIC, accuracy 1e-3",
        partial(Drake, scheme="cenic", accuracy=1e-3),
        True,
        no_coefficient,
    ),
    Setting(
        "drake",
        "CENIC, accuracy 1e-5",
        partial(Drake, scheme="cenic", accuracy=1e-5),
        True,
        no_coefficient,
    ),
    Setting(
        "drake",
        "CENIC, accuracy 1e-7",
        partial(Drake, scheme="cenic", accuracy=1e-7),
        True,
        no_coefficient,
    ),
    Setting(
        "drake",
        "RK3, k 1e8, accuracy 1e-6",
        partial(Drake, scheme="runge_kutta3", accuracy=1e-6),
        True,
        too_slow,
    ),
)


def missing(engine) -> str | None:
    """What to install for an engine that is not there, or None."""
    _, package, module = ENGINES[engine]
    if importlib.util.find_spec(module) is None:
        return f"not installed: pip install {package}"
    return None


def version(engine) -> str | None:
    """The installed version, or None."""
    return None if missing(engine) else importlib.metadata.version(ENGINES[engine][1])
