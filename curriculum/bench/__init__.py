"""Run time against error: contact.py's models and other engines, where the answer is known."""
