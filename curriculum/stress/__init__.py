"""The stress test: what must hold on any scene. python -m curriculum.stress --help"""
