def position_level(gap, dt):
    return 0.5, -gap / dt


def velocity_level(lam, then, now):
    return lam > 0.0, 0.0, lam, now


ORDER = 2.0
