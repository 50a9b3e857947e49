"""What every chapter of the course shares. Standard library only, and cheap to import."""
