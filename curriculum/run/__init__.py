"""What the folder adds to a run of contact.py: recording, picture, many seeds, what to do next."""
