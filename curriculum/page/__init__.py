"""The chapter as one web page: `python -m curriculum.page [--out FILE]`.

The page is a single HTML file that asks the network for nothing. Its text is prose/chapter.md, its
code comes from the literate files by region, its numbers from fresh runs, its exercises from
exercises/. Its figures compute with the functions of contact.py, made into JavaScript.

    build.py      collects all that; chapter.py, panels.py, exercises.py make the parts
    bundle.py     joins the modules into one script without globals, and runs some while building:
                  still.js draws every figure's first picture, for readers without scripts
    main.js       the start; stage.js what can be grabbed and set; draw.js charts and balls
    runs.js       recordings of the made steps, for which python.js has what JavaScript lacks
    figures/NAME.js   a figure each, for the slot <!-- figure: NAME?quantity=value -->
    lit-html.js   lit-html 3.3.3, as npm has it; while building text.js stands in its place
"""
