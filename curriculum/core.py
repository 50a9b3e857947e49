"""The core of leapfrog: what lasts is asked twice. It does not bounce; contact.py has the whole."""

import math

import contact


# --- region: leapfrog-core ---
def core_step(balls, dt, iters):
    """One step [s] of leapfrog where nothing bounces: ask where, move, ask how fast."""
    contacts = contact.detect_contacts(balls, contact.step_reach(balls, dt))
    for c in contacts:
        c.target = c.depth / dt  # gap + dt v_n >= 0
    contact.accelerate(balls, 0.5 * dt)
    contact.solve_with_momentum(contacts, iters)  # where
    contact.move(balls, dt)
    contact.accelerate(balls, 0.5 * dt)
    closed = [c for c in contacts if c.lam > 0.0]
    for c in closed:
        turn(c)
        c.target = 0.0
    contact.solve_with_momentum(closed, iters)  # how fast


def turn(c):
    """Give contact c the normal of now."""
    if c.b is not contact.FLOOR:
        dx, dy = c.a.x - c.b.x, c.a.y - c.b.y
        distance = math.sqrt(dx * dx + dy * dy)
        c.nx, c.ny = dx / distance, dy / distance


# --- endregion ---
