def penalty_normal_force(depth, v_n, stiffness, damping):
    return max(0.0, stiffness * depth - damping * v_n)


def project_impulse(lam, dlam):
    return max(0.0, lam + dlam)  # the sum, not the change
