"""Exercise 10, write it (20 minutes): see it coming.

lcp looks at gaps below a fixed margin of 1 mm. A ball that falls at 4 m/s comes 8 mm in a step of
2 ms, so lcp finds it inside the table, lets the overlap open, and throws it. Write the three lines
that let it look as far as a step travels. What is around them, for e of the material and beta:

    look = how_far(fastest, dt) if applies(e) else 1 mm     contacts: all gaps below `look`
    target = least_speed(depth, beta, dt) if applies(e) else the law as it was
    gravity, sweeps, move                                   as before

    python exercises/ex10_see_it_coming.py      # your lcp on four scenes, beside exact
    python exercises/ex10_see_it_coming.py --hint 1     # 1, 2: how far; 3, 4: speed; 5: when
    python checks.py -k ex10
"""

from kit import script


def how_far(fastest, dt):
    """The largest gap [m] that two bodies could close in a step `dt` [s]; more costs time.

    `fastest` [m/s] is the speed of the fastest ball, before gravity acts in this step.
    """
    return ...  # TODO: blank 1


def least_speed(depth, baumgarte, dt):
    """The least normal velocity [m/s] to leave the step with; depth < 0 is a gap, > 0 an overlap.

    A gap must not become negative; of an overlap the share `baumgarte` opens.
    """
    return ...  # TODO: blank 2


def applies(restitution):
    """Whether (True or False) to look ahead, in a material that gives that share e back."""
    return ...  # TODO: blank 3


if __name__ == "__main__":
    script.main()
