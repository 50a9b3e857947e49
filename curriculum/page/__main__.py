"""python -m curriculum.page [--out FILE] [--screenshot PNG]: write the chapter as one HTML file."""

import sys
from pathlib import Path

from curriculum.common.arguments import Parser
from curriculum.common.files import write_whole


def main(argv=None):
    """Build and write. Returns the exit status: 0 written, 1 the chapter can't be built, 2 bad usage."""
    parser = Parser(prog="python -m curriculum.page", description="Write the chapter as one web page.")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("outputs/contact.html"),
        metavar="FILE",
        help="the file to write (outputs/contact.html)",
    )
    parser.add_argument("--root", type=Path, help="another copy of the project")
    parser.add_argument("--screenshot", type=Path, metavar="PNG", help="and its first screen as a picture")
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
    if args.screenshot:
        photograph(args.out, args.screenshot)
        print(args.screenshot)
    return 0


def photograph(page, picture):
    """Save the first screen of the HTML file `page` (1280 x 900, nothing moving). Needs a Chromium."""
    from playwright.sync_api import sync_playwright

    from curriculum.tests.page_browser import CHROMIUM, FLAGS
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        tab = browser.new_page(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
        tab.goto(page.resolve().as_uri())
        tab.wait_for_timeout(1500)                                  # ms: the figure draws itself
        tab.screenshot(path=picture)
        browser.close()


if __name__ == "__main__":
    raise SystemExit(main())
