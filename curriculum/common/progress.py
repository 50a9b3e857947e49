"""How far a long run has come: one line on a terminal's stderr, nothing when piped."""

import sys
from time import perf_counter


class steps:
    """Progress over `total` steps, either way: `for k in steps(n, "pile")`, or `tick(done)` calls.

    Silent where stderr is no terminal and for the first second; then redrawn ten times a second
    and wiped when the last step is done, so that nothing of it stays on the screen.
    """

    def __init__(self, total, label, unit="steps"):
        self.total, self.label, self.unit = total, label, unit
        self.start = perf_counter()
        self.shown = sys.stderr is not None and sys.stderr.isatty()
        self.next = self.start + 1.0
        self.drawn = False

    def __call__(self, done):
        if not self.shown:
            return None
        if done >= self.total:
            return self.wipe()
        now = perf_counter()
        if now >= self.next and done > 0:
            left = (now - self.start) / done * (self.total - done)
            line = f"{self.label}: {done} of {self.total} {self.unit}, {left:.0f} s left "
            sys.stderr.write(f"\r{line}\x1b[K")
            sys.stderr.flush()
            self.next, self.drawn = now + 0.1, True

    def __iter__(self):
        try:
            for k in range(self.total):
                self(k)
                yield k
        finally:
            self.wipe()

    def wipe(self):
        """Clear the line, if there is one."""
        if self.drawn:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
            self.drawn = False
