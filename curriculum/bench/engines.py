"""Other engines and contact.py's models, as sessions that step the scenes of contact.py.

**To send a better setting, add one line to settings.csv**: the engine, its options as they are
typed, the problems that it is for (names, "all", "-name" for all but this one), the numbers of
substeps in 2 ms that it is measured with (none: it chooses its own steps), those for the piles, and
the most balls of a pile (none: any). Options are the arguments of a session's __init__, or
contact.py's own flags.

Every engine is optional. The same for all: balls that cannot rotate, no friction, one thread, the
scene's masses, radii and restitution, a floor along y = 0. A ball of infinite mass is fixed. No
ball sleeps, and steps are warm-started as shipped.
"""

import math
from ast import literal_eval
from functools import cached_property, partial
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import numpy as np

import contact
from curriculum import stored
from curriculum.bench import events
from curriculum.compiled import run as compiled

HERE = Path(__file__).parent
BLOCK = 200  # steps that one of our models takes in one go
GRAVITY = 9.81  # m/s^2, downwards
FLOOR = 1000.0  # m, half the length of the floor, where an engine wants an end to it
MANY = 60  # balls: from here on MuJoCo gets 4 GB of memory, pymunk a spatial hash


class Session:
    """One world, looked at after every `substeps` steps. A subclass has step, state and heights."""

    substeps = 1

    def go(self, n):
        """Take the steps of n looks and read nothing: the bare cost of stepping."""
        step = self.step
        for _ in range(n * self.substeps):
            step()

    def looks(self, read, n):
        """Return what read() returns at the start and at each of n samples."""
        steps = self.step if self.substeps == 1 else partial(self.go, 1)
        rows = [read()]
        for _ in range(n):
            steps()
            rows.append(read())
        return rows

    def trace(self, n):
        """Return every height at each of n samples, as a user needs them."""
        return self.looks(self.heights, n)

    def states(self, n):
        """Return q and v [m, m/s] at each of n samples, (n + 1, 2, N)."""
        return tuple(map(np.array, zip(*self.looks(self.state, n))))

    @cached_property
    def moving(self):
        """Return the indices of the balls that are not fixed."""
        return np.flatnonzero(np.isfinite(self.scene.mass))

    def with_the_fixed(self, *parts):
        """Return q and v of every ball, from flat lists: x, y and more of each moving one."""
        found = self.scene.q0.copy(), self.scene.v0.copy()
        for whole, part in zip(found, parts):
            whole[:, self.moving] = part.reshape(len(self.moving), -1)[:, :2].T
        return found


class Whole(Session):
    """A session that gives whole runs, by states(n) alone."""

    def trace(self, n):
        return self.states(n)[0][:, 1]


class Ours(Whole):
    """A model of contact.py, by its compiled loops; no step is skipped. exact has no steps."""

    def __init__(self, scene, dt, model, **knobs):
        self.given = model, scene, dt
        self.settings = contact.Settings(skip=False, **knobs)
        self.rows = np.empty((BLOCK + 1, 4, len(scene.mass)))  # the first is the state now
        self.rows[0] = *scene.q0, *scene.v0

    def states(self, n):
        home = compiled if contact.MODELS[self.given[0]].step else contact
        run = home.run_model(*self.given, n * self.substeps, self.settings)
        return run.q[:: self.substeps], run.v[:: self.substeps]

    def go(self, n):
        steps = n * self.substeps
        for first in range(0, steps, BLOCK):
            last = min(BLOCK, steps - first)
            self.stepper.take(self.rows[: last + 1])
            self.rows[0] = self.rows[last]

    @cached_property
    def stepper(self):
        """Return the compiled loops, which go on from where they are."""
        return compiled.Stepper(*self.given, self.settings)

    def state(self):
        return np.split(self.rows[0].copy(), 2)


class Events(Whole):
    """The rival that goes from event to event."""

    def __init__(self, scene, dt, **how):
        self.run, self.dt = partial(events.run, scene, gravity=GRAVITY, **how), dt

    def states(self, n):
        return self.run(np.arange(n + 1) * self.dt * self.substeps)


def balls_of(scene, scale=1.0):
    """Return (place, velocity, mass, radius, fixed) of every ball, in a world scaled up.

    The mass of a fixed one is 1: no engine asks for it.
    """
    fixed = np.isinf(scene.mass)
    places, speeds = (map(tuple, (scale * part.T).tolist()) for part in (scene.q0, scene.v0))
    columns = np.where(fixed, 1.0, scene.mass), scale * scene.radius, fixed
    return list(zip(places, speeds, *(column.tolist() for column in columns)))


def spring(scene, dt, push=None, timeconst=None, ratio=1.0, d=0.9999):
    """Return MuJoCo's solref and solimp, as its option's text. Both negative: given directly.

    MuJoCo divides stiffness and damping by d^2 and d: the speed turns into exactly -e times itself.
    """
    if push is None and timeconst is None:
        return "0.02 1", "0.9 0.95 0.001 0.5 2"  # as it ships; no restitution
    solref = -(push or 0.0) / dt**2, -(1.0 + scene.restitution) / dt
    if timeconst is not None:
        solref = timeconst * dt, ratio
    return "{!r} {!r}".format(*solref), f"{d!r} {d!r} 0.001"


class Mujoco(Session):
    """Spring and damper made implicit and convex. texts: solref and solimp, in place of options."""

    def __init__(self, scene, dt, texts=None, solver="Newton", xml="", **options):
        import mujoco
        from mujoco import rollout

        self.mujoco, self.rollout, self.scene = mujoco, rollout.rollout, scene
        mujoco.set_mju_user_warning(lambda text: None)  # its default writes a log file
        solref, solimp = texts or spring(scene, dt, **options)
        many = len(scene.mass) >= MANY
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><size memory="{"4G" if many else "-1"}"/>'
            f'<option timestep="{dt!r}" gravity="0 0 -{GRAVITY}" solver="{solver}" {xml}>'
            f'<flag autoreset="disable"/></option>'
            f'<default><geom condim="1" solref="{solref}" solimp="{solimp}"/></default><worldbody>'
            f'<geom type="plane" size="0 0 1"/>{"".join(map(self.body, balls_of(scene)))}'
            "</worldbody></mujoco>"
        )
        self.data = mujoco.MjData(self.model)
        self.step = partial(mujoco.mj_step, self.model, self.data)
        self.data.qpos[:] = scene.q0[:, self.moving].T.ravel()
        self.data.qvel[:] = scene.v0[:, self.moving].T.ravel()

    @staticmethod
    def body(ball):
        (x, y), _, mass, radius, fixed = ball
        joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        body = f'<body pos="{x!r} 0 {y!r}">' if fixed else f"<body>{joints}"
        return f'{body}<geom type="sphere" size="{radius!r}" mass="{mass!r}"/></body>'

    def go(self, n):
        self.mujoco.mj_step(self.model, self.data, nstep=n * self.substeps)

    def trace(self, n):
        """Return heights by MuJoCo's own rollout, a loop in C that stores every state."""
        full = self.mujoco.mjtState.mjSTATE_FULLPHYSICS
        start = np.empty(self.mujoco.mj_stateSize(self.model, full))
        self.mujoco.mj_getState(self.model, self.data, start, full)
        rows = self.rollout(self.model, self.data, start, nstep=n * self.substeps)[0][0]
        rows = np.vstack((start, rows[self.substeps - 1 :: self.substeps]))
        return rows[:, 2 : 1 + self.model.nq : 2]

    def state(self):
        return self.with_the_fixed(self.data.qpos, self.data.qvel)


class Pymunk(Session):
    """Chipmunk: sequential impulses with cached sums; position error is pushed out on its own."""

    def __init__(self, scene, dt, iterations, push=None, slop=1e-6):
        import pymunk
        import pymunk.batch
        from pymunk._chipmunk_cffi import lib

        self.batch, self.buffer = pymunk.batch, pymunk.batch.Buffer()
        self.space, self.bodies = pymunk.Space(), []
        space = self.space
        space.gravity, space.iterations, space.collision_slop = (0, -GRAVITY), iterations, slop
        if push is not None:  # a share of an overlap in 2 ms; the engine keeps what a second leaves
            space.collision_bias = (1.0 - push) ** 500
        if len(scene.mass) >= MANY:
            space.use_spatial_hash(2.0 * scene.radius.max(), 10 * len(scene.mass))
        space.add(pymunk.Segment(space.static_body, (-FLOOR, 0), (FLOOR, 0), 0))
        for place, velocity, mass, radius, fixed in balls_of(scene):
            kind = pymunk.Body.STATIC if fixed else pymunk.Body.DYNAMIC
            body = pymunk.Body(mass, math.inf, kind)
            body.position, body.velocity = place, velocity
            space.add(body, pymunk.Circle(body, radius))
            self.bodies.append(body)
        for shape in space.shapes:  # the engine multiplies the two bodies' elasticities
            shape.elasticity, shape.friction = math.sqrt(scene.restitution), 0.0
        # the engine alone: of one ball's microsecond, pymunk's own step is two thirds.
        self.step = partial(lib.cpSpaceStep, space._space, dt)
        if len(self.bodies) > 1 and not np.isinf(scene.mass).any():
            self.heights = self.many_heights

    def heights(self):
        return [body.position[1] for body in self.bodies]

    def many_heights(self):
        """Return all heights by the engine's own batch call; the floor comes last."""
        self.buffer.clear()
        self.batch.get_space_bodies(self.space, self.batch.BodyFields.POSITION, self.buffer)
        return np.frombuffer(self.buffer.float_buf())[1:-2:2].copy()

    def state(self):
        q, v = zip(*((body.position, body.velocity) for body in self.bodies))
        return np.array(q).T, np.array(v).T


class Box2d3(Session):
    """Box2D 3: soft contacts solved over small substeps, then relaxed."""

    def __init__(self, scene, dt, inner, hertz=None, scale=10.0):
        import pyb2d3 as box2d

        how = dict(restitution_threshold=0.0, maximum_linear_speed=1e6)
        self.world = world = box2d.World(gravity=(0, -GRAVITY * scale), **how)
        self.scale, self.bodies, world.sleeping_enabled = scale, box2d.Bodies(), False
        if hertz is not None:  # frequency [Hz], damping ratio, push-out speed
            world.set_contact_tuning(hertz, 10.0, 1e9)
        material = box2d.surface_material(friction=0.0, restitution=scene.restitution)
        floor = world.create_static_body(position=(0, -1.0))  # a segment would tilt by rounding
        floor.create_shape(box2d.shape_def(material=material), box2d.box(FLOOR * scale, 1.0))
        for place, velocity, mass, radius, fixed in balls_of(scene, scale):
            make = world.create_static_body if fixed else world.create_dynamic_body
            moves = {} if fixed else dict(linear_velocity=velocity, fixed_rotation=True)
            body, density = make(position=place, **moves), mass / (math.pi * radius * radius)
            skin = box2d.shape_def(density=density, material=material)
            body.create_shape(skin, box2d.circle(radius=radius))
            self.bodies.append(body)
        self.step = partial(world.step, dt, inner)
        if len(scene.mass) == 1:
            self.heights = lambda: (body.position[1] / scale,)

    def heights(self):
        return self.bodies.get_positions()[:, 1] / self.scale

    def state(self):
        parts = self.bodies.get_positions(), self.bodies.get_linear_velocities()
        return tuple(part.astype(float).T / self.scale for part in parts)


class Rapier(Session):
    """Rapier: soft contacts over small substeps, as Box2D 3; here balls that stay in a plane."""

    def __init__(self, scene, dt, inner, hertz=None, scale=1.0):
        import rapier3d as rapier

        self.scale, self.bodies = scale, []
        self.world = world = rapier.PhysicsWorld(gravity=(0.0, -GRAVITY * scale, 0.0))
        world.set_num_threads(1)
        knobs = world.integration_parameters
        knobs.dt, knobs.num_solver_iterations = dt, inner
        knobs.normalized_max_linear_velocity = 1e6
        if hertz is not None:
            spring = rapier.SpringCoefficients(hertz, 10.0)
            knobs.contact_softness = knobs.static_contact_softness = spring
            knobs.normalized_max_corrective_velocity = 1e9
            knobs.normalized_allowed_linear_error = 1e-7
            knobs.contact_recycling = knobs.contact_clustering = False

        def skin(shape):
            return shape.friction(0.0).restitution(scene.restitution)

        world.add_collider(skin(rapier.Collider.halfspace((0.0, 1.0, 0.0))))
        for place, velocity, mass, radius, fixed in balls_of(scene, scale):
            body = rapier.RigidBody.fixed() if fixed else rapier.RigidBody.dynamic()
            body = body.translation((*place, 0.0)).enabled_rotations((False, False, False))
            body = body.enabled_translations((True, True, False)).can_sleep(False)
            body = body if fixed else body.linvel((*velocity, 0.0))
            ball = skin(rapier.Collider.ball(radius)).mass(mass)
            self.bodies.append(world.rigid_bodies.get(world.add_body(body, [ball])))
        self.step = world.step

    def heights(self):
        return [body.translation.y / self.scale for body in self.bodies]

    def state(self):
        q, v = ([getattr(b, part) for b in self.bodies] for part in ("translation", "linvel"))
        return tuple(np.array([(p.x, p.y) for p in part]).T / self.scale for part in (q, v))


class Drake(Session):
    """Compliant points: its discrete solver, or with `scheme` an integrator of that accuracy.

    It has no coefficient of restitution, only a dissipation, so it is for e = 0 and e = 1.
    """

    def __init__(self, scene, dt, stiffness, scheme=None, accuracy=None, dissipation=1e3, cut=0):
        import logging

        import pydrake.all as drake

        logging.getLogger("drake").setLevel(logging.ERROR)
        self.scene, self.dt, self.time, self.dense = scene, dt, 0, scheme and not cut
        builder, lossy = drake.DiagramBuilder(), float(scene.restitution < 1.0)
        skin = dict(hunt_crossley_dissipation=lossy * dissipation, relaxation_time=lossy * dt)
        skin |= dict(point_stiffness=2.0 * stiffness)  # of two surfaces in series: half of it
        skin = drake.DefaultProximityProperties(dynamic_friction=0, static_friction=0, **skin)
        every = drake.SceneGraphConfig(default_proximity_properties=skin)
        points = drake.MultibodyPlantConfig(time_step=0 if scheme else dt, contact_model="point")
        self.plant, _ = drake.AddMultibodyPlant(points, every, builder)
        plant = self.plant
        plant.mutable_gravity_field().set_gravity_vector([0.0, -GRAVITY, 0.0])
        put = partial(plant.RegisterCollisionGeometry, properties=drake.ProximityProperties())
        floor = drake.RigidTransform(drake.HalfSpace.MakePose([0.0, 1.0, 0.0], np.zeros(3)))
        put(plant.world_body(), floor, drake.HalfSpace(), "floor")
        for k, (place, _, mass, radius, fixed) in enumerate(balls_of(scene)):
            body, pose = plant.world_body(), drake.RigidTransform([*place, 0.0])
            if not fixed:
                inertia = drake.SpatialInertia.SolidSphereWithMass(mass, radius)
                body, pose = plant.AddRigidBody(f"ball {k}", inertia), drake.RigidTransform()
                frames = plant.world_frame(), body.body_frame()
                plant.AddJoint(drake.PlanarJoint(f"joint {k}", *frames))
            put(body, pose, drake.Sphere(radius), f"ball {k}")
        plant.Finalize()
        self.simulator = drake.Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for to, given in ((plant.SetPositions, scene.q0), (plant.SetVelocities, scene.v0)):
            to(self.context, np.pad(given[:, self.moving].T, ((0, 0), (0, 1))).ravel())  # x, y, 0
        if scheme:
            drake.ResetIntegratorFromFlags(self.simulator, scheme, 0.1)
            self.simulator.get_mutable_integrator().set_target_accuracy(accuracy)
        self.simulator.Initialize()

    def go(self, n):
        self.time += n * self.substeps
        self.simulator.AdvanceTo(self.time * self.dt)

    def step(self):
        self.go(1)

    def heights(self):
        return self.plant.GetPositions(self.context)[1::3]

    def state(self):
        plant, context = self.plant, self.context
        return self.with_the_fixed(plant.GetPositions(context), plant.GetVelocities(context))

    def looks(self, read, n):
        """Return heights or states, by the engine's dense output unless it steps or is cut."""
        if not self.dense:
            return super().looks(read, n)
        integrator, look = self.simulator.get_mutable_integrator(), self.dt * self.substeps
        integrator.StartDenseIntegration()
        self.simulator.AdvanceTo(n * look)
        found = integrator.StopDenseIntegration()
        times = np.clip(np.arange(n + 1) * look, found.start_time(), found.end_time())
        rows = found.vector_values(times).T  # (n + 1, 6 N)
        if read == self.heights:
            return rows[:, 1 : 3 * len(self.moving) : 3]
        return [self.with_the_fixed(*np.split(row, 2)) for row in rows]


class Dart(Session):
    """DART: velocities by Dantzig's method for the LCP; a share of the overlap is pushed out."""

    def __init__(self, scene, dt):
        import dartpy as dart

        self.dart, self.scene, self.balls = dart, scene, []
        self.world = world = dart.simulation.World()
        world.setGravity([0.0, -GRAVITY, 0.0])
        world.setTimeStep(dt)
        awake = world.getDeactivationOptions()
        awake.mEnabled = False
        world.setDeactivationOptions(awake)
        world.getConstraintSolver().setCollisionDetector(dart.collision.DARTCollisionDetector())
        self.put(dart.dynamics.BoxShape([2.0 * FLOOR, 2.0, 2.0 * FLOOR]), (0.0, -1.0))
        for place, velocity, mass, radius, fixed in balls_of(scene):
            ball = self.put(dart.dynamics.SphereShape(radius), place, None if fixed else mass)
            ball.setVelocities([*velocity, 0.0])
            self.balls.append(ball)
        self.step = world.step

    def put(self, shape, place, mass=None):
        """Add a body that cannot rotate, or without a mass one that is fixed; return it."""
        skeleton = self.dart.dynamics.Skeleton()
        _, body = skeleton.createTranslationalJointAndBodyNodePair()
        skin = body.createShapeNode(shape)
        skin.createCollisionAspect()
        skin.createDynamicsAspect()
        skin.getDynamicsAspect().setFrictionCoeff(0.0)
        # the engine multiplies the two bodies' coefficients
        skin.getDynamicsAspect().setRestitutionCoeff(math.sqrt(self.scene.restitution))
        body.setMass(mass or 1.0)
        skeleton.setMobile(mass is not None)
        skeleton.setPositions([*place, 0.0])
        self.world.addSkeleton(skeleton)
        return skeleton

    def heights(self):
        return [ball.getPositions()[1] for ball in self.balls]

    def state(self):
        q, v = zip(*((ball.getPositions(), ball.getVelocities()) for ball in self.balls))
        return np.array(q)[:, :2].T, np.array(v)[:, :2].T


ENGINES = {  # label, package, session
    "mujoco": ("MuJoCo", "mujoco-core", Mujoco),
    "pymunk": ("pymunk", "pymunk", Pymunk),
    "box2d3": ("Box2D 3", "pyb2d3", Box2d3),
    "rapier": ("Rapier", "rapier3d", Rapier),
    "drake": ("Drake", "drake", Drake),
    "dart": ("DART", "dartpy", Dart),
    "events": ("event-driven", "scipy", Events),
}
LABELS = {name: name for name in contact.MODELS} | {name: row[0] for name, row in ENGINES.items()}


def missing(engine):
    """Return whether an engine is not installed; a model always is."""
    return engine in ENGINES and not any(metadata.distributions(name=ENGINES[engine][1]))


class Setting(NamedTuple):
    """One engine, or one of our models, with one set of choices: a line of settings.csv.

    `ahead` is a way to start: a step that first accelerates and then moves is exact in free flight
    if its first speed stands half a step earlier.
    """

    engine: str  # a key of ENGINES, or a model
    options: str | None  # as they stand in the file
    problems: str | None
    substeps: tuple  # in 2 ms; none where it chooses its own, and dt is how often it is looked at
    piles: tuple  # substeps in a step of the piles
    most: int | None = None  # balls of a pile; a larger one would take hours

    @property
    def name(self):
        return f"{self.engine} {self.options or ''}".strip()

    @property
    def knobs(self):
        """Return the options as a dict of numbers, tuples and words."""
        pairs = (word.split("=", 1) for word in (self.options or "").split())
        return {key: text if text.isidentifier() else literal_eval(text) for key, text in pairs}

    @property
    def inner(self):
        """Return its substeps within each step; leapfrog solves twice."""
        return self.knobs.get("inner", 2 if self.engine == "leapfrog" else 1)

    def runs(self, problem):
        """Return whether it is for a problem."""
        words = (self.problems or "").split()
        return ("all" in words or problem in words) and f"-{problem}" not in words

    def build(self, scene, dt, substeps=1):
        """Return a session that is sampled every dt [s], after so many steps."""
        knobs, dt, engine = self.knobs, dt / substeps, self.engine
        ahead = knobs.pop("ahead", 0) * contact.GRAVITY * dt / self.inner / 2
        v0 = np.where(np.isfinite(scene.mass), scene.v0 + np.array([[0.0], [ahead]]), scene.v0)
        make = ENGINES[engine][-1] if engine in ENGINES else partial(Ours, model=engine)
        session = make(scene._replace(v0=v0), dt, **knobs)
        session.substeps = substeps
        return session


def listed():
    """Yield every setting of settings.csv that can run here."""
    for *row, substeps, piles, most in map(dict.values, stored.load(HERE)[0]["settings"]):
        counts = (tuple(map(int, str(cell or "").split())) for cell in (substeps, piles))
        if not missing(row[0]):
            yield Setting(*row, *counts, most)


BY_NAME = {setting.name: setting for setting in listed()}
PILES = [(setting, substeps) for setting in BY_NAME.values() for substeps in setting.piles]
