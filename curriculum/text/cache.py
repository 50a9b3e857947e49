"""What a run of the code gives, kept until the code changes."""

import hashlib
import json
import sys
from importlib.metadata import version
from pathlib import Path

from contact import write_whole
from curriculum.machine import fingerprint
from curriculum.text.regions import CODE, ROOT

FOLDER = ROOT / ".cache"  # git ignores it; it may be deleted at any time


def cached(name: str, inputs, make, code=CODE):
    """make()'s result (JSON), made anew where `inputs` or the code changed since the last time.

    name: of the file in `.cache`. code: the files on which the result depends. A folder that
    cannot be written costs time only.
    """
    about = [inputs, fingerprint(*code), version("numpy"), sys.version]
    digits = hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()[:16]
    path = Path(FOLDER) / f"{name}.{digits}.json"
    try:
        return json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        text = json.dumps(make())
    try:
        write_whole(path, text)
        for other in path.parent.glob(f"{name}.{'?' * 16}.json"):
            if other != path:
                other.unlink(missing_ok=True)
    except OSError:
        pass
    return json.loads(text)
