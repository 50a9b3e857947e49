"""Newton's cradle by the width of its gaps, and the forces that hold up a tower: outcomes, no times.

Five balls in a row on the floor, e = 1; the first comes in at 1 m/s. With gaps, however narrow,
only two balls touch at a time, and the last one leaves with all the speed. A step that meets two
gaps at once sees one impact of three balls, and shares the speed out. A tower of ten at rest has
the force (N - k + 1) m g under ball k.
"""

import numpy as np

import contact
from curriculum import measured
from curriculum.bench import closed_form, contestants, engines

COMMAND = "python -m curriculum.bench cradle"
CODE = ("contact.py", "curriculum/exact.py")
BALLS, SPEED, DT, R = 5, 1.0, 0.002, contact.RADIUS
GAPS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)  # m; a step of 2 ms at 1 m/s crosses 2e-3 m
TOWER, SETTLE = 10, 4.0  # balls; s until the forces are read


def cradle(gap):
    """The row, at rest on the floor but for the first ball, which is `gap` away like the others."""
    x = (2.0 * R + gap) * np.arange(BALLS)
    v = np.zeros((2, BALLS))
    v[0, 0] = SPEED
    return contact.Scene(
        f"cradle {gap:g}",
        np.array([x, np.full(BALLS, R)]),
        v,
        np.ones(BALLS),
        np.full(BALLS, R),
        1.0,
        0.0,
    )


def measure(quick=False, cells=None):
    """outcomes: for every contestant and gap the last speeds and their error; forces of the tower."""
    cells = {} if cells is None else cells
    chosen = [
        c
        for c in contestants.CONTESTANTS
        if not c.only or c.family == "soft" and "elastic" in c.only
    ]
    chosen = [c for c in chosen if not (quick and c.family == "drake")]
    with measured.progress(len(chosen) * (len(GAPS) + 1), "cradle and tower") as tick:
        for c in chosen:
            for gap in GAPS:
                key = f"{c.name} {gap:g}"
                if key not in cells and not c.refuses(cradle(gap)):
                    cells[key] = outcome(c, gap)
                tick(c.name)
            if f"{c.name} forces" not in cells:
                cells[f"{c.name} forces"] = tower(c)
            tick(c.name)
    outcomes = [
        dict(family=c.family, words=c.words, gap=gap, **cells[f"{c.name} {gap:g}"])
        for c in chosen
        for gap in GAPS
        if f"{c.name} {gap:g}" in cells
    ]
    forces = [dict(family=c.family, words=c.words, **cells[f"{c.name} forces"]) for c in chosen]
    return dict(
        quick=quick,
        outcomes=outcomes,
        forces=[row for row in forces if row["worst"] is not None],
        untold=[f"{c.name}" for c in chosen if cells[f"{c.name} forces"]["worst"] is None],
    )


def outcome(contestant, gap):
    """Speeds after everything has met, and the largest difference from the truth, in SPEED."""
    duration = 0.2 + 2.0 * BALLS * gap / SPEED
    run = contestant.record(cradle(gap), DT, round(duration / DT))
    speeds = run.v[-1, 0]
    error = np.abs(speeds - closed_form.cradle_speeds(BALLS, SPEED)).max() / SPEED
    return measured.plain(dict(speeds=list(map(float, speeds)), error=float(error)))


def tower(contestant):
    """The largest error of a force in a tower at rest, in m g, or None where forces are not told."""
    scene = contact.build_scene("stack", 0, TOWER)
    scene.q0[1] -= scene.q0[1, 0] - R
    truth, found = closed_form.tower_forces(TOWER, 1.0), forces_of(contestant, scene)
    if found is None:
        return dict(worst=None)
    worst = np.abs(np.array(found) - truth).max() / (scene.mass[0] * closed_form.g)
    return measured.plain(dict(worst=float(worst)))


def forces_of(contestant, scene):
    """The normal force [N] under every ball, lowest first, after SETTLE; None where it is not told."""
    if contestant.family == "exact":
        from curriculum import exact

        return exact.solve_lcp(*delassus(scene))
    if contestant.family in ("penalty", "lcp", "soft"):
        return own_forces(contestant, scene)
    setting = next(
        s for s in engines.SETTINGS if (s.engine, s.words) == (contestant.family, contestant.words)
    )
    if engines.missing(setting.engine):
        return None
    session = setting.build(scene, DT)
    if not hasattr(session, "forces"):
        return None
    session.advance(round(SETTLE / DT))
    told = session.forces()
    return [told.get((k, k - 1), 0.0) for k in range(TOWER)]


def delassus(scene):
    """W and b of the tower's accelerations at rest."""
    J = np.eye(TOWER) - np.eye(TOWER, k=-1)
    return (J / scene.mass) @ J.T, J @ np.full(TOWER, contact.GRAVITY)


def own_forces(contestant, scene):
    """Forces of penalty, lcp and soft, from the contacts of the last step."""
    run = contestant.record(scene, DT, round(SETTLE / DT))
    balls = contact.make_balls(scene._replace(q0=run.q[-1], v0=run.v[-1]))
    family = contestant.family
    contacts = contact.detect_contacts(balls, contact.CONTACT_MARGIN if family == "lcp" else 0.0)
    found = dict.fromkeys(range(TOWER), 0.0)
    number = {id(ball): k for k, ball in enumerate(balls)}
    solref, solimp = contact.soft_defaults(0.0, DT)
    for c in contacts:
        if family == "lcp":
            c.target = contact.contact_target(c, 0.0, 0.2, DT)
        elif family == "soft":
            contact.soften(c, DT, solref, solimp)
        else:
            c.lam = DT * contact.penalty_normal_force(c.depth, c.v_n(), 1e4, scene.damping)
    if family != "penalty":
        contact.fall(balls, DT)
        contact.solve_contacts(contacts, 20 if family == "lcp" else contact.MOST_SWEEPS)
    for c in contacts:
        found[max(number[id(c.a)], number.get(id(c.b), -1))] = c.lam / DT
    return [found[k] for k in range(TOWER)]
