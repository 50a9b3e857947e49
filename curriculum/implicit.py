"""The implicit spring: penalty's spring, taken at the end of the step."""

import contact


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
