"""The stress test: what must hold on any scene, maps of every knob, every flag at its ends.

python -m curriculum.stress --help
"""
