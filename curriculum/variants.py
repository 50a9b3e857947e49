"""Variants of a step that the chapter shows: the core of leapfrog, and the implicit spring."""

import math

import contact


# --- region: leapfrog-core ---
def core_step(balls, dt, iters):
    """One step [s] of leapfrog where nothing bounces: ask where, move, ask how fast."""
    contacts = contact.detect_contacts(balls, contact.detection_distance(balls, dt))
    for c in contacts:
        c.target = c.depth / dt  # gap + dt v_n >= 0
    contact.accelerate(balls, 0.5 * dt)
    contact.solve_accelerated(contacts, iters)  # where
    contact.move(balls, dt)
    contact.accelerate(balls, 0.5 * dt)
    closed = [c for c in contacts if c.lam > 0.0]
    for c in closed:
        turn(c)
        c.target = 0.0
    contact.solve_accelerated(closed, iters)  # how fast


def turn(c):
    """Give contact c the normal of now."""
    if c.b is not contact.FLOOR:
        dx, dy = c.a.x - c.b.x, c.a.y - c.b.y
        distance = math.sqrt(dx * dx + dy * dy)
        c.nx, c.ny = dx / distance, dy / distance


# --- endregion ---


# --- region: implicit-spring ---
def implicit_step(balls, dt, spring):
    """One step [s] of penalty's spring, taken at the end of the step and not at its beginning.

    spring(depth) gives softness R and target; then it is lcp's step: the sweep knows R already.
    """
    contacts = contact.detect_contacts(balls, margin=0.0)
    for c in contacts:
        c.softness, c.target = spring(c.depth)
        c.m_eff = 1.0 / (c.a.inv_mass + c.b.inv_mass + c.softness)
    contact.accelerate(balls, dt)
    contact.solve_contacts(contacts, 100)
    contact.move(balls, dt)


# --- endregion ---
