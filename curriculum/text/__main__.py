"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.text                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.text --accept SECTION  # these sections have been read as they are now

It holds together: regions are well formed, and each is included once by the chapter; a section of
chapter or README was read again after its text, or the code of a region that it includes or names,
changed; numbers are quoted by reference, and `holds:` comments are true; measured results and rows
of the ledger are of today's code.
"""

import sys

from curriculum.commands import Parser, needs, stoppable


@stoppable()
@needs("dev")
def main(argv=None) -> int:
    """Check or accept. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog="python -m curriculum.text", description=__doc__)
    parser.add_argument("--accept", metavar="SECTION", nargs="*", help="these have been read")
    args = parser.parse_args(argv)
    try:
        from curriculum.text import gate

        return gate.check() if args.accept is None else gate.accept(args.accept)
    except SyntaxError as error:
        wrong = f"{error.filename}:{error.lineno}: not Python: {error.msg}"
    except (OSError, ValueError) as error:
        wrong = error
    print(wrong, file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main())
