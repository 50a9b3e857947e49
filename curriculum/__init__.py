"""What stands around contact.py. Here, at its first import: how every command of it ends.

Ctrl-C at any time is "stopped" and status 130, SIGTERM 143, and no child lives on; 141 where nobody
reads on (`| head -1`); and what a disk, a folder or a file refuses is one line, with status 2.
"""

import atexit
import builtins
import contextlib
import glob
import os
import signal
import sys

HOME, OWNER = os.path.dirname(os.path.dirname(os.path.realpath(__file__))), os.getpid()


def stop(number, frame):
    """Handle a signal. A forked child has this handler, too, and ends silently."""
    if os.getpid() == OWNER:
        with contextlib.suppress(OSError):
            os.write(2, b"stopped\n")
        for listed in glob.glob("/proc/self/task/*/children"):  # elsewhere a terminal tells them
            with contextlib.suppress(OSError), open(listed) as file:
                for child in file.read().split():
                    os.kill(int(child), signal.SIGKILL)
    os._exit(128 + number)


def said(error):
    """Return an error's words without its number, with the file that it is about."""
    what = getattr(error, "strerror", None) or str(error)
    return f"{what}: {error.filename}" if getattr(error, "filename", None) else what


def refused(kind, error, trace):
    """Print an OSError in one line, as sys.excepthook; other errors keep their traceback."""
    if isinstance(error, BrokenPipeError):
        os._exit(141)
    if not isinstance(error, OSError):
        return sys.__excepthook__(kind, error, trace)
    with contextlib.suppress(OSError):
        print(f"error: {said(error)}", file=sys.stderr, flush=True)
    os._exit(2)


def print_the_rest():
    """Flush at the end, because Python itself would print a traceback if that fails."""
    for number in (signal.SIGINT, signal.SIGTERM):  # too late: all is done
        signal.signal(number, signal.SIG_IGN)
    try:
        print(end="", flush=True)
    except OSError as error:
        refused(OSError, error, None)


# "-m" stands there while the module is looked for; our scripts lie in two folders
_main = os.path.realpath(getattr(sys.modules["__main__"], "__file__", None) or "/")
_ours = sys.argv[0] == "-m" or os.path.dirname(_main) in (HOME, os.path.join(HOME, "exercises"))
if _ours and not hasattr(builtins, "__IPYTHON__"):  # whose %run goes on after a script
    for library in ("OMP", "OPENBLAS", "MKL"):  # before numpy loads: nothing here gains by two
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)
    sys.excepthook = refused
    atexit.register(print_the_rest)
