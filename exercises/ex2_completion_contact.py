"""Exercise 2, fill in (25 minutes): the two lines that make a contact one-sided.

Each contact model has one line in which the table is told that it may push and never pull.
Detection, normals, masses and time stepping are given, in contact.py; the two lines are yours. The
signs are those of the table at the top of contact.py. Do not call its functions of these names.

    pytest checks.py -k ex2                             # skips a blank that is still a blank
    python exercises/ex2_completion_contact.py          # the drop with your two lines
    python exercises/ex2_completion_contact.py --hint 1     # 1, 2: first blank; 3, 4: second

Out of scope: friction, and several contacts at once (your second line is called for each in turn).
"""

import sys
from unittest.mock import patch

import predict
from predict import contact


def penalty_normal_force(depth, v_n, stiffness, damping):
    """The push [N] of a spring with a damper beside it, between bodies that overlap by `depth` [m].

    The spring has `stiffness` [N/m]; the damper has `damping` [N s/m] and works against the motion;
    v_n [m/s] is positive when the bodies separate.
    """
    f_n = ...           # TODO: blank 1
    return f_n


def project_impulse(lam, dlam):
    """The new accumulated impulse [N s] of one contact within a sweep.

    `lam` has been accumulated so far; `dlam`, of either sign, is the change that would bring this
    contact to its target velocity right now.
    """
    new_lam = ...       # TODO: blank 2
    return new_lam


def main():
    """The drop, stepped with the two functions above. Returns the exit status."""
    if predict.hint("ex2"):
        return 0
    for name, value in (("penalty_normal_force", penalty_normal_force(0.01, 0.0, 1e4, 80.0)),
                        ("project_impulse", project_impulse(0.1, 0.1))):
        if value is ...:
            print(f"{name} is still a blank", file=sys.stderr)
            return 2
    with yours():
        qualities = predict.quality(contact.build_scene("drop"), dt=0.002, steps=2000)
    for model, q in qualities.items():
        print(f"{model:<10}deepest {q['max_penetration_frac']:.5f} r, at rest "
              f"{q['rest_penetration_frac']:.5f} r, energy gained {q['energy_excess']:.4g}")
    print("One ball does not meet every border; pytest checks.py -k ex2 does.")
    return 0


def yours():
    """contact.py with these two functions in place of its own, while the context lasts."""
    return patch.multiple(
        contact, penalty_normal_force=lambda *inputs: penalty_normal_force(*inputs[:4]),
        project_impulse=lambda *inputs: project_impulse(*inputs[:2]))


if __name__ == "__main__":
    sys.exit(main())
