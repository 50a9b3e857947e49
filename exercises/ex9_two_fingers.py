# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 9, choose (30 minutes): a gripper that holds still.

A cup, here a ball of 1 kg, stands on a table. Two fingers of 0.2 kg squeeze it from left and right
with 20 N each, for one second. This is the gripper from the chapter's first page, and it trembles:
set MODEL = "penalty" and see by how much. Make it hold still, with fingertips that give way a
little: choose a model, its numbers and a step from 0.5 to 20 ms so that in the end the overlap is
between half a thousandth and a thousandth of a radius, and over the last quarter varies (std) by
less than a hundredth of that. There is more than one way. Before you try numbers, estimate: what do
20 N do to a spring, and how light is the lightest thing that hangs on it?
"""

from kit import script

script.main(__name__)

MODEL = None  # "penalty", "implicit" (the spring of exercise 8) or "soft"
DT = 0.004  # s
STIFFNESS = 1e4  # N/m, of penalty and implicit
DAMPING = 80.0  # N s/m, of penalty and implicit
SOLREF = (0.02, 1.0)  # of soft: time constant [s] and damping ratio
SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)  # of soft: the impedance, see contact.impedance
