"""What stands around contact.py: shared helpers, prose, gate, page, benchmarks and tests."""
