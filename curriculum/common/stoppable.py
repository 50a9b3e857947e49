"""How a command ends when a person stops it: one line after Ctrl-C, silence at a closed pipe."""

import functools
import os
import sys

STOPPED = 128 + 2  # the exit status that a shell gives to what Ctrl-C (SIGINT) ended
UNREAD = 128 + 13  # and to what ended since nobody reads its output any more (SIGPIPE)


def stoppable(main=None, *, said="stopped"):
    """A decorator of a command's main, so that no stop ends it in a traceback.

    It returns main's exit status; 130 after Ctrl-C, with the line `said` on stderr; 141 without a
    word when the output is piped into something that has ended, such as `head -1`; and 2 when the
    output goes to a full disk. Nothing is cleaned up here, since curriculum/common/files.py
    writes files whole or not at all.
    """
    if main is None:
        return functools.partial(stoppable, said=said)

    @functools.wraps(main)
    def ended(*given, **named):
        try:
            try:
                return main(*given, **named)
            finally:
                if sys.stdout is not None:
                    sys.stdout.flush()  # at Python's own end, an error could not be caught
        except KeyboardInterrupt:
            wiped = "\r\x1b[K" if sys.stderr.isatty() else ""
            print(f"{wiped}{said}", file=sys.stderr)
            return STOPPED
        except BrokenPipeError:
            forget_output()
            return UNREAD
        except OSError as error:
            import errno

            if error.errno != errno.ENOSPC or error.filename is not None:
                raise
            forget_output()
            print(f"error: cannot print the rest: {error.strerror}", file=sys.stderr)
            return 2

    return ended


def forget_output():
    """Send what is still to be printed nowhere, or Python would complain at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def end_at_ctrl_c():
    """For worker processes: Ctrl-C ends them at once and without a word. Their parent says it."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)
