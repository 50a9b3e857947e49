"""python -m curriculum.notebook [--out FILE]"""

import argparse
import sys

from curriculum.files import write_whole
from curriculum.notebook.build import build


def main():
    """Build and write. Returns the exit status: 0 written, 1 the notebook can't be built."""
    parser = argparse.ArgumentParser(description="The chapter as a notebook.", allow_abbrev=False)
    parser.add_argument("--out", default="outputs/contact.ipynb", metavar="FILE")
    args = parser.parse_args()
    try:
        text = build()
        write_whole(args.out, text)
    except (ImportError, OSError, ValueError) as error:
        hint = f" ({sys.executable} -m pip install -e '.[notebook]')"
        print(f"{error}{hint if isinstance(error, ImportError) else ''}", file=sys.stderr)
        return 1
    print(f"{args.out}: {len(text.encode()) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
