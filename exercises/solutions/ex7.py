import math


def time_to_impact(gap, v_n, a_n):
    square = v_n * v_n - 2.0 * gap * a_n
    if square < 0.0 or not (v_n < 0.0 or a_n < 0.0):
        return math.inf
    root = math.sqrt(square)
    return 2.0 * gap / (root - v_n) if v_n < 0.0 else -(v_n + root) / a_n
