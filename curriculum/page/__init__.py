"""The chapter as one web page: `python -m curriculum.page [--out FILE]`.

The page is a single HTML file that asks the network for nothing. Its text is prose/chapter.md, its
code comes from the literate files by region, its numbers from fresh runs, its exercises from
exercises/ and meta.yaml, its clock times from wallclock.csv. Its figures are live: engine.js
computes penalty, lcp and soft in the reader's browser bit for bit as contact.py does, and exact.js
the exact model.

The picture is written once, in JavaScript that makes SVG as text. What computes and draws touches no
document, so the same files run in an embedded V8 while the page is built, and draw the stills that a
reader without scripts sees (still.py, still.js). No second drawing in Python has to be kept equal.

    build.py      collects all that and writes the file
    prose.py      chapter.md to HTML, with its slots, its links that set the figure, its numbers to drag
    body.py       the chapter's segments in order, each behind the veils of the bets it would tell
    exercises.py  bets and the blank, from exercises/ and meta.yaml
    panels.py     code, highlighted: regions, and the whole of contact.py
    maths_font.py the font of the formulas, and the command that cuts it
    browser.py    a real browser, for the pictures of the README
    engine.js, exact.js                     the models
    plot.js, lane.js, small_figures.js      numbers, plots, balls; the lanes; the small figures
    state.js, controls.js, live_figure.js   what is set; the knobs; the live figure
    links.js, live_small.js, puzzle.js      what the text sets; the small figures' knobs; the puzzle
    bets.js, arithmetic.js, blank.js        exercises: bets, and the blank that is filled in the page
    sandbox.js, reader.js                   balls to throw; copying, contents, and the start
    style.css  templates/
"""
