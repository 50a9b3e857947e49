"""The chapter as a notebook: `python -m curriculum.notebook [--out FILE]`."""
