# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 10, work it out (20 minutes): where does a ball rest in MuJoCo's contact?

A ball of 3 kg comes to rest on the table, in MuJoCo's contact. Its time constant is 0.05 s, its
damping ratio 1, and its impedance the same at every depth, d = d0 = d1 = 0.8. Its spring asks for
the acceleration K d depth, where K = 1 / (d1 timeconst dampratio)^2. That wish gets the share d,
and the share 1 - d goes to what the ball would do without the table. How deep does it lie in the
end, in radii (RADIUS of contact.py)?

Work it out on paper: at rest nothing accelerates. In which term does the mass stand? Write DEPTH,
to three digits, and only then look at gap/r of contact.py with these flags:

    --contact soft --mass 3 --solref 0.05 1 --solimp 0.8 0.8 0.001 0.5 2
"""

from kit import script

script.main(__name__)

DEPTH = None  # r, from your paper
