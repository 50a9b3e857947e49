import numpy as np


def step_matrix(mass, stiffness, damping, dt):
    slowed = 1.0 - dt * damping / mass
    return [[1.0 - dt * dt * stiffness / mass, -dt * slowed], [dt * stiffness / mass, slowed]]


def longest_step(mass, stiffness, damping):
    low, high = 0.0, 2.0
    while high - low > 1e-4 * high:
        dt = 0.5 * (low + high)
        stable = max(abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, dt)))) <= 1.0
        low, high = (dt, high) if stable else (low, dt)
    return low
