import math


def time_to_impact(gap, v_n, a_n):
    square = v_n * v_n - 2.0 * gap * a_n
    if square < 0.0 or not (v_n < 0.0 or a_n < 0.0):
        return math.inf
    root = math.sqrt(square)
    return 2.0 * gap / (root - v_n) if v_n < 0.0 else -(v_n + root) / a_n


def before_the_move(gap, dt):
    return 0.5, -gap / dt


def after_the_move(lam, then, now):
    return lam > 0.0, 0.0, lam, now


ORDER = 2.0
