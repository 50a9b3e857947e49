def solve_contacts(contacts, iters):
    for _ in range(iters):
        for c in contacts:
            add = (c.target - c.v_n()) * c.m_eff
            lam = max(0.0, c.lam + add)
            c.apply_impulse(lam - c.lam)
            c.lam = lam
