"""What keeps text, code, numbers and results together: `python -m curriculum.gate`."""
