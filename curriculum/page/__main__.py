"""python -m curriculum.page [--out FILE]"""

import sys
from pathlib import Path

from curriculum.commands import Parser, needs


@needs("page")
def main(argv=None):
    """Build and write. Returns the exit status: 0 written, 1 it can't be built, 2 bad usage."""
    parser = Parser(
        prog="python -m curriculum.page", description="Write the chapter as one web page."
    )
    default = Path("outputs/contact.html")
    written = f"the file to write ({default})"
    parser.add_argument("--out", type=Path, default=default, metavar="FILE", help=written)
    args = parser.parse_args(argv)
    if args.out.is_dir():
        parser.error(f"--out: given the folder {args.out}; allowed: a file")
    try:
        from curriculum.commands import write_atomic
        from curriculum.page.build import build

        print("building: runs, figures, formulas; up to a minute", file=sys.stderr)
        page = build()
        write_atomic(args.out, page)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{args.out}: {len(page.encode()) / 1000:.0f} kB, one file; open it in a browser:")
    print(args.out.resolve().as_uri())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
