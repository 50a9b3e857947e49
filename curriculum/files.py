"""Files that are written whole or not at all, so that nobody ever reads half of one."""

import json
import os
from pathlib import Path


def write_whole(path, content):
    """Replace the file at `path` by str or bytes, whole or not at all. Makes missing folders."""
    path = Path(os.path.realpath(path))
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        temporary.write_bytes(content.encode() if isinstance(content, str) else content)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_json(path, data):
    """Write strict JSON, whole or not at all. Raises ValueError on NaN and infinity."""
    write_whole(path, json.dumps(data, indent=2, sort_keys=True, allow_nan=False) + "\n")
