"""Where each contact model breaks, and proof that nothing else does: `python -m curriculum.stress`.

maps        stability, depth and error over dt, stiffness, damping, beta, e, with the theory lines
extremes    cases far from the defaults, each with what must happen stated beforehand
invariants  what must hold on any scene, checked on thousands of random ones; trial: one of them
samebytes   one run, the same bytes: hash seeds, threads, folders, Pythons, numpy, numba
runner      the jobs on processes or a Dask cluster; finished ones are kept, dead ones reported
report      results.json and report.md; figures: its pictures

Everything runs the real contact.py (under_test.py finds it); nothing here copies its arithmetic.
"""
