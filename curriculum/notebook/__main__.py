"""python -m curriculum.notebook [--out FILE]"""

import sys

from curriculum.commands import Parser, needs


@needs("notebook")
def main():
    """Build and write. Returns the exit status: 0 written, 1 the notebook can't be built."""
    parser = Parser(prog="python -m curriculum.notebook", description="The chapter as a notebook.")
    parser.add_argument("--out", default="outputs/contact.ipynb", metavar="FILE")
    args = parser.parse_args()
    try:
        from curriculum.commands import write_whole
        from curriculum.notebook.build import build

        text = build()
        write_whole(args.out, text)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{args.out}: {len(text.encode()) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
