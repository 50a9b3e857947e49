"""The chapter as one web page: `python -m curriculum.page [--out FILE]`.

The page is a single HTML file that asks the network for nothing. Its text is prose/chapter.md, its
code comes from the literate files by region, its numbers from fresh runs, its exercises from
exercises/. Its figures can be grabbed: engine.js computes the models in the reader's browser, all
that step bit for bit as contact.py does.

    build.py      collects all that; chapter.py, panels.py, exercises.py make the parts
    bundle.py     joins the modules into one script without globals, and runs some while building:
                  still.js draws every figure's first picture, for readers without scripts
    fonts.py      the fonts; the README's picture and measuring: curriculum/tests/page_measure.py
    main.js       the start; store.js the one state; stage.js what can be grabbed; draw.js SVG
    engine.js falls.js      the models; as the live figure and the first bet let them fall
    figures/NAME.js         a figure each, for the slot <!-- figure: NAME -->; kit.js
    bets.js blank.js arithmetic.js reader.js    exercises, and what the text sets
"""
