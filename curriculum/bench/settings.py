"""Who competes: every model and every engine, in every setting, for the problems and for the piles.

**To send a better setting, add one line to SETTINGS**, or to PILES: the benchmark runs every line,
draws the front of all settings of an engine, and names the best. Nothing else has to change. Words
name the options, so what is said is what is run. Options are those of the session in engines.py;
`only` names the problems that a setting is for. "begun half a step off" is a way to start: a step
that first accelerates and then moves is exact in free flight if the speed that it begins with
stands half a step earlier.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import engines


class Setting(NamedTuple):
    """One engine, or one of our models, with one set of choices."""

    engine: str  # a key of ENGINES, or a model
    words: str  # the setting, for a reader
    options: dict  # of its session
    only: tuple = ()  # the problems it is for; none means all
    half: float = 0.0  # half steps of gravity that its first speed is ahead

    @property
    def name(self):
        return f"{self.engine}: {self.words}"

    @property
    def inner(self):
        """Substeps that the engine takes by itself in each step."""
        return self.options.get("inner", 1)

    @property
    def adaptive(self):
        """Whether it chooses its own steps: dt is only how often it is looked at."""
        return self.engine == "exact" or "scheme" in self.options

    @property
    def slow(self):
        """Whether one start and one process have to be enough."""
        return self.engine == "drake" and not self.adaptive

    def cut(self, substeps):
        """The words, with that many substeps for each look."""
        return self.words if substeps == 1 else f"{self.words}, {substeps} x"

    def refuses(self, scene):
        """Why it does not run a scene, or does not run here, or None."""
        missing = engines.not_installed(self.engine)
        return missing or engines.session(self.engine).cannot(scene)

    def build(self, scene, dt, substeps=1):
        """A session that is looked at every dt [s], after so many steps."""
        dt /= substeps
        v0 = scene.v0 + np.array([[0.0], [self.half * contact.GRAVITY * dt / self.inner / 2]])
        scene = scene._replace(v0=np.where(np.isfinite(scene.mass), v0, scene.v0))
        session = engines.session(self.engine)(scene, dt, **self.options)
        session.substeps = substeps
        return session


def setting(engine, words, only=(), half=0.0, **options):
    """A setting whose words name these options."""
    words = words.format(**options) + ", begun half a step off" * bool(half)
    words = words.replace("substeps", "substep" if options.get("inner") == 1 else "substeps")
    return Setting(engine, words, options, only, half)


penalty, lcp, leapfrog, soft, exact = (
    partial(setting, model, model=model) for model in contact.MODELS
)
mujoco, pymunk, box2d3, drake = (partial(setting, engine) for engine in engines.ENGINES)
SHARED = ("stack", "pile", "heavy_100", "heavy_1000", "tower", "spread", "pile_bounce", "cradle")
SWEEPS, GAIN = "{iters} sweeps", "{iters} sweeps, gain {baumgarte:g}"
WARM = SWEEPS + ", warm"
RIGID = partial(engines.direct, 0.0, 0.9999)
PUSHED = partial(engines.direct, 0.2, 0.999)
STIFF = partial(engines.standard, 2.0, 5.0, 0.9999)
SPRING = partial(engines.standard, 2.0, 1.0, 0.99)
ITERATIONS, PUSHING = "{iterations} iterations", "{iterations} iterations, push {push:g} in 2 ms"
HARD, SHIPPED = "{inner} substeps, hardest", "{inner} substeps, as shipped"
SCALED = HARD + ", scale {scale:g}"
TUNED = "{inner} substeps, {hertz:.0f} Hz, scale {scale:g}"
# e = 0, and no lottery
RESTING = ("drop", "slide", "stack", "heavy_100", "heavy_1000", "tower", "spread", "glance")
CENIC, RK3 = (f"{name}, accuracy {{accuracy:g}}, k {{stiffness:g}}" for name in ("CENIC", "RK3"))
cenic = partial(drake, scheme="cenic")
rk3 = partial(drake, scheme="runge_kutta3")
OURS = (
    penalty("k 1e4", stiffness=1e4),
    lcp(SWEEPS, iters=20),
    lcp(SWEEPS + ", in Python", iters=20, python=True),
    lcp(SWEEPS, SHARED, iters=100),
    *(lcp(WARM, SHARED, iters=n, warm=0.8) for n in (5, 20)),
    lcp(GAIN, iters=20, baumgarte=1.0),
    leapfrog(SWEEPS, iters=20),
    leapfrog("solved, at most {iters} sweeps", SHARED, iters=1000),
    soft("as MuJoCo ships it, or direct where e > 0"),
    soft("time constant 2 dt, ratio 5, d 0.9999", ("drop", "slide", *SHARED),
         solref=(1e-9, 5.0), solimp=contact.HARD),
    exact("event to event"),
)  # fmt: skip
SETTINGS = (
    mujoco("as shipped", soften=engines.shipped),
    *(mujoco("time constant 2 dt, ratio 5, d 0.9999", half=h, soften=STIFF) for h in (0, -1)),
    *(mujoco("direct, no push, d 0.9999", half=h, soften=RIGID) for h in (0, -1)),
    mujoco("direct, no push, speculative", soften=RIGID, speculative=True),
    mujoco("direct, push 0.2, d 0.999", soften=PUSHED),
    *(pymunk(ITERATIONS, iterations=n) for n in (10, 100)),
    *(pymunk(PUSHING, iterations=n, push=0.2) for n in (10, 100)),
    *(pymunk(PUSHING, iterations=n, push=1.0) for n in (10, 30, 100)),
    *(pymunk(PUSHING, half=1, iterations=10, push=x) for x in (0.2, 1.0)),
    *(pymunk(PUSHING + ", slop {slop:g} m", half=h, iterations=n, push=1.0, slop=x)
      for h, n, x in ((0, 30, 2e-7), (1, 10, 1e-7), (1, 30, 1e-10))),
    box2d3(SHIPPED, inner=4),
    *(box2d3(HARD, inner=n, hertz=1e9) for n in (1, 4, 16, 64)),
    *(box2d3(SCALED, inner=4, hertz=1e9, scale=x) for x in (1.0, 100.0, 1000.0)),
    *(box2d3(SCALED, half=-1, inner=n, hertz=1e9, scale=x)
      for n, x in ((1, 10.0), (1, 100.0), (4, 1.0))),
    *(box2d3(TUNED, inner=n, hertz=hertz, scale=x)
      for n, hertz, x in ((1, 120.0, 1000.0), (1, 240.0, 1.0), (1, 480.0, 10.0), (4, 240.0, 10.0),
                          (32, 240.0, 10.0))),
    drake("discrete, k {stiffness:g}", stiffness=1e8),
    *(cenic(CENIC, accuracy=a, stiffness=1e8) for a in (1e-3, 1e-5, 1e-7)),
    cenic(CENIC, RESTING, accuracy=1e-7, stiffness=1e10),
    cenic(CENIC, RESTING, accuracy=1e-9, stiffness=1e12),
    cenic(CENIC + ", dissipation {dissipation:g}", RESTING, accuracy=1e-7, stiffness=1e10,
          dissipation=100.0),
    cenic(CENIC, ("tower",), accuracy=1e-9, stiffness=1e10),
    cenic(CENIC + ", cut", RESTING, accuracy=1e-7, stiffness=1e10, cut=True),
    rk3(RK3, ("drop", "slide"), accuracy=1e-5, stiffness=1e8),
    rk3(RK3 + ", cut", ("elastic",), accuracy=1e-7, stiffness=1e14, cut=True),
    rk3(RK3 + ", cut", ("cradle",), accuracy=1e-5, stiffness=1e8, cut=True),
)  # fmt: skip
PILES = (  # and how many substeps they take for a step of 2 ms
    (lcp(SWEEPS, iters=20), 1),
    *((lcp(GAIN, iters=n, baumgarte=1.0), substeps)
      for n, substeps in ((2, 1), (4, 1), (6, 1), (7, 1), (12, 1), (4, 2), (2, 4), (4, 4), (2, 6))),
    *((leapfrog(SWEEPS, iters=n), 1) for n in (2, 4, 8, 20)),
    (box2d3(SHIPPED, inner=4), 1),
    *((box2d3(HARD, inner=n, hertz=1e9), 1) for n in (4, 8, 12, 16)),
    *((pymunk(ITERATIONS, iterations=n), 1) for n in (10, 30)),
    (pymunk(PUSHING, iterations=10, push=0.2), 1),
    (mujoco("as shipped, CG", soften=engines.shipped), 1),
    (mujoco("2 dt, ratio 1, d 0.99, CG", soften=SPRING), 1),
    (mujoco("direct, push 0.2, d 0.999, CG", soften=PUSHED), 1),
)  # fmt: skip
EVERYBODY = OURS + SETTINGS
BY_NAME = {each.name: each for each in EVERYBODY}
