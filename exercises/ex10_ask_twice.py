# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 10, write it (30 minutes): ask twice.

lcp asks one question for two things. One velocity has to say where a ball may go, and how fast it
may be afterwards. So ask twice. What is around your two functions is lcp_step, taken apart:

    list all contacts that a step may bring together
    kick, least = before_the_move(gap, dt)          for each contact, its gap
    that share of gravity's kick, sweeps for these least speeds; lam is what they gave
    move
    the rest of the kick
    asked, least, lam, normal = after_the_move(...) for each contact again
    sweeps once more, for those that are asked, each beginning with its lam

exact judges it, on a drop, a stack, a ball that slides off another and one that begins in another.
Then look at its order: what is left of the error of the slide when the step is a quarter?

    python exercises/ex10_ask_twice.py      # your step beside lcp's
    python exercises/ex10_ask_twice.py --hint 1     # 1, 2: before the move; 3 to 5: after it
    python checks.py -k ex10
"""

from kit import script


def before_the_move(gap, dt):
    """(the share of gravity's kick that comes first, the least normal velocity [m/s] to move with).

    The step ends with gap + dt v_n [m]; it may not be negative. gap < 0 is an overlap.
    """
    return ...  # TODO: blank 1


def after_the_move(lam, then, now):
    """(whether this contact is asked, its least speed [m/s], lam to begin with, its normal).

    `lam` [N s] is what it gave on the way; `then` and `now` are the angles [rad] of its normal
    before and after the move. The balls stay where they are now: only their speeds are left.
    """
    return ...  # TODO: blank 2


if __name__ == "__main__":
    script.main()
