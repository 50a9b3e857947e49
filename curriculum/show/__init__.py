"""What the folder adds to a run of contact.py: recording, picture, memory, what to do next."""
