import numpy as np


def step_matrix(mass, stiffness, damping, dt):
    slowed = 1.0 - dt * damping / mass
    return [[1.0 - dt * dt * stiffness / mass, -dt * slowed], [dt * stiffness / mass, slowed]]


def longest_step(mass, stiffness, damping):
    low, high = 0.0, 2.0
    while high - low > 1e-4 * high:
        middle = 0.5 * (low + high)
        sizes = np.abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, middle)))
        low, high = (middle, high) if max(sizes) <= 1.0 else (low, middle)
    return low
