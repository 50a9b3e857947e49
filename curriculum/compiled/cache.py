"""Compile loops by numba, and keep them on disk, in .cache/loops beside contact.py.

The source of the loops is a file in a folder of its own, named by the hash of all that decides what
is compiled. So loops of another contact.py are never loaded, two processes may write at once, and a
folder that cannot be used (read-only, full, cut, no home) costs the keeping, never the run.
"""

import hashlib
import os
import shutil
import sys
import types
from importlib.metadata import PackageNotFoundError, version

from contact import MissingPackage
from curriculum.commands import ROOT, to_install, write_atomic

try:
    NUMBA = version("numba")  # numba itself takes a while, so it is imported where loops are loaded
except PackageNotFoundError:
    raise MissingPackage(to_install("numba")) from None
if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":  # contact.py's own loops are faster
    raise MissingPackage("numba is told not to compile (NUMBA_DISABLE_JIT)")

FOLDER = ROOT / ".cache" / "loops"
SECONDS_A_LINE = 0.01  # of CPU: compiling scalar loops, by the lines of their source, measured


class Loops:
    """A module of loops, given as source, that numba compiles."""

    def __init__(self, name: str, source: str):
        decided_by = f"{source}{sys.version}{NUMBA}"
        self.name = f"{name}_{hashlib.sha256(decided_by.encode()).hexdigest()[:16]}"
        self.source = source
        self.seconds = SECONDS_A_LINE * source.count("\n")  # about how long compiling takes
        self.folder = FOLDER / self.name
        self.module: types.ModuleType | None = None

    def pays(self, seconds: float) -> bool:
        """Return whether to use them for a run that takes so many seconds without them.

        It does where they are loaded or on disk, or compiled sooner than the run is done.
        """
        return self.module is not None or self.kept() or seconds > self.seconds

    def kept(self) -> bool:
        """Return whether numba has put them on disk."""
        return any(self.folder.rglob("*.nbc"))

    def load(self, examples: dict) -> types.ModuleType:
        """Return the module, compiled for {function that Python calls: arguments like these}.

        Says on stderr that it compiles. Raises ImportError where numba is missing.
        """
        path = self.folder / f"{self.name}.py"
        if self.module is None:
            if not self.kept() and sys.stderr:
                name = self.name.rpartition("_")[0].removesuffix("_step")
                print(f"compiling {name}, once ({self.seconds:.0f} s) ...", file=sys.stderr)
            try:
                if not path.exists():
                    write_atomic(path, self.source)
                self.module = self.compile(examples, path)
            except ImportError:
                raise
            except Exception:  # numba's own, pickle's, a full disk: forget what is on disk
                shutil.rmtree(self.folder, ignore_errors=True)
                self.module = self.module or self.compile(examples)
        return self.module

    def compile(self, examples, path=None) -> types.ModuleType:
        """Return the module with its functions compiled, kept beside `path` if there is one."""
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
                setattr(module, name, numba.njit(function, **options))
        for name, given in examples.items():
            getattr(module, name).compile(tuple(map(numba.typeof, given)))
        return module
