"""One name for a run that is asked for, which whoever runs something can pass on."""

from typing import NamedTuple

import contact


class Case(NamedTuple):
    """A run to be made: the arguments of contact.run_model, in its order."""

    model: str
    scene: contact.Scene
    dt: float = 0.002  # s
    steps: int = 2000
    settings: contact.Settings = contact.Settings()

    def run(self, report=None) -> contact.Run:
        """The run."""
        return contact.run_model(*self, report)
