"""Look into what the README's commands wrote: `python .ci/look.py page.html book.ipynb`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


import nbformat

from curriculum.tests.page_browser import opened

for path in map(Path, sys.argv[1:]):
    if path.suffix == ".html":  # it opens in Chromium without an error, and all figures are drawn
        with opened(path, shown=False, motion="no-preference") as tab:
            parts, empty = (tab.locator(f".fig{e}").count() for e in ("", ":not(:has(svg *))"))
    else:
        book = nbformat.read(path, as_version=4)
        nbformat.validate(book)
        parts, empty = len(book.cells), sum(not cell.source for cell in book.cells)
    assert parts > 10 and not empty, (path, parts, empty)
    print(f"{path}: {parts} figures or cells, none of them empty")
