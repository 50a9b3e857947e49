"""Compile all loops for many balls and keep them on disk: `python -m curriculum.compiled`.

It takes about half a minute, once for each contact.py; runs then start in a second.
"""

from curriculum.commands import Parser, needs

with needs("bench"):
    import numba  # noqa: F401  # first: without it run cannot be imported

    import contact
    from curriculum.compiled import run

if __name__ == "__main__":
    Parser(prog="python -m curriculum.compiled", description=__doc__).parse_args()
    scene = contact.build_scene("pile", bodies=3)
    for model in contact.STEPPED:
        run.run_model(model, scene, 0.002, 2, contact.Settings())
        print(f"compiled: {model}", flush=True)
