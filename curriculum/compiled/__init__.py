"""Many balls by compiled loops: the bits of contact.py's own steps, sooner.

run.py       runs a model: what contact.py calls
to_loops.py  translates contact.py's steps from objects to rows of tables
rows.py      what a model's loops need beside its step, written by hand
pairs.py     the broad phase, the same for all models
cache.py     compiles loops by numba and keeps them on disk
"""
