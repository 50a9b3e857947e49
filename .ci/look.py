"""Look into what the README's commands wrote: `python .ci/look.py page.html book.ipynb`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


def look_at_page(path):
    """Open the page in Chromium: no error, and no figure without a drawing in it."""
    from curriculum.tests.page_browser import opened

    with opened(path, shown=False, motion="no-preference") as tab:
        heading = tab.locator("h1").first.inner_text()
        figures = tab.locator(".fig").count()
        empty = tab.locator(".fig:not(:has(svg *))").count()
    assert figures > 10 and not empty, (figures, empty)
    return f"{heading!r} in Chromium, {figures} figures, all drawn, no error"


def look_at_notebook(path):
    """The notebook is valid, and its code cells are Python or notebook magic."""
    import nbformat

    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    code = [cell.source for cell in book.cells if cell.cell_type == "code"]
    for source in code:
        compile("\n".join(x for x in source.splitlines() if x[:1] not in "%!"), str(path), "exec")
    assert len(code) > 10 and len(book.cells) > 2 * 10, len(book.cells)
    return f"{len(book.cells)} cells, {len(code)} of code (the tests run them)"


for name in sys.argv[1:]:
    look = look_at_page if name.endswith(".html") else look_at_notebook
    print(f"{name}: {look(Path(name))}")
