"""Where each contact model breaks, and proof that nothing else does: `python -m curriculum.stress`.

maps           stability, depth and error over dt, stiffness, damping, beta, e, with the theory lines
extremes       cases far from the defaults, each with what must happen stated beforehand
invariants     what must hold on any scene, checked on thousands of random ones; trial: one of them
samebytes      one run, the same bytes: hash seeds, threads, folders, Pythons, numpy, numba
runner         the jobs on processes or a Dask cluster; finished ones are kept, dead ones reported
report         results.json and report.md; figures: its pictures
exact_sweep    exact in piles and towers, a command of its own; exact_report: its page
precise_exact  exact in 80 bits, from its own source; precise_tower: towers in 120 digits
mujoco_match   how far soft is from the engine, a command of its own

Everything runs the real contact.py (under_test.py finds it); nothing here copies its arithmetic.
"""
