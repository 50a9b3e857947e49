"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.text                 # check, write nothing; exit 1 and a line a problem
    python -m curriculum.text --accept NAME   # what speaks of this region has been read; and all
                                              # sentences whose numbers moved

Slots, flags and names in `code` are of what is there, numbers are quoted by reference, `holds:`
comments are true, and results are of today's code; gate.py says what a reader has to read again.
"""

import sys

from curriculum.commands import Parser, needs, stoppable


@stoppable()
@needs("dev")
def main(argv=None) -> int:
    """Check or accept. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog="python -m curriculum.text", description=__doc__)
    parser.add_argument("--accept", metavar="NAME", nargs="*", help="what was read")
    args = parser.parse_args(argv)
    from curriculum.text import gate
    from curriculum.text.references import TextError

    try:
        return gate.check() if args.accept is None else gate.accept(args.accept)
    except SyntaxError as error:
        print(f"{error.filename}:{error.lineno}: not Python: {error.msg}", file=sys.stderr)
    except (OSError, TextError) as error:
        print(error, file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main())
