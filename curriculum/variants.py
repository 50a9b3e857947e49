"""Variants of a step that the chapter shows: the core of leapfrog, and the implicit spring."""

import math

import contact


# --- region: leapfrog-core ---
def core_step(balls, dt, iters):
    """Take one step [s] of leapfrog without rebounds: a position solve and a velocity solve."""
    contacts = contact.detect_contacts(balls, contact.detection_distance(balls, dt))
    for c in contacts:
        c.target = c.depth / dt  # gap + dt v_n >= 0
    contact.accelerate(balls, 0.5 * dt)
    contact.solve_accelerated(contacts, iters)  # position level
    contact.move(balls, dt)
    contact.accelerate(balls, 0.5 * dt)
    closed = [c for c in contacts if c.lam > 0.0]
    for c in closed:
        turn(c)
        c.target = 0.0
    contact.solve_accelerated(closed, iters)  # velocity level


def turn(c):
    """Recompute the normal of contact c at the current positions."""
    if c.b is not contact.FLOOR:
        dx, dy = c.a.x - c.b.x, c.a.y - c.b.y
        distance = math.sqrt(dx * dx + dy * dy)
        c.nx, c.ny = dx / distance, dy / distance


# --- endregion ---


# --- region: implicit-spring ---
def implicit_step(balls, dt, spring):
    """Take one step [s] of penalty's spring by implicit Euler: with the force of the step's end.

    spring(depth) returns softness R and target; the rest is lcp's step, whose sweep includes R.
    """
    contacts = contact.detect_contacts(balls, margin=0.0)
    for c in contacts:
        c.softness, c.target = spring(c.depth)
        c.m_eff = 1.0 / (c.a.inv_mass + c.b.inv_mass + c.softness)
    contact.accelerate(balls, dt)
    contact.solve_contacts(contacts, 100)
    contact.move(balls, dt)


# --- endregion ---
