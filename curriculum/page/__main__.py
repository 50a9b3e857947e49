"""python -m curriculum.page [--out FILE] [--pictures FOLDER]: write the chapter as one HTML file."""

import sys
from pathlib import Path

from curriculum.common.arguments import Parser
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable


@stoppable
def main(argv=None):
    """Build and write. Returns the exit status: 0 written, 1 the chapter can't be built, 2 bad usage."""
    parser = Parser(
        prog="python -m curriculum.page", description="Write the chapter as one web page."
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("outputs/contact.html"),
        metavar="FILE",
        help="the file to write (outputs/contact.html)",
    )
    parser.add_argument("--root", type=Path, help="another copy of the project")
    parser.add_argument(
        "--pictures", type=Path, metavar="FOLDER", help="and the README's pictures of it"
    )
    args = parser.parse_args(argv)
    try:
        from curriculum.page.build import build
    except ImportError as error:
        print(f"the page needs {error.name}: pip install -e '.[page]'", file=sys.stderr)
        return 1
    try:
        page = build(args.root) if args.root else build()
        args.out.parent.mkdir(parents=True, exist_ok=True)
        write_whole(args.out, page)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{args.out}: {len(page.encode()) / 1000:.0f} kB, one file")
    if args.pictures:
        from curriculum.page.browser import photograph

        print(*photograph(args.out, args.pictures), sep="\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
