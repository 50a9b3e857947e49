"""Where each contact model breaks, and proof that nothing else does: `python -m curriculum.stress`.

maps        stability over dt, stiffness, damping, baumgarte, restitution, with the theory lines
extremes    cases far from the defaults, each with what must happen stated beforehand
invariants  what must hold on any scene, checked on thousands of random ones
samebytes   one run, the same bytes: hash seeds, threads, folders, Pythons, numpy versions
runner      the jobs on processes or a Dask cluster; finished ones are kept, dead ones reported
figures     heat maps as SVG
report      results.json and report.md

Everything runs the real contact.py (engine.py finds it); nothing here copies its arithmetic.
"""
