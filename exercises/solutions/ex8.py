# lam = dt k depth - (k dt^2 + c dt) v_n; divided by what stands before v_n:
# v_n + lam / (k dt^2 + c dt) - dt k depth / (k dt^2 + c dt) = 0.
def implicit_spring(depth, stiffness, damping, dt):
    softness = 1.0 / (stiffness * dt * dt + damping * dt)
    return softness, dt * stiffness * depth * softness
