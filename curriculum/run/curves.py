"""What is drawn of a run: a colour a model, and the curves of recording, picture and notebook."""

import numpy as np

import contact

# safe for colour-blind readers (Okabe and Ito)
COLORS = {"penalty": "#d55e00", "lcp": "#0072b2", "leapfrog": "#e69f00", "soft": "#cc79a7", "exact": "#009e73"}


@np.errstate(all="ignore")
def contact_impulses(run: contact.Run, scene: contact.Scene) -> np.ndarray:
    """The impulse [N s] that all contacts of a ball give it in each step, (S, 2, N).

    It is the change of momentum that gravity does not explain, so it is there for every model.
    """
    gained = np.diff(run.t[:2]).sum() * np.array([[0.0], [contact.GRAVITY]])
    mass = np.where(np.isfinite(scene.mass), scene.mass, 0.0)
    return np.concatenate((np.zeros_like(run.v[:1]), mass * (np.diff(run.v, axis=0) - gained)))


@np.errstate(all="ignore")
def curves(runs: dict[str, contact.Run], scene: contact.Scene) -> dict:
    """What is plotted of runs {model: Run}, {title: {model: values (S,)}}."""
    drawn: dict = {}
    for model, run in runs.items():
        total = contact.energy(run.q, run.v, scene.mass)
        depth = np.maximum(-contact.smallest_gap(run.q, scene.radius), 0.0)
        lines = {
            "height [m], mean": run.q[:, 1].mean(-1),
            "penetration [r]": depth / scene.radius[0],
            "impulse of floor [N s]": contact_impulses(run, scene)[:, 1].sum(-1),
            "energy above start [J]": total - total[0],
            "rises of energy [J]": np.maximum(np.diff(total, prepend=total[0]), 0.0).cumsum(),
        }
        for title, line in lines.items():
            drawn.setdefault(title, {})[model] = line
    return drawn


def ending(run: contact.Run, scene: contact.Scene) -> str:
    """How the run ended, in contact.py's words, such as "ok" and "through the floor"."""
    dt = float(np.diff(run.t[:2]).sum())
    return contact.ending(contact.contact_quality(run, scene, dt))
