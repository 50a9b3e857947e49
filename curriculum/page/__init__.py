"""The chapter as one web page: `python -m curriculum.page [--out FILE]`.

The page is a single HTML file that asks the network for nothing. Its text is prose/chapter.md, its
code comes from contact.py by region, its numbers from fresh runs, its exercises from exercises/ and
meta.yaml, its clock times from wallclock.csv. Its first figure is live: engine.js computes the three
models in the reader's browser, penalty and lcp bit for bit as contact.py does.

    build.py      collects all that and writes the file
    prose.py      chapter.md to HTML, with its slots for figures and exercises
    drawing.py    what is seen with JavaScript off: the poster and the small figures, as SVG
    engine.js     the three models            draw.js      the look of a model; a small plotter
    figure.js     the live figure             figures.js   small figures and the puzzle
    reader.js     copying, exercises, contents
    style.css  templates/
"""
