"""Loops compiled by numba, kept on disk, and taken only where that pays.

The source of the loops is a file in a folder of its own, named by the hash of all that decides what
is compiled. So what was compiled for another contact.py is never taken, two processes may write at
once, and whatever stands in the way of the folder (read-only, full, cut, no home) costs the keeping
or the compiling, and never the run: the plain loops do it.
"""

import hashlib
import os
import shutil
import sys
import types
from importlib.metadata import PackageNotFoundError, version

from curriculum.commands import ROOT, to_install, write_atomic

try:
    NUMBA = version("numba")  # itself it is imported where loops are loaded: that takes a while
except PackageNotFoundError:
    raise ImportError(to_install("numba")) from None  # without a name: it says itself what it needs
if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":  # contact.py's own loops are faster
    raise ImportError("numba is told not to compile (NUMBA_DISABLE_JIT)")

FOLDER = ROOT / ".cache" / "loops"
SECONDS = 8.0  # about what it takes to compile the loops of one model


class Loops:
    """The functions of a source, to be compiled, each with numba's options."""

    def __init__(self, name: str, source: str, **options):
        decided_by = f"{source}{options}{sys.version}{NUMBA}"
        self.name = f"{name}_{hashlib.sha256(decided_by.encode()).hexdigest()[:16]}"
        self.source, self.options = source, options
        self.folder = FOLDER / self.name
        self.kept = self.folder / "kept"  # stands there once all is compiled and on disk
        self.module: types.ModuleType | None = None

    def pays(self, seconds: float) -> bool:
        """Whether to take them for a run that plain loops would need so many seconds for."""
        return self.module is not None or self.kept.exists() or seconds > SECONDS

    def load(self, examples: dict) -> types.ModuleType:
        """The module, compiled for {function that Python calls: arguments like these}.

        Slow the first time. Raises ImportError where numba cannot be imported.
        """
        path = self.folder / f"{self.name}.py"
        if self.module is None:
            if not self.kept.exists() and sys.stderr and sys.stderr.isatty():
                print(f"compiling {self.name.rpartition('_')[0]}, once ...", file=sys.stderr)
            try:
                if not path.exists():
                    write_atomic(path, self.source)
                self.module = self.compile(examples, path)
                if not self.kept.exists():
                    write_atomic(self.kept, "")
            except ImportError:
                raise
            except Exception:  # numba's own, pickle's, a full disk: forget what is kept
                shutil.rmtree(self.folder, ignore_errors=True)
                self.module = self.module or self.compile(examples)
        return self.module

    def compile(self, examples, path=None) -> types.ModuleType:
        """The module with its functions compiled, kept beside `path` if there is one."""
        import numba

        module = types.ModuleType(self.name)
        module.__file__ = str(path or f"<{self.name}>")
        sys.modules[self.name] = module  # numba's files name it
        exec(compile(self.source, module.__file__, "exec"), vars(module))
        for name, function in list(vars(module).items()):
            if isinstance(function, types.FunctionType):
                if name in examples:
                    options = {"cache": path is not None}
                else:  # Python does not call it
                    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
                setattr(module, name, numba.njit(function, **options, **self.options))
        for name, given in examples.items():
            getattr(module, name).compile(tuple(map(numba.typeof, given)))
        return module
