"""Run time against error: contact.py's models and other engines, on problems with a known answer."""
