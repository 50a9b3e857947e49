"""Write a file whole or not at all."""

import os
from contextlib import contextmanager


@contextmanager
def whole(path):
    """Yield a temporary name beside `path`; on leaving, what was written there becomes `path`.

    For writers that insist on opening the file themselves. Missing folders are made. On any
    failure, Ctrl-C included, the temporary file is removed and `path` is as it was. After kill -9
    `path` is as it was too; the hidden `.NAME.PID.tmp` is then all that is left behind.
    Raises OSError naming `path` (not the temporary name) when the folder or file can't be written.
    """
    path = os.path.realpath(path)
    folder, name = os.path.split(path)
    temporary = os.path.join(folder, f".{name}.{os.getpid()}.tmp")
    try:
        os.makedirs(folder, exist_ok=True)
        yield temporary
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException as error:
        if os.path.lexists(temporary):
            os.unlink(temporary)
        if isinstance(error, OSError) and error.errno is not None:
            raise OSError(error.errno, error.strerror, path) from None
        raise


def write_whole(path, data):
    """Replace the file at `path` by `data` (bytes, or str as UTF-8) in one step; see `whole`."""
    data = data.encode("utf-8") if isinstance(data, str) else data
    with whole(path) as temporary, open(temporary, "wb") as file:
        file.write(data)


def why_unwritable(folder):
    """None when files can go into `folder` (made if need be), else a few words why not.

    Looks only, makes nothing. A full disk or a folder that vanishes later still raises OSError
    in `whole`.
    """
    folder = os.path.realpath(folder)
    while not os.path.lexists(folder):
        folder = os.path.dirname(folder)
    if not os.path.isdir(folder):
        return f"{folder} is not a folder"
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"no permission to write in {folder}"
    return None
